//! The checks: one file each, one line here.
pub(super) mod air;
pub(super) mod alike;
mod aside;
pub(super) mod clearance;
pub(super) mod cutting;
mod depth;
mod diameter;
pub(super) mod mirrored;
mod missing;
mod of_rows;
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
pub(super) mod surplus;
pub(super) mod through;
pub(super) mod tool_short;
mod tools;

use super::{Comparison, Objection};

type Check = fn(&Comparison<'_>, &mut Vec<Objection>);

pub(super) const ALL: &[Check] = &[
    row_group::check,
    row_angle::check,
    row_seam::check,
    row_pitch::check,
    missing::check,
    surplus::check,
    position::check,
    aside::check,
    depth::check,
    diameter::check,
    tools::check,
    overlap::check,
    row_short::check,
    row_missing::check,
];
