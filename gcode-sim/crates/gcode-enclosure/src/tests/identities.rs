//! Two formulas of one quantity: the range of their difference holds every computed one, and is as small as the roundings.
use crate::{Arena, Binary, Domain, Enclosures, Interval, NodeId, Unary};

/// Builder of expressions of some inputs.
struct Formulas(Arena);

impl Formulas {
    fn of(&mut self, operator: Binary, a: NodeId, b: NodeId) -> NodeId {
        self.0.binary(operator, a, b)
    }

    fn square(&mut self, x: NodeId) -> NodeId {
        self.of(Binary::Mul, x, x)
    }

    fn root(&mut self, x: NodeId) -> NodeId {
        self.0.unary(Unary::Sqrt, x)
    }
}

/// Returns points of a box: corners, places near them, and a sequence that fills it.
fn points(ranges: &[Interval]) -> Vec<Vec<f64>> {
    let mut points = Vec::new();
    for index in 0..4000_u32 {
        let coordinate = |(place, range): (usize, &Interval)| {
            let step = f64::from(index) * [0.618_033_988_7, 0.754_877_666_2, 0.569_840_290_9][place];
            let part = match index % 4 {
                0 => step.fract(),
                // Near either end, by a distance of 1e-1 to 1e-16 of the width.
                1 => libm::pow(10.0, -16.0 * step.fract()),
                2 => 1.0 - libm::pow(10.0, -16.0 * step.fract()),
                _ => f64::from(index >> (2 + place) & 1),
            };
            (range.lo() + (range.hi() - range.lo()) * part).clamp(range.lo(), range.hi())
        };
        points.push(ranges.iter().enumerate().map(coordinate).collect());
    }
    points
}

/// Asserts that the range of a node over the whole box holds its values at many points; returns it.
fn enclosed(formulas: &Formulas, node: NodeId, ranges: &[(f64, f64)]) -> Interval {
    let ranges: Vec<_> = ranges.iter().map(|(low, high)| Interval::new(*low, *high)).collect();
    let range = Enclosures::new(Domain::new(ranges.clone())).enclose(&formulas.0, node);
    for point in points(&ranges) {
        let Ok(value) = formulas.0.evaluate(node, &point) else { continue };
        assert!(range.contains(value), "{value:e} at {point:?} outside {range:?}");
    }
    range
}

#[test]
fn the_sag_of_a_circle_by_two_formulas() {
    let mut f = Formulas(Arena::default());
    let (a, r) = (f.0.input(0), f.0.input(1));
    let (aa, rr) = (f.square(a), f.square(r));
    let difference = f.of(Binary::Sub, rr, aa);
    let root = f.root(difference);
    let sag = f.of(Binary::Sub, r, root);
    let sum = f.of(Binary::Add, r, root);
    let quotient = f.of(Binary::Div, aa, sum);
    let rest = f.of(Binary::Sub, sag, quotient);
    // Where the root is 0 its argument is off by 2500 units of 2^-53: 3e-13, which the sum 50 divides; the sag is 50.
    let range = enclosed(&f, rest, &[(0.0, 50.0), (50.0, 200.0)]);
    assert!(range.magnitude() < 1e-11, "{range:?}");
    assert!(range.magnitude() > 1e-14, "{range:?}");
}

#[test]
fn a_sag_with_another_factor_is_none() {
    let mut f = Formulas(Arena::default());
    let (a, r) = (f.0.input(0), f.0.input(1));
    let (aa, rr) = (f.square(a), f.square(r));
    let difference = f.of(Binary::Sub, rr, aa);
    let root = f.root(difference);
    let sag = f.of(Binary::Sub, r, root);
    let sum = f.of(Binary::Add, r, root);
    let factor = f.0.constant(1.0 + 1e-9);
    let more = f.of(Binary::Mul, aa, factor);
    let quotient = f.of(Binary::Div, more, sum);
    let rest = f.of(Binary::Sub, sag, quotient);
    // At a = r = 50 it is 5e-8.
    let range = enclosed(&f, rest, &[(0.0, 50.0), (50.0, 200.0)]);
    assert!(range.lo() <= -4.99e-8, "{range:?}");
}

#[test]
fn a_rotation_keeps_the_length() {
    let mut f = Formulas(Arena::default());
    let [x, y, t] = [0, 1, 2].map(|input| f.0.input(input));
    let (sine, cosine) = (f.0.unary(Unary::Sin, t), f.0.unary(Unary::Cos, t));
    let product = |f: &mut Formulas, a, b| f.of(Binary::Mul, a, b);
    let (xc, ys) = (product(&mut f, x, cosine), product(&mut f, y, sine));
    let (xs, yc) = (product(&mut f, x, sine), product(&mut f, y, cosine));
    let (turned_x, turned_y) = (f.of(Binary::Sub, xc, ys), f.of(Binary::Add, xs, yc));
    let squares = [turned_x, turned_y, x, y].map(|node| f.square(node));
    let (after, before) =
        (f.of(Binary::Add, squares[0], squares[1]), f.of(Binary::Add, squares[2], squares[3]));
    let rest = f.of(Binary::Sub, after, before);
    // 200 × some units in the last place.
    let range = enclosed(&f, rest, &[(-10.0, 10.0), (-10.0, 10.0), (0.0, 360.0)]);
    assert!(range.magnitude() < 1e-11, "{range:?}");
}

#[test]
fn a_double_angle_and_complements() {
    let mut f = Formulas(Arena::default());
    let x = f.0.input(0);
    let two = f.0.constant(2.0);
    let double = f.of(Binary::Mul, two, x);
    let (sine, of_double) = (f.0.unary(Unary::Sin, x), f.0.unary(Unary::Cos, double));
    let square = f.square(sine);
    let twice = f.of(Binary::Mul, two, square);
    let other = f.of(Binary::Sub, Arena::ONE, twice);
    let rest = f.of(Binary::Sub, of_double, other);
    assert!(enclosed(&f, rest, &[(-180.0, 180.0)]).magnitude() < 1e-13);

    let (arc_sine, arc_cosine) = (f.0.unary(Unary::Asin, x), f.0.unary(Unary::Acos, x));
    let sum = f.of(Binary::Add, arc_sine, arc_cosine);
    let range = enclosed(&f, sum, &[(0.0, 1.0)]);
    assert!(range.lo() > 90.0 - 1e-10 && range.hi() < 90.0 + 1e-10, "{range:?}");
    // From −1 on, the arc sine has a turn more: 450.
    assert!(enclosed(&f, sum, &[(-1.0, 1.0)]).hi() >= 450.0 - 1e-9);
}

#[test]
fn the_direction_of_polar_coordinates() {
    for is_signed in [false, true] {
        let semantics = crate::Semantics { returns_signed_angles: is_signed, ..Default::default() };
        let mut f = Formulas(Arena::new(semantics));
        let (r, t) = (f.0.input(0), f.0.input(1));
        let (sine, cosine) = (f.0.unary(Unary::Sin, t), f.0.unary(Unary::Cos, t));
        let (y, x) = (f.of(Binary::Mul, r, sine), f.of(Binary::Mul, r, cosine));
        let angle = f.of(Binary::Atan, y, x);
        let rest = f.of(Binary::Sub, angle, t);
        let turn = if is_signed { (-180.0, 180.0) } else { (0.0, 360.0) };
        assert!(enclosed(&f, rest, &[(0.5, 10.0), turn]).magnitude() < 1e-11);
        // Below 0 a turn is added, and taken away again here.
        if !is_signed {
            let whole = f.0.constant(360.0);
            let less = f.of(Binary::Sub, angle, whole);
            let rest = f.of(Binary::Sub, less, t);
            assert!(enclosed(&f, rest, &[(0.5, 10.0), (-359.0, -1e-9)]).magnitude() < 1e-11);
            assert!(enclosed(&f, rest, &[(0.5, 10.0), (-360.0, 0.0)]).magnitude() >= 359.0);
        }
        // Beyond the turn, and for a negative radius, the direction is another one.
        let beyond = enclosed(&f, rest, &[(0.5, 10.0), (turn.0, turn.1 + 1.0)]);
        assert!(beyond.lo() <= -359.0, "{beyond:?}");
        let opposite = enclosed(&f, rest, &[(-10.0, 10.0), turn]);
        assert!(opposite.hi() >= 179.0, "{opposite:?}");
    }
}

#[test]
fn roots_by_two_formulas() {
    let mut f = Formulas(Arena::default());
    let [a, b, r] = [0, 1, 2].map(|input| f.0.input(input));
    let (first, rr) = (f.of(Binary::Div, r, a), f.square(r));
    let ratio = f.square(first);
    let part = f.of(Binary::Sub, Arena::ONE, ratio);
    let root = f.root(part);
    let left = f.of(Binary::Mul, b, root);
    let aa = f.square(a);
    let legs = f.of(Binary::Sub, aa, rr);
    let leg = f.root(legs);
    let product = f.of(Binary::Mul, b, leg);
    let right = f.of(Binary::Div, product, a);
    let rest = f.of(Binary::Sub, left, right);
    // The heights are 180 to 1200; the squares are multiplied by the fourth power of a, of which the least is 256 times less.
    let ranges = [(500.0, 2000.0), (300.0, 1200.0), (0.0, 400.0)];
    assert!(enclosed(&f, rest, &ranges).magnitude() < 1e-7);

    let mut f = Formulas(Arena::default());
    let x = f.0.input(0);
    let next = f.of(Binary::Add, x, Arena::ONE);
    let (high, low) = (f.root(next), f.root(x));
    let (difference, sum) = (f.of(Binary::Sub, high, low), f.of(Binary::Add, high, low));
    let quotient = f.of(Binary::Div, Arena::ONE, sum);
    let rest = f.of(Binary::Sub, difference, quotient);
    // The squares are off by some units of 1001, 1.1e-13 each; the least sum is 1.
    assert!(enclosed(&f, rest, &[(0.0, 1000.0)]).magnitude() < 1e-11);
}

#[test]
fn a_widening_widens_an_identity() {
    let of = |widening: f64| {
        let mut f = Formulas(Arena::default().with_widening(widening));
        let (x, y) = (f.0.input(0), f.0.input(1));
        let (sum, difference) = (f.of(Binary::Add, x, y), f.of(Binary::Sub, x, y));
        let product = f.of(Binary::Mul, sum, difference);
        let (xx, yy) = (f.square(x), f.square(y));
        let squares = f.of(Binary::Sub, xx, yy);
        let rest = f.of(Binary::Sub, product, squares);
        enclosed(&f, rest, &[(1.0, 100.0), (1.0, 100.0)])
    };
    // At x = 100 and y = 1 a product of 101 · 99 that is off by a part of 1e-9 is off by 1e-5.
    assert!(of(0.0).magnitude() < 1e-10);
    assert!((1e-5..1e-3).contains(&of(1e-9).magnitude()), "{:?}", of(1e-9));
}

/// Returns r·f[x ± y] − r·(its two products by the functions of x and y), where one sign may be wrong.
fn angle_sum_rest(f: &mut Formulas, function: Unary, operator: Binary, is_wrong: bool) -> NodeId {
    let [x, y, r] = [0, 1, 2].map(|input| f.0.input(input));
    let [sine_x, cosine_x] = [Unary::Sin, Unary::Cos].map(|function| f.0.unary(function, x));
    let [sine_y, cosine_y] = [Unary::Sin, Unary::Cos].map(|function| f.0.unary(function, y));
    let angle = f.of(operator, x, y);
    let of_sum = f.0.unary(function, angle);
    let left = f.of(Binary::Mul, r, of_sum);
    let (first, second, is_plus) = match function {
        Unary::Sin => ((sine_x, cosine_y), (cosine_x, sine_y), operator == Binary::Add),
        _ => ((cosine_x, cosine_y), (sine_x, sine_y), operator == Binary::Sub),
    };
    let [first, second] = [first, second].map(|(a, b)| f.of(Binary::Mul, a, b));
    let combined = if is_plus != is_wrong { Binary::Add } else { Binary::Sub };
    let sum = f.of(combined, first, second);
    let right = f.of(Binary::Mul, r, sum);
    f.of(Binary::Sub, left, right)
}

#[test]
fn the_sine_and_cosine_of_sums_and_differences_of_angles() {
    for function in [Unary::Sin, Unary::Cos] {
        for operator in [Binary::Add, Binary::Sub] {
            let ranges = [(0.0, 360.0), (-90.0, 90.0), (1.0, 500.0)];
            let mut f = Formulas(Arena::default());
            let rest = angle_sum_rest(&mut f, function, operator, false);
            let range = enclosed(&f, rest, &ranges);
            // 500 × (some 30 units of 1, and the rounding of 450° as a part of a radian).
            assert!(range.magnitude() < 1e-11, "{function:?} {operator:?}: {range:?}");
            let mut f = Formulas(Arena::default());
            let rest = angle_sum_rest(&mut f, function, operator, true);
            // At x = y = 45° the products differ by 500 · 2 · 1/2.
            assert!(enclosed(&f, rest, &ranges).magnitude() >= 500.0);
        }
    }
}

#[test]
fn a_quarter_turn_added_to_an_angle() {
    let mut f = Formulas(Arena::default());
    let x = f.0.input(0);
    let [_, cosine] = [Unary::Sin, Unary::Cos].map(|function| f.0.unary(function, x));
    for (turn, is_equal) in [(90.0, true), (90.001, false)] {
        let turn = f.0.constant(turn);
        let angle = f.of(Binary::Add, x, turn);
        let sine = f.0.unary(Unary::Sin, angle);
        let rest = f.of(Binary::Sub, sine, cosine);
        let range = enclosed(&f, rest, &[(-720.0, 720.0)]);
        // 0.001° is 1.745e-5 of a radian.
        assert_eq!(range.magnitude() < 1e-13, is_equal, "{range:?}");
        assert!(is_equal || range.magnitude() >= 1.74e-5, "{range:?}");
    }
}

#[test]
fn a_square_between_other_factors_has_its_sign() {
    let mut f = Formulas(Arena::default());
    let (x, y) = (f.0.input(0), f.0.input(1));
    let (two, factor) = (f.0.constant(2.0), f.0.constant(-25.0));
    let rest = f.of(Binary::Sub, x, two);
    let left = f.of(Binary::Mul, factor, rest);
    let product = f.of(Binary::Mul, left, rest);
    // −25·(x − 2)² from x = −2 to 3: 0 at 2, −400 at −2.
    let range = enclosed(&f, product, &[(-2.0, 3.0), (-1.0, 1.0)]);
    assert_eq!(range.hi(), 0.0);
    assert!(range.lo() > -400.000_000_1, "{range:?}");
    // Times y, from −1 to 1, both signs are possible.
    let product = f.of(Binary::Mul, product, y);
    let range = enclosed(&f, product, &[(-2.0, 3.0), (-1.0, 1.0)]);
    assert!(range.lo() < -399.9 && range.hi() > 399.9 && range.hi() < 400.000_001, "{range:?}");
}

#[test]
fn a_power_of_a_sum_is_the_product_of_powers() {
    let mut f = Formulas(Arena::default());
    let (x, y) = (f.0.input(0), f.0.input(1));
    let [of_x, of_y] = [x, y].map(|x| f.0.unary(Unary::Exp, x));
    let product = f.of(Binary::Mul, of_x, of_y);
    let sum = f.of(Binary::Add, x, y);
    let power = f.0.unary(Unary::Exp, sum);
    let rest = f.of(Binary::Sub, product, power);
    // e¹⁰ is 22026, whose unit in the last place is 4e-12; a dozen of them.
    let range = enclosed(&f, rest, &[(-5.0, 5.0), (-5.0, 5.0)]);
    assert!(range.magnitude() < 1e-10 && range.magnitude() > 4e-12, "{range:?}");
}

#[test]
fn a_sum_in_another_order_differs_by_four_roundings() {
    let mut f = Formulas(Arena::default());
    let [x, y, z] = [0, 1, 2].map(|input| f.0.input(input));
    let (xy, yz) = (f.of(Binary::Add, x, y), f.of(Binary::Add, y, z));
    let (left, right) = (f.of(Binary::Add, xy, z), f.of(Binary::Add, x, yz));
    let rest = f.of(Binary::Sub, left, right);
    // Sums up to 2 and 3 are rounded by 2^−52 at most.
    let range = enclosed(&f, rest, &[(-1.0, 1.0); 3]);
    assert!(range.magnitude() < 9e-16 && range.magnitude() > 2.2e-16, "{range:?}");
}

#[test]
fn the_opposite_of_a_difference_is_the_difference_the_other_way_round() {
    let mut arena = Arena::default();
    let (x, y) = (arena.input(0), arena.input(1));
    let (difference, other) = (arena.binary(Binary::Sub, x, y), arena.binary(Binary::Sub, y, x));
    assert_eq!(arena.unary(Unary::Neg, difference), other);
    assert_eq!(arena.binary(Binary::Add, difference, other), Arena::ZERO);
    // Where results are off, the two may be off by other parts.
    let mut arena = Arena::default().with_widening(1e-9);
    let (x, y) = (arena.input(0), arena.input(1));
    let (difference, other) = (arena.binary(Binary::Sub, x, y), arena.binary(Binary::Sub, y, x));
    assert_ne!(arena.unary(Unary::Neg, difference), other);
}
