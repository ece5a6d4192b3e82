//! The checks on holes: one file each, one line here. All of them share the imports of this file.
mod air;
mod clearance;
mod common_shift;
mod cut_outside;
pub(super) mod cutting;
mod depth;
mod diameter;
mod explained_by_rows;
pub(super) mod extra;
pub(super) mod mirrored;
mod missing;
mod overlap;
mod position;
mod reach;
mod row_angle;
mod row_group;
mod row_missing;
mod row_pitch;
mod row_seam;
mod row_short;
mod signs;
mod stopped;
mod through;
mod tool_short;
mod tools;

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{Point3, Unit, Vector3};

use super::hole_finding::{About, HoleFindings, folded_note, locate_at_call, summary};
use super::rows::PatternRows;
use super::{Comparison, Deviation, HoleInspection, HolePair, format_range};
use crate::holes::DrilledHole;
use crate::machine::{LinkMotion, Machine};
use gcode_lang::diag::{Diagnostic, FindingKind, Severity};
use gcode_lang::units::Deg;
use gcode_part::{Hole, Pattern, PointTree, ProcessLimits, Surface};

/// A check adds findings; it may fold earlier ones.
type Check = fn(&HoleInspection<'_>, &mut HoleFindings);

/// The checks in order: each sees the findings of those above it.
pub(super) const ALL: &[Check] = &[
    mirrored::check,
    row_group::check,
    row_angle::check,
    row_seam::check,
    row_pitch::check,
    missing::check,
    extra::check,
    position::check,
    cut_outside::check,
    depth::check,
    diameter::check,
    tools::check,
    overlap::check,
    row_short::check,
    row_missing::check,
    air::check,
    through::check,
    tool_short::check,
    stopped::check,
    common_shift::check,
    reach::check,
    signs::check,
    clearance::check,
    cutting::check,
];
