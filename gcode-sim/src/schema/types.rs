//! Schemas made of types: of files that are read, everything in one place and nothing that TOML hasn't got, and of results.
use schemars::generate::SchemaSettings;
use schemars::transform::RecursiveTransform;
use schemars::{JsonSchema, Schema};
use serde_json::{Map, Value};

/// The schema of a file that is JSON.
pub(super) fn read<T: JsonSchema>() -> Schema {
    of::<T>(SchemaSettings::draft2020_12())
}

/// The schema of a result.
pub(super) fn written<T: JsonSchema>() -> Schema {
    of::<T>(SchemaSettings::draft2020_12().for_serialize())
}

/// The schema of a file that is TOML. Editors follow no references beside descriptions, so that it has none.
pub(super) fn toml<T: JsonSchema>() -> Schema {
    let settings = SchemaSettings::draft2020_12().with(|settings| settings.inline_subschemas = true);
    of::<T>(settings.with_transform(RecursiveTransform(without_null)))
}

fn of<T: JsonSchema>(settings: SchemaSettings) -> Schema {
    settings.with_transform(RecursiveTransform(without_bits)).into_generator().into_root_schema_for::<T>()
}

/// How many bits a number takes up is nobody's business.
fn without_bits(schema: &mut Schema) {
    schema.remove("format");
}

/// TOML has no null: a key that may be left out has the type that it has where it is there.
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

/// `anyOf` a schema and null is that schema.
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
            // What a key is for says more than what its table is.
            object.entry(key).or_insert(value);
        }
    }
}
