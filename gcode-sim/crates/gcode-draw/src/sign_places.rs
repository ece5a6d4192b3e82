//! Positions of the symbols of places on a path: beside the symbol of a hole, of a work zero or of another place, so that both are seen.
use super::ink::{DrawCommand, Px, Rect};
use super::labels::LabelArea;
use super::lines::{SIGN, ZERO};
use super::marks::DrawnMark;
use super::measure::Frame;
use super::obstacle::Obstacle;
use super::scene::{Scene, Shape, Sign, Stroke};
use super::symbol;
use gcode_lang::units::Deg;

/// Directions in which a symbol stands beside another, counter-clockwise from the right; the verdict of a hole is at its upper right.
const DIRECTIONS: [f64; 8] = [225.0, 315.0, 135.0, 45.0, 180.0, 270.0, 0.0, 90.0];

/// The symbols of the places of a scene, with their positions on the sheet.
pub(super) struct SignPlaces<'s> {
    places: Vec<(&'s Stroke, Sign, Px)>,
    /// Radius of a symbol, pixels.
    radius: f64,
}

impl<'s> SignPlaces<'s> {
    /// Places the symbols in the order of the strokes. One without room beside what it would cover stays in its place.
    pub(super) fn of(scene: &'s Scene, drawn: &[DrawnMark], frame: &Frame, drawing: Rect) -> Self {
        let radius = SIGN * frame.text_size;
        let zeros = scene.strokes.iter().filter_map(|stroke| match stroke.shape {
            Shape::Zero(at) => Some((frame.scale.px(at), ZERO * frame.text_size)),
            _ => None,
        });
        let marks = drawn.iter().map(|mark| (mark.centre, mark.label_clearance));
        let mut taken: Vec<(Px, f64)> = marks.chain(zeros).collect();
        let mut places = Vec::new();
        for stroke in &scene.strokes {
            let Shape::Sign { at, sign } = stroke.shape else { continue };
            let exact = frame.scale.px(at);
            let is_free = |at: &Px| {
                drawing.contains(&Rect::around(*at, (2.0 * radius, 2.0 * radius)))
                    && taken.iter().all(|(other, reach)| 0.95 * (reach + radius) < at.distance(*other))
            };
            let covered = taken.iter().find(|(other, reach)| exact.distance(*other) < reach + 0.5 * radius);
            let beside = covered.and_then(|(other, reach)| {
                let way = 1.05 * (reach + radius);
                DIRECTIONS
                    .map(|angle| other.toward(symbol::direction(Deg(angle)), way))
                    .into_iter()
                    .find(is_free)
            });
            let place = beside.unwrap_or(exact);
            taken.push((place, radius));
            places.push((stroke, sign, place));
        }
        Self { places, radius }
    }

    /// Returns the position of the symbol of a stroke; `None` of another stroke.
    pub(super) fn of_stroke(&self, stroke: &Stroke) -> Option<Px> {
        self.places.iter().find(|(one, ..)| std::ptr::eq(*one, stroke)).map(|(.., at)| *at)
    }

    /// Adds the symbols to the label area.
    pub(super) fn block(&self, field: &mut LabelArea) {
        for (.., centre) in &self.places {
            field.block(Obstacle::Disc { centre: *centre, radius: self.radius });
        }
    }

    /// Draws the symbols.
    pub(super) fn commands(&self) -> impl Iterator<Item = DrawCommand> + '_ {
        self.places.iter().flat_map(|(_, sign, at)| symbol::sign(*sign, *at, self.radius))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ink::px;
    use crate::layout::lay_out;
    use crate::picture::Picture;
    use crate::scene::{HoleStatus, Mark, Pen};
    use crate::size::Size;

    /// A plate of 100 × 60 with a hole in its middle, a work zero in a corner, and places on both.
    #[test]
    fn a_place_is_seen_beside_the_hole_and_the_zero_in_it() {
        let corners = vec![[0.0, 0.0], [100.0, 0.0], [100.0, 60.0], [0.0, 60.0], [0.0, 0.0]];
        let sign = |at, sign| Stroke::new(Pen::Edge, Shape::Sign { at, sign });
        let scene = |status| Scene {
            strokes: vec![
                Stroke::new(Pen::Outline, Shape::Line(corners.clone())),
                Stroke::new(Pen::Edge, Shape::Zero([10.0, 10.0])),
                sign([50.0, 30.0], Sign::End),
                sign([50.0, 30.0], Sign::Start),
                sign([10.0, 10.0], Sign::Stop),
                sign([80.0, 30.0], Sign::Alarm),
            ],
            marks: vec![Mark { radius: 3.0, label: vec!["1".to_owned()], ..Mark::new([50.0, 30.0], status) }],
            ..Scene::default()
        };
        for status in [HoleStatus::Unjudged, HoleStatus::Good, HoleStatus::Bad, HoleStatus::Missing] {
            let scene = scene(status);
            let drawing = Rect::new(0.0, 0.0, 400.0, 240.0);
            let scale = crate::measure::Scale { factor: 4.0, origin: px(0.0, 240.0) };
            let frame = Frame {
                font: crate::font::Font::embedded(),
                text_size: 14.0,
                scale,
                largest_dial: 20.0,
                axis_reach: 0.0,
            };
            let hole = DrawnMark {
                centre: px(200.0, 120.0),
                label_clearance: 12.0,
                is_crowded: false,
                commands: Vec::new(),
                is_truncated: false,
                has_displacement_line: false,
                has_axis_arrow: false,
            };
            let places = SignPlaces::of(&scene, &[hole], &frame, drawing);
            let at: Vec<Px> = places.places.iter().map(|(.., at)| *at).collect();
            let radius = SIGN * 14.0;
            let [end, start, stop, alarm] = at[..] else { panic!("four places") };
            let hole = px(200.0, 120.0);
            assert!(
                [end, start].into_iter().all(|at| 0.95 * (12.0 + radius) < hole.distance(at)),
                "{end:?} {start:?}"
            );
            assert!(1.9 * radius < end.distance(start) && hole.distance(start) < 20.0, "{end:?} {start:?}");
            assert!(0.95 * (ZERO * 14.0 + radius) < px(40.0, 200.0).distance(stop), "{stop:?}");
            assert_eq!(alarm, px(320.0, 120.0), "nothing else is there");
            let picture = Picture { scene, ..Picture::default() };
            assert!(lay_out(&picture, Size::new(480, 360).unwrap()).is_ok());
        }
    }
}
