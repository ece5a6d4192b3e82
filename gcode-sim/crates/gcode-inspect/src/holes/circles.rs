//! Circles of an engagement that make one hole, and how far the path leads beyond them.
use nalgebra::{Point3, Unit, Vector3};

use super::HoleExtractor;
use super::arc_run::{PartArc, Ring};
use super::hole_circles::{EXCESS_SLACK, HoleCircles, PathExcess, distance};
use super::milled::{Engagement, MIN_AXIS_COSINE};
use super::strokes::LEVEL_TOLERANCE;
use super::swept_tool::ring as directions;
use crate::machine::TOUCH_DEPTH;
use gcode_part::{Frustum, MAX_EDGE_BREAK, Taper, exceeds};

/// Number of directions in which the cone of a mill is compared with a pocket.
const CONE_SPOKES: u32 = 64;

impl Engagement {
    /// Returns the circles of one hole among some rings; `None` without a ring, and if their axes differ in direction. A
    /// narrower circle that is no deeper decides nothing, wherever it is.
    pub(super) fn circles(&self, rings: &[&Ring], cutter: Option<f64>) -> Option<HoleCircles> {
        let widest =
            *rings.iter().reduce(|best, ring| if best.radius < ring.radius { ring } else { best })?;
        let out = widest.out;
        if rings.iter().any(|ring| ring.out.dot(&out) <= MIN_AXIS_COSINE) {
            return None;
        }
        let mut order = rings.to_vec();
        order.sort_by(|a, b| a.level().total_cmp(&b.level()).then(b.radius.total_cmp(&a.radius)));
        let mut kept: Vec<Ring> = Vec::new();
        for ring in order {
            match kept.iter_mut().find(|deeper| ring.radius - 0.01 <= deeper.radius) {
                Some(deeper) => {
                    // What has come loose inside a narrower circle is no metal any more.
                    deeper.slug = if deeper.slug < ring.slug { ring.slug } else { deeper.slug };
                    if deeper.radius - 0.01 <= ring.radius {
                        deeper.extend_wall(&ring.with_edges(self.edges));
                    }
                    deeper.cuts.append(&ring.cuts);
                }
                None => kept.push(ring.with_edges(self.edges)),
            }
        }
        let top = rings.iter().map(|ring| ring.top).fold(f64::NEG_INFINITY, f64::max) + LEVEL_TOLERANCE;
        let below: Vec<&Point3<f64>> = self.points.iter().filter(|p| p.coords.dot(&out) <= top).collect();
        let nearest = below.iter().map(|p| distance(p, &widest.centre, &out)).fold(widest.radius, f64::min);
        let is_inside = nearest <= widest.radius / 2.0;
        // A circle that leaves a core may be a groove.
        let slack = EXCESS_SLACK + widest.roundness;
        let reaches_axis = cutter.is_some_and(|cutter| !exceeds(widest.radius, cutter / 2.0 + slack));
        let is_helix = cutter.is_none() && rings.iter().any(|ring| ring.is_helix());
        let excess = self.excess(&widest.centre, &out, widest.radius, top);
        let is_certain = is_inside || reaches_axis || is_helix;
        Some(HoleCircles { rings: kept, widest: widest.clone(), is_certain, excess })
    }

    /// Returns where the path leads farthest beyond a circle, below a height along its axis.
    pub(super) fn excess(
        &self,
        centre: &Point3<f64>,
        out: &Unit<Vector3<f64>>,
        radius: f64,
        top: f64,
    ) -> Option<PathExcess> {
        let ends = self.points.iter().copied();
        let far = ends.chain(self.arcs.iter().filter_map(|arc| arc.farthest_from(centre)));
        let beyond = far.filter(|tip| tip.coords.dot(out) <= top).map(|tip| {
            let depth = distance(&tip, centre, out) - radius;
            (tip, depth)
        });
        let (tip, depth) = beyond.reduce(|best, other| if best.1 < other.1 { other } else { best })?;
        let spoke = tip - centre;
        let outwards = Unit::try_new(spoke - out.into_inner() * spoke.dot(out), 1e-9)?.into_inner();
        (0.0 < depth).then_some(PathExcess { centre: *centre, tip, outwards, depth })
    }
}

impl HoleExtractor<'_> {
    /// Returns the circles of each hole that the engagement mills. A path that leads beyond its circles mills something larger
    /// than a hole, unless nominal holes are at them. The second value is true if circles are left out because pockets hold them.
    pub(super) fn hole_circles(&self) -> (Vec<HoleCircles>, bool) {
        let engagement = &self.engagement;
        let cutter = self.machine.diameter_of(self.setup.tool);
        if engagement.rings.is_empty() || engagement.is_full() {
            return (Vec::new(), false);
        }
        let all: Vec<&Ring> = engagement.rings.iter().filter(|ring| !self.is_in_air(ring, cutter)).collect();
        if all.is_empty() {
            return (Vec::new(), false);
        }
        let is_along_tool =
            |ring: &&Ring| self.pose.axis.as_ref().is_none_or(|axis| MIN_AXIS_COSINE <= axis.dot(&ring.out));
        if !all.iter().all(is_along_tool) {
            return (Vec::new(), false);
        }
        let (threads, rings): (Vec<_>, Vec<_>) =
            all.into_iter().partition(|ring| ring.helix.is_some_and(|helix| helix.is_thread));
        let mut holes = self.bored_holes(rings, cutter);
        let count = holes.len();
        holes.retain(|circles| !self.is_in_pocket(&circles.widest, cutter));
        let has_pocket = holes.len() < count;
        holes.extend(self.thread_turns(threads, cutter));
        (holes, has_pocket)
    }

    /// Returns the turns at nominal threads, and at nominal holes of unknown diameter; a turn along a thread cuts no hole. Of several at
    /// one thread the widest decides how far the path leads beyond them. Without nominal holes those count that cut the wall of a
    /// drilled hole.
    fn thread_turns(&self, turns: Vec<&Ring>, cutter: Option<f64>) -> Vec<HoleCircles> {
        if self.strokes.nominal_axes().is_empty() {
            let is_at_wall = |ring: &&Ring| self.strokes.is_at_drilled_wall(ring, cutter, self.machine);
            let whole = turns
                .into_iter()
                .filter(is_at_wall)
                .filter_map(|ring| self.engagement.circles(&[ring], cutter).filter(HoleCircles::is_whole));
            return whole.collect();
        }
        let entry = |ring: &&Ring| {
            let axis = self.strokes.nominal_of_ring(ring, true)?;
            let may_have_thread = axis.thread.is_some() || axis.radius.is_none() && self.is_hollow(ring);
            (may_have_thread && self.is_at_nominal_wall(ring, cutter)).then_some(axis.entry)
        };
        let turns: Vec<(Point3<f64>, &Ring)> =
            turns.into_iter().filter_map(|ring| Some((entry(&ring)?, ring))).collect();
        let circles = turns.iter().filter_map(|(entry, ring)| {
            let mut circles = self.engagement.circles(&[ring], cutter)?;
            let is_wider = |(other, wide): &(Point3<f64>, &Ring)| other == entry && ring.radius < wide.radius;
            if turns.iter().any(is_wider) {
                circles.excess = None;
            }
            Some(circles)
        });
        circles.collect()
    }

    /// Returns true if feeds have removed the metal inside a circle.
    fn is_hollow(&self, ring: &Ring) -> bool {
        self.metal.uncut(&[ring.centre, ring.centre + ring.out.into_inner() * ring.height()]).is_none()
    }

    /// Returns the circles of each hole among rings that follow no thread.
    fn bored_holes(&self, rings: Vec<&Ring>, cutter: Option<f64>) -> Vec<HoleCircles> {
        let engagement = &self.engagement;
        if let Some(circles) = engagement.circles(&rings, cutter).filter(HoleCircles::is_whole) {
            let is_hole = circles.is_certain || self.is_at_nominal_wall(&circles.widest, cutter);
            return if is_hole { vec![circles] } else { Vec::new() };
        }
        let mut by_hole: Vec<(Point3<f64>, Vec<&Ring>)> = Vec::new();
        for ring in rings {
            let Some(axis) = self.strokes.nominal_of_ring(ring, true) else { continue };
            match by_hole.iter_mut().find(|(entry, _)| *entry == axis.entry) {
                Some((_, rings)) => rings.push(ring),
                None => by_hole.push((axis.entry, vec![ring])),
            }
        }
        let holes = by_hole.iter().filter_map(|(_, rings)| engagement.circles(rings, cutter));
        holes.filter(|circles| self.is_at_nominal_wall(&circles.widest, cutter)).collect()
    }

    /// Returns true if all metal that a circle removes is in a pocket. At a nominal hole that is a groove or a recess which is wider than
    /// the hole, as high as the edges of the mill.
    fn is_in_pocket(&self, ring: &Ring, cutter: Option<f64>) -> bool {
        let radius = ring.radius + cutter.unwrap_or(0.0) / 2.0;
        let mut height = self.metal.removed.height_of_metal(&ring.centre, &ring.out);
        if let Some(axis) = self.strokes.nominal_of_ring(ring, true) {
            let Some(own) = axis.radius.filter(|own| own + MAX_EDGE_BREAK < radius) else { return false };
            if self.tool_body.iter().any(|part| part.is_cutter && 0.0 < part.taper.slope) {
                return self.is_cone_in_pocket(ring, own);
            }
            let edges = self.tool_body.iter().filter(|part| part.is_cutter).map(|part| part.to);
            height = edges.reduce(f64::max).map_or(height, |edges| height.min(edges));
        }
        let up = ring.out.into_inner() * height;
        self.is_round_in_pocket(&[ring.centre, ring.centre + up], &ring.out, radius)
    }

    /// Returns true if the edges of a mill meet nothing of a known body along a circle, above it or beyond it.
    fn is_in_air(&self, ring: &Ring, cutter: Option<f64>) -> bool {
        let Some((body, cutter)) = self.surface.zip(cutter) else { return false };
        let (out, radius) = (ring.out.into_inner(), ring.radius + cutter / 2.0);
        let metal = self.metal.removed.height_of_round(&ring.centre, &out, radius);
        let length = (metal.min(self.engagement.edges) - 2.0 * TOUCH_DEPTH).max(0.0);
        let taper = Taper::cylinder(radius - TOUCH_DEPTH);
        let edges = Frustum { base: ring.centre + out * TOUCH_DEPTH, axis: ring.out, length, taper };
        !body.touches(&edges, &(out * ring.height()))
    }

    /// Returns true if pockets hold all that a pointed mill cuts beside a hole of a radius. A cone that only breaks the edge is
    /// judged with the hole.
    fn is_cone_in_pocket(&self, ring: &Ring, own: f64) -> bool {
        let out = ring.out.into_inner();
        let spokes = directions(&ring.out, &Vector3::zeros(), 1.0, CONE_SPOKES);
        let mut widest = 0.0f64;
        let mut is_inside = true;
        for part in self.tool_body.iter().filter(|part| part.is_cutter) {
            let Taper { slope, .. } = part.taper;
            let wide = |height: f64| ring.radius + part.taper.at(height);
            // Below this height the part is inside the hole.
            let begin = match wide(part.from) < own {
                true if slope == 0.0 => continue,
                true => part.from + (own - wide(part.from)) / slope,
                false => part.from,
            };
            let end = part.to.min(self.metal.removed.height_of_metal(&ring.centre, &ring.out));
            if end <= begin {
                continue;
            }
            widest = widest.max(wide(end));
            is_inside &= spokes.iter().all(|spoke| {
                let line = [begin, end].map(|height| ring.centre + spoke * wide(height) + out * height);
                self.metal.is_in_pocket(&line)
            });
        }
        is_inside && own + MAX_EDGE_BREAK < widest
    }

    /// Returns true if a circle is at a nominal hole and cuts its wall; round it the circle mills something else.
    fn is_at_nominal_wall(&self, ring: &Ring, cutter: Option<f64>) -> bool {
        self.strokes.nominal_of_ring(ring, false).is_some_and(|axis| {
            let gap = axis.radius.zip(cutter).map(|(radius, cutter)| ring.radius - cutter / 2.0 - radius);
            gap.is_none_or(|gap| gap < 0.0)
        })
    }
}

impl PartArc {
    /// Returns the point of the arc's inside that is farthest from the axis through a point; `None` if an end is.
    fn farthest_from(&self, axis: &Point3<f64>) -> Option<Point3<f64>> {
        let across = |v: Vector3<f64>| v - self.out.into_inner() * v.dot(&self.out);
        let (away, spoke) = (across(self.centre - axis), across(self.from - self.centre));
        let turn = gcode_lang::units::Deg::atan2(spoke.cross(&away).dot(&self.out), spoke.dot(&away)).0;
        let along = if self.sweep.0 < 0.0 { -turn } else { turn }.rem_euclid(360.0);
        (1e-9 < away.norm() && along < self.sweep.0.abs()).then(|| self.point(along / self.sweep.0.abs()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gcode_lang::units::Deg;

    /// A half circle of 4 about (3, 0), from (7, 0) over (3, 4) to (-1, 0). From the origin 7 is farthest, at its start; from
    /// (3, -1) it is (3, 4), 5 away.
    #[test]
    fn the_farthest_point_of_an_arc_is_its_inside_or_an_end() {
        let half = PartArc {
            centre: Point3::new(3.0, 0.0, 0.0),
            out: Vector3::z_axis(),
            from: Point3::new(7.0, 0.0, 0.0),
            to: Point3::new(-1.0, 0.0, 0.0),
            sweep: Deg(180.0),
            is_chord: false,
        };
        let far = |arc: &PartArc, y: f64| arc.farthest_from(&Point3::new(3.0, y, 0.0));
        assert!((far(&half, -1.0).unwrap() - Point3::new(3.0, 4.0, 0.0)).norm() < 1e-12);
        assert_eq!(far(&half, 1.0), None, "the lower half is no part of it");
        assert_eq!(far(&half, 0.0), None, "all points are as far");
        let clockwise = PartArc { sweep: Deg(-180.0), ..half };
        assert!((far(&clockwise, 1.0).unwrap() - Point3::new(3.0, -4.0, 0.0)).norm() < 1e-12);
    }
}
