//! Sections of the alignment sheet alone: a form for the readings, and remedies for the alarms of the
//! measurements.
use gcode_part::job::{Alignment, Job};
use gcode_sim::report::figures::{rounded, short};
use maud::{Markup, html};

use super::zero::on_surface;
use super::{cell, table};
use crate::families::alignment::{ALARMS, MacroAlarm, overwritten};
use crate::families::control::alarm_thousands;
use crate::package::stem;
use crate::sheet::Sheet;

/// Returns the values to be read at the stops; the form has room for three passes.
fn lines(job: &Alignment) -> Vec<(String, &'static str, String)> {
    let rotary = job.machine.rotary.letter;
    let shift = format!("±{}", short(job.limits().shift));
    let tilt = format!("±{}", short(job.limits().tilt));
    let line = |place: &str, what: &'static str| (place.to_owned(), what, String::new());
    let mut all = vec![
        ("#580".to_owned(), "shift in X, mm", shift.clone()),
        ("#581".to_owned(), "shift in Z, mm", shift),
        ("#582".to_owned(), "tilt about X, °", tilt.clone()),
        ("#583".to_owned(), "tilt about Z, °", tilt),
        line("#584", "shift in Y, mm, less accurate"),
        ("#585".to_owned(), "residual of the fit, mm", format!("at most {}", short(2.0 * job.probe_noise()))),
        line("#596", "assumed angle of the table, °"),
        line("#586", "angle to set, °"),
        line("#587", "height of the gauge blocks for it, mm"),
        line("#588", "change of the height, mm"),
        line("#589", "error of #587, ″"),
    ];
    let offset =
        |when: &'static str| ["X", "Y", "Z"].map(|axis| (format!("G54 {axis}"), when, String::new()));
    all.extend(offset("before O8200, mm"));
    all.push((format!("G54 {rotary}"), "before O8200, °", String::new()));
    all.extend([
        line("#570", "number of the point used for E"),
        line("#571", "number of the point used for F"),
        line("#572", "chord minus model chord, mm"),
        line("#573", "chord offset in X, mm, not added"),
        line("#574", "added to Y, mm"),
        line("#575", "chord offset in Z, mm, not added"),
        line("#576", "added to the rotary, °"),
        line("#577", "tilt of the chord, °"),
    ]);
    all.extend(offset("after O8200, mm"));
    all.push((format!("G54 {rotary}"), "after O8200, °", String::new()));
    all
}

/// Number of positions on the ellipse with a line in the form.
const PLACES: u32 = 7;

pub(super) fn readings(sheet: &Sheet<'_>) -> Markup {
    let Job::Alignment(job) = sheet.job else { return html! {} };
    let blank = || html! {};
    let variables = lines(job).into_iter().map(|(place, what, limit)| {
        vec![html! { b { (place) } }, cell(what), cell(limit), blank(), blank(), blank()]
    });
    let places = (0..PLACES).map(|n| {
        let path = &job.ellipse();
        let [x, y, across, up] =
            on_surface(job.surface, path.from + (path.to - path.from) * f64::from(n) / f64::from(PLACES - 1));
        let ball = [x + job.probe.radius * across, y + job.probe.radius * up];
        let [x, y] = ball.map(|value| cell(rounded(value, 2)));
        vec![x, y, cell("0"), blank(), blank()]
    });
    html! {
        div.together {
            h2 { "Readings" }
            p {
                "As the control shows them at the stops. Nothing is filled in: a simulation is not a measurement. The limits are the job's "
                code { "[limits]" } ", those of #580 to #583 for the last pass. " b { "Write #596 down: " }
                "after a RESET at the wrong moment (alarm " (alarm_thousands(job.control.dialect)) "169) it must be entered again. Once the blocks are "
                "changed it is asin(#587/L), within #589 of #586."
            }
            div.fill { (table(&["place", "meaning", "limit", "first pass", "second pass", "third pass"], variables)) }
        }
        div.together {
            h3 { "Dial along the ellipse, O8220" }
            p {
                "Position of the ball centre; above 0 a gap. On a part in its nominal position the dial shows 0 all the way; "
                code { "gcode-sim readings" } " predicts it for a misplaced part. "
                b { "Limit: ±" (short(job.limits().dial)) " mm" } " at every position."
            }
            div.fill { (table(&["#X", "#Y", "#nominal", "reading", "after correction"], places)) }
        }
    }
}

pub(super) fn alarms(sheet: &Sheet<'_>) -> Markup {
    let Job::Alignment(job) = sheet.job else { return html! {} };
    let k = alarm_thousands(job.control.dialect);
    let row = |alarm: &MacroAlarm| {
        vec![cell(shown(alarm, k)), html! { span.mono { (alarm.text) } }, cell(&alarm.remedy)]
    };
    let before = |index: usize| ALARMS.iter().take(index);
    let rows = ALARMS
        .iter()
        .enumerate()
        .filter(|(index, alarm)| !before(*index).any(|other| alike(alarm, other)))
        .map(|(_, alarm)| row(alarm));
    html! {
        h2 { "Alarms and remedies" }
        ul {
            li {
                b { "RESET and any alarm " } "leave complete results or none. Take the ball clear of the part by hand before the next start: away "
                "towards X+ in O8210, up towards Y+ in O8200 and O8220."
            }
            li {
                b { "The ball touches in rapid, " } "or the machine stops with its own alarm of the probe: the part protrudes by more than the search of "
                (short(job.probe.search)) " mm, or G54 is wrong. RESET, take the ball clear, check ball and stylus and calibrate them again, set the "
                "part up more accurately; then O8210 from its beginning. Watch the first touch of each height at reduced rapid."
            }
            li {
                b { "A touch is interrupted " } "(RESET, emergency stop, power): O8210 starts from its beginning. O8200 does not continue until #578 is set: 0. touches "
                "all points again."
            }
            li {
                "Any other alarm of " (k) "061 to " (k) "076, " (k) "101 to " (k) "169: an argument of a call differs from the emitted program. Load the programs again."
            }
        }
        (table(&["alarm", "the control shows", "remedy"], rows))
    }
}

/// Returns true for the same alarm in several macros.
fn alike(one: &MacroAlarm, other: &MacroAlarm) -> bool {
    one.text == other.text && one.remedy == other.remedy
}

/// Returns the numbers of an alarm as the control shows them: `3112, 3137, 3138`.
fn shown(alarm: &MacroAlarm, k: &str) -> String {
    let mut numbers: Vec<_> =
        ALARMS.iter().filter(|other| alike(alarm, other)).map(|one| one.number).collect();
    numbers.sort_unstable();
    numbers.iter().map(|number| format!("{k}{number:03}")).collect::<Vec<_>>().join(", ")
}

/// Returns the item on common variables for the section on the control.
pub(super) fn overwritten_variables(job: &Alignment) -> Markup {
    let all: Vec<_> =
        overwritten().map(|(main, named)| format!("{}: {}", stem(main), named.to_lowercase())).collect();
    html! {
        li {
            b { "Common variables " } "that are overwritten, and kept when the control is switched off: " (all.join("; ")) ". Save what other cycles of the "
            "shop keep there first. A local shift of " (job.machine.rotary.letter) " by G52 is cancelled."
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_alarm_of_several_macros_has_all_its_numbers_as_the_control_shows_them() {
        let of = |text: &str| ALARMS.iter().find(|alarm| alarm.text == text).unwrap();
        assert_eq!(shown(of("G52 OR G92 SHIFT IN X Y Z"), "3"), "3112, 3137, 3138");
        assert_eq!(shown(of("G52 OR G92 SHIFT IN X Y Z"), "1"), "1112, 1137, 1138");
        // The remedies differ.
        assert_eq!(shown(of("NO CONTACT"), "3"), "3155");
        assert_eq!(shown(of("A CANDIDATE IS MISSING"), "3"), "3068");
    }
}
