//! `test` on folders: links lead to no case twice and to no endless walk, and a broken link is no case that passes; the merged shards of
//! several folders are the whole run.
#![cfg(unix)]
use std::os::unix::fs::symlink;
use std::path::Path;

use gcode_tests::programs::run_line;

const PROGRAM: &str = "O0300\nG00 X1.\nM30\n";

/// A collection of one accepted case, `plate`.
fn collection() -> tempfile::TempDir {
    let place = tempfile::tempdir().unwrap();
    std::fs::create_dir_all(place.path().join("parts/plate")).unwrap();
    std::fs::write(place.path().join("parts/plate/O0300.nc"), PROGRAM).unwrap();
    assert_eq!(run("--accept", place.path()), (0, "accepted plate\n1 case: 1 as accepted\n".to_owned()));
    place
}

fn run(more: &str, place: &Path) -> (i32, String) {
    let done = run_line(&format!("gcode-sim test parts {more}"), place);
    (done.status.code().unwrap(), String::from_utf8(done.stdout).unwrap())
}

#[test]
fn a_link_back_up_and_a_second_way_to_a_case_count_once() {
    let place = collection();
    symlink(".", place.path().join("parts/self")).unwrap();
    symlink("plate", place.path().join("parts/again")).unwrap();
    assert_eq!(run("", place.path()), (0, "1 case: 1 as accepted\n".to_owned()));
}

#[test]
fn a_case_behind_a_link_is_run() {
    let place = collection();
    std::fs::rename(place.path().join("parts/plate"), place.path().join("elsewhere")).unwrap();
    symlink("../elsewhere", place.path().join("parts/plate")).unwrap();
    assert_eq!(run("", place.path()), (0, "1 case: 1 as accepted\n".to_owned()));
}

#[test]
fn a_broken_link_is_reported() {
    let place = collection();
    let program = place.path().join("parts/plate/O0300.nc");
    std::fs::remove_file(&program).unwrap();
    let (code, text) = run("", place.path());
    assert_eq!(
        (code, text.contains("refused  plate: parts/plate has accepted.json and no program")),
        (2, true)
    );

    symlink("gone.nc", &program).unwrap();
    let (code, text) = run("", place.path());
    assert_eq!(
        (code, text.contains("refused  plate: parts/plate/O0300.nc cannot be read")),
        (2, true),
        "{text}"
    );

    std::fs::remove_file(&program).unwrap();
    std::fs::create_dir(&program).unwrap();
    assert_eq!(run("", place.path()).0, 2);

    symlink("../gone", place.path().join("parts/cover")).unwrap();
    let (code, text) = run("--only cover", place.path());
    assert_eq!((code, text.contains("refused  cover: parts/cover is a broken link")), (2, true));
}

#[test]
fn accepted_results_behind_a_broken_link_are_refused() {
    let place = collection();
    let accepted = place.path().join("parts/plate/accepted.json");
    std::fs::remove_file(&accepted).unwrap();
    symlink("gone.json", &accepted).unwrap();
    assert_eq!(run("", place.path()).0, 2);
}

/// Of two folders, the one that was named first comes second by its name.
#[test]
fn two_folders_in_shards_are_the_whole_run_in_every_format() {
    let place = collection();
    for (case, program) in [("more/a", PROGRAM), ("more/b", "O1\nG0 X1.\n#3000=1(NO PART)\nM30\n")] {
        let folder = place.path().join(case);
        std::fs::create_dir_all(&folder).unwrap();
        std::fs::write(folder.join("main.nc"), program).unwrap();
    }
    std::fs::write(place.path().join("parts/plate/O0300.nc"), PROGRAM.replace("X1.", "X2.")).unwrap();
    let of = |arguments: &str| {
        let done = run_line(&format!("gcode-sim test {arguments}"), place.path());
        (done.status.code().unwrap(), String::from_utf8(done.stdout).unwrap())
    };
    for shard in [1, 2] {
        let (code, result) = of(&format!("parts more --shard {shard}/2 --format json"));
        assert_eq!(code, 1, "{result}");
        std::fs::write(place.path().join(format!("{shard}.json")), result).unwrap();
    }
    for format in ["text", "json", "junit", "sarif"] {
        let whole = of(&format!("parts more --format {format}"));
        assert_eq!(of(&format!("--merge 2.json 1.json --format {format}")), whole, "{format}");
        let places = ["more/a", "more/b", "parts/plate"].map(|name| whole.1.find(name).unwrap());
        assert!(places.is_sorted(), "{format}: {}", whole.1);
    }
}
