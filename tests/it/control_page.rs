//! The examples in docs/control.md and docs/dialects.md run as the pages state.
use gcode_sim::report::explain;
use gcode_tests::{expect, workspace};

/// A line's program and the end it must come to: `` `program` → `end` ``.
fn examples(page: &str) -> Vec<(String, String)> {
    let lines = page.lines().filter_map(|line| line.split_once("` → `"));
    lines
        .map(|(before, after)| {
            let program = before.rsplit('`').next().unwrap();
            (program.to_owned(), after.split('`').next().unwrap().to_owned())
        })
        .collect()
}

/// `PS0050 to PS0058` and single codes of the first column of the table of alarms that are never raised.
fn never_raised(page: &str) -> Vec<String> {
    let table = page.split("that are never raised here").nth(1).unwrap().split("\n## ").next().unwrap();
    let first = table.lines().filter_map(|line| line.strip_prefix("| PS")?.split(" | ").next());
    let mut codes = Vec::new();
    for words in first.map(|cell| format!("PS{cell}").replace(',', "")) {
        let words: Vec<&str> = words.split(' ').collect();
        let number = |word: &str| word.strip_prefix("PS")?.parse::<u16>().ok();
        for (place, word) in words.iter().enumerate() {
            let Some(from) = number(word) else { continue };
            let to = match words.get(place + 1) {
                Some(&"to") => number(words[place + 2]).unwrap(),
                _ => from,
            };
            codes.extend((from..=to).map(|number| format!("PS{number:04}")));
        }
    }
    codes
}

#[test]
fn an_alarm_that_is_never_raised_has_no_page() {
    let page = std::fs::read_to_string(workspace().join("docs/control.md")).unwrap();
    let never = never_raised(&page);
    assert!(never.len() > 60, "the codes were found");
    let pages = explain::findings();
    let raised = pages.iter().filter(|page| never.iter().any(|code| code == page.code));
    assert_eq!(raised.map(|page| page.code).collect::<Vec<_>>(), [""; 0]);
}

/// Runs the examples of a page, each behind `head`, and compares their ends with the page's.
fn check(name: &str, head: &str, at_least: usize) {
    let page = std::fs::read_to_string(workspace().join("docs").join(name)).unwrap();
    let shown = examples(&page);
    assert!(shown.len() > at_least, "the examples were found");
    let mut wrong = String::new();
    for (program, end) in &shown {
        let mut text = program.replace("; ", "\n");
        if !program.starts_with(['O', ':', '<', '%']) && !program.contains("; O1") {
            text = format!("O1\n{text}");
        }
        if !program.contains("M30") {
            text.push_str("\nM30");
        }
        for difference in expect::run(format!("{head}{text}\n").as_bytes()).differences(end) {
            wrong.push_str(&format!("{program}\n    {difference}\n"));
        }
    }
    assert!(wrong.is_empty(), "docs/{name} is wrong:\n{wrong}");
}

#[test]
fn the_examples_of_the_page_on_the_control_run_as_stated() {
    check("control.md", "", 80);
}

#[test]
fn the_examples_of_the_page_on_dialects_run_as_stated() {
    check("dialects.md", "(@DIALECT=haas-ngc)\n", 20);
}
