//! G12 and G13 of a Haas: a circular pocket, milled from its centre.
use super::checked::{ExecResult, locate};
use super::plan::BlockPlan;
use super::planner::Planner;
use super::words::BlockWords;
use gcode_lang::alarm::Alarm;
use gcode_lang::motion::{EventKind, PlanarArc};
use gcode_lang::program::modes::{CutterSide, Motion, Plane};
use gcode_lang::source::Span;
use gcode_lang::units::Deg;

/// More circles than this in one block are a slip.
const MAX_CIRCLES: f64 = 10_000.0;

impl Planner<'_> {
    /// At the centre the tool feeds to Z; then it mills a circle of radius I, and with K and Q wider ones up to K; all
    /// of that L times. The radius of D stays inside. Which circles are milled is in the manual; that the tool goes out
    /// to X+ and back by half circles is a choice of this interpreter.
    pub(super) fn plan_circle_pocket(
        &self,
        motion: Motion,
        block_words: &BlockWords,
        plan: &mut BlockPlan,
        span: Span,
    ) -> ExecResult<()> {
        let clockwise = motion == Motion::Clockwise;
        let code = if clockwise { "G12" } else { "G13" };
        let modal = &plan.state.modal;
        let is_allowed = modal.plane == Plane::Xy
            && modal.cycle.is_none()
            && modal.cutter == CutterSide::Off
            && plan.state.transform.is_none();
        if !is_allowed || block_words.has_any(b"XY") {
            let what = format!("{code} with X, Y, another plane, compensation, rotation or a drilling cycle");
            return Err(Alarm::NotSimulated { what }.located_at(span));
        }
        let radii = self.radii(code, block_words, plan, span)?;
        let passes = block_words.count(b'L')?.unwrap_or(1);
        if f64::from(passes) * radii.len() as f64 > MAX_CIRCLES {
            return Err(
                Alarm::NotSimulated { what: format!("{code} with this number of circles") }.located_at(span)
            );
        }
        for _ in 0..passes {
            let endpoint = self.resolve_endpoint(block_words, &mut plan.state)?;
            locate(self.push_feed(plan, &endpoint.machine, block_words), span)?;
            plan.state.programmed = endpoint.programmed;
            for radius in &radii {
                let sense = if clockwise { -1.0 } else { 1.0 };
                let centre = (plan.state.machine[0], plan.state.machine[1]);
                let half = (centre.0 + radius / 2.0, centre.1);
                let edge = self.data.remove_residue(centre.0 + radius);
                self.push_xy_arc(plan, block_words, edge, half, radius / 2.0, 180.0 * sense, span)?;
                self.push_xy_arc(plan, block_words, edge, centre, *radius, 360.0 * sense, span)?;
                self.push_xy_arc(plan, block_words, centre.0, half, radius / 2.0, 180.0 * sense, span)?;
            }
        }
        plan.commands_axes = true;
        Ok(())
    }

    /// The radii of the tool's centre, from the inside out.
    fn radii(
        &self,
        code: &'static str,
        block_words: &BlockWords,
        plan: &BlockPlan,
        span: Span,
    ) -> ExecResult<Vec<f64>> {
        let missing = |letter| Alarm::MissingWord { code, letter }.located_at(span);
        let state = &plan.state;
        let first = self.data.dimension(block_words, b'I', state)?.ok_or_else(|| missing('I'))?;
        let (last, step) = match (
            self.data.dimension(block_words, b'K', state)?,
            self.data.dimension(block_words, b'Q', state)?,
        ) {
            (None, None) => (first, 0.0),
            (Some(last), Some(step)) => (last, step),
            (Some(_), None) => return Err(missing('Q')),
            (None, Some(_)) => return Err(missing('K')),
        };
        let number = state.codes.d;
        let unknown = || Alarm::OffsetNumber { number: i64::from(number) }.located_at(span);
        let tool = self.data.offset_radius(number).ok_or_else(unknown)?;
        let out_of_range = |letter: char, value| {
            Alarm::OutOfRange { function: format!("{letter} of {code}"), value }.located_at(span)
        };
        if first <= tool {
            return Err(out_of_range('I', first));
        }
        if last < first {
            return Err(out_of_range('K', last));
        }
        if last > first && (step <= 0.0 || (last - first) / step > MAX_CIRCLES) {
            return Err(out_of_range('Q', step));
        }
        let mut radii = Vec::new();
        let mut count = 0.0;
        while first + count * step < last - 1e-9 {
            radii.push(self.data.remove_residue(first + count * step - tool));
            count += 1.0;
        }
        radii.push(self.data.remove_residue(last - tool));
        Ok(radii)
    }

    /// An arc in the plane XY that ends at X `to`, on the height of its start.
    #[expect(clippy::too_many_arguments, reason = "an arc is all of this")]
    fn push_xy_arc(
        &self,
        plan: &mut BlockPlan,
        block_words: &BlockWords,
        to: f64,
        centre: (f64, f64),
        radius: f64,
        sweep: f64,
        span: Span,
    ) -> ExecResult<()> {
        let length = radius * sweep.abs().to_radians();
        let timed = self.data.path_time(&plan.state, length, block_words.has(b'F'));
        let (rate, seconds) = timed.map_err(|_| Alarm::ArcFeedZero.located_at(span))?;
        let mut end = plan.state.machine;
        end[0] = to;
        let arc = PlanarArc { plane: (0, 1), centre, sweep: Deg(sweep) };
        plan.events.push((EventKind::Arc { to: end, arc, rate }, seconds));
        plan.state.machine = end;
        Ok(())
    }
}
