//! The job file of the family `alignment`: the part to be set up and its measuring devices.
#[cfg(test)]
mod tests;

use schemars::JsonSchema;
use serde::de::Error;
use serde::{Deserialize, Deserializer};

use super::{Family, FileError, JobControl, PinMachine, Reader, SheetInfo, SurfaceSpec};
use crate::gauge::{self, GaugeSet};
use crate::reader::bounds::{
    Candidates, ChordError, KeyRange, Length, PartHeight, PartShift, PathFeed, ProbeFeed, ProbeLength,
    ProbeSearch, Radius, ReadingAngle, ReadingCount, ShiftLimit, SineTableAngle, SineTableLength, TiltLimit,
    Uneven,
};
use crate::reader::{AxisSign, FileKey, FixedArray, OUT_OF_RANGE, Optional, Section, Word, WordList};
use gcode_lang::units::{Deg, Mm};

/// Least y component of the surface's normal at a point that O8202 touches along y.
const STEEP: f64 = 0.3;

/// Measurements of the position of a part on its machine.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Alignment {
    /// The kind of part, which decides the other keys.
    #[serde(rename = "family")]
    #[schemars(extend("enum" = ["alignment"]))]
    _family: String,
    /// The control of the programs.
    #[serde(with = "Section::<JobControl>")]
    pub control: JobControl,
    /// The machine.
    #[serde(with = "Section::<PinMachine>")]
    pub machine: PinMachine,
    /// The surface that is measured.
    #[serde(with = "Section::<SurfaceSpec>")]
    pub surface: SurfaceSpec,
    /// The touch probe.
    #[serde(with = "Section::<TouchProbe>")]
    pub probe: TouchProbe,
    /// The table that sets the angle of the part's axis.
    #[serde(with = "Section::<SineTable>")]
    pub sine_table: SineTable,
    /// The chord between two points of the surface.
    #[serde(with = "Section::<Chord>")]
    pub chord: Chord,
    /// An indicator on the part while the table rotates.
    #[serde(with = "Section::<Runout>")]
    pub runout: Runout,
    /// The outline that an edge finder follows.
    #[serde(default, with = "Section::<FileEllipse>")]
    ellipse: FileEllipse,
    /// Tolerances of the set-up of a part.
    #[serde(default, with = "Section::<FileLimits>")]
    limits: FileLimits,
    /// Additional data for the set-up sheet.
    #[serde(default, with = "Section::<SheetInfo>")]
    pub sheet: SheetInfo,
}

/// The touch probe.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TouchProbe {
    /// Radius of the stylus ball, mm.
    #[serde(with = "ProbeLength")]
    pub radius: f64,
    /// Feed of a touch, mm/min.
    #[serde(default = "ProbeFeed::default", with = "ProbeFeed")]
    pub feed: f64,
    /// Distance in front of and behind the nominal surface where a touch begins and ends, mm.
    #[serde(default = "ProbeSearch::default", with = "ProbeSearch")]
    pub search: f64,
    /// Standard deviation of a touch, mm; not below the least increment [default: 0.002, or the increment].
    #[serde(default, with = "Optional::<ChordError>")]
    noise: Option<f64>,
}

/// The table that sets the angle between the part's bottom face and its axis.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SineTable {
    /// Distance between the rollers, mm.
    #[serde(with = "SineTableLength")]
    pub length: f64,
    /// The angle, degrees.
    #[serde(with = "SineTableAngle")]
    pub phi: f64,
    /// The set of gauge blocks.
    #[serde(with = "Word::<GaugeSet>")]
    pub gauge_blocks: GaugeSet,
    /// 1 if higher blocks rotate the part from x towards y, -1 if they rotate it back.
    #[serde(default = "AxisSign::default", with = "AxisSign")]
    pub sign: i8,
}

impl WordList for GaugeSet {
    type Value = Self;

    fn all() -> Vec<(&'static str, Self)> {
        Self::ALL.map(|set| (set.name, set)).into()
    }
}

/// The chord between two points E and F of the surface in the plane z = 0.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Chord {
    /// x of E, mm: at most the equatorial radius.
    #[serde(with = "Radius")]
    pub e_radius: f64,
    /// x of F, mm, different from that of E.
    #[serde(with = "Radius")]
    pub f_radius: f64,
    /// Radius of the circle of candidates round each, mm.
    #[serde(with = "Length")]
    pub circle: f64,
    /// Number of candidates round each.
    #[serde(with = "Candidates")]
    pub candidates: u32,
    /// Largest difference of the part's height over the model between E and F, mm, if they were touched
    /// [default: 0.05, or 1.5 times what a part set right by the run-out leaves].
    #[serde(default, with = "Optional::<Uneven>")]
    uneven: Option<f64>,
}

/// Run-out measurement: an indicator on the part while the table rotates.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Runout {
    /// Two different y of the indicator, mm.
    #[serde(with = "FixedArray::<PartHeight, 2>")]
    pub heights: [f64; 2],
    /// From, to, and the number of readings (3 to 100): degrees.
    #[serde(with = "Readings")]
    pub angles: Readings,
    /// The largest shift of the part in y that the fit accepts, mm.
    #[serde(default = "PartShift::default", with = "PartShift")]
    pub y_shift: f64,
}

/// Positions of the rotary at which the indicator is read.
#[derive(Clone, Copy, Debug, PartialEq, JsonSchema)]
#[schemars(with = "FixedArray::<ReadingAngle, 3>")]
pub struct Readings {
    /// Position at the first reading.
    pub from: f64,
    /// Position at the last reading.
    pub to: f64,
    /// Readings at each height, 3 to 100.
    pub count: u32,
}

impl FileKey for Readings {
    type Value = Self;

    fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let [from, to, count] = FixedArray::<ReadingAngle, 3>::deserialize(deserializer)?;
        let angles = [("from", from), ("to", to)];
        let wrong = if let Some((which, angle)) = angles.iter().find(|(_, a)| !ReadingAngle::contains(*a)) {
            format!("the angle {which} is {angle}: {}", ReadingAngle::allowed())
        } else if from >= to {
            format!("it runs from {from} to {to}: from must be less than to")
        } else if count.fract() != 0.0 || !ReadingCount::contains(count) {
            format!("the number of readings is {count}: {}", ReadingCount::allowed())
        } else {
            return Ok(Self { from, to, count: count as u32 });
        };
        Err(D::Error::custom(format!("{OUT_OF_RANGE}from, to and the number of readings; {wrong}")))
    }
}

/// The outline in the plane z = 0 that an edge finder follows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct FileEllipse {
    /// x of its start, mm [default: that of F].
    #[serde(default, with = "Optional::<Radius>")]
    from: Option<f64>,
    /// x of its end, mm [default: that of E].
    #[serde(default, with = "Optional::<Radius>")]
    to: Option<f64>,
    /// Tolerance of the ball position, mm: no less than the least increment [default: 0.002, or two
    /// increments].
    #[serde(default, with = "Optional::<ChordError>")]
    chord_error: Option<f64>,
    /// Feed, mm/min [default: 200].
    #[serde(default, with = "Optional::<PathFeed>")]
    feed: Option<f64>,
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

/// Tolerances of the set-up of a part.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct FileLimits {
    /// Tolerance of the shift in x and in z after the last run-out, mm [default: 0.025].
    #[serde(default, with = "Optional::<ShiftLimit>")]
    shift: Option<f64>,
    /// Tolerance of the tilt about x and about z after the last run-out, degrees [default: the tilt that alone
    /// gives `dial` on the ellipse, 0.001 to 0.1].
    #[serde(default, with = "Optional::<TiltLimit>")]
    tilt: Option<f64>,
    /// Tolerance of the dial reading along the ellipse, mm [default: 0.03].
    #[serde(default, with = "Optional::<ShiftLimit>")]
    dial: Option<f64>,
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

impl Alignment {
    /// Returns the standard deviation of a touch, mm.
    pub fn probe_noise(&self) -> f64 {
        self.probe.noise.unwrap_or(f64::max(0.002, self.control.increment.size()))
    }

    /// Returns the largest difference of the part's height over the model between two touched points, one at
    /// each end of the chord, mm.
    pub fn unevenness(&self) -> f64 {
        let Chord { e_radius, f_radius, uneven, .. } = self.chord;
        let left = (1.5e3 * chord_unevenness(self.surface, e_radius, f_radius)).ceil() / 1e3;
        uneven.unwrap_or(left.max(0.05))
    }

    /// Returns the path of the edge finder.
    pub fn ellipse(&self) -> EllipsePath {
        let FileEllipse { from, to, chord_error, feed } = self.ellipse;
        EllipsePath {
            from: from.unwrap_or(self.chord.f_radius),
            to: to.unwrap_or(self.chord.e_radius),
            chord_error: chord_error.unwrap_or(f64::max(0.002, 2.0 * self.control.increment.size())),
            feed: feed.unwrap_or(200.0),
        }
    }

    /// Returns the tolerances of the set-up. The defaults are those of *Improved Processing Technology of
    /// Positioning Pin Hole on Melon Mold*: 0.03 along the ellipse, and a run-out of 0.05, twice the shift.
    pub fn limits(&self) -> AlignmentLimits {
        let FileLimits { shift, tilt, dial } = self.limits;
        let dial = dial.unwrap_or(0.03);
        let tilt = tilt.unwrap_or_else(|| dial_tilt(dial, self.surface, self.ellipse()));
        AlignmentLimits { shift: shift.unwrap_or(0.025), tilt, dial }
    }
}

impl Family for Alignment {
    fn check(&mut self, reader: &Reader<'_>) -> Result<(), FileError> {
        self.machine.check(reader)?;
        self.check_chord(reader)?;
        self.sine_table.check(reader)?;
        self.check_runout(reader)?;
        let (increment, most) = (self.control.increment.size(), ChordError::MAX);
        let (path, noise) = (self.ellipse(), self.probe_noise());
        // The control records a touch no finer than its least increment.
        for (key, value) in [("probe.noise", noise), ("ellipse.chord_error", path.chord_error)] {
            let allowed = format_args!("{increment} (the least increment) to {most} mm");
            reader.check((increment..=most).contains(&value), key, value, allowed)?;
        }
        self.surface.check_radius(reader, "ellipse.from", path.from)?;
        self.surface.check_radius(reader, "ellipse.to", path.to)?;
        if path.from != path.to {
            return Ok(());
        }
        let message = format!(
            "the ellipse begins and ends at x = {} mm: 'ellipse.from' and 'ellipse.to' (by default F and E) must differ",
            path.from
        );
        Err(reader.error_at(if reader.has("ellipse.to") { "ellipse.to" } else { "ellipse.from" }, message))
    }
}

impl SineTable {
    fn check(&self, reader: &Reader<'_>) -> Result<(), FileError> {
        let Self { length, phi, gauge_blocks: set, .. } = self;
        let (height, most) = (gauge::height(Mm(*length), Deg(*phi)).0, set.total());
        let allowed =
            format_args!("all its blocks together are {most} mm high, L*sin(phi) is {height:.3} mm");
        let name = format_args!("'{}'", set.name);
        reader.check(height <= most.mm(), "sine_table.gauge_blocks", name, allowed)?;
        let setting = gauge::sine_setting(Mm(*length), Deg(*phi), set);
        let allowed = format_args!(
            "L*sin(phi) is {:.4} mm, lower than any stack of '{}'; put blocks under both rollers and choose \
             the phi of their difference, or 0",
            setting.height.0, set.name
        );
        reader.check(!setting.stack.blocks.is_empty() || *phi <= 0.0, "sine_table.phi", phi, allowed)
    }
}

impl Alignment {
    /// Checks that O8202 can touch the candidates: along y, each in its own circle, within the probe's
    /// search.
    fn check_chord(&self, reader: &Reader<'_>) -> Result<(), FileError> {
        let Chord { e_radius, f_radius, circle, .. } = self.chord;
        let (surface, search) = (self.surface, self.probe.search);
        surface.check_radius(reader, "chord.e_radius", e_radius)?;
        surface.check_radius(reader, "chord.f_radius", f_radius)?;
        if e_radius == f_radius {
            let message = format!(
                "key 'chord.f_radius' is {f_radius}, equal to e_radius: E and F need different values"
            );
            return Err(reader.error_at("chord.f_radius", message));
        }
        let apart = (e_radius - f_radius).abs();
        let allowed = format_args!("the circles round E and F, {apart:.3} mm apart in x, must not meet");
        reader.check(2.0 * circle < apart, "chord.circle", circle, allowed)?;
        let allowed = format_args!(
            "at most an eighth of 'probe.search', which is {search} mm, because the surface falls within \
             the circle"
        );
        reader.check(8.0 * circle <= search, "chord.circle", circle, allowed)?;
        for (key, x) in [("chord.e_radius", e_radius), ("chord.f_radius", f_radius)] {
            let (_, [_, up]) = surface.section(x);
            let allowed = format_args!(
                "the surface is at {:.1} degrees to y there, and less than {:.1} is too steep for a touch \
                 along y; choose it nearer to the pole",
                Deg::asin(up).0,
                Deg::asin(STEEP).0
            );
            reader.check(STEEP <= up, key, x, allowed)?;
        }
        Ok(())
    }

    fn check_runout(&self, reader: &Reader<'_>) -> Result<(), FileError> {
        let b = self.surface.b;
        let wrong = match self.runout.heights {
            [low, high] if low == high => Some(format!("both are {low}")),
            heights => heights.iter().find(|y| b <= y.abs() || y.is_nan()).map(|y| format!("{y} is not")),
        };
        if let Some(wrong) = wrong {
            let message = format!(
                "key 'runout.heights' needs two different y, each less than b = {b} mm from 0; {wrong}"
            );
            return Err(reader.error_at("runout.heights", message));
        }
        let Readings { from, to, .. } = self.runout.angles;
        if from > 0.0 || to < 0.0 {
            let message = format!(
                "key 'runout.angles' runs from {from} to {to}: it must include 0, because the chord and \
                 the ellipse are touched at B0; shift the work zero of the rotary so that 0 is on the petal"
            );
            return Err(reader.error_at("runout.angles", message));
        }
        Ok(())
    }
}

/// Returns the difference of the part's height over the model between E and F, mm, after a run-out with its
/// usual remainder.
///
/// The remainder is a tilt of 0.004° about z and a shift of 0.01 mm in x. At x they raise the part by δ·x·(1
/// − b²/a²) and by dx·(b²/a²)·x/y.
fn chord_unevenness(surface: SurfaceSpec, e: f64, f: f64) -> f64 {
    let squares = (surface.b * surface.b) / (surface.a * surface.a);
    let steepness = |x: f64| x / surface.section(x).0;
    Deg(0.004).to_rad() * ((e - f) * (1.0 - squares)).abs()
        + 0.01 * squares * (steepness(e) - steepness(f)).abs()
}

/// Returns the tilt about z, degrees, rounded down to thousandths, whose largest dial reading on the path is
/// `dial`. The dial reads δ·(x·n_y − y·n_x).
fn dial_tilt(dial: f64, surface: SurfaceSpec, path: EllipsePath) -> f64 {
    let arm = |x: f64| {
        let (y, [across, up]) = surface.section(x);
        (x * up - y * across).abs()
    };
    // A tilt of a sphere gives no reading.
    let tilt = Deg::from_rad(dial / arm(path.from).max(arm(path.to)).max(f64::MIN_POSITIVE)).0;
    ((tilt * 1e3).floor() / 1e3).clamp(0.001, 0.1)
}
