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

/// A move is told as the position display shows it: G54 is 300 left of machine zero and H1 50 long, which no number here has in it.
/// While the path is played, the block of the move stays in sight beside the drawing, or below it on a telephone, with its caption
/// above the drawing.
#[test]
fn the_listing_follows_the_moves() {
    let place = tempfile::tempdir().unwrap();
    let steps: String = (1..=80).map(|x| format!("G1 X{x}. A{x}. F100\n")).collect();
    let head = "O1\n(A LONG PROGRAM)\nG10 L2 P1 X-300. Z-400.\nG10 L10 P1 R50.\nG21 G90 G54 G0 X0. Y0. A0.\nG43 H1 Z10.\n";
    std::fs::write(place.path().join("O1.nc"), format!("{head}{steps}M30\n")).unwrap();
    assert!(programs::run_line("gcode-sim page O1.nc -o page.html", place.path()).status.success());
    for (width, height) in [(1400, 1000), (1366, 768), (500, 844)] {
        let browser = Browser::start(width, height);
        browser.open(&place.path().join("page.html"));
        assert_eq!(browser.run("return document.title"), "Program O0001 (O1.nc)");
        browser.run("document.getElementById('player').scrollIntoView()");
        for _ in 0..62 {
            browser.run("document.querySelector('[data-play=step]').click()");
        }
        // Two moves lead to the first step of 80.
        let text = picked(&browser);
        assert!(text.contains("to X 60.000 Y 0.000 Z 10.000 A 60.000 on the position display"), "{text}");
        assert!(text.contains("O0001:66 G1 X60. A60. F100"), "{text}");
        let seen = browser.run(
            "const [block, pane, caption, canvas] = ['.half.at', '#programs', '#picked', '#canvas-new'] \
               .map((one) => document.querySelector(one).getBoundingClientRect()); \
             return [block.top >= pane.top && block.bottom <= pane.bottom, block.bottom <= innerHeight, \
               caption.bottom <= canvas.top, caption.top >= 0]",
        );
        assert_eq!(seen, json!([true, true, true, true]), "{width} wide");
    }
}

/// Z is unknown until Z50.: the path begins there, as where one block commands X, Y and Z.
#[test]
fn the_start_is_where_the_known_path_begins() {
    let drawn = |first: &str| {
        let place = tempfile::tempdir().unwrap();
        let program = format!("O1\nG21 G90 G54 {first}\nG1 Z-5. F100\nX100.\nY40.\nM30\n");
        std::fs::write(place.path().join("O1.nc"), program).unwrap();
        assert!(programs::run_line("gcode-sim page O1.nc -o page.html", place.path()).status.success());
        let browser = Browser::start(1400, 1000);
        browser.open(&place.path().join("page.html"));
        browser.click("[data-view=front]");
        picture(&browser, "new")
    };
    let begins_at_50 = drawn("G0 X0. Y0. Z50.");
    assert_eq!(drawn("G0 X0. Y0.\nZ50."), begins_at_50);
    assert_ne!(drawn("G0 X0. Y0. Z20."), begins_at_50);
}

/// The work zero, the start and the end are drawn, and in the legend.
#[test]
fn zero_start_and_end_are_drawn() {
    let place = tempfile::tempdir().unwrap();
    let program = "O1\nG21 G90 G54 G0 X0. Y0. Z0.\nG1 X100. F100\nY40.\nX20.\nM30\n";
    std::fs::write(place.path().join("O1.nc"), program).unwrap();
    assert!(programs::run_line("gcode-sim page O1.nc -o page.html", place.path()).status.success());
    let browser = Browser::start(1400, 1000);
    browser.open(&place.path().join("page.html"));
    browser.click("[data-view=top]");
    picture(&browser, "new");
    let legend =
        browser.run("return [...document.querySelectorAll('.legend li')].map((item) => item.className)");
    let has = |name: &str| legend.as_array().unwrap().iter().any(|item| item == name);
    assert!(["zero", "start", "end"].into_iter().all(has), "{legend}");
    // The end is the one black square of 9 by 9 pixels: nothing else on the canvas is as broad.
    let squares = browser.run(
        "const canvas = document.getElementById('canvas-new'); \
         const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height); \
         const dark = (x, y) => { const at = 4 * (y * canvas.width + x); \
           return data[at + 3] > 200 && data[at] < 60 && data[at + 1] < 60 && data[at + 2] < 60; }; \
         const all = [...Array(9).keys()]; let found = 0; \
         for (let y = 0; y + 9 < canvas.height; y++) for (let x = 0; x + 9 < canvas.width; x++) \
           if (dark(x, y) && dark(x + 8, y + 8) && all.every((dx) => all.every((dy) => dark(x + dx, y + dy)))) found++; \
         return found",
    );
    assert!((1..=9).contains(&squares.as_u64().unwrap()), "{squares}");
    is_quiet(&browser);
}
