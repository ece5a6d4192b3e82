//! Marks of the values that a block reads: variables, system variables, parameters.
use super::super::data::{ControlData, Register, system_index};
use super::super::evaluation::RoundingTarget;
use super::super::functions::variable_number;
use super::super::variables::VariableClass;
use super::{Block, Marks, OutsideValue, Slice};
use crate::registers::Registers;
use gcode_lang::control::{OffsetMemory, OffsetVariables, Settings};
use gcode_lang::program::modes::WorkSystem;
use gcode_lang::program::{Instruction, Operand, OperandSource, Operation, UncommonOp};

/// Number of axes in each range of positions, #5001 to #5020 and so on.
pub(super) const POSITIONS: u32 = 20;

/// Place of the first additional work coordinate system behind EXT and G54 to G59.
const FIRST_ADDITIONAL: usize = 7;

/// Entry of an offset table.
pub(super) enum OffsetEntry {
    /// Table and number of a tool offset.
    Tool(Register, u32),
    /// System and axis, as a bit; 0 of an axis that no control has.
    Work(usize, u8),
}

/// Returns the entry that a system variable addresses.
pub(super) fn offset_of(number: u32, settings: &Settings) -> Option<OffsetEntry> {
    let is_haas = settings.offset_variables == OffsetVariables::Haas;
    let bit = |axis: u32| 1_u8.checked_shl(axis).unwrap_or(0);
    let work = |first: u32, system: usize| {
        let (row, axis) = ((number - first) / POSITIONS, (number - first) % POSITIONS);
        OffsetEntry::Work(system + row as usize, bit(axis))
    };
    let wear = is_wear(number, settings);
    let length = |tool| OffsetEntry::Tool(if wear { Register::HWear } else { Register::HGeometry }, tool);
    let radius = |tool| OffsetEntry::Tool(if wear { Register::DWear } else { Register::DGeometry }, tool);
    Some(match number {
        2001..=2400 => length((number - 2001) % 200 + 1),
        2401..=2800 if is_haas || settings.has_diameter_variables => radius((number - 2401) % 200 + 1),
        2500..=2806 => OffsetEntry::Work((number % 100) as usize, bit(number / 100 - 25)),
        5201..=5220 if is_haas => return None,
        5201..=5340 => work(5201, 0),
        7001..=7960 => work(7001, FIRST_ADDITIONAL),
        10_001..=13_999 if is_haas => return None,
        10_001..=11_999 => length(number % 1000),
        12_001..=13_999 => radius(number % 1000),
        14_001..=20_000 => work(14_001, FIRST_ADDITIONAL),
        _ => return None,
    })
}

fn is_haas(block: &Block<'_>) -> bool {
    block.registers.data.settings.offset_variables == OffsetVariables::Haas
}

/// Returns true if a system variable is the wear of a tool, which no machine file states.
fn is_wear(number: u32, settings: &Settings) -> bool {
    match settings.offset_variables {
        OffsetVariables::Fanuc if settings.has_diameter_variables && matches!(number, 2401..=2600) => true,
        OffsetVariables::Fanuc => matches!(number, 2001..=2200 | 10_001..=10_999 | 12_001..=12_999),
        OffsetVariables::Haas => matches!(number, 2201..=2400 | 2601..=2800),
    }
}

impl Block<'_> {
    /// Returns true if a condition is true.
    pub(super) fn is_true(&self, condition: &[Instruction]) -> bool {
        self.registers
            .without_side_effects(|registers| registers.evaluate_condition(condition).unwrap_or(false))
    }

    /// Returns the number that the code before an instruction computes.
    fn number_before(&self, code: &[Instruction], place: usize) -> Option<u32> {
        let value = self.registers.without_side_effects(|registers| {
            registers.run_code(&code[..place], RoundingTarget::Whole).ok()
        })?;
        variable_number(value).ok()
    }
}

impl Slice {
    pub(super) fn operand_marks(&mut self, block: &Block<'_>, operand: &Operand) -> Marks {
        match operand {
            Operand::Number(_) => Marks::NONE,
            Operand::Variable { slot, .. } => self.variable_marks(block, slot.number()),
            Operand::Code(code) => self.code_marks(block, code),
        }
    }

    /// Returns the marks of everything that code reads.
    pub(super) fn code_marks(&mut self, block: &Block<'_>, code: &[Instruction]) -> Marks {
        let mut marks = Marks::NONE;
        for (place, Instruction { operation, .. }) in code.iter().enumerate() {
            marks |= match operation {
                Operation::Uncommon(UncommonOp::Read(number)) => self.variable_marks(block, *number),
                Operation::Uncommon(UncommonOp::ReadItem { number, rounded, .. }) => {
                    let has_items = block.registers.data.settings.has_variable_bits;
                    self.variable_marks(block, if has_items { *number } else { *rounded })
                }
                Operation::Uncommon(UncommonOp::LoadIndirect | UncommonOp::AddPoint) => {
                    match block.number_before(code, place) {
                        Some(number) => self.variable_marks(block, number),
                        None => Marks::NONE,
                    }
                }
                Operation::Uncommon(UncommonOp::Parameter { bit, axis }) => {
                    let is_whole = !bit && !axis;
                    let number = block.number_before(code, place).filter(|_| is_whole);
                    self.outside(OutsideValue::Parameter(number), None, block.flow, block.op)
                }
                _ => self.sources_marks(block, operation.sources()),
            };
        }
        marks
    }

    fn sources_marks(&mut self, block: &Block<'_>, sources: &[OperandSource]) -> Marks {
        let mut marks = Marks::NONE;
        for source in sources {
            if let OperandSource::Free(place) = source {
                marks |= self.variable_marks(block, u32::from(*place));
            }
        }
        marks
    }

    /// Returns the marks of a variable; one that nothing in the program has set is an outside value.
    pub(super) fn variable_marks(&mut self, block: &Block<'_>, number: u32) -> Marks {
        match block.registers.variables.classify(number) {
            VariableClass::Vacant => Marks::NONE,
            VariableClass::Local(place) => {
                let is_preset = self.variables.level() == 0
                    && !self.variables.is_written(place)
                    && !block.registers.variables.get(place).is_vacant();
                let outside = if is_preset { self.outside_variable(block, number) } else { Marks::NONE };
                self.variables.get(place) | outside
            }
            VariableClass::Common(place) => {
                let is_written = self.variables.is_written(place);
                let outside = if is_written { Marks::NONE } else { self.outside_variable(block, number) };
                self.variables.get(place) | outside
            }
            VariableClass::System => self.system_marks(block, number),
        }
    }

    pub(super) fn outside_variable(&mut self, block: &Block<'_>, number: u32) -> Marks {
        let value = block.registers.without_side_effects(|registers| registers.read_variable(number).ok());
        let value = value.and_then(|value| value.as_number());
        self.outside(OutsideValue::Variable(number), value, block.flow, block.op)
    }

    /// Returns the marks of a system variable.
    fn system_marks(&mut self, block: &Block<'_>, number: u32) -> Marks {
        match number {
            3000 | 3006 | 3100..=3102 => Marks::NONE,
            4001..=4130 | 4201..=4330 => self.modal_marks(block, number),
            5001..=5100 => self.position_marks(block, number),
            // Before any tool change the tool in the spindle comes from outside.
            3026 if is_haas(block) => match block.registers.state.tool {
                0 => self.machine.tool | self.outside_variable(block, number),
                _ => self.machine.tool,
            },
            3027 if is_haas(block) => self.machine.spindle | self.modal_marks(block, 4119),
            20_009 if is_haas(block) => self.modal_marks(block, 4006),
            // A clock goes on whatever the program sets.
            3001 | 3002 | 3011 | 3012 => self.outside_variable(block, number),
            _ => match self.variables.system(number) {
                Some(marks) => marks,
                None if self.is_offset_set(&block.registers.data, number) => self.table_marks(number),
                None => self.outside_variable(block, number) | self.table_marks(number),
            },
        }
    }

    /// Returns the marks of a tool length, by its H: an outside value unless the machine file states it or blocks have set both
    /// its geometry and its wear.
    pub(super) fn length_marks(&mut self, block: &Block<'_>, number: u32) -> Marks {
        let offsets = &block.registers.data.offsets;
        let [geometry, wear] = [Register::HGeometry, Register::HWear];
        if number == 0 || self.stated.lengths.contains(&number) {
            Marks::NONE
        } else if !self.is_tool_set(&block.registers.data, geometry, number) {
            let value = offsets.length(number).ok();
            self.outside(OutsideValue::ToolLength(number), value, block.flow, block.op)
        } else if !self.is_tool_set(&block.registers.data, wear, number) {
            self.outside_variable(block, if is_haas(block) { 2200 } else { 10_000 } + number)
        } else {
            Marks::NONE
        }
    }

    /// Returns the marks of a cutter radius, by its D, as of a length; memories A and B have one table for both.
    pub(super) fn radius_marks(&mut self, block: &Block<'_>, number: u32) -> Marks {
        let data = &block.registers.data;
        let [geometry, wear] = [Register::DGeometry, Register::DWear];
        let stated = match data.settings.offset_memory {
            OffsetMemory::A | OffsetMemory::B => &self.stated.lengths,
            OffsetMemory::C => &self.stated.radii,
        };
        if number == 0 || stated.contains(&number) {
            Marks::NONE
        } else if !self.is_tool_set(data, geometry, number) {
            let value = data.offset_radius(number);
            self.outside(OutsideValue::CutterRadius(number), value, block.flow, block.op)
        } else if !self.is_tool_set(data, wear, number) {
            self.outside_variable(block, if is_haas(block) { 2600 } else { 12_000 } + number)
        } else {
            Marks::NONE
        }
    }

    /// Returns true if a block has set an entry of a table of tool offsets.
    pub(super) fn is_tool_set(&self, data: &ControlData, register: Register, number: u32) -> bool {
        self.set_tools[data.table(register) as usize].contains(&number)
    }

    /// Returns the marks of a work offset that nothing has set for `axes`; of each of them where it is set for others.
    pub(super) fn open_offset_marks(&mut self, block: &Block<'_>, work: WorkSystem, axes: u8) -> Marks {
        if self.set_offsets.axes(system_index(work)) == 0 {
            return self.outside(OutsideValue::WorkOffset(work, None), None, block.flow, block.op);
        }
        let data = &block.registers.data;
        let open = data.settings.axes.iter().filter(|(axis, _)| axes >> axis & 1 == 1);
        open.map(|(axis, letter)| {
            let value = data.offsets.work.get(system_index(work)).map(|offset| offset[axis]);
            self.outside(OutsideValue::WorkOffset(work, Some(letter)), value, block.flow, block.op)
        })
        .collect()
    }

    /// Returns the axes, as bits, whose offset in a work coordinate system is an outside value. G54 is the part's zero unless
    /// something sets it.
    pub(super) fn open_axes(&self, data: &ControlData, work: WorkSystem) -> u8 {
        let index = system_index(work);
        let with_offset = if work == WorkSystem::default() { data.set_offsets.axes(index) } else { u8::MAX };
        with_offset & !self.set_offsets.axes(index)
    }

    /// Returns true if the machine file states an offset or a block has set it, by its variable.
    fn is_offset_set(&self, data: &ControlData, number: u32) -> bool {
        let settings = &data.settings;
        match offset_of(number, settings) {
            Some(OffsetEntry::Tool(register, tool)) => {
                let stated = &self.stated;
                let is_stated = match register {
                    Register::HGeometry => stated.lengths.contains(&tool),
                    Register::DGeometry => stated.radii.contains(&tool),
                    Register::HWear | Register::DWear => false,
                };
                is_stated || self.is_tool_set(data, register, tool)
            }
            Some(OffsetEntry::Work(system, axis)) => self.set_offsets.axes(system) & axis != 0,
            None => false,
        }
    }

    /// Returns the marks of offsets that G10 or another variable may have set.
    fn table_marks(&self, number: u32) -> Marks {
        match number {
            2001..=2999 | 5201..=5340 | 7001..=7960 | 10_001..=20_000 => {
                self.machine.work_table | self.machine.tool_table
            }
            _ => Marks::NONE,
        }
    }

    /// Writes a variable.
    pub(super) fn write(&mut self, registers: &Registers, number: u32, marks: Marks) {
        match registers.variables.classify(number) {
            VariableClass::Vacant => {}
            VariableClass::Local(place) | VariableClass::Common(place) => self.variables.set(place, marks),
            VariableClass::System => {
                self.variables.set_system(number, marks);
                self.add_to_tables(number, marks);
                match offset_of(number, &registers.data.settings) {
                    Some(OffsetEntry::Tool(register, tool)) => {
                        self.set_tools[registers.data.table(register) as usize].insert(tool);
                    }
                    Some(OffsetEntry::Work(system, axis)) => self.set_offsets.add(system, axis),
                    None => {}
                }
            }
        }
    }

    /// Adds marks to a variable that might have been written.
    pub(super) fn add_to_variable(&mut self, registers: &Registers, number: u32, marks: Marks) {
        match registers.variables.classify(number) {
            VariableClass::Vacant => {}
            VariableClass::Local(place) | VariableClass::Common(place) => self.variables.add(place, marks),
            // An alarm or a stop changes nothing.
            VariableClass::System if matches!(number, 3000 | 3006) => {}
            VariableClass::System => {
                match self.variables.system(number) {
                    Some(before) => self.variables.set_system(number, before | marks),
                    None => self.machine.rest |= marks,
                }
                self.add_to_tables(number, marks);
            }
        }
    }

    fn add_to_tables(&mut self, number: u32, marks: Marks) {
        match number {
            2001..=2499 | 10_001..=13_999 => self.machine.tool_table |= marks,
            2500..=2806 | 5201..=5340 | 7001..=7960 | 14_001..=20_000 => self.machine.work_table |= marks,
            _ => {}
        }
    }
}
