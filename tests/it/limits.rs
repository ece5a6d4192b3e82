//! Programs of extreme size or nesting are read and come to an end or an alarm without delay.
use std::sync::Arc;
use std::sync::atomic::Ordering;

use gcode_control::{Outcome, Progress};
use gcode_inspect::machine::Machine;
use gcode_lang::motion::{Event, EventSink};
use gcode_lang::program::NoLibrary;
use gcode_session::{Request, run};
use gcode_tests::{expect, files_below, fuzz, root};
use proptest::prelude::*;

/// The code that a program stops with, or `end`.
fn stops_with(program: &str) -> String {
    match expect::run(program.as_bytes()).outcome {
        Outcome::End => "end".into(),
        Outcome::Limit => "limit".into(),
        Outcome::Alarm(stopped) => stopped.alarm.code().to_string(),
    }
}

fn block(text: &str) -> String {
    stops_with(&format!("O1\n{text}\nM30\n"))
}

const MANY: usize = 100_000;

#[test]
fn nesting_without_end_is_an_alarm() {
    let brackets = format!("{}1{}", "[".repeat(MANY), "]".repeat(MANY));
    for text in [
        format!("#1={brackets}"),
        format!("G0 X{brackets}"),
        format!("IF[{brackets} EQ 1]GOTO 5"),
        format!("#1={}1", "#[".repeat(MANY)),
        format!("#1={}1", "SIN[".repeat(MANY)),
    ] {
        assert_eq!(block(&text), "PS0118", "{}", &text[..20]);
    }
    let beginnings =
        ["#1=", "G0 X", "#", "GOTO", "IF[", "DPRNT[", "SETVN", "M98 P", "G65 P1 A", "/", "N", "O"];
    let pieces = [
        "-",
        "+",
        "#",
        "[",
        "]",
        "IF[1 EQ 1]",
        "IF[1 EQ 1]THEN",
        "THEN",
        "WHILE[",
        "DO",
        "SIN",
        "/",
        "=",
        "*",
    ];
    for beginning in beginnings {
        for piece in pieces {
            let code = block(&format!("{beginning}{}1", piece.repeat(2_000)));
            // Strokes and a number are an empty block that may be skipped. All else is nonsense.
            let is_skipped = beginning == "/" && piece == "/";
            let is_right = if is_skipped { code == "end" } else { code.starts_with("PS") };
            assert!(is_right, "{beginning} {piece}: {code}");
        }
    }
}

#[test]
fn chains_without_end_are_read_at_once() {
    for (text, end) in [
        (format!("#1=1{}", "+1".repeat(MANY)), "SIM0001"),
        (format!("#1=1{}", " 1".repeat(MANY)), "PS0003"),
        (format!("G0 X0{}.5", "0".repeat(MANY)), "end"),
        ("#1=1 ".repeat(MANY), "PS0125"),
        (format!("G0 X1.{}", "/2 Y1.".repeat(MANY)), "SIM0001"),
        ("G0".repeat(MANY), "SIM0001"),
        (format!("POPEN\nDPRNT[{}]", "#1[44]".repeat(10_000)), "end"),
        (format!("SETVN500[{}A]", "A,".repeat(MANY)), "PS0115"),
    ] {
        assert_eq!(block(&text), end, "{}", &text[..10]);
    }
}

#[test]
fn a_block_of_ten_thousand_words_is_read() {
    let words: String = (1..=10_000).map(|i| format!("X{i} Y-{i}.")).collect();
    expect::run(format!("O1\nG0 {words}\nM30\n").as_bytes()).must("end=normal; path=R(10,-10000,0)");
    let arguments: String = (1..=10_000).map(|i| format!("A{i}. Z-{i}.")).collect();
    let text = format!("O1\nG65 P2 {arguments}\nM30\nO2\n#100=#1+#26*2\nM99\n");
    expect::run(text.as_bytes()).must("end=normal; #100=-10000");
}

#[test]
fn a_line_of_a_megabyte_is_read() {
    const MEGABYTE: usize = 1 << 20;
    let text = format!(
        "O1({})\nG0{}X1.\n#100=7{};\n(UNCLOSED{}\nY{}2.\nM30\n",
        "A".repeat(MEGABYTE),
        " ".repeat(MEGABYTE),
        "\t".repeat(MEGABYTE),
        "(".repeat(MEGABYTE),
        "0".repeat(MEGABYTE),
    );
    expect::run(text.as_bytes()).must("end=normal; #100=7; path=R(1,0,0) R(1,2,0)");
}

#[test]
fn a_hundred_thousand_sequence_numbers_are_found() {
    let mut text = "O1\nN200000 #1=#1+1\nIF[#1 GT 20000]GOTO 99999\nGOTO[#1*4+7]\n".to_owned();
    for number in 1..MANY {
        text.push_str(&format!("N{number} GOTO 200000\n"));
    }
    let text = text.replace("N99999 GOTO 200000", "N99999 M30");
    assert_eq!(stops_with(&text), "end");
}

#[test]
fn calls_inside_one_another_are_counted() {
    assert_eq!(stops_with("O1\nG65 P1\n"), "PS0122");
    assert_eq!(stops_with("O1\nM98 P1\n"), "PS0077");
    assert_eq!(stops_with("O1\nG66 P2\nX1.\nM30\nO2\nX2.\nM98 P2\nM99\n"), "PS0077");
    let many: String = (2..5_000).map(|n| format!("O{n}\nM99\n")).collect();
    let calls: String = (2..5_000).map(|n| format!("M98 P{n}\n")).collect();
    assert_eq!(stops_with(&format!("O1\n{calls}M30\n{many}")), "end");
}

/// The programs of the control's cases with their expectations.
fn cases() -> Vec<Vec<u8>> {
    let files = files_below(&root().join("control"), "txt");
    let texts: Vec<_> = files.iter().map(|file| std::fs::read_to_string(file).unwrap()).collect();
    let bodies = texts.iter().flat_map(|text| text.split("== ").skip(1));
    bodies.map(|body| body.split_once('\n').unwrap().1.as_bytes().to_vec()).collect()
}

/// One change to a program: where, as a part of its length, and what.
type Edit = (f64, u8, u8);

fn edited(mut program: Vec<u8>, edits: &[Edit]) -> Vec<u8> {
    for (place, kind, byte) in edits {
        let at = (place * program.len() as f64) as usize;
        let to = (at + usize::from(*byte % 16)).min(program.len());
        match kind {
            0 => program.insert(at, *byte),
            1 => drop(program.drain(at..to)),
            2 => program.splice(at..at, program[at..to].to_vec()).for_each(drop),
            3 => program[at..to].reverse(),
            _ if at < program.len() => program[at] = b"[]#.-/=()%\n;0GMX"[usize::from(*byte % 16)],
            _ => {}
        }
    }
    program
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(1500) })]

    #[test]
    fn cases_with_a_few_bytes_changed_are_read_and_run(
        program in prop::sample::select(cases()),
        edits in prop::collection::vec((0.0..1.0, 0..5u8, any::<u8>()), 1..6),
    ) {
        let program = edited(program, &edits);
        fuzz::reader(&program);
        fuzz::run(&program);
    }
}

/// Cancels the run at its first move.
struct CancelAtMove(Arc<Progress>);

impl EventSink for CancelAtMove {
    fn event(&mut self, event: &Event<'_>) {
        self.0.cancel.fetch_or(event.kind.end().is_some(), Ordering::Relaxed);
    }
}

#[test]
fn a_cancelled_run_reports_the_state_so_far() {
    let text = "O1\nG0 X5.\n#1=0\nWHILE[#1LT1000000]DO1\n#1=#1+1\nG0 X10.\nEND1\nM30\n";
    let progress = Arc::new(Progress::default());
    let mut request = Request::new("long.nc", text.as_bytes(), Machine::default());
    request.progress = Some(Arc::clone(&progress));
    let done = run(&request, &mut NoLibrary, &mut CancelAtMove(Arc::clone(&progress))).unwrap();
    assert!(matches!(done.outcome, Outcome::Limit));
    // The flag is read every 4,096 blocks: two, 1,023 iterations of four, and WHILE and the assignment of another.
    assert_eq!(done.control.blocks(), 4096);
    assert_eq!(done.control.work_position(0), 10.0);
    assert_eq!(done.control.variable(1).unwrap().number(), 1024.0);
    let finding = done.stop_finding().unwrap();
    assert_eq!((finding.kind.code, progress.blocks.load(Ordering::Relaxed)), ("limit", 4096));
    assert!(finding.message.contains("interrupted after 4096 blocks"), "{}", finding.message);
}
