//! Contents of the picture of a tool path: runs, tools, stops, work zeros and stock.
use std::collections::{BTreeMap, BTreeSet};

use super::figures::{as_on_control, count};
use super::run::comments;
use super::top::side_along_holes;
use super::work_zeros::zeros;
use gcode_draw::{
    DrawnTool, PathPlace, PathRun, PathView, RunAxis, RunKind, Side, Sign, TopView, TravelLimit,
};
use gcode_inspect::drawn_move::PathKind;
use gcode_inspect::machine::{HeadKind, Machine, Setup, Tool, ToolKind};
use gcode_inspect::tool_path::{PathStop, StretchAxis, ToolPath};
use gcode_lang::control::StrokeLimits;
use gcode_lang::diag::{Diagnostic, Severity};
use gcode_lang::motion::Position;
use gcode_lang::source::{SourceId, Span};
use gcode_part::{Hole, Stock};
use gcode_session::Simulation;

/// Largest number of stops whose text is in the title block.
const MAX_STOP_TEXTS: usize = 3;

/// Returns true if a path shows more than the symbols of the holes do: a feed that makes none, or motion without holes.
pub(crate) fn shows_more(path: &ToolPath, simulation: &Simulation) -> bool {
    let holes = &simulation.extracted.holes;
    let blocks: BTreeSet<(SourceId, u32)> = holes
        .iter()
        .flat_map(|hole| hole.passes().map(|pass| (pass.backtrace.block.source, pass.backtrace.block.start)))
        .collect();
    let is_of_hole = |block: Span| blocks.contains(&(block.source, block.start));
    !path.moves.is_empty() && (holes.is_empty() || path.has_feed_off_holes(is_of_hole))
}

/// Returns true if a path has a milled hole, or an operator stop at a known position.
pub(crate) fn has_curves_or_stops(path: &ToolPath) -> bool {
    !path.moves.is_empty() && (path.has_curved_feed() || path.stops.iter().any(|stop| stop.at.is_some()))
}

/// Returns the side from which the part is cut: that of the tool in most feeds, of most holes, or of the spindle. A tool of
/// unknown direction that makes no hole is along z, as in G17.
pub(crate) fn top_side(path: &ToolPath, found: &[Hole], machine: &Machine, spindle: Side) -> Side {
    let along = |(axis, is_positive)| Side::along(axis, is_positive);
    let known = path.tool_axis().map(along);
    let usual = if machine.head.kind == HeadKind::Free && found.is_empty() { Side::Z } else { spindle };
    known.or_else(|| side_along_holes(found)).or_else(|| path.supposed_axis().map(along)).unwrap_or(usual)
}

/// Builds the contents of the picture. The points of the path move into it.
pub(crate) fn of_path(
    path: ToolPath,
    simulation: &Simulation,
    machine: &Machine,
    stock: Option<Stock>,
    strokes: Option<StrokeLimits>,
) -> PathView {
    let run = &simulation.run;
    let mut names: BTreeMap<Option<u32>, usize> = BTreeMap::new();
    let mut programs: BTreeMap<String, usize> = BTreeMap::new();
    let mut known: BTreeMap<(SourceId, u32), usize> = BTreeMap::new();
    let mut runs = Vec::with_capacity(path.stretches.len());
    let mut tools = Vec::new();
    for stretch in &path.stretches {
        let tool = *names.entry(stretch.tool).or_insert_with(|| {
            tools.push(tool(stretch.tool, machine));
            tools.len() - 1
        });
        let program = *known.entry((stretch.block.source, stretch.block.start)).or_insert_with(|| {
            let next = programs.len();
            *programs.entry(run.locate(stretch.block).0).or_insert(next)
        });
        let kind = match stretch.kind {
            PathKind::Rapid => RunKind::Rapid,
            PathKind::Feed => RunKind::Feed,
            PathKind::Probe => RunKind::Probe,
        };
        let axis = match stretch.axis {
            StretchAxis::Unknown => RunAxis::Unknown,
            StretchAxis::Along(axis, _) => RunAxis::Along(axis),
            StretchAxis::Oblique => RunAxis::Oblique,
        };
        runs.push(PathRun { kind, tool, program, feed: stretch.feed, axis, points: stretch.points.clone() });
    }
    let mut programs: Vec<(String, usize)> = programs.into_iter().collect();
    programs.sort_by_key(|(_, number)| *number);
    PathView {
        runs,
        tools,
        programs: programs.into_iter().map(|(name, _)| name).collect(),
        places: places(&path, simulation),
        zeros: zeros(machine, [run]),
        limits: strokes.map_or_else(Vec::new, |strokes| travel_limits(&path, machine, &strokes)),
        stock,
        notes: notes(&path, simulation),
        points: path.points,
    }
}

/// Returns the name of a tool and the width that it sweeps: a cone cuts as wide as it is deep, and a probe cuts nothing.
fn tool(number: Option<u32>, machine: &Machine) -> DrawnTool {
    let Some(number) = number else {
        return DrawnTool { name: "feed, no tool called before".to_owned(), swept_width: None };
    };
    let known = machine.tools.iter().find(|tool| tool.number == number).copied();
    let Tool { kind: kind_of_point, diameter, point_angle, .. } = known.unwrap_or_default();
    let kind = kind_of_point.map(|kind| format!(" {}", kind.name().replace('-', " ")));
    let size = diameter.map(|diameter| format!(" Φ{}", super::figures::short(diameter)));
    let name = format!("T{number}{}{}", kind.unwrap_or_default(), size.unwrap_or_default());
    let is_pointed = point_angle.is_some_and(|angle| angle.0 < 180.0);
    let swept_width = match kind_of_point {
        Some(ToolKind::SpotDrill | ToolKind::Countersink | ToolKind::Probe) => None,
        Some(ToolKind::EndMill) if is_pointed => None,
        _ => diameter,
    };
    DrawnTool { name, swept_width }
}

/// Returns start and end of the path, its stops, and the position of an alarm, or the last known one. A path that leads to an unknown
/// place has no end.
fn places(path: &ToolPath, simulation: &Simulation) -> Vec<PathPlace> {
    let place = |sign, at: Option<[f64; 3]>, label: String| at.map(|at| PathPlace { sign, at, label });
    let first = path.points.first().copied();
    let last = path.end.or_else(|| path.points.last().copied());
    let start = place(Sign::Start, first, "start".to_owned());
    let end = match simulation.run.stop_finding() {
        Some(finding) => place(Sign::Alarm, last, finding.code().into_owned()),
        None => place(Sign::End, path.end, "end".to_owned()),
    };
    let stops = path.stops.iter().filter_map(|stop| place(Sign::Stop, stop.at, stop.kind.name().to_owned()));
    start.into_iter().chain(end).chain(stops).collect()
}

/// Returns the travel limits of the tip, where no head and no stated table rotates. That of Z is one for each tool whose
/// length the machine file gives, for the tip is lower than the spindle by that length.
fn travel_limits(path: &ToolPath, machine: &Machine, strokes: &StrokeLimits) -> Vec<TravelLimit> {
    let is_rotating = !matches!(machine.head.kind, HeadKind::Free | HeadKind::Fixed(_))
        || !machine.has_default_table && !machine.table.0.is_empty();
    if is_rotating {
        return Vec::new();
    }
    let ends = |coordinate: usize, name: u8, tool: Option<u32>| {
        let axis = machine.axes.find(name)?;
        let setup = Setup { tool, ..Setup::default() };
        let tip = move |limit: f64| {
            let mut at = Position::default();
            at[axis] = limit;
            let mm = machine.forward(&at, &setup).tip[coordinate];
            TravelLimit { axis: coordinate, mm, tool: tool.map(|tool| format!("T{tool}")) }
        };
        Some([strokes.min[axis], strokes.max[axis]].into_iter().flatten().map(tip))
    };
    let across = [(0, b'X'), (1, b'Y')].into_iter().filter_map(|(axis, name)| ends(axis, name, None));
    let used: BTreeSet<u32> = path.stretches.iter().filter_map(|stretch| stretch.tool).collect();
    let is_known = |tool: &Tool| used.contains(&tool.number) && tool.length.is_some();
    let is_along_z = matches!(machine.head.kind, HeadKind::Fixed(out) if 0.999 < out.z);
    let tools = machine.tools.iter().filter(|tool| is_along_z && is_known(tool));
    let along = tools.filter_map(|tool| ends(2, b'Z', Some(tool.number)));
    across.flatten().chain(along.flatten()).collect()
}

/// Returns what the picture lacks, and the texts of the first stops.
fn notes(path: &ToolPath, simulation: &Simulation) -> Vec<String> {
    let mut notes = Vec::new();
    // The control and the path record the same stops in their order.
    let variables = simulation.run.control.stops().iter().map(|stop| stop.variables.as_slice());
    let sources = simulation.run.control.memory().sources();
    let text = |stop: &PathStop| match stop.text.as_str() {
        "" => comments(&sources.text(stop.block)),
        shown => shown.to_owned(),
    };
    let texts = path.stops.iter().zip(variables).map(|(stop, variables)| (stop, text(stop), variables));
    let value = |(number, value): &(u32, f64)| format!("#{number} = {}", as_on_control(*value));
    let line = |(stop, text, variables): (&PathStop, String, &[(u32, f64)])| {
        let values: Vec<String> = variables.iter().map(value).collect();
        let values = if values.is_empty() { String::new() } else { format!(": {}", values.join(", ")) };
        format!("stop {}: {text}{values}", stop.kind.name())
    };
    let texts: Vec<_> = texts.filter(|(_, text, _)| !text.is_empty()).collect();
    let more = texts.len().saturating_sub(MAX_STOP_TEXTS);
    notes.extend(texts.into_iter().take(MAX_STOP_TEXTS).map(line));
    if 0 < more {
        notes.push(format!("and {}", count(more, "more stop")));
    }
    if 0 < path.unplaced_feeds {
        let feeds = count(path.unplaced_feeds, "feed");
        notes.push(format!("{feeds} from or to an unknown position not drawn"));
    }
    if 0 < path.omitted_moves {
        let drawn = path.moves.len();
        notes.push(format!("the first {drawn} of {} moves are drawn", drawn as u64 + path.omitted_moves));
    }
    notes
}

/// Returns the number of findings of a severity and the first of them as a line of the title block.
pub(crate) fn finding_line<'a>(
    findings: impl IntoIterator<Item = &'a Diagnostic>,
    severity: Severity,
    what: &str,
) -> Option<String> {
    let mut of_severity = findings.into_iter().filter(|finding| finding.severity == severity);
    let first = of_severity.next()?;
    let others: usize = of_severity.map(|finding| 1 + finding.more).sum();
    let all = 1 + first.more + others;
    let which = if all == 1 { "" } else { ", first" };
    Some(format!("{}{which}: {}", count(all, what), first.message))
}

/// Returns true if there is something to draw: a move or a hole.
pub(crate) fn is_drawable(path: &ToolPath, holes: &TopView) -> bool {
    !path.moves.is_empty() || !holes.holes.is_empty()
}

#[cfg(test)]
mod tests {
    use super::*;
    use gcode_lang::units::Deg;

    /// A cone of 60° that is 0.2 deep cuts 0.23 wide, not its 6: the depth below the surface is unknown.
    #[test]
    fn a_cone_sweeps_no_width_of_its_own() {
        let width = |kind, point_angle| {
            let known = Tool { number: 1, kind, diameter: Some(6.0), point_angle, ..Tool::default() };
            tool(Some(1), &Machine { tools: vec![known], ..Machine::default() }).swept_width
        };
        let angle = Some(Deg(60.0));
        for kind in [ToolKind::Countersink, ToolKind::SpotDrill, ToolKind::Probe] {
            assert_eq!(width(Some(kind), None), None, "{kind:?}");
        }
        assert_eq!(width(Some(ToolKind::EndMill), angle), None);
        for (kind, angle) in [(Some(ToolKind::EndMill), None), (Some(ToolKind::Drill), angle), (None, None)] {
            assert_eq!(width(kind, angle), Some(6.0), "{kind:?}");
        }
    }
}
