//! Variables that the next block reads, found before it is executed.
use super::control::Control;
use super::evaluation::RoundingTarget;
use super::functions::variable_number;
use super::registers::Registers;
use super::variables::VariableClass;
use gcode_lang::program::{
    Assign, AssignmentTarget, CallTarget, ComputedSource, Instruction, LoweredWord, OpKind, Operand,
    OperandSource, Operation, PrintPart, Statement, UncommonOp, WordOperand, Words,
};
use gcode_lang::syntax::ast::Relation;

impl Control {
    /// Returns the local and common variables that [`Control::next_block`] will read, those with computed numbers included. A
    /// comparison with #0 asks whether its variable is vacant and counts as no read.
    pub fn next_read_variables(&self) -> Vec<u32> {
        self.inspect_next(|registers, op, numbers| registers.collect_reads(op.kind(), numbers))
    }
}

impl Registers {
    fn collect_reads(&self, kind: &OpKind, numbers: &mut Vec<u32>) {
        match kind {
            OpKind::AssignDirect(assign) => self.reads_of_code(&assign.code, numbers),
            OpKind::Statement(statement) => self.reads_of_statement(statement, numbers),
            OpKind::Words(words) => self.reads_of_words(words, numbers),
            OpKind::If { condition, then } => {
                self.reads_of_code(condition, numbers);
                if self.evaluate_condition(condition).unwrap_or(false) {
                    self.collect_reads(then, numbers);
                }
            }
            OpKind::Empty | OpKind::Alarm(_) => {}
        }
    }

    fn reads_of_statement(&self, statement: &Statement, numbers: &mut Vec<u32>) {
        match statement {
            Statement::AssignDirect(Assign { code, .. }) => self.reads_of_code(code, numbers),
            Statement::Assign { target, value, .. } => {
                if let AssignmentTarget::Computed(number) = target {
                    self.reads_of_operand(number, numbers);
                }
                self.reads_of_operand(value, numbers);
            }
            Statement::Assignments(all) => all.iter().for_each(|one| self.reads_of_statement(one, numbers)),
            Statement::Goto(to) => self.reads_of_operand(&to.node, numbers),
            Statement::IfGoto { condition, to } => {
                self.reads_of_code(condition, numbers);
                if self.evaluate_condition(condition).unwrap_or(false) {
                    self.reads_of_operand(&to.node, numbers);
                }
            }
            Statement::IfThen { condition, then } => {
                self.reads_of_code(condition, numbers);
                if self.evaluate_condition(condition).unwrap_or(false) {
                    self.reads_of_statement(then, numbers);
                }
            }
            Statement::While { condition, .. } => self.reads_of_code(condition, numbers),
            Statement::SetNames { first, .. } => self.reads_of_operand(first, numbers),
            Statement::Print { parts, .. } => {
                for part in parts {
                    if let PrintPart::Value { value, .. } = part {
                        self.reads_of_operand(value, numbers);
                    }
                }
            }
            Statement::Do { .. }
            | Statement::End { .. }
            | Statement::OpenOutput
            | Statement::CloseOutput
            | Statement::Alarm(_) => {}
        }
    }

    fn reads_of_words(&self, words: &Words, numbers: &mut Vec<u32>) {
        let words = self.data.words_not_skipped(words).0;
        words.list.iter().for_each(|word| self.reads_of_word(words, word, numbers));
        if let Some(call) = words.call() {
            if let CallTarget::Number(number) = &call.target {
                self.reads_of_word(words, number, numbers);
            }
            let parts = call.repeats.iter().chain(&call.start).chain(&call.arguments);
            parts.for_each(|word| self.reads_of_word(words, word, numbers));
        }
    }

    fn reads_of_word(&self, words: &Words, word: &LoweredWord, numbers: &mut Vec<u32>) {
        if let Some(axis) = word.axis.and_then(|index| words.axis(index)) {
            self.reads_of_operand(axis, numbers);
        }
        match word.value {
            WordOperand::Variable { slot, .. } => self.add_read(slot.number(), numbers),
            WordOperand::Code(index) => self.reads_of_code(words.code(index), numbers),
            WordOperand::Literal(_) | WordOperand::G(..) | WordOperand::Number(_) => {}
        }
    }

    fn reads_of_operand(&self, operand: &Operand, numbers: &mut Vec<u32>) {
        match operand {
            Operand::Number(_) => {}
            Operand::Variable { slot, .. } => self.add_read(slot.number(), numbers),
            Operand::Code(code) => self.reads_of_code(code, numbers),
        }
    }

    fn reads_of_code(&self, code: &[Instruction], numbers: &mut Vec<u32>) {
        // Numbers of reads before each of the last three instructions.
        let mut counts = [numbers.len(); 3];
        for (place, Instruction { operation, .. }) in code.iter().enumerate() {
            let before = numbers.len();
            match operation {
                Operation::Compare(Relation::Eq | Relation::Ne, values) if is_null(code, place) => {
                    // The value beside #0 is read for its vacancy alone.
                    if values.contains(&OperandSource::Computed(ComputedSource::Stacked))
                        && is_loaded(code, place)
                    {
                        numbers.truncate(counts[0]);
                    }
                }
                Operation::Uncommon(UncommonOp::Read(number)) => self.add_read(*number, numbers),
                Operation::Uncommon(UncommonOp::ReadItem { number, rounded, .. }) => {
                    let has_items = self.data.settings.has_variable_bits;
                    self.add_read(if has_items { *number } else { *rounded }, numbers);
                }
                Operation::Uncommon(UncommonOp::LoadIndirect | UncommonOp::AddPoint) => {
                    let value = self.run_code(&code[..place], RoundingTarget::Whole).ok();
                    if let Some(number) = value.and_then(|value| variable_number(value).ok()) {
                        self.add_read(number, numbers);
                    }
                }
                _ => operation.sources().iter().for_each(|source| self.reads_of_source(source, numbers)),
            }
            counts = [counts[1], counts[2], before];
        }
    }

    fn reads_of_source(&self, source: &OperandSource, numbers: &mut Vec<u32>) {
        if let OperandSource::Free(number) = source {
            self.add_read(u32::from(*number), numbers);
        }
    }

    fn add_read(&self, number: u32, numbers: &mut Vec<u32>) {
        if matches!(self.variables.classify(number), VariableClass::Local(_) | VariableClass::Common(_)) {
            numbers.push(number);
        }
    }
}

/// Returns true if the instruction before a place reads #0.
fn is_null(code: &[Instruction], place: usize) -> bool {
    let before = place.checked_sub(1).and_then(|before| code.get(before));
    before.is_some_and(|before| before.operation == Operation::Uncommon(UncommonOp::Read(0)))
}

/// Returns true if the value that a comparison with #0 takes from the stack is a variable, which nothing has computed.
fn is_loaded(code: &[Instruction], place: usize) -> bool {
    // It is loaded, pushed, #0 is read, and both are compared.
    let loaded = place.checked_sub(3).and_then(|loaded| code.get(loaded));
    let is_load = |operation: &Operation| {
        use UncommonOp::{Load, LoadIndirect, Push, Read};
        let is_push = code[place - 2].operation == Operation::Uncommon(Push);
        is_push && matches!(operation, Operation::Uncommon(Load(_) | Read(_) | LoadIndirect))
    };
    loaded.is_some_and(|loaded| is_load(&loaded.operation))
}

#[cfg(test)]
mod tests {
    use crate::Control;
    use gcode_lang::control::Settings;
    use gcode_lang::program::{Memory, NoLibrary};

    /// Returns what a block reads when #1 is 5 and #2 is vacant.
    fn reads(block: &str) -> Vec<u32> {
        let mut memory = Memory::default();
        memory.load("O1.nc", format!("O1\n#1=5\n{block}\nN9 M30\n").into_bytes());
        let mut control = Control::new(memory, Settings::default());
        assert!(control.step(&mut NoLibrary, &mut ()).is_none());
        control.next_block();
        control.next_read_variables()
    }

    #[test]
    fn reads_are_found_in_statements_words_and_arguments() {
        for (block, expected) in [
            ("#3=1", &[][..]),
            ("#3=#2", &[2]),
            ("#3=#1+#2", &[1, 2]),
            ("#[#1+95]=#[#1+96]", &[1, 1, 101]),
            ("#3=SIN[#2]", &[2]),
            ("G0 X#1 Y[#2+1]", &[1, 2]),
            ("G65 P2 A#2 L#1", &[1, 2]),
            ("IF[#1 GT 9]THEN #3=#2", &[1]),
            ("IF[#1 LT 9]THEN #3=#2", &[1, 2]),
            ("IF[#2 EQ 0]GOTO 9", &[2]),
            ("DPRNT[X#2[20]]", &[2]),
            ("#3=#5001", &[]),
            ("GOTO#1", &[1]),
        ] {
            assert_eq!(reads(block), expected, "{block}");
        }
    }

    #[test]
    fn a_test_for_vacancy_is_no_read() {
        for block in ["IF[#2 EQ #0]GOTO 9", "IF[#0 NE #2]GOTO 9", "#3=#0"] {
            assert!(reads(block).is_empty(), "{block}");
        }
        assert_eq!(reads("IF[[#2 EQ #0]OR[#1 GT 3]]GOTO 9"), [1]);
        assert_eq!(reads("IF[[#1 GT 3]OR[#5001 EQ #0]]GOTO 9"), [1]);
        assert_eq!(reads("IF[[#1+#2] EQ #0]GOTO 9"), [1, 2]);
        assert_eq!(reads("IF[[#1 GT 3]AND[#2 EQ #0]]GOTO 9"), [1]);
        assert_eq!(reads("IF[#[#1+95] EQ #0]GOTO 9"), [1], "the number is read, #100 isn't");
    }
}
