//! Claims of a case: `claims.toml` is proved, but for what `claims.lock` records of the same programs and conditions.
#![expect(clippy::disallowed_methods, reason = "the command line reads the clock")]

use std::collections::BTreeMap;
use std::fmt::Write;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

use crate::cli::library::Folders;
use crate::cli::{UsageError, input};
use crate::report::encode::sha256;
use crate::report::test_report::{ClaimCounts, FirstFailure};
use gcode_control::Control;
use gcode_lang::program::Library;
use gcode_lang::source::Bytes;
use gcode_part::job::claims::{ClaimsFile, ProofRequest};
use gcode_prove::{Ask, ClaimVerdict, ProofAnswer, Setup, Watch, prove};
use gcode_session::Request;

/// Name of the file with the claims.
pub(super) const CLAIMS: &str = "claims.toml";

/// Name of the file that records what is proved.
pub(super) const LOCK: &str = "claims.lock";

/// Seconds for the claims of one request.
const TIME: f64 = 10.0;

#[derive(Default, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct LockFile {
    #[serde(default)]
    proved: Vec<ProvedRequest>,
}

/// Request that is proved.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct ProvedRequest {
    /// Digest of the request, of the main program, of all conditions of its run and of the version of gcode-sim.
    request: String,
    /// Digest of each called program, by its number or name; of one that isn't found, `absent`.
    programs: BTreeMap<String, String>,
}

/// Result of a case's claims.
pub(super) struct ClaimsResult {
    pub counts: ClaimCounts,
    pub failure: Option<FirstFailure>,
    /// Text of the lock file for what is proved now.
    pub lock: String,
}

/// Called programs with their digests.
#[derive(Clone)]
struct RecordingLibrary {
    folders: Arc<Mutex<Folders>>,
    seen: Arc<Mutex<BTreeMap<String, String>>>,
}

impl RecordingLibrary {
    fn record(
        &self,
        name: String,
        find: impl FnOnce(&mut Folders) -> Option<(String, Bytes)>,
    ) -> Option<(String, Bytes)> {
        let found = find(&mut self.folders.lock().unwrap_or_else(PoisonError::into_inner));
        let digest =
            found.as_ref().map_or_else(|| ABSENT.to_owned(), |(_, bytes)| sha256(bytes.file_content()));
        self.seen.lock().unwrap_or_else(PoisonError::into_inner).insert(name, digest);
        found
    }
}

/// Digest of a program that isn't found.
const ABSENT: &str = "absent";

impl Library for RecordingLibrary {
    fn program(&mut self, number: u32) -> Option<(String, Bytes)> {
        self.record(format!("O{number:04}"), |folders| folders.program(number))
    }

    fn named(&mut self, name: &str) -> Option<(String, Bytes)> {
        self.record(name.to_owned(), |folders| folders.named(name))
    }

    fn read_error(&self) -> Option<String> {
        self.folders.lock().unwrap_or_else(PoisonError::into_inner).read_error()
    }
}

/// Source of the controls of a request.
struct Controls<'a> {
    request: &'a Request,
    call: Option<&'a str>,
    library: RecordingLibrary,
}

impl Setup for Controls<'_> {
    type Library = RecordingLibrary;

    fn control(&self, settings: &[(String, String)]) -> Result<Control, String> {
        let request = self.request.with_settings(settings);
        let request = request.map_err(|error| format!("claim travel: {error}"))?;
        gcode_session::set_up(&request, self.call).map_err(|error| error.to_string())
    }

    fn library(&self) -> RecordingLibrary {
        self.library.clone()
    }
}

/// Proves the claims of a file, but for what the lock file records; `is_all` proves these again too.
pub(super) fn check(
    file: &Path,
    lock: &Path,
    request: &Request,
    (program, libraries): (&Path, &[PathBuf]),
    is_all: bool,
) -> Result<ClaimsResult, UsageError> {
    let claims = ClaimsFile::parse(&input::text(file)?).map_err(|error| UsageError::in_file(file, error))?;
    let recorded: LockFile = match lock.exists() && !is_all {
        true => {
            toml::from_str(&input::text(lock)?).map_err(|error| UsageError::in_file(lock, error.message()))?
        }
        false => LockFile::default(),
    };
    let mut proved = LockFile::default();
    let (mut counts, mut failure) = (ClaimCounts::default(), None);
    for one in &claims.proof {
        let digest = digest(one, request);
        let library = || -> Result<RecordingLibrary, UsageError> {
            let folders = Arc::new(Mutex::new(Folders::new(program, libraries)?));
            Ok(RecordingLibrary { folders, seen: Arc::default() })
        };
        let known = recorded.proved.iter().find(|known| known.request == digest);
        if let Some(known) = known
            && is_unchanged(known, library()?)
        {
            counts.kept += one.claim.len();
            proved.proved.push(known.clone());
            continue;
        }
        let controls = Controls { request, call: one.call.as_deref(), library: library()? };
        let answer = prove_one(one, &controls).map_err(|error| UsageError::in_file(file, error))?;
        let number = |verdict| answer.claims.iter().filter(|claim| claim.verdict == verdict).count();
        counts.proved += number(ClaimVerdict::Proved);
        counts.refuted += number(ClaimVerdict::Refuted);
        counts.undecided += number(ClaimVerdict::Undecided);
        if answer.verdict == ClaimVerdict::Proved {
            let programs = controls.library.seen.lock().unwrap_or_else(PoisonError::into_inner).clone();
            proved.proved.push(ProvedRequest { request: digest, programs });
        } else if failure.is_none() {
            failure =
                Some(FirstFailure { code: "claim".to_owned(), message: message(&answer), location: None });
        }
    }
    let mut text = "# What gcode-sim test --accept has proved of claims.toml. A request whose programs and conditions still have these\n\
                    # digests is not proved again.\n"
        .to_owned();
    let records = toml::to_string(&proved).map_err(|error| UsageError::in_file(lock, error))?;
    let _ = write!(text, "\n{records}");
    Ok(ClaimsResult { counts, failure, lock: text })
}

fn prove_one(one: &ProofRequest, controls: &Controls<'_>) -> Result<ProofAnswer, String> {
    let time = one.time.unwrap_or(TIME);
    let ask = Ask {
        ranges: one.range.clone(),
        conditions: one.conditions.clone(),
        claims: one.claim.clone(),
        bounds: Vec::new(),
        max_blocks: controls.request.limits.blocks,
        // Cases run on all cores already.
        threads: NonZeroUsize::MIN,
        widening: 0.0,
    };
    let start = Instant::now();
    let clock = || start.elapsed();
    let watch = Watch::new(&clock, Duration::from_secs_f64(time));
    prove(controls, &ask, &watch).map_err(|error| error.to_string())
}

/// Returns the digest of a request: what is asked, the main program, and the conditions of its run.
fn digest(one: &ProofRequest, request: &Request) -> String {
    let ProofRequest { call, range, conditions, claim, .. } = one;
    let parts = format!(
        "{} {:?} {:?} {:?} {:?} {} {:?} {:?} {:?} {:?}",
        env!("CARGO_PKG_VERSION"),
        call,
        range,
        conditions,
        claim,
        sha256(request.bytes.file_content()),
        request.main,
        request.settings,
        request.machine,
        (request.limits.blocks, &request.variables),
    );
    sha256(parts.as_bytes())
}

/// Returns true if every called program is as it was.
fn is_unchanged(known: &ProvedRequest, mut library: RecordingLibrary) -> bool {
    for name in known.programs.keys() {
        match name.strip_prefix('O').and_then(|digits| digits.parse().ok()) {
            Some(number) => library.program(number),
            None => library.named(name),
        };
    }
    *library.seen.lock().unwrap_or_else(PoisonError::into_inner) == known.programs
}

/// Returns the first claim that isn't proved, as a message.
fn message(answer: &ProofAnswer) -> String {
    let refuted = answer.claims.iter().find(|claim| claim.verdict == ClaimVerdict::Refuted);
    let first = refuted.or_else(|| answer.claims.iter().find(|claim| claim.verdict != ClaimVerdict::Proved));
    let Some(claim) = first else { return "a claim is not proved".to_owned() };
    match &claim.counterexample {
        Some(point) => {
            let values = point.iter().map(|(variable, value)| format!("#{variable}={value}"));
            format!("claim '{}' is refuted at {}", claim.claim, values.collect::<Vec<_>>().join(" "))
        }
        None => {
            let why =
                answer.unfollowed.first().map(|what| format!("; not followed: {what}")).unwrap_or_default();
            format!("claim '{}' is undecided{why}", claim.claim)
        }
    }
}
