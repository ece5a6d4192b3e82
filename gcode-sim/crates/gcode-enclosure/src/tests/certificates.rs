//! Inequalities by certificates: decided on a whole box, and at no point against what is computed.
use proptest::prelude::*;

use crate::*;

/// Builder of expressions of some inputs.
struct Sides(Arena);

impl Sides {
    fn of(&mut self, operator: Binary, a: NodeId, b: NodeId) -> NodeId {
        self.0.binary(operator, a, b)
    }

    fn square(&mut self, x: NodeId) -> NodeId {
        self.of(Binary::Mul, x, x)
    }

    /// SQRT[x·x + y·y].
    fn length(&mut self, x: NodeId, y: NodeId) -> NodeId {
        let (xx, yy) = (self.square(x), self.square(y));
        let sum = self.of(Binary::Add, xx, yy);
        self.0.unary(Unary::Sqrt, sum)
    }

    /// Decides left ≤ right + margin over a box.
    fn decide(&mut self, left: NodeId, right: NodeId, margin: f64, ranges: &[(f64, f64)]) -> Option<bool> {
        let margin = self.0.constant(margin);
        let right = self.of(Binary::Add, right, margin);
        let ranges = ranges.iter().map(|(low, high)| Interval::new(*low, *high)).collect();
        Enclosures::new(Domain::new(ranges)).decide(&self.0, Condition::new(Relation::Le, left, right))
    }
}

#[test]
fn the_inequality_of_cauchy() {
    let mut s = Sides(Arena::default());
    let [a, b, c, d] = [0, 1, 2, 3].map(|input| s.0.input(input));
    let (ac, bd) = (s.of(Binary::Mul, a, c), s.of(Binary::Mul, b, d));
    let product = s.of(Binary::Add, ac, bd);
    let (left, right) = (s.length(a, b), s.length(c, d));
    let lengths = s.of(Binary::Mul, left, right);
    // The lengths are 50 at most, so that all roundings are some 1e-14.
    assert_eq!(s.decide(product, lengths, 1e-12, &[(-5.0, 5.0); 4]), Some(true));
    // Of parallel directions the sides are equal: neither side has a margin.
    assert_eq!(s.decide(product, lengths, -1e-12, &[(-5.0, 5.0); 4]), None);
    assert_eq!(s.decide(lengths, product, 1e-12, &[(-5.0, 5.0); 4]), None);
    // With a·c − b·d it holds as well, with a·c + 2·b·d it doesn't.
    let difference = s.of(Binary::Sub, ac, bd);
    assert_eq!(s.decide(difference, lengths, 1e-12, &[(-5.0, 5.0); 4]), Some(true));
    let more = s.of(Binary::Add, product, bd);
    assert_eq!(s.decide(more, lengths, 1e-12, &[(-5.0, 5.0); 4]), None);
}

#[test]
fn the_inequality_of_the_triangle() {
    let mut s = Sides(Arena::default());
    let [a, b, c, d] = [0, 1, 2, 3].map(|input| s.0.input(input));
    let (x, y) = (s.of(Binary::Add, a, c), s.of(Binary::Add, b, d));
    let (first, second, third) = (s.length(a, b), s.length(c, d), s.length(x, y));
    let sum = s.of(Binary::Add, first, second);
    assert_eq!(s.decide(third, sum, 1e-9, &[(-5.0, 5.0); 4]), Some(true));
    assert_eq!(s.decide(sum, third, 1e-9, &[(-5.0, 5.0); 4]), None);
    // A side is at least the difference of the others.
    let difference = s.of(Binary::Sub, first, second);
    assert_eq!(s.decide(difference, third, 1e-9, &[(-5.0, 5.0); 4]), Some(true));
}

#[test]
fn the_point_of_two_circles_that_cross() {
    let mut s = Sides(Arena::default());
    let [r, t, d] = [0, 1, 2].map(|input| s.0.input(input));
    let (rr, tt, dd) = (s.square(r), s.square(t), s.square(d));
    let sum = s.of(Binary::Add, dd, rr);
    let sum = s.of(Binary::Sub, sum, tt);
    let two = s.0.constant(2.0);
    let divisor = s.of(Binary::Mul, two, d);
    let foot = s.of(Binary::Div, sum, divisor);
    let square = s.square(foot);
    let height = s.of(Binary::Sub, rr, square);
    let (reach, gap) = (s.of(Binary::Add, r, t), s.of(Binary::Sub, r, t));
    let gap = s.0.unary(Unary::Abs, gap);
    let limits = |margin: f64, s: &mut Sides| {
        let margin = s.0.constant(margin);
        let (most, least) = (s.of(Binary::Sub, reach, margin), s.of(Binary::Add, gap, margin));
        [Condition::new(Relation::Lt, d, most), Condition::new(Relation::Gt, d, least)]
    };
    let decided = |s: &mut Sides, limits: &[Condition]| {
        let ranges = vec![Interval::new(1.0, 10.0), Interval::new(1.0, 10.0), Interval::new(0.5, 25.0)];
        let mut path = Enclosures::new(Domain::new(ranges));
        assert!(limits.iter().all(|limit| path.assume(&s.0, *limit)));
        path.decide(&s.0, Condition::new(Relation::Lt, height, Arena::ZERO))
    };
    let both = limits(0.1, &mut s);
    assert_eq!(decided(&mut s, &both), Some(false));
    // One limit alone doesn't suffice.
    assert_eq!(decided(&mut s, &both[..1]), None);
    assert_eq!(decided(&mut s, &both[1..]), None);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    /// Sums, products, roots and quotients of whole multiples of inputs: what is decided holds at every point.
    #[test]
    fn a_decision_holds_at_every_point(
        steps in prop::collection::vec((0_usize..7, 0_usize..40, 0_usize..40), 2..14),
        centres in prop::collection::vec(-4.0..4.0, 3),
        width in prop::sample::select(&[1e-9, 0.3, 3.0, 8.0][..]),
        condition in prop::option::of((0_usize..40, 0_usize..40)),
        margin in prop::sample::select(&[0.0, 1e-15, -1e-15, 1e-12, 0.1][..]),
        shares in prop::collection::vec(prop::collection::vec(0.0..1.0, 3), 40),
    ) {
        let mut arena = Arena::default();
        let mut nodes: Vec<_> = (0..3).map(|input| arena.input(input)).collect();
        nodes.push(arena.constant(2.0));
        for (operation, a, b) in steps {
            let (a, b) = (nodes[nodes.len() - 1 - a % nodes.len()], nodes[b % nodes.len()]);
            nodes.push(match operation {
                0 => arena.binary(Binary::Add, a, b),
                1 => arena.binary(Binary::Sub, a, b),
                2 => arena.binary(Binary::Mul, a, b),
                3 => arena.binary(Binary::Mul, a, a),
                4 => arena.unary(Unary::Sqrt, a),
                5 => arena.binary(Binary::Div, a, b),
                _ => arena.unary(Unary::Abs, a),
            });
        }
        let ranges: Vec<_> =
            centres.iter().map(|centre| Interval::new(centre - width, centre + width)).collect();
        let points: Vec<Vec<f64>> = shares
            .iter()
            .map(|shares| {
                let place = |(range, share): (&Interval, &f64)| match *share {
                    share if share < 0.1 => range.lo(),
                    share if share > 0.9 => range.hi(),
                    share => (range.lo() + share * (range.hi() - range.lo())).clamp(range.lo(), range.hi()),
                };
                ranges.iter().zip(shares).map(place).collect()
            })
            .collect();
        let mut path = Enclosures::new(Domain::new(ranges));
        let condition = condition.map(|(a, b)| {
            Condition::new(Relation::Ge, nodes[a % nodes.len()], nodes[b % nodes.len()])
        });
        if let Some(condition) = condition {
            // A condition that no point keeps leaves nothing to decide.
            prop_assume!(path.assume(&arena, condition));
        }
        let margin = arena.constant(margin);
        let last = *nodes.last().unwrap();
        let last = arena.binary(Binary::Add, last, margin);
        for node in nodes.iter().copied().rev().take(5) {
            let claim = Condition::new(Relation::Le, node, last);
            path.enclose(&arena, node);
            path.enclose(&arena, last);
            let decided = path.decide_by_certificate(&arena, claim.relation, claim.left, claim.right);
            for point in &points {
                let keeps = condition.is_none_or(|condition| arena.holds(condition, point) == Ok(true));
                if let (Some(decided), Ok(holds), true) = (decided, arena.holds(claim, point), keeps) {
                    prop_assert_eq!(decided, holds, "{:?} at {:?}", claim, point);
                }
            }
        }
    }
}
