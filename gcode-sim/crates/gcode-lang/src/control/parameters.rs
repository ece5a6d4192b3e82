//! Parameters by their numbers: what PRM reads and G10 L52 writes of the settings.
use super::{Increment, Settings};
use crate::motion::AxisIndex;

/// Why a parameter can't be read or written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParameterError {
    /// Nothing here depends on it, or nothing is known of it.
    Unknown,
    /// It has one value for each axis.
    AxisWanted,
    /// It has one value for all axes.
    NoAxis,
    /// It is a byte of which not every bit is known.
    BitWanted,
    /// It is a number.
    NoBit,
    /// It can't have this value.
    Value,
    /// Here it can't change in a run.
    Fixed,
}

/// Which parameter: a bit of a byte or all of a number, of an axis or of all.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct ParameterId {
    pub number: u16,
    pub bit: Option<u8>,
    pub axis: Option<AxisIndex>,
}

type SetAxis = fn(&mut Settings, AxisIndex, f64) -> Option<()>;

enum Access {
    /// A setting by its key.
    Key(&'static str, fn(&Settings) -> f64),
    /// A value for each axis, and how it is set; without that, it is fixed.
    Axes(fn(&Settings, AxisIndex) -> f64, Option<SetAxis>),
    Fixed(fn(&Settings) -> f64),
}

struct ParameterRow {
    number: u16,
    bit: Option<u8>,
    /// A length in mm, which a point has to say.
    length: bool,
    access: Access,
}

const fn bit(number: u16, bit: u8, access: Access) -> ParameterRow {
    ParameterRow { number, bit: Some(bit), length: false, access }
}

const fn length(number: u16, access: Access) -> ParameterRow {
    ParameterRow { number, bit: None, length: true, access }
}

const fn number(number: u16, access: Access) -> ParameterRow {
    ParameterRow { number, bit: None, length: false, access }
}

/// What a stroke limit reads that isn't there, mm.
const NO_END: f64 = 99_999.999;

/// What the parameters are here, by number and bit. Those of calls by codes are in [`super::CodeCalls`].
#[rustfmt::skip]
const ROWS: &[ParameterRow] = &[
    bit(1008, 0, Access::Axes(|s, axis| f64::from(s.roll_over[axis]), Some(set_roll_over))),
    bit(1013, 0, Access::Axes(|s, _| f64::from(s.increment == Increment::IsA), None)),
    bit(1013, 1, Access::Axes(|s, _| f64::from(s.increment == Increment::IsC), None)),
    number(1020, Access::Axes(|s, axis| f64::from(s.axes.letter(axis) as u8), None)),
    length(1240, Access::Axes(|_, _| 0.0, None)),
    length(1241, Access::Axes(|s, axis| s.references[0][axis], Some(|s, axis, v| { s.references[0][axis] = v; Some(()) }))),
    length(1242, Access::Axes(|s, axis| s.references[1][axis], Some(|s, axis, v| { s.references[1][axis] = v; Some(()) }))),
    length(1243, Access::Axes(|s, axis| s.references[2][axis], Some(|s, axis, v| { s.references[2][axis] = v; Some(()) }))),
    length(1320, Access::Axes(|s, axis| s.stroke.and_then(|l| l.max[axis]).unwrap_or(NO_END), Some(|s, axis, v| { s.stroke.get_or_insert_default().max[axis] = Some(v); Some(()) }))),
    length(1321, Access::Axes(|s, axis| s.stroke.and_then(|l| l.min[axis]).unwrap_or(-NO_END), Some(|s, axis, v| { s.stroke.get_or_insert_default().min[axis] = Some(v); Some(()) }))),
    bit(1401, 1, Access::Fixed(|_| 1.0)),
    number(1420, Access::Axes(|s, axis| if s.axes.is_rotary(axis) { s.rapid_rotary } else { s.rapid.0 }, None)),
    bit(3401, 0, Access::Key("DPI", |s| f64::from(s.calculator_input))),
    bit(3403, 6, Access::Key("AD2", |s| f64::from(s.no_repeated_address))),
    bit(3404, 7, Access::Key("M3B", |s| f64::from(s.three_m_codes))),
    length(3410, Access::Key("3410", |s| s.arc_tolerance)),
    bit(5001, 4, Access::Key("EVR", |s| f64::from(s.new_radius_at_once))),
    bit(5003, 0, Access::Key("SUP", |s| f64::from(s.start_up_b))),
    bit(5004, 2, Access::Key("ODI", |s| f64::from(s.offsets_are_diameters))),
    bit(5101, 0, Access::Key("FXY", |s| f64::from(s.drills_by_plane))),
    length(5114, Access::Key("5114", |s| s.g73_retract)),
    length(5115, Access::Key("5115", |s| s.g83_clearance)),
    bit(5400, 7, Access::Key("SCR", |s| f64::from(s.coarse_scaling))),
    length(5440, Access::Axes(|s, axis| s.overrun[axis], Some(|s, axis, v| { s.overrun[axis] = v; Some(()) }))),
    bit(6000, 3, Access::Key("V15", |s| f64::from(s.series_15_offsets))),
    bit(6001, 1, Access::Key("PRT", |s| f64::from(s.print_without_blanks))),
    bit(6001, 5, Access::Key("TCS", |s| f64::from(s.code_calls.by_t))),
    bit(6004, 0, Access::Key("NAT", |s| f64::from(s.signed_angles))),
    bit(6004, 1, Access::Key("MFZ", |s| f64::from(s.zero_residues))),
    bit(6007, 3, Access::Key("MGE", |s| f64::from(s.code_calls.every_block))),
    bit(6007, 4, Access::Key("CVA", |s| f64::from(s.converts_arguments))),
    bit(6008, 1, Access::Key("MCA", |s| f64::from(s.macro_alarm_base == 0))),
    bit(6008, 6, Access::Key("GMP", |s| f64::from(s.code_calls.inside_others))),
    bit(6008, 7, Access::Key("IJK", |s| f64::from(s.plain_ijk))),
    number(19625, Access::Key("19625", |s| s.blocks_read as f64)),
];

/// Parameters that nothing a run shows depends on: what is written to them can be read again. Only those that are
/// known to be so; any other may be one that moves the machine elsewhere.
#[rustfmt::skip]
const WITHOUT_EFFECT: &[u16] = &[
    // Input and output devices: the channel, and of each channel its bits, its device and its baud rate.
    20, 101, 102, 103, 111, 112, 113, 121, 122, 123,
    // What the screens show.
    3105, 3106, 3107, 3108, 3111, 3112, 3281,
    // Protection of programs and offsets against the keyboard, their password, sequence numbers while editing.
    3202, 3210, 3211, 3216, 3290,
];

/// Whether a parameter changes nothing that a run shows.
pub fn is_without_effect(number: u16) -> bool {
    WITHOUT_EFFECT.contains(&number)
}

fn set_roll_over(settings: &mut Settings, axis: AxisIndex, value: f64) -> Option<()> {
    if !settings.axes.is_rotary(axis) {
        return None;
    }
    settings.roll_over[axis] = value != 0.0;
    Some(())
}

fn row(place: ParameterId) -> Result<&'static ParameterRow, ParameterError> {
    let mut of_number = ROWS.iter().filter(|row| row.number == place.number).peekable();
    let first = of_number.peek().ok_or(ParameterError::Unknown)?;
    match (place.bit, first.bit) {
        (None, Some(_)) => return Err(ParameterError::BitWanted),
        (Some(_), None) => return Err(ParameterError::NoBit),
        _ => {}
    }
    let row = of_number.find(|row| row.bit == place.bit).ok_or(ParameterError::Unknown)?;
    match (&row.access, place.axis) {
        (Access::Axes(..), None) => Err(ParameterError::AxisWanted),
        (Access::Key(..) | Access::Fixed(_), Some(_)) => Err(ParameterError::NoAxis),
        _ => Ok(row),
    }
}

impl Settings {
    /// The value of a parameter; lengths in mm.
    pub fn parameter(&self, place: ParameterId) -> Result<f64, ParameterError> {
        if let Some(code) = self.code_calls.parameter(place.number) {
            return code_call(place).map(|()| code as f64);
        }
        let row = row(place)?;
        Ok(match (&row.access, place.axis) {
            (Access::Axes(read, _), Some(axis)) => read(self, axis),
            (Access::Key(_, read) | Access::Fixed(read), _) => read(self),
            (Access::Axes(..), None) => return Err(ParameterError::AxisWanted),
        })
    }

    /// Sets a parameter; a length in mm.
    pub fn set_parameter(&mut self, place: ParameterId, value: f64) -> Result<(), ParameterError> {
        if place.bit.is_some() && value != 0.0 && value != 1.0 {
            return Err(ParameterError::Value);
        }
        if self.code_calls.parameter(place.number).is_some() {
            code_call(place)?;
            let whole = value.fract() == 0.0 && value.abs() < 1e9;
            let set = whole.then(|| self.code_calls.set_parameter(place.number, value as i64)).flatten();
            return set.ok_or(ParameterError::Value);
        }
        let set = match (&row(place)?.access, place.axis) {
            (Access::Key(key, _), _) => self.set(key, &value.to_string()).ok(),
            (Access::Axes(_, Some(set)), Some(axis)) => set(self, axis, value),
            (Access::Axes(..) | Access::Fixed(_), _) => return Err(ParameterError::Fixed),
        };
        set.ok_or(ParameterError::Value)
    }

    /// Whether a parameter is a length, of which a point must say the unit.
    pub fn is_length_parameter(place: ParameterId) -> bool {
        row(place).is_ok_and(|row| row.length)
    }
}

/// The parameters of calls by codes are numbers for all axes.
fn code_call(place: ParameterId) -> Result<(), ParameterError> {
    match (place.bit, place.axis) {
        (None, None) => Ok(()),
        (Some(_), _) => Err(ParameterError::NoBit),
        (None, Some(_)) => Err(ParameterError::NoAxis),
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
    fn each_row_reads_what_its_setting_says() {
        for row in ROWS {
            let Access::Key(key, read) = row.access else { continue };
            let values = if key == "19625" { ["3", "8"] } else { ["0", "1"] };
            for value in values {
                let mut settings = Settings::default();
                settings.set(key, value).unwrap();
                assert_eq!(read(&settings).to_string(), value, "{key}");
            }
        }
    }
}
