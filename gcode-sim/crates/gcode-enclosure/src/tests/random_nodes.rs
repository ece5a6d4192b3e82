//! Random expressions over random boxes: whatever is computed at a point lies in the enclosure.
use proptest::prelude::*;

use crate::*;

const UNARY: [Unary; 17] = [
    Unary::Neg,
    Unary::Abs,
    Unary::Sqrt,
    Unary::Sin,
    Unary::Cos,
    Unary::Tan,
    Unary::Asin,
    Unary::Acos,
    Unary::Atan,
    Unary::Exp,
    Unary::Ln,
    Unary::Fix,
    Unary::Fup,
    Unary::Round,
    Unary::Bin,
    Unary::Bcd,
    Unary::Residue,
];

const BINARY: [Binary; 16] = [
    Binary::Add,
    Binary::Sub,
    Binary::Mul,
    Binary::Div,
    Binary::Add,
    Binary::Sub,
    Binary::Mul,
    Binary::Div,
    Binary::Mod,
    Binary::And,
    Binary::Or,
    Binary::Xor,
    Binary::Pow,
    Binary::Atan,
    Binary::Compare(Relation::Gt),
    Binary::Atan,
];

const RELATIONS: [Relation; 6] =
    [Relation::Eq, Relation::Ne, Relation::Gt, Relation::Ge, Relation::Lt, Relation::Le];

/// Numbers near which functions change: branch points, quadrants, halves, limits of the format.
const PLACES: [f64; 28] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.5,
    -0.5,
    1.5,
    2.0,
    3.0,
    10.0,
    -10.0,
    45.0,
    90.0,
    -90.0,
    180.0,
    270.0,
    360.0,
    720.5,
    1000.0,
    1e-8,
    1e-300,
    5e-324,
    -5e-324,
    1e10,
    4_294_967_295.0,
    1e150,
    f64::MAX,
    -1e308,
];
const WIDTHS: [f64; 10] = [0.0, 1e-320, 1e-15, 1e-9, 1e-3, 0.5, 1.0, 20.0, 400.0, 1e200];

fn range() -> impl Strategy<Value = Interval> {
    let place = prop_oneof![4 => -20.0..20.0, 4 => prop::sample::select(&PLACES[..]), 1 => any::<f64>()];
    let width = prop_oneof![3 => 0.0..4.0, 3 => prop::sample::select(&WIDTHS[..])];
    (place, width, 0..3).prop_map(|(place, width, side): (f64, f64, i32)| {
        let place = if place.is_nan() { 0.0 } else { place };
        let (below, above) = [(0.0, width), (width, 0.0), (width, width)][side as usize];
        Interval::new((place - below).max(-f64::MAX), (place + above).min(f64::MAX))
    })
}

fn semantics() -> impl Strategy<Value = Semantics> {
    any::<[bool; 5]>().prop_map(|[a, b, c, d, e]| Semantics {
        returns_signed_angles: a,
        zeroes_residues: b,
        tan_90_alarms: c,
        atan_of_zeros_alarms: d,
        negative_bits_alarm: e,
    })
}

/// Builds nodes from triples of an operation and its operands among the nodes before it.
fn build(semantics: Semantics, inputs: usize, steps: &[(usize, usize, usize, f64)]) -> (Arena, Vec<NodeId>) {
    let mut arena = Arena::new(semantics);
    let mut nodes: Vec<_> = (0..inputs).map(|input| arena.input(input)).collect();
    for &(operation, a, b, constant) in steps {
        // Late operands are likelier, so that expressions become deep.
        let pick = |index: usize| nodes[nodes.len() - 1 - (index * index / 97) % nodes.len()];
        let (a, b) = (pick(a), pick(b));
        let node = match operation {
            0..=16 => arena.unary(UNARY[operation], a),
            17..=19 => {
                let constant = arena.constant(constant);
                arena.binary(BINARY[operation - 17], a, constant)
            }
            20..=22 => arena.binary(BINARY[operation - 19], a, a),
            23 => arena.round_scaled(a, 1000.0),
            _ => arena.binary(BINARY[(operation - 24) % 16], a, b),
        };
        nodes.push(node);
    }
    (arena, nodes)
}

/// Returns points of a box: ends, the middle, and shares of the width.
fn points(domain: &Domain, shares: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let of_shares = shares.iter().map(|shares| {
        let ranges = domain.ranges().iter().zip(shares);
        let place = |(range, share): (&Interval, &f64)| match share {
            share if *share < 0.15 => range.lo(),
            share if *share > 0.85 => range.hi(),
            share if *share < 0.2 => range.lo().next_up().min(range.hi()),
            share if *share > 0.8 => range.hi().next_down().max(range.lo()),
            share if (0.49..0.52).contains(share) && range.contains(0.0) => -0.0,
            share => {
                let share = (share - 0.2) / 0.6;
                (range.lo() * (1.0 - share) + range.hi() * share).clamp(range.lo(), range.hi())
            }
        };
        ranges.map(place).collect()
    });
    std::iter::once(domain.midpoint()).chain(of_shares).collect()
}

fn steps() -> impl Strategy<Value = Vec<(usize, usize, usize, f64)>> {
    let constant = prop_oneof![-10.0..10.0, prop::sample::select(&PLACES[..])];
    prop::collection::vec((0_usize..64, 0_usize..60, 0_usize..60, constant), 1..12)
}

fn shares() -> impl Strategy<Value = Vec<Vec<f64>>> {
    prop::collection::vec(prop::collection::vec(0.0..1.0, 3), 12)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12 * ProptestConfig::default().cases, ..ProptestConfig::default() })]

    #[test]
    fn a_computed_value_lies_in_its_enclosure(
        semantics in semantics(),
        ranges in prop::collection::vec(range(), 3),
        steps in steps(),
        shares in shares(),
        degree in 0_u32..7,
    ) {
        let (arena, nodes) = build(semantics, 3, &steps);
        let domain = Domain::new(ranges);
        let mut enclosures = Enclosures::with_degree(domain.clone(), degree);
        let points = points(&domain, &shares);
        for node in nodes {
            let alarms = enclosures.alarms(&arena, node);
            let range = enclosures.enclose_tightly(&arena, node);
            for point in &points {
                match arena.evaluate(node, point) {
                    Ok(value) => {
                        prop_assert!(range.contains(value), "{value:e} at {point:?} beyond {range:?}");
                        prop_assert!(alarms.iter().all(|alarm| !alarm.is_certain), "{alarms:?} at {point:?}");
                    }
                    Err(kind) => {
                        let own = arena.operands(node).all(|operand| arena.evaluate(operand, point).is_ok());
                        prop_assert!(
                            !own || alarms.iter().any(|alarm| alarm.kind == kind),
                            "{kind:?} at {point:?}, not in {alarms:?}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn a_decision_holds_at_every_point_of_its_path(
        semantics in semantics(),
        ranges in prop::collection::vec(range(), 3),
        steps in steps(),
        shares in shares(),
        conditions in prop::collection::vec((0_usize..60, 0_usize..60, 0_usize..6), 3),
    ) {
        let (arena, nodes) = build(semantics, 3, &steps);
        let domain = Domain::new(ranges);
        let pick = |index: usize| nodes[index % nodes.len()];
        let mut enclosures = Enclosures::new(domain.clone());
        let mut points = points(&domain, &shares);
        for &(left, right, relation) in &conditions {
            let condition = Condition::new(RELATIONS[relation], pick(left), pick(right));
            let decided = enclosures.decide(&arena, condition);
            for point in &points {
                if let (Some(decided), Ok(holds)) = (decided, arena.holds(condition, point)) {
                    prop_assert_eq!(decided, holds, "{:?} at {:?}", condition, point);
                }
            }
            points.retain(|point| arena.holds(condition, point) == Ok(true));
            let is_possible = enclosures.assume(&arena, condition);
            prop_assert!(is_possible || points.is_empty(), "{condition:?} at {points:?}");
        }
        let contracted = enclosures.contracted_domain(&arena);
        prop_assert!(points.is_empty() || contracted.is_some());
        for (point, domain) in points.iter().flat_map(|point| contracted.iter().map(move |domain| (point, domain))) {
            let mut sides = domain.ranges().iter().zip(point);
            prop_assert!(sides.all(|(range, value)| range.contains(*value)), "{point:?} beyond {domain:?}");
        }
        for &node in &nodes {
            let range = enclosures.enclose_tightly(&arena, node);
            for point in &points {
                if let Ok(value) = arena.evaluate(node, point) {
                    prop_assert!(range.contains(value), "{value:e} at {point:?} beyond {range:?}");
                }
            }
        }
    }
}

/// Operations about which the proofs by structure know something.
fn build_plain(steps: &[(usize, usize, usize)]) -> (Arena, Vec<NodeId>) {
    let mut arena = Arena::default();
    let mut nodes: Vec<_> = (0..3).map(|input| arena.input(input)).collect();
    nodes.extend([Arena::ZERO, Arena::ONE, Arena::MINUS_ONE]);
    let two = arena.constant(2.0);
    for &(operation, a, b) in steps {
        let (a, b) = (nodes[a % nodes.len()], nodes[b % nodes.len()]);
        let functions = [Unary::Neg, Unary::Abs, Unary::Sqrt, Unary::Fix, Unary::Fup, Unary::Round];
        let node = match operation {
            0..=5 => arena.unary(functions[operation], a),
            6 => arena.binary(Binary::Mul, a, a),
            7 => {
                let magnitude = arena.unary(Unary::Abs, a);
                let sum = arena.binary(Binary::Add, a, magnitude);
                arena.binary(Binary::Div, sum, two)
            }
            _ => arena.binary([Binary::Add, Binary::Sub, Binary::Mul, Binary::Div][operation % 4], a, b),
        };
        nodes.push(node);
    }
    (arena, nodes)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12 * ProptestConfig::default().cases, ..ProptestConfig::default() })]

    #[test]
    fn a_proof_by_structure_holds_at_every_point(
        steps in prop::collection::vec((0_usize..16, 0_usize..60, 0_usize..60), 2..9),
        places in prop::collection::vec(prop::collection::vec((-6_i32..7, -1_i32..2), 3), 24),
        conditions in prop::collection::vec((0_usize..60, 0_usize..60), 1..4),
        is_positive in any::<[bool; 3]>(),
    ) {
        let (arena, nodes) = build_plain(&steps);
        let ranges = is_positive.map(|positive| Interval::new(if positive { 0.0 } else { -3.1 }, 3.1));
        // Halves and the doubles beside them: equal values, and ones that differ by a rounding.
        let mut points: Vec<Vec<f64>> = places.iter().map(|place| {
            let value = |(range, &(halves, beside)): (&Interval, &(i32, i32))| {
                let value = f64::from(halves) / 2.0;
                let value = match beside { 0 => value, 1 => value.next_up(), _ => value.next_down() };
                value.clamp(range.lo(), range.hi())
            };
            ranges.iter().zip(place).map(value).collect()
        }).collect();
        let mut enclosures = Enclosures::with_degree(Domain::new(ranges.to_vec()), 0);
        for &(left, right) in &conditions {
            let (left, right) = (nodes[left % nodes.len()], nodes[right % nodes.len()]);
            // A condition that the first point keeps.
            let Some(relation) = RELATIONS.into_iter().rev().find(|relation| {
                arena.holds(Condition::new(*relation, left, right), &points[0]) == Ok(true)
            }) else { continue };
            let condition = Condition::new(relation, left, right);
            points.retain(|point| arena.holds(condition, point) == Ok(true));
            prop_assert!(enclosures.assume(&arena, condition));
        }
        for &left in &nodes {
            for &right in &nodes {
                for relation in [Relation::Ge, Relation::Gt, Relation::Eq] {
                    let condition = Condition::new(relation, left, right);
                    let Some(decided) = enclosures.decide(&arena, condition) else { continue };
                    for point in &points {
                        let holds = arena.holds(condition, point);
                        prop_assert!(holds.is_err() || holds == Ok(decided), "{condition:?} at {point:?}");
                    }
                }
            }
        }
    }
}
