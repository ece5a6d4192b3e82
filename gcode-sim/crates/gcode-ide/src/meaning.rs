//! Meaning of a variable: what the head of its program or a comment beside its value says.
use gcode_lang::program::NoLibrary;
use gcode_lang::syntax::ast::ProgramName;
use gcode_lint::rules::MISSING_ARGUMENT;

use crate::entry::EntryKind;
use crate::head_comment::{VariableMeaning, meanings, optional_letters};
use crate::project::{ProgramKey, Project};
use crate::scope::VariableScope;
use crate::text::{TextRange, line_range, lossy};

/// Most files that are searched for the meaning of a common.
const MAX_SEARCHED: usize = 500;

/// Longest macro that is checked for the arguments that it requires, bytes.
const MAX_CHECKED: u32 = 256 * 1024;

impl Project {
    /// Returns what the comments of a program say of a variable.
    pub(crate) fn stated_meaning(&self, number: u32, key: ProgramKey) -> Option<String> {
        let index = self.file(key.file)?;
        let in_head = meanings(index, key.program).into_iter().find(|meaning| meaning.number == number);
        if let Some(meaning) = in_head {
            return Some(meaning.text);
        }
        let mut writes = index.program_entries(key.program);
        let writes = writes.by_ref().filter(|entry| entry.kind == EntryKind::Write && entry.value == number);
        // An assignment at depth 0 is the only one of its block; its comment says what the value is.
        let mut comments = writes.filter_map(|entry| {
            let line = line_range(index.text(), entry.range.start);
            let before = TextRange::new(line.start, entry.range.start).of(index.text());
            let is_first = before.iter().all(|byte| byte.is_ascii_alphanumeric() || *byte == b' ');
            let behind = lossy(TextRange::new(entry.range.end, line.end).of(index.text()));
            let (_, comment) = behind.split_once('(').filter(|_| is_first)?;
            let text = comment.split(')').next()?.trim().to_owned();
            (!text.is_empty()).then_some(text)
        });
        comments.next()
    }

    /// Returns the meaning of a variable in a program; of a common in any, with the label of that program.
    pub(crate) fn meaning(&self, number: u32, key: ProgramKey) -> Option<(String, Option<String>)> {
        if let Some(text) = self.stated_meaning(number, key) {
            return Some((text, None));
        }
        let scope = VariableScope::of(number, self.settings());
        let others: Vec<_> = match scope {
            VariableScope::Common => self.programs().map(|(other, _)| other).take(MAX_SEARCHED).collect(),
            VariableScope::Local => self.programs_of_level(key),
            VariableScope::Null | VariableScope::System => Vec::new(),
        };
        let mut others = others.into_iter().filter(|other| *other != key);
        others.find_map(|other| Some((self.stated_meaning(number, other)?, Some(self.label(other)))))
    }

    /// Returns the arguments of a macro: those of its head, and the locals that it reads before it sets them.
    pub(crate) fn parameters_of(&self, key: ProgramKey) -> Vec<MacroParameter> {
        let Some(index) = self.file(key.file) else { return Vec::new() };
        let stated: Vec<VariableMeaning> = meanings(index, key.program);
        let mut set = [false; 34];
        let mut read = [false; 34];
        let mut line = TextRange::default();
        let mut pending: Option<usize> = None;
        for entry in index.program_entries(key.program) {
            let Some(local) = usize::try_from(entry.value).ok().filter(|local| (1..34).contains(local))
            else {
                continue;
            };
            if entry.range.start >= line.end {
                // The value of an assignment is read before its target is set.
                if let Some(target) = pending.take() {
                    set[target] = true;
                }
                line = line_range(index.text(), entry.range.start);
            }
            match entry.kind {
                EntryKind::Write => pending = Some(local),
                EntryKind::Read if !set[local] => {
                    read[local] = true;
                }
                _ => {}
            }
        }
        let is_parameter = |local: usize| {
            let is_stated = stated.iter().any(|m| m.number as usize == local && m.letter.is_some());
            is_stated || read[local]
        };
        let required = self.required_letters(key);
        let optional = optional_letters(index, key.program);
        let locals = (1..=26).filter_map(|local| Some((local, gcode_lang::program::argument_letter(local)?)));
        let parameters =
            locals.filter(|(local, _)| is_parameter(*local)).map(|(local, letter)| MacroParameter {
                letter,
                local: local as u32,
                text: stated
                    .iter()
                    .find(|m| m.number as usize == local)
                    .map(|m| m.text.clone())
                    .unwrap_or_default(),
                is_optional: !required.contains(&letter)
                    && optional.as_ref().is_none_or(|optional| {
                        optional.contains(&letter) || stated.iter().all(|m| m.letter != Some(letter))
                    }),
            });
        let mut found: Vec<_> = parameters.collect();
        found.sort_by_key(|parameter| parameter.letter);
        found
    }

    /// Returns the letters without which `check` expects a macro to stop or to compute with 0.
    fn required_letters(&self, key: ProgramKey) -> Vec<char> {
        let Some((index, outline)) = self.file(key.file).zip(self.program(key)) else { return Vec::new() };
        let Some(ProgramName::Number(number)) = self.name_of(key) else { return Vec::new() };
        if outline.range.len() > MAX_CHECKED {
            return Vec::new();
        }
        let caller = if number == 1 { 2 } else { 1 };
        let body = TextRange::new(outline.name_range.end, outline.range.end);
        let mut letters = Vec::new();
        // Behind an alarm nothing is computed: what else is missing shows once the arguments are there.
        loop {
            let passed: String = letters.iter().map(|letter| format!(" {letter}1.")).collect();
            let mut text = format!("O{caller}\nG65 P{number}{passed}\nM30\nO{number}\n").into_bytes();
            text.extend_from_slice(body.of(index.text()));
            let checked = gcode_lint::check("call", text, self.settings(), &mut NoLibrary);
            let missing = checked.findings.iter().filter(|finding| finding.kind == MISSING_ARGUMENT);
            let found = missing.filter_map(|finding| finding.message.split_once(" (#")?.0.chars().last());
            let before = letters.len();
            letters.extend(found);
            letters.sort_unstable();
            letters.dedup();
            if letters.len() == before {
                return letters;
            }
        }
    }
}

/// Argument that a macro takes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct MacroParameter {
    pub letter: char,
    pub local: u32,
    /// Meaning, empty if no comment states one.
    pub text: String,
    /// True if the macro does without it.
    pub is_optional: bool,
}
