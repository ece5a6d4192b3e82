//! Any program, without a job: exit codes of pictures, pages and sheets agree, what is not in a list is said, and one verdict has one picture.
use std::path::Path;
use std::process::Output;

use gcode_tests::programs::run_line;

const MACHINE: &str = "[control]\naxes = \"XYZ\"\n[head]\nkind = \"fixed\"\ndirection = [0.0, 0.0, 1.0]\n\
                       [[tool]]\nnumber = 1\nkind = \"end-mill\"\ndiameter = 10.0\nlength = 0.0\n\
                       [stock]\nkind = \"box\"\nmin = [0.0, 0.0, -20.0]\nmax = [100.0, 60.0, 0.0]\n";

/// Drills at (20, 20) to z −22 in 20 mm; then `more`.
fn program(spindle: &str, more: &str) -> String {
    format!(
        "%\nO1\nG21 G90 G54\nT1 M6\n{spindle}\nG0 X20. Y20. Z5.\nG98 G81 Z-22. R2. F100\nG80\n{more}G0 Z5.\nM30\n%\n"
    )
}

fn place(program: &str) -> tempfile::TempDir {
    let place = tempfile::tempdir().unwrap();
    std::fs::write(place.path().join("machine.toml"), MACHINE).unwrap();
    std::fs::write(place.path().join("O1.nc"), program).unwrap();
    place
}

fn errors(done: &Output) -> String {
    String::from_utf8_lossy(&done.stderr).into_owned()
}

#[test]
fn a_program_without_a_move_has_no_page_and_no_sheet() {
    let place = place("%\nO1\n#500=5.\nG4 X1.\nM30\n%\n");
    for what in ["page", "sheet"] {
        let done = run_line(&format!("gcode-sim {what} O1.nc -o O1.html"), place.path());
        assert_eq!(done.status.code(), Some(2), "{what}");
        assert!(errors(&done).contains(&format!("no {what} is written: the program makes no move")));
        assert!(!place.path().join("O1.html").exists(), "{what}");
    }
}

/// A stopped spindle is an error of the motion, and needs no reference.
#[test]
fn an_error_in_the_motion_fails_a_picture_as_it_fails_a_page() {
    for (spindle, code) in [("S1000 M3", 0), ("S1000", 1)] {
        let place = place(&program(spindle, ""));
        for command in
            ["render O1.nc -o O1.png --size 480x360", "page O1.nc -o O1.html", "sheet O1.nc -o S.html"]
        {
            let done = run_line(&format!("gcode-sim {command}"), place.path());
            assert_eq!(done.status.code(), Some(code), "{command}: {}", errors(&done));
            assert_eq!(errors(&done).contains("error[spindle-stopped]"), code == 1, "{command}");
        }
    }
}

#[test]
fn a_list_of_a_program_says_which_feeds_it_lacks() {
    let lacks = |more: &str| {
        let place = place(&program("S1000 M3", more));
        let done = run_line("gcode-sim new reference --from O1.nc -o holes.csv", place.path());
        assert_eq!(done.status.code(), Some(0));
        errors(&done).contains("note: not in the list: feeds that are in no hole")
    };
    assert!(lacks("G0 X60. Y30.\nG1 Z-5. F100\nG3 X70. I5.\nG1 Y40.\n"));
    assert!(!lacks(""));
}

/// The tip is 2 mm below a plate of 20: that is no deviation of a through hole.
#[test]
fn a_breakthrough_is_no_error_and_a_picture_of_the_verdict_is_that_of_render() {
    let place = place(&program("S1000 M3", ""));
    let read = |name: &str| std::fs::read(Path::new(place.path()).join(name)).unwrap();
    std::fs::write(place.path().join("holes.csv"), "id,x,y,depth,diameter,through\nA,20,20,20,10,true\n")
        .unwrap();
    let verify = run_line(
        "gcode-sim verify O1.nc --reference holes.csv --picture verify.png --page O1.html",
        place.path(),
    );
    let text = String::from_utf8_lossy(&verify.stdout).into_owned();
    let row = text.lines().find(|line| line.starts_with("A ")).unwrap();
    assert!(row.contains(" through ") && row.ends_with("pass"), "{text}");
    let page = String::from_utf8(read("O1.html")).unwrap();
    assert!(page.contains("data-name=\"Depth error\">through<"));
    run_line("gcode-sim verify O1.nc --reference holes.csv --picture alone.png", place.path());
    assert_eq!(read("verify.png"), read("alone.png"));
    run_line("gcode-sim render O1.nc --reference holes.csv -o render.png", place.path());
    assert_eq!(read("alone.png"), read("render.png"));
}
