//! `gcode-gen prove`: claims on a job's resident macro for all values of its quantities.
#![expect(clippy::disallowed_methods, reason = "the command line reads the clock")]

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use clap::Args;
use gcode_lang::program::Library;
use gcode_part::job::Job;
use gcode_prove::ClaimVerdict;
use gcode_sim::cli::format::TextFormat;
use gcode_sim::cli::library::Folders;
use gcode_sim::cli::{ExitStatus, UsageError, input, output, progress};

use crate::families;
use crate::package::Package;
use crate::proof::report::JobProof;
use crate::proof::{ProofRequest, prove_job};

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// The job file; '-' reads standard input
    #[arg(value_name = "JOB.toml")]
    job: PathBuf,
    /// A quantity of the job and its limits, e.g. 'hole.radius=0..1100' (repeatable): hole.radius, hole.azimuth, hole.depth,
    /// surface.a, surface.b
    #[arg(long, value_name = "KEY=LOW..HIGH", allow_hyphen_values = true)]
    over: Vec<String>,
    /// A position tolerance, mm (repeatable) [default: the job's]
    #[arg(long, value_name = "MM")]
    tolerance: Vec<f64>,
    /// A folder with macros, instead of those that emit writes
    #[arg(long = "lib", value_name = "DIR")]
    library: Option<PathBuf>,
    /// Largest time, seconds
    #[arg(long, value_name = "SECONDS", default_value_t = 300.0)]
    time: f64,
    /// Number of threads [default: the number of processors]
    #[arg(long, value_name = "N")]
    threads: Option<NonZeroUsize>,
    /// Output format
    #[arg(long, value_enum, default_value_t = TextFormat::Text)]
    format: TextFormat,
}

pub(super) fn run(arguments: &Arguments) -> Result<ExitStatus, UsageError> {
    let path = &arguments.job;
    let job = Job::parse(&input::text(path)?).map_err(|error| UsageError::in_toml(path, &error))?;
    if !(arguments.time > 0.0 && arguments.time <= 86_400.0) {
        return Err(UsageError::new(format!("--time {}: seconds above 0, up to 86400", arguments.time)));
    }
    if let Some(tolerance) =
        arguments.tolerance.iter().find(|tolerance| tolerance.is_nan() || **tolerance <= 0.0)
    {
        return Err(UsageError::new(format!("--tolerance {tolerance}: millimetres above 0")));
    }
    let mut package = families::emit(&job);
    if let Some(folder) = &arguments.library {
        replace_macros(&mut package, path, folder)?;
    }
    let start = Instant::now();
    let clock = || start.elapsed();
    let threads = arguments.threads.or_else(|| std::thread::available_parallelism().ok());
    let request = ProofRequest {
        job: &job,
        package: &package,
        over: &arguments.over,
        tolerances: &arguments.tolerance,
        threads: threads.unwrap_or(NonZeroUsize::MIN),
        clock: &clock,
        limit: Duration::from_secs_f64(arguments.time),
    };
    let proof = progress::of_work("proving", || prove_job(&request)).map_err(UsageError::new)?;
    output::report(&proof, JobProof::text, arguments.format)?;
    Ok(if proof.verdict == ClaimVerdict::Proved { ExitStatus::Passed } else { ExitStatus::Failed })
}

/// Replaces the macros of a package by those of a folder that has the same numbers.
fn replace_macros(package: &mut Package, job: &Path, folder: &Path) -> Result<(), UsageError> {
    let mut folders = Folders::new(job, &[folder.to_owned()])?;
    let mut is_found = false;
    for program in &mut package.programs {
        if package.mains.contains(&program.number) {
            continue;
        }
        let Some((name, bytes)) = folders.program(program.number) else { continue };
        program.text = String::from_utf8(bytes.to_vec())
            .map_err(|error| UsageError::new(format!("{name}: {error}: save it as UTF-8")))?;
        is_found = true;
    }
    if let Some(error) = folders.read_error() {
        return Err(UsageError::new(error));
    }
    match is_found {
        true => Ok(()),
        false => Err(UsageError::new(format!(
            "--lib {}: no macro of this job is in the folder: name the folder with O8101",
            folder.display()
        ))),
    }
}
