//! Holes of a pin-hole job: the entry is the intersection of the hole's line with the implicit surface.
//!
//! The direction is the gradient of the surface there, or its axis of revolution.
use std::sync::Arc;

use nalgebra::{Point3, Vector3};

use super::hole::Hole;
use super::nominal_axes::NominalAxes;
use super::reference::{ProcessLimits, Reference, ToolProcess};
use super::surface::Surface;
use crate::job::{AxisDirection, HoleSpec, PinHoles, Tool};
use crate::reader::FileError;
use gcode_lang::units::Deg;

/// Returns the nominal holes of a pin-hole job.
///
/// # Errors
/// A hole whose line misses the surface.
pub(super) fn reference(job: &PinHoles) -> Result<Reference, FileError> {
    let surface = Surface::Ellipsoid { a: job.surface.a, b: job.surface.b };
    let holes = job.holes.iter().map(|hole| pin_hole(&surface, hole)).collect::<Result<Vec<_>, _>>()?;
    let process_limits =
        ProcessLimits { hole_axes: Arc::new(NominalAxes::of(&holes)), ..process_limits(job) };
    Ok(Reference {
        holes,
        position: Some(job.tolerance.position),
        depth: Some(job.tolerance.depth),
        surface: Some(surface),
        stock: None,
        process_limits,
        pattern: None,
        open_depths: Vec::new(),
        unread: Vec::new(),
        note: None,
    })
}

fn process_limits(job: &PinHoles) -> ProcessLimits {
    let tool_process = |tool: &Tool| ToolProcess {
        number: tool.number,
        offset: Some(tool.number),
        speed: Some(tool.speed),
        feed: Some(tool.feed),
        peck: tool.peck,
        depth: tool.depth,
    };
    ProcessLimits {
        clearance: Some(job.machine.clearance()),
        approach: job.machine.clearance,
        retract: job.machine.retract,
        rotary: Some(job.machine.rotary),
        clamp: None,
        tools: job.tools.iter().filter(|_| job.are_tools_specified).map(tool_process).collect(),
        ..ProcessLimits::default()
    }
}

/// Returns the hole at the point of the upper half over (r·cos α, r·sin α).
fn pin_hole(surface: &Surface, spec: &HoleSpec) -> Result<Hole, FileError> {
    let azimuth = Deg(spec.azimuth);
    let under = Point3::new(spec.radius * azimuth.cos(), 0.0, spec.radius * azimuth.sin());
    let missed = || FileError {
        line: None,
        message: format!("hole '{}': a line at radius {} misses the surface", spec.id, spec.radius),
    };
    let entry = surface.exit(&under, &Vector3::y_axis()).ok_or_else(missed)?;
    let axis = match spec.axis {
        AxisDirection::Axial => Vector3::y_axis(),
        AxisDirection::Normal => surface.normal(&entry).ok_or_else(missed)?,
    };
    Ok(Hole {
        id: Some(spec.id.clone()),
        entry: entry.coords.into(),
        axis: axis.into_inner().into(),
        depth: spec.depth,
        diameter: Some(spec.diameter),
        ..Hole::default()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spec(radius: f64, azimuth: f64, axis: AxisDirection) -> HoleSpec {
        HoleSpec {
            id: "h".into(),
            radius,
            azimuth,
            axis,
            diameter: 6.0,
            depth: 15.0,
            named_tools: None,
            tools: vec![1],
        }
    }

    fn near(found: [f64; 3], expected: [f64; 3]) {
        let off = found.iter().zip(&expected).map(|(f, e)| (f - e).abs()).fold(0.0, f64::max);
        assert!(off < 1e-9, "{found:?} is not {expected:?}");
    }

    #[test]
    fn at_the_pole_the_normal_is_the_axis() {
        for b in [50.0, 100.0, 300.0] {
            let surface = Surface::Ellipsoid { a: 100.0, b };
            let hole = pin_hole(&surface, &spec(0.0, 77.0, AxisDirection::Normal)).unwrap();
            near(hole.entry, [0.0, b, 0.0]);
            near(hole.axis, [0.0, 1.0, 0.0]);
        }
    }

    #[test]
    fn at_the_equator_the_normal_is_radial() {
        let surface = Surface::Ellipsoid { a: 100.0, b: 60.0 };
        let hole = pin_hole(&surface, &spec(100.0, 450.0, AxisDirection::Normal)).unwrap();
        let off = hole.entry[1].abs().max((hole.entry[2] - 100.0).abs()).max(hole.axis[0].abs());
        assert!(off < 1e-5, "{hole:?}");
        assert!((hole.axis[2] - 1.0).abs() < 1e-9);
    }

    /// a = 5, b = 4: at r = 3 the section's height is 4·4/5 = 3.2, and the normal is the tangent's perpendicular:
    /// the tangent of (5 cos t, 4 sin t) with cos t = 0.6 is (−5·0.8, 4·0.6), so the normal is (2.4, 4).
    #[test]
    fn an_ellipse_worked_by_hand() {
        let surface = Surface::Ellipsoid { a: 5.0, b: 4.0 };
        let hole = pin_hole(&surface, &spec(3.0, -90.0, AxisDirection::Normal)).unwrap();
        near(hole.entry, [0.0, 3.2, -3.0]);
        let size = (2.4f64 * 2.4 + 16.0).sqrt();
        near(hole.axis, [0.0, 4.0 / size, -2.4 / size]);
        let axial = pin_hole(&surface, &spec(3.0, 270.0, AxisDirection::Axial)).unwrap();
        near(axial.entry, [0.0, 3.2, -3.0]);
        near(axial.axis, [0.0, 1.0, 0.0]);
    }

    #[test]
    fn on_a_sphere_the_normal_points_from_the_centre() {
        let surface = Surface::Ellipsoid { a: 500.0, b: 500.0 };
        for (radius, azimuth) in [(1e-6, 10.0), (300.0, -200.0), (485.0, 359.999)] {
            let hole = pin_hole(&surface, &spec(radius, azimuth, AxisDirection::Normal)).unwrap();
            near(hole.axis, hole.entry.map(|v| v / 500.0));
        }
    }
}
