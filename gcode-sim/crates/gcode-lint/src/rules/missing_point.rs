//! Rule: a missing decimal point. Without calculator-type input `Z-3` is 0.003 mm.
//!
//! Programs that count in increments throughout (`X45000`) are exempt: they have no decimal point, and a
//! number of 1 mm or more.
use std::cell::LazyCell;
use std::collections::{BTreeMap, BTreeSet};

use gcode_lang::control::Settings;
use gcode_lang::program::code_facts::Measured;
use gcode_lang::program::g_codes::{Effect, GCodeRow, OneShot};
use gcode_lang::program::modes::{Motion, Unit};
use gcode_lang::program::{LoweredWord, WordOperand, Words, m_codes};
use gcode_lang::source::SourceId;
use gcode_lang::syntax::ast::Decimal;

use crate::ControlKnowledge;
use crate::literal::{self, without_point};
use crate::parameters;
use crate::prelude::*;
use crate::units::unit_in_force;

pub(super) static RULE: Rule = Rule::new(
    "missing-point",
    Severity::Warning,
    "a number without a decimal point that counts thousandths",
    find,
);

/// Number of increments from which a peck or a dwell may be intended: many programs write `G4 X500`.
const MIN_INTENDED_INCREMENTS: u64 = 100;

/// Feed in mm or inch a minute from which a number of increments may be intended.
const MIN_INTENDED_FEED: f64 = 1.0;

fn find(context: &CheckContext<'_>, unit: &ProgramUnit<'_>) -> Vec<Diagnostic> {
    let settings = context.settings;
    if settings.uses_calculator_input {
        return Vec::new();
    }
    // The pieces of a program count together.
    if unit.piece.is_none() && point_counts(unit, settings).are_increments() {
        return Vec::new();
    }
    let found = numbers_without_point(context, unit);
    if unit.piece.is_some() {
        return found;
    }
    let calculator_files = context.calculator_files.get_or_init(|| calculator_files(context));
    if found.is_empty() || !calculator_files.contains(&unit.program.span.source) {
        return found;
    }
    // Such a file is written for another setting, which is one fault.
    let is_first = |other: &&ProgramUnit<'_>| !numbers_without_point(context, other).is_empty();
    if programs_of_file(context, unit).find(is_first).is_some_and(|first| first.id != unit.id) {
        return Vec::new();
    }
    let others = found.len().saturating_sub(1);
    found.into_iter().next().map(|first| as_whole(first, others, context.knowledge)).into_iter().collect()
}

/// Returns the finding about a file that hardly has a point.
pub(crate) fn as_whole(first: Diagnostic, others: usize, knowledge: ControlKnowledge) -> Diagnostic {
    let message =
        format!("{}, and so with {others} more: hardly a number of the program has a point", first.message);
    let help = "write the points, or give --control DPI=1 for a control with calculator-type input";
    knowledge.unless_optional(Diagnostic { message, ..first }.help(help))
}

/// Numbers of a program that are lengths, angles or seconds.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct PointCounts {
    /// Numbers other than 0 with a point.
    pub pointed: usize,
    /// Numbers other than 0 without one.
    without: usize,
    /// A number, which may be 0, has a point.
    has_point: bool,
    /// A number is 1 mm or more if it counts increments.
    is_large: bool,
}

impl PointCounts {
    /// Adds the numbers of another program, or of another piece of the same one.
    pub(crate) fn add(&mut self, other: Self) {
        self.pointed += other.pointed;
        self.without += other.without;
        self.has_point |= other.has_point;
        self.is_large |= other.is_large;
    }

    /// Returns true for a program that counts in increments on purpose: it has no decimal point, and a number of 1 mm or more.
    pub(crate) fn are_increments(self) -> bool {
        !self.has_point && self.is_large
    }

    /// Returns true if hardly a number has a point.
    pub(crate) fn hardly_have_points(self) -> bool {
        self.without >= MANY_NUMBERS.max(POINTLESS_FOR_EACH_POINTED * self.pointed)
    }
}

/// Returns what is counted in a program, with the blocks that are left out.
pub(crate) fn point_counts(unit: &ProgramUnit<'_>, settings: &Settings) -> PointCounts {
    let mut counts = PointCounts { pointed: unit.left_out.points, ..PointCounts::default() };
    for number in numbers(unit, settings) {
        let (has_point, is_zero) = (number.places.is_some(), number.digits == 0);
        counts.pointed += usize::from(has_point && !is_zero);
        counts.without += usize::from(!has_point && !is_zero);
        counts.has_point |= has_point;
        counts.is_large |= number.digits as f64 >= settings.increment.per_unit();
    }
    counts
}

/// Number of numbers without a point from which a file that hardly has a point is one finding.
const MANY_NUMBERS: usize = 4;

/// Numbers without a point for each with one in a file that hardly has a point.
const POINTLESS_FOR_EACH_POINTED: usize = 9;

/// Returns the files that are written for calculator-type input: hardly a length in them has a point.
fn calculator_files(context: &CheckContext<'_>) -> BTreeSet<SourceId> {
    let mut counts: BTreeMap<SourceId, PointCounts> = BTreeMap::new();
    for unit in &context.units {
        counts.entry(unit.program.span.source).or_default().add(point_counts(unit, context.settings));
    }
    let files = counts.into_iter().filter(|(_, counts)| counts.hardly_have_points());
    files.map(|(source, _)| source).collect()
}

/// Iterates over the programs under check in the file of a program.
fn programs_of_file<'c, 'a>(
    context: &'c CheckContext<'a>,
    unit: &ProgramUnit<'_>,
) -> impl Iterator<Item = &'c ProgramUnit<'a>> {
    let source = unit.program.span.source;
    context.units.iter().filter(move |other| other.program.span.source == source)
}

/// Returns a finding for each number without a point.
fn numbers_without_point(context: &CheckContext<'_>, unit: &ProgramUnit<'_>) -> Vec<Diagnostic> {
    let settings = context.settings;
    let unit_of_lengths = LazyCell::new(|| unit_in_force(context, unit));
    let parameters = parameters::parameter_blocks(unit.program);
    let mut found = Vec::new();
    for (block, words) in unit.reached_words().filter(|(block, _)| !parameters[*block]) {
        let codes = BlockCodes::of(words);
        // What a macro that is not here makes of its arguments is unknown.
        let calls_unknown = words.call().is_some_and(|call| !call.arguments.is_empty())
            && unit.call_in(block).is_none_or(|call| context.called_unit(call).is_none());
        let severity = if calls_unknown { Severity::Note } else { RULE.kind.severity };
        for word in codes.measured_words(settings) {
            let Some(number) = without_point(word) else { continue };
            let is_peck = word.letter == b'Q' && words.call().is_none() && !codes.mills_pocket();
            let is_count = is_peck || codes.measured == Measured::Seconds;
            if is_count && number.digits >= MIN_INTENDED_INCREMENTS {
                continue;
            }
            let values = codes.values(word, number, settings, *unit_of_lengths);
            if word.letter == b'F' && values.iter().any(|(value, _)| *value >= MIN_INTENDED_FEED) {
                continue;
            }
            let written = spelled(word.letter, number);
            let message = format!("{written} is {}", meaning(&values));
            let finding = unit.finding(&RULE.kind, block, message).with_span(word.span);
            // A macro that counts with whole numbers is right where they stay such.
            let otherwise = match words.call() {
                Some(_) => {
                    ", or give --control DPI=1 for a control that takes it as written (3401#0, setting 162 of a Haas)"
                }
                None => "",
            };
            found.push(finding.with_severity(severity).help(format!("write {written}.{otherwise}")));
        }
    }
    found
}

/// Spells the values that a number may have, `0.003 mm`.
fn meaning(values: &[(f64, &str)]) -> String {
    match values {
        [(first, unit), (second, other)] if unit == other => format!("{first} or {second} {unit}"),
        _ => values.iter().map(|(value, unit)| format!("{value} {unit}")).collect::<Vec<_>>().join(" or "),
    }
}

/// Iterates over the literals that are lengths, angles or seconds.
fn numbers<'a>(unit: &'a ProgramUnit<'_>, settings: &'a Settings) -> impl Iterator<Item = Decimal> + 'a {
    let words = unit.program.ops().iter().filter_map(|op| op.kind().words());
    words.flat_map(|words| {
        let literal = |word: &LoweredWord| match word.value {
            WordOperand::Literal(number) => Some(number),
            _ => None,
        };
        BlockCodes::of(words).measured_words(settings).filter_map(literal).collect::<Vec<_>>()
    })
}

/// Words of a block, with what its G codes make of them.
struct BlockCodes<'w> {
    words: &'w Words,
    /// Rows of its G codes, each once and on the first control that has it.
    rows: Vec<&'static GCodeRow>,
    /// Words that are measured; the code that leaves fewest takes precedence.
    measured: Measured,
    /// K counts repeats: it is a length only in an arc or with I or J.
    counts_by_k: bool,
}

impl<'w> BlockCodes<'w> {
    fn of(words: &'w Words) -> Self {
        let mut rows: Vec<&'static GCodeRow> = Vec::new();
        for row in words.g_codes().filter_map(|found| found.row_for_any()) {
            if !rows.iter().any(|other| std::ptr::eq(*other, row)) {
                rows.push(row);
            }
        }
        let measured = rows.iter().map(|row| row.facts.words.measured).max().unwrap_or(Measured::AsInMove);
        let codes = Self { words, rows, measured, counts_by_k: false };
        let is_arc = codes
            .has(|effect| matches!(effect, Effect::Motion(Motion::Clockwise | Motion::Counterclockwise)));
        let counts_by_k = !is_arc && !words.list.iter().any(|word| matches!(word.letter, b'I' | b'J'));
        Self { counts_by_k, ..codes }
    }

    /// Returns true if one of the codes has an effect.
    fn has(&self, is_one: impl Fn(&Effect) -> bool) -> bool {
        self.rows.iter().any(|row| is_one(&row.effect))
    }

    /// Returns true for G12, G13 and G150 of a Haas: their Q is a step or an allowance.
    fn mills_pocket(&self) -> bool {
        self.has(|effect| matches!(effect, Effect::OneShot(OneShot::CirclePocket(_) | OneShot::Pocket)))
    }

    /// Returns true for a tapping cycle.
    fn taps(&self) -> bool {
        self.has(|effect| matches!(effect, Effect::Cycle(Some(cycle)) if cycle.taps()))
    }

    /// Iterates over the words that are lengths, angles or seconds.
    fn measured_words(&self, settings: &Settings) -> impl Iterator<Item = &'w LoweredWord> {
        let plain = self.words.list.iter().filter(move |word| self.is_measure(word, settings));
        // The arguments of a macro call that a control scales: all but D E F H M S T.
        let arguments = self.words.call().into_iter().flat_map(|call| &call.arguments);
        let scaled = arguments.filter(|word| b"ABCIJKQRUVWXYZ".contains(&word.letter));
        plain.filter(move |word| word.letter != b'K' || !self.counts_by_k).chain(scaled)
    }

    fn is_measure(&self, word: &LoweredWord, settings: &Settings) -> bool {
        let is_axis = settings.axes.find(word.letter).is_some();
        match (self.measured, word.letter) {
            (Measured::Nothing, _) => false,
            (Measured::Seconds, letter) => matches!(letter, b'X' | b'U'),
            (Measured::ByTable, letter) => match parameters::data_input_kind(self.words) {
                Some(2 | 20) => is_axis,
                Some(1 | 10..=13) => letter == b'R',
                _ => false,
            },
            (Measured::AsInMove, b'Q') => {
                let is_peck =
                    |effect: &Effect| matches!(effect, Effect::Cycle(Some(cycle)) if cycle.uses_q());
                self.mills_pocket() || self.has(is_peck)
            }
            // Setting 77 of a Haas.
            (Measured::AsInMove | Measured::Axes, b'F') => settings.feed_in_increments,
            // J of a tapping cycle of a Haas multiplies the speed of the retract.
            (Measured::AsInMove, b'J') if self.taps() => false,
            (Measured::AsInMove, b'I' | b'J' | b'K' | b'R') => !self.are_of_m_code(settings),
            (Measured::AsInMove, b'C') if word.comma => true,
            (Measured::AsInMove | Measured::Axes, _) => is_axis,
        }
    }

    /// Returns true if I, J, K and R go to the logic of an M code: the block has one of the machine builder, no G code and no axis.
    fn are_of_m_code(&self, settings: &Settings) -> bool {
        let is_axis = |word: &&LoweredWord| settings.axes.find(word.letter).is_some();
        let is_of_builder = |word: &LoweredWord| {
            let code = (word.letter == b'M').then(|| literal::word_count(word)).flatten();
            code.is_some_and(|code| m_codes::find(code, settings.codes).is_none())
        };
        self.rows.is_empty()
            && !self.words.list.iter().any(|word| is_axis(&word))
            && self.words.list.iter().any(is_of_builder)
    }

    /// Returns the value of a number with its unit: two of a length if its unit is unknown.
    fn values(
        &self,
        word: &LoweredWord,
        number: Decimal,
        settings: &Settings,
        unit: Option<Unit>,
    ) -> Vec<(f64, &'static str)> {
        let is_argument = self.words.call().is_some();
        let value = number.value() / settings.increment.per_unit();
        let inches = number.value() / (settings.increment.per_unit() * 10.0);
        let in_unit = |unit: Unit| match (unit, is_argument, word.letter) {
            (Unit::Metric, true, _) => (value, "for the macro"),
            (Unit::Inch, true, _) => (inches, "for the macro"),
            (Unit::Metric, false, b'F') => (value, "mm/min"),
            (Unit::Inch, false, b'F') => (inches, "inch/min"),
            (Unit::Metric, false, _) => (value, "mm"),
            (Unit::Inch, false, _) => (inches, "inch"),
        };
        match unit {
            _ if self.measured == Measured::Seconds => vec![(value, "seconds")],
            _ if self.is_angle(word) => vec![(value, if is_argument { "for the macro" } else { "degrees" })],
            Some(unit) => vec![in_unit(unit)],
            None => vec![in_unit(Unit::Metric), in_unit(Unit::Inch)],
        }
    }

    /// Returns true for a word in degrees; C behind a comma is the length of a chamfer.
    fn is_angle(&self, word: &LoweredWord) -> bool {
        match word.letter {
            b'C' if word.comma => false,
            b'A' | b'B' | b'C' => true,
            letter => self.rows.iter().any(|row| row.facts.words.angles.has(letter)),
        }
    }
}

fn spelled(letter: u8, number: Decimal) -> String {
    let sign = if number.negative { "-" } else { "" };
    format!("{}{sign}{}", char::from(letter), number.digits)
}

#[cfg(test)]
mod tests {
    use super::super::testing::{NOWHERE, lines, messages};
    use super::RULE;
    use crate::check;
    use gcode_lang::control::Settings;
    use gcode_lang::diag::Severity;
    use gcode_lang::program::NoLibrary;

    #[test]
    fn a_missing_point_is_reported() {
        let found =
            messages(&RULE, "O1\nG0 X10. Y20.\nG1 Z-3 F100\nG4 X2\nG0 B90\nG65 P2 A5\nM30\nO2\nM99\n");
        assert_eq!(
            found,
            ["Z-3 is -0.003 mm", "X2 is 0.002 seconds", "B90 is 0.09 degrees", "A5 is 0.005 for the macro"]
        );
    }

    /// Setting 77 of a Haas: F10 is 0.001 inch/min. From 1 inch or mm a minute on the increments may be meant.
    #[test]
    fn a_feed_of_a_haas_without_a_point_is_reported_below_one_unit_a_minute() {
        let messages = |text: &str| {
            let mut settings = Settings::default();
            settings.apply_dialect(gcode_lang::control::Dialect::HaasNgc);
            let found = check("O1.nc", text.as_bytes(), &settings, &mut NoLibrary).findings;
            let of_rule = found.into_iter().filter(|finding| finding.code() == "missing-point");
            of_rule.map(|finding| finding.message).collect::<Vec<_>>()
        };
        assert_eq!(messages("O1\nG20\nG1 X1.5 F10\nM30\n"), ["F10 is 0.001 inch/min"]);
        assert_eq!(messages("O1\nG21\nG1 X1.5 F999\nM30\n"), ["F999 is 0.999 mm/min"]);
        assert_eq!(messages("O1\nG21\nG1 X1.5 F1000\nX2.5 F10.\nM30\n"), [""; 0]);
        assert_eq!(messages("O1\nG20\nG1 X1.5 F10000\nX2.5 F#1\nM30\n"), [""; 0]);
        assert_eq!(lines(&RULE, "O1\nG1 X1.5 F10\nM30\n"), NOWHERE, "a Fanuc");
    }

    /// 12 increments are 0.0012 inch where the control, a caller or a called program is in inch, and 0.012 mm otherwise.
    #[test]
    fn a_number_counts_in_the_unit_in_force() {
        let of = |inch: Option<bool>, text: &str| {
            let settings = Settings { is_inch_at_power_on: inch, ..Settings::default() };
            let found = check("O1.nc", text.as_bytes(), &settings, &mut NoLibrary).findings;
            let of_rule = found.into_iter().filter(|finding| finding.code() == "missing-point");
            of_rule.map(|finding| finding.message).collect::<Vec<_>>().join("; ")
        };
        let plain = "O1\nG0 X1.5\nX12\nM30\n";
        assert_eq!(of(None, plain), "X12 is 0.012 mm");
        assert_eq!(of(Some(false), plain), "X12 is 0.012 mm");
        assert_eq!(of(Some(true), plain), "X12 is 0.0012 inch");
        assert_eq!(of(Some(true), "O1\nG21\nG0 X1.5\nX12\nM30\n"), "X12 is 0.012 mm");
        let called = |head: &str| format!("O1\n{head}G0 X1.5\nM98 P2\nM30\nO2\nX12\nY3.\nM99\n");
        assert_eq!(of(None, &called("")), "X12 is 0.012 mm");
        assert_eq!(of(Some(true), &called("")), "X12 is 0.0012 inch");
        assert_eq!(of(None, &called("G20\n")), "X12 is 0.0012 inch");
        assert_eq!(of(Some(true), &called("G21\n")), "X12 is 0.012 mm");
        assert_eq!(of(None, &called("G20\nM98 P2\nG21\n")), "X12 is 0.012 mm or 0.0012 inch");
        let sets = "O1\nM98 P2\nG0 X1.5\nX12\nM30\nO2\nG20\nM99\n";
        assert_eq!(of(None, sets), "X12 is 0.0012 inch");
        let resident = "O9010\nG0 X1.5\nX12\nG65 P2 X5 Y1.\nM99\n";
        assert_eq!(
            of(Some(true), resident),
            "X12 is 0.012 mm or 0.0012 inch; X5 is 0.005 or 0.0005 for the macro"
        );
        let in_circle = "O1\nM98 P2\nM30\nO2\nG0 X1.5\nX12\nIF[#1EQ1]GOTO1\nM98 P3\nN1M99\nO3\nM98 P2\nM99\n";
        assert_eq!(of(Some(true), in_circle), "X12 is 0.0012 inch");
        assert_eq!(
            of(Some(true), "O1\nG0 X1. A5 C7.\nG4 X5\nM30\n"),
            "A5 is 0.005 degrees; X5 is 0.005 seconds"
        );
    }

    #[test]
    fn an_argument_of_a_macro_that_is_not_here_is_a_note() {
        let severity = |text: &str| {
            let found = check("O1.nc", text.as_bytes(), &Settings::default(), &mut NoLibrary).findings;
            found.into_iter().find(|finding| finding.code() == "missing-point").unwrap().severity
        };
        assert_eq!(severity("O1\nG65 P9810 A5 Z1.\nM30\n"), Severity::Note);
        assert_eq!(severity("O1\nG65 P2 A5 Z1.\nM30\nO2\n#100=#1\nM99\n"), Severity::Warning);
        assert_eq!(severity("O1\nG65 P9810 Z1.\nG00 X5\nM30\n"), Severity::Warning);
    }

    #[test]
    fn a_program_without_any_point_is_one_finding() {
        let text = "O1\nG0 X10 Y20\nG1 Z-3 F100\nX45\nM30\n";
        assert_eq!(
            messages(&RULE, text),
            ["X10 is 0.01 mm, and so with 3 more: hardly a number of the program has a point"]
        );
        assert_eq!(lines(&RULE, &text.replace("X45", "X45.5")), [2, 2, 3], "one of four has a point");
        let longer = text.replace("M30", "X1\nX2\nX3\nX4\nX5\nX6\nX7.5\nM30");
        assert_eq!(lines(&RULE, &longer), [2], "one of eleven has a point");
        assert_eq!(lines(&RULE, &longer.replace("X1\n", "X1.\n")).len(), 9, "two have one");
        let two = format!("{longer}O2\nG0 X7\nM30\n");
        assert_eq!(lines(&RULE, &two), [2], "the file is one finding");
    }

    /// M138 P100 R20 of a Haas varies the speed; beside an axis R is a radius.
    #[test]
    fn words_of_an_m_code_are_no_lengths() {
        assert_eq!(lines(&RULE, "O1\nG0 X1.5\nM138 P100 R20\nM30\n"), NOWHERE);
        assert_eq!(lines(&RULE, "O1\nG2 X1.5 R5.\nM138 X3.5 R20\nM30\n"), [3]);
        assert_eq!(lines(&RULE, "O1\nG2 X1.5 R5.\nM8 R20\nM30\n"), [3]);
    }

    /// Moves and calls that a check leaves out have points too: 9 numbers without one for each with one are hardly any.
    #[test]
    fn points_of_repeated_blocks_count() {
        let found = |blocks: &str, count: usize| {
            messages(&RULE, &format!("O1\nG90\n{}{}M30\n", blocks.repeat(count), "Z5\n".repeat(54))).len()
        };
        assert_eq!((found("X1.\n", 7), found("X1.\n", 6)), (54, 1));
        assert_eq!((found("G65 P9810 X1. F5.\n", 7), found("G65 P9810 X1. F5.\n", 6)), (54, 1));
        assert_eq!(found("X0. F5.\n", 100), 1, "0 and feeds are no lengths that need a point");
    }

    #[test]
    fn offsets_and_angles_of_codes_are_measured() {
        let text =
            "O1\nG0 X1.\nG10 L2 P1 X-100 Y0\nG10 L10 P1 R50\nG68 X0 Y0 R45\nG69\nG51 X10 Y0 P2000\nM30\n";
        let found = messages(&RULE, text);
        assert_eq!(found, ["X-100 is -0.1 mm", "R50 is 0.05 mm", "R45 is 0.045 degrees", "X10 is 0.01 mm"]);
        let tilted = messages(&RULE, "O1\nG68.2 X0 Y0 Z0 I0 J90 K0\nG0 Z5.\nM30\n");
        assert_eq!(tilted, ["J90 is 0.09 degrees"]);
    }

    #[test]
    fn counts_zeros_and_increments_are_accepted() {
        for text in [
            "O1\nG0 X0 Y0.5\nG43 H1 Z100.\nM98 P2 L3\nG4 P500\nM30\nO2\nM99\n",
            "O1\nG0 X45000 Y500\nG1 Z-3000 F200\nM30\n",
            "O1\nG83 X1. Y1. Z-20. R2. Q500 K3 F100\nM30\n",
            "O1\nS500\nG84 X1. Z-9. R2. J4 F500.\nM30\n",
            "O1\n#1=3\nG4 X500\nG0 X#1 Y[5]\nG10 L2 P1 X1.\nG51 X0 Y0 I2000 J2000\nM30\n",
            "O1\nG65 P2 A5. D3 H2 T1 S5\nM30\nO2\nM99\n",
            "O1\nG0 X1.\nG10 L52\nN6004 Q0 R1\nN1241 P1 R5.\nG11\nM30\n",
            "O1\nG0 X1.\nG10 L3\nP1 L10\nG11\nM30\n",
        ] {
            assert_eq!(lines(&RULE, text), NOWHERE, "{text}");
        }
    }
}
