//! The names of system variables: `[#_ABSMT[1]]` is #5021.

/// A name, the number of its first variable, and the suffixes it takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NameRow {
    pub name: &'static str,
    /// The variable of the lowest suffix, or the one variable.
    pub number: u32,
    /// The lowest and the highest suffix; `None` where the name takes none.
    pub suffix: Option<(u32, u32)>,
    /// V15 6000#3 gives geometry and wear each other's numbers: the number with V15 set.
    pub series_15: u32,
}

const fn one(name: &'static str, number: u32) -> NameRow {
    NameRow { name, number, suffix: None, series_15: number }
}

const fn many(name: &'static str, number: u32, from: u32, to: u32) -> NameRow {
    NameRow { name, number, suffix: Some((from, to)), series_15: number }
}

const fn offset(name: &'static str, number: u32, series_15: u32) -> NameRow {
    NameRow { name, number, suffix: Some((1, 999)), series_15 }
}

/// All names but those of the additional work coordinate systems, [`find`] has them.
#[rustfmt::skip]
pub const NAMES: &[NameRow] = &[
    many("_UI", 1000, 0, 31), many("_UIL", 1032, 0, 3), many("_UO", 1100, 0, 31), many("_UOL", 1132, 0, 3),
    one("_ALM", 3000), one("_CLOCK1", 3001), one("_CLOCK2", 3002), one("_CNTL1", 3003), one("_CNTL2", 3004),
    one("_SETDT", 3005), one("_MSGSTP", 3006), one("_MRIMG", 3007), one("_PRSTR", 3008),
    one("_DATE", 3011), one("_TIME", 3012), one("_EMPTY", 3100), one("_PI", 3101), one("_E", 3102),
    one("_PRTSA", 3901), one("_PRTSN", 3902),
    many("_BUFG", 4001, 1, 30), one("_BUFB", 4102), one("_BUFD", 4107), one("_BUFE", 4108), one("_BUFF", 4109),
    one("_BUFH", 4111), one("_BUFM", 4113), one("_BUFN", 4114), one("_BUFO", 4115), one("_BUFS", 4119),
    one("_BUFT", 4120), one("_BUFWZP", 4130),
    many("_ACTG", 4201, 1, 30), one("_ACTB", 4302), one("_ACTD", 4307), one("_ACTE", 4308), one("_ACTF", 4309),
    one("_ACTH", 4311), one("_ACTM", 4313), one("_ACTN", 4314), one("_ACTO", 4315), one("_ACTS", 4319),
    one("_ACTT", 4320), one("_ACTWZP", 4330),
    many("_ABSIO", 5001, 1, 20), many("_ABSMT", 5021, 1, 20), many("_ABSOT", 5041, 1, 20),
    many("_ABSKP", 5061, 1, 20), many("_TOFS", 5081, 1, 20), many("_SVERR", 5101, 1, 20),
    many("_MIRTP", 5121, 1, 20), many("_DIST", 5181, 1, 20),
    many("_WZCMN", 5201, 1, 20), many("_WZG54", 5221, 1, 20), many("_WZG55", 5241, 1, 20),
    many("_WZG56", 5261, 1, 20), many("_WZG57", 5281, 1, 20), many("_WZG58", 5301, 1, 20),
    many("_WZG59", 5321, 1, 20),
    offset("_OFSHG", 11001, 10001), offset("_OFSHW", 10001, 11001),
    offset("_OFSDG", 13001, 12001), offset("_OFSDW", 12001, 13001),
];

/// Names of the tool offset memories A and B, where this control has C.
pub const OTHER_MEMORIES: [&str; 3] = ["_OFS", "_OFSG", "_OFSW"];

/// The variable that a name and its suffix stand for, or the bounds of what would be one.
pub fn find(name: &str) -> Option<NameRow> {
    let system =
        |text: &str| text.parse().ok().filter(|p: &u32| (1..=300).contains(p) && !text.starts_with('0'));
    if let Some(p) = name.strip_prefix("_WZP").and_then(system) {
        let number = 14_001 + 20 * (p - 1);
        return Some(NameRow { name: "_WZP", number, suffix: Some((1, 20)), series_15: number });
    }
    NAMES.iter().find(|row| row.name == name).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_stand_once() {
        for (i, row) in NAMES.iter().enumerate() {
            assert!(NAMES[..i].iter().all(|other| other.name != row.name), "{}", row.name);
        }
    }

    #[test]
    fn additional_systems_have_twenty_variables_each() {
        assert_eq!(find("_WZP1").map(|row| row.number), Some(14_001));
        assert_eq!(find("_WZP300").map(|row| row.number), Some(19_981));
        assert!(find("_WZP301").is_none() && find("_WZP0").is_none() && find("_WZP").is_none());
    }
}
