//! Rounding errors against exact rationals.
use num_rational::BigRational;
use proptest::prelude::*;

use crate::*;

/// Returns the exact value of a node of + − × ÷ at a point; `None` for a division by 0.
fn exact(arena: &Arena, node: NodeId, point: &[f64]) -> Option<BigRational> {
    match arena.node(node) {
        Node::Constant(value) => BigRational::from_float(value),
        Node::Input(input) => BigRational::from_float(point[input]),
        Node::Unary(Unary::Neg, x) => Some(-exact(arena, x, point)?),
        Node::Unary(..) => None,
        Node::Binary(operator, a, b) => {
            let (a, b) = (exact(arena, a, point)?, exact(arena, b, point)?);
            match operator {
                Binary::Add => Some(a + b),
                Binary::Sub => Some(a - b),
                Binary::Mul => Some(a * b),
                Binary::Div if b == BigRational::from_integer(0.into()) => None,
                Binary::Div => Some(a / b),
                _ => None,
            }
        }
    }
}

proptest! {
    #[test]
    fn a_computed_value_is_off_the_exact_one_by_its_rounding_error(
        centres in prop::collection::vec(-9.0..9.0, 3),
        width in prop::sample::select(&[0.0, 1e-9, 0.01, 0.7][..]),
        steps in prop::collection::vec((0_usize..4, 0_usize..40, 0_usize..40), 1..9),
        shares in prop::collection::vec(0.0..1.0, 3),
    ) {
        let mut arena = Arena::default();
        let mut nodes: Vec<_> = (0..3).map(|input| arena.input(input)).collect();
        nodes.push(arena.constant(0.1));
        for (operation, a, b) in steps {
            let operator = [Binary::Add, Binary::Sub, Binary::Mul, Binary::Div][operation];
            let (a, b) = (nodes[a % nodes.len()], nodes[nodes.len() - 1 - b % nodes.len()]);
            nodes.push(arena.binary(operator, a, b));
        }
        let ranges = centres.iter().map(|centre| Interval::new(centre - width, centre + width)).collect();
        let mut enclosures = Enclosures::new(Domain::new(ranges));
        let point: Vec<f64> = centres.iter().zip(&shares)
            .map(|(centre, share): (&f64, &f64)| (centre + (2.0 * share - 1.0) * width).clamp(centre - width, centre + width))
            .collect();
        for node in nodes {
            let error = enclosures.rounding_error(&arena, node);
            let (Some(error), Ok(value)) = (error, arena.evaluate(node, &point)) else { continue };
            let Some(real) = exact(&arena, node, &point) else { continue };
            let distance = BigRational::from_float(value).unwrap() - real;
            let error = BigRational::from_float(error).unwrap();
            prop_assert!(distance <= error && -distance <= error, "{node:?} at {point:?}");
        }
    }
}

#[test]
fn rounding_errors_have_the_size_of_the_roundings() {
    let mut arena = Arena::default();
    let x = arena.input(0);
    let third = arena.constant(3.0);
    let quotient = arena.binary(Binary::Div, x, third);
    let product = arena.binary(Binary::Mul, quotient, third);
    let mut enclosures = Enclosures::new(Domain::new(vec![Interval::new(2.0, 3.0)]));
    // x/3 ≤ 1 is off by 2^−53 at most, 3 times that by 3·2^−53 and a rounding of 3·2^−53.
    let error = enclosures.rounding_error(&arena, product).unwrap();
    assert!((5e-16..7e-16).contains(&error), "{error:e}");
    assert_eq!(enclosures.rounding_error(&arena, x), Some(0.0));
    // The real cosine of 90° is 0, the computed one 6e-17.
    let cosine = arena.unary(Unary::Cos, x);
    let mut right_angle = Enclosures::new(Domain::new(vec![Interval::point(90.0)]));
    let error = right_angle.rounding_error(&arena, cosine).unwrap();
    assert!((6.1e-17..2e-15).contains(&error), "{error:e}");
}
