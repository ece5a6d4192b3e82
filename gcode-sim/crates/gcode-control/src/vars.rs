//! Local and common variables. Vacant is a state of its own: it is neither 0 nor a number.
use gcode_lang::program::Slot;

/// What a variable holds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Value {
    #[default]
    Vacant,
    Number(f64),
}

impl Value {
    /// Arithmetic takes a vacant variable for 0.
    pub fn number(self) -> f64 {
        match self {
            Self::Vacant => 0.0,
            Self::Number(number) => number,
        }
    }

    pub fn is_vacant(self) -> bool {
        self == Self::Vacant
    }

    /// The number, or `None` where the word that carries it is not there.
    pub fn as_number(self) -> Option<f64> {
        match self {
            Self::Vacant => None,
            Self::Number(number) => Some(number),
        }
    }
}

/// What code has given last: the number is 0 where it is vacant, so that arithmetic needn't ask.
#[derive(Clone, Copy, Debug)]
pub(super) struct Accumulator {
    pub(super) number: f64,
    vacant: bool,
}

impl Accumulator {
    pub(super) const VACANT: Self = Self { number: 0.0, vacant: true };

    #[inline(always)]
    pub(super) fn of(number: f64) -> Self {
        Self { number, vacant: false }
    }
}

impl From<Value> for Accumulator {
    #[inline]
    fn from(value: Value) -> Self {
        Self { number: value.number(), vacant: value.is_vacant() }
    }
}

impl From<Accumulator> for Value {
    #[inline]
    fn from(last: Accumulator) -> Self {
        if last.vacant { Self::Vacant } else { Self::Number(last.number) }
    }
}

/// A value as it is kept, in the same way.
#[derive(Clone, Copy, Debug, PartialEq)]
struct StoredValue {
    number: f64,
    vacant: bool,
    /// The decimals of an argument that was written without a point and counts increments; 0 for all others.
    decimals: u8,
}

impl StoredValue {
    const VACANT: Self = Self { number: 0.0, vacant: true, decimals: 0 };

    /// What tells 0 from −0, too.
    fn bits(self) -> (u64, bool) {
        (self.number.to_bits(), self.vacant)
    }
}

impl From<Value> for StoredValue {
    #[inline]
    fn from(value: Value) -> Self {
        Self { number: value.number(), vacant: value.is_vacant(), decimals: 0 }
    }
}

impl From<StoredValue> for Value {
    #[inline]
    fn from(held: StoredValue) -> Self {
        if held.vacant { Self::Vacant } else { Self::Number(held.number) }
    }
}

/// #0, which stays vacant, and #1 to #33.
const LOCALS: usize = 34;
/// The numbers up to the last common of every control.
const ORDINARY: usize = 1000;
/// Places for them, so many that the low bits of any number are one: nothing needs to ask whether it is there.
const PLACES: usize = ORDINARY.next_power_of_two();

/// #1 to #33 of one macro level, by number; #0 stays vacant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Locals([StoredValue; LOCALS]);

/// A level that nothing has been written to.
pub(super) const VACANT: Locals = Locals([StoredValue::VACANT; LOCALS]);

impl Locals {
    pub fn get(&self, local: usize) -> Value {
        self.0[local].into()
    }

    /// Sets an argument; `decimals` where it was written without a point and counts increments.
    pub(super) fn set(&mut self, local: usize, value: Value, decimals: u8) {
        self.0[local] = StoredValue { decimals, ..value.into() };
    }
}

/// Where a number belongs; a local's and a common's place among the values of [`Vars`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum VariableClass {
    Vacant,
    Local(usize),
    Common(usize),
    System,
}

/// All variables that a program may use freely.
#[derive(Clone, Debug)]
pub struct Vars {
    /// By number the locals of the current level and the commons. What has no number of these is never written.
    ordinary: Box<[StoredValue; PLACES]>,
    further: Vec<StoredValue>,
    /// The locals of the levels that wait for the current one, the main program's first.
    outer: Vec<Locals>,
    /// The numbers of further commons.
    more: (u32, u32),
    /// `#10100` is `#100`.
    aliased: bool,
}

impl Vars {
    /// `more` are the numbers of commons beyond #999; with `aliased` #10100 is #100, and so on.
    pub(super) fn new(more: Option<(u32, u32)>, aliased: bool) -> Self {
        let count = more.map_or(0, |(from, to)| (to - from + 1) as usize);
        Self {
            ordinary: Box::new([StoredValue::VACANT; PLACES]),
            further: vec![StoredValue::VACANT; count],
            outer: Vec::new(),
            more: more.unwrap_or((1, 0)),
            aliased,
        }
    }

    /// What kind of variable `number` is.
    #[inline]
    pub(super) fn kind(&self, number: u32) -> VariableClass {
        match Slot::of(number) {
            Slot::Free(place) if usize::from(place) < LOCALS => VariableClass::Local(usize::from(place)),
            Slot::Free(place) => VariableClass::Common(usize::from(place)),
            Slot::Other(number) => self.other_kind(number),
        }
    }

    /// What kind of variable one is that settings of the control decide about.
    fn other_kind(&self, number: u32) -> VariableClass {
        match number {
            0 => VariableClass::Vacant,
            10_100..=10_199 | 10_500..=10_999 if self.aliased => {
                VariableClass::Common(number as usize - 10_000)
            }
            _ if (self.more.0..=self.more.1).contains(&number) => {
                VariableClass::Common(ORDINARY + (number - self.more.0) as usize)
            }
            _ => VariableClass::System,
        }
    }

    /// The value of a variable of [`Slot::Free`].
    #[inline(always)]
    pub(super) fn free(&self, number: u16) -> Value {
        self.ordinary[usize::from(number) % PLACES].into()
    }

    /// Its number; 0 where it is vacant.
    #[inline(always)]
    pub(super) fn number(&self, number: u16) -> f64 {
        self.ordinary[usize::from(number) % PLACES].number
    }

    /// Writes such a variable.
    #[inline(always)]
    pub(super) fn set_free(&mut self, number: u16, value: Accumulator) {
        let held = &mut self.ordinary[usize::from(number) % PLACES];
        (held.number, held.vacant, held.decimals) = (value.number, value.vacant, 0);
    }

    /// The value at a place that [`Vars::kind`] tells.
    pub(super) fn get(&self, place: usize) -> Value {
        self.held(place).into()
    }

    /// Writes a value at such a place.
    pub(super) fn set(&mut self, place: usize, value: Value) {
        match place.checked_sub(ORDINARY) {
            None => self.ordinary[place] = value.into(),
            Some(place) => self.further[place] = value.into(),
        }
    }

    #[inline]
    fn held(&self, place: usize) -> StoredValue {
        match place.checked_sub(ORDINARY) {
            None => self.ordinary[place],
            Some(place) => self.further[place],
        }
    }

    /// How many places there are.
    fn places(&self) -> usize {
        ORDINARY + self.further.len()
    }

    /// ADP: a local's value as if it had been passed with a point.
    pub(super) fn with_point(&self, local: usize) -> f64 {
        let StoredValue { number, decimals, .. } = self.ordinary[local];
        number * 10_f64.powi(i32::from(decimals))
    }

    /// The locals of the current level.
    pub fn locals(&self) -> Locals {
        Locals(std::array::from_fn(|local| self.ordinary[local]))
    }

    pub(super) fn set_locals(&mut self, locals: &Locals) {
        self.ordinary[..LOCALS].copy_from_slice(&locals.0);
    }

    pub fn level(&self) -> usize {
        self.outer.len()
    }

    /// A macro call: a new level with these locals.
    pub(super) fn enter(&mut self, locals: &Locals) {
        self.outer.push(self.locals());
        self.set_locals(locals);
    }

    /// Back to the caller's locals.
    pub(super) fn leave(&mut self) {
        if let Some(callers) = self.outer.pop() {
            self.set_locals(&callers);
        }
    }

    /// Whether all values in force are the same.
    pub(super) fn same(&self, other: &Self) -> bool {
        self.ordinary == other.ordinary && self.further == other.further && self.outer == other.outer
    }

    /// Whether the values at a place differ, be it in one bit.
    #[inline]
    pub(super) fn differ_at(&self, place: usize, other: &Self) -> bool {
        self.held(place).bits() != other.held(place).bits()
    }

    /// A place where the values differ; that of #0 where only callers' locals do.
    pub(super) fn difference(&self, other: &Self) -> Option<usize> {
        let found = (0..self.places()).find(|place| self.differ_at(*place, other));
        found.or_else(|| self.outer_bits().ne(other.outer_bits()).then_some(0))
    }

    fn outer_bits(&self) -> impl Iterator<Item = (u64, bool)> + '_ {
        self.outer.iter().flat_map(|level| level.0.map(StoredValue::bits))
    }

    /// The variables that aren't vacant, by number: the locals of the main program and the commons.
    pub fn nonvacant(&self) -> impl Iterator<Item = (u32, f64)> + '_ {
        let local = |local| self.outer.first().map_or_else(|| self.get(local), |level| level.get(local));
        let locals = (0..LOCALS).map(move |place| (place, local(place)));
        let commons = (LOCALS..self.places()).map(|place| (place, self.get(place)));
        locals.chain(commons).filter_map(|(place, value)| {
            let number = place.checked_sub(ORDINARY).map_or(place as u32, |more| self.more.0 + more as u32);
            Some((number, value.as_number()?))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_call_hides_the_callers_locals_and_a_return_brings_them_back() {
        let mut vars = Vars::new(None, false);
        vars.set(1, Value::Number(7.0));
        vars.enter(&VACANT);
        assert!(vars.get(1).is_vacant());
        vars.set(1, Value::Number(9.0));
        assert_eq!(vars.nonvacant().collect::<Vec<_>>(), [(1, 7.0)], "the main program's");
        vars.leave();
        assert_eq!(vars.get(1), Value::Number(7.0));
        vars.enter(&VACANT);
        assert!(vars.get(1).is_vacant(), "a level used before starts vacant");
    }

    #[test]
    fn values_differ_in_any_bit_and_on_any_level() {
        let mut vars = Vars::new(Some((98_000, 98_499)), false);
        vars.set(3, Value::Number(0.0));
        let before = vars.clone();
        assert_eq!(before.difference(&vars), None);
        for value in [Value::Vacant, Value::Number(-0.0), Value::Number(1.0)] {
            vars.set(3, value);
            assert_eq!(before.difference(&vars), Some(3), "{value:?} is not 0");
        }
        vars.set(3, Value::Number(0.0));
        vars.set(ORDINARY + 499, Value::Number(5.0));
        assert_eq!(before.difference(&vars), Some(ORDINARY + 499));
        vars.set(ORDINARY + 499, Value::Vacant);
        assert_eq!(before.difference(&vars), None);
        vars.enter(&before.locals());
        assert_eq!(before.difference(&vars), Some(0), "there is another level");
        vars.leave();
        assert_eq!(before.difference(&vars), None);
    }

    #[test]
    fn what_is_known_has_its_number() {
        let mut vars = Vars::new(Some((98_000, 98_499)), false);
        for place in [33, 100, 999, ORDINARY, ORDINARY + 499] {
            vars.set(place, Value::Number(1.0));
        }
        let numbers: Vec<_> = vars.nonvacant().map(|(number, _)| number).collect();
        assert_eq!(numbers, [33, 100, 999, 98_000, 98_499]);
    }
}
