//! The job file of the family `alignment`: what is known of the part that is to be set up, and what it is measured with.
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
    pub control: JobControl,
    pub machine: PinMachine,
    pub surface: Surface,
    /// Radius of the stylus ball.
    pub probe_radius: f64,
    /// mm/min of a touch.
    pub probe_feed: f64,
    /// A touch begins this far before where the surface should be, and ends as far behind it.
    pub probe_search: f64,
    /// Standard deviation of a touch.
    pub probe_noise: f64,
    pub sine_table: SineTable,
    pub chord: Chord,
    pub runout: Runout,
    pub ellipse: EllipsePath,
    pub limits: AlignmentLimits,
    pub sheet: SheetInfo,
}

/// The table that sets the angle between the part's bottom face and its axis.
#[derive(Clone, Debug, PartialEq)]
pub struct SineTable {
    /// Between the rollers.
    pub length: f64,
    pub phi: f64,
    pub gauge_blocks: GaugeSet,
    /// 1 where higher blocks turn the part from x towards y, −1 where they turn it back.
    pub sign: i8,
}

/// The chord between two points E and F of the surface in the plane z = 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chord {
    /// Their x.
    pub e_radius: f64,
    pub f_radius: f64,
    /// Radius of the circle on which the candidates lie round each.
    pub circle: f64,
    pub candidates: u32,
    /// How much higher over the model the part may stand at one end than at the other, of points that were touched.
    pub uneven: f64,
}

/// The ellipse in the plane z = 0 along which the ball of an edge finder is fed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EllipsePath {
    /// x of the surface where it begins and where it ends.
    pub from: f64,
    pub to: f64,
    /// How far the ball may be off its distance from the surface, rounding included.
    pub chord_error: f64,
    /// mm/min.
    pub feed: f64,
}

/// An indicator held against the part while the table turns.
#[derive(Clone, Debug, PartialEq)]
pub struct Runout {
    /// The two y of the indicator.
    pub heights: [f64; 2],
    /// Where the rotary stands at the first reading and at the last.
    pub from: f64,
    pub to: f64,
    /// At each height; 3 to 100.
    pub readings: u32,
    /// The largest shift of the part in y that the fit is believed to find.
    pub y_shift: f64,
}

/// What a part that is set up may be off by: the set-up sheet prints it beside the readings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AlignmentLimits {
    /// #580 and #581 of the last run-out, mm.
    pub shift: f64,
    /// #582 and #583 of the last run-out, degrees.
    pub tilt: f64,
    /// The dial along the ellipse, mm.
    pub dial: f64,
}
