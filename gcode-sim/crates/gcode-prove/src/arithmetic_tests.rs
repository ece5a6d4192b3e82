//! Values of nodes are those of the control's arithmetic, bit for bit.
use gcode_control::static_eval::{atan2, binary, function, power};
use gcode_enclosure::{Arena, Binary, NodeId, Unary};
use gcode_lang::control::Settings;
use gcode_lang::syntax::ast::{BinaryOp, Function};
use proptest::prelude::*;

use crate::nodes::semantics;

/// Numbers at which functions turn, end or lose digits.
const SPECIAL: [f64; 40] = [
    0.0,
    -0.0,
    0.5,
    -0.5,
    1.0,
    -1.0,
    1.5,
    2.5,
    -2.5,
    0.49999999999999994,
    0.9999999999999999,
    1.0000000000000002,
    1e-8,
    -1e-8,
    9.999e-9,
    -9.999e-9,
    5e-324,
    -5e-324,
    2.2250738585072014e-308,
    f64::MAX,
    f64::MIN,
    90.0,
    -90.0,
    180.0,
    270.0,
    360.0,
    450.0,
    89.99999999999999,
    30.0,
    45.0,
    60.0,
    709.782712893384,
    710.0,
    4294967295.0,
    2147483648.0,
    -2147483648.0,
    -2147483649.0,
    99999999.0,
    99999999.5,
    305419896.0,
];

/// Returns the settings with these choices, as bits.
fn settings(choices: u8) -> Settings {
    let (returns_signed_angles, zeroes_residues) = (choices & 1 != 0, choices & 2 != 0);
    let mut settings = Settings { returns_signed_angles, zeroes_residues, ..Settings::default() };
    settings.undocumented.tan_90_alarms = choices & 4 != 0;
    settings.undocumented.atan_of_zeros_alarms = choices & 8 != 0;
    settings.undocumented.negative_bits_alarm = choices & 16 != 0;
    settings
}

/// Returns the value of a node at two inputs; an alarm is `None`.
fn value(
    settings: &Settings,
    [x, y]: [f64; 2],
    node: impl Fn(&mut Arena, NodeId, NodeId) -> NodeId,
) -> Option<u64> {
    let mut arena = Arena::new(semantics(settings));
    let (a, b) = (arena.input(0), arena.input(1));
    let node = node(&mut arena, a, b);
    arena.evaluate(node, &[x, y]).ok().map(f64::to_bits)
}

fn compare(choices: u8, x: f64, y: f64) {
    let settings = &settings(choices);
    let functions = [
        (Function::Sin, Unary::Sin),
        (Function::Cos, Unary::Cos),
        (Function::Tan, Unary::Tan),
        (Function::Asin, Unary::Asin),
        (Function::Acos, Unary::Acos),
        (Function::Atan, Unary::Atan),
        (Function::Sqrt, Unary::Sqrt),
        (Function::Abs, Unary::Abs),
        (Function::Round, Unary::Round),
        (Function::Fix, Unary::Fix),
        (Function::Fup, Unary::Fup),
        (Function::Ln, Unary::Ln),
        (Function::Exp, Unary::Exp),
        (Function::Bin, Unary::Bin),
        (Function::Bcd, Unary::Bcd),
    ];
    for (name, unary) in functions {
        let expected = function(name, x, settings).ok().map(f64::to_bits);
        let found = value(settings, [x, y], |arena, a, _| arena.unary(unary, a));
        assert_eq!(found, expected, "{name:?} of {x:e}, settings {choices:05b}");
    }
    let operators = [
        (BinaryOp::Add, Binary::Add),
        (BinaryOp::Sub, Binary::Sub),
        (BinaryOp::Mul, Binary::Mul),
        (BinaryOp::Div, Binary::Div),
        (BinaryOp::Mod, Binary::Mod),
        (BinaryOp::And, Binary::And),
        (BinaryOp::Or, Binary::Or),
        (BinaryOp::Xor, Binary::Xor),
    ];
    let undocumented = &settings.undocumented;
    let operators = operators.map(|(op, node)| (format!("{op:?}"), node, binary(op, x, y, undocumented)));
    let of_two = [
        ("ATAN".to_owned(), Binary::Atan, atan2(x, y, settings)),
        ("POW".to_owned(), Binary::Pow, power(x, y)),
    ];
    for (name, operator, expected) in operators.into_iter().chain(of_two) {
        let expected = expected.ok().map(f64::to_bits);
        let found = value(settings, [x, y], |arena, a, b| arena.binary(operator, a, b));
        assert_eq!(found, expected, "{name} of {x:e} and {y:e}, settings {choices:05b}");
    }
}

#[test]
fn special_numbers_have_the_values_of_the_control() {
    for choices in 0..32 {
        for x in SPECIAL {
            for y in SPECIAL {
                compare(choices, x, y);
            }
        }
    }
}

proptest! {
    #[test]
    fn any_numbers_have_the_values_of_the_control(
        choices in 0_u8..32,
        x in prop_oneof![any::<f64>(), -1000.0..1000.0, -1.0..1.0, (-5_000_000_000_i64..5_000_000_000).prop_map(|n| n as f64 / 2.0)],
        y in prop_oneof![any::<f64>(), -1000.0..1000.0, -1.0..1.0, (-5_000_000_000_i64..5_000_000_000).prop_map(|n| n as f64 / 2.0)],
    ) {
        prop_assume!(x.is_finite() && y.is_finite());
        compare(choices, x, y);
    }
}
