//! A length offset that isn't the tool's, where the machine file has its length: told where just that puts the tool beside
//! the depth of the holes, and nothing it drilled is right.
use nalgebra::{Point3, Unit, Vector3};

use super::{Comparison, Objection};
use crate::diag::Diagnostic;
use crate::holes::Reach;
use crate::machine::Machine;
use crate::motion::Lengthening;
use crate::part::conduct::Conduct;
use crate::verify::objection::{behind, fold};

/// A feed that ends so near the line of a hole is meant for it, mm, …
const ASIDE: f64 = 0.5;

/// … if their directions differ by no more than 5°.
const COSINE: f64 = 0.996_194_698_091_745_5;

/// What is found of holes that are cut at a wrong depth.
const OF_DEPTHS: [&str; 5] = ["hole-missing", "hole-extra", "hole-depth", "holes-alike", "hole-in-air"];

pub(in crate::verify) fn check(
    comparison: &Comparison<'_>,
    reaches: &[Reach],
    conduct: &Conduct,
    machine: &Machine,
    objections: &mut Vec<Objection>,
) {
    let wrong: Vec<&Reach> = reaches.iter().filter(|reach| explains(comparison, reach)).collect();
    if wrong.is_empty() {
        return;
    }
    let by_them = |found: usize| {
        let tool = comparison.found[found].tool;
        wrong.iter().any(|reach| Some(reach.tool) == tool)
    };
    let pair_of = |wanted: usize| comparison.pairs.iter().find(|pair| pair.wanted == wanted);
    // What is missing or wrong with many holes, a tool with the right offset may have to do with.
    let alone = comparison.pairs.iter().all(|pair| by_them(pair.found));
    fold(objections, &OF_DEPTHS, |objection| match (objection.extra, objection.wanted) {
        (Some(extra), _) => by_them(extra),
        (None, Some(wanted)) => pair_of(wanted).map_or(alone, |pair| by_them(pair.found)),
        (None, None) => alone,
    });
    // With those behind a finding that is folded itself.
    let folded = objections.iter().filter(|objection| objection.folded).count();
    let mut told: Vec<Objection> =
        wrong.into_iter().map(|reach| Objection::whole(finding(reach, conduct, machine))).collect();
    told[0].finding.notes.extend(behind(folded));
    objections.splice(0..0, told);
}

fn finding(reach: &Reach, conduct: &Conduct, machine: &Machine) -> Diagnostic {
    let Reach { tool, beyond, .. } = *reach;
    let length = machine.length_of(Some(tool)).unwrap_or_default();
    let (by, side) = (shown(beyond.abs()), if beyond > 0.0 { "deeper" } else { "higher" });
    let own = conduct.duty(Some(tool)).and_then(|duty| duty.offset).unwrap_or(tool);
    let (how, help) = match reach.by {
        Lengthening::Off | Lengthening::Plus(0) | Lengthening::Minus(0) => {
            ("without its length offset".to_owned(), format!("command G43 H{own} before the first hole"))
        }
        Lengthening::Plus(h) if h == own => (
            format!("with H{h}, which is {}", shown(length - beyond)),
            format!("set H{h} in the control to the length of T{tool}"),
        ),
        Lengthening::Plus(h) => {
            (format!("with H{h}, which is {}", shown(length - beyond)), format!("command G43 H{own}"))
        }
        Lengthening::Minus(h) => {
            (format!("with G44 H{h}, which subtracts the length"), format!("command G43 H{own}"))
        }
    };
    let length = shown(length);
    let message = format!("T{tool}, {length} mm long, cuts {how}: its tip is {by} mm {side} than programmed");
    let other = conduct.tools.first().filter(|_| conduct.duty(Some(tool)).is_none());
    let help = match other {
        Some(duty) => format!("use the job's tool, T{}, or {help}", duty.number),
        None => help,
    };
    Diagnostic::error("length-offset", message)
        .note("this length error alone explains the missed depths; the length comes from the machine file")
        .help(help)
        .at(reach.place.clone())
}

/// To a thousandth, without what adding up leaves behind that.
fn shown(mm: f64) -> f64 {
    (mm * 1e3).round() / 1e3 + 0.0
}

/// Whether the tool's holes are beside the wanted depth, and would be right if its tip were where it is programmed.
fn explains(comparison: &Comparison<'_>, reach: &Reach) -> bool {
    let tolerance = comparison.tolerances.depth;
    let is_right = |(depth, wanted): (f64, f64)| (depth - wanted).abs() <= tolerance;
    let is_cut = |(depth, wanted): (f64, f64)| 0.0 < depth && depth <= wanted + tolerance;
    let mut explained = 0;
    for (end, axis) in &reach.ends {
        let found = depth(comparison, end, axis);
        if found.is_some_and(is_right) {
            return false;
        }
        let Some(programmed) = depth(comparison, &(end + axis.into_inner() * reach.beyond), axis) else {
            continue;
        };
        // A tool that doesn't finish the hole goes less deep: then at least not above it, nor too deep.
        let is_better = is_cut(programmed) && !found.is_some_and(is_cut);
        explained += usize::from(is_right(programmed) || is_better);
    }
    0 < explained && reach.ends.len() <= 2 * explained
}

/// How deep a point is in the wanted hole along whose line it lies, and how deep that is wanted.
fn depth(comparison: &Comparison<'_>, point: &Point3<f64>, axis: &Unit<Vector3<f64>>) -> Option<(f64, f64)> {
    comparison.wanted.iter().find_map(|hole| {
        let out = Vector3::from(hole.axis);
        let from = point - Point3::from(hole.entry);
        let depth = -from.dot(&out);
        let aside = (from + out * depth).norm();
        (aside <= ASIDE && COSINE <= out.dot(axis)).then_some((depth, hole.depth))
    })
}
