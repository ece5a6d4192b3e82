//! Random pin-hole jobs: the generated programs, run as on the control, make the job's holes.
use std::fmt::Write;

use gcode_gen::check::check;
use gcode_inspect::verify::Answer;
use gcode_tests::bench::Bench;
use proptest::prelude::*;

/// 24 holes on five radii from near 0 to 0.97·a, 15° apart in an arbitrary order of turns, so that on all but small parts no two
/// meet.
fn holes() -> impl Strategy<Value = Vec<(f64, f64, bool, f64)>> {
    let hole = (0usize..5, -2i32..2, 0.0..6.0f64, any::<bool>(), 3.0..40.0f64);
    (prop::collection::vec(hole, 24), 0.12..0.2f64).prop_map(|(holes, inner)| {
        let on_radius =
            |(index, (ring, turn, jitter, axial, depth)): (usize, (usize, i32, f64, bool, f64))| {
                // One hole may stand near the axis, where all azimuths meet.
                let radius = if index == 0 { 1e-3 } else { inner + (0.97 - inner) * ring as f64 / 4.0 };
                let azimuth = f64::from(turn) * 360.0 + index as f64 * 15.0 + jitter;
                (radius, azimuth, axial, depth)
            };
        holes.into_iter().enumerate().map(on_radius).collect()
    })
}

/// Job files; numbers as a drawing has them, with more digits than the control's increment. The head may be an axis with a pivot.
fn random_jobs() -> impl Strategy<Value = String> {
    let control = (
        prop::sample::select(vec!["IS-B", "IS-C"]),
        prop::sample::select(vec!["fanuc-31i", "fanuc-0i-f", "haas-ngc"]),
        prop::sample::select(vec![1i8, -1]),
    );
    let head = prop::option::of((prop::sample::select(vec!['A', 'C']), 0.0..250.0f64));
    // A tool with a stated length is longer than its holes are deep.
    let lengths = prop_oneof![Just([0.0, 0.0]), [50.0..200.0f64, 50.0..200.0f64]];
    let surface = (150.0..1200.0f64, prop_oneof![Just(1.0), 0.4..1.0f64, 1.0..2.5f64]);
    (control, head, lengths, surface, 0.5..5.0f64, 0.0..80.0f64, holes()).prop_map(
        |((increment, dialect, sign), head, lengths, (a, ratio), clearance, retract, holes)| {
            let head = head.map_or("kind = \"manual\"".to_owned(), |(letter, pivot)| {
                format!("kind = \"axis\"\nletter = \"{letter}\"\npivot = {pivot:?}")
            });
            let (retract, b) = (clearance + retract, a * ratio);
            let mut text = format!(
                "family = \"pin-holes\"\n[control]\ndialect = \"{dialect}\"\nincrement = \"{increment}\"\n[machine]\n\
                 rotary = {{ letter = \"B\", sign = {sign} }}\nclearance = {clearance:?}\nretract = {retract:?}\n\
                 [machine.head]\n{head}\n[surface]\nkind = \"ellipsoid\"\na = {a:?}\nb = {b:?}\n[tolerance]\nposition = 0.1\n"
            );
            for (number, diameter, length) in [(1, 7.8, lengths[0]), (2, 8.0, lengths[1])] {
                let _ = write!(
                    text,
                    "[[tool]]\nnumber = {number}\ndiameter = {diameter:?}\nlength = {length:?}\nspeed = 1500\nfeed = 10.0\n"
                );
            }
            for (id, (radius, azimuth, axial, depth)) in holes.into_iter().enumerate() {
                let (radius, axis) = (radius * a, if axial { "axial" } else { "normal" });
                let _ = write!(
                    text,
                    "[[hole]]\nid = \"{id}\"\nradius = {radius:?}\nazimuth = {azimuth:?}\naxis = \"{axis}\"\n\
                     diameter = 8.0\ndepth = {depth:?}\n"
                );
            }
            text
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn a_random_job_makes_its_holes(text in random_jobs()) {
        let bench = Bench::of(&text);
        let checked = check(&bench.job, &bench.package).unwrap();
        prop_assume!(!checked.refusals.concat().contains(" overlap: their axes come within "));
        prop_assert!(checked.refusals.is_empty(), "{}\n{text}", checked.refusals.concat());
        let verdict = checked.verdict.into_holes().unwrap();
        prop_assert!(verdict.verdict == Answer::Pass);
        prop_assert!(verdict.holes.len() == 24 && verdict.extra.is_empty());
        let (worst, rounding) = (verdict.worst.unwrap(), verdict.rounding.unwrap());
        prop_assert!(worst <= rounding + 0.0005, "Φ{worst} where rounding explains Φ{rounding}\n{text}");
    }
}
