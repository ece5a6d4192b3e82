//! Passes that a wider tool swallows: all that they cut lies in what it cuts, wherever their axes are.
use super::drill_pass::{DrillPass, PassCut};
use crate::machine::{Machine, PointShape, Tool};
use gcode_lang::units::Deg;
use gcode_part::{NOISE, PARALLEL_COSINE, PointTree};
use nalgebra::{Point3, Vector3};

/// Cylinder with a conical end that a pass cuts.
#[derive(Clone, Copy, Debug)]
pub(super) struct CutEnd {
    radius: f64,
    /// Height of the cone's edge above its tip per mm of radius; 0 of a flat end.
    rise: f64,
}

impl CutEnd {
    /// Returns the end of a pass of a tool; `None` if its diameter is unknown.
    pub(super) fn of(
        tool: Option<u32>,
        diameter: Option<f64>,
        cut: &PassCut,
        machine: &Machine,
    ) -> Option<Self> {
        let radius = diameter? / 2.0;
        let tool = tool.and_then(|number| machine.find_tool(number));
        let point = match tool.map_or(PointShape::Unknown, Tool::point) {
            _ if cut.milled.is_some() => PointShape::Flat,
            PointShape::Unknown => PointShape::DRILL,
            point => point,
        };
        let rise = match point {
            PointShape::Pointed(angle) => 1.0 / Deg(angle.0 / 2.0).tan(),
            PointShape::Flat | PointShape::Unknown => 0.0,
        };
        Some(Self { radius, rise })
    }

    /// Returns true if a narrower end lies in this one. Its axis is `aside` from this axis, its tip `above` this tip.
    pub(super) fn contains(&self, other: &Self, aside: f64, above: f64) -> bool {
        let is_within = other.radius < self.radius - NOISE && aside + other.radius <= self.radius + NOISE;
        // Both ends are straight along the radius: their tip and their edge decide.
        let tip = self.rise * aside <= above + NOISE;
        let edge = self.rise * (aside + other.radius) <= above + other.rise * other.radius + NOISE;
        is_within && tip && edge
    }
}

/// Returns for each pass the nearest wider one that swallows it; `None` without one.
pub(super) fn swallowing_passes(
    passes: &[DrillPass],
    tree: &PointTree,
    machine: &Machine,
) -> Vec<Option<usize>> {
    // Most passes are cut by the tool of the one before.
    let mut last: Option<(Option<u32>, Option<CutEnd>)> = None;
    let end = |pass: &DrillPass| match last {
        Some((tool, end)) if tool == pass.tool && pass.cut.milled.is_none() => end,
        _ => {
            let end = CutEnd::of(pass.tool, pass.diameter(machine), &pass.cut, machine);
            last = pass.cut.milled.is_none().then_some((pass.tool, end));
            end
        }
    };
    let ends: Vec<Option<CutEnd>> = passes.iter().map(end).collect();
    let narrowest = ends.iter().flatten().map(|end| end.radius).fold(f64::INFINITY, f64::min);
    let mut nearest: Vec<Option<(f64, usize)>> = vec![None; passes.len()];
    for (index, (pass, end)) in passes.iter().zip(&ends).enumerate() {
        let Some(end) = end.as_ref().filter(|end| narrowest < end.radius - NOISE) else { continue };
        let margin = Vector3::repeat(end.radius - narrowest);
        let (low, high) =
            (pass.cut.start.inf(&pass.cut.bottom) - margin, pass.cut.start.sup(&pass.cut.bottom) + margin);
        tree.in_box(&low, &high, &mut |other| {
            let (narrow, axis) = (&passes[other], &pass.axis);
            if narrow.axis.dot(axis) < PARALLEL_COSINE {
                return;
            }
            let from_axis = |point: &Point3<f64>| {
                let to = point - pass.cut.bottom;
                (to - axis.into_inner() * to.dot(axis)).norm()
            };
            let aside = from_axis(&narrow.cut.bottom).max(from_axis(&narrow.cut.start));
            let above = (narrow.cut.bottom - pass.cut.bottom).dot(axis);
            let is_inside = ends[other].as_ref().is_some_and(|narrow| end.contains(narrow, aside, above));
            if is_inside && nearest[other].is_none_or(|(least, _)| aside < least) {
                nearest[other] = Some((aside, index));
            }
        });
    }
    nearest.into_iter().map(|nearest| nearest.map(|(_, index)| index)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A pilot Φ4, 3 mm beside a drill Φ12 that goes 2 mm deeper, both of 118°. At 5 mm from the axis the drill's cone is
    /// 5/tan 59° = 3.004 above its tip, the pilot's edge 2 + 2/tan 59° = 3.202.
    #[test]
    fn a_pilot_aside_lies_in_the_cone_of_the_drill() {
        let rise = 1.0 / Deg(59.0).tan();
        let end = |diameter: f64| CutEnd { radius: diameter / 2.0, rise };
        let (pilot, drill) = (end(4.0), end(12.0));
        assert!(drill.contains(&pilot, 3.0, 2.0));
        assert!(!drill.contains(&pilot, 3.0, 1.8), "the pilot's edge is at 3.002");
        assert!(!drill.contains(&pilot, 3.0, 1.802), "3.004 is 3.0043");
        assert!(drill.contains(&pilot, 3.0, 1.803));
        assert!(
            drill.contains(&pilot, 4.0, 2.5) && !drill.contains(&pilot, 4.001, 2.5),
            "4 + 2 reaches the wall"
        );
        assert!(!drill.contains(&drill, 0.0, 0.0), "the same diameter is no pilot");
        let flat = CutEnd { rise: 0.0, ..end(4.0) };
        assert!(!drill.contains(&flat, 3.0, 3.0) && drill.contains(&flat, 3.0, 3.005), "a flat pilot");
    }
}
