//! Schemas of results: every result of a command is valid, and has no key that its schema lacks.

use gcode_tests::programs::run_line;
use gcode_tests::workspace;
use serde_json::Value;

use super::{schema, validator};

/// The schema with every object closed: a key that it doesn't name is refused.
fn closed(name: &str) -> jsonschema::Validator {
    fn close(schema: &mut Value) {
        match schema {
            Value::Object(object) => {
                if object.contains_key("properties") && !object.contains_key("additionalProperties") {
                    object.insert("additionalProperties".to_owned(), false.into());
                }
                object.values_mut().for_each(close);
            }
            Value::Array(all) => all.iter_mut().for_each(close),
            _ => {}
        }
    }
    let mut schema = schema(name);
    close(&mut schema);
    jsonschema::validator_for(&schema).unwrap()
}

fn check(name: &str, document: &Value, what: &str) {
    let errors = closed(name);
    let against: Vec<_> = errors
        .iter_errors(document)
        .take(5)
        .map(|error| format!("{}: {error}", error.instance_path()))
        .collect();
    assert!(against.is_empty(), "{what} as {name}: {against:#?}");
}

/// Commands that answer in every shape there is, behind the names of their schemas.
const COMMANDS: &str = "\
run gcode-sim run examples/melon-mould/O8100.nc --moves --show '#5041' --show '#1' --format json
run gcode-sim run examples/nc-repository/macros/O9001.nc --format json
holes gcode-sim holes examples/melon-mould/O8100.nc --format json
holes gcode-sim reference examples/melon-mould/job.toml
reference gcode-sim reference examples/melon-mould/job.toml
wanted-flutes gcode-sim reference examples/burr/job.toml
verify gcode-sim verify examples/melon-mould/O8100.nc --reference examples/melon-mould/job.toml --format json
verify gcode-sim verify examples/one-digit-wrong/O8100.nc --lib examples/melon-mould --reference examples/melon-mould/job.toml --format json
verify gcode-sim verify examples/honeycomb/O8300.nc --machine examples/honeycomb/machine.toml --reference examples/honeycomb/job.toml --format json
verify-flutes gcode-sim verify tests/suite/verify/an_uneven_index_is_measured/case.nc --machine tests/suite/verify/grinder.toml --reference tests/suite/verify/burr.toml --format json
readings gcode-sim readings examples/alignment/O8220.nc --machine examples/alignment/machine.toml --part examples/alignment/job.toml --tolerance 0.03 --format json
check gcode-sim check examples/melon-mould/O8101.nc --format json
diff gcode-sim diff examples/melon-mould/O8100.nc examples/one-digit-wrong/O8100.nc --lib examples/melon-mould --format json
test gcode-sim test examples/nc-repository/parts --lib examples/nc-repository/macros --shard 1/1 --format json
test gcode-sim test examples/melon-mould --format json
budget gcode-sim budget examples/melon-mould/job.toml --errors examples/error-budget/before.toml --samples 50 --format json
prove gcode-sim prove macros/O8231_sine_table.nc --range '#101=0..45' --call 'G65 P8231 A#101 B200. C0.001 U1.' --claim no-alarm --claim 'blocks LE 100' --bounds '#586' --time 5 --format json
settings gcode-sim settings --format json
explain gcode-sim explain hole-depth --format json
explain gcode-sim explain --list --format json
compare gcode-sim compare examples/burr/O8400.png examples/burr/O8400-tip.png --format json
compare gcode-sim compare examples/burr/O8400.png examples/burr/O8400.png --format json
";

#[test]
fn results_are_valid() {
    for (name, line) in COMMANDS.lines().filter_map(|row| row.split_once(' ')) {
        let done = run_line(line, &workspace());
        let document = serde_json::from_slice(&done.stdout)
            .unwrap_or_else(|error| panic!("{line}: {error}: {}", String::from_utf8_lossy(&done.stderr)));
        check(name, &document, line);
    }
}

#[test]
fn alarms_findings_and_changes_are_valid() {
    let place = tempfile::tempdir().unwrap();
    let write = |file: &str, text: &str| {
        let path = place.path().join(file);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    };
    write("O1.nc", "O1\n#3006=1(LOOK)\nM50\nG65 P2\nM30\n");
    write("O2.nc", "O2\nPOPEN\nDPRNT[X]\nM00\nG4 P500\nG2 X1. R1. F5\n#1=1/0\nM99\n");
    write("O3.nc", "O3\n#1=#2+1.\nGOTO 5\nWHILE[1EQ1]DO1\nG65 P9\nM30\n");
    write("parts/new/a.nc", "O1\nM30\n");
    write("parts/two/a.nc", "O1\nM30\n");
    write("parts/two/b.nc", "O2\nM30\n");
    let drilled = |y: &str| format!("O1\nS500 M3\nG81 X10. Y{y} Z-5. R2. F100\nG80\nM30\n");
    write("parts/moved/main.nc", &drilled("0."));
    write("parts/moved/reference.csv", "id,x,y,z,i,j,k,depth,diameter\n1,10,0.2,0,0,0,1,5,\n");
    run_line("gcode-sim test parts --only moved --accept", place.path());
    write("parts/moved/main.nc", &drilled("0.1"));
    let result = |name: &str, line: &str| {
        let done = run_line(line, place.path());
        let document: Value = serde_json::from_slice(&done.stdout)
            .unwrap_or_else(|error| panic!("{line}: {error}: {}", String::from_utf8_lossy(&done.stderr)));
        check(name, &document, line);
    };
    for (name, line) in [
        ("run", "gcode-sim run O1.nc --moves --format json"),
        ("check", "gcode-sim check O3.nc --format json"),
        ("diff", "gcode-sim diff O1.nc O3.nc --format json"),
        ("test", "gcode-sim test parts --format json"),
        (
            "verify",
            "gcode-sim verify parts/moved/main.nc --reference parts/moved/reference.csv --format json",
        ),
        ("render", "gcode-sim render parts/moved/main.nc -o top.png --size 480x360 --format json"),
    ] {
        result(name, line);
    }
    let accepted = std::fs::read_to_string(place.path().join("parts/moved/accepted.json")).unwrap();
    check("accepted", &serde_json::from_str(&accepted).unwrap(), "accepted.json");
}

/// Results of the generator for programs that pass and for programs that fail.
#[test]
fn results_of_the_generator_are_valid() {
    let place = tempfile::tempdir().unwrap();
    let complete = workspace().join("tests/complete");
    for name in ["honeycomb.toml", "rates.toml"] {
        std::fs::copy(complete.join(name), place.path().join(name)).unwrap();
    }
    run_line("gcode-gen new pin-holes -o job.toml", place.path());
    let job = std::fs::read_to_string(place.path().join("job.toml")).unwrap();
    // A zone that rounding alone uses up.
    std::fs::write(place.path().join("tight.toml"), job.replace("position = 0.1", "position = 0.0001"))
        .unwrap();
    for (name, line, code) in [
        ("emit", "gcode-gen emit job.toml --out nc --format json", 0),
        ("emit", "gcode-gen emit tight.toml --out no --format json", 1),
        ("sheet", "gcode-gen sheet job.toml -o setup.html --rates rates.toml --format json", 0),
        ("sheet", "gcode-gen sheet tight.toml -o no.html --format json", 1),
    ] {
        let done = run_line(line, place.path());
        assert_eq!(done.status.code(), Some(code), "{line}");
        let document: Value = serde_json::from_slice(&done.stdout).unwrap();
        check(name, &document, line);
        assert_eq!(document["refused"].is_null(), code == 0, "{line}");
        let refusal = document["refused"].as_str().unwrap_or_default();
        assert!(!refusal.contains('\u{1b}'), "{refusal}");
    }
    assert!(place.path().join("nc/O8100.nc").exists() && !place.path().join("no").exists());
}

/// The sessions of the cases and of the examples that have JSON in them.
#[test]
fn results_that_stand_in_the_repository_are_valid() {
    let mut count = 0;
    for entry in std::fs::read_dir(workspace().join("tests/suite/cli")).unwrap() {
        let path = entry.unwrap().path().join("session.snap");
        let text = std::fs::read_to_string(&path).unwrap_or_default();
        for part in text.split("\n$ gcode-sim ").skip(1) {
            let (line, rest) = part.split_once('\n').unwrap();
            let shown: Vec<&str> = rest.lines().take_while(|line| !line.starts_with(['!', '['])).collect();
            let Ok(document) = serde_json::from_str(&shown.join("\n")) else { continue };
            let name = line.split(' ').next().unwrap();
            if line.contains("sarif") || name == "schema" {
                continue;
            }
            check(name, &document, &format!("{}: {line}", path.display()));
            count += 1;
        }
    }
    assert!(count > 2, "{count} results were checked");
    let path = "examples/nc-repository/parts/plate/accepted.json";
    let text = std::fs::read_to_string(workspace().join(path)).unwrap();
    check("accepted", &serde_json::from_str(&text).unwrap(), path);
}

/// A wrong list of holes is refused by its reader, and by the schema if that can state the rule.
#[test]
fn lists_of_holes_are_refused_alike() {
    use gcode_part::NominalPart;
    let text = std::fs::read_to_string(workspace().join("tests/complete/reference.json")).unwrap();
    let validator = validator("reference");
    let both = |text: &str| {
        let document: Value = serde_json::from_str(text).unwrap();
        (NominalPart::parse(text).is_ok(), validator.is_valid(&document))
    };
    assert_eq!(both(&text), (true, true));
    for (from, to) in [
        ("\"unit\": \"mm\"", "\"unit\": \"cm\""),
        ("\"unit\": \"mm\", ", ""),
        ("\"depth\": 15.0", "\"depth\": 0"),
        ("\"depth\": 15.0", "\"depth\": -1"),
        ("\"diameter\": 6.0", "\"diameter\": 0"),
        ("\"depth\": 15.0, ", ""),
        ("\"depth\": 15.0", "\"deep\": 15.0"),
        ("675.2, 0.0]", "675.2]"),
        ("675.2, 0.0]", "675.2, 0.0, 0.0]"),
        ("\"id\": \"1\"", "\"id\": 1"),
        ("\"tool\": 2", "\"tool\": -2"),
    ] {
        assert!(text.contains(from), "{from}");
        assert_eq!(both(&text.replacen(from, to, 1)), (false, false), "{to}");
    }
    // An axis of length 2, and a name that is there twice.
    for (from, to) in
        [("[0.0, 1.0, 0.0]", "[0.0, 2.0, 0.0]"), ("{\"entry\": [1,", "{\"id\": \"1\", \"entry\": [1,")]
    {
        assert_eq!(both(&text.replacen(from, to, 1)), (false, true), "{to}");
    }
}
