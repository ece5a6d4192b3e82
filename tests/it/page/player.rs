//! What a person does with the page of one program: plays its path, goes back, zooms in.
use super::*;

/// A page of one program: its path is played move by move, and goes back.
#[test]
fn a_person_plays_a_program_and_goes_back() {
    let place = tempfile::tempdir().unwrap();
    let program = "O1\nG21 G90 G54 G0 X0. Y0. Z50.\nG1 Z-1. F100\nX10.\nY10.\nX0.\nG0 Z50.\nM30\n";
    std::fs::write(place.path().join("O1.nc"), program).unwrap();
    assert!(programs::run_line("gcode-sim page O1.nc -o page.html", place.path()).status.success());
    let browser = Browser::start(1400, 1000);
    browser.open(&place.path().join("page.html"));
    let all = picture(&browser, "new");
    browser.click("[data-play=step]");
    browser.click("[data-play=step]");
    browser.click("[data-play=step]");
    assert!(picked(&browser).contains("O0001:4 X10."), "{}", picked(&browser));
    let third = picture(&browser, "new");
    assert_ne!(third, all);
    browser.click("[data-play=back]");
    assert!(picked(&browser).contains("O0001:3 G1 Z-1. F100"), "{}", picked(&browser));
    browser.click("[data-play=step]");
    assert_eq!(picture(&browser, "new"), third, "back and forward again");
    // Played, it ends at its last move, and the button is one to play again.
    browser.click("[data-play=play]");
    std::thread::sleep(std::time::Duration::from_millis(800));
    assert_eq!(browser.run("return document.getElementById('progress-count').textContent"), "6 of 6");
    assert!(picked(&browser).contains("O0001:7 G0 Z50."), "{}", picked(&browser));
    is_quiet(&browser);
}

/// A circle of 100 mm is drawn by chords up to 0.05 mm off it, and zoomed in by its exact points: halfway between two of them the
/// line is at most 0.001 mm off, and 0.0001 for their digits.
#[test]
fn zoomed_in_the_path_itself_is_drawn() {
    let place = tempfile::tempdir().unwrap();
    let program = "O1\nG21 G90 G54 G0 X100. Y0. Z0.\nG1 Z-1. F500\nG3 X100. Y0. I-100. J0.\nG0 Z50.\nM30\n";
    std::fs::write(place.path().join("O1.nc"), program).unwrap();
    assert!(programs::run_line("gcode-sim page O1.nc -o page.html", place.path()).status.success());
    let browser = Browser::start(1400, 1000);
    browser.open(&place.path().join("page.html"));
    let off = browser.run(
        "const side = JSON.parse(document.getElementById('data').textContent).sides[0]; \
         const move = side.exact.findIndex((text) => text); \
         const off = (xyz) => { let most = 0; \
           for (let at = 0; at + 5 < xyz.length; at += 3) \
             most = Math.max(most, Math.abs(100 - Math.hypot(xyz[at] + xyz[at + 3], xyz[at + 1] + xyz[at + 4]) / 2)); \
           return most; }; \
         return [off(side.scene.strokes[move].line), off(exactPoints(side.exact[move]))]",
    );
    let (lines, exact) = (off[0].as_f64().unwrap(), off[1].as_f64().unwrap());
    assert!(0.01 < lines && lines < 0.052, "{lines}");
    assert!(0.0 < exact && exact < 0.0012, "{exact}");
    let all = picture(&browser, "new");
    let (x, y) =
        middle(&browser, "return document.getElementById('canvas-new').getBoundingClientRect().toJSON()");
    browser.wheel((x, y), -3000.0);
    assert_ne!(picture(&browser, "new"), all);
    is_quiet(&browser);
}
