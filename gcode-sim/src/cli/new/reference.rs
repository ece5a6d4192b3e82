//! `gcode-sim new reference`: the holes that a program makes now, as a list for `verify`.
use std::collections::BTreeSet;
use std::path::PathBuf;

use clap::Args;
use nalgebra::{Point3, Unit, Vector3};

use super::{ExitStatus, OutputFile, UsageError};
use crate::cli::conditions::{ProgramArguments, RunConditions};
use crate::cli::library::Folders;
use crate::cli::{common, options, output, progress};
use crate::report::figures::count as count_of;
use crate::report::holes as report;
use gcode_inspect::findings::{FEED_NO_HOLE, FEED_WITHOUT_RETRACT, MAIN_PROGRAM};
use gcode_inspect::holes::DrilledHole;
use gcode_inspect::verify::Answer;
use gcode_lang::diag::Diagnostic;
use gcode_part::{FeatureKind, Hole, HoleList, MM_PER_INCH, Metal, PartSolid, Reference, Stock, Surface};
use gcode_session::{Criteria, Request, Simulation};

/// Largest difference between levels that are one, mm.
const SAME_LEVEL: f64 = 0.001;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// The program; '-' reads standard input
    #[arg(long, value_name = "PROGRAM.nc", display_order = 0)]
    from: PathBuf,

    /// Distance of the R point level from the surface, mm, or inches for a program in inches: entries lie so far below the
    /// start of the feed
    #[arg(long, value_name = "LENGTH", value_parser = common::number)]
    clearance: Option<f64>,

    #[command(flatten)]
    file: OutputFile,

    #[command(flatten)]
    conditions: RunConditions,
}

pub(super) fn run(arguments: &Arguments) -> Result<ExitStatus, UsageError> {
    let is_json = is_json(&arguments.file)?;
    let clearance = arguments.clearance.unwrap_or_default();
    if !(clearance.is_finite() && clearance >= 0.0) {
        return Err(UsageError::new(format!("--clearance {clearance}: a length of 0 mm or more")));
    }
    let program =
        ProgramArguments { program: arguments.from.clone(), conditions: arguments.conditions.clone() };
    let (program, _) = program.completed()?;
    let (mut request, mut folders) = options::checked_request(&program, None, arguments.file.path(), None)?;
    let simulation = progress::of_run(&mut request, |request| {
        let stock = request.machine.stock.as_ref();
        let metal = Metal {
            body: body(request),
            entries: None,
            pockets: stock.map(Stock::pockets).unwrap_or_default(),
            voids: stock.map(Stock::voids).unwrap_or_default(),
        };
        gcode_session::simulate(request, &mut folders, metal)
    })?;
    if let Some(stop) = simulation.run.stop_finding() {
        super::super::findings(std::iter::once(&stop), &simulation.run);
        output::print_message("error: nothing is written: the run stopped, and holes may be missing\n");
        return Ok(ExitStatus::Stopped);
    }
    let unit = if simulation.run.control.is_inch() { MM_PER_INCH } else { 1.0 };
    let MadeList { list, entries, sunk, unlisted } =
        list(&simulation, &request, arguments.clearance.map(|clearance| clearance * unit))?;
    if list.holes.is_empty() {
        let of_choice: Vec<Diagnostic> =
            simulation.run.findings().filter(|finding| finding.kind == &MAIN_PROGRAM).collect();
        super::super::findings(&of_choice, &simulation.run);
        output::print_message("error: nothing is written: the program makes no hole\n");
        return Ok(ExitStatus::Failed);
    }
    let text = if is_json { json(&list)? } else { report::csv(&list) };
    arguments.file.write(&text)?;
    let (holes, lengths) = (count_of(list.holes.len(), "hole"), if unit == 1.0 { "" } else { ", in inches" });
    output::print_message(&format!("note: {holes} as the program makes them{lengths}; {entries}\n"));
    if list.holes.iter().any(|hole| hole.diameter.is_none() && hole.features.is_empty()) {
        output::print_message(
            "note: without a diameter: holes whose tool is not in the machine file; write those of the drawing\n",
        );
    }
    if 0 < sunk {
        let holes = count_of(sunk, "hole");
        output::print_message(&format!(
            "note: {holes} with the entry below the surface: the program mills there first\n"
        ));
    }
    if let (count @ 1.., tools) = unlisted {
        let tools = tools.into_iter().map(|tool| format!("T{tool}")).collect::<Vec<_>>().join(", ");
        let holes = count_of(count, "hole");
        output::print_message(&format!(
            "note: {holes} with one diameter, though several tools cut: the machine file lacks the kind or the diameter of \
             {tools}\n"
        ));
    }
    let through = list.holes.iter().filter(|hole| hole.through).count();
    if 0 < through {
        let holes = count_of(through, "hole");
        output::print_message(&format!(
            "note: {holes} through the stock: `through`, and the depth is the thickness there\n"
        ));
    }
    let is_in_no_hole =
        |finding: &&Diagnostic| [&FEED_NO_HOLE, &FEED_WITHOUT_RETRACT].contains(&finding.kind);
    let mut beside = simulation.extracted.findings.iter().filter(is_in_no_hole);
    if let Some(first) = beside.next() {
        super::super::findings(std::iter::once(first), &simulation.run);
        output::print_message(
            "note: not in the list: feeds that are in no hole; write the threads and bores that they mill, and state \
             pockets in [[stock.pocket]]\n",
        );
    }
    let in_air = simulation.extracted.strokes_in_air();
    if 0 < in_air {
        let strokes = count_of(in_air as usize, "stroke");
        output::print_message(&format!(
            "note: not in the list: {strokes} of drilling cycles where the part has no metal; a list of several parts needs a [stock] \
             over all of them\n"
        ));
    }
    if let Some(line) = failure_against_itself(&list, &request, &mut folders)? {
        output::print_message(&format!(
            "note: verify of the program against this list as it stands: {line}\n"
        ));
    }
    Ok(ExitStatus::Passed)
}

/// Returns the first line of the verdict on the program with its own list if it fails: as by a helix without a closing circle, which
/// leaves a ramp below the depth in the list.
fn failure_against_itself(
    list: &HoleList,
    request: &Request,
    folders: &mut Folders,
) -> Result<Option<String>, UsageError> {
    let Ok(reference) = Reference::of_list(list.clone()) else { return Ok(None) };
    let criteria = Criteria::of(&reference);
    let (_, verdict) = gcode_session::judge_holes(request, folders, criteria, &mut (), &mut ())?;
    Ok((verdict.verdict == Answer::Fail).then(|| verdict.conclusion().line()))
}

/// Returns true for a file with the ending of JSON; refuses other endings than those of lists.
fn is_json(file: &OutputFile) -> Result<bool, UsageError> {
    let Some(path) = file.path() else { return Ok(false) };
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase());
    match ending.as_deref() {
        Some("json") => Ok(true),
        Some("csv") => Ok(false),
        _ => Err(UsageError::new(format!("{}: a list of holes ends with .csv or .json", path.display()))),
    }
}

fn json(list: &HoleList) -> Result<String, UsageError> {
    let text = serde_json::to_string_pretty(list);
    text.map(|text| text + "\n")
        .map_err(|error| UsageError::new(format!("the list cannot be written as JSON: {error}")))
}

/// The list of a program's holes, and what is to be said of it.
struct MadeList {
    list: HoleList,
    /// How the entries are found.
    entries: String,
    /// Number of holes that begin below the part's surface.
    sunk: usize,
    /// Numbers of holes, and the tools of unknown kind or diameter in them, whose features the list lacks.
    unlisted: (usize, BTreeSet<u32>),
}

/// Returns the holes, each once, with a number as their id.
fn list(simulation: &Simulation, request: &Request, clearance: Option<f64>) -> Result<MadeList, UsageError> {
    let mut list = simulation.hole_list();
    let drilled = &simulation.extracted.holes;
    let (kept, firsts): (Vec<usize>, Vec<&DrilledHole>) = first_on_lines(drilled).unzip();
    list.holes = kept.into_iter().filter_map(|index| list.holes.get(index).cloned()).collect();
    let body = body(request);
    let mut sunk = 0;
    let entries = match (body, clearance) {
        (Some(_), Some(_)) => {
            return Err(UsageError::new("--clearance: the surface is known: omit the flag"));
        }
        (Some(surface), None) => {
            list.enter_at(&surface);
            for (hole, surface) in
                list.holes.iter_mut().zip(&firsts).filter_map(|(h, d)| Some((h, d.surface?)))
            {
                let below = (Point3::from(hole.entry) - surface).dot(&Vector3::from(hole.axis));
                if SAME_LEVEL < below && below < hole.depth {
                    sink(hole, below)?;
                    sunk += 1;
                }
            }
            "entries lie on the surface of the part".to_owned()
        }
        (None, Some(clearance)) => {
            for (hole, drilled) in list.holes.iter_mut().zip(&firsts) {
                sink(hole, drilled.deepest_feed_start())?;
                sink(hole, clearance)?;
            }
            format!("entries lie {} below the start of the feed", length(clearance, simulation))
        }
        (None, None) => {
            for (hole, drilled) in list.holes.iter_mut().zip(&firsts) {
                sink(hole, drilled.deepest_feed_start())?;
            }
            "entries lie where the feed begins (R point level): give --clearance, or [stock] in the \
                         machine file"
                .to_owned()
        }
    };
    let mut unlisted = (0, BTreeSet::new());
    for (index, (hole, drilled)) in list.holes.iter_mut().zip(&firsts).enumerate() {
        let (entry, out) = (Point3::from(hole.entry), Vector3::from(hole.axis));
        hole.features = drilled.features(&entry, &out, &request.machine);
        let has_cone = hole.features.iter().any(|feature| feature.kind == FeatureKind::Countersink);
        if body.is_none() && clearance.is_none() && has_cone {
            return Err(UsageError::new(format!(
                "nothing is written: the diameter of the countersink of hole {} counts from the surface, which is unknown: give \
                 --clearance with the distance of the R point level from it, or [stock] in the machine file",
                index + 1
            )));
        }
        match hole.features.is_empty() {
            true => {
                let tools = drilled.tools_of_unknown_shape(&request.machine);
                unlisted.0 += usize::from(!tools.is_empty() && hole.diameter.is_some());
                unlisted.1.extend(tools.into_iter().filter(|_| hole.diameter.is_some()));
            }
            false => hole.diameter = None,
        }
        let far_side = body.and_then(|body| thickness(&body, &entry, &out));
        if let Some(thick) =
            far_side.filter(|thick| drilled.breaks_out(&entry, &out, *thick, &request.machine))
        {
            (hole.through, hole.depth) = (true, thick);
            let depths = hole.features.iter_mut().filter_map(|feature| feature.depth.as_mut());
            depths.for_each(|depth| *depth = depth.min(thick));
        }
        hole.id = Some((index + 1).to_string());
        hole.from = None;
    }
    let is_inch = simulation.run.control.is_inch();
    list = if is_inch { list.in_inches() } else { list };
    // A tenth of a micrometre, and the nearest decimal place in inches.
    let parts = if is_inch { 1e5 } else { 1e4 };
    for hole in &mut list.holes {
        hole.entry = hole.entry.map(|value| rounded(value, parts));
        hole.axis = hole.axis.map(|value| rounded(value, 1e6));
        hole.depth = rounded(hole.depth, parts);
        hole.diameter = hole.diameter.map(|diameter| rounded(diameter, parts));
        for feature in &mut hole.features {
            feature.diameter = rounded(feature.diameter, parts);
            feature.depth = feature.depth.map(|depth| rounded(depth, parts));
            // A pitch is a number of threads an inch.
            feature.pitch = feature.pitch.map(|pitch| rounded(pitch, parts * 10.0));
        }
    }
    Ok(MadeList { list, entries, sunk, unlisted })
}

/// Returns the part's surface, or the stock of the machine file.
fn body(request: &Request) -> Option<Surface> {
    request.part.as_ref().map(PartSolid::body).or_else(|| request.machine.stock.as_ref()?.body(None))
}

/// Returns a length as the program gives it.
fn length(value: f64, simulation: &Simulation) -> String {
    match simulation.run.control.is_inch() {
        true => format!("{} inch", rounded(value / MM_PER_INCH, 1e9)),
        false => format!("{value} mm"),
    }
}

/// Returns the distance from an entry to the opposite side of a body; `None` where the wall of a hole may be longer than its axis:
/// it runs askew, or across a rod beside its axis.
fn thickness(body: &Surface, entry: &Point3<f64>, out: &Vector3<f64>) -> Option<f64> {
    let is_straight = match body {
        Surface::Block { .. } => 1.0 - 1e-9 < out.amax(),
        Surface::Rod(rod) => {
            let cosine = rod.axis.dot(out).abs();
            let aside = (entry - rod.base).dot(&rod.axis.cross(out)).abs();
            1.0 - 1e-9 < cosine || cosine < 1e-9 && aside < SAME_LEVEL
        }
        Surface::Ellipsoid { .. } | Surface::Cylinder { .. } => false,
    };
    let far = body.exit(entry, &-Unit::new_normalize(*out)).filter(|_| is_straight)?;
    Some((entry - far).dot(out)).filter(|thick| 0.0 < *thick)
}

/// Returns the holes, each once, with their indices in the extraction.
fn first_on_lines(drilled: &[DrilledHole]) -> impl Iterator<Item = (usize, &DrilledHole)> {
    drilled.iter().enumerate().filter(|(index, hole)| hole.first_on_line == *index)
}

/// Moves the entry of a hole into the part; its bottom stays.
fn sink(hole: &mut Hole, clearance: f64) -> Result<(), UsageError> {
    if hole.depth <= clearance {
        let depth = hole.depth;
        return Err(UsageError::new(format!(
            "--clearance {clearance}: a feed is only {depth:.3} mm long: give a shorter distance, or [stock] in \
             the machine file"
        )));
    }
    hole.depth -= clearance;
    for (entry, out) in hole.entry.iter_mut().zip(hole.axis) {
        *entry -= out * clearance;
    }
    Ok(())
}

/// Rounds to a multiple of 1/`parts`; −0 becomes 0.
fn rounded(value: f64, parts: f64) -> f64 {
    (value * parts).round() / parts + 0.0
}
