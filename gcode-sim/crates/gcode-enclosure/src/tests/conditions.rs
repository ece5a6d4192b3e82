//! Conditions of a path and rests of loops: whatever is computed at a point that keeps the conditions lies in the ranges.
use proptest::prelude::*;

use crate::*;

/// Returns a rising or a waving function of a node by its number.
fn function(arena: &mut Arena, kind: usize, x: NodeId) -> NodeId {
    let constant = |arena: &mut Arena, value: f64| arena.constant(value);
    match kind % 7 {
        0 => arena.binary(Binary::Mul, x, x),
        1 => arena.unary(Unary::Sin, x),
        2 => arena.unary(Unary::Exp, x),
        3 => {
            let two = constant(arena, 2.0);
            let sum = arena.binary(Binary::Add, x, two);
            arena.binary(Binary::Div, x, sum)
        }
        4 => {
            let square = arena.binary(Binary::Mul, x, x);
            let cube = arena.binary(Binary::Mul, square, x);
            arena.binary(Binary::Sub, cube, x)
        }
        5 => {
            let sum = arena.binary(Binary::Add, x, Arena::ONE);
            arena.unary(Unary::Sqrt, sum)
        }
        _ => x,
    }
}

/// Returns a range around a place between 0 and 3.
fn range() -> impl Strategy<Value = Interval> {
    let width = prop::sample::select(&[1e-9, 1e-4, 0.01, 0.3, 1.0][..]);
    (0.0..3.0, width).prop_map(|(low, width): (f64, f64)| Interval::new(low, low + width))
}

fn points(parts: &[[f64; 3]], ranges: &[Interval]) -> Vec<Vec<f64>> {
    let at =
        |(range, part): (&Interval, &f64)| (range.lo() + range.width() * part).clamp(range.lo(), range.hi());
    parts.iter().map(|parts| ranges.iter().zip(parts).map(at).collect()).collect()
}

fn parts() -> impl Strategy<Value = Vec<[f64; 3]>> {
    let part = || prop_oneof![Just(0.0), Just(1.0), 0.0..1.0];
    prop::collection::vec([part(), part(), part()], 40)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(600))]

    #[test]
    fn differences_lie_in_their_ranges_under_conditions(
        place in range(),
        kinds in [0_usize..7, 0..7, 0..7],
        slopes in [-2.0..2.0_f64, -2.0..2.0],
        part in 0.0..0.2_f64,
        parts in parts(),
    ) {
        let mut arena = Arena::default();
        let [x, y, z] = [0, 1, 2].map(|input| arena.input(input));
        // f(y) − f(x), times a factor of z, less a multiple of a third function.
        let [at_x, at_y] = [x, y].map(|node| function(&mut arena, kinds[0], node));
        let factor = function(&mut arena, kinds[1], z);
        let [left, right] = [at_y, at_x].map(|node| arena.binary(Binary::Mul, node, factor));
        let slope = arena.constant(slopes[0]);
        let multiple = arena.binary(Binary::Mul, slope, z);
        let bound = function(&mut arena, kinds[2], multiple);
        let ranges = [place, place.widened(part * place.width()), Interval::new(0.0, 1.0)];
        let domain = Domain::new(ranges.to_vec());
        let mut path = Enclosures::new(domain);
        let shifted = {
            let shift = arena.constant(slopes[1] * place.width());
            arena.binary(Binary::Add, x, shift)
        };
        let conditions =
            [Condition::new(Relation::Ge, y, x), Condition::new(Relation::Le, y, shifted)];
        for condition in conditions {
            path.assume(&arena, condition);
        }
        let of = |node: NodeId, point: &[f64]| arena.evaluate(node, point);
        let sides = [(left, right), (right, left), (left, bound), (bound, right)];
        let found: Vec<_> = sides
            .iter()
            .map(|(a, b)| {
                let range = path.difference_range(&arena, *a, *b);
                let answers = [Relation::Ge, Relation::Gt, Relation::Eq]
                    .map(|relation| (relation, path.decide(&arena, Condition::new(relation, *a, *b))));
                (*a, *b, range, answers)
            })
            .collect();
        for point in points(&parts, &ranges) {
            if !conditions.iter().all(|condition| arena.holds(*condition, &point) == Ok(true)) {
                continue;
            }
            for (a, b, range, answers) in &found {
                let (Ok(one), Ok(other)) = (of(*a, &point), of(*b, &point)) else { continue };
                let difference = one - other;
                let is_inside = range.lo() <= difference.next_up() && difference.next_down() <= range.hi();
                prop_assert!(is_inside, "{difference} at {point:?} isn't in {range:?}");
                for (relation, answer) in answers {
                    prop_assert!(answer.is_none_or(|answer| answer == relation.holds(one, other)));
                }
            }
        }
    }

    #[test]
    fn turns_of_a_loop_lie_in_their_ranges(
        places in [range(), range()],
        kind in 0..4_usize,
        turns in 3..9_usize,
        parts in parts(),
    ) {
        let mut arena = Arena::default();
        let [a, b] = [0, 1].map(|input| arena.input(input));
        let (two, three) = (arena.constant(2.0), arena.constant(3.0));
        let mut x = arena.binary(Binary::Add, a, Arena::ONE);
        let mut all = vec![x];
        for _ in 0..turns {
            x = match kind {
                // Newton's root of a + 1, a contraction by a sine, a map that stretches, a mean with the start.
                0 => {
                    let square = arena.binary(Binary::Add, a, Arena::ONE);
                    let quotient = arena.binary(Binary::Div, square, x);
                    let sum = arena.binary(Binary::Add, x, quotient);
                    arena.binary(Binary::Div, sum, two)
                }
                1 => {
                    let sine = arena.unary(Unary::Sin, x);
                    let product = arena.binary(Binary::Mul, sine, b);
                    let product = arena.binary(Binary::Mul, product, x);
                    arena.binary(Binary::Add, product, a)
                }
                2 => {
                    let square = arena.binary(Binary::Mul, x, x);
                    let part = arena.binary(Binary::Div, square, three);
                    arena.binary(Binary::Sub, part, b)
                }
                _ => {
                    let product = arena.binary(Binary::Mul, x, b);
                    let sum = arena.binary(Binary::Add, x, product);
                    let divisor = arena.binary(Binary::Add, b, two);
                    arena.binary(Binary::Div, sum, divisor)
                }
            };
            all.push(x);
        }
        let mut path = Enclosures::new(Domain::new(places.to_vec()));
        let ranges: Vec<_> = all.iter().map(|node| path.enclose_tightly(&arena, *node)).collect();
        let steps: Vec<_> =
            all.windows(2).map(|pair| path.difference_range(&arena, pair[1], pair[0])).collect();
        for point in points(&parts, &places) {
            let values: Vec<_> = all.iter().map_while(|node| arena.evaluate(*node, &point).ok()).collect();
            for (value, range) in values.iter().zip(&ranges) {
                prop_assert!(range.contains(*value), "{value} at {point:?} isn't in {range:?}");
            }
            for (pair, range) in values.windows(2).zip(&steps) {
                let step = pair[1] - pair[0];
                prop_assert!(range.lo() <= step.next_up() && step.next_down() <= range.hi());
            }
        }
    }
}
