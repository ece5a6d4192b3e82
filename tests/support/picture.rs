//! Draws the view that a `case.toml` describes, or that of the burr in a `job.toml` beside it as a `case.nc` or its own program grinds it, and holds it against
//! `expected.png`, one step per channel allowed. With an `old.nc` it is the holes of `new.nc` over those of `old.nc`.
//!
//! `says.snap` beside it has the picture's words. With an `other.toml` the picture is the comparison of both. What
//! was drawn instead, and where it differs, is left in `target/pictures/`.
use gcode_draw::{
    Cylinder, Difference, DrawnHole, HoleStatus, Pen, PicturePurpose, Shape, Sheet, Side, Size, Stroke,
    TopView, compare, development, lay_out, paint, png, top_view,
};
use gcode_inspect::machine::Machine;
use gcode_part::Hole;
use gcode_review::RevisionDiff;
use gcode_sim::report::changed_view;
use serde::Deserialize;
use tiny_skia::{IntRect, Pixmap};

use crate::changes::revision;
use crate::{Case, burr_picture, root};

/// A picture that people look at in a review is small.
const MOST_BYTES: usize = 20 * 1024;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Picture {
    size: String,
    /// Left, top, width, height of what `expected.png` shows of it.
    crop: [u32; 4],
    name: String,
    outline: Option<f64>,
    /// Of a part that is a cylinder, seen along the spindle, or unrolled.
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
    /// What counts as the same, mm.
    tolerance: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct HoleCase {
    id: String,
    at: [f64; 3],
    axis: [f64; 3],
    /// Actual − nominal of the entry; a missing hole has none, and neither has one without a reference.
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
    if let Some(job) = case.optional("job.toml") {
        let picture: BurrPicture = toml::from_str(&case.text("case.toml")).unwrap();
        let scene = burr_picture::scene(&job, case.optional("case.nc"), &picture.view);
        let sheet = lay_out(&scene, picture.size.parse().unwrap()).unwrap();
        case.snapshot("says", &words(&sheet));
        return assert_picture(case, &cropped(&png(&paint(&sheet)).unwrap(), picture.crop));
    }
    if let Some(old) = case.optional("old.nc") {
        let picture: ChangedPicture = toml::from_str(&case.text("case.toml")).unwrap();
        let view = changed(&old, &case.text("new.nc"), picture.tolerance);
        let sheet = lay_out(&top_view(&view), picture.size.parse().unwrap()).unwrap();
        case.snapshot("says", &words(&sheet));
        return assert_picture(case, &cropped(&png(&paint(&sheet)).unwrap(), picture.crop));
    }
    let (picture, sheet) = draw(&case.text("case.toml"));
    let bytes = png(&paint(&sheet)).unwrap();
    let Some(other) = case.optional("other.toml") else {
        case.snapshot("says", &words(&sheet));
        return assert_picture(case, &cropped(&bytes, picture.crop));
    };
    let (_, other) = draw(&other);
    let difference = compare(&bytes, &png(&paint(&other)).unwrap(), 1).unwrap();
    case.snapshot("says", &describe(&difference));
    assert_picture(case, &cropped(&difference.png().unwrap(), picture.crop));
}

/// The holes of a new revision over those of the old one, on the machine that is taken where none is told.
fn changed(old: &str, new: &str, tolerance: f64) -> TopView {
    let machine = Machine::default();
    let (old, new) = (revision(old), revision(new));
    let compared = RevisionDiff::new(&old.record, &new.record, tolerance);
    let differences = (&compared, tolerance);
    changed_view::of_changes("O0100.nc", (&old, &new), &machine, differences, None)
}

fn draw(text: &str) -> (Picture, Sheet) {
    let picture: Picture = toml::from_str(text).unwrap();
    let size: Size = picture.size.parse().unwrap();
    let view = TopView {
        name: picture.name.clone(),
        outline: picture.outline,
        side: if picture.cylinder.is_some() { Side::Z } else { Side::Y },
        cylinder: picture.cylinder.as_ref().map(|cylinder| Cylinder {
            outer: cylinder.radius,
            radius: cylinder.radius,
            length: cylinder.length,
            rows: cylinder.rows,
        }),
        tolerance: picture.tolerance,
        rotary: "B".to_owned(),
        purpose: PicturePurpose::Verdict,
        holes: picture.hole.iter().map(drawn_hole).collect(),
        path: picture.path.iter().map(stroke).collect(),
        ..TopView::default()
    };
    let scene = if picture.unrolled { development(&view).unwrap() } else { top_view(&view) };
    let sheet = lay_out(&scene, size).unwrap();
    (picture, sheet)
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
        from: None,
    };
    let wanted = matches!(standing, HoleStatus::Good | HoleStatus::Bad | HoleStatus::Missing);
    DrawnHole {
        id: case.id.clone(),
        nominal: wanted.then(|| at([0.0; 3])),
        actual: (standing != HoleStatus::Missing).then(|| at(case.off.unwrap_or_default())),
        status: standing,
        position_deviation: case.phi,
        rotary_angle: case.turn,
        remarks: case.remark.iter().cloned().collect(),
    }
}

/// What the picture says in words.
fn words(sheet: &Sheet) -> String {
    let mut lines: Vec<String> =
        sheet.labels.iter().map(|(_, lines)| format!("label: {}", lines.join(" | "))).collect();
    lines.extend(sheet.magnification.map(|times| format!("misfits: ×{times:.0}")));
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

/// `INSTA_UPDATE=always` accepts what is new, as for snapshots.
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
    let left = root().join("../../target/pictures").join(case.name());
    std::fs::create_dir_all(&left).unwrap();
    std::fs::write(left.join("actual.png"), actual).unwrap();
    let Some(difference) = difference else {
        panic!("there is no expected.png; what was drawn is in {}", left.display())
    };
    std::fs::write(left.join("difference.png"), difference.png().unwrap()).unwrap();
    panic!("{}; see {}", describe(&difference), left.display());
}
