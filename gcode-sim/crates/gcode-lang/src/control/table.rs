//! Named settings: the parameter in the manual, the key on the command line, and how the value is read.
use super::common_ranges;
use super::machine_values::MachineValues;
use super::{
    ArgumentScale, DeclaredEffect, Dialect, INPUTS, Increment, OffsetMemory, OffsetVariables, Settings,
    ToolAxisChoice,
};
use crate::motion::{Axes, MAX_AXES, Position};
use crate::similar::similar;
use crate::units::MmPerMin;

/// Reason why a setting is refused.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SettingError {
    /// No setting has this key.
    #[error("no setting '{key}'{}: see `gcode-sim settings`", meant(key))]
    Unknown {
        /// Key as given.
        key: String,
    },
    /// The value is outside the permitted values.
    #[error("setting {key} is '{value}': {allowed}")]
    Value {
        /// Key as given.
        key: String,
        /// Value as given.
        value: String,
        /// Permitted values.
        allowed: String,
    },
}

/// Returns a question for the setting that a misspelt key means.
fn meant(key: &str) -> String {
    let keys = ROWS.iter().map(|row| row.key).filter(|key| !key.starts_with(|c: char| c.is_ascii_digit()));
    similar(key, keys).map(|meant| format!(" (did you mean '{meant}'?)")).unwrap_or_default()
}

/// Named setting.
#[derive(Clone, Copy)]
pub struct SettingRow {
    /// Key on the command line.
    pub key: &'static str,
    /// Its meaning in one line, with the number of the parameter if a control has one.
    pub meaning: &'static str,
    /// Permitted values.
    pub values: SettingValues,
    set: fn(&mut Settings, &str) -> Option<()>,
}

/// Permitted values of a setting.
#[derive(Clone, Copy)]
pub enum SettingValues {
    /// 1 for on, 0 for off.
    Switch,
    /// One of a few words.
    Words(fn() -> Vec<&'static str>),
    /// Whole number between two bounds.
    Whole(usize, usize),
    /// Number between two bounds, with their description.
    Number(f64, f64, &'static str),
    /// Text that matches a regular expression, with its description.
    Text(&'static str, &'static str),
    /// Ranges of common variables that match a regular expression.
    Ranges(&'static str),
}

impl SettingValues {
    /// Returns the reason why a value is refused, or the permitted values.
    fn refusal(&self, value: &str) -> String {
        match self {
            Self::Ranges(_) => common_ranges::read(value).err().unwrap_or_else(|| self.to_string()),
            _ => self.to_string(),
        }
    }
}

impl SettingRow {
    /// Returns true for a setting that is on or off.
    pub fn is_switch(&self) -> bool {
        matches!(self.values, SettingValues::Switch)
    }
}

/// Writes the permitted values as in messages and in the list of settings.
impl std::fmt::Display for SettingValues {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Switch => f.write_str(SWITCH),
            Self::Words(words) => match words().as_slice() {
                [] => Ok(()),
                [only] => f.write_str(only),
                [others @ .., last] => write!(f, "{} or {last}", others.join(", ")),
            },
            Self::Whole(min, max) => write!(f, "{min} to {max}"),
            Self::Number(_, _, wording) | Self::Text(_, wording) => f.write_str(wording),
            Self::Ranges(_) => f.write_str(common_ranges::ALLOWED),
        }
    }
}

const SWITCH: &str = "0 or 1";
const LENGTH: &str = "a length in mm, 0 or more";

/// Pattern of `X10,Z-5.5`.
const POINT: &str = "^ *[A-Ca-cU-Zu-z][+-]?([0-9]+[.]?[0-9]*|[.][0-9]+)( *, *[A-Ca-cU-Zu-z][+-]?([0-9]+[.]?[0-9]*|[.][0-9]+))* *$";
const MACHINE_POSITION: SettingValues =
    SettingValues::Text(POINT, "axes and their machine coordinates, as in X10,Z-5");

macro_rules! switch {
    ($key:literal, $meaning:literal, $($field:ident).+) => {
        switch!($key, $meaning, |s, on| s.$($field).+ = on)
    };
    ($key:literal, $meaning:literal, |$s:ident, $on:ident| $set:expr) => {
        row!($key, $meaning, SettingValues::Switch, |$s, text| { let $on = switch(text)?; $set; })
    };
}

macro_rules! choice {
    ($key:literal, $meaning:literal, $all:expr, |$s:ident, $v:ident| $set:expr) => {
        row!(
            $key,
            $meaning,
            SettingValues::Words(|| $all.iter().map(|(name, _)| *name).collect()),
            |$s, text| {
                let $v = choice(text, &$all)?;
                $set;
            }
        )
    };
}

macro_rules! whole {
    ($key:literal, $meaning:literal, $min:literal, $max:literal, |$s:ident, $v:ident| $set:expr) => {
        row!($key, $meaning, SettingValues::Whole($min, $max), |$s, text| {
            let $v = whole(text, $min, $max)?;
            $set;
        })
    };
}

macro_rules! number {
    ($key:literal, $meaning:literal, $min:expr, $max:expr, $wording:expr, |$s:ident, $v:ident| $set:expr) => {
        row!($key, $meaning, SettingValues::Number($min, $max, $wording), |$s, text| {
            let $v = between(text, $min, $max)?;
            $set;
        })
    };
}

macro_rules! row {
    ($key:literal, $meaning:literal, $values:expr, |$s:ident, $text:ident| $set:expr) => {
        SettingRow {
            key: $key,
            meaning: $meaning,
            values: $values,
            set: |$s, $text| {
                $set;
                Some(())
            },
        }
    };
}

const REPEAT_LETTERS: [(&str, u8); 2] = [("K", b'K'), ("L", b'L')];

/// All named settings in the order of their list.
pub const ROWS: &[SettingRow] = &{
    let mut all = [DOCUMENTED[0]; DOCUMENTED.len() + UNDOCUMENTED.len()];
    let (first, last) = all.split_at_mut(DOCUMENTED.len());
    first.copy_from_slice(DOCUMENTED);
    last.copy_from_slice(UNDOCUMENTED);
    all
};

/// Settings that manuals describe.
#[rustfmt::skip]
const DOCUMENTED: &[SettingRow] = &[
    choice!("DIALECT", "the family of controls", Dialect::ALL, |s, v| s.apply_dialect(v)),
    choice!("CODES", "the set of G and M codes", Dialect::ALL, |s, v| s.codes = v),
    choice!("INCREMENT", "1013: the least input increment", Increment::ALL, |s, v| s.increment = v),
    switch!("INI", "the unit at power-on is inch: INI of the setting data, setting 9 of a Haas", |s, on| s.is_inch_at_power_on = Some(on)),
    switch!("DPI", "3401#0, setting 162 of a Haas: numbers without a decimal point are mm, degrees, seconds", uses_calculator_input),
    switch!("NAT", "6004#0: ASIN -90 to 90, ATAN -180 to 180", returns_signed_angles),
    switch!("MFZ", "6004#1: SIN, COS, TAN below 1e-8 become 0", zeroes_residues),
    switch!("IJK", "6008#7: I J K in G65 are always specification I", reads_ijk_plainly),
    switch!("GMP", "6008#6: G codes also call in programs called by M, T, S or B, and vice versa", code_calls.allows_nested_calls),
    switch!("MGE", "6007#3: a G code that 6050 and following define as a modal call is G66.1 instead of G66", code_calls.modal_is_every_block),
    switch!("TCS", "6001#5: T calls O9000 with its number in #149", code_calls.t_calls_program),
    switch!("SCS", "S calls O9029 with its number in #147", code_calls.s_calls_program),
    switch!("BCS", "B, unless it is an axis, calls O9028 with its number in #146", code_calls.b_calls_program),
    switch!("CVA", "6007#4: arguments without a decimal point are converted when they are passed: ADP has no effect", converts_arguments),
    switch!("G67-ALARM", "G67 without G66 raises PS1100, as with 0 in 6000#0; without this setting only a G67 without other G codes in its block does", |s, on| s.g67_alarms = Some(on)),
    switch!("FXY", "5101#0: canned cycles drill along the normal of the plane, not always Z", drills_by_plane),
    switch!("D15", "6004#5: #2401 to #2800 are the offsets of D, and #2500 to #2806 no work offsets", has_diameter_variables),
    switch!("V15", "6000#3: geometry and wear are exchanged in tool offset variables", series_15_offsets),
    switch!("AD2", "3403#6: a repeated address in a block raises an alarm", alarms_on_repeated_address),
    switch!("M3B", "3404#7: up to three M codes in a block", allows_three_m_codes),
    switch!("PLURAL-M-ALARM", "more M codes in a block than allowed raise an alarm", plural_m_alarms),
    row!("1241", "the second reference position", MACHINE_POSITION, |s, v| s.reference_positions[0] = point(s, v)?),
    row!("1242", "the third reference position", MACHINE_POSITION, |s, v| s.reference_positions[1] = point(s, v)?),
    row!("1243", "the fourth reference position", MACHINE_POSITION, |s, v| s.reference_positions[2] = point(s, v)?),
    row!("1320", "stroke limits on the plus side: OT0500 beyond them", MACHINE_POSITION, |s, v| s.stroke_limits.get_or_insert_default().max = limits(&s.axes, v)?),
    row!("1321", "stroke limits on the minus side: OT0501 beyond them", MACHINE_POSITION, |s, v| s.stroke_limits.get_or_insert_default().min = limits(&s.axes, v)?),
    switch!("MCA", "6008#1: #3000=n shows MC n", |s, on| (s.macro_alarm_base, s.macro_alarm_max) = if on { (0, 4095) } else { (3000, 200) }),
    whole!("ALARM-BASE", "the number that #3000=n adds to n", 0, 9000, |s, v| s.macro_alarm_base = v as u16),
    whole!("ALARM-MOST", "the largest n that the manual gives for #3000=n", 1, 4095, |s, v| s.macro_alarm_max = v as u16),
    row!("MORE-COMMONS", "common variables beyond #100 to #199 and #500 to #999", SettingValues::Ranges(common_ranges::PATTERN), |s, v| s.extra_commons = common_ranges::read(v).ok()?),
    choice!("OFFSET-MEMORY", "the tool offset memory (8136#6, 8136#7): C has H and D apart, B geometry and wear for both, A one value", OffsetMemory::ALL, |s, v| s.offset_memory = v),
    choice!("OFFSET-VARIABLES", "numbering of the tool offset variables", OffsetVariables::ALL, |s, v| s.offset_variables = v),
    switch!("DO-LINE", "macro statements behind DO in its line are accepted, each as a block of its own; otherwise PS0125", reads_statements_behind_do),
    switch!("PLAIN-IF", "IF[..] accepts an assignment or words without THEN", allows_plain_if),
    switch!("VALUE-CONDITIONS", "IF[#1] and WHILE[#1] are true unless #1 is 0 or vacant", allows_value_conditions),
    switch!("THEN-WORDS", "IF[..]THEN accepts words", then_takes_words),
    switch!("PRT", "6001#1: DPRNT omits the blanks before a number", omits_print_blanks),
    switch!("PRINT-EXPANDS", "DPRNT prints all digits of a number, also beyond its format", print_expands),
    switch!("PRINT-NEEDS-POPEN", "DPRNT and BPRNT without POPEN raise an alarm", print_needs_open),
    whole!("PRINT-DIGITS", "the most digits that DPRNT's format allows", 1, 18, |s, v| s.print_digits = v),
    switch!("ODI", "5004#2, setting 40 of a Haas: the offsets of D are diameters", |s, on| s.offsets_are_diameters = Some(on)),
    switch!("OFH", "5001#2: the offset of G45 to G48 is that of H, not of D", tool_offset_is_h),
    switch!("EVO", "5001#6: a length offset that G28, G30 and G53 cancel counts again from the next block", |s, on| s.restores_length = Some(on)),
    switch!("EVR", "5001#4: a changed offset of D applies from the next block", applies_radius_at_once),
    switch!("SUP", "5003#0: cutter compensation starts and ends by type B", starts_up_by_type_b),
    whole!("19625", "blocks of lookahead in cutter compensation", 3, 8, |s, v| s.lookahead_blocks = v),
    number!("5411", "scale factor of G51 for an axis without P and without its I, J or K; 1 here", -999_999.0, 999_999.0, "a factor", |s, v| s.scale_factor = v),
    switch!("SCR", "5400#7: G51 scales in units of 0.001", has_coarse_scaling),
    row!("ROA", "1008#0: axes that roll over at 360 degrees", SettingValues::Text("^[A-Ca-c+]*$", "letters of rotary axes"), |s, v| roll_over(s, v)?),
    row!("BDT", "the block skip switches that are on", SettingValues::Text("^[1-9]([+][1-9])*$", "switches 1 to 9, as in 1+2"), |s, v| skip_switches(s, v)?),
    switch!("OPTIONAL-STOP", "M01 stops", stops_at_m01),
    number!("SKIP", "the skip signal comes after this fraction of a G31 path", 0.0, 1.0, "0 to 1", |s, v| s.skip_signal = Some(v)),
    switch!("SKIP-ALARM", "a G31 that ends without its signal raises an alarm", missed_skip_alarms),
    whole!("CYCLES", "the main program's M99 of this number ends the run", 0, 999_999_999, |s, v| s.main_program_cycles = u32::try_from(v).ok()),
    switch!("LRP", "1401#1: a rapid is a straight line; without it `verify` takes every path that the axes can take", rapids_are_straight),
    number!("RAPID", "1420: rapid rate of linear axes, mm/min", f64::MIN_POSITIVE, 1e9, "more than 0", |s, v| s.rapid = MmPerMin(v)),
    number!("RAPID-ROTARY", "1420: rapid rate of rotary axes, degrees/min", f64::MIN_POSITIVE, 1e9, "more than 0", |s, v| s.rapid_rotary = v),
    choice!("G53.1-P", "the rotary axis of which P1 of G53.1 takes the solution with the plus sign, P2 the other", ToolAxisChoice::ALL, |s, v| s.tool_axis_choice = v),
    switch!("WKP", "19696#5: X, Y and Z of G43.4 count in the work system, which does not turn with the table", tip_in_work_system),
    whole!("12321", "the direction to which X of G68.3 is square: 1 to 3 for X, Y, Z, 0 for that of the tool at 0", 0, 3, |s, v| s.vertical_axis = v),
    number!("CHORDS", "largest deviation of the chords that replace an arc in a plane that is not one of the machine's", 1e-6, 1.0, "0.000001 to 1 mm", |s, v| s.chord_tolerance = v),
    whole!("5460", "number of the linear axis of G12.1; 0 for X", 0, 8, |s, v| s.polar_axes[0] = v),
    whole!("5461", "number of the rotary axis of G12.1; 0 for C, or the only one", 0, 8, |s, v| s.polar_axes[1] = v),
    number!("3410", "tolerance for the radius at an arc's end point", 0.0, 1e6, LENGTH, |s, v| s.arc_tolerance = v),
    switch!("CIR", "3403#5: an arc without R, I, J and K raises PS0022, otherwise it is a straight cut", alarms_without_centre),
    row!("5440", "overrun of G60 single direction positioning, with the sign of its direction", SettingValues::Text(POINT, "axes and lengths, as in X0.5,Z-0.2"), |s, v| s.single_direction_overrun = point(s, v)?),
    switch!("M97-CALLS", "M97 P calls the subprogram at N of the same program", has_local_calls),
    number!("5114", "retract of G73; setting 22 of a Haas", 0.0, 1e6, LENGTH, |s, v| s.g73_retract = v),
    number!("5115", "clearance of G83", 0.0, 1e6, LENGTH, |s, v| s.g83_clearance = v),
    number!("SETTING-52", "setting 52 of a Haas: height above R to which G83 retracts", 0.0, 1e6, LENGTH, |s, v| s.g83_above_r = v),
    switch!("FEED-INCREMENTS", "setting 77 of a Haas: F without a decimal point counts 0.001 mm/min", feed_in_increments),
    whole!("WORK-SYSTEMS", "additional work coordinate systems, G54.1 P or G154 P", 1, 300, |s, v| s.work_systems = v),
    switch!("ALIASED-COMMONS", "#10100.. and #10500.. are #100.. and #500..", aliases_commons),
    switch!("VARIABLE-BITS", "#n.m is item m of the parameter #30000 to #39999, or bit m of any other variable", has_variable_bits),
    switch!("NEW-WORDS", "<NAME>, SETVN, [#NAME], [#_NAME], PRM, AX, AXNUM are available", has_named_variables),
    switch!("MORE-FUNCTIONS", "FUP, LN, EXP, BIN, BCD, POW, ADP, ATAN[a,b] are available", has_extended_functions),
    switch!("G10-PARAMETERS", "G10 accepts L3, L14, L50, L52 and L85", allows_parameter_input),
    switch!("REPEATS-IN-P", "M98 P with more than four digits is repeats and program", reads_repeats_in_p),
    choice!("CYCLE-REPEATS", "the address for the number of repeats of a canned cycle", REPEAT_LETTERS, |s, v| s.cycle_repeat_letter = v),
    switch!("MOVE-REPEATS", "L repeats an incremental straight move", repeats_moves),
    switch!("S-POINT", "S may have a decimal point", speed_takes_point),
    switch!("HOME-ALL", "G28 without an axis moves all axes to the reference position", homes_all_axes),
    switch!("DWELL-SECONDS", "P of a dwell with a decimal point is seconds; G04 takes no X and U", dwell_in_seconds),
    switch!("G84-RIGID", "5200#0: G84 and G74 turn the spindle without M29 as well", taps_rigidly),
    switch!("PECK-IJK", "G73 and G83 accept I, J, K for decreasing pecks", has_shrinking_pecks),
    whole!("OFFSETS", "pairs of tool offsets", 1, 999, |s, v| s.tool_offsets = v),
    whole!("MACRO-LEVELS", "levels of macro calls", 1, 15, |s, v| s.macro_levels = v),
    whole!("CALL-LEVELS", "levels of calls", 1, 30, |s, v| s.call_levels = v),
    whole!("DATE", "#3011, as yyyymmdd", 0, 99_991_231, |s, v| s.date = v as u32),
    whole!("TIME", "#3012, as hhmmss", 0, 235_959, |s, v| s.time = v as u32),
];

/// Declares [`UndocumentedChoices`], their defaults and their settings: key, field, default, meaning.
macro_rules! undocumented_choices {
    ($($key:literal $field:ident = $default:literal, $meaning:literal;)+) => {
        /// Choices of the simulator where manuals are silent or contradict one another.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub struct UndocumentedChoices {
            $(#[doc = concat!("`", $key, "`: `", $meaning, "`.")] pub $field: bool,)+
            /// Unit of an argument E without a decimal point.
            pub argument_e: ArgumentScale,
            /// Unit of an argument F without a decimal point.
            pub argument_f: ArgumentScale,
        }

        impl Default for UndocumentedChoices {
            fn default() -> Self {
                let (argument_e, argument_f) = (ArgumentScale::Whole, ArgumentScale::Feed);
                Self { $($field: $default,)+ argument_e, argument_f }
            }
        }

        /// Settings of the undocumented choices.
        const UNDOCUMENTED: &[SettingRow] = &[
            $(switch!($key, $meaning, undocumented.$field),)+
            choice!("ARGUMENT-E", "unit of an argument E without a decimal point", ArgumentScale::ALL, |s, v| s.undocumented.argument_e = v),
            choice!("ARGUMENT-F", "unit of an argument F without a decimal point", ArgumentScale::ALL, |s, v| s.undocumented.argument_f = v),
        ];
    };
}

undocumented_choices! {
    "VACANT-MINUS" minus_keeps_vacancy = false, "-#1 of a vacant #1 stays vacant in an expression instead of becoming 0";
    "VACANT-BRACKETS" brackets_keep_vacancy = true, "[#1] of a vacant #1 stays vacant instead of becoming 0";
    "ROUND-LITERALS" rounds_literals = false, "literals finer than the increment are rounded, not truncated";
    "GOTO-FIRST" goto_takes_first_number = false, "of duplicate N, GOTO takes the first in the program, not the next";
    "THEN-GOTO" then_takes_goto = false, "IF[..]THEN GOTO is accepted";
    "L-RESETS" repeats_reset_locals = false, "G65 L sets the arguments again for every repeat";
    "G66.1-CALLS" every_block_calls_itself = true, "G66.1 with arguments calls its macro at once";
    "G66-KEEPS-LOCALS" modal_keeps_locals = true, "a modal macro keeps its locals from its last call";
    "GOTO-MINUS-UP" minus_searches_up = false, "GOTO-n searches upwards instead of raising PS1128";
    "MISSING-N-78" missing_target_is_78 = false, "GOTO without its target is PS0078, not PS0128";
    "BITS-ALARM" negative_bits_alarm = false, "AND, OR, XOR of a negative number raise PS0119 instead of working on two's complements";
    "SHOWN-TRANSFORMED" shows_transformed = false, "#5001.. under G51, G51.1, G68, G68.2 are the transformed coordinates, not the programmed ones";
    "SHOWN-G154" shows_g154 = false, "#4014 of a Haas is 154 in G154 and G110 to G129; otherwise SIM0001, because manuals don't say";
    "NEW-FUNCTIONS" has_new_functions = true, "POW, MOD and ATAN[a,b] are available";
    "ATAN-0-ALARM" atan_of_zeros_alarms = false, "ATAN[0]/[0] raises PS0119 instead of returning 0";
    "TAN-90-ALARM" tan_90_alarms = false, "TAN[90] raises PS0119 instead of returning a large number";
    "G53-IN-G91" g53_moves_in_g91 = false, "G53 in G91 moves by the increment instead of not moving";
    "K0-MOVES" k0_positions = false, "a canned cycle with K0 moves in the plane";
    "SKIP-KEEPS-END" skip_keeps_end = false, "#5001.. after a skipped G31 are the commanded end, not the position of the signal";
    "G31-R" skip_takes_r = true, "R beside G31 selects a skip signal, as P does; otherwise SIM0001";
    "G43-MOVES" length_moves_at_once = true, "G43 H or G49 without an axis moves by the offset at once";
    "TAP-DWELL-R" tap_dwells_at_r = true, "G84 and G74 dwell at the R point level as well";
    "SMALL-R-ALARM" small_radius_alarms = true, "an arc whose R is too small raises PS0020 instead of becoming a half circle";
    "TWO-ASSIGNMENTS" allows_several_assignments = false, "several assignments in a block are accepted";
    "ASSIGN-GOTO" allows_goto_after_assignment = false, "a GOTO behind assignments in a block is accepted";
    "EOB-IN-LINE" semicolon_ends_block = true, "a block behind `;` in a line is executed instead of raising PS0004";
    "SIGNS" allows_relation_signs = false, "conditions accept = <> > >= < <= & and |";
    "SHORT-WORDS" allows_short_words = true, "statement keywords may be abbreviated to two letters: WH GO EN TH PO PC DP BP SE";
    "LOWER-CASE" reads_lower_case = true, "lower case is read as capitals instead of raising PS0004";
    "LARGE-ALARMS" shows_large_alarm_numbers = true, "#3000=n shows a number that is too large instead of raising PS0119";
    "M98-NO-P-311" missing_p_is_311 = false, "M98 without P is PS0311, not PS0076";
    "DWELL-COMPUTED" computed_dwell_is_seconds = true, "with DWELL-SECONDS a computed P of a dwell is seconds, not milliseconds";
    "CODES-BEFORE-CALL" allows_codes_before_call = true, "modal codes, F, S, T, D, H and M before G65, G66 or G66.1 act first; otherwise PS0125";
    "M06-STOPS-SPINDLE" tool_change_stops_spindle = true, "M06 stops the spindle";
    "M00-STOPS-SPINDLE" stop_stops_spindle = false, "M00 and M01 stop the spindle";
    "TRANSFORM-RETURNS" returns_in_transforms = false, "G27 to G30 and G53 move in G68 and G51.1 as without them; otherwise SIM0001";
    "PLANE-TURNS" plane_turns_with_axes = false, "a rotary axis that moves after G53.1 takes the plane with it; otherwise the plane stays where G53.1 left it";
    "G268-TURNS" feature_axes_turn = false, "I, J and K of G268 are about axes that turn with one another, not about those of the work system";
    "IJK-INCREMENTS" directions_have_increments = false, "I J K of a direction (G43.5, G68, G68.2 P3) are cut off at the increment instead of counting with all their digits";
    "PROGRAM-ZERO" reads_program_zero = true, "a program O0 runs: the operator gives it a number when it is read; otherwise PS0074";
    "G72-AT-START" line_starts_here = true, "the first hole of G72 is at the tool's position, not at the distance I from it";
    "M06-HOMES-Z" tool_change_homes_z = false, "M06 sends Z to machine zero before the tool changes";
}

impl Settings {
    /// Sets a setting, an input or a code that calls a program, from the text of its value.
    ///
    /// A setting has a key (`NAT`, `5115`), an input its variable (`#1005`). A code is given by itself (`G201`,
    /// `M50`, `T`) or by its parameter (`6050`).
    pub fn set(&mut self, key: &str, value: &str) -> Result<(), SettingError> {
        let bad = |allowed: &dyn std::fmt::Display| {
            let allowed = allowed.to_string();
            SettingError::Value { key: key.to_owned(), value: value.to_owned(), allowed }
        };
        if let Some(row) = ROWS.iter().find(|row| row.key.eq_ignore_ascii_case(key)) {
            return (row.set)(self, value.trim()).ok_or_else(|| bad(&row.values.refusal(value.trim())));
        }
        if let Some(number) = key.strip_prefix('#') {
            if let Some(stated) = MachineValues::key(number) {
                let set = self.machine_values.set(stated, value);
                return set.ok_or_else(|| bad(&MachineValues::ALLOWED));
            }
            let bit = number.parse().ok().filter(|n| INPUTS.contains(n)).map(|n: u32| n - INPUTS.start());
            let bit = bit.ok_or_else(|| SettingError::Unknown { key: key.to_owned() })?;
            let on = switch(value).ok_or_else(|| bad(&SettingValues::Switch))?;
            self.inputs = if on { self.inputs | 1 << bit } else { self.inputs & !(1 << bit) };
            return Ok(());
        }
        let unknown = || SettingError::Unknown { key: key.to_owned() };
        if let Some(number) = key.parse().ok().filter(|n| self.code_calls.parameter(*n).is_some()) {
            let set = value.trim().parse().ok().and_then(|v| self.code_calls.set_parameter(number, v));
            return set.ok_or_else(|| bad(&"the code that calls, 0 for none"));
        }
        // What follows is about codes: G201, M-3, T.
        let is_code = |rest: &str| rest.chars().all(|c| c.is_ascii_digit() || ['-', '.'].contains(&c));
        if !key.starts_with(|c: char| c.is_ascii_alphabetic()) || !is_code(&key[1..]) {
            return Err(unknown());
        }
        if let Some(effect) = choice(value.trim(), &DeclaredEffect::ALL) {
            return self.declared_codes.set(key, effect).ok_or_else(unknown);
        }
        if value.trim().eq_ignore_ascii_case("P") {
            return self.code_calls.set_code_with_p(key).ok_or_else(unknown);
        }
        let number = value.trim().trim_start_matches(['O', 'o']);
        let allowed = "a program number, P, nothing or wait";
        let program = whole(number, 1, 99_999_999).ok_or_else(|| bad(&allowed))? as u32;
        self.code_calls.set_code(key, program).ok_or_else(unknown)
    }
}

fn switch(value: &str) -> Option<bool> {
    match value {
        "0" => Some(false),
        "1" => Some(true),
        _ => None,
    }
}

fn choice<T: Copy>(value: &str, all: &[(&str, T)]) -> Option<T> {
    all.iter().find(|(name, _)| name.eq_ignore_ascii_case(value)).map(|(_, choice)| *choice)
}

fn between(value: &str, min: f64, max: f64) -> Option<f64> {
    value.parse().ok().filter(|v| (min..=max).contains(v))
}

fn whole(value: &str, min: usize, max: usize) -> Option<usize> {
    value.parse().ok().filter(|v| (min..=max).contains(v))
}

/// Reads a position, `X10,Z-5`; axes not named are at 0.
fn point(settings: &Settings, value: &str) -> Option<Position> {
    limits(&settings.axes, value).map(|limits| Position(limits.map(Option::unwrap_or_default)))
}

/// Reads the limits of the named axes, `X400,Z0`.
fn limits(axes: &Axes, value: &str) -> Option<[Option<f64>; MAX_AXES]> {
    let mut limits = [None; MAX_AXES];
    for word in value.split(',').map(str::trim) {
        let letter = word.bytes().next()?.to_ascii_uppercase();
        limits[axes.find(letter)?] = Some(between(word.get(1..)?, -1e6, 1e6)?);
    }
    Some(limits)
}

fn roll_over(settings: &mut Settings, letters: &str) -> Option<()> {
    for letter in letters.bytes().filter(|b| *b != b'+') {
        let axis = settings.axes.find(letter.to_ascii_uppercase())?;
        if !settings.axes.is_rotary(axis) {
            return None;
        }
        settings.rolls_over[axis] = true;
    }
    Some(())
}

fn skip_switches(settings: &mut Settings, value: &str) -> Option<()> {
    for number in value.split('+') {
        let switch = whole(number, 1, 9)?;
        settings.skip_switches[switch - 1] = true;
    }
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_are_set_by_key() {
        let mut settings = Settings::default();
        assert!(settings.set("G120.1", "nothing").is_ok() && settings.set("M77", "wait").is_ok());
        assert_eq!(settings.declared_codes.find(b'G', 1201), Some(DeclaredEffect::Nothing));
        assert!(settings.set("X5", "nothing").is_err() && settings.set("M7.5", "wait").is_err());
        for (key, value) in
            [("NAT", "1"), ("BDT", "1+3"), ("ROA", "A"), ("5115", "0.2"), ("#1005", "1"), ("G201", "9010")]
        {
            settings.set(key, value).unwrap();
        }
        assert!(settings.returns_signed_angles && settings.rolls_over[3]);
        assert_eq!(settings.skip_switches.map(u8::from), [1, 0, 1, 0, 0, 0, 0, 0, 0]);
        assert_eq!((settings.g83_clearance, settings.inputs), (0.2, 1 << 5));
        assert_eq!(settings.code_calls.find_call(b'G', 2010).map(|called| called.program), Some(9010));
    }

    #[test]
    fn a_refusal_names_the_key_and_the_permitted_values() {
        let mut settings = Settings::default();
        let error = |r: Result<(), SettingError>| r.unwrap_err().to_string();
        assert_eq!(error(settings.set("NAT", "2")), "setting NAT is '2': 0 or 1");
        assert!(error(settings.set("NOPE", "1")).starts_with("no setting 'NOPE': see"));
        assert!(error(settings.set("NATT", "1")).starts_with("no setting 'NATT' (did you mean 'NAT'?): see"));
        assert!(error(settings.set("dialekt", "fanuc-31i")).contains("(did you mean 'DIALECT'?)"));
        assert!(error(settings.set("ROA", "X")).contains("letters of rotary axes"));
    }

    #[test]
    fn keys_are_unique() {
        for (i, row) in ROWS.iter().enumerate() {
            assert!(ROWS[..i].iter().all(|other| other.key != row.key), "{}", row.key);
        }
    }
}
