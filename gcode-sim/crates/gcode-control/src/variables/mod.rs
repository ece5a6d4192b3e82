//! Local and common variables, and the operands that wait in an expression. Vacant is neither 0 nor a number.
mod joined;

use std::cell::Cell;
use std::collections::BTreeMap;
use std::sync::Arc;

use gcode_lang::alarm::Alarm;
use gcode_lang::program::{STACK, Slot};
use gcode_lang::units::POWERS;

/// Value of a variable.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Value {
    /// No value.
    #[default]
    Vacant,
    /// Number.
    Number(f64),
}

impl Value {
    /// Returns the number, 0 for vacant, as arithmetic takes it.
    pub fn number(self) -> f64 {
        match self {
            Self::Vacant => 0.0,
            Self::Number(number) => number,
        }
    }

    /// Returns true for vacant.
    pub fn is_vacant(self) -> bool {
        self == Self::Vacant
    }

    /// Returns the number; `None` for vacant, as a word with a vacant value counts as absent.
    pub fn as_number(self) -> Option<f64> {
        match self {
            Self::Vacant => None,
            Self::Number(number) => Some(number),
        }
    }
}

/// Result of an instruction. The number of a vacant value is 0, so that arithmetic doesn't test for it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Accumulator {
    pub(super) number: f64,
    is_vacant: bool,
}

impl Accumulator {
    pub(super) const VACANT: Self = Self { number: 0.0, is_vacant: true };

    #[inline(always)]
    pub(super) fn of(number: f64) -> Self {
        Self { number, is_vacant: false }
    }
}

impl From<Value> for Accumulator {
    #[inline]
    fn from(value: Value) -> Self {
        Self { number: value.number(), is_vacant: value.is_vacant() }
    }
}

impl From<Accumulator> for Value {
    #[inline]
    fn from(last: Accumulator) -> Self {
        if last.is_vacant { Self::Vacant } else { Self::Number(last.number) }
    }
}

/// Value in a variable, stored as in an [`Accumulator`].
#[derive(Clone, Copy, Debug, PartialEq)]
struct StoredValue {
    number: f64,
    is_vacant: bool,
    /// Decimals of an argument that was written without a point and counts increments; 0 for any other value.
    decimals: u8,
}

impl StoredValue {
    const VACANT: Self = Self { number: 0.0, is_vacant: true, decimals: 0 };

    /// Returns bits that also distinguish 0 from −0.
    fn bits(self) -> (u64, bool) {
        (self.number.to_bits(), self.is_vacant)
    }
}

impl From<Value> for StoredValue {
    #[inline]
    fn from(value: Value) -> Self {
        Self { number: value.number(), is_vacant: value.is_vacant(), decimals: 0 }
    }
}

impl From<StoredValue> for Value {
    #[inline]
    fn from(stored: StoredValue) -> Self {
        if stored.is_vacant { Self::Vacant } else { Self::Number(stored.number) }
    }
}

/// Number of locals: #0, which stays vacant, and #1 to #33.
const LOCALS: usize = 34;

/// Number of the variables up to the last common of every control.
const DIRECT_COUNT: usize = 1000;

/// Number of their slots, a power of two: the low bits of any number are an index, without a range check.
const SLOTS: usize = DIRECT_COUNT.next_power_of_two();

/// Locals #1 to #33 of one macro level, by number; #0 stays vacant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Locals([StoredValue; LOCALS]);

/// Locals of a new level.
pub(super) const VACANT: Locals = Locals([StoredValue::VACANT; LOCALS]);

impl Locals {
    /// Returns the value of a local.
    pub fn get(&self, local: usize) -> Value {
        self.0[local].into()
    }

    /// Sets an argument; `decimals` if it was written without a point and counts increments.
    pub(super) fn set(&mut self, local: usize, value: Value, decimals: u8) {
        self.0[local] = StoredValue { decimals, ..value.into() };
    }
}

/// Class of a variable number; locals and commons with their index in [`Vars`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum VariableClass {
    Vacant,
    Local(usize),
    Common(usize),
    System,
}

/// Local and common variables.
#[derive(Clone, Debug)]
pub struct Vars {
    /// Locals of the current level and commons, by number; other slots are never written.
    direct_values: Box<[StoredValue; SLOTS]>,
    /// Shared by the checkpoints of a run until one of them is written.
    extra_values: Arc<Vec<StoredValue>>,
    /// Locals of the callers' levels, the main program's first.
    outer_locals: Vec<Locals>,
    /// Numbers of further commons, in the order of their indices.
    extra_ranges: Vec<(u32, u32)>,
    /// `#10100` is `#100`.
    aliases_commons: bool,
    /// Names from SETVN.
    names: BTreeMap<String, u32>,
}

impl Vars {
    /// Returns vacant variables; `extra_ranges` are the numbers of commons that not every control has, with `aliases_commons`
    /// #10100 is #100.
    pub(super) fn new(extra_ranges: &[(u32, u32)], aliases_commons: bool) -> Self {
        let count = extra_ranges.iter().map(|(from, to)| (to - from + 1) as usize).sum();
        Self {
            direct_values: Box::new([StoredValue::VACANT; SLOTS]),
            extra_values: Arc::new(vec![StoredValue::VACANT; count]),
            outer_locals: Vec::new(),
            extra_ranges: extra_ranges.to_vec(),
            aliases_commons,
            names: BTreeMap::new(),
        }
    }

    /// SETVN: names the variables from `first` on, all or none.
    pub(super) fn set_names(&mut self, first: u32, names: &[String]) -> Result<(), Alarm> {
        let numbered = || {
            let number = |index: usize| first.saturating_add(index as u32);
            names.iter().enumerate().map(move |(index, name)| (number(index), name))
        };
        if let Some((number, _)) = numbered().find(|(number, _)| !(500..=549).contains(number)) {
            return Err(Alarm::NoSuchVariable { number: i64::from(number) });
        }
        for (number, name) in numbered() {
            // The last name of a variable replaces the earlier one.
            self.names.retain(|_, named| *named != number);
            self.names.insert(name.clone(), number);
        }
        Ok(())
    }

    /// Returns the variable with a name from SETVN.
    pub(super) fn named_variable(&self, name: &str) -> Result<u32, Alarm> {
        let unknown = || Alarm::NoVariableName { name: name.to_owned() };
        self.names.get(name).copied().ok_or_else(unknown)
    }

    #[inline]
    pub(super) fn classify(&self, number: u32) -> VariableClass {
        match Slot::of(number) {
            Slot::Free(index) if usize::from(index) < LOCALS => VariableClass::Local(usize::from(index)),
            Slot::Free(index) => VariableClass::Common(usize::from(index)),
            Slot::Other(number) => self.classify_other(number),
        }
    }

    /// Returns the class of a variable number that depends on settings of the control.
    fn classify_other(&self, number: u32) -> VariableClass {
        match number {
            0 => VariableClass::Vacant,
            10_100..=10_199 | 10_500..=10_999 if self.aliases_commons => {
                VariableClass::Common(number as usize - 10_000)
            }
            _ => self.extra_index(number).map_or(VariableClass::System, VariableClass::Common),
        }
    }

    /// Returns the index of a common that not every control has.
    fn extra_index(&self, number: u32) -> Option<usize> {
        let mut first = DIRECT_COUNT;
        for (from, to) in &self.extra_ranges {
            if (*from..=*to).contains(&number) {
                return Some(first + (number - from) as usize);
            }
            first += (to - from + 1) as usize;
        }
        None
    }

    /// Returns the numbers of the commons behind [`DIRECT_COUNT`], in the order of their indices.
    pub(super) fn extra_numbers(&self) -> impl Iterator<Item = u32> + '_ {
        self.extra_ranges.iter().flat_map(|(from, to)| *from..=*to)
    }

    #[inline(always)]
    pub(super) fn get_free(&self, number: u16) -> Value {
        self.direct_values[usize::from(number) % SLOTS].into()
    }

    /// Returns the number of a variable of [`Slot::Free`]; 0 if it is vacant.
    #[inline(always)]
    pub(super) fn free_number(&self, number: u16) -> f64 {
        self.direct_values[usize::from(number) % SLOTS].number
    }

    #[inline(always)]
    pub(super) fn set_direct(&mut self, number: u16, value: Accumulator) {
        let stored = &mut self.direct_values[usize::from(number) % SLOTS];
        (stored.number, stored.is_vacant, stored.decimals) = (value.number, value.is_vacant, 0);
    }

    /// Returns the value at an index from [`Vars::classify`].
    pub(super) fn get(&self, index: usize) -> Value {
        self.stored_value(index).into()
    }

    /// Writes the value at an index from [`Vars::classify`].
    pub(super) fn set(&mut self, index: usize, value: Value) {
        match index.checked_sub(DIRECT_COUNT) {
            None => self.direct_values[index] = value.into(),
            Some(index) => Arc::make_mut(&mut self.extra_values)[index] = value.into(),
        }
    }

    #[inline]
    fn stored_value(&self, index: usize) -> StoredValue {
        match index.checked_sub(DIRECT_COUNT) {
            None => self.direct_values[index],
            Some(index) => self.extra_values[index],
        }
    }

    fn indices(&self) -> usize {
        DIRECT_COUNT + self.extra_values.len()
    }

    /// ADP: returns the value of a local as if the argument had been written with a point.
    pub(super) fn value_with_point(&self, local: usize) -> f64 {
        let StoredValue { number, decimals, .. } = self.direct_values[local];
        number * POWERS[usize::from(decimals)]
    }

    /// Returns the locals of the current level.
    pub fn locals(&self) -> Locals {
        Locals(std::array::from_fn(|local| self.direct_values[local]))
    }

    pub(super) fn set_locals(&mut self, locals: &Locals) {
        self.direct_values[..LOCALS].copy_from_slice(&locals.0);
    }

    /// Returns the number of macro levels above the main program.
    pub fn level(&self) -> usize {
        self.outer_locals.len()
    }

    /// Begins a macro level with these locals.
    pub(super) fn push_level(&mut self, locals: &Locals) {
        self.outer_locals.push(self.locals());
        self.set_locals(locals);
    }

    /// Restores the caller's locals.
    pub(super) fn pop_level(&mut self) {
        if let Some(callers) = self.outer_locals.pop() {
            self.set_locals(&callers);
        }
    }

    pub(super) fn has_same_values(&self, other: &Self) -> bool {
        let Self {
            direct_values,
            extra_values,
            outer_locals,
            names,
            // Settings of the control.
            extra_ranges: _,
            aliases_commons: _,
        } = self;
        // By their bits: a number that isn't one, as in a symbolic run, equals itself.
        let same = |these: &[StoredValue], others: &[StoredValue]| {
            these.len() == others.len()
                && these
                    .iter()
                    .zip(others)
                    .all(|(this, other)| this.bits() == other.bits() && this.decimals == other.decimals)
        };
        same(&direct_values[..], &other.direct_values[..])
            && same(extra_values, &other.extra_values)
            && outer_locals.len() == other.outer_locals.len()
            && outer_locals.iter().zip(&other.outer_locals).all(|(these, others)| same(&these.0, &others.0))
            && *names == other.names
    }

    /// Returns true if the values at an index differ in any bit.
    #[inline]
    pub(super) fn differs_at(&self, index: usize, other: &Self) -> bool {
        self.stored_value(index).bits() != other.stored_value(index).bits()
    }

    /// Returns an index where the values differ; that of #0 if only callers' locals do.
    pub(super) fn difference(&self, other: &Self) -> Option<usize> {
        let found = (0..self.indices()).find(|index| self.differs_at(*index, other));
        found.or_else(|| self.outer_bits().ne(other.outer_bits()).then_some(0))
    }

    /// Returns the locals of a level below the current one.
    pub(super) fn outer_level(&self, level: usize) -> Option<&Locals> {
        self.outer_locals.get(level)
    }

    /// Sets a local of a level below the current one; false if there is no such level.
    pub(super) fn set_outer_local(&mut self, level: usize, local: usize, value: Value) -> bool {
        let Some(locals) = self.outer_locals.get_mut(level) else { return false };
        locals.set(local, value, 0);
        true
    }

    fn outer_bits(&self) -> impl Iterator<Item = (u64, bool)> + '_ {
        self.outer_locals.iter().flat_map(|level| level.0.map(StoredValue::bits))
    }

    /// Iterates over the variables that aren't vacant: the locals of the main program, the commons of every control, and the
    /// others, each by number.
    pub(super) fn nonvacant(&self) -> impl Iterator<Item = (u32, f64)> + '_ {
        let local =
            |local| self.outer_locals.first().map_or_else(|| self.get(local), |level| level.get(local));
        let locals = (0..LOCALS).map(move |index| (index as u32, local(index)));
        let direct = (LOCALS..DIRECT_COUNT).map(|index| (index as u32, self.get(index)));
        let extra = self
            .extra_numbers()
            .zip(self.extra_values.iter())
            .map(|(number, stored)| (number, Value::from(*stored)));
        locals.chain(direct).chain(extra).filter_map(|(number, value)| Some((number, value.as_number()?)))
    }
}

/// Operands that wait for their operators, in [`STACK`] slots. The stack is part of the control, so that an evaluation has
/// nothing to clear; its depth wraps, which needs no range check and tolerates operands that an alarm has left.
#[derive(Clone, Debug)]
pub(super) struct OperandStack {
    pub(super) values: [Cell<Value>; STACK],
    depth: Cell<usize>,
}

impl Default for OperandStack {
    fn default() -> Self {
        Self { values: [const { Cell::new(Value::Vacant) }; STACK], depth: Cell::new(0) }
    }
}

impl OperandStack {
    pub(super) fn push(&self, value: Value) {
        let used = self.depth.get();
        self.values[used % STACK].set(value);
        self.depth.set(used.wrapping_add(1));
    }

    #[inline]
    pub(super) fn pop(&self) -> Value {
        let used = self.depth.get().wrapping_sub(1);
        self.depth.set(used);
        self.values[used % STACK].get()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_call_hides_the_callers_locals_and_a_return_restores_them() {
        let mut vars = Vars::new(&[], false);
        vars.set(1, Value::Number(7.0));
        vars.push_level(&VACANT);
        assert!(vars.get(1).is_vacant());
        vars.set(1, Value::Number(9.0));
        assert_eq!(vars.nonvacant().collect::<Vec<_>>(), [(1, 7.0)], "the main program's");
        vars.pop_level();
        assert_eq!(vars.get(1), Value::Number(7.0));
        vars.push_level(&VACANT);
        assert!(vars.get(1).is_vacant(), "a level used before starts vacant");
    }

    #[test]
    fn values_differ_in_any_bit_and_on_any_level() {
        let mut vars = Vars::new(&[(400, 409), (98_000, 98_499)], false);
        vars.set(3, Value::Number(0.0));
        let before = vars.clone();
        assert_eq!(before.difference(&vars), None);
        for value in [Value::Vacant, Value::Number(-0.0), Value::Number(1.0)] {
            vars.set(3, value);
            assert_eq!(before.difference(&vars), Some(3), "{value:?} is not 0");
        }
        vars.set(3, Value::Number(0.0));
        vars.set(DIRECT_COUNT + 499, Value::Number(5.0));
        assert_eq!(before.difference(&vars), Some(DIRECT_COUNT + 499));
        vars.set(DIRECT_COUNT + 499, Value::Vacant);
        assert_eq!(before.difference(&vars), None);
        vars.push_level(&before.locals());
        assert_eq!(before.difference(&vars), Some(0), "there is another level");
        vars.pop_level();
        assert_eq!(before.difference(&vars), None);
    }

    #[test]
    fn variables_that_are_not_vacant_have_their_numbers() {
        let mut vars = Vars::new(&[(400, 409), (98_000, 98_499)], false);
        for index in [33, 100, 999, DIRECT_COUNT, DIRECT_COUNT + 9, DIRECT_COUNT + 10, DIRECT_COUNT + 509] {
            vars.set(index, Value::Number(1.0));
        }
        let numbers: Vec<_> = vars.nonvacant().map(|(number, _)| number).collect();
        assert_eq!(numbers, [33, 100, 999, 400, 409, 98_000, 98_499]);
        assert!(numbers.iter().all(|number| matches!(
            vars.classify(*number),
            VariableClass::Local(_) | VariableClass::Common(_)
        )));
        assert_eq!(vars.classify(410), VariableClass::System);
    }
}
