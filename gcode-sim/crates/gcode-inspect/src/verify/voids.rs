//! Cylindrical voids of the stock on the axis of a nominal hole: a tool that only widens or threads a hole works in them as in what
//! was cut before.
use nalgebra::{Point3, Unit, Vector3};

use super::Tolerances;
use super::followers::MIN_ALIKE_COSINE;
use super::hole_cuts::Cut;
use crate::holes::{PassCut, ToolPass};
use crate::machine::{PointShape, TOUCH_DEPTH};
use gcode_lang::motion::Backtrace;
use gcode_part::{Hole, MAX_BREAK_THROUGH, Surface, exceeds};

/// What is known of the stock before the program runs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Blank<'a> {
    /// Stock, or the surface of the part; `None` if neither is known.
    pub body: Option<Surface>,
    /// Stated pockets and voids.
    pub openings: &'a [Surface],
    pub voids: &'a [Surface],
}

impl<'a> Cut<'a> {
    /// Returns the voids on the axis of a hole that are open at its entry, as cuts at a block.
    pub(super) fn of_voids(
        nominal: &Hole,
        blank: Blank<'a>,
        tolerances: Tolerances,
        backtrace: &'a Backtrace,
    ) -> Vec<Self> {
        let (entry, axis) = (Point3::from(nominal.entry), Unit::new_normalize(Vector3::from(nominal.axis)));
        let depth = |p: &Point3<f64>| (entry - p).dot(&axis);
        let of_void = |void: &Surface| {
            let Surface::Rod(rod) = void else { return None };
            let ends = [rod.base, rod.base + rod.axis.into_inner() * rod.length];
            let [top, bottom] = if depth(&ends[0]) < depth(&ends[1]) { ends } else { [ends[1], ends[0]] };
            let aside = (top - entry) + axis.into_inner() * depth(&top);
            let is_on_axis =
                MIN_ALIKE_COSINE < rod.axis.dot(&axis).abs() && aside.norm() <= tolerances.position;
            if !is_on_axis || exceeds(depth(&top), tolerances.depth) {
                return None;
            }
            // Behind a void that comes out of the stock there is air.
            let is_through = blank.body.is_some_and(|body| body.depth(&bottom) <= TOUCH_DEPTH);
            let air = if is_through { axis.into_inner() * MAX_BREAK_THROUGH } else { Vector3::zeros() };
            let cut = PassCut::new(top, bottom - air);
            let pass = ToolPass { tool: None, diameter: Some(2.0 * rod.radius), axis, cut, backtrace };
            let (start, tip, point) = (depth(&top), depth(&cut.bottom), PointShape::Flat);
            let (kind, hand, thread, mill) = (None, None, None, None);
            let (is_void, may_be_cone) = (true, false);
            Some(Self { pass, start, tip, kind, hand, point, thread, is_void, may_be_cone, mill })
        };
        blank.voids.iter().filter_map(of_void).collect()
    }

    /// Returns true if a void leaves another cut metal all round.
    pub(super) fn is_void_within(&self, other: &Self) -> bool {
        let widths = self.pass.diameter.zip(other.pass.diameter);
        self.is_void && widths.is_none_or(|(own, other)| own < other)
    }
}
