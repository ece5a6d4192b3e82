//! Every command that answers something has `--format` with the same words; every command has its manual page and completions.
use gcode_tests::programs::run_line;

/// The formats of each command, the default first; commands that write a file for something else have no `--format`.
const COMMANDS: &[(&str, &str, &[&str])] = &[
    ("gcode-sim", "run", &["text", "json"]),
    ("gcode-sim", "holes", &["text", "json", "csv"]),
    ("gcode-sim", "reference", &["json", "text", "csv"]),
    ("gcode-sim", "verify", &["text", "json", "sarif"]),
    ("gcode-sim", "render", &["text", "json"]),
    ("gcode-sim", "page", &[]),
    ("gcode-sim", "sheet", &[]),
    ("gcode-sim", "readings", &["text", "json", "csv"]),
    ("gcode-sim", "check", &["text", "json", "sarif"]),
    ("gcode-sim", "diff", &["text", "json", "sarif"]),
    ("gcode-sim", "test", &["text", "json", "junit", "sarif"]),
    ("gcode-sim", "new", &[]),
    ("gcode-sim", "budget", &["text", "json"]),
    ("gcode-sim", "prove", &["text", "json"]),
    ("gcode-sim", "settings", &["text", "json"]),
    ("gcode-sim", "dap", &[]),
    ("gcode-sim", "explain", &["text", "json"]),
    ("gcode-sim", "lsp", &[]),
    ("gcode-sim", "schema", &[]),
    ("gcode-sim", "completions", &[]),
    ("gcode-sim", "man", &[]),
    ("gcode-sim", "compare", &["text", "json"]),
    ("gcode-gen", "new", &[]),
    ("gcode-gen", "emit", &["text", "json"]),
    ("gcode-gen", "sheet", &["text", "json"]),
    ("gcode-gen", "prove", &["text", "json"]),
    ("gcode-gen", "schema", &[]),
    ("gcode-gen", "completions", &[]),
    ("gcode-gen", "man", &[]),
];

fn help(line: &str) -> String {
    String::from_utf8(run_line(&format!("{line} --help"), &std::env::temp_dir()).stdout).unwrap()
}

/// The commands that a program's help lists.
fn commands(program: &str) -> Vec<String> {
    let text = help(program);
    let list = text.split("Commands:\n").nth(1).unwrap().lines().take_while(|line| !line.is_empty());
    let names = list.filter_map(|line| line.strip_prefix("  ")?.split(' ').next());
    names.filter(|name| !name.is_empty() && *name != "help").map(str::to_owned).collect()
}

#[test]
fn every_command_is_in_the_list() {
    for program in ["gcode-sim", "gcode-gen"] {
        let listed = COMMANDS.iter().filter(|(of, ..)| *of == program).map(|(_, name, _)| *name);
        assert_eq!(commands(program), listed.collect::<Vec<_>>(), "{program}");
    }
}

#[test]
fn every_command_has_its_manual_page_and_completions_in_every_shell() {
    for program in ["gcode-sim", "gcode-gen"] {
        let place = tempfile::tempdir().unwrap();
        let done = run_line(&format!("{program} man ."), place.path());
        assert_eq!(done.status.code(), Some(0), "{done:?}");
        assert!(place.path().join(format!("{program}.1")).is_file());
        let commands = commands(program);
        for command in &commands {
            let page = std::fs::read_to_string(place.path().join(format!("{program}-{command}.1"))).unwrap();
            assert!(page.contains(".SH SYNOPSIS"), "{page}");
        }
        for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
            let done = run_line(&format!("{program} completions {shell}"), place.path());
            let text = String::from_utf8(done.stdout).unwrap();
            for command in &commands {
                assert!(text.contains(command.as_str()), "{program} {shell}: {command}");
            }
        }
        assert_eq!(run_line(&format!("{program} man nowhere"), place.path()).status.code(), Some(2));
    }
}

#[test]
fn every_answer_has_its_formats_in_the_same_words() {
    const WORDS: [(&str, &str); 4] = [
        ("json", "One document, and nothing else on standard output"),
        ("csv", "A header and one line each"),
        ("junit", "JUnit XML, for build servers"),
        ("sarif", "SARIF 2.1.0, for code reviews"),
    ];
    for (program, command, formats) in COMMANDS {
        let text = help(&format!("{program} {command}"));
        let Some(after) = text.split("      --format <FORMAT>\n").nth(1) else {
            assert!(formats.is_empty(), "{command} has no --format");
            continue;
        };
        let part: String =
            after.lines().take_while(|line| !line.starts_with("      --")).collect::<Vec<_>>().join("\n");
        let lines: Vec<&str> = part.lines().map(str::trim).filter(|line| !line.is_empty()).collect();
        assert_eq!(lines[0], "Output format", "{command}");
        let values = lines.iter().filter_map(|line| line.strip_prefix("- "));
        let values: Vec<(&str, &str)> = values
            .map(|line| line.split_once(':').map_or((line, ""), |(name, words)| (name, words.trim())))
            .collect();
        let mut names: Vec<&str> = values.iter().map(|(name, _)| *name).collect();
        for (name, words) in &values {
            let expected = WORDS.iter().find(|(known, _)| known == name).map_or("", |(_, words)| words);
            assert_eq!(*words, expected, "{command} --format {name}");
        }
        assert!(lines.contains(&format!("[default: {}]", formats[0]).as_str()), "{command}: {lines:?}");
        let mut expected = formats.to_vec();
        names.sort_unstable();
        expected.sort_unstable();
        assert_eq!(names, expected, "{command}");
    }
}

/// A request that can't be used leaves standard output empty, whatever the format.
#[test]
fn a_refused_request_writes_no_document() {
    for (program, command, formats) in COMMANDS.iter().filter(|(_, name, _)| *name != "settings") {
        for format in *formats {
            let line = match *command {
                "explain" => format!("{program} explain NOTHING --format {format}"),
                "compare" | "diff" => format!("{program} {command} none.1 none.2 --format {format}"),
                "verify" => format!("{program} verify none.nc --reference none.toml --format {format}"),
                "budget" => format!("{program} budget none.toml --errors none.toml --format {format}"),
                "render" | "sheet" => format!("{program} {command} none.nc -o none.png --format {format}"),
                "emit" => format!("{program} emit none.toml --out none --format {format}"),
                _ => format!("{program} {command} none --format {format}"),
            };
            let done = run_line(&line, &std::env::temp_dir());
            assert_eq!((done.status.code(), done.stdout.len()), (Some(2), 0), "{line}");
            assert!(!done.stderr.is_empty(), "{line}");
        }
    }
}

/// What a command needs stands first among its options, and the conditions of a run are a group of their own.
#[test]
fn help_has_groups_and_begins_with_what_is_required() {
    for (command, first) in [
        ("verify", "--reference"),
        ("render", "-o, --output"),
        ("budget", "--errors"),
        ("new reference", "--from"),
    ] {
        let text = help(&format!("gcode-sim {command}"));
        let options = text.split("\nOptions:\n").nth(1).unwrap();
        assert!(options.trim_start().starts_with(first), "{command}\n{text}");
        if command != "budget" {
            let group = text.split("\nMachine, control and start of the run:\n").nth(1).unwrap();
            let group = group.split("\nExamples:").next().unwrap();
            assert!(group.contains("--machine") && !group.contains("--format"), "{command}\n{text}");
        }
    }
}
