//! Every example and every macro has accepted results: a change that moves a hole fails here until it is accepted.
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use gcode_control::Limits;
use gcode_inspect::machine::{Machine, Probe};
use gcode_lang::program::Library;
use gcode_lang::source::Bytes;
use gcode_lang::units::Deg;
use gcode_part::ProbedPart;
use gcode_review::{Record, Revision, changes};
use gcode_session::Request;
use gcode_sim::cli::library::Folders;
use gcode_sim::report::changes::ChangesReport;
use gcode_tests::verify::machine_of;
use gcode_tests::workspace;

/// Limit of executed blocks: the first rows of a honeycomb show the effect of its macro, and the whole is compared with the reference
/// elsewhere.
const BLOCKS: u64 = 2000;
const TOLERANCE: f64 = 0.0001;
const REMEDY: &str = "look at the change; where it is meant, cargo xtask bless accepts it";

fn folder(path: &Path) -> Vec<PathBuf> {
    let mut found: Vec<_> = std::fs::read_dir(path).unwrap().map(|entry| entry.unwrap().path()).collect();
    found.sort();
    found
}

/// The main programs of the examples, macros and subprograms left out.
pub(crate) fn mains() -> Vec<PathBuf> {
    let files = folder(&workspace().join("examples")).into_iter().filter(|path| path.is_dir());
    let files = files.flat_map(|path| folder(&path));
    let is_main = |path: &PathBuf| {
        path.extension().is_some_and(|e| e == "nc") && std::fs::read_to_string(path).unwrap().contains("M30")
    };
    files.filter(is_main).collect()
}

/// Where a program finds its machine and its macros: beside it, or with the example it is a variant of.
fn home(main: &Path) -> PathBuf {
    let own = main.parent().unwrap();
    match own.file_name().is_some_and(|name| name == "one-digit-wrong") {
        true => workspace().join("examples/melon-mould"),
        false => own.to_owned(),
    }
}

pub(crate) fn request(main: &Path) -> Request {
    let home = home(main);
    let read = |name: &str| std::fs::read_to_string(home.join(name)).ok();
    // A case about a slip in its machine file runs on the default machine.
    let machine = machine_of(&home).and_then(|text| Machine::parse(&text).ok()).unwrap_or_default();
    let name = main.strip_prefix(workspace()).unwrap().display().to_string();
    let mut request = Request::new(name, std::fs::read(main).unwrap(), machine);
    request.limits = Limits { blocks: BLOCKS };
    // Programs that probe find the part of their job there.
    if let Some(Ok(ProbedPart { solid, radius: Some(radius), .. })) =
        read("job.toml").map(|text| ProbedPart::parse(&text, None))
    {
        request.part = Some(solid);
        request.machine.probe.get_or_insert(Probe::new(radius));
        request.variables = candidates();
    }
    request
}

/// Candidates of the points E and F before a program matches their chord: ten of each, 36° apart on a
/// circle of radius 1 mm about x = 812.4 and x = 318 of the ellipsoid 1158.8, 724.3. Three variables a point from #501 on.
fn candidates() -> Vec<(u32, f64)> {
    let points = [812.4, 318.0].into_iter().flat_map(|x| (0..10).map(move |k| (x, Deg(36.0 * f64::from(k)))));
    let coordinates = points.flat_map(|(x, angle)| {
        let (x, z) = (x + angle.cos(), angle.sin());
        [x, 724.3 * (1.0 - (x * x + z * z) / (1158.8 * 1158.8)).sqrt(), z]
    });
    (501..).zip(coordinates).collect()
}

fn revision(main: &Path, library: &mut impl Library) -> Revision {
    Revision::of(&request(main), library, None).unwrap_or_else(|e| panic!("{}: {e}", main.display()))
}

/// `O8101` of `macros/O8101_pin_hole.nc`.
fn resident() -> impl Iterator<Item = String> {
    let files = folder(&workspace().join("macros")).into_iter();
    let names = files.filter_map(|path| Some(path.file_name()?.to_str()?.strip_suffix(".nc")?.to_owned()));
    names.filter_map(|name| Some(name.split_once('_')?.0.to_owned()))
}

pub(crate) fn folders(main: &Path) -> Folders {
    Folders::new(main, &[home(main)]).unwrap()
}

/// `examples/melon-mould/O8100.nc` is accepted in `tests/accepted/melon-mould/O8100.json`.
fn accepted(main: &Path) -> PathBuf {
    let below = main.strip_prefix(workspace().join("examples")).unwrap();
    workspace().join("tests/accepted").join(below).with_extension("json")
}

/// The differences from the accepted result as `diff` shows them; `None` if there is none.
fn describe_difference(name: &str, old: &Record, new: &Record) -> Option<String> {
    let found = changes(old, new, TOLERANCE);
    let report = ChangesReport::new(("as accepted", old), (name, new), &found, Vec::new(), TOLERANCE);
    (!found.is_empty()).then(|| report.text())
}

#[test]
fn every_example_runs_as_accepted_and_every_macro_is_in_one() {
    let mut wrong = String::new();
    let mut executed = BTreeSet::new();
    for main in mains() {
        let (revision, file) = (revision(&main, &mut folders(&main)), accepted(&main));
        executed.extend(revision.files().into_keys());
        let record = revision.record;
        let name = main.strip_prefix(workspace()).unwrap().display().to_string();
        let known = std::fs::read_to_string(&file)
            .ok()
            .map(|text| Record::from_json(&text).unwrap_or_else(|e| panic!("{}: {e}", file.display())));
        let change = match &known {
            Some(known) if known.is_legacy() => Some("accepted by an earlier version\n".to_owned()),
            Some(known) => describe_difference(&name, known, &record),
            None => Some("nothing is accepted yet\n".to_owned()),
        };
        let Some(change) = change else { continue };
        if std::env::var("BLESS").is_ok() {
            std::fs::create_dir_all(file.parent().unwrap()).unwrap();
            std::fs::write(&file, record.to_json().unwrap()).unwrap();
        } else {
            wrong.push_str(&format!("{name}:\n{change}{REMEDY}\n"));
        }
    }
    for name in resident().filter(|name| !executed.contains(name)) {
        wrong.push_str(&format!("macros/{name}: no example calls it: add one to examples/\n"));
    }
    assert!(wrong.is_empty(), "{wrong}");
}

#[test]
fn every_accepted_result_has_its_program() {
    let known: Vec<PathBuf> = mains().iter().map(|main| accepted(main)).collect();
    for file in folder(&workspace().join("tests/accepted")).iter().flat_map(|path| folder(path)) {
        assert!(known.contains(&file), "{}: its example is gone: delete it", file.display());
    }
}

/// The folders of a main program, whose called programs are edited as they are read, by the names of their files.
pub(crate) struct EditedLibrary<F> {
    folders: Folders,
    edit: F,
}

impl<F: FnMut(&str, String) -> String> EditedLibrary<F> {
    pub(crate) fn new(main: &Path, edit: F) -> Self {
        Self { folders: folders(main), edit }
    }

    fn edited(&mut self, found: Option<(String, Bytes)>) -> Option<(String, Bytes)> {
        let (name, bytes) = found?;
        let text = (self.edit)(&name, String::from_utf8(bytes.to_vec()).unwrap());
        Some((name, text.into_bytes().into()))
    }
}

impl<F: FnMut(&str, String) -> String> Library for EditedLibrary<F> {
    fn program(&mut self, number: u32) -> Option<(String, Bytes)> {
        let found = self.folders.program(number);
        self.edited(found)
    }

    fn named(&mut self, name: &str) -> Option<(String, Bytes)> {
        let found = self.folders.named(name);
        self.edited(found)
    }
}

/// The radius of every hole 0.01 mm larger: hole 1, axial at azimuth 0, moves along x by just that.
#[test]
fn a_macro_that_moves_a_hole_differs_by_that_move() {
    let main = workspace().join("examples/melon-mould/O8100.nc");
    let (from, to) = ("#18+[#17", "#18+0.01+[#17");
    let mut library = EditedLibrary::new(&main, |name, text| {
        assert!(!name.contains("8101") || text.contains(from), "{from} isn't in O8101");
        if name.contains("8101") { text.replace(from, to) } else { text }
    });
    let old = Record::from_json(&std::fs::read_to_string(accepted(&main)).unwrap()).unwrap();
    let text = describe_difference("O8100", &old, &revision(&main, &mut library).record).expect("a change");
    let entry = "hole-moved     holes 1, 2, 3, 4, 5: moved by X +0.0100 of the machine, up to 0.0100 mm (hole 1: \
                 +0.0100 +0.0000 +0.0000 mm)";
    assert!(text.starts_with(entry), "{text}");
    assert!(text.contains("new O8101:"), "{text}");
    assert!(text.contains("called from O8100:"), "{text}");
    assert!(text.contains("\n1 change\n"), "{text}");
}
