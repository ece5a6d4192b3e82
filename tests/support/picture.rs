//! Draws the view that a `case.toml` describes and compares it with `expected.png`; each channel may differ by one step.
//!
//! With a key `render`, the picture is what `gcode-sim render` draws with these arguments in the folder.
//! With a `job.toml` the view is of its burr, ground by `case.nc` or by its own program; with an `old.nc`, of the holes of
//! `new.nc` over those of `old.nc`. `says.snap` has the picture's texts. With an `other.toml` the picture is the comparison
//! of both. A picture that differs is left in `target/pictures/`, with its differences.
use gcode_draw::{
    Cylinder, Difference, DrawnHole, HoleStatus, Pen, PicturePurpose, Shape, Sheet, Side, Stroke, TopView,
    compare, development, lay_out, paint, png, top_view,
};
use gcode_inspect::machine::Machine;
use gcode_inspect::tool_path::PathRecorder;
use gcode_part::Hole;
use gcode_review::RevisionDiff;
use gcode_sim::report::changed_view;
use serde::Deserialize;
use tiny_skia::{IntRect, Pixmap};

use crate::changes::revision_with;
use crate::programs::run_line;
use crate::{Case, burr_picture, root};

/// Largest size of an expected picture.
const MOST_BYTES: usize = 20 * 1024;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Picture {
    size: String,
    /// Left, top, width, height of the part in `expected.png`.
    crop: [u32; 4],
    name: String,
    outline: Option<f64>,
    /// Dimensions of a part that is a cylinder, which is seen along the spindle or unrolled.
    cylinder: Option<CylinderCase>,
    #[serde(default)]
    unrolled: bool,
    tolerance: Option<f64>,
    #[serde(default)]
    hole: Vec<HoleCase>,
    #[serde(default)]
    path: Vec<PathCase>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BurrPicture {
    size: String,
    crop: [u32; 4],
    /// `side`, `tip` or `helix`.
    view: String,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ChangedPicture {
    size: String,
    crop: [u32; 4],
    /// Tolerance for equality, mm.
    tolerance: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RenderedPicture {
    size: String,
    crop: [u32; 4],
    /// Arguments of `gcode-sim render` besides size and output.
    render: String,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct HoleCase {
    id: String,
    at: [f64; 3],
    axis: [f64; 3],
    /// Actual − nominal of the entry; `None` for a missing hole and without a reference.
    off: Option<[f64; 3]>,
    #[serde(default = "six")]
    diameter: f64,
    standing: String,
    phi: Option<f64>,
    turn: Option<f64>,
    remark: Option<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PathCase {
    points: Vec<[f64; 3]>,
    rapid: bool,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CylinderCase {
    radius: f64,
    length: f64,
    rows: u32,
}

fn six() -> f64 {
    6.0
}

pub(crate) fn run(case: &Case) {
    let text = case.text("case.toml");
    if let Ok(form) = toml::from_str::<RenderedPicture>(&text) {
        return assert_picture(case, &cropped(&rendered(case, &form), form.crop));
    }
    let mut title = None;
    let (picture, size, crop) = if let Some(job) = case.optional("job.toml") {
        let form: BurrPicture = toml::from_str(&text).unwrap();
        (burr_picture::picture(&job, case.optional("case.nc"), &form.view), form.size, form.crop)
    } else if let Some(old) = case.optional("old.nc") {
        let form: ChangedPicture = toml::from_str(&text).unwrap();
        let view = changed(&old, &case.text("new.nc"), form.tolerance);
        let headline = view.headline().map(|(_, words)| words).unwrap_or_default();
        title = Some(format!("title: seen from {}: {headline}\n", view.side.name()));
        (top_view(&view), form.size, form.crop)
    } else {
        described(&text)
    };
    let lay_out = |picture, size: String| lay_out(&picture, size.parse().unwrap()).unwrap();
    let sheet = lay_out(picture, size);
    let bytes = png(&paint(&sheet)).unwrap();
    let Some(other) = case.optional("other.toml") else {
        case.snapshot("says", &(title.unwrap_or_default() + &words(&sheet)));
        return assert_picture(case, &cropped(&bytes, crop));
    };
    let (other, size, _) = described(&other);
    let difference = compare(&bytes, &png(&paint(&lay_out(other, size))).unwrap(), 1).unwrap();
    case.snapshot("says", &describe(&difference));
    assert_picture(case, &cropped(&difference.png().unwrap(), crop));
}

/// Returns the picture of a program; `says.snap` has what the command prints.
fn rendered(case: &Case, form: &RenderedPicture) -> Vec<u8> {
    let place = tempfile::tempdir().unwrap();
    let picture = place.path().join("case.png");
    let RenderedPicture { size, render, .. } = form;
    let done =
        run_line(&format!("gcode-sim render {render} --size {size} -o {}", picture.display()), &case.dir);
    let printed =
        |bytes: &[u8]| String::from_utf8_lossy(bytes).replace(&picture.display().to_string(), "case.png");
    let says =
        format!("{}{}exit {}", printed(&done.stdout), printed(&done.stderr), done.status.code().unwrap());
    case.snapshot("says", &says);
    std::fs::read(&picture).unwrap()
}

/// Returns the holes of a new revision over those of the old one, on the default machine.
fn changed(old: &str, new: &str, tolerance: f64) -> TopView {
    let machine = Machine::default();
    let [(old, old_path), (new, new_path)] = [old, new].map(|text| {
        let mut path = PathRecorder::new(&machine);
        (revision_with(&machine, text, &mut path), path.finish())
    });
    let compared = RevisionDiff::new(&old.record, &new.record, tolerance);
    changed_view::of_changes(
        "O0100.nc",
        (&old, &new),
        &machine,
        (&compared, tolerance),
        (None, &[old_path, new_path]),
    )
}

/// Returns the picture that a `case.toml` describes, its size and its crop.
fn described(text: &str) -> (gcode_draw::Picture, String, [u32; 4]) {
    let form: Picture = toml::from_str(text).unwrap();
    let cylinder = form.cylinder.map(|CylinderCase { radius, length, rows }| Cylinder {
        outer: radius,
        radius,
        length,
        rows,
    });
    let view = TopView {
        name: form.name,
        outline: form.outline.map(|radius| [radius; 2]),
        side: if cylinder.is_some() { Side::Z } else { Side::Y },
        cylinder,
        tolerance: form.tolerance,
        rotary: "B".to_owned(),
        purpose: PicturePurpose::Verdict,
        verdict: verdict(&form.hole),
        holes: form.hole.iter().map(drawn_hole).collect(),
        path: form.path.iter().map(stroke).collect(),
        ..TopView::default()
    };
    let picture = if form.unrolled { development(&view).unwrap() } else { top_view(&view) };
    (picture, form.size, form.crop)
}

/// The line of a verdict on these holes; none if no hole is judged.
fn verdict(holes: &[HoleCase]) -> Option<(HoleStatus, String)> {
    let count = |standing: &str| holes.iter().filter(|hole| hole.standing == standing).count();
    let [good, bad, missing, extra] = ["good", "bad", "missing", "extra"].map(count);
    let all = good + bad + missing;
    if all + extra == 0 {
        return None;
    }
    if good == all && extra == 0 {
        return Some((HoleStatus::Good, format!("PASS: {good} of {all} holes in tolerance")));
    }
    let others = [(bad, "out"), (missing, "missing"), (extra, "extra")];
    let others = others.iter().filter(|(number, _)| *number != 0);
    let others: String = others.map(|(number, word)| format!(", {number} {word}")).collect();
    Some((HoleStatus::Bad, format!("FAIL: {good} of {all} in tolerance{others}")))
}

fn stroke(case: &PathCase) -> Stroke<3> {
    Stroke::new(if case.rapid { Pen::Rapid } else { Pen::Feed }, Shape::Line(case.points.clone()))
}

fn drawn_hole(case: &HoleCase) -> DrawnHole {
    let standing = match case.standing.as_str() {
        "good" => HoleStatus::Good,
        "bad" => HoleStatus::Bad,
        "missing" => HoleStatus::Missing,
        "extra" => HoleStatus::Extra,
        "unjudged" => HoleStatus::Unjudged,
        other => panic!("a hole is good, bad, missing, extra or unjudged, not {other}"),
    };
    let length = case.axis.iter().map(|v| v * v).sum::<f64>().sqrt();
    let at = |off: [f64; 3]| Hole {
        id: None,
        entry: [case.at[0] + off[0], case.at[1] + off[1], case.at[2] + off[2]],
        axis: case.axis.map(|v| v / length),
        depth: 15.0,
        diameter: Some(case.diameter),
        ..Hole::default()
    };
    let is_nominal = matches!(standing, HoleStatus::Good | HoleStatus::Bad | HoleStatus::Missing);
    DrawnHole {
        id: case.id.clone(),
        nominal: is_nominal.then(|| at([0.0; 3])),
        actual: (standing != HoleStatus::Missing).then(|| at(case.off.unwrap_or_default())),
        status: standing,
        position_deviation: case.phi,
        rotary_angle: case.turn,
        further_angles: Vec::new(),
        remarks: case.remark.iter().cloned().collect(),
    }
}

/// Returns the texts of the picture.
fn words(sheet: &Sheet) -> String {
    let mut lines: Vec<String> =
        sheet.labels.iter().map(|(_, lines)| format!("label: {}", lines.join(" | "))).collect();
    lines.extend(sheet.magnification.map(|times| format!("deviations: ×{times:.0}")));
    lines.extend(sheet.notes.iter().map(|note| format!("note: {note}")));
    lines.join("\n")
}

fn describe(difference: &Difference) -> String {
    match difference.bounds {
        Some([left, top, right, bottom]) => format!(
            "{} pixels differ, by {} at most, from {left},{top} to {right},{bottom}",
            difference.pixels, difference.largest
        ),
        None => "no pixel differs".to_owned(),
    }
}

fn cropped(bytes: &[u8], [left, top, width, height]: [u32; 4]) -> Vec<u8> {
    let whole = Pixmap::decode_png(bytes).unwrap();
    assert!(left + width <= whole.width() && top + height <= whole.height(), "the crop leaves the picture");
    let part = IntRect::from_xywh(left as i32, top as i32, width, height);
    png(&part.and_then(|part| whole.clone_rect(part)).unwrap()).unwrap()
}

/// Compares with the expected picture; `INSTA_UPDATE=always` accepts a new one, as for snapshots.
fn assert_picture(case: &Case, actual: &[u8]) {
    assert!(actual.len() <= MOST_BYTES, "{} bytes are more than {MOST_BYTES}: crop it", actual.len());
    let expected = case.dir.join("expected.png");
    let accepts = std::env::var("INSTA_UPDATE").is_ok_and(|v| v == "always");
    let difference = expected.exists().then(|| compare(&case.bytes("expected.png"), actual, 1).unwrap());
    if difference.as_ref().is_some_and(Difference::is_none) {
        return;
    }
    if accepts {
        return std::fs::write(expected, actual).unwrap();
    }
    let folder = root().join("../../target/pictures").join(case.name());
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("actual.png"), actual).unwrap();
    let Some(difference) = difference else {
        panic!("there is no expected.png; the picture is in {}", folder.display())
    };
    std::fs::write(folder.join("difference.png"), difference.png().unwrap()).unwrap();
    panic!("{}; see {}", describe(&difference), folder.display());
}
