//! Families of controls as data: the settings that `--control` selects.
use super::{Dialect, Settings};

/// Settings of a family of controls; a later setting overrides them.
#[derive(Debug)]
struct DialectRow {
    dialect: Dialect,
    /// Family whose settings apply first.
    base: Option<Dialect>,
    /// Keys of [`super::ROWS`] with their values.
    settings: &'static [(&'static str, &'static str)],
}

/// All families; settings that a row omits have their default.
///
/// Sources: 31i and 0i-F, operator's manuals B-64484EN and B-64604EN; Haas, Mill Operator's Manual 96-8210,
/// and its predecessor 96-8000 where that is silent.
#[rustfmt::skip]
const DIALECTS: &[DialectRow] = &[
    DialectRow { dialect: Dialect::Fanuc31i, base: None, settings: &[
        ("CODES", "fanuc-31i"), ("MACRO-LEVELS", "5"), ("CALL-LEVELS", "15"), ("OFFSETS", "400"), ("WORK-SYSTEMS", "300"),
        ("MORE-COMMONS", "98000-98499"), ("ALIASED-COMMONS", "0"), ("VARIABLE-BITS", "0"), ("OFFSET-VARIABLES", "fanuc"),
        ("ALARM-BASE", "3000"), ("ALARM-MOST", "200"), ("PRINT-EXPANDS", "0"), ("PRINT-DIGITS", "8"),
        ("PLAIN-IF", "0"), ("VALUE-CONDITIONS", "0"), ("THEN-WORDS", "0"), ("THEN-GOTO", "0"), ("DO-LINE", "0"),
        ("NEW-WORDS", "1"), ("MORE-FUNCTIONS", "1"), ("G10-PARAMETERS", "1"), ("REPEATS-IN-P", "1"), ("M97-CALLS", "0"),
        ("CYCLE-REPEATS", "K"), ("MOVE-REPEATS", "0"), ("S-POINT", "0"), ("K0-MOVES", "0"), ("HOME-ALL", "0"), ("DWELL-SECONDS", "0"), ("FEED-INCREMENTS", "0"), ("PECK-IJK", "0"),
        ("TAP-DWELL-R", "1"), ("G84-RIGID", "0"), ("M06-HOMES-Z", "0"), ("M00-STOPS-SPINDLE", "0"), ("TRANSFORM-RETURNS", "0"),
    ] },
    // Four simultaneous axes, so no five-axis codes; 48 additional work coordinate systems, 300 by option.
    DialectRow { dialect: Dialect::Fanuc0iF, base: Some(Dialect::Fanuc31i), settings: &[
        ("CODES", "fanuc-0i-f"), ("WORK-SYSTEMS", "48"),
    ] },
    // Nine macro levels in all; offsets: #2001 length and #2201 its wear, #2401 D and #2601 its wear;
    // #3000=n shows 1000 + n; DPRNT prints all digits, nine before the point and nine behind it; IF without THEN.
    DialectRow { dialect: Dialect::HaasNgc, base: None, settings: &[
        ("CODES", "haas-ngc"), ("MACRO-LEVELS", "9"), ("CALL-LEVELS", "9"), ("OFFSETS", "200"), ("WORK-SYSTEMS", "99"),
        ("MORE-COMMONS", "10000-10999"), ("ALIASED-COMMONS", "1"), ("VARIABLE-BITS", "1"), ("OFFSET-VARIABLES", "haas"),
        ("ALARM-BASE", "1000"), ("ALARM-MOST", "999"), ("PRINT-EXPANDS", "1"), ("PRINT-DIGITS", "18"),
        ("PLAIN-IF", "1"), ("VALUE-CONDITIONS", "1"), ("THEN-WORDS", "1"), ("THEN-GOTO", "1"), ("DO-LINE", "1"),
        ("NEW-WORDS", "0"), ("MORE-FUNCTIONS", "0"), ("G10-PARAMETERS", "0"), ("REPEATS-IN-P", "0"), ("M97-CALLS", "1"),
        ("CYCLE-REPEATS", "L"), ("MOVE-REPEATS", "1"), ("S-POINT", "1"), ("K0-MOVES", "1"), ("HOME-ALL", "1"), ("DWELL-SECONDS", "1"), ("FEED-INCREMENTS", "1"), ("PECK-IJK", "1"),
        ("TAP-DWELL-R", "0"), ("G84-RIGID", "1"), ("M06-HOMES-Z", "1"), ("M00-STOPS-SPINDLE", "1"), ("TRANSFORM-RETURNS", "1"),
    ] },
];

impl Settings {
    /// Applies all settings of a family.
    pub fn apply_dialect(&mut self, dialect: Dialect) {
        self.dialect = dialect;
        let row = |dialect: Dialect| DIALECTS.iter().find(|row| row.dialect == dialect);
        let own = row(dialect);
        let like = own.and_then(|own| own.base).and_then(row);
        for (key, value) in like.into_iter().chain(own).flat_map(|row| row.settings) {
            // A test ensures that every row can be set.
            let result = self.set(key, value);
            debug_assert_eq!(result, Ok(()));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The 0i-F has 48 additional work coordinate systems and its own codes; the rest is that of a 31i.
    #[test]
    fn a_0i_f_is_a_31i_with_fewer_work_systems() {
        let mut expected = Settings::default();
        expected.set("CODES", "fanuc-0i-f").unwrap();
        expected.set("WORK-SYSTEMS", "48").unwrap();
        expected.dialect = Dialect::Fanuc0iF;
        let mut settings = Settings::default();
        settings.apply_dialect(Dialect::HaasNgc);
        settings.apply_dialect(Dialect::Fanuc0iF);
        assert_eq!(settings, expected);
    }

    #[test]
    fn every_row_can_be_set_and_the_first_is_the_default() {
        for row in DIALECTS {
            let mut settings = Settings::default();
            for (key, value) in row.settings {
                settings.set(key, value).unwrap();
            }
            let like = row.base.and_then(|like| DIALECTS.iter().find(|other| other.dialect == like));
            assert!(
                like.is_none_or(|like| like.base.is_none()),
                "{:?}: like one that is like another",
                row.dialect
            );
            settings.apply_dialect(row.dialect);
            assert_eq!(settings.dialect, row.dialect);
            settings.apply_dialect(Dialect::default());
            assert_eq!(settings, Settings::default(), "{:?} leaves something after", row.dialect);
        }
    }
}
