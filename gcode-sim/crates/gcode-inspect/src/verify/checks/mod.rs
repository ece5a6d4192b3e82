//! The checks: one file each, one line here.
mod air;
mod clearance;
mod common_shift;
mod cut_outside;
pub(super) mod cutting;
mod depth;
mod diameter;
mod explained_by_rows;
pub(super) mod extra;
mod mirrored;
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

use super::{Comparison, HoleFinding, HoleInspection};

/// A check adds what it finds; it may fold earlier findings behind its own.
type Check = fn(&HoleInspection<'_>, &mut Vec<HoleFinding>);

/// In the order in which they are made: a check sees the findings of those above it.
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
