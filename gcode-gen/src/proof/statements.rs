//! What a macro says of itself in its remarks: its alarms, and its blocks a hole.
use crate::package::Package;

/// Statements of the macros of a package.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Statements {
    /// Codes of the alarms, in order.
    pub(super) alarms: Vec<String>,
    /// Blocks a hole, of all macros together; `None` if one of them doesn't say it.
    pub(super) blocks: Option<u64>,
}

impl Statements {
    /// Reads the remarks of all macros, which call one another.
    pub(super) fn of(package: &Package) -> Self {
        let macros = package.programs.iter().filter(|program| !package.mains.contains(&program.number));
        let texts: Vec<_> = macros.map(|program| program.text.as_str()).collect();
        let mut numbers: Vec<u32> = texts.iter().flat_map(|text| alarms(text)).collect();
        numbers.sort_unstable();
        numbers.dedup();
        let blocks = texts.iter().map(|text| blocks(text)).sum();
        Self { alarms: numbers.iter().map(|number| format!("MC{number:04}")).collect(), blocks }
    }
}

/// Returns the numbers of `(ALARMS 3001-3015 3017 3019 BEFORE ANYTHING MOVES, 3016)`.
fn alarms(text: &str) -> Vec<u32> {
    // A remark goes on in lines that begin with spaces.
    let mut is_open = false;
    let remarks = text.lines().filter_map(move |line| {
        let line = line.trim();
        is_open = line.starts_with("(ALARMS") || is_open && line.starts_with("(   ");
        is_open.then(|| line.trim_start_matches("(ALARMS"))
    });
    let number = |text: &str| text.parse::<u32>().ok().filter(|_| text.len() == 4);
    let range = |word: &str| match word.split_once('-') {
        Some((first, last)) => Some(number(first)?..=number(last)?),
        None => number(word).map(|number| number..=number),
    };
    remarks.flat_map(|line| line.split([' ', ',', ')', '.'])).filter_map(range).flatten().collect()
}

/// Returns the number of `BLOCKS A HOLE: 62`.
fn blocks(text: &str) -> Option<u64> {
    let (_, rest) = text.split_once("BLOCKS A HOLE: ")?;
    rest.split(|c: char| !c.is_ascii_digit()).next()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn remarks_name_alarms_and_blocks() {
        let text = "O1(A)\nGOTO 10 (OVER THE REMARKS. BLOCKS A HOLE: 62)\n(ALARMS 3001-3003 3017 BEFORE ANYTHING MOVES, 3016)\n";
        assert_eq!(alarms(text), [3001, 3002, 3003, 3017, 3016]);
        assert_eq!((blocks(text), blocks("O1\nM99")), (Some(62), None));
        let text = "(ALARMS 3138-3139 BEFORE ANYTHING MOVES, THEN)\n(       3154-3155. TEXTS)\nN10 #1=3000\n(   3001)\n";
        assert_eq!(alarms(text), [3138, 3139, 3154, 3155]);
        assert!(alarms("(ALARMS OF 12 HOLES)").is_empty());
    }
}
