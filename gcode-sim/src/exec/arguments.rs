//! The words of a macro call to the locals they set.
use super::Core;
use super::eval::Checked;
use super::vars::{Locals, VACANT, Value};
use crate::alarm::Alarm;
use crate::program::{ArgumentLocals, Coded, Program};

impl Core {
    /// Word by word in the order they stand in; a vacant value leaves its local vacant. `every` is G66.1, which takes
    /// G, L, N and P as well.
    pub(super) fn arguments(&self, program: &Program, words: &[Coded], every: bool) -> Checked<Locals> {
        let mut locals = VACANT;
        let mut letters = ArgumentLocals::new(self.settings.plain_ijk, every);
        for word in words {
            if word.comma {
                return Err(Alarm::ImproperAddress { letter: char::from(word.letter) }.at(word.span));
            }
            let local = letters.next(word.letter).map_err(|alarm| alarm.at(word.span))?;
            let Some(local) = local else { continue };
            if let Some(raw) = self.raw_argument(program, word)? {
                let decimals = self.argument_decimals(raw, word.letter);
                locals.set(local, Value::Number(self.argument(raw, word.letter)), decimals);
            }
        }
        Ok(locals)
    }
}
