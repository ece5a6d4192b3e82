//! Inspection of the next block before its execution: assignments, modes, positions, codes without an effect in a run.
use super::control::Control;
use super::flow::CallFrame;
use super::registers::Registers;
use super::words::{computed_row, count};
use gcode_lang::program::code_facts::{AxisWords, Letters, Unsimulated};
use gcode_lang::program::g_codes::{Effect, GCodeRow, OneShot};
use gcode_lang::program::m_codes::MCodeEffect;
use gcode_lang::program::modes::Distance;
use gcode_lang::program::{
    Assign, LoweredWord, Op, OpKind, Slot, Statement, WordOperand, Words, g_codes, m_codes,
};
use gcode_lang::source::Span;

/// Commands of the next block for state that would otherwise stay as it is.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct BlockCommands {
    /// Group and code × 10 of each modal code.
    pub modes: Vec<(u32, u32)>,
    /// Letters of the axes whose end position doesn't depend on their start.
    pub axes: Vec<char>,
    /// Offsets that G10 sets: `G10 L2 P1 X`.
    pub offsets: Vec<String>,
    /// Letters of F, S, T, H and D with a value.
    pub valued_letters: Vec<char>,
    /// G12 or G13 of a Haas, whose circles are smaller by the radius of D.
    pub is_circle_pocket: bool,
}

/// Codes of the next block that have no effect in a run and may have one on a machine.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct UnsimulatedCodes {
    /// `/`, `/3`: at the start of the block or inside.
    pub block_skips: Vec<String>,
    /// Corner accuracy and lookahead: `G09`, `G05.1 Q1`.
    pub path_codes: Vec<String>,
    /// Other G codes without effect: `G25`.
    pub g_codes: Vec<String>,
    /// Other M codes without effect: `M29`.
    pub m_codes: Vec<String>,
    /// The block may change offsets, parameters, outputs or counters.
    pub writes: bool,
    /// Number of M02 or M30.
    pub end_code: Option<u32>,
}

impl Control {
    /// Lowers the next block and returns its index; `None` after the last block.
    pub fn next_block(&mut self) -> Option<Span> {
        let CallFrame { program, next, .. } = self.executor.flow.frame;
        self.memory.lower_block(program, next).map(|op| op.span)
    }

    /// Returns the variables that [`Control::next_block`] will assign, those with computed numbers included.
    pub fn next_assigned_variables(&self) -> Vec<u32> {
        self.inspect_next(Registers::collect_targets)
    }

    /// Returns the commands of [`Control::next_block`]; none for a block that is skipped.
    pub fn next_commands(&self) -> BlockCommands {
        self.inspect_next(|registers, op, commands| {
            if let OpKind::Words(words) = registers.guarded_operation(op.kind()) {
                registers.collect_commands(words, commands);
            }
        })
    }

    /// Returns the codes of [`Control::next_block`] without effect in a run; none for a block that is skipped.
    pub fn next_unsimulated(&self) -> UnsimulatedCodes {
        self.inspect_next(|registers, op, unsimulated: &mut UnsimulatedCodes| {
            unsimulated.block_skips.extend(op.skip().map(skip_text));
            match registers.guarded_operation(op.kind()) {
                OpKind::Words(words) => registers.collect_unsimulated(words, unsimulated),
                OpKind::Statement(_) => {
                    let mut targets = Vec::new();
                    registers.collect_targets(op, &mut targets);
                    unsimulated.writes = targets.iter().any(|number| *number >= 1000);
                }
                OpKind::Empty | OpKind::AssignDirect(_) | OpKind::If { .. } | OpKind::Alarm(_) => {}
            }
        })
    }

    /// Returns true if no block skip and no condition keeps [`Control::next_block`] from being executed whole.
    pub fn is_next_unconditional(&self) -> bool {
        let Some(op) = self.next_op() else { return true };
        let condition = match op.kind() {
            OpKind::If { condition, .. }
            | OpKind::Statement(Statement::IfGoto { condition, .. } | Statement::IfThen { condition, .. }) => {
                Some(condition)
            }
            OpKind::Empty
            | OpKind::Words(_)
            | OpKind::Statement(_)
            | OpKind::AssignDirect(_)
            | OpKind::Alarm(_) => None,
        };
        self.executor.registers.without_side_effects(|registers| {
            condition.is_none_or(|condition| registers.evaluate_condition(condition).unwrap_or(true))
                && !registers.is_skipped(op)
        })
    }

    /// Returns the operation of [`Control::next_block`] if it is lowered.
    pub(super) fn next_op(&self) -> Option<&Op> {
        let CallFrame { program, next, .. } = self.executor.flow.frame;
        self.memory.programs().get(program.0 as usize)?.op(next)
    }

    /// Collects facts of the next operation; none if it is skipped or isn't lowered.
    pub(super) fn inspect_next<T: Default>(&self, collect: impl FnOnce(&Registers, &Op, &mut T)) -> T {
        let mut facts = T::default();
        if let Some(op) = self.next_op().filter(|op| !self.executor.registers.is_skipped(op)) {
            self.executor.registers.without_side_effects(|registers| collect(registers, op, &mut facts));
        }
        facts
    }
}

/// Returns a block skip as written; the first switch needs no number.
fn skip_text(switch: u8) -> String {
    if switch <= 1 { "/".to_owned() } else { format!("/{switch}") }
}

impl Registers {
    /// Calls a function and discards its effects on the run.
    pub(super) fn without_side_effects<T>(&self, inspect: impl FnOnce(&Self) -> T) -> T {
        let clock_read = self.clock.has_been_read.get();
        let result = self.block_effects.without_effects(|| inspect(self));
        self.clock.has_been_read.set(clock_read);
        result
    }

    /// Returns true if a block skip before the block is on.
    fn is_skipped(&self, op: &Op) -> bool {
        op.skip().is_some_and(|switch| self.data.is_skip_on(switch))
    }

    /// Returns the operation behind an IF whose condition is true, otherwise the operation itself.
    fn guarded_operation<'a>(&self, kind: &'a OpKind) -> &'a OpKind {
        match kind {
            OpKind::If { condition, then } if self.evaluate_condition(condition).unwrap_or(false) => then,
            _ => kind,
        }
    }

    fn collect_targets(&self, op: &Op, numbers: &mut Vec<u32>) {
        match self.guarded_operation(op.kind()) {
            OpKind::AssignDirect(Assign { variable, .. }) => numbers.push(u32::from(*variable)),
            OpKind::Statement(statement) => self.collect_statement_targets(statement, numbers),
            OpKind::Empty | OpKind::Words(_) | OpKind::If { .. } | OpKind::Alarm(_) => {}
        }
    }

    fn collect_statement_targets(&self, statement: &Statement, numbers: &mut Vec<u32>) {
        match statement {
            Statement::AssignDirect(Assign { variable, .. }) => numbers.push(u32::from(*variable)),
            Statement::Assign { target, .. } => {
                numbers.extend(self.resolve_target(target).map(Slot::number));
            }
            Statement::Assignments(all) => {
                all.iter().for_each(|one| self.collect_statement_targets(one, numbers))
            }
            Statement::IfThen { condition, then } if self.evaluate_condition(condition).unwrap_or(false) => {
                self.collect_statement_targets(then, numbers);
            }
            _ => {}
        }
    }

    /// Returns true if a word has a value.
    fn has_value(&self, words: &Words, word: &LoweredWord) -> bool {
        !word.comma && matches!(self.evaluate_word(words, word), Ok(Some(_)))
    }

    /// Iterates over the rows of a block's G codes.
    fn g_code_rows(&self, words: &Words) -> impl Iterator<Item = &'static GCodeRow> {
        let codes = words.list.iter().filter(|word| word.letter == b'G');
        codes
            .filter_map(|word| computed_row(self.evaluate_word(words, word).ok()??, &self.data.settings).ok())
    }

    /// Returns true if G90 is in force in a block.
    fn is_absolute(&self, words: &Words) -> bool {
        let commanded = self.g_code_rows(words).filter_map(|row| match row.effect {
            Effect::Distance(distance) => Some(distance),
            _ => None,
        });
        commanded.last().unwrap_or(self.state.modal.distance) == Distance::Absolute
    }

    fn collect_commands(&self, words: &Words, commands: &mut BlockCommands) {
        // The letters of G65 and M98 are arguments.
        if words.call().is_some() {
            return;
        }
        let words = self.data.words_not_skipped(words).0;
        let is_absolute = self.is_absolute(words);
        let mut axis_words = AxisWords::Move;
        for row in self.g_code_rows(words) {
            if !matches!(row.facts.axis_words, AxisWords::Move | AxisWords::Hole) {
                axis_words = row.facts.axis_words;
            }
            commands.is_circle_pocket |= matches!(row.effect, Effect::OneShot(OneShot::CirclePocket(_)));
            commands.modes.extend(row.group().map(|group| (group, row.code)));
        }
        let is_positioned = match axis_words {
            AxisWords::Position => true,
            AxisWords::Move | AxisWords::Hole | AxisWords::PositionInAbsolute => is_absolute,
            AxisWords::Tables => {
                self.collect_written_offsets(words, commands);
                false
            }
            AxisWords::Other => false,
        };
        for word in words.list.iter().filter(|word| self.has_value(words, word)) {
            let letter = char::from(word.letter);
            if "FSTHD".contains(letter) {
                commands.valued_letters.push(letter);
            }
            if is_positioned && word.axis.is_none() && self.data.settings.axes.find(word.letter).is_some() {
                commands.axes.push(letter);
            }
        }
    }

    /// Collects `G10 L2 P1 X` for every value of the block.
    fn collect_written_offsets(&self, words: &Words, commands: &mut BlockCommands) {
        let mut table = "G10".to_owned();
        for letter in *b"LP" {
            let word = words.list.iter().find(|word| word.letter == letter && !word.comma);
            let raw = word.and_then(|word| self.evaluate_word(words, word).ok().flatten());
            if let Some(raw) = raw {
                table.push_str(&format!(" {}{}", char::from(letter), raw.value()));
            }
        }
        let values = words.list.iter().filter(|word| !b"GLPN".contains(&word.letter) && !word.comma);
        commands.offsets.extend(values.map(|word| format!("{table} {}", char::from(word.letter))));
    }

    fn collect_unsimulated(&self, words: &Words, unsimulated: &mut UnsimulatedCodes) {
        unsimulated.writes |= self.state.is_in_parameter_input;
        let (words, switch) = self.data.words_not_skipped(words);
        unsimulated.block_skips.extend(switch.map(skip_text));
        for word in words.list.iter().filter(|word| matches!(word.letter, b'G' | b'M')) {
            let Ok(Some(raw)) = self.evaluate_word(words, word) else { continue };
            if word.letter == b'M' {
                let Ok(code) = count(raw, b'M') else { continue };
                let text = |letters| self.with_words(words, format!("M{code:02}"), letters);
                match m_codes::find(code, self.data.settings.codes) {
                    Some(MCodeEffect::NoEffect | MCodeEffect::RigidTapping) => {
                        unsimulated.m_codes.push(text(Letters::NONE))
                    }
                    Some(MCodeEffect::Orient) => unsimulated.m_codes.push(text(Letters::of(b"PR"))),
                    Some(MCodeEffect::Output { .. }) => unsimulated.m_codes.push(text(Letters::of(b"P"))),
                    Some(MCodeEffect::JumpByInput) => unsimulated.m_codes.push(text(Letters::of(b"PQ"))),
                    Some(MCodeEffect::OperatorInput) => unsimulated.m_codes.push(text(Letters::of(b"P"))),
                    Some(MCodeEffect::SkipAlarm(_) | MCodeEffect::SkipReference) => {
                        unsimulated.m_codes.push(text(Letters::NONE))
                    }
                    Some(MCodeEffect::End) => unsimulated.end_code = Some(code),
                    Some(
                        MCodeEffect::Stop
                        | MCodeEffect::OptionalStop
                        | MCodeEffect::SpindleForward
                        | MCodeEffect::SpindleReverse
                        | MCodeEffect::SpindleStop
                        | MCodeEffect::ToolChange
                        | MCodeEffect::CoolantOn
                        | MCodeEffect::CoolantOff
                        | MCodeEffect::InterruptOn
                        | MCodeEffect::InterruptOff
                        | MCodeEffect::Call
                        | MCodeEffect::NotSimulated,
                    )
                    | None => {}
                }
                continue;
            }
            let Ok(row) = computed_row(raw, &self.data.settings) else { continue };
            // A declared code has no number of its own.
            let code =
                if row.effect == Effect::Declared { (raw.value() * 10.0).round() as u32 } else { row.code };
            let text = |letters| self.with_words(words, g_codes::name(code), letters);
            match row.facts.unsimulated {
                Unsimulated::No => {}
                Unsimulated::Path(letters) => unsimulated.path_codes.push(text(letters)),
                // The point on the way depends on a work offset, which may be 0 in a run.
                Unsimulated::Code(letters)
                    if matches!(row.effect, Effect::OneShot(code) if code.moves_to_reference())
                        && self.is_absolute(words) =>
                {
                    unsimulated.g_codes.push(format!("G90 {}", text(letters)));
                }
                Unsimulated::Code(letters) => unsimulated.g_codes.push(text(letters)),
                Unsimulated::Writes => unsimulated.writes = true,
            }
        }
    }

    /// Returns a name with the values of these letters.
    fn with_words(&self, words: &Words, name: String, letters: Letters) -> String {
        let values = words.list.iter().filter(|word| letters.has(word.letter) && !word.comma);
        let shown = values.filter_map(|word| {
            if matches!(word.value, WordOperand::G(..)) {
                return None;
            }
            let value = self.evaluate_word(words, word).ok()??.value();
            Some(format!(" {}{value}", char::from(word.letter)))
        });
        name + &shown.collect::<String>()
    }
}

/// Returns a modal code × 10 as programs write it: `G90`, `G54.1`, `G00`.
pub fn modal_code(code: u32) -> String {
    g_codes::name(code)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Limits, Observer, Value};
    use gcode_lang::control::Settings;
    use gcode_lang::program::{Memory, NoLibrary};

    /// Results of a function before each block, and the variables that each block has assigned.
    struct Inspection<T> {
        inspect: fn(&Control) -> T,
        before: Vec<T>,
        targets: Vec<u32>,
        assigned: Vec<(u32, Value)>,
    }

    impl<T> Observer for Inspection<T> {
        fn before_block(&mut self, control: &mut Control) {
            self.targets = Vec::new();
            if control.next_block().is_some() {
                self.before.push((self.inspect)(control));
                self.targets = control.next_assigned_variables();
            }
        }

        fn after_block(&mut self, control: &Control) {
            let values = self.targets.iter().map(|number| (*number, control.variable(*number).unwrap()));
            self.assigned.extend(values);
        }
    }

    fn inspect<T>(blocks: &str, inspect: fn(&Control) -> T) -> Inspection<T> {
        let mut memory = Memory::default();
        memory.load("O1.nc", format!("O1\n{blocks}\nM30\n").into_bytes());
        let mut control = Control::new(memory, Settings::default());
        let mut inspection =
            Inspection { inspect, before: Vec::new(), targets: Vec::new(), assigned: Vec::new() };
        control.run_observed(Limits::default(), &mut NoLibrary, &mut (), &mut inspection);
        inspection
    }

    /// Returns what a function returns before the last block but M30.
    fn before<T>(block: &str, function: fn(&Control) -> T) -> T {
        let mut all = inspect(block, function).before;
        all.pop();
        all.pop().unwrap()
    }

    #[test]
    fn assignments_are_known_with_computed_numbers() {
        let assigned = |blocks| inspect(blocks, |_| ()).assigned;
        let blocks = "#1=500\n#[#1+2]=7.5\nIF[#1 EQ 500]THEN #2=#0\nIF[#1 EQ 1]THEN #3=1";
        let expected = [(1, Value::Number(500.0)), (502, Value::Number(7.5)), (2, Value::Vacant)];
        assert_eq!(assigned(blocks), expected, "#3 is not assigned: its condition is false");
        assert_eq!(assigned("#1=1\nGOTO 5\n#1=2\nN5"), [(1, Value::Number(1.0))]);
    }

    #[test]
    fn modal_codes_positions_and_offsets_are_commanded() {
        let commands = |block| before(block, Control::next_commands);
        let commanded = commands("G90 G54 G0 X5. Y0");
        assert_eq!(commanded.modes, [(3, 900), (14, 540), (1, 0)]);
        for (block, axes) in [
            ("G90 G54 G0 X5. Y0", &['X', 'Y'][..]),
            ("G91 G0 X5.", &[]),
            ("G92 X5.", &[]),
            ("G91 G28 Z0", &['Z']),
        ] {
            assert_eq!(commands(block).axes, axes, "{block}");
        }
        assert_eq!(commands("G10 L2 P1 X0 Y0").offsets, ["G10 L2 P1 X", "G10 L2 P1 Y"]);
        assert_eq!(commands("G1 X1. F100 S500 M3").valued_letters, ['F', 'S']);
        assert!(commands("G0 X1.").valued_letters.is_empty(), "F is modal");
        assert_eq!(commands("G43 Z5. H2").valued_letters, ['H']);
        assert_eq!([modal_code(0), modal_code(541)], ["G00", "G54.1"]);
    }

    #[test]
    fn a_block_with_a_false_condition_is_conditional() {
        for block in ["IF[1 GT 2]THEN #3000=1", "IF[1 GT 2]GOTO 9", "N5 IF[#1 EQ 1]THEN #2=1"] {
            assert!(!before(block, Control::is_next_unconditional), "{block}");
        }
        for block in ["IF[1 LT 2]THEN #2=1", "#2=1", "G0 X1."] {
            assert!(before(block, Control::is_next_unconditional), "{block}");
        }
    }

    #[test]
    fn codes_without_effect_are_listed() {
        let codes = |block| before(block, Control::next_unsimulated);
        assert_eq!(codes("/G1 X1. F100").block_skips, ["/"]);
        assert_eq!(codes("/3 M08").block_skips, ["/3"]);
        assert_eq!(codes("G1 X1. F100 /2 Y5.").block_skips, ["/2"]);
        let path = [
            ("G9 G1 X1. F100", "G09"),
            ("G5.1 Q1 R5", "G05.1 Q1 R5"),
            ("G8 P1", "G08 P1"),
            ("G60 X5.", "G60"),
        ];
        for (block, code) in path {
            assert_eq!(codes(block).path_codes, [code], "{block}");
        }
        for (block, code) in [
            ("G25", "G25"),
            ("G91 G28 Z0", "G28"),
            ("G91 G30 P3 Z0", "G30 P3"),
            ("G90 G28 Z0", "G90 G28"),
            ("G53 G0 Z0", "G53"),
        ] {
            assert_eq!(codes(block).g_codes, [code], "{block}");
        }
        // M19 stops the spindle, and orients it.
        for (block, code) in [("M29 S500", "M29"), ("M19 R90.", "M19 R90"), ("M19", "M19")] {
            assert_eq!(codes(block).m_codes, [code], "{block}");
        }
        for block in ["G10 L2 P1 X5.", "G92 X0", "G52 X1.", "#5221=3.", "#2001=1."] {
            assert!(codes(block).writes, "{block}");
        }
        for block in ["G1 X1. F100", "#500=3.", "G54", "G90 G0 X5."] {
            assert_eq!(codes(block), UnsimulatedCodes::default(), "{block}");
        }
    }
}
