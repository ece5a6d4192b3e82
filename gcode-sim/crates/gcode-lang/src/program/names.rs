//! Names of system variables: `[#_ABSMT[1]]` is #5021.

/// Name with the number of its first variable and its suffixes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NameRow {
    /// Name without `#`.
    pub name: &'static str,
    /// Variable of the lowest suffix, or the only variable.
    pub number: u32,
    /// Lowest and highest suffix; `None` for a name without suffix.
    pub suffix: Option<(u32, u32)>,
    /// Number with V15 6000#3, which exchanges the numbers of geometry and wear.
    pub series_15: u32,
}

const fn single(name: &'static str, number: u32) -> NameRow {
    NameRow { name, number, suffix: None, series_15: number }
}

const fn numbered(name: &'static str, number: u32, from: u32, to: u32) -> NameRow {
    NameRow { name, number, suffix: Some((from, to)), series_15: number }
}

const fn offset(name: &'static str, number: u32, series_15: u32) -> NameRow {
    NameRow { name, number, suffix: Some((1, 999)), series_15 }
}

/// All names except those of the additional work coordinate systems, which [`find`] computes.
#[rustfmt::skip]
const NAMES: &[NameRow] = &[
    numbered("_UI", 1000, 0, 31), numbered("_UIL", 1032, 0, 3), numbered("_UO", 1100, 0, 31), numbered("_UOL", 1132, 0, 3),
    single("_ALM", 3000), single("_CLOCK1", 3001), single("_CLOCK2", 3002), single("_CNTL1", 3003), single("_CNTL2", 3004),
    single("_SETDT", 3005), single("_MSGSTP", 3006), single("_MRIMG", 3007), single("_PRSTR", 3008),
    single("_DATE", 3011), single("_TIME", 3012), single("_EMPTY", 3100), single("_PI", 3101), single("_E", 3102),
    single("_PRTSA", 3901), single("_PRTSN", 3902),
    numbered("_BUFG", 4001, 1, 30), single("_BUFB", 4102), single("_BUFD", 4107), single("_BUFE", 4108), single("_BUFF", 4109),
    single("_BUFH", 4111), single("_BUFM", 4113), single("_BUFN", 4114), single("_BUFO", 4115), single("_BUFS", 4119),
    single("_BUFT", 4120), single("_BUFWZP", 4130),
    numbered("_ACTG", 4201, 1, 30), single("_ACTB", 4302), single("_ACTD", 4307), single("_ACTE", 4308), single("_ACTF", 4309),
    single("_ACTH", 4311), single("_ACTM", 4313), single("_ACTN", 4314), single("_ACTO", 4315), single("_ACTS", 4319),
    single("_ACTT", 4320), single("_ACTWZP", 4330),
    numbered("_ABSIO", 5001, 1, 20), numbered("_ABSMT", 5021, 1, 20), numbered("_ABSOT", 5041, 1, 20),
    numbered("_ABSKP", 5061, 1, 20), numbered("_TOFS", 5081, 1, 20), numbered("_SVERR", 5101, 1, 20),
    numbered("_MIRTP", 5121, 1, 20), numbered("_DIST", 5181, 1, 20),
    numbered("_WZCMN", 5201, 1, 20), numbered("_WZG54", 5221, 1, 20), numbered("_WZG55", 5241, 1, 20),
    numbered("_WZG56", 5261, 1, 20), numbered("_WZG57", 5281, 1, 20), numbered("_WZG58", 5301, 1, 20),
    numbered("_WZG59", 5321, 1, 20),
    offset("_OFSHG", 11001, 10001), offset("_OFSHW", 10001, 11001),
    offset("_OFSDG", 13001, 12001), offset("_OFSDW", 12001, 13001),
];

/// Names of the tool offset memories A and B; the simulated control has memory C.
pub(super) const OTHER_MEMORIES: [&str; 3] = ["_OFS", "_OFSG", "_OFSW"];

/// Iterates over all names except those of the additional work coordinate systems.
pub fn all() -> impl Iterator<Item = &'static NameRow> {
    NAMES.iter()
}

/// Returns the variables that a name stands for.
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
    fn names_are_unique() {
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
