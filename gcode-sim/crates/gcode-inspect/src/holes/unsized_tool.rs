//! Tools of unknown diameter on the axis of a nominal hole: each is as wide as the feature that ends where its strokes do.
use nalgebra::{Point3, Unit, Vector3};

use super::HoleExtractor;
use super::feed_law::{FIT, ON_AXIS, is_along};
use super::line::CuttingLine;
use super::profile::Profile;
use super::strip::Line;
use super::swept_tool::rim;
use crate::findings::RAPID_INTO_PART;
use gcode_lang::diag::Diagnostic;
use gcode_part::Collar;

/// Depth in a hole from which on the start of a feed is inside it, mm.
const MIN_START_DEPTH: f64 = 0.1;

/// Depth below the entry of a hole at which the width of a cone counts as that at the entry, mm.
const MOUTH_DEPTH: f64 = 0.05;

/// Radius up to which a mill of unknown diameter may remove metal, mm.
pub(super) const MAX_RADIUS: f64 = 25.0;

/// Strokes of a tool of unknown diameter on one line, from the highest to the deepest tip: a peck that ends where a feature does is
/// part of them.
#[derive(Clone, Copy, Debug)]
pub(super) struct UnsizedStroke {
    travel: Line,
    axis: Unit<Vector3<f64>>,
}

impl UnsizedStroke {
    /// Adds a feed on the same line; returns false for another one.
    fn extend(&mut self, travel: &Line, axis: &Unit<Vector3<f64>>) -> bool {
        let [top, bottom] = self.travel;
        let aside = |p: &Point3<f64>| (p - top) - axis.into_inner() * (p - top).dot(axis);
        if *axis != self.axis || travel.iter().any(|p| ON_AXIS < aside(p).norm()) {
            return false;
        }
        let height = |p: &Point3<f64>| p.coords.dot(axis);
        let (mut high, mut low) = (top, bottom);
        for p in travel {
            high = if height(&high) < height(p) { *p } else { high };
            low = if height(p) < height(&low) { *p } else { low };
        }
        self.travel = [high, low];
        true
    }
}

impl HoleExtractor<'_> {
    /// Returns the largest radius that a tool of unknown diameter may have in a stroke on the axis of a nominal hole: that of the
    /// feature that ends there; `None` for a travel beside all holes.
    fn radius_of_stroke(&self, travel: &Line, axis: &Unit<Vector3<f64>>) -> Option<f64> {
        self.radius_on_axis(travel, axis, |collar, depth| collar.radius_of_stroke(depth))
    }

    /// Returns the largest radius that the holes on whose axis a travel is have for it and its depth.
    fn radius_on_axis(
        &self,
        travel: &Line,
        axis: &Unit<Vector3<f64>>,
        radius: impl Fn(&Collar, f64) -> f64,
    ) -> Option<f64> {
        let mut widest: Option<f64> = None;
        self.metal.around(travel, &mut |collar: &Collar| {
            let aside = travel.iter().map(|p| collar.from_axis(p)).fold(0.0, f64::max);
            if collar.is_parallel(axis) && aside <= ON_AXIS {
                let depth = travel.iter().map(|p| collar.depth(p)).fold(0.0, f64::max);
                widest = Some(widest.unwrap_or(0.0).max(radius(collar, depth) - aside));
            }
        });
        widest
    }

    /// Removes what a straight feed of a tool of unknown diameter cuts of a nominal hole: off the axis as far as its wall, on the axis
    /// the narrowest feature, and that which ends where the strokes do once they have ended.
    pub(super) fn remove_unsized(&mut self, travel: &Line, axis: &Unit<Vector3<f64>>) {
        let [from, to] = *travel;
        let mut milled: Option<f64> = None;
        self.metal.around(travel, &mut |collar: &Collar| {
            let aside = travel.iter().map(|p| collar.from_axis(p)).fold(0.0, f64::max);
            if collar.is_parallel(axis) && aside <= collar.hole_radius && ON_AXIS < aside {
                milled = Some(milled.unwrap_or(0.0).max(collar.hole_radius - aside));
            }
        });
        let drilled = self.radius_on_axis(travel, axis, |collar, _| collar.narrowest());
        if drilled.is_some()
            && !self.unsized_stroke.as_mut().is_some_and(|stroke| stroke.extend(travel, axis))
        {
            self.end_unsized_stroke();
            self.unsized_stroke = Some(UnsizedStroke { travel: *travel, axis: *axis });
        }
        let room = drilled.map_or(milled, |radius| Some(radius.max(milled.unwrap_or(0.0))));
        let profile = match room {
            Some(room) => Profile::flat(room, true),
            // Without nominal holes the direction of the tool may be that of the feed.
            None if is_along(axis, &(to - from)) || self.metal.holes.is_none() => Profile::flat(0.0, true),
            None => {
                if self.surface.is_some() {
                    self.note_unsized_mill(self.setup.tool);
                }
                Profile::flat(MAX_RADIUS, false)
            }
        };
        self.metal.removed.add(from, to, *axis, &profile);
    }

    /// Removes what the last strokes of a tool of unknown diameter have cut of the feature that ends where they do.
    pub(super) fn end_unsized_stroke(&mut self) {
        let Some(UnsizedStroke { travel, axis }) = self.unsized_stroke.take() else { return };
        let narrowest = self.radius_on_axis(&travel, &axis, |collar, _| collar.narrowest());
        if let Some(radius) = self.radius_of_stroke(&travel, &axis).filter(|radius| narrowest < Some(*radius))
        {
            self.metal.removed.add(travel[0], travel[1], axis, &Profile::flat(radius, true));
        }
    }

    /// Returns the radius of a stroke if that of its tool is unknown, mm.
    pub(super) fn radius_of_unsized(
        &self,
        travel: &[Point3<f64>; 2],
        axis: &Unit<Vector3<f64>>,
    ) -> Option<f64> {
        if self.tool_radius().is_some() { None } else { self.radius_of_stroke(travel, axis) }
    }

    /// Reports a tool that begins its feed inside a hole which it widens, where its own diameter or that of the hole is unknown: it has
    /// come down through the metal that it is there to cut.
    pub(super) fn check_start_inside(&mut self, line: &CuttingLine) {
        if !line.is_inward() {
            return;
        }
        let axis = line.tool_axis.unwrap_or(line.out);
        let widened = match self.tool_radius() {
            Some(_) => self.start_in_open_hole(line, &axis),
            None => self.start_of_unsized(line, &axis),
        };
        let Some((depth, radius)) = widened else { return };
        self.findings.add(&RAPID_INTO_PART, line.backtrace(), 0, |kind| {
            let name = line.cutting_state.tool.map_or("the tool".to_owned(), |number| format!("T{number}"));
            let message = format!(
                "{name} begins its feed {depth:.3} mm deep in the hole that it widens to Φ{:.3}: it comes down in rapid through \
                 the metal that it cuts",
                2.0 * radius
            );
            Diagnostic::new(kind, message).help("begin the feed above the hole: check R or Z of the approach")
        });
    }

    /// Returns the depth at which a tool of known diameter begins in a hole whose diameter the reference doesn't have, and the tool's
    /// radius there, if no feed has made the hole as wide above it.
    fn start_in_open_hole(&self, line: &CuttingLine, axis: &Unit<Vector3<f64>>) -> Option<(f64, f64)> {
        let depth = self.depth_in_open_hole(&line.start, axis).filter(|depth| MIN_START_DEPTH < *depth)?;
        let (height, radius) = self.widest_in_open_hole(&line.start, axis)?;
        let out = axis.into_inner();
        let (wide, above) = (line.start + out * height, line.start + out * depth);
        let rim = rim(axis, &Vector3::zeros(), radius - FIT);
        let is_cut =
            |offset: Vector3<f64>| self.metal.cuts_open_wall(&[wide + offset, above + offset], axis, radius);
        rim.into_iter().any(is_cut).then_some((depth, radius))
    }

    /// Returns the depth of a tip on the axis of a hole whose diameter the reference doesn't have, mm; `None` beside all of them.
    fn depth_in_open_hole(&self, tip: &Point3<f64>, axis: &Unit<Vector3<f64>>) -> Option<f64> {
        let mut deepest: Option<f64> = None;
        let top = tip + axis.into_inner() * self.metal.removed.height_of_metal(tip, axis);
        self.metal.around(&[*tip, top], &mut |collar| {
            let is_on_axis = collar.is_parallel(axis) && collar.from_axis(tip) <= ON_AXIS;
            if !collar.has_diameter && is_on_axis {
                deepest = Some(deepest.unwrap_or(0.0).max(collar.depth(tip)));
            }
        });
        deepest
    }

    /// Returns the height above a tip, on the axis of a hole whose diameter the reference doesn't have, at which the tool is as wide as
    /// it gets below the entry, and its radius there: that of a cone only at the entry, if the full diameter is above it.
    pub(super) fn widest_in_open_hole(
        &self,
        tip: &Point3<f64>,
        axis: &Unit<Vector3<f64>>,
    ) -> Option<(f64, f64)> {
        let full = *self.machine.tool_end(self.setup.tool).first()?;
        let mouth = self.depth_in_open_hole(tip, axis)? - MOUTH_DEPTH;
        match full.from <= mouth {
            true => Some((full.from, full.radius())),
            false => (0.0 < mouth).then(|| (mouth, full.radius() * mouth / full.from)),
        }
    }

    /// Returns the depth at which a tool of unknown diameter begins in a hole, and the radius to which it widens that, if the metal
    /// above it is not removed.
    fn start_of_unsized(&self, line: &CuttingLine, axis: &Unit<Vector3<f64>>) -> Option<(f64, f64)> {
        let (start, tip) = (line.start, self.pose.tip);
        let mut begun = None;
        self.metal.around(&[start, tip], &mut |collar| {
            let (depth, radius) = (collar.depth(&start), collar.widened_at(collar.depth(&tip)));
            let is_on_axis = collar.is_parallel(axis) && collar.from_axis(&tip) <= ON_AXIS;
            if let Some(radius) = radius.filter(|_| is_on_axis && MIN_START_DEPTH < depth) {
                begun = Some((depth, radius));
            }
        });
        let (depth, radius) = begun?;
        let above = start + axis.into_inner() * depth;
        let rim = rim(axis, &Vector3::zeros(), radius - FIT);
        let is_cut =
            |offset: Vector3<f64>| self.metal.cuts(&(start + offset), &(above + offset)) == Some(true);
        if rim.into_iter().any(is_cut) { begun } else { None }
    }
}
