//! The set-up sheet: complete in one file, no text of a job becomes markup, its hashes are those of the files written.
use std::path::Path;

use gcode_sim::report::encode::sha256;
use gcode_tests::programs;
use gcode_tests::sheet::html;

const JOB: &str = "family = \"pin-holes\"\n[control]\ndialect = \"fanuc-31i\"\nincrement = \"IS-B\"\n[machine]\n\
                   rotary = { letter = \"B\", sign = 1 }\n[surface]\nkind = \"ellipsoid\"\na = 500.0\nb = 300.0\n\
                   [tolerance]\nposition = 0.1\n[[hole]]\nid = \"EVIL\"\nradius = 200.0\nazimuth = 15.0\n\
                   axis = \"normal\"\ndiameter = 6.0\ndepth = 15.0\n";

/// Texts that would run in a browser if they were markup.
#[test]
fn no_text_of_a_job_becomes_markup() {
    let evil = "<script>alert(1)</script>\\\" onload='x' <img src=x>";
    let words = ["part", "drawing", "revision", "material", "machine"];
    let section: String = words.iter().map(|word| format!("{word} = \"{evil}\"\n")).collect();
    let rates = format!(
        "[sheet.rates]\ncurrency = \"{evil}\"\nrate = 1\n[[sheet.rates.beside]]\nmachine = \"{evil}\"\nrate = 2\n"
    );
    let job = JOB.replace("EVIL", evil);
    let html = html(&format!("{job}[sheet]\n{section}{rates}"), None);
    assert!(!html.contains("<script") && !html.contains("<img"), "{html}");
    assert!(!html.contains("\" onload"), "a quote ends no attribute");
    assert!(html.matches("&lt;script&gt;").count() > 10);
}

#[test]
fn a_sheet_has_everything_inside_and_no_script() {
    let place = tempfile::tempdir().unwrap();
    std::fs::write(place.path().join("job.toml"), JOB).unwrap();
    let done = programs::run_line("gcode-gen sheet job.toml -o sheet.html", place.path());
    assert!(done.status.success());
    let html = std::fs::read_to_string(place.path().join("sheet.html")).unwrap();
    let addresses = html.replace("http://www.w3.org/2000/svg", "");
    for outside in ["http:", "https:", "<link", "<script", "@import", "url(", "//"] {
        let without_pictures: String = addresses
            .split("src=\"data:image/png;base64,")
            .map(|piece| piece.rsplit('"').next().unwrap())
            .collect();
        assert!(!without_pictures.contains(outside), "{outside}");
    }
    assert_eq!(html.matches("<img ").count(), html.matches("src=\"data:image/png;base64,").count());
    assert!(html.contains("<img "), "the part is shown");
}

#[test]
fn its_hashes_are_those_of_the_files_that_emit_writes() {
    let place = tempfile::tempdir().unwrap();
    std::fs::write(place.path().join("job.toml"), JOB).unwrap();
    for line in ["gcode-gen emit job.toml --out nc", "gcode-gen sheet job.toml -o sheet.html"] {
        assert!(programs::run_line(line, place.path()).status.success(), "{line}");
    }
    let html = std::fs::read_to_string(place.path().join("sheet.html")).unwrap().replace("<wbr>", "");
    for name in ["O8100.nc", "O8101.nc", "O8102.nc", "machine.toml"] {
        let bytes = std::fs::read(place.path().join("nc").join(name)).unwrap();
        assert!(html.contains(&sha256(&bytes)), "{name}");
    }
}

#[test]
fn the_columns_for_results_are_empty() {
    let html = html(JOB, None);
    // Position, depth and diameter of one hole: two columns each, both empty.
    for name in ["results", "gauge, non-conformance"] {
        assert_eq!(html.matches(&format!("<td class=\"result\" data-name=\"{name}\"></td>")).count(), 3);
    }
    assert_eq!(html.matches("class=\"result\"").count(), 6);
}

#[test]
fn a_job_that_fails_verification_has_no_sheet() {
    let place = tempfile::tempdir().unwrap();
    // Least increments of 0.01 spoil a zone of 0.001.
    let coarse = JOB.replace("IS-B", "IS-A").replace("position = 0.1", "position = 0.001");
    std::fs::write(place.path().join("job.toml"), coarse).unwrap();
    let done = programs::run_line("gcode-gen sheet job.toml -o sheet.html", place.path());
    assert_eq!(done.status.code(), Some(1));
    assert!(!Path::new(&place.path().join("sheet.html")).exists());
}

/// The sheet in a browser.
#[cfg(feature = "browser")]
mod screen {
    use gcode_tests::browser::Browser;
    use gcode_tests::sheet::html;
    use gcode_tests::workspace;
    use serde_json::json;

    use super::JOB;

    /// At 375 px, with the dark mode that a browser forces: nothing is wider than the screen, and the paper stays white.
    #[test]
    fn a_telephone_shows_every_table_whole() {
        let browser = Browser::start(800, 900);
        let metrics = json!({"width": 375, "height": 800, "deviceScaleFactor": 1, "mobile": true});
        browser.command("Emulation.setDeviceMetricsOverride", &metrics);
        browser.command("Emulation.setAutoDarkModeOverride", &json!({"enabled": true}));
        let place = tempfile::tempdir().unwrap();
        let setting_up = std::fs::read_to_string(workspace().join("examples/alignment/job.toml")).unwrap();
        for (name, job) in [("alignment", setting_up.as_str()), ("pin-holes", JOB)] {
            let page = place.path().join(format!("{name}.html"));
            std::fs::write(&page, html(job, None)).unwrap();
            browser.open(&page);
            let wide = browser.run(
                "return [document.documentElement, ...document.querySelectorAll('.wide, .wide *')] \
                 .filter((one) => one.scrollWidth > 375 || one.getBoundingClientRect().right > 376) \
                 .map((one) => one.outerHTML.slice(0, 200))",
            );
            assert_eq!(wide, json!([]), "{name}");
            let scheme = browser.run("return getComputedStyle(document.documentElement).colorScheme");
            assert!(scheme.as_str().unwrap().contains("only"), "{scheme}");
            let paper =
                browser.run("return getComputedStyle(document.querySelector('figure svg')).backgroundColor");
            assert_eq!(paper, json!("rgb(255, 255, 255)"));
        }
    }
}

/// Rapids at 15,000 mm/min, feeds at 600: Z from 50 to -2 takes 52/600 min and so on; the numbers of the tools' rows are worked out
/// at each of them. T1 mills at S3000 with H1 and D11 in G54, T2 drills two holes at S1200 with H2 in G55, after M00 and a stop
/// that names #101.
const BY_HAND: &str = "%\nO1234 (PLATE <B>)\nG90 G17 G21 G40 G80 G49\nT1 M6\nG54 G0 X-10. Y0.\nG43 H1 Z50. S3000 M3\n\
                       M8\nG1 Z0. F600\nG41 D11 X10. Y0.\nX310.\nG40 X320.\nG0 Z50. M9\nM5\nM00 (TURN THE PART)\n#101=12.5\n\
                       #3006=1(SET JAW TO #101)\nT2 M6\nG55 G0 X10. Y10.\nG43 H2 Z50. S1200 M3\nM77\n\
                       G99 G81 Z-10. R2. F120.\nX20.\nG80\nG0 Z50.\nM30\n%\n";

/// Returns the cells of the rows of the table below a heading.
fn rows(html: &str, heading: &str) -> Vec<Vec<String>> {
    let below = html.split(&format!("<h2>{heading}</h2>")).nth(1).unwrap();
    let table = below.split("<tbody>").nth(1).unwrap().split("</tbody>").next().unwrap();
    let text = |cell: &str| {
        let inside = cell.split_once('>').map_or("", |(_, inside)| inside);
        let words = inside.split('<').map(|piece| piece.rsplit('>').next().unwrap()).collect::<String>();
        words.trim().to_owned()
    };
    table.split("<tr>").skip(1).map(|row| row.split("<td").skip(1).map(text).collect()).collect()
}

#[test]
fn a_program_by_hand_has_a_sheet_with_its_tools_offsets_stops_and_codes() {
    let place = tempfile::tempdir().unwrap();
    std::fs::write(place.path().join("O1234.nc"), BY_HAND).unwrap();
    let done = programs::run_line("gcode-sim sheet O1234.nc -o sheet.html", place.path());
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let html = std::fs::read_to_string(place.path().join("sheet.html")).unwrap();
    assert!(!html.contains("<script") && !html.contains("<B>") && html.contains("O1234 (PLATE &lt;B&gt;)"));
    assert!(html.contains(&sha256(BY_HAND.as_bytes()).split_at(32).0.to_owned()));
    assert!(html.contains("Not compared with a drawing."), "no reference, no verdict");

    let systems: Vec<String> = rows(&html, "Work zeros").iter().map(|row| row[0].clone()).collect();
    assert_eq!(systems, ["G54", "G55"]);

    // T1 feeds 50 + 330 mm at 600 mm/min: 0.63 min. Each hole is fed 12 mm at 120 mm/min: 0.1 min, 0.2 for two.
    let tools = rows(&html, "Tools, in the order of use");
    assert_eq!(tools.len(), 2, "{tools:?}");
    // Without a machine file neither lengths nor offsets are known.
    let first = ["T1", "", "", "H1 (not set)", "D11 (not set)", "3000", "600", "M08", ""];
    assert_eq!(tools[0][..9], first, "{tools:?}");
    assert_eq!(tools[1][..9], ["T2", "", "", "H2 (not set)", "", "1200", "120", "", "2"], "{tools:?}");
    assert_eq!([&tools[0][9], &tools[1][9]], ["0.6", "0.2"]);
    assert_eq!([&tools[0][10], &tools[1][10]], ["O1234 line 5", "O1234 line 18"]);

    assert!(!html.contains("Switches of the panel"), "no block has a / and no stop is M01");
    let stops = rows(&html, "Operator stops");
    assert_eq!(stops.len(), 2, "{stops:?}");
    assert!(stops[0][1].starts_with("M00 TURN THE PART") && stops[0][2] == "T1", "{stops:?}");
    assert!(stops[1][1].starts_with("#3006 SET JAW TO #101 #101 = 12.5"), "{stops:?}");
    assert_eq!(rows(&html, "M codes of the machine builder")[0][..2], ["M77", "O1234 line 20"]);
}

/// The same holes 5 mm away are wrong: the sheet says FAIL, the exit code is 1, and the file is written.
#[test]
fn a_sheet_shows_the_verdict_and_has_its_exit_code() {
    let place = tempfile::tempdir().unwrap();
    std::fs::write(place.path().join("O1234.nc"), BY_HAND).unwrap();
    let machine =
        "[head]\nkind = \"fixed\"\ndirection = [0.0, 0.0, 1.0]\n[start]\nX = 0.0\nY = 0.0\nZ = 100.0\n";
    std::fs::write(place.path().join("machine.toml"), machine).unwrap();
    std::fs::write(
        place.path().join("wrong.csv"),
        "id,x,y,z,i,j,k,depth\n1,15,10,0,0,0,1,10\n2,25,10,0,0,0,1,10\n",
    )
    .unwrap();
    let line = "gcode-sim sheet O1234.nc --machine machine.toml --reference wrong.csv -o wrong.html";
    let done = programs::run_line(line, place.path());
    assert_eq!(done.status.code(), Some(1), "{}", String::from_utf8_lossy(&done.stderr));
    let html = std::fs::read_to_string(place.path().join("wrong.html")).unwrap();
    assert!(html.contains("<b>FAIL. </b>") && html.contains("0 of 2 holes in tolerance"), "{html}");
}

/// Comments on tools behind their change and at the head, a block with `/`, and M01.
#[test]
fn a_sheet_has_the_comments_on_tools_and_the_switches_of_the_panel() {
    let program = "%\nO1 (PLATE)\n(T2 - .240 THREAD MILL)\nG90 G17 G21 G40 G80 G49 G54\nT1 M6 (DRILL 6.8)\nG0 X0 Y0\n\
                   G43 H1 Z50. S3000 M3\nG1 Z-1. F100\nG0 Z50.\nM01 (CHECK DEPTH)\n/G0 X100.\n/2 G0 X110.\nT2 M6\nG0 X0\n\
                   G43 H2 Z50. S3000 M3\nG1 Z-1. F100\nG0 Z50.\nT3 M6\nG0 X0\nG43 H3 Z50. S3000 M3\nG1 Z-1. F100\nG0 Z50.\nM30\n%\n";
    let place = tempfile::tempdir().unwrap();
    std::fs::write(place.path().join("O1.nc"), program).unwrap();
    std::fs::write(
        place.path().join("machine.toml"),
        "[[tool]]\nnumber = 2\nkind = \"end-mill\"\ndiameter = 6.0\n",
    )
    .unwrap();
    let done = programs::run_line("gcode-sim sheet O1.nc -o sheet.html", place.path());
    assert!(place.path().join("sheet.html").exists(), "{}", String::from_utf8_lossy(&done.stderr));
    let html = std::fs::read_to_string(place.path().join("sheet.html")).unwrap();
    let kinds: Vec<String> =
        rows(&html, "Tools, in the order of use").iter().map(|row| row[1].clone()).collect();
    assert_eq!(kinds, ["“DRILL 6.8”", "end mill Φ6“.240 THREAD MILL”", ""]);
    assert_eq!(
        rows(&html, "Switches of the panel"),
        [
            ["block skip", "off: the blocks are executed", "O0001 line 11"],
            ["block skip 2", "off: the blocks are executed", "O0001 line 12"],
            ["optional stop", "on: M01 stops", "O0001 line 10"],
        ]
    );
}
