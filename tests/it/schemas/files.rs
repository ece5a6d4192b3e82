//! Schemas of files against their readers: files of the repository, and each of them changed in every place.
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use gcode_inspect::machine::{Machine, error_file};
use gcode_lang::control::Settings;
use gcode_part::job::claims::ClaimsFile;
use gcode_part::job::control_file;
use gcode_part::job::project::ProjectFile;
use gcode_part::job::{Job, Rates};
use gcode_tests::workspace;
use serde_json::Value as Json;
use toml::{Table, Value};

use super::{schema, validator, walk};

type Read = fn(&str) -> Result<(), String>;

/// The TOML files by the names of their schemas, each with its reader.
const READERS: [(&str, Read); 7] = [
    ("job", |text| Job::parse(text).map(drop).map_err(|error| error.to_string())),
    ("machine", |text| Machine::parse(text).map(drop).map_err(|error| error.to_string())),
    ("control", |text| {
        control_file::apply(text, &mut Settings::default(), true).map_err(|error| error.to_string())
    }),
    ("errors", |text| {
        let machine = Machine::parse("[head]\nkind = \"manual\"\n").unwrap();
        error_file(text, &machine).map(drop).map_err(|error| error.to_string())
    }),
    ("project", |text| ProjectFile::parse(text).map(drop).map_err(|error| error.to_string())),
    ("claims", |text| ClaimsFile::parse(text).map(drop).map_err(|error| error.to_string())),
    ("rates", |text| Rates::parse(text).map(drop).map_err(|error| error.to_string())),
];

fn files(dir: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(dir).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files(&path, found);
        } else if path.extension().is_some_and(|e| e == "toml") {
            found.push(path);
        }
    }
}

fn json(table: &Table) -> Json {
    serde_json::to_value(table).unwrap()
}

#[test]
fn every_file_that_a_reader_takes_is_valid() {
    let mut found = Vec::new();
    for dir in ["examples", "tests/suite", "tests/complete", "gcode-gen/src/families"] {
        files(&workspace().join(dir), &mut found);
    }
    for (name, read) in READERS {
        let validator = validator(name);
        let mut count = 0;
        for path in &found {
            let text = std::fs::read_to_string(path).unwrap_or_default();
            if read(&text).is_err() {
                continue;
            }
            count += 1;
            let document = json(&toml::from_str(&text).unwrap());
            let against: Vec<_> = validator.iter_errors(&document).map(|e| e.to_string()).collect();
            assert!(against.is_empty(), "{} as {name}: {against:?}", path.display());
        }
        println!("{name}: {count} files");
        assert!(count > 0, "{name}: no file was read");
    }
}

/// The complete files, each with its schema.
fn complete() -> Vec<(PathBuf, &'static str, Read)> {
    let mut found = Vec::new();
    files(&workspace().join("tests/complete"), &mut found);
    let named = |path: PathBuf| {
        let stem = path.file_stem().unwrap().to_str().unwrap();
        let known = READERS.iter().skip(1).find(|(name, _)| stem.split('-').next() == Some(name));
        let (name, read) = *known.unwrap_or(&READERS[0]);
        (path, name, read)
    };
    found.into_iter().map(named).collect()
}

/// No key is forgotten by what follows: each is in one of the complete files.
#[test]
fn the_complete_files_have_every_key() {
    fn keys(value: &Json, path: &str, found: &mut Vec<String>) {
        match value {
            Json::Object(table) => {
                for (key, inner) in table {
                    found.push(format!("{path}/{key}"));
                    keys(inner, &format!("{path}/{key}"), found);
                }
            }
            Json::Array(all) => all.iter().for_each(|inner| keys(inner, &format!("{path}/[]"), found)),
            _ => {}
        }
    }
    for (name, _) in READERS.iter().filter(|(name, _)| *name != "control") {
        let mut there = Vec::new();
        for (path, _, _) in complete().iter().filter(|(_, of, _)| of == name) {
            let document: Table = toml::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
            keys(&json(&document), "", &mut there);
        }
        let all = schema(name);
        walk(&all, "", &mut |path, schema| {
            for (key, _) in schema["properties"].as_object().into_iter().flatten() {
                let key = format!("{path}/{key}");
                // A spread has one of three, and a section of rates is the same in every family.
                let known = there.iter().any(|k| *k == key || k.starts_with(&format!("{key}/")));
                let spread = ["fixed", "normal", "uniform"].iter().any(|end| key.ends_with(end));
                assert!(known || spread, "{name}: no complete file has {key}");
            }
        });
    }
}

/// Visits the schemas of one value: those given, and their alternatives.
fn each<'s>(schemas: &[&'s Json], visit: &mut impl FnMut(&'s Json)) {
    for schema in schemas {
        visit(schema);
        for word in ["anyOf", "oneOf"] {
            let inner: Vec<_> = schema[word].as_array().into_iter().flatten().collect();
            each(&inner, visit);
        }
    }
}

/// Returns the schemas of the value of a key.
fn of_key<'s>(schemas: &[&'s Json], key: &str) -> Vec<&'s Json> {
    let mut found = Vec::new();
    each(schemas, &mut |schema| match schema["properties"].get(key) {
        Some(inner) => found.push(inner),
        None => found.extend(schema["patternProperties"].as_object().into_iter().flatten().map(|(_, s)| s)),
    });
    found
}

/// Returns the schemas of the items of an array.
fn of_items<'s>(schemas: &[&'s Json]) -> Vec<&'s Json> {
    let mut found = Vec::new();
    each(schemas, &mut |schema| found.extend(schema.get("items")));
    found
}

/// Returns the bounds that the schemas of a number have, the numbers just inside and just beyond each, and some others.
fn numbers(schemas: &[&Json]) -> Vec<f64> {
    let mut all = vec![0.0, -1.0, 1.5, 1e9, -1e9];
    each(schemas, &mut |schema| {
        let bounds = ["minimum", "maximum"].map(|word| &schema[word]);
        let excluded = schema["not"]["enum"].as_array().into_iter().flatten();
        let listed = schema["enum"].as_array().into_iter().flatten();
        for bound in bounds.into_iter().chain(excluded).chain(listed).filter_map(Json::as_f64) {
            let little = bound.abs().max(1e-3) * 1e-3;
            all.extend([bound, bound - little, bound + little]);
        }
    });
    all.sort_by(f64::total_cmp);
    all.dedup();
    all
}

/// Returns other values for the place of a value with these schemas.
fn instead(value: &Value, schemas: &[&Json]) -> Vec<Value> {
    let mut all = vec![
        Value::Boolean(true),
        Value::String("X".into()),
        Value::Array(Vec::new()),
        Value::Table(Table::new()),
    ];
    match value {
        Value::Float(_) => all.extend(numbers(schemas).into_iter().map(Value::Float)),
        Value::Integer(_) => {
            let whole = numbers(schemas).into_iter();
            let whole = whole.flat_map(|number| [number.floor(), number.ceil()]).map(|number| number as i64);
            let whole: BTreeSet<_> = whole.collect();
            all.extend(whole.into_iter().map(Value::Integer));
            all.push(Value::Float(1.5));
        }
        Value::String(text) => all.push(Value::String(format!("{text}x"))),
        Value::Array(items) if !items.is_empty() => {
            all.push(Value::Array(items[1..].to_vec()));
            all.push(Value::Array(items.iter().chain(items.first()).cloned().collect()));
        }
        _ => {}
    }
    all
}

/// The value changed in one place: a key gone, a key more, another value.
fn changed(value: &Value, name: &str, schemas: &[&Json]) -> Vec<(String, Value)> {
    let others = instead(value, schemas).into_iter();
    let mut all: Vec<_> = others.map(|other| (format!("{name} = {other}"), other)).collect();
    match value {
        Value::Table(table) => {
            let with = |key: &str, inner: Option<Value>| {
                let mut copy = table.clone();
                copy.remove(key);
                copy.extend(inner.map(|inner| (key.to_owned(), inner)));
                Value::Table(copy)
            };
            all.push((format!("{name} with another key"), with("another", Some(Value::Integer(1)))));
            for (key, inner) in table {
                let name = format!("{name}.{key}");
                let inner = changed(inner, &name, &of_key(schemas, key)).into_iter();
                all.extend(inner.map(|(what, inner)| (what, with(key, Some(inner)))));
                all.push((format!("{name} gone"), with(key, None)));
            }
        }
        Value::Array(items) => {
            for (n, inner) in items.iter().enumerate() {
                let inner = changed(inner, &format!("{name}.{n}"), &of_items(schemas)).into_iter();
                all.extend(inner.map(|(what, inner)| {
                    let mut copy = items.clone();
                    copy[n] = inner;
                    (what, Value::Array(copy))
                }));
            }
        }
        _ => {}
    }
    all
}

/// Words of messages about keys that contradict each other, which a schema cannot state.
const ACROSS: [&str; 55] = [
    "the tool has a length",
    "below the depth",
    "which is not in [[tool]]",
    "names tools of [[tool]], but there are none",
    "every [[tool]] is larger",
    "the last tool of hole",
    "is used twice",
    "(the clearance) to",
    "from the diameter of",
    "to the diameter of",
    "above the drill diameter",
    "fewer than two rows fit round",
    "below the radius of",
    "the same as 'on'",
    "(half the diameter)",
    "(the radius)",
    "(the nose alone) to",
    "because they end on a circle",
    "(the least increment) to",
    "rounding to the least increment",
    "to the equatorial radius a =",
    "each less than b =",
    "from, to and the number of readings",
    "all its blocks together",
    "lower than any stack of",
    "it must include 0",
    "one of the control's axes",
    "does not match",
    "whose direction is unknown",
    "needs exactly one axis that rotates",
    "needs a [probe]",
    "an eighth of 'probe.search'",
    "round E and F",
    "too steep for a touch along y",
    "needs the key 'tool.",
    "at most the length of the tool",
    "max above min",
    "to above from",
    "does not matter on a straight line",
    "needs it",
    "is for a [cylinder]",
    "is for a tilted [face] only",
    "[face] excludes [cylinder]",
    "[face] needs G68.2",
    "the letter of 'rotary'",
    "no pattern names tool",
    "is not for operation",
    "whose minor diameter",
    "one circle leaves a core",
    "or the last ones meet the first",
    "where y is an angle",
    "one of the holes 1 to",
    "it is named twice",
    "no hole remains",
    "split the pattern, or list its points",
];

#[test]
fn readers_and_schemas_refuse_the_same() {
    let mut wrong = Vec::new();
    let mut tried = 0;
    for (path, name, read) in complete() {
        let text = std::fs::read_to_string(&path).unwrap();
        read(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let (validator, all) = (validator(name), schema(name));
        let root = Value::Table(toml::from_str(&text).unwrap());
        for (what, document) in changed(&root, "", &[&all]) {
            let Value::Table(table) = document else { continue };
            tried += 1;
            let text = toml::to_string(&table).unwrap();
            let taken = read(&text);
            let file = path.file_name().unwrap().to_str().unwrap();
            match (taken, validator.is_valid(&json(&table))) {
                (Ok(()), false) => wrong.push(format!("{file}: {what}: only the reader takes it")),
                (Err(error), true) if !ACROSS.iter().any(|words| error.contains(words)) => {
                    wrong.push(format!("{file}: {what}: only the schema takes it: {error}"));
                }
                _ => {}
            }
        }
    }
    println!("{tried} files tried");
    assert!(wrong.is_empty(), "{} of {tried}:\n{}", wrong.len(), wrong.join("\n"));
}

/// Tries a list at every key of a table, and in every list of tables.
#[test]
fn a_list_in_place_of_a_table_is_refused() {
    fn tables(value: &Value, name: &str, found: &mut Vec<(String, Value)>) {
        if let Value::Array(items) = value {
            items.iter().for_each(|item| tables(item, name, found));
        }
        let Value::Table(table) = value else { return };
        for (key, inner) in table {
            let name = if name.is_empty() { key.clone() } else { format!("{name}.{key}") };
            let with = |inner: Value| {
                let mut copy = table.clone();
                copy.insert(key.clone(), inner);
                Value::Table(copy)
            };
            match inner {
                Value::Table(_) => found.push((name.clone(), with(Value::Array(Vec::new())))),
                Value::Array(items) if items.iter().any(Value::is_table) => {
                    found.push((name.clone(), with(Value::Array(vec![Value::Array(Vec::new())]))));
                }
                _ => {}
            }
            let mut below = Vec::new();
            tables(inner, &name, &mut below);
            let is_list = inner.is_array();
            found.extend(
                below.into_iter().map(|(name, inner)| {
                    (name, with(if is_list { Value::Array(vec![inner]) } else { inner }))
                }),
            );
        }
    }
    let mut tried = BTreeSet::new();
    for (path, name, read) in complete() {
        let root = toml::from_str(&std::fs::read_to_string(&path).unwrap()).unwrap();
        let mut changed = Vec::new();
        tables(&Value::Table(root), "", &mut changed);
        for (key, document) in changed {
            let error = read(&toml::to_string(&document).unwrap()).unwrap_err();
            // Of a table whose `kind` decides its keys the reader names the table.
            let named = if key.starts_with("stock.") { "stock" } else { key.as_str() };
            let expected = format!("key '{named}' is a list: a table, {{ key = value }}, is required");
            assert!(error.ends_with(&expected), "{}: {key}: {error}", path.display());
            tried.insert(format!("{name}.{key}"));
        }
    }
    for key in [
        "job.control",
        "job.hole",
        "machine.tool",
        "machine.offsets.G54",
        "errors.part.tilt.z",
        "rates.beside",
    ] {
        assert!(tried.contains(key), "{key} is in no complete file: {tried:?}");
    }
}
