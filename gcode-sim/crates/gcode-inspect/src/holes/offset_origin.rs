//! The block that puts the length offset of a cut in force: a wrong H stands there, not at the cut.
use gcode_lang::diag::Diagnostic;
use gcode_lang::motion::{Backtrace, LengthCompensation};

/// Block that puts a length offset in force.
#[derive(Clone, Debug)]
pub(crate) struct OffsetOrigin {
    pub backtrace: Backtrace,
    /// Code and number of the offset.
    pub compensation: LengthCompensation,
    /// False if a tool change follows: the offset is left from the tool before.
    pub is_own: bool,
}

impl OffsetOrigin {
    /// Returns true if the block has this code and number.
    pub(super) fn is_of(&self, compensation: LengthCompensation) -> bool {
        self.compensation == compensation
    }

    /// Locates a finding on the offset of a cut at the block that puts it in force, if no tool change follows; the other block is
    /// a secondary location.
    pub(crate) fn locate(origin: Option<&Self>, finding: Diagnostic, cut: &Backtrace) -> Diagnostic {
        match origin {
            Some(own) if own.is_own && own.backtrace.block != cut.block => {
                finding.label(cut.block, "the first cut with it").with_backtrace(own.backtrace.clone())
            }
            Some(left) if !left.is_own => {
                let caption = "in force from here, before the tool change";
                finding.label(left.backtrace.block, caption).with_backtrace(cut.clone())
            }
            _ => finding.with_backtrace(cut.clone()),
        }
    }
}
