//! Errors in files: the `[errors]` of a machine file, and the error file of a budget.
use schemars::{JsonSchema, Schema};
use serde::Deserialize;
use serde_json::Value;

use super::sections::{Collector, FileHead, FileLinear, FilePart, FileRotary};
use super::spread::{FileSpread, LENGTH};
use crate::machine::Machine;
use crate::machine::sources::{ErrorSource, SampleParameters};
use gcode_part::reader::FileError;
use gcode_part::reader::bounds::Bounded;
use gcode_part::reader::{Reader, Spanned};

/// Of a touch probe.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct FileProbe {
    /// Error of each touch along its direction, mm.
    #[schemars(transform = LENGTH.bounds())]
    noise: Option<Spanned<FileSpread>>,
    /// Seed of the random numbers [default: 0].
    seed: Option<Spanned<u64>>,
}

/// The machine file's `[errors]`.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct FileErrors {
    /// Of the linear axes.
    linear: Option<FileLinear>,
    /// Of the axis that rotates the part.
    rotary: Option<FileRotary>,
    /// Of a head of kind manual or axis.
    head: Option<FileHead>,
    /// Of a touch probe.
    probe: Option<FileProbe>,
}

/// Set-up and machine errors, from which a budget draws each simulated part.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct File {
    /// Of the set-up of the part.
    part: Option<FilePart>,
    /// Of the linear axes.
    #[schemars(transform = without_draws)]
    linear: Option<FileLinear>,
    /// Of the axis that rotates the part.
    #[schemars(transform = without_draws)]
    rotary: Option<FileRotary>,
    /// Of a head of kind manual or axis.
    #[schemars(transform = without_draws)]
    head: Option<FileHead>,
}

/// Removes the keys that only a machine file needs, whose errors are drawn once when it is read.
fn without_draws(schema: &mut Schema) {
    let keys = schema.get_mut("properties").and_then(Value::as_object_mut);
    keys.into_iter().for_each(|keys| keys.retain(|key, _| !["wave", "seed"].contains(&key.as_str())));
}

fn seed(seed: &Option<Spanned<u64>>) -> u64 {
    seed.as_ref().map_or(0, |seed| *seed.as_ref())
}

impl FileErrors {
    /// Draws the errors and adds them to the machine.
    pub(super) fn apply(&self, reader: &Reader<'_>, machine: &mut Machine) -> Result<(), FileError> {
        let nominal = machine.clone();
        let collect = || Collector { reader, machine: &nominal, prefix: "errors.", sources: Vec::new() };
        let mut all: Vec<(ErrorSource, SampleParameters)> = Vec::new();
        let mut keep = |found: Vec<ErrorSource>, seed: u64, wave: f64| {
            all.extend(found.into_iter().map(|source| (source, SampleParameters { seed, wave })));
        };
        if let Some(linear) = &self.linear {
            let mut collector = collect();
            collector.linear(linear)?;
            let wave = linear.wave.as_ref().map_or(500.0, Bounded::get);
            keep(collector.sources, seed(&linear.seed), wave);
        }
        if let Some(rotary) = &self.rotary {
            let mut collector = collect();
            collector.rotary(rotary)?;
            keep(collector.sources, seed(&rotary.seed), 360.0);
        }
        if let Some(head) = &self.head {
            let mut collector = collect();
            collector.head(head)?;
            keep(collector.sources, seed(&head.seed), 360.0);
        }
        for (source, drawn) in all {
            source.apply_by_position(machine, drawn);
        }
        self.probe(reader, machine)
    }

    fn probe(&self, reader: &Reader<'_>, machine: &mut Machine) -> Result<(), FileError> {
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

/// Parses the error file of a budget for this machine.
///
/// # Errors
/// Keys that are unknown, out of range, for a machine file only, or about a part that the machine lacks.
pub fn error_file(text: &str, machine: &Machine) -> Result<Vec<ErrorSource>, FileError> {
    let reader = Reader { text };
    let file: File = toml::from_str(text).map_err(|e| reader.syntax(&e))?;
    let mut collector = Collector { reader: &reader, machine, prefix: "", sources: Vec::new() };
    if let Some(part) = &file.part {
        collector.part(part)?;
    }
    if let Some(linear) = &file.linear {
        collector.linear(linear)?;
        if let Some(wave) = &linear.wave {
            let message = "key 'linear.wave' is for a machine file: a budget draws each hole anew";
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
        return Err(reader.error(seed, "key 'seed' is for a machine file: a budget has --seed"));
    }
    Ok(collector.sources)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machine::error::Distribution;
    use gcode_lang::motion::Position;

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
        assert_eq!(machine.slides.0[0].error.value_at(77.0), 0.02);
        assert_eq!(machine.slides.0[1].error.period, 400.0);
        assert_eq!(machine.slides.0[2].error.value_at(1.0), 0.0);
        assert_eq!(machine.table.0[0].error.value_at(12.0), -0.001);
        let mut at = Position::default();
        at[4] = 90.001;
        let origin = machine.part_frame(&at) * nalgebra::Point3::origin();
        // About (0.3, 0, 0), the axis tilted by 0.1° to −x: from there the origin is −0.3 away in x.
        let (s, c) = (gcode_lang::units::Deg(0.1).sin(), gcode_lang::units::Deg(0.1).cos());
        let along = 0.3 * s;
        assert!(
            (origin - nalgebra::Point3::new(0.3 - along * s, along * c, 0.3 * c)).norm() < 1e-12,
            "{origin}"
        );
        assert!(machine.head.error.amplitude > 0.0);
        let probe = machine.probe.unwrap();
        assert_eq!((probe.noise, probe.seed), (Distribution::Normal(0.001), 2));
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
            "line 3: key 'errors.linear.x' needs one of normal (standard deviation), uniform (plus and minus), fixed"
        );
        assert_eq!(
            machine("[errors.part]\nrunout = { normal = 1 }\n"),
            "line 1: key 'errors.part' is unknown; allowed: linear, rotary, head, probe"
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
            "line 3: key 'errors.rotary.index': needs exactly one axis that rotates the part; this machine \
             has none, or several"
        );
        assert_eq!(
            budget("[linear]\nx = { normal = 0.1 }\nseed = 3\n"),
            "line 3: key 'seed' is for a machine file: a budget has --seed"
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
        assert_eq!(found[0].distribution, Distribution::Normal(0.03));
    }
}
