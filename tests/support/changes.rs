//! Cases of kind `changes`: programs with edits, and the entries that `diff` has for each edit, as they were worked out.
//!
//! `cases.txt` has, after a sentence on what it is about, cases of the form
//!
//! ```text
//! == a deeper pilot
//! O1
//! …
//! M30
//! Z-4. R2. => Z-4.01 R2.
//! -> hole-pass: hole 1: pass 1 of 2, by T1, 0.0100 mm deeper
//!    at 5, 5
//!    | move-shifted: …
//! ```
//!
//! | line | meaning |
//! |---|---|
//! | `# TEXT` | a remark |
//! | `machine FILE` | the machine file in the folder, `machine.toml` if there is one, for the program below |
//! | `O1` … `M30` | the program; a case without one has that of the case before |
//! | `A => B`, `A =>> B` | the new revision has B in place of the only A, or of every A; `;` is the end of a line |
//! | `both: A => B` | both revisions have B |
//! | `-> CODE: MESSAGE` | the next entry; `-> nothing` if there is none; `...` at the end leaves the rest open |
//! | `   \| CODE: MESSAGE` | the next effect of that entry; `   \| ...` leaves the others open |
//! | `   at 5, -` | the lines of the entry or effect before it in the old and the new revision, `5 from 2` inside a call |
//! | `<- …` | an entry of the comparison the other way round |
//! | `idle 5, -` | the lines of the next edited block that neither run executes; `idle none` if there is none |
use gcode_inspect::machine::Machine;
use gcode_lang::motion::EventSink;
use gcode_lang::program::NoLibrary;
use gcode_review::{BlockLocation, Change, Revision, changes, unexecuted};
use gcode_session::Request;

use crate::{Case, edited};

/// The difference in mm from which on an entry is made.
const TOLERANCE: f64 = 0.0001;

/// Runs a program on the default machine.
pub fn revision(text: &str) -> Revision {
    revision_on(&Machine::default(), text)
}

fn revision_on(machine: &Machine, text: &str) -> Revision {
    revision_with(machine, text, &mut ())
}

/// Runs a program; `sink` records what else is shown.
pub(crate) fn revision_with(machine: &Machine, text: &str, sink: &mut impl EventSink) -> Revision {
    let request = Request::new("O1.nc", text.as_bytes(), machine.clone());
    Revision::observed(&request, &mut NoLibrary, None, sink, &mut ()).unwrap()
}

/// Compares two programs on the default machine.
pub fn find_changes(old: &str, new: &str) -> Vec<Change> {
    changes(&revision(old).record, &revision(new).record, TOLERANCE)
}

/// Entries with all their effects, as `code: message | code: message`.
pub fn effect_texts(found: &[Change]) -> Vec<String> {
    let whole = |change: &Change| {
        let effects = change.effects().map(|(code, message)| format!("{code}: {message}"));
        effects.collect::<Vec<_>>().join(" | ")
    };
    found.iter().map(whole).collect()
}

pub(crate) fn run(case: &Case) {
    let text = case.text("cases.txt");
    let (mut program, mut machine) = (String::new(), Machine::default());
    let (mut wrong, mut names) = (String::new(), Vec::new());
    for entry in text.split("\n== ").skip(1) {
        let (name, lines) = entry.split_once('\n').unwrap();
        assert!(!names.contains(&name), "{}: two cases are called '{name}'", case.name());
        names.push(name);
        let lines: Vec<&str> =
            lines.lines().filter(|line| !line.is_empty() && !line.starts_with("# ")).collect();
        let is_expectation = |line: &&str| ["->", "<-", "idle "].iter().any(|word| line.starts_with(word));
        assert!(lines.iter().any(is_expectation), "{}: '{name}' expects nothing", case.name());
        let is_program = |line: &&&str| {
            !["->", "<-", "   ", "idle ", "machine "].iter().any(|word| line.starts_with(word))
                && !line.contains(" =>")
        };
        let own: String = lines.iter().filter(is_program).map(|line| format!("{line}\n")).collect();
        if !own.is_empty() {
            program = own;
            let file = lines.iter().find_map(|line| line.strip_prefix("machine ")).unwrap_or("machine.toml");
            machine =
                case.optional(file).map_or_else(Machine::default, |text| Machine::parse(&text).unwrap());
        }
        let mut texts = [program.clone(), program.clone()];
        for line in lines.iter().filter(|line| line.contains(" =>")) {
            match line.strip_prefix("both: ") {
                Some(edit) => texts = texts.map(|text| edited(&text, edit)),
                None => texts[1] = edited(&texts[1], line),
            }
        }
        let [old, new] = texts.map(|text| revision_on(&machine, &text));
        for (arrow, from, to) in [("->", &old, &new), ("<-", &new, &old)] {
            let expected = expected_lines(&lines, arrow);
            let found = shown(&changes(&from.record, &to.record, TOLERANCE), arrow);
            if !expected.is_empty() && !agree(&expected, &found) {
                wrong.push_str(&format!(
                    "{name}: expected\n{}\nfound\n{}\n",
                    expected.join("\n"),
                    found.join("\n")
                ));
            }
        }
        let expected: Vec<&str> = lines.iter().filter_map(|line| line.strip_prefix("idle ")).collect();
        let idle =
            unexecuted(&old.record, &new.record).into_iter().map(|block| places(&block.old, &block.new));
        let idle: Vec<String> =
            if expected == ["none"] { idle.chain(["none".to_owned()]).collect() } else { idle.collect() };
        if !expected.is_empty() && idle != expected {
            wrong.push_str(&format!(
                "{name}: expected\nidle {}\nfound\nidle {}\n",
                expected.join("\nidle "),
                idle.join("\nidle ")
            ));
        }
    }
    assert!(!names.is_empty(), "{}: no cases", case.name());
    assert!(wrong.is_empty(), "{}:\n{wrong}", case.name());
}

/// The lines of a case that one direction of the comparison must have; `-> nothing` stays a line of its own.
fn expected_lines<'t>(lines: &[&'t str], arrow: &str) -> Vec<&'t str> {
    let mut is_meant = false;
    let mut expected = Vec::new();
    for line in lines {
        is_meant = if line.starts_with("   ") { is_meant } else { line.starts_with(arrow) };
        if is_meant {
            expected.push(*line);
        }
    }
    expected
}

/// Entries as `cases.txt` has them, with all their effects and places.
fn shown(found: &[Change], arrow: &str) -> Vec<String> {
    if found.is_empty() {
        return vec![format!("{arrow} nothing")];
    }
    let mut lines = Vec::new();
    for change in found {
        lines.push(format!("{arrow} {}: {}", change.code, change.message));
        lines.push(format!("   at {}", places(&change.old, &change.new)));
        for effect in &change.also {
            lines.push(format!("   | {}: {}", effect.code, effect.message));
            lines.push(format!("   at {}", places(&effect.old, &effect.new)));
        }
    }
    lines
}

/// `5, -`: the lines of a block in both revisions, with those of the calls that led to it.
fn places(old: &Option<BlockLocation>, new: &Option<BlockLocation>) -> String {
    let line = |place: &Option<BlockLocation>| match place {
        None => "-".to_owned(),
        Some(place) => {
            let calls = place.calls.iter().map(|call| format!(" from {}", call.line));
            format!("{}{}", place.line, calls.collect::<String>())
        }
    };
    format!("{}, {}", line(old), line(new))
}

/// Whether the lines agree; places that aren't expected are left out, and what `...` stands for.
fn agree(expected: &[&str], found: &[String]) -> bool {
    let mut found = found.iter().peekable();
    for expected in expected {
        if *expected == "   | ..." {
            while found.next_if(|line| line.starts_with("   ")).is_some() {}
            continue;
        }
        if !expected.starts_with("   at") {
            while found.next_if(|line| line.starts_with("   at")).is_some() {}
        }
        let is_agreed = |line: &String| match expected.strip_suffix("...") {
            Some(begin) => line.starts_with(begin),
            None => line == expected,
        };
        if !found.next().is_some_and(is_agreed) {
            return false;
        }
    }
    found.all(|line| line.starts_with("   at"))
}
