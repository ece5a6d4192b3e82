//! Local and common variables. Vacant is a state of its own: it is neither 0 nor a number.

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
pub(super) type Locals = [Value; 34];

/// A level that nothing has been written to.
pub(super) const VACANT: Locals = [Value::Vacant; 34];

/// Where a number belongs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Vacant,
    Local(usize),
    Common(usize),
    System,
}

const COMMONS: usize = 1000;

/// What kind of variable `number` is.
pub(super) fn kind(number: u32) -> Kind {
    match number {
        0 => Kind::Vacant,
        1..=33 => Kind::Local(number as usize),
        100..=199 | 500..=999 => Kind::Common(number as usize),
        _ => Kind::System,
    }
}

/// All variables that a program may use freely.
#[derive(Clone, Debug)]
pub struct Vars {
    /// One set per level; sets above the current level are kept to be used again.
    levels: Vec<Locals>,
    level: usize,
    commons: Vec<Value>,
}

impl Default for Vars {
    fn default() -> Self {
        Self { levels: vec![VACANT], level: 0, commons: vec![Value::Vacant; COMMONS] }
    }
}

impl Vars {
    pub fn locals(&self) -> &Locals {
        &self.levels[self.level]
    }

    pub(super) fn locals_mut(&mut self) -> &mut Locals {
        &mut self.levels[self.level]
    }

    pub fn level(&self) -> usize {
        self.level
    }

    pub fn common(&self, index: usize) -> Value {
        self.commons[index]
    }

    pub(super) fn set_common(&mut self, index: usize, value: Value) {
        self.commons[index] = value;
    }

    /// A macro call: a new level with these locals.
    pub(super) fn enter(&mut self, locals: &Locals) {
        self.level += 1;
        match self.levels.get_mut(self.level) {
            Some(set) => *set = *locals,
            None => self.levels.push(*locals),
        }
    }

    /// Back to the caller's locals.
    pub(super) fn leave(&mut self) {
        self.level = self.level.saturating_sub(1);
    }

    /// The variables that aren't vacant, by number: the locals of the main program and the commons.
    pub fn known(&self) -> impl Iterator<Item = (u32, f64)> + '_ {
        let locals = self.levels[0].iter().enumerate();
        let all = locals.chain(self.commons.iter().enumerate());
        all.filter_map(|(number, value)| Some((number as u32, value.given()?)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_call_hides_the_callers_locals_and_a_return_brings_them_back() {
        let mut vars = Vars::default();
        vars.locals_mut()[1] = Value::Number(7.0);
        vars.enter(&VACANT);
        assert!(vars.locals()[1].is_vacant());
        vars.locals_mut()[1] = Value::Number(9.0);
        vars.leave();
        assert_eq!(vars.locals()[1], Value::Number(7.0));
        vars.enter(&VACANT);
        assert!(vars.locals()[1].is_vacant(), "a level used before starts vacant");
    }
}
