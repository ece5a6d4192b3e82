//! Calls by codes: G and M codes that parameters make calls of.
use super::Core;
use super::eval::{Checked, at};
use super::plan::{CallKind, CallPlan, Flow, Plan, Target};
use super::words::{Raw, count};
use crate::program::{Program, Words};

impl Core {
    /// A parameter-defined G or M code that calls a macro: the block's words are its arguments.
    pub(super) fn call_by_code(&self, program: &Program, words: &Words, plan: &mut Plan) -> Checked<bool> {
        let settings = &self.settings;
        if (settings.g_calls.is_empty() && settings.m_calls.is_empty()) || self.frame().by_code {
            return Ok(false);
        }
        let Some(first) = words.list.first() else { return Ok(false) };
        let Some(raw) = self.raw(program, first)? else { return Ok(false) };
        let number = match first.letter {
            b'M' => {
                let code = at(count(raw, b'M'), first.span)?;
                settings.m_calls.iter().find(|(m, _)| *m == code).map(|(_, program)| *program)
            }
            b'G' => {
                let code = match raw {
                    Raw::Computed(value) => (value * 10.0).round() as u16,
                    Raw::Literal(_) => return Ok(false),
                };
                settings.g_calls.iter().find(|(g, _)| *g == code).map(|(_, program)| *program)
            }
            _ => None,
        };
        let Some(number) = number else { return Ok(false) };
        let locals = self.arguments(program, &words.list[1..], false)?;
        let repeats = match words.list[1..].iter().find(|w| w.letter == b'L') {
            Some(word) => self.coded_count(program, word)?.unwrap_or(1),
            None => 1,
        };
        plan.flow = Flow::Call(Box::new(CallPlan {
            kind: CallKind::Code,
            target: Target::Number(number),
            repeats,
            start: None,
            locals,
            calls_now: true,
            span: first.span,
        }));
        Ok(true)
    }
}
