//! Properties of numbers: expressions compared with a second way of computing them, words with their digits.
use gcode_tests::expect;
use proptest::prelude::*;
use proptest::sample::select;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;

/// What a program of one assignment gives: #100, 0 where it is vacant, or the alarm's code.
fn value(expression: &str) -> Result<f64, String> {
    let program = format!("O1\n#1=2.5\n#2=-7\n#3=0\n#5=1000.125\n#100={expression}\nM30\n");
    let ran = expect::run(program.as_bytes());
    match ran.outcome {
        gcode_control::Outcome::Alarm(stopped) => Err(stopped.alarm.code().to_string()),
        _ => Ok(ran.control.variables().find(|(n, _)| *n == 100).map_or(0.0, |(_, v)| v)),
    }
}

/// A piece of an expression with its value, worked out while it is written down. `None` where it alarms.
#[derive(Clone, Debug)]
struct ExpressionSample {
    text: String,
    value: Option<f64>,
}

impl ExpressionSample {
    fn map(&self, text: String, value: impl Fn(f64) -> Option<f64>) -> Self {
        Self { text, value: self.value.and_then(value) }
    }
}

fn single() -> impl Strategy<Value = ExpressionSample> {
    let variables = [
        ("#1", 2.5),
        ("#2", -7.0),
        ("#3", 0.0),
        ("#4", 0.0),
        ("#0", 0.0),
        ("#5", 1000.125),
        ("#[3-1]", -7.0),
    ];
    let piece = |(text, value): (&str, f64)| ExpressionSample { text: text.to_owned(), value: Some(value) };
    prop_oneof![
        select(variables.to_vec()).prop_map(piece),
        (0..2000u32).prop_map(|n| ExpressionSample { text: n.to_string(), value: Some(f64::from(n)) }),
        (0..99_999u32, 1..4u32).prop_map(|(n, places)| {
            let scale = 10_u32.pow(places);
            let text = format!("{}.{:0width$}", n / scale, n % scale, width = places as usize);
            ExpressionSample { value: Some(text.parse().unwrap()), text }
        }),
    ]
}

/// 32 bits, signed or not.
fn bits(value: f64) -> Option<i32> {
    let value = value.round();
    if (0.0..=f64::from(u32::MAX)).contains(&value) {
        return Some((value as u32).cast_signed());
    }
    (value >= f64::from(i32::MIN) && value < 0.0).then_some(value as i32)
}

fn apply(op: &str, left: f64, right: f64) -> Option<f64> {
    let value = match op {
        "+" => left + right,
        "-" => left - right,
        "*" => left * right,
        "/" => return (right != 0.0).then_some(left / right),
        "MOD" => return (right.round() != 0.0).then_some(left.round() % right.round()),
        "AND" => f64::from(bits(left)? & bits(right)?),
        "OR" => f64::from(bits(left)? | bits(right)?),
        _ => f64::from(bits(left)? ^ bits(right)?),
    };
    Some(value)
}

/// Two passes over a row of values and operators: first the operators that bind, then the others, both from the left.
fn folded(values: Vec<ExpressionSample>, ops: &[&str]) -> ExpressionSample {
    let mut text = values[0].text.clone();
    for (op, piece) in ops.iter().zip(&values[1..]) {
        text.push_str(&format!(" {op} {}", piece.text));
    }
    let mut values: Vec<Option<f64>> = values.into_iter().map(|piece| piece.value).collect();
    let mut ops = ops.to_vec();
    for level in [&["*", "/", "MOD", "AND"], &["+", "-", "OR", "XOR"]] {
        let mut at = 0;
        while at < ops.len() {
            if level.contains(&ops[at]) {
                let right = values.remove(at + 1);
                values[at] = values[at].zip(right).and_then(|(left, right)| apply(ops[at], left, right));
                ops.remove(at);
            } else {
                at += 1;
            }
        }
    }
    ExpressionSample { text, value: values[0] }
}

fn expression() -> impl Strategy<Value = ExpressionSample> {
    single().prop_recursive(3, 24, 4, |inner| {
        let part = prop_oneof![
            3 => single(),
            1 => inner.clone().prop_map(|p| p.map(format!("[{}]", p.text), Some)),
            1 => single().prop_map(|p| p.map(format!("-{}", p.text), |v| Some(-v))),
            1 => inner.clone().prop_map(|p| p.map(format!("ABS[{}]", p.text), |v| Some(v.abs()))),
            1 => inner.clone().prop_map(|p| p.map(format!("FIX[{}]", p.text), |v| Some(v.trunc()))),
            1 => inner.clone().prop_map(|p| p.map(format!("FU[{}]", p.text), |v| {
                Some(if v < 0.0 { v.floor() } else { v.ceil() })
            })),
            1 => inner.clone().prop_map(|p| p.map(format!("ROUND[{}]", p.text), |v| Some(v.round()))),
            1 => inner.prop_map(|p| p.map(format!("SQ[{}]", p.text), |v| (v >= 0.0).then(|| v.sqrt()))),
        ];
        let op = select(&["+", "-", "*", "/", "MOD", "AND", "OR", "XOR"][..]);
        (1..5usize)
            .prop_flat_map(move |count| {
                let values = prop::collection::vec(part.clone(), count);
                (values, prop::collection::vec(op.clone(), count - 1))
            })
            .prop_map(|(values, ops)| folded(values, &ops))
    })
}

/// An exact number of thousandths, written with a point and a variable number of places.
fn decimal(digits: i64, places: u32) -> String {
    let scale = 10_i64.pow(places);
    let sign = if digits < 0 { "-" } else { "" };
    let digits = digits.abs();
    format!("{sign}{}.{:0width$}", digits / scale, digits % scale, width = places as usize)
}

fn x(program: &str) -> f64 {
    let ran = expect::run(format!("O1\n{program}\nM30\n").as_bytes());
    let axis = ran.control.settings().axes.find(b'X').unwrap();
    ran.control.work_position(axis)
}

/// Whether an expression has an operator or a function that can raise an alarm.
fn may_alarm(text: &str, code: &str) -> bool {
    let has = |causes: &[&str]| causes.iter().any(|cause| text.contains(cause));
    match code {
        "PS0110" => has(&["AND", "OR"]),
        "PS0112" => has(&["/", "MOD"]),
        "PS0119" => has(&["SQ"]),
        _ => false,
    }
}

#[test]
fn most_expressions_have_a_value() {
    let mut runner = TestRunner::deterministic();
    let drawn = (0..1000).map(|_| expression().new_tree(&mut runner).unwrap().current());
    let valued = drawn.filter(|piece| piece.value.is_some()).count();
    assert!(valued > 700, "{valued} of 1000");
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(2000) })]

    #[test]
    fn an_expression_has_the_value_of_two_passes(piece in expression()) {
        prop_assume!(piece.text.matches('[').count() <= 5);
        match (value(&piece.text), piece.value) {
            (Ok(found), Some(wanted)) => prop_assert_eq!(found, wanted, "{}", piece.text),
            (Err(code), None) => prop_assert!(may_alarm(&piece.text, &code), "{} {}", code, piece.text),
            (found, wanted) => prop_assert!(false, "{} is {:?}, {:?} is wanted", piece.text, found, wanted),
        }
    }

    #[test]
    fn literals_are_cut_to_the_increment(digits in -99_999_999..99_999_999_i64, places in 1..7_u32) {
        let text = decimal(digits, places);
        let thousandths = if places > 3 { digits / 10_i64.pow(places - 3) } else { digits * 10_i64.pow(3 - places) };
        prop_assume!(thousandths.abs() <= 999_999_999);
        prop_assert_eq!(x(&format!("G0 X{text}")), thousandths as f64 / 1000.0, "{}", text);
    }

    #[test]
    fn values_are_rounded_to_the_increment(digits in -999_999_999..999_999_999_i64, places in 4..7_u32) {
        let text = decimal(digits, places);
        let unit = 10_i64.pow(places - 3);
        let away = (digits.abs() + unit / 2) / unit * digits.signum();
        prop_assert_eq!(x(&format!("#1={text}\nG0 X#1")), away as f64 / 1000.0, "{}", text);
        prop_assert_eq!(x(&format!("G0 X[{text}]")), away as f64 / 1000.0, "{}", text);
        prop_assert_eq!(x(&format!("#1={text}\nG0 X-#1")), -away as f64 / 1000.0 + 0.0, "{}", text);
    }

    #[test]
    fn halves_of_an_increment_go_away_from_zero(thousandths in -999_999..999_999_i64) {
        let text = decimal(thousandths * 10 + 5 * if thousandths < 0 { -1 } else { 1 }, 4);
        let away = thousandths + if thousandths < 0 { -1 } else { 1 };
        prop_assert_eq!(x(&format!("#1={text}\nG0 X#1")), away as f64 / 1000.0, "{}", text);
        prop_assert_eq!(x(&format!("#1={text}\nG0 X[ROUND[#1]]")), away as f64 / 1000.0, "{}", text);
    }
}
