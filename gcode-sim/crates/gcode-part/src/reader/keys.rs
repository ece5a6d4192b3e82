//! Kinds of values of keys: a field names one by `#[serde(with = "…")]`, and its check and its schema follow.
use std::borrow::Cow;
use std::fmt;
use std::marker::PhantomData;
use std::ops::Deref;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::value::MapAccessDeserializer;
use serde::de::{DeserializeOwned, Error, MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serializer};

use super::Located;
use gcode_lang::control::{Dialect, Increment};

/// Start of the message for a value that is not allowed; the reader replaces it by the key.
pub const OUT_OF_RANGE: &str = "out of range: ";

/// A kind of value that a key takes.
pub trait FileKey {
    /// Type of the value.
    type Value;

    /// Reads and checks a value.
    ///
    /// # Errors
    /// A value that is not allowed, with those that are.
    fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Self::Value, D::Error>;

    /// Writes the value of a key that is left out, for the schema; null if the schema does not state it.
    ///
    /// # Errors
    /// Those of the serialiser.
    fn serialize<S: Serializer>(_: &Self::Value, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_unit()
    }
}

/// A list of words, each with the value that it stands for.
pub trait WordList {
    /// Type of the values.
    type Value: Copy;

    /// Returns all words.
    fn all() -> Vec<(&'static str, Self::Value)>;

    /// Returns the value of a word; `None` for one that is not in the list.
    fn find(word: &str) -> Option<Self::Value> {
        Self::all().into_iter().find(|(name, _)| *name == word).map(|(_, value)| value)
    }

    /// Returns the words as a message lists them.
    fn names() -> Vec<String> {
        Self::all().into_iter().map(|(name, _)| name.to_owned()).collect()
    }

    /// Returns a regular expression of the words.
    fn pattern() -> String {
        Self::names().join("|")
    }
}

/// One word of the list `W`.
#[derive(Clone, Copy, Debug)]
pub struct Word<W>(PhantomData<W>);

impl<W: WordList> FileKey for Word<W> {
    type Value = W::Value;

    fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<W::Value, D::Error> {
        let written = String::deserialize(deserializer)?;
        W::find(&written).ok_or_else(|| {
            D::Error::custom(format!("{OUT_OF_RANGE}'{written}': one of {}", W::names().join(", ")))
        })
    }
}

impl<W: WordList> JsonSchema for Word<W> {
    fn schema_name() -> Cow<'static, str> {
        "Word".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let names: Vec<_> = W::all().into_iter().map(|(name, _)| name).collect();
        json_schema!({ "type": "string", "enum": names })
    }
}

impl WordList for Dialect {
    type Value = Self;

    fn all() -> Vec<(&'static str, Self)> {
        Self::ALL.into()
    }
}

impl WordList for Increment {
    type Value = Self;

    fn all() -> Vec<(&'static str, Self)> {
        Self::ALL.into()
    }
}

/// 1 or −1: the direction of an axis.
#[derive(Clone, Copy, Debug)]
pub enum AxisSign {}

impl AxisSign {
    /// Returns the sign of an axis that is not reversed.
    pub(crate) fn default() -> i8 {
        1
    }
}

impl FileKey for AxisSign {
    type Value = i8;

    fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<i8, D::Error> {
        match i64::deserialize(deserializer)? {
            1 => Ok(1),
            -1 => Ok(-1),
            other => Err(D::Error::custom(format!("{OUT_OF_RANGE}{other}: 1 or -1"))),
        }
    }

    fn serialize<S: Serializer>(sign: &i8, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_i8(*sign)
    }
}

impl JsonSchema for AxisSign {
    fn schema_name() -> Cow<'static, str> {
        "Sign".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "type": "integer", "enum": [1, -1] })
    }
}

/// A value of a key that may be left out; the field has `default` as well.
#[derive(Clone, Copy, Debug)]
pub struct Optional<K>(PhantomData<K>);

impl<K: FileKey> FileKey for Optional<K> {
    type Value = Option<K::Value>;

    fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<K::Value>, D::Error> {
        K::deserialize(deserializer).map(Some)
    }
}

/// A table; serde's own structs take a list of their fields as well.
#[derive(Clone, Copy, Debug)]
pub struct Section<T>(PhantomData<T>);

impl<T: DeserializeOwned> FileKey for Section<T> {
    type Value = T;

    fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<T, D::Error> {
        deserializer.deserialize_map(Self(PhantomData))
    }
}

impl<'de, T: DeserializeOwned> Visitor<'de> for Section<T> {
    type Value = T;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("a table")
    }

    fn visit_map<A: MapAccess<'de>>(self, table: A) -> Result<T, A::Error> {
        T::deserialize(MapAccessDeserializer::new(table))
    }
}

/// A list of values of kind `K`.
#[derive(Clone, Copy, Debug)]
pub struct Items<K>(PhantomData<K>);

impl<K: FileKey> FileKey for Items<K> {
    type Value = Vec<K::Value>;

    fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<K::Value>, D::Error> {
        let items = Vec::<Checked<K>>::deserialize(deserializer)?;
        Ok(items.into_iter().map(|item| item.0).collect())
    }
}

/// A table whose keys are words of the list `W`, with values of kind `K`.
#[derive(Clone, Copy, Debug)]
pub struct TableOf<W, K>(PhantomData<(W, K)>);

impl<W: WordList, K: FileKey> FileKey for TableOf<W, K> {
    type Value = Vec<(W::Value, K::Value)>;

    fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Self::Value, D::Error> {
        deserializer.deserialize_map(Self(PhantomData))
    }
}

impl<'de, W: WordList, K: FileKey> Visitor<'de> for TableOf<W, K> {
    type Value = Vec<(W::Value, K::Value)>;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("a table")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut table: A) -> Result<Self::Value, A::Error> {
        let mut entries = Vec::new();
        while let Some((TableKey::<W>(key), Checked::<K>(value))) = table.next_entry()? {
            entries.push((key, value));
        }
        Ok(entries)
    }
}

impl<W: WordList, K: JsonSchema> JsonSchema for TableOf<W, K> {
    fn schema_name() -> Cow<'static, str> {
        format!("Table_of_{}", K::schema_name()).into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let pattern = format!("^({})$", W::pattern());
        let value = generator.subschema_for::<K>();
        json_schema!({
            "type": "object",
            "patternProperties": { pattern: value },
            "additionalProperties": false
        })
    }
}

/// A key of a table, one word of the list `W`.
struct TableKey<W: WordList>(W::Value);

impl<'de, W: WordList> Deserialize<'de> for TableKey<W> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let written = String::deserialize(deserializer)?;
        W::find(&written).map(Self).ok_or_else(|| {
            let names: Vec<_> = W::names().into_iter().map(|name| format!("`{name}`")).collect();
            D::Error::custom(format!("unknown field `{written}`, expected one of {}", names.join(", ")))
        })
    }
}

/// Gives a kind of value the schema of another type. A derived one has no name of its own for each `T`, so that
/// nested ones count as recursion.
macro_rules! schema_of {
    ($($kind:ident: $schema:ty),+) => {$(
        impl<T: JsonSchema> JsonSchema for $kind<T> {
            fn schema_name() -> Cow<'static, str> {
                <$schema>::schema_name()
            }

            fn schema_id() -> Cow<'static, str> {
                <$schema>::schema_id()
            }

            fn json_schema(generator: &mut SchemaGenerator) -> Schema {
                <$schema>::json_schema(generator)
            }
        }
    )+};
}

schema_of!(Optional: T, Section: T, Items: Vec<T>);

/// A value of kind `K` with its location in the text.
pub struct Bounded<K: FileKey>(Located<Checked<K>>);

/// A value of kind `K`.
pub struct Checked<K: FileKey>(K::Value);

impl<'de, K: FileKey> Deserialize<'de> for Checked<K> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        K::deserialize(deserializer).map(Self)
    }
}

impl<'de, K: FileKey> Deserialize<'de> for Bounded<K> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Located::deserialize(deserializer).map(Self)
    }
}

impl<K: FileKey<Value: Copy>> Bounded<K> {
    /// Returns the value.
    pub fn get(&self) -> K::Value {
        self.0.as_ref().0
    }
}

impl<K: FileKey> Deref for Bounded<K> {
    type Target = Located<Checked<K>>;

    fn deref(&self) -> &Self::Target {
        &self.0
    }
}

/// The schema is that of the value alone; a derived one would have the sentence above as a description.
impl<K: FileKey + JsonSchema> JsonSchema for Bounded<K> {
    fn schema_name() -> Cow<'static, str> {
        K::schema_name()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        K::json_schema(generator)
    }
}

/// An array of exactly `N` values; serde's own arrays ignore extra ones silently.
#[derive(Clone, Debug)]
pub struct FixedArray<T, const N: usize>(pub [T; N]);

impl<'de, T: Deserialize<'de>, const N: usize> Deserialize<'de> for FixedArray<T, N> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let values = Vec::deserialize(deserializer)?;
        let wrong = |values: Vec<T>| D::Error::invalid_length(values.len(), &format!("{N}").as_str());
        values.try_into().map(Self).map_err(wrong)
    }
}

impl<K: FileKey, const N: usize> FileKey for FixedArray<K, N> {
    type Value = [K::Value; N];

    fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<[K::Value; N], D::Error> {
        let FixedArray(values) = <FixedArray<Checked<K>, N> as Deserialize>::deserialize(deserializer)?;
        Ok(values.map(|value| value.0))
    }
}

impl<T: JsonSchema, const N: usize> JsonSchema for FixedArray<T, N> {
    fn schema_name() -> Cow<'static, str> {
        format!("{N}_of_{}", T::schema_name()).into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let item = generator.subschema_for::<T>();
        json_schema!({ "type": "array", "items": item, "minItems": N, "maxItems": N })
    }
}
