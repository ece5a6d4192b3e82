//! `test --watch` runs the cases again that a saved file concerns.
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

use gcode_tests::programs::{program, run_line};

/// The program while it watches; it ends with the test.
struct Watching {
    child: Child,
    lines: Receiver<String>,
}

impl Drop for Watching {
    fn drop(&mut self) {
        self.child.kill().unwrap();
        self.child.wait().unwrap();
    }
}

impl Watching {
    fn begin(place: &Path) -> Self {
        let mut command = program("gcode-sim");
        command.args(["test", "parts", "--lib", "macros", "--watch"]).current_dir(place);
        let mut child = command.stdout(Stdio::piped()).spawn().unwrap();
        let out = BufReader::new(child.stdout.take().unwrap());
        let (sender, lines) = channel();
        std::thread::spawn(move || out.lines().map_while(Result::ok).try_for_each(|line| sender.send(line)));
        Self { child, lines }
    }

    /// The output up to the line that counts the cases.
    fn output(&self) -> String {
        let mut text = String::new();
        loop {
            let line = self.lines.recv_timeout(Duration::from_secs(20)).expect("output within 20 s");
            text.push_str(&format!("{line}\n"));
            if line.contains(" as accepted") {
                return text;
            }
        }
    }
}

#[test]
fn a_saved_file_runs_its_cases_again() {
    let place = tempfile::tempdir().unwrap();
    let place = place.path();
    let write = |file: &str, text: &str| {
        let path = place.join(file);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    };
    write("macros/O9001.nc", "O9001\nG81 X0. Y0. Z-5. R2. F100\nG80\nM99\n");
    write("parts/called/main.nc", "O1\nS500 M3\nG65 P9001\nM30\n");
    write("parts/plain/main.nc", "O2\nG0 X1.\nM30\n");
    run_line("gcode-sim test parts --lib macros --accept", place);

    let watching = Watching::begin(place);
    assert_eq!(watching.output(), "2 cases: 2 as accepted\n");
    // One case alone, as the file is in its folder.
    write("parts/plain/main.nc", "O2\nG0 X2.\nM30\n\n");
    let output = watching.output();
    assert!(
        output.starts_with("\nsaved: parts/plain/main.nc\nchanged  plain\n    move-shifted "),
        "{output}"
    );
    assert!(output.ends_with("1 case: 0 as accepted, 1 changed\n"), "{output}");
    // A macro concerns all.
    write("macros/O9001.nc", "O9001\nG81 X0.01 Y0. Z-5. R2. F100\nG80\nM99\n");
    let output = watching.output();
    assert!(output.contains("saved: macros/O9001.nc\n"), "{output}");
    assert!(output.contains("hole 1: moved by +0.0100 +0.0000 +0.0000 mm"), "{output}");
    assert!(output.ends_with("2 cases: 0 as accepted, 2 changed\n"), "{output}");
}
