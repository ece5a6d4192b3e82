//! The machine file's `[probe]`.
use serde::Deserialize;
use toml::Spanned;

use crate::job::JobError;
use crate::job::reader::Reader;
use crate::machine::Probe;
use crate::units::Seconds;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FileProbe {
    radius: Spanned<f64>,
    delay: Option<Spanned<f64>>,
    overrun: Option<Spanned<f64>>,
    give: Option<Spanned<f64>>,
}

impl FileProbe {
    pub(super) fn check(&self, reader: &Reader<'_>) -> Result<Probe, JobError> {
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
            probe.give = length("probe.give", give)?;
        }
        Ok(probe)
    }
}
