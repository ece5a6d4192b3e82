//! Rename of a local within its macro level, and of a common in the whole project.
use gcode_lang::control::Dialect;
use gcode_lang::program::{ArgumentLocals, argument_letter};

use super::{digits_in, file_edit};
use crate::block_entries::NAMED;
use crate::entry::EntryKind;
use crate::file_index::Call;
use crate::navigation::Reference;
use crate::project::{ProgramKey, Project};
use crate::scope::{VariableScope, canonical};
use crate::symbol::Symbol;
use crate::text::{FileEdit, Refusal, TextRange};

/// Commons that SETVN can name.
const NAMED_COMMONS: std::ops::RangeInclusive<u32> = 500..=549;

/// First common variable of a Fanuc that keeps its value when the power is off (operator's manual, macro variables).
const FIRST_KEPT: u32 = 500;

impl Project {
    /// Refuses a variable that cannot be renamed, whatever its new number.
    pub(super) fn check_variable(&self, number: u32, program: ProgramKey) -> Result<(), Refusal> {
        let scope = VariableScope::of(number, self.settings());
        match scope {
            VariableScope::Null => return Err(Refusal::new("#0 is the vacant variable of the control")),
            VariableScope::System => {
                return Err(Refusal::new(format!(
                    "#{number} is a system variable: the control gives it its number"
                )));
            }
            VariableScope::Local | VariableScope::Common => {}
        }
        let keys = self.programs_of_scope(scope, program);
        self.refuse_computed_variables(&keys, number)?;
        self.refuse_names(&[number])?;
        self.refuse_messages(&keys, number)?;
        self.refuse_address_calls(&[number])?;
        if scope == VariableScope::Local {
            self.refuse_unknown_level(&keys, number)?;
        }
        for reference in self.variable_places(number, scope, program) {
            self.spelled_number(&reference, number)?;
        }
        Ok(())
    }

    /// Returns the edits that give a variable another number.
    pub(super) fn rename_variable(
        &self,
        number: u32,
        program: ProgramKey,
        new: u32,
    ) -> Result<Vec<FileEdit>, Refusal> {
        self.check_variable(number, program)?;
        let scope = VariableScope::of(number, self.settings());
        if new == number {
            return Ok(Vec::new());
        }
        self.check_new_variable(number, scope, new)?;
        let keys = self.programs_of_scope(scope, program);
        if let Some(taken) = self.variable_places(new, scope, program).first() {
            let place = self.place_of(taken);
            let reason = format!("#{new} is in use: {place}");
            return Err(Refusal::new(reason).at(taken.location.file, taken.location.range));
        }
        self.refuse_names(&[new])?;
        self.refuse_address_calls(&[new])?;
        let mut edits = Vec::new();
        for reference in self.variable_places(number, scope, program) {
            let digits = self.spelled_number(&reference, number)?;
            edits.push(file_edit(reference.location.file, digits, new.to_string()));
        }
        if scope == VariableScope::Local {
            self.rename_arguments(&keys, (number, new), &mut edits)?;
        }
        let is_renamed = |kind: EntryKind, from: u32, to: u32| {
            matches!(kind, EntryKind::Read | EntryKind::Write) && (from, to) == (number, new)
        };
        self.prove(&edits, is_renamed, |_, _| false)?;
        Ok(edits)
    }

    fn programs_of_scope(&self, scope: VariableScope, program: ProgramKey) -> Vec<ProgramKey> {
        match scope {
            VariableScope::Local => self.programs_of_level(program),
            _ => self.programs().map(|(key, _)| key).collect(),
        }
    }

    fn check_new_variable(&self, number: u32, scope: VariableScope, new: u32) -> Result<(), Refusal> {
        let new_scope = VariableScope::of(new, self.settings());
        if new_scope != scope {
            let range =
                if scope == VariableScope::Local { "#1 to #33" } else { "#100 to #199 or #500 to #999" };
            let kind =
                if new_scope == VariableScope::Local { "a local variable" } else { "not such a variable" };
            let reason = format!("#{number} is a {}, #{new} is {kind}: write {range}", scope.name());
            return Err(Refusal::new(reason));
        }
        // A Haas saves all common variables (Mill Operator's Manual, macro variables).
        let keeps_all = self.settings().dialect == Dialect::HaasNgc;
        let is_plain = number.max(new) < 1000;
        if scope == VariableScope::Common
            && is_plain
            && !keeps_all
            && (number < FIRST_KEPT) != (new < FIRST_KEPT)
        {
            let (kept, cleared) = (number.max(new), number.min(new));
            let range = if FIRST_KEPT <= number { "#500 to #999" } else { "#100 to #199" };
            let reason =
                format!("#{kept} keeps its value when the power is off, #{cleared} doesn't: write {range}");
            return Err(Refusal::new(reason));
        }
        if canonical(new, self.settings()) != new {
            let same = canonical(new, self.settings());
            return Err(Refusal::new(format!("#{new} is another name of #{same}: write #{same}")));
        }
        Ok(())
    }

    /// Returns the places that spell a variable, its arguments left out.
    fn variable_places(&self, number: u32, scope: VariableScope, program: ProgramKey) -> Vec<Reference> {
        let symbol = Symbol::Variable { number, scope, program };
        let mut found = self.symbol_references(&symbol, program.file);
        found.retain(|reference| {
            let text = self.text(reference.location.file, reference.location.range);
            !text.starts_with(|c: char| c.is_ascii_alphabetic())
        });
        found
    }

    fn place_of(&self, reference: &Reference) -> String {
        let key = self.program_at(reference.location.file, reference.location.range.start);
        key.map_or_else(String::new, |key| self.place(key, reference.location.range))
    }

    /// Returns the digits of a reference; refuses one that spells the variable in another way.
    fn spelled_number(&self, reference: &Reference, number: u32) -> Result<TextRange, Refusal> {
        let (file, range) = (reference.location.file, reference.location.range);
        let digits = self.file(file).and_then(|index| digits_in(index.text(), range));
        let is_same = |digits: &TextRange| self.text(file, *digits).parse() == Ok(number);
        digits.filter(is_same).ok_or_else(|| {
            let text = self.text(file, range);
            let reason = format!("{} spells #{number} as {text}", self.place_of(reference));
            Refusal::new(reason).at(file, range)
        })
    }

    /// Refuses if a program accesses a variable whose number only the run knows.
    fn refuse_computed_variables(&self, keys: &[ProgramKey], number: u32) -> Result<(), Refusal> {
        for key in keys {
            let Some(index) = self.file(key.file) else { continue };
            let mut entries = index.program_entries(key.program);
            let computed = entries
                .find(|entry| matches!(entry.kind, EntryKind::ComputedRead | EntryKind::ComputedWrite));
            if let Some(entry) = computed {
                let text = self.text(key.file, entry.range);
                let reason =
                    format!("{} accesses {text}, which may be #{number}", self.place(*key, entry.range));
                return Err(Refusal::new(reason).at(key.file, entry.range));
            }
        }
        Ok(())
    }

    /// Refuses if SETVN may give one of the variables a name.
    fn refuse_names(&self, numbers: &[u32]) -> Result<(), Refusal> {
        for (key, _) in self.programs() {
            let Some(index) = self.file(key.file) else { continue };
            for entry in index.program_entries(key.program) {
                let is_named = match entry.kind {
                    EntryKind::SetNames => {
                        let count = self.given_names(key.file, entry.range).len() as u32;
                        let first = entry.value;
                        numbers
                            .iter()
                            .any(|n| first == NAMED || (first..first.saturating_add(count)).contains(n))
                    }
                    EntryKind::Read | EntryKind::Write if entry.value == NAMED => {
                        numbers.iter().any(|number| NAMED_COMMONS.contains(number))
                    }
                    _ => false,
                };
                if is_named {
                    let text = self.text(key.file, entry.range);
                    let reason = format!("{} may name the variable: {text}", self.place(key, entry.range));
                    return Err(Refusal::new(reason).at(key.file, entry.range));
                }
            }
        }
        Ok(())
    }

    /// Refuses the commons that receive the number of an address that calls a program.
    fn refuse_address_calls(&self, numbers: &[u32]) -> Result<(), Refusal> {
        for letter in b'A'..=b'Z' {
            let call = self.settings().code_calls.address_call(letter);
            if let Some(call) = call.filter(|call| numbers.contains(&call.variable)) {
                let (letter, variable) = (char::from(letter), call.variable);
                let reason = format!("{letter} calls O{} and passes its number in #{variable}", call.program);
                return Err(Refusal::new(reason));
            }
        }
        Ok(())
    }

    /// Refuses if a program that the project lacks shares the locals, or passes the local as an argument.
    fn refuse_unknown_level(&self, keys: &[ProgramKey], number: u32) -> Result<(), Refusal> {
        let mut is_called = false;
        for (from, call) in self.all_calls() {
            let called = self.called_program(from.file, &call.record.target);
            is_called |= called.is_some_and(|called| keys.contains(&called));
            if keys.contains(&from) && !call.record.has_own_locals && called.is_none() {
                let label = call.record.target.label();
                let reason = format!(
                    "{} calls {label}, which shares the local variables and is not in the project",
                    self.place(from, call.code)
                );
                return Err(Refusal::new(reason).at(from.file, call.code));
            }
        }
        let Some(letter) = argument_letter(number as usize).filter(|_| !is_called) else { return Ok(()) };
        for key in keys {
            let Some(index) = self.file(key.file) else { continue };
            let entries = || index.program_entries(key.program);
            let mut uses = entries().filter(|entry| {
                matches!(entry.kind, EntryKind::Read | EntryKind::Write) && entry.value == number
            });
            // In `#1=#1+1` the target is recorded first, the value is read first.
            let first = uses.next();
            let second = uses.next();
            let is_read_first = match (first, second) {
                (Some(first), Some(second)) if first.kind == EntryKind::Write => {
                    second.kind == EntryKind::Read && self.is_same_line(*key, first.range, second.range)
                }
                (first, _) => first.is_some_and(|first| first.kind == EntryKind::Read),
            };
            let returns = entries().any(|entry| entry.kind == EntryKind::End && entry.value == 99);
            let ends = entries().any(|entry| entry.kind == EntryKind::End && entry.value != 99);
            if let Some(first) = first.filter(|_| is_read_first && returns && !ends) {
                let reason = format!(
                    "{} is called by programs that are not in the project, and #{number} is their argument {letter}",
                    self.label(*key)
                );
                return Err(Refusal::new(reason).at(key.file, first.range));
            }
        }
        Ok(())
    }

    fn is_same_line(&self, key: ProgramKey, one: TextRange, other: TextRange) -> bool {
        let Some(index) = self.file(key.file) else { return false };
        let between = TextRange::new(one.start.min(other.start), one.end.max(other.end)).of(index.text());
        !between.iter().any(|byte| matches!(byte, b'\n' | b'\r'))
    }

    /// Renames the arguments of all calls that set a local.
    fn rename_arguments(
        &self,
        keys: &[ProgramKey],
        (number, new): (u32, u32),
        edits: &mut Vec<FileEdit>,
    ) -> Result<(), Refusal> {
        for (from, call) in self.all_calls().filter(|(_, call)| call.record.has_own_locals) {
            let locals = call.record.arguments.iter().map(|argument| argument.local());
            let passes = |local: u32| locals.clone().any(|other| other == local);
            let is_called = |key: &ProgramKey| keys.contains(key);
            let is_every_block = self.is_every_block(call.record.kind, call.record.is_modal);
            if !passes(number) && !passes(new) && !is_every_block
                || !self.called_program(from.file, &call.record.target).as_ref().is_some_and(is_called)
            {
                continue;
            }
            let place = self.place(from, call.code);
            let refused = |reason: String| Refusal::new(reason).at(from.file, call.code);
            if is_every_block {
                return Err(refused(format!("{place} passes the words of all blocks after it as arguments")));
            }
            if passes(new) {
                return Err(refused(format!("#{new} is in use: it is an argument of {place}")));
            }
            let letter = argument_letter(new as usize).ok_or_else(|| {
                refused(format!("#{number} is an argument of {place}, and #{new} has no letter"))
            })?;
            if !self.has_renamed_locals(&call, (number, new), letter) {
                let reason =
                    format!("with {letter} for #{new} the arguments of {place} would set other variables");
                return Err(refused(reason));
            }
            let arguments = call.record.arguments.iter().filter(|argument| argument.local() == number);
            edits
                .extend(arguments.map(|argument| file_edit(from.file, call.place(argument.range()), letter)));
        }
        Ok(())
    }

    /// Returns true if the arguments set the same locals with a new letter, but for the renamed one.
    fn has_renamed_locals(&self, call: &Call<'_>, (number, new): (u32, u32), letter: char) -> bool {
        let is_every_block = self.is_every_block(call.record.kind, call.record.is_modal);
        let mut locals = ArgumentLocals::new(self.settings().reads_ijk_plainly, is_every_block);
        call.record.arguments.iter().all(|argument| {
            let is_renamed = argument.local() == number;
            let written = if is_renamed { letter as u8 } else { argument.letter };
            let expected = if is_renamed { new } else { argument.local() };
            matches!(locals.next(written), Ok(Some(local)) if local as u32 == expected)
        })
    }
}
