//! The top view: the part seen along its axis of revolution y, or a cylinder about x seen along the spindle.
use nalgebra::Vector3;

use super::purpose::{PicturePurpose, change_headline};
use crate::hole_table::{Column, HoleTable};
use crate::measure::plain;
use crate::picture::{LegendItem, Sample, Title};
use crate::scene::{HoleStatus, Mark, Pen, Shape, Stroke, ZoneDeviation};
use crate::side::{Side, deviation};
use gcode_part::{FeatureKind, Hole};

/// Contents of a top view; everything but the holes may be unknown.
#[derive(Clone, Debug, Default)]
pub struct TopView {
    /// Name of the part or the program.
    pub name: String,
    /// Viewing direction.
    pub side: Side,
    /// Equatorial and polar radius of a part that is an ellipsoid of revolution about y, mm.
    pub outline: Option<[f64; 2]>,
    /// Dimensions of a part that is a cylinder about x.
    pub cylinder: Option<Cylinder>,
    /// Diameter of the position tolerance zone, mm.
    pub tolerance: Option<f64>,
    /// Letter of the rotary axis of `DrawnHole::turn`.
    pub rotary: String,
    /// Whether the rotary axis increases as the presented azimuth (from z towards y) decreases.
    pub is_rotary_reversed: bool,
    /// The holes, nominal and actual.
    pub holes: Vec<DrawnHole>,
    /// Purpose of the comparison, which selects the wording.
    pub purpose: PicturePurpose,
    /// Verdict on the holes in one line; a comparison of revisions counts its differences instead.
    pub verdict: Option<(HoleStatus, String)>,
    /// Number of differences between two revisions that no hole shows.
    pub other_differences: usize,
    /// Sentence on a different end of the two revisions.
    pub ending: Option<String>,
    /// Tool path in the part's frame.
    pub path: Vec<Stroke<3>>,
    /// Further lines of the title block.
    pub lines: Vec<String>,
    /// Names and positions of the work zeros, drawn where the part has no outline of its own.
    pub zeros: Vec<(String, [f64; 3])>,
    /// Radius of a shaft of unknown length about x, mm.
    pub shaft: Option<f64>,
}

/// A cylinder about x, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder {
    /// Radius of its surface.
    pub outer: f64,
    /// Radius on which distances are measured and at which it is unrolled.
    pub radius: f64,
    /// Length of the pattern: holes lie at 0 ≤ x ≤ length.
    pub length: f64,
    /// Number of rows round the circumference.
    pub rows: u32,
}

/// One hole: nominal, actual and verdict.
#[derive(Clone, Debug, Default)]
pub struct DrawnHole {
    /// Number or name in the label.
    pub id: String,
    /// Nominal hole; `None` for an extra one.
    pub nominal: Option<Hole>,
    /// Actual hole; `None` for a missing one.
    pub actual: Option<Hole>,
    /// Result of the comparison.
    pub status: HoleStatus,
    /// Position deviation by ISO 1101 (a diameter), mm.
    pub position_deviation: Option<f64>,
    /// Angle of the rotary axis during drilling, degrees.
    pub rotary_angle: Option<f64>,
    /// Letters and angles of further rotary axes, degrees.
    pub further_angles: Vec<(char, f64)>,
    /// Faults other than position, a few words each.
    pub remarks: Vec<String>,
}

impl DrawnHole {
    /// Returns the nominal hole; the actual one if there is no nominal.
    pub(super) fn shown(&self) -> Option<&Hole> {
        self.nominal.as_ref().or(self.actual.as_ref())
    }

    /// Returns actual − nominal.
    pub(super) fn deviation(&self) -> Option<ZoneDeviation<3>> {
        deviation(self.nominal.as_ref()?, self.actual.as_ref()?)
    }
}

/// Largest number of numbered holes; beyond it good holes have neither number nor dial, which would hide each
/// other.
pub(super) const MAX_NUMBERED: usize = 60;

/// Difference of two diameters that are one, mm.
const SAME_DIAMETER: f64 = 1e-3;

/// Cosine of the largest angle between a hole and the line of sight at which its features are circles: 2.6°.
const ALONG: f64 = 0.999;

/// Cosine of the angle between a hole and the line of sight beyond which the hole is on the far side: 30° off it.
const FAR_SIDE: f64 = 0.866;

/// Removes the numbers and dials that would hide the holes of a dense pattern.
pub(super) fn number_few(marks: &mut [Mark]) {
    if MAX_NUMBERED < marks.len() {
        for mark in marks.iter_mut().filter(|mark| mark.status.is_good()) {
            mark.label.clear();
            mark.deviation = None;
        }
    }
    if MAX_NUMBERED < marks.iter().filter(|mark| !mark.label.is_empty()).count() {
        marks.iter_mut().for_each(|mark| mark.label.clear());
    }
}

/// Returns the mark of a hole on the part.
pub(super) fn hole_mark(hole: &DrawnHole, view: &TopView) -> Option<Mark<3>> {
    let shown = hole.shown()?;
    let actual = hole.actual.as_ref().filter(|_| hole.nominal.is_some());
    let features = shown.features.iter().map(|feature| feature.diameter);
    // A thread has a broken circle of its own, which a solid one would cover.
    let is_thread = |diameter: &f64| {
        let mut threads = shown.features.iter().filter(|feature| feature.kind == FeatureKind::Tap);
        threads.any(|thread| (thread.diameter - diameter).abs() < SAME_DIAMETER)
    };
    let diameter = shown.diameter.filter(|own| !is_thread(own)).or_else(|| widest(shown));
    Some(Mark {
        rim: features.fold(0.0, f64::max) / 2.0,
        radius: diameter.unwrap_or(0.0) / 2.0,
        depth: shown.depth,
        label: view.label(hole),
        direction: Some(shown.axis),
        deviation: hole.deviation(),
        actual: actual.map(|actual| actual.entry),
        ..Mark::new(shown.entry, hole.status)
    })
}

/// Returns the diameter of the widest feature of a hole, threads left out.
fn widest(hole: &Hole) -> Option<f64> {
    let features = hole.features.iter().filter(|feature| feature.kind != FeatureKind::Tap);
    features.map(|feature| feature.diameter).reduce(f64::max)
}

impl TopView {
    /// Draws the diameters of the features of holes along the line of sight, those of threads broken.
    pub(super) fn feature_circles(&self, side: Side) -> impl Iterator<Item = Stroke> {
        let along = move |hole: &&Hole| ALONG < Vector3::from(hole.axis).dot(&side.towards());
        self.holes.iter().filter_map(DrawnHole::shown).filter(along).flat_map(move |hole| {
            hole.features.iter().map(move |feature| {
                let is_thread = feature.kind == FeatureKind::Tap;
                let pen = if is_thread { Pen::Thread } else { Pen::Edge };
                let circle =
                    Shape::Circle { centre: side.project(hole.entry), radius: feature.diameter / 2.0 };
                Stroke::new(pen, circle)
            })
        })
    }

    /// Builds the title block; `more` is its last line.
    pub(super) fn title(&self, view: String, position: Option<f64>, more: Option<String>) -> Title {
        Title {
            name: self.name.clone(),
            view,
            position,
            verdict: self.headline(),
            lines: self.worst().into_iter().chain(self.lines.iter().cloned()).chain(more).collect(),
            caution: "Predicted by simulation, not measured".to_owned(),
        }
    }

    /// Returns the label of a hole: number, remarks, rotary angle and deviation.
    pub(super) fn label(&self, hole: &DrawnHole) -> Vec<String> {
        let angle = |name: &str, turn: f64| format!("{name} {}°", signed(turn, 3));
        let first = hole.rotary_angle.map(|turn| angle(&self.rotary, turn));
        let further = hole.further_angles.iter().map(|(letter, turn)| angle(&letter.to_string(), *turn));
        let angles: Vec<String> = first.into_iter().chain(further).collect();
        let turn = (!angles.is_empty()).then(|| angles.join(" "));
        let phi = hole.position_deviation.filter(|phi| self.purpose.shows_deviation(*phi, 3));
        let phi = phi.map(|phi| format!("Φ{phi:.3}"));
        let words = match hole.status {
            HoleStatus::Missing | HoleStatus::Extra => vec![self.purpose.status_word(hole.status).to_owned()],
            HoleStatus::Good | HoleStatus::Bad | HoleStatus::Unjudged => hole.remarks.clone(),
        };
        let numbers = if hole.status == HoleStatus::Good { [turn, phi] } else { [phi, turn] };
        let far = |hole: &Hole| Vector3::from(hole.axis).dot(&self.side.towards()) < -FAR_SIDE;
        // An unrolled cylinder shows all of them, a cylinder from above none.
        let is_far = self.cylinder.is_none() && hole.shown().is_some_and(far);
        let far = is_far.then(|| "far side".to_owned());
        let lines = [hole.id.clone()].into_iter().chain(words).chain(far);
        let lines = lines.chain(numbers.into_iter().flatten());
        lines.filter(|line| !line.is_empty()).collect()
    }

    fn count(&self, status: HoleStatus) -> usize {
        self.holes.iter().filter(|hole| hole.status == status).count()
    }

    /// Returns status and words of the line below the name.
    pub fn headline(&self) -> Option<(HoleStatus, String)> {
        use HoleStatus::{Bad, Extra, Good, Missing};
        if self.purpose == PicturePurpose::Verdict {
            return self.verdict.clone();
        }
        let counts = [Good, Bad, Missing, Extra].map(|status| self.count(status));
        let (status, words) = change_headline(counts, self.other_differences)?;
        Some((status, self.ending.iter().cloned().chain([words]).collect::<Vec<_>>().join("; ")))
    }

    fn worst(&self) -> Option<String> {
        let known = self.holes.iter().filter_map(|hole| Some((hole.position_deviation?, &hole.id)));
        let (phi, id) = known.fold(None, |worst: Option<(f64, &String)>, next| match worst {
            Some(worst) if next.0 <= worst.0 => Some(worst),
            _ => Some(next),
        })?;
        let is_shown = self.purpose.shows_deviation(phi, 4);
        is_shown.then(|| format!("{}: Φ{phi:.4} (hole\u{a0}{id})", self.purpose.worst_label()))
    }

    /// Returns the legend lines of the symbols and of the dials that are drawn.
    pub(super) fn status_legend(&self, marks: &[Mark]) -> Vec<LegendItem> {
        use HoleStatus::{Bad, Extra, Good, Missing, Unjudged};
        let drawn =
            [Good, Bad, Missing, Extra, Unjudged].into_iter().filter(|status| 0 < self.count(*status));
        let signs = drawn.map(|status| LegendItem::new(Sample::Status(status), self.purpose.legend(status)));
        let zone = self.tolerance.filter(|_| marks.iter().any(|mark| mark.deviation.is_some()));
        let zone =
            zone.map(|zone| format!("{} Φ{}, axial view,", self.purpose.deviation_label(), plain(zone)));
        let zone = zone.map(|text| {
            let hole = LegendItem::new(Sample::HoleInZone, "the hole, not enlarged");
            [LegendItem::new(Sample::Deviation, text), hole]
        });
        signs.chain(zone.into_iter().flatten()).collect()
    }

    /// Returns the table of the holes: place, size, and with a verdict the deviation. A comparison of revisions has none.
    pub(super) fn table(&self) -> HoleTable {
        let shown = || self.holes.iter().filter_map(|hole| Some((hole, hole.shown()?)));
        if self.purpose == PicturePurpose::Change || shown().next().is_none() {
            return HoleTable::default();
        }
        let diameters = |hole: &Hole| {
            let mut all: Vec<f64> = hole.features.iter().map(|feature| feature.diameter).collect();
            all.extend(hole.diameter.filter(|_| hole.features.is_empty()));
            all.sort_by(f64::total_cmp);
            all.dedup();
            all.into_iter().map(|diameter| signed(diameter, 3)).collect::<Vec<_>>().join("/")
        };
        // The other columns have the nominal hole.
        let fault = |drawn: &DrawnHole| match drawn.status {
            HoleStatus::Bad => drawn.remarks.join(", "),
            HoleStatus::Missing | HoleStatus::Extra => self.purpose.status_word(drawn.status).to_owned(),
            HoleStatus::Good | HoleStatus::Unjudged => String::new(),
        };
        let has_diameter = shown().any(|(_, hole)| !diameters(hole).is_empty());
        let has_position = shown().any(|(hole, _)| hole.position_deviation.is_some());
        // Without a nominal hole the depth counts from where a feed begins to the deepest point of any tool.
        let is_fed = shown().all(|(hole, _)| hole.nominal.is_none());
        let columns = [
            (true, "hole", 9),
            (true, "x", 8),
            (true, "y", 7),
            (true, "z", 6),
            (has_diameter, "Φ", 3),
            (true, if is_fed { "deepest" } else { "depth" }, 2),
            (has_position, "position", 5),
            (shown().any(|(hole, _)| !fault(hole).is_empty()), "fault", 6),
        ];
        let row = |(drawn, hole): (&DrawnHole, &Hole)| {
            let [x, y, z] = hole.entry.map(|mm| signed(mm, 3));
            let depth = if hole.through { "through".to_owned() } else { signed(hole.depth, 3) };
            let position = drawn.position_deviation.map_or_else(String::new, |phi| format!("Φ{phi:.3}"));
            let cells = [drawn.id.clone(), x, y, z, diameters(hole), depth, position, fault(drawn)];
            let cells = cells.into_iter().zip(&columns).filter(|(_, (is_shown, ..))| *is_shown);
            (drawn.status, cells.map(|(cell, _)| cell).collect())
        };
        let rows = shown().map(row).collect();
        let columns = columns.iter().filter(|(is_shown, ..)| *is_shown);
        HoleTable {
            columns: columns.map(|(_, head, importance)| Column { head, importance: *importance }).collect(),
            rows,
        }
    }
}

/// Formats a number without trailing zeros and with a true minus sign.
pub(super) fn signed(number: f64, decimals: usize) -> String {
    let text = format!("{number:.decimals$}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.replace('-', "−") }
}
