//! Contents of a burr's pictures: its outline, the ground flutes, and the helix angle along them.
use nalgebra::Point3;

use super::top::{assumption_lines, drawn_conclusion};
use gcode_draw::{Fault, FlutePoint, FluteView, HelixCourses, HelixPoint, HoleStatus};
use gcode_inspect::findings::{FLUTE_EXTRA, FLUTE_MISSING};
use gcode_inspect::flutes::{GrindingPass, Trace};
use gcode_inspect::verify::flutes::{FluteVerdict, describe_kind};
use gcode_lang::units::Deg;
use gcode_part::job::FluteLaw;
use gcode_part::{Flutes, Profile, Total};
use gcode_session::GrindingRun;

/// Builds the view of the program `name`.
pub fn of(name: &str, grinding: &GrindingRun, verdict: &FluteVerdict) -> FluteView {
    let nominal = &grinding.nominal;
    let profile = &nominal.profile;
    let points = |pass: &GrindingPass| {
        pass.trace.samples.iter().map(|sample| flute_point(profile, sample.point)).collect()
    };
    // Every degree of the nose, from its widest circle to the pole.
    let nose = (0..=90).map(|degree| profile.point_at_polar(Deg(90.0 - f64::from(degree))));
    let nose: Vec<[f64; 2]> = nose.map(|at| [at.x, -at.y]).collect();
    let mut outline = nose;
    if 0.0 < nominal.start {
        outline.insert(0, [nominal.start, profile.radius()]);
    }
    let end = profile.point_at_polar(nominal.tip_angle);
    let number = |value: Option<f64>, places: usize| {
        value.map_or("−".to_owned(), |value| format!("{value:.places$}").replace('-', "−"))
    };
    FluteView {
        name: name.to_owned(),
        verdict: drawn_conclusion(&verdict.conclusion()),
        lines: [
            format!("Law: {}, {}° on the cylinder", verdict.law, verdict.helix),
            format!(
                "Helix angle {}° to {}°, largest deviation from the law on pass {}",
                number(verdict.helix_min, 2),
                number(verdict.helix_max, 2),
                verdict.course_pass
            ),
            format!(
                "Contact deviation from the surface: at most {} mm",
                number(verdict.surface_deviation, 4)
            ),
        ]
        .into_iter()
        .chain(assumption_lines(&verdict.assumptions, Total::Flutes(verdict.passes)))
        .collect(),
        outline,
        tip_radius: -end.y,
        flutes: grinding.result.passes.iter().map(points).collect(),
        faults: faults(profile, verdict),
        helix: helix_courses(grinding, verdict),
    }
}

fn flute_point(profile: &Profile, at: Point3<f64>) -> FlutePoint {
    FlutePoint { position: at.coords.into(), normal: profile.normal(&at).into_inner().into() }
}

/// Returns the sites of the findings; several at one site of a pass are merged.
fn faults(profile: &Profile, verdict: &FluteVerdict) -> Vec<Fault> {
    let mut faults: Vec<Fault> = Vec::new();
    for finding in &verdict.findings {
        for (index, site) in finding.sites.iter().enumerate() {
            let what = if index == 0 { describe_kind(finding.kind) } else { None };
            let (spot, pass) = (flute_point(profile, site.at.into()), site.pass.map(|pass| pass - 1));
            let is_here = |fault: &&mut Fault| fault.pass == pass && fault.point.position == spot.position;
            if let Some(fault) = faults.iter_mut().find(is_here) {
                fault.labels.extend(what);
                continue;
            }
            let standing = match finding.kind {
                kind if kind == &FLUTE_MISSING => HoleStatus::Missing,
                kind if kind == &FLUTE_EXTRA => HoleStatus::Extra,
                _ => HoleStatus::Bad,
            };
            faults.push(Fault { point: spot, pass, status: standing, labels: what.into_iter().collect() });
        }
    }
    faults
}

/// Polar angles marked along the nose; the tip angle follows.
const NAMED_ANGLES: [f64; 6] = [90.0, 75.0, 60.0, 45.0, 30.0, 15.0];

/// Returns the helix angle along every flute over the distance from the shank's end.
fn helix_courses(grinding: &GrindingRun, verdict: &FluteVerdict) -> HelixCourses {
    let nominal = &grinding.nominal;
    let other = match nominal.law {
        FluteLaw::ConstantHelix => FluteLaw::Published,
        FluteLaw::Published => FluteLaw::ConstantHelix,
    };
    let lengths = nose_lengths(nominal);
    let tip = nominal.tip_angle.0;
    let nearest = |polar: f64| {
        let off = |one: &(Deg, f64)| (one.0.0 - polar).abs();
        lengths.iter().min_by(|one, other| off(one).total_cmp(&off(other))).map(|(_, length)| *length)
    };
    let nose = NAMED_ANGLES.into_iter().filter(|polar| tip + 5.0 < *polar).chain([tip]);
    let at = |length: f64, polar: Deg| {
        let [own, other] = [nominal.law, other].map(|law| nominal.helix_angle(law, polar).0);
        HelixPoint { path_length: length, actual: own, nominal: own, other_law: other }
    };
    let shank = (0.0 < nominal.start).then(|| at(0.0, Deg(90.0)));
    HelixCourses {
        passes: grinding.result.passes.iter().map(|pass| course(nominal, pass)).collect(),
        worst_pass: verdict.course_pass - 1,
        tolerance: nominal.helix_tolerance.0,
        laws: [nominal.law.name(), other.name()],
        nominal: shank.into_iter().chain(lengths.iter().map(|(polar, length)| at(*length, *polar))).collect(),
        nose: nose.filter_map(|polar| Some((nearest(polar)?, format!("{polar}°")))).collect(),
    }
}

/// Returns the distance from the shank's end along the nose by polar angle, every half degree and at the tip
/// angle.
fn nose_lengths(nominal: &Flutes) -> Vec<(Deg, f64)> {
    let tip = nominal.tip_angle;
    let halves = (0..=180).map(|half| Deg(90.0 - f64::from(half) / 2.0)).filter(|polar| tip < *polar);
    let mut length = nominal.start;
    let mut before = nominal.profile.point_at_polar(Deg(90.0));
    halves
        .chain([tip])
        .map(|polar| {
            let here = nominal.profile.point_at_polar(polar);
            length += (here - before).norm();
            before = here;
            (polar, length)
        })
        .collect()
}

/// Returns the helix angles of a pass by distance, whatever its direction.
fn course(nominal: &Flutes, pass: &GrindingPass) -> Vec<HelixPoint> {
    let begins = from_shank(nominal, &pass.trace);
    let windows = pass.trace.windows(nominal.gauge);
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
fn from_shank(nominal: &Flutes, trace: &Trace) -> f64 {
    let first = trace.samples.iter().max_by(|one, other| one.point.x.total_cmp(&other.point.x));
    first.map_or(0.0, |first| nominal.start - first.point.x - first.along)
}
