//! G47 of a Haas: engraved text, whose strokes the manual does not give.
use super::functions::{ExecResult, locate};
use super::kinematics::sine_cosine;
use super::notes::Note;
use super::plan::BlockPlan;
use super::planner::Planner;
use gcode_lang::motion::UnknownAxes;

/// Most characters of a text.
const MAX_TEXT: u32 = 500;

impl Planner<'_> {
    /// G47: one cut along the base of the text instead of its strokes. P0 engraves the comment of the block, P1 a serial number,
    /// P32 to P126 one character. I is the angle, J the height; each character counts as wide as it is high. The tool goes by
    /// rapid to X Y and to R, feeds with E to Z, cuts along the base, and goes back to R; X and Y are unknown then.
    pub(super) fn plan_engraving(&self, plan: &mut BlockPlan) -> ExecResult<()> {
        let state = &plan.state;
        self.check_outside_cycle_and_offset("47", &state.modal)?;
        let [x, y, z] = self.locate(self.slides())?;
        let kind = self.words.count(b'P')?.unwrap_or(0);
        let characters = match kind {
            0 | 1 => self.words.comment_length.unwrap_or(1).min(MAX_TEXT),
            32..=126 => 1,
            _ => return Err(self.not_simulated("G47 with a P other than 0, 1 and 32 to 126")),
        };
        let height = match self.dimension(b'J', state)? {
            Some(height) => height.abs(),
            // 1 in the unit of the program.
            None => 1.0 / self.data.to_program_unit(state, None, 1.0),
        };
        let (sine, cosine) = sine_cosine(self.angle(b'I')?.unwrap_or(0.0));
        let top = self.dimension(b'R', state)?;
        let plunge = match self.words.get(b'E') {
            Some((raw, span)) => locate(self.data.feed_of(&raw, state), span)?,
            None => state.modal_words.f,
        };
        let start = state.programmed_position;
        let bottom = self.resolve_endpoint(plan)?.programmed;
        let (mut above, mut retracted, mut end) = (bottom, bottom, bottom);
        above[z] = start[z];
        retracted[z] = top.unwrap_or(start[z]);
        let width = f64::from(characters) * height;
        (end[x], end[y]) = (bottom[x] + width * cosine, bottom[y] + width * sine);
        for point in [above, retracted] {
            let to = self.data.to_machine(&plan.state, &point);
            self.push_rapid(plan, &to);
        }
        let feed = std::mem::replace(&mut plan.state.modal_words.f, plunge);
        let to = self.data.to_machine(&plan.state, &bottom);
        self.locate(self.push_feed(plan, &to))?;
        plan.state.modal_words.f = feed;
        let to = self.data.to_machine(&plan.state, &end);
        self.locate(self.push_feed(plan, &to))?;
        end[z] = retracted[z];
        let to = self.data.to_machine(&plan.state, &end);
        self.push_rapid(plan, &to);
        plan.state.programmed_position = end;
        let across = 1 << x | 1 << y;
        let lost = UnknownAxes { shifted: across, ..UnknownAxes::default() };
        plan.state.unknown = plan.state.unknown.with_axes_of(across, lost);
        self.push_unknown_axes(plan);
        plan.notes.push(Note::Engraving { characters, height: (height * 1000.0).round() as u32 });
        plan.commands_axes = true;
        Ok(())
    }
}
