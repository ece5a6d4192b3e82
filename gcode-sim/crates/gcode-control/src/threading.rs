//! G33: a straight cut that keeps step with the spindle.
use super::checked::ExecResult;
use super::plan::BlockPlan;
use super::planner::Planner;
use super::words::{BlockWords, WordNumber};
use gcode_lang::alarm::Alarm;
use gcode_lang::motion::{EventKind, MAX_AXES, Position, SpindleDirection};
use gcode_lang::program::modes::Unit;
use gcode_lang::source::Span;
use gcode_lang::units::MmPerMin;

impl Planner<'_> {
    /// F is the lead along the axis with the longest way, in every feed mode; Q, the angle it starts at, moves nothing.
    pub(super) fn plan_thread(
        &self,
        plan: &mut BlockPlan,
        to: Position,
        block_words: &BlockWords,
        span: Span,
    ) -> ExecResult<()> {
        block_words.mark_read(b"Q");
        let refused = |what: &str, span| Err(Alarm::NotSimulated { what: what.into() }.located_at(span));
        if let Some((WordNumber::Literal(lead), _)) = block_words.get(b'F')
            && lead.places.is_none()
        {
            return refused(
                "F without a decimal point (its unit differs between controls) in G33",
                block_words.span(b'F'),
            );
        }
        let turning = plan.state.spindle != SpindleDirection::Off && plan.state.codes.s > 0.0;
        if !turning {
            return refused("G33 with the spindle stopped (a control waits for it)", span);
        }
        let inch = plan.state.modal.unit == Unit::Inch;
        let lead = plan.state.codes.f * if inch { 25.4 } else { 1.0 };
        if lead <= 0.0 {
            return Err(Alarm::FeedZero.located_at(span));
        }
        let from = plan.state.machine;
        if to == from {
            return Ok(());
        }
        let way = |axis: usize| (to[axis] - from[axis]).abs();
        let longest = (0..MAX_AXES).map(way).fold(0.0, f64::max);
        let length = (0..MAX_AXES).map(|axis| way(axis) * way(axis)).sum::<f64>().sqrt();
        let minutes = longest / (lead * plan.state.codes.s);
        let rate = MmPerMin(length / minutes);
        plan.events.push((EventKind::Feed { to, rate }, minutes * 60.0));
        plan.state.machine = to;
        Ok(())
    }
}
