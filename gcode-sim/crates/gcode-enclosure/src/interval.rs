//! Intervals of finite doubles.

/// A closed interval of finite doubles; the empty one has a lower end above its upper end.
///
/// Zeros of either sign are one number: no operation of a control separates them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    lo: f64,
    hi: f64,
}

impl Interval {
    /// The interval without a number.
    pub const EMPTY: Self = Self { lo: f64::MAX, hi: -f64::MAX };
    /// The interval of all finite doubles.
    pub const ALL: Self = Self { lo: -f64::MAX, hi: f64::MAX };

    /// Returns the interval between two numbers; an infinite end becomes the largest double.
    ///
    /// It is empty where the lower number is larger, is +∞ or is NaN.
    pub fn new(lo: f64, hi: f64) -> Self {
        if lo <= hi && lo < f64::INFINITY && hi > f64::NEG_INFINITY {
            Self { lo: lo.max(-f64::MAX) + 0.0, hi: hi.min(f64::MAX) + 0.0 }
        } else {
            Self::EMPTY
        }
    }

    /// Returns the interval of two finite numbers in order.
    pub(crate) const fn of_ends(lo: f64, hi: f64) -> Self {
        Self { lo, hi }
    }

    /// Returns the interval of one finite number.
    pub fn point(value: f64) -> Self {
        Self::new(value, value)
    }

    /// Returns the lower end.
    pub fn lo(self) -> f64 {
        self.lo
    }

    /// Returns the upper end.
    pub fn hi(self) -> f64 {
        self.hi
    }

    /// Returns true without a number inside.
    pub fn is_empty(self) -> bool {
        self.lo > self.hi
    }

    /// Returns the only number inside.
    pub fn as_point(self) -> Option<f64> {
        (self.lo == self.hi).then_some(self.lo)
    }

    /// Returns true if the number lies inside.
    pub fn contains(self, value: f64) -> bool {
        self.lo <= value && value <= self.hi
    }

    /// Returns an upper bound of the width, 0 for the empty interval.
    pub fn width(self) -> f64 {
        if self.is_empty() { 0.0 } else { sub_up(self.hi, self.lo) }
    }

    /// Returns a number inside, about halfway.
    pub fn midpoint(self) -> f64 {
        let middle = self.lo / 2.0 + self.hi / 2.0;
        middle.clamp(self.lo.min(self.hi), self.hi.max(self.lo))
    }

    /// Returns the largest magnitude inside.
    pub fn magnitude(self) -> f64 {
        if self.is_empty() { 0.0 } else { self.lo.abs().max(self.hi.abs()) }
    }

    /// Returns the least magnitude inside.
    pub fn mignitude(self) -> f64 {
        if self.contains(0.0) || self.is_empty() { 0.0 } else { self.lo.abs().min(self.hi.abs()) }
    }

    /// Returns the numbers that both have.
    pub fn intersect(self, other: Self) -> Self {
        Self::new(self.lo.max(other.lo), self.hi.min(other.hi))
    }

    /// Returns the least interval around both.
    pub fn hull(self, other: Self) -> Self {
        match (self.is_empty(), other.is_empty()) {
            (true, _) => other,
            (_, true) => self,
            _ => Self { lo: self.lo.min(other.lo), hi: self.hi.max(other.hi) },
        }
    }

    /// Returns an interval around the real products of numbers of both.
    pub(crate) fn times(self, other: Self) -> Self {
        if self.is_empty() || other.is_empty() {
            return Self::EMPTY;
        }
        let ends = [(self.lo, other.lo), (self.lo, other.hi), (self.hi, other.lo), (self.hi, other.hi)];
        let products = ends.map(|(a, b)| if a == 0.0 || b == 0.0 { None } else { Some(a * b) });
        let below = products.map(|product| product.map_or(0.0, f64::next_down));
        let above = products.map(|product| product.map_or(0.0, f64::next_up));
        let lo = below.into_iter().fold(f64::INFINITY, f64::min);
        Self::new(lo, above.into_iter().fold(f64::NEG_INFINITY, f64::max))
    }

    /// Returns the interval wider by `by` on both sides.
    pub(crate) fn widened(self, by: f64) -> Self {
        if self.is_empty() { self } else { Self::new(sub_down(self.lo, by), add_up(self.hi, by)) }
    }
}

/// Returns an upper bound of a sum.
#[inline]
pub(crate) fn add_up(a: f64, b: f64) -> f64 {
    (a + b).next_up()
}

/// Returns a lower bound of a sum.
#[inline]
pub(crate) fn add_down(a: f64, b: f64) -> f64 {
    (a + b).next_down()
}

/// Returns an upper bound of a difference.
#[inline]
pub(crate) fn sub_up(a: f64, b: f64) -> f64 {
    (a - b).next_up()
}

/// Returns a lower bound of a difference.
#[inline]
pub(crate) fn sub_down(a: f64, b: f64) -> f64 {
    (a - b).next_down()
}

/// Returns an upper bound of a product.
#[inline]
pub(crate) fn mul_up(a: f64, b: f64) -> f64 {
    (a * b).next_up()
}
