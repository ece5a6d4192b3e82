//! What is proved of resident macros, by the SHA-256 of their texts.
use std::collections::BTreeMap;

use gcode_sim::report::encode::sha256;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::package::{Package, stem};

/// Table of proofs.
const TABLE: &str = include_str!("proved.toml");

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Table {
    proof: Vec<Entry>,
}

/// One proof.
#[derive(Clone, Debug, Deserialize)]
struct Entry {
    /// Macros that the proof is about, each with its digest.
    macros: BTreeMap<String, String>,
    /// Statement for people.
    says: String,
    /// How it is proved: `gcode-gen prove`, or the flags of `gcode-sim prove`.
    #[serde(flatten)]
    #[cfg_attr(not(test), expect(dead_code, reason = "the test proves each entry by it"))]
    way: BTreeMap<String, toml::Value>,
}

/// What is proved of some macros.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct ProvedMacros {
    /// The macros, by their names: `O8101`.
    pub macros: Vec<String>,
    /// The statement.
    pub says: String,
}

fn table() -> Vec<Entry> {
    // The test reads the table too.
    toml::from_str::<Table>(TABLE).map(|table| table.proof).unwrap_or_default()
}

/// Returns what is proved of a package's macros, as they are written there.
pub fn proved(package: &Package) -> Vec<ProvedMacros> {
    let digests = digests(package);
    let is_same = |entry: &Entry| entry.macros.iter().all(|(name, digest)| digests.get(name) == Some(digest));
    let entries = table().into_iter().filter(is_same);
    entries
        .map(|entry| ProvedMacros { macros: entry.macros.into_keys().collect(), says: entry.says })
        .collect()
}

/// Returns the macros of a package of which no proof is recorded in this form.
pub fn not_proved(package: &Package, proved: &[ProvedMacros]) -> Vec<String> {
    let is_proved = |name: &String| proved.iter().any(|one| one.macros.contains(name));
    digests(package).into_keys().filter(|name| !is_proved(name)).collect()
}

/// Returns the digests of a package's macros by their names.
fn digests(package: &Package) -> BTreeMap<String, String> {
    let macros = package.programs.iter().filter(|program| !package.mains.contains(&program.number));
    macros.map(|program| (stem(program.number), sha256(program.text.as_bytes()))).collect()
}

#[cfg(test)]
mod tests {
    use std::num::NonZeroUsize;
    use std::time::Duration;

    use gcode_inspect::machine::Machine;
    use gcode_part::job::Job;
    use gcode_prove::{Ask, ClaimVerdict, Watch, prove};
    use gcode_session::Request;

    use super::*;
    use crate::families::{ALL, emit};
    use crate::proof::controls::Controls;
    use crate::proof::{ProofRequest, prove_job};

    /// The new job whose programs have a macro.
    fn job_with(name: &str) -> (Job, Package) {
        let jobs = ALL.iter().map(|family| Job::parse(family.new_job).unwrap());
        let packages = jobs.map(|job| (emit(&job), job)).map(|(package, job)| (job, package));
        let mut found = packages.filter(|(_, package)| digests(package).contains_key(name));
        found.next().unwrap_or_else(|| panic!("no family has {name}"))
    }

    fn texts(entry: &Entry, key: &str) -> Vec<String> {
        let list = entry.way.get(key).and_then(toml::Value::as_array).cloned().unwrap_or_default();
        list.iter().map(|text| text.as_str().unwrap().to_owned()).collect()
    }

    fn is_proved(entry: &Entry, job: &Job, package: &Package) -> bool {
        let clock = || Duration::ZERO;
        let threads = NonZeroUsize::new(2).unwrap();
        if let Some(tolerance) = entry.way.get("tolerance") {
            let tolerances = [tolerance.as_float().unwrap()];
            let (over, limit) = (texts(entry, "over"), Duration::from_secs(300));
            let (over, tolerances, clock) = (&over[..], &tolerances[..], &clock);
            let proof = prove_job(&ProofRequest { job, package, over, tolerances, threads, clock, limit });
            let wanted = texts(entry, "claims");
            let proof = proof.unwrap();
            let claims = proof.cases.iter().flat_map(|case| &case.claims);
            let mut own = claims.filter(|claim| wanted.iter().any(|wanted| claim.claim.starts_with(wanted)));
            assert!(own.clone().count() >= wanted.len() * proof.cases.len());
            return own.all(|claim| claim.verdict == ClaimVerdict::Proved);
        }
        let start = entry
            .way
            .get("start")
            .map_or_else(String::new, |start| format!("\n[start]\n{}\n", start.as_str().unwrap()));
        let machine = Machine::parse(&format!("{}{start}", package.machine)).unwrap();
        let mut request = Request::new("O9000.nc", *b"O9000\nM30\n", machine);
        request.variables = texts(entry, "set")
            .iter()
            .map(|text| text.trim_start_matches('#').split_once('=').unwrap())
            .map(|(variable, value)| (variable.parse().unwrap(), value.parse().unwrap()))
            .collect();
        let call = entry.way["call"].as_str().unwrap().to_owned();
        let controls = Controls { request, call: Some(call), programs: package };
        let ask = Ask {
            ranges: texts(entry, "range"),
            conditions: texts(entry, "where"),
            claims: texts(entry, "claim"),
            threads,
            ..Ask::default()
        };
        let watch = Watch::new(&clock, Duration::from_secs(300));
        prove(&controls, &ask, &watch).unwrap().verdict == ClaimVerdict::Proved
    }

    /// A macro that has changed must be proved again before its new digest is entered.
    #[test]
    fn each_entry_is_proved_of_the_macro_as_it_is_emitted() {
        let entries = toml::from_str::<Table>(TABLE).unwrap().proof;
        for entry in &entries {
            let name = entry.macros.keys().next().unwrap();
            let (job, package) = job_with(name);
            let own = digests(&package);
            let changed: Vec<_> =
                entry.macros.keys().filter(|name| own[*name] != entry.macros[*name]).collect();
            assert!(
                changed.is_empty(),
                "{changed:?} has changed: prove '{}' again and enter its digest",
                entry.says
            );
            assert!(is_proved(entry, &job, &package), "{}", entry.says);
        }
    }

    #[test]
    fn a_changed_macro_has_no_proof() {
        let (_, mut package) = job_with("O8101");
        assert!(!proved(&package).is_empty());
        assert!(not_proved(&package, &proved(&package)).is_empty());
        for program in package.programs.iter_mut().filter(|program| program.number == 8102) {
            program.text = program.text.replace("1000.", "100.");
        }
        // What O8101 does depends on O8102.
        assert_eq!(proved(&package), []);
        assert_eq!(not_proved(&package, &[]), ["O8101", "O8102"]);
    }
}
