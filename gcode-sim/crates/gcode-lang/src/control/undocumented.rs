//! Behaviour of controls where manuals are silent or contradict one another, one field for each point.

/// Choices of the simulator where manuals are silent or contradict one another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UndocumentedChoices {
    /// `-#1` with #1 vacant stays vacant in an expression instead of becoming 0.
    pub minus_keeps_vacancy: bool,
    /// `[#1]` with #1 vacant stays vacant instead of becoming 0.
    pub brackets_keep_vacancy: bool,
    /// A literal finer than the increment is rounded, not truncated.
    pub rounds_literals: bool,
    /// GOTO takes the first of several equal N of the program, not the next one downwards.
    pub goto_takes_first_number: bool,
    /// `IF[…]THEN GOTO n` is accepted.
    pub then_takes_goto: bool,
    /// G65 … L sets the arguments again for every repeat.
    pub repeats_reset_locals: bool,
    /// G66.1 with arguments in its block calls the macro at once.
    pub every_block_calls_itself: bool,
    /// A modal macro call keeps its locals from its last call.
    pub modal_keeps_locals: bool,
    /// `GOTO-n` searches upwards instead of raising PS1128.
    pub minus_searches_up: bool,
    /// A GOTO without its target raises PS0078 instead of PS0128.
    pub missing_target_is_78: bool,
    /// AND, OR and XOR of a negative number raise PS0119 instead of working on two's complements.
    pub negative_bits_alarm: bool,
    /// #5001… under mirror, scaling and rotation are the transformed coordinates, not the programmed ones.
    pub shows_transformed: bool,
    /// POW, MOD and ATAN with a comma are available.
    pub has_new_functions: bool,
    /// `ATAN[0]/[0]` raises PS0119 instead of returning 0.
    pub atan_of_zeros_alarms: bool,
    /// `TAN[90]` raises PS0119 instead of returning a large number.
    pub tan_90_alarms: bool,
    /// G53 in G91 moves by the increment instead of not moving.
    pub g53_moves_in_g91: bool,
    /// A drilling block with K0 moves in the plane.
    pub k0_positions: bool,
    /// #5001… after a skipped G31 are the commanded end, not the position of the signal.
    pub skip_keeps_end: bool,
    /// `G43 H` without an axis word moves the axis by the offset at once.
    pub length_moves_at_once: bool,
    /// G84 and G74 dwell P at the R level as well.
    pub tap_dwells_at_r: bool,
    /// G67 without G66 raises PS1100.
    pub g67_alarms: bool,
    /// An arc whose R is too small to reach its end raises PS0020 instead of becoming a half circle.
    pub small_radius_alarms: bool,
    /// Several assignments in a block are accepted.
    pub allows_several_assignments: bool,
    /// Conditions may be written with `=`, `<>`, `>`, `>=`, `<`, `<=`, `&` and `|`.
    pub allows_relation_signs: bool,
    /// Statement keywords may be abbreviated to two letters.
    pub allows_short_words: bool,
    /// Lower case is read as capitals instead of raising PS0004.
    pub reads_lower_case: bool,
    /// `#3000=n` shows a number that is too large instead of raising PS0119.
    pub shows_large_alarm_numbers: bool,
    /// M98 without P raises PS0311 instead of PS0076.
    pub missing_p_is_311: bool,
    /// M06 stops the spindle, as a tool changer requires.
    pub tool_change_stops_spindle: bool,
    /// Unit of an argument E without a point.
    pub argument_e: ArgumentScale,
    /// Unit of an argument F without a point.
    pub argument_f: ArgumentScale,
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

impl Default for UndocumentedChoices {
    fn default() -> Self {
        Self {
            minus_keeps_vacancy: false,
            brackets_keep_vacancy: true,
            rounds_literals: false,
            goto_takes_first_number: false,
            then_takes_goto: false,
            repeats_reset_locals: false,
            every_block_calls_itself: true,
            modal_keeps_locals: true,
            minus_searches_up: false,
            missing_target_is_78: false,
            negative_bits_alarm: false,
            shows_transformed: false,
            has_new_functions: true,
            atan_of_zeros_alarms: false,
            tan_90_alarms: false,
            g53_moves_in_g91: false,
            k0_positions: false,
            skip_keeps_end: false,
            length_moves_at_once: true,
            tap_dwells_at_r: true,
            g67_alarms: true,
            small_radius_alarms: true,
            allows_several_assignments: false,
            allows_relation_signs: false,
            allows_short_words: true,
            reads_lower_case: true,
            shows_large_alarm_numbers: true,
            missing_p_is_311: false,
            tool_change_stops_spindle: true,
            argument_e: ArgumentScale::Whole,
            argument_f: ArgumentScale::Feed,
        }
    }
}
