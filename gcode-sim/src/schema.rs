//! JSON Schemas of the files that users write and of the results written as JSON.
//!
//! They are derived from the types that are read and written, so that schemas and documents always agree.
use schemars::generate::SchemaSettings;
use schemars::transform::RecursiveTransform;
use schemars::{JsonSchema, Schema};
use serde_json::{Map, Value};

use crate::report::budget::BudgetReport;
use crate::report::changes::ChangesReport;
use crate::report::check::CheckReport;
use crate::report::explain::ExplainReport;
use crate::report::pictures::{CompareReport, RenderReport};
use crate::report::proof::ProofReport;
use crate::report::readings::ReadingsReport;
use crate::report::run::RunReport;
use crate::report::settings::SettingsReport;
use crate::report::test_report::TestReport;
use gcode_inspect::machine::{ErrorFile, MachineFile};
use gcode_inspect::verify::Verdict;
use gcode_inspect::verify::flutes::{FluteVerdict, NominalFlutes};
use gcode_part::HoleList;
use gcode_part::job::claims::ClaimsFile;
use gcode_part::job::control_file::ControlFile;
use gcode_part::job::project::ProjectFile;
use gcode_part::job::{JobFile, Rates};
use gcode_review::AcceptedFile;

/// One kind of document and its schema.
pub struct Format {
    /// Name for `gcode-sim schema`.
    pub name: &'static str,
    /// Title: the document in one line.
    pub about: &'static str,
    /// Whether users write it as TOML; else it is JSON.
    pub is_toml: bool,
    schema: fn() -> Schema,
}

/// All formats: files first, then results by the commands that write them.
pub const FORMATS: &[Format] = &[
    file::<JobFile>("job", "a job file, of any family"),
    file::<MachineFile>("machine", "a machine file: gcode-sim --machine"),
    file::<ControlFile>("control", "settings of the control: gcode-sim --control-file"),
    file::<ProjectFile>("project", "the project's file: gcode.toml"),
    file::<ErrorFile>("errors", "set-up and machine errors: budget --errors"),
    file::<ClaimsFile>("claims", "claims of a case, proved by test: claims.toml"),
    file::<Rates>("rates", "machine-hour rates: gcode-gen sheet --rates"),
    Format {
        name: "reference",
        about: "a list of holes: --reference",
        is_toml: false,
        schema: read::<HoleList>,
    },
    Format {
        name: "accepted",
        about: "an accepted result of a case: accepted.json",
        is_toml: false,
        schema: read::<AcceptedFile>,
    },
    result::<RunReport>("run", "the result of run"),
    result::<HoleList>("holes", "the result of holes, and of reference for a part with holes"),
    result::<NominalFlutes>("wanted-flutes", "the result of reference for a burr"),
    result::<Verdict>("verify", "the result of verify for a part with holes"),
    result::<FluteVerdict>("verify-flutes", "the result of verify for a burr"),
    result::<ReadingsReport>("readings", "the result of readings"),
    result::<CheckReport>("check", "the result of check"),
    result::<ChangesReport>("diff", "the result of diff"),
    result::<TestReport>("test", "the result of test, which test --merge reads"),
    result::<BudgetReport>("budget", "the result of budget"),
    result::<ProofReport>("prove", "the result of prove"),
    result::<RenderReport>("render", "the result of render, in addition to the picture"),
    result::<CompareReport>("compare", "the result of compare"),
    result::<SettingsReport>("settings", "the result of settings"),
    result::<ExplainReport>("explain", "the result of explain"),
];

/// Returns the TOML files that have a key, by its path; those of jobs with their family.
pub fn homes_of(key: &str) -> Vec<String> {
    let has = |schema: &Value| {
        let step = |schema: Value, name: &str| {
            // A table of a list has the keys of the list.
            let table = schema.get("items").cloned().unwrap_or(schema);
            table.get("properties")?.get(name).cloned()
        };
        key.split('.').try_fold(schema.clone(), step).is_some()
    };
    let mut homes = Vec::new();
    for format in FORMATS.iter().filter(|format| format.is_toml) {
        let schema = format.schema();
        let of_file = has(&schema).then(|| format.about.to_owned());
        homes.extend(of_file);
        let families = schema.get("oneOf").and_then(Value::as_array).into_iter().flatten();
        let family =
            |one: &Value| Some(format!("a job of {}", one["properties"]["family"]["enum"][0].as_str()?));
        homes.extend(families.filter(|one| has(one)).filter_map(family));
    }
    homes
}

const fn file<T: JsonSchema>(name: &'static str, about: &'static str) -> Format {
    Format { name, about, is_toml: true, schema: toml::<T> }
}

/// Returns the format of a command's JSON result.
pub const fn result<T: JsonSchema>(name: &'static str, about: &'static str) -> Format {
    Format { name, about, is_toml: false, schema: written::<T> }
}

impl Format {
    /// Returns the schema, draft 2020-12.
    pub fn schema(&self) -> Value {
        let mut schema = (self.schema)();
        schema.insert("title".to_owned(), self.about.into());
        schema.to_value()
    }
}

/// Returns the schema of a JSON file that is read.
fn read<T: JsonSchema>() -> Schema {
    of::<T>(SchemaSettings::draft2020_12())
}

/// Returns the schema of a result.
fn written<T: JsonSchema>() -> Schema {
    of::<T>(SchemaSettings::draft2020_12().for_serialize())
}

/// Returns the schema of a TOML file, without references: editors ignore keywords beside `$ref`.
fn toml<T: JsonSchema>() -> Schema {
    let settings = SchemaSettings::draft2020_12().with(|settings| settings.inline_subschemas = true);
    let settings = settings.with_transform(RecursiveTransform(without_null));
    of::<T>(settings.with_transform(RecursiveTransform(describe_default)))
}

fn of<T: JsonSchema>(settings: SchemaSettings) -> Schema {
    settings.with_transform(RecursiveTransform(without_bits)).into_generator().into_root_schema_for::<T>()
}

/// Removes number formats: the width of an integer is an implementation detail.
fn without_bits(schema: &mut Schema) {
    schema.remove("format");
}

/// Moves a default to the description, unless that states it already: `Of a touch, mm/min [default: 100].`
fn describe_default(schema: &mut Schema) {
    let default = schema.remove("default").and_then(|default| default.as_f64());
    let Some((default, description)) = default.zip(schema.get("description").and_then(Value::as_str)) else {
        return;
    };
    if !description.contains("[default: ") {
        let described = format!("{} [default: {default}].", description.trim_end_matches('.'));
        schema.insert("description".to_owned(), described.into());
    }
}

/// Removes null: TOML has none, and an optional key keeps its own type.
fn without_null(schema: &mut Schema) {
    let Some(object) = schema.as_object_mut() else { return };
    if let Some(Value::Array(types)) = object.get_mut("type") {
        types.retain(|name| name != "null");
        if let [only] = types.as_slice() {
            let only = only.clone();
            object.insert("type".to_owned(), only);
        }
    }
    if let Some(Value::Array(values)) = object.get_mut("enum") {
        values.retain(|value| !value.is_null());
    }
    lift_only_choice(object);
}

/// Replaces `anyOf` of a schema and null by the schema.
fn lift_only_choice(object: &mut Map<String, Value>) {
    let Some(Value::Array(choices)) = object.get_mut("anyOf") else { return };
    let others = choices.len();
    choices.retain(|choice| choice["type"] != "null");
    if choices.len() == others {
        return;
    }
    if let [Value::Object(only)] = choices.as_slice() {
        let only = only.clone();
        object.remove("anyOf");
        for (key, value) in only {
            // The description of the key takes precedence over that of its table.
            object.entry(key).or_insert(value);
        }
    }
}
