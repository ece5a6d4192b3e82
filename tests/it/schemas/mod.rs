//! Schemas that `schema` prints, compared with the readers of files and with results.
mod controls;
mod files;
mod results;

use gcode_sim::schema::{FORMATS, Format};
use serde_json::Value;

/// Returns the formats of both programs.
fn all() -> impl Iterator<Item = &'static Format> {
    FORMATS.iter().chain(gcode_gen::report::FORMATS)
}

/// Returns the schema of a document by its name.
fn schema(name: &str) -> Value {
    all().find(|format| format.name == name).unwrap_or_else(|| panic!("no schema {name}")).schema()
}

fn validator(name: &str) -> jsonschema::Validator {
    jsonschema::validator_for(&schema(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// Visits every subschema with its path.
fn walk<'s>(schema: &'s Value, path: &str, visit: &mut impl FnMut(&str, &'s Value)) {
    visit(path, schema);
    for (key, inner) in schema.as_object().into_iter().flatten() {
        match (key.as_str(), inner) {
            ("properties" | "patternProperties" | "$defs", Value::Object(named)) => {
                named.iter().for_each(|(name, inner)| walk(inner, &format!("{path}/{name}"), visit));
            }
            ("items" | "additionalProperties", Value::Object(_)) => walk(inner, &format!("{path}/[]"), visit),
            ("oneOf" | "anyOf", Value::Array(all)) => {
                all.iter().for_each(|inner| walk(inner, path, visit));
            }
            _ => {}
        }
    }
}

#[test]
fn every_schema_is_one_of_draft_2020_12() {
    for format in all() {
        let schema = format.schema();
        assert_eq!(schema["$schema"], "https://json-schema.org/draft/2020-12/schema", "{}", format.name);
        assert!(jsonschema::meta::is_valid(&schema), "{}", format.name);
    }
}

/// Editors know an older draft: schemas of TOML files use keywords whose meaning is the same since draft 4.
#[test]
fn schemas_of_toml_files_use_keywords_of_draft_4() {
    const WORDS: &str = "$schema additionalProperties anyOf description enum items maxItems maxProperties maximum \
                         minItems minProperties minimum multipleOf not oneOf pattern patternProperties properties \
                         required title type";
    for format in FORMATS.iter().filter(|format| format.is_toml) {
        walk(&format.schema(), "", &mut |path, schema| {
            for word in schema.as_object().into_iter().flatten().map(|(word, _)| word) {
                assert!(WORDS.split(' ').any(|known| known == word), "{}{path}: {word}", format.name);
            }
        });
    }
}

/// An editor shows the description of a key.
#[test]
fn every_key_of_a_file_is_described() {
    for format in FORMATS.iter().filter(|format| format.is_toml) {
        let all = format.schema();
        walk(&all, "", &mut |path, schema| {
            for (key, inner) in schema["properties"].as_object().into_iter().flatten() {
                let narrows = inner.as_object().unwrap().keys().all(|word| word == "enum");
                let text = inner["description"].as_str().unwrap_or_default();
                assert!(narrows || text.len() > 2, "{}{path}/{key} has no description", format.name);
            }
        });
    }
}

#[test]
fn descriptions_are_plain_words() {
    for format in all() {
        walk(&format.schema(), "", &mut |path, schema| {
            let text = schema["description"].as_str().unwrap_or_default();
            assert!(!text.contains("[`") && !text.contains("::"), "{}{path}: {text}", format.name);
        });
    }
}
