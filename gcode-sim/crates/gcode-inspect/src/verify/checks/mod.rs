//! The checks: one file each, one line here.
pub(super) mod air;
pub(super) mod clearance;
pub(super) mod common_shift;
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
pub(super) mod reach;
mod row_angle;
mod row_group;
mod row_missing;
mod row_pitch;
mod row_seam;
mod row_short;
pub(super) mod signs;
pub(super) mod stopped;
pub(super) mod through;
pub(super) mod tool_short;
mod tools;

use super::{Comparison, HoleFinding};

type Check = fn(&Comparison<'_>, &mut Vec<HoleFinding>);

pub(super) const ALL: &[Check] = &[
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
];
