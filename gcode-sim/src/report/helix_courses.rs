//! The helix angle along every flute over the distance from the shank's end, for its picture.
use gcode_draw::{HelixAt, HelixCourses};
use gcode_inspect::flutes::{GrindingPass, Trace};
use gcode_inspect::verify::flutes::FluteVerdict;
use gcode_lang::units::Deg;
use gcode_part::Flutes;
use gcode_part::job::FluteLaw;
use gcode_session::GrindingRun;

/// Polar angles marked along the nose; the tip angle follows.
const NAMED: [f64; 6] = [90.0, 75.0, 60.0, 45.0, 30.0, 15.0];

pub(super) fn of(grinding: &GrindingRun, verdict: &FluteVerdict) -> HelixCourses {
    let wanted = &grinding.wanted;
    let other = match wanted.law {
        FluteLaw::ConstantHelix => FluteLaw::Published,
        FluteLaw::Published => FluteLaw::ConstantHelix,
    };
    let outline = outline(wanted);
    let tip = wanted.tip_angle.0;
    let nearest = |polar: f64| {
        let off = |one: &(Deg, f64)| (one.0.0 - polar).abs();
        outline.iter().min_by(|one, other| off(one).total_cmp(&off(other))).map(|(_, way)| *way)
    };
    let nose = NAMED.into_iter().filter(|polar| tip + 5.0 < *polar).chain([tip]);
    let at = |way: f64, polar: Deg| {
        let (wanted, other) = (wanted.angle(wanted.law, polar).0, wanted.angle(other, polar).0);
        HelixAt { way, found: wanted, wanted, other }
    };
    let shank = (0.0 < wanted.start).then(|| at(0.0, Deg(90.0)));
    HelixCourses {
        passes: grinding.ground.passes.iter().map(|pass| course(wanted, pass)).collect(),
        worst: verdict.course_pass - 1,
        tolerance: wanted.helix_tolerance.0,
        laws: [wanted.law.name(), other.name()],
        wanted: shank.into_iter().chain(outline.iter().map(|(polar, way)| at(*way, *polar))).collect(),
        nose: nose.filter_map(|polar| Some((nearest(polar)?, format!("{polar}°")))).collect(),
    }
}

/// Returns the distance from the shank's end along the nose by polar angle, every half degree and at the tip
/// angle.
fn outline(wanted: &Flutes) -> Vec<(Deg, f64)> {
    let tip = wanted.tip_angle;
    let halves = (0..=180).map(|half| Deg(90.0 - f64::from(half) / 2.0)).filter(|polar| tip < *polar);
    let mut way = wanted.start;
    let mut before = wanted.profile.at_polar(Deg(90.0));
    halves
        .chain([tip])
        .map(|polar| {
            let here = wanted.profile.at_polar(polar);
            way += (here - before).norm();
            before = here;
            (polar, way)
        })
        .collect()
}

/// Returns the helix angles of a pass by distance, whatever its direction.
fn course(wanted: &Flutes, pass: &GrindingPass) -> Vec<HelixAt> {
    let begins = from_shank(wanted, &pass.trace);
    let windows = pass.trace.windows(wanted.gauge);
    let mut course: Vec<HelixAt> = windows
        .map(|window| HelixAt {
            way: begins + window.middle.along,
            found: window.helix.0,
            wanted: window.nominal_helix.0,
            other: window.other_law_helix.0,
        })
        .collect();
    course.sort_by(|one, other| one.way.total_cmp(&other.way));
    course
}

/// Returns the distance along the outline from the shank's end to the pass's start, by the sample nearest the
/// shank.
fn from_shank(wanted: &Flutes, trace: &Trace) -> f64 {
    let first = trace.samples.iter().max_by(|one, other| one.point.x.total_cmp(&other.point.x));
    first.map_or(0.0, |first| wanted.start - first.point.x - first.along)
}
