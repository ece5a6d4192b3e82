//! The checks on holes: one file each, one line here. All of them share the imports of this file.
mod air;
mod both_sides;
mod clearance;
mod common_shift;
mod cut_outside;
pub(super) mod cutting;
mod cycle_in_air;
mod depth;
mod diameter;
mod edges_alike;
mod explained_by_rows;
pub(super) mod extra;
pub(super) mod features;
mod milled_core;
pub(super) mod mirrored;
mod missing;
mod next_hole;
mod overlap;
mod position;
mod reach;
mod roundness;
mod row_angle;
mod row_group;
mod row_missing;
mod row_pitch;
mod row_seam;
mod row_short;
mod signs;
mod start_unknown;
pub(super) mod stock;
mod stopped;
mod tap_motion;
mod threads;
mod through;
mod tool_idle;
mod tool_kinds;
mod tool_short;
mod tools;
mod transformed;
mod wall;
mod widths;

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{Point3, Unit, Vector3};

use super::hole_finding::{HoleFindings, Subject, finish_group_finding, folded_note, locate_at_call};
use super::rows::PatternRows;
use super::{Comparison, Deviation, HoleInspection, HolePair, format_range};
use crate::holes::DrilledHole;
use crate::machine::{LinkMotion, Machine};
use gcode_lang::diag::{Diagnostic, FindingKind, Severity};
use gcode_lang::units::Deg;
use gcode_part::{Hole, MAX_BREAK_THROUGH, Pattern, PointTree, ProcessLimits, Surface, exceeds};

/// A check adds findings; it may fold earlier ones.
type Check = fn(&HoleInspection<'_>, &mut HoleFindings);

/// The checks in order, each with the codes of its findings; each sees the findings of those above it.
pub(super) const ALL: &[Check] = &[
    start_unknown::check, // start-unknown
    stock::check,         // stock-mismatch
    mirrored::check,      // rotary-sign, mirror-image
    transformed::check,   // holes-transformed
    row_group::check,     // row-group
    row_angle::check,     // row-angle
    row_seam::check,      // row-seam
    row_pitch::check,     // row-pitch
    missing::check,       // hole-missing
    extra::check,         // hole-extra, hole-twice
    position::check,      // hole-position, hole-tilted
    cut_outside::check,   // hole-cut-aside
    depth::check,         // hole-depth
    diameter::check,      // hole-diameter
    roundness::check,     // hole-roundness
    milled_core::check,   // hole-core
    features::check,      // feature-*, hole-not-through, hole-twice, tap-*, tool-kind
    tools::check,         // hole-tools
    overlap::check,       // hole-overlap
    row_short::check,     // row-short
    row_missing::check,   // row-missing
    air::check,           // hole-in-air
    cycle_in_air::check,  // cycle-in-air
    tool_idle::check,     // tool-cuts-nothing
    through::check,       // hole-through
    tool_short::check,    // tool-short
    stopped::check,       // hole-missing
    common_shift::check,  // holes-alike, hole-twice
    edges_alike::check,   // feature-extra
    reach::check,         // length-offset
    signs::check,         // axis-signs
    clearance::check,     // turns-near-part, rapid-near-part
    cutting::check,       // drill-speed, drill-feed, drill-peck, spindle-reversed, job-tool, length-offset
];
