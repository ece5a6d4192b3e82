//! Everything that a verdict on holes does not cover, with the reasons.
use std::collections::{BTreeMap, BTreeSet};

use super::checks::features::ShapeGap;
use super::checks::stock::deeper_than_stock;
use super::hole_cuts::Cut;
use super::{Comparison, HoleInspection};
use crate::findings::BACK_BORED;
use crate::holes::{AssumedCone, DrilledHole, HoleExtraction, OnPath, Search};
use crate::machine::{HeadKind, Machine, PointShape, Tool, tool_name};
use gcode_lang::motion::LengthCompensation;
use gcode_lang::source::Span;
use gcode_part::{FeatureKind, Reference, ToolProcess};

/// Motion that no check covers if neither stock nor surface is known.
const MOTION: &str = "motion beside the holes (no stock)";

/// Metal near feeds of unknown width.
const UNSIZED: &str = "what mills of unknown diameter remove";

/// Something that a verdict does not cover.
pub(super) struct NotChecked {
    what: String,
    reason: String,
    /// The first line of the verdict names it: neither could the reference specify it, nor do most machines lack it.
    is_gap: bool,
}

impl NotChecked {
    fn gap(what: impl Into<String>, reason: impl Into<String>) -> Self {
        Self { what: what.into(), reason: reason.into(), is_gap: true }
    }

    fn aside(what: impl Into<String>, reason: impl Into<String>) -> Self {
        Self { is_gap: false, ..Self::gap(what, reason) }
    }

    /// Returns `head angles: the head is unknown, each axis is taken along its feed`.
    pub(super) fn sentence(&self) -> String {
        format!("{}: {}", self.what, self.reason)
    }
}

/// Returns the names of the gaps for the first line of a verdict, each once.
pub(super) fn gaps(all: &[NotChecked]) -> Vec<String> {
    let mut gaps: Vec<String> = Vec::new();
    for one in all.iter().filter(|one| one.is_gap) {
        // One with its reason says the same.
        let with_reason = format!("{} (", one.what);
        let is_said = all.iter().any(|other| other.is_gap && other.what.starts_with(&with_reason));
        if !is_said && !gaps.contains(&one.what) {
            gaps.push(one.what.clone());
        }
    }
    gaps
}

/// Returns everything that the verdict does not cover, so that a pass is not taken for more than it is.
pub(super) fn list(
    inspection: &HoleInspection<'_>,
    locate: &dyn Fn(Span) -> (String, u32),
) -> Vec<NotChecked> {
    let HoleInspection { comparison, extraction, reference, machine, .. } = inspection;
    let mut all = diameters(comparison, machine);
    if comparison.nominal.is_empty() {
        all.push(NotChecked::aside(
            "the holes (no reference)",
            "the program has to make none; only its motion is judged",
        ));
    }
    let open: Vec<&str> = reference.open_depths.iter().map(|index| comparison.id(*index)).collect();
    if !open.is_empty() {
        let what = format!("the depth of {}", hole_names(&open));
        all.push(NotChecked::gap(what, "the list has none, and that of the program counts"));
    }
    if !reference.unread.is_empty() {
        let s = if reference.unread.len() == 1 { "" } else { "s" };
        let what = format!("the column{s} {} of the list", reference.unread.join(", "));
        all.push(NotChecked::gap(what, "no such column is read"));
    }
    let cuts = extraction.cut_conditions.iter().any(|cut| cut.tool.is_none());
    let probes = extraction.unjudged.probes_of_start_tool.first().is_some();
    if !machine.tools.is_empty() && (cuts || probes) {
        let what = "the tool in the spindle at the start";
        let does = if cuts { "cuts" } else { "probes" };
        all.push(NotChecked::gap(what, format!("it {does} before the first tool change")));
    }
    all.extend(pitches(comparison, machine));
    all.extend(shapes(inspection));
    all.extend(assumed_cones(inspection));
    all.extend(lengths(extraction, machine));
    for (h, own, stated) in &extraction.reset_lengths {
        let what = format!("the length that the program sets for H{h}");
        let reason =
            format!("it is {own}, and {stated} in the machine file; the depth of what T{h} cuts rests on it");
        all.push(NotChecked::gap(what, reason));
    }
    all.extend(holders(extraction, machine));
    all.extend(conditions(extraction, reference, machine));
    all.extend(stubs(&extraction.called_stubs));
    if extraction.findings.iter().any(|finding| finding.kind == &BACK_BORED) {
        all.push(NotChecked::gap("bores made backwards", "their depth and diameter"));
    }
    let is_unknown = |drilled: &DrilledHole| !drilled.is_tool_axis_known;
    if machine.head.kind == HeadKind::Free && comparison.matched().any(|(.., drilled)| is_unknown(drilled)) {
        all.push(NotChecked::gap("head angles", "the head is unknown, each axis is taken along its feed"));
    }
    let has_sides = machine.tools.iter().any(|tool| tool.diameter.is_some());
    if machine.head.kind == HeadKind::Free && extraction.is_metal_known && has_sides {
        let reason = "the direction of the tool is unknown: across its axis they are not compared";
        all.push(NotChecked::gap("the sides of tools (no [head])", reason));
    }
    if extraction.assumed_axes != 0 && !extraction.holes.is_empty() {
        let what = format!("the position of {}", machine.axes.names(extraction.assumed_axes));
        all.push(NotChecked::aside(what, "no block commands it, and it counts as 0"));
    }
    if !extraction.is_metal_known {
        let reason = "give [stock] in the reference or the machine file; the metal is known only round the nominal \
                      holes, to 1 mm from their walls";
        all.push(NotChecked::gap(MOTION, reason));
    } else if let Some(unknown) = &extraction.unknown_rapids {
        let (what, reason) = unknown.describe(locate(unknown.backtrace.block));
        all.push(NotChecked::gap(what, reason));
    }
    let given_up = extraction.unsearched.iter().map(|(search, motions)| {
        let (what, kind, reason) = given_up(*search);
        (motions, what, kind, reason)
    });
    let others = [
        (
            &extraction.unjudged.rapids_of_unknown_tip,
            "rapids at machine positions without a length offset",
            "rapid",
            "the length of the tool is unknown, and a tool of length 0 would stand in the part there; give the length in the machine file",
        ),
        (
            &extraction.rapids_behind_change,
            "the retract of the tool change before some rapids",
            "rapid",
            "free if the tool change moves the tool away from the part, as on most machines; retract before it by G28 or G53",
        ),
        (
            &extraction.unjudged.probes_in_metal,
            "what probing moves touch",
            "move",
            "G31 leads through metal up to its signal, or a probe moves in a pocket that no feed has milled",
        ),
        (
            &extraction.unjudged.shifts_of_unknown_kind,
            "whether a tool shifted in its hole is a boring bar",
            "shift",
            "G76 and G87 shift a bar off the wall, and any other tool into it; give the kind of the tool in the machine file",
        ),
        (
            &extraction.unjudged.shifts_without_angle,
            "the angle at which a boring bar is shifted (no M19)",
            "shift",
            "M05 stops the edge at any angle, and the shift may take it into the wall; orient the spindle with M19 before it",
        ),
        (
            &extraction.unjudged.probes_without_signal,
            match machine.probe {
                None => "what probing moves touch (no [probe], no --skip)",
                Some(_) => "what probing moves touch (no [stock], no --skip)",
            },
            "move",
            match machine.probe {
                None => {
                    "no signal ends G31 in the metal; give [probe] with the radius of its ball in the machine file, or the \
                     place of the signal by --skip"
                }
                Some(_) => {
                    "no signal ends G31 in the metal; give [stock], which the probe touches, or the place of the signal by --skip"
                }
            },
        ),
    ];
    for (motions, what, kind, reason) in given_up.chain(others) {
        if let Some((first, count)) = motions.first() {
            let (program, line) = locate(first.block);
            let plural = if *count == 1 { "" } else { "s" };
            let reason = format!("{count} {kind}{plural}, first {program} line {line}; {reason}");
            all.push(NotChecked::gap(what, reason));
        }
    }
    for tool in &extraction.unsized_mills {
        let tool = tool_name(*tool);
        let reason = format!("the machine file has no diameter of {tool}; rapids near its feeds pass");
        all.push(NotChecked::gap(UNSIZED, reason));
    }
    if 0 < extraction.strokes_in_air {
        let what = format!("{} of drilling cycles in the air", strokes(extraction.strokes_in_air));
        let reason = "the part has no metal there: the cycle is wrong, or it drills another part, whose holes are not compared";
        all.push(NotChecked::gap(what, reason));
    }
    if 0 < extraction.milled_strokes {
        let what = format!("{} of a mill beside the holes", strokes(extraction.milled_strokes));
        all.push(NotChecked::gap(what, "taken for milling, not for a hole"));
    }
    if !extraction.milled_blocks.is_empty() {
        let what = format!("the shape of the milling ({})", milled_lines(&extraction.milled_blocks, locate));
        let reason = "it may remove all of its [[stock.pocket]], and nothing beside it; what it leaves there is not compared";
        all.push(NotChecked::gap(what, reason));
    }
    if extraction.has_unmilled_pockets {
        let reason = "if this program should mill a [[stock.pocket]], blocks are missing";
        all.push(NotChecked::gap("the stated pockets, which no feed cuts", reason));
    }
    let covered: Vec<&str> = extraction.covered_entries.iter().map(|index| comparison.id(*index)).collect();
    if !covered.is_empty() {
        let holes = hole_names(&covered);
        let what = format!("the metal over the entry of {holes}");
        all.push(NotChecked::gap(what, "the stock has it, and no feed removes it"));
    }
    let deeper = deeper_than_stock(inspection);
    if !deeper.is_empty() {
        let what = format!("the far side of {}", hole_names(&deeper));
        all.push(NotChecked::gap(what, "deeper than the stock is thick, and not `through` in the reference"));
    }
    if extraction.is_removal_cut_short {
        let what = "what the feeds after the first million remove";
        all.push(NotChecked::gap(what, "rapids where they have removed the metal are reported"));
    }
    all
}

/// Returns `1 stroke`, `2 strokes`.
fn strokes(count: u64) -> String {
    if count == 1 { "1 stroke".to_owned() } else { format!("{count} strokes") }
}

/// Returns what a search for metal that is given up leaves out, the kind of its motions, and the reason.
fn given_up(search: Search) -> (&'static str, &'static str, &'static str) {
    let reason = |path: OnPath| match path {
        OnPath::Turning => "an axis rotates near the metal",
        OnPath::Straight => "the metal beside them is cut too finely",
    };
    match search {
        Search::Paths => {
            ("rapids whose axes may reach too many positions", "rapid", "give [rapid] in the machine file")
        }
        Search::Rapid(path) => ("the side of the tool in some rapids", "rapid", reason(path)),
        Search::Feed(path) => ("the side of the tool in some feeds", "feed", reason(path)),
    }
}

/// Returns `O1 lines 45 to 60, O9100 line 3 and 2 more`.
fn milled_lines(runs: &[[Span; 2]], locate: &dyn Fn(Span) -> (String, u32)) -> String {
    const MAX_SHOWN: usize = 3;
    let shown = runs.iter().take(MAX_SHOWN).map(|run| {
        let [(program, from), (other, to)] = run.map(locate);
        match () {
            () if other != program => format!("{program} line {from} to {other} line {to}"),
            () if from == to => format!("{program} line {from}"),
            () => format!("{program} lines {from} to {to}"),
        }
    });
    let shown = shown.collect::<Vec<_>>().join(", ");
    match runs.len().saturating_sub(MAX_SHOWN) {
        0 => shown,
        more => format!("{shown} and {more} more"),
    }
}

/// Returns `hole 1`, or the number of several with the first.
fn hole_names(ids: &[&str]) -> String {
    match ids {
        [one] => format!("hole {one}"),
        _ => format!("{} holes (first {})", ids.len(), ids[0]),
    }
}

/// Returns the effect of called programs that are stubs here.
fn stubs(programs: &[String]) -> Option<NotChecked> {
    let what = match programs {
        [] => return None,
        [one] => format!("what {one} does (a stub, M99 alone)"),
        [first, others @ ..] => {
            let last = others.last()?;
            let between =
                others[..others.len() - 1].iter().map(|name| format!(", {name}")).collect::<String>();
            format!("what {first}{between} and {last} do (stubs, M99 alone)")
        }
    };
    Some(NotChecked::gap(
        what,
        "the control has another program of this number; offsets and positions that it sets are unknown",
    ))
}

/// Returns the holes of unknown diameter, by their tools.
fn diameters(comparison: &Comparison<'_>, machine: &Machine) -> Vec<NotChecked> {
    let mut by_tool: BTreeMap<Option<u32>, Vec<&str>> = BTreeMap::new();
    let mut unspecified = Vec::new();
    for (pair, nominal, drilled) in comparison.matched() {
        if nominal.widest_diameter().is_none() {
            unspecified.push(comparison.id(pair.nominal));
            continue;
        }
        for pass in drilled.passes().filter(|pass| pass.diameter.is_none()) {
            let ids = by_tool.entry(pass.tool.filter(|_| !machine.tools.is_empty())).or_default();
            let id = comparison.id(pair.nominal);
            if ids.last() != Some(&id) {
                ids.push(id);
            }
        }
    }
    let gap = |(tool, ids): (Option<u32>, Vec<&str>)| {
        let what = format!("the diameter of {}", hole_names(&ids));
        match tool {
            None if machine.tools.is_empty() => NotChecked::gap("diameters", "the machine has no tool table"),
            None => NotChecked::gap(what, "made before the first tool change"),
            Some(tool) if machine.find_tool(tool).is_none() => {
                NotChecked::gap(what, format!("T{tool} is not in the machine file"))
            }
            Some(tool) => NotChecked::gap(what, format!("the machine file has none of T{tool}")),
        }
    };
    let unspecified = (!unspecified.is_empty()).then(|| {
        let reason = "the reference has none, and the sides of the tools in it are not compared either";
        NotChecked::gap(format!("the diameter of {}", hole_names(&unspecified)), reason)
    });
    by_tool.into_iter().map(gap).chain(unspecified).collect()
}

/// Returns the tools that cut a thread in holes where the reference has none, or none with a pitch.
fn pitches(comparison: &Comparison<'_>, machine: &Machine) -> Vec<NotChecked> {
    let mut by_tool: BTreeMap<Option<u32>, Vec<&str>> = BTreeMap::new();
    for (pair, nominal, drilled) in comparison.matched() {
        if nominal.features.iter().any(|one| one.kind == FeatureKind::Tap && one.pitch.is_some()) {
            continue;
        }
        let cuts = Cut::all(nominal, drilled, machine);
        let threads: BTreeSet<_> =
            cuts.iter().filter(|cut| cut.is_thread()).map(|cut| cut.pass.tool).collect();
        for tool in threads {
            by_tool.entry(tool).or_default().push(comparison.id(pair.nominal));
        }
    }
    let gap = |(tool, ids): (Option<u32>, Vec<&str>)| {
        let what = format!("the pitch of the thread of {}", tool_name(tool));
        NotChecked::gap(what, format!("the reference has none for {}", hole_names(&ids)))
    };
    by_tool.into_iter().map(gap).collect()
}

/// Returns the tools whose end the machine file does not describe, with what was taken for it.
fn shapes(inspection: &HoleInspection<'_>) -> Vec<NotChecked> {
    let mut ids: BTreeMap<ShapeGap, Vec<&str>> = BTreeMap::new();
    for hole in &inspection.features {
        for gap in &hole.gaps {
            let holes = ids.entry(*gap).or_default();
            let id = inspection.comparison.id(hole.nominal);
            if holes.last() != Some(&id) {
                holes.push(id);
            }
        }
    }
    let gap = |(gap, ids): (ShapeGap, Vec<&str>)| {
        let holes = hole_names(&ids);
        let no_angle = |what: String, tool| {
            NotChecked::gap(what, format!("the machine file has no point_angle of {}", tool_name(tool)))
        };
        match gap {
            ShapeGap::SpotDrill(tool) => {
                let tool = tool_name(tool);
                let reason =
                    format!("the machine file has no kind or point_angle; {tool} is taken for a spot drill");
                NotChecked::gap(format!("the end of {tool} in {holes}"), reason)
            }
            ShapeGap::Undrilled(tool) => {
                let what = format!("the hole in which {} cuts", tool_name(tool));
                NotChecked::gap(what, format!("the program does not drill {holes}"))
            }
            ShapeGap::Thread(tool) => {
                let what = format!("the thread that {} cuts", tool_name(tool));
                NotChecked::gap(
                    what,
                    format!("the reference has no thread, neither its depth nor its pitch, in {holes}"),
                )
            }
            ShapeGap::ThreadLength(tool) => {
                let what = format!("the length of the thread of {holes}");
                let tool = tool_name(tool);
                NotChecked::gap(what, format!("{tool} goes round once, and a comb mill cuts a longer thread"))
            }
            ShapeGap::FullThrough(tool) => {
                let what = format!("the full diameter of {holes} on the far side");
                let end = tool.and_then(|number| inspection.machine.find_tool(number)).map(Tool::point);
                match end.is_some_and(|end| end != PointShape::Unknown) {
                    true => NotChecked::gap(
                        what,
                        format!("the machine file has no diameter of {}", tool_name(tool)),
                    ),
                    false => no_angle(what, tool),
                }
            }
            ShapeGap::BreakThrough(tool) => {
                let tool = tool_name(tool);
                let reason = format!(
                    "the machine file has no diameter of {tool}, on which the length of its point rests"
                );
                NotChecked::gap(format!("how far {tool} goes through {holes}"), reason)
            }
            ShapeGap::FullDepth(tool) => no_angle(format!("the depth of the full diameter of {holes}"), tool),
            ShapeGap::Floor(tool) => {
                let reason = format!(
                    "the machine file has no kind or point_angle of {}, which is taken for flat",
                    tool_name(tool)
                );
                NotChecked::gap(format!("the floor of the counterbore of {holes}"), reason)
            }
            ShapeGap::Angle(tool) => no_angle(format!("the angle of the countersink of {holes}"), tool),
        }
    };
    ids.into_iter().map(gap).collect()
}

/// Returns the tools whose unknown ends count as cones, where no countersink that they make says so.
fn assumed_cones(inspection: &HoleInspection<'_>) -> Vec<NotChecked> {
    let is_named = |tool| {
        let mut gaps = inspection.features.iter().flat_map(|hole| &hole.gaps);
        gaps.any(|gap| *gap == ShapeGap::Angle(Some(tool)))
    };
    let open = inspection.extraction.assumed_cones.iter().filter(|(tool, _)| !is_named(**tool));
    let gap = |(tool, cone): (&u32, &AssumedCone)| {
        let reason = format!(
            "the machine file has no kind or point_angle of it; it counts as the cone of the countersink of {}",
            hole_names(&[inspection.comparison.id(cone.hole)])
        );
        NotChecked::gap(format!("the end of T{tool}"), reason)
    };
    open.map(gap).collect()
}

/// Returns the tools of unknown length, and the length taken for each.
fn lengths(extraction: &HoleExtraction, machine: &Machine) -> Vec<NotChecked> {
    let unknown = extraction.cut_conditions.iter().filter(|cut| machine.length_of(cut.tool).is_none());
    let tools: BTreeSet<_> = unknown.map(|cut| (cut.tool, cut.compensation)).collect();
    let gap = |(tool, compensation): (Option<u32>, LengthCompensation)| {
        let whose = tool.map_or("the tool's length".to_owned(), |number| format!("the length of T{number}"));
        match compensation.number() {
            // Touched off at the part: the offset is stated, and is no length.
            Some(h)
                if machine
                    .find_tool(h)
                    .and_then(|tool| tool.length_offset)
                    .is_some_and(|offset| offset < 0.0) =>
            {
                NotChecked::gap(
                    whose,
                    format!("not in the machine file: the stated H{h} puts its tip, and is no length"),
                )
            }
            Some(h) => NotChecked::gap(whose, format!("not in the machine file: H{h} counts as its length")),
            None => NotChecked::gap(
                format!("{whose} (no length offset)"),
                "not in the machine file: its tip counts as the programmed point",
            ),
        }
    };
    tools.into_iter().map(gap).collect()
}

/// Returns the tools whose holder is described, but not where it is.
fn holders(extraction: &HoleExtraction, machine: &Machine) -> Option<NotChecked> {
    let tools: BTreeSet<u32> = extraction.cut_conditions.iter().filter_map(|cut| cut.tool).collect();
    let is_nowhere = |number: &&u32| {
        machine
            .find_tool(**number)
            .is_some_and(|tool| tool.holder_diameter.is_some() && tool.length.is_none())
    };
    let names: Vec<_> = tools.iter().filter(is_nowhere).map(|number| format!("T{number}")).collect();
    let what = format!("the holder of {} in the holes", names.join(", "));
    (!names.is_empty()).then(|| NotChecked::gap(what, "the machine file has no length"))
}

/// Returns the limits of the process that the reference does not specify.
fn conditions(extraction: &HoleExtraction, reference: &Reference, machine: &Machine) -> Option<NotChecked> {
    let limits = &reference.process_limits;
    if extraction.process_limits != *limits {
        let reason = "the run was simulated without those of the reference";
        return Some(NotChecked::gap("cutting conditions", reason));
    }
    let tools: BTreeSet<_> = extraction.cut_conditions.iter().map(|cut| cut.tool).collect();
    let lacks = |value: &dyn Fn(&ToolProcess) -> Option<f64>| {
        tools.iter().any(|tool| limits.tool_process(*tool).and_then(value).is_none())
    };
    let rotates = machine.table.rotary_axes().next().is_some();
    let conditions = [
        (lacks(&|tool| tool.speed), "S"),
        (lacks(&|tool| tool.feed), "F"),
        (rotates && limits.clearance.is_none(), "the clearance while an axis rotates"),
        (rotates && limits.retract.is_none(), "the retract before the rotary moves"),
        (rotates && limits.clamp.is_none(), "the rotary clamp"),
    ];
    let names: Vec<_> = conditions.iter().filter(|(lacks, _)| *lacks).map(|(_, name)| *name).collect();
    (!names.is_empty()).then(|| NotChecked::aside(names.join(", "), "not specified in the reference"))
}
