//! G70 and G71 of a Haas: the drilling cycle in force, at holes round a centre.
use super::checked::ExecResult;
use super::cycle_expansion::BoltHolePattern;
use super::plan::BlockPlan;
use super::planner::Planner;
use super::words::BlockWords;
use gcode_lang::alarm::Alarm;
use gcode_lang::program::g_codes::HolePattern;
use gcode_lang::program::modes::Plane;
use gcode_lang::source::Span;

impl Planner<'_> {
    /// I is the radius, J the angle of the first hole, L their number, K the angle between holes on an arc. The hole
    /// in the centre is not drilled (Haas Mill Operator's Manual, G70 and G71).
    pub(super) fn plan_bolt_holes(
        &self,
        holes: HolePattern,
        block_words: &BlockWords,
        plan: &mut BlockPlan,
        span: Span,
    ) -> ExecResult<()> {
        let code = match holes {
            HolePattern::Circle => "G70",
            HolePattern::Arc => "G71",
        };
        let Some(cycle) = plan.state.modal.cycle else {
            return Err(Alarm::NoCycle { code }.located_at(span));
        };
        if plan.state.modal.plane != Plane::Xy {
            return Err(Alarm::NotSimulated { what: format!("{code} outside plane G17") }.located_at(span));
        }
        let missing = |letter| Alarm::MissingWord { code, letter }.located_at(span);
        let radius = self.data.dimension(block_words, b'I', &plan.state)?.ok_or_else(|| missing('I'))?;
        let start = self.data.angle(block_words, b'J')?.ok_or_else(|| missing('J'))?;
        let count = block_words.count(b'L')?.filter(|count| *count > 0).ok_or_else(|| missing('L'))?;
        let angle_step = match holes {
            // A negative radius goes round clockwise.
            HolePattern::Circle => (360.0 / f64::from(count)).copysign(radius),
            HolePattern::Arc => self.data.angle(block_words, b'K')?.ok_or_else(|| missing('K'))?,
        };
        if radius == 0.0 || radius < 0.0 && holes == HolePattern::Arc {
            return Err(
                Alarm::OutOfRange { function: format!("I of {code}"), value: radius }.located_at(span)
            );
        }
        let pattern = BoltHolePattern { count, radius: radius.abs(), start, angle_step };
        self.plan_cycle(plan, block_words, cycle, Some(pattern), span)
    }
}
