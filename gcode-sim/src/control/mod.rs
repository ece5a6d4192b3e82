//! The settings of a control that a program's meaning depends on, in one struct: never an `if` in the reader.
mod code_calls;
mod dialect;
mod parameters;
mod table;

use crate::motion::{Axes, MAX_AXES, Position};
use crate::units::{MmPerMin, nearest};

pub use code_calls::{AddressCall, Called, CodeCallKind, CodeCalls, FAMILIES, RANGES};
pub use dialect::{DIALECTS, DialectRow};
pub use parameters::{ParameterError, ParameterPlace, is_without_effect};
pub use table::{ROWS, Row, SettingError};

/// The least input increment (parameter 1013).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Increment {
    /// 0.01 mm and degrees.
    IsA,
    /// 0.001 mm and degrees.
    #[default]
    IsB,
    /// 0.0001 mm and degrees.
    IsC,
}

impl Increment {
    pub const ALL: [(&'static str, Self); 3] =
        [("IS-A", Self::IsA), ("IS-B", Self::IsB), ("IS-C", Self::IsC)];

    /// How many increments make a millimetre or a degree.
    pub fn per_unit(self) -> f64 {
        match self {
            Self::IsA => 100.0,
            Self::IsB => 1_000.0,
            Self::IsC => 10_000.0,
        }
    }

    /// The multiple of the increment nearest to `value`, half away from zero.
    pub fn round(self, value: f64) -> f64 {
        nearest(value, self.per_unit()) / self.per_unit()
    }

    /// The increment itself in mm or degrees.
    pub fn size(self) -> f64 {
        1.0 / self.per_unit()
    }
}

/// Which family of controls; its limits and differences are data.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Dialect {
    #[default]
    Fanuc31i,
    Fanuc0iF,
    HaasNgc,
}

impl Dialect {
    pub const ALL: [(&'static str, Self); 3] =
        [("fanuc-31i", Self::Fanuc31i), ("fanuc-0i-f", Self::Fanuc0iF), ("haas-ngc", Self::HaasNgc)];
}

/// Which variables the tool offsets have.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum OffsetVariables {
    /// #10001 wear and #11001 geometry of H, #12001 and #13001 of D; #2001 and #2201 for the first 200 of H.
    #[default]
    Fanuc,
    /// #2001 geometry and #2201 wear of the length, #2401 and #2601 of the diameter.
    Haas,
}

impl OffsetVariables {
    pub const ALL: [(&'static str, Self); 2] = [("fanuc", Self::Fanuc), ("haas", Self::Haas)];

    /// The variable of the geometry offset H of a tool, if it has one.
    pub fn length(self, tool: u32) -> Option<u32> {
        match self {
            Self::Fanuc => (tool <= 999).then_some(11_000 + tool),
            Self::Haas => (tool <= 200).then_some(2_000 + tool),
        }
    }
}

/// Stroke limits in machine coordinates; an axis without one has no end there.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stroke {
    pub most: [Option<f64>; MAX_AXES],
    pub least: [Option<f64>; MAX_AXES],
}

/// What is done where the sources are silent or contradict one another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unsure {
    /// `-#1` with #1 vacant stays vacant in an expression instead of becoming 0.
    pub minus_keeps_vacancy: bool,
    /// `[#1]` with #1 vacant stays vacant instead of becoming 0.
    pub brackets_keep_vacancy: bool,
    /// A literal finer than the increment is rounded instead of cut off.
    pub round_literals: bool,
    /// GOTO takes the first of several equal N of the program instead of the next one downwards.
    pub first_stored_number: bool,
    /// `IF[…]THEN GOTO n` is taken.
    pub then_takes_goto: bool,
    /// G65 … L sets the arguments anew for every pass.
    pub repeats_reset_locals: bool,
    /// G66.1 with arguments of its own calls the macro at once.
    pub every_block_calls_itself: bool,
    /// A modal macro call finds its locals as its last call left them.
    pub modal_keeps_locals: bool,
    /// `GOTO-n` searches upwards instead of raising PS1128.
    pub minus_searches_up: bool,
    /// A GOTO without its target raises PS0078 instead of PS0128.
    pub missing_target_is_78: bool,
    /// AND, OR and XOR of a negative number raise PS0119 instead of working on two's complements.
    pub negative_bits_alarm: bool,
    /// #5001… under mirror, scaling and rotation are the coordinates after them instead of those programmed.
    pub shows_transformed: bool,
    /// POW, MOD and ATAN with a comma are known.
    pub new_functions: bool,
    /// `ATAN[0]/[0]` raises PS0119 instead of answering 0.
    pub atan_of_nothing_alarms: bool,
    /// `TAN[90]` raises PS0119 instead of answering a large number.
    pub tan_90_alarms: bool,
    /// G53 in G91 moves by the increment instead of not moving.
    pub g53_moves_in_g91: bool,
    /// A drilling block with K0 moves to its XY.
    pub k0_positions: bool,
    /// After a skipped G31 #5001… are the commanded end instead of the place of the signal.
    pub skip_keeps_end: bool,
    /// `G43 H` without an axis word moves the axis by the offset at once.
    pub length_moves_at_once: bool,
    /// G84 and G74 dwell P at the R level too.
    pub tap_dwells_at_r: bool,
    /// G67 without G66 raises PS1100.
    pub g67_alarms: bool,
    /// An arc whose R can't reach its end raises PS0020 instead of a half circle.
    pub small_radius_alarms: bool,
    /// Several assignments may stand in a block.
    pub several_assignments: bool,
    /// Conditions may be written with `=`, `<>`, `>`, `>=`, `<`, `<=`, `&` and `|`.
    pub signs: bool,
    /// Words of statements may be cut to two letters.
    pub short_words: bool,
    /// Lower case is read as capitals instead of raising PS0004.
    pub lower_case: bool,
    /// `#3000=n` shows a number that is too large instead of raising PS0119.
    pub large_alarm_numbers: bool,
    /// M98 without P raises PS0311 instead of PS0076.
    pub missing_p_is_311: bool,
    /// What E and F without a point are as arguments.
    pub argument_e: ArgumentScale,
    pub argument_f: ArgumentScale,
}

/// What a number without a point is when it is an argument of a macro call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ArgumentScale {
    /// As it stands.
    Whole,
    /// As the word F counts in the feed mode in force.
    Feed,
    /// So many least increments of a length.
    Increments,
}

impl ArgumentScale {
    pub const ALL: [(&'static str, Self); 3] =
        [("whole", Self::Whole), ("feed", Self::Feed), ("increments", Self::Increments)];
}

/// Everything a run depends on besides the programs. `Default` is a 30i / 0i-F class mill, metric, IS-B.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    pub dialect: Dialect,
    pub increment: Increment,
    pub axes: Axes,
    /// ROA 1008#0: the axes whose work coordinate runs from 0 to 360 and that turn the shorter way.
    pub roll_over: [bool; MAX_AXES],
    /// DPI 3401#0: a number without a point is mm, degrees, seconds instead of increments.
    pub calculator_input: bool,
    /// NAT 6004#0: ASIN and ATAN answer −90…90 and −180…180 instead of 270…90 and 0…360.
    pub signed_angles: bool,
    /// MFZ 6004#1: sines, cosines and tangents below 1e-8 become 0.
    pub zero_residues: bool,
    /// IJK 6008#7: I J K in G65 are always specification I.
    pub plain_ijk: bool,
    /// CVA 6007#4: arguments of macro calls are converted when they are passed, so that ADP finds nothing to do.
    pub converts_arguments: bool,
    /// FXY 5101#0: cycles drill along the normal of the plane, or along the axis that their block names, instead of Z.
    pub drills_by_plane: bool,
    /// V15 6000#3: geometry and wear change places in the variables of tool offsets.
    pub series_15_offsets: bool,
    /// AD2 3403#6: an address twice in a block raises PS5074.
    pub no_repeated_address: bool,
    /// More M codes in a block than it may have raise PS0335; otherwise the last counts.
    pub plural_m_alarms: bool,
    /// M3B 3404#7: up to three M codes in a block.
    pub three_m_codes: bool,
    /// `#3000=n` shows MC with this number added; MCA 6008#1 makes it 0.
    pub macro_alarm_base: u16,
    /// The largest n that the manual names for `#3000=n`.
    pub macro_alarm_most: u16,
    /// `IF[…]` is followed by an assignment or by words without THEN.
    pub plain_if: bool,
    /// `IF[…]THEN` takes words.
    pub then_takes_words: bool,
    /// Common variables beyond #999.
    pub more_commons: Option<(u32, u32)>,
    pub offset_variables: OffsetVariables,
    /// PRT 6001#1: DPRNT leaves the blanks before a number out.
    pub print_without_blanks: bool,
    /// A number with more digits than DPRNT's format is printed whole instead of its lower digits only.
    pub print_expands: bool,
    /// DPRNT and BPRNT alarm unless POPEN came before.
    pub print_needs_open: bool,
    /// How many digits DPRNT's format may ask for.
    pub print_digits: usize,
    /// SCR 5400#7: G51 counts its factors in 0.001 instead of 0.00001.
    pub coarse_scaling: bool,
    /// Block-skip switches that are on, by number 1 to 9.
    pub skip_switches: [bool; 9],
    /// M01 stops.
    pub optional_stop: bool,
    /// The inputs #1000 to #1031 that are 1, as bits.
    pub inputs: u32,
    /// The skip signal comes after this part of a G31 path; without it, never.
    pub skip_signal: Option<f64>,
    /// A G31 that ends without its signal alarms.
    pub missed_skip_alarms: bool,
    /// The main program's M99 of this number ends the run.
    pub cycles: Option<u32>,
    /// Codes and addresses that call programs.
    pub code_calls: CodeCalls,
    /// 1420: rapid rate of the axes that slide.
    pub rapid: MmPerMin,
    /// 1420: rapid rate of the axes that turn, degrees a minute.
    pub rapid_rotary: f64,
    /// 3410: how far an arc's end may be off its radius, mm.
    pub arc_tolerance: f64,
    /// 5440: the way that G60 leaves to its end, in the direction it comes from.
    pub overrun: Position,
    /// M97 P calls the subprogram that begins at a sequence number of its own program.
    pub local_calls: bool,
    /// 5114: the retract of G73, mm.
    pub g73_retract: f64,
    /// 5115: the clearance of G83 above the last depth, mm.
    pub g83_clearance: f64,
    /// 1241 to 1243: the second, third and fourth reference position, in machine coordinates.
    pub references: [Position; 3],
    /// 1320 and 1321: stroke limits; without any, axes have no ends.
    pub stroke: Option<Stroke>,
    /// Pairs of tool offsets.
    pub tool_offsets: usize,
    /// Macro calls inside one another.
    pub macro_levels: usize,
    /// Calls of all kinds inside one another.
    pub call_levels: usize,
    /// #3011 as yyyymmdd: a run never reads a clock.
    pub date: u32,
    /// #3012 as hhmmss at the start of the run.
    pub time: u32,
    pub unsure: Unsure,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            dialect: Dialect::default(),
            increment: Increment::default(),
            axes: Axes::default(),
            roll_over: [false; MAX_AXES],
            calculator_input: false,
            signed_angles: false,
            zero_residues: false,
            plain_ijk: false,
            converts_arguments: false,
            drills_by_plane: false,
            series_15_offsets: false,
            no_repeated_address: false,
            plural_m_alarms: false,
            three_m_codes: false,
            macro_alarm_base: 3000,
            macro_alarm_most: 200,
            plain_if: false,
            then_takes_words: false,
            more_commons: Some((98_000, 98_499)),
            offset_variables: OffsetVariables::default(),
            print_without_blanks: false,
            print_expands: false,
            print_needs_open: false,
            print_digits: 8,
            coarse_scaling: true,
            skip_switches: [false; 9],
            optional_stop: true,
            inputs: 0,
            skip_signal: None,
            missed_skip_alarms: false,
            cycles: None,
            code_calls: CodeCalls::default(),
            rapid: MmPerMin(24_000.0),
            rapid_rotary: 3_600.0,
            arc_tolerance: 0.02,
            overrun: Position::default(),
            local_calls: false,
            g73_retract: 1.0,
            g83_clearance: 0.5,
            references: [Position::default(); 3],
            stroke: None,
            tool_offsets: 400,
            macro_levels: 5,
            call_levels: 15,
            date: 20_260_101,
            time: 120_000,
            unsure: Unsure::default(),
        }
    }
}

impl Default for Unsure {
    fn default() -> Self {
        Self {
            minus_keeps_vacancy: false,
            brackets_keep_vacancy: true,
            round_literals: false,
            first_stored_number: false,
            then_takes_goto: false,
            repeats_reset_locals: false,
            every_block_calls_itself: true,
            modal_keeps_locals: true,
            minus_searches_up: false,
            missing_target_is_78: false,
            negative_bits_alarm: false,
            shows_transformed: false,
            new_functions: true,
            atan_of_nothing_alarms: false,
            tan_90_alarms: false,
            g53_moves_in_g91: false,
            k0_positions: false,
            skip_keeps_end: false,
            length_moves_at_once: true,
            tap_dwells_at_r: true,
            g67_alarms: true,
            small_radius_alarms: true,
            several_assignments: false,
            signs: false,
            short_words: true,
            lower_case: true,
            large_alarm_numbers: true,
            missing_p_is_311: false,
            argument_e: ArgumentScale::Whole,
            argument_f: ArgumentScale::Feed,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_is_half_away_from_zero() {
        assert_eq!(Increment::IsB.round(-1.0005), -1.001);
        assert_eq!(Increment::IsB.round(12.3456), 12.346);
        assert_eq!(Increment::IsA.round(0.005), 0.01);
    }
}
