//! The pages of `explain`: one for every alarm and every finding, with examples that raise it.
use std::collections::BTreeSet;
use std::path::PathBuf;

use gcode_control::Outcome;
use gcode_inspect::machine::Machine;
use gcode_inspect::verify::Tolerances;
use gcode_lang::diag::{Diagnostic, Severity};
use gcode_lang::program::NoLibrary;
use gcode_part::NominalPart;
use gcode_part::ProbedPart;
use gcode_review::kinds;
use gcode_session::{Request, grind, read_stylus, simulate};
use gcode_sim::report::explain::{self, Page};
use gcode_tests::{expect, files_below, workspace};

fn is_finding(page: &Page) -> bool {
    matches!(page.code, "assumption" | "limit") || page.code.contains('-')
}

#[test]
fn every_page_has_its_row_and_every_code_is_listed_once() {
    let listed: Vec<String> = explain::findings().iter().map(|page| page.code.to_owned()).collect();
    let codes: BTreeSet<String> = listed.iter().cloned().collect();
    assert_eq!(codes.len(), listed.len(), "{listed:?}");
    let folder = workspace().join("docs/explain");
    let page = |path: &PathBuf| path.strip_prefix(&folder).unwrap().with_extension("").display().to_string();
    let files: BTreeSet<String> = files_below(&folder, "md").iter().map(page).collect();
    assert_eq!(files, codes, "a file that no row has");
}

#[test]
fn every_change_has_its_section_and_every_section_its_change() {
    let page = std::fs::read_to_string(workspace().join("docs/changes.md")).unwrap();
    let headings: Vec<&str> = page.lines().filter_map(|line| line.strip_prefix("## ")).collect();
    let rows: Vec<String> = kinds::ALL.iter().map(|kind| format!("{}: {}", kind.code, kind.title)).collect();
    assert_eq!(headings, rows, "docs/changes.md");
    for page in explain::changes() {
        assert!(page.text.contains("\n**Look at:** "), "{}: what to do", page.code);
    }
}

#[test]
fn a_code_with_two_meanings_is_explained_with_both() {
    let titles: Vec<_> = explain::pages("hole-depth").map(|page| page.title).collect();
    assert_eq!(titles.len(), 2, "{titles:?}");
    assert_eq!(explain::pages("ps112").count(), 1);
    assert_eq!(explain::pages("no-such-code").count(), 0);
}

/// Largest width of a page's line, columns.
const PAGE_WIDTH: usize = 110;

#[test]
fn every_page_has_its_headings_and_two_programs() {
    for page in explain::findings() {
        let file = format!("docs/explain/{}.md", page.code);
        for heading in ["## Raises it", "## Write instead"] {
            let has_heading = page.text.lines().any(|line| line == heading);
            assert!(has_heading, "{file}: no heading `{heading}`; hole-cut-aside.md has all of them");
        }
        let programs = page.fenced("nc").len();
        assert_eq!(
            programs, 2,
            "{file}: {programs} programs fenced as nc: one that raises it, one that doesn't"
        );
    }
}

#[test]
fn every_line_that_explain_prints_is_within_its_width() {
    for page in explain::all() {
        for line in page.text.lines().filter(|line| !line.starts_with('|')) {
            let width = line.chars().count();
            assert!(width <= PAGE_WIDTH, "{}: {width} columns, limit {PAGE_WIDTH}: {line}", page.code);
        }
    }
}

#[test]
fn the_first_program_raises_the_alarm_and_the_second_ends() {
    for page in explain::findings().iter().filter(|page| !is_finding(page)) {
        let run = |program: &&str| match page.fenced("toml").is_empty() {
            true => expect::run(program.as_bytes()).outcome,
            false => on_a_machine(page, program),
        };
        let programs: Vec<_> = page.fenced("nc").iter().map(run).collect();
        match &programs[0] {
            Outcome::Alarm(stopped) => {
                let code = stopped.alarm.code().to_string();
                let found = explain::find(&code).map(|p| p.code);
                assert_eq!(found, Some(page.code), "{} raises {code} {}", page.code, stopped.alarm);
            }
            other => panic!("{} raises nothing: {other:?}", page.code),
        }
        assert!(matches!(programs[1], Outcome::End), "{}: {:?}", page.code, programs[1]);
    }
}

/// How a program ends on the page's machine, with the page's part on it.
fn on_a_machine(page: &Page, program: &str) -> Outcome {
    let (jobs, machines): (Vec<&str>, Vec<&str>) =
        page.fenced("toml").into_iter().partition(|text| text.starts_with("family"));
    let machine = Machine::parse(machines[0]).unwrap();
    let mut request = Request::new("example.nc", program.as_bytes(), machine);
    request.part = jobs.first().map(|job| ProbedPart::parse(job, None).unwrap().solid);
    simulate(&request, &mut NoLibrary, None).unwrap().run.outcome
}

/// What is found on a page's first or second program, against its reference on its machine, or the second on the second.
fn findings_on(page: &Page, number: usize) -> Vec<Diagnostic> {
    let program = page.fenced("nc")[number];
    let (jobs, machines): (Vec<&str>, Vec<&str>) =
        page.fenced("toml").into_iter().partition(|text| text.starts_with("family"));
    let machine = machines
        .get(number)
        .or(machines.first())
        .map_or_else(Machine::default, |text| Machine::parse(text).unwrap());
    // A finding on the reference itself has a second one without it.
    let job = jobs.get(number).or(jobs.first()).copied();
    let nominal =
        page.fenced("csv").into_iter().chain(job).next().map(|text| NominalPart::parse(text).unwrap());
    let mut request = Request::new("example.nc", program.as_bytes(), machine.clone());
    if let Some(NominalPart::Flutes(flutes)) = &nominal {
        return grind(&request, &mut NoLibrary, flutes).unwrap().verify(&request).diagnostics;
    }
    let reference = nominal.and_then(NominalPart::into_holes);
    // Of a job on these pages only the surface counts, or the pattern.
    let surface = reference.as_ref().and_then(|reference| reference.surface);
    if let (Some(surface), Some(probe)) = (surface, &machine.probe) {
        return read_stylus(&request, &mut NoLibrary, surface, probe.radius).unwrap().readings.findings;
    }
    request.process_limits =
        reference.as_ref().map(|reference| reference.process_limits.clone()).unwrap_or_default();
    let metal = reference.as_ref().map(|reference| request.metal(reference)).unwrap_or_default();
    let simulation = simulate(&request, &mut NoLibrary, metal).unwrap();
    match reference {
        Some(reference)
            if surface.is_none() || reference.pattern.is_some() || page.code.starts_with("hole-") =>
        {
            request.denies_assumptions = page.code == "assumption";
            simulation.verify(&reference, Tolerances::of(&reference, None), &request).diagnostics
        }
        _ => simulation.extracted.findings,
    }
}

#[test]
fn the_first_program_has_the_finding_and_the_second_none() {
    let mut wrong = String::new();
    for page in explain::findings().iter().filter(|page| is_finding(page)) {
        let codes: Vec<_> = findings_on(page, 0).iter().map(Diagnostic::code).collect();
        if !codes.iter().any(|code| code == page.code) {
            wrong.push_str(&format!("{}: the first gives {codes:?}\n", page.code));
        }
        let good: Vec<_> = findings_on(page, 1)
            .into_iter()
            .filter(|f| Severity::Note < f.severity)
            .map(|f| (f.code(), f.message))
            .collect();
        if !good.is_empty() {
            wrong.push_str(&format!("{}: the second gives {good:?}\n", page.code));
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}
