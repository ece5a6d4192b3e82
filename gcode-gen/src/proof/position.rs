//! Position of a pin hole over a box: how far its axis can be from the one that the part's geometry asks for.
//!
//! In the plane of the head the tool's tip ends at T = P − Q·d, P the pivot and d = (cos θ, sin θ) the head's direction; the axis
//! of the hole is the line through T along d. With C = T + D·d, the point of the axis above the bottom, the nominal entry
//! E = (r, y) on the surface F = r²/a² + y²/b² − 1 = 0 and its normal n ∝ ∇F, the axis passes E and E − D·n within
//! |C − E|·(1 + tan τ) + D·tan τ, τ the angle between d and n. C − E is the rounding of the words and what the formulas differ
//! by; τ that of the head's angle. The rotary turns both about y by its own error β: up to β·max(r, D) out of the plane, and
//! less than its square times that in it.
use gcode_enclosure::{Binary, Condition, Enclosures, Node, NodeId};
use gcode_part::job::AxisDirection;
use gcode_prove::{ExactForms, Polynomial};

use super::hole_path::HolePath;
use super::rapids::{self, Edge, Tip};

/// Bound of the error of a computed sine or cosine: the function's, and that of the conversion to radians of up to 720°.
const TRIGONOMETRY: f64 = 1e-13;

/// What a control that sets small residues of SIN and COS to 0 loses.
const RESIDUE: f64 = 1e-8;

/// Bound of the error of a computed direction, degrees.
const DIRECTION: f64 = 1e-11;

/// Magnitude of products that are errors, mm.
const SMALL: f64 = 1e-8;

/// Distance for the arithmetic of a clearance's bound, mm.
const SMALL_DISTANCE: f64 = 1e-5;

/// Margin for the rounding of a bound's own arithmetic.
const MARGIN: f64 = 1.0 + 1e-9;

/// Nominal hole, with its quantities as inputs.
#[derive(Clone, Copy, Debug)]
pub(super) struct NominalHole {
    pub(super) a: NodeId,
    pub(super) b: NodeId,
    pub(super) radius: NodeId,
    pub(super) azimuth: NodeId,
    pub(super) depth: NodeId,
    pub(super) axis: AxisDirection,
    /// From the pivot to the tip.
    pub(super) reach: f64,
    /// Half the diameter of the tool.
    pub(super) tool_radius: f64,
    /// Clearance and retract above the hole.
    pub(super) heights: [f64; 2],
    /// Sign of the rotary.
    pub(super) sign: f64,
}

/// Bounds over a box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PositionBound {
    /// Diameter of the zone that has the axis, mm.
    pub(super) phi: f64,
    /// Error of the depth, mm.
    pub(super) depth: f64,
    /// Distance of the tip from the surface at the nearest end of a rapid, mm; `None` if the rapids aren't known to stay outside.
    pub(super) clearance: Option<f64>,
}

/// Returns the bounds of a hole over the box of enclosures; `None` if none is found.
pub(super) fn bound(
    arena: &gcode_enclosure::Arena,
    enclosures: &mut Enclosures,
    path: &HolePath,
    hole: &NominalHole,
    zeroes_residues: bool,
    conditions: &[Condition],
) -> Option<PositionBound> {
    let [radius, depth, polar_radius] =
        [hole.radius, hole.depth, hole.b].map(|node| enclosures.enclose(arena, node).magnitude());
    let angle = enclosures.enclose(arena, path.angle);
    if angle.magnitude() > 720.0 {
        return None;
    }
    let mut forms = ExactForms::new(arena, enclosures);
    let [a, b, r, w, d] = [hole.a, hole.b, hole.radius, hole.azimuth, hole.depth]
        .map(|node| Polynomial::atom(gcode_prove::Atom::Node(node)));
    let (over_a, over_b) = (forms.inverse(&a)?, forms.inverse(&b)?);

    // C − E: the words' rounding, and the difference of the formulas.
    let [x, y, cosine, sine] = [path.x, path.y, path.cosine, path.sine].map(|node| forms.form(node).real);
    let reach = hole.reach;
    let (aside, lost_x) =
        forms.combine(&[(1.0, &[&x]), (-reach, &[&cosine]), (1.0, &[&d, &cosine]), (-1.0, &[&r])])?;
    let (height, lost_y) = forms.combine(&[(1.0, &[&y]), (-reach, &[&sine]), (1.0, &[&d, &sine])])?;
    let of_functions = TRIGONOMETRY + if zeroes_residues { RESIDUE } else { 0.0 };
    // Factors such as a reach that a word's scale rounds leave a rest, which is an error like any other.
    let (height, rest) = forms.without_small(&height, SMALL);
    let lost_y = lost_y + rest;
    let levers = (reach.abs() + depth) * of_functions;
    let off_x = forms.error(path.x) + forms.magnitude(&aside) + lost_x + levers;
    let off_y = forms.error(path.y) + lost_y + levers;
    // F at C, moved onto the nominal radius: 0, or the entry is higher or lower by no more than b·√|F|.
    let (value, lost) = forms.combine(&[
        (1.0, &[&r, &r, &over_a, &over_a]),
        (1.0, &[&height, &height, &over_b, &over_b]),
        (-1.0, &[]),
    ])?;
    if !forms.is_nonnegative(&height) {
        return None;
    }
    let is_on_surface = value.is_zero() && lost == 0.0;
    let value = forms.magnitude(&value) + lost;
    let raised = polar_radius * libm::sqrt(value) * MARGIN;

    // τ, in degrees.
    let form = forms.form(path.angle);
    let tilt = match (hole.axis, form.real.as_constant(), form.real.as_node()) {
        (AxisDirection::Axial, Some(constant), _) => (constant - 90.0).abs() * MARGIN,
        (AxisDirection::Normal, _, Some(direction)) if is_on_surface => {
            let Node::Binary(Binary::Atan, up, out) = arena.node(direction) else { return None };
            // ∇F ∝ (r/a², y/b²), y the nominal height.
            let (along_x, along_y) = (forms.form(out), forms.form(up));
            let gradient = [
                forms.combine(&[(1.0, &[&r, &over_a, &over_a])])?,
                forms.combine(&[(1.0, &[&height, &over_b, &over_b])])?,
            ];
            let (cross, lost) = forms.combine(&[
                (1.0, &[&along_x.real, &gradient[1].0]),
                (-1.0, &[&along_y.real, &gradient[0].0]),
            ])?;
            let is_parallel = cross.is_zero() && lost == 0.0 && gradient.iter().all(|(_, lost)| *lost == 0.0);
            let has_one_sense = [&along_x.real, &along_y.real, &gradient[0].0, &gradient[1].0]
                .into_iter()
                .all(|part| forms.is_nonnegative(part));
            if !is_parallel || !has_one_sense {
                return None;
            }
            // Relative errors turn it by half their sum at most, absolute ones by their share of its length.
            let length = forms.magnitudes(out).0.max(forms.magnitudes(up).0);
            if length <= 0.0 {
                return None;
            }
            let turned = (along_x.relative + along_y.relative) / 2.0
                + (along_x.absolute + along_y.absolute) / (length * (1.0 - 1e-3));
            turned.to_degrees() * 1.01 + DIRECTION
        }
        _ => return None,
    };
    let tilt = ((tilt + forms.error(path.angle)).to_radians()) * MARGIN;

    // β, in degrees.
    let rotary = forms.form(path.rotary).real;
    let (turned, lost) = forms.combine(&[(hole.sign, &[&rotary]), (-1.0, &[&w])])?;
    let turn = forms.magnitude(&turned) + lost + forms.error(path.rotary);
    let turn = turn.to_radians() * MARGIN;
    if !(tilt < 0.1 && turn < 0.1) {
        return None;
    }
    let tangent = libm::tan(tilt) * MARGIN;
    let across = libm::hypot(off_x, off_y) + raised;
    let in_plane = across * (1.0 + tangent) + depth * tangent;
    let lever = radius.max(depth) + in_plane;
    let second_order = lever * turn * turn;
    let off = libm::hypot(in_plane + second_order, lever * turn) + second_order;
    let phi = 2.0 * off * MARGIN;
    let depth_error = (across + depth * tilt * tilt / 2.0 + second_order) * MARGIN;
    let edge = match hole.axis {
        AxisDirection::Normal => Some(None),
        AxisDirection::Axial => edge(&mut forms, hole).map(Some),
    };
    let clearance = edge.and_then(|edge| {
        let (directions, inverses) = ([&cosine, &sine], [&over_a, &over_b]);
        let tip = Tip { radius: &r, height: &height, top: &b, inverses, edge, directions, reach };
        let along = rapids::clearance(&mut forms, path, &tip, conditions)?;
        // The tool's end is a disc, which dips where the tool is tilted.
        Some(along * (1.0 - tilt * tilt) - hole.tool_radius * tangent - levers - SMALL_DISTANCE)
    });
    phi.is_finite().then_some(PositionBound { phi, depth: depth_error, clearance })
}

/// Returns the edge of an axial tool next to the axis; `None` where a box has radii on both sides of the tool's.
fn edge(forms: &mut ExactForms<'_>, hole: &NominalHole) -> Option<Edge> {
    let (least, most) = forms.magnitudes(hole.radius);
    let radius = if least >= hole.tool_radius {
        let radius = Polynomial::atom(gcode_prove::Atom::Node(hole.radius));
        let (edge, lost) = forms.combine(&[(1.0, &[&radius]), (-hole.tool_radius, &[])])?;
        (lost == 0.0).then_some(edge)?
    } else if most <= hole.tool_radius {
        Polynomial::default()
    } else {
        return None;
    };
    let (_, b) = forms.magnitudes(hole.b);
    let (a, _) = forms.magnitudes(hole.a);
    Some(Edge { radius, heights: hole.heights, steepness: b / libm::sqrt(a) * MARGIN, top: b })
}
