//! Values of a machine that a program reads and no code sets: signals, settings, parameters, by their variables.
use std::collections::BTreeMap;

/// Variables that hold such a value: inputs, analogue inputs, settings and parameters of a Haas (Mill Operator's Manual
/// 96-8210, macro variables), its tables of tools, timers and pallets, and the keys that
/// the operator presses at M109.
const RANGES: &[(u32, u32)] = &[
    // Answers to M109.
    (500, 599),
    (1032, 1099),
    (1132, 1299),
    (1601, 2000),
    (3020, 3025),
    (3028, 3028),
    (3030, 3034),
    (3196, 3196),
    (3201, 3600),
    (5401, 6999),
    (7401, 7960),
    (8500, 8599),
    (10_500, 10_599),
    (11_000, 11_255),
    (13_000, 13_063),
    (20_000, 39_999),
    (50_001, 59_999),
];

/// First and last output of a Haas that an input may follow.
const OUTPUTS: (u32, u32) = (12_000, 12_255);

/// Variable and the item behind its point: `#30057.21` is item 21 of #30057.
type Key = (u32, Option<u32>);

/// Stated value of a variable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MachineValue {
    /// Number.
    Number(f64),
    /// Signal that follows an output of the program.
    Output {
        /// Variable of the output.
        number: u32,
        /// True for 1 while the output is 0.
        is_inverted: bool,
    },
}

/// Stated values by their variables.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MachineValues(BTreeMap<Key, MachineValue>);

impl MachineValues {
    /// Permitted values, as in messages.
    pub(super) const ALLOWED: &'static str = "a number, or an output with ! for its inverse, as in !#12003";

    /// Returns the stated value of a variable or of one of its items.
    pub fn get(&self, number: u32, item: Option<u32>) -> Option<MachineValue> {
        self.0.get(&(number, item)).copied()
    }

    /// Returns true for a variable that may hold such a value.
    pub(super) fn holds(number: u32) -> bool {
        RANGES.iter().any(|(from, to)| (*from..=*to).contains(&number))
    }

    /// Returns the variable and item of a key without its `#`; `None` for a variable without such a value.
    pub(super) fn key(text: &str) -> Option<Key> {
        let (number, item) = match text.split_once('.') {
            Some((number, item)) => (number, Some(item.parse().ok()?)),
            None => (text, None),
        };
        let number = number.parse().ok()?;
        (Self::holds(number) && (item.is_none() || has_items(number))).then_some((number, item))
    }

    /// States a value; `None` for a text that is no value.
    pub(super) fn set(&mut self, key: Key, text: &str) -> Option<()> {
        let text = text.trim();
        let (is_inverted, name) = match text.strip_prefix('!') {
            Some(name) => (true, name),
            None => (false, text),
        };
        let value = match name.strip_prefix('#') {
            Some(number) => {
                let number = number.parse().ok().filter(|number| (OUTPUTS.0..=OUTPUTS.1).contains(number))?;
                MachineValue::Output { number, is_inverted }
            }
            None => MachineValue::Number(text.parse().ok().filter(|number: &f64| number.is_finite())?),
        };
        self.0.insert(key, value);
        Some(())
    }
}

/// Returns the value that a variable, or one of its items, is assumed to have: 0, but 1 for item 25 of parameter 57. With 0
/// lengths and work offsets of a Haas have no sign, and its probing macros stop with `SET PARAM 57 NEG OFFSETS TO 1`.
pub fn assumed_machine_value(number: u32, item: Option<u32>) -> u8 {
    u8::from((number, item) == (30_057, Some(25)))
}

/// Returns true for a parameter, whose point separates an item; behind any other number it separates a bit.
pub fn has_items(number: u32) -> bool {
    (30_000..=39_999).contains(&number)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_stated_by_variable_and_item() {
        let mut values = MachineValues::default();
        for (key, value) in [("20255", "-12.5"), ("30057.21", "1"), ("11017", "!#12003")] {
            values.set(MachineValues::key(key).unwrap(), value).unwrap();
        }
        assert_eq!(values.get(20_255, None), Some(MachineValue::Number(-12.5)));
        assert_eq!(values.get(30_057, Some(21)), Some(MachineValue::Number(1.0)));
        assert_eq!(values.get(30_057, Some(2)), None);
        let follows = MachineValue::Output { number: 12_003, is_inverted: true };
        assert_eq!(values.get(11_017, None), Some(follows));
    }

    #[test]
    fn other_variables_and_texts_are_refused() {
        for key in ["600", "12003", "20255.1", "x", "30057.x"] {
            assert_eq!(MachineValues::key(key), None, "{key}");
        }
        let mut values = MachineValues::default();
        for text in ["", "on", "!1", "#500", "inf"] {
            assert_eq!(values.set((11_017, None), text), None, "{text}");
        }
    }
}
