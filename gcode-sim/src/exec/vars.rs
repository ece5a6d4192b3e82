//! Local and common variables. Vacant is a state of its own: it is neither 0 nor a number.
use crate::program::Slot;

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
    pub fn given(self) -> Option<f64> {
        match self {
            Self::Vacant => None,
            Self::Number(number) => Some(number),
        }
    }
}

/// #1 to #33 of one macro level, by number; #0 stays vacant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Locals {
    values: [Value; 34],
    /// The decimals of an argument that was written without a point and counts increments; 0 for all others.
    decimals: [u8; 34],
}

/// A level that nothing has been written to.
pub(super) const VACANT: Locals = Locals { values: [Value::Vacant; 34], decimals: [0; 34] };

impl Locals {
    /// Sets an argument; `decimals` where it was written without a point and counts increments.
    pub(super) fn set(&mut self, local: usize, value: Value, decimals: u8) {
        self.values[local] = value;
        self.decimals[local] = decimals;
    }

    /// ADP: the value as if it had been passed with a point.
    pub(super) fn with_point(&self, local: usize) -> f64 {
        self.values[local].number() * 10_f64.powi(i32::from(self.decimals[local]))
    }
}

impl std::ops::Index<usize> for Locals {
    type Output = Value;

    fn index(&self, local: usize) -> &Value {
        &self.values[local]
    }
}

/// Where a number belongs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Vacant,
    Local(usize),
    Common(usize),
    System,
}

const COMMONS: usize = 1000;

/// All variables that a program may use freely.
#[derive(Clone, Debug)]
pub struct Vars {
    /// The locals of the current level.
    locals: Locals,
    /// Those of the levels that wait for it, the main program's first.
    outer: Vec<Locals>,
    commons: Vec<Value>,
    /// The numbers of further commons, which follow the others in `commons`.
    more: (u32, u32),
    /// `#10100` is `#100`.
    aliased: bool,
    /// A digest of all values in force, kept up with every write.
    digest: u64,
}

impl Vars {
    /// `more` are the numbers of commons beyond #999; with `aliased` #10100 is #100, and so on.
    pub(super) fn new(more: Option<(u32, u32)>, aliased: bool) -> Self {
        let count = more.map_or(0, |(from, to)| (to - from + 1) as usize);
        let more = more.unwrap_or((1, 0));
        Self {
            locals: VACANT,
            outer: Vec::new(),
            commons: vec![Value::Vacant; COMMONS + count],
            more,
            aliased,
            digest: 0,
        }
    }
}

impl Vars {
    /// What kind of variable `number` is.
    #[inline]
    pub(super) fn kind(&self, number: u32) -> Kind {
        match Slot::of(number) {
            Slot::Local(local) => Kind::Local(usize::from(local)),
            Slot::Common(common) => Kind::Common(usize::from(common)),
            Slot::Other(number) => self.other_kind(number),
        }
    }

    /// What kind of variable one is that settings of the control decide about.
    fn other_kind(&self, number: u32) -> Kind {
        match number {
            0 => Kind::Vacant,
            10_100..=10_199 | 10_500..=10_999 if self.aliased => Kind::Common(number as usize - 10_000),
            _ if (self.more.0..=self.more.1).contains(&number) => {
                Kind::Common(COMMONS + (number - self.more.0) as usize)
            }
            _ => Kind::System,
        }
    }

    #[inline]
    pub fn locals(&self) -> &Locals {
        &self.locals
    }

    #[inline]
    pub(super) fn set_local(&mut self, index: usize, value: Value) {
        self.note(self.level() + 1, index, self.locals[index], value);
        self.locals.set(index, value, 0);
    }

    pub(super) fn set_locals(&mut self, locals: &Locals) {
        self.note_all(self.level() + 1, &self.locals.clone(), locals);
        self.locals = *locals;
    }

    /// Keeps the digest up with a variable.
    #[inline]
    fn note(&mut self, level: usize, index: usize, old: Value, new: Value) {
        // Each variable counts by an odd factor of its own, so that none makes up for another.
        let factor = ((level << 16 | index) as u64).wrapping_mul(0x3C6E_F372_FE94_F82A) | 1;
        let change = mixed(new).wrapping_sub(mixed(old)).wrapping_mul(factor);
        self.digest = self.digest.wrapping_add(change);
    }

    fn note_all(&mut self, level: usize, old: &Locals, new: &Locals) {
        for (index, (old, new)) in old.values.iter().zip(new.values).enumerate() {
            self.note(level, index, *old, new);
        }
    }

    /// Differs almost surely where any value differs.
    pub(super) fn digest(&self) -> u64 {
        self.digest
    }

    /// Whether all values in force are the same.
    pub(super) fn same(&self, other: &Self) -> bool {
        self.locals == other.locals && self.outer == other.outer && self.commons == other.commons
    }

    pub fn level(&self) -> usize {
        self.outer.len()
    }

    pub fn common(&self, index: usize) -> Value {
        self.commons[index]
    }

    #[inline]
    pub(super) fn set_common(&mut self, index: usize, value: Value) {
        self.note(0, index, self.commons[index], value);
        self.commons[index] = value;
    }

    /// A macro call: a new level with these locals.
    pub(super) fn enter(&mut self, locals: &Locals) {
        self.outer.push(std::mem::replace(&mut self.locals, *locals));
        self.note_all(self.level() + 1, &VACANT, locals);
    }

    /// Back to the caller's locals.
    pub(super) fn leave(&mut self) {
        self.note_all(self.level() + 1, &self.locals.clone(), &VACANT);
        if let Some(callers) = self.outer.pop() {
            self.locals = callers;
        }
    }

    /// The variables that aren't vacant, by number: the locals of the main program and the commons.
    pub fn known(&self) -> impl Iterator<Item = (u32, f64)> + '_ {
        let locals = self.outer.first().unwrap_or(&self.locals).values.iter().enumerate();
        let (commons, more) = self.commons.split_at(COMMONS);
        let more = (self.more.0 as usize..).zip(more);
        let all = locals.chain(commons.iter().enumerate()).chain(more);
        all.filter_map(|(number, value)| Some((number as u32, value.given()?)))
    }
}

/// A value's part of the digest. What tells numbers apart is in their highest bits, and a product only carries upwards.
#[inline]
fn mixed(value: Value) -> u64 {
    match value {
        Value::Vacant => 0,
        Value::Number(number) => !number.to_bits().rotate_left(24),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_call_hides_the_callers_locals_and_a_return_brings_them_back() {
        let mut vars = Vars::new(None, false);
        vars.set_local(1, Value::Number(7.0));
        vars.enter(&VACANT);
        assert!(vars.locals()[1].is_vacant());
        vars.set_local(1, Value::Number(9.0));
        vars.leave();
        assert_eq!(vars.locals()[1], Value::Number(7.0));
        vars.enter(&VACANT);
        assert!(vars.locals()[1].is_vacant(), "a level used before starts vacant");
    }

    #[test]
    fn the_digest_comes_back_with_the_values() {
        let mut vars = Vars::new(None, false);
        vars.set_common(500, Value::Number(1.0));
        vars.set_local(3, Value::Number(0.0));
        let before = vars.digest();
        let mut locals = VACANT;
        locals.set(7, Value::Number(5.0), 0);
        vars.enter(&locals);
        vars.set_local(7, Value::Number(6.0));
        assert_ne!(vars.digest(), before);
        vars.leave();
        vars.set_local(3, Value::Vacant);
        assert_ne!(vars.digest(), before, "0 is not vacant");
        vars.set_local(3, Value::Number(0.0));
        assert_eq!(vars.digest(), before);
    }
}
