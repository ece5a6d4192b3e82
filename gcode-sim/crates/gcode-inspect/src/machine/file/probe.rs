//! The machine file's `[probe]`.
use schemars::JsonSchema;
use serde::Deserialize;

use crate::machine::Probe;
use gcode_lang::units::Seconds;
use gcode_part::reader::FileError;
use gcode_part::reader::{Reader, Spanned};

/// A touch probe.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct FileProbe {
    /// Of the stylus ball, mm; its centre is the tool's tip.
    #[schemars(range(min = 0.0, max = 1000.0))]
    radius: Spanned<f64>,
    /// Time from the contact until the control latches the position, seconds [default: 0].
    #[schemars(range(min = 0.0, max = 10.0))]
    delay: Option<Spanned<f64>>,
    /// Time from then until the axes stop, seconds [default: 0].
    #[schemars(range(min = 0.0, max = 10.0))]
    overrun: Option<Spanned<f64>>,
    /// Largest deflection of the stylus before it breaks, mm [default: unlimited].
    #[schemars(range(min = 0.0, max = 1000.0))]
    give: Option<Spanned<f64>>,
}

impl FileProbe {
    pub(super) fn check(&self, reader: &Reader<'_>) -> Result<Probe, FileError> {
        let seconds = |key: &str, value: &Option<Spanned<f64>>| match value {
            Some(value) => {
                reader.number(key, value, "seconds, 0 to 10", |v| (0.0..=10.0).contains(&v)).map(Seconds)
            }
            None => Ok(Seconds::ZERO),
        };
        let length = |key: &str, value: &Spanned<f64>| {
            reader.number(key, value, "mm, 0 to 1000", |v| (0.0..=1000.0).contains(&v))
        };
        let mut probe = Probe::new(length("probe.radius", &self.radius)?);
        probe.delay = seconds("probe.delay", &self.delay)?;
        probe.overrun = seconds("probe.overrun", &self.overrun)?;
        if let Some(give) = &self.give {
            probe.overtravel_limit = length("probe.give", give)?;
        }
        Ok(probe)
    }
}
