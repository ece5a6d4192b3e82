//! Time and cost of a part, from the simulated run and the user's minutes and rates.
use gcode_part::job::{AlternativeMachine, Minutes, Rates, SheetInfo};

use super::record::Record;

/// Predicted time of a part on one machine, in minutes.
#[derive(Clone, Debug, PartialEq)]
pub struct MachineTime {
    /// Running time of the program.
    pub run: f64,
    /// Number of operator stops.
    pub stops: usize,
    /// Number of tool changes.
    pub tool_changes: usize,
    /// Minutes given by the user; missing ones are not counted.
    pub minutes: Minutes,
}

impl MachineTime {
    /// Returns the minutes of all operator stops; `None` if the time of one is not given.
    pub fn all_stops(&self) -> Option<f64> {
        total_minutes(self.stops, self.minutes.stop)
    }

    /// Returns the minutes of all tool changes; `None` if the time of one is not given.
    pub fn all_tool_changes(&self) -> Option<f64> {
        total_minutes(self.tool_changes, self.minutes.tool_change)
    }

    /// Returns the machine time in minutes.
    pub fn total(&self) -> f64 {
        let rest = [self.minutes.setup, self.all_stops(), self.all_tool_changes()];
        self.run + rest.into_iter().flatten().sum::<f64>()
    }

    /// Returns the job's keys of times that are missing in the sum.
    pub fn not_counted(&self) -> Vec<&'static str> {
        let all = [
            ("setup_minutes", self.minutes.setup.is_none()),
            ("stop_minutes", self.minutes.stop.is_none() && self.stops > 0),
            ("tool_change_minutes", self.minutes.tool_change.is_none() && self.tool_changes > 0),
        ];
        all.into_iter().filter(|(_, missing)| *missing).map(|(key, _)| key).collect()
    }
}

fn total_minutes(count: usize, minutes: Option<f64>) -> Option<f64> {
    if count == 0 { Some(0.0) } else { minutes.map(|minutes| minutes * count as f64) }
}

/// Cost of the part on one machine.
#[derive(Clone, Debug, PartialEq)]
pub struct Cost {
    /// Name of the machine; `None` for the job's own.
    pub machine: Option<String>,
    /// Time of the part on this machine.
    pub time: MachineTime,
    /// Rate of a machine hour.
    pub rate: f64,
    /// Whether the running time is the user's instead of the simulation's.
    pub is_run_specified: bool,
}

impl Cost {
    /// Returns the cost in the currency of the rates.
    pub fn cost(&self) -> f64 {
        self.time.total() / 60.0 * self.rate
    }

    /// Returns the cost difference to `other` in percent of the other's cost, negative if cheaper; `None` if
    /// a time is given for only one of them.
    pub fn change(&self, other: &Self) -> Option<f64> {
        let alike = self.time.not_counted() == other.time.not_counted();
        alike.then(|| (self.cost() / other.cost() - 1.0) * 100.0)
    }
}

/// Returns the time on the job's own machine.
pub(super) fn machine_time(info: &SheetInfo, record: &Record) -> MachineTime {
    MachineTime {
        run: record.times.total() / 60.0,
        stops: record.stops.len(),
        tool_changes: record.tools.len(),
        minutes: info.minutes(),
    }
}

/// Returns the costs of the job's own machine and of the others. Times not given for another machine are
/// taken to be the same.
pub(super) fn costs(rates: &Rates, own: &MachineTime) -> Vec<Cost> {
    let alternative = |other: &AlternativeMachine| Cost {
        machine: Some(other.machine.clone()),
        time: MachineTime {
            run: other.run_minutes.unwrap_or(own.run),
            minutes: Minutes {
                setup: other.setup_minutes.or(own.minutes.setup),
                stop: other.stop_minutes.or(own.minutes.stop),
                tool_change: other.tool_change_minutes.or(own.minutes.tool_change),
            },
            ..own.clone()
        },
        rate: other.rate,
        is_run_specified: other.run_minutes.is_some(),
    };
    let first = Cost { machine: None, time: own.clone(), rate: rates.rate, is_run_specified: false };
    std::iter::once(first).chain(rates.alternatives.iter().map(alternative)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Run 30 min, 6 stops of 10, 2 tool changes of 5, set-up 20: two hours.
    fn two_hours() -> MachineTime {
        let minutes = Minutes { setup: Some(20.0), stop: Some(10.0), tool_change: Some(5.0) };
        MachineTime { run: 30.0, stops: 6, tool_changes: 2, minutes }
    }

    #[test]
    fn minutes_add_up_and_missing_ones_are_named() {
        assert_eq!(two_hours().total(), 120.0);
        assert!(two_hours().not_counted().is_empty());
        let silent = MachineTime { minutes: Minutes::default(), ..two_hours() };
        assert_eq!(silent.total(), 30.0);
        assert_eq!(silent.not_counted(), ["setup_minutes", "stop_minutes", "tool_change_minutes"]);
        let unstopped = MachineTime { stops: 0, tool_changes: 0, ..silent };
        assert_eq!(unstopped.not_counted(), ["setup_minutes"]);
    }

    #[test]
    fn a_quarter_of_the_rate_in_the_same_time_is_75_percent_less() {
        let other =
            AlternativeMachine { machine: "5-axis".into(), rate: 400.0, ..AlternativeMachine::default() };
        let rates = Rates { currency: "CNY".into(), rate: 100.0, alternatives: vec![other.clone()] };
        let costs = costs(&rates, &two_hours());
        assert_eq!((costs[0].cost(), costs[1].cost()), (200.0, 800.0));
        assert_eq!(costs[0].change(&costs[1]), Some(-75.0));
        // Without stops there, 60 min: 400, a saving of one half.
        let other = AlternativeMachine { stop_minutes: Some(0.0), ..other };
        let rates = Rates { alternatives: vec![other], ..rates };
        let costs = super::costs(&rates, &two_hours());
        assert_eq!((costs[1].cost(), costs[0].change(&costs[1])), (400.0, Some(-50.0)));
        // A set-up time of only the other machine would look like a saving.
        let silent = MachineTime { minutes: Minutes { setup: None, ..two_hours().minutes }, ..two_hours() };
        let other = Cost { time: silent, ..costs[1].clone() };
        assert_eq!(costs[0].change(&other), None);
    }
}
