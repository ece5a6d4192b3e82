//! Calls of a program: G65, G66, M98 and the codes that call programs, with the locals their arguments set.
use gcode_lang::control::{CalledProgram, CodeCallKind, Settings};
use gcode_lang::program::{
    ArgumentLocals, CallCode, CallTarget, LoweredWord, Memory, OpIndex, Program, ProgramId, WordOperand,
    Words,
};
use gcode_lang::source::Span;
use gcode_lang::syntax::ast::{Folder, ProgramName};

use super::literal;

/// Call of a block.
#[derive(Debug)]
pub struct CallSite {
    /// Block of the call in its program.
    pub block: OpIndex,
    /// Kind of the call; `None` for a code that calls a program.
    pub kind: Option<CallCode>,
    /// True for a call with its own locals; M98 shares the caller's.
    pub has_own_locals: bool,
    /// True for G66, whose macro is called after later moves.
    pub is_modal: bool,
    /// Called program.
    pub target: CalledProgramName,
    /// Word P of the called program.
    pub target_span: Option<Span>,
    /// Folder of the calling program.
    pub folder: Option<Folder>,
    /// Sequence number at which the called program starts: Q of M98, P of M97; `None` for a computed one.
    pub start: Option<u32>,
    /// All digits of P, if the first ones are repeats.
    pub digits_of_p: Option<u32>,
    /// Word of the sequence number.
    pub start_span: Option<Span>,
    /// Locals that the arguments set.
    pub arguments: Vec<Argument>,
    /// Code of the call.
    pub span: Span,
}

impl CallSite {
    /// Returns true for a call of a part of the same program: M97 P, or M98 with Q or H alone.
    pub fn is_of_own_program(&self) -> bool {
        self.target == CalledProgramName::Missing && self.start_span.is_some()
    }
}

/// Program of a call, as far as it is known without a run.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum CalledProgramName {
    /// O number.
    Number(u32),
    /// Program name.
    Name(String),
    /// Computed number, `P#1`.
    Computed,
    /// No P.
    Missing,
}

/// Argument of a macro call.
#[derive(Clone, Copy, Debug)]
pub struct Argument {
    /// Letter of the argument.
    pub letter: u8,
    /// Local that the argument sets.
    pub local: usize,
    /// Span of the word.
    pub span: Span,
    /// True for a number, which cannot be vacant.
    pub is_number: bool,
}

/// Returns the programs that a program calls, also by codes that call programs.
pub fn called_programs(program: &Program, settings: &Settings) -> Vec<CalledProgramName> {
    call_sites(program, settings).into_iter().map(|site| site.target).collect()
}

pub(super) fn call_sites(program: &Program, settings: &Settings) -> Vec<CallSite> {
    let mut found = Vec::new();
    for (block, op) in program.ops().iter().enumerate() {
        if let Some(words) = op.kind().words() {
            let site = call_site(block, words, settings);
            found.extend(site.map(|site| CallSite { folder: program.folder.clone(), ..site }));
        }
    }
    found
}

/// Returns the call of a block of words, also by a code that calls a program; `None` for a return.
pub fn call_site(block: OpIndex, words: &Words, settings: &Settings) -> Option<CallSite> {
    let Some(call) = words.call() else { return code_call_site(block, words, settings) };
    let subprogram = matches!(call.kind, CallCode::Subprogram | CallCode::File | CallCode::Local);
    if matches!(call.kind, CallCode::Return | CallCode::Cancel) {
        return None;
    }
    let has_repeats_in_p =
        call.kind == CallCode::Subprogram && settings.reads_repeats_in_p && call.repeats.is_none();
    let mut digits_of_p = None;
    let target = match &call.target {
        CallTarget::None => CalledProgramName::Missing,
        CallTarget::Name(name) => CalledProgramName::Name(name.clone()),
        CallTarget::Number(word) => match literal::word_count(word) {
            None => CalledProgramName::Computed,
            // M98 P with more than four digits: repeats before a four-digit program number.
            Some(number) if has_repeats_in_p && number > 9999 => {
                digits_of_p = Some(number);
                CalledProgramName::Number(number % 10_000)
            }
            Some(number) => CalledProgramName::Number(number),
        },
    };
    let target_span = match &call.target {
        // O stands for a path in a comment.
        CallTarget::Number(word) => (word.letter == b'P').then_some(word.span),
        CallTarget::Name(_) | CallTarget::None => None,
    };
    Some(CallSite {
        block,
        kind: Some(call.kind),
        has_own_locals: !subprogram,
        is_modal: matches!(call.kind, CallCode::AfterMoves | CallCode::EveryBlock),
        target,
        digits_of_p,
        target_span,
        folder: None,
        start: call.start.as_ref().and_then(literal::word_count),
        start_span: call.start.as_ref().map(|word| word.span),
        arguments: arguments(&call.arguments, call.kind == CallCode::EveryBlock, settings),
        span: call.span,
    })
}

/// Returns the call that a code makes by a parameter.
///
/// The code of a macro is the first word, and the other words are its arguments; the code of a subprogram may
/// have any position.
fn code_call_site(block: OpIndex, words: &Words, settings: &Settings) -> Option<CallSite> {
    if settings.code_calls.is_empty() {
        return None;
    }
    words.list.iter().enumerate().find_map(|(place, word)| {
        let called = match (word.letter, word.value) {
            (b'G', WordOperand::G(code, _)) => settings.code_calls.find_call(b'G', code),
            (b'M', _) => settings.code_calls.find_call(b'M', literal::word_count(word)?.checked_mul(10)?),
            (letter, _) => settings
                .code_calls
                .address_call(letter)
                .map(|call| CalledProgram { program: call.program, kind: CodeCallKind::Subprogram }),
        }?;
        let has_own_locals = called.kind != CodeCallKind::Subprogram;
        let is_modal = called.kind == CodeCallKind::Modal;
        let is_every_block = is_modal && settings.code_calls.modal_is_every_block;
        let arguments = match has_own_locals {
            true if place > 0 => return None,
            true => arguments(&words.list[1..], is_every_block, settings),
            false => Vec::new(),
        };
        let program = match called.kind {
            CodeCallKind::MacroInP => {
                words.list.iter().find(|word| word.letter == b'P').and_then(literal::word_count)?
            }
            CodeCallKind::Macro | CodeCallKind::Modal | CodeCallKind::Subprogram => called.program,
        };
        let target = CalledProgramName::Number(program);
        let target_span = match called.kind {
            CodeCallKind::MacroInP => {
                words.list.iter().find(|word| word.letter == b'P').map(|word| word.span)
            }
            CodeCallKind::Macro | CodeCallKind::Modal | CodeCallKind::Subprogram => None,
        };
        Some(CallSite {
            block,
            kind: None,
            has_own_locals,
            is_modal,
            target,
            digits_of_p: None,
            target_span,
            folder: None,
            start: None,
            start_span: None,
            arguments,
            span: word.span,
        })
    })
}

fn arguments(words: &[LoweredWord], is_every_block: bool, settings: &Settings) -> Vec<Argument> {
    let mut letters = ArgumentLocals::new(settings.reads_ijk_plainly, is_every_block);
    let arguments = words.iter().filter_map(|word| {
        let local = letters.next(word.letter).ok().flatten()?;
        let is_number = literal::word_number(word).is_some();
        Some(Argument { letter: word.letter, local, span: word.span, is_number })
    });
    arguments.collect()
}

impl CalledProgramName {
    /// Returns the name used in messages: `O8101`, `<PROBE>`.
    pub fn label(&self) -> String {
        match self {
            Self::Number(number) => format!("O{number:04}"),
            Self::Name(name) => format!("<{name}>"),
            Self::Computed | Self::Missing => "the called program".into(),
        }
    }

    /// Returns the program that a call from `folder` finds in memory.
    pub fn find(&self, memory: &Memory, folder: Option<&Folder>) -> Option<ProgramId> {
        match self {
            Self::Number(number) => memory.find_from(&ProgramName::Number(*number), folder),
            Self::Name(name) => memory.find_from(&ProgramName::of(name.clone()), folder),
            Self::Computed | Self::Missing => None,
        }
    }
}
