//! Rounding errors against exact rationals.
use num_rational::BigRational;
use proptest::prelude::*;

use crate::real_values::RealValues;
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
            let (Some(error), Ok(value)) = (error_of(&mut enclosures, &arena, node), arena.evaluate(node, &point)) else { continue };
            let Some(real) = exact(&arena, node, &point) else { continue };
            let distance = BigRational::from_float(value).unwrap() - real;
            let error = BigRational::from_float(error).unwrap();
            prop_assert!(distance <= error && -distance <= error, "{node:?} at {point:?}");
        }
    }
}

/// Returns the bound of the rounding errors of a node that has a real value by its operands.
fn error_of(enclosures: &mut Enclosures, arena: &Arena, node: NodeId) -> Option<f64> {
    enclosures.enclose(arena, node);
    let reals = RealValues::of(arena, &[node], &|node| enclosures.hull(node))?;
    let is_real = arena.cone(&[node]).into_iter().all(|part| !reals.is_computed(part));
    is_real.then(|| reals.error(node))
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
    let error = error_of(&mut enclosures, &arena, product).unwrap();
    assert!((5e-16..7e-16).contains(&error), "{error:e}");
    assert_eq!(error_of(&mut enclosures, &arena, x), Some(0.0));
}

#[test]
fn the_root_of_a_sum_of_squares_is_off_by_a_part_of_it() {
    let mut arena = Arena::default();
    let (x, y) = (arena.input(0), arena.input(1));
    let (xx, yy) = (arena.binary(Binary::Mul, x, x), arena.binary(Binary::Mul, y, y));
    let sum = arena.binary(Binary::Add, xx, yy);
    let root = arena.unary(Unary::Sqrt, sum);
    let mut enclosures =
        Enclosures::new(Domain::new(vec![Interval::new(-3.0, 3.0), Interval::new(-4.0, 4.0)]));
    // The sum is off by 2 units of 2^−53, the root of 5 at most by half of that and one more; 0 is inside the box.
    let error = error_of(&mut enclosures, &arena, root).unwrap();
    assert!((1.1e-15..1.2e-15).contains(&error), "{error:e}");
    // A root whose argument may be below 0 is taken as computed.
    let difference = arena.binary(Binary::Sub, xx, yy);
    let root = arena.unary(Unary::Sqrt, difference);
    assert_eq!(error_of(&mut enclosures, &arena, root), None);
}
