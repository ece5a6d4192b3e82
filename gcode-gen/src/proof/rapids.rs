//! Rapid moves beside a hole: outwards first, then between points above the hole.
//!
//! The tool starts clear of the part, in the plane Z0, its tip at X and Y from 0 on. A move on which neither X nor Y falls leads
//! away, whatever path the axes take: no point of the part is beyond a point outside in both. The head turns only where its pivot
//! is so high that the tip is above the part at any angle. A move between two points above the hole has no point below the nearer
//! one in either coordinate. Above a hole along the normal these are E + c·d and E + v·d with 0 ≤ c ≤ v: the surface lies below
//! its tangent plane at the entry E, so that the tip is c away, less the rounding. Above an axial hole the metal under the tool
//! is highest at the edge next to the axis, e = max(r − D/2, 0): a tip at y(e) + c is c above it; where rounding moves it by δ
//! towards the axis the surface is higher by no more than b·√(2δ/a), as y(e − δ)² ≤ y(e)² + 2·b²·δ/a.
use gcode_enclosure::{Condition, NodeId, Relation};
use gcode_prove::{ExactForms, Polynomial};

use super::hole_path::{HolePath, Passage};

/// Real numbers of the tip over the entry.
pub(super) struct Tip<'a> {
    pub(super) radius: &'a Polynomial,
    pub(super) height: &'a Polynomial,
    /// Polar radius of the part, and the inverses of both.
    pub(super) top: &'a Polynomial,
    pub(super) inverses: [&'a Polynomial; 2],
    /// Where the tool is nearest to the axis, above an axial hole; `None` above one along the normal.
    pub(super) edge: Option<Edge>,
    /// Cosine and sine of the head's angle.
    pub(super) directions: [&'a Polynomial; 2],
    pub(super) reach: f64,
}

/// Edge of an axial tool.
pub(super) struct Edge {
    /// Its distance from the axis.
    pub(super) radius: Polynomial,
    /// Distances above the metal at which a rapid may begin or end.
    pub(super) heights: [f64; 2],
    /// Bound of b·√(1/a) over the box.
    pub(super) steepness: f64,
    /// Largest polar radius.
    pub(super) top: f64,
}

/// Largest fall of a coordinate that is rounding: two words, each half of the coarsest increment.
const LARGEST_FALL: f64 = 0.0105;

/// Fall of real numbers that is the arithmetic of bounds.
const SMALL: f64 = 1e-6;

/// Magnitude of products that are the arithmetic of bounds.
const SMALL_PRODUCT: f64 = 1e-8;

/// Returns the least distance from the surface of the tip's nearest end of a rapid above the hole; `None` if a rapid isn't known
/// to stay outside.
pub(super) fn clearance(
    forms: &mut ExactForms<'_>,
    path: &HolePath,
    tip: &Tip<'_>,
    conditions: &[Condition],
) -> Option<f64> {
    let mut least = f64::INFINITY;
    let mut is_outward_so_far = true;
    for passage in path.passages.as_ref()? {
        let (from, to) = match *passage {
            Passage::Rapid { from, to } => (from, to),
            Passage::HeadTurn { at: [_, y] } if is_outward_so_far && is_above(forms, y, tip, conditions) => {
                continue;
            }
            Passage::HeadTurn { .. } => return None,
        };
        let outward = fall(forms, from, to, conditions);
        if outward.is_some() && is_outward_so_far {
            continue;
        }
        is_outward_so_far = false;
        let (nearest, fallen) = match outward {
            Some(fallen) => (from, fallen),
            None => (to, fall(forms, to, from, conditions)?),
        };
        let rounding = nearest.map(|coordinate| forms.error(coordinate));
        let distance = match &tip.edge {
            None => along_hole(forms, nearest, tip)?,
            Some(edge) => above_edge(forms, nearest, tip, edge)?,
        };
        least = least.min(distance - fallen - libm::hypot(rounding[0], rounding[1]));
    }
    least.is_finite().then_some(least)
}

/// Returns by how much the coordinates fall from one point to another where that is rounding alone; `None` if one falls by more.
fn fall(
    forms: &mut ExactForms<'_>,
    from: [NodeId; 2],
    to: [NodeId; 2],
    conditions: &[Condition],
) -> Option<f64> {
    let mut falls = [0.0; 2];
    for axis in 0..2 {
        let (from, to) = (from[axis], to[axis]);
        if from == to {
            continue;
        }
        let (before, after) = (forms.form(from).real, forms.form(to).real);
        let error = forms.error(from) + forms.error(to);
        // A condition of the way may say so.
        let said = conditions.iter().find(|condition| {
            matches!(condition.relation, Relation::Lt | Relation::Le)
                && condition.left == from
                && forms.form(condition.right).real == after
        });
        falls[axis] = match said {
            Some(condition) => forms.error(condition.right) + forms.error(to),
            None => {
                let (difference, lost) = forms.combine(&[(1.0, &[&after]), (-1.0, &[&before])])?;
                (lost - forms.least(&difference)).max(0.0) + error
            }
        };
    }
    let fall = libm::hypot(falls[0], falls[1]);
    falls.into_iter().all(|fall| fall <= LARGEST_FALL).then_some(fall)
}

/// Returns true if the tip is above the part at any angle of the head, whose pivot is at a height.
fn is_above(forms: &mut ExactForms<'_>, y: NodeId, tip: &Tip<'_>, conditions: &[Condition]) -> bool {
    let reach = Polynomial::constant(-tip.reach);
    let is_above = |node: NodeId| {
        let height = forms.form(node).real;
        let above = forms.combine(&[(1.0, &[&height]), (1.0, &[&reach]), (-1.0, &[tip.top])]);
        above.is_some_and(|(above, lost)| forms.least(&above) - lost - forms.error(node) >= 0.0)
    };
    let lower = conditions.iter().filter_map(|condition| match condition.relation {
        Relation::Ge | Relation::Gt if condition.left == y => Some(condition.right),
        Relation::Le | Relation::Lt if condition.right == y => Some(condition.left),
        _ => None,
    });
    std::iter::once(y).chain(lower).any(is_above)
}

/// Returns the distance of a point above the entry along the hole, if it is on its axis.
fn along_hole(forms: &mut ExactForms<'_>, at: [NodeId; 2], tip: &Tip<'_>) -> Option<f64> {
    let mut distance = f64::INFINITY;
    for (axis, entry) in [tip.radius, tip.height].into_iter().enumerate() {
        let position = forms.form(at[axis]).real;
        let direction = tip.directions[axis];
        let (off, lost) =
            forms.combine(&[(1.0, &[&position]), (-tip.reach, &[direction]), (-1.0, &[entry])])?;
        let (off, rest) = forms.without_small(&off, SMALL_PRODUCT);
        if lost + rest > SMALL {
            return None;
        }
        // A number times the direction.
        let ((powers, along), (of_direction, one)) = (off.only_term()?, direction.only_term()?);
        if powers != of_direction || one != 1.0 {
            return None;
        }
        distance = distance.min(along);
    }
    (distance > 0.0).then_some(distance)
}

/// Returns the distance of a point above the highest metal under an axial tool, if it is one of those that the macro gives.
fn above_edge(forms: &mut ExactForms<'_>, at: [NodeId; 2], tip: &Tip<'_>, edge: &Edge) -> Option<f64> {
    let [x, y] = at.map(|coordinate| forms.form(coordinate).real);
    let (aside, lost) =
        forms.combine(&[(1.0, &[&x]), (-tip.reach, &[tip.directions[0]]), (-1.0, &[tip.radius])])?;
    let aside = forms.magnitude(&aside) + lost + forms.error(at[0]);
    let (height, lost) = forms.combine(&[(1.0, &[&y]), (-tip.reach, &[tip.directions[1]])])?;
    let (height, rest) = forms.without_small(&height, SMALL_PRODUCT);
    if lost + rest > SMALL {
        return None;
    }
    let [over_a, over_b] = tip.inverses;
    edge.heights.into_iter().find_map(|above| {
        let (metal, lost_here) = forms.combine(&[(1.0, &[&height]), (-above, &[])])?;
        let (value, lost) = forms.combine(&[
            (1.0, &[&edge.radius, &edge.radius, over_a, over_a]),
            (1.0, &[&metal, &metal, over_b, over_b]),
            (-1.0, &[]),
        ])?;
        let off = forms.magnitude(&value) + lost;
        let is_on_surface = off <= SMALL_PRODUCT && lost_here <= SMALL && forms.is_nonnegative(&metal);
        let rounding = edge.steepness * libm::sqrt(2.0 * aside) + edge.top * libm::sqrt(off) + lost_here;
        is_on_surface.then_some(above - rounding)
    })
}
