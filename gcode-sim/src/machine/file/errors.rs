//! Errors as a file names them: the `[errors]` of a machine file, and the error file of a budget.
use serde::Deserialize;
use toml::Spanned;

use super::spread::{ANGLE, FileSpread, FileVector, Kind, LENGTH};
use crate::job::JobError;
use crate::job::reader::Reader;
use crate::machine::sources::{Drawn, Quantity, Source};
use crate::machine::{HeadKind, Machine};
use crate::motion::Axis;

/// The set-up of the part.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FilePart {
    shift: Option<FileVector>,
    tilt: Option<FileVector>,
    runout: Option<Spanned<FileSpread>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FileLinear {
    x: Option<Spanned<FileSpread>>,
    y: Option<Spanned<FileSpread>>,
    z: Option<Spanned<FileSpread>>,
    wave: Option<Spanned<f64>>,
    seed: Option<Spanned<u64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FileRotary {
    index: Option<Spanned<FileSpread>>,
    centre: Option<FileVector>,
    tilt: Option<FileVector>,
    seed: Option<Spanned<u64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FileHead {
    angle: Option<Spanned<FileSpread>>,
    seed: Option<Spanned<u64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FileProbe {
    noise: Option<Spanned<FileSpread>>,
    seed: Option<Spanned<u64>>,
}

/// The machine file's `[errors]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FileErrors {
    linear: Option<FileLinear>,
    rotary: Option<FileRotary>,
    head: Option<FileHead>,
    probe: Option<FileProbe>,
}

/// The error file of a budget.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    part: Option<FilePart>,
    linear: Option<FileLinear>,
    rotary: Option<FileRotary>,
    head: Option<FileHead>,
}

/// Collects sources, and checks that the machine has what they are about.
struct Collector<'r, 'm> {
    reader: &'r Reader<'r>,
    machine: &'m Machine,
    /// `errors.` in a machine file.
    before: &'static str,
    found: Vec<Source>,
}

impl Collector<'_, '_> {
    fn one(
        &mut self,
        key: &str,
        spread: &Option<Spanned<FileSpread>>,
        quantity: Quantity,
        kind: Kind,
    ) -> Result<(), JobError> {
        let Some(spread) = spread else { return Ok(()) };
        let key = format!("{}{key}", self.before);
        let spread_checked = spread.as_ref().check(self.reader, &key, spread.span().start, kind)?;
        if let Some(lacking) = self.lacking(quantity) {
            return Err(self.reader.error(spread, format!("key '{key}': {lacking}")));
        }
        self.found.push(Source { quantity, spread: spread_checked });
        Ok(())
    }

    fn vector(
        &mut self,
        key: &str,
        vector: &Option<FileVector>,
        quantity: impl Fn(usize) -> Quantity,
        kind: Kind,
    ) -> Result<(), JobError> {
        let Some(vector) = vector else { return Ok(()) };
        for (direction, spread) in [&vector.x, &vector.y, &vector.z].into_iter().enumerate() {
            let letter = ["x", "y", "z"][direction];
            self.one(&format!("{key}.{letter}"), spread, quantity(direction), kind)?;
        }
        Ok(())
    }

    fn part(&mut self, part: &FilePart) -> Result<(), JobError> {
        self.vector("part.shift", &part.shift, Quantity::Shift, LENGTH)?;
        self.vector("part.tilt", &part.tilt, Quantity::Tilt, ANGLE)?;
        self.one("part.runout", &part.runout, Quantity::RunOut, LENGTH)
    }

    fn linear(&mut self, linear: &FileLinear) -> Result<(), JobError> {
        for (letter, spread) in [(b'X', &linear.x), (b'Y', &linear.y), (b'Z', &linear.z)] {
            let Some(written) = spread else { continue };
            let name = char::from(letter).to_ascii_lowercase();
            let axis: Option<Axis> =
                self.machine.axes.find(letter).filter(|axis| self.machine.carries(*axis));
            let Some(axis) = axis else {
                let message =
                    format!("key '{}linear.{name}': no such axis moves the tool or the part", self.before);
                return Err(self.reader.error(written, message));
            };
            self.one(&format!("linear.{name}"), spread, Quantity::Linear(axis), LENGTH)?;
        }
        Ok(())
    }

    fn rotary(&mut self, rotary: &FileRotary) -> Result<(), JobError> {
        self.one("rotary.index", &rotary.index, Quantity::Index, ANGLE)?;
        self.vector("rotary.centre", &rotary.centre, Quantity::Centre, LENGTH)?;
        self.vector("rotary.tilt", &rotary.tilt, Quantity::AxisTilt, ANGLE)
    }

    fn head(&mut self, head: &FileHead) -> Result<(), JobError> {
        self.one("head.angle", &head.angle, Quantity::Head, ANGLE)
    }

    /// What an error needs that the machine hasn't got.
    fn lacking(&self, quantity: Quantity) -> Option<&'static str> {
        match quantity {
            Quantity::RunOut | Quantity::Index | Quantity::Centre(_) | Quantity::AxisTilt(_) => {
                let one = self.machine.rotary_axis().is_some();
                (!one).then_some("needs one axis that turns the part; this machine has none, or several")
            }
            Quantity::Head => {
                let turns = matches!(self.machine.head.kind, HeadKind::Manual { .. } | HeadKind::Axis { .. });
                (!turns).then_some("needs a [head] of kind manual or axis")
            }
            Quantity::Shift(_) | Quantity::Tilt(_) | Quantity::Linear(_) => None,
        }
    }
}

fn seed(seed: &Option<Spanned<u64>>) -> u64 {
    seed.as_ref().map_or(0, |seed| *seed.as_ref())
}

impl FileErrors {
    /// Draws the errors and puts them into the machine.
    pub(super) fn apply(&self, reader: &Reader<'_>, machine: &mut Machine) -> Result<(), JobError> {
        let nominal = machine.clone();
        let collect = || Collector { reader, machine: &nominal, before: "errors.", found: Vec::new() };
        let mut all: Vec<(Source, Drawn)> = Vec::new();
        let mut keep = |found: Vec<Source>, seed: u64, wave: f64| {
            all.extend(found.into_iter().map(|source| (source, Drawn { seed, wave })));
        };
        if let Some(linear) = &self.linear {
            let mut collector = collect();
            collector.linear(linear)?;
            let wave = match &linear.wave {
                Some(wave) => reader.number("errors.linear.wave", wave, "mm, 1 to 100000", |v| {
                    (1.0..=100_000.0).contains(&v)
                })?,
                None => 500.0,
            };
            keep(collector.found, seed(&linear.seed), wave);
        }
        if let Some(rotary) = &self.rotary {
            let mut collector = collect();
            collector.rotary(rotary)?;
            keep(collector.found, seed(&rotary.seed), 360.0);
        }
        if let Some(head) = &self.head {
            let mut collector = collect();
            collector.head(head)?;
            keep(collector.found, seed(&head.seed), 360.0);
        }
        for (source, drawn) in all {
            source.realize(machine, drawn);
        }
        self.probe(reader, machine)
    }

    fn probe(&self, reader: &Reader<'_>, machine: &mut Machine) -> Result<(), JobError> {
        let Some(FileProbe { noise: Some(noise), seed: drawn }) = &self.probe else { return Ok(()) };
        let key = "errors.probe.noise";
        let spread = noise.as_ref().check(reader, key, noise.span().start, LENGTH)?;
        let Some(probe) = &mut machine.probe else {
            return Err(reader.error(noise, format!("key '{key}' needs a [probe]")));
        };
        (probe.noise, probe.seed) = (spread, seed(drawn));
        Ok(())
    }
}

/// Reads the error file of a budget for this machine.
pub fn error_file(text: &str, machine: &Machine) -> Result<Vec<Source>, JobError> {
    let reader = Reader { text };
    let file: File = toml::from_str(text).map_err(|e| reader.syntax(&e))?;
    let mut collector = Collector { reader: &reader, machine, before: "", found: Vec::new() };
    if let Some(part) = &file.part {
        collector.part(part)?;
    }
    if let Some(linear) = &file.linear {
        collector.linear(linear)?;
        if let Some(wave) = &linear.wave {
            let message = "key 'linear.wave' goes into a machine file: a budget draws each hole anew";
            return Err(reader.error(wave, message));
        }
    }
    if let Some(rotary) = &file.rotary {
        collector.rotary(rotary)?;
    }
    if let Some(head) = &file.head {
        collector.head(head)?;
    }
    let linear = file.linear.as_ref().and_then(|linear| linear.seed.as_ref());
    let rotary = file.rotary.as_ref().and_then(|rotary| rotary.seed.as_ref());
    let head = file.head.as_ref().and_then(|head| head.seed.as_ref());
    if let Some(seed) = linear.or(rotary).or(head) {
        return Err(reader.error(seed, "key 'seed' goes into a machine file: a budget has --seed"));
    }
    Ok(collector.found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machine::error::Spread;
    use crate::motion::Position;

    #[test]
    fn every_error_of_a_machine_file_reaches_the_machine() {
        let text = r#"
[head]
kind = "manual"
[probe]
radius = 3.0
[errors.linear]
x = { fixed = 0.02 }
y = { uniform = 0.01 }
wave = 400
seed = 4
[errors.rotary]
index = { fixed = -0.001 }
centre.x = { fixed = 0.3 }
tilt.z = { fixed = 0.1 }
[errors.head]
angle = { normal = 0.05 }
seed = 9
[errors.probe]
noise = { normal = 0.001 }
seed = 2
"#;
        let machine = Machine::parse(text).unwrap();
        assert_eq!(machine, Machine::parse(text).unwrap(), "the same file is the same machine");
        assert_eq!(machine.slides.0[0].error.at(77.0), 0.02);
        assert_eq!(machine.slides.0[1].error.length, 400.0);
        assert_eq!(machine.slides.0[2].error.at(1.0), 0.0);
        assert_eq!(machine.table.0[0].error.at(12.0), -0.001);
        let mut at = Position::default();
        at[4] = 90.001;
        let origin = machine.part_frame(&at) * nalgebra::Point3::origin();
        // About (0.3, 0, 0), the axis leaning by 0.1° to −x: from there the origin is −0.3 away in x.
        let (s, c) = (crate::units::Deg(0.1).sin(), crate::units::Deg(0.1).cos());
        let along = 0.3 * s;
        assert!(
            (origin - nalgebra::Point3::new(0.3 - along * s, along * c, 0.3 * c)).norm() < 1e-12,
            "{origin}"
        );
        assert!(machine.head.error.swing > 0.0);
        let probe = machine.probe.unwrap();
        assert_eq!((probe.noise, probe.seed), (Spread::Normal(0.001), 2));
        let other = Machine::parse(&text.replace("seed = 9", "seed = 10")).unwrap();
        assert_ne!(machine.head.error, other.head.error);
        assert_eq!(machine.slides, other.slides);
    }

    #[test]
    fn what_cannot_be_used_is_named_with_its_line() {
        let machine = |text: &str| Machine::parse(text).unwrap_err().to_string();
        let budget = |text: &str| error_file(text, &Machine::default()).unwrap_err().to_string();
        assert_eq!(
            machine("[errors.linear]\nx = { normal = -0.1 }\n"),
            "line 2: key 'errors.linear.x.normal' is -0.1: mm, 100 at most"
        );
        assert_eq!(
            machine("[errors.linear]\n\nx = { normal = 0.1, fixed = 1 }\n"),
            "line 3: key 'errors.linear.x' has one of normal (standard deviation), uniform (plus and minus), fixed"
        );
        assert_eq!(
            machine("[errors.part]\nrunout = { normal = 1 }\n"),
            "line 1: key 'errors.part' is not known; allowed: linear, rotary, head, probe"
        );
        assert_eq!(
            machine("[errors.head]\nangle = { normal = 1 }\n"),
            "line 2: key 'errors.head.angle': needs a [head] of kind manual or axis"
        );
        assert_eq!(
            machine("[errors.probe]\nnoise = { normal = 1 }\n"),
            "line 2: key 'errors.probe.noise' needs a [probe]"
        );
        assert_eq!(
            machine("table = []\n[errors.rotary]\nindex = { normal = 1 }\n"),
            "line 3: key 'errors.rotary.index': needs one axis that turns the part; this machine has none, or several"
        );
        assert_eq!(
            budget("[linear]\nx = { normal = 0.1 }\nseed = 3\n"),
            "line 3: key 'seed' goes into a machine file: a budget has --seed"
        );
        assert_eq!(
            budget("[part]\ntilt.z = { normal = 46 }\n"),
            "line 2: key 'part.tilt.z.normal' is 46: degrees, 45 at most"
        );
    }

    #[test]
    fn a_budget_reads_what_the_set_up_and_the_machine_are_off_by() {
        let text = "[part]\nrunout = { uniform = 0.15 }\nshift.z = { normal = 0.03 }\n[rotary]\nindex = { fixed = 0.001 }\n";
        let found = error_file(text, &Machine::default()).unwrap();
        let names: Vec<_> = found.iter().map(|source| source.quantity.name(&Machine::default())).collect();
        assert_eq!(names, ["part.shift.z", "part.runout", "rotary.index"]);
        assert_eq!(found[0].spread, Spread::Normal(0.03));
    }
}
