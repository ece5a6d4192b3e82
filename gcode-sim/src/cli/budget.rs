//! `gcode-sim budget`: the spread of every hole's position under errors of set-up and machine.
use std::fmt::Display;
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::sync::atomic::AtomicUsize;

use clap::Args;

use super::format::TextFormat;
use super::picture_file::PictureFile;
use super::{ExitStatus, UsageError, common, input, options, output, overwrite_guard, progress};
use crate::report::budget::BudgetReport;
use gcode_draw::Size;
use gcode_inspect::budget::{BudgetRequest, MAX_SAMPLES, budget};
use gcode_inspect::machine::{Machine, error_file};
use gcode_inspect::verify::Tolerances;
use gcode_part::NominalPart;
use gcode_part::job::Job;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// The job file: the holes, and the machine they are drilled on
    #[arg(value_name = "JOB.toml")]
    job: PathBuf,

    /// The set-up and machine errors
    #[arg(long, value_name = "ERRORS.toml", display_order = 0)]
    errors: PathBuf,

    /// Number of simulated parts
    #[arg(long, value_name = "N", default_value_t = 100_000)]
    samples: usize,

    /// Seed of the random numbers
    #[arg(long, value_name = "S", default_value_t = 0)]
    seed: u64,

    /// The machine, without errors [default: the job's machine]
    #[arg(long, value_name = "MACHINE.toml")]
    machine: Option<PathBuf>,

    /// Diameter of the tolerance zone, mm [default: the job's]
    #[arg(long, value_name = "MM", allow_negative_numbers = true, value_parser = common::number)]
    tolerance: Option<f64>,

    /// Number of threads; the result does not depend on it [default: the number of processors]
    #[arg(long, value_name = "N")]
    threads: Option<NonZeroUsize>,

    /// Also draw each error source's share to this file
    #[arg(long, value_name = "OUT.png", value_parser = PictureFile::parser())]
    picture: Option<PictureFile>,

    /// Output format
    #[arg(long, value_enum, default_value_t = TextFormat::Text)]
    format: TextFormat,
}

pub(super) fn run(arguments: &Arguments) -> Result<ExitStatus, UsageError> {
    let in_job = |error: &dyn Display| UsageError::in_file(&arguments.job, error);
    let tolerance = options::tolerance("--tolerance", arguments.tolerance)?;
    if !(1..=MAX_SAMPLES).contains(&arguments.samples) {
        return Err(UsageError::new(format!("--samples {}: 1 to {MAX_SAMPLES}", arguments.samples)));
    }
    if let Some(file) = &arguments.picture {
        let machine = arguments.machine.as_deref();
        let files = [arguments.job.as_path(), arguments.errors.as_path()].into_iter().chain(machine);
        overwrite_guard::check_not_input(file.path(), &files.collect::<Vec<_>>())?;
    }
    let job =
        Job::parse(&input::text(&arguments.job)?).map_err(|e| UsageError::in_toml(&arguments.job, &e))?;
    let reference = NominalPart::from_job(&job).map_err(|e| in_job(&e))?.into_holes();
    let reference =
        reference.ok_or_else(|| in_job(&"a budget needs holes, and this family's part has none"))?;
    let machine = match &arguments.machine {
        Some(path) => options::read_machine(path)?,
        None => Machine::from_job(&job)
            .ok_or_else(|| in_job(&"this job has no machine: give one with --machine"))?,
    };
    if !machine.is_exact() {
        let message =
            "--machine: the file has errors or a misplaced part; a budget takes those from --errors alone";
        return Err(UsageError::new(message));
    }
    let sources = error_file(&input::text(&arguments.errors)?, &machine)
        .map_err(|error| UsageError::in_toml(&arguments.errors, &error))?;
    let one = NonZeroUsize::MIN;
    let request = BudgetRequest {
        machine: &machine,
        holes: &reference.holes,
        clearance: job.clearance(),
        sources: &sources,
        samples: arguments.samples,
        seed: arguments.seed,
        threads: arguments.threads.unwrap_or_else(|| std::thread::available_parallelism().unwrap_or(one)),
        tolerance: Tolerances::of(&reference, tolerance).position,
    };
    let counted = AtomicUsize::new(0);
    let all = arguments.samples.saturating_mul(reference.holes.len());
    let result = progress::with_progress(all, &counted, || budget(&request, &counted))
        .map_err(|error| in_job(&error))?;
    let report = BudgetReport::new(&request, &result);
    output::report(&report, BudgetReport::text, arguments.format)?;
    if let Some(file) = &arguments.picture {
        // The height grows with the number of bars.
        let height = 120 + 25 * sources.len() as u32;
        file.plot(&report.bars(), Size::new(1200, height.max(360))?)?;
        output::written("picture", file.path(), arguments.format == TextFormat::Text)?;
    }
    Ok(ExitStatus::Passed)
}
