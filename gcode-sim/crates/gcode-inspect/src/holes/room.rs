//! Room of the tool's parts in nominal holes and pockets.
use nalgebra::{Point3, Unit, Vector3};

use super::metal::{KnownMetal, MAX_OFFSET, SIDE_SLACK};
use crate::machine::{TOUCH_DEPTH, ToolPart};
use gcode_part::{Collar, NOISE, Rod, Step, Surface, Taper};

impl KnownMetal {
    /// Returns true if a part of the tool stays in one nominal hole, or in one pocket but for `slack`, while the tip moves between two
    /// points.
    pub(super) fn is_allowed(
        &self,
        tips: &[Point3<f64>; 2],
        axis: &Unit<Vector3<f64>>,
        part: &ToolPart,
        slack: f64,
    ) -> bool {
        let base = tips.map(|tip| tip + axis.into_inner() * part.from);
        let height = base
            .map(|p| self.removed.height_of_round(&p, axis, part.radius()))
            .into_iter()
            .fold(0.0, f64::max);
        let is_in_box = self.pockets.iter().any(|pocket| {
            let radius = part.radius();
            let (min, max) = match pocket {
                Surface::Block { min, max } => (min, max),
                Surface::Rod(rod) => {
                    return self.is_in_rod(rod, &base, axis.into_inner() * height, (radius, slack));
                }
                Surface::Ellipsoid { .. } | Surface::Cylinder { .. } => return false,
            };
            let across = axis.map(|along| radius * (1.0 - along * along).max(0.0).sqrt() - slack);
            let up = axis.into_inner() * height;
            let (low, high) = (base[0].inf(&base[1]) - across, base[0].sup(&base[1]) + across);
            (0..3).all(|i| {
                let (low, high) = (low[i] + up[i].min(0.0), high[i] + up[i].max(0.0));
                min[i] <= low && high <= max[i] + if up[i] > 0.0 { TOUCH_DEPTH } else { 0.0 }
            })
        });
        is_in_box || self.hole_around(&base, axis, part).is_some()
    }

    /// Returns true if a cylinder about the tool, as high as `up`, is in a round pocket wherever there is metal. The tool stands along the
    /// pocket, or across a round body that the pocket holds between its ends.
    fn is_in_rod(
        &self,
        pocket: &Rod,
        base: &[Point3<f64>; 2],
        up: Vector3<f64>,
        (radius, slack): (f64, f64),
    ) -> bool {
        let out = pocket.axis.into_inner();
        let from_axis = |p: &Point3<f64>| {
            let from_base = p - pocket.base;
            (from_base - out * from_base.dot(&out)).norm()
        };
        let rise = up.dot(&out);
        let slope = rise / up.norm();
        let across = radius * (1.0 - slope * slope).max(0.0).sqrt();
        let is_along = up.cross(&out).norm() <= NOISE * up.norm();
        let is_held = match self.body {
            _ if is_along => base.iter().all(|p| from_axis(p) + radius - slack <= pocket.radius),
            Some(Surface::Rod(body)) => {
                let is_parallel = body.axis.cross(&out).norm() <= NOISE;
                is_parallel && from_axis(&body.base) + body.radius <= pocket.radius + NOISE
            }
            _ => false,
        };
        let height = |p: &Point3<f64>| (p - pocket.base).dot(&out);
        is_held
            && base.iter().all(|p| {
                let (low, high) = (height(p) - across + rise.min(0.0), height(p) + across + rise.max(0.0));
                -slack <= low && high <= pocket.length + slack
            })
    }

    /// Returns the nominal hole on whose axis the tip makes a stroke.
    pub(super) fn hole_of_stroke(
        &self,
        tips: &[Point3<f64>; 2],
        axis: &Unit<Vector3<f64>>,
    ) -> Option<&Collar> {
        let line = ToolPart::flutes(0.0, f64::INFINITY, 0.0);
        self.hole_around(tips, axis, &line)
            .filter(|hole| tips.iter().all(|tip| hole.from_axis(tip) <= MAX_OFFSET))
    }

    /// Returns the nominal hole in which a part of the tool stays while its lower end moves between two points.
    fn hole_around(
        &self,
        ends: &[Point3<f64>; 2],
        axis: &Unit<Vector3<f64>>,
        part: &ToolPart,
    ) -> Option<&Collar> {
        let mut found = None;
        self.around(ends, &mut |collar| {
            let aside = ends.iter().map(|p| collar.from_axis(p)).fold(0.0, f64::max);
            let deepest = ends.iter().map(|p| collar.depth(p)).fold(0.0, f64::max);
            // Widths change evenly: those at the entry and at the lower end decide.
            let is_in_step = |step: &Step| {
                let is_in = |depth: f64| {
                    let width = part.taper.at((part.from + deepest - depth).min(part.to.max(part.from)));
                    let room =
                        if collar.has_diameter { step.radius(depth) + SIDE_SLACK - width } else { width };
                    aside <= room
                };
                deepest <= step.max_depth + TOUCH_DEPTH && is_in(0.0) && is_in(deepest)
            };
            let is_in_edge = collar.edge_break(part.taper.slope).is_some_and(|edge| {
                let radius = edge.taper.radius - SIDE_SLACK;
                aside < TOUCH_DEPTH
                    && is_in_step(&Step { taper: Taper::cylinder(radius), max_depth: collar.max_depth() })
            });
            if collar.is_parallel(axis) && (is_in_edge || collar.steps.iter().any(is_in_step)) {
                found = Some(collar);
            }
        });
        found
    }
}
