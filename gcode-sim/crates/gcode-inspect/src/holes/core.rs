//! Core of a milled hole: metal inside the circle of the mill that no tool has removed.
use nalgebra::{Point3, Unit, Vector3};

use super::HoleExtractor;
use super::group::{DrilledHole, PassCut};
use super::tool_lines::rim;

/// Largest height of a core on the bottom of a hole that counts as removed, mm.
const MAX_CORE_HEIGHT: f64 = 0.1;

/// Distance of the outermost line from the mill's inner edge, mm.
const EDGE: f64 = 0.02;

/// Number of circles of lines inside the mill's inner edge.
const RINGS: u32 = 6;

impl HoleExtractor<'_> {
    /// Finds the core of each milled circle.
    pub(super) fn find_cores(&self, holes: &mut [DrilledHole]) {
        for hole in holes {
            let diameter = self.machine.diameter_of(hole.tool);
            self.find_core(&mut hole.finishing_cut, &hole.axis, diameter);
            for pass in &mut hole.earlier_passes {
                let diameter = self.machine.diameter_of(pass.tool);
                self.find_core(&mut pass.cut, &pass.axis, diameter);
            }
        }
    }

    /// Finds the core that a mill of this diameter leaves; one of unknown diameter is taken to leave none.
    fn find_core(&self, cut: &mut PassCut, axis: &Unit<Vector3<f64>>, diameter: Option<f64>) {
        let Some((circle, diameter)) = cut.milled.as_mut().zip(diameter) else { return };
        let inner = circle.radius - diameter / 2.0;
        if inner <= EDGE {
            return;
        }
        let out = axis.into_inner();
        let bottom = cut.bottom + out * MAX_CORE_HEIGHT;
        let top = cut.bottom + out * self.metal.removed.height_of_metal(&cut.bottom, &out);
        let is_left = |radius: f64| {
            let lines = rim(axis, &Vector3::zeros(), radius).into_iter();
            let mut lines = lines.map(|offset| [bottom + offset, top + offset]);
            lines.any(|line: [Point3<f64>; 2]| self.metal.uncut(&line, &|_| false).is_some())
        };
        let radius = |ring: u32| (inner - EDGE) * f64::from(ring) / f64::from(RINGS);
        let left = (1..=RINGS).rev().find(|ring| is_left(radius(*ring)));
        circle.core = left.map(|ring| 2.0 * if ring == RINGS { inner } else { radius(ring) });
    }
}
