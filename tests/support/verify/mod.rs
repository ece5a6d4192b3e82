//! Cases of kind `verify`: a program compared with a reference; the expected findings are computed by hand.
//!
//! `case.nc` is the program (programs it calls stand in the same file). `expect.txt` names, in the words of
//! `expected_verdict`, the machine and the reference in `suite/verify/`, and the verdict.
//! A machine or a reference that only one case has stands beside its program: `machine.toml`, `reference.toml` or `.csv`.
//! Without a reference the case lists the holes that the program makes.
mod expected_verdict;

use std::fmt::Write as _;
use std::path::Path;

use gcode_inspect::machine::Machine;
use gcode_inspect::verify::flutes::FluteVerdict;
use gcode_inspect::verify::{Answer, Finding, HoleVerdict, Verdict};
use gcode_lang::diag::Diagnostic;
use gcode_lang::motion::{Backtrace, Call};
use gcode_lang::program::NoLibrary;
use gcode_part::{Assumption, AssumptionPlace, NominalPart, Reference};
use gcode_session::{
    Criteria, Request, Run, Simulation, complete_depths, judge_flutes, judge_holes, simulate,
};
use gcode_sim::report::flute_table;
use gcode_sim::report::verdict_table::{Layout, table};

use self::expected_verdict::{ActualVerdict, FindingLine, has_layout};
use crate::Case;

pub(crate) fn run(case: &Case) {
    let text = case.text("expect.txt");
    let mut machine =
        machine_of(&case.dir).map_or_else(Machine::default, |text| Machine::parse(&text).unwrap());
    let starts = text.lines().filter_map(|line| line.strip_prefix("start ")).flat_map(str::split_whitespace);
    machine.start.extend(starts.map(|start| {
        let (letter, position) = start.split_once('=').unwrap();
        let axis = machine.axes.find(letter.as_bytes()[0]).unwrap();
        (axis, position.parse::<f64>().unwrap())
    }));
    let request = Request::new("case.nc", case.bytes("case.nc"), machine.clone());
    let of_motion = text.lines().any(|line| line == "reference none").then(Reference::without_holes);
    let nominal = match of_motion {
        Some(reference) => Some(NominalPart::Holes(reference)),
        None => reference_of(&case.dir).map(|text| NominalPart::parse(&text).unwrap()),
    };
    let (actual, layout) = match nominal {
        Some(NominalPart::Flutes(flutes)) => {
            let (grinding, verdict) = judge_flutes(&request, &mut NoLibrary, &flutes).unwrap();
            inspect_flutes(&verdict, &grinding.run)
        }
        Some(nominal) => {
            let mut reference = nominal.into_holes().unwrap();
            complete_depths(&request, &mut NoLibrary, &mut reference).unwrap();
            let criteria = Criteria::of(&reference);
            let (simulation, verdict) =
                judge_holes(&request, &mut NoLibrary, criteria, &mut (), &mut ()).unwrap();
            inspect_holes(&verdict, &simulation.run)
        }
        None => list_holes(&simulate(&request, &mut NoLibrary, None).unwrap()),
    };
    let differences = actual.differences(&text);
    assert!(differences.is_empty(), "{}:\n{}\n{layout}", case.name(), differences.join("\n"));
    let has_layout = has_layout(&text);
    assert!(has_layout || case.optional("verdict.snap").is_none(), "{}: no line 'layout'", case.name());
    if has_layout {
        case.snapshot("verdict", &layout);
    }
}

/// Returns the machine file of a program in `folder`.
pub fn machine_of(folder: &Path) -> Option<String> {
    file_of(folder, "machine", &["machine.toml"])
}

/// Returns the reference of a program in `folder`.
pub fn reference_of(folder: &Path) -> Option<String> {
    file_of(folder, "reference", &["reference.toml", "reference.csv", "reference.json"])
}

/// Returns the file beside the folders of the cases that a line of `expect.txt` names, else the folder's own.
fn file_of(folder: &Path, word: &str, own: &[&str]) -> Option<String> {
    let expected = std::fs::read_to_string(folder.join("expect.txt")).unwrap_or_default();
    let named = expected.lines().find_map(|line| line.strip_prefix(word)?.strip_prefix(' '));
    if named == Some("none") {
        return None;
    }
    if let Some(named) = named {
        let path = folder.parent().unwrap().join(named);
        return Some(std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display())));
    }
    own.iter().find_map(|name| std::fs::read_to_string(folder.join(name)).ok())
}

fn inspect_holes(verdict: &Verdict, run: &Run) -> (ActualVerdict, String) {
    let good = verdict.holes.iter().filter(|hole| hole.ok).count();
    let mut summary =
        format!("{} {good} of {}", answer(verdict.verdict), verdict.holes.len() + verdict.missing.len());
    let folded = verdict.findings.len() - verdict.diagnostics.len();
    for (count, what) in
        [(verdict.missing.len(), "missing"), (verdict.extra.len(), "extra"), (folded, "folded")]
    {
        if count != 0 {
            write!(summary, ", {count} {what}").unwrap();
        }
    }
    let mut facts: Vec<_> =
        verdict.holes.iter().map(|hole| (format!("hole {}", hole.id), deviations(hole))).collect();
    if let Some(neighbours) = &verdict.neighbours {
        let distances =
            [&neighbours.min, &neighbours.max].map(|extreme| extreme.as_ref().map(|found| found.distance));
        let found = [
            ("six", Some(neighbours.with_six as f64)),
            ("inner", Some(neighbours.with_six_nominal as f64)),
            ("nearest", distances[0]),
            ("farthest", distances[1]),
        ];
        facts.push(("neighbours".to_owned(), known_facts(found)));
    }
    let actual = ActualVerdict {
        summary: Some(summary),
        findings: finding_lines(&verdict.diagnostics, &verdict.findings, run),
        missing: verdict.missing.clone(),
        not_checked: verdict.not_checked.clone(),
        assumptions: verdict.assumptions.iter().map(assumption_line).collect(),
        facts,
        made: Vec::new(),
    };
    let shown = table(verdict, Layout::default());
    (actual, with_findings(shown, &verdict.diagnostics, run))
}

fn assumption_line(assumption: &Assumption) -> String {
    let Assumption { what, place: AssumptionPlace { program, line }, decides, .. } = assumption;
    format!("{what} at {} decides {}", place_label(program, *line), decides.join(" ")).trim_end().to_owned()
}

fn deviations(hole: &HoleVerdict) -> Vec<(&'static str, f64)> {
    let [dx, dy, dz] = [0, 1, 2].map(|i| hole.actual.entry[i] - hole.nominal.entry[i]);
    vec![
        ("phi", hole.position_deviation),
        ("entry", hole.at_entry),
        ("bottom", hole.at_bottom),
        ("tilt", hole.tilt),
        ("depth", hole.depth_error),
        ("dx", dx),
        ("dy", dy),
        ("dz", dz),
    ]
}

fn inspect_flutes(verdict: &FluteVerdict, run: &Run) -> (ActualVerdict, String) {
    let found = [
        ("contact", verdict.surface_deviation),
        ("helix_min", verdict.helix_min),
        ("helix_max", verdict.helix_max),
        ("index", verdict.index_error),
        ("speed_min", verdict.speed_min),
        ("speed_max", verdict.speed_max),
        ("nearest", verdict.nearest),
        ("passes", Some(verdict.passes as f64)),
        ("moves", Some(verdict.moves as f64)),
    ];
    let actual = ActualVerdict {
        summary: Some(format!(
            "{} {} of {}",
            answer(verdict.verdict),
            verdict.flutes,
            verdict.nominal_flutes
        )),
        findings: finding_lines(&verdict.diagnostics, &verdict.findings, run),
        missing: Vec::new(),
        not_checked: verdict.not_checked.clone(),
        assumptions: verdict.assumptions.iter().map(assumption_line).collect(),
        facts: vec![("burr".to_owned(), known_facts(found))],
        made: Vec::new(),
    };
    let shown = flute_table::table(verdict);
    (actual, with_findings(shown, &verdict.diagnostics, run))
}

/// Lists the holes that a program without a reference makes.
fn list_holes(simulation: &Simulation) -> (ActualVerdict, String) {
    let mut text = String::new();
    let mut made = Vec::new();
    for hole in simulation.hole_list().holes {
        let ([x, y, z], [i, j, k]) = (hole.entry.map(|v| v + 0.0), hole.axis.map(|v| v + 0.0));
        let (depth, from) = (hole.depth, hole.from.unwrap());
        let tool = from.tool.map_or(String::new(), |tool| format!(", T{tool}"));
        let line = format!(
            "hole from {x:.3} {y:.3} {z:.3}, axis {i:.4} {j:.4} {k:.4}, {depth:.3} deep: {} line {}{tool}",
            from.program, from.line
        );
        writeln!(text, "{}", line.replace("-0.000 ", "0.000 ").replace("-0.0000", "0.0000")).unwrap();
        let by = from.tool.map_or(String::new(), |tool| format!(" by T{tool}"));
        let at = place_label(&from.program, from.line) + &by;
        let mut numbers = vec![("x", x), ("y", y), ("z", z), ("i", i), ("j", j), ("k", k), ("depth", depth)];
        numbers.extend(hole.diameter.map(|diameter| ("diameter", diameter)));
        made.push((at, numbers));
    }
    let findings = &simulation.extracted.findings;
    let actual = ActualVerdict {
        summary: None,
        findings: finding_lines(findings, &[], &simulation.run),
        missing: Vec::new(),
        not_checked: Vec::new(),
        assumptions: Vec::new(),
        facts: Vec::new(),
        made,
    };
    (actual, with_findings(text, findings, &simulation.run))
}

fn answer(answer: Answer) -> &'static str {
    match answer {
        Answer::Pass => "PASS",
        Answer::Fail => "FAIL",
    }
}

fn known_facts<const N: usize>(facts: [(&'static str, Option<f64>); N]) -> Vec<(&'static str, f64)> {
    facts.into_iter().filter_map(|(key, value)| Some((key, value?))).collect()
}

/// Returns findings as `error hole-depth at O6:13 from O5:6 of r1h0`, with their messages and notes.
fn finding_lines(shown: &[Diagnostic], data: &[Finding], run: &Run) -> Vec<FindingLine> {
    let one = |finding: &Diagnostic| {
        let mut head = format!("{} {}", finding.severity.name(), finding.code());
        if let Some(place) = &finding.backtrace {
            let mut word = " at ";
            for (program, line, _) in places(run, place) {
                write!(head, "{word}{}", place_label(&program, line)).unwrap();
                word = " from ";
            }
        }
        let same = |one: &&Finding| one.code == finding.code() && one.message == finding.message;
        if let Some(hole) = data.iter().find(same).and_then(|one| one.hole.as_ref()) {
            write!(head, " of {hole}").unwrap();
        }
        let text = format!("{}\n{}", finding.message, finding.notes.join("\n"));
        FindingLine { head, text, help: finding.help.clone().unwrap_or_default() }
    };
    shown.iter().map(one).collect()
}

/// Returns `O5:6` for line 6 of O0005.
fn place_label(program: &str, line: u32) -> String {
    let number = program.strip_prefix('O').map(|digits| digits.trim_start_matches('0'));
    number.map_or_else(|| format!("{program}:{line}"), |number| format!("O{number}:{line}"))
}

/// Appends the findings with their blocks to the table.
fn with_findings(mut shown: String, findings: &[Diagnostic], run: &Run) -> String {
    for finding in findings {
        let severity = finding.severity.name();
        write!(shown, "\n{severity} {}: {}\n", finding.code(), finding.message).unwrap();
        if let Some(place) = &finding.backtrace {
            let mut word = "at";
            for (program, line, text) in places(run, place) {
                writeln!(shown, "  {word} {program} line {line}: {text}").unwrap();
                word = "called from";
            }
        }
        finding.notes.iter().for_each(|note| writeln!(shown, "  {note}").unwrap());
        finding.help.iter().for_each(|help| writeln!(shown, "  help: {help}").unwrap());
    }
    shown
}

/// Returns program, line and text of a block, and of the calls that led to it, innermost first.
fn places(run: &Run, place: &Backtrace) -> Vec<(String, u32, String)> {
    let calls = std::iter::successors(place.calls.as_deref(), |call: &&Call| call.outer_calls.as_deref());
    let blocks = std::iter::once(place.block).chain(calls.map(|call| call.calling_block));
    let located = blocks.map(|block| {
        let (program, line) = run.locate(block);
        (program, line, run.control.memory().sources().text(block).trim().to_owned())
    });
    located.collect()
}
