//! Nodes without a sign in their operands, and without a whole part that is taken off and added again.
use crate::arena::Arena;
use crate::interval::Interval;
use crate::node::{Binary, Node, NodeId, Unary};

impl Arena {
    /// Returns the node of a function of the opposite of a value: roundings, the library's functions and the conversion of
    /// degrees don't depend on the sign.
    pub(crate) fn of_opposite(&mut self, function: Unary, x: NodeId) -> Option<NodeId> {
        let is_whole_part = matches!(function, Unary::Fix | Unary::Fup | Unary::Round);
        // A function with a result that is off may be off by another part for the opposite.
        if self.widening() > 0.0 && !is_whole_part {
            return None;
        }
        match function {
            Unary::Sin | Unary::Tan | Unary::Atan | Unary::Fix | Unary::Fup | Unary::Round => {
                let value = self.unary(function, x);
                Some(self.unary(Unary::Neg, value))
            }
            Unary::Cos => Some(self.unary(Unary::Cos, x)),
            _ => None,
        }
    }

    /// Returns the node of an operator with the opposite of a value, as that of the value.
    pub(crate) fn of_opposites(&mut self, operator: Binary, a: NodeId, b: NodeId) -> Option<NodeId> {
        if self.widening() > 0.0 {
            return None;
        }
        let opposite = |x: NodeId| match self.node(x) {
            Node::Unary(Unary::Neg, inner) => Some(inner),
            _ => None,
        };
        match (operator, opposite(a), opposite(b)) {
            (Binary::Add, _, Some(b)) => Some(self.binary(Binary::Sub, a, b)),
            (Binary::Add, Some(a), None) => Some(self.binary(Binary::Sub, b, a)),
            (Binary::Sub, _, Some(b)) => Some(self.binary(Binary::Add, a, b)),
            (Binary::Mul | Binary::Div, Some(a), Some(b)) => Some(self.binary(operator, a, b)),
            (Binary::Mul | Binary::Div, Some(a), None) => {
                let value = self.binary(operator, a, b);
                Some(self.unary(Unary::Neg, value))
            }
            (Binary::Mul | Binary::Div, None, Some(b)) => {
                let value = self.binary(operator, a, b);
                Some(self.unary(Unary::Neg, value))
            }
            _ => None,
        }
    }

    /// Returns x of w + [x − w], and w of x − [x − w], for the whole part w of x, FIX or ROUND: no operation rounds.
    pub(crate) fn by_whole_part(&self, operator: Binary, a: NodeId, b: NodeId) -> Option<NodeId> {
        if self.widening() > 0.0 {
            return None;
        }
        match operator {
            Binary::Add => [(a, b), (b, a)].into_iter().find_map(|(whole, fraction)| {
                self.fraction(fraction).filter(|(_, part)| *part == whole).map(|(x, _)| x)
            }),
            Binary::Sub => self.fraction(b).filter(|(x, _)| *x == a).map(|(_, part)| part),
            _ => None,
        }
    }

    /// Returns x and w of x − w for the whole part w of x, FIX or ROUND.
    fn fraction(&self, id: NodeId) -> Option<(NodeId, NodeId)> {
        let Node::Binary(Binary::Sub, x, whole) = self.node(id) else { return None };
        match self.node(whole) {
            Node::Unary(Unary::Fix | Unary::Round, of) if of == x => Some((x, whole)),
            _ => None,
        }
    }

    /// Returns the range of x − FIX[x], of x − ROUND[x], of x − FUP[x] and of their opposites, by the range of x.
    pub(crate) fn fraction_range(&self, id: NodeId, hull: &dyn Fn(NodeId) -> Interval) -> Option<Interval> {
        let Node::Binary(Binary::Sub, a, b) = self.node(id) else { return None };
        let part = |x: NodeId, whole: NodeId| match self.node(whole) {
            Node::Unary(function @ (Unary::Fix | Unary::Round | Unary::Fup), of) if of == x => Some(function),
            _ => None,
        };
        let (x, function, is_reversed) = match (part(a, b), part(b, a)) {
            (Some(function), _) => (a, function, false),
            (None, Some(function)) => (b, function, true),
            (None, None) => return None,
        };
        // The largest double below 1: what FIX takes off leaves less than 1, without a rounding.
        let below_one = 1.0_f64.next_down();
        let (least, most) = match (function, hull(x).lo() >= 0.0, hull(x).hi() <= 0.0) {
            (Unary::Round, ..) => (-0.5, 0.5),
            (Unary::Fix, true, _) => (0.0, below_one),
            (Unary::Fix, _, true) => (-below_one, 0.0),
            (Unary::Fix, ..) => (-below_one, below_one),
            (_, true, _) => (-1.0, 0.0),
            (_, _, true) => (0.0, 1.0),
            _ => (-1.0, 1.0),
        };
        // A result that is off is so by a part of it.
        let range = if is_reversed { Interval::new(-most, -least) } else { Interval::new(least, most) };
        Some(self.widened(id, range))
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::values;

    /// Doubles of all magnitudes, whole numbers and halves with their neighbours.
    fn numbers() -> impl Strategy<Value = f64> {
        let near = (-2000..2000_i32, -2..3_i32).prop_map(|(halves, steps)| {
            let value = f64::from(halves) / 2.0;
            (0..steps.abs())
                .fold(value, |value, _| if steps > 0 { value.next_up() } else { value.next_down() })
        });
        let any = any::<f64>().prop_filter("a number", |value| value.is_finite());
        prop_oneof![near, -1e3..1e3_f64, -1e17..1e17_f64, any]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        #[test]
        fn functions_of_an_opposite_have_the_bits_of_the_number(x in numbers()) {
            let of = |function, x| values::unary(function, x, Default::default()).map(|value| value + 0.0);
            for function in [Unary::Sin, Unary::Tan, Unary::Atan, Unary::Fix, Unary::Fup, Unary::Round] {
                prop_assert_eq!(of(function, -x), of(function, x).map(|value| -value + 0.0));
            }
            prop_assert_eq!(of(Unary::Cos, -x), of(Unary::Cos, x));
        }

        #[test]
        fn a_whole_part_is_taken_off_and_added_without_a_rounding(x in numbers()) {
            for function in [Unary::Fix, Unary::Round] {
                let whole = values::unary(function, x, Default::default()).unwrap();
                prop_assert_eq!(whole + (x - whole), x);
                prop_assert_eq!(x - (x - whole), whole);
            }
        }

        #[test]
        fn a_fraction_lies_in_its_range(x in numbers()) {
            let mut arena = Arena::default();
            let input = arena.input(0);
            for function in [Unary::Fix, Unary::Round, Unary::Fup] {
                let whole = arena.unary(function, input);
                for (a, b) in [(input, whole), (whole, input)] {
                    let fraction = arena.binary(Binary::Sub, a, b);
                    let range = arena.fraction_range(fraction, &|_| Interval::point(x)).unwrap();
                    prop_assert!(range.contains(arena.evaluate(fraction, &[x]).unwrap()));
                }
            }
        }
    }
}
