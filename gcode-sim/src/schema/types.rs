//! Schemas derived from types: files that are read, with all subschemas inline for TOML, and results.
use schemars::generate::SchemaSettings;
use schemars::transform::RecursiveTransform;
use schemars::{JsonSchema, Schema};
use serde_json::{Map, Value};

/// Returns the schema of a JSON file that is read.
pub(super) fn read<T: JsonSchema>() -> Schema {
    of::<T>(SchemaSettings::draft2020_12())
}

/// Returns the schema of a result.
pub(super) fn written<T: JsonSchema>() -> Schema {
    of::<T>(SchemaSettings::draft2020_12().for_serialize())
}

/// Returns the schema of a TOML file, without references: editors ignore keywords beside `$ref`.
pub(super) fn toml<T: JsonSchema>() -> Schema {
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
