//! Scope of variables: the macro level of a local, the project for a common.
use gcode_lang::control::Settings;

use gcode_lang::syntax::ast::{Item, Statement};

use crate::block_entries::NAMED;
use crate::entry::EntryKind;
use crate::project::{ProgramKey, Project};
use crate::text::{FileId, TextRange, lossy};

/// Scope of a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VariableScope {
    /// #0, always vacant.
    Null,
    /// #1 to #33 of a macro level.
    Local,
    /// Common to all programs.
    Common,
    /// System variable, or a number that no control has.
    System,
}

impl VariableScope {
    /// Returns the scope of a number on a control.
    pub fn of(number: u32, settings: &Settings) -> Self {
        match number {
            0 => Self::Null,
            1..=33 => Self::Local,
            100..=199 | 500..=999 => Self::Common,
            10_100..=10_199 | 10_500..=10_999 if settings.aliases_commons => Self::Common,
            _ if settings.extra_commons.iter().any(|(from, to)| (*from..=*to).contains(&number)) => {
                Self::Common
            }
            _ => Self::System,
        }
    }

    /// Returns the name in messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::Null => "null variable",
            Self::Local => "local variable",
            Self::Common => "common variable",
            Self::System => "system variable",
        }
    }
}

/// Returns the number under which a common is stored: #10100 of a Haas is #100.
pub(crate) fn canonical(number: u32, settings: &Settings) -> u32 {
    match number {
        10_100..=10_199 | 10_500..=10_999 if settings.aliases_commons => number - 10_000,
        _ => number,
    }
}

impl Project {
    /// Returns the programs that share the locals of a program: they call one another by M98.
    pub(crate) fn programs_of_level(&self, key: ProgramKey) -> Vec<ProgramKey> {
        let links: Vec<_> = self
            .all_calls()
            .filter(|(_, call)| !call.record.has_own_locals)
            .filter_map(|(from, call)| Some((from, self.called_program(from.file, &call.record.target)?)))
            .collect();
        let mut level = vec![key];
        let mut next = 0;
        while let Some(current) = level.get(next).copied() {
            for (from, to) in &links {
                let other = match current {
                    _ if current == *from => to,
                    _ if current == *to => from,
                    _ => continue,
                };
                if !level.contains(other) {
                    level.push(*other);
                }
            }
            next += 1;
        }
        level
    }

    /// Returns the names that a SETVN gives to consecutive variables.
    pub(crate) fn given_names(&self, file: FileId, range: TextRange) -> Vec<String> {
        let block = self.block(file, range.start);
        let names = block.into_iter().flat_map(|block| block.items).filter_map(|item| match item {
            Item::Statement(statement) => match statement.node {
                Statement::SetNames { names, .. } => Some(names),
                _ => None,
            },
            _ => None,
        });
        names.flatten().collect()
    }

    /// Returns the number of the variable that a SETVN of the project gives a name, `[#TOOL_NO]`.
    pub(crate) fn named_variable(&self, file: FileId, range: TextRange) -> Option<u32> {
        let text = lossy(range.of(self.file(file)?.text())).to_ascii_uppercase();
        let (_, behind) = text.split_once('#')?;
        let name = behind.split(|c: char| !c.is_ascii_alphanumeric() && c != '_').next()?;
        self.files().find_map(|(other, index)| {
            let mut given =
                index.all_entries().filter(|entry| entry.kind == EntryKind::SetNames && entry.value != NAMED);
            given.find_map(|entry| {
                let place = self.given_names(other, entry.range).iter().position(|given| given == name)?;
                entry.value.checked_add(place as u32)
            })
        })
    }
}
