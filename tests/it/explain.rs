//! The pages of `explain`: one for every alarm, and every example does what its page says.
use std::collections::BTreeSet;
use std::path::Path;

use gcode_sim::exec::Outcome;
use gcode_sim::report::explain::{self, PAGES};
use gcode_tests::expect;

/// The codes that the table of alarms can give; all that programs raise themselves are `MC3000`.
fn table() -> BTreeSet<String> {
    let text = include_str!("../../gcode-sim/src/alarm/table.rs");
    let mut codes = BTreeSet::new();
    for (family, name) in [("Ps(", "PS"), ("Ot(", "OT"), ("Sim(", "SIM")] {
        for rest in text.split(&format!("({family}")).skip(1) {
            let digits: String = rest.chars().take_while(char::is_ascii_digit).collect();
            codes.insert(format!("{name}{:04}", digits.parse::<u32>().unwrap()));
        }
    }
    codes.insert("MC3000".to_owned());
    codes
}

#[test]
fn every_alarm_has_its_page_and_every_page_its_alarm() {
    let listed: Vec<String> = PAGES.iter().map(|page| page.code.to_owned()).collect();
    let mut sorted = listed.clone();
    sorted.sort();
    assert_eq!(listed, sorted, "pages stand in the order of their codes");
    let listed: BTreeSet<String> = listed.into_iter().collect();
    assert!(table().len() > 50, "the codes in alarm/table.rs were found");
    assert_eq!(listed, table(), "a page in docs/explain/ and a line in report/explain.rs for each alarm");
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/explain");
    let files: BTreeSet<String> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path().file_stem().unwrap().to_string_lossy().into_owned())
        .collect();
    assert_eq!(files, listed, "a file that no one shows, or a page without its file");
}

#[test]
fn every_page_begins_with_its_code_and_has_two_programs() {
    for page in PAGES {
        assert!(page.text.starts_with(&format!("# {}: ", page.code)), "{}", page.code);
        assert_eq!(page.programs().count(), 2, "{}", page.code);
        assert!(page.text.contains("\n## Raises it\n"), "{}", page.code);
        assert!(page.text.contains("\n## Write instead\n"), "{}", page.code);
        assert!(page.text.lines().all(|line| line.chars().count() <= 110), "{}: a long line", page.code);
    }
}

#[test]
fn the_first_program_raises_the_alarm_and_the_second_ends() {
    for page in PAGES {
        let programs: Vec<_> = page.programs().map(|p| expect::run(p.as_bytes()).outcome).collect();
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
