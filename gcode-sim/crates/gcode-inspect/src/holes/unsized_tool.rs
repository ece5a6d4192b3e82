//! Tools of unknown diameter on the axis of a nominal hole: each is as wide as the feature that ends where its strokes do.
use nalgebra::{Point3, Unit, Vector3};

use super::HoleExtractor;
use super::feed_law::{FIT, ON_AXIS, is_along};
use super::line::{CuttingLine, StartInside};
use super::profile::Profile;
use super::strip::Line;
use super::swept_tool::rim;
use crate::findings::RAPID_INTO_PART;
use crate::machine::ToolKind;
use gcode_lang::diag::Diagnostic;
use gcode_part::{Collar, EntrySearch, PARALLEL_COSINE, SAME_END};

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

/// Strokes of one tool in a nominal hole, until another one comes.
#[derive(Clone, Copy, Debug)]
pub(super) struct HoleStroke {
    tool: Option<u32>,
    /// Depth of the deepest tip below the entry, mm.
    depth: f64,
}

/// Radii of a tool of unknown diameter in a stroke, mm.
#[derive(Clone, Copy, Debug)]
struct StrokeRadii {
    /// That of the narrowest feature of the holes into which it leads.
    through: f64,
    /// That of the feature that ends where the stroke does.
    end: Option<f64>,
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
    /// Returns the radii of a tool of unknown diameter in a stroke on the axis of nominal holes, mm; `None` beside all of them.
    fn radii_on_axis(&self, travel: &Line, axis: &Unit<Vector3<f64>>) -> Option<StrokeRadii> {
        let mut narrowest_entered: Option<f64> = None;
        let (mut widest_hole, mut end): (Option<f64>, Option<f64>) = (None, None);
        // A hole that the tip has left is above it.
        let up = axis.into_inner() * self.metal.removed.height_of_metal(&travel[1], axis);
        let [low, high] = [travel[0].inf(&travel[1]), travel[0].sup(&travel[1])];
        let searched = [low.inf(&(low + up)), high.sup(&(high + up))];
        self.metal.around(&searched, &mut |collar: &Collar| {
            let aside = travel.iter().map(|p| collar.from_axis(p)).fold(0.0, f64::max);
            if !collar.is_parallel(axis) || ON_AXIS < aside {
                return;
            }
            let depths = travel.map(|p| collar.depth(&p));
            let (deepest, highest) = (depths[0].max(depths[1]), depths[0].min(depths[1]));
            let is_into = 0.0 < axis.dot(&collar.rod.axis);
            // Of holes on one axis those count into which the stroke leads.
            let is_entered = match is_into {
                true => SAME_END < deepest,
                false => highest < collar.rod.length - SAME_END,
            };
            let narrowest = collar.narrowest() - aside;
            widest_hole = Some(widest_hole.unwrap_or(0.0).max(narrowest));
            if is_entered {
                narrowest_entered = Some(narrowest_entered.unwrap_or(f64::INFINITY).min(narrowest));
            }
            if let Some(radius) = collar.radius_ending_at(deepest).filter(|_| is_into) {
                end = Some(end.unwrap_or(f64::INFINITY).min(radius - aside));
            }
        });
        Some(StrokeRadii { through: narrowest_entered.or(widest_hole)?, end })
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
        let drilled = self.radii_on_axis(travel, axis).map(|radii| radii.through);
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
        self.metal.removed.add([from, to], *axis, &profile, false);
    }

    /// Removes what the last strokes of a tool of unknown diameter have cut of the feature that ends where they do.
    pub(super) fn end_unsized_stroke(&mut self) {
        let Some(UnsizedStroke { travel, axis }) = self.unsized_stroke.take() else { return };
        let Some(StrokeRadii { through, end }) = self.radii_on_axis(&travel, &axis) else { return };
        if let Some(radius) = end.filter(|radius| through < *radius) {
            self.metal.removed.add(travel, axis, &Profile::flat(radius, true), false);
        }
    }

    /// Returns the radius of a stroke if that of its tool is unknown, mm.
    pub(super) fn radius_of_unsized(
        &self,
        travel: &[Point3<f64>; 2],
        axis: &Unit<Vector3<f64>>,
    ) -> Option<f64> {
        if self.tool_radius().is_some() {
            return None;
        }
        self.radii_on_axis(travel, axis).map(|radii| radii.end.unwrap_or(radii.through))
    }

    /// Records how deep a feed along the tool goes in the nominal holes on whose axis it is: in each from the first tool of unknown
    /// diameter on.
    pub(super) fn record_hole_stroke(&mut self, line: &Line, axis: &Unit<Vector3<f64>>) {
        let Some(holes) = &self.metal.holes else { return };
        let tool = self.setup.tool;
        let is_sized = self.machine.diameter_of(tool).is_some();
        if is_sized && self.hole_strokes.is_empty() {
            return;
        }
        for_each_hole_along(holes, line, axis, |hole, collar| {
            let depth = collar.depth(&line[0]).max(collar.depth(&line[1]));
            if depth <= 0.0 || is_sized && !self.hole_strokes.contains_key(&hole) {
                return;
            }
            let strokes = self.hole_strokes.entry(hole).or_default();
            match strokes.last_mut().filter(|last| last.tool == tool) {
                Some(last) => last.depth = last.depth.max(depth),
                None => strokes.push(HoleStroke { tool, depth }),
            }
        });
    }

    /// Returns true if the last other tool that ended where this one does (within [`SAME_END`]) has no known diameter: this tool is then
    /// assumed to cut. False for a tap or a probe.
    pub(super) fn is_finishing(&self, line: &Line, axis: &Unit<Vector3<f64>>) -> bool {
        let (tool, kind) = (self.setup.tool, self.machine.kind_of(self.setup.tool));
        if matches!(kind, Some(ToolKind::Tap | ToolKind::Probe)) {
            return false;
        }
        let Some(holes) = self.metal.holes.as_ref().filter(|_| !self.hole_strokes.is_empty()) else {
            return false;
        };
        let mut is_finishing = false;
        for_each_hole_along(holes, line, axis, |hole, collar| {
            let Some(strokes) = self.hole_strokes.get(&hole) else { return };
            let depth = collar.depth(&line[1]);
            let is_before =
                |stroke: &&HoleStroke| stroke.tool != tool && collar.is_same_end(stroke.depth, depth);
            let before = strokes.iter().rfind(is_before);
            is_finishing |= before.is_some_and(|stroke| self.machine.diameter_of(stroke.tool).is_none());
        });
        is_finishing
    }

    /// Records where a tool begins its feed inside a hole which it widens, where its own diameter or that of the hole is unknown: it has
    /// come down through the metal that it is there to cut.
    pub(super) fn record_start_inside(&self, line: &mut CuttingLine) {
        if !line.is_inward() || line.start_inside.is_some() {
            return;
        }
        let axis = line.tool_axis.unwrap_or(line.out);
        let widened = match self.tool_radius() {
            Some(_) => self.start_in_open_hole(line, &axis),
            None => self.start_of_unsized(line, &axis),
        };
        line.start_inside = widened.or_else(|| self.start_of_finishing(line, &axis));
    }

    /// Reports a tool that has begun its feed inside a hole which it widens. A mill that goes on across widens it there.
    pub(super) fn report_start_inside(&mut self, line: &CuttingLine) {
        let Some(StartInside { depth, radius }) = line.start_inside else { return };
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

    /// Returns where a tool begins in the hole that it finishes, if nothing wider is cut above it.
    fn start_of_finishing(&self, line: &CuttingLine, axis: &Unit<Vector3<f64>>) -> Option<StartInside> {
        let (start, tip) = (line.start, self.pose.tip);
        if !self.is_finishing(&[start, tip], axis) {
            return None;
        }
        let own = self.tool_radius();
        let radii = self.radii_on_axis(&[start, tip], axis)?;
        let made = radii.end.unwrap_or(radii.through);
        let radius = own.unwrap_or(made);
        let depth = self.depth_on_axis(&start, axis, |_| true).filter(|depth| MIN_START_DEPTH < *depth)?;
        let above = start + axis.into_inner() * depth;
        let wider = radius.max(made) + 2.0 * FIT;
        let is_cut = |offset: Vector3<f64>| {
            self.metal.cuts(&(start + offset), &(above + offset)) == Some(true)
                || self.metal.cuts_open_wall(&[start + offset, above + offset], axis, wider)
        };
        let rim = rim(axis, &Vector3::zeros(), wider);
        rim.into_iter().any(is_cut).then_some(StartInside { depth, radius })
    }

    /// Returns where a tool of known diameter begins in a hole whose diameter the reference doesn't have, if no feed has made the hole
    /// as wide above it.
    fn start_in_open_hole(&self, line: &CuttingLine, axis: &Unit<Vector3<f64>>) -> Option<StartInside> {
        let depth = self.depth_in_open_hole(&line.start, axis).filter(|depth| MIN_START_DEPTH < *depth)?;
        let (height, radius) = self.widest_in_open_hole(&line.start, axis)?;
        let out = axis.into_inner();
        let (wide, above) = (line.start + out * height, line.start + out * depth);
        let rim = rim(axis, &Vector3::zeros(), radius - FIT);
        let is_cut =
            |offset: Vector3<f64>| self.metal.cuts_open_wall(&[wide + offset, above + offset], axis, radius);
        rim.into_iter().any(is_cut).then_some(StartInside { depth, radius })
    }

    /// Returns the depth of a tip on the axis of a hole whose diameter the reference doesn't have, mm; `None` beside all of them.
    fn depth_in_open_hole(&self, tip: &Point3<f64>, axis: &Unit<Vector3<f64>>) -> Option<f64> {
        self.metal.holes.as_ref().filter(|holes| holes.has_open())?;
        self.depth_on_axis(tip, axis, |collar| !collar.has_diameter)
    }

    /// Returns the largest depth of a tip below the entries of the nominal holes that count and on whose axis it is, mm.
    fn depth_on_axis(
        &self,
        tip: &Point3<f64>,
        axis: &Unit<Vector3<f64>>,
        is_counted: impl Fn(&Collar) -> bool,
    ) -> Option<f64> {
        let mut deepest: Option<f64> = None;
        let top = tip + axis.into_inner() * self.metal.removed.height_of_metal(tip, axis);
        self.metal.around(&[*tip, top], &mut |collar| {
            let is_on_axis = collar.is_parallel(axis) && collar.from_axis(tip) <= ON_AXIS;
            if is_on_axis && is_counted(collar) {
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

    /// Returns where a tool of unknown diameter begins in a hole that is cut on its axis, if the metal round that is not removed above it.
    fn start_of_unsized(&self, line: &CuttingLine, axis: &Unit<Vector3<f64>>) -> Option<StartInside> {
        let (start, tip) = (line.start, self.pose.tip);
        let radius = self.radii_on_axis(&[start, tip], axis)?.end?;
        let is_into = |collar: &Collar| 0.0 < axis.dot(&collar.rod.axis);
        let depth = self.depth_on_axis(&start, axis, is_into).filter(|depth| MIN_START_DEPTH < *depth)?;
        let above = start + axis.into_inner() * depth;
        let is_cut =
            |offset: Vector3<f64>| self.metal.cuts(&(start + offset), &(above + offset)) == Some(true);
        let is_widened =
            !is_cut(Vector3::zeros()) && rim(axis, &Vector3::zeros(), radius - FIT).into_iter().any(is_cut);
        is_widened.then_some(StartInside { depth, radius })
    }
}

/// Calls `each` with the nominal holes on whose axis a stroke along a tool ends, and into which it leads.
fn for_each_hole_along<'h>(
    holes: &'h EntrySearch,
    [from, to]: &Line,
    axis: &Unit<Vector3<f64>>,
    mut each: impl FnMut(usize, &'h Collar),
) {
    holes.around(&from.inf(to), &from.sup(to), &mut |hole| {
        let collar = holes.collar(hole);
        if PARALLEL_COSINE <= axis.dot(&collar.rod.axis) && collar.from_axis(to) <= ON_AXIS {
            each(hole, collar);
        }
    });
}
