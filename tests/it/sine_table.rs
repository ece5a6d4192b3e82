//! The sine table's program on the control: heights worked out by hand, and what it refuses.
use std::path::Path;

use gcode_control::Outcome;
use gcode_gen::check::Programs;
use gcode_gen::families;
use gcode_gen::package::Package;
use gcode_inspect::machine::Machine;
use gcode_part::job::Job;
use gcode_session::{Request, Run, run};

fn package() -> Package {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/alignment/job.toml");
    families::emit(&Job::parse(&std::fs::read_to_string(path).unwrap()).unwrap())
}

/// O8230 with a word changed, after a run-out that found this tilt.
fn ran(change: (&str, &str), tilt: Option<f64>) -> Run {
    after(change, tilt, Some(0.001))
}

/// The same, with what the run-out left in #585.
fn after(change: (&str, &str), tilt: Option<f64>, left: Option<f64>) -> Run {
    let package = package();
    let text = &package.program(8230).unwrap().text;
    assert!(text.contains(change.0), "{} isn't in\n{text}", change.0);
    let text = text.replace(change.0, change.1);
    let mut request = Request::new("O8230.nc", text.into_bytes(), Machine::parse(&package.machine).unwrap());
    request.variables.extend(tilt.map(|tilt| (583, tilt)));
    request.variables.extend(left.map(|left| (585, left)));
    run(&request, &mut Programs(&package), &mut ()).unwrap()
}

/// L = 200: 200·sin 38.4° = 124.229 56, 200·sin 38.5° = 124.502 93, 200·sin 38.6° = 124.775 92. A micron at 38.4° is
/// 206 265/(200 000·cos 38.4°) = 1.316 seconds, at 38.6° 1.320: 0.444 microns are 0.584, 0.081 are 0.106.
#[test]
fn the_height_follows_the_tilt_the_way_that_u_says() {
    let cases = [
        ("U1.", 0.1, 38.4, 124.23, 124.23 - 124.502_927, 0.584),
        ("U-1.", 0.1, 38.6, 124.776, 124.776 - 124.502_927, 0.106),
        ("U-1.", -0.1, 38.4, 124.23, 124.23 - 124.502_927, 0.584),
        ("U1.", 0.0, 38.5, 124.503, 124.503 - 124.502_927, 0.096),
    ];
    for (sign, tilt, angle, height, change, left) in cases {
        let ran = ran(("U1.", sign), Some(tilt));
        assert!(matches!(ran.outcome, Outcome::End), "{:?}", ran.outcome);
        let value = |number: u32| ran.control.variable(number).unwrap().number();
        let found = [value(586), value(587), value(588), value(589)];
        for (found, (wanted, by)) in
            found.into_iter().zip([(angle, 1e-9), (height, 1e-9), (change, 1e-6), (left, 2e-3)])
        {
            assert!((found - wanted).abs() < by, "{found} is not {wanted}, {sign} {tilt}");
        }
        assert_eq!(ran.control.stops().len(), 2, "the operator is asked and told");
        assert!(ran.control.variable(583).unwrap().is_vacant(), "used up");
    }
}

/// 200·sin 38.5° is 124.503 by the set of 87: 1.003 for the last digit, which leaves 123.5, and no block is as thick.
#[test]
fn the_program_names_the_blocks() {
    let package = package();
    let text = &package.program(8230).unwrap().text;
    assert!(text.contains("(GAUGE BLOCKS METRIC-87)\n(BLOCKS 100 + 20 + 3.5 + 1.003)\n"), "{text}");
    assert!(text.contains("(THEY MAKE 0.10 SECONDS OF ARC TOO MUCH)"), "{text}");
}

/// sin 0 = 0: nothing goes under the table, and nothing is left of the angle.
#[test]
fn a_table_that_lies_flat_has_no_blocks() {
    let text =
        std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/alignment/job.toml"));
    let package = families::emit(&Job::parse(&text.unwrap().replace("phi = 38.5", "phi = 0.0")).unwrap());
    let text = &package.program(8230).unwrap().text;
    assert!(
        text.contains("(GAUGE BLOCKS METRIC-87)\n(NO BLOCKS, THE TABLE LIES FLAT)\n(AFTER O8210"),
        "{text}"
    );
}

#[test]
fn what_no_table_can_be_set_to_is_refused() {
    let cases = [
        ("THEN #596=38.5", "THEN #597=1", Some(0.1), 3161),
        ("THEN #596=38.5", "THEN #596=-1.", Some(0.1), 3169),
        ("THEN #596=38.5", "THEN #596=45.1", Some(0.1), 3161),
        ("B200.", "", Some(0.1), 3162),
        ("C0.001", "C0.", Some(0.1), 3163),
        ("U1.", "", Some(0.1), 3164),
        ("U1.", "U2.", Some(0.1), 3164),
        ("U1.", "U1.", None, 3165),
        ("THEN #596=38.5", "THEN #596=44.9", Some(-0.2), 3166),
        ("THEN #596=38.5", "THEN #596=0.1", Some(0.2), 3166),
        ("U1.", "U1.", Some(1.001), 3168),
        ("U1.", "U1.", Some(-1.001), 3168),
        ("U1.", "U1.", Some(-38.0), 3168),
    ];
    for (from, to, tilt, number) in cases {
        let ran = ran((from, to), tilt);
        let Outcome::Alarm(stopped) = &ran.outcome else { panic!("{to} in place of {from} runs") };
        assert_eq!(stopped.alarm.code().raised, Some(number), "{to} in place of {from}, {tilt:?}");
        assert!(ran.control.variable(586).unwrap().is_vacant());
    }
}

/// A run-out that came to no end leaves #585 vacant, whatever stands in #583; 1° is the most that is believed, and 38.5 − 1 is 37.5.
#[test]
fn a_tilt_of_no_finished_run_out_is_refused_before_a_stack_is_told() {
    let ran = after(("U1.", "U1."), Some(0.1), None);
    let Outcome::Alarm(stopped) = &ran.outcome else { panic!("it runs") };
    assert_eq!(stopped.alarm.code().raised, Some(3167));
    assert!(ran.control.stops().is_empty());
    assert!((586..590).all(|number| ran.control.variable(number).unwrap().is_vacant()));
    for (tilt, angle) in [(1.0, 37.5), (-1.0, 39.5)] {
        let ran = after(("U1.", "U1."), Some(tilt), Some(0.0));
        assert!(matches!(ran.outcome, Outcome::End), "{:?}", ran.outcome);
        assert!((ran.control.variable(586).unwrap().number() - angle).abs() < 1e-9);
    }
}
