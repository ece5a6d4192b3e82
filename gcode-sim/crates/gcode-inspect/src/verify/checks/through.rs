//! A wanted hole deeper than the part is thick along its axis goes through: the drawing may mean that, so it is told and
//! leaves the verdict alone. The part may be thinner than its surface says, a shell or cut off, so silence is no proof.
use nalgebra::{Point3, Unit, Vector3};

use super::{HoleFinding, HoleInspection};
use crate::findings::HOLE_THROUGH;
use crate::verify::hole_finding::folded_note;
use gcode_lang::diag::Diagnostic;
use gcode_part::Hole;
use gcode_part::Surface;

/// Fewer holes are told one by one.
const MIN_HOLES: usize = 3;

pub(super) fn check(inspection: &HoleInspection<'_>, objections: &mut Vec<HoleFinding>) {
    let comparison = &inspection.comparison;
    let Some(surface) = inspection.reference.surface else { return };
    let thin = |(wanted, hole): (usize, &Hole)| {
        // What ends inside the part doesn't go through: how thick it is there needn't be asked.
        if surface.value(&end(hole)) < 0.0 {
            return None;
        }
        let thick = thickness(&surface, hole);
        (thick < hole.depth).then_some((wanted, thick))
    };
    let through: Vec<(usize, f64)> = comparison.nominal.iter().enumerate().filter_map(thin).collect();
    let sentence = |which: &str, wanted: usize, thick: f64| {
        let depth = comparison.nominal[wanted].depth;
        let message =
            format!("{which} through: {depth} mm deep, the part is {thick:.1} mm thick along its axis");
        Diagnostic::new(&HOLE_THROUGH, message)
            .help("check depth, radius and direction, unless the drawing specifies a through hole")
    };
    let many = MIN_HOLES <= through.len();
    if let Some((wanted, thick)) = through.first().filter(|_| many) {
        let (count, all, id) = (through.len(), comparison.nominal.len(), comparison.id(*wanted));
        let mut finding =
            sentence(&format!("{count} of {all} holes go through; the first, {id}, goes"), *wanted, *thick);
        finding.notes.extend(folded_note(count));
        objections.push(HoleFinding::unlocated(finding));
    }
    objections.extend(through.into_iter().map(|(wanted, thick)| {
        let finding = sentence(&format!("hole {} goes", comparison.id(wanted)), wanted, thick);
        HoleFinding { is_folded: many, ..HoleFinding::of_nominal(wanted, finding) }
    }));
}

fn end(hole: &Hole) -> Point3<f64> {
    Point3::from(hole.entry) - Vector3::from(hole.axis) * hole.depth
}

/// From the entry, along the axis, to the far side; 0 where the axis only touches the part.
fn thickness(surface: &Surface, hole: &Hole) -> f64 {
    let entry = Point3::from(hole.entry);
    let into = Unit::new_normalize(-Vector3::from(hole.axis));
    surface.exit(&entry, &into).map_or(0.0, |far| (far - entry).dot(&into).max(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn thick(surface: Surface, entry: [f64; 3], axis: [f64; 3]) -> f64 {
        thickness(&surface, &Hole { id: None, entry, axis, depth: 1.0, diameter: None, from: None })
    }

    /// (16/20)² + (7.2/12)² = 1. Parallel to y the far side is at −7.2. The normal there is (16/400, 7.2/144) =
    /// (0.04, 0.05), so n = (4, 5)/√41, and the chord is 2·(p·M·n)/(n·M·n) with M = (1/400, 1/144):
    /// 2·(0.41/√41)/((16/400 + 25/144)/41) = 24.580.
    #[test]
    fn an_ellipse_worked_by_hand() {
        let surface = Surface::Ellipsoid { a: 20.0, b: 12.0 };
        let s = 41f64.sqrt();
        for sign in [1.0, -1.0] {
            let entry = [0.0, 7.2, 16.0 * sign];
            assert!((thick(surface, entry, [0.0, 1.0, 0.0]) - 14.4).abs() < 1e-9);
            let normal = thick(surface, entry, [0.0, 5.0 / s, 4.0 * sign / s]);
            assert!((normal - 24.580).abs() < 1e-3, "{normal}");
        }
        assert!((thick(surface, [0.0, 12.0, 0.0], [0.0, 1.0, 0.0]) - 24.0).abs() < 1e-9);
    }

    #[test]
    fn on_the_rim_there_is_nothing_to_drill_and_a_cylinder_is_as_thick_as_its_diameter() {
        let surface = Surface::Ellipsoid { a: 20.0, b: 12.0 };
        assert!(thick(surface, [20.0, 0.0, 0.0], [0.0, 1.0, 0.0]) < 1e-5);
        let cylinder = Surface::Cylinder { radius: 30.0 };
        assert!((thick(cylinder, [5.0, 0.0, -30.0], [0.0, 0.0, -1.0]) - 60.0).abs() < 1e-9);
    }
}
