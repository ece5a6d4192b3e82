//! Level of detail per hole: which holes have a dial with their deviation, its size and its magnification.
use nalgebra::Point3;

use super::ink::Px;
use super::measure::{Frame, LABEL_LIMIT, magnification};
use super::scene::{HoleStatus, Mark, Scene};
use gcode_part::PointTree;

/// Distance in text heights below which two symbols overlap; the symbol of an extra hole then moves aside.
pub(super) const MIN_SIGN_DISTANCE: f64 = 0.8;

/// Level of detail, tried in this order until every hole has its number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Detail {
    AllDeviations,
    BadDeviations,
    Signs,
    SignsWithoutAxes,
}

impl Detail {
    pub(super) const ALL: [Self; 4] =
        [Self::AllDeviations, Self::BadDeviations, Self::Signs, Self::SignsWithoutAxes];

    fn shows_deviation(self, mark: &Mark) -> bool {
        mark.deviation.is_some()
            && match self {
                Self::AllDeviations => true,
                Self::BadDeviations => !mark.status.is_good(),
                Self::Signs | Self::SignsWithoutAxes => false,
            }
    }
}

/// The dials of one sheet: which holes have one, and how large.
#[derive(Clone, Debug)]
pub(super) struct DeviationDials {
    /// Magnification, and radius of the tolerance zone's circle in pixels.
    pub(super) zone_circle: Option<(f64, f64)>,
    /// Whether a hole has a dial.
    has_dial: Vec<bool>,
    /// Distance of each hole to its nearest neighbour, pixels.
    gaps: Vec<f64>,
    /// Whether a hole may shrink to a dot.
    can_be_dot: Vec<bool>,
    pub(super) detail: Detail,
}

impl DeviationDials {
    /// Chooses the size from the spacing of three quarters of the holes; a hole closer to a neighbour has no
    /// dial.
    pub(super) fn choose(scene: &Scene, frame: &Frame, detail: Detail) -> Self {
        let gaps = gaps(scene, frame);
        let shows: Vec<bool> = scene.marks.iter().map(|mark| detail.shows_deviation(mark)).collect();
        let mut room: Vec<f64> = gaps.iter().zip(&shows).filter(|(_, w)| **w).map(|(gap, _)| *gap).collect();
        room.sort_by(f64::total_cmp);
        let quarter = room.get(room.len() / 4).copied().unwrap_or(0.0);
        let most = (0.42 * quarter).min(frame.largest_dial).max(0.8 * frame.text_size);
        let shown = scene.zone.filter(|zone| 0.0 < *zone).map(|zone| {
            let times = magnification(most / (zone / 2.0 * frame.scale.factor));
            (times, times * zone / 2.0 * frame.scale.factor)
        });
        let radius = shown.map_or(f64::INFINITY, |(_, radius)| radius);
        let has: Vec<bool> = shows.iter().zip(&gaps).map(|(w, gap)| *w && 2.0 * radius <= *gap).collect();
        let many = LABEL_LIMIT < scene.marks.len();
        // Among hundreds of bad holes none stands out, and their positions matter more.
        let dense = LABEL_LIMIT < scene.marks.iter().filter(|mark| !mark.status.is_good()).count();
        let dots = scene.marks.iter().map(|mark| many && (dense || mark.status.is_good())).collect();
        Self { zone_circle: shown, has_dial: has, gaps, can_be_dot: dots, detail }
    }

    /// Returns magnification and circle radius for a hole that has a dial.
    pub(super) fn dial(&self, index: usize) -> Option<(f64, f64)> {
        self.zone_circle.filter(|_| self.has_dial[index])
    }

    /// Returns the magnification if any deviation is drawn.
    pub(super) fn magnification(&self) -> Option<f64> {
        self.zone_circle.filter(|_| self.has_dial.contains(&true)).map(|(times, _)| times)
    }

    /// Returns the radius of a hole's symbol: as large as its neighbours allow, but legible. Among hundreds a
    /// good hole may be a mere dot, so that bad holes stand out.
    pub(super) fn badge(&self, index: usize, text: f64) -> f64 {
        let least = if self.can_be_dot[index] { 1.2 } else { 0.28 * text };
        (0.36 * self.gaps[index]).min(0.55 * text).max(least)
    }

    /// Returns true if the hole's symbol may shrink to a dot at its exact position.
    pub(super) fn is_dot(&self, index: usize) -> bool {
        self.can_be_dot[index]
    }

    /// Returns true if holes whose status satisfies `of` are drawn to scale, without a symbol.
    pub(super) fn has_plain(&self, scene: &Scene, of: impl Fn(HoleStatus) -> bool) -> bool {
        self.can_be_dot.iter().zip(&scene.marks).any(|(dot, mark)| *dot && of(mark.status))
    }

    /// Returns true if the symbol overlaps another: a label beside them could belong to either.
    pub(super) fn is_crowded(&self, index: usize, text: f64) -> bool {
        self.gaps[index] < 2.0 * self.badge(index, text)
    }

    /// Returns a note that counts the omitted deviations.
    pub(super) fn note(&self, scene: &Scene) -> Option<String> {
        let known = scene.marks.iter().filter(|m| m.deviation.is_some() && scene.zone.is_some()).count();
        match known - self.has_dial.iter().filter(|has| **has).count() {
            0 => None,
            left if left == known => Some("Deviations not drawn: no room.".to_owned()),
            left => Some(format!("Deviations of {left} of {known} holes not drawn: no room.")),
        }
    }
}

/// Returns the distance from each hole to its nearest neighbour, pixels. An extra hole at the position of
/// another does not count: its symbol moves aside.
fn gaps(scene: &Scene, frame: &Frame) -> Vec<f64> {
    let points: Vec<Px> = scene.marks.iter().map(|mark| frame.scale.px(mark.position)).collect();
    let flat = |point: &Px| Point3::new(point.x, point.y, 0.0);
    let tree = PointTree::new(points.iter().map(flat));
    let is_extra = |index: usize| scene.marks[index].status == HoleStatus::Extra;
    let gap = |(index, point): (usize, &Px)| {
        let counts = |other: usize, distance: f64| {
            other != index
                && (MIN_SIGN_DISTANCE * frame.text_size <= distance || !is_extra(index) && !is_extra(other))
        };
        tree.nearest_matching(&flat(point), &counts).map_or(f64::INFINITY, |(_, distance)| distance)
    };
    points.iter().enumerate().map(gap).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::font::Font;
    use crate::ink::Rect;
    use crate::measure::Scale;
    use crate::scene::ZoneDeviation;

    fn mark(at: [f64; 2], standing: HoleStatus) -> Mark {
        let deviation = Some(ZoneDeviation { entry: [0.01, 0.0], bottom: [0.01, 0.0] });
        Mark { radius: 3.0, deviation, ..Mark::new(at, standing) }
    }

    /// 1 px per mm, text of 10 px.
    fn frame() -> Frame {
        let scale = Scale::fitting(([0.0, 0.0], [100.0, 100.0]), Rect::new(0.0, 0.0, 100.0, 100.0));
        Frame { font: Font::embedded(), text_size: 10.0, scale, largest_dial: 25.0, axis_reach: 20.0 }
    }

    #[test]
    fn the_zone_is_drawn_at_a_round_magnification() {
        let marks = vec![mark([0.0, 0.0], HoleStatus::Good), mark([50.0, 0.0], HoleStatus::Good)];
        let scene = Scene { marks, zone: Some(0.1), ..Scene::default() };
        let dials = DeviationDials::choose(&scene, &frame(), Detail::AllDeviations);
        // 0.42 of 50 px is 21 px; the zone's radius is 0.05 px: at most 420 times.
        assert_eq!(dials.magnification().map(|m| m.round()), Some(400.0));
        assert_eq!(dials.note(&scene), None);
    }

    #[test]
    fn a_hole_close_to_another_has_no_dial_and_a_note_counts_it() {
        let mut marks: Vec<Mark> =
            (0..8).map(|i| mark([f64::from(i) * 50.0, 0.0], HoleStatus::Good)).collect();
        marks.push(mark([3.0, 0.0], HoleStatus::Good));
        let scene = Scene { marks, zone: Some(0.1), ..Scene::default() };
        let dials = DeviationDials::choose(&scene, &frame(), Detail::AllDeviations);
        assert_eq!((dials.dial(0), dials.dial(8)), (None, None));
        assert!(dials.dial(4).is_some());
        assert!(dials.is_crowded(0, 10.0) && !dials.is_crowded(4, 10.0));
        assert_eq!(dials.note(&scene).unwrap(), "Deviations of 2 of 9 holes not drawn: no room.");
    }
}
