//! Claims on the macro as it is, and on wrong twins of it that must not pass.
use gcode_prove::ClaimVerdict;

use super::report::ClaimReport;
use super::*;
use crate::families::{ALL, emit};

/// The new job with one normal hole and one tool.
fn job() -> Job {
    let family = ALL.iter().find(|family| family.name == "pin-holes").unwrap();
    let Ok(Job::PinHoles(mut job)) = Job::parse(family.new_job) else { panic!("no pin holes") };
    let mut hole = job.holes.iter().find(|hole| hole.axis == AxisDirection::Normal).unwrap().clone();
    hole.tools = vec![2];
    job.holes = vec![hole];
    Job::PinHoles(job)
}

/// Proves a job's macros after an edit of their text.
fn proved(job: &Job, (from, to): (&str, &str), over: &[&str], tolerance: f64) -> Vec<ClaimReport> {
    let mut package = emit(job);
    let mut is_edited = from.is_empty();
    for program in package.programs.iter_mut().filter(|program| program.number != 8100) {
        if !from.is_empty() && program.text.contains(from) {
            program.text = program.text.replace(from, to);
            is_edited = true;
        }
    }
    assert!(is_edited, "{from}");
    let over: Vec<String> = over.iter().map(|text| (*text).to_owned()).collect();
    let request = ProofRequest {
        job,
        package: &package,
        over: &over,
        tolerances: &[tolerance],
        threads: NonZeroUsize::MIN,
        clock: &|| Duration::ZERO,
        limit: Duration::from_secs(5),
    };
    let mut proof = prove_job(&request).unwrap();
    assert_eq!(proof.cases.len(), 1);
    proof.cases.remove(0).claims
}

const PART: [&str; 4] =
    ["hole.radius=0..1998", "hole.azimuth=-180..180", "surface.a=500..2000", "surface.b=300..1200"];

/// Half an increment of B is 0.0005° = 8.72665·10⁻⁶ rad: 0.017436 mm at r = 1998. The words X and Y are off by 0.0005 each,
/// 0.000707 together, and half an increment of the head moves the bottom, 15 mm below, by 0.000131: together
/// 2·√(0.017436² + 0.000838²) = 0.034912.
#[test]
fn every_pin_hole_is_as_near_as_rounding_allows() {
    let claims = proved(&job(), ("", ""), &PART, 0.035);
    let verdicts: Vec<_> = claims.iter().map(|claim| (claim.claim.as_str(), claim.verdict)).collect();
    assert!(claims.iter().all(|claim| claim.verdict == ClaimVerdict::Proved), "{verdicts:?}");
    assert_eq!(claims[0].proved_share, 1.0);
    let bound = claims[1].bound.unwrap();
    assert!((0.034_910..0.034_920).contains(&bound), "{bound}");
    // The verified holes come near it, and none is beyond.
    let found = claims[1].found.as_ref().unwrap().0;
    assert!(found > 0.01 && found < bound, "{found}");
    assert!((0.000_707..0.000_708).contains(&claims[2].bound.unwrap()), "{:?}", claims[2].bound);
    // The clearance of 2 mm, less the rounding: (0.0005 + 0.0005)·√2 between the two ends, 0.0005·√2 of the nearer one, and 3 mm
    // of the tool tilted by 0.0005°.
    assert!((1.9978..1.9979).contains(&claims[3].bound.unwrap()), "{:?}", claims[3]);
    assert!(claims[5].claim.contains("at most 95 blocks"), "{verdicts:?}");
}

#[test]
fn an_axial_hole_needs_no_angle() {
    let Job::PinHoles(mut axial) = job() else { unreachable!() };
    axial.holes[0].axis = AxisDirection::Axial;
    let axial = Job::PinHoles(axial);
    let claims = proved(&axial, ("", ""), &PART, 0.035);
    let (rapids, others): (Vec<_>, Vec<_>) = claims.iter().partition(|claim| claim.claim.contains("rapids"));
    assert!(others.iter().all(|claim| claim.verdict == ClaimVerdict::Proved), "{claims:?}");
    // Near the equator the edge of the tool isn't followed.
    assert!(rapids[0].verdict == ClaimVerdict::Undecided && rapids[0].proved_share > 0.5, "{rapids:?}");
    let over = ["hole.radius=0..450", PART[1], PART[2], PART[3]];
    let claims = proved(&axial, ("", ""), &over, 0.035);
    // 2 mm, less 1200/√500·√(2·0.0005) = 1.697 by which the surface can rise within half an increment, less 0.0021.
    assert!((0.300..0.302).contains(&claims[3].bound.unwrap()), "{:?}", claims[3]);
}

/// The printed height, the angle of the wrong normal, whole degrees of B, its wrong sense, a hole 0.02 mm aside, and a cosine for
/// a sine.
#[test]
fn wrong_twins_are_refuted() {
    let height = "#24=#2*SQRT[[#1-#18]*[#1+#18]]/#1";
    for (from, to) in [
        (height, "#24=SQRT[[#1-#18]*[#1+#18]]/#1/#2"),
        ("ATAN[#24/[#2*#2]]/[#18/[#1*#1]]", "ATAN[#24]/[#18]"),
        ("B[#21*#23]", "B[#21*FIX[#23]]"),
        ("B[#21*#23]", "B[-#21*#23]"),
        ("G01 X[#18+[#17-#7]*#26]", "G01 X[#18+0.02+[#17-#7]*#26]"),
        ("#27=SIN[#141]", "#27=COS[#141]"),
    ] {
        let claims = proved(&job(), (from, to), &PART, 0.035);
        assert_eq!(claims[0].verdict, ClaimVerdict::Refuted, "{to}: {:?}", claims[0]);
        assert!(claims[0].counterexample.is_some() && claims[0].proved_share < 1.0, "{to}: {:?}", claims[0]);
    }
}

/// At r ≤ 100 rounding allows 2·√(0.000838² + 0.000873²) = 0.00242. A head that is off by 0.019°, which O8101 accepts at 15 mm,
/// moves the bottom by 0.005 mm.
#[test]
fn a_head_that_is_set_wrong_is_refuted() {
    let over = ["hole.radius=0..100", "hole.azimuth=-180..180", "surface.a=500..2000", "surface.b=300..1200"];
    let claims = proved(&job(), ("", ""), &over, 0.0025);
    assert_eq!(claims[0].verdict, ClaimVerdict::Proved, "{:?}", claims[0]);
    let twin = ("#140=ROUND[#25*1000.]/1000.", "#140=ROUND[#25*1000.]/1000.+0.019");
    let claims = proved(&job(), twin, &over, 0.0025);
    assert_eq!(claims[0].verdict, ClaimVerdict::Refuted, "{:?}", claims[0]);
}

/// A rapid to the bottom's side of the surface, and one that goes to the retract point at once, through the part.
#[test]
fn rapids_through_the_part_are_not_proved() {
    for (from, to) in [
        (
            "X[#18+[#17+#3]*#26] Y[#24+[#17+#3]*#27] (DOWN TO C)",
            "X[#18+[#17-#3]*#26] Y[#24+[#17-#3]*#27] (DOWN TO C)",
        ),
        ("X[[#5001+#28+ABS[#5001-#28]]/2] Y[[#5002+#29+ABS[#5002-#29]]/2] Z0.", "X#28 Y#29 Z0."),
    ] {
        let claims = proved(&job(), (from, to), &PART, 0.035);
        let rapids = claims.iter().find(|claim| claim.claim.starts_with("rapids")).unwrap();
        assert_eq!(rapids.verdict, ClaimVerdict::Undecided, "{to}: {rapids:?}");
    }
}

#[test]
fn a_missing_guard_is_refuted_by_a_radius_beyond_the_equator() {
    let claims = proved(&job(), ("OR[#18 GT #1]OR", "OR"), &PART, 0.035);
    let alarms = claims.iter().find(|claim| claim.claim.starts_with("no alarms")).unwrap();
    assert_eq!(alarms.verdict, ClaimVerdict::Refuted);
    let point = alarms.counterexample.as_ref().unwrap();
    assert!(point["hole.radius"] > point["surface.a"], "{point:?}");
}

/// 1 − r²/a² instead of (a − r)·(a + r)/a² is the same hole, but for its rounding near the equator.
#[test]
fn another_formula_of_the_same_height_is_proved() {
    let twin = ("#24=#2*SQRT[[#1-#18]*[#1+#18]]/#1", "#24=#2*SQRT[1.-#18*#18/#1/#1]");
    let over = ["hole.radius=0..450", "surface.a=500..2000", "surface.b=300..1200"];
    let claims = proved(&job(), twin, &over, 0.01);
    assert_eq!(claims[0].verdict, ClaimVerdict::Proved, "{:?}", claims[0]);
}

#[test]
fn a_feed_that_is_not_followed_is_undecided() {
    let twin = ("G01 X[#18+[#17-#7]*#26]", "G01 Z0.1 F#9\nX[#18+[#17-#7]*#26]");
    let claims = proved(&job(), twin, &["hole.radius=100..101"], 10.0);
    assert_ne!(claims[0].verdict, ClaimVerdict::Proved);
    assert!(claims[0].proved_share < 1.0);
}

#[test]
fn requests_that_can_not_be_used_say_why() {
    let job = job();
    let package = emit(&job);
    let request = |over: &[String]| {
        let request = ProofRequest {
            job: &job,
            package: &package,
            over,
            tolerances: &[],
            threads: NonZeroUsize::MIN,
            clock: &|| Duration::ZERO,
            limit: Duration::from_secs(1),
        };
        prove_job(&request).unwrap_err()
    };
    assert!(request(&[]).contains("give --over"));
    assert!(request(&["hole.colour=1..2".to_owned()]).contains("is none of"));
}
