//! Guards of macros: which are complete, and which lack a condition.
use crate::*;

/// An arena with the enclosures over ranges of its inputs.
struct Path {
    arena: Arena,
    enclosures: Enclosures,
}

impl Path {
    fn new(ranges: &[(f64, f64)]) -> Self {
        let ranges = ranges.iter().map(|&(lo, hi)| Interval::new(lo, hi)).collect();
        Self { arena: Arena::default(), enclosures: Enclosures::new(Domain::new(ranges)) }
    }

    fn of(&mut self, operator: Binary, a: NodeId, b: NodeId) -> NodeId {
        self.arena.binary(operator, a, b)
    }

    fn assume(&mut self, relation: Relation, a: NodeId, b: NodeId) {
        assert!(self.enclosures.assume(&self.arena, Condition::new(relation, a, b)));
    }

    fn decide(&mut self, relation: Relation, a: NodeId, b: NodeId) -> Option<bool> {
        self.enclosures.decide(&self.arena, Condition::new(relation, a, b))
    }

    fn alarms(&mut self, node: NodeId) -> Vec<PossibleAlarm> {
        self.enclosures.alarms(&self.arena, node)
    }

    /// Returns SQRT[a·a − b·b].
    fn leg(&mut self, a: NodeId, b: NodeId) -> NodeId {
        let (aa, bb) = (self.of(Binary::Mul, a, a), self.of(Binary::Mul, b, b));
        let difference = self.of(Binary::Sub, aa, bb);
        self.arena.unary(Unary::Sqrt, difference)
    }
}

const ANY: (f64, f64) = (-100.0, 100.0);
const OUT_OF_RANGE: PossibleAlarm = PossibleAlarm { kind: AlarmKind::OutOfRange, is_certain: false };

#[test]
fn a_root_of_a_difference_of_squares_needs_both_guards() {
    // IF[#18GT#1] alone leaves #18 below −#1.
    let mut path = Path::new(&[(0.0, 100.0), ANY]);
    let (a, r) = (path.arena.input(0), path.arena.input(1));
    let root = path.leg(a, r);
    assert_eq!(path.alarms(root), [OUT_OF_RANGE]);
    path.assume(Relation::Le, r, a);
    let mut path = Path { enclosures: path.enclosures.clone(), ..path };
    assert_eq!(path.alarms(root), [OUT_OF_RANGE]);
    path.assume(Relation::Ge, r, Arena::ZERO);
    assert_eq!(path.alarms(root), []);
}

#[test]
fn the_magnitude_as_guard_of_a_root() {
    let mut path = Path::new(&[ANY, ANY]);
    let (a, r) = (path.arena.input(0), path.arena.input(1));
    let (abs_a, abs_r) = (path.arena.unary(Unary::Abs, a), path.arena.unary(Unary::Abs, r));
    let root = path.leg(a, r);
    path.assume(Relation::Ge, abs_a, abs_r);
    assert_eq!(path.alarms(root), []);
    // Relations reach through others.
    let mut path = Path::new(&[(0.0, 100.0), (0.0, 100.0), (0.0, 100.0)]);
    let [a, b, c] = [0, 1, 2].map(|input| path.arena.input(input));
    let root = path.leg(a, c);
    path.assume(Relation::Ge, a, b);
    assert_eq!(path.alarms(root), [OUT_OF_RANGE]);
    path.assume(Relation::Gt, b, c);
    assert_eq!(path.alarms(root), []);
    assert_eq!(path.decide(Relation::Gt, a, c), Some(true));
    assert_eq!(path.decide(Relation::Le, a, c), Some(false));
    assert_eq!(path.decide(Relation::Eq, a, c), Some(false));
}

#[test]
fn a_quotient_of_a_guarded_pair_is_a_sine() {
    let mut path = Path::new(&[(0.0, 100.0), (0.0, 100.0)]);
    let (x, r) = (path.arena.input(0), path.arena.input(1));
    let ratio = path.of(Binary::Div, x, r);
    let angle = path.arena.unary(Unary::Acos, ratio);
    path.assume(Relation::Gt, r, Arena::ZERO);
    assert_eq!(path.alarms(angle), [OUT_OF_RANGE]);
    path.assume(Relation::Le, x, r);
    assert_eq!(path.alarms(angle), []);
}

#[test]
fn a_leg_is_not_longer_than_its_hypotenuse() {
    let mut path = Path::new(&[ANY, (1.0, 100.0)]);
    let (x, y) = (path.arena.input(0), path.arena.input(1));
    let (xx, yy) = (path.of(Binary::Mul, x, x), path.of(Binary::Mul, y, y));
    let sum = path.of(Binary::Add, xx, yy);
    let root = path.arena.unary(Unary::Sqrt, sum);
    let ratio = path.of(Binary::Div, x, root);
    let angle = path.arena.unary(Unary::Asin, ratio);
    assert_eq!(path.alarms(angle), []);
    // With both legs near 0 the squares underflow: x = 1e-170 is longer than the root of 0.
    let mut near_zero = Enclosures::new(Domain::new(vec![Interval::new(-1.0, 1.0), Interval::new(0.0, 1.0)]));
    assert_eq!(near_zero.decide(&path.arena, Condition::new(Relation::Ge, root, x)), None);
    assert_eq!(path.arena.evaluate(root, &[1e-170, 0.0]), Ok(0.0));
}

#[test]
fn a_guard_on_a_sum_reaches_its_terms() {
    // #1 + #2 ≤ 10 and #1 ≥ 0: 10 − #1 − #2 ≥ 0 up to rounding, and #2 ≤ 10 plus half a unit in the last place.
    let mut path = Path::new(&[(0.0, 100.0), ANY]);
    let (a, b, ten) = (path.arena.input(0), path.arena.input(1), path.arena.constant(10.0));
    let sum = path.of(Binary::Add, a, b);
    let limit = path.arena.constant(10.000_001);
    assert_eq!(path.decide(Relation::Le, b, limit), None);
    path.assume(Relation::Le, sum, ten);
    assert_eq!(path.decide(Relation::Le, b, limit), Some(true));
    let left = path.of(Binary::Sub, limit, a);
    let left = path.of(Binary::Sub, left, b);
    assert_eq!(path.decide(Relation::Ge, left, Arena::ZERO), Some(true));
    // The same without the margin isn't true of all doubles.
    let left = path.of(Binary::Sub, ten, a);
    let left = path.of(Binary::Sub, left, b);
    assert_eq!(path.decide(Relation::Gt, left, Arena::ZERO), None);
    let domain = path.enclosures.contracted_domain(&path.arena).unwrap();
    assert!(domain.range(1).hi() < 10.000_001, "{domain:?}");
}

#[test]
fn a_divisor_that_is_not_zero_divides() {
    let mut path = Path::new(&[ANY]);
    let x = path.arena.input(0);
    let five = path.arena.constant(5.0);
    let divisor = path.of(Binary::Sub, x, five);
    let quotient = path.of(Binary::Div, Arena::ONE, divisor);
    let kinds: Vec<_> = path.alarms(quotient).iter().map(|alarm| alarm.kind).collect();
    assert!(kinds.contains(&AlarmKind::DivideByZero), "{kinds:?}");
    path.assume(Relation::Ne, x, five);
    let kinds: Vec<_> = path.alarms(quotient).iter().map(|alarm| alarm.kind).collect();
    assert!(!kinds.contains(&AlarmKind::DivideByZero), "{kinds:?}");
    let zero = path.of(Binary::Mul, x, Arena::ZERO);
    let never = path.of(Binary::Div, x, zero);
    assert_eq!(path.alarms(never), [PossibleAlarm { kind: AlarmKind::DivideByZero, is_certain: true }]);
}

#[test]
fn two_formulas_of_one_point_agree() {
    // r·cos(a + b) against r·cos a·cos b − r·sin a·sin b, over a box of 3 inputs.
    let mut path = Path::new(&[(10.0, 12.0), (20.0, 25.0), (-40.0, -36.0)]);
    let [r, a, b] = [0, 1, 2].map(|input| path.arena.input(input));
    let sum = path.of(Binary::Add, a, b);
    let cosine = path.arena.unary(Unary::Cos, sum);
    let direct = path.of(Binary::Mul, r, cosine);
    let [sin_a, cos_a, sin_b, cos_b] = [(Unary::Sin, a), (Unary::Cos, a), (Unary::Sin, b), (Unary::Cos, b)]
        .map(|(function, angle)| path.arena.unary(function, angle));
    let (left, right) = (path.of(Binary::Mul, r, cos_a), path.of(Binary::Mul, r, sin_a));
    let (left, right) = (path.of(Binary::Mul, left, cos_b), path.of(Binary::Mul, right, sin_b));
    let by_parts = path.of(Binary::Sub, left, right);
    let difference = path.of(Binary::Sub, direct, by_parts);
    let range = path.enclosures.enclose_tightly(&path.arena, difference);
    assert!(range.magnitude() < 1e-6, "{range:?}");
    // A wrong twin, 0.01° off, is seen.
    let hundredth = path.arena.constant(0.01);
    let wrong = path.of(Binary::Add, sum, hundredth);
    let cosine = path.arena.unary(Unary::Cos, wrong);
    let wrong = path.of(Binary::Mul, r, cosine);
    assert_eq!(path.decide(Relation::Ne, wrong, by_parts), Some(true));
}

#[test]
fn what_a_rounding_cuts_off_stays_one_number() {
    // y = FIX[x]: y·y − y·y is 0, x − y lies from 0 to 1, and y + 1 > x.
    let mut path = Path::new(&[(0.0, 50.0)]);
    let x = path.arena.input(0);
    let whole = path.arena.unary(Unary::Fix, x);
    let part = path.of(Binary::Sub, x, whole);
    let range = path.enclosures.enclose_tightly(&path.arena, part);
    assert!(range.lo() >= -1e-12 && range.hi() <= 1.0 + 1e-12, "{range:?}");
    let squared = path.of(Binary::Add, whole, Arena::ONE);
    let squared = path.of(Binary::Mul, squared, squared);
    let (square, two) = (path.of(Binary::Mul, whole, whole), path.arena.constant(2.0));
    let double = path.of(Binary::Mul, two, whole);
    let difference = path.of(Binary::Sub, squared, square);
    let difference = path.of(Binary::Sub, difference, double);
    let range = path.enclosures.enclose_tightly(&path.arena, difference);
    assert!((range.lo() - 1.0).abs() < 1e-9 && (range.hi() - 1.0).abs() < 1e-9, "{range:?}");
}

#[test]
fn the_inner_edge_of_a_tool_is_on_the_surface() {
    // O8101: #24=#2*SQRT[[#1-#18]*[#1+#18]]/#1, then #26=#18-#11*#20/2, #26=[#26+ABS[#26]]/2 and the root with #26.
    let mut path = Path::new(&[(500.0, 2000.0), (0.0, 2000.0), (0.0, 1.0), (0.1, 60.0)]);
    let [a, r, h, t] = [0, 1, 2, 3].map(|input| path.arena.input(input));
    let two = path.arena.constant(2.0);
    let width = path.of(Binary::Mul, h, t);
    let half = path.of(Binary::Div, width, two);
    let edge = path.of(Binary::Sub, r, half);
    let magnitude = path.arena.unary(Unary::Abs, edge);
    let double = path.of(Binary::Add, edge, magnitude);
    let edge = path.of(Binary::Div, double, two);
    let root = |path: &mut Path, r: NodeId| {
        let (difference, sum) = (path.of(Binary::Sub, a, r), path.of(Binary::Add, a, r));
        let product = path.of(Binary::Mul, difference, sum);
        path.arena.unary(Unary::Sqrt, product)
    };
    let roots = [root(&mut path, r), root(&mut path, edge)];
    // Without R ≤ A both can lack a value.
    for root in roots {
        assert_eq!(path.alarms(root), [OUT_OF_RANGE]);
    }
    path.assume(Relation::Le, r, a);
    for root in roots {
        assert_eq!(path.alarms(root), []);
    }
    assert!(path.enclosures.enclose(&path.arena, edge).lo() >= 0.0);
}

#[test]
fn a_point_on_the_surface_keeps_its_equation() {
    // Y = B*SQRT[[A-R]*[A+R]]/A: R*R/[A*A] + Y*Y/[B*B] is 1 within some roundings of 1.1e-16.
    let mut path = Path::new(&[(500.0, 2000.0), (300.0, 1200.0), (0.0, 0.999)]);
    let [a, b, share] = [0, 1, 2].map(|input| path.arena.input(input));
    let r = path.of(Binary::Mul, share, a);
    let (difference, sum) = (path.of(Binary::Sub, a, r), path.of(Binary::Add, a, r));
    let product = path.of(Binary::Mul, difference, sum);
    let root = path.arena.unary(Unary::Sqrt, product);
    let y = path.of(Binary::Mul, b, root);
    let y = path.of(Binary::Div, y, a);
    let [rr, aa, yy, bb] = [r, a, y, b].map(|x| path.of(Binary::Mul, x, x));
    let (x_part, y_part) = (path.of(Binary::Div, rr, aa), path.of(Binary::Div, yy, bb));
    let surface = path.of(Binary::Add, x_part, y_part);
    let search = BoundsSearch {
        tolerance: 1e-9,
        relative_tolerance: 0.0,
        max_boxes: 4000,
        threads: 2,
        is_over: &|| false,
    };
    let bounds = bounds(&path.arena, surface, path.enclosures.domain(), &search);
    println!("surface: {:?}, {} boxes", bounds.range, bounds.boxes);
    assert!(bounds.is_complete);
    assert!(bounds.range.lo() > 1.0 - 2e-9 && bounds.range.hi() < 1.0 + 2e-9, "{:?}", bounds.range);
}

#[test]
fn whole_numbers_are_left_out_one_by_one() {
    // FIX[#1]+1 over 0.5…2.5 is 1, 2 or 3.
    let mut path = Path::new(&[(0.5, 2.5)]);
    let x = path.arena.input(0);
    let fixed = path.arena.unary(Unary::Fix, x);
    let whole = path.of(Binary::Add, fixed, Arena::ONE);
    let [two, three] = [2.0, 3.0].map(|value| path.arena.constant(value));
    path.assume(Relation::Ne, whole, Arena::ONE);
    assert_eq!(path.enclosures.enclose(&path.arena, whole), Interval::new(2.0, 3.0));
    path.assume(Relation::Ne, whole, three);
    assert_eq!(path.decide(Relation::Eq, whole, two), Some(true));
    assert!(!path.enclosures.assume(&path.arena, Condition::new(Relation::Ne, whole, two)));
    // A half more is no whole number: 1.5, 2.5 and 3.5 are left where 1 is left out.
    let mut path = Path::new(&[(0.5, 2.5)]);
    let x = path.arena.input(0);
    let (fixed, part) = (path.arena.unary(Unary::Fix, x), path.arena.constant(1.5));
    let sum = path.of(Binary::Add, fixed, part);
    path.assume(Relation::Gt, sum, part);
    assert_eq!(path.enclosures.enclose(&path.arena, sum).hi(), 3.5);
}

#[test]
fn a_direction_near_the_axis_is_near_0_or_near_a_turn() {
    for (is_beyond, least, most) in [(true, 354.0, 360.0), (false, 0.0, 6.0)] {
        // The direction of (10, −1…1): 5.71° and 354.29° are the ends.
        let mut path = Path::new(&[(-1.0, 1.0)]);
        let (y, x) = (path.arena.input(0), path.arena.constant(10.0));
        let angle = path.of(Binary::Atan, y, x);
        assert_eq!(path.enclosures.enclose(&path.arena, angle).lo(), 0.0);
        let half = path.arena.constant(180.0);
        path.assume(if is_beyond { Relation::Gt } else { Relation::Le }, angle, half);
        let range = path.enclosures.enclose(&path.arena, angle);
        assert!(range.lo() >= least && range.hi() <= most, "{range:?}");
        assert!(range.width() >= 5.71, "{range:?}");
    }
}

#[test]
fn an_exponential_of_no_positive_number_is_1_at_most() {
    for (hi, is_limited) in [(0.0, true), (1e-9, false)] {
        let mut path = Path::new(&[(-1.0, hi)]);
        let x = path.arena.input(0);
        let value = path.arena.unary(Unary::Exp, x);
        assert_eq!(path.decide(Relation::Le, value, Arena::ONE) == Some(true), is_limited);
    }
}

#[test]
fn the_sides_of_a_triangle_are_guarded_by_sums_and_by_a_magnitude() {
    // Heron's product s·(s − a)·(s − b)·(s − c) of sides from 1 to 9, each guard with a margin of 1e-6.
    for (has_sum, has_magnitude) in [(true, true), (false, true), (true, false)] {
        let mut path = Path::new(&[(1.0, 9.0), (1.0, 9.0), (1.0, 9.0)]);
        let [a, b, c] = [0, 1, 2].map(|input| path.arena.input(input));
        let margin = path.arena.constant(1e-6);
        let sum = path.of(Binary::Add, a, b);
        if has_sum {
            let least = path.of(Binary::Sub, sum, margin);
            path.assume(Relation::Le, c, least);
        }
        if has_magnitude {
            let difference = path.of(Binary::Sub, a, b);
            let magnitude = path.arena.unary(Unary::Abs, difference);
            let most = path.of(Binary::Add, magnitude, margin);
            path.assume(Relation::Ge, c, most);
        }
        let perimeter = path.of(Binary::Add, sum, c);
        let two = path.arena.constant(2.0);
        let s = path.of(Binary::Div, perimeter, two);
        let mut product = s;
        for side in [a, b, c] {
            let rest = path.of(Binary::Sub, s, side);
            product = path.of(Binary::Mul, product, rest);
        }
        let root = path.arena.unary(Unary::Sqrt, product);
        assert_eq!(path.alarms(root).is_empty(), has_sum && has_magnitude);
    }
}

#[test]
fn a_mean_lies_between_two_numbers_in_order() {
    let mut arena = Arena::default();
    let (a, b) = (arena.input(0), arena.input(1));
    let sum = arena.binary(Binary::Add, a, b);
    let two = arena.constant(2.0);
    let mean = arena.binary(Binary::Div, sum, two);
    let ranges = vec![Interval::new(-100.0, 100.0); 2];
    let mut path = Enclosures::new(Domain::new(ranges.clone()));
    assert!(path.assume(&arena, Condition::new(Relation::Le, a, b)));
    assert_eq!(path.decide(&arena, Condition::new(Relation::Ge, mean, a)), Some(true));
    assert_eq!(path.decide(&arena, Condition::new(Relation::Le, mean, b)), Some(true));
    assert_eq!(path.decide(&arena, Condition::new(Relation::Le, mean, a)), None);
    // Without the order nothing is known.
    let mut path = Enclosures::new(Domain::new(ranges));
    assert_eq!(path.decide(&arena, Condition::new(Relation::Ge, mean, a)), None);
}

#[test]
fn half_of_a_chord_and_the_square_of_a_ratio_keep_their_guard() {
    let mut arena = Arena::default();
    let (a, c) = (arena.input(0), arena.input(1));
    let two = arena.constant(2.0);
    let (double, half) = (arena.binary(Binary::Mul, two, a), arena.binary(Binary::Div, c, two));
    let ratio = arena.binary(Binary::Div, half, a);
    let square = arena.binary(Binary::Mul, ratio, ratio);
    let rest = arena.binary(Binary::Sub, Arena::ONE, square);
    let ranges = vec![Interval::new(0.001, 50.0), Interval::new(0.0, 200.0)];
    let mut path = Enclosures::new(Domain::new(ranges.clone()));
    assert!(path.assume(&arena, Condition::new(Relation::Le, c, double)));
    assert_eq!(path.decide(&arena, Condition::new(Relation::Le, ratio, Arena::ONE)), Some(true));
    assert_eq!(path.decide(&arena, Condition::new(Relation::Lt, rest, Arena::ZERO)), Some(false));
    let mut path = Enclosures::new(Domain::new(ranges));
    assert_eq!(path.decide(&arena, Condition::new(Relation::Lt, rest, Arena::ZERO)), None);
}
