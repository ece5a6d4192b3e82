//! The errors of `libm`'s functions against a reference of 320 bits: less than one unit in the last place, two for
//! atan2, where the enclosures reckon with four.
use num_bigint::BigInt;
use proptest::prelude::*;

/// Bits behind the point.
const BITS: u32 = 320;

/// A number with [`BITS`] bits behind its point.
#[derive(Clone)]
struct Fixed(BigInt);

impl Fixed {
    fn whole(value: i64) -> Self {
        Self(BigInt::from(value) << BITS)
    }

    /// Returns a double of magnitude 2^−200 or more, or 0, exactly.
    fn of(value: f64) -> Self {
        let exponent = (value.to_bits() >> 52 & 0x7ff) as i64 - 1075;
        let mantissa = (value.to_bits() & ((1 << 52) - 1)) | 1 << 52;
        let shift = exponent + i64::from(BITS);
        assert!(value == 0.0 || value.is_normal() && shift >= 0, "{value:e}");
        let magnitude = if value == 0.0 { BigInt::from(0) } else { BigInt::from(mantissa) << shift };
        Self(if value < 0.0 { -magnitude } else { magnitude })
    }

    fn add(&self, other: &Self) -> Self {
        Self(&self.0 + &other.0)
    }

    fn sub(&self, other: &Self) -> Self {
        Self(&self.0 - &other.0)
    }

    fn mul(&self, other: &Self) -> Self {
        Self((&self.0 * &other.0) >> BITS)
    }

    fn div(&self, other: &Self) -> Self {
        Self((&self.0 << BITS) / &other.0)
    }

    fn over(&self, divisor: i64) -> Self {
        Self(&self.0 / BigInt::from(divisor))
    }

    fn sqrt(&self) -> Self {
        Self((&self.0 << BITS).sqrt())
    }

    fn is_zero(&self) -> bool {
        self.0 == BigInt::from(0)
    }

    fn is_negative(&self) -> bool {
        self.0 < BigInt::from(0)
    }

    /// Returns the nearest whole number of a quotient.
    fn rounded_ratio(&self, unit: &Self) -> i64 {
        let doubled: BigInt = (&self.0 * 2 + &unit.0) / (&unit.0 * 2);
        let floor = if (&self.0 * 2 + &unit.0) < BigInt::from(0) { doubled - 1 } else { doubled };
        floor.try_into().unwrap()
    }

    /// Returns Σ terms, the first given, each next one by a function of its number and the one before.
    fn series(first: Self, next: impl Fn(i64, &Self) -> Self) -> Self {
        let (mut sum, mut term) = (first.clone(), first);
        for number in 1.. {
            term = next(number, &term);
            if term.is_zero() {
                break;
            }
            sum = sum.add(&term);
        }
        sum
    }

    /// Returns the arc tangent of a number of magnitude below 1/2: Σ (−1)^n·x^(2n+1)/(2n+1).
    fn small_atan(&self) -> Self {
        let square = self.mul(self);
        let mut sum = self.clone();
        let mut power = self.clone();
        for number in 1.. {
            power = Self(-power.mul(&square).0);
            let term = power.over(2 * number + 1);
            if power.is_zero() {
                break;
            }
            sum = sum.add(&term);
        }
        sum
    }

    fn pi() -> Self {
        let atan = |divisor: i64| Self::whole(1).over(divisor).small_atan();
        Self(atan(5).0 * 16 - atan(239).0 * 4)
    }

    fn ln_2() -> Self {
        Self::whole(2).ln_of_ratio()
    }

    /// Returns the logarithm of a number between 1/2 and 2: 2·artanh((x − 1)/(x + 1)).
    fn ln_of_ratio(&self) -> Self {
        let one = Self::whole(1);
        let ratio = self.sub(&one).div(&self.add(&one));
        let square = ratio.mul(&ratio);
        let (mut sum, mut power) = (ratio.clone(), ratio);
        for number in 1.. {
            power = power.mul(&square);
            if power.is_zero() {
                break;
            }
            sum = sum.add(&power.over(2 * number + 1));
        }
        Self(sum.0 * 2)
    }

    fn sin_cos(&self) -> [Self; 2] {
        let quarter = Self::pi().over(2);
        let turns = self.rounded_ratio(&quarter);
        let rest = self.sub(&Self(&quarter.0 * turns));
        let square = rest.mul(&rest);
        let minus = |term: &Self| Self(-term.mul(&square).0);
        let sine = Self::series(rest, |n, term| minus(term).over(2 * n * (2 * n + 1)));
        let cosine = Self::series(Self::whole(1), |n, term| minus(term).over((2 * n - 1) * 2 * n));
        let negative = |x: &Self| Self(-x.0.clone());
        match turns.rem_euclid(4) {
            0 => [sine, cosine],
            1 => [cosine, negative(&sine)],
            2 => [negative(&sine), negative(&cosine)],
            _ => [negative(&cosine), sine],
        }
    }

    fn exp(&self) -> Self {
        let ln_2 = Self::ln_2();
        let doublings = self.rounded_ratio(&ln_2);
        let rest = self.sub(&Self(&ln_2.0 * doublings));
        let value = Self::series(Self::whole(1), |n, term| term.mul(&rest).over(n));
        Self(if doublings >= 0 { value.0 << doublings } else { value.0 >> -doublings })
    }

    fn ln(value: f64) -> Self {
        let exponent = (value.to_bits() >> 52) as i64 - 1023;
        let mantissa = f64::from_bits(value.to_bits() & ((1 << 52) - 1) | 1023 << 52);
        Self::of(mantissa).ln_of_ratio().add(&Self(Self::ln_2().0 * exponent))
    }

    fn atan(&self) -> Self {
        let one = Self::whole(1);
        if self.is_negative() {
            return Self(-Self(-self.0.clone()).atan().0);
        }
        if self.0 > one.0 {
            return Self::pi().over(2).sub(&one.div(self).atan());
        }
        let half = |x: &Self| x.div(&one.add(&one.add(&x.mul(x)).sqrt()));
        Self(half(&half(self)).small_atan().0 * 4)
    }
}

/// Fails unless a computed double is within so many units of 2^−52 of the reference.
fn check(name: &str, x: f64, computed: f64, reference: &Fixed, units: u32) {
    let distance = Fixed::of(computed).sub(reference);
    let distance = if distance.is_negative() { -distance.0 } else { distance.0 };
    let magnitude = if reference.is_negative() { -reference.0.clone() } else { reference.0.clone() };
    assert!(distance << 52 <= magnitude * units, "{name} of {x:e}: {computed:e}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]

    #[test]
    fn functions_are_within_a_unit_in_the_last_place(
        share in -1.0..1.0_f64,
        scale in prop::sample::select(&[1e-9, 1e-3, 0.1, 1.0, 3.0, 30.0, 5000.0][..]),
        quarter in -40_i32..40,
    ) {
        prop_assume!(share.abs() > 1e-6);
        let x = share * scale;
        let near_quarter = f64::from(quarter) * std::f64::consts::FRAC_PI_2 + share * 1e-9 * scale;
        for x in [x, near_quarter] {
            let [sine, cosine] = Fixed::of(x).sin_cos();
            check("sin", x, libm::sin(x), &sine, 1);
            check("cos", x, libm::cos(x), &cosine, 1);
            check("tan", x, libm::tan(x), &sine.div(&cosine), 1);
        }
        check("atan", x, libm::atan(x), &Fixed::of(x).atan(), 1);
        check("log", x.abs(), libm::log(x.abs()), &Fixed::ln(x.abs()), 1);
        check("log", 1.0 + x.abs(), libm::log(1.0 + x.abs()), &Fixed::ln(1.0 + x.abs()), 1);
        if scale <= 30.0 {
            check("exp", x, libm::exp(x), &Fixed::of(x).exp(), 1);
        }
        for sine in [share, 1.0 - share.abs() * 1e-9, share * scale.min(1.0)] {
            let root = Fixed::whole(1).sub(&Fixed::of(sine).mul(&Fixed::of(sine))).sqrt();
            let angle = Fixed::of(sine).div(&root).atan();
            check("asin", sine, libm::asin(sine), &angle, 1);
            check("acos", sine, libm::acos(sine), &Fixed::pi().over(2).sub(&angle), 1);
        }
    }

    #[test]
    fn functions_of_two_values_are_within_two_units(
        y in -100.0..100.0_f64,
        x in 0.001..100.0_f64,
        exponent in -8.0..8.0_f64,
    ) {
        prop_assume!(y.abs() > 1e-6 && exponent.abs() > 1e-6);
        let angle = Fixed::of(y).div(&Fixed::of(x)).atan();
        check("atan2", y, libm::atan2(y, x), &angle, 2);
        let half_turn = if y < 0.0 { Fixed(-Fixed::pi().0) } else { Fixed::pi() };
        check("atan2", y, libm::atan2(y, -x), &half_turn.sub(&angle), 2);
        let power = Fixed::ln(x).mul(&Fixed::of(exponent)).exp();
        check("pow", x, libm::pow(x, exponent), &power, 1);
    }

    #[test]
    fn conversions_multiply_by_a_constant(x in any::<f64>(), near in -720.0..720.0_f64) {
        let (to_radians, to_degrees) = crate::form::conversions();
        for x in [x, near] {
            prop_assert!(x.is_nan() || x.to_radians() == x * to_radians);
            prop_assert!(x.is_nan() || x.to_degrees() == x * to_degrees);
        }
    }
}

#[test]
fn the_conversions_are_within_a_unit_in_the_last_place() {
    let (to_radians, to_degrees) = crate::form::conversions();
    check("radians", 1.0, to_radians, &Fixed::pi().over(180), 1);
    check("degrees", 1.0, to_degrees, &Fixed::whole(180).div(&Fixed::pi()), 1);
}

#[test]
fn angles_stay_within_their_quadrants() {
    // The largest results are those of the ends and of the doubles beside them.
    let near_one = (0..2000).map(|step| f64::from_bits(1.0_f64.to_bits() - step));
    for sine in near_one.chain([0.5, 0.0, 5e-324, 1e-9, 7e-9]) {
        assert!(libm::asin(sine).to_degrees() <= 90.0, "{sine}");
        assert!((0.0..=180.0).contains(&libm::acos(sine).to_degrees()), "{sine}");
        assert!((0.0..=180.0).contains(&libm::acos(-sine).to_degrees()), "{sine}");
    }
    for power in 0..1023 {
        let tangent = f64::from_bits((1023 + power) << 52);
        for tangent in [tangent, tangent.next_down(), tangent * 1.7] {
            assert!(libm::atan(tangent).to_degrees() <= 90.0, "{tangent:e}");
            assert!(libm::atan2(tangent, -1e-5).to_degrees() <= 180.0, "{tangent:e}");
            assert!(libm::atan2(1.0 / tangent, -1.0).to_degrees() <= 180.0, "{tangent:e}");
        }
    }
}
