//! System variables: one row per range, with its functions to read and write.
use super::data::Register;
use super::functions::integer;
use super::notes::Note;
use super::registers::{Registers, check_signal_word};
use super::variables::Value;
use gcode_lang::alarm::Alarm;
use gcode_lang::control::{
    Dialect, MachineValue, OffsetMemory, OffsetVariables, Settings, assumed_machine_value, has_items,
};
use gcode_lang::motion::{AxisIndex, Position, SpindleDirection};
use gcode_lang::program::modes::{Unit, WorkSystem};

type ReadVariable = fn(&Registers, u32) -> Result<f64, Alarm>;

type WriteVariable = fn(&mut Registers, u32, f64) -> Result<(), Alarm>;

/// Range of variables; reading and writing take the index in the range.
struct VariableRow {
    from: u32,
    to: u32,
    read: ReadRule,
    write: Option<WriteVariable>,
}

/// Result of reading a variable.
enum ReadRule {
    /// PS1115.
    Protected,
    /// Always vacant.
    Vacant,
    Value(ReadVariable),
}

const fn row(from: u32, to: u32, read: Option<ReadVariable>, write: Option<WriteVariable>) -> VariableRow {
    let read = match read {
        Some(read) => ReadRule::Value(read),
        None => ReadRule::Protected,
    };
    VariableRow { from, to, read, write }
}

/// Returns the row of a variable that is always vacant.
const fn vacant(number: u32) -> VariableRow {
    VariableRow { from: number, to: number, read: ReadRule::Vacant, write: None }
}

/// All ranges in ascending order. A number in none of them is PS0115; without a way to read PS1115, to write PS0116.
#[rustfmt::skip]
const ROWS: &[VariableRow] = &[
    // Interface signals.
    row(1000, 1031, Some(|r, n| Ok(f64::from(r.data.settings.inputs >> n & 1))), None),
    row(1032, 1035, Some(|r, n| check_signal_word(n).map(|()| f64::from(r.data.settings.inputs as i32))), None),
    row(1100, 1131, Some(|r, n| Ok(f64::from(r.panel.outputs >> n & 1))), Some(|r, n, v| { r.panel.set_output(n, v != 0.0); Ok(()) })),
    row(1132, 1135, Some(|r, n| check_signal_word(n).map(|()| f64::from(r.panel.outputs as i32))), Some(|r, n, v| r.panel.set_outputs(n, v))),
    // Tool offsets, memory C.
    row(2001, 2200, Some(|r, n| r.tool_offset(Register::HWear, n)), Some(|r, n, v| r.set_tool_offset(Register::HWear, n, v))),
    row(2201, 2400, Some(|r, n| r.tool_offset(Register::HGeometry, n)), Some(|r, n, v| r.set_tool_offset(Register::HGeometry, n, v))),
    // Work offsets by axis: EXT, G54 to G59 of axis 1, 2, 3, 4.
    row(2500, 2506, Some(|r, n| r.work_offset(n as usize, 0)), Some(|r, n, v| r.set_work_offset(n as usize, 0, v))),
    row(2600, 2606, Some(|r, n| r.work_offset(n as usize, 1)), Some(|r, n, v| r.set_work_offset(n as usize, 1, v))),
    row(2700, 2706, Some(|r, n| r.work_offset(n as usize, 2)), Some(|r, n, v| r.set_work_offset(n as usize, 2, v))),
    row(2800, 2806, Some(|r, n| r.work_offset(n as usize, 3)), Some(|r, n, v| r.set_work_offset(n as usize, 3, v))),
    // Alarm, clocks, switches, message.
    row(3000, 3000, None, None),
    row(3001, 3001, Some(|r, _| Ok(r.clock.milliseconds())), Some(|r, _, v| { r.clock.set_milliseconds(v); Ok(()) })),
    row(3002, 3002, Some(|r, _| Ok(r.clock.hours())), Some(|r, _, v| { r.clock.set_hours(v); Ok(()) })),
    row(3003, 3004, Some(|r, n| Ok(r.panel.control_switches[n as usize])), Some(|r, n, v| r.panel.set_switch(n, v))),
    // Setting data: of its bits only INI (2), inch input, has an effect here.
    row(3005, 3005, Some(|r, _| Ok(if r.state.modal.unit == Unit::Inch { 4.0 } else { 0.0 })), Some(|_, _, _| Err(Alarm::NotSimulated { what: "writing #3005".into() }))),
    row(3006, 3006, None, None),
    // Mirror image by setting or signal: there is none; G51.1 is none of them.
    row(3007, 3007, Some(|_, _| Ok(0.0)), None),
    row(3008, 3008, Some(|_, _| Ok(0.0)), None),
    row(3011, 3011, Some(|r, _| Ok(f64::from(r.data.settings.date))), None),
    row(3012, 3012, Some(|r, _| Ok(r.time_of_day())), None),
    vacant(3100),
    row(3101, 3101, Some(|_, _| Ok(std::f64::consts::PI)), None),
    row(3102, 3102, Some(|_, _| Ok(std::f64::consts::E)), None),
    row(3901, 3902, Some(|r, n| Ok(r.panel.part_counters[n as usize])), Some(|r, n, v| r.panel.set_parts(n, v))),
    // Modal information: of the block before, and of the block at work. Here they are the same.
    row(4001, 4130, Some(|r, n| r.modal_information(n + 1)), None),
    row(4201, 4330, Some(|r, n| r.modal_information(n + 1)), None),
    // Positions.
    row(5001, 5020, Some(|r, n| r.position(n, |r, axis| r.end_point()[axis])), None),
    row(5021, 5040, Some(|r, n| r.position(n, |r, axis| r.data.wrap_angle(axis, r.tool_centre(axis)))), None),
    row(5041, 5060, Some(|r, n| r.position(n, |r, axis| r.work_coordinate(axis, r.tool_centre(axis)))), None),
    row(5061, 5080, Some(|r, n| r.position(n, |r, axis| r.work_coordinate(axis, r.state.skip_position[axis]))), None),
    row(5081, 5100, Some(|r, n| r.position(n, |r, axis| r.state.length_offset[axis])), None),
    row(5101, 5140, Some(|r, n| r.position(n % 20, |_, _| 0.0)), None),
    row(5181, 5200, Some(|r, n| r.position(n, |_, _| 0.0)), None),
    // Work offsets.
    row(5201, 5340, Some(|r, n| r.work_offset((n / 20) as usize, n % 20)), Some(|r, n, v| r.set_work_offset((n / 20) as usize, n % 20, v))),
    // Fixture offsets of G54.2.
    row(5521, 5680, Some(|r, n| r.position(n % 20, |r, axis| r.data.offsets.fixtures[(n / 20) as usize].map_or(0.0, |row| row[axis]))), Some(|r, n, v| r.set_fixture((n / 20) as usize, n % 20, v))),
    row(7001, 7960, Some(|r, n| r.work_offset((7 + n / 20) as usize, n % 20)), Some(|r, n, v| r.set_work_offset((7 + n / 20) as usize, n % 20, v))),
    row(10001, 10999, Some(|r, n| r.tool_offset(Register::HWear, n)), Some(|r, n, v| r.set_tool_offset(Register::HWear, n, v))),
    row(11001, 11999, Some(|r, n| r.tool_offset(Register::HGeometry, n)), Some(|r, n, v| r.set_tool_offset(Register::HGeometry, n, v))),
    row(12001, 12999, Some(|r, n| r.tool_offset(Register::DWear, n)), Some(|r, n, v| r.set_tool_offset(Register::DWear, n, v))),
    row(13001, 13999, Some(|r, n| r.tool_offset(Register::DGeometry, n)), Some(|r, n, v| r.set_tool_offset(Register::DGeometry, n, v))),
    row(14001, 20000, Some(|r, n| r.work_offset((7 + n / 20) as usize, n % 20)), Some(|r, n, v| r.set_work_offset((7 + n / 20) as usize, n % 20, v))),
    // Setting errors of G54.4.
    row(26010, 26079, Some(|r, n| r.setting_error(n)), Some(|r, n, v| r.set_setting_error(n, v))),
];

/// Ranges that a control may have and the simulator lacks.
const NOT_SIMULATED: &[(u32, u32, &str)] = &[
    (4401, 4530, "the codes of a block that a macro interrupted"),
    (8000, 8999, "tool management"),
    (26_000, 26_005, "the workpiece setting error that all have in common"),
    (100_001, 100_200, "positions of more than 20 axes"),
];

/// Ranges that differ with D15 6004#5: the offsets of D replace work offsets by axis.
#[rustfmt::skip]
const DIAMETER_ROWS: &[VariableRow] = &[
    row(2401, 2600, Some(|r, n| r.tool_offset(Register::DWear, n)), Some(|r, n, v| r.set_tool_offset(Register::DWear, n, v))),
    row(2601, 2800, Some(|r, n| r.tool_offset(Register::DGeometry, n)), Some(|r, n, v| r.set_tool_offset(Register::DGeometry, n, v))),
];

/// Range of values of the machine that a program reads.
macro_rules! stated {
    ($from:literal, $to:literal) => {
        row($from, $to, Some(|r, n| Ok(r.machine_value($from + n, None))), None)
    };
}

/// Range of entries of a table of the machine, which a program reads and writes.
macro_rules! stored {
    ($from:literal, $to:literal) => {
        row($from, $to, Some(|r, n| Ok(r.stored_value($from + n))), Some(|r, n, v| r.store($from + n, v)))
    };
}

/// Ranges that differ on a Haas: tool offsets, the offset of G52, and what its machine and
/// its tables state.
#[rustfmt::skip]
const HAAS: &[VariableRow] = &[
    row(2001, 2200, Some(|r, n| r.tool_offset(Register::HGeometry, n)), Some(|r, n, v| r.set_tool_offset(Register::HGeometry, n, v))),
    row(2201, 2400, Some(|r, n| r.tool_offset(Register::HWear, n)), Some(|r, n, v| r.set_tool_offset(Register::HWear, n, v))),
    row(2401, 2600, Some(|r, n| r.tool_offset(Register::DGeometry, n)), Some(|r, n, v| r.set_tool_offset(Register::DGeometry, n, v))),
    row(2601, 2800, Some(|r, n| r.tool_offset(Register::DWear, n)), Some(|r, n, v| r.set_tool_offset(Register::DWear, n, v))),
    stated!(1032, 1099),
    stored!(1132, 1299),
    stored!(1601, 2000),
    stored!(3020, 3025),
    row(3026, 3026, Some(|r, _| Ok(f64::from(r.state.tool))), None),
    row(3027, 3027, Some(|r, _| Ok(if r.state.spindle == SpindleDirection::Off { 0.0 } else { r.state.modal_words.s })), None),
    stated!(3028, 3028),
    stored!(3030, 3031),
    row(3032, 3032, Some(|r, _| Ok(f64::from(u8::from(r.data.is_skip_on(1))))), None),
    row(3033, 3033, Some(|r, _| Ok(f64::from(u8::from(r.data.settings.stops_at_m01)))), None),
    stated!(3034, 3034),
    vacant(3100),
    stored!(3196, 3196),
    stored!(3201, 3600),
    row(5201, 5220, Some(|r, n| r.position(n, |r, axis| r.state.g52_shift[axis])), Some(|r, n, v| r.set_local(n, v))),
    stored!(5401, 6999),
    stored!(7401, 7960),
    stored!(8500, 8599),
    stated!(11_000, 11_255),
    row(12_000, 12_255, Some(|r, n| Ok(r.panel.stored(12_000 + n).unwrap_or(0.0))), Some(|r, n, v| r.store(12_000 + n, f64::from(u8::from(v != 0.0))))),
    stated!(13_000, 13_063),
    stated!(20_000, 39_999),
    stored!(50_001, 59_999),
];

/// Returns the alarm of a number in one of these ranges.
fn not_simulated(number: u32, of: &[(u32, u32, &str)]) -> Option<Alarm> {
    let (.., what) = of.iter().find(|(from, to, _)| (*from..=*to).contains(&number))?;
    Some(Alarm::NotSimulated { what: format!("#{number} ({what})") })
}

/// Returns the row of a number on a control with these settings.
fn find(number: u32, settings: &Settings) -> Result<&'static VariableRow, Alarm> {
    let unknown = Alarm::NoSuchVariable { number: i64::from(number) };
    let among = |rows: &'static [VariableRow]| rows.iter().find(|row| (row.from..=row.to).contains(&number));
    if settings.offset_variables == OffsetVariables::Haas {
        if let Some(row) = among(HAAS) {
            return Ok(row);
        }
        if matches!(number, 2500..=2899 | 3100..=3199 | 10_001..=13_999) {
            return Err(unknown);
        }
    } else if settings.has_diameter_variables
        && let Some(row) = among(DIAMETER_ROWS)
    {
        return Ok(row);
    }
    let is_missing = match settings.offset_memory {
        OffsetMemory::A => matches!(number, 2201..=2400 | 11_001..=13_999),
        OffsetMemory::B => matches!(number, 12_001..=13_999),
        OffsetMemory::C => false,
    };
    if is_missing {
        return Err(unknown);
    }
    let index = ROWS.partition_point(|row| row.to < number);
    let found = ROWS.get(index).filter(|row| row.from <= number);
    found.ok_or_else(|| not_simulated(number, NOT_SIMULATED).unwrap_or(unknown))
}

/// Raises the alarm of reading a number on any control with these settings.
pub(super) fn check_readable(number: u32, settings: &Settings) -> Result<(), Alarm> {
    match find(number, settings)?.read {
        ReadRule::Protected => Err(Alarm::ReadProtected { number }),
        ReadRule::Vacant | ReadRule::Value(_) => Ok(()),
    }
}

/// Raises the alarm of writing a number on any control with these settings.
pub(super) fn check_writable(number: u32, settings: &Settings) -> Result<(), Alarm> {
    find(number, settings)?.write.map(|_| ()).ok_or(Alarm::WriteProtected { number })
}

/// Returns the alarm of a variable: an axis that the control lacks has none.
fn variable_alarm(alarm: Alarm, number: u32) -> Alarm {
    match alarm {
        Alarm::AxisNumber { .. } => Alarm::NoSuchVariable { number: i64::from(number) },
        other => other,
    }
}

impl Registers {
    pub(super) fn read_system(&self, number: u32) -> Result<Value, Alarm> {
        let row = find(number, &self.data.settings)?;
        match row.read {
            ReadRule::Protected => Err(Alarm::ReadProtected { number }),
            ReadRule::Vacant => Ok(Value::Vacant),
            ReadRule::Value(read) => {
                let value = read(self, number - row.from);
                value.map(Value::Number).map_err(|alarm| variable_alarm(alarm, number))
            }
        }
    }

    pub(super) fn write_system(&mut self, number: u32, value: f64) -> Result<(), Alarm> {
        let row = find(number, &self.data.settings)?;
        let write = row.write.ok_or(Alarm::WriteProtected { number })?;
        write(self, number - row.from, value).map_err(|alarm| variable_alarm(alarm, number))
    }

    /// Reads `#n.m`: an item of a parameter of a Haas, or a bit of any other variable.
    pub(super) fn read_item(&self, number: u32, item: u32) -> Result<Value, Alarm> {
        if has_items(number) {
            return Ok(Value::Number(self.machine_value(number, Some(item))));
        }
        let bits = integer(self.read_variable(number)?.number())?;
        if item > 31 {
            return Err(Alarm::OutOfRange { function: format!("bit of #{number}"), value: f64::from(item) });
        }
        Ok(Value::Number((bits >> item & 1) as f64))
    }

    /// Returns a value of the machine: one that follows from the settings of the control, or is stated; an assumed one with a
    /// note for any other.
    pub(super) fn machine_value(&self, number: u32, item: Option<u32>) -> f64 {
        let known = if item.is_none() { self.haas_setting(number) } else { None };
        if let Some(value) = known {
            return value;
        }
        match self.data.settings.machine_values.get(number, item) {
            Some(MachineValue::Number(value)) => value,
            Some(MachineValue::Output { number, is_inverted }) => {
                let is_on = self.panel.stored(number).is_some_and(|value| value != 0.0);
                f64::from(u8::from(is_on != is_inverted))
            }
            None => {
                self.block_effects.record_note(Note::MachineValueUnknown { number, item });
                f64::from(assumed_machine_value(number, item))
            }
        }
    }

    /// Returns a setting of a Haas that the simulator has, by its variable #20000 + n. Mirror images by settings are off.
    fn haas_setting(&self, number: u32) -> Option<f64> {
        let settings = &self.data.settings;
        let on = |is_on: bool| f64::from(u8::from(is_on));
        Some(match number {
            20_009 => on(self.state.modal.unit == Unit::Metric),
            20_022 => self.data.to_program_unit(&self.state, None, settings.g73_retract),
            20_033 | 20_045..=20_048 | 20_080 | 20_250 => 0.0,
            20_040 => on(settings.has_diameter_offsets()),
            20_052 => self.data.to_program_unit(&self.state, None, settings.g83_above_r),
            20_162 => on(settings.uses_calculator_input),
            _ => return None,
        })
    }

    /// Returns an entry of a table of the machine: as the program has written it, as stated, or 0 with a note.
    fn stored_value(&self, number: u32) -> f64 {
        self.panel.stored(number).unwrap_or_else(|| self.machine_value(number, None))
    }

    fn store(&mut self, number: u32, value: f64) -> Result<(), Alarm> {
        self.panel.store(number, value);
        Ok(())
    }

    /// Returns #3012 as hhmmss: the time of the settings plus the duration of the run.
    fn time_of_day(&self) -> f64 {
        let start = self.data.settings.time;
        let seconds =
            f64::from(start / 10_000 * 3600 + start / 100 % 100 * 60 + start % 100) + self.clock.seconds();
        let seconds = seconds.rem_euclid(86_400.0) as u32;
        f64::from(seconds / 3600 * 10_000 + seconds / 60 % 60 * 100 + seconds % 60)
    }

    /// Returns #4001… and #4201… by their last three digits.
    fn modal_information(&self, item: u32) -> Result<f64, Alarm> {
        let codes = &self.state.modal_words;
        Ok(match item {
            102 => codes.b,
            107 => f64::from(codes.d),
            108 => 0.0,
            109 => codes.f,
            111 => f64::from(codes.h),
            113 => f64::from(codes.m),
            114 => f64::from(codes.n),
            115 => f64::from(codes.o),
            119 => codes.s,
            120 => f64::from(codes.t),
            130 => match self.state.modal.work {
                WorkSystem::Additional(p) => f64::from(p),
                WorkSystem::Standard(_) => 0.0,
            },
            14 if self.data.settings.codes == Dialect::HaasNgc
                && matches!(self.state.modal.work, WorkSystem::Additional(_)) =>
            {
                if !self.data.settings.undocumented.shows_g154 {
                    let what = "#4014 in G154 and G110 to G129 (with SHOWN-G154=1 it is 154)".into();
                    return Err(Alarm::NotSimulated { what });
                }
                154.0
            }
            101..=126 if self.data.settings.codes == Dialect::HaasNgc => {
                let what = format!("#{} (a word of the previous block)", 4000 + item);
                return Err(Alarm::NotSimulated { what });
            }
            // Group 23 is that of a Haas.
            23 if self.data.settings.codes != Dialect::HaasNgc => {
                return Err(Alarm::NoSuchVariable { number: i64::from(4000 + item) });
            }
            group => {
                let unknown = Alarm::NoSuchVariable { number: i64::from(4000 + group) };
                f64::from(self.state.modal.code(group).ok_or(unknown)?) / 10.0
            }
        })
    }

    /// Returns the end of the last block: as programmed, or after mirror, scaling and rotation.
    fn end_point(&self) -> Position {
        match self.data.settings.undocumented.shows_transformed {
            true => self.data.to_work(&self.state, &self.state.programmed_position),
            false => {
                if self.state.end_before_transform.is_some() {
                    self.block_effects.record_note(Note::EndPointBeforeTransform);
                }
                self.data.move_end(&self.state)
            }
        }
    }

    /// Returns a position of an axis in the active unit.
    fn position(&self, axis: u32, of: impl Fn(&Self, AxisIndex) -> f64) -> Result<f64, Alarm> {
        let axis = self.data.check_axis(axis)?;
        Ok(self.data.to_program_unit(&self.state, Some(axis), of(self, axis)))
    }

    /// Returns a machine position in the work coordinate system, tool length included.
    fn work_coordinate(&self, axis: AxisIndex, machine: f64) -> f64 {
        self.data.wrap_angle(axis, self.data.remove_residue(machine - self.data.zero(&self.state, axis)))
    }

    /// Sets the offset of G52.
    fn set_local(&mut self, axis: u32, value: f64) -> Result<(), Alarm> {
        let axis = self.data.check_axis(axis)?;
        self.state.g52_shift[axis] =
            self.data.check_offset_range(self.data.to_stored(&self.state, Some(axis), value))?;
        self.update_after_offset_change();
        Ok(())
    }

    fn work_offset(&self, system: usize, axis: u32) -> Result<f64, Alarm> {
        self.data.check_system(system)?;
        self.position(axis, |registers, axis| registers.data.offsets.work[system][axis])
    }

    fn set_work_offset(&mut self, system: usize, axis: u32, value: f64) -> Result<(), Alarm> {
        self.data.check_system(system)?;
        let axis = self.data.check_axis(axis)?;
        let value = self.data.check_offset_range(self.data.to_stored(&self.state, Some(axis), value))?;
        self.data.set_work_offset(system, axis, value);
        self.update_after_offset_change();
        Ok(())
    }

    /// Recomputes the programmed position after a change of the work zero.
    pub(super) fn update_after_offset_change(&mut self) {
        self.data.recompute_position(&mut self.state);
        self.update_is_plain();
    }

    fn tool_offset(&self, register: Register, index: u32) -> Result<f64, Alarm> {
        let value = self.data.offsets.tool(self.data.register(register), index + 1)?;
        Ok(self.data.to_program_unit(&self.state, None, value))
    }

    fn set_tool_offset(&mut self, register: Register, index: u32, value: f64) -> Result<(), Alarm> {
        let register = self.data.register(register);
        self.data.offsets.tool(register, index + 1)?;
        let value = self.data.check_offset_range(self.data.to_stored(&self.state, None, value))?;
        self.data.offsets.tools[register as usize][index as usize + 1] = value;
        Ok(())
    }

    /// Returns the tool centre in machine coordinates; a move that waits for the next one counts as executed, as if nothing
    /// followed.
    pub(super) fn tool_centre(&self, axis: AxisIndex) -> f64 {
        let offset = self.lookahead.machine_offset();
        if self.state.virtual_plane.is_some() {
            let at = Position(std::array::from_fn(|axis| self.state.machine_position[axis] + offset[axis]));
            return self.data.real_position(&self.state, &at)[axis];
        }
        self.state.machine_position[axis] + offset[axis]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_ascend_and_do_not_overlap() {
        for pair in ROWS.windows(2) {
            assert!(pair[0].to < pair[1].from, "#{}", pair[1].from);
        }
    }

    #[test]
    fn numbers_between_the_ranges_do_not_exist() {
        for number in [34, 99, 200, 499, 5401, 9_999_999] {
            assert!(find(number, &Settings::default()).is_err(), "#{number}");
        }
    }
}
