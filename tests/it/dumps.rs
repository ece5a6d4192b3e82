//! Files with several programs: dumps of a control's memory with folders, the choice of the main program, files of other endings and
//! encodings, and folders with several main programs.
use std::path::Path;

use gcode_tests::programs::run_line;

/// Two folders with a program O1 each, and a library that both call.
const DUMP: &str = "%\n\
    &F=//CNC_MEM/USER/PATH1/\nO0001\n#100=1\nM98 P2\nM30\nO0002\n#101=12\nM99\n\
    &F=//CNC_MEM/USER/PATH2/\nO0001\n#100=2\nM98 P2\nM98 P9\nM30\n\
    &F=/CNC_MEM/USER/LIBRARY\nO0002\n#101=99\nM99\n\
    &F=//CNC_MEM/USER/PATH3/\nO0009\n#102=3\nM99\n%\n";

fn folder(files: &[(&str, &[u8])]) -> tempfile::TempDir {
    let place = tempfile::tempdir().unwrap();
    for (name, bytes) in files {
        let path = place.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, bytes).unwrap();
    }
    place
}

fn run(line: &str, place: &Path) -> (i32, String, String) {
    let done = run_line(&format!("gcode-sim {line}"), place);
    let text = |bytes| String::from_utf8(bytes).unwrap();
    (done.status.code().unwrap(), text(done.stdout), text(done.stderr))
}

/// Returns the common variables at the end of a run.
fn commons(line: &str, place: &Path) -> serde_json::Value {
    let (code, json, message) = run(&format!("run {line} --format json"), place);
    assert_eq!(code, 0, "{json} {message}");
    serde_json::from_str::<serde_json::Value>(&json).unwrap()["variables"].take()
}

#[test]
fn a_call_finds_the_programs_of_its_folder_and_then_the_common_ones() {
    let place = folder(&[("ALL-PROG.TXT", DUMP.as_bytes())]);
    let first = serde_json::json!({"#100": 1.0, "#101": 12.0});
    assert_eq!(commons("ALL-PROG.TXT", place.path()), first, "the first program, its own O2");
    assert_eq!(commons("ALL-PROG.TXT --program //CNC_MEM/USER/PATH1/O1", place.path()), first);
    let second = serde_json::json!({"#100": 2.0, "#101": 99.0, "#102": 3.0});
    assert_eq!(
        commons("ALL-PROG.TXT --program cnc_mem/user/path2/O0001", place.path()),
        second,
        "O2 of the library"
    );
    // The folders of the memory need no name of the device.
    let short = DUMP.replace("CNC_MEM/", "");
    let place = folder(&[("ALL-PROG.TXT", short.as_bytes())]);
    assert_eq!(commons("ALL-PROG.TXT --program /USER/PATH1/O1", place.path()), first);
    assert_eq!(commons("ALL-PROG.TXT --program //CNC_MEM/USER/PATH2/O1", place.path()), second);
}

#[test]
fn the_choice_of_a_main_program_is_said() {
    let place = folder(&[("ALL-PROG.TXT", DUMP.as_bytes())]);
    let (_, _, text) = run("run ALL-PROG.TXT", place.path());
    let note = "warning[main-program]: //CNC_MEM/USER/PATH1/O0001 is executed, the first program of ALL-PROG.TXT, not \
                //CNC_MEM/USER/PATH2/O0001";
    assert!(text.contains(note), "{text}");
    let (_, _, text) = run("run ALL-PROG.TXT --program O1", place.path());
    assert!(!text.contains("main-program"), "{text}");
    let (_, _, text) = run("run ALL-PROG.TXT --program //CNC_MEM/USER/PATH2/O1", place.path());
    assert!(text.contains("warning[other-folder]"), "O9 is in no folder that a control searches: {text}");
    let (code, _, message) = run("run ALL-PROG.TXT --program O7", place.path());
    assert_eq!(code, 2);
    assert!(
        message.contains("ALL-PROG.TXT contains no program O0007; it contains //CNC_MEM/USER/PATH1/O0001, "),
        "{message}"
    );
}

/// The end of a path is enough where one program has it.
#[test]
fn a_program_is_chosen_by_the_end_of_its_path() {
    let dump = "%\n&F=//CNC_MEM/USER/PARTS/JOB1/\nO1\n#100=1\nM30\n\
                &f=//CNC_MEM/USER/PARTS/JOB2/\nO1\n#100=2\nM30\n\
                &F=//CNC_MEM/USER/OLD/JOB1/\nO1\n#100=3\nM30\n%\n";
    let place = folder(&[("d.txt", dump.as_bytes())]);
    let second = serde_json::json!({"#100": 2.0});
    assert_eq!(commons("d.txt --program JOB2/O1", place.path()), second);
    assert_eq!(commons("d.txt --program PARTS/JOB1/O1", place.path()), serde_json::json!({"#100": 1.0}));
    for unclear in ["JOB1/O1", "OB2/O1", "JOB2/O2"] {
        let (code, _, message) = run(&format!("run d.txt --program {unclear}"), place.path());
        assert!(code == 2 && message.contains("contains no program"), "{unclear}: {message}");
    }
}

/// Some senders write `;` for the end of a block, and a whole program in a line.
#[test]
fn a_program_behind_a_semicolon_is_one() {
    let text = b"%\nO1;#100=1;M98P2;M30;O2;#101=2;M99;%\n";
    let place = folder(&[("p.nc", text), ("q.nc", b"%\nO2\n#101=77\nM99\n%\n")]);
    assert_eq!(commons("p.nc", place.path()), serde_json::json!({"#100": 1.0, "#101": 2.0}));
    // Behind `;` a text with a number in front is a comment.
    let remark = b"O1\n#100=1 ;O2 is the sensor\n#101=3\nM30\n";
    let place = folder(&[("p.nc", remark)]);
    assert_eq!(commons("p.nc", place.path()), serde_json::json!({"#100": 1.0, "#101": 3.0}));
}

/// A tape in ISO code: the eighth bit makes the number of ones of a byte even. Between its lines are pauses.
#[test]
fn a_tape_with_parity_and_pauses_is_read() {
    let plain = b"%\r\n\0\0O1\r\n\0\0#100=17\r\n\0\0M30\r\n%\r\n";
    let punched = plain.map(|byte| byte | ((byte.count_ones() as u8 & 1) << 7));
    let place = folder(&[("plain.nc", plain), ("punched.nc", &punched)]);
    for name in ["plain.nc", "punched.nc"] {
        assert_eq!(commons(name, place.path()), serde_json::json!({"#100": 17.0}), "{name}");
    }
}

/// A file may begin with the subprograms.
#[test]
fn the_only_main_program_is_executed_though_others_come_first() {
    let place = folder(&[("p.eia", b"O0002\n#101=2\nM99\nO0001\n#100=1\nM98 P2\nM30\n")]);
    assert_eq!(commons("p.eia", place.path()), serde_json::json!({"#100": 1.0, "#101": 2.0}));
    let (_, _, text) = run("run p.eia", place.path());
    assert!(text.contains("O0001 is executed, the only program that no other calls of p.eia"), "{text}");
}

#[test]
fn called_programs_are_found_in_files_of_any_ending() {
    let called: &[u8] = b"%\nO0002\n#101=7\nM99\n%\n";
    for name in ["O0002.txt", "sub.TXT", "O2", "subs.min", "subs.tap", "subs.cnc", "subs.ncd"] {
        let place =
            folder(&[("main.nc", b"O1\nM98 P2\nM30\n"), (name, called), ("readme.txt", b"O2 is called\n")]);
        assert_eq!(commons("main.nc", place.path()), serde_json::json!({"#101": 7.0}), "{name}");
    }
}

#[test]
fn utf_16_runs_and_its_messages_are_readable() {
    let bytes: Vec<u8> =
        "O1\n#3000=1(\u{5de5}\u{5177})\nM30\n".encode_utf16().flat_map(u16::to_le_bytes).collect();
    let place = folder(&[("p.nc", &bytes)]);
    let (code, json, _) = run("run p.nc --format json", place.path());
    let alarm = &serde_json::from_str::<serde_json::Value>(&json).unwrap()["alarm"];
    assert_eq!(
        (code, alarm["message"].as_str(), alarm["line"].as_u64()),
        (3, Some("\u{5de5}\u{5177}"), Some(2))
    );
}

#[test]
fn each_main_program_of_a_folder_is_a_case_with_its_own_accepted_result() {
    let (one, two): (&[u8], &[u8]) = (b"O1\nG00 X1.\nM98 P3\nM30\n", b"O2\nG00 X2.\nM30\n");
    let place = folder(&[
        ("parts/plate/O1.nc", one),
        ("parts/plate/O2.tap", two),
        ("parts/plate/O3.nc", b"O3\nM99\n"),
    ]);
    let accepted = "accepted plate/O1\naccepted plate/O2\n2 cases: 2 as accepted\n";
    assert_eq!(run("test parts --accept", place.path()), (0, accepted.to_owned(), String::new()));
    assert!(place.path().join("parts/plate/O1.accepted.json").exists());
    assert_eq!(run("test parts", place.path()).1, "2 cases: 2 as accepted\n");

    std::fs::write(place.path().join("parts/plate/O2.tap"), "O2\nG00 X3.\nM30\n").unwrap();
    let (code, text, _) = run("test parts", place.path());
    assert_eq!((code, text.contains("2 cases: 1 as accepted, 1 changed")), (1, true), "{text}");

    std::fs::remove_file(place.path().join("parts/plate/O2.tap")).unwrap();
    let (code, text, _) = run("test parts", place.path());
    assert_eq!(
        (code, text.contains("refused  plate/O2: parts/plate has O2.accepted.json and no program")),
        (2, true),
        "{text}"
    );
}

#[test]
fn each_main_program_of_a_dump_is_a_case() {
    let place = folder(&[("parts/ALL-PROG.TXT", DUMP.as_bytes())]);
    let (code, text, _) = run("test parts --accept", place.path());
    assert_eq!(code, 0, "{text}");
    assert!(text.ends_with("2 cases: 2 as accepted\n"), "{text}");
    assert_eq!(run("test parts", place.path()).1, "2 cases: 2 as accepted\n");
}

#[test]
fn a_check_of_a_dump_resolves_calls_by_folder() {
    let place = folder(&[("ALL-PROG.TXT", DUMP.as_bytes())]);
    let (code, text, _) = run("check ALL-PROG.TXT", place.path());
    assert_eq!(code, 0, "{text}");
}

/// O0100 calls O8000 alone; what the other programs of its dump lack is none of its findings.
#[test]
fn a_verdict_and_a_page_are_of_the_programs_that_the_run_can_reach() {
    let dump = |sub: &str| {
        format!(
            "%\nO0001\nG00 X5.\nM30\nO0100\nT1 M06\nS1500 M03\nG54 G90 G00 X10. Y10.\nG43 H1 Z50.\nG98 G81 Z-5. R2. F100.\n\
             {sub}\nG80\nM30\nO0101\nG00 X50 Y20.\nX60.\nX[1.\nGOTO 50\nM30\nO8000\nX40.\nM99\n%\n"
        )
    };
    let list = "id,x,y,z,depth,diameter\n1,10,10,0,5,\n2,40,10,0,5,\n";
    let verdict = |sub: &str, list: &str| {
        let place = folder(&[("d.txt", dump(sub).as_bytes()), ("l.csv", list.as_bytes())]);
        let (code, text, findings) = run("verify d.txt --program O100 --reference l.csv", place.path());
        (code, text + &findings)
    };
    let (code, text) = verdict("M98 P8000", list);
    assert!(code == 0 && !text.contains("O0101"), "{text}");
    // 40 counts 0.04 mm here.
    let (code, text) = verdict("X40", &list.replace("2,40,", "2,0.04,"));
    assert!(code == 0 && text.contains("warnings: missing-point") && !text.contains("O0101"), "{text}");
    let (code, text) = verdict("M98 P8000", &list.replace("2,40,", "2,41,"));
    assert!(code == 1 && text.contains("hole-position") && !text.contains("O0101"), "{text}");
    // A computed number may be any.
    let (code, text) = verdict("#1=8000\nM98 P#1", &list.replace("2,40,", "2,41,"));
    assert!(code == 1 && text.contains("error[unreadable]") && text.contains("O0101"), "{text}");

    let place = folder(&[("d.txt", dump("M98 P8000").as_bytes())]);
    let (code, _, message) = run("page d.txt --program O100 -o p.html", place.path());
    assert_eq!(code, 0, "{message}");
    let page = std::fs::read_to_string(place.path().join("p.html")).unwrap();
    let programs = page.split("class=\"program\">").nth(1).unwrap();
    assert!(programs.starts_with("O0100, O8000<"), "{}", &programs[..80]);
    let (chosen, called) = (programs.find("<code>O0100").unwrap(), programs.find("<code>O8000").unwrap());
    assert!(chosen < called && !programs.contains("<code>O0101"));
    // The first four lines with O0001, and six of O0101.
    assert!(programs.contains("10 lines of programs that the run cannot reach are omitted"));
}
