//! Recorders of a run for the person at the machine: uses of tools in order, offsets, stops, and times.
use std::collections::{BTreeMap, BTreeSet};

use gcode_control::{Control, Observer};
use gcode_lang::motion::{
    AxisIndex, Backtrace, Event, EventKind, EventSink, LengthCompensation, SpindleDirection, StopKind,
};
use gcode_lang::program::modes::{ModalGroup, WorkSystem};
use gcode_lang::source::Span;

/// G40, as code × 10.
const CUTTER_COMPENSATION_OFF: u32 = 400;

/// G00, G80 and G95.
const RAPID: u32 = 0;
const NO_CYCLE: u32 = 800;
const FEED_PER_REVOLUTION: u32 = 950;

/// From one tool change to the next.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct ToolUse {
    /// Tool in the spindle; `None` before the first tool change.
    pub tool: Option<u32>,
    /// Length offsets that are commanded or cut, as code and H.
    pub length_offsets: BTreeSet<LengthCompensation>,
    /// Least and largest spindle speed of its cuts, 1/min.
    pub speed: Option<[f64; 2]>,
    /// True if the spindle turns as by M04 when it begins a cut; a tap is reversed on its way out.
    pub is_reversed: bool,
    /// Least and largest feed of its cuts, mm/min.
    pub feed: Option<[f64; 2]>,
    /// M codes that switch coolant on.
    pub coolants: BTreeSet<u32>,
    /// Duration without stops, s.
    pub seconds: f64,
    /// Block of its tool change.
    pub change: Option<Span>,
    /// Block of its first move.
    pub first_block: Option<Backtrace>,
}

/// An operator stop.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SheetStop {
    pub kind: StopKind,
    pub text: String,
    /// Variables that the text names, with their values.
    pub variables: Vec<(u32, f64)>,
    /// Tool in the spindle.
    pub tool: Option<u32>,
    /// Running time before the stop, s.
    pub elapsed: f64,
    pub backtrace: Backtrace,
}

/// Recorder of the events of a run.
#[derive(Debug, Default)]
pub(crate) struct UseRecorder {
    pub uses: Vec<ToolUse>,
    pub stops: Vec<SheetStop>,
    /// Times of rapids, feeds and dwells, s.
    pub times: [f64; 3],
    length: LengthCompensation,
    speed: f64,
    direction: SpindleDirection,
    coolant: Option<u32>,
    /// Block of the last cut, and the spindle's direction when that block began to cut; `None` behind a rapid.
    cut: Option<(Span, SpindleDirection)>,
}

impl UseRecorder {
    fn current(&mut self) -> &mut ToolUse {
        if self.uses.is_empty() {
            self.uses.push(ToolUse::default());
        }
        let last = self.uses.len() - 1;
        &mut self.uses[last]
    }

    fn record_cut(&mut self, rate: f64, block: Span) {
        let (length, speed, direction, coolant) = (self.length, self.speed, self.direction, self.coolant);
        let begun = self.cut.filter(|(known, _)| *known == block);
        let (_, first) = *self.cut.insert(begun.unwrap_or((block, direction)));
        let now = self.current();
        now.length_offsets.insert(length);
        widen(&mut now.feed, rate);
        if direction != SpindleDirection::Off {
            widen(&mut now.speed, speed);
        }
        now.is_reversed |= first == SpindleDirection::Counterclockwise;
        now.coolants.extend(coolant);
    }
}

fn widen(range: &mut Option<[f64; 2]>, value: f64) {
    let [min, max] = range.get_or_insert([value, value]);
    *min = min.min(value);
    *max = max.max(value);
}

impl EventSink for UseRecorder {
    fn event(&mut self, event: &Event<'_>) {
        let seconds = event.seconds.0;
        let kind = match &event.kind {
            EventKind::Rapid { .. } => {
                self.cut = None;
                Some(0)
            }
            EventKind::Feed { rate, .. } | EventKind::Arc { rate, .. } | EventKind::Skip { rate, .. } => {
                self.record_cut(rate.0, event.block);
                Some(1)
            }
            EventKind::Dwell { .. } => Some(2),
            EventKind::ToolChange { number } => {
                let change = Some(event.block);
                self.uses.push(ToolUse { tool: Some(*number), change, ..ToolUse::default() });
                None
            }
            EventKind::ToolLength { compensation, .. } => {
                self.length = *compensation;
                // A tool that cuts nothing, such as a probe, has its offset on the sheet too.
                if *compensation != LengthCompensation::Off {
                    self.current().length_offsets.insert(*compensation);
                }
                None
            }
            EventKind::Spindle { direction, speed, .. } => {
                (self.direction, self.speed) = (*direction, speed.0);
                None
            }
            EventKind::Coolant { is_on, code } => {
                self.coolant = is_on.then_some(*code);
                None
            }
            EventKind::Stop { kind, text, variables } => {
                self.stops.push(SheetStop {
                    kind: *kind,
                    text: text.clone(),
                    variables: variables.clone(),
                    tool: self.uses.last().and_then(|last| last.tool),
                    elapsed: self.times.iter().sum(),
                    backtrace: event.backtrace(),
                });
                None
            }
            EventKind::Start { .. }
            | EventKind::PositionUnknown { .. }
            | EventKind::ToolSelected { .. }
            | EventKind::Auxiliary { .. } => None,
        };
        if let Some(kind) = kind {
            self.times[kind] += seconds;
            let now = self.current();
            now.seconds += seconds;
            now.first_block.get_or_insert_with(|| event.backtrace());
        }
    }
}

/// Observer of the offsets that are in force when a block has moved something.
#[derive(Debug, Default)]
pub(crate) struct OffsetObserver {
    /// Work coordinate systems, in the order of their first use.
    pub work_systems: Vec<WorkSystem>,
    /// Cutter radius offsets, as tool and D.
    pub radius_offsets: BTreeSet<(u32, u32)>,
    /// Least and largest F of the cuts of a tool in G95, in the program's unit a revolution.
    pub feeds_per_revolution: BTreeMap<u32, [f64; 2]>,
    /// Rotary axes with their first commanded positions in work coordinates, degrees.
    pub first_angles: Vec<(AxisIndex, f64)>,
    moves: u64,
    /// The next block mills a circle that is smaller by the radius of D.
    is_circle_pocket: bool,
}

impl Observer for OffsetObserver {
    fn before_block(&mut self, control: &mut Control) {
        self.moves = control.moves();
        control.next_block();
        self.is_circle_pocket = control.next_commands().is_circle_pocket;
    }

    fn after_block(&mut self, control: &Control) {
        let state = control.state();
        // A move with compensation waits for the next one.
        let is_compensated = state.modal.code_in(ModalGroup::Cutter) != CUTTER_COMPENSATION_OFF;
        if is_compensated || self.is_circle_pocket {
            self.radius_offsets.insert((state.tool, state.modal_words.d));
        }
        if control.moves() == self.moves {
            return;
        }
        if !self.work_systems.contains(&state.modal.work) {
            self.work_systems.push(state.modal.work);
        }
        let is_cut = state.modal.code_in(ModalGroup::Motion) != RAPID
            || state.modal.code_in(ModalGroup::Cycle) != NO_CYCLE;
        if is_cut && state.modal.code_in(ModalGroup::FeedMode) == FEED_PER_REVOLUTION {
            let feed = state.modal_words.f;
            let range = self.feeds_per_revolution.entry(state.tool).or_insert([feed, feed]);
            *range = [range[0].min(feed), range[1].max(feed)];
        }
        let uncommanded = control.unknown_axes().uncommanded;
        let axes = &control.settings().axes;
        for axis in (0..axes.len()).filter(|axis| axes.is_rotary(*axis) && uncommanded >> axis & 1 == 0) {
            if self.first_angles.iter().all(|(known, _)| *known != axis) {
                self.first_angles.push((axis, control.work_position(axis)));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gcode_inspect::machine::Machine;
    use gcode_lang::program::NoLibrary;
    use gcode_session::Request;

    fn is_reversed(lines: &str) -> bool {
        let text = format!("O1\nG90 G0 Z50.\n{lines}\nM30\n");
        let request = Request::new("O1.nc", text.as_bytes(), Machine::default());
        let mut recorder = UseRecorder::default();
        gcode_session::run(&request, &mut NoLibrary, &mut recorder).unwrap();
        let [one] = &recorder.uses[..] else { panic!("one tool") };
        assert!(one.speed == Some([300.0, 300.0]) && one.feed == Some([450.0, 450.0]), "{one:?}");
        one.is_reversed
    }

    /// The cycle of a tap reverses the spindle on the way out: M03 is what the operator sees start.
    #[test]
    fn the_direction_of_a_tap_is_that_of_its_way_in() {
        let tap = "X10. Y0 R5. Z-20. F450.";
        for (lines, expected) in [
            (format!("S300 M03\nG99 G84 {tap}\nX20.\nX30. K2"), false),
            (format!("M29 S300\nG84 {tap}\nX20."), false),
            (format!("S300 M03\nG84 {tap} Q5."), false),
            (format!("S300 M04\nG74 {tap}\nX20."), true),
            (format!("M29 S300\nG74 {tap}"), true),
            (format!("S300 M04\nG81 {tap}"), true),
            (format!("S300 M03\nG81 {tap}"), false),
            (format!("S300 M03\nG84 {tap}\nG80\nM04\nG1 X0 F450."), true),
        ] {
            assert_eq!(is_reversed(&lines), expected, "{lines}");
        }
    }

    /// G13 D1 at T1, whose circle needs the radius of D1; G41 D2 at T2; a D in a block of G43 is not yet used.
    #[test]
    fn offsets_of_circles_and_of_contours_are_on_the_sheet() {
        let text = "O1\nG21 G90 G54 G40 G80\nT1 M6\nS500 M3\nG0 X0. Y0. Z5.\nG43 H1 D7 Z4.\nG1 Z-1. F100.\nG13 D1 I10. F200.\nG0 Z5.\n\
                    T2 M6\nS500 M3\nG41 D2 G1 X20. F100.\nY20.\nG40 X30.\nM30\n";
        let mut request = Request::new("O1.nc", text.as_bytes(), Machine::default());
        request.settings.apply_dialect(gcode_lang::control::Dialect::HaasNgc);
        let mut observer = OffsetObserver::default();
        gcode_session::run_observed(&request, &mut NoLibrary, &mut (), &mut observer).unwrap();
        assert_eq!(observer.radius_offsets, BTreeSet::from([(1, 1), (2, 2)]));
    }

    /// A move with compensation waits for the next block; D11 is in force all the same. F of G95 counts for cuts, not for rapids.
    #[test]
    fn offsets_and_feeds_a_revolution_are_those_of_the_cuts() {
        let text = "O1\nG21 G90 G54 G40 G80\nT3 M6\nS500 M3\nG0 X0. Y0. Z5. A30.\nG95 F0.5\nG0 X1.\nG41 D11 G1 X20. F0.1\nY20.\n\
                    G40 X30.\nG81 X1. Y1. Z-5. R2. F0.25\nG80\nG94 G1 X50. F200.\nM30\n";
        let request = Request::new("O1.nc", text.as_bytes(), Machine::default());
        let mut observer = OffsetObserver::default();
        gcode_session::run_observed(&request, &mut NoLibrary, &mut (), &mut observer).unwrap();
        assert_eq!(observer.radius_offsets, BTreeSet::from([(3, 11)]));
        assert_eq!(observer.feeds_per_revolution, BTreeMap::from([(3, [0.1, 0.25])]));
        let a = request.machine.axes.find(b'A').unwrap();
        assert_eq!(observer.first_angles, [(a, 30.0)], "B and C are not commanded");
    }
}
