//! Finds the control settings that the programs depend on: each switch is changed in turn, and the run
//! compared with that of the default settings.
use gcode_control::{Limits, Outcome};
use gcode_lang::control::{ROWS, SettingRow, Settings};
use gcode_lang::motion::{Event, EventKind, EventSink};
use gcode_part::job::Job;
use gcode_session::{Request, SessionError};

use super::record::{ProgramStart, request, run_with_part};
use crate::check::{CheckError, broken_package};
use crate::package::Package;

/// Number of blocks followed: later ones only repeat loops.
pub(super) const MAX_BLOCKS: u64 = 2_000;

/// A switch that must have the simulated value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct RequiredSetting {
    pub key: &'static str,
    pub meaning: &'static str,
    /// 0 or 1.
    pub value: &'static str,
    /// Effect of the other value.
    pub consequence: String,
}

/// Runs the main programs once for every switch; a program that ends in an alarm with default settings is
/// skipped.
///
/// # Errors
/// [`CheckError::Broken`] if the package contradicts itself.
pub(super) fn required_settings(
    job: &Job,
    package: &Package,
    begins: &[ProgramStart],
) -> Result<Vec<RequiredSetting>, CheckError> {
    let mut found: Vec<RequiredSetting> = Vec::new();
    for begin in begins {
        let mut request = request(package, begin)?;
        request.limits = Limits { blocks: MAX_BLOCKS };
        let usual = request.settings.clone();
        let mut trace = |settings: Settings| {
            request.settings = settings;
            RunTrace::of(job, package, &request).map_err(|error| broken_package(&request.name, &error))
        };
        let expected = trace(usual.clone())?;
        if expected.alarm.is_some() {
            continue;
        }
        for row in ROWS {
            let Some((value, turned)) = switched(row, &usual) else { continue };
            let other = trace(turned)?;
            if other != expected && found.iter().all(|known| known.key != row.key) {
                let otherwise = other.alarm.unwrap_or_else(|| "the machine moves differently".to_owned());
                found.push(RequiredSetting {
                    key: row.key,
                    meaning: row.meaning,
                    value,
                    consequence: otherwise,
                });
            }
        }
    }
    Ok(found)
}

/// Returns the value of a switch and the settings with the other value; `None` if the row is not a switch.
fn switched(row: &SettingRow, usual: &Settings) -> Option<(&'static str, Settings)> {
    ["0", "1"].into_iter().zip(["1", "0"]).find_map(|(value, other)| {
        let mut same = usual.clone();
        same.set(row.key, value).ok()?;
        let mut turned = usual.clone();
        turned.set(row.key, other).ok()?;
        (row.is_switch() && same == *usual && turned != *usual).then_some((value, turned))
    })
}

/// Everything that the machine and the operator do in a run, in its order.
#[derive(Debug, Default, PartialEq)]
struct RunTrace {
    events: Vec<EventKind>,
    alarm: Option<String>,
}

impl RunTrace {
    fn of(job: &Job, package: &Package, request: &Request) -> Result<Self, SessionError> {
        let mut trace = Self::default();
        let run = run_with_part(job, package, request, &mut trace)?;
        trace.alarm = match &run.outcome {
            Outcome::Alarm(stopped) => {
                let (program, line) = run.locate(stopped.backtrace.block);
                Some(format!("the run stops with {} in {program} line {line}", stopped.alarm.row().code))
            }
            Outcome::End | Outcome::Limit => None,
        };
        Ok(trace)
    }
}

impl EventSink for RunTrace {
    fn event(&mut self, event: &Event<'_>) {
        match event.kind {
            // What the control knows of positions moves nothing.
            EventKind::ToolLength { .. } | EventKind::Start { .. } | EventKind::PositionUnknown { .. } => {}
            kind => self.events.push(kind.clone()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::families;
    use crate::package::Program;

    fn found(text: &str) -> Vec<(&'static str, &'static str, String)> {
        let programs = vec![Program { number: 1, text: text.to_owned() }];
        let package = Package { mains: vec![1], programs, machine: String::new() };
        // Any job without probing.
        let job = Job::parse(families::ALL[0].new_job).unwrap();
        let needed =
            required_settings(&job, &package, &[ProgramStart { main: 1, variables: Vec::new() }]).unwrap();
        needed.into_iter().map(|one| (one.key, one.value, one.consequence)).collect()
    }

    /// ATAN of the third quadrant is 225, or -135 with NAT; `IF[..]` needs THEN unless PLAIN-IF; X10 is 10 µm
    /// or mm.
    #[test]
    fn a_switch_that_changes_the_run_is_named() {
        let moves = "the machine moves differently".to_owned();
        assert_eq!(found("O1\n#1=ATAN[-1.]/[-1.]\nG0 X#1\nM30\n"), [("NAT", "0", moves.clone())]);
        assert_eq!(found("O1\nG0 X10\nM30\n"), [("DPI", "0", moves)]);
        assert_eq!(found("O1\n#1=POW[2.,3.]\nG0 X#1\nM30\n").len(), 2, "two switches know POW");
        assert_eq!(found("O1\nG0 X10.\nM30\n"), []);
    }
}
