//! Budgets with known results: one or two sources, and distributions from tables.
use super::*;
use crate::machine::Distribution;
use crate::machine::Quantity;
use gcode_lang::units::Deg;

/// Returns an axial hole at azimuth 0 or 180 whose coordinates are whole increments: rounding changes
/// nothing.
fn hole(x: f64) -> Hole {
    Hole {
        id: Some("1".to_owned()),
        entry: [x, 320.0, 0.0],
        axis: [0.0, 1.0, 0.0],
        depth: 15.0,
        diameter: None,
        ..Hole::default()
    }
}

fn request<'q>(machine: &'q Machine, holes: &'q [Hole], sources: &'q [ErrorSource]) -> BudgetRequest<'q> {
    BudgetRequest {
        machine,
        holes,
        clearance: 2.0,
        sources,
        samples: N,
        seed: 20_210_115,
        threads: NonZeroUsize::new(2).unwrap(),
        tolerance: 0.1,
    }
}

fn of(request: &BudgetRequest<'_>) -> Budget {
    budget(request, &AtomicUsize::new(0)).unwrap()
}

/// Returns the budget of holes on the default machine.
fn found(holes: &[Hole], sources: &[ErrorSource]) -> Budget {
    of(&request(&Machine::default(), holes, sources))
}

fn source(quantity: Quantity, distribution: Distribution) -> ErrorSource {
    ErrorSource { quantity, distribution }
}

const N: usize = 60_000;

/// Asserts a percentile within four standard errors: √(q·(1 − q)/N) over the density there.
fn percentile(found: f64, expected: f64, q: f64, density: f64) {
    let error = (q * (1.0 - q) / N as f64).sqrt() / density;
    assert!((found - expected).abs() < 4.0 * error, "{found} is not {expected} within {error}");
}

/// For X alone, Gaussian with σ: Φ = 2·|x| is half-normal. Mean 2σ·√(2/π); the percentiles of |x|/σ are those
/// of the normal distribution for 75 %, 97.5 % and 99.85 %.
#[test]
fn one_gaussian_axis_gives_the_half_normal_distribution() {
    let sigma = 0.01;
    for x in [300.0, -300.0] {
        let found = found(&[hole(x)], &[source(Quantity::Linear(0), Distribution::Normal(sigma))]);
        let statistics = found.holes[0].statistics;
        let mean = 2.0 * sigma * (2.0 / std::f64::consts::PI).sqrt();
        let error = 2.0 * sigma * (1.0 - 2.0 / std::f64::consts::PI).sqrt() / (N as f64).sqrt();
        assert!((statistics.mean - mean).abs() < 4.0 * error, "{} is not {mean}", statistics.mean);
        for (found, q, z) in [
            (statistics.p50, 0.5, 0.674_489_750),
            (statistics.p95, 0.95, 1.959_963_985),
            (statistics.p997, 0.997, 2.967_737_925),
        ] {
            let density = 2.0 * libm::exp(-z * z / 2.0) / (2.0 * std::f64::consts::PI).sqrt() / (2.0 * sigma);
            percentile(found, 2.0 * sigma * z, q, density);
        }
        assert!(statistics.p997 < statistics.max && statistics.share_in_tolerance > 0.999);
        assert!(found.holes[0].nominal < 1e-9);
        assert_eq!(found.shares[0].share, 1.0);
        assert!((found.shares[0].displacement - sigma).abs() < 1e-9);
    }
}

/// For a shift in x and in z, both Gaussian with σ: Φ is twice a Rayleigh variable, whose percentile q is
/// σ·√(−2·ln(1 − q)) and whose mean σ·√(π/2).
#[test]
fn two_gaussian_shifts_give_the_rayleigh_distribution() {
    let sigma = 0.02;
    let sources = [Quantity::Shift(0), Quantity::Shift(2)].map(|q| source(q, Distribution::Normal(sigma)));
    let found = found(&[hole(300.0), hole(-400.0)], &sources);
    for hole in &found.holes {
        let mean = 2.0 * sigma * (std::f64::consts::PI / 2.0).sqrt();
        let error = 2.0 * sigma * (2.0 - std::f64::consts::PI / 2.0).sqrt() / (N as f64).sqrt();
        assert!((hole.statistics.mean - mean).abs() < 4.0 * error);
        let statistics = hole.statistics;
        for (found, q) in [(statistics.p50, 0.5), (statistics.p95, 0.95), (statistics.p997, 0.997)] {
            let r = (-2.0 * libm::log(1.0 - q)).sqrt();
            percentile(found, 2.0 * sigma * r, q, r * libm::exp(-r * r / 2.0) / (2.0 * sigma));
        }
        assert!((hole.shares[0].share - 0.5).abs() < 1e-9);
    }
    // One part has one set-up: both its holes have the same deviation, and so has the worst of them.
    assert!((found.parts.p95 - found.holes[0].statistics.p95).abs() < 1e-9);
    // Within Φ0.1 is within 2.5 σ: 1 − exp(−3.125).
    assert!(
        (found.parts.share_in_tolerance - (1.0 - libm::exp(-3.125))).abs()
            < 4.0 * (0.042f64 / N as f64).sqrt()
    );
}

/// A run-out uniform from 0 to 0.15, in any direction, is an eccentricity of 0 to 0.075, so Φ is uniform from
/// 0 to 0.15.
#[test]
fn a_run_out_is_a_position_of_the_same_size() {
    let found = found(&[hole(300.0)], &[source(Quantity::RunOut, Distribution::Uniform(0.15))]);
    let statistics = found.holes[0].statistics;
    percentile(statistics.p50, 0.075, 0.5, 1.0 / 0.15);
    percentile(statistics.p95, 0.1425, 0.95, 1.0 / 0.15);
    assert!(statistics.max <= 0.15 + 1e-9);
    // The mean square of the displacement is (0.15/2)²/3.
    assert!((found.shares[0].displacement - 0.075 / 3f64.sqrt()).abs() < 1e-9);
}

/// A head 0.1° beyond its angle, its tip in its nominal position (no pivot, no tool length): the tool is
/// inclined to the hole, whose mouth is off by 15·tan 0.1°.
#[test]
fn an_error_of_the_head_angle_displaces_the_mouth() {
    for angle in [0.1, -0.1] {
        let found = found(&[hole(300.0)], &[source(Quantity::Head, Distribution::Fixed(angle))]);
        let aside = 15.0 * Deg(0.1).tan();
        assert!((found.holes[0].statistics.max - 2.0 * aside).abs() < 1e-9, "{found:?}");
        assert!((found.shares[0].displacement - aside).abs() < 1e-6);
    }
}

/// The sum of the sources' squares is the mean square of the samples, for a hole where one end decides.
#[test]
fn the_squares_of_the_shares_add_up_to_those_of_the_samples() {
    let sources = [
        source(Quantity::Tilt(2), Distribution::Normal(0.002)),
        source(Quantity::Index, Distribution::Uniform(0.002)),
        source(Quantity::Linear(0), Distribution::Normal(0.005)),
        source(Quantity::Centre(0), Distribution::Normal(0.004)),
    ];
    let found = found(&[hole(-300.0)], &sources);
    let squares: f64 =
        found.holes[0].shares.iter().map(|share| share.displacement * share.displacement).sum();
    assert!((found.holes[0].shares.iter().map(|share| share.share).sum::<f64>() - 1.0).abs() < 1e-12);
    // By hand: tilt about z at the height 320 and index at the radius 300, in rad, and B's centre twice at B = 180.
    let (tilt, index) = (320.0 * 0.002f64.to_radians(), 300.0 * 0.002f64.to_radians() / 3f64.sqrt());
    let by_hand = tilt * tilt + index * index + 0.005 * 0.005 + 0.008 * 0.008;
    assert!((squares / by_hand - 1.0).abs() < 1e-3, "{squares} is not {by_hand}");
    let mean = found.holes[0].statistics.mean;
    assert!(mean * mean / 4.0 < squares && squares < mean * mean, "{mean}");
}

#[test]
fn a_seed_gives_the_same_result_on_any_number_of_threads() {
    let sources = [
        source(Quantity::RunOut, Distribution::Uniform(0.1)),
        source(Quantity::Linear(0), Distribution::Normal(0.01)),
        source(Quantity::AxisTilt(2), Distribution::Normal(0.01)),
    ];
    let (machine, holes) = (Machine::default(), [hole(300.0), hole(-200.0)]);
    let with = |samples, threads| {
        let threads = NonZeroUsize::new(threads).unwrap();
        of(&BudgetRequest { samples, threads, ..request(&machine, &holes, &sources) })
    };
    let one = with(10_007, 1);
    for threads in [2, 3, 8] {
        assert_eq!(one, with(10_007, threads));
    }
    assert_eq!(with(1, 4).holes[0].statistics.share_in_tolerance, 1.0, "fewer samples than threads");
}

#[test]
fn a_hole_out_of_reach_is_named() {
    let head = crate::machine::Head::new(crate::machine::HeadKind::Fixed(nalgebra::Vector3::z_axis()), 0.0);
    let machine = Machine { head, ..Machine::default() };
    let holes = [Hole { axis: [0.0, 0.6, 0.8], ..hole(300.0) }];
    let error = budget(&request(&machine, &holes, &[]), &AtomicUsize::new(0)).unwrap_err();
    assert_eq!(error, BudgetError::OutOfReach { id: "1".to_owned() });
}
