//! Requests of a program that the machine file cannot meet: axes, tools, a head set by hand.
use super::HoleExtractor;
use crate::findings::{AXIS_CARRIES_NOTHING, HEAD_MESSAGE_UNCLEAR, HEAD_NOT_MANUAL, TOOL_UNKNOWN};
use crate::machine::HeadMessage;
use gcode_lang::diag::Diagnostic;
use gcode_lang::motion::{Event, Position};
use gcode_lang::units::Deg;

impl HoleExtractor<'_> {
    /// Reports axes of the control that move and carry nothing on this machine, each once.
    pub(super) fn check_idle_axes(&mut self, event: &Event<'_>, from: &Position, to: &Position) {
        for (axis, letter) in self.machine.axes.iter() {
            if from[axis] != to[axis] && !self.machine.is_axis_used(axis) {
                self.findings.add_in_program(&AXIS_CARRIES_NOTHING, &event.backtrace(), axis as u32, 1, |kind| {
                    let message =
                        format!("{letter} moves to {}; the machine has nothing on that axis", to[axis]);
                    Diagnostic::new(kind, message).help(format!(
                        "describe in the machine file what {letter} carries, or remove {letter} from the program"
                    ))
                });
            }
        }
    }

    /// Reports a tool that the tool table lacks.
    pub(super) fn check_tool_known(&mut self, event: &Event<'_>, number: u32) {
        let tools = &self.machine.tools;
        if number == 0 || tools.is_empty() || self.machine.find_tool(number).is_some() {
            return;
        }
        self.findings.add(&TOOL_UNKNOWN, &event.backtrace(), number, |kind| {
            let known: Vec<_> = tools.iter().map(|tool| format!("T{}", tool.number)).collect();
            let message = format!(
                "T{number} is not in the machine file (which has {}): the diameter of its holes is \
                 not checked, its length is taken from the length offset",
                known.join(", ")
            );
            Diagnostic::new(kind, message).help(format!(
                "check that it is the right tool; if so, add a [[tool]] with number = {number} and its diameter"
            ))
        });
    }

    /// Returns the head angle that a message such as `#3006=1(SET HEAD TO #140)` requests; `None` if it gives none.
    pub(super) fn operator_head_angle(
        &mut self,
        event: &Event<'_>,
        text: &str,
        variables: &[(u32, f64)],
    ) -> Option<Deg> {
        let message = HeadMessage::parse(text, variables);
        match message {
            HeadMessage::Unrelated => {}
            HeadMessage::Angle(_) | HeadMessage::Unclear if !self.machine.head.is_set_by_hand() => {
                self.findings.add(&HEAD_NOT_MANUAL, &event.backtrace(), 0, |kind| {
                    let message = format!(
                        "the message ({text}) calls for a head set by hand; the machine's head is not"
                    );
                    Diagnostic::new(kind, message).help(
                        "give kind = \"manual\" under [head] in the machine file, or remove the message",
                    )
                });
            }
            HeadMessage::Angle(angle) => return Some(angle),
            HeadMessage::Unclear => {
                self.findings.add(&HEAD_MESSAGE_UNCLEAR, &event.backtrace(), 0, |_| unclear_head(text));
            }
        }
        None
    }
}

/// Returns the finding for a message about the head that gives no angle.
pub(crate) fn unclear_head(text: &str) -> Diagnostic {
    let message = format!(
        "the message ({text}) does not name exactly one variable with a value: the head angle is unchanged"
    );
    Diagnostic::new(&HEAD_MESSAGE_UNCLEAR, message)
        .help("name the variable that holds the angle, as in #3006=1(SET HEAD TO #140)")
}
