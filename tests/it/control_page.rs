//! The examples in docs/control.md are run: what stands there is what happens.
use std::path::Path;

use gcode_tests::expect;

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

#[test]
fn the_page_on_the_control_shows_what_happens() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/control.md");
    let page = std::fs::read_to_string(page).unwrap();
    let shown = examples(&page);
    assert!(shown.len() > 80, "the examples were found");
    let mut wrong = String::new();
    for (program, end) in &shown {
        let mut text = program.replace("; ", "\n");
        if !program.starts_with(['O', ':', '<', '%']) && !program.contains("; O1") {
            text = format!("O1\n{text}");
        }
        if !program.contains("M30") {
            text.push_str("\nM30");
        }
        for difference in expect::run(format!("{text}\n").as_bytes()).differences(end) {
            wrong.push_str(&format!("{program}\n    {difference}\n"));
        }
    }
    assert!(wrong.is_empty(), "docs/control.md says something else than happens:\n{wrong}");
}
