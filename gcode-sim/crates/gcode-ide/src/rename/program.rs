//! Rename of a program with its calls.
use gcode_lang::control::SEQUENTIAL_CODES;
use gcode_lang::syntax::ast::ProgramName;
use gcode_lint::CalledProgramName;

use super::{digits_in, file_edit};
use crate::entry::EntryKind;
use crate::project::Project;
use crate::text::{FileEdit, FileId, Refusal, TextRange};

/// Largest program number.
const MAX_PROGRAM: u32 = 99_999_999;

impl Project {
    /// Refuses a program that cannot be renamed, whatever its new number.
    pub(super) fn check_program(&self, number: u32, from: FileId) -> Result<(), Refusal> {
        let name = ProgramName::Number(number);
        let label = name.label();
        let named = self.programs_named(&name, from);
        match named[..] {
            [] => return Err(Refusal::new(format!("{label} is not in the project"))),
            [key] => {
                if self.program(key).is_none_or(|program| program.name != name) {
                    return Err(Refusal::new(format!(
                        "{label} has its number from the name of its file: rename the file"
                    )));
                }
            }
            [_, second, ..] => {
                let range = self.program(second).map(|program| program.name_range).unwrap_or_default();
                let reason =
                    format!("{label} is in the project more than once: {}", self.place(second, range));
                return Err(Refusal::new(reason).at(second.file, range));
            }
        }
        if let Some(code) = self.code_that_calls(number) {
            return Err(Refusal::new(format!("the control calls {label} by {code}, a setting")));
        }
        for (key, call) in self.all_calls() {
            let place = || self.place(key, call.code);
            let is_by_code = call.target_range().is_none();
            let reason = match &call.record.target {
                CalledProgramName::Computed => {
                    format!("{} calls a program whose number is computed", place())
                }
                CalledProgramName::Number(called) if *called == number && is_by_code => {
                    format!("{} calls {label} by a code, a setting of the control", place())
                }
                _ => continue,
            };
            return Err(Refusal::new(reason).at(key.file, call.code));
        }
        self.refuse_unreadable_calls(number)?;
        self.refuse_reads(&[4115, 4315], "the program number")
    }

    /// Returns the edits that give a program another number.
    pub(super) fn rename_program(
        &self,
        number: u32,
        from: FileId,
        new: u32,
    ) -> Result<Vec<FileEdit>, Refusal> {
        self.check_program(number, from)?;
        if new == number {
            return Ok(Vec::new());
        }
        let (old_name, new_name) = (ProgramName::Number(number), ProgramName::Number(new));
        let label = new_name.label();
        if !(1..=MAX_PROGRAM).contains(&new) {
            return Err(Refusal::new(format!("{label} is out of range: 1 to {MAX_PROGRAM}")));
        }
        if let Some(taken) = self.programs_named(&new_name, from).first() {
            let range = self.program(*taken).map(|program| program.name_range).unwrap_or_default();
            let reason = format!("{label} is in use: {}", self.place(*taken, range));
            return Err(Refusal::new(reason).at(taken.file, range));
        }
        if let Some(code) = self.code_that_calls(new) {
            return Err(Refusal::new(format!("the control calls {label} by {code}, a setting")));
        }
        let mut edits = Vec::new();
        for key in self.programs_named(&old_name, from) {
            let Some((index, program)) = self.file(key.file).zip(self.program(key)) else { continue };
            let spelled = digits_in(index.text(), program.name_range);
            let unread =
                || Refusal::new("the name of the program is no number").at(key.file, program.name_range);
            edits.push(file_edit(key.file, spelled.ok_or_else(unread)?, format!("{new:04}")));
        }
        for (key, call) in self.all_calls() {
            match &call.record.target {
                CalledProgramName::Number(called) if *called == number => {}
                CalledProgramName::Number(called) if *called == new => {
                    let reason = format!(
                        "{} calls {label}, which is missing, and would find it",
                        self.place(key, call.code)
                    );
                    return Err(Refusal::new(reason).at(key.file, call.code));
                }
                _ => continue,
            }
            let range = call.target_range().unwrap_or(call.code);
            let edit = self.call_edit(key.file, range, number, new).ok_or_else(|| {
                let text = self.text(key.file, range);
                let reason = format!("{} spells the number as {text}", self.place(key, range));
                Refusal::new(reason).at(key.file, range)
            })?;
            edits.push(edit);
        }
        let is_recalled = |from: &Option<ProgramName>, to: &Option<ProgramName>| {
            from.as_ref() == Some(&old_name) && to.as_ref() == Some(&new_name)
        };
        self.prove(&edits, |_, _, _| false, is_recalled)?;
        Ok(edits)
    }

    /// Returns the edit of a word P: `P8101`, or `P51234` for O1234 five times.
    fn call_edit(&self, file: FileId, word: TextRange, number: u32, new: u32) -> Option<FileEdit> {
        let digits = digits_in(self.file(file)?.text(), word).filter(|digits| {
            let behind = self.text(file, TextRange::new(digits.end, word.end));
            behind.is_empty() || behind == "."
        })?;
        let text = self.text(file, digits);
        let written: u32 = text.parse().ok()?;
        if written == number {
            let width = if text.starts_with('0') { text.len() } else { 1 };
            return Some(file_edit(file, digits, format!("{new:0width$}")));
        }
        let is_repeated = written % 10_000 == number && new <= 9999;
        let last = TextRange::new(digits.end.checked_sub(4)?, digits.end);
        is_repeated.then(|| file_edit(file, last, format!("{new:04}")))
    }

    /// Returns the code that calls a program by a parameter.
    fn code_that_calls(&self, number: u32) -> Option<String> {
        let calls = &self.settings().code_calls;
        let sequential = SEQUENTIAL_CODES.iter().find_map(|codes| {
            let index = u16::try_from(number.checked_sub(codes.program)?).ok()?;
            let parameter = codes.first.checked_add(index).filter(|parameter| *parameter <= codes.last)?;
            let code = calls.parameter(parameter).filter(|code| *code != 0)?;
            Some(format!("{}{}", char::from(codes.letter), code.abs()))
        });
        let by_address = || {
            let called = |letter: &u8| calls.address_call(*letter).is_some_and(|call| call.program == number);
            (b'A'..=b'Z').find(called).map(|letter| char::from(letter).to_string())
        };
        sequential.or_else(by_address)
    }

    /// Refuses if text that cannot be read spells the number behind a P.
    fn refuse_unreadable_calls(&self, number: u32) -> Result<(), Refusal> {
        let spelled = [format!("P{number}"), format!("P{number:04}")];
        for (key, _) in self.programs() {
            let Some(index) = self.file(key.file) else { continue };
            for entry in
                index.program_entries(key.program).filter(|entry| entry.kind == EntryKind::Unreadable)
            {
                let text = self.text(key.file, entry.range).replace(' ', "").to_ascii_uppercase();
                if spelled.iter().any(|spelled| text.contains(spelled.as_str())) {
                    let reason = format!("{} cannot be read and may call it", self.place(key, entry.range));
                    return Err(Refusal::new(reason).at(key.file, entry.range));
                }
            }
        }
        Ok(())
    }
}
