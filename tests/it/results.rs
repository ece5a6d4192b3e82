//! Results for other programs: SARIF is valid by its schema, JUnit has the counts that servers show, and the merged results of shards are
//! those of one run.
use std::path::Path;

use gcode_tests::programs::run_line;
use serde_json::Value;

/// A collection with a case of every answer: as accepted, changed, new, refused, against its reference.
fn collection(place: &Path) {
    let case = |name: &str, file: &str, text: &str| {
        let folder = place.join("parts").join(name);
        std::fs::create_dir_all(&folder).unwrap();
        std::fs::write(folder.join(file), text).unwrap();
    };
    let drill = |y: &str| format!("O1\nG0 X10. Y{y} Z5.\nS500 M3\nG81 X10. Y{y} Z-5. R2. F100\nG80\nM30\n");
    for name in ["held", "moved", "aside"] {
        case(name, "main.nc", &drill("0."));
    }
    case("aside", "reference.csv", "id,x,y,z,i,j,k,depth,diameter\n1,10,0.2,0,0,0,1,5,\n");
    case("lost", "main.nc", "O2\nG0 X1.\nM00\nM30\n");
    run_line("gcode-sim test parts --accept", place);
    case("moved", "main.nc", &drill("0.01"));
    case("lost", "main.nc", "O2\nG0 X1.\nM30\n");
    case("new & <odd>", "main.nc", "O3\nG0 X1.\nM30\n");
    case("two", "a.nc", "O4\nM98 P5\nM30\n");
    case("two", "b.nc", "O5\nM98 P4\nM30\n");
}

fn json(line: &str, place: &Path) -> Value {
    let done = run_line(line, place);
    serde_json::from_slice(&done.stdout)
        .unwrap_or_else(|e| panic!("{line}: {e}: {}", String::from_utf8_lossy(&done.stderr)))
}

/// Errors of a document by the schema of SARIF 2.1.0.
fn against_schema(document: &Value) -> Vec<String> {
    // A bracket stands alone in a pattern there, and the validator is strict about it.
    let schema = include_str!("../fixtures/sarif-2.1.0-rtm.5.json").replace("{2}]?$", "{2})?$");
    let schema = serde_json::from_str(&schema.replace("|^[a-zA-Z]{2}-", "(-")).unwrap();
    let schema = jsonschema::validator_for(&schema).unwrap();
    schema.iter_errors(document).map(|error| format!("{}: {error}", error.instance_path())).collect()
}

/// Code, file and line of a result.
type Entry<'l> = (&'l str, &'l str, Option<u64>);

/// The results of a SARIF log, which must be valid.
fn entries(log: &Value) -> Vec<Entry<'_>> {
    assert_eq!(against_schema(log), Vec::<String>::new());
    let results = log["runs"][0]["results"].as_array().unwrap();
    let entries = results.iter().map(|result| {
        let at = &result["locations"][0]["physicalLocation"];
        let uri = at["artifactLocation"]["uri"].as_str().unwrap_or_default();
        (result["ruleId"].as_str().unwrap(), uri, at["region"]["startLine"].as_u64())
    });
    entries.collect()
}

#[test]
fn sarif_is_valid_and_has_the_places() {
    let place = tempfile::tempdir().unwrap();
    collection(place.path());
    let log = json("gcode-sim test parts --format sarif", place.path());
    let expected = [
        ("hole-position", "parts/aside/main.nc", Some(4)),
        ("stop", "parts/lost/main.nc", Some(2)),
        ("hole-moved", "parts/moved/main.nc", Some(4)),
        ("case-new", "parts/new%20%26%20%3Codd%3E/main.nc", Some(1)),
        ("case-refused", "parts/two/a.nc", Some(1)),
    ];
    assert_eq!(entries(&log), expected);
    let results = log["runs"][0]["results"].as_array().unwrap();
    let moved = results[2]["message"]["text"].as_str().unwrap();
    assert_eq!(
        moved,
        "moved: hole 1: moved by +0.0000 +0.0100 +0.0000 mm\nalso move-shifted: moves end at a different point: \
         Y +0.0100 (3 rapids, a feed)"
    );
    for rule in log["runs"][0]["tool"]["driver"]["rules"].as_array().unwrap() {
        assert!(rule["help"]["text"].as_str().is_some_and(|text| text.len() > 40), "{rule}");
    }
    let mut broken = log;
    broken["runs"][0]["results"][0]["level"] = "bad".into();
    assert!(!against_schema(&broken).is_empty(), "the schema refuses a wrong level");
}

#[test]
fn findings_of_check_are_sarif_too() {
    let place = tempfile::tempdir().unwrap();
    std::fs::write(place.path().join("O1.nc"), "O1\n#1=#2+1.\nGOTO 5\nG65 P2 A1.\nM30\n").unwrap();
    let log = json("gcode-sim check O1.nc --format sarif", place.path());
    assert_eq!(against_schema(&log), Vec::<String>::new());
    let results = log["runs"][0]["results"].as_array().unwrap();
    let missing = results.iter().find(|result| result["ruleId"] == "missing-n").unwrap();
    assert_eq!(missing["level"], "error");
    assert_eq!(
        missing["locations"][0]["physicalLocation"],
        serde_json::json!({"artifactLocation": {"uri": "O1.nc"}, "region": {"startLine": 3, "startColumn": 1}})
    );
}

/// Findings of `verify` are at the line that causes them, changes of `diff` at the line of the new program.
#[test]
fn findings_of_verify_and_changes_of_diff_are_sarif() {
    let place = tempfile::tempdir().unwrap();
    let drill = |y: &str| format!("O1\nS500 M3\nG81 X10. Y{y} Z-5. R2. F100\nG80\nM00\nM30\n");
    std::fs::write(place.path().join("old.nc"), drill("0.2")).unwrap();
    std::fs::write(place.path().join("new.nc"), drill("0.").replace("M00\n", "")).unwrap();
    std::fs::write(
        place.path().join("reference.csv"),
        "id,x,y,z,i,j,k,depth,diameter\n1,10,0.2,0,0,0,1,5,\n",
    )
    .unwrap();
    let expected: [(&str, &[Entry<'_>]); 3] = [
        ("verify old.nc --reference reference.csv", &[]),
        ("diff old.nc new.nc", &[("hole-moved", "new.nc", Some(3)), ("stop", "new.nc", Some(3))]),
        ("diff old.nc old.nc", &[]),
    ];
    for (command, expected) in expected {
        let log = json(&format!("gcode-sim {command} --format sarif"), place.path());
        assert_eq!(entries(&log), expected, "{command}");
    }
    let log = json("gcode-sim verify new.nc --reference reference.csv --format sarif", place.path());
    assert!(entries(&log).contains(&("hole-position", "new.nc", Some(3))), "{log}");
}

#[test]
fn junit_counts_failures_and_describes_them_as_the_terminal_does() {
    let place = tempfile::tempdir().unwrap();
    collection(place.path());
    let done = run_line("gcode-sim test parts --format junit", place.path());
    let text = String::from_utf8(done.stdout).unwrap();
    let report = quick_junit::Report::deserialize_from_str(&text).unwrap();
    assert_eq!((report.tests, report.failures, report.errors), (6, 4, 1), "{text}");
    let case = |name: &str| {
        let case = report.test_suites[0].test_cases.iter().find(|case| case.name.as_str() == name);
        match &case.unwrap().status {
            quick_junit::TestCaseStatus::NonSuccess { kind, message, ty, description, .. } => {
                let text = |t: &Option<quick_junit::XmlString>| t.as_ref().unwrap().as_str().to_owned();
                Some((*kind, text(ty), text(message), text(description)))
            }
            quick_junit::TestCaseStatus::Success { .. } => None,
            other @ quick_junit::TestCaseStatus::Skipped { .. } => panic!("{name}: {other:?}"),
        }
    };
    assert_eq!(case("held"), None);
    let (kind, code, message, description) = case("moved").unwrap();
    assert_eq!((kind, code.as_str()), (quick_junit::NonSuccessKind::Failure, "hole-moved"));
    assert_eq!(message, "hole-moved: hole 1: moved by +0.0000 +0.0100 +0.0000 mm");
    assert!(description.contains("new O0001:4  G81 X10. Y0.01 Z-5. R2. F100"), "{description}");
    assert_eq!(case("new & <odd>").unwrap().1, "case-new");
    assert_eq!(case("two").unwrap().0, quick_junit::NonSuccessKind::Error);
    assert!(case("aside").unwrap().2.starts_with("hole-position: hole 1 is out of position"));
}

#[test]
fn the_results_of_shards_merge_to_those_of_one_run() {
    let place = tempfile::tempdir().unwrap();
    collection(place.path());
    let whole = json("gcode-sim test parts --format json", place.path());
    for k in 1..=4 {
        run_line(&format!("gcode-sim test parts --shard {k}/4 --format json > {k}.json"), place.path());
    }
    run_line("gcode-sim test parts --shard 4/4 --tolerance 0.02 --format json > wide.json", place.path());
    assert_eq!(json("gcode-sim test --merge 3.json 1.json 4.json 2.json --format json", place.path()), whole);
    for (line, expected) in [
        ("1.json 2.json 4.json", "the results of --shard 3/4 are missing"),
        ("1.json 2.json 3.json 4.json 4.json", "7 cases of 6"),
        ("main.json main.json", "case aside is in two of the results"),
        ("1.json main.json", "these are not shards of one collection of cases"),
        ("odd.json", "missing field"),
        (
            "1.json 2.json 3.json wide.json",
            "some results were made with --tolerance 0.0001 and some with 0.02",
        ),
    ] {
        std::fs::write(place.path().join("main.json"), whole.to_string()).unwrap();
        std::fs::write(place.path().join("odd.json"), "{}").unwrap();
        let done = run_line(&format!("gcode-sim test --merge {line}"), place.path());
        let messages = String::from_utf8(done.stderr).unwrap();
        assert!(messages.contains(expected), "{line}: {messages}");
        assert_eq!(done.status.code(), Some(2), "{line}");
    }
}

/// A build server keeps the document in a file: its log has the reason why a case can't be used.
#[test]
fn a_refused_case_is_reported_beside_every_document() {
    let place = tempfile::tempdir().unwrap();
    collection(place.path());
    for format in ["json", "junit", "sarif"] {
        let done = run_line(&format!("gcode-sim test parts --format {format} > out"), place.path());
        let messages = String::from_utf8(done.stderr).unwrap();
        assert!(
            messages.starts_with("error: case two: parts/two contains only programs that call one another"),
            "{format}: {messages}"
        );
        assert_eq!(done.status.code(), Some(2), "{format}");
    }
    assert!(
        run_line("gcode-sim test parts", place.path()).stderr.is_empty(),
        "the text has the reason itself"
    );
}
