//! Forms against formulas that are equal in real numbers, and against near ones that aren't.
use gcode_enclosure::{Arena, Binary, Domain, Enclosures, Interval, NodeId, Unary};
use proptest::prelude::*;

use super::*;

/// Nodes of #1 = a, #2 = b, #3 = r.
struct Ellipse {
    arena: Arena,
    a: NodeId,
    b: NodeId,
    r: NodeId,
}

impl Ellipse {
    fn new() -> Self {
        let mut arena = Arena::default();
        let [a, b, r] = [0, 1, 2].map(|input| arena.input(input));
        Self { arena, a, b, r }
    }

    /// b·√((a − r)·(a + r))/a.
    fn height(&mut self) -> NodeId {
        let arena = &mut self.arena;
        let (near, far) =
            (arena.binary(Binary::Sub, self.a, self.r), arena.binary(Binary::Add, self.a, self.r));
        let product = arena.binary(Binary::Mul, near, far);
        let root = arena.unary(Unary::Sqrt, product);
        let scaled = arena.binary(Binary::Mul, self.b, root);
        arena.binary(Binary::Div, scaled, self.a)
    }

    /// b·√(1 − r·r/a/a).
    fn other_height(&mut self) -> NodeId {
        let arena = &mut self.arena;
        let square = arena.binary(Binary::Mul, self.r, self.r);
        let once = arena.binary(Binary::Div, square, self.a);
        let twice = arena.binary(Binary::Div, once, self.a);
        let rest = arena.binary(Binary::Sub, Arena::ONE, twice);
        let root = arena.unary(Unary::Sqrt, rest);
        arena.binary(Binary::Mul, self.b, root)
    }
}

fn domain(r: Interval) -> Domain {
    Domain::new(vec![Interval::new(500.0, 2000.0), Interval::new(300.0, 1200.0), r])
}

/// Returns r²/a² + y²/b² − 1 of a height's real number.
fn surface(forms: &mut ExactForms<'_>, ellipse: &(NodeId, NodeId, NodeId), y: NodeId) -> (Polynomial, f64) {
    let [a, b, r] = [ellipse.0, ellipse.1, ellipse.2].map(|node| Polynomial::atom(Atom::Node(node)));
    let (a, b) = (forms.inverse(&a).unwrap(), forms.inverse(&b).unwrap());
    let y = forms.form(y).real;
    forms.combine(&[(1.0, &[&r, &r, &a, &a]), (1.0, &[&y, &y, &b, &b]), (-1.0, &[])]).unwrap()
}

#[test]
fn both_heights_lie_on_the_surface_and_a_near_one_does_not() {
    let mut ellipse = Ellipse::new();
    let (y, other) = (ellipse.height(), ellipse.other_height());
    let scale = ellipse.arena.constant(1.0 + 1e-12);
    let near = ellipse.arena.binary(Binary::Mul, y, scale);
    let mut enclosures = Enclosures::with_degree(domain(Interval::new(0.0, 450.0)), 0);
    let inputs = (ellipse.a, ellipse.b, ellipse.r);
    let mut forms = ExactForms::new(&ellipse.arena, &mut enclosures);
    assert_eq!(surface(&mut forms, &inputs, y), (Polynomial::default(), 0.0));
    assert_eq!(surface(&mut forms, &inputs, other), (Polynomial::default(), 0.0));
    // (1 + 10⁻¹²)² − 1 = 2·10⁻¹² of y²/b² = 1 − r²/a²; the magnitudes of both terms are at most 1 and 0.81. The double next to
    // 1 + 10⁻¹² is off by up to 1.1·10⁻¹⁶.
    let (rest, _) = surface(&mut forms, &inputs, near);
    let magnitude = forms.magnitude(&rest);
    assert!((magnitude - 3.62e-12).abs() < 1e-15, "{magnitude} of {rest:?}");
}

#[test]
fn a_height_keeps_its_relative_error_up_to_the_equator() {
    let mut ellipse = Ellipse::new();
    let (y, other) = (ellipse.height(), ellipse.other_height());
    let mut enclosures = Enclosures::with_degree(domain(Interval::new(0.0, 2000.0)), 0);
    let less = gcode_enclosure::Condition::new(gcode_enclosure::Relation::Le, ellipse.r, ellipse.a);
    assert!(enclosures.assume(&ellipse.arena, less));
    let mut forms = ExactForms::new(&ellipse.arena, &mut enclosures);
    let form = forms.form(y);
    // Four roundings, half of three and one of the root, and two more.
    assert!(form.absolute == 0.0 && form.relative < 5.0 * f64::EPSILON, "{form:?}");
    // 1 − r²/a² cancels near r = a: without a bound of its sign the root is an atom.
    let form = forms.form(other);
    assert!(form.real.as_node().is_none() && format!("{:?}", form.real).contains("Node"), "{form:?}");
}

#[test]
fn a_rounded_word_is_off_by_half_an_increment() {
    let mut arena = Arena::default();
    let (x, thousand) = (arena.input(0), arena.constant(1000.0));
    let whole = arena.round_scaled(x, 1000.0);
    let word = arena.binary(Binary::Div, whole, thousand);
    let mut enclosures = Enclosures::with_degree(Domain::new(vec![Interval::new(-360.0, 360.0)]), 0);
    let mut forms = ExactForms::new(&arena, &mut enclosures);
    assert_eq!(forms.form(word).real.as_node(), Some(x));
    let error = forms.error(word);
    assert!((0.0005..0.000_500_001).contains(&error), "{error}");
}

/// [x + y + ABS[x − y]]/2 is the larger of both.
#[test]
fn the_larger_of_two_is_not_below_either() {
    let mut arena = Arena::default();
    let (x, y, two) = (arena.input(0), arena.input(1), arena.constant(2.0));
    let difference = arena.binary(Binary::Sub, x, y);
    let magnitude = arena.unary(Unary::Abs, difference);
    let sum = arena.binary(Binary::Add, x, y);
    let sum = arena.binary(Binary::Add, sum, magnitude);
    let larger = arena.binary(Binary::Div, sum, two);
    let ranges = vec![Interval::new(-5000.0, 5000.0), Interval::new(0.0, 900.0)];
    let mut enclosures = Enclosures::with_degree(Domain::new(ranges), 0);
    let mut forms = ExactForms::new(&arena, &mut enclosures);
    let real = forms.form(larger).real;
    for one in [x, y] {
        let one = forms.form(one).real;
        let (above, _) = forms.combine(&[(1.0, &[&real]), (-1.0, &[&one])]).unwrap();
        let least = forms.least(&above);
        assert!((-1e-9..=0.0).contains(&least), "{least}");
        let (below, _) = forms.combine(&[(-1.0, &[&real]), (1.0, &[&one])]).unwrap();
        assert!(forms.least(&below) < -1000.0, "it is above the smaller one");
    }
}

proptest! {
    /// Two formulas for one height differ by their error bounds at most.
    #[test]
    fn errors_are_within_their_bounds(
        (a, b, r) in (500.0..2000.0f64, 300.0..1200.0f64, 0.0..450.0f64),
        width in 0.0..1e-3f64,
    ) {
        let mut ellipse = Ellipse::new();
        let (y, other) = (ellipse.height(), ellipse.other_height());
        let values = [y, other].map(|node| ellipse.arena.evaluate(node, &[a, b, r]).unwrap());
        let around = |value: f64| Interval::new(value * (1.0 - width), value * (1.0 + width));
        let mut enclosures = Enclosures::with_degree(Domain::new([a, b, r].map(around).to_vec()), 0);
        let mut forms = ExactForms::new(&ellipse.arena, &mut enclosures);
        let bound = forms.error(y) + forms.error(other);
        prop_assert!((values[0] - values[1]).abs() <= bound, "{values:?} {bound}");
        prop_assert!(bound < 1e-10, "{bound}");
    }
}
