//! Tests of alignment jobs: values, defaults and messages.
use super::{Alignment, Readings};
use crate::job::Job;

const JOB: &str = r#"family = "alignment"
[control]
dialect = "fanuc-31i"
increment = "IS-B"
[machine]
rotary = { letter = "B", sign = 1 }
[surface]
kind = "ellipsoid"
a = 1158.8
b = 724.3
[probe]
radius = 3.0
[sine_table]
length = 200.0
phi = 38.5
gauge_blocks = "metric-87"
[chord]
e_radius = 812.4
f_radius = 318.0
circle = 1.0
candidates = 10
[runout]
heights = [150.0, 420.0]
angles = [-25.0, 25.0, 11]
"#;

fn read(text: &str) -> Alignment {
    let Ok(Job::Alignment(job)) = Job::parse(text) else { panic!("no alignment: {text}") };
    job
}

#[test]
fn every_key_of_a_job_is_read() {
    let job = read(JOB);
    assert_eq!((job.probe.feed, job.probe.search), (100.0, 10.0));
    assert_eq!((job.probe.radius, job.surface.b, job.sine_table.phi), (3.0, 724.3, 38.5));
    assert_eq!((job.sine_table.length, job.sine_table.gauge_blocks.name), (200.0, "metric-87"));
    assert_eq!((job.chord.e_radius, job.chord.candidates, job.unevenness()), (812.4, 10, 0.05));
    assert_eq!(job.runout.heights, [150.0, 420.0]);
    assert_eq!(job.runout.angles, Readings { from: -25.0, to: 25.0, count: 11 });
}

/// A slender part, a 700 and b 1500: for E at 512.4 and F at 318 the tilt gives 0.004° in rad·194.4·3.592
/// = 0.048 75, and the shift 0.01·4.592·(512.4/1021.93 − 318/1336.25) = 0.012 10: 1.5 times both is
/// 0.0913.
#[test]
fn a_slender_part_may_be_as_uneven_as_the_run_out_leaves_it() {
    let text =
        JOB.replace("a = 1158.8", "a = 700.0").replace("b = 724.3", "b = 1500.0").replace("812.4", "512.4");
    let job = read(&text);
    assert_eq!(job.unevenness(), 0.092);
}

#[test]
fn an_ellipse_that_is_left_out_goes_from_f_to_e() {
    for (increment, chord_error) in [("IS-A", 0.02), ("IS-B", 0.002), ("IS-C", 0.002)] {
        let path = read(&JOB.replace("IS-B", increment)).ellipse();
        assert_eq!((path.from, path.to, path.chord_error, path.feed), (318.0, 812.4, chord_error, 200.0));
    }
}

/// At E, x 812.4 and y 516.48, the normal is (0.5235, 0.8520): 812.4·0.8520 − 516.48·0.5235 = 421.8, and
/// 0.03/421.8 rad are 0.004 07°; 0.05 are 0.006 79°.
#[test]
fn limits_that_are_left_out_are_those_of_the_paper() {
    for (section, expected) in [
        ("", [0.025, 0.004, 0.03]),
        ("[limits]\ndial = 0.05", [0.025, 0.006, 0.05]),
        ("[limits]\nshift = 0.01\ntilt = 0.002", [0.01, 0.002, 0.03]),
    ] {
        let limits = read(&format!("{JOB}{section}")).limits();
        assert_eq!([limits.shift, limits.tilt, limits.dial], expected);
    }
}

#[test]
fn a_refused_key_is_named_with_its_line() {
    for (from, to, message) in [
        ("[probe]\nradius = 3.0\n", "", "key 'probe' is missing"),
        ("radius = 3.0", "radius = 0", "line 12: key 'probe.radius' is 0: 0.01 to 1000 mm"),
        (
            "radius = 3.0",
            "diameter = 6",
            "line 12: key 'probe.diameter' is unknown; allowed: radius, feed, search, noise",
        ),
        ("phi = 38.5", "phi = 46", "line 15: key 'sine_table.phi' is 46: 0 to 45 degrees"),
        ("length = 200.0", "sign = 2\nlength = 200.0", "line 14: key 'sine_table.sign' is 2: 1 or -1"),
        ("length = 200.0", "length = 5", "line 14: key 'sine_table.length' is 5: 10 to 2000 mm"),
        (
            "metric-87",
            "metric-86",
            "line 16: key 'sine_table.gauge_blocks' is 'metric-86': one of metric-32, metric-38, metric-46, metric-47, \
             metric-76, metric-83, metric-87, metric-88, metric-91, metric-103, metric-112",
        ),
        (
            "length = 200.0\nphi = 38.5\ngauge_blocks = \"metric-87\"",
            "length = 500.0\nphi = 45.0\ngauge_blocks = \"metric-32\"",
            "line 16: key 'sine_table.gauge_blocks' is 'metric-32': all its blocks together are \
             188.955 mm high, L*sin(phi) is 353.553 mm",
        ),
        ("candidates = 10", "candidates = 11", "line 21: key 'chord.candidates' is 11: 1 to 10"),
        ("[runout]", "uneven = 0\n[runout]", "line 22: key 'chord.uneven' is 0: 0.001 to 100 mm"),
        (
            "e_radius = 812.4",
            "e_radius = 318",
            "line 19: key 'chord.f_radius' is 318, equal to e_radius: E and F need different values",
        ),
        ("radius = 3.0", "radius = 3.0\nfeed = 0", "line 13: key 'probe.feed' is 0: 0.01 to 1000 mm/min"),
        (
            "e_radius = 812.4",
            "e_radius = 1200.0",
            "line 18: key 'chord.e_radius' is 1200: 0 to the equatorial radius a = 1158.8 mm",
        ),
        (
            "circle = 1.0",
            "circle = 2.0",
            "line 20: key 'chord.circle' is 2: at most an eighth of 'probe.search', which is 10 mm, \
             because the surface falls within the circle",
        ),
        (
            "f_radius = 318.0",
            "f_radius = 811.0",
            "line 20: key 'chord.circle' is 1: the circles round E and F, 1.400 mm apart in x, must not meet",
        ),
        // y = 129.939, tan = (y/b²)/(x/a²) = 0.29176.
        (
            "e_radius = 812.4",
            "e_radius = 1140.0",
            "line 18: key 'chord.e_radius' is 1140: the surface is at 16.3 degrees to y there, and \
             less than 17.5 is too steep for a touch along y; choose it nearer to the pole",
        ),
        (
            "radius = 3.0",
            "radius = 3.0\nnoise = 0.0005",
            "line 13: key 'probe.noise' is 0.0005: 0.001 (the least increment) to 1 mm",
        ),
        ("[runout]", "[runout]\ny_shift = 0", "line 23: key 'runout.y_shift' is 0: 0.01 to 100 mm"),
        ("[150.0, 420.0]", "[150.0]", "line 23: key 'runout.heights' has 1 values: 2 are required"),
        (
            "[150.0, 420.0]",
            "[150.0, 150.0]",
            "line 23: key 'runout.heights' needs two different y, each less than b = 724.3 mm from 0; \
             both are 150",
        ),
        (
            "[150.0, 420.0]",
            "[150.0, -800.0]",
            "line 23: key 'runout.heights' needs two different y, each less than b = 724.3 mm from 0; -800 is not",
        ),
        (
            "phi = 38.5",
            "phi = 0.01",
            "line 15: key 'sine_table.phi' is 0.01: L*sin(phi) is 0.0349 mm, lower than any stack of \
             'metric-87'; put blocks under both rollers and choose the phi of their difference, or 0",
        ),
        (
            "[-25.0, 25.0",
            "[10.0, 60.0",
            "line 24: key 'runout.angles' runs from 10 to 60: it must include 0, because the chord and \
             the ellipse are touched at B0; shift the work zero of the rotary so that 0 is on the petal",
        ),
        (
            "[-25.0, 25.0",
            "[-60.0, -0.5",
            "line 24: key 'runout.angles' runs from -60 to -0.5: it must include 0, because the chord \
             and the ellipse are touched at B0; shift the work zero of the rotary so that 0 is on the \
             petal",
        ),
        (
            "25.0, 11]",
            "25.0, 2]",
            "line 24: key 'runout.angles' is from, to and the number of readings; the number of \
             readings is 2: a whole number, 3 to 100",
        ),
        (
            "25.0, 11]",
            "25.0, 10.5]",
            "line 24: key 'runout.angles' is from, to and the number of readings; the number of \
             readings is 10.5: a whole number, 3 to 100",
        ),
        (
            "[-25.0, 25.0",
            "[25.0, -25.0",
            "line 24: key 'runout.angles' is from, to and the number of readings; it runs from 25 to \
             -25: from must be less than to",
        ),
        (
            "[-25.0, 25.0",
            "[-25.0, 365.0",
            "line 24: key 'runout.angles' is from, to and the number of readings; the angle to is 365: \
             -360 to 360 degrees",
        ),
        (
            "[runout]",
            "[ellipse]\nfrom = -1\n[runout]",
            "line 23: key 'ellipse.from' is -1: 0 to the equatorial radius a = 1158.8 mm",
        ),
        (
            "[runout]",
            "[ellipse]\nto = 1200\n[runout]",
            "line 23: key 'ellipse.to' is 1200: 0 to the equatorial radius a = 1158.8 mm",
        ),
        (
            "[runout]",
            "[ellipse]\nchord_error = 0.0005\n[runout]",
            "line 23: key 'ellipse.chord_error' is 0.0005: 0.001 (the least increment) to 1 mm",
        ),
        ("[runout]", "[ellipse]\nfeed = 0\n[runout]", "line 23: key 'ellipse.feed' is 0: 1 to 10000 mm/min"),
        (
            "[runout]",
            "[ellipse]\nspeed = 1\n[runout]",
            "line 23: key 'ellipse.speed' is unknown; allowed: from, to, chord_error, feed",
        ),
        (
            "[runout]",
            "[ellipse]\nto = 318\n[runout]",
            "line 23: the ellipse begins and ends at x = 318 mm: 'ellipse.from' and 'ellipse.to' (by default F and E) must differ",
        ),
        ("[runout]", "[limits]\nshift = 0\n[runout]", "line 23: key 'limits.shift' is 0: 0.001 to 10 mm"),
        ("[runout]", "[limits]\ntilt = 2\n[runout]", "line 23: key 'limits.tilt' is 2: 0.001 to 1 degrees"),
        (
            "[runout]",
            "[limits]\ndial = -0.03\n[runout]",
            "line 23: key 'limits.dial' is -0.03: 0.001 to 10 mm",
        ),
        (
            "[runout]",
            "[limits]\nchord = 1\n[runout]",
            "line 23: key 'limits.chord' is unknown; allowed: shift, tilt, dial",
        ),
    ] {
        let text = JOB.replacen(from, to, 1);
        assert_ne!(text, JOB, "{from}");
        let found = Job::parse(&text).unwrap_err().to_string();
        assert!(found.ends_with(message), "{found}\n{message}");
    }
}
