//! `gcode-sim run`: executes a program and shows the end state.
use std::path::{Path, PathBuf};

use clap::Args;

use super::conditions::{DenyArguments, ProgramArguments};
use super::format::TextFormat;
use super::{ExitStatus, UsageError, options, output, overwrite_guard, progress, unused_machine};
use crate::report::run::{MAX_MOVES, MoveRecorder, RunReport, StopRecorder};
use gcode_inspect::holes::HoleExtractor;
use gcode_inspect::stylus::RapidChecker;
use gcode_part::Total;
use gcode_session::SessionError;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// Add every move to the result, in machine coordinates
    #[arg(long)]
    moves: bool,

    #[command(flatten)]
    deny: DenyArguments,

    /// Write what the program prints (DPRNT, BPRNT) to this file
    #[arg(long, value_name = "FILE")]
    output: Option<PathBuf>,

    /// Show a system variable at the end, e.g. '#5041' (repeatable)
    #[arg(long, value_name = "#N")]
    show: Vec<String>,

    /// Output format
    #[arg(long, value_enum, default_value_t = TextFormat::Text)]
    format: TextFormat,

    #[command(flatten)]
    program: ProgramArguments,
}

pub(super) fn run(arguments: &Arguments) -> Result<ExitStatus, UsageError> {
    let (program, _) = arguments.program.completed()?;
    let (mut request, mut folders) =
        options::checked_request(&program, None, arguments.output.as_deref(), None)?;
    let shown = arguments.show.iter().map(|text| options::variable(text)).collect::<Result<Vec<_>, _>>()?;
    let (mut stops, mut moves) = (StopRecorder::default(), arguments.moves.then(MoveRecorder::default));
    let (run, rapids, touches) = progress::of_run(&mut request, |request| {
        // The tool is followed only if there is a part for probing.
        let part = request.probed();
        let follow = |part| HoleExtractor::new(&request.machine).with_probed(Some(part));
        let mut probe = part.clone().map(follow);
        // A tool that no file states to be a probe may have drilled and milled the stock before.
        let is_ball_known = request.part.is_some() || request.machine.has_probe_tool();
        let ball = part.filter(|_| is_ball_known).zip(request.machine.probe.as_ref());
        let mut rapids = ball.map(|(part, probe)| RapidChecker::new(&request.machine, part, probe.radius));
        let run = gcode_session::run(
            request,
            &mut folders,
            &mut (&mut (&mut stops, &mut moves), &mut (&mut probe, &mut rapids)),
        )?;
        let touches = probe.map_or(0, |probe| probe.probe_count());
        Ok::<_, SessionError>((run, rapids.map_or_else(Vec::new, RapidChecker::finish), touches))
    })?;
    if request.part.is_none() && 0 < touches {
        output::print_message(
            "note: the probe touches the [stock] of the machine file as it is before the run: what the program cuts stays\n",
        );
    }
    let mut system = Vec::new();
    for number in shown {
        let value = run.control.variable(number);
        system
            .push((number, value.map_err(|alarm| UsageError::new(format!("--show '#{number}': {alarm}")))?));
    }
    if let Some(path) = &arguments.output {
        // The called programs are known only after the run.
        let called = run.control.memory().sources().iter().map(|(_, source)| Path::new(&source.name));
        overwrite_guard::check_not_input(path, &called.collect::<Vec<_>>())?;
        let lines = run.control.output().iter();
        let bytes: Vec<u8> = lines.flat_map(|line| line.iter().copied().chain([b'\n'])).collect();
        output::write(path, &bytes)?;
    }
    let found = run.dependencies(&request);
    let (assumed, holes) = (found.numbered(&run), Total::Holes(found.count()));
    let denied = arguments.deny.errors(&assumed, holes);
    let assumptions = (assumed.into_iter().map(|(assumption, _)| assumption).collect(), holes);
    let report = RunReport::new(&run, &request.machine, (&stops, moves.as_ref()), system, assumptions);
    output::report(&report, RunReport::text, arguments.format)?;
    unused_machine::warn_unused_axes(&program, &request.machine, &run);
    let in_part = super::findings(&rapids, &run);
    let of_run = super::findings(&run.findings().collect::<Vec<_>>(), &run);
    let status = in_part.max(of_run).max(super::findings(&denied, &run));
    if moves.is_some_and(|moves| moves.is_truncated) {
        output::print_message(&format!(
            "error: --moves: more than {MAX_MOVES} moves; later ones are not in the list\n"
        ));
        return Ok(ExitStatus::Stopped);
    }
    Ok(status)
}
