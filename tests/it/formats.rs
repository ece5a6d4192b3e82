//! `--format` is the same everywhere: every command that answers something has it, with the same words.
use gcode_tests::programs::run_line;

/// What each command can write, the default first; those that write a file for something else have no `--format`.
const COMMANDS: &[(&str, &str, &[&str])] = &[
    ("gcode-sim", "run", &["text", "json"]),
    ("gcode-sim", "holes", &["text", "json", "csv"]),
    ("gcode-sim", "reference", &["json", "text", "csv"]),
    ("gcode-sim", "verify", &["text", "json", "sarif"]),
    ("gcode-sim", "render", &["text", "json"]),
    ("gcode-sim", "readings", &["text", "json", "csv"]),
    ("gcode-sim", "check", &["text", "json", "sarif"]),
    ("gcode-sim", "diff", &["text", "json", "sarif"]),
    ("gcode-sim", "test", &["text", "json", "junit", "sarif"]),
    ("gcode-sim", "budget", &["text", "json"]),
    ("gcode-sim", "settings", &["text", "json"]),
    ("gcode-sim", "explain", &["text", "json"]),
    ("gcode-sim", "schema", &[]),
    ("gcode-sim", "completions", &[]),
    ("gcode-sim", "man", &[]),
    ("gcode-sim", "compare", &["text", "json"]),
    ("gcode-gen", "new", &[]),
    ("gcode-gen", "emit", &["text", "json"]),
    ("gcode-gen", "sheet", &["text", "json"]),
    ("gcode-gen", "schema", &[]),
    ("gcode-gen", "completions", &[]),
    ("gcode-gen", "man", &[]),
];

fn help(line: &str) -> String {
    String::from_utf8(run_line(&format!("{line} --help"), &std::env::temp_dir()).stdout).unwrap()
}

#[test]
fn every_command_is_in_the_list() {
    for program in ["gcode-sim", "gcode-gen"] {
        let text = help(program);
        let commands = text.split("Commands:\n").nth(1).unwrap().lines().take_while(|line| !line.is_empty());
        let names = commands.filter_map(|line| line.strip_prefix("  ")?.split(' ').next());
        let names: Vec<&str> = names.filter(|name| !name.is_empty() && *name != "help").collect();
        let listed = COMMANDS.iter().filter(|(of, ..)| *of == program).map(|(_, name, _)| *name);
        assert_eq!(names, listed.collect::<Vec<_>>(), "{program}");
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
        let said: Vec<&str> = part.lines().map(str::trim).filter(|line| !line.is_empty()).collect();
        assert_eq!(said[0], "Output format", "{command}");
        let values = said.iter().filter_map(|line| line.strip_prefix("- "));
        let values: Vec<(&str, &str)> = values
            .map(|line| line.split_once(':').map_or((line, ""), |(name, words)| (name, words.trim())))
            .collect();
        let mut names: Vec<&str> = values.iter().map(|(name, _)| *name).collect();
        for (name, words) in &values {
            let wanted = WORDS.iter().find(|(known, _)| known == name).map_or("", |(_, words)| words);
            assert_eq!(*words, wanted, "{command} --format {name}");
        }
        assert!(said.contains(&format!("[default: {}]", formats[0]).as_str()), "{command}: {said:?}");
        let mut wanted = formats.to_vec();
        names.sort_unstable();
        wanted.sort_unstable();
        assert_eq!(names, wanted, "{command}");
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
