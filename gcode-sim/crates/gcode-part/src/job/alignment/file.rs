//! Reads the job file of the family `alignment`. Errors name the key and its line.
use schemars::JsonSchema;
use serde::Deserialize;

use super::ellipse::FileEllipse;
use super::limits::FileLimits;
use super::runout::FileRunout;
use super::{Alignment, Chord, SineTable};
use crate::gauge::{self, GaugeSet};
use crate::job::pin_holes::{FileMachine, FileSurface};
use crate::job::sections::{FileControl, in_range};
use crate::job::sheet::FileSheet;
use crate::job::{FileError, Reader, Surface};
use crate::reader::Spanned;
use crate::reader::bounds::{
    Bounded, Candidates, ChordError, KeyRange, Length, ProbeFeed, ProbeLength, Radius, Sign, SineTableAngle,
    SineTableLength, Uneven,
};
use gcode_lang::units::{Deg, Mm};

/// Least y component of the surface's normal at a point that O8202 touches along y.
const STEEP: f64 = 0.3;

/// Measurements of the position of a part on its machine.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::job) struct File {
    /// The kind of part, which decides the other keys.
    #[serde(rename = "family")]
    #[schemars(extend("enum" = ["alignment"]))]
    _family: String,
    /// The control of the programs.
    control: FileControl,
    /// The machine.
    machine: FileMachine,
    /// The surface that is measured.
    surface: FileSurface,
    /// The touch probe.
    probe: FileProbe,
    /// The table that sets the angle of the part's axis.
    sine_table: FileSineTable,
    /// The chord between two points of the surface.
    chord: FileChord,
    /// An indicator on the part while the table rotates.
    runout: FileRunout,
    /// The outline that an edge finder follows.
    #[serde(default)]
    ellipse: FileEllipse,
    /// Tolerances of the set-up of a part.
    #[serde(default)]
    limits: FileLimits,
    /// Additional data for the set-up sheet.
    sheet: Option<FileSheet>,
}

/// The touch probe.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct FileProbe {
    /// Of the stylus ball, mm.
    radius: Bounded<ProbeLength>,
    /// Of a touch, mm/min [default: 100].
    feed: Option<Bounded<ProbeFeed>>,
    /// Distance in front of and behind the nominal surface where a touch begins and ends, mm [default: 10].
    search: Option<Bounded<ProbeLength>>,
    /// Standard deviation of a touch, mm; not below the least increment [default: 0.002, or the increment].
    noise: Option<Bounded<ChordError>>,
}

/// The table that sets the angle of the part's axis.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct FileSineTable {
    /// Between the rollers, mm.
    length: Bounded<SineTableLength>,
    /// The angle, degrees.
    phi: Bounded<SineTableAngle>,
    /// The set of gauge blocks.
    #[schemars(extend("enum" = GaugeSet::ALL.map(|set| set.name)))]
    gauge_blocks: Spanned<String>,
    /// 1 if higher blocks rotate the part from x towards y, -1 if they rotate it back [default: 1].
    sign: Option<Sign>,
}

/// The chord between two points E and F of the surface in the plane z = 0.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct FileChord {
    /// x of E, mm: at most the equatorial radius.
    e_radius: Bounded<Radius>,
    /// x of F, mm, different from that of E.
    f_radius: Bounded<Radius>,
    /// Radius of the circle of candidates round each, mm.
    circle: Bounded<Length>,
    /// Number of candidates round each.
    candidates: Bounded<Candidates>,
    /// Largest difference of the part's height over the model between E and F, mm, if they were touched
    /// [default: 0.05, or 1.5 times what a part set right by the run-out leaves].
    uneven: Option<Bounded<Uneven>>,
}

/// Reads the text of a job of this family.
pub(in crate::job) fn parse(reader: &Reader<'_>) -> Result<Alignment, FileError> {
    let file: File = toml::from_str(reader.text).map_err(|e| reader.syntax(&e))?;
    let surface = file.surface.check(reader)?;
    let control = file.control.check(reader)?;
    let chord = file.chord.check(reader, surface)?;
    let probe = &file.probe;
    let probe_search = probe.search.as_ref().map_or(10.0, Bounded::get);
    file.chord.touchable(reader, surface, chord, probe_search)?;
    let (increment, most) = (control.increment.size(), ChordError::MAX);
    let ellipse = file.ellipse.check(reader, control, surface, chord)?;
    Ok(Alignment {
        control,
        machine: file.machine.check(reader)?,
        probe_radius: probe.radius.get(),
        probe_feed: probe.feed.as_ref().map_or(100.0, Bounded::get),
        probe_search,
        probe_noise: match &probe.noise {
            // The control records a touch no finer than its least increment.
            Some(noise) => {
                let allowed = format!("{increment} (the least increment) to {most} mm");
                reader.number("probe.noise", noise, &allowed, in_range(increment, most))?
            }
            None => f64::max(0.002, increment),
        },
        sine_table: file.sine_table.check(reader)?,
        chord,
        runout: file.runout.check(reader, surface)?,
        limits: file.limits.limits(surface, ellipse),
        ellipse,
        sheet: file.sheet.map(FileSheet::info).unwrap_or_default(),
        surface,
    })
}

impl FileSineTable {
    fn check(&self, reader: &Reader<'_>) -> Result<SineTable, FileError> {
        let sets = GaugeSet::ALL.map(|set| (set.name, set));
        let table = SineTable {
            length: self.length.get(),
            phi: self.phi.get(),
            gauge_blocks: reader.choice("sine_table.gauge_blocks", &self.gauge_blocks, &sets)?,
            sign: self.sign.as_ref().map_or(1, Sign::get),
        };
        let (height, most) = (gauge::height(Mm(table.length), Deg(table.phi)).0, table.gauge_blocks.total());
        if height > most.mm() {
            let message = format!(
                "key 'sine_table.gauge_blocks' is '{}': all its blocks together are {most} mm high, \
                 L*sin(phi) is {height:.3} mm",
                table.gauge_blocks.name
            );
            return Err(reader.error(&self.gauge_blocks, message));
        }
        let setting = gauge::sine_setting(Mm(table.length), Deg(table.phi), &table.gauge_blocks);
        if setting.stack.blocks.is_empty() && table.phi > 0.0 {
            let message = format!(
                "key 'sine_table.phi' is {}: L*sin(phi) is {:.4} mm, lower than any stack of '{}'; put \
                 blocks under both rollers and choose the phi of their difference, or 0",
                table.phi, setting.height.0, table.gauge_blocks.name
            );
            return Err(reader.error(&self.phi, message));
        }
        Ok(table)
    }
}

impl FileChord {
    fn check(&self, reader: &Reader<'_>, surface: Surface) -> Result<Chord, FileError> {
        let allowed = format!("0 to the equatorial radius a = {} mm", surface.a);
        let radius = |key: &str, value| reader.number(key, value, &allowed, in_range(0.0, surface.a));
        let e_radius = radius("chord.e_radius", &self.e_radius)?;
        let f_radius = radius("chord.f_radius", &self.f_radius)?;
        if e_radius == f_radius {
            let message = format!(
                "key 'chord.f_radius' is {f_radius}, equal to e_radius: E and F need different values"
            );
            return Err(reader.error(&self.f_radius, message));
        }
        let left = || f64::max(0.05, (1.5e3 * chord_unevenness(surface, e_radius, f_radius)).ceil() / 1e3);
        Ok(Chord {
            e_radius,
            f_radius,
            circle: self.circle.get(),
            candidates: self.candidates.get() as u32,
            uneven: self.uneven.as_ref().map_or_else(left, Bounded::get),
        })
    }
}

/// Returns the difference of the part's height over the model between E and F, mm, after a run-out with its
/// usual remainder.
///
/// The remainder is a tilt of 0.004° about z and a shift of 0.01 mm in x. At x they raise the part by δ·x·(1
/// − b²/a²) and by dx·(b²/a²)·x/y.
fn chord_unevenness(surface: Surface, e: f64, f: f64) -> f64 {
    let Surface { a, b } = surface;
    let squares = (b * b) / (a * a);
    let steepness = |x: f64| x / (b * (1.0 - (x / a) * (x / a)).sqrt());
    Deg(0.004).to_rad() * ((e - f) * (1.0 - squares)).abs()
        + 0.01 * squares * (steepness(e) - steepness(f)).abs()
}

impl FileChord {
    /// Checks that O8202 can touch the candidates: along y, each in its own circle, within the probe's
    /// search.
    fn touchable(
        &self,
        reader: &Reader<'_>,
        surface: Surface,
        chord: Chord,
        search: f64,
    ) -> Result<(), FileError> {
        let Chord { e_radius, f_radius, circle, .. } = chord;
        if (e_radius - f_radius).abs() <= 2.0 * circle {
            let message = format!(
                "key 'chord.circle' is {circle}: the circles round E and F, {:.3} mm apart in x, must not meet",
                (e_radius - f_radius).abs()
            );
            return Err(reader.error(&self.circle, message));
        }
        if search < 8.0 * circle {
            let message = format!(
                "key 'chord.circle' is {circle}: at most an eighth of 'probe.search', which is {search} \
                 mm, because the surface falls within the circle"
            );
            return Err(reader.error(&self.circle, message));
        }
        for (key, value, x) in
            [("chord.e_radius", &self.e_radius, e_radius), ("chord.f_radius", &self.f_radius, f_radius)]
        {
            let y = surface.b * (1.0 - (x / surface.a) * (x / surface.a)).sqrt();
            let (across, up) = (x / (surface.a * surface.a), y / (surface.b * surface.b));
            let part = up / (across * across + up * up).sqrt();
            if part < STEEP {
                let message = format!(
                    "key '{key}' is {x}: the surface is at {:.1} degrees to y there, and less than {:.1} \
                     is too steep for a touch along y; choose it nearer to the pole",
                    Deg::asin(part).0,
                    Deg::asin(STEEP).0
                );
                return Err(reader.error(value, message));
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use crate::job::Job;

    const JOB: &str = r#"family = "alignment"
[control]
dialect = "fanuc-31i"
increment = "IS-B"
[machine]
rotary = { letter = "B", sign = 1 }
[surface]
kind = "ellipsoid"
a = 1158.8
b = 724.3
[probe]
radius = 3.0
[sine_table]
length = 200.0
phi = 38.5
gauge_blocks = "metric-87"
[chord]
e_radius = 812.4
f_radius = 318.0
circle = 1.0
candidates = 10
[runout]
heights = [150.0, 420.0]
angles = [-25.0, 25.0, 11]
"#;

    #[test]
    fn everything_a_job_says_is_read() {
        let Ok(Job::Alignment(job)) = Job::parse(JOB) else { panic!("no alignment: {JOB}") };
        assert_eq!((job.probe_feed, job.probe_search), (100.0, 10.0));
        assert_eq!((job.probe_radius, job.surface.b, job.sine_table.phi), (3.0, 724.3, 38.5));
        assert_eq!((job.sine_table.length, job.sine_table.gauge_blocks.name), (200.0, "metric-87"));
        assert_eq!((job.chord.e_radius, job.chord.candidates, job.chord.uneven), (812.4, 10, 0.05));
        assert_eq!((job.runout.heights, job.runout.readings), ([150.0, 420.0], 11));
        assert_eq!((job.runout.from, job.runout.to), (-25.0, 25.0));
    }

    /// A slender part, a 700 and b 1500: for E at 512.4 and F at 318 the tilt gives 0.004° in rad·194.4·3.592
    /// = 0.048 75, and the shift 0.01·4.592·(512.4/1021.93 − 318/1336.25) = 0.012 10: 1.5 times both is
    /// 0.0913.
    #[test]
    fn a_slender_part_may_be_as_uneven_as_the_run_out_leaves_it() {
        let text = JOB
            .replace("a = 1158.8", "a = 700.0")
            .replace("b = 724.3", "b = 1500.0")
            .replace("812.4", "512.4");
        let Ok(Job::Alignment(job)) = Job::parse(&text) else { panic!("{text}") };
        assert_eq!(job.chord.uneven, 0.092);
    }

    #[test]
    fn what_cannot_be_used_is_named_with_its_line() {
        for (from, to, message) in [
            ("[probe]\nradius = 3.0\n", "", "key 'probe' is missing"),
            ("radius = 3.0", "radius = 0", "line 12: key 'probe.radius' is 0: 0.01 to 1000 mm"),
            (
                "radius = 3.0",
                "diameter = 6",
                "line 12: key 'probe.diameter' is unknown; allowed: radius, feed, search, noise",
            ),
            ("phi = 38.5", "phi = 46", "line 15: key 'sine_table.phi' is 46: 0 to 45 degrees"),
            ("length = 200.0", "sign = 2\nlength = 200.0", "line 14: key 'sine_table.sign' is 2: 1 or -1"),
            ("length = 200.0", "length = 5", "line 14: key 'sine_table.length' is 5: 10 to 2000 mm"),
            (
                "metric-87",
                "metric-86",
                "line 16: key 'sine_table.gauge_blocks' is 'metric-86': one of metric-32, metric-38, metric-46, metric-47, \
                 metric-76, metric-83, metric-87, metric-88, metric-91, metric-103, metric-112",
            ),
            (
                "length = 200.0\nphi = 38.5\ngauge_blocks = \"metric-87\"",
                "length = 500.0\nphi = 45.0\ngauge_blocks = \"metric-32\"",
                "line 16: key 'sine_table.gauge_blocks' is 'metric-32': all its blocks together are \
                 188.955 mm high, L*sin(phi) is 353.553 mm",
            ),
            ("candidates = 10", "candidates = 11", "line 21: key 'chord.candidates' is 11: 1 to 10"),
            ("[runout]", "uneven = 0\n[runout]", "line 22: key 'chord.uneven' is 0: 0.001 to 100 mm"),
            (
                "e_radius = 812.4",
                "e_radius = 318",
                "line 19: key 'chord.f_radius' is 318, equal to e_radius: E and F need different values",
            ),
            ("radius = 3.0", "radius = 3.0\nfeed = 0", "line 13: key 'probe.feed' is 0: 0.01 to 1000 mm/min"),
            (
                "e_radius = 812.4",
                "e_radius = 1200.0",
                "line 18: key 'chord.e_radius' is 1200: 0 to the equatorial radius a = 1158.8 mm",
            ),
            (
                "circle = 1.0",
                "circle = 2.0",
                "line 20: key 'chord.circle' is 2: at most an eighth of 'probe.search', which is 10 mm, \
                 because the surface falls within the circle",
            ),
            (
                "f_radius = 318.0",
                "f_radius = 811.0",
                "line 20: key 'chord.circle' is 1: the circles round E and F, 1.400 mm apart in x, must not meet",
            ),
            // y = 129.939, tan = (y/b²)/(x/a²) = 0.29176.
            (
                "e_radius = 812.4",
                "e_radius = 1140.0",
                "line 18: key 'chord.e_radius' is 1140: the surface is at 16.3 degrees to y there, and \
                 less than 17.5 is too steep for a touch along y; choose it nearer to the pole",
            ),
            (
                "radius = 3.0",
                "radius = 3.0\nnoise = 0.0005",
                "line 13: key 'probe.noise' is 0.0005: 0.001 (the least increment) to 1 mm",
            ),
            ("[runout]", "[runout]\ny_shift = 0", "line 23: key 'runout.y_shift' is 0: 0.01 to 100 mm"),
            (
                "[150.0, 420.0]",
                "[150.0]",
                "line 23: key 'runout.heights' needs two different y, each less than b = 724.3 mm from 0; it has 1",
            ),
            (
                "[150.0, 420.0]",
                "[150.0, 150.0]",
                "line 23: key 'runout.heights' needs two different y, each less than b = 724.3 mm from 0; \
                 both are 150",
            ),
            (
                "[150.0, 420.0]",
                "[150.0, -800.0]",
                "line 23: key 'runout.heights' needs two different y, each less than b = 724.3 mm from 0; -800 is not",
            ),
            (
                "phi = 38.5",
                "phi = 0.01",
                "line 15: key 'sine_table.phi' is 0.01: L*sin(phi) is 0.0349 mm, lower than any stack of \
                 'metric-87'; put blocks under both rollers and choose the phi of their difference, or 0",
            ),
            (
                "[-25.0, 25.0",
                "[10.0, 60.0",
                "line 24: key 'runout.angles' runs from 10 to 60: it must include 0, because the chord and \
                 the ellipse are touched at B0; shift the work zero of the rotary so that 0 is on the petal",
            ),
            (
                "[-25.0, 25.0",
                "[-60.0, -0.5",
                "line 24: key 'runout.angles' runs from -60 to -0.5: it must include 0, because the chord \
                 and the ellipse are touched at B0; shift the work zero of the rotary so that 0 is on the \
                 petal",
            ),
            (
                "25.0, 11]",
                "25.0, 2]",
                "line 24: key 'runout.angles' is from, to and the number of readings; the number of \
                 readings is 2: a whole number, 3 to 100",
            ),
            (
                "25.0, 11]",
                "25.0, 10.5]",
                "line 24: key 'runout.angles' is from, to and the number of readings; the number of \
                 readings is 10.5: a whole number, 3 to 100",
            ),
            (
                "[-25.0, 25.0",
                "[25.0, -25.0",
                "line 24: key 'runout.angles' is from, to and the number of readings; it runs from 25 to \
                 -25: from must be less than to",
            ),
            (
                "[-25.0, 25.0",
                "[-25.0, 365.0",
                "line 24: key 'runout.angles' is from, to and the number of readings; the angle to is 365: \
                 -360 to 360 degrees",
            ),
        ] {
            let text = JOB.replacen(from, to, 1);
            assert_ne!(text, JOB, "{from}");
            let told = Job::parse(&text).unwrap_err().to_string();
            assert!(told.ends_with(message), "{told}\n{message}");
        }
    }
}
