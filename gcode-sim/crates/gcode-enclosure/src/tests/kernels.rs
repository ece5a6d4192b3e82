//! Published kernels (FPBench): bounds against the true ranges.
//!
//! The true range is found by a dense search in doubles, independent of the enclosures: a grid, then smaller grids around
//! its best points.
use crate::*;

/// Expressions over an arena, as programs write them.
struct Builder {
    arena: Arena,
}

impl Builder {
    fn new() -> Self {
        Self { arena: Arena::default() }
    }

    fn x(&mut self, input: usize) -> NodeId {
        self.arena.input(input)
    }

    fn c(&mut self, value: f64) -> NodeId {
        self.arena.constant(value)
    }

    fn add(&mut self, a: NodeId, b: NodeId) -> NodeId {
        self.arena.binary(Binary::Add, a, b)
    }

    fn sub(&mut self, a: NodeId, b: NodeId) -> NodeId {
        self.arena.binary(Binary::Sub, a, b)
    }

    fn mul(&mut self, a: NodeId, b: NodeId) -> NodeId {
        self.arena.binary(Binary::Mul, a, b)
    }

    fn div(&mut self, a: NodeId, b: NodeId) -> NodeId {
        self.arena.binary(Binary::Div, a, b)
    }

    fn of(&mut self, function: Unary, x: NodeId) -> NodeId {
        self.arena.unary(function, x)
    }

    /// Returns the product of numbers and nodes, from the left.
    fn product(&mut self, factors: &[NodeId]) -> NodeId {
        let mut product = factors[0];
        for factor in &factors[1..] {
            product = self.mul(product, *factor);
        }
        product
    }

    /// Returns the sum of nodes, from the left.
    fn sum(&mut self, terms: &[NodeId]) -> NodeId {
        let mut sum = terms[0];
        for term in &terms[1..] {
            sum = self.add(sum, *term);
        }
        sum
    }

    /// Returns a number × a product.
    fn term(&mut self, factor: f64, factors: &[NodeId]) -> NodeId {
        let factor = self.c(factor);
        let product = self.product(factors);
        self.mul(factor, product)
    }
}

/// Returns the least and the greatest value found by grids.
fn search(arena: &Arena, node: NodeId, ranges: &[(f64, f64)]) -> (f64, f64) {
    let steps = match ranges.len() {
        1 => 2001,
        2 => 81,
        3 => 25,
        4 => 11,
        5 => 7,
        _ => 5,
    };
    let extreme = |sign: f64| {
        let mut centre: Vec<f64> = ranges.iter().map(|(lo, hi)| (lo + hi) / 2.0).collect();
        let mut share = 0.5;
        let mut best = f64::NEG_INFINITY;
        for _ in 0..24 {
            let around = centre.clone();
            let mut indices = vec![0; ranges.len()];
            'grid: loop {
                let point: Vec<f64> = indices
                    .iter()
                    .zip(ranges)
                    .zip(&around)
                    .map(|((index, (lo, hi)), middle)| {
                        let offset =
                            (f64::from(*index) / f64::from(steps - 1) * 2.0 - 1.0) * share * (hi - lo);
                        (middle + offset).clamp(*lo, *hi)
                    })
                    .collect();
                if let Ok(value) = arena.evaluate(node, &point)
                    && value * sign > best
                {
                    best = value * sign;
                    centre = point;
                }
                for index in &mut indices {
                    *index += 1;
                    if *index < steps {
                        continue 'grid;
                    }
                    *index = 0;
                }
                break;
            }
            share *= 0.5;
        }
        best * sign
    };
    (extreme(-1.0), extreme(1.0))
}

/// Fails unless the bounds hold the values found and are within `factor` of their width.
fn check(name: &str, arena: &Arena, node: NodeId, ranges: &[(f64, f64)], factor: f64) -> Bounds {
    let domain = Domain::new(ranges.iter().map(|&(lo, hi)| Interval::new(lo, hi)).collect());
    let limits = BoundsSearch {
        tolerance: 0.0,
        relative_tolerance: (factor - 1.0) / 2.5,
        max_boxes: 100_000,
        threads: 2,
        is_over: &|| false,
    };
    let bounds = bounds(arena, node, &domain, &limits);
    let (mut least, mut greatest) = search(arena, node, ranges);
    for (value, point) in [&bounds.least, &bounds.greatest].into_iter().flatten() {
        assert_eq!(arena.evaluate(node, point), Ok(*value), "{name} at {point:?}");
        (least, greatest) = (least.min(*value), greatest.max(*value));
    }
    let range = bounds.range;
    println!("{name}: [{least}, {greatest}] in {range:?}, {} boxes", bounds.boxes);
    assert!(range.contains(least) && range.contains(greatest), "{name}: {least} {greatest} beyond {range:?}");
    assert!(bounds.is_complete, "{name}");
    assert!(range.width() <= factor * (greatest - least), "{name}: {range:?} for {least} {greatest}");
    bounds
}

const KERNEL: f64 = 1.05;

fn doppler(b: &mut Builder) -> NodeId {
    let (u, v, t) = (b.x(0), b.x(1), b.x(2));
    let (base, slope) = (b.c(331.4), b.c(0.6));
    let slope = b.mul(slope, t);
    let t1 = b.add(base, slope);
    let minus = b.of(Unary::Neg, t1);
    let above = b.mul(minus, v);
    let below = b.add(t1, u);
    let below = b.mul(below, below);
    b.div(above, below)
}

#[test]
fn doppler_kernels() {
    let mut b = Builder::new();
    let node = doppler(&mut b);
    check("doppler1", &b.arena, node, &[(-100.0, 100.0), (20.0, 20_000.0), (-30.0, 50.0)], KERNEL);
    check("doppler2", &b.arena, node, &[(-125.0, 125.0), (15.0, 25_000.0), (-40.0, 60.0)], KERNEL);
    check("doppler3", &b.arena, node, &[(-30.0, 120.0), (320.0, 20_300.0), (-50.0, 30.0)], KERNEL);
}

#[test]
fn rigid_body_kernels() {
    let mut b = Builder::new();
    let (x, y, z) = (b.x(0), b.x(1), b.x(2));
    let terms = [b.term(-1.0, &[x, y]), b.term(-2.0, &[y, z]), b.of(Unary::Neg, x), b.of(Unary::Neg, z)];
    let first = b.sum(&terms);
    let ranges = [(-15.0, 15.0); 3];
    check("rigidBody1", &b.arena, first, &ranges, KERNEL);
    // 2xyz + 3zz − yxyz + 3zz − y
    let terms = [
        b.term(2.0, &[x, y, z]),
        b.term(3.0, &[z, z]),
        b.term(-1.0, &[y, x, y, z]),
        b.term(3.0, &[z, z]),
        b.of(Unary::Neg, y),
    ];
    let second = b.sum(&terms);
    check("rigidBody2", &b.arena, second, &ranges, KERNEL);
}

#[test]
fn turbine_kernels() {
    let mut b = Builder::new();
    let (v, w, r) = (b.x(0), b.x(1), b.x(2));
    let ranges = [(-4.5, -0.3), (0.4, 0.9), (3.8, 7.8)];
    let (one, two, three) = (b.c(1.0), b.c(2.0), b.c(3.0));
    let rr = b.mul(r, r);
    let over = b.div(two, rr);
    let wwrr = b.product(&[w, w, r, r]);
    let rest = b.sub(one, v);
    // 3 + 2/(rr) − 0.125·(3 − 2v)·(wwrr)/(1 − v) − 4.5
    let (eighth, four_half) = (b.c(0.125), b.c(4.5));
    let double = b.mul(two, v);
    let left = b.sub(three, double);
    let part = b.product(&[eighth, left, wwrr]);
    let part = b.div(part, rest);
    let head = b.add(three, over);
    let head = b.sub(head, part);
    let first = b.sub(head, four_half);
    check("turbine1", &b.arena, first, &ranges, KERNEL);
    // 6v − 0.5·v·(wwrr)/(1 − v) − 2.5
    let six = b.term(6.0, &[v]);
    let part = b.term(0.5, &[v, wwrr]);
    let part = b.div(part, rest);
    let head = b.sub(six, part);
    let two_half = b.c(2.5);
    let second = b.sub(head, two_half);
    check("turbine2", &b.arena, second, &ranges, KERNEL);
    // 3 − 2/(rr) − 0.125·(1 + 2v)·(wwrr)/(1 − v) − 0.5
    let left = b.add(one, double);
    let part = b.product(&[eighth, left, wwrr]);
    let part = b.div(part, rest);
    let head = b.sub(three, over);
    let head = b.sub(head, part);
    let half = b.c(0.5);
    let third = b.sub(head, half);
    check("turbine3", &b.arena, third, &ranges, KERNEL);
}

#[test]
fn kernels_of_one_input() {
    let mut b = Builder::new();
    let x = b.x(0);
    let one = b.c(1.0);
    // verhulst: 4x / (1 + x/1.11)
    let k = b.c(1.11);
    let (above, part) = (b.term(4.0, &[x]), b.div(x, k));
    let below = b.add(one, part);
    let node = b.div(above, below);
    check("verhulst", &b.arena, node, &[(0.1, 0.3)], KERNEL);
    // predatorPrey: 4xx / (1 + (x/1.11)²)
    let (above, square) = (b.term(4.0, &[x, x]), b.mul(part, part));
    let below = b.add(one, square);
    let node = b.div(above, below);
    check("predatorPrey", &b.arena, node, &[(0.1, 0.3)], KERNEL);
    // carbonGas: (p + a·(n/v)²)·(v − n·b) − k·n·t
    let (p, n) = (b.c(3.5e7), b.c(1000.0));
    let ratio = b.div(n, x);
    let square = b.mul(ratio, ratio);
    let part = b.term(0.401, &[square]);
    let left = b.add(p, part);
    let volume = b.c(1000.0 * 42.7e-6);
    let right = b.sub(x, volume);
    let product = b.mul(left, right);
    let heat = b.c(1.380_650_3e-23 * 1000.0 * 300.0);
    let node = b.sub(product, heat);
    check("carbonGas", &b.arena, node, &[(0.1, 0.5)], KERNEL);
    const HALF_PI: f64 = std::f64::consts::FRAC_PI_2;
    // sine: x − xxx/6 + xxxxx/120 − xxxxxxx/5040
    let (c6, c120, c5040) = (b.c(6.0), b.c(120.0), b.c(5040.0));
    let (p3, p5, p7) = (b.product(&[x; 3]), b.product(&[x; 5]), b.product(&[x; 7]));
    let (t3, t5, t7) = (b.div(p3, c6), b.div(p5, c120), b.div(p7, c5040));
    let head = b.sub(x, t3);
    let head = b.add(head, t5);
    let node = b.sub(head, t7);
    check("sine", &b.arena, node, &[(-HALF_PI, HALF_PI)], KERNEL);
    // sqroot: 1 + 0.5x − 0.125xx + 0.0625xxx − 0.0390625xxxx
    let terms = [
        one,
        b.term(0.5, &[x]),
        b.term(-0.125, &[x; 2]),
        b.term(0.0625, &[x; 3]),
        b.term(-0.039_062_5, &[x; 4]),
    ];
    let node = b.sum(&terms);
    check("sqroot", &b.arena, node, &[(0.0, 1.0)], KERNEL);
    // sineOrder3: 0.954929658551372·x − 0.12900613773279798·xxx
    let (left, right) = (b.term(0.954_929_658_551_372, &[x]), b.term(0.129_006_137_732_797_98, &[x; 3]));
    let node = b.sub(left, right);
    check("sineOrder3", &b.arena, node, &[(-2.0, 2.0)], KERNEL);
}

#[test]
fn kernels_of_two_inputs() {
    let mut b = Builder::new();
    let (x, y) = (b.x(0), b.x(1));
    // himmilbeau: (xx + y − 11)² + (x + yy − 7)²
    let (xx, yy, c11, c7) = (b.mul(x, x), b.mul(y, y), b.c(11.0), b.c(7.0));
    let left = b.add(xx, y);
    let left = b.sub(left, c11);
    let right = b.add(x, yy);
    let right = b.sub(right, c7);
    let (left, right) = (b.mul(left, left), b.mul(right, right));
    let node = b.add(left, right);
    check("himmilbeau", &b.arena, node, &[(-5.0, 5.0); 2], KERNEL);
    // jetEngine
    let one = b.c(1.0);
    let d = b.add(xx, one);
    let three = b.term(3.0, &[xx]);
    let double = b.term(2.0, &[y]);
    let sum = b.add(three, double);
    let t = b.sub(sum, x);
    let t = b.div(t, d);
    let sum = b.sub(three, double);
    let t2 = b.sub(sum, x);
    let _ = b.div(t2, d);
    let (c3, c6) = (b.c(3.0), b.c(6.0));
    let minus = b.sub(t, c3);
    let first = b.product(&[x, t, minus]);
    let first = b.term(2.0, &[first]);
    let four = b.term(4.0, &[t]);
    let second = b.sub(four, c6);
    let second = b.product(&[x, x, second]);
    let inner = b.add(first, second);
    let inner = b.mul(inner, d);
    let third = b.term(3.0, &[xx, t]);
    let cube = b.product(&[x, x, x]);
    let last = b.term(3.0, &[t]);
    let terms = [inner, third, cube, x];
    let inner = b.sum(&terms);
    let head = b.add(x, inner);
    let node = b.add(head, last);
    check("jetEngine", &b.arena, node, &[(-5.0, 5.0), (-20.0, 5.0)], KERNEL);
}

#[test]
fn kepler_kernels() {
    let mut b = Builder::new();
    let x: Vec<_> = (0..6).map(|input| b.x(input)).collect();
    let ranges = [(4.0, 6.36); 6];
    let signed = |b: &mut Builder, signs: [f64; 6]| {
        let terms: Vec<_> = (0..6).filter(|i| signs[*i] != 0.0).map(|i| b.term(signs[i], &[x[i]])).collect();
        b.sum(&terms)
    };
    // x2x5 + x3x6 − x2x3 − x5x6 + x1(−x1 + x2 + x3 − x4 + x5 + x6)
    let inner = signed(&mut b, [-1.0, 1.0, 1.0, -1.0, 1.0, 1.0]);
    let terms = [
        b.mul(x[1], x[4]),
        b.mul(x[2], x[5]),
        b.term(-1.0, &[x[1], x[2]]),
        b.term(-1.0, &[x[4], x[5]]),
        b.mul(x[0], inner),
    ];
    let node = b.sum(&terms);
    check("kepler0", &b.arena, node, &ranges, KERNEL);
    // x1x4(−x1 + x2 + x3 − x4) + x2(x1 − x2 + x3 + x4) + x3(x1 + x2 − x3 + x4) − x2x3x4 − x1x3 − x1x2 − x4
    let (first, second, third) = (
        signed(&mut b, [-1.0, 1.0, 1.0, -1.0, 0.0, 0.0]),
        signed(&mut b, [1.0, -1.0, 1.0, 1.0, 0.0, 0.0]),
        signed(&mut b, [1.0, 1.0, -1.0, 1.0, 0.0, 0.0]),
    );
    let terms = [
        b.product(&[x[0], x[3], first]),
        b.mul(x[1], second),
        b.mul(x[2], third),
        b.term(-1.0, &[x[1], x[2], x[3]]),
        b.term(-1.0, &[x[0], x[2]]),
        b.term(-1.0, &[x[0], x[1]]),
        b.of(Unary::Neg, x[3]),
    ];
    let node = b.sum(&terms);
    check("kepler1", &b.arena, node, &ranges[..4], KERNEL);
    // x1x4(…) + x2x5(…) + x3x6(…) − x2x3x4 − x1x3x5 − x1x2x6 − x4x5x6
    let (first, second, third) = (
        signed(&mut b, [-1.0, 1.0, 1.0, -1.0, 1.0, 1.0]),
        signed(&mut b, [1.0, -1.0, 1.0, 1.0, -1.0, 1.0]),
        signed(&mut b, [1.0, 1.0, -1.0, 1.0, 1.0, -1.0]),
    );
    let terms = [
        b.product(&[x[0], x[3], first]),
        b.product(&[x[1], x[4], second]),
        b.product(&[x[2], x[5], third]),
        b.term(-1.0, &[x[1], x[2], x[3]]),
        b.term(-1.0, &[x[0], x[2], x[4]]),
        b.term(-1.0, &[x[0], x[1], x[5]]),
        b.term(-1.0, &[x[3], x[4], x[5]]),
    ];
    let node = b.sum(&terms);
    check("kepler2", &b.arena, node, &ranges, KERNEL);
}

/// The conversion of radians to degrees, for kernels whose angles are radians.
const DEGREES: f64 = 180.0 / std::f64::consts::PI;

#[test]
fn instantaneous_current() {
    let mut b = Builder::new();
    let (t, resistance, frequency, inductance, voltage) = (b.x(0), b.x(1), b.x(2), b.x(3), b.x(4));
    // impedance_re = r, impedance_im = 2π·f·l
    let tau = b.c(std::f64::consts::TAU);
    let omega = b.mul(tau, frequency);
    let reactance = b.mul(omega, inductance);
    let rr = b.mul(resistance, resistance);
    let xx = b.mul(reactance, reactance);
    let denominator = b.add(rr, xx);
    let above = b.mul(voltage, resistance);
    let real = b.div(above, denominator);
    let above = b.mul(voltage, reactance);
    let above = b.of(Unary::Neg, above);
    let imaginary = b.div(above, denominator);
    let (re2, im2) = (b.mul(real, real), b.mul(imaginary, imaginary));
    let square = b.add(re2, im2);
    let current = b.of(Unary::Sqrt, square);
    let ratio = b.div(imaginary, real);
    let phase = b.of(Unary::Atan, ratio);
    let to_degrees = b.c(DEGREES);
    let angle = b.mul(omega, t);
    let angle = b.mul(angle, to_degrees);
    let angle = b.add(angle, phase);
    let cosine = b.of(Unary::Cos, angle);
    let node = b.mul(current, cosine);
    let ranges = [(0.0, 300.0), (1.0, 50.0), (1.0, 100.0), (0.001, 0.004), (1.0, 12.0)];
    let bounds = check("instantaneousCurrent", &b.arena, node, &ranges, 1.05);
    assert!(bounds.range.magnitude() <= 12.1, "{:?}", bounds.range);
}

#[test]
fn azimuth() {
    let mut b = Builder::new();
    let (lat1, lat2, lon1, lon2) = (b.x(0), b.x(1), b.x(2), b.x(3));
    let to_degrees = b.c(DEGREES);
    let [lat1, lat2, lon1, lon2] = [lat1, lat2, lon1, lon2].map(|angle| b.mul(angle, to_degrees));
    let delta = b.sub(lon2, lon1);
    let [s1, c1, s2, c2] =
        [b.of(Unary::Sin, lat1), b.of(Unary::Cos, lat1), b.of(Unary::Sin, lat2), b.of(Unary::Cos, lat2)];
    let (sd, cd) = (b.of(Unary::Sin, delta), b.of(Unary::Cos, delta));
    let y = b.mul(c2, sd);
    let left = b.mul(c1, s2);
    let right = b.product(&[s1, c2, cd]);
    let x = b.sub(left, right);
    let ratio = b.div(y, x);
    let angle = b.of(Unary::Atan, ratio);
    let to_radians = b.c(std::f64::consts::PI / 180.0);
    let node = b.mul(angle, to_radians);
    let ranges = [(0.0, 0.4), (0.5, 1.0), (0.0, std::f64::consts::TAU), (-std::f64::consts::PI, -0.5)];
    let bounds = check("azimuth", &b.arena, node, &ranges, 1.005);
    assert!(bounds.range.magnitude() <= 1.27, "{:?}", bounds.range);
}
