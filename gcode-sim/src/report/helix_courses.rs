//! The helix angle along every flute over the distance from the shank's end, for its picture.
use gcode_draw::{HelixCourses, HelixPoint};
use gcode_inspect::flutes::{GrindingPass, Trace};
use gcode_inspect::verify::flutes::FluteVerdict;
use gcode_lang::units::Deg;
use gcode_part::Flutes;
use gcode_part::job::FluteLaw;
use gcode_session::GrindingRun;

/// Polar angles marked along the nose; the tip angle follows.
const NAMED_ANGLES: [f64; 6] = [90.0, 75.0, 60.0, 45.0, 30.0, 15.0];

pub(super) fn of(grinding: &GrindingRun, verdict: &FluteVerdict) -> HelixCourses {
    let wanted = &grinding.nominal;
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
    let nose = NAMED_ANGLES.into_iter().filter(|polar| tip + 5.0 < *polar).chain([tip]);
    let at = |way: f64, polar: Deg| {
        let (wanted, other) = (wanted.helix_angle(wanted.law, polar).0, wanted.helix_angle(other, polar).0);
        HelixPoint { path_length: way, actual: wanted, nominal: wanted, other_law: other }
    };
    let shank = (0.0 < wanted.start).then(|| at(0.0, Deg(90.0)));
    HelixCourses {
        passes: grinding.result.passes.iter().map(|pass| course(wanted, pass)).collect(),
        worst_pass: verdict.course_pass - 1,
        tolerance: wanted.helix_tolerance.0,
        laws: [wanted.law.name(), other.name()],
        nominal: shank.into_iter().chain(outline.iter().map(|(polar, way)| at(*way, *polar))).collect(),
        nose: nose.filter_map(|polar| Some((nearest(polar)?, format!("{polar}°")))).collect(),
    }
}

/// Returns the distance from the shank's end along the nose by polar angle, every half degree and at the tip
/// angle.
fn outline(wanted: &Flutes) -> Vec<(Deg, f64)> {
    let tip = wanted.tip_angle;
    let halves = (0..=180).map(|half| Deg(90.0 - f64::from(half) / 2.0)).filter(|polar| tip < *polar);
    let mut way = wanted.start;
    let mut before = wanted.profile.point_at_polar(Deg(90.0));
    halves
        .chain([tip])
        .map(|polar| {
            let here = wanted.profile.point_at_polar(polar);
            way += (here - before).norm();
            before = here;
            (polar, way)
        })
        .collect()
}

/// Returns the helix angles of a pass by distance, whatever its direction.
fn course(wanted: &Flutes, pass: &GrindingPass) -> Vec<HelixPoint> {
    let begins = from_shank(wanted, &pass.trace);
    let windows = pass.trace.windows(wanted.gauge);
    let mut course: Vec<HelixPoint> = windows
        .map(|window| HelixPoint {
            path_length: begins + window.middle.along,
            actual: window.helix.0,
            nominal: window.nominal_helix.0,
            other_law: window.other_law_helix.0,
        })
        .collect();
    course.sort_by(|one, other| one.path_length.total_cmp(&other.path_length));
    course
}

/// Returns the distance along the outline from the shank's end to the pass's start, by the sample nearest the
/// shank.
fn from_shank(wanted: &Flutes, trace: &Trace) -> f64 {
    let first = trace.samples.iter().max_by(|one, other| one.point.x.total_cmp(&other.point.x));
    first.map_or(0.0, |first| wanted.start - first.point.x - first.along)
}
