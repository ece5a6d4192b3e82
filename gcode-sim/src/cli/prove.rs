//! `gcode-sim prove`: claims on a program for all values of its variables at once.
#![expect(clippy::disallowed_methods, reason = "the command line reads the clock")]

use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::sync::Mutex;
use std::time::{Duration, Instant};

use clap::Args;

use super::conditions::ProgramArguments;
use super::format::TextFormat;
use super::library::Folders;
use super::rerun::Rerun;
use super::{ExitStatus, UsageError, common, options, output, progress};
use crate::report::proof::ProofReport;
use gcode_control::Control;
use gcode_prove::{Ask, ClaimVerdict, Setup, Watch, prove};
use gcode_session::Request;

/// Part of the time after which the proof ends: the rest is for what is under way, and the report.
const WORKING_PART: f64 = 0.96;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// A local or common variable and the limits of its values, e.g. '#1=0.1..9.9' (repeatable)
    #[arg(long = "range", value_name = "#N=LOW..HIGH", allow_hyphen_values = true, display_order = 0)]
    ranges: Vec<String>,

    /// A condition on these values, e.g. '#3 LE #1' (repeatable): values that don't satisfy it are left out
    #[arg(long = "where", value_name = "CONDITION", allow_hyphen_values = true, display_order = 0)]
    conditions: Vec<String>,

    /// What is to hold for all values (repeatable): a condition at the end, '#100 LE 12.1'; no-alarm; 'alarm MC3001|MC3002';
    /// 'blocks LE 500'; 'travel 1320=X100.'
    #[arg(long = "claim", value_name = "CLAIM", allow_hyphen_values = true, display_order = 0)]
    claims: Vec<String>,

    /// A variable whose least and largest value at the end are to be enclosed, e.g. '#100' (repeatable)
    #[arg(long, value_name = "#N", display_order = 0)]
    bounds: Vec<String>,

    /// Run this block instead of the program, e.g. 'G65 P8101 A#101 B700.'
    #[arg(long, value_name = "BLOCK", display_order = 0)]
    call: Option<String>,

    /// Largest time, seconds
    #[arg(
        long,
        value_name = "SECONDS",
        default_value_t = 10.0,
        allow_negative_numbers = true,
        display_order = 0,
        value_parser = common::number
    )]
    time: f64,

    /// Part of each result by which the control's arithmetic may be off from that of doubles, such as 1e-9
    #[arg(
        long = "widen",
        value_name = "PART",
        default_value_t = 0.0,
        allow_negative_numbers = true,
        display_order = 0,
        value_parser = common::number
    )]
    widening: f64,

    /// Number of threads [default: the number of processors]
    #[arg(long, value_name = "N", display_order = 0)]
    threads: Option<NonZeroUsize>,

    /// Output format
    #[arg(long, value_enum, default_value_t = TextFormat::Text)]
    format: TextFormat,

    #[command(flatten)]
    program: ProgramArguments,
}

/// Source of the controls of a request.
struct Controls<'a> {
    request: &'a Request,
    found: &'a Mutex<Found>,
    call: Option<&'a str>,
}

/// Called programs that have been searched, by number and by name; a folder is read once, not by every thread.
#[derive(Default)]
struct Found {
    folders: Option<Folders>,
    by_number: BTreeMap<u32, FoundProgram>,
    by_name: BTreeMap<String, FoundProgram>,
}

/// Name and text of a program, if there is one.
type FoundProgram = Option<(String, gcode_lang::source::Bytes)>;

/// Library of one thread.
struct SharedFolders<'a>(&'a Mutex<Found>);

impl SharedFolders<'_> {
    fn found(&self) -> std::sync::MutexGuard<'_, Found> {
        self.0.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
    }
}

impl gcode_lang::program::Library for SharedFolders<'_> {
    fn program(&mut self, number: u32) -> FoundProgram {
        let Found { folders, by_number, .. } = &mut *self.found();
        by_number.entry(number).or_insert_with(|| folders.as_mut()?.program(number)).clone()
    }

    fn named(&mut self, name: &str) -> FoundProgram {
        let Found { folders, by_name, .. } = &mut *self.found();
        by_name.entry(name.to_owned()).or_insert_with(|| folders.as_mut()?.named(name)).clone()
    }

    fn read_error(&self) -> Option<String> {
        self.found().folders.as_ref()?.read_error()
    }
}

impl<'a> Setup for Controls<'a> {
    type Library = SharedFolders<'a>;

    fn control(&self, settings: &[(String, String)]) -> Result<Control, String> {
        let request = self.request.with_settings(settings);
        let request = request.map_err(|error| format!("--claim travel: {error}"))?;
        gcode_session::set_up(&request, self.call).map_err(|error| error.to_string())
    }

    fn library(&self) -> SharedFolders<'a> {
        SharedFolders(self.found)
    }
}

/// Returns true if a setting sets a variable that has a range.
fn names_range(set: &str, ranges: &[String]) -> bool {
    let variable = |text: &str| text.split_once('=').map(|(variable, _)| variable.trim().to_owned());
    let set = variable(set);
    set.is_some() && ranges.iter().any(|range| variable(range) == set)
}

pub(super) fn run(arguments: &Arguments) -> Result<ExitStatus, UsageError> {
    let (program, _) = arguments.program.completed()?;
    let (request, _) = options::checked_request(&program, None, None, None)?;
    if request.part.is_some() {
        return Err(UsageError::new("--part: prove follows no probe on a part: omit it"));
    }
    if !(arguments.time > 0.0 && arguments.time <= 86_400.0) {
        return Err(UsageError::new(format!("--time {}: seconds above 0, up to 86400", arguments.time)));
    }
    if let Some(call) = &arguments.call
        && (call.trim().is_empty() || call.contains(['\n', ';']))
    {
        return Err(UsageError::new("--call: write one block, 'G65 P8101 A#101'"));
    }
    let conditions = &arguments.program.conditions;
    if let Some(set) = conditions.set.iter().find(|set| names_range(set, &arguments.ranges)) {
        return Err(UsageError::new(format!("--set '{set}': this variable has a --range: omit one of them")));
    }
    let one = NonZeroUsize::MIN;
    let ask = Ask {
        ranges: arguments.ranges.clone(),
        conditions: arguments.conditions.clone(),
        claims: arguments.claims.clone(),
        bounds: arguments.bounds.clone(),
        max_blocks: request.limits.blocks,
        threads: arguments.threads.unwrap_or_else(|| std::thread::available_parallelism().unwrap_or(one)),
        widening: arguments.widening,
    };
    // The folders have been checked with the request.
    let folders = Folders::new(&program.program, &program.conditions.libraries).ok();
    let found = Mutex::new(Found { folders, ..Found::default() });
    let controls = Controls { request: &request, found: &found, call: arguments.call.as_deref() };
    let start = Instant::now();
    let clock = || start.elapsed();
    let watch = Watch::new(&clock, Duration::from_secs_f64(arguments.time * WORKING_PART));
    let answer = progress::of_proof(&watch, || prove(&controls, &ask, &watch));
    let answer = answer.map_err(|error| UsageError::new(error.to_string()))?;
    let rerun = Rerun::new(&program.program, &arguments.program.conditions, arguments.call.clone());
    let report = ProofReport::new(&answer, start.elapsed().as_secs_f64(), rerun);
    output::report(&report, ProofReport::text, arguments.format)?;
    Ok(if answer.verdict == ClaimVerdict::Proved { ExitStatus::Passed } else { ExitStatus::Failed })
}
