//! G150 of a Haas: a pocket whose outline is a program, of which only the finishing cut is known.
use super::flow::CallOrigins;
use super::functions::ExecResult;
use super::linear_motion::Endpoint;
use super::notes::Note;
use super::plan::{BlockFlow, BlockPlan, CallKind, CallPlan, ProgramRef};
use super::planner::Planner;
use super::variables::VACANT;
use gcode_lang::alarm::Alarm;
use gcode_lang::program::code_facts::Letters;
use gcode_lang::program::modes::{Distance, Plane};

impl Planner<'_> {
    /// G150: by rapid to X Y and to R, feeds to Z, and calls the outline P once, in the compensation of G41 or G42 if the block
    /// has it. The passes that clear the pocket, by I or J, Q and K, are not those of the manual's figures and are left out.
    pub(super) fn plan_pocket(&self, plan: &mut BlockPlan) -> ExecResult<()> {
        let state = &plan.state;
        self.check_outside_cycle("150", &state.modal)?;
        let is_allowed = state.modal.plane == Plane::Xy
            && state.modal.distance == Distance::Absolute
            && !self.registers.lookahead.is_offset();
        if !is_allowed {
            return Err(self.not_simulated("G150 in G91, in another plane or in cutter compensation"));
        }
        let missing = |letter| Alarm::MissingWord { code: "G150", letter }.located_at(self.block);
        let program = self.words.count(b'P')?.ok_or_else(|| missing('P'))?;
        let r_level = self.dimension(b'R', state)?.ok_or_else(|| missing('R'))?;
        if !self.words.has(b'Z') {
            return Err(missing('Z'));
        }
        let z = self.locate(self.data.axis_with_letter(b'Z'))?;
        self.words.mark_read(Letters::of(b"IJKQ"));
        let start = state.programmed_position[z];
        let bottom: Endpoint = self.resolve_endpoint(plan)?;
        for level in [start, r_level] {
            let mut point = bottom.programmed;
            point[z] = level;
            let to = self.data.to_machine(&plan.state, &point);
            self.push_rapid(plan, &to);
        }
        self.locate(self.push_feed(plan, &bottom.machine))?;
        plan.state.programmed_position = bottom.programmed;
        plan.notes.push(Note::PocketClearing);
        plan.commands_axes = true;
        plan.flow = BlockFlow::Call(Box::new(CallPlan {
            kind: CallKind::Subprogram,
            target: ProgramRef::Number(program),
            repeats: 1,
            digits_of_p: None,
            start: None,
            locals: VACANT,
            is_immediate: true,
            origins: CallOrigins::default(),
            is_external: false,
            span: self.words.span(b'P'),
        }));
        Ok(())
    }
}
