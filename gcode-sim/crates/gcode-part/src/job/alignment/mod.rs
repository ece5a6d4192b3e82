//! The job file of the family `alignment`: the part to be set up and its measuring devices.
mod ellipse;
mod file;
mod limits;
mod runout;

pub(super) use file::{File, parse};

use super::{JobControl, PinMachine, SheetInfo, Surface};
use crate::gauge::GaugeSet;

/// A part to be aligned; lengths in mm, angles in degrees.
#[derive(Clone, Debug, PartialEq)]
pub struct Alignment {
    /// Control of the programs.
    pub control: JobControl,
    /// Machine.
    pub machine: PinMachine,
    /// Surface of the part.
    pub surface: Surface,
    /// Radius of the stylus ball.
    pub probe_radius: f64,
    /// Feed of a touch, mm/min.
    pub probe_feed: f64,
    /// Distance before and behind the nominal surface at which a touch begins and ends.
    pub probe_search: f64,
    /// Standard deviation of a touch.
    pub probe_noise: f64,
    /// Table that sets the angle of the part's axis.
    pub sine_table: SineTable,
    /// Chord E–F and its candidates.
    pub chord: Chord,
    /// Run-out measurement.
    pub runout: Runout,
    /// Path of the edge finder.
    pub ellipse: EllipsePath,
    /// Tolerances of the set-up.
    pub limits: AlignmentLimits,
    /// Additional data for the set-up sheet.
    pub sheet: SheetInfo,
}

/// The table that sets the angle between the part's bottom face and its axis.
#[derive(Clone, Debug, PartialEq)]
pub struct SineTable {
    /// Distance between the rollers.
    pub length: f64,
    /// Nominal angle, 0 to 45.
    pub phi: f64,
    /// Set of gauge blocks.
    pub gauge_blocks: GaugeSet,
    /// 1 if higher blocks rotate the part from x towards y, −1 if they rotate it back.
    pub sign: i8,
}

/// The chord between two points E and F of the surface in the plane z = 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chord {
    /// x of E.
    pub e_radius: f64,
    /// x of F.
    pub f_radius: f64,
    /// Radius of the circle of candidates round each.
    pub circle: f64,
    /// Number of candidates round each, 1 to 10.
    pub candidates: u32,
    /// Largest difference of the part's height over the model between two touched points, one at each end.
    pub uneven: f64,
}

/// The ellipse in the plane z = 0 along which the ball of an edge finder is fed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EllipsePath {
    /// x of the surface at the start.
    pub from: f64,
    /// x of the surface at the end.
    pub to: f64,
    /// Tolerance of the ball's distance from the surface, rounding included.
    pub chord_error: f64,
    /// Feed, mm/min.
    pub feed: f64,
}

/// Run-out measurement: an indicator on the part while the table rotates.
#[derive(Clone, Debug, PartialEq)]
pub struct Runout {
    /// Both y of the indicator.
    pub heights: [f64; 2],
    /// Position of the rotary at the first reading.
    pub from: f64,
    /// Position of the rotary at the last reading.
    pub to: f64,
    /// Readings at each height, 3 to 100.
    pub readings: u32,
    /// Largest shift of the part in y that the fit accepts.
    pub y_shift: f64,
}

/// Tolerances of the set-up, which the set-up sheet prints beside the readings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AlignmentLimits {
    /// Limit of #580 and #581 of the last run-out, mm.
    pub shift: f64,
    /// Limit of #582 and #583 of the last run-out, degrees.
    pub tilt: f64,
    /// Limit of the dial reading along the ellipse, mm.
    pub dial: f64,
}
