//! Who calls whom: G65, G66, M98 and the codes that call macros, with the locals that their arguments set.
use gcode_lang::control::{CodeCallKind, Settings};
use gcode_lang::program::{
    ArgumentLocals, CallCode, CallTarget, LoweredWord, Memory, OpIndex, OpKind, Program, WordOperand, Words,
};
use gcode_lang::source::Span;

use super::literal;

/// One block that calls.
#[derive(Debug)]
pub(crate) struct CallSite {
    pub block: OpIndex,
    /// A fresh set of locals; M98 shares the caller's.
    pub has_own_locals: bool,
    /// G66: called after moves that follow, not here.
    pub is_modal: bool,
    pub target: CalledProgramName,
    /// Where Q of M98 starts.
    pub start: Option<u32>,
    /// The locals that arguments set, with the letters they stand behind.
    pub arguments: Vec<Argument>,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum CalledProgramName {
    Number(u32),
    Name(String),
    /// `P#1`: only a run knows.
    Computed,
    /// No P at all.
    Missing,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Argument {
    pub local: usize,
    /// A number, so surely not vacant.
    pub is_number: bool,
}

/// The programs that a program calls, by codes that call too.
pub fn called_programs(program: &Program, settings: &Settings) -> Vec<CalledProgramName> {
    call_sites(program, settings).into_iter().map(|site| site.target).collect()
}

/// Every call of a program.
pub(super) fn call_sites(program: &Program, settings: &Settings) -> Vec<CallSite> {
    let mut found = Vec::new();
    for (block, op) in program.ops().iter().enumerate() {
        if let OpKind::Words(words) = op.kind() {
            found.extend(call_site(block, words, settings));
        }
    }
    found
}

fn call_site(block: OpIndex, words: &Words, settings: &Settings) -> Option<CallSite> {
    let Some(call) = words.call() else { return code_call_site(block, words, settings) };
    let subprogram = matches!(call.kind, CallCode::Subprogram | CallCode::File | CallCode::Local);
    if matches!(call.kind, CallCode::Return | CallCode::Cancel) {
        return None;
    }
    let target = match &call.target {
        CallTarget::None => CalledProgramName::Missing,
        CallTarget::Name(name) => CalledProgramName::Name(name.clone()),
        CallTarget::Number(word) => match literal::word_count(word) {
            // M98 P with more than four digits: repeats in front of a four-digit program number.
            Some(number)
                if call.kind == CallCode::Subprogram
                    && settings.reads_repeats_in_p
                    && call.repeats.is_none()
                    && number > 9999 =>
            {
                CalledProgramName::Number(number % 10_000)
            }
            Some(number) => CalledProgramName::Number(number),
            None => CalledProgramName::Computed,
        },
    };
    Some(CallSite {
        block,
        has_own_locals: !subprogram,
        is_modal: matches!(call.kind, CallCode::AfterMoves | CallCode::EveryBlock),
        target,
        start: call.start.as_ref().and_then(literal::word_count),
        arguments: arguments(&call.arguments, call.kind == CallCode::EveryBlock, settings),
        span: call.span,
    })
}

/// A code that calls by a parameter: a macro's code comes first, and the other words are its arguments; a subprogram's
/// may stand anywhere.
fn code_call_site(block: OpIndex, words: &Words, settings: &Settings) -> Option<CallSite> {
    if settings.code_calls.is_empty() {
        return None;
    }
    let new_site = |word: &LoweredWord, program, own_locals, modal, arguments| CallSite {
        block,
        has_own_locals: own_locals,
        is_modal: modal,
        target: CalledProgramName::Number(program),
        start: None,
        arguments,
        span: word.span,
    };
    words.list.iter().enumerate().find_map(|(place, word)| {
        let called = match (word.letter, word.value) {
            (b'G', WordOperand::G(code, _)) => settings.code_calls.find_call(b'G', code),
            (b'M', _) => settings.code_calls.find_call(b'M', literal::word_count(word)?.checked_mul(10)?),
            (letter, _) => {
                let called = settings.code_calls.address_call(letter)?;
                return Some(new_site(word, called.program, false, false, Vec::new()));
            }
        }?;
        match called.kind {
            CodeCallKind::Subprogram => Some(new_site(word, called.program, false, false, Vec::new())),
            CodeCallKind::Macro | CodeCallKind::Modal if place == 0 => {
                let is_every_block =
                    called.kind == CodeCallKind::Modal && settings.code_calls.modal_is_every_block;
                let arguments = arguments(&words.list[1..], is_every_block, settings);
                Some(new_site(word, called.program, true, called.kind == CodeCallKind::Modal, arguments))
            }
            CodeCallKind::Macro | CodeCallKind::Modal => None,
        }
    })
}

fn arguments(words: &[LoweredWord], is_every_block: bool, settings: &Settings) -> Vec<Argument> {
    let mut letters = ArgumentLocals::new(settings.reads_ijk_plainly, is_every_block);
    let arguments = words.iter().filter_map(|word| {
        let local = letters.next(word.letter).ok().flatten()?;
        Some(Argument { local, is_number: literal::word_number(word).is_some() })
    });
    arguments.collect()
}

impl CalledProgramName {
    /// As a message names it: `O8101`, `<PROBE>`.
    pub fn label(&self) -> String {
        match self {
            Self::Number(number) => format!("O{number:04}"),
            Self::Name(name) => format!("<{name}>"),
            Self::Computed | Self::Missing => "the called program".into(),
        }
    }

    /// The program, where it is in memory.
    pub fn find(&self, memory: &Memory) -> Option<gcode_lang::program::ProgramId> {
        match self {
            Self::Number(number) => memory.find(*number),
            Self::Name(name) => memory.find_name(name),
            Self::Computed | Self::Missing => None,
        }
    }
}
