//! Meanings of system variables, by number, on a control.
use gcode_control::static_eval::VariableTable;
use gcode_lang::control::{OffsetVariables, Settings};
use gcode_lang::program::names;

/// Meaning of a range of variables; how the number of a variable in it counts.
struct SystemRow {
    from: u32,
    to: u32,
    text: &'static str,
    counts: Count,
}

/// What the place of a variable in its range counts.
#[derive(Clone, Copy)]
enum Count {
    /// Nothing: the range is one variable, or the text covers all of it.
    Nothing,
    /// Axes, from the first on.
    Axes,
    /// Tool offset numbers, from 1 on.
    Offsets,
    /// Bits, from 0 on.
    Bits,
    /// Twenty axes for each of several work coordinate systems.
    Systems(&'static [&'static str]),
    /// Twenty axes for each additional work coordinate system.
    AdditionalSystems,
    /// External offset and G54 to G59 of one axis.
    OfAxis,
    /// Modal information by its last three digits.
    Modal,
}

const fn row(from: u32, to: u32, text: &'static str, counts: Count) -> SystemRow {
    SystemRow { from, to, text, counts }
}

const STANDARD: &[&str] = &["external offset", "G54", "G55", "G56", "G57", "G58", "G59"];

/// Dynamic fixture offsets of a rotary table.
const FIXTURES: &[&str] =
    &["G54.2 P1", "G54.2 P2", "G54.2 P3", "G54.2 P4", "G54.2 P5", "G54.2 P6", "G54.2 P7", "G54.2 P8"];

/// Ranges of a Fanuc.
#[rustfmt::skip]
const FANUC: &[SystemRow] = &[
    row(1000, 1031, "input signal", Count::Bits),
    row(1032, 1035, "input signals, 32 in one number", Count::Nothing),
    row(1100, 1131, "output signal", Count::Bits),
    row(1132, 1135, "output signals, 32 in one number", Count::Nothing),
    row(2001, 2200, "wear of the tool length offset H", Count::Offsets),
    row(2201, 2400, "geometry of the tool length offset H", Count::Offsets),
    row(2500, 2506, "work offset of axis 1", Count::OfAxis),
    row(2600, 2606, "work offset of axis 2", Count::OfAxis),
    row(2700, 2706, "work offset of axis 3", Count::OfAxis),
    row(2800, 2806, "work offset of axis 4", Count::OfAxis),
    row(3000, 3000, "alarm: `#3000=n(TEXT)` stops the control", Count::Nothing),
    row(3001, 3001, "clock, milliseconds", Count::Nothing),
    row(3002, 3002, "clock, hours", Count::Nothing),
    row(3003, 3003, "single block and waiting for auxiliary codes: 1 disables the one, 2 the other", Count::Nothing),
    row(3004, 3004, "feed hold 1, feed override 2, exact stop 4: disabled by their sum", Count::Nothing),
    row(3005, 3005, "setting data; 4 is input in inch", Count::Nothing),
    row(3006, 3006, "message: `#3006=1(TEXT)` stops until cycle start", Count::Nothing),
    row(3007, 3007, "mirror image of the axes, by setting or signal, as bits", Count::Nothing),
    row(3008, 3008, "program restart: 1 during a restart", Count::Nothing),
    row(3011, 3011, "date, yyyymmdd", Count::Nothing),
    row(3012, 3012, "time, hhmmss", Count::Nothing),
    row(3100, 3100, "vacant", Count::Nothing),
    row(3101, 3101, "π", Count::Nothing),
    row(3102, 3102, "e", Count::Nothing),
    row(3901, 3901, "number of parts made", Count::Nothing),
    row(3902, 3902, "number of parts required", Count::Nothing),
    row(4001, 4130, "in the block before", Count::Modal),
    row(4201, 4330, "in the running block", Count::Modal),
    row(4401, 4530, "in the block that a macro interrupted", Count::Modal),
    row(5001, 5020, "end of the last block, work coordinates, tool length not counted", Count::Axes),
    row(5021, 5040, "position, machine coordinates", Count::Axes),
    row(5041, 5060, "position, work coordinates, tool length counted", Count::Axes),
    row(5061, 5080, "position of the skip signal (G31), work coordinates", Count::Axes),
    row(5081, 5100, "tool length offset in force", Count::Axes),
    row(5101, 5120, "servo position error", Count::Axes),
    row(5121, 5140, "handwheel shift", Count::Axes),
    row(5181, 5200, "distance to go", Count::Axes),
    row(5201, 5340, "", Count::Systems(STANDARD)),
    row(5521, 5680, "", Count::Systems(FIXTURES)),
    row(7001, 7960, "", Count::AdditionalSystems),
    row(8000, 8999, "tool management", Count::Nothing),
    row(10_001, 10_999, "wear of the tool length offset H", Count::Offsets),
    row(11_001, 11_999, "geometry of the tool length offset H", Count::Offsets),
    row(12_001, 12_999, "wear of the cutter radius offset D", Count::Offsets),
    row(13_001, 13_999, "geometry of the cutter radius offset D", Count::Offsets),
    row(14_001, 20_000, "", Count::AdditionalSystems),
];

/// Ranges that replace those above with D15 6004#5.
const DIAMETERS: &[SystemRow] = &[
    row(2401, 2600, "wear of the cutter radius offset D", Count::Offsets),
    row(2601, 2800, "geometry of the cutter radius offset D", Count::Offsets),
];

/// Ranges that a Haas has in place of those above.
#[rustfmt::skip]
const HAAS: &[SystemRow] = &[
    row(2001, 2200, "geometry of the tool length offset H", Count::Offsets),
    row(2201, 2400, "wear of the tool length offset H", Count::Offsets),
    row(2401, 2600, "geometry of the cutter offset D", Count::Offsets),
    row(2601, 2800, "wear of the cutter offset D", Count::Offsets),
    row(3020, 3020, "power-on timer", Count::Nothing),
    row(3021, 3021, "cycle start timer", Count::Nothing),
    row(3022, 3022, "feed timer", Count::Nothing),
    row(3026, 3026, "tool in the spindle", Count::Nothing),
    row(3027, 3027, "spindle speed", Count::Nothing),
    row(3030, 3030, "single block", Count::Nothing),
    row(3032, 3032, "block delete", Count::Nothing),
    row(3033, 3033, "optional stop", Count::Nothing),
    row(5201, 5220, "offset of G52", Count::Axes),
    row(5401, 5500, "feed time of a tool, seconds", Count::Nothing),
    row(5501, 5600, "total time of a tool, seconds", Count::Nothing),
    row(5601, 5699, "tool life limit", Count::Nothing),
    row(5701, 5800, "tool life counter", Count::Nothing),
    row(12_000, 12_255, "output", Count::Nothing),
    row(11_000, 11_255, "input", Count::Nothing),
    row(20_000, 29_999, "setting; #20000 plus its number", Count::Nothing),
    row(30_000, 39_999, "parameter; #30000 plus its number", Count::Nothing),
];

/// Modal information by the last three digits of the number.
#[rustfmt::skip]
const MODAL: &[(u32, &str)] = &[
    (1, "G code of group 01, motion"), (2, "G code of group 02, plane"), (3, "G code of group 03, absolute or incremental"),
    (4, "G code of group 04, stroke check"), (5, "G code of group 05, feed mode"), (6, "G code of group 06, inch or mm"),
    (7, "G code of group 07, cutter compensation"), (8, "G code of group 08, tool length compensation"),
    (9, "G code of group 09, canned cycle"), (10, "G code of group 10, return level"), (11, "G code of group 11, scaling"),
    (12, "G code of group 12, macro modal call"), (13, "G code of group 13, surface speed control"),
    (14, "G code of group 14, work coordinate system"), (15, "G code of group 15, cutting mode"),
    (16, "G code of group 16, rotation"), (17, "G code of group 17, polar coordinates"),
    (22, "G code of group 22, mirror image"), (102, "B code"), (107, "D code"), (108, "E code"), (109, "F code"),
    (111, "H code"), (113, "M code"), (114, "sequence number"), (115, "program number"), (119, "S code"), (120, "T code"),
    (130, "P of the additional work coordinate system"),
];

/// Returns the meaning of a system variable on a control; `None` for a number without one.
pub(crate) fn system_text(number: u32, settings: &Settings) -> Option<String> {
    let among = |rows: &'static [SystemRow]| rows.iter().find(|row| (row.from..=row.to).contains(&number));
    let is_haas = settings.offset_variables == OffsetVariables::Haas;
    let own = if is_haas { among(HAAS) } else { None };
    let diameters = if settings.has_diameter_variables && !is_haas { among(DIAMETERS) } else { None };
    let row = own.or(diameters).or_else(|| among(FANUC))?;
    let index = number - row.from;
    let text = match row.counts {
        Count::Nothing => row.text.to_owned(),
        Count::Axes => format!("{}, axis {}", row.text, axis(index, settings)),
        Count::Offsets => format!("{}{}", exchanged(row.text, settings), index + 1),
        Count::Bits => format!("{} {index}", row.text),
        Count::OfAxis => format!("{}: {}", row.text, STANDARD.get(index as usize)?),
        Count::Systems(systems) => {
            format!("{}, axis {}", offset_of(systems.get(index as usize / 20)?), axis(index % 20, settings))
        }
        Count::AdditionalSystems => {
            format!("offset of G54.1 P{}, axis {}", index / 20 + 1, axis(index % 20, settings))
        }
        Count::Modal => {
            let item = index + 1;
            let (_, what) = MODAL.iter().find(|(other, _)| *other == item)?;
            format!("{what}, {}", row.text)
        }
    };
    Some(text)
}

fn offset_of(system: &str) -> String {
    if system.starts_with('G') { format!("offset of {system}") } else { system.to_owned() }
}

/// Returns the text of an offset with V15 6000#3, which exchanges geometry and wear.
fn exchanged(text: &str, settings: &Settings) -> String {
    match (settings.series_15_offsets, text.split_once(' ')) {
        (true, Some(("wear", rest))) => format!("geometry {rest}"),
        (true, Some(("geometry", rest))) => format!("wear {rest}"),
        _ => text.to_owned(),
    }
}

/// Returns the number of an axis with its letter, `3 (Z)`.
fn axis(index: u32, settings: &Settings) -> String {
    let letter =
        (b'A'..=b'Z').find(|letter| settings.axes.find(*letter).is_some_and(|axis| axis as u32 == index));
    let letter = letter.map_or_else(String::new, |letter| format!(" ({})", char::from(letter)));
    format!("{}{letter}", index + 1)
}

/// Returns how a program may use a system variable.
pub(crate) fn access_text(number: u32, settings: &Settings) -> &'static str {
    let table = VariableTable::new(settings);
    match (table.read(number).is_ok(), table.write(number).is_ok()) {
        (true, true) => "read and write",
        (true, false) => "read only",
        (false, true) => "write only",
        (false, false) => "this control does not have it, or the simulator lacks it",
    }
}

/// Returns the name of a system variable, `#_ABSMT[1]`.
pub(crate) fn system_name(number: u32) -> Option<String> {
    let named = names::all().find_map(|row| match row.suffix {
        None => (row.number == number).then(|| format!("#{}", row.name)),
        Some((from, to)) => {
            let suffix = from + number.checked_sub(row.number)?;
            (suffix <= to).then(|| format!("#{}[{suffix}]", row.name))
        }
    });
    named.or_else(|| {
        let index = number.checked_sub(14_001).filter(|index| *index < 6000)?;
        Some(format!("#_WZP{}[{}]", index / 20 + 1, index % 20 + 1))
    })
}

/// System variables that a completion offers, with their names.
pub(crate) fn common_system_variables() -> impl Iterator<Item = u32> {
    let single = [3000, 3001, 3002, 3003, 3004, 3006, 3011, 3012, 3901, 3902];
    let modal = [4001, 4002, 4003, 4006, 4007, 4008, 4009, 4014, 4109, 4111, 4114, 4119, 4120];
    let axes = [5001, 5021, 5041, 5061, 5081, 5221, 5241].into_iter().flat_map(|first| first..first + 3);
    let tools = [2001, 2201, 10_001, 11_001, 12_001, 13_001];
    single.into_iter().chain(modal).chain(axes).chain(tools)
}

#[cfg(test)]
mod tests {
    use super::*;
    use gcode_lang::control::Dialect;

    #[test]
    fn numbers_have_their_meaning() {
        let settings = Settings::default();
        let text = |number| system_text(number, &settings).unwrap_or_default();
        assert_eq!(text(5023), "position, machine coordinates, axis 3 (Z)");
        assert_eq!(text(5222), "offset of G54, axis 2 (Y)");
        assert_eq!(text(5201), "external offset, axis 1 (X)");
        assert_eq!(text(5542), "offset of G54.2 P2, axis 2 (Y)");
        assert_eq!(text(7021), "offset of G54.1 P2, axis 1 (X)");
        assert_eq!(text(11_007), "geometry of the tool length offset H7");
        assert_eq!(text(4314), "sequence number, in the running block");
        assert_eq!(text(4014), "G code of group 14, work coordinate system, in the block before");
        assert_eq!(text(2501), "work offset of axis 1: G54");
        assert_eq!(text(499), "");
        assert_eq!((access_text(5021, &settings), access_text(3000, &settings)), ("read only", "write only"));
        let mut haas = Settings::default();
        haas.apply_dialect(Dialect::HaasNgc);
        assert_eq!(system_text(2003, &haas).as_deref(), Some("geometry of the tool length offset H3"));
    }

    #[test]
    fn names_are_those_of_the_reader() {
        assert_eq!(system_name(5023).as_deref(), Some("#_ABSMT[3]"));
        assert_eq!(system_name(3000).as_deref(), Some("#_ALM"));
        assert_eq!(system_name(14_022).as_deref(), Some("#_WZP2[2]"));
        assert_eq!(system_name(100), None);
    }

    /// What the control has is explained, and what is offered exists.
    #[test]
    fn every_variable_of_the_control_has_a_meaning() {
        let settings = Settings::default();
        let table = VariableTable::new(&settings);
        for number in (1000..20_000).filter(|number| table.read(*number).is_ok()) {
            let is_modal = matches!(number, 4001..=4130 | 4201..=4330);
            assert!(is_modal || system_text(number, &settings).is_some(), "#{number}");
        }
        for number in common_system_variables() {
            assert!(table.read(number).is_ok() || table.write(number).is_ok(), "#{number}");
            assert!(system_text(number, &settings).is_some(), "#{number}");
        }
    }
}
