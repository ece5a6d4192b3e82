//! `check` on the programs of this repository: no finding in macros and examples, a case for each rule.
use gcode_lang::control::Settings;
use gcode_lang::diag::Severity;
use gcode_lang::program::NoLibrary;
use gcode_lint::rules::ALL;
use gcode_lint::{CheckResult, check};
use gcode_sim::cli::library::Folders;
use gcode_tests::{files_below, workspace};

fn messages(checked: &CheckResult) -> Vec<String> {
    checked.findings.iter().map(|f| format!("{}: {}", f.code(), f.message)).collect()
}

#[test]
fn macros_and_examples_have_no_findings() {
    // The program with a wrong digit calls the macros beside the right one, a repository's parts its macros.
    let beside =
        ["melon-mould", "nc-repository/macros"].map(|folder| workspace().join("examples").join(folder));
    let all =
        ["macros", "examples"].into_iter().flat_map(|folder| files_below(&workspace().join(folder), "nc"));
    let mut seen = 0;
    // What was published is wrong on purpose: docs/examples/published-honeycomb.md shows what is found in it.
    let published = workspace().join("examples/published-honeycomb");
    for path in all.filter(|path| !path.starts_with(&published) || path.ends_with("O8300.nc")) {
        let mut folders = Folders::new(&path, &beside).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        let checked = check(path.display().to_string(), bytes, &Settings::default(), &mut folders);
        // The effect of a clamp's M code is the machine builder's: a note.
        let faults = checked.findings.iter().filter(|f| Severity::Note < f.severity);
        assert_eq!(faults.map(|f| &f.message).collect::<Vec<_>>(), [""; 0], "{}", path.display());
        seen += 1;
    }
    assert!(seen > 5);
}

#[test]
fn a_fault_put_into_an_example_is_found() {
    let path = workspace().join("examples/melon-mould/O8100.nc");
    let text = std::fs::read_to_string(&path).unwrap();
    let faults = [
        (
            " W21.6405",
            "",
            "missing-argument: O8101 needs W (#23): if it is omitted, the program stops with MC3010 (W MISSING)",
        ),
        ("D15. C2. V50. F10.", "D15. C2 V50. F10.", "missing-point: C2 is 0.002 for the macro"),
        ("G65 P8102", "G65 P8103", "missing-program: PS0076: program O8103 is not found"),
        (
            "Y[724.3+0.+50.]",
            "Y(724.3+0.+50.)",
            "round-brackets: PS0005: address Y has no number: round brackets are a comment",
        ),
        (
            "N380 M30",
            "N370 M30",
            "doubled-n: N370 is already defined in line 65: a search finds one of the two",
        ),
    ];
    for (right, wrong, found) in faults {
        let spoilt = text.replacen(right, wrong, 1);
        assert_ne!(spoilt, text, "{right}");
        let mut folders = Folders::new(&path, &[]).unwrap();
        let checked = check("O8100.nc", spoilt.into_bytes(), &Settings::default(), &mut folders);
        assert_eq!(messages(&checked), [found]);
    }
}

#[test]
fn every_rule_has_a_case() {
    let suite = workspace().join("tests/suite/check");
    let mut found = String::new();
    for entry in std::fs::read_dir(suite).unwrap() {
        let path = entry.unwrap().path().join("findings.snap");
        found += &std::fs::read_to_string(&path)
            .unwrap_or_else(|e| panic!("{}: {e}; cargo xtask bless -- check/NAME writes it", path.display()));
    }
    for rule in ALL {
        let severities = [Severity::Error, Severity::Warning, Severity::Note].map(Severity::name);
        let finds = severities.iter().any(|name| found.contains(&format!("  {name} {}:", rule.kind)));
        assert!(finds, "no case in tests/suite/check finds {}", rule.kind);
    }
}

/// Every file can be checked; the cases of the suite have every kind of fault.
#[test]
fn every_program_of_the_suite_can_be_checked() {
    for path in files_below(&workspace().join("tests/suite"), "nc") {
        let bytes = std::fs::read(&path).unwrap();
        let whole = check("whole", bytes.clone(), &Settings::default(), &mut NoLibrary);
        let again = check("whole", bytes.clone(), &Settings::default(), &mut NoLibrary);
        assert_eq!(messages(&whole), messages(&again), "{}", path.display());
        for cut in [bytes.len() / 3, bytes.len() / 2] {
            check("cut", bytes[cut..].to_vec(), &Settings::default(), &mut NoLibrary);
        }
    }
}
