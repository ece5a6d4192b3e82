//! The page docs/ci.md in a scratch repository: its hook refuses a changed macro with the page's message and takes it once accepted; the
//! commands of its workflow have the page's results.
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use gcode_tests::programs::{program, run_line};
use gcode_tests::{copy_folder, workspace};

fn example() -> PathBuf {
    workspace().join("examples/nc-repository")
}

/// The folders that programs are looked for in, without gcode-sim.
fn others() -> Vec<PathBuf> {
    let all = std::env::var_os("PATH").unwrap_or_default();
    std::env::split_paths(&all).filter(|folder| !folder.join("gcode-sim").exists()).collect()
}

/// `git` in a repository of its own, whatever the surroundings say, with gcode-sim on its path.
fn git(place: &Path, arguments: &[&str]) -> Output {
    let bin = PathBuf::from(program("gcode-sim").get_program()).parent().unwrap().to_owned();
    git_with(std::iter::once(bin).chain(others()), place, arguments)
}

fn git_with(path: impl IntoIterator<Item = PathBuf>, place: &Path, arguments: &[&str]) -> Output {
    let path = std::env::join_paths(path);
    let mut command = Command::new("git");
    for name in ["GIT_DIR", "GIT_INDEX_FILE", "GIT_WORK_TREE"] {
        command.env_remove(name);
    }
    command.args(["-c", "user.name=Shop", "-c", "user.email=shop@example.com", "-c", "core.hooksPath=hooks"]);
    command.args(arguments).current_dir(place).env("PATH", path.unwrap());
    command.env("GIT_CONFIG_GLOBAL", "/dev/null").env("GIT_CONFIG_SYSTEM", "/dev/null");
    command.output().expect("git is there")
}

fn page() -> String {
    std::fs::read_to_string(workspace().join("docs/ci.md")).unwrap()
}

fn move_the_row(place: &Path) {
    let file = place.join("macros/O9001.nc");
    let text = std::fs::read_to_string(&file).unwrap();
    assert!(text.contains("Y5. "));
    std::fs::write(&file, text.replace("Y5. ", "Y5.01 ")).unwrap();
}

/// The example, committed.
#[cfg(unix)]
fn repository() -> tempfile::TempDir {
    let repository = tempfile::tempdir().unwrap();
    let place = repository.path();
    copy_folder(&example(), place);
    assert!(git(place, &["init", "--quiet"]).status.success());
    git(place, &["add", "--all"]);
    let first = git(place, &["commit", "--quiet", "-m", "Programs"]);
    assert!(first.status.success(), "{first:?}");
    repository
}

/// The messages of a commit, which must be refused with exit code 1.
#[cfg(unix)]
fn refused(commit: Output, place: &Path) -> String {
    assert_eq!(commit.status.code(), Some(1), "{commit:?}");
    let commits = git(place, &["rev-list", "--count", "HEAD"]).stdout;
    assert_eq!(String::from_utf8(commits).unwrap(), "1\n");
    String::from_utf8([commit.stdout, commit.stderr].concat()).unwrap()
}

const COMMIT: [&str; 5] = ["commit", "--quiet", "-a", "-m", "Row moved"];

#[cfg(unix)]
#[test]
fn the_hook_refuses_a_commit_that_it_cannot_test() {
    let repository = repository();
    let place = repository.path();
    move_the_row(place);
    let messages = refused(git_with(others(), place, &COMMIT), place);
    assert_eq!(messages, "commit refused: gcode-sim is not on the PATH, so nothing was tested\n");

    std::fs::write(place.join("parts/plate/control.toml"), "nonsense = 1\n").unwrap();
    git(place, &["add", "--all"]);
    let messages = refused(git(place, &COMMIT), place);
    assert!(messages.starts_with("refused  plate: ") && messages.contains("nonsense"), "{messages}");
    let last = messages.lines().last().unwrap();
    assert_eq!(
        last,
        "commit refused: not every case could be tested (exit code 2); mend what is named above"
    );
}

/// The flange of the tutorial in a repository of its own: no macros/, for the macro is in the dump.
#[cfg(unix)]
#[test]
fn the_hook_needs_no_folder_of_macros_and_names_a_case_that_fails_its_reference() {
    let repository = tempfile::tempdir().unwrap();
    let place = repository.path();
    copy_folder(&example().join("hooks"), &place.join("hooks"));
    copy_folder(&workspace().join("examples/first-hour/parts/flange"), &place.join("parts/flange"));
    run_line("gcode-sim test parts --accept", place);
    assert!(git(place, &["init", "--quiet"]).status.success());
    git(place, &["add", "--all"]);
    let first = git(place, &["commit", "--quiet", "-m", "Programs"]);
    assert!(first.status.success(), "{first:?}");

    // Hole 1 of the program is at x 30: the list has it at 31.
    let list = "id,x,y,depth\n1,31,0,22\n";
    std::fs::write(place.join("parts/flange/reference.csv"), list).unwrap();
    git(place, &["add", "--all"]);
    let messages = refused(git(place, &COMMIT), place);
    let last: Vec<&str> = messages.lines().filter(|line| line.starts_with("commit refused")).collect();
    let reason = "commit refused: a case fails its reference: correct the program or the reference; --accept does not help";
    assert_eq!(last, [reason], "{messages}");

    let program = place.join("parts/flange/DUMP.TXT");
    let text = std::fs::read_to_string(&program).unwrap();
    assert!(text.contains("30."));
    std::fs::write(&program, text.replacen("30.", "30.5", 1)).unwrap();
    git(place, &["add", "--all"]);
    let messages = refused(git(place, &COMMIT), place);
    assert!(messages.contains("changed  flange") && !messages.contains("use --accept"), "{messages}");
    let last: Vec<&str> = messages.lines().filter(|line| line.starts_with("commit refused")).collect();
    assert_eq!(last, [reason], "the change is corrected, not accepted: {messages}");
    std::fs::remove_file(place.join("parts/flange/reference.csv")).unwrap();
    git(place, &["add", "--all"]);
    let messages = refused(git(place, &COMMIT), place);
    let accept =
        "commit refused: where the change is meant, gcode-sim test parts --accept, then git add parts";
    assert_eq!(messages.lines().last(), Some(accept), "{messages}");
}

#[cfg(unix)]
#[test]
fn the_hook_refuses_a_changed_macro_with_the_message_of_the_page() {
    let repository = repository();
    let place = repository.path();

    move_the_row(place);
    // The change is in the folder and not staged: a commit of something else isn't about it.
    std::fs::write(place.join("notes.txt"), "Plate: 4 holes\n").unwrap();
    git(place, &["add", "notes.txt"]);
    assert!(git(place, &["commit", "--quiet", "-m", "Notes"]).status.success());

    let refused = git(place, &COMMIT);
    assert_eq!(refused.status.code(), Some(1));
    let messages = [refused.stdout, refused.stderr].concat();
    let messages = String::from_utf8(messages).unwrap();
    assert!(page().contains(&format!("```text\n{messages}```")), "docs/ci.md doesn't show\n{messages}");

    run_line("gcode-sim test parts --lib macros --accept", place);
    let taken = git(place, &COMMIT);
    assert!(taken.status.success(), "{taken:?}");
    let moved = String::from_utf8(git(place, &["show", "HEAD", "--", "parts"]).stdout).unwrap();
    assert!(moved.contains("+{\"entry\":[10.0,5.01,"), "{moved}");
}

/// One branch changes the macro and accepts it, the other has a new program that calls it: either holds alone.
#[cfg(unix)]
#[test]
fn the_hook_refuses_a_merge_of_changes_that_pass_alone() {
    let repository = repository();
    let place = repository.path();
    let is_done = |arguments: &[&str]| {
        let done = git(place, arguments);
        assert!(done.status.success(), "{arguments:?}: {done:?}");
    };
    let accept = || {
        run_line("gcode-sim test parts --lib macros --accept", place);
        is_done(&["add", "--all"]);
        is_done(&["commit", "--quiet", "-m", "Accepted"]);
    };
    is_done(&["branch", "moved"]);
    std::fs::create_dir(place.join("parts/cover")).unwrap();
    std::fs::copy(place.join("parts/plate/O0100.nc"), place.join("parts/cover/O0100.nc")).unwrap();
    accept();
    is_done(&["checkout", "--quiet", "moved"]);
    move_the_row(place);
    accept();

    is_done(&["checkout", "--quiet", "-"]);
    let merge = git(place, &["merge", "--quiet", "-m", "Both", "moved"]);
    assert!(!merge.status.success(), "{merge:?}");
    let messages = String::from_utf8([merge.stdout, merge.stderr].concat()).unwrap();
    assert!(
        messages.contains("changed  cover\n    hole-moved     holes 1, 2, 3, 4: moved by +0.0000 +0.0100"),
        "{messages}"
    );
    assert!(!messages.contains("changed  plate"), "{messages}");
    run_line("gcode-sim test parts --lib macros --accept", place);
    is_done(&["commit", "--quiet", "-a", "--no-edit"]);
}

/// The lines of the workflow that run gcode-sim, with the numbers of the shards in.
#[test]
fn the_commands_of_the_workflow_have_the_results_of_the_page() {
    let text = std::fs::read_to_string(example().join(".github/workflows/programs.yml")).unwrap();
    let place = tempfile::tempdir().unwrap();
    copy_folder(&example(), place.path());
    move_the_row(place.path());
    let mut codes = Vec::new();
    for line in text.lines().filter_map(|line| line.trim().strip_prefix("- run: gcode-sim ")) {
        let command = line.split("||").next().unwrap();
        let shards = if command.contains("matrix.shard") { 1..=2 } else { 1..=1 };
        for shard in shards {
            let command = command.replace("${{ matrix.shard }}", &shard.to_string());
            codes.push(run_line(&format!("gcode-sim {command}"), place.path()).status.code().unwrap());
        }
    }
    assert_eq!(codes, [1, 0, 1, 1, 1], "one shard has the changed case, the other none");
    let sarif = std::fs::read_to_string(place.path().join("result.sarif")).unwrap();
    assert!(sarif.contains("\"uri\": \"macros/O9001.nc\""), "{sarif}");
    assert!(std::fs::read_to_string(place.path().join("result.xml")).unwrap().contains("failures=\"1\""));
}

/// The last step of docs/tutorial.md: the case of the dump is accepted and committed, and the commit of its edited digit is refused.
#[cfg(unix)]
#[test]
fn the_hook_refuses_the_changed_digit_of_the_tutorial() {
    let repository = repository();
    let place = repository.path();
    let tutorial = workspace().join("examples/first-hour");
    copy_folder(&tutorial.join("parts"), &place.join("parts"));
    let machine = "gcode-sim new machine --kind 3-axis -o parts/flange/machine.toml";
    for line in [machine, "gcode-sim test parts --lib macros --only flange --accept"] {
        assert!(run_line(line, place).status.success(), "{line}");
    }
    git(place, &["add", "--all"]);
    assert!(git(place, &["commit", "--quiet", "-m", "Flange"]).status.success());
    std::fs::copy(tutorial.join("edited/flange/DUMP.TXT"), place.join("parts/flange/DUMP.TXT")).unwrap();
    git(place, &["add", "--all"]);
    let refused = git(place, &["commit", "--quiet", "-m", "Digit"]);
    let words = [refused.stdout, refused.stderr].concat();
    let words = String::from_utf8_lossy(&words);
    assert!(!refused.status.success() && words.contains("commit refused"), "{words}");
    // The radius is 0.5 larger, and so is the way of each hole from the centre.
    assert!(words.contains("holes 1, 2, 3, 4, 5, 6: moved by up to 0.5000 mm"), "{words}");
}
