//! Sound enclosures of what a control computes, over boxes of its arguments.
//!
//! In goes an expression in an [`Arena`] and a [`Domain`], a range for each input. Out come ranges that have every double
//! the interpreter can compute, decisions of conditions, the alarms that an operation can raise, and [`bounds`] by
//! subdivision. The crate knows no program: `gcode-lang` gives it the conversion of degrees and the rounding.
//!
//! # Example
//!
//! The guard `#2 LE #1` makes `SQRT[#1*#1-#2*#2]` safe for #1 and #2 from 0 to 50.
//!
//! ```
//! use gcode_enclosure::{Arena, Binary, Condition, Domain, Enclosures, Interval, Relation, Unary};
//!
//! let mut arena = Arena::default();
//! let (a, r) = (arena.input(0), arena.input(1));
//! let (aa, rr) = (arena.binary(Binary::Mul, a, a), arena.binary(Binary::Mul, r, r));
//! let difference = arena.binary(Binary::Sub, aa, rr);
//! let root = arena.unary(Unary::Sqrt, difference);
//!
//! let domain = Domain::new(vec![Interval::new(0.0, 50.0); 2]);
//! let mut path = Enclosures::new(domain);
//! assert_eq!(path.alarms(&arena, root).len(), 1);
//! assert!(path.assume(&arena, Condition::new(Relation::Le, r, a)));
//! assert!(path.alarms(&arena, root).is_empty());
//! assert_eq!(path.enclose(&arena, root).hi(), 50.0);
//! ```
//!
//! # What an enclosure says
//!
//! A node is the double that the interpreter computes, not a real number. An enclosure of it over a box has every double
//! that it can be at a point of the box which keeps the conditions assumed so far and at which no operation of it raises
//! an alarm. Nothing infinite and no NaN is a value: the interpreter raises an alarm instead. [`Enclosures::alarms`] says
//! which, and whether at every point.
//!
//! # Method
//!
//! Six layers hold at once, and each may narrow what the others say.
//!
//! - **Ranges** (`hull`). An operation that rounds correctly, + − × ÷ SQRT FIX FUP ROUND, is monotone in doubles: the range
//!   of its computed values lies between its values at the ends, without a margin (IEEE 754; IEEE 1788, Standard for
//!   Interval Arithmetic, rounds outwards because it encloses real numbers). A function of `libm` has a margin of four
//!   units in the last place on either side; tests measure less than one against a reference of 320 bits, for atan2 two.
//! - **Taylor models** (`model`, `form`): a polynomial of the inputs of bounded total degree and an interval around it
//!   that has the truncated terms, the rounding of its coefficients and the rounding of the control (Makino and Berz,
//!   Taylor models and other validated functional inclusion methods). Functions come in by Chebyshev interpolation with a
//!   bound of the remainder, at the ends of SQRT and ASIN by a chord. What FIX and ROUND cut off is a variable of its own,
//!   so that it stays the same wherever it is used. Directions are turned to the middle of the box before the arc tangent.
//!   Polynomials are bounded by Bernstein coefficients.
//! - **Factors** (`factors`). Products, quotients and roots are powers of what isn't one. Equal factors cancel, and a
//!   squared root is its argument, for a rounding each (Higham, Accuracy and Stability of Numerical Algorithms).
//! - **Algebra** (`algebra`). Computed values satisfy identities up to a rounding each: a root's square is its argument,
//!   SIN² + COS² is 1, a quotient times its divisor is its dividend. Of two formulas of one quantity all monomials cancel;
//!   the roundings are left.
//! - **Certificates** (`certificate`). Real values satisfy the identities exactly (`real_values`). Sums of squares, squared
//!   sides and products of the path's conditions show their sign; how far the computed values are off is added.
//! - **Structure** (`proof`). From a ≥ r ≥ 0 follows a·a ≥ r·r in doubles, a difference of doubles has the sign of the real
//!   one, a root isn't shorter than a leg (Boldo, Stupid is as stupid does: taking the square root of the square of a
//!   floating-point number). Conditions of the path chain, shrink ranges, and are subtracted from polynomials in multiples.
//!
//! [`bounds`] divides the worst boxes first, at the input that matters most, on several threads with one result. Tests hold
//! the kernels of FPBench (Damouche and others, Toward a standard benchmark format and suite for floating-point analysis) to
//! 1.05 of their true width, and random expressions over random boxes to their values at random and adversarial points
//! (Rump, Verification methods: rigorous results using floating-point arithmetic, on what such bounds must mind).
//!
//! Not covered: a path on which `ATAN` jumps from 360° to 0° inside a box has the range of both sides and no polynomial;
//! results of MOD, AND, OR, XOR, BIN and BCD have ranges and a variable of their own.
#![warn(missing_docs)]

mod alarms;
mod algebra;
mod angle_sums;
mod apply;
mod approximation;
mod arena;
mod basis;
mod bounds;
mod certificate;
mod contraction;
mod decisions;
mod divided_models;
mod domain;
mod elementary;
mod enclosures;
mod fact_factors;
mod factor_signs;
mod factors;
mod form;
mod grain;
mod hull;
mod identities;
mod interval;
mod inverses;
mod model;
mod multiples;
mod node;
mod polynomial;
mod polynomial_range;
mod proof;
mod quotients;
mod ranked;
mod ratio;
mod real_values;
mod rests;
mod signs;
mod square_sums;
mod squares;
#[cfg(test)]
mod tests;
mod values;

pub use alarms::PossibleAlarm;
pub use arena::Arena;
pub use bounds::{Bounds, BoundsSearch, bounds};
pub use domain::Domain;
pub use enclosures::Enclosures;
pub use interval::Interval;
pub use node::{AlarmKind, Binary, Condition, Node, NodeId, Relation, Semantics, Unary};
pub use ranked::Ranked;
