//! Runs every case folder as one test: `cargo test --test suite -- exec/g81` runs those whose name has that.
use gcode_tests::{KINDS, cases, folders};
use libtest_mimic::{Arguments, Failed, Trial};

fn main() {
    let mut trials = Vec::new();
    for (kind, run) in KINDS {
        for case in cases(kind) {
            trials.push(Trial::test(case.name(), move || {
                run(&case);
                Ok(())
            }));
        }
    }
    trials.push(Trial::test("every_folder_has_a_kind", || {
        match folders().into_iter().find(|folder| KINDS.iter().all(|(kind, _)| kind != folder)) {
            Some(folder) => {
                Err(Failed::from(format!("suite/{folder} is of no kind in support/lib.rs: nothing runs it")))
            }
            None => Ok(()),
        }
    }));
    libtest_mimic::run(&Arguments::from_args(), trials).exit();
}
