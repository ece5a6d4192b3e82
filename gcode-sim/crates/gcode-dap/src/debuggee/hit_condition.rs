//! Hit conditions of breakpoints: `5`, `>= 3`, `% 2`.

/// Condition on how often a breakpoint has been reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct HitCondition {
    relation: Relation,
    count: u64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Relation {
    Equal,
    Above,
    AtLeast,
    Below,
    AtMost,
    Multiple,
}

/// Signs of the relations; a longer one stands before its beginning.
const SIGNS: [(&str, Relation); 7] = [
    (">=", Relation::AtLeast),
    ("<=", Relation::AtMost),
    ("==", Relation::Equal),
    ("=", Relation::Equal),
    (">", Relation::Above),
    ("<", Relation::Below),
    ("%", Relation::Multiple),
];

impl HitCondition {
    /// Reads a hit condition; a number alone is the hit at which the run stops.
    pub(crate) fn parse(text: &str) -> Result<Self, String> {
        let text = text.trim();
        let signed = SIGNS.iter().find_map(|(sign, relation)| Some((text.strip_prefix(sign)?, *relation)));
        let (digits, relation) = signed.unwrap_or((text, Relation::Equal));
        let count = digits.trim().parse().ok().filter(|count| *count > 0 || relation != Relation::Multiple);
        match count {
            Some(count) => Ok(Self { relation, count }),
            None => {
                Err(format!("hit condition '{text}': write a number, or >=, >, <=, <, = or % and a number"))
            }
        }
    }

    /// Returns true if the run stops at a hit, counted from 1.
    pub(crate) fn holds(self, hit: u64) -> bool {
        match self.relation {
            Relation::Equal => hit == self.count,
            Relation::Above => hit > self.count,
            Relation::AtLeast => hit >= self.count,
            Relation::Below => hit < self.count,
            Relation::AtMost => hit <= self.count,
            Relation::Multiple => hit.is_multiple_of(self.count),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hit_condition_chooses_hits() {
        let hits = |text: &str| {
            let condition = HitCondition::parse(text).unwrap();
            (1..=6).filter(|hit| condition.holds(*hit)).collect::<Vec<u64>>()
        };
        assert_eq!(hits("5"), [5]);
        assert_eq!(hits(" == 2 "), [2]);
        assert_eq!(hits("=2"), [2]);
        assert_eq!(hits(">= 3"), [3, 4, 5, 6]);
        assert_eq!(hits("> 3"), [4, 5, 6]);
        assert_eq!(hits("<=2"), [1, 2]);
        assert_eq!(hits("< 2"), [1]);
        assert_eq!(hits("% 2"), [2, 4, 6]);
        for text in ["", "x", ">=", "% 0", "-1", "1.5"] {
            assert!(HitCondition::parse(text).is_err(), "{text}");
        }
    }
}
