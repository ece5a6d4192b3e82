//! The review page in a browser: what a person does with it, on a screen, on a telephone and on paper.
mod comparison;
mod player;

use std::path::{Path, PathBuf};

use gcode_tests::browser::{Browser, key};
use gcode_tests::{programs, workspace};
use serde_json::{Value, json};

/// Runs `gcode-sim` in `dir` and gives the page that it wrote there.
fn page(dir: &Path, command: &str) -> PathBuf {
    let done = programs::run_line(&format!("gcode-sim {command} --page review.html"), dir);
    assert!(done.status.code().is_some_and(|code| code != 2), "{}", String::from_utf8_lossy(&done.stderr));
    dir.join("review.html")
}

/// The page of the example with one wrong digit, and the folder it is in.
fn one_digit_wrong(more: &str) -> (tempfile::TempDir, PathBuf) {
    let place = tempfile::tempdir().unwrap();
    let example = |name: &str| workspace().join("examples").join(name).display().to_string();
    let (old, new) = (example("melon-mould"), example("one-digit-wrong"));
    let command = format!(
        "diff {old}/O8100.nc {new}/O8100.nc --lib {old} --machine {old}/machine.toml {}",
        more.replace("JOB", &format!("{old}/job.toml"))
    );
    let page = page(place.path(), &command);
    (place, page)
}

/// The page of a program and what became of it.
fn of_texts(old: &[u8], new: &[u8]) -> (tempfile::TempDir, PathBuf) {
    let place = tempfile::tempdir().unwrap();
    std::fs::write(place.path().join("OLD.nc"), old).unwrap();
    std::fs::write(place.path().join("NEW.nc"), new).unwrap();
    let page = page(place.path(), "diff OLD.nc NEW.nc");
    (place, page)
}

fn column(browser: &Browser, number: u32) -> Vec<String> {
    let cells = format!("tbody tr:not([hidden]) > :nth-child({number})");
    let texts = browser.run(&format!(
        "return [...document.querySelector('table.holes').querySelectorAll('{cells}')].map((cell) => cell.textContent)"
    ));
    texts.as_array().unwrap().iter().map(|text| text.as_str().unwrap().trim().to_owned()).collect()
}

/// The block that the page stands at must become the one that begins so: a browser tells of a jump a moment later.
fn lands(browser: &Browser, expected: &str) {
    let at = || {
        browser.run(
            "const half = document.querySelector('.half.at'); \
             return half && `${half.id} ${half.querySelector('code').textContent}`",
        )
    };
    let there = |place: &Value| place.as_str().is_some_and(|place| place.starts_with(expected));
    for _ in 0..100 {
        if there(&at()) {
            return;
        }
        std::thread::sleep(std::time::Duration::from_millis(50));
    }
    panic!("the page stands at {}, not at {expected}; picked: {}", at(), picked(browser));
}

fn picture(browser: &Browser, side: &str) -> String {
    let drawn = browser.run(&format!(
        "return new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => \
         done(document.getElementById('canvas-{side}').toDataURL()))))"
    ));
    drawn.as_str().unwrap().to_owned()
}

fn picked(browser: &Browser) -> String {
    browser.run("return document.getElementById('picked').textContent").as_str().unwrap().to_owned()
}

/// Nothing in the console, and nothing asked of any network.
fn is_quiet(browser: &Browser) {
    let console = browser.log("browser");
    assert!(console.is_empty(), "{console:?}");
    for entry in browser.log("performance") {
        let message: Value = serde_json::from_str(entry["message"].as_str().unwrap()).unwrap();
        let asked = &message["message"]["params"];
        let is_ours = asked["documentURL"].as_str().is_some_and(|page| page.starts_with("file:"));
        if message["message"]["method"] == "Network.requestWillBeSent" && is_ours {
            let url = asked["request"]["url"].as_str().unwrap();
            assert!(url.starts_with("file:") || url.starts_with("data:"), "the page asks for {url}");
        }
    }
}

#[test]
fn a_person_sorts_the_holes_and_goes_to_a_block() {
    let (_place, page) = one_digit_wrong("--reference JOB");
    let browser = Browser::start(1400, 1000);
    browser.open(&page);
    assert_eq!(column(&browser, 1), ["1", "2", "3", "4", "5"]);

    // By the new φ, downwards: the hole that the wrong digit moved by 0.95 mm is the worst.
    browser.click(".holes th:nth-child(4) button");
    assert_eq!(column(&browser, 1).last().unwrap(), "5");
    browser.click(".holes th:nth-child(4) button");
    assert_eq!(column(&browser, 1)[0], "5");
    let sorted = browser.run(
        "return [...document.querySelectorAll('.holes th[aria-sort]')].map((head) => head.getAttribute('aria-sort'))",
    );
    assert_eq!(sorted[3], "descending");
    assert_eq!(sorted.as_array().unwrap().iter().filter(|sort| *sort != "none").count(), 1);

    // A click anywhere in its row leads to the block that made it, and marks the call with the wrong digit.
    browser.click(".holes tbody tr:first-child td.state");
    lands(&browser, "new-2-67 G01 X[#18+[#17-#7]*#26] Y[#24+[#17-#7]*#27] F#9");
    let seen = browser.run(
        "const box = document.querySelector('.half.at').getBoundingClientRect(); \
         const viewer = document.getElementById('viewer').getBoundingClientRect(); \
         return box.top >= viewer.bottom && box.bottom <= innerHeight",
    );
    assert_eq!(seen, true, "the block stands in sight, below the drawing");
    let caller = browser.run("return document.querySelector('.half.from code').textContent");
    assert!(caller.as_str().unwrap().contains("W15.2385"), "{caller}");
    assert!(
        picked(&browser).contains("hole 5") && picked(&browser).contains("O8100:61"),
        "{}",
        picked(&browser)
    );
    is_quiet(&browser);
}

#[test]
fn all_can_be_done_with_keys() {
    let (_place, page) = one_digit_wrong("");
    let browser = Browser::start(1400, 1000);
    browser.open(&page);

    // A column head sorts, the arrows go from row to row, Enter goes to the block.
    browser.run("document.querySelector('.holes th:nth-child(9) button').focus()");
    browser.press(&key::ENTER.repeat(2));
    assert_eq!(column(&browser, 1)[0], "5", "moved the farthest");
    browser.run("document.querySelector('.holes tbody a').focus()");
    browser.press(&[key::DOWN, key::UP, key::ENTER].concat());
    lands(&browser, "new-2-67 ");
    let focus = browser.run("return document.activeElement.id");
    assert_eq!(focus, "new-2-67", "reading goes on at the block");

    // The drawing: turned, zoomed, put back; both canvases look from the same side.
    browser.run("document.getElementById('canvas-new').focus()");
    let (old, new) = (picture(&browser, "old"), picture(&browser, "new"));
    browser.press(key::LEFT);
    let (turned_old, turned_new) = (picture(&browser, "old"), picture(&browser, "new"));
    assert!(old != turned_old && new != turned_new, "both turn");
    browser.press(&[key::RIGHT, "+"].concat());
    assert_ne!(picture(&browser, "new"), new, "zoomed");
    browser.press("0");
    assert_eq!(picture(&browser, "new"), new);
    browser.click("[data-view=reset]");
    assert_ne!(picture(&browser, "new"), new, "the first view shows the change, and not all");
    browser.run("document.getElementById('canvas-new').focus()");

    // From move to move, each with its block; Enter goes there.
    browser.press("nnn");
    assert!(picked(&browser).starts_with("New, move 3 of "), "{}", picked(&browser));
    browser.press(key::ENTER);
    let name = picked(&browser).split(". ").nth(1).unwrap().split(' ').next().unwrap().to_owned();
    let (program, line) = name.split_once(':').unwrap();
    let source = ["O8100", "O8102", "O8101"].iter().position(|known| *known == program).unwrap();
    lands(&browser, &format!("new-{source}-{line} "));
    is_quiet(&browser);
}

/// The middle of what a script gives as left, top, width and height.
fn middle(browser: &Browser, script: &str) -> (f64, f64) {
    let found = browser.run(script);
    let number = |name: &str| found[name].as_f64().unwrap();
    (number("left") + number("width") / 2.0, number("top") + number("height") / 2.0)
}

#[test]
fn the_mouse_turns_zooms_and_picks() {
    // One hole, in the middle of all that is fitted into the canvas.
    let program = "O1\nT1 M6\nG0 X0 Y0 Z10.\nM3 S500\nG1 Z-8. F50\nG0 Z10.\nX90. Y40.\nM30\n";
    let (_place, page) = of_texts(program.as_bytes(), program.replace("Z-8.", "Z-9.").as_bytes());
    let browser = Browser::start(1200, 1000);
    browser.open(&page);
    browser.run("document.getElementById('viewer').scrollIntoView()");
    let (x, y) =
        middle(&browser, "return document.getElementById('canvas-new').getBoundingClientRect().toJSON()");
    // The scale has 40 pixels below what is fitted.
    let y = y - 20.0;
    let before = picture(&browser, "new");
    browser.drag(&[(x + 150.0, y + 60.0), (x + 200.0, y + 60.0), (x + 220.0, y + 80.0)]);
    let turned = picture(&browser, "new");
    assert_ne!(turned, before);
    browser.wheel((x, y), -240.0);
    assert_ne!(picture(&browser, "new"), turned);

    browser.click("[data-view=reset]");
    browser.drag(&[(x, y)]);
    lands(&browser, "new-0-5 G1 Z-9.");
    assert!(
        picked(&browser).starts_with("New, hole 1 on the part at x 0.000 y 0.000"),
        "{}",
        picked(&browser)
    );
    is_quiet(&browser);
}

#[test]
fn a_telephone_the_dark_and_paper_are_served() {
    let (_place, page) = one_digit_wrong("--reference JOB");
    let browser = Browser::start(1400, 1000);
    browser.open(&page);
    let paper = || browser.run("return getComputedStyle(document.body).backgroundColor");
    assert_eq!(paper(), "rgb(255, 255, 255)");
    let light = picture(&browser, "new");
    let dark = json!({"features": [{"name": "prefers-color-scheme", "value": "dark"}]});
    browser.command("Emulation.setEmulatedMedia", &dark);
    assert_eq!(paper(), "rgb(21, 23, 26)");
    assert_ne!(picture(&browser, "new"), light, "the drawing follows");

    let printed = browser.command(
        "Page.printToPDF",
        &json!({"printBackground": true, "paperWidth": 8.27, "paperHeight": 11.69}),
    );
    let pdf = printed["data"].as_str().unwrap();
    assert!(pdf.starts_with("JVBERi0"), "%PDF- in base64");

    let narrow = json!({"width": 375, "height": 740, "deviceScaleFactor": 2, "mobile": true});
    browser.command("Emulation.setDeviceMetricsOverride", &narrow);
    let wide = browser.run("return document.documentElement.scrollWidth");
    assert_eq!(wide, 375, "nothing sticks out to the side");
    browser.click(".holes tbody tr:first-child a.go");
    lands(&browser, "new-2-67 ");
    is_quiet(&browser);
}

#[test]
fn what_a_program_says_is_text_and_nothing_else() {
    let mut old =
        b"O1(</script><img src=x onerror=\"document.title='broken'\">)\n#1=1(</SCRIPT><b id=broken>)\n"
            .to_vec();
    // GBK for a greeting, and bytes that are no text in any encoding.
    old.extend(b"(\xc4\xe3\xba\xc3 \xff\xfe\x00)\n#3006=1(<!--<script>)\nG0 X1.(&lt;)\n");
    let mut new = old.clone();
    old.extend(b"M30\n");
    new.extend(b"G1 X5. F'100\nM30\n");
    let (_place, page) = of_texts(&old, &new);
    assert!(std::str::from_utf8(&std::fs::read(&page).unwrap()).is_ok(), "the page is UTF-8");
    let browser = Browser::start(1200, 900);
    browser.open(&page);
    assert_eq!(browser.run("return document.querySelectorAll('img, #broken').length"), 0);
    assert_eq!(browser.run("return document.title"), "Review of NEW.nc against OLD.nc");
    let line = browser.run("return document.querySelector('#old-0-1 code').textContent");
    assert_eq!(line, "O1(</script><img src=x onerror=\"document.title='broken'\">)");
    let line = browser.run("return document.querySelector('#old-0-5 code').textContent");
    assert_eq!(line, "G0 X1.(&lt;)");
    let messages = browser.run("return document.getElementById('messages').textContent");
    assert!(messages.as_str().unwrap().contains("<!--<script>"), "{messages}");
    is_quiet(&browser);
}

/// The operator turns the part at M00: a program without it is the one mistake that must be seen in the old text too.
#[test]
fn a_lost_stop_is_marked_where_it_was() {
    let old = b"O1\nG21\nG0 X1.\nM00\nG0 X2.\n#3006=1(TURN)\nM30\n";
    let (_place, page) = of_texts(old, b"O1\nG21\nG0 X1.\nG0 X2.\n#3006=1(CLAMP)\nM30\n");
    let browser = Browser::start(1200, 900);
    browser.open(&page);
    let marks = browser.run(
        "return [...document.querySelectorAll('.half .mark')].map((mark) => \
         `${mark.closest('.half').id} ${mark.textContent}`)",
    );
    let expected = [
        "old-0-4 stop not executed here by the new program",
        "old-0-6 stop executed differently by the new program",
        "new-0-5 stop executed differently by the old program",
    ];
    assert_eq!(marks, json!(expected));
    let listed = browser.run(
        "return [...document.querySelectorAll('#messages .stops li')].map((stop) => \
         `${stop.querySelector('code').textContent} ${stop.querySelector('.mark').textContent}`)",
    );
    let expected = [
        "M00 not executed here by the new program",
        "#3006 executed differently by the new program",
        "#3006 executed differently by the old program",
    ];
    assert_eq!(listed, json!(expected));

    // A telephone shows one program's lines where both are alike, and this one's in any case.
    browser.command(
        "Emulation.setDeviceMetricsOverride",
        &json!({"width": 375, "height": 740, "deviceScaleFactor": 2, "mobile": true}),
    );
    assert_eq!(browser.run("return document.documentElement.scrollWidth"), 375);
    let high =
        browser.run("return document.querySelector('#old-0-4 .mark').getBoundingClientRect().height > 0");
    assert_eq!(high, true);
    browser.click("#messages .stops li .place a");
    lands(&browser, "old-0-4 M00");
    is_quiet(&browser);
}

/// A spot drilling that is lost is nothing that position, depth or diameter of the hole would show.
#[test]
fn a_row_says_what_is_different_and_names_all_tools() {
    let spot = "T1 M6\nS500 M3\nG0 Y50.\nX10. Z0\nG1 Y-2. F100\nG0 Y50.\n";
    let drill = "T2 M6\nS500 M3\nX10. Z0\nG1 Y-20. F100\nG0 Y50.\nX30.\nG1 Y-20.\nG0 Y50.\nM30\n";
    let old = format!("O1\nG90\n{spot}{drill}");
    let (place, page_of_both) = of_texts(old.as_bytes(), format!("O1\nG90\n{drill}").as_bytes());
    let browser = Browser::start(1200, 900);
    browser.open(&page_of_both);
    assert_eq!(column(&browser, 2), ["T2, was T1 T2", "same"]);
    assert_eq!(column(&browser, 8), ["T1 T2 → T2", "T2"]);

    // Against a reference both holes are good; that one is made otherwise stands beside it.
    let expected = "id,x,y,z,i,j,k,depth,diameter\na,10,0,0,0,1,0,20,\nb,30,0,0,0,1,0,20,\n";
    std::fs::write(place.path().join("reference.csv"), expected).unwrap();
    browser.open(&page(place.path(), "diff OLD.nc NEW.nc --reference reference.csv"));
    assert_eq!(column(&browser, 2), ["in tolerance, but: T2, was T1 T2", "in tolerance"]);
    let sign = browser
        .run("return getComputedStyle(document.querySelector('tr.altered .state'), '::before').content");
    assert_eq!(sign, "\"≠ \"");
    is_quiet(&browser);
}

/// 310 holes that are all 1 deeper: a print has 300 of them as they were sorted, and says so.
#[test]
fn a_long_table_is_printed_in_part_and_says_so() {
    let row = |depth: &str| {
        let drilled = format!("WHILE[#1 LT 310]DO1\n#1=#1+1\nG81 X[#1*5.] Y0 Z{depth} R2. F100\nEND1\n");
        format!("O1\nS500 M3\n#1=0\nG0 Z5.\n{drilled}G80\nM30\n")
    };
    let (_place, page) = of_texts(row("-5.").as_bytes(), row("-6.").as_bytes());
    let browser = Browser::start(1200, 900);
    browser.open(&page);
    let rows = "const shown = (element) => getComputedStyle(element).display !== 'none'; \
         const rows = [...document.querySelectorAll('.holes tbody tr')].filter(shown); \
         const note = document.querySelector('#holes p.paper'); \
         return [rows.length, rows[0].cells[0].textContent, shown(note) ? note.textContent : '']";
    browser.click(".holes th:nth-child(1) button");
    browser.click(".holes th:nth-child(1) button");
    assert_eq!(browser.run(rows), json!([310, "310", ""]));
    browser.command("Emulation.setEmulatedMedia", &json!({"media": "print"}));
    let note = "The first 300 of 310 rows are printed, in the order of the screen; the others are on the \
                screen only.";
    assert_eq!(browser.run(rows), json!([300, "310", note]));
    is_quiet(&browser);
}

#[test]
fn what_is_worst_and_what_nobody_executed_stands_first() {
    let cut = "G0 Z5.\nG1 Z-1. F100\nX40.\nY40.\nX0\nY0\nG0 Z50.\n";
    let old = format!("O1\n#1=2\nIF[#1 GT 3]GOTO 9\n{cut}N9 M30\n");
    let new = format!("O1\n#1=2\nIF[#1 GT 3]THEN #3000=1(FAR)\n{cut}X[1/0]\nN9 M30\n");
    let (_place, page) = of_texts(old.as_bytes(), new.as_bytes());
    let browser = Browser::start(1200, 900);
    browser.open(&page);
    let found = browser.run(
        "return [...document.querySelectorAll('#messages .sides > div')].map((side) => \
         [...side.querySelectorAll('.findings > li')].map((finding) => \
         `${finding.className} ${finding.querySelector('code').textContent} ${finding.querySelectorAll('a').length}`))",
    );
    // The contour is no hole that failed: the alarm is the only finding.
    assert_eq!(found, json!([[], ["alarm PS0112 1"]]));
    let marks = browser.run(
        "return [...document.querySelectorAll('#messages .findings .mark')].map((mark) => mark.textContent)",
    );
    assert_eq!(marks, json!(["not in the old program"]));

    let answers = browser
        .run("return [...document.querySelectorAll('header .answer')].map((answer) => answer.textContent)");
    let open = "Executed by neither run, effect unknown: 1 changed block";
    assert_eq!(answers[1], open);
    browser.click("header .answer a");
    let seen = browser
        .run("return location.hash + ' ' + document.querySelector('#unexecuted + .note + ol').textContent");
    assert!(
        seen.as_str().unwrap().contains("#unexecuted") && seen.as_str().unwrap().contains("#3000=1(FAR)"),
        "{seen}"
    );

    // A telephone names both files above the lines of both.
    let narrow = json!({"width": 375, "height": 740, "deviceScaleFactor": 2, "mobile": true});
    browser.command("Emulation.setDeviceMetricsOverride", &narrow);
    let named = browser.run("return document.querySelector('.listing .names').innerText");
    assert!(
        named.as_str().unwrap().contains("Old OLD.nc") && named.as_str().unwrap().contains("New NEW.nc"),
        "{named}"
    );
    is_quiet(&browser);
}

#[test]
fn a_program_that_stops_shows_where_and_why() {
    let old = b"O1\n#1=4.\nG0 X[#1/2.]\nM30\n";
    let (_place, page) = of_texts(old, b"O1\n#1=4.\nG0 X[#1/0]\nM30\n");
    let text = std::fs::read_to_string(&page).unwrap();
    assert!(text.contains("New: stopped, alarm PS0112"), "the answer names the alarm");
    let browser = Browser::start(1200, 900);
    browser.open(&page);
    // From the alarm to its line; nothing is there to be drawn on the new side.
    browser.click("#messages .alarm .place a");
    lands(&browser, "new-0-3 G0 X[#1/0]");
    let halves = browser.run(
        "return ['old-0-3', 'new-0-3', 'old-0-4', 'new-0-4'].map((id) => document.getElementById(id).classList.contains('done'))",
    );
    assert_eq!(halves, json!([true, true, true, false]), "M30 of the new program is never reached");
    let values = browser.run("return document.querySelector('#old-0-2 .values').textContent.trim()");
    assert_eq!(values, "#1 ← 4");
    is_quiet(&browser);
}

#[test]
fn a_long_program_is_drawn_in_fewer_lines_and_says_so() {
    let moves = "WHILE[#1 LT 45000]DO1\n#1=#1+1\nG1 X[#1 MOD 100] Y[#1/1000.] F900\nEND1\n";
    let program = format!("O1\n#1=0\nG0 Z5.\n{moves}G0 Z50.\nM30\n");
    let (_place, page) = of_texts(program.as_bytes(), program.as_bytes());
    let text = std::fs::read_to_string(&page).unwrap();
    assert!(text.len() < 5_000_000, "{} bytes", text.len());
    // The first move, whose start is unknown, and the last one are lines of their own.
    assert!(text.contains("45\u{a0}002 moves are drawn as 22\u{a0}503 lines"));
    assert!(text.contains("#1 0 … 44999 (45000×)"), "the variable's first and last value before the block");
    let browser = Browser::start(1200, 900);
    browser.open(&page);
    browser.run("document.getElementById('canvas-new').focus()");
    let turned = browser.run(
        "const begun = performance.now(); \
         return new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(performance.now() - begun))))",
    );
    assert!(turned.as_f64().unwrap() < 5000.0, "{turned} ms");
    is_quiet(&browser);
}

#[test]
fn a_program_alone_has_a_page_too() {
    let place = tempfile::tempdir().unwrap();
    let example = workspace().join("examples/melon-mould").display().to_string();
    let program = format!("{example}/O8100.nc --machine {example}/machine.toml");
    let judged = page(place.path(), &format!("verify {program} --reference {example}/job.toml"));
    let text = std::fs::read_to_string(&judged).unwrap();
    assert!(
        text.contains("PASS, 5 of 5 holes in tolerance")
            && text.contains("Predicted by simulation, not measured")
    );
    assert!(!text.contains("id=\"changes\"") && !text.contains("canvas-old"));
    // `sha256sum job.toml`, as the page writes it.
    let digest = std::fs::read(format!("{example}/job.toml")).map(sha256).unwrap();
    assert!(text.contains(&digest), "{digest}");

    let browser = Browser::start(1200, 900);
    page(place.path(), &format!("holes {program}"));
    browser.open(&judged);
    assert_eq!(column(&browser, 1), ["1", "2", "3", "4", "5"]);
    browser.click(".holes tbody tr:nth-child(2) a.go");
    lands(&browser, "new-2-67 ");
    is_quiet(&browser);
}

/// As `sha256sum` prints it.
fn sha256(bytes: Vec<u8>) -> String {
    use std::io::Write;
    let mut sum = std::process::Command::new("sha256sum")
        .stdin(std::process::Stdio::piped())
        .stdout(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    sum.stdin.take().unwrap().write_all(&bytes).unwrap();
    let said = sum.wait_with_output().unwrap().stdout;
    String::from_utf8(said).unwrap().split(' ').next().unwrap().to_owned()
}
