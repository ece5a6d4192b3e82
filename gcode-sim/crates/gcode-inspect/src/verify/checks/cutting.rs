//! While a tool cuts it turns and is fed as the reference says of it, and the right length offset is in force.
use std::collections::BTreeMap;

use super::{HoleFinding, HoleInspection};
use crate::findings::{DRILL_FEED, DRILL_PECK, DRILL_SPEED, JOB_TOOL, LENGTH_OFFSET, SPINDLE_REVERSED};
use crate::holes::CutConditions;
use crate::machine::Machine;
use gcode_lang::diag::{Diagnostic, Severity};
use gcode_lang::motion::{LengthCompensation, SpindleDirection};
use gcode_part::ProcessLimits;

/// S and F may be off by this part of what is said: of F what an inch rounds to. More is told, …
const ROUNDING_ALLOWANCE: f64 = 0.005;

/// … and beyond this part it is no other choice but a slip: an error. Tables of cutting data leave so much open.
const ERROR_RATIO: f64 = 0.25;

pub(super) fn check(inspection: &HoleInspection<'_>, findings: &mut Vec<HoleFinding>) {
    let HoleInspection { machine, extraction, reference, .. } = inspection;
    let (cuttings, conduct) = (&extraction.cut_conditions, &reference.process_limits);
    let checks = [reversed, speed, feed, peck, length, tool];
    let found = checks.iter().flat_map(|check| cuttings.iter().map(move |cutting| (check, cutting)));
    let mut told: Vec<(Diagnostic, u64)> = Vec::new();
    let mut known: BTreeMap<String, usize> = BTreeMap::new();
    for (check, cutting) in found {
        let Some(finding) = check(cutting, conduct, machine) else { continue };
        match known.get(&finding.message) {
            Some(index) => told[*index].1 += cutting.count,
            None => {
                known.insert(finding.message.clone(), told.len());
                told.push((finding.with_backtrace(cutting.backtrace.clone()), cutting.count));
            }
        }
    }
    let counted = |(finding, times): (Diagnostic, u64)| match times {
        1 => finding,
        more => finding.note(format!("in {more} cuts; this is the first")),
    };
    findings.extend(told.into_iter().map(counted).map(HoleFinding::of_motion));
}

fn reversed(cutting: &CutConditions, _: &ProcessLimits, _: &Machine) -> Option<Diagnostic> {
    (cutting.spindle_direction == SpindleDirection::Counterclockwise).then(|| {
        Diagnostic::new(&SPINDLE_REVERSED, format!("{} cuts with M04", name(cutting)))
            .note("a right-hand drill rubs and breaks; the reference does not give the hand of the tool")
            .help("use M03, unless the tool is left-hand")
    })
}

fn speed(cutting: &CutConditions, conduct: &ProcessLimits, _: &Machine) -> Option<Diagnostic> {
    let wanted = conduct.tool_process(cutting.tool)?.speed?;
    let found = cutting.speed.0;
    // One that stands is told already.
    let severity = severity(found, wanted).filter(|_| cutting.spindle_direction != SpindleDirection::Off)?;
    let message = format!("{} cuts at S{found}; the job specifies S{wanted}", name(cutting));
    Some(
        Diagnostic::new(&DRILL_SPEED, message)
            .with_severity(severity)
            .help("correct S, or the tool's speed in the job"),
    )
}

fn feed(cutting: &CutConditions, conduct: &ProcessLimits, _: &Machine) -> Option<Diagnostic> {
    let wanted = conduct.tool_process(cutting.tool)?.feed?;
    let off = |found: &f64| (found / wanted).max(wanted / found);
    let found = cutting.feed_range.map(|feed| feed.0).into_iter().max_by(|a, b| off(a).total_cmp(&off(b)))?;
    let severity = severity(found, wanted)?;
    let message = format!(
        "{} feeds at {} mm/min; the job specifies {wanted} mm/min",
        name(cutting),
        (found * 1e3).round() / 1e3
    );
    Some(
        Diagnostic::new(&DRILL_FEED, message)
            .with_severity(severity)
            .help("correct F, or the tool's feed in the job; check that G94 and G21 are in force"),
    )
}

fn peck(cutting: &CutConditions, conduct: &ProcessLimits, _: &Machine) -> Option<Diagnostic> {
    let wanted = conduct.tool_process(cutting.tool)?.peck?;
    let shown = |mm: f64| (mm * 1e3).round() / 1e3;
    if let Some(severity) = severity(cutting.max_cut, wanted).filter(|_| wanted < cutting.max_cut) {
        let message = format!(
            "{} drills {} mm without retracting; the job specifies pecks of {wanted} mm",
            name(cutting),
            shown(cutting.max_cut)
        );
        let finding = Diagnostic::new(&DRILL_PECK, message).with_severity(severity);
        return Some(finding.help("use G83 with the job's peck as Q, or correct drill.peck in the job"));
    }
    let peck = cutting.min_peck.filter(|peck| *peck < wanted && severity(*peck, wanted).is_some())?;
    let message =
        format!("{} drills in pecks of {} mm; the job specifies {wanted} mm", name(cutting), shown(peck));
    Some(
        Diagnostic::new(&DRILL_PECK, message)
            .with_severity(Severity::Warning)
            .note("this costs time, and chips are cut twice")
            .help("correct Q, or drill.peck in the job; check Q for a missing decimal point"),
    )
}

/// Another tool than the job's, or none.
fn tool(cutting: &CutConditions, conduct: &ProcessLimits, _: &Machine) -> Option<Diagnostic> {
    let said: Vec<_> = conduct.tools.iter().filter(|duty| duty.offset.is_some()).collect();
    let [first, ..] = said.as_slice() else { return None };
    if said.iter().any(|duty| Some(duty.number) == cutting.tool) {
        return None;
    }
    let names: Vec<_> = said.iter().map(|duty| format!("T{}", duty.number)).collect();
    let names = names.join(", ");
    Some(match cutting.tool {
        None => Diagnostic::new(
            &JOB_TOOL,
            format!("the part is cut before the first tool change; the job specifies {names}"),
        )
        .note("the tool in the spindle at the start is unknown")
        .help(format!("command T{} M06 before the first hole", first.number)),
        Some(number) => Diagnostic::new(&JOB_TOOL, format!("T{number} cuts; the job specifies {names}"))
            .note("speed and feed of this tool are not specified")
            .help("use the job's tool, or correct its number in the job"),
    })
}

/// How bad it is that S or F is another one than is said; `None` where it will do.
pub(in crate::verify) fn severity(actual: f64, nominal: f64) -> Option<Severity> {
    match (actual - nominal).abs() / nominal {
        off if off <= ROUNDING_ALLOWANCE => None,
        off if off <= ERROR_RATIO => Some(Severity::Warning),
        _ => Some(Severity::Error),
    }
}

/// Where the machine file has the tool's length, the holes tell whether the offset is right; else only its number does.
fn length(cutting: &CutConditions, conduct: &ProcessLimits, machine: &Machine) -> Option<Diagnostic> {
    if machine.length_of(cutting.tool).is_some() {
        return None;
    }
    let asked = conduct.tool_process(cutting.tool).and_then(|duty| duty.offset);
    let tool = name(cutting);
    let note = "the machine file does not give the tool's length, so the simulated holes do not depend on \
                the length offset";
    let finding =
        |severity, message| Diagnostic::new(&LENGTH_OFFSET, message).with_severity(severity).note(note);
    match (cutting.compensation, asked) {
        (LengthCompensation::Minus(h), asked) => {
            let severity = if asked.is_some() { Severity::Error } else { Severity::Warning };
            let message = format!("{tool} cuts with G44 H{h}: its length is subtracted instead of added");
            Some(finding(severity, message).help("use G43, if the offsets are measured as lengths"))
        }
        (LengthCompensation::Off | LengthCompensation::Plus(0), Some(asked)) => {
            let message = format!("{tool} cuts without a length offset; the job specifies H{asked}");
            Some(finding(Severity::Warning, message).help(format!(
                "command G43 H{asked} before the first hole, unless the work zero is set for this tool's tip"
            )))
        }
        (LengthCompensation::Plus(h), Some(asked)) if h != asked => {
            let message =
                format!("{tool} cuts with H{h}, the length of another tool; the job specifies H{asked}");
            Some(
                finding(Severity::Error, message)
                    .help(format!("command G43 H{asked}, or correct the tool's number in the job")),
            )
        }
        (LengthCompensation::Plus(h), None) => {
            let number = cutting.tool.filter(|number| *number != h)?;
            machine.find_tool(h)?;
            let message = format!("{tool} cuts with H{h}, the number of another tool");
            Some(
                finding(Severity::Warning, message)
                    .help(format!("command H{number}, if offsets have the numbers of their tools")),
            )
        }
        (LengthCompensation::Off | LengthCompensation::Plus(_), _) => None,
    }
}

fn name(cutting: &CutConditions) -> String {
    cutting.tool.map_or("the tool".to_owned(), |number| format!("T{number}"))
}
