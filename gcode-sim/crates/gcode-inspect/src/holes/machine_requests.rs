//! What a program asks of the machine that the machine file doesn't have: axes, tools, a head set by hand.
use super::HoleExtractor;
use crate::findings::{AXIS_CARRIES_NOTHING, HEAD_MESSAGE_UNCLEAR, HEAD_NOT_MANUAL, TOOL_UNKNOWN};
use crate::machine::HeadMessage;
use gcode_lang::diag::Diagnostic;
use gcode_lang::motion::{Event, Position};
use gcode_lang::units::Deg;

impl HoleExtractor<'_> {
    /// An axis that the control has and the machine doesn't use was told to move.
    pub(super) fn check_idle_axes(&mut self, event: &Event<'_>, from: &Position, to: &Position) {
        for (axis, letter) in self.machine.axes.iter() {
            if from[axis] != to[axis] && !self.machine.is_axis_used(axis) {
                self.findings.add(&AXIS_CARRIES_NOTHING, &event.backtrace(), axis as u32, |kind| {
                    Diagnostic::new(kind, format!("{letter} moves to {}; the machine has nothing on that axis", to[axis]))
                    .help(format!(
                        "describe in the machine file what {letter} carries, or remove {letter} from the program"
                    ))
                });
            }
        }
    }

    /// A tool that the machine file has no row for.
    pub(super) fn check_tool_known(&mut self, event: &Event<'_>, number: u32) {
        if number != 0 && !self.machine.tools.is_empty() && self.machine.find_tool(number).is_none() {
            self.findings.add(&TOOL_UNKNOWN, &event.backtrace(), number, |kind| {
                let known: Vec<_> =
                    self.machine.tools.iter().map(|tool| format!("T{}", tool.number)).collect();
                Diagnostic::new(kind, format!(
                        "T{number} is not in the machine file (which has {}): the diameter of its holes is \
                         not checked, its length is taken from the length offset",
                        known.join(", ")
                    ))
                .help(format!(
                    "check that it is the right tool; if so, add a [[tool]] with number = {number} and its diameter"
                ))
            });
        }
    }

    /// The operator does what `#3006=1(SET HEAD TO #140)` says: the angle, where the message gives one.
    pub(super) fn operator_head_angle(
        &mut self,
        event: &Event<'_>,
        text: &str,
        named: &[(u32, f64)],
    ) -> Option<Deg> {
        let message = HeadMessage::parse(text, named);
        if message == HeadMessage::Unrelated {
            return None;
        }
        if !self.machine.head.is_set_by_hand() {
            self.findings.add(&HEAD_NOT_MANUAL, &event.backtrace(), 0, |kind| {
                Diagnostic::new(
                    kind,
                    format!("the message ({text}) calls for a head set by hand; the machine's head is not"),
                )
                .help("give kind = \"manual\" under [head] in the machine file, or remove the message")
            });
            return None;
        }
        match message {
            HeadMessage::Angle(angle) => Some(angle),
            HeadMessage::Unrelated | HeadMessage::Unclear => {
                self.findings.add(&HEAD_MESSAGE_UNCLEAR, &event.backtrace(), 0, |_| unclear_head(text));
                None
            }
        }
    }
}

/// A message about the head from which no angle can be read.
pub fn unclear_head(text: &str) -> Diagnostic {
    let message = format!(
        "the message ({text}) does not name exactly one variable with a value: the head angle is unchanged"
    );
    Diagnostic::new(&HEAD_MESSAGE_UNCLEAR, message)
        .help("name the variable that holds the angle, as in #3006=1(SET HEAD TO #140)")
}
