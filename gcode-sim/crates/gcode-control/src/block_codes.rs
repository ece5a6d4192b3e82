//! Codes of a block: modal G codes, F S T D H, M codes, and the letters that need a code.
use super::axis_word_use::{AxisWordUse, AxisWordUses};
use super::functions::{ExecResult, locate};
use super::haas_outputs::LAST_OUTPUT;
use super::notes::Note;
use super::plan::{BlockFlow, BlockPlan, TableWrite};
use super::planner::Planner;
use super::state::{CycleState, Modal, PolarPoint, RigidTapping, State};
use super::variables::Value;
use super::words::{WordNumber, count};
use gcode_lang::alarm::{Alarm, LocatedAlarm};
use gcode_lang::control::Dialect;
use gcode_lang::motion::{EventKind, SpindleDirection, StopKind};
use gcode_lang::program::code_facts::{CoordinateUse, Letters, LookaheadUse};
use gcode_lang::program::cycles::Cycle;
use gcode_lang::program::g_codes::{Effect, GCodeRow, OneShot, spelled};
use gcode_lang::program::m_codes;
use gcode_lang::program::m_codes::MCodeEffect;
use gcode_lang::program::modes::{CutterSide, Distance, DynamicOffset, Motion, Polar, Rotation, Scaling};
use gcode_lang::units::Rpm;

/// M99, the end of a subprogram or macro.
const RETURN: u32 = 99;

/// G10 L23: the setting error of a part.
const SETTING_ERROR_INPUT: u32 = 23;

/// Variable of input 0 of a Haas.
const FIRST_INPUT: u32 = 11_000;

fn is_skip(effect: Effect) -> bool {
    matches!(effect, Effect::OneShot(one) if one.is_skip())
}

impl Planner<'_> {
    /// 1. Applies the modal G codes in their order; returns the use of the axis words instead of a move.
    #[inline]
    pub(super) fn apply_modal_codes(&self, plan: &mut BlockPlan) -> ExecResult<Option<AxisWordUse>> {
        if self.words.has_other_g_codes {
            return self.apply_all_codes(plan);
        }
        if let Some(motion) = self.words.motion {
            plan.state.set_motion_mode(motion);
        }
        Ok(None)
    }

    /// Applies the G codes of a block that has codes outside group 01.
    #[inline(never)]
    fn apply_all_codes(&self, plan: &mut BlockPlan) -> ExecResult<Option<AxisWordUse>> {
        let state = &mut plan.state;
        let before = state.modal;
        let (axis_use, is_cycle_active) = self.apply_each_code(state)?;
        let of_builder = self.words.g_codes().filter(|row| row.facts.is_of_builder);
        plan.notes.extend(of_builder.map(|row| Note::BuilderCode(row.code)));
        for group in self.words.g_codes().filter_map(|row| row.effect.group()) {
            plan.commanded_groups.insert(group);
        }
        self.check_modes(&before, state)?;
        let length_before = state.length_offset;
        self.update_coordinates(&before, state);
        let is_selected =
            || self.words.has_non_motion_code(|effect| matches!(effect, Effect::UnstatedOffset(_)));
        let starts_dynamic = (state.modal.dynamic != before.dynamic || is_selected())
            && match state.modal.dynamic {
                DynamicOffset::Off => false,
                DynamicOffset::On => self.data.settings.kinematics.is_none(),
                DynamicOffset::Fixture | DynamicOffset::SettingError => state.part_error.is_none(),
            };
        if state.modal.cycle.is_some() && !is_cycle_active {
            self.begin_cycle(state)?;
        }
        // G54 P is G54.1 P; in a block that drills P is that of the cycle.
        let drills = || self.words.has(b'R') || self.names_axis();
        let selects_additional_work = self.words.has(b'P')
            && axis_use.is_none()
            && (state.modal.cycle.is_none() || !drills())
            && self.words.has_non_motion_code(|effect| effect == Effect::Work(1));
        self.push_turned_length(plan, length_before);
        if starts_dynamic {
            self.lose_position(plan, plan.state.modal.dynamic.code(), false);
        }
        Ok(if selects_additional_work { Some(AxisWordUse::AdditionalWork) } else { axis_use })
    }

    /// Applies the G codes in their order; returns the use of the axis words, and true if a cycle stays active that was
    /// active before.
    fn apply_each_code(&self, state: &mut State) -> ExecResult<(Option<AxisWordUse>, bool)> {
        let mut uses = AxisWordUses::default();
        let mut is_cycle_active = state.modal.cycle.is_some();
        for row in self.words.g_codes() {
            self.check_code_in_virtual_plane(row)?;
            if let Effect::Motion(motion) = row.effect {
                state.set_motion_mode(motion);
                is_cycle_active = false;
                continue;
            }
            if row.facts.lookahead == LookaheadUse::Alarms && state.modal.cutter != CutterSide::Off {
                return Err(Alarm::ToolOffsetInCompensation.located_at(self.block));
            }
            if row.effect == Effect::Declared && self.names_axis() {
                return Err(self.not_simulated("an axis in a block with a declared code"));
            }
            self.words.mark_read(row.facts.words.without_effect);
            if matches!(row.effect, Effect::NotSimulated | Effect::Call) {
                return Err(self.not_simulated(format!("G{} ({})", spelled(row.code), row.description)));
            }
            uses.add(state.modal.apply(row.effect));
            if let Effect::UnstatedOffset(offset) = row.effect {
                self.select_part_error(offset, state)?;
            }
            if row.effect == Effect::Cycle(None) {
                state.cycle = CycleState::default();
                state.rigid_tapping = RigidTapping::Off;
                is_cycle_active = false;
            }
        }
        Ok((self.single_use(&uses, state)?, is_cycle_active))
    }

    /// Returns the one use that the codes of a block make of its axis words.
    fn single_use(&self, uses: &AxisWordUses, state: &mut State) -> ExecResult<Option<AxisWordUse>> {
        use AxisWordUse::{AdditionalWork, OneShot as Single};
        let (skip, machine) = (Single(OneShot::Skip), Single(OneShot::MachineCoordinateSystem));
        match (uses.first, uses.second) {
            (first, None) => Ok(first),
            _ if uses.has_third => self.several_uses(),
            // G53 is ignored in G91, or its increment is that of the skip move: where no axis is turned, scaled or mirrored.
            (Some(first), Some(second))
                if first.is_pair_with(second, [skip, machine])
                    && state.modal.distance == Distance::Incremental
                    && (!self.data.settings.undocumented.g53_moves_in_g91
                        || state.transform.is_identity()) =>
            {
                Ok(Some(skip))
            }
            // P is that of the work coordinate system.
            (Some(AdditionalWork), Some(other)) | (Some(other), Some(AdditionalWork)) if other.leaves_p() => {
                self.select_additional_work(state)?;
                Ok(Some(other))
            }
            (Some(first), Some(second)) if first.is_plane_and_tool_axis(second) => {
                let what = "G53.1, G53.6 or G253 in the block of the tilted plane";
                Err(Alarm::ToolAxisCode(what).located_at(self.block))
            }
            _ => self.several_uses(),
        }
    }

    fn several_uses<T>(&self) -> ExecResult<T> {
        Err(self.not_simulated("several G codes of group 00 (or G51, G51.1, G54.1, G68, G68.2) in one block"))
    }

    /// Raises the alarm of modes that exclude one another or the codes of the block.
    fn check_modes(&self, before: &Modal, state: &State) -> ExecResult<()> {
        let modal = &state.modal;
        if modal.plane != before.plane && self.registers.lookahead.is_offset() {
            return Err(Alarm::PlaneInCompensation.located_at(self.block));
        }
        if modal.plane != before.plane && self.checks_rigid_tapping(state) {
            return Err(Alarm::PlaneInRigidTapping.located_at(self.block));
        }
        if modal.plane != before.plane && state.transform.rotation.is_some() {
            return Err(Alarm::PlaneInRotation.located_at(self.block));
        }
        if before.scaling == Scaling::On
            && modal.scaling == Scaling::On
            && let Some(row) = self.words.g_codes().find(|row| row.facts.coordinates != CoordinateUse::Free)
        {
            return Err(Alarm::CodeInScaling(spelled(row.code)).located_at(self.block));
        }
        self.check_transform_order(before, state)
    }

    /// Returns true in rigid tapping on a Fanuc, which checks it: PS0200, PS0204 and PS0206. M29 without S counts from its
    /// tapping cycle on.
    pub(super) fn checks_rigid_tapping(&self, state: &State) -> bool {
        let is_rigid = match state.rigid_tapping {
            RigidTapping::Off => false,
            RigidTapping::Possible { .. } => state.modal.cycle.is_some_and(Cycle::taps),
            RigidTapping::Certain => true,
        };
        is_rigid && Dialect::FANUC.contains(&self.data.settings.codes)
    }

    /// Ends transforms whose modes are off, and recomputes the position if the coordinates have changed.
    fn update_coordinates(&self, before: &Modal, state: &mut State) {
        let modal = state.modal;
        if modal.scaling == Scaling::Off {
            state.transform.scaling = None;
        }
        if modal.rotation == Rotation::Off {
            state.transform.rotation = None;
            state.end_alignment();
            (state.transform.tilt, state.transform.plane_entry) = (None, None);
        }
        let is_centred = state.transform.scaling.is_some() || state.transform.rotation.is_some();
        if !is_centred && !state.is_turned() && modal.dynamic == DynamicOffset::Off {
            state.transform.unknown_centre = 0;
        }
        if modal.polar == Polar::On && before.polar == Polar::Off {
            state.polar = PolarPoint::default();
        }
        let error_before = self.registers.state.part_error;
        if modal.work != before.work || modal.dynamic != before.dynamic || state.part_error != error_before {
            state.end_before_transform = None;
            self.realign(state);
            self.data.recompute_position(state);
        } else if state.transform != self.registers.state.transform {
            self.data.apply_transform_change(state);
        }
    }

    /// Stores the drilling axis and the initial level of a cycle that the block begins.
    fn begin_cycle(&self, state: &mut State) -> ExecResult<()> {
        let axis = self.locate(self.drilling_axis(state))?;
        state.cycle.axis = Some(axis);
        state.cycle.initial = state.programmed_position[axis];
        state.cycle.initial_unknown = state.unknown;
        Ok(())
    }

    /// 1. Applies F S T D H, and the radius of D.
    pub(super) fn plan_modal_words(&self, plan: &mut BlockPlan) -> ExecResult<()> {
        if let Some(f) = self.feed_word(&plan.state)? {
            (plan.state.modal_words.f, plan.state.modal_words.mode_of_f) = (f, plan.state.modal.feed_mode);
        }
        if let Some(s) = self.speed_word()? {
            plan.state.modal_words.s = f64::from(s);
        }
        if let Some(t) = self.words.count(b'T')? {
            plan.state.modal_words.t = t;
            plan.push_event(EventKind::ToolSelected { number: t });
        }
        let codes = &mut plan.state.modal_words;
        for (letter, code) in [(b'D', &mut codes.d), (b'H', &mut codes.h)] {
            let Some(number) = self.words.count(letter)? else { continue };
            if number as usize > self.data.settings.tool_offsets {
                let alarm = Alarm::OffsetNumber { number: i64::from(number) };
                return Err(alarm.located_at(self.words.span(letter)));
            }
            *code = number;
        }
        self.check_misplaced_words(plan)?;
        let starts_compensation =
            |row: &&GCodeRow| matches!(row.effect, Effect::Cutter(CutterSide::Left | CutterSide::Right));
        if plan.state.modal_words.d == 0
            && let Some(row) = self.words.g_codes().find(starts_compensation)
        {
            plan.notes.push(Note::CutterRadiusZero(row.code));
        }
        let is_compensating = plan.state.modal.cutter != CutterSide::Off;
        let selects_side = || self.words.has_non_motion_code(|effect| matches!(effect, Effect::Cutter(_)));
        if self.words.has(b'D')
            || is_compensating && (self.data.settings.applies_radius_at_once || selects_side())
        {
            plan.state.cutter_radius = self.data.offset_radius(plan.state.modal_words.d).unwrap_or(0.0);
        }
        Ok(())
    }

    /// Returns S, which a Haas takes with a point.
    fn speed_word(&self) -> ExecResult<Option<u32>> {
        match self.words.get(b'S') {
            Some((WordNumber::Literal(number), span)) if self.data.settings.speed_takes_point => {
                locate(count(WordNumber::Computed(number.value()), b'S'), span).map(Some)
            }
            _ => self.words.count(b'S'),
        }
    }

    /// Raises the alarm of a word that needs a code which the block lacks, or excludes one that it has.
    fn check_misplaced_words(&self, plan: &BlockPlan) -> ExecResult<()> {
        let mut owned = self.words.letters_of_codes();
        // E of a Haas: a percentage of the rapid rate, or the speed that throws off chips after a hole.
        let axis_letters = self.data.settings.axes.letter_bits();
        if self.data.settings.codes == Dialect::HaasNgc
            && axis_letters & Letters::of(b"E").bits() == 0
            && (plan.state.modal.cycle.is_some() || plan.state.modal.motion == Motion::Rapid)
        {
            self.words.mark_read(Letters::of(b"E"));
            owned |= Letters::of(b"E").bits();
        }
        if self.words.has_non_motion_code(|effect| effect == Effect::OneShot(OneShot::DataInput))
            && self.words.count(b'L')? == Some(SETTING_ERROR_INPUT)
        {
            // Angles about X, Y and Z, whatever axes the machine has.
            owned |= Letters::of(b"ABC").bits();
        }
        if let Some(letter) = self.words.first_present(Letters::of(b"ENO").bits() & !owned & !axis_letters) {
            return Err(self.improper_address(letter));
        }
        if self.words.has_non_motion_code(|effect| effect == Effect::LookAhead)
            && self.words.count(b'P')?.is_none_or(|p| p > 1)
        {
            return Err(Alarm::LookAheadFormat.located_at(self.block));
        }
        if self.words.has(b'T') && self.words.g_codes().any(|row| row.facts.words.refuses_tool) {
            return Err(Alarm::TNotAllowed.located_at(self.words.span(b'T')));
        }
        let repeats_cycle =
            self.data.settings.cycle_repeat_letter == b'L' && plan.state.modal.cycle.is_some();
        let repeats_move = self.data.settings.repeats_moves && self.repeats_move(&plan.state);
        if self.words.has_letters(Letters::of(b"L").bits() & !owned) && !repeats_cycle && !repeats_move {
            return Err(self.improper_address(b'L'));
        }
        let axes = Letters::of(b"ABCUVWXYZ").bits() & !owned;
        if let Some(letter) = self.words.first_present(axes & !axis_letters) {
            return Err(self.improper_address(letter));
        }
        Ok(())
    }

    fn improper_address(&self, letter: u8) -> LocatedAlarm {
        Alarm::ImproperAddress { letter: char::from(letter) }.located_at(self.words.span(letter))
    }

    /// 2., 5. and 6. Plans what M codes do, each at its time.
    pub(super) fn plan_m_codes(&self, plan: &mut BlockPlan) -> ExecResult<()> {
        plan.notes.extend(self.words.replaced_m_codes.iter().map(|code| Note::MCodeLost(*code)));
        for (code, span) in self.words.m_codes.iter().copied() {
            plan.state.modal_words.m = code;
            let speed = Rpm(plan.state.modal_words.s);
            if matches!(code, 3..=6) {
                plan.state.rigid_tapping.end_if_possible();
            }
            let is_declared = || self.data.settings.declared_codes.find(b'M', 10 * code).is_some();
            let Some(effect) = m_codes::find(code, self.data.settings.codes) else {
                if is_declared() {
                    self.words.mark_read(Letters::of(b"EIJKPQR"));
                    continue;
                }
                plan.builder_m_codes.push(code);
                plan.push_event(EventKind::Auxiliary { code });
                if code > 9999 {
                    plan.notes.push(Note::LongMCode(code));
                }
                continue;
            };
            match effect {
                MCodeEffect::Stop => self.plan_stop(plan, StopKind::M00, speed),
                MCodeEffect::OptionalStop if self.data.settings.stops_at_m01 => {
                    self.plan_stop(plan, StopKind::M01, speed);
                }
                MCodeEffect::OptionalStop | MCodeEffect::NoEffect => {}
                MCodeEffect::End => {
                    plan.notes.extend(compensation_left(plan).map(Note::CompensationAtEnd));
                    plan.flow = BlockFlow::End;
                }
                MCodeEffect::SpindleForward => self.set_spindle(plan, SpindleDirection::Clockwise, speed),
                MCodeEffect::SpindleReverse => {
                    self.set_spindle(plan, SpindleDirection::Counterclockwise, speed)
                }
                MCodeEffect::SpindleStop | MCodeEffect::Orient => {
                    let is_oriented = effect == MCodeEffect::Orient;
                    if is_oriented {
                        self.words.mark_read(Letters::of(b"PR"));
                    }
                    plan.state.spindle = SpindleDirection::Off;
                    let direction = SpindleDirection::Off;
                    let stop = EventKind::Spindle { direction, speed, is_rigid: false, is_oriented };
                    plan.events_after_motion.push((stop, 0.0));
                }
                MCodeEffect::ToolChange => {
                    plan.notes.extend(compensation_left(plan).map(Note::CompensationAtToolChange));
                    if self.data.settings.undocumented.tool_change_homes_z {
                        self.plan_z_home(plan);
                    }
                    let stops_spindle = self.data.settings.undocumented.tool_change_stops_spindle;
                    if stops_spindle && plan.state.spindle != SpindleDirection::Off {
                        self.set_spindle(plan, SpindleDirection::Off, speed);
                    }
                    plan.state.tool = plan.state.modal_words.t;
                    plan.push_event(EventKind::ToolChange { number: plan.state.modal_words.t });
                }
                MCodeEffect::RigidTapping if self.pulses_output() => {
                    // The output is off again when the machine has answered.
                    let number = self.output_variable(code)?;
                    plan.push_event(EventKind::Auxiliary { code });
                    plan.writes.push(TableWrite::Variable { number, value: Value::Number(0.0) });
                }
                MCodeEffect::RigidTapping => {
                    plan.state.rigid_tapping = if self.words.has(b'S') {
                        RigidTapping::Certain
                    } else {
                        RigidTapping::Possible { has_moved: false }
                    };
                }
                MCodeEffect::CoolantOn => {
                    plan.state.is_coolant_on = true;
                    plan.push_event(EventKind::Coolant { is_on: true, code });
                }
                MCodeEffect::CoolantOff => {
                    plan.state.is_coolant_on = false;
                    plan.events_after_motion.push((EventKind::Coolant { is_on: false, code }, 0.0));
                }
                MCodeEffect::Output { is_on } => {
                    plan.push_event(EventKind::Auxiliary { code });
                    let number = self.output_variable(code)?;
                    let value = Value::Number(f64::from(u8::from(is_on)));
                    plan.writes.push(TableWrite::Variable { number, value });
                }
                MCodeEffect::JumpByInput => self.plan_jump_by_input(plan)?,
                MCodeEffect::OperatorInput => self.plan_operator_input(plan)?,
                MCodeEffect::SkipReference
                    if self.words.has_non_motion_code(|effect| effect == Effect::OneShot(OneShot::Skip)) => {}
                MCodeEffect::SkipAlarm(_) if self.words.has_non_motion_code(is_skip) => {}
                MCodeEffect::InterruptOn => {
                    self.words.mark_read(Letters::of(b"P"));
                    plan.notes.push(Note::InterruptNotSimulated);
                }
                MCodeEffect::InterruptOff => {}
                // M99 whose number is a variable: lowering separates only a call whose code is written.
                MCodeEffect::Call if code == RETURN => {
                    let number = self.words.count(b'P')?;
                    plan.flow = BlockFlow::Return { number, target: None };
                }
                MCodeEffect::Call => {
                    let what = format!("M{code:02} from a variable (write M{code:02})");
                    return Err(Alarm::NotSimulated { what }.located_at(span));
                }
                MCodeEffect::NotSimulated | MCodeEffect::SkipAlarm(_) | MCodeEffect::SkipReference => {
                    return Err(Alarm::NotSimulated { what: format!("M{code:02} here") }.located_at(span));
                }
            }
        }
        let changes_spindle =
            || plan.events.iter().any(|(kind, _)| matches!(kind, EventKind::Spindle { .. }));
        if self.words.has(b'S') && plan.state.spindle != SpindleDirection::Off && !changes_spindle() {
            self.set_spindle(plan, plan.state.spindle, Rpm(plan.state.modal_words.s));
        }
        Ok(())
    }

    /// M96 P Q of a Haas.
    fn plan_jump_by_input(&self, plan: &mut BlockPlan) -> ExecResult<()> {
        let missing = |letter| Alarm::MissingWord { code: "M96", letter }.located_at(self.block);
        let number = self.words.count(b'P')?.ok_or_else(|| missing('P'))?;
        let input = self.words.count(b'Q')?.ok_or_else(|| missing('Q'))?;
        if input > LAST_OUTPUT {
            return Err(self.not_simulated("M96 without Q0 to Q255"));
        }
        if self.registers.machine_value(FIRST_INPUT + input, None) == 0.0 {
            plan.flow = BlockFlow::Jump { number, target: 0 };
        }
        Ok(())
    }

    /// M109 P of a Haas: the code of the key that the operator presses, as stated for the variable.
    fn plan_operator_input(&self, plan: &mut BlockPlan) -> ExecResult<()> {
        let number = self.words.count(b'P')?;
        let allowed = number.filter(|number| matches!(number, 500..=599 | 10_500..=10_599));
        let number = allowed.ok_or_else(|| self.not_simulated("M109 without P500 to P599"))?;
        let value = Value::Number(self.registers.machine_value(number, None));
        plan.writes.push(TableWrite::Variable { number, value });
        Ok(())
    }

    fn plan_stop(&self, plan: &mut BlockPlan, kind: StopKind, speed: Rpm) {
        plan.stops.push(kind);
        if self.data.settings.undocumented.stop_stops_spindle && plan.state.spindle != SpindleDirection::Off {
            plan.state.spindle = SpindleDirection::Off;
            plan.events_after_motion.push((spindle_event(SpindleDirection::Off, speed), 0.0));
        }
    }

    fn set_spindle(&self, plan: &mut BlockPlan, direction: SpindleDirection, speed: Rpm) {
        plan.state.spindle = direction;
        plan.push_event(spindle_event(direction, speed));
    }
}

/// Returns the event of a spindle that an M code or S changes.
fn spindle_event(direction: SpindleDirection, speed: Rpm) -> EventKind {
    EventKind::Spindle { direction, speed, is_rigid: false, is_oriented: false }
}

/// Returns G41 or G42, × 10, if it is in force behind a block.
fn compensation_left(plan: &BlockPlan) -> Option<u32> {
    let side = plan.state.modal.cutter;
    (side != CutterSide::Off).then(|| side.code())
}
