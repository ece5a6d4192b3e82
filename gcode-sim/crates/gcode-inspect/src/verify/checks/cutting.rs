//! Cutting conditions of each tool: spindle, speed, feed, pecks and length offset as the reference specifies them.
use std::collections::BTreeSet;

use super::*;
use crate::findings::{DRILL_FEED, DRILL_PECK, DRILL_SPEED, JOB_TOOL, LENGTH_OFFSET, SPINDLE_REVERSED};
use crate::holes::{CutConditions, OffsetOrigin};
use crate::machine::{ToolKind, tool_name};
use gcode_lang::motion::{LengthCompensation, SpindleDirection};
use gcode_part::{FeatureKind, Hand};

/// Relative deviation of S and F without a finding: rounding of an inch value.
const ROUNDING_ALLOWANCE: f64 = 0.005;

/// Relative deviation above which S or F is an error: tables of cutting data leave this range open.
const ERROR_RATIO: f64 = 0.25;

/// Largest cutting speed, m/min: coated tools in aluminium reach some 1500, PCD some 1800.
const MAX_CUTTING_SPEED: f64 = 1800.0;

/// Largest feed of a tool of unknown diameter, mm per revolution.
const MAX_FEED_PER_TURN: f64 = 5.0;

/// Share of its diameter that no drill feeds in a revolution: tables give up to 0.05.
const MAX_DRILL_FEED_SHARE: f64 = 0.25;

/// Feed that no drill stands, mm/min: coated drills in aluminium reach some 6000.
const MAX_DRILL_FEED: f64 = 15_000.0;

/// Share of its diameter that each drill feeds in a revolution: tables give 0.005 and more.
const LEAST_FEED_SHARE: f64 = 0.0005;

/// Feed that other tools have in a revolution, mm: below the radius of a sharp edge, some 2 µm, no chip comes off.
const LEAST_FEED: f64 = 0.002;

/// Feed that a tool of unknown diameter has in a revolution, mm: that of a drill of Φ0.4.
const LEAST_OPEN_FEED: f64 = 0.0002;

/// Pecks up to this length, mm, and up to this share of the drill's diameter are none: the drill only rubs.
const LEAST_PECK: f64 = 0.01;
const LEAST_PECK_SHARE: f64 = 0.005;

/// A check of one cut.
type CutCheck<'c> = &'c dyn Fn(&CutConditions, &ProcessLimits, &Machine) -> Option<Diagnostic>;

pub(super) fn check(inspection: &HoleInspection<'_>, findings: &mut HoleFindings) {
    let (conditions, limits) = (&inspection.extraction.cut_conditions, &inspection.reference.process_limits);
    let mut reported = CutFindings::default();
    let offsets = offsets_of_tools(conditions);
    let described = described_taps(inspection);
    let widths = widths_of_unknown_tools(inspection);
    let per_turn = |cut: &CutConditions, _: &ProcessLimits, machine: &Machine| {
        feed_per_turn(cut, machine, widths.get(&cut.tool).copied())
    };
    let checks: [CutCheck<'_>; 9] =
        [&reversed, &speed, &feed, &per_turn, &rubbing_feed, &peck, &fine_peck, &length, &tool];
    for check in checks {
        for cut in conditions {
            let Some(finding) = check(cut, limits, inspection.machine) else { continue };
            if finding.kind == &SPINDLE_REVERSED && cut.is_tapping && described.contains(&cut.tool) {
                continue;
            }
            // Lengths that the machine file states are compared.
            let is_open = finding.kind == &LENGTH_OFFSET && inspection.machine.length_of(cut.tool).is_none();
            let finding = match owner_of_length(cut, &offsets).filter(|_| is_open) {
                Some(owner) => finding
                    .with_severity(Severity::Error)
                    .note(format!("T{owner} cuts with it too: two tools have two lengths")),
                None => finding,
            };
            reported.add(finding, cut);
        }
    }
    for cut in conditions {
        if let Some(finding) = without_offset(cut, &offsets, inspection) {
            reported.add(finding, cut);
        }
    }
    reported.finish(findings);
}

/// Findings on cuts: those with one message are one, at the first cut, with the number of all.
#[derive(Default)]
pub(super) struct CutFindings {
    list: Vec<(Diagnostic, u64)>,
    by_message: BTreeMap<String, usize>,
}

impl CutFindings {
    pub(super) fn add(&mut self, finding: Diagnostic, cut: &CutConditions) {
        let index = *self.by_message.entry(finding.message.clone()).or_insert(self.list.len());
        if index == self.list.len() {
            let located = match finding.kind == &LENGTH_OFFSET {
                true => OffsetOrigin::locate(cut.offset_origin.as_ref(), finding, &cut.backtrace),
                false => finding.with_backtrace(cut.backtrace.clone()),
            };
            self.list.push((located, 0));
        }
        self.list[index].1 += cut.count;
    }

    pub(super) fn finish(self, findings: &mut HoleFindings) {
        for (finding, count) in self.list {
            let note = (count != 1).then(|| format!("in {count} cuts; this is the first"));
            findings.add(Subject::Motion, note.into_iter().fold(finding, Diagnostic::note));
        }
    }
}

/// Returns the taps of unknown hand that cut only holes whose threads the reference describes: their hand is compared there.
fn described_taps(inspection: &HoleInspection<'_>) -> BTreeSet<Option<u32>> {
    let HoleInspection { comparison, machine, .. } = inspection;
    let hand = |tool: Option<u32>| tool.and_then(|number| machine.find_tool(number)?.hand);
    let has_thread = |hole: &Hole| hole.features.iter().any(|feature| feature.kind == FeatureKind::Tap);
    let taps = |hole: &DrilledHole| -> Vec<Option<u32>> {
        hole.passes().filter(|pass| pass.cut.is_tapping).map(|pass| pass.tool).collect()
    };
    let mut described = BTreeSet::new();
    for (_, _, drilled) in comparison.matched().filter(|(_, nominal, _)| has_thread(nominal)) {
        described.extend(taps(drilled).into_iter().filter(|tool| hand(*tool).is_none()));
    }
    for (_, _, drilled) in comparison.matched().filter(|(_, nominal, _)| !has_thread(nominal)) {
        taps(drilled).iter().for_each(|tool| _ = described.remove(tool));
    }
    for extra in &comparison.extra {
        taps(&comparison.actual[*extra]).iter().for_each(|tool| _ = described.remove(tool));
    }
    described
}

/// Returns the diameter of the widest hole of the reference in which each tool of unknown diameter cuts: no such tool is wider. A
/// tool that cuts elsewhere too has none.
fn widths_of_unknown_tools(inspection: &HoleInspection<'_>) -> BTreeMap<Option<u32>, f64> {
    let HoleInspection { comparison, machine, .. } = inspection;
    let mut widths: BTreeMap<Option<u32>, f64> = BTreeMap::new();
    if inspection.extraction.cut_conditions.iter().all(|cut| machine.diameter_of(cut.tool).is_some()) {
        return widths;
    }
    for (_, nominal, drilled) in comparison.matched() {
        let width = nominal.widest_diameter().unwrap_or(f64::INFINITY);
        for pass in drilled.passes().filter(|pass| machine.diameter_of(pass.tool).is_none()) {
            let known = widths.entry(pass.tool).or_insert(width);
            *known = known.max(width);
        }
    }
    for extra in &comparison.extra {
        comparison.actual[*extra].passes().for_each(|pass| _ = widths.remove(&pass.tool));
    }
    widths
}

/// Returns the first cut of each tool with each length offset.
fn offsets_of_tools(conditions: &[CutConditions]) -> Vec<&CutConditions> {
    let mut known = BTreeSet::new();
    conditions.iter().filter(|cut| known.insert((cut.tool, cut.compensation))).collect()
}

/// Returns the tool of the same number as the length offset of a cut, if it cuts with that offset too and is another one.
fn owner_of_length(cut: &CutConditions, offsets: &[&CutConditions]) -> Option<u32> {
    let LengthCompensation::Plus(h) = cut.compensation else { return None };
    let is_owner = |other: &&CutConditions| other.tool == Some(h) && other.compensation == cut.compensation;
    (cut.tool.is_some_and(|tool| tool != h) && offsets.iter().any(is_owner)).then_some(h)
}

/// Reports a tool that turns against its hand. A thread has the hand of the spindle, which another check compares with the
/// reference.
fn reversed(cut: &CutConditions, _: &ProcessLimits, machine: &Machine) -> Option<Diagnostic> {
    let hand = cut.tool.and_then(|number| machine.find_tool(number)?.hand);
    let (wrong, code, right) = match hand.unwrap_or_default() {
        Hand::Right => (SpindleDirection::Counterclockwise, "M04", "M03"),
        Hand::Left => (SpindleDirection::Clockwise, "M03", "M04"),
    };
    let is_warning = cut.is_tapping;
    (cut.spindle_direction == wrong).then(|| {
        Diagnostic::new(&SPINDLE_REVERSED, format!("{} cuts with {code}", tool_name(cut.tool)))
            .with_severity(if is_warning { Severity::Warning } else { Severity::Error })
            .note("a tool that turns against its hand rubs and breaks")
            .help(format!("use {right}, or give the tool's hand in the machine file"))
    })
}

fn speed(cut: &CutConditions, limits: &ProcessLimits, machine: &Machine) -> Option<Diagnostic> {
    // A stopped spindle has its own finding.
    if cut.spindle_direction == SpindleDirection::Off {
        return None;
    }
    let Some(nominal) = limits.tool_process(cut.tool).and_then(|tool| tool.speed) else {
        return cutting_speed(cut, machine);
    };
    let actual = cut.speed.0;
    let severity = severity(actual, nominal)?;
    let message = format!("{} cuts at S{actual}; the job specifies S{nominal}", tool_name(cut.tool));
    let finding = Diagnostic::new(&DRILL_SPEED, message).with_severity(severity);
    Some(finding.help("correct S, or the tool's speed in the job"))
}

/// Reports a cutting speed far above those of tables, at which S has a digit too many.
fn cutting_speed(cut: &CutConditions, machine: &Machine) -> Option<Diagnostic> {
    let speed = std::f64::consts::PI * machine.diameter_of(cut.tool)? * cut.speed.0 / 1000.0;
    if !exceeds(speed, MAX_CUTTING_SPEED) {
        return None;
    }
    let (tool, actual) = (tool_name(cut.tool), cut.speed.0);
    let message = format!("{tool} cuts at {speed:.0} m/min (S{actual}), more than {MAX_CUTTING_SPEED:.0}");
    let finding = Diagnostic::new(&DRILL_SPEED, message).with_severity(Severity::Warning);
    Some(finding.help("check S, and the tool's diameter in the machine file; speed in the job states it"))
}

fn feed(cut: &CutConditions, limits: &ProcessLimits, _: &Machine) -> Option<Diagnostic> {
    let nominal = limits.tool_process(cut.tool)?.feed?;
    let ratio = |actual: &f64| (actual / nominal).max(nominal / actual);
    let actual =
        cut.feed_range.map(|feed| feed.0).into_iter().max_by(|a, b| ratio(a).total_cmp(&ratio(b)))?;
    let severity = severity(actual, nominal)?;
    let message = format!(
        "{} feeds at {} mm/min; the job specifies {nominal} mm/min",
        tool_name(cut.tool),
        round_thousandth(actual)
    );
    let finding = Diagnostic::new(&DRILL_FEED, message).with_severity(severity);
    Some(finding.help("correct F, or the tool's feed in the job; check that G94 and G21 are in force"))
}

/// Reports a feed per revolution of several times what tables of cutting data give; an error above the diameter, of a drill above
/// a quarter of it.
fn feed_per_turn(cut: &CutConditions, machine: &Machine, width: Option<f64>) -> Option<Diagnostic> {
    let kind = machine.kind_of(cut.tool);
    let [_, (feed, speed)] = cut.extremes;
    if !is_fed_by_turns(cut, machine) || speed.0 <= 0.0 {
        return None;
    }
    let per_turn = feed.0 / speed.0;
    let diameter = machine.diameter_of(cut.tool);
    let limit = match (diameter, kind) {
        (Some(diameter), Some(ToolKind::Drill)) => (0.1 * diameter).max(0.2),
        (Some(diameter), _) => (0.2 * diameter).max(0.5),
        // A tap of unknown kind advances by its pitch, which is below a quarter of its diameter.
        (None, _) => width.map_or(MAX_FEED_PER_TURN, |width| (0.25 * width).clamp(0.5, MAX_FEED_PER_TURN)),
    };
    let is_drill = kind == Some(ToolKind::Drill);
    let most = match diameter {
        Some(diameter) if is_drill => MAX_DRILL_FEED_SHARE * diameter,
        Some(diameter) => diameter,
        None => width.map_or(MAX_FEED_PER_TURN, |width| width.min(MAX_FEED_PER_TURN)),
    };
    let is_too_fast = is_drill && exceeds(feed.0, MAX_DRILL_FEED);
    let is_impossible = is_too_fast || exceeds(per_turn, most.max(limit));
    if !is_impossible && !exceeds(per_turn, limit) {
        return None;
    }
    let message = format!(
        "{} feeds {} mm a revolution ({} mm/min at S{})",
        tool_name(cut.tool),
        round_thousandth(per_turn),
        round_thousandth(feed.0),
        speed.0
    );
    let severity = if is_impossible { Severity::Error } else { Severity::Warning };
    Some(Diagnostic::new(&DRILL_FEED, message).with_severity(severity).help(
        "check F and S, whether F is left from another tool, and whether G95 is in force instead of G94",
    ))
}

/// Returns true if a tool other than a tap cuts while it turns.
fn is_fed_by_turns(cut: &CutConditions, machine: &Machine) -> bool {
    let is_tap = cut.is_tapping || machine.kind_of(cut.tool) == Some(ToolKind::Tap);
    !is_tap && cut.spindle_direction != SpindleDirection::Off
}

/// Reports a feed per revolution so small that the edges rub and cut no chip, as of an F without its decimal point.
fn rubbing_feed(cut: &CutConditions, limits: &ProcessLimits, machine: &Machine) -> Option<Diagnostic> {
    let [(feed, speed), _] = cut.extremes;
    let is_specified = limits.tool_process(cut.tool).and_then(|tool| tool.feed).is_some();
    if is_specified || !is_fed_by_turns(cut, machine) || speed.0 <= 0.0 || feed.0 <= 0.0 {
        return None;
    }
    let share = machine.diameter_of(cut.tool).map(|diameter| LEAST_FEED_SHARE * diameter);
    let limit = match machine.kind_of(cut.tool) {
        Some(ToolKind::Drill) => share,
        _ => share.map(|share| share.min(LEAST_FEED)),
    };
    let (per_turn, limit) = (feed.0 / speed.0, limit.unwrap_or(LEAST_OPEN_FEED));
    if !exceeds(limit, per_turn) {
        return None;
    }
    let message = format!(
        "{} feeds {} µm a revolution ({} mm/min at S{}), limit {}",
        tool_name(cut.tool),
        round_thousandth(per_turn * 1e3),
        round_thousandth(feed.0),
        speed.0,
        round_thousandth(limit * 1e3)
    );
    let finding = Diagnostic::new(&DRILL_FEED, message).with_severity(Severity::Warning);
    Some(finding.note("the edges rub and cut no chip").help(
        "check F for a missing decimal point, which counts in thousandths, and whether G94 is in force instead of G95",
    ))
}

fn peck(cut: &CutConditions, limits: &ProcessLimits, _: &Machine) -> Option<Diagnostic> {
    let nominal = limits.tool_process(cut.tool)?.peck?;
    if let Some(severity) = severity(cut.max_cut, nominal).filter(|_| nominal < cut.max_cut) {
        let message = format!(
            "{} drills {} mm without retracting; the job specifies pecks of {nominal} mm",
            tool_name(cut.tool),
            round_thousandth(cut.max_cut)
        );
        let finding = Diagnostic::new(&DRILL_PECK, message).with_severity(severity);
        return Some(finding.help("use G83 with the job's peck as Q, or correct drill.peck in the job"));
    }
    let peck = cut.min_peck.filter(|peck| *peck < nominal && severity(*peck, nominal).is_some())?;
    let message = format!(
        "{} drills in pecks of {} mm; the job specifies {nominal} mm",
        tool_name(cut.tool),
        round_thousandth(peck)
    );
    let finding = Diagnostic::new(&DRILL_PECK, message).with_severity(Severity::Warning);
    let finding = finding.note("this costs time, and chips are cut twice");
    Some(finding.help("correct Q, or drill.peck in the job; check Q for a missing decimal point"))
}

/// Reports pecks too short for any drill: Q without its decimal point.
fn fine_peck(cut: &CutConditions, limits: &ProcessLimits, machine: &Machine) -> Option<Diagnostic> {
    if limits.tool_process(cut.tool).and_then(|tool| tool.peck).is_some() {
        return None;
    }
    let share = machine.diameter_of(cut.tool).map_or(0.0, |diameter| diameter * LEAST_PECK_SHARE);
    let peck = cut.min_peck.filter(|peck| *peck <= LEAST_PECK.max(share))?;
    let message = format!("{} drills in pecks of {} mm", tool_name(cut.tool), round_thousandth(peck));
    Some(Diagnostic::new(&DRILL_PECK, message).with_severity(Severity::Warning).help(
        "correct Q: without a decimal point it counts the control's increment, and Q5 is 0.005 mm, not 5 mm",
    ))
}

/// Reports a tool that the job does not have, or none.
fn tool(cut: &CutConditions, limits: &ProcessLimits, _: &Machine) -> Option<Diagnostic> {
    let specified: Vec<u32> =
        limits.tools.iter().filter(|tool| tool.offset.is_some()).map(|tool| tool.number).collect();
    let first = specified.first().filter(|_| cut.tool.is_none_or(|tool| !specified.contains(&tool)))?;
    let names: Vec<_> = specified.iter().map(|number| format!("T{number}")).collect();
    let names = names.join(", ");
    Some(match cut.tool {
        None => {
            let message = format!("the part is cut before the first tool change; the job specifies {names}");
            Diagnostic::new(&JOB_TOOL, message)
                .note("the tool in the spindle at the start is unknown")
                .help(format!("command T{first} M06 before the first hole"))
        }
        Some(number) => Diagnostic::new(&JOB_TOOL, format!("T{number} cuts; the job specifies {names}"))
            .note("speed and feed of this tool are not specified")
            .help("use the job's tool, or correct its number in the job"),
    })
}

/// Returns the severity of a speed or feed that deviates; `None` within rounding.
pub(in crate::verify) fn severity(actual: f64, nominal: f64) -> Option<Severity> {
    match (actual - nominal).abs() / nominal {
        off if off <= ROUNDING_ALLOWANCE => None,
        off if off <= ERROR_RATIO => Some(Severity::Warning),
        _ => Some(Severity::Error),
    }
}

/// Reports the number of a length offset that cannot be the tool's. If the machine file gives the tool's length, the
/// depth of the holes shows whether the offset is right.
fn length(cut: &CutConditions, limits: &ProcessLimits, machine: &Machine) -> Option<Diagnostic> {
    if machine.length_of(cut.tool).is_some() {
        return None;
    }
    let specified = limits.tool_process(cut.tool).and_then(|tool| tool.offset);
    let tool = tool_name(cut.tool);
    let (severity, message, help) = match (cut.compensation, specified) {
        (LengthCompensation::Minus(h), specified) => (
            if specified.is_some() { Severity::Error } else { Severity::Warning },
            format!("{tool} cuts with G44 H{h}: its length is subtracted instead of added"),
            "use G43, if the offsets are measured as lengths".to_owned(),
        ),
        (LengthCompensation::Off | LengthCompensation::Plus(0), Some(own)) => (
            Severity::Warning,
            format!("{tool} cuts without a length offset; the job specifies H{own}"),
            format!(
                "command G43 H{own} before the first hole, unless the work zero is set for this tool's tip"
            ),
        ),
        (LengthCompensation::Plus(h), Some(own)) if h != own => (
            Severity::Error,
            format!("{tool} cuts with H{h}, the length of another tool; the job specifies H{own}"),
            format!("command G43 H{own}, or correct the tool's number in the job"),
        ),
        (LengthCompensation::Plus(h), None) if h != 0 => {
            let number = cut.tool.filter(|number| *number != h)?;
            // Without a tool table numbers alone show the tool.
            if !machine.tools.is_empty() {
                machine.find_tool(h)?;
            }
            (
                Severity::Warning,
                format!("{tool} cuts with H{h}, the number of another tool"),
                format!("command H{number}, if offsets have the numbers of their tools"),
            )
        }
        (LengthCompensation::Off | LengthCompensation::Plus(_), _) => return None,
    };
    let note = "the machine file does not give the tool's length, so the simulated holes do not depend on \
                the length offset";
    Some(Diagnostic::new(&LENGTH_OFFSET, message).with_severity(severity).note(note).help(help))
}

/// Reports a tool of unknown length that cuts without a length offset where the program uses lengths: another tool of unknown
/// length cuts with one, this one has had one, or the program sets its length.
fn without_offset(
    cut: &CutConditions,
    offsets: &[&CutConditions],
    inspection: &HoleInspection<'_>,
) -> Option<Diagnostic> {
    let HoleInspection { extraction, machine, reference, .. } = inspection;
    let is_specified = reference.process_limits.tool_process(cut.tool).and_then(|tool| tool.offset).is_some();
    let is_open = |tool| machine.length_of(tool).is_none();
    // Where the job has the offset, another finding says so.
    if cut.compensation.number().is_some() || is_specified || !is_open(cut.tool) {
        return None;
    }
    let has_offset = |other: &&&CutConditions| {
        other.compensation.number().is_some() && is_open(other.tool) && other.tool != cut.tool
    };
    let own = cut.tool.filter(|tool| extraction.program_lengths.contains(tool));
    let reason = match (offsets.iter().find(has_offset), own) {
        (Some(other), _) => format!("{} with one", tool_name(other.tool)),
        (None, Some(h)) => format!("the program sets the length of H{h}"),
        (None, None) if extraction.offset_tools.contains(&cut.tool) => {
            "the program moves it by one before or after it".to_owned()
        }
        (None, None) => return None,
    };
    let message = format!("{} cuts without a length offset, and {reason}", tool_name(cut.tool));
    Some(Diagnostic::new(&LENGTH_OFFSET, message).help(
        "command G43 with the tool's H before the cut, or give the lengths of the tools in the machine file",
    ))
}

/// Rounds a length of a list, which may have been in inches, to ten-thousandths.
pub(super) fn to_places(value: f64) -> f64 {
    (value * 1e4).round() / 1e4
}

/// Rounds to a thousandth; −0 becomes 0.
pub(in crate::verify) fn round_thousandth(value: f64) -> f64 {
    (value * 1e3).round() / 1e3 + 0.0
}
