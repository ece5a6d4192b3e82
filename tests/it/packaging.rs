//! Completions and manual pages name every command of both programs.
use gcode_tests::programs::run_line;

/// The commands that the help lists.
fn commands(program: &str) -> Vec<String> {
    let place = tempfile::tempdir().unwrap();
    let help = String::from_utf8(run_line(&format!("{program} --help"), place.path()).stdout).unwrap();
    let list = help.split("Commands:\n").nth(1).unwrap().split("\n\n").next().unwrap();
    let names = list.lines().filter_map(|line| line.strip_prefix("  ")?.split(' ').next());
    names.filter(|name| !name.is_empty() && *name != "help").map(str::to_owned).collect()
}

#[test]
fn every_command_has_its_page_and_every_shell_its_completions() {
    for program in ["gcode-sim", "gcode-gen"] {
        let place = tempfile::tempdir().unwrap();
        let commands = commands(program);
        assert!(commands.contains(&"man".to_owned()), "{commands:?}");
        let done = run_line(&format!("{program} man ."), place.path());
        assert_eq!(done.status.code(), Some(0), "{done:?}");
        for command in &commands {
            let page = std::fs::read_to_string(place.path().join(format!("{program}-{command}.1"))).unwrap();
            assert!(page.contains(".SH SYNOPSIS"), "{page}");
        }
        assert!(place.path().join(format!("{program}.1")).is_file());
        for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
            let done = run_line(&format!("{program} completions {shell}"), place.path());
            let text = String::from_utf8(done.stdout).unwrap();
            for command in &commands {
                assert!(text.contains(command.as_str()), "{program} {shell}: {command}");
            }
        }
        let nowhere = run_line(&format!("{program} man nowhere"), place.path());
        assert_eq!(nowhere.status.code(), Some(2));
    }
}
