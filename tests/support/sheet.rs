//! Cases of kind `sheet`: the words and figures of the set-up sheet of `job.toml`, without its markup and pictures.
use gcode_gen::check::check;
use gcode_gen::families;
use gcode_gen::sheet::Sheet;
use gcode_part::job::{Job, Rates};

use crate::Case;

/// Compares the text of the sheet with `sheet.snap`; `rates.toml` is what `--rates` names.
pub(crate) fn run(case: &Case) {
    let rates = case.optional("rates.toml").map(|text| Rates::parse(&text).unwrap());
    case.snapshot("sheet", &text(&html(&case.text("job.toml"), rates.as_ref())));
}

/// The page of a job, without pictures.
pub fn html(job: &str, rates: Option<&Rates>) -> String {
    let job = Job::parse(job).unwrap_or_else(|error| panic!("{error}"));
    let package = families::emit(&job);
    let checked = check(&job, &package).unwrap_or_else(|error| panic!("{error}"));
    assert!(checked.refusals.is_empty(), "{}", checked.refusals.concat());
    Sheet::new(&job, &package, &checked, rates, Vec::new()).unwrap().html()
}

/// The visible text: a line for each row or paragraph, bars between cells. Hashes are shown by their length alone, for they
/// change with every byte of a macro.
fn text(html: &str) -> String {
    let body = html.split_once("<body>").unwrap().1;
    let mut text = String::new();
    for piece in body.split('<').skip(1) {
        let (tag, words) = piece.split_once('>').unwrap();
        match tag.split(' ').next().unwrap() {
            "tr" | "p" | "li" | "h1" | "h2" | "h3" | "/tr" | "/p" | "/li" | "/div" | "figcaption"
            | "text" => text.push('\n'),
            "/td" | "/th" => text.push_str(" | "),
            _ => {}
        }
        text.push_str(
            &words.replace("&lt;", "<").replace("&gt;", ">").replace("&quot;", "\"").replace("&amp;", "&"),
        );
    }
    let lines = text.lines().map(|line| line.trim().trim_end_matches(" |").trim_end());
    let words = |line: &str| {
        let word = |word: &str| match word.len() == 64 && word.bytes().all(|b| b.is_ascii_hexdigit()) {
            true => "(64 digits)".to_owned(),
            false => word.to_owned(),
        };
        line.split(' ').map(word).collect::<Vec<_>>().join(" ")
    };
    lines.filter(|line| !line.is_empty()).map(words).collect::<Vec<_>>().join("\n") + "\n"
}
