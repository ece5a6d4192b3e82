//! Feeds while an axis rotates: they may remove the nominal holes and the stated pockets.
use nalgebra::{Point3, Unit, Vector3};

use super::HoleExtractor;
use super::axis_box::AxisBox;
use super::feed_law::{CHORD_TOLERANCE, COARSE_TOLERANCE, Gouge, ToolRegion};
use super::near_metal::{Contact, FeedPart, Judged};
use super::rapid_paths::{OnPath, Search};
use super::strip::Line;
use crate::machine::{AxisMotion, Pose, TOUCH_DEPTH};
use gcode_lang::motion::{Event, Position};
use gcode_lang::units::MmPerMin;

/// Largest number of chords of a feed that is followed.
const MAX_CHORDS: usize = 5000;

impl HoleExtractor<'_> {
    /// Removes what a feed cuts while an axis rotates. Returns false, and removes nothing, if the feed removes what has to stay
    /// or can't be followed.
    pub(super) fn remove_while_turning(
        &mut self,
        event: &Event<'_>,
        travel: &AxisMotion<'_>,
        is_known: bool,
    ) -> bool {
        let is_followed = is_known
            && self.surface.is_some()
            && self.has_left_start
            && self.metal.holes.is_some()
            && self.tool_radius().is_some();
        if !is_followed {
            return false;
        }
        let Some(coarse) = self.turning_chords(travel, COARSE_TOLERANCE) else { return false };
        let reach = self.body_radius() + COARSE_TOLERANCE;
        let is_near = |(chord, axis): &(Line, Unit<Vector3<f64>>)| {
            let [from, to] = chord.map(|tip| tip - axis.into_inner() * COARSE_TOLERANCE);
            self.metal.is_touched(&from, &to, axis, reach)
        };
        if !coarse.iter().any(is_near) {
            self.milling.record_idle(event, &self.tool_state());
            return true;
        }
        let Some(chords) = self.turning_chords(travel, CHORD_TOLERANCE) else { return false };
        let mills = |own: &Self| chords.iter().any(|(chord, axis)| own.mills(chord, axis));
        self.check_milling(event, rate_on_part(event, &chords), &[], mills);
        if !chords.iter().all(|(chord, axis)| self.is_turning_allowed(chord, axis)) {
            self.is_feed_unsearched.take();
            return false;
        }
        // The search for one of them may have been given up.
        if self.is_feed_unsearched.take() {
            return false;
        }
        self.note_milled_block(event, &chords);
        for (chord, axis) in &chords {
            self.remove(chord, axis, false);
        }
        true
    }

    /// Returns the chords of a path on the part, each with the tool's direction at its middle, and their ends with the direction
    /// there; `None` if it is unknown or the chords are too many.
    fn turning_chords(
        &self,
        travel: &AxisMotion<'_>,
        tolerance: f64,
    ) -> Option<Vec<(Line, Unit<Vector3<f64>>)>> {
        let mut poses: Vec<Pose> = Vec::new();
        self.machine.for_each_pose(travel, &self.setup, tolerance, |pose| {
            if poses.len() <= MAX_CHORDS {
                poses.push(pose);
            }
        });
        if MAX_CHORDS < poses.len() {
            return None;
        }
        let stand = |pose: &Pose| Some(([pose.tip, pose.tip], pose.axis?));
        let chord = |pair: &[Pose]| {
            let axis = pair[0].axis?.into_inner() + pair[1].axis?.into_inner();
            Some(([pair[0].tip, pair[1].tip], Unit::try_new(axis, 0.1)?))
        };
        poses.windows(2).flat_map(|pair| [chord(pair), stand(&pair[1])]).collect()
    }

    /// Checks the body of the tool in a feed while an axis rotates; the feed is counted where it meets metal that may go.
    pub(super) fn check_turning_feed(&mut self, event: &Event<'_>, (from, to): (&Position, &Position)) {
        let Some(body) = self.surface else {
            if self.positions.is_known(self.machine)
                && let Some(gouge) = self.turned_body_gouge(&AxisMotion { from, to, arc: None })
            {
                self.report_gouge(&event.backtrace(), &[self.pose.tip], gouge);
            }
            return self.count_unsearched_feed(event, OnPath::Turning);
        };
        if !self.has_left_start || self.metal.holes.is_none() {
            return;
        }
        let (setup, axis) = (self.setup, self.pose.axis);
        let Some(axis) = axis.filter(|_| self.positions.is_known(self.machine)) else { return };
        let path = AxisBox::line(self.machine, &setup, from, to);
        let at = match self.body_contact(&path, None, &axis) {
            Contact::Clear => return,
            Contact::Metal(at) => Some(at.point).filter(|at| TOUCH_DEPTH < body.depth(at)),
            Contact::Unknown => None,
        };
        let side = FeedPart::Side { radius: self.body_radius(), slope: 0.0 };
        match at.and_then(|at| self.metal.gouge(&[at, at], side)) {
            Some(at) => {
                self.report_gouge(&event.backtrace(), &[self.pose.tip], Gouge { at, part: ToolRegion::Side })
            }
            None => self.count_unsearched(event, Search::Feed(OnPath::Turning)),
        }
    }

    /// Returns the first gouge in what has to stay on a path while an axis rotates; `None` without pockets.
    pub(super) fn turning_gouge(&self, travel: &AxisMotion<'_>) -> Option<Gouge> {
        if self.metal.pockets.is_empty() {
            return None;
        }
        let chords = self.turning_chords(travel, CHORD_TOLERANCE)?;
        chords.iter().find_map(|(chord, axis)| self.gouge_on_chord(chord, axis))
    }

    fn gouge_on_chord(&self, chord: &Line, axis: &Unit<Vector3<f64>>) -> Option<Gouge> {
        let is_touched = self.metal.is_touched(&chord[0], &chord[1], axis, self.body_radius());
        if is_touched { self.gouge(chord, axis, u32::MAX) } else { None }
    }

    /// Returns true if the tool removes nothing that has to stay on a chord.
    fn is_turning_allowed(&self, chord: &[Point3<f64>; 2], axis: &Unit<Vector3<f64>>) -> bool {
        let is_touching = || {
            let mut parts = self.tool_body.iter().filter(|part| !part.is_cutter);
            parts.any(|part| self.contact_in_feed(part, axis, chord, Judged::Uncut(None)).is_some())
        };
        self.gouge_on_chord(chord, axis).is_none() && !is_touching()
    }
}

/// Returns the rate of the tool on the part: F counts the degrees of a rotary axis as millimetres.
fn rate_on_part(event: &Event<'_>, chords: &[(Line, Unit<Vector3<f64>>)]) -> MmPerMin {
    let length: f64 = chords.iter().map(|([from, to], _)| (to - from).norm()).sum();
    MmPerMin(length / event.seconds.0 * 60.0)
}
