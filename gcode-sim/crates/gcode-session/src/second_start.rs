//! Second start of a program, with the offsets and modes that its first run leaves.
use std::hash::{DefaultHasher, Hasher};
use std::sync::Arc;

use super::set_up::{set_up_control, set_up_control_behind};
use super::{Request, Run, extractor};
use gcode_control::{Limits, Outcome, ResidualKind, ResidualValue};
use gcode_inspect::findings::SECOND_START;
use gcode_inspect::holes::{DrilledHole, HoleExtraction};
use gcode_lang::diag::Diagnostic;
use gcode_lang::motion::{Event, EventSink, MAX_AXES};
use gcode_lang::program::g_codes::name;
use gcode_lang::program::{Memory, NoLibrary};
use gcode_part::Metal;

/// Largest difference between two holes that are the same, mm; of their axes, as a length of unit vectors.
const SAME: f64 = 1e-4;

/// Largest number of blocks of a second start, as a multiple of those of the first.
const MAX_BLOCKS_RATIO: u64 = 2;

/// Largest number of offsets in a message.
const MAX_NAMED: usize = 3;

/// Trace of all feeds of a run: two runs with the same trace feed from place to place at the same rates.
#[derive(Debug, Default)]
pub(super) struct FeedTrace(DefaultHasher);

impl EventSink for FeedTrace {
    fn event(&mut self, event: &Event<'_>) {
        let Some((rate, to)) = event.kind.rate().zip(event.kind.end()) else { return };
        self.0.write_u64(rate.0.to_bits());
        (0..MAX_AXES).for_each(|axis| self.0.write_u64(to[axis].to_bits()));
    }
}

/// Returns the warning that the program leaves an offset or a mode changed and its second start makes other holes or feeds.
pub(super) fn finding(
    request: &Request,
    run: &Run,
    metal: &Metal,
    (extracted, feeds): (&HoleExtraction, FeedTrace),
) -> Option<Diagnostic> {
    if !matches!(run.outcome, Outcome::End) || extracted.holes.is_empty() {
        return None;
    }
    let start = set_up_control(request, Memory::default()).ok()?;
    if start.has_state_of(&run.control) {
        return None;
    }
    let mut control =
        set_up_control_behind(request, run.control.memory().reload(), Some(&run.control)).ok()?;
    let changes = changes(&start.residual_values(), &control.residual_values());
    if let Some(progress) = &request.progress {
        control.set_progress(Arc::clone(progress));
    }
    let mut extractor = extractor(request, metal.clone()).without_rapids();
    let limits = Limits { blocks: request.limits.blocks.min(MAX_BLOCKS_RATIO * run.control.blocks()) };
    let mut feeds_again = FeedTrace::default();
    let mut sinks = (&mut extractor, &mut feeds_again);
    let outcome = control.run_observed(limits, &mut NoLibrary, &mut sinks, &mut ());
    if control.is_cancelled() {
        return None;
    }
    let again = extractor.finish().holes;
    let difference = match outcome {
        Outcome::Alarm(stop) => format!("it stops with alarm {}", stop.alarm.code()),
        Outcome::Limit => format!("it has not ended after {} blocks", control.blocks()),
        Outcome::End => {
            let pairs = extracted.holes.iter().zip(&again);
            let aside = pairs.filter(|(one, other)| !is_same(one, other)).count();
            match aside + extracted.holes.len().abs_diff(again.len()) {
                0 if feeds.0.finish() == feeds_again.0.finish() => return None,
                0 => "its holes are the same, but other feeds lead elsewhere or have another rate".to_owned(),
                1 => "one hole is elsewhere".to_owned(),
                count => format!("{count} holes are elsewhere"),
            }
        }
    };
    let message = format!("the program leaves {changes}: started again, {difference}");
    Some(
        Diagnostic::new(&SECOND_START, message)
            .with_backtrace(run.control.backtrace())
            .note("M30 keeps modes and the shift of G52 unless parameters 3402#6 (CLR) and 1202#3 (RLC) clear them")
            .help("set the offset or the mode before its first use, or restore it before M30"),
    )
}

/// Returns true if two holes are at one place, of one depth and by one tool.
fn is_same(one: &DrilledHole, other: &DrilledHole) -> bool {
    (one.entry - other.entry).norm() <= SAME
        && (one.axis.into_inner() - other.axis.into_inner()).norm() <= SAME
        && (one.depth - other.depth).abs() <= SAME
        && one.tool == other.tool
}

/// Returns `G54 X at 20, which was 0 at its start`, for the first offsets that differ, else the codes of the modes that do.
fn changes(before: &[ResidualValue], after: &[ResidualValue]) -> String {
    let is_offset =
        |value: &&ResidualValue| matches!(value.kind, ResidualKind::WorkOffset | ResidualKind::ToolOffset);
    if before.iter().filter(is_offset).eq(after.iter().filter(is_offset)) {
        let is_mode = |value: &&ResidualValue| value.kind == ResidualKind::Mode;
        let modes = after.iter().filter(is_mode).filter(|value| !before.contains(value));
        let codes: Vec<String> = modes.map(|value| name((value.value * 10.0).round() as u32)).collect();
        return format!("{} in force", codes.join(" and "));
    }
    let value_in = |values: &[ResidualValue], of: &str| {
        values.iter().filter(is_offset).find(|value| value.name == of).map_or(0.0, |value| value.value)
    };
    let mut names: Vec<&str> =
        after.iter().chain(before).filter(is_offset).map(|value| value.name.as_str()).collect();
    let mut seen = std::collections::BTreeSet::new();
    names.retain(|name| seen.insert(*name) && value_in(before, name) != value_in(after, name));
    let shown = names.iter().take(MAX_NAMED).map(|name| {
        format!("{name} at {}, which was {} at its start", value_in(after, name), value_in(before, name))
    });
    let shown: Vec<_> = shown.collect();
    let more = match names.len() {
        count if MAX_NAMED < count => format!(", and {} more offsets", count - MAX_NAMED),
        _ => String::new(),
    };
    format!("{}{more}", shown.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulate;
    use gcode_inspect::machine::Machine;
    use gcode_lang::control::Dialect;

    /// Returns the message about the second start of a program with one hole and these blocks behind it.
    fn message(dialect: Dialect, blocks: &str) -> Option<String> {
        message_behind("G21", dialect, blocks)
    }

    /// Returns the message about a program that begins with a code of the unit, or with none.
    fn message_behind(unit: &str, dialect: Dialect, blocks: &str) -> Option<String> {
        let text = format!(
            "O1\nG90 G17 {unit} G94 S1000 M03\nG0 X20. Y0. Z50.\nG81 X20. Z-5. R2. F100.\nG80 Z50.\n{blocks}\nM30\n"
        );
        let mut request = Request::new("O1.nc", text.as_bytes(), Machine::default());
        request.settings.apply_dialect(dialect);
        let simulation = simulate(&request, &mut NoLibrary, None).unwrap();
        let mut findings = simulation.extracted.findings.into_iter();
        findings.find(|finding| finding.kind == &SECOND_START).map(|finding| finding.message)
    }

    #[test]
    fn the_unit_is_left_to_a_start_that_commands_none() {
        assert_eq!(
            message_behind("", Dialect::Fanuc31i, "G20").unwrap(),
            "the program leaves G20 in force: started again, one hole is elsewhere"
        );
        assert_eq!(message_behind("", Dialect::Fanuc31i, "G20\nG21"), None);
        assert_eq!(message_behind("G21", Dialect::Fanuc31i, "G20"), None);
    }

    #[test]
    fn m30_of_a_haas_resets_the_modes() {
        assert_eq!(message(Dialect::HaasNgc, "G68 X0 Y0 R90."), None);
        assert_eq!(
            message(Dialect::Fanuc31i, "G68 X0 Y0 R90.").unwrap(),
            "the program leaves G68 in force: started again, one hole is elsewhere"
        );
    }

    /// The groove lies 0.1 deeper with each start, and the hole where it was.
    #[test]
    fn feeds_beside_the_holes_count() {
        let groove = "G43 H5 Z5.\nG1 Z-1. F80.\nX40.\nG0 Z50.\nG49\nG91 G10 L11 P5 R-0.1\nG90";
        let found = message(Dialect::Fanuc31i, groove).unwrap();
        assert!(found.contains("H5 wear at -0.1") && found.contains("other feeds lead elsewhere"), "{found}");
        let set = groove.replace("G43 H5", "G90 G10 L11 P5 R0\nG43 H5");
        assert_eq!(message(Dialect::Fanuc31i, &set), None);
    }
}
