//! Factors of a node: products, quotients and roots as powers of what isn't one.
//!
//! In `#24*#24/[#2*#2]` with `#24=#2*SQRT[…]/#1` the factor #2 cancels and the root becomes its argument. Of a polynomial of
//! a root's approximation nothing cancels; the factors are exact but for a rounding each.
use crate::interval::Interval;
use crate::node::{Binary, Node, NodeId, Unary};

/// A node as constant × Π factor^(halves/2), within a number of roundings.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Factors {
    /// Product of the constants.
    pub(crate) constant: f64,
    /// Factors in the order of their nodes, with twice their exponents.
    pub(crate) powers: Vec<(NodeId, i32)>,
    /// All factors, those that cancelled as well; true for one that is part of a divisor somewhere.
    pub(crate) used: Vec<(NodeId, bool)>,
    /// Number of roundings, those of the constant included.
    pub(crate) roundings: u32,
    /// True if factors cancelled or a root was squared.
    pub(crate) is_simpler: bool,
}

/// Largest number of roundings: every operation has two, so that there are no more than a dozen factors.
const MOST: u32 = 24;

/// Largest number of factors whose ranges are multiplied.
const MAX_RANGED: usize = 4;

impl Factors {
    /// Returns the factors of a node from those of its operands.
    pub(crate) fn of(id: NodeId, node: Node, known: &[Self]) -> Self {
        let whole = Self {
            constant: 1.0,
            powers: vec![(id, 2)],
            used: vec![(id, false)],
            roundings: 0,
            is_simpler: false,
        };
        let factors = |x: NodeId| &known[x.index()];
        let found = match node {
            Node::Constant(value) if value != 0.0 => Some(Self {
                constant: value,
                powers: Vec::new(),
                used: Vec::new(),
                roundings: 0,
                is_simpler: false,
            }),
            Node::Unary(Unary::Neg, x) => Some(Self { constant: -factors(x).constant, ..factors(x).clone() }),
            // The root of a node, which is 0 or more where the root has a value.
            Node::Unary(Unary::Sqrt, x) => Some(Self {
                constant: 1.0,
                powers: vec![(x, 1)],
                used: vec![(x, false)],
                roundings: 1,
                is_simpler: false,
            }),
            Node::Binary(Binary::Mul, a, b) => factors(a).product(factors(b), 1),
            Node::Binary(Binary::Div, a, b) => factors(a).product(factors(b), -1),
            _ => None,
        };
        found.unwrap_or(whole)
    }

    /// Returns a range of the computed value by those of the factors, if one of them has an even power; a square isn't below 0.
    ///
    /// Factors are at most 1e10, and at least 1e-10 in a divisor, so that what underflows stays below 1e-60.
    pub(crate) fn range(&self, hull: impl Fn(NodeId) -> Interval) -> Option<Interval> {
        let has_square = self.powers.iter().any(|(_, halves)| *halves > 0 && halves % 4 == 0);
        if !has_square || self.powers.len() > MAX_RANGED {
            return None;
        }
        let is_moderate = |(factor, is_divisor): &(NodeId, bool)| {
            let hull = hull(*factor);
            hull.magnitude() <= 1e10 && (!is_divisor || hull.mignitude() >= 1e-10)
        };
        if !self.used.iter().all(is_moderate) {
            return None;
        }
        let mut range = Interval::point(self.constant);
        for &(factor, halves) in &self.powers {
            if halves < 0 || halves % 2 != 0 {
                return None;
            }
            let of_factor = hull(factor);
            let magnitudes = Interval::new(of_factor.mignitude(), of_factor.magnitude());
            for _ in 0..halves / 4 {
                range = range.times(magnitudes).times(magnitudes);
            }
            if halves % 4 != 0 {
                range = range.times(of_factor);
            }
        }
        // No rounding changes a sign.
        let relative = f64::from(self.roundings) * f64::EPSILON;
        let low = range.lo() - range.lo().abs() * relative - 1e-60;
        let high = range.hi() + range.hi().abs() * relative + 1e-60;
        let low = if range.lo() >= 0.0 { low.max(0.0) } else { low };
        Some(Interval::new(low, if range.hi() <= 0.0 { high.min(0.0) } else { high }))
    }

    /// Returns the product with another number to the power `sign`, 1 or −1.
    fn product(&self, other: &Self, sign: i32) -> Option<Self> {
        let mut powers = self.powers.clone();
        let mut is_simpler = self.is_simpler || other.is_simpler;
        for &(factor, halves) in &other.powers {
            let halves = halves * sign;
            match powers.iter_mut().find(|(known, _)| *known == factor) {
                Some((_, known)) => {
                    is_simpler |= *known % 2 != 0 || *known * halves < 0;
                    *known += halves;
                }
                None => powers.push((factor, halves)),
            }
        }
        powers.retain(|(_, halves)| *halves != 0);
        powers.sort_unstable();
        let mut used = self.used.clone();
        for &(factor, is_divisor) in &other.used {
            let is_divisor = is_divisor || sign < 0;
            match used.iter_mut().find(|(known, _)| *known == factor) {
                Some((_, known)) => *known |= is_divisor,
                None => used.push((factor, is_divisor)),
            }
        }
        let constant = if sign > 0 { self.constant * other.constant } else { self.constant / other.constant };
        // One rounding of the operation, one of the constant.
        let roundings = self.roundings + other.roundings + 2;
        let is_usable = (1e-10..1e10).contains(&constant.abs()) && roundings <= MOST;
        is_usable.then_some(Self { constant, powers, used, roundings, is_simpler })
    }
}
