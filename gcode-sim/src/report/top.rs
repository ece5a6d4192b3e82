//! What the top view shows: holes found, and where there is a reference, the verdict on each.
use std::collections::BTreeMap;

use crate::holes::Found;
use crate::machine::{Link, LinkMotion, Machine};
use crate::motion::Axis;
use crate::part::reference::Reference;
use crate::part::surface::Surface;
use crate::picture::{DrawnHole, Standing, TopView};
use crate::session::Simulation;
use crate::verify::Verdict;

/// The holes of a program nobody has judged.
pub fn of_holes(name: &str, simulation: &Simulation, machine: &Machine) -> TopView {
    let rotary = Rotary::of(machine);
    let holes = simulation.extracted.holes.iter().zip(simulation.list().holes).enumerate();
    let drawn = holes.map(|(index, (found, hole))| DrawnHole {
        id: (index + 1).to_string(),
        nominal: None,
        found: Some(hole),
        standing: Standing::Unjudged,
        phi: None,
        turn: rotary.turn(found),
        remark: None,
    });
    TopView { name: name.to_owned(), rotary: rotary.letter(), holes: drawn.collect(), ..TopView::default() }
}

/// The holes as they were judged: found and wanted, missing and too many.
pub fn of_verdict(
    name: &str,
    simulation: &Simulation,
    reference: &Reference,
    verdict: &Verdict,
    machine: &Machine,
) -> TopView {
    let rotary = Rotary::of(machine);
    let found = &simulation.extracted.holes;
    let by_id: BTreeMap<_, _> = reference.holes.iter().map(|hole| (hole.id.as_deref(), hole)).collect();
    let wanted = |id: &str| by_id.get(&Some(id)).copied();
    let judged = verdict.holes.iter().map(|hole| DrawnHole {
        id: hole.id.clone(),
        nominal: wanted(&hole.id).cloned(),
        found: Some(found[hole.found].hole(nowhere)),
        standing: if hole.ok { Standing::Good } else { Standing::Bad },
        phi: Some(hole.phi),
        turn: rotary.turn(&found[hole.found]),
        remark: hole.objections.first().map(|code| code.trim_start_matches("hole-").to_owned()),
    });
    let missing = verdict.missing.iter().map(|id| DrawnHole {
        id: id.clone(),
        nominal: wanted(id).cloned(),
        found: None,
        standing: Standing::Missing,
        phi: None,
        turn: None,
        remark: None,
    });
    let extra = verdict.extra.iter().map(|extra| DrawnHole {
        id: extra
            .hole
            .from
            .as_ref()
            .map_or_else(String::new, |from| format!("{}:{}", from.program, from.line)),
        nominal: None,
        found: Some(extra.hole.clone()),
        standing: Standing::Extra,
        phi: None,
        turn: None,
        remark: None,
    });
    TopView {
        name: name.to_owned(),
        outline: reference.surface.and_then(outline),
        tolerance: Some(verdict.tolerance),
        rotary: rotary.letter(),
        holes: judged.chain(missing).chain(extra).collect(),
        ..TopView::default()
    }
}

/// The radius of the part seen along y, where that is a circle.
fn outline(surface: Surface) -> Option<f64> {
    match surface {
        Surface::Ellipsoid { a, .. } => Some(a),
        Surface::Cylinder { .. } => None,
    }
}

/// A picture shows no blocks.
fn nowhere(_: crate::source::Span) -> (String, u32) {
    (String::new(), 0)
}

/// The axis that turns the part: the one whose angle an operator looks for.
struct Rotary(Option<(Axis, char)>);

impl Rotary {
    fn of(machine: &Machine) -> Self {
        let turns = |link: &&Link| matches!(link.motion, LinkMotion::Turn { .. });
        let link = machine.table.0.iter().find(turns);
        Self(link.map(|link| (link.axis, machine.axes.letter(link.axis))))
    }

    fn letter(&self) -> String {
        self.0.map_or_else(String::new, |(_, letter)| letter.to_string())
    }

    fn turn(&self, found: &Found) -> Option<f64> {
        self.0.map(|(axis, _)| found.at[axis])
    }
}
