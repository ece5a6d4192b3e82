//! Assumption of a result: a value that the run read and nothing in its program set.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A value that the run read and nothing in its program set, and that can touch a hole or a flute.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Assumption {
    /// The value as programs write it: `#510`, `/2`, `G55`, `H3`, `M21`.
    pub what: String,
    /// The number that the run read; null for vacant, and for what is no number.
    pub value: Option<f64>,
    /// The block of the first read.
    pub place: AssumptionPlace,
    /// Ids of the holes that it can touch, or their numbers without a reference, or the numbers of flutes; those without a
    /// nominal one are `extra 1`, `extra 2`, …. Empty if it touches none of them: it decides a feed beside them, or another
    /// value may make further ones.
    pub decides: Vec<String>,
}

/// Block of a program.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AssumptionPlace {
    /// Program as in messages, such as `O8300`.
    pub program: String,
    /// Line in the file, from 1.
    pub line: u32,
}

/// Number of all holes or flutes of a result.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Total {
    /// Number of holes.
    Holes(usize),
    /// Number of flutes, repeated passes over a flute included.
    Flutes(usize),
}

/// Number of holes that are listed by their ids.
const MAX_LISTED: usize = 8;

impl Assumption {
    /// Returns `#510 = vacant (O0100 line 12) decides holes 3, 4`.
    pub fn sentence(&self, total: Total) -> String {
        let (noun, count) = match total {
            Total::Holes(count) => ("hole", count),
            Total::Flutes(count) => ("flute", count),
        };
        let Self { what, value, place: AssumptionPlace { program, line }, decides } = self;
        let value = match value {
            Some(value) => format!(" = {value}"),
            None if what.starts_with('#') => " = vacant".to_owned(),
            None => String::new(),
        };
        let shown = decides.iter().take(MAX_LISTED).cloned().collect::<Vec<_>>().join(", ");
        let decided = match decides.len() {
            0 if count == 0 => "what is cut".to_owned(),
            0 => format!("what is cut besides the {noun}s"),
            1 => format!("{noun} {shown}"),
            all if all == count => format!("all {all} {noun}s"),
            all if MAX_LISTED < all => format!("{noun}s {shown}, … and {} more", all - MAX_LISTED),
            _ => format!("{noun}s {shown}"),
        };
        format!("{what}{value} ({program} line {line}) decides {decided}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sentence_names_the_value_its_place_and_the_holes() {
        let place = AssumptionPlace { program: "O0100".to_owned(), line: 12 };
        let assumption = |what: &str, value, count: usize| Assumption {
            what: what.to_owned(),
            value,
            place: place.clone(),
            decides: (1..=count).map(|id| id.to_string()).collect(),
        };
        for (one, holes, expected) in [
            (assumption("#510", None, 2), 3, "#510 = vacant (O0100 line 12) decides holes 1, 2"),
            (assumption("#510", Some(2.5), 1), 3, "#510 = 2.5 (O0100 line 12) decides hole 1"),
            (assumption("#510", Some(0.0), 0), 0, "#510 = 0 (O0100 line 12) decides what is cut"),
            (
                assumption("D1", Some(0.0), 0),
                2,
                "D1 = 0 (O0100 line 12) decides what is cut besides the holes",
            ),
            (assumption("M21", None, 3), 3, "M21 (O0100 line 12) decides all 3 holes"),
            (
                assumption("/", Some(0.0), 10),
                12,
                "/ = 0 (O0100 line 12) decides holes 1, 2, 3, 4, 5, 6, 7, 8, … and 2 more",
            ),
        ] {
            assert_eq!(one.sentence(Total::Holes(holes)), expected);
            assert_eq!(one.sentence(Total::Flutes(holes)), expected.replace("hole", "flute"));
        }
    }
}
