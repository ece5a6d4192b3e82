//! Exceptions: alarms of the control, reads of vacant variables, and holes that come out bad.
use std::collections::BTreeSet;

use super::values;
use gcode_control::Control;
use gcode_lang::alarm::Alarm;

/// Filter of exceptions that a client offers.
#[derive(Debug)]
pub(crate) struct FilterRow {
    pub(crate) filter: &'static str,
    pub(crate) label: &'static str,
    pub(crate) description: &'static str,
}

/// Filter of vacant reads.
pub(crate) const VACANT_READ: &str = "vacant";

/// Filter of holes that come out bad.
pub(crate) const BAD_HOLE: &str = "hole";

/// Filter of all alarms.
pub(crate) const ALARM: &str = "alarm";

/// All filters.
pub(crate) const FILTERS: &[FilterRow] = &[
    FilterRow { filter: ALARM, label: "Alarms", description: "Any alarm of the control" },
    FilterRow { filter: "PS", label: "PS alarms", description: "Alarms of the program, PS0010 and so on" },
    FilterRow { filter: "MC", label: "MC alarms", description: "Alarms that the program raises with #3000" },
    FilterRow { filter: "OT", label: "OT alarms", description: "Overtravel" },
    FilterRow { filter: "SIM", label: "SIM alarms", description: "Functions that are not simulated" },
    FilterRow { filter: VACANT_READ, label: "Vacant reads", description: "A block reads a vacant variable" },
    FilterRow {
        filter: BAD_HOLE,
        label: "Bad holes",
        description: "A block makes a hole that the reference refuses or lacks; needs 'reference' in the launch",
    },
];

/// Reason for a stop that nothing in the set-up of the debugger asks for by place.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Exception {
    /// Code: `PS0112`, `vacant`, `hole`.
    pub(crate) code: String,
    pub(crate) message: String,
}

impl Exception {
    pub(crate) fn of_alarm(alarm: &Alarm) -> Self {
        let row = alarm.row();
        Self { code: row.code.to_string(), message: row.message }
    }

    /// Returns the exception of the next block if it reads a vacant variable.
    pub(crate) fn of_vacant_read(control: &Control) -> Option<Self> {
        let is_vacant = |number: &u32| control.variable(*number).is_ok_and(|value| value.is_vacant());
        let vacant: BTreeSet<u32> = control.next_read_variables().into_iter().filter(is_vacant).collect();
        let names: Vec<String> = vacant.iter().map(|number| format!("#{number}")).collect();
        let verb = if names.len() == 1 { "is" } else { "are" };
        let message = format!("{} {verb} {} and the next block reads it", names.join(", "), values::VACANT);
        (!names.is_empty()).then(|| Self { code: VACANT_READ.to_owned(), message })
    }

    /// Returns code and message in one line.
    pub(crate) fn text(&self) -> String {
        format!("{}: {}", self.code, self.message)
    }
}

/// Filters in force.
#[derive(Clone, Debug, Default)]
pub(crate) struct Filters(BTreeSet<&'static str>);

impl Filters {
    /// Returns the filters with these names; unknown ones are left out.
    pub(crate) fn of<'n>(names: impl IntoIterator<Item = &'n str>) -> Self {
        let known = |name: &str| FILTERS.iter().find(|row| row.filter == name).map(|row| row.filter);
        Self(names.into_iter().filter_map(known).collect())
    }

    pub(crate) fn has(&self, filter: &str) -> bool {
        self.0.contains(filter)
    }

    /// Returns true if the run stops at an alarm with this code.
    pub(crate) fn stops_at_alarm(&self, code: &str) -> bool {
        let family = code.trim_end_matches(|letter: char| letter.is_ascii_digit());
        self.has(ALARM) || self.has(family)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn filters_choose_alarms_by_family() {
        let stops = |names: &[&str], code| Filters::of(names.iter().copied()).stops_at_alarm(code);
        assert!(stops(&["alarm"], "PS0112") && stops(&["alarm"], "SIM0001"));
        assert!(stops(&["PS"], "PS0112") && !stops(&["PS"], "MC3001"));
        assert!(stops(&["OT", "MC"], "MC3001") && !stops(&["OT", "MC"], "PS0112"));
        assert!(!stops(&["vacant", "hole", "unknown"], "PS0112"));
    }
}
