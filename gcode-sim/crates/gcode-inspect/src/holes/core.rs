//! Core of a milled hole: metal inside its circle that no tool has removed.
use nalgebra::{Point3, Unit, Vector3};

use super::HoleExtractor;
use super::axis_box::directions_across;
use super::drill_pass::PassCut;
use super::group::{DrilledHole, ToolPass};
use crate::machine::TOUCH_DEPTH;
use gcode_part::exceeds;

/// Largest height of metal on the bottom of a hole that counts as removed, mm.
const MAX_CORE_HEIGHT: f64 = 0.1;

/// Width at the wall in which the circle itself is judged, mm.
const WALL_WIDTH: f64 = 0.05;

/// Number of lines on the radius of a hole, and their least distance, mm.
const LINES: f64 = 32.0;
const MIN_DISTANCE: f64 = 0.25;

/// Ring that a tool of a hole clears.
struct ClearedRing {
    inner: f64,
    outer: f64,
    /// Lowest height at which it is cleared to its width.
    level: f64,
}

impl HoleExtractor<'_> {
    /// Finds the core of each milled circle.
    pub(super) fn find_cores(&self, holes: &mut [DrilledHole]) {
        for hole in holes {
            let cores: Vec<Option<f64>> = {
                let passes: Vec<ToolPass<'_>> = hole.passes().collect();
                if passes.iter().all(|pass| pass.cut.milled.is_none()) {
                    continue;
                }
                let is_covered =
                    |one: &ToolPass<'_>| passes.iter().any(|other| is_wider_and_deeper(other, one));
                passes
                    .iter()
                    .map(|pass| if is_covered(pass) { None } else { self.core_of(pass, &passes) })
                    .collect()
            };
            let (finishing, mut cores) = (hole.finishing_index.min(hole.earlier_passes.len()), cores);
            set_core(&mut hole.finishing_cut, cores.remove(finishing));
            for (pass, core) in hole.earlier_passes.iter_mut().zip(cores) {
                set_core(&mut pass.cut, core);
            }
        }
    }

    /// Returns the diameter up to which metal is left inside the circle of a pass; a mill of unknown diameter is taken to
    /// leave none.
    fn core_of(&self, pass: &ToolPass<'_>, passes: &[ToolPass<'_>]) -> Option<f64> {
        let circle = pass.cut.milled?;
        // The cone of a pointed mill is judged by its shape: what is inside its full diameter counts.
        let is_pointed = 0.0 < self.point_length(pass);
        let wall = if is_pointed { 2.0 * circle.radius - pass.diameter? / 2.0 } else { pass.diameter? / 2.0 };
        let radius = wall - WALL_WIDTH - circle.roundness;
        if radius <= 0.0 {
            return None;
        }
        let level = pass.cut.bottom.coords.dot(&pass.axis) + MAX_CORE_HEIGHT;
        let gaps = self.gaps(pass, passes, (radius, level));
        if gaps.is_empty() {
            return None;
        }
        let left = self.left_inside(&pass.cut.bottom, &pass.axis, &gaps, 0.0)?;
        let edge = gaps.iter().find(|gap| gap[0] - WALL_WIDTH <= left && left <= gap[1] + WALL_WIDTH);
        Some(2.0 * edge.map_or(left, |gap| gap[1]))
    }

    /// Returns the radii up to `radius` that no circle and no drill about the axis of a pass clears down to a level.
    fn gaps(&self, at: &ToolPass<'_>, passes: &[ToolPass<'_>], (radius, level): (f64, f64)) -> Vec<[f64; 2]> {
        let rings = passes.iter().filter_map(|pass| self.cleared_ring(pass, at));
        let mut rings: Vec<ClearedRing> = rings.filter(|ring| ring.level <= level).collect();
        rings.sort_by(|a, b| a.inner.total_cmp(&b.inner));
        let (mut gaps, mut cleared) = (Vec::new(), 0.0);
        for ring in rings {
            if cleared + TOUCH_DEPTH < ring.inner && cleared < radius {
                gaps.push([cleared, ring.inner.min(radius)]);
            }
            cleared = ring.outer.max(cleared);
        }
        if cleared < radius {
            gaps.push([cleared, radius]);
        }
        gaps
    }

    /// Returns the length of the tool below its full diameter.
    fn point_length(&self, pass: &ToolPass<'_>) -> f64 {
        self.machine.tool_end(pass.tool).first().map_or(0.0, |full| full.from)
    }

    /// Returns the ring about the axis of another pass that a pass clears.
    fn cleared_ring(&self, pass: &ToolPass<'_>, at: &ToolPass<'_>) -> Option<ClearedRing> {
        let diameter = pass.diameter?;
        let point = self.point_length(pass);
        let to = pass.cut.bottom - at.cut.bottom;
        let aside = (to - at.axis.into_inner() * to.dot(&at.axis)).norm();
        // A circle cleared the metal from its path less the mill's radius on.
        let inner = pass.cut.milled.map_or(0.0, |circle| 2.0 * circle.radius - diameter / 2.0);
        Some(ClearedRing {
            inner: if inner + aside < TOUCH_DEPTH { 0.0 } else { inner + aside },
            outer: diameter / 2.0 - aside,
            level: pass.cut.bottom.coords.dot(&at.axis) + point,
        })
    }

    /// Returns the distance from the axis of the farthest metal above the bottom of a hole, within gaps of the radius, that is
    /// higher than `min_height`.
    pub(super) fn left_inside(
        &self,
        bottom: &Point3<f64>,
        axis: &Unit<Vector3<f64>>,
        gaps: &[[f64; 2]],
        min_height: f64,
    ) -> Option<f64> {
        let out = axis.into_inner();
        let base = bottom + out * MAX_CORE_HEIGHT;
        let up = out * self.metal.removed.height_of_metal(bottom, &out);
        let [u, v] = directions_across(axis);
        let is_left = |offset: Vector3<f64>| {
            let line = [base + offset, base + offset + up];
            self.metal.uncut(&line).is_some()
                && (min_height == 0.0 || exceeds(self.metal.uncut_length(&line), min_height))
        };
        let radius = gaps.last()?[1];
        let distance = (radius / LINES).max(MIN_DISTANCE);
        let steps = (radius / distance).floor() as i32;
        let offsets = (-steps..=steps).flat_map(|i| {
            (-steps..=steps).map(move |j| u * (f64::from(i) * distance) + v * (f64::from(j) * distance))
        });
        let is_in_gap = |offset: &Vector3<f64>| {
            let radius = offset.norm();
            gaps.iter().any(|gap| gap[0] <= radius && radius <= gap[1])
        };
        let left = offsets.filter(is_in_gap).filter(|offset| is_left(*offset));
        left.map(|offset| offset.norm()).reduce(f64::max)
    }
}

/// Returns true if a circle is wider than another one and as deep, or as wide and deeper.
fn is_wider_and_deeper(one: &ToolPass<'_>, other: &ToolPass<'_>) -> bool {
    let (Some(width), Some(other_width)) = (one.diameter, other.diameter) else { return false };
    let height = |pass: &ToolPass<'_>| pass.cut.bottom.coords.dot(&one.axis);
    let (level, other_level) = (height(one), height(other));
    one.cut.milled.is_some()
        && other_width <= width
        && level <= other_level
        && (other_width < width || level < other_level)
}

fn set_core(cut: &mut PassCut, core: Option<f64>) {
    if let Some(circle) = &mut cut.milled {
        circle.core = core.or(circle.core);
    }
}
