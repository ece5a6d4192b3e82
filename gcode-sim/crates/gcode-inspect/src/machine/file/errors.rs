//! Errors in files: the `[errors]` of a machine file, and the error file of a budget.
use schemars::{JsonSchema, Schema};
use serde::Deserialize;
use serde_json::Value;

use super::sections::{Collector, FileHead, FileLinear, FilePart, FileRotary, seed};
use super::spread::{ErrorSpread, Length};
use crate::machine::{ErrorSource, Machine};
use gcode_part::reader::FileError;
use gcode_part::reader::bounds::Bounded;
use gcode_part::reader::{FileKey, Optional, Reader, Section, Spanned};

/// Errors of a touch probe.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct FileProbe {
    /// Error of each touch along its direction, mm.
    noise: Option<Bounded<ErrorSpread<Length>>>,
    /// Seed of the random numbers [default: 0].
    seed: Option<Spanned<u64>>,
}

/// The machine file's `[errors]`.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct FileErrors {
    /// Errors of the linear axes.
    #[serde(default, with = "Optional::<Section<FileLinear>>")]
    linear: Option<FileLinear>,
    /// Errors of the axis that rotates the part.
    #[serde(default, with = "Optional::<Section<FileRotary>>")]
    rotary: Option<FileRotary>,
    /// Errors of a head of kind manual or axis.
    #[serde(default, with = "Optional::<Section<FileHead>>")]
    head: Option<FileHead>,
    /// Errors of a touch probe.
    #[serde(default, with = "Optional::<Section<FileProbe>>")]
    probe: Option<FileProbe>,
}

/// Set-up and machine errors, from which a budget draws each simulated part.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct File {
    /// Errors of the set-up of the part.
    #[serde(default, with = "Optional::<Section<FilePart>>")]
    part: Option<FilePart>,
    /// Errors of the linear axes.
    #[serde(default, with = "Optional::<Section<FileLinear>>")]
    #[schemars(transform = without_draws)]
    linear: Option<FileLinear>,
    /// Errors of the axis that rotates the part.
    #[serde(default, with = "Optional::<Section<FileRotary>>")]
    #[schemars(transform = without_draws)]
    rotary: Option<FileRotary>,
    /// Errors of a head of kind manual or axis.
    #[serde(default, with = "Optional::<Section<FileHead>>")]
    #[schemars(transform = without_draws)]
    head: Option<FileHead>,
}

/// Removes the keys that only a machine file needs, whose errors are drawn once when it is read.
fn without_draws(schema: &mut Schema) {
    let keys = schema.get_mut("properties").and_then(Value::as_object_mut);
    keys.into_iter().for_each(|keys| keys.retain(|key, _| !["wave", "seed"].contains(&key.as_str())));
}

impl FileErrors {
    /// Draws the errors and adds them to the machine.
    pub(super) fn apply(&self, reader: &Reader<'_>, machine: &mut Machine) -> Result<(), FileError> {
        let nominal = machine.clone();
        let mut collector = Collector::new(reader, &nominal, "errors.");
        collector.linear(self.linear.as_ref())?;
        collector.rotary(self.rotary.as_ref())?;
        collector.head(self.head.as_ref())?;
        for (source, parameters) in collector.sources {
            source.apply_by_position(machine, parameters);
        }
        self.probe(reader, machine)
    }

    fn probe(&self, reader: &Reader<'_>, machine: &mut Machine) -> Result<(), FileError> {
        let Some(FileProbe { noise: Some(noise), seed: drawn }) = &self.probe else { return Ok(()) };
        let key = "errors.probe.noise";
        let Some(probe) = &mut machine.probe else {
            return Err(reader.error(noise, format!("key '{key}' needs a [probe]")));
        };
        (probe.noise, probe.seed) = (noise.get(), seed(drawn));
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
    let mut collector = Collector::new(&reader, machine, "");
    collector.part(file.part.as_ref())?;
    collector.linear(file.linear.as_ref())?;
    if let Some(wave) = file.linear.as_ref().and_then(|linear| linear.wave.as_ref()) {
        let message = "key 'linear.wave' is for a machine file: a budget draws each hole anew";
        return Err(reader.error(wave, message));
    }
    collector.rotary(file.rotary.as_ref())?;
    collector.head(file.head.as_ref())?;
    let linear = file.linear.as_ref().and_then(|linear| linear.seed.as_ref());
    let rotary = file.rotary.as_ref().and_then(|rotary| rotary.seed.as_ref());
    let head = file.head.as_ref().and_then(|head| head.seed.as_ref());
    if let Some(seed) = linear.or(rotary).or(head) {
        return Err(reader.error(seed, "key 'seed' is for a machine file: a budget has --seed"));
    }
    Ok(collector.sources.into_iter().map(|(source, _)| source).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machine::Distribution;
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
    fn an_unusable_key_is_named_with_its_line() {
        let machine = r#"
[errors.linear]
x = { normal = -0.1 }
=> line 2: key 'errors.linear.x.normal' is -0.1: 0 to 100 mm

[errors.linear]
x = { normal = 0.1, fixed = 1 }
=> line 2: key 'errors.linear.x' is not one distribution: one of normal (standard deviation), uniform (plus and minus), fixed

[errors.linear]
x.normal = 0.1
x.fixed = 1
=> line 2: key 'errors.linear.x' is not one distribution: one of normal (standard deviation), uniform (plus and minus), fixed

[errors.part]
runout = { normal = 1 }
=> line 1: key 'errors.part' is unknown; allowed: linear, rotary, head, probe

[errors.head]
angle = { normal = 1 }
=> line 2: key 'errors.head.angle': needs a [head] of kind manual or axis

[errors.probe]
noise = { normal = 1 }
=> line 2: key 'errors.probe.noise' needs a [probe]

table = []
[errors.rotary]
index = { normal = 1 }
=> line 3: key 'errors.rotary.index': needs exactly one axis that rotates the part; this machine has none, or several"#;
        let budget = r#"
[linear]
x = { normal = 0.1 }
seed = 3
=> line 3: key 'seed' is for a machine file: a budget has --seed

[part]
tilt.z = { normal = 46 }
=> line 2: key 'part.tilt.z.normal' is 46: 0 to 45 degrees"#;
        let check = |cases: &str, error: &dyn Fn(&str) -> FileError| {
            for case in cases.trim().split("\n\n") {
                let (text, expected) = case.split_once("=> ").unwrap();
                assert_eq!(error(text).to_string(), expected, "{text}");
            }
        };
        check(machine, &|text| Machine::parse(text).unwrap_err());
        check(budget, &|text| error_file(text, &Machine::default()).unwrap_err());
    }

    #[test]
    fn a_budget_reads_the_errors_of_set_up_and_machine() {
        let text = "[part]\nrunout = { uniform = 0.15 }\nshift.z = { normal = 0.03 }\n[rotary]\nindex = { fixed = 0.001 }\n";
        let found = error_file(text, &Machine::default()).unwrap();
        let names: Vec<_> = found.iter().map(|source| source.quantity.name(&Machine::default())).collect();
        assert_eq!(names, ["part.shift.z", "part.runout", "rotary.index"]);
        assert_eq!(found[0].distribution, Distribution::Normal(0.03));
    }
}
