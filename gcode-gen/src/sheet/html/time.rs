//! Running time and, with rates, the cost, compared with other machines.
use gcode_part::job::Job;
use gcode_sim::report::figures::{rounded, short, signed_to};
use gcode_sim::report::sheet::layout::BASIS;
use maud::{Markup, html};

use super::{cell, table};
use crate::sheet::Sheet;
use crate::sheet::cost::{Cost, MachineTime, costs, machine_time};

pub(super) fn time(sheet: &Sheet<'_>) -> Markup {
    let times = sheet.record.times;
    let own = machine_time(sheet.job.sheet(), &sheet.record);
    let minutes = |seconds: f64| rounded(seconds / 60.0, 1);
    html! {
        div.together {
            h2 { "Run time and cost" }
            @if sheet.record.alarmed_programs.len() < sheet.package.mains.len() { p {
                "The program runs " b { (minutes(times.total())) " min" } ": feed " (minutes(times.feed)) ", rapid "
                (minutes(times.rapid)) ", dwell " (minutes(times.dwell)) ". " (BASIS) ": paths divided by feeds and rapid rates, "
                "without acceleration, which makes it longer at the machine."
                @if matches!(sheet.job, Job::Alignment(_)) {
                    " Each program runs once, O8210 once more after the sine table has moved the part."
                }
            } }
            @if !sheet.record.alarmed_programs.is_empty() {
                p { "Without " (sheet.record.alarmed_programs.join(", ")) ", which ends in an alarm on a part in its nominal position." }
            }
            @match sheet.rates {
                Some(rates) => {
                    @let all = costs(rates, &own);
                    (cost_table(&all, &rates.currency))
                    @for other in all.iter().skip(1) { (beside(&all[0], other)) }
                    (assumed(&all))
                }
                None => {
                    (time_table(&own))
                    p { b { "No rate given: " } "the sheet shows time only. Give a rate per machine hour, with its currency, in the job as "
                        code { "[sheet.rates]" } " or in the file of " code { "--rates" } "." }
                }
            }
            (uncounted(&own))
        }
    }
}

/// Returns `60.0 (6 × 10)`, or that the time is not given.
fn times(count: usize, each: Option<f64>, all: Option<f64>) -> String {
    match (count, each, all) {
        (0, ..) => "none".to_owned(),
        (_, Some(each), Some(all)) => format!("{} ({count} × {})", rounded(all, 1), short(each)),
        _ => format!("not given ({count})"),
    }
}

fn parts(taken: &MachineTime) -> [String; 4] {
    [
        taken.minutes.setup.map_or("not given".to_owned(), |minutes| rounded(minutes, 1)),
        rounded(taken.run, 1),
        times(taken.stops, taken.minutes.stop, taken.all_stops()),
        times(taken.tool_changes, taken.minutes.tool_change, taken.all_tool_changes()),
    ]
}

const PARTS: [&str; 4] = ["set-up, min", "run, min", "operator stops, min", "tool changes, min"];

fn time_table(own: &MachineTime) -> Markup {
    let sum = (rounded(own.total(), 1), rounded(own.total() / 60.0, 2));
    let rows = PARTS.iter().zip(parts(own)).map(|(name, value)| vec![cell(name), cell(value)]);
    let last = vec![html! { b { "machine time, min" } }, html! { b { (sum.0) " (" (sum.1) " h)" } }];
    table(&["", "#this job"], rows.chain([last]))
}

fn cost_table(all: &[Cost], currency: &str) -> Markup {
    let names = all.iter().map(|cost| cost.machine.as_deref().unwrap_or("this job"));
    let mut rows: Vec<Vec<Markup>> = PARTS
        .iter()
        .enumerate()
        .map(|(row, name)| {
            let values = all.iter().map(|cost| cell(&parts(&cost.time)[row]));
            std::iter::once(cell(name)).chain(values).collect()
        })
        .collect();
    let mut row = |name: String, value: &dyn Fn(&Cost) -> Markup| {
        rows.push(std::iter::once(cell(name)).chain(all.iter().map(value)).collect());
    };
    row("machine time, h".to_owned(), &|cost| cell(rounded(cost.time.total() / 60.0, 2)));
    row(format!("rate, {currency} a machine hour"), &|cost| cell(short(cost.rate)));
    row(format!("cost of one part, {currency}"), &|cost| html! { b { (rounded(cost.cost(), 2)) } });
    let columns: Vec<String> =
        std::iter::once(String::new()).chain(names.map(|name| format!("#{name}"))).collect();
    table(&columns.iter().map(String::as_str).collect::<Vec<_>>(), rows)
}

/// Returns one sentence with the difference.
fn beside(own: &Cost, other: &Cost) -> Markup {
    html! {
        p {
            "Against " (other.machine.as_deref().unwrap_or("")) ": "
            @match own.change(other) {
                Some(change) => b { (signed_to(change, 1)) " %" },
                None => "not compared: a time is given for one of them only",
            }
            " (" (rounded(own.cost(), 2)) " beside " (rounded(other.cost(), 2)) ")."
        }
    }
}

fn assumed(all: &[Cost]) -> Markup {
    html! {
        @if all.len() > 1 {
            p.note {
                "Assumed, not simulated: the other machines have the same numbers of stops and tool changes, and the same "
                "times where none are given"
                @if all.iter().skip(1).any(|cost| !cost.is_run_specified) { ", the run time too" }
                ". Rates and minutes are the user's."
            }
        }
    }
}

fn uncounted(own: &MachineTime) -> Markup {
    let keys = own.not_counted();
    html! {
        @if !keys.is_empty() {
            p.note {
                "Not counted, because the job's section " code { "[sheet]" } " does not give it: " (keys.join(", ")) "."
            }
        }
    }
}
