//! What the measurements refuse before the ball moves, and where they leave the rotary: modes that change coordinates, a start from
//! which the way leads through the part.
use gcode_inspect::machine::Placement;
use gcode_session::Run;
use gcode_tests::alignment::{Bench, alarm, marks, placement, value};

/// A main program of the example, behind these blocks.
fn run_behind(main: u32, blocks: &str) -> Run {
    let first = "N20 G00 G17 G40 G49 G54 G80 G90 G94\n";
    Bench::of(&[]).edited(main, first, &format!("{first}{blocks}")).run(main, &Placement::default(), &[])
}

/// G16 and G51 don't refuse the main programs' own G52; what G68 and G51.1 do to it the simulator doesn't know, so that it stops there.
#[test]
fn coordinates_that_are_changed_are_an_alarm_before_the_ball_moves() {
    for (main, number) in [(8200, 3120), (8210, 3139), (8220, 3113)] {
        let polar = run_behind(main, "G16\n");
        assert_eq!(alarm(&polar), Some(number), "O{main}");
        let turned = Bench::of(&[]).edited(main, "N30 G52 B0.\n", "G68 X0 Y0 R10.\n").run(
            main,
            &Placement::default(),
            &[],
        );
        assert_eq!(alarm(&turned), Some(number), "O{main}");
        for run in [&polar, &turned] {
            assert_eq!([5001, 5002, 5003].map(|axis| value(run, axis)), [0.0; 3], "O{main}");
        }
    }
}

/// The pole is at Y 724.3, the equator at X 1158.8; the ball's radius is 3.
#[test]
fn a_start_whose_way_leads_through_the_part_is_an_alarm() {
    for (at, refused) in [
        ("G00 Y900.\nX-800.\nY560.\n", true),
        ("G00 Y900.\nZ-500.\nY700.\n", true),
        ("G00 Y900.\nX-800.\n", false),
        ("G00 X1300.\nZ-500.\nY400.\n", false),
        ("G00 Y900.\nX800.\nY560.\n", false),
    ] {
        for (main, number) in [(8210, 3140), (8220, 3114)] {
            assert_eq!(alarm(&run_behind(main, at)), refused.then_some(number), "O{main} {at}");
        }
    }
}

/// The numbers at the stop are those of a part at B0: whoever moves it at B25 moves it elsewhere.
#[test]
fn the_run_out_stops_and_ends_at_0_of_the_rotary() {
    let stop = "#3006=1(PART OFF #580-#583 AT B0)";
    let run = Bench::of(&[]).edited(8210, stop, "#599=#5025").run(8210, &Placement::default(), &[]);
    assert_eq!(alarm(&run), None);
    assert_eq!([599, 5025].map(|number| value(&run, number)), [0.0; 2]);
}

/// Both ends 0.9 aside, the way of azimuths that grow: by hand, tan = (812.4 + 318)·0.9/(812.4² + 318²) = 0.001 336 7, which is
/// 0.076 59°. A chord turned by that leaves 0.9 − 812.4·0.001 336 7 = −0.186 at E and +0.475 at F. E alone 0.9 aside is
/// 812.4·0.9/761 118 = 0.055 04°. X and Z of G54 stay, wherever the marks are.
#[test]
fn marks_correct_y_and_the_rotary_alone() {
    let aside = |of: std::ops::Range<u32>, axis: u32, by: f64| -> Vec<(u32, f64)> {
        let moved = |n: u32| of.contains(&n) && (n - 501) % 3 == axis;
        let one_each = |n: u32| if n < 531 { 501 + (n - 501) % 3 } else { 531 + (n - 531) % 3 };
        let marks = marks();
        let first = |n: u32| marks.iter().find(|(number, _)| *number == one_each(n)).unwrap().1;
        (501..561).map(|n| (n, first(n) + if moved(n) { by } else { 0.0 })).collect()
    };
    for (set, y, rotary) in [
        (aside(501..561, 2, 0.9), 0.0, 0.076_59),
        (aside(501..531, 2, 0.9), 0.0, 0.055_04),
        (aside(501..561, 2, -0.9), 0.0, -0.076_59),
        (aside(501..561, 0, 0.9), 0.0, 0.0),
        (aside(501..561, 1, -0.3), -0.3, 0.0),
    ] {
        for sign in [1.0, -1.0] {
            let bench = match sign > 0.0 {
                true => Bench::of(&[]),
                false => Bench::of(&[("sign = 1 }", "sign = -1 }")]),
            };
            let run = bench.run(8200, &placement([0.0; 3], [0.0; 3]), &set);
            assert_eq!(alarm(&run), None);
            assert!((value(&run, 574) - y).abs() < 1e-6, "{}", value(&run, 574));
            assert!((value(&run, 576) - sign * rotary).abs() < 2e-5, "{}", value(&run, 576));
            assert_eq!([5221, 5223].map(|number| value(&run, number)), [0.0; 2]);
            assert!(
                (value(&run, 5222) - y).abs() < 0.0006 && (value(&run, 5225) - sign * rotary).abs() < 0.0006
            );
        }
    }
}
