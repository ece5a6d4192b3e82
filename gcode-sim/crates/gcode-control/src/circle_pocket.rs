//! G12 and G13 of a Haas: circular pockets.
use super::functions::ExecResult;
use super::linear_motion::Endpoint;
use super::plan::BlockPlan;
use super::planner::Planner;
use gcode_lang::alarm::Alarm;
use gcode_lang::motion::PlanarArc;
use gcode_lang::program::modes::{Motion, Plane};
use gcode_lang::units::Deg;

/// Largest number of circles in one block; more are a typing error.
const MAX_CIRCLES: f64 = 10_000.0;

impl Planner<'_> {
    /// G12 and G13: at the centre the tool feeds to Z, then mills a circle of radius I, and with K and Q larger ones up to
    /// K; all of it L times, inside by the radius of D. The circles are those of the manual; the half circles out to X+ and
    /// back are a choice of this simulator.
    pub(super) fn plan_circle_pocket(&self, motion: Motion, plan: &mut BlockPlan) -> ExecResult<()> {
        let clockwise = motion == Motion::Clockwise;
        let code = if clockwise { "G12" } else { "G13" };
        let modal = &plan.state.modal;
        self.check_outside_cycle_and_offset(&code[1..], modal)?;
        if modal.plane != Plane::Xy || self.words.has_any(b"XY") {
            return Err(self.not_simulated(format!("{code} with X, Y or another plane")));
        }
        let radii = self.radii(code, plan)?;
        let plane = self.locate(self.data.plane_axes(Plane::Xy))?;
        let passes = self.words.count(b'L')?.unwrap_or(1);
        if f64::from(passes) * radii.len() as f64 > MAX_CIRCLES {
            return Err(self.not_simulated(format!("{code} with this number of circles")));
        }
        for _ in 0..passes {
            let endpoint = self.resolve_endpoint(plan)?;
            self.locate(self.push_feed(plan, &endpoint.machine))?;
            plan.state.programmed_position = endpoint.programmed;
            for radius in &radii {
                let start = plan.state.programmed_position;
                let centre = (start[plane.0], start[plane.1]);
                let half_circle_centre = (centre.0 + radius / 2.0, centre.1);
                let mut edge = start;
                edge[plane.0] = self.data.remove_residue(centre.0 + radius);
                let arcs = [
                    (edge, half_circle_centre, radius / 2.0, 180.0),
                    (edge, centre, *radius, 360.0),
                    (start, half_circle_centre, radius / 2.0, 180.0),
                ];
                for (programmed, centre, radius, degrees) in arcs {
                    let sweep = Deg(if clockwise { -degrees } else { degrees });
                    let machine = self.data.to_machine(&plan.state, &programmed);
                    let end = Endpoint { programmed, machine, ..endpoint };
                    self.push_programmed_arc(plan, &end, PlanarArc { plane, centre, sweep }, radius)?;
                    plan.state.programmed_position = programmed;
                }
            }
        }
        plan.commands_axes = true;
        Ok(())
    }

    /// Returns the radii of the tool centre's circles, from the inside out.
    fn radii(&self, code: &'static str, plan: &BlockPlan) -> ExecResult<Vec<f64>> {
        let missing = |letter| Alarm::MissingWord { code, letter }.located_at(self.block);
        let state = &plan.state;
        let first = self.dimension(b'I', state)?.ok_or_else(|| missing('I'))?;
        let (last, step) = match (self.dimension(b'K', state)?, self.dimension(b'Q', state)?) {
            (None, None) => (first, 0.0),
            (Some(last), Some(step)) => (last, step),
            (Some(_), None) => return Err(missing('Q')),
            (None, Some(_)) => return Err(missing('K')),
        };
        let number = state.modal_words.d;
        let unknown = || Alarm::OffsetNumber { number: i64::from(number) }.located_at(self.block);
        let tool = self.data.offset_radius(number).ok_or_else(unknown)?;
        let out_of_range = |letter: char, value| {
            Alarm::OutOfRange { function: format!("{letter} of {code}"), value }.located_at(self.block)
        };
        if first <= tool {
            return Err(Alarm::PocketTooSmall { code, radius: first, tool }.located_at(self.block));
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
}
