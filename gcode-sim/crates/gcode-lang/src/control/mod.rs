//! Settings of a control that the meaning of a program depends on, in one struct.
mod code_calls;
mod common_ranges;
mod declared_codes;
mod dialect;
mod kinematics;
mod machine_values;
mod parameters;
mod table;

use crate::motion::{Axes, AxisIndex, MAX_AXES, Position};
use crate::units::{MmPerMin, round_scaled};

pub use code_calls::{
    ADDRESSES, AddressCall, CODE_RANGES, CalledProgram, CodeCallKind, CodeCalls, SEQUENTIAL_CODES,
};
pub use declared_codes::{DeclaredCodes, DeclaredEffect};
pub use kinematics::{Kinematics, RotaryAxis};
pub use machine_values::{MachineValue, MachineValues, assumed_machine_value, has_items};
pub use parameters::{ParameterError, ParameterId, changes_motion, is_without_effect};
pub use table::{ROWS, SettingError, SettingRow, SettingValues, UndocumentedChoices};

/// Least input increment (parameter 1013).
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
    /// All increments with their names on the command line.
    pub const ALL: [(&'static str, Self); 3] =
        [("IS-A", Self::IsA), ("IS-B", Self::IsB), ("IS-C", Self::IsC)];

    /// Returns the name, `IS-B`.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(_, increment)| *increment == self).map_or("", |(name, _)| name)
    }

    /// Returns the number of increments in a millimetre or a degree.
    pub fn per_unit(self) -> f64 {
        match self {
            Self::IsA => 100.0,
            Self::IsB => 1_000.0,
            Self::IsC => 10_000.0,
        }
    }

    /// Returns the number of decimals of a value in mm or degrees.
    pub fn decimals(self) -> usize {
        match self {
            Self::IsA => 2,
            Self::IsB => 3,
            Self::IsC => 4,
        }
    }

    /// Rounds `value` to the nearest multiple of the increment, halves away from zero.
    pub fn round(self, value: f64) -> f64 {
        round_scaled(value, self.per_unit()) / self.per_unit()
    }

    /// Returns the increment in mm or degrees.
    pub fn size(self) -> f64 {
        1.0 / self.per_unit()
    }
}

/// Family of controls. Its limits and differences are rows of a table in `dialect`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Dialect {
    /// Fanuc 31i, the default.
    #[default]
    Fanuc31i,
    /// Fanuc 0i-F.
    Fanuc0iF,
    /// Haas NGC.
    HaasNgc,
}

impl Dialect {
    /// All families with their names on the command line.
    pub const ALL: [(&'static str, Self); 3] =
        [("fanuc-31i", Self::Fanuc31i), ("fanuc-0i-f", Self::Fanuc0iF), ("haas-ngc", Self::HaasNgc)];

    /// Families of a code that every control has.
    pub const ALL_CONTROLS: &'static [Self] = &[Self::Fanuc31i, Self::Fanuc0iF, Self::HaasNgc];
    /// Families of Fanuc controls.
    pub const FANUC: &'static [Self] = &[Self::Fanuc31i, Self::Fanuc0iF];
    /// Controls with five simultaneous axes.
    pub(crate) const FIVE_AXES: &'static [Self] = &[Self::Fanuc31i];
    pub(crate) const HAAS: &'static [Self] = &[Self::HaasNgc];

    /// Returns the name, `fanuc-31i`.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(_, dialect)| *dialect == self).map_or("", |(name, _)| name)
    }
}

/// Tool offset memory (8136#6 NGW, 8136#7 NDO).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum OffsetMemory {
    /// One value for each number, of H and D alike.
    A,
    /// Geometry and wear for each number, of H and D alike.
    B,
    /// Geometry and wear, of H and D apart.
    #[default]
    C,
}

impl OffsetMemory {
    /// All memories with their names on the command line.
    pub const ALL: [(&'static str, Self); 3] = [("A", Self::A), ("B", Self::B), ("C", Self::C)];
}

/// Numbering of the tool offset variables.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum OffsetVariables {
    /// #10001 wear and #11001 geometry of H, #12001 and #13001 of D; #2001 and #2201 for the first 200 of H.
    #[default]
    Fanuc,
    /// #2001 geometry and #2201 wear of the length, #2401 and #2601 of D.
    Haas,
}

impl OffsetVariables {
    /// All numberings with their names on the command line.
    pub const ALL: [(&'static str, Self); 2] = [("fanuc", Self::Fanuc), ("haas", Self::Haas)];

    /// Returns the variable of the geometry offset H of a tool; `None` beyond the last tool.
    pub fn length(self, tool: u32) -> Option<u32> {
        match self {
            Self::Fanuc => (tool <= 999).then_some(11_000 + tool),
            Self::Haas => (tool <= 200).then_some(2_000 + tool),
        }
    }

    /// Returns the variable of the geometry offset D of a tool; `None` beyond the last tool.
    pub fn radius(self, tool: u32) -> Option<u32> {
        match self {
            Self::Fanuc => (tool <= 999).then_some(13_000 + tool),
            Self::Haas => (tool <= 200).then_some(2_400 + tool),
        }
    }
}

/// Unit of a macro argument without a decimal point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ArgumentScale {
    /// The number itself.
    Whole,
    /// The unit of the word F in the active feed mode.
    Feed,
    /// Least increments of a length.
    Increments,
}

impl ArgumentScale {
    /// All units with their names on the command line.
    pub const ALL: [(&'static str, Self); 3] =
        [("whole", Self::Whole), ("feed", Self::Feed), ("increments", Self::Increments)];
}

/// Rotary axis whose sign P1 (plus) and P2 (minus) of G53.1 choose.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ToolAxisChoice {
    /// First axis that changes the tool's angle to the axis of the spindle.
    #[default]
    Tilting,
    /// First rotary axis: of the head before the table, each from its base.
    First,
    /// Second rotary axis.
    Second,
}

impl ToolAxisChoice {
    /// All choices with their names on the command line.
    pub const ALL: [(&'static str, Self); 3] =
        [("tilting", Self::Tilting), ("first", Self::First), ("second", Self::Second)];
}

/// Stroke limits in machine coordinates, mm or degrees; `None` for an axis without a limit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StrokeLimits {
    /// Upper limits.
    pub max: [Option<f64>; MAX_AXES],
    /// Lower limits.
    pub min: [Option<f64>; MAX_AXES],
}

/// Declares a struct whose fields have default values, `field: type = value`.
macro_rules! with_defaults {
    ($(#[$doc:meta])* pub struct $name:ident { $($(#[$field_doc:meta])* pub $field:ident: $type:ty = $value:expr,)+ }) => {
        $(#[$doc])*
        pub struct $name {
            $($(#[$field_doc])* pub $field: $type,)+
        }

        impl Default for $name {
            fn default() -> Self {
                Self { $($field: $value,)+ }
            }
        }
    };
}

with_defaults! {
    /// Everything that a run depends on besides the programs.
    ///
    /// `Default` is a mill of the 30i / 0i-F class, metric, IS-B.
    #[derive(Clone, Debug, PartialEq)]
    pub struct Settings {
        /// Family of the control.
        pub dialect: Dialect = Default::default(),
        /// Family whose G and M codes the control has.
        pub codes: Dialect = Default::default(),
        /// Least input increment.
        pub increment: Increment = Default::default(),
        /// True for inches at power-on, false for mm; `None` if nothing states it, which counts as mm.
        pub is_inch_at_power_on: Option<bool> = None,
        /// True if G67 without G66 raises PS1100; `None` if only one without other G codes in its block does.
        pub g67_alarms: Option<bool> = None,
        /// Axes in the order of their numbers.
        pub axes: Axes = Default::default(),
        /// ROA 1008#0: axes whose work coordinate rolls over from 360 to 0 and that take the shorter rotation.
        pub rolls_over: [bool; MAX_AXES] = [false; MAX_AXES],
        /// DPI 3401#0: a number without a point is mm, degrees or seconds, not increments.
        pub uses_calculator_input: bool = false,
        /// NAT 6004#0: ASIN returns −90 to 90 and ATAN −180 to 180, not 270 to 90 and 0 to 360.
        pub returns_signed_angles: bool = false,
        /// MFZ 6004#1: sines, cosines and tangents below 1e-8 become 0.
        pub zeroes_residues: bool = false,
        /// IJK 6008#7: I J K in G65 are always specification I.
        pub reads_ijk_plainly: bool = false,
        /// CVA 6007#4: arguments of macro calls are converted when they are passed; ADP then has no effect.
        pub converts_arguments: bool = false,
        /// FXY 5101#0: cycles drill along the normal of the plane or the axis in their block, not always Z.
        pub drills_by_plane: bool = false,
        /// D15 6004#5: #2401 to #2800 are the offsets of D, not work offsets.
        pub has_diameter_variables: bool = false,
        /// V15 6000#3: geometry and wear are exchanged in the tool offset variables.
        pub series_15_offsets: bool = false,
        /// AD2 3403#6: a repeated address in a block raises PS5074.
        pub alarms_on_repeated_address: bool = false,
        /// Too many M codes in a block raise PS0335; otherwise the last counts.
        pub plural_m_alarms: bool = false,
        /// M3B 3404#7: up to three M codes in a block.
        pub allows_three_m_codes: bool = false,
        /// Number added to n by `#3000=n`; MCA 6008#1 makes it 0.
        pub macro_alarm_base: u16 = 3000,
        /// Largest n that the manual gives for `#3000=n`.
        pub macro_alarm_max: u16 = 200,
        /// Macro statements behind DO in its line are accepted, each as a block of its own.
        pub reads_statements_behind_do: bool = false,
        /// `IF[…]` accepts an assignment or words without THEN.
        pub allows_plain_if: bool = false,
        /// IF and WHILE accept a value as their condition, true unless it is 0 or vacant.
        pub allows_value_conditions: bool = false,
        /// `IF[…]THEN` accepts words.
        pub then_takes_words: bool = false,
        /// First and last of each range of common variables beyond those of every control, in ascending order.
        pub extra_commons: Vec<(u32, u32)> = vec![(98_000, 98_499)],
        /// Tool offset memory.
        pub offset_memory: OffsetMemory = Default::default(),
        /// Numbering of the tool offset variables.
        pub offset_variables: OffsetVariables = Default::default(),
        /// PRT 6001#1: DPRNT omits the blanks before a number.
        pub omits_print_blanks: bool = false,
        /// DPRNT prints all digits of a number with more digits than its format, not only the lower ones.
        pub print_expands: bool = false,
        /// DPRNT and BPRNT raise an alarm without a preceding POPEN.
        pub print_needs_open: bool = false,
        /// Most digits that the format of DPRNT allows.
        pub print_digits: usize = 8,
        /// ODI 5004#2, setting 40 of a Haas: the offsets of D are diameters; `None` if nothing states it, and they count as
        /// radii.
        pub offsets_are_diameters: Option<bool> = None,
        /// OFH 5001#2: the offset of G45 to G48 is that of H, not of D.
        pub tool_offset_is_h: bool = false,
        /// EVO 5001#6: the length offset that G28, G30 and G53 cancel counts again from the next block, not from the next H, G43
        /// or G44. If nothing states it, it does so behind G53 alone, as on a Haas.
        pub restores_length: Option<bool> = None,
        /// EVR 5001#4: a changed offset of D applies from the next block, not from the next D.
        pub applies_radius_at_once: bool = false,
        /// SUP 5003#0: cutter compensation starts and ends by type B.
        pub starts_up_by_type_b: bool = false,
        /// 19625: number of lookahead blocks in cutter compensation; two of them must move.
        pub lookahead_blocks: usize = 3,
        /// 5460 and 5461: numbers of the linear and the rotary axis of G12.1; 0 for X, and for C or the only rotary axis.
        pub polar_axes: [usize; 2] = [0, 0],
        /// 5411: factor of G51 for an axis that its words give none.
        pub scale_factor: f64 = 1.0,
        /// SCR 5400#7: factors of G51 count in 0.001, not 0.00001.
        pub has_coarse_scaling: bool = true,
        /// Block skip switches 1 to 9 that are on.
        pub skip_switches: [bool; 9] = [false; 9],
        /// M01 stops.
        pub stops_at_m01: bool = true,
        /// Inputs #1000 to #1031 that are 1, as bits.
        pub inputs: u32 = 0,
        /// Other values of the machine that a program can read.
        pub machine_values: MachineValues = Default::default(),
        /// Fraction of a G31 path after which the skip signal comes; `None` for no signal.
        pub skip_signal: Option<f64> = None,
        /// A G31 that ends without its signal raises an alarm.
        pub missed_skip_alarms: bool = false,
        /// Number of M99 in the main program that ends the run; `None` for no limit.
        pub main_program_cycles: Option<u32> = None,
        /// Codes and addresses that call programs.
        pub code_calls: CodeCalls = Default::default(),
        /// Codes of the machine builder with a declared effect.
        pub declared_codes: DeclaredCodes = Default::default(),
        /// 1401#1: a rapid is a straight line; otherwise each axis moves at its own rate.
        pub rapids_are_straight: bool = false,
        /// 1420: rapid rate of the linear axes.
        pub rapid: MmPerMin = MmPerMin(24_000.0),
        /// 1420: rapid rate of the rotary axes, degrees per minute.
        pub rapid_rotary: f64 = 3_600.0,
        /// Rotary axes that turn part and tool; `None` if they are unknown.
        pub kinematics: Option<Kinematics> = None,
        /// Rotary axis whose sign P1 and P2 of G53.1 choose.
        pub tool_axis_choice: ToolAxisChoice = Default::default(),
        /// WKP 19696#5: tool centre point control counts in the work system, which does not turn with the table.
        pub tip_in_work_system: bool = false,
        /// 12321: direction to which X of G68.3 is square, 1 to 3 for X, Y and Z, 0 for that of the tool.
        pub vertical_axis: usize = 0,
        /// Largest deviation of the chords that replace an arc in a plane that is not one of the machine's, mm.
        pub chord_tolerance: f64 = 0.001,
        /// 3410: largest difference between the radii at start and end of an arc, mm.
        pub arc_tolerance: f64 = 0.02,
        /// CIR 3403#5: an arc without R, I, J and K raises PS0022; otherwise it is a straight cut.
        pub alarms_without_centre: bool = true,
        /// 5440: final approach of G60 with its direction, mm or degrees.
        pub single_direction_overrun: Position = Default::default(),
        /// M97 P calls the subprogram at a sequence number of its own program.
        pub has_local_calls: bool = false,
        /// 5114: retract of G73, mm.
        pub g73_retract: f64 = 1.0,
        /// 5115: clearance of G83 above the last depth, mm.
        pub g83_clearance: f64 = 0.5,
        /// 1241 to 1243: second, third and fourth reference position, in machine coordinates.
        pub reference_positions: [Position; 3] = [Position::default(); 3],
        /// 1320 and 1321: stroke limits; `None` for unlimited axes.
        pub stroke_limits: Option<StrokeLimits> = None,
        /// Number of additional work coordinate systems: G54.1 P1…, G154 P1….
        pub work_systems: usize = 300,
        /// `#10100` is `#100`; `#10500` to `#10999` are `#500` to `#999`.
        pub aliases_commons: bool = false,
        /// `#n.m` is item m of the parameter #n, or bit m of any other variable #n.
        pub has_variable_bits: bool = false,
        /// Programs and variables may have names; PRM, AX and AXNUM are available.
        pub has_named_variables: bool = true,
        /// FUP, LN, EXP, BIN, BCD, POW, ADP and ATAN with a comma are available.
        pub has_extended_functions: bool = true,
        /// G10 accepts parameters, variables and tool life.
        pub allows_parameter_input: bool = true,
        /// `M98 P` with five digits or more is repeats and program.
        pub reads_repeats_in_p: bool = true,
        /// Letter for the number of repeats of a canned cycle, K or L.
        pub cycle_repeat_letter: u8 = b'K',
        /// S may have a decimal point.
        pub speed_takes_point: bool = false,
        /// L repeats an incremental straight move.
        pub repeats_moves: bool = false,
        /// G28 without an axis moves all axes to the reference position.
        pub homes_all_axes: bool = false,
        /// P of a dwell with a point is seconds.
        pub dwell_in_seconds: bool = false,
        /// F without a point counts increments.
        pub feed_in_increments: bool = false,
        /// 5200#0: G84 and G74 turn the spindle without M29 as well.
        pub taps_rigidly: bool = false,
        /// G73 and G83 accept I, J and K for decreasing pecks.
        pub has_shrinking_pecks: bool = false,
        /// Height above R to which G83 retracts, mm.
        pub g83_above_r: f64 = 0.0,
        /// Number of tool offset pairs.
        pub tool_offsets: usize = 400,
        /// Deepest nesting of macro calls.
        pub macro_levels: usize = 5,
        /// Deepest nesting of calls of all kinds.
        pub call_levels: usize = 15,
        /// #3011 as yyyymmdd; a run never reads a clock.
        pub date: u32 = 20_260_101,
        /// #3012 as hhmmss at the start of the run.
        pub time: u32 = 120_000,
        /// Behaviour on which the manuals are silent.
        pub undocumented: UndocumentedChoices = Default::default(),
    }
}

/// Variables of the inputs of every control.
const INPUTS: std::ops::RangeInclusive<u32> = 1000..=1031;

impl Settings {
    /// Returns true for a system variable of a signal or a setting that the caller may state.
    pub fn is_input(number: u32) -> bool {
        INPUTS.contains(&number) || *INPUTS.end() < number && MachineValues::holds(number)
    }

    /// Iterates over the axes that roll over; usually none.
    pub fn rollover_axes(&self) -> impl Iterator<Item = AxisIndex> + '_ {
        let some = self.rolls_over != [false; MAX_AXES];
        (0..if some { self.axes.len() } else { 0 }).filter(|axis| self.rolls_over[*axis])
    }

    /// Returns the variable of the geometry offset H of a tool; `None` beyond the last tool.
    pub fn length_variable(&self, tool: u32) -> Option<u32> {
        match self.offset_memory {
            OffsetMemory::A => (tool <= 999).then_some(10_000 + tool),
            OffsetMemory::B | OffsetMemory::C => self.offset_variables.length(tool),
        }
    }

    /// Returns the variable of the geometry offset D of a tool; `None` beyond the last tool, and where D has the offset of H.
    pub fn radius_variable(&self, tool: u32) -> Option<u32> {
        match self.offset_memory {
            OffsetMemory::A | OffsetMemory::B => None,
            OffsetMemory::C => self.offset_variables.radius(tool),
        }
    }

    /// Returns true if the offsets of D are diameters.
    pub fn has_diameter_offsets(&self) -> bool {
        self.offsets_are_diameters == Some(true)
    }

    /// Returns true if a length offset counts behind G53 although a parameter may have cancelled it; a Haas has none.
    pub fn assumes_restored_length(&self) -> bool {
        self.restores_length.is_none() && self.codes != Dialect::HaasNgc
    }

    /// Returns true if the offsets of D count as radii although an operator may set the control to diameters: setting 40 of a
    /// Haas. On a Fanuc it is a parameter of the machine's builder.
    pub fn assumes_radius_offsets(&self) -> bool {
        self.offsets_are_diameters.is_none() && self.codes == Dialect::HaasNgc
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
