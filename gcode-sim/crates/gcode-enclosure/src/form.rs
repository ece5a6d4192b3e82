//! The form of a node: its range and its Taylor model, from those of its operands.
use std::sync::Arc;

use crate::approximation::Approximation;
use crate::basis::Basis;
use crate::elementary::Elementary;
use crate::factors::Factors;
use crate::hull::{FUNCTION_ERROR, UNDERFLOW};
use crate::interval::{Interval, add_up, mul_up};
use crate::model::{HALF_ULP, Model, is_power_of_two};
use crate::node::{Binary, Semantics, Unary};
use crate::values::RESIDUE;

/// What is known of a node over a box.
#[derive(Clone, Debug)]
pub(crate) struct Form {
    /// A range of its values.
    pub(crate) hull: Interval,
    /// A polynomial near its values; none for a number, and where a range says as much.
    pub(crate) model: Option<Model>,
}

impl Form {
    /// The form of a value of which nothing is known.
    pub(crate) const UNKNOWN: Self = Self { hull: Interval::ALL, model: None };

    /// Returns the form of the opposite number.
    fn opposite(&self) -> Self {
        let hull = Interval::new(-self.hull.hi(), -self.hull.lo());
        Self { hull, model: self.model.as_ref().map(Model::neg) }
    }

    /// Returns the model, or that of the range.
    pub(crate) fn as_model(&self) -> Option<Model> {
        let model = match &self.model {
            Some(model) => model.clone(),
            None => Model::of_interval(self.hull),
        };
        model.is_finite().then_some(model)
    }
}

/// Radians in a degree and degrees in a radian, as the interpreter's conversions multiply.
pub(crate) fn conversions() -> (f64, f64) {
    (1.0_f64.to_radians(), 1.0_f64.to_degrees())
}

/// Computes models over one basis.
pub(crate) struct Modeller<'a> {
    pub(crate) basis: &'a mut Basis,
    pub(crate) semantics: Semantics,
}

impl Modeller<'_> {
    /// Returns the model of a function of one value whose values lie in `result`; `None` without one.
    pub(crate) fn unary(&mut self, function: Unary, x: &Form, result: Interval) -> Option<Model> {
        let model = x.model.as_ref()?;
        let range = x.hull;
        let (_, to_degrees) = conversions();
        match function {
            Unary::Neg => Some(model.neg()),
            Unary::Abs if range.lo() >= 0.0 => Some(model.clone()),
            Unary::Abs if range.hi() <= 0.0 => Some(model.neg()),
            Unary::Abs => self.magnitude(model, range),
            Unary::Sqrt => rounded(self.compose(Elementary::Sqrt, model, range)?, result),
            Unary::Sin => self.of_degrees(Elementary::Sin, model, range, result),
            Unary::Cos => self.of_degrees(Elementary::Cos, model, range, result),
            Unary::Tan => self.of_degrees(Elementary::Tan, model, range, result),
            Unary::Asin => {
                let is_turned = !self.semantics.returns_signed_angles && range.lo() < 0.0;
                if is_turned && range.hi() >= 0.0 {
                    return None;
                }
                let angle = self.compose(Elementary::Asin, model, range)?.scale(to_degrees);
                let angle = of_function(angle, Interval::new(-90.0, 90.0));
                Some(if is_turned { turned(&angle) } else { angle })
            }
            Unary::Acos => {
                Some(of_function(self.compose(Elementary::Acos, model, range)?.scale(to_degrees), result))
            }
            Unary::Atan => {
                Some(of_function(self.compose(Elementary::Atan, model, range)?.scale(to_degrees), result))
            }
            Unary::Exp => Some(of_function(self.compose(Elementary::Exp, model, range)?, result)),
            Unary::Ln => Some(of_function(self.compose(Elementary::Ln, model, range)?, result)),
            Unary::Residue if range.mignitude() >= RESIDUE => Some(model.clone()),
            Unary::Residue => {
                let mut model = model.clone();
                model.widen(RESIDUE);
                Some(model)
            }
            Unary::Fix | Unary::Fup | Unary::Round | Unary::Bin | Unary::Bcd => None,
        }
    }

    /// Returns the model of an operator or a function of two values whose values lie in `result`.
    pub(crate) fn binary(&mut self, operator: Binary, a: &Form, b: &Form, result: Interval) -> Option<Model> {
        match operator {
            Binary::Add => rounded_unless(a.as_model()?.add(&b.as_model()?), result, false),
            Binary::Sub => {
                let difference = a.as_model()?.sub(&b.as_model()?);
                rounded_unless(difference, result, is_exact_difference(a.hull, b.hull))
            }
            Binary::Mul => {
                let product = match (a.hull.as_point(), b.hull.as_point()) {
                    (Some(factor), _) => b.as_model()?.scale(factor),
                    (_, Some(factor)) => a.as_model()?.scale(factor),
                    _ => a.as_model()?.mul(&b.as_model()?, self.basis),
                };
                let factors = [a.hull.as_point(), b.hull.as_point()];
                let is_exact = factors.into_iter().flatten().any(is_power_of_two);
                rounded_unless(product, result, is_exact)
            }
            Binary::Div => {
                let quotient = self.quotient(a, b)?;
                let is_exact = b.hull.as_point().is_some_and(is_power_of_two);
                rounded_unless(quotient, result, is_exact)
            }
            Binary::Pow => self.power(a, b, result),
            Binary::Atan => self.angle(a, b),
            Binary::Mod | Binary::And | Binary::Or | Binary::Xor | Binary::Compare(_) => None,
        }
    }

    /// Returns the model of a node by its factors, whose forms are given in their order.
    pub(crate) fn product_of_powers(
        &mut self,
        factors: &Factors,
        forms: &[Arc<Form>],
        result: Interval,
    ) -> Option<Model> {
        let mut product = Model::constant(factors.constant);
        for ((_, halves), form) in factors.powers.iter().zip(forms) {
            let factor = form.as_model()?;
            if halves % 2 != 0 {
                product = product.mul(&self.compose(Elementary::Sqrt, &factor, form.hull)?, self.basis);
            }
            let whole = halves.div_euclid(2);
            let base =
                if whole < 0 { self.compose(Elementary::Reciprocal, &factor, form.hull)? } else { factor };
            for _ in 0..whole.unsigned_abs() {
                product = product.mul(&base, self.basis);
            }
        }
        let rounding = result.magnitude() * HALF_ULP * f64::from(factors.roundings) * (1.0 + 1e-9);
        product.widen(add_up(rounding, 1e-60));
        product.is_finite().then_some(product)
    }

    /// Returns the model of a real function of a value in a range.
    fn compose(&mut self, function: Elementary, x: &Model, range: Interval) -> Option<Model> {
        let near = Approximation::of(function, range, self.basis.degree() as usize)?;
        let mut place = x.sub(&Model::constant(near.middle)).scale(1.0 / near.radius);
        // The place of a value in the range is at most 1: the rounded factor moves it by this much.
        place.widen(2.0 * f64::EPSILON);
        if !place.is_finite() {
            return None;
        }
        let mut value = place.compose(&near.coefficients, self.basis);
        value.widen(near.error);
        value.is_finite().then_some(value)
    }

    /// Returns the model of a trigonometric function of degrees.
    fn of_degrees(
        &mut self,
        function: Elementary,
        x: &Model,
        degrees: Interval,
        result: Interval,
    ) -> Option<Model> {
        let (to_radians, _) = conversions();
        let radians = Interval::new(degrees.lo().to_radians(), degrees.hi().to_radians());
        let angle = rounded(x.scale(to_radians), radians)?;
        let value = self.compose(function, &angle, radians)?;
        Some(of_function(value, result))
    }

    /// Returns the model of ABS where the sign isn't known: between the chord and 0.
    fn magnitude(&mut self, x: &Model, range: Interval) -> Option<Model> {
        let (below, above) = (-range.lo(), range.hi());
        let slope = (above - below) / (above + below);
        let slope = slope.clamp(-1.0, 1.0);
        // |x| − slope·x is largest at an end, and 0 at 0.
        let most = (above - slope * above).max(below + slope * below) * (1.0 + 1e-14);
        let mut model = x.scale(slope).add(&Model::constant(most / 2.0));
        model.widen(add_up(most / 2.0, 1e-300));
        model.is_finite().then_some(model)
    }

    /// Returns the model of POW.
    fn power(&mut self, base: &Form, exponent: &Form, result: Interval) -> Option<Model> {
        let value = match exponent.hull.as_point() {
            Some(whole) if (1.0..=8.0).contains(&whole) && whole.trunc() == whole => {
                let factor = base.as_model()?;
                let mut product = factor.clone();
                for _ in 1..whole as u32 {
                    product = product.mul(&factor, self.basis);
                }
                product
            }
            Some(exponent) => self.compose(Elementary::Power(exponent), base.model.as_ref()?, base.hull)?,
            None => {
                if base.hull.lo() <= 0.0 {
                    return None;
                }
                let logarithm = match base.hull.as_point() {
                    Some(base) => {
                        let value = libm::log(base);
                        let mut logarithm = Model::constant(value);
                        logarithm.widen(value.abs() * FUNCTION_ERROR + UNDERFLOW);
                        logarithm
                    }
                    None => self.compose(Elementary::Ln, base.model.as_ref()?, base.hull)?,
                };
                let product = logarithm.mul(&exponent.as_model()?, self.basis);
                let range = product.range(self.basis);
                self.compose(Elementary::Exp, &product, range)?
            }
        };
        Some(of_function(value, result))
    }

    /// Returns the model of ATAN of two values, where the angle has no jump.
    fn angle(&mut self, y: &Form, x: &Form) -> Option<Model> {
        let (_, to_degrees) = conversions();
        let is_signed = self.semantics.returns_signed_angles;
        let shift = if y.hull.lo() >= 0.0 || x.hull.lo() > 0.0 && is_signed {
            0.0
        } else if y.hull.hi() < 0.0 {
            // A negative angle that underflows stays 0.
            match is_signed {
                true => 0.0,
                false if y.hull.hi() / x.hull.magnitude() < -1e-300 => 360.0,
                false => return None,
            }
        } else if x.hull.hi() < 0.0 && !is_signed {
            // Across the negative x axis: half a turn from the opposite direction, which has no jump there.
            let [y, x] = [y, x].map(Form::opposite);
            return Some(in_degrees(self.direction(&y, &x)?, to_degrees, 180.0));
        } else {
            return None;
        };
        Some(in_degrees(self.direction(y, x)?, to_degrees, shift))
    }

    /// Returns the model of ATAN of a quotient, whose divisor has one sign.
    pub(crate) fn angle_of_quotient(&mut self, y: &Form, x: &Form) -> Option<Model> {
        let (_, to_degrees) = conversions();
        let direction = if x.hull.lo() > 0.0 {
            self.direction(y, x)?
        } else if x.hull.hi() < 0.0 {
            self.direction(&y.opposite(), &x.opposite())?
        } else {
            return None;
        };
        Some(in_degrees(direction, to_degrees, 0.0))
    }

    /// Returns the model of the direction of points in radians, within half a turn of that of a point amid them.
    ///
    /// The points must be on one side of an axis: y ≥ 0, y < 0 or x > 0. Turned by the middle's direction they lie around
    /// the x axis, where the ratio y/x is small.
    fn direction(&mut self, y: &Form, x: &Form) -> Option<Model> {
        let (mid_y, mid_x) = (y.hull.midpoint(), x.hull.midpoint());
        let distance = libm::hypot(mid_y, mid_x);
        let (sine, cosine) = (mid_y / distance, mid_x / distance);
        if !(1e-20..1e20).contains(&distance) {
            return None;
        }
        let (y, x) = (y.as_model()?, x.as_model()?);
        let turned_x = x.scale(cosine).add(&y.scale(sine));
        let turned_y = y.scale(cosine).sub(&x.scale(sine));
        // Any pair of a sine and a cosine is a direction, whatever its rounded length.
        let along = turned_x.range(self.basis);
        if along.lo() <= 0.0 || !turned_y.is_finite() {
            return None;
        }
        let inverse = self.compose(Elementary::Reciprocal, &turned_x, along)?;
        let ratio = turned_y.mul(&inverse, self.basis);
        let range = ratio.range(self.basis);
        let mut angle =
            self.compose(Elementary::Atan, &ratio, range)?.add(&Model::constant(libm::atan2(sine, cosine)));
        angle.widen(std::f64::consts::PI * FUNCTION_ERROR);
        angle.is_finite().then_some(angle)
    }

    /// Returns the model of a real quotient.
    fn quotient(&mut self, a: &Form, b: &Form) -> Option<Model> {
        match b.hull.as_point() {
            Some(divisor) => {
                let inverse = Some(1.0 / divisor).filter(|inverse| inverse.is_normal())?;
                let mut quotient = a.as_model()?.scale(inverse);
                if !is_power_of_two(divisor) {
                    quotient.widen(mul_up(quotient.norm() + quotient.rest, f64::EPSILON));
                }
                Some(quotient)
            }
            None => {
                let inverse = self.compose(Elementary::Reciprocal, b.model.as_ref()?, b.hull)?;
                Some(a.as_model()?.mul(&inverse, self.basis))
            }
        }
    }

    /// Returns the model of a rounding to a whole number: the operand and a new variable for what is cut off.
    pub(crate) fn whole(&mut self, function: Unary, x: &Form, variable: Option<usize>) -> Option<Model> {
        let range = x.hull;
        let towards_zero = if range.lo() >= 0.0 {
            (-0.5, 0.5)
        } else if range.hi() <= 0.0 {
            (0.5, 0.5)
        } else {
            (0.0, 1.0)
        };
        let (shift, reach) = match function {
            Unary::Fix => towards_zero,
            Unary::Fup => (-towards_zero.0, towards_zero.1),
            Unary::Round => (0.0, 0.5),
            _ => return None,
        };
        if range.magnitude() > 1e15 {
            return None;
        }
        let part = Interval::new(shift - reach, shift + reach);
        let cut = match variable {
            Some(variable) => Model::of_variable(self.basis, variable, part),
            None => Model::of_interval(part),
        };
        Some(x.model.as_ref()?.add(&cut))
    }
}

/// Returns a direction in degrees as the interpreter computes it, shifted by a number of half turns.
fn in_degrees(direction: Model, to_degrees: f64, shift: f64) -> Model {
    let mut angle = direction.scale(to_degrees).add(&Model::constant(shift));
    // The function, the conversion and the addition of a turn are off by this much together; half turns in degrees are
    // those in radians × the factor, within a unit in the last place.
    angle.widen(add_up(mul_up(180.0, 2.0 * FUNCTION_ERROR), 720.0 * f64::EPSILON));
    angle
}

/// Returns an angle one turn on.
fn turned(angle: &Model) -> Model {
    let mut turned = angle.add(&Model::constant(360.0));
    turned.widen(mul_up(360.0, f64::EPSILON));
    turned
}

/// Returns the model of a value that is rounded to a double in a range.
fn rounded(model: Model, result: Interval) -> Option<Model> {
    rounded_unless(model, result, false)
}

fn rounded_unless(mut model: Model, result: Interval, is_exact: bool) -> Option<Model> {
    if !is_exact {
        let magnitude = result.magnitude().min(model.norm() + model.rest);
        model.widen(add_up(mul_up(magnitude, HALF_ULP * (1.0 + 1e-9)), 1e-300));
    }
    model.is_finite().then_some(model)
}

/// Returns the model of a function of `libm` whose values lie in a range.
fn of_function(mut model: Model, result: Interval) -> Model {
    // The bound refers to the real value, which is off the computed one by its own part.
    model.widen(add_up(mul_up(result.magnitude(), FUNCTION_ERROR * (1.0 + 1e-9)), UNDERFLOW));
    model
}

/// Returns true where a difference of doubles has no rounding: they are within a factor of 2.
fn is_exact_difference(a: Interval, b: Interval) -> bool {
    let is_near = |a: Interval, b: Interval| a.lo() > 0.0 && a.lo() >= b.hi() / 2.0 && a.hi() / 2.0 <= b.lo();
    is_near(a, b) || is_near(Interval::new(-a.hi(), -a.lo()), Interval::new(-b.hi(), -b.lo()))
}
