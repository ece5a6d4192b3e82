//! Body of the tool while an axis rotates, where the metal is known round the holes alone.
use nalgebra::{Point3, Unit, Vector3};

use super::HoleExtractor;
use super::feed_law::{Gouge, ToolRegion};
use super::metal::PointInMetal;
use super::near_metal::{FeedPart, Judged};
use super::rapid_paths::{OnPath, Search};
use super::strip::Line;
use crate::machine::{AxisMotion, Pose, TOUCH_DEPTH, ToolPart};
use gcode_lang::motion::{Event, Position};
use gcode_lang::units::Deg;
use gcode_part::Collar;

/// Largest rotation between two positions of the tool that are compared.
const MAX_STEP: Deg = Deg(2.0);

/// Largest number of positions of one motion that are compared.
const MAX_STANDS: u32 = 20_000;

/// A travel of the tip on the part, and the direction of the tool.
type Stand = (Line, Unit<Vector3<f64>>);

impl HoleExtractor<'_> {
    /// Returns the first metal round a hole that the body of the tool meets in a rapid while an axis rotates.
    pub(super) fn turned_body_contact(
        &mut self,
        event: &Event<'_>,
        travel: &AxisMotion<'_>,
    ) -> Option<PointInMetal> {
        let parts = self.turned_parts(travel.from);
        let stands = self.turned_stands(travel, &parts);
        let found = stands.iter().find_map(|(line, axis)| {
            let mut touching = parts.iter().filter(|part| self.may_cut(part, line, axis));
            touching.find_map(|part| self.contact_in_feed(part, axis, line, Judged::Uncut(None)))
        });
        if self.is_feed_unsearched.take() && found.is_none() {
            self.count_unsearched(event, Search::Rapid(OnPath::Turning));
        }
        found
    }

    /// Returns the first gouge that the tool makes in what has to stay round a hole, in a feed while an axis rotates.
    pub(super) fn turned_body_gouge(&self, travel: &AxisMotion<'_>) -> Option<Gouge> {
        let parts = self.turned_parts(travel.from);
        self.turned_stands(travel, &parts).iter().find_map(|(line, axis)| {
            if let Some(at) = self.metal.judged_on(line, Judged::Kept(FeedPart::Tip, u32::MAX)) {
                return Some(Gouge { at, part: ToolRegion::Tip });
            }
            parts.iter().filter(|part| self.may_cut(part, line, axis)).find_map(|part| {
                let side = FeedPart::Side { radius: part.radius(), slope: part.taper.slope };
                let (judged, region) = match part.is_cutter {
                    true => (Judged::Kept(side, u32::MAX), ToolRegion::Side),
                    false => (Judged::Uncut(None), ToolRegion::Shank),
                };
                let at = self.contact_in_feed(part, axis, line, judged)?;
                Some(Gouge { at, part: region })
            })
        })
    }

    /// Returns the parts of the tool. One of unknown diameter fills the hole in which its tip stands, as high as the metal.
    fn turned_parts(&self, from: &Position) -> Vec<ToolPart> {
        if !self.tool_body.is_empty() {
            return self.tool_body.clone();
        }
        let tip = self.machine.forward(from, &self.setup).tip;
        let radius = self.hole_of_tip(&tip).map(|hole| hole.hole_radius - hole.from_axis(&tip));
        // A point of 90° or more is no higher than the radius.
        radius.map(|radius| ToolPart::flutes(radius, radius, radius)).into_iter().collect()
    }

    /// Returns the travels of the tip at which the body of the tool may touch metal, and the points between them.
    fn turned_stands(&self, travel: &AxisMotion<'_>, parts: &[ToolPart]) -> Vec<Stand> {
        if self.metal.holes.is_none() {
            return Vec::new();
        }
        let Some(in_machine) = self.tool_in_turn(travel.from) else { return Vec::new() };
        let turned = self.machine.total_rotation(travel).0 / MAX_STEP.0;
        let chords = self.machine.chord_count(travel, &self.setup, TOUCH_DEPTH);
        let count = (turned.ceil() as u32).max(chords).min(MAX_STANDS);
        let reach = parts.iter().map(ToolPart::radius).fold(0.0, f64::max);
        let pose_at = |step: u32| -> (Point3<f64>, Unit<Vector3<f64>>) {
            let at = travel.position(f64::from(step) / f64::from(count));
            let Pose { tip, axis } = self.machine.forward(&at, &self.setup);
            let axis = axis.unwrap_or_else(|| {
                self.machine.part_frame(&at).rotation.inverse_transform_unit_vector(&in_machine)
            });
            (tip, axis)
        };
        let mut stands = Vec::new();
        let mut last = pose_at(0);
        for step in 1..=count {
            let next = pose_at(step);
            let middle = Unit::try_new(last.1.into_inner() + next.1.into_inner(), 0.1);
            let chord = middle.map(|axis| ([last.0, next.0], axis));
            let stand = ([next.0, next.0], next.1);
            let is_near = |(line, axis): &Stand| self.metal.is_touched(&line[0], &line[1], axis, reach);
            stands.extend(chord.into_iter().chain([stand]).filter(is_near));
            last = next;
        }
        stands
    }

    /// Returns the direction of the tool before a rotation, in machine coordinates. If the head leaves it open, it is that of the
    /// hole in which the tip stands.
    fn tool_in_turn(&self, from: &Position) -> Option<Unit<Vector3<f64>>> {
        let Pose { tip, axis } = self.machine.forward(from, &self.setup);
        let frame = self.machine.part_frame(from);
        let own = axis.or_else(|| Some(self.hole_of_tip(&tip)?.rod.axis));
        own.map(|axis| frame.rotation * axis)
    }

    /// Returns the nominal hole of stated diameter in which the tip stands.
    fn hole_of_tip(&self, tip: &Point3<f64>) -> Option<&Collar> {
        let mut own = None;
        self.metal.around(&[*tip, *tip], &mut |collar| {
            let depth = collar.depth(tip);
            let is_in = TOUCH_DEPTH < depth && depth <= collar.max_depth() + TOUCH_DEPTH;
            if is_in && collar.has_diameter && collar.from_axis(tip) <= collar.hole_radius {
                own = Some(collar);
            }
        });
        own
    }
}
