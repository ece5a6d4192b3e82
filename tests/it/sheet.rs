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
