//! Parameters by number: values that PRM reads and G10 L52 writes.
use super::{Increment, Settings};
use crate::motion::AxisIndex;

/// Reason why a parameter cannot be read or written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParameterError {
    /// No setting depends on the parameter, or nothing is known about it.
    Unknown,
    /// The parameter has one value per axis.
    MissingAxis,
    /// The parameter has one value for all axes.
    UnexpectedAxis,
    /// The parameter is a byte of which not all bits are known.
    MissingBit,
    /// The parameter is a number without bits.
    UnexpectedBit,
    /// The value is out of range.
    InvalidValue,
    /// The parameter cannot change during a run.
    ReadOnly,
}

/// Parameter, bit and axis of one value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct ParameterId {
    /// Parameter number.
    pub number: u16,
    /// Bit number; `None` for the whole parameter.
    pub bit: Option<u8>,
    /// Axis; `None` for a parameter that is the same for all axes.
    pub axis: Option<AxisIndex>,
}

type SetAxis = fn(&mut Settings, AxisIndex, f64) -> Option<()>;

enum ParameterAccess {
    /// Value of a named setting.
    Key(&'static str, fn(&Settings) -> f64),
    /// Value per axis and its setter; `None` makes it read-only.
    PerAxis(fn(&Settings, AxisIndex) -> f64, Option<SetAxis>),
    Fixed(fn(&Settings) -> f64),
}

struct ParameterRow {
    number: u16,
    bit: Option<u8>,
    /// True for a length in mm, which must be written with a decimal point.
    is_length: bool,
    access: ParameterAccess,
}

const fn bit_row(number: u16, bit: u8, access: ParameterAccess) -> ParameterRow {
    ParameterRow { number, bit: Some(bit), is_length: false, access }
}

const fn length_row(number: u16, access: ParameterAccess) -> ParameterRow {
    ParameterRow { number, bit: None, is_length: true, access }
}

const fn number_row(number: u16, access: ParameterAccess) -> ParameterRow {
    ParameterRow { number, bit: None, is_length: false, access }
}

/// Value of a missing stroke limit, mm.
const NO_STROKE_LIMIT: f64 = 99_999.999;

/// Parameters by number and bit. Those of calls by codes are in [`super::CodeCalls`].
#[rustfmt::skip]
const ROWS: &[ParameterRow] = &[
    bit_row(1008, 0, ParameterAccess::PerAxis(|s, axis| f64::from(s.rolls_over[axis]), Some(set_roll_over))),
    bit_row(1013, 0, ParameterAccess::PerAxis(|s, _| f64::from(s.increment == Increment::IsA), None)),
    bit_row(1013, 1, ParameterAccess::PerAxis(|s, _| f64::from(s.increment == Increment::IsC), None)),
    number_row(1020, ParameterAccess::PerAxis(|s, axis| f64::from(s.axes.letter(axis) as u8), None)),
    length_row(1240, ParameterAccess::PerAxis(|_, _| 0.0, None)),
    length_row(1241, ParameterAccess::PerAxis(|s, axis| s.reference_positions[0][axis], Some(|s, axis, v| { s.reference_positions[0][axis] = v; Some(()) }))),
    length_row(1242, ParameterAccess::PerAxis(|s, axis| s.reference_positions[1][axis], Some(|s, axis, v| { s.reference_positions[1][axis] = v; Some(()) }))),
    length_row(1243, ParameterAccess::PerAxis(|s, axis| s.reference_positions[2][axis], Some(|s, axis, v| { s.reference_positions[2][axis] = v; Some(()) }))),
    length_row(1320, ParameterAccess::PerAxis(|s, axis| s.stroke_limits.and_then(|l| l.max[axis]).unwrap_or(NO_STROKE_LIMIT), Some(|s, axis, v| { s.stroke_limits.get_or_insert_default().max[axis] = Some(v); Some(()) }))),
    length_row(1321, ParameterAccess::PerAxis(|s, axis| s.stroke_limits.and_then(|l| l.min[axis]).unwrap_or(-NO_STROKE_LIMIT), Some(|s, axis, v| { s.stroke_limits.get_or_insert_default().min[axis] = Some(v); Some(()) }))),
    bit_row(1401, 1, ParameterAccess::Fixed(|s| f64::from(s.rapids_are_straight))),
    number_row(1420, ParameterAccess::PerAxis(|s, axis| if s.axes.is_rotary(axis) { s.rapid_rotary } else { s.rapid.0 }, None)),
    bit_row(3401, 0, ParameterAccess::Key("DPI", |s| f64::from(s.uses_calculator_input))),
    bit_row(3403, 5, ParameterAccess::Key("CIR", |s| f64::from(s.alarms_without_centre))),
    bit_row(3403, 6, ParameterAccess::Key("AD2", |s| f64::from(s.alarms_on_repeated_address))),
    bit_row(3404, 7, ParameterAccess::Key("M3B", |s| f64::from(s.allows_three_m_codes))),
    length_row(3410, ParameterAccess::Key("3410", |s| s.arc_tolerance)),
    bit_row(5001, 2, ParameterAccess::Key("OFH", |s| f64::from(s.tool_offset_is_h))),
    bit_row(5001, 4, ParameterAccess::Key("EVR", |s| f64::from(s.applies_radius_at_once))),
    bit_row(5001, 6, ParameterAccess::Key("EVO", |s| f64::from(s.restores_length == Some(true)))),
    bit_row(5003, 0, ParameterAccess::Key("SUP", |s| f64::from(s.starts_up_by_type_b))),
    bit_row(5004, 2, ParameterAccess::Key("ODI", |s| f64::from(s.has_diameter_offsets()))),
    bit_row(5101, 0, ParameterAccess::Key("FXY", |s| f64::from(s.drills_by_plane))),
    length_row(5114, ParameterAccess::Key("5114", |s| s.g73_retract)),
    length_row(5115, ParameterAccess::Key("5115", |s| s.g83_clearance)),
    bit_row(5200, 0, ParameterAccess::Key("G84-RIGID", |s| f64::from(s.taps_rigidly))),
    bit_row(5400, 7, ParameterAccess::Key("SCR", |s| f64::from(s.has_coarse_scaling))),
    number_row(5411, ParameterAccess::Key("5411", |s| s.scale_factor)),
    length_row(5440, ParameterAccess::PerAxis(|s, axis| s.single_direction_overrun[axis], Some(|s, axis, v| { s.single_direction_overrun[axis] = v; Some(()) }))),
    number_row(5460, ParameterAccess::Key("5460", |s| s.polar_axes[0] as f64)),
    number_row(5461, ParameterAccess::Key("5461", |s| s.polar_axes[1] as f64)),
    bit_row(6000, 3, ParameterAccess::Key("V15", |s| f64::from(s.series_15_offsets))),
    bit_row(6001, 1, ParameterAccess::Key("PRT", |s| f64::from(s.omits_print_blanks))),
    bit_row(6001, 5, ParameterAccess::Key("TCS", |s| f64::from(s.code_calls.t_calls_program))),
    bit_row(6004, 0, ParameterAccess::Key("NAT", |s| f64::from(s.returns_signed_angles))),
    bit_row(6004, 1, ParameterAccess::Key("MFZ", |s| f64::from(s.zeroes_residues))),
    bit_row(6004, 5, ParameterAccess::Key("D15", |s| f64::from(s.has_diameter_variables))),
    bit_row(6007, 3, ParameterAccess::Key("MGE", |s| f64::from(s.code_calls.modal_is_every_block))),
    bit_row(6007, 4, ParameterAccess::Key("CVA", |s| f64::from(s.converts_arguments))),
    bit_row(6008, 1, ParameterAccess::Key("MCA", |s| f64::from(s.macro_alarm_base == 0))),
    bit_row(6008, 6, ParameterAccess::Key("GMP", |s| f64::from(s.code_calls.allows_nested_calls))),
    bit_row(6008, 7, ParameterAccess::Key("IJK", |s| f64::from(s.reads_ijk_plainly))),
    number_row(12321, ParameterAccess::Key("12321", |s| s.vertical_axis as f64)),
    number_row(19625, ParameterAccess::Key("19625", |s| s.lookahead_blocks as f64)),
    bit_row(19696, 5, ParameterAccess::Key("WKP", |s| f64::from(s.tip_in_work_system))),
];

/// Parameters that can be written and read back but are known to have no effect on a run.
#[rustfmt::skip]
const WITHOUT_EFFECT: &[u16] = &[
    // Input and output devices: the channel, and for each channel its bits, device and baud rate.
    20, 101, 102, 103, 111, 112, 113, 121, 122, 123,
    // Contents of the screens.
    3105, 3106, 3107, 3108, 3111, 3112, 3281,
    // Protection of programs and offsets against editing, their password, sequence numbers while editing.
    3202, 3210, 3211, 3216, 3290,
];

/// Returns true if a parameter has no effect on a run.
pub fn is_without_effect(number: u16) -> bool {
    WITHOUT_EFFECT.contains(&number)
}

/// Ranges of parameters of which any may change where a program moves: units, axes, coordinates and limits, servo, the reading
/// of programs, compensation, cycles and coordinate systems, macros, axis control, five axes.
const OF_MOTION: &[std::ops::RangeInclusive<u16>] = &[
    0..=19,
    1000..=1399,
    1800..=1899,
    3400..=3499,
    5000..=6099,
    7000..=8299,
    11_200..=12_399,
    19_600..=19_799,
];

/// Returns true if an unknown parameter may change where a program moves.
pub fn changes_motion(number: u16) -> bool {
    OF_MOTION.iter().any(|range| range.contains(&number))
}

fn set_roll_over(settings: &mut Settings, axis: AxisIndex, value: f64) -> Option<()> {
    if !settings.axes.is_rotary(axis) {
        return None;
    }
    settings.rolls_over[axis] = value != 0.0;
    Some(())
}

fn find_row(id: ParameterId) -> Result<&'static ParameterRow, ParameterError> {
    let mut rows = ROWS.iter().filter(|row| row.number == id.number).peekable();
    let first = rows.peek().ok_or(ParameterError::Unknown)?;
    match (id.bit, first.bit) {
        (None, Some(_)) => return Err(ParameterError::MissingBit),
        (Some(_), None) => return Err(ParameterError::UnexpectedBit),
        _ => {}
    }
    let row = rows.find(|row| row.bit == id.bit).ok_or(ParameterError::Unknown)?;
    match (&row.access, id.axis) {
        (ParameterAccess::PerAxis(..), None) => Err(ParameterError::MissingAxis),
        (ParameterAccess::Key(..) | ParameterAccess::Fixed(_), Some(_)) => {
            Err(ParameterError::UnexpectedAxis)
        }
        _ => Ok(row),
    }
}

impl Settings {
    /// Returns the value of a parameter; lengths in mm.
    pub fn parameter(&self, id: ParameterId) -> Result<f64, ParameterError> {
        if let Some(code) = self.code_calls.parameter(id.number) {
            return check_code_call_id(id).map(|()| code as f64);
        }
        let row = find_row(id)?;
        Ok(match (&row.access, id.axis) {
            (ParameterAccess::PerAxis(read, _), Some(axis)) => read(self, axis),
            (ParameterAccess::Key(_, read) | ParameterAccess::Fixed(read), _) => read(self),
            (ParameterAccess::PerAxis(..), None) => return Err(ParameterError::MissingAxis),
        })
    }

    /// Sets a parameter; lengths in mm.
    pub fn set_parameter(&mut self, id: ParameterId, value: f64) -> Result<(), ParameterError> {
        if id.bit.is_some() && value != 0.0 && value != 1.0 {
            return Err(ParameterError::InvalidValue);
        }
        if self.code_calls.parameter(id.number).is_some() {
            check_code_call_id(id)?;
            let whole = value.fract() == 0.0 && value.abs() < 1e9;
            let set = whole.then(|| self.code_calls.set_parameter(id.number, value as i64)).flatten();
            return set.ok_or(ParameterError::InvalidValue);
        }
        let set = match (&find_row(id)?.access, id.axis) {
            (ParameterAccess::Key(key, _), _) => self.set(key, &value.to_string()).ok(),
            (ParameterAccess::PerAxis(_, Some(set)), Some(axis)) => set(self, axis, value),
            (ParameterAccess::PerAxis(..) | ParameterAccess::Fixed(_), _) => {
                return Err(ParameterError::ReadOnly);
            }
        };
        set.ok_or(ParameterError::InvalidValue)
    }

    /// Returns true for a length, whose unit a decimal point must decide.
    pub fn is_length_parameter(id: ParameterId) -> bool {
        find_row(id).is_ok_and(|row| row.is_length)
    }
}

/// Rejects bit and axis: parameters of calls by codes are numbers for all axes.
fn check_code_call_id(id: ParameterId) -> Result<(), ParameterError> {
    match (id.bit, id.axis) {
        (None, None) => Ok(()),
        (Some(_), _) => Err(ParameterError::UnexpectedBit),
        (None, Some(_)) => Err(ParameterError::UnexpectedAxis),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_setting_that_names_a_parameter_is_one() {
        for setting in crate::control::ROWS {
            let text =
                if setting.key.bytes().all(|b| b.is_ascii_digit()) { setting.key } else { setting.meaning };
            let digits: String = text.chars().take_while(char::is_ascii_digit).collect();
            let behind = &text[digits.len()..];
            let Ok(number) = digits.parse::<u16>() else { continue };
            let bit = behind.strip_prefix('#').and_then(|rest| rest.get(..1)?.parse().ok());
            let known = ROWS.iter().any(|row| row.number == number && (bit.is_none() || row.bit == bit));
            assert!(known, "{}: {}", setting.key, setting.meaning);
        }
    }

    #[test]
    fn each_row_reads_the_value_of_its_setting() {
        for row in ROWS {
            let ParameterAccess::Key(key, read) = row.access else { continue };
            let values = if key == "19625" { ["3", "8"] } else { ["0", "1"] };
            for value in values {
                let mut settings = Settings::default();
                settings.set(key, value).unwrap();
                assert_eq!(read(&settings).to_string(), value, "{key}");
            }
        }
    }
}
