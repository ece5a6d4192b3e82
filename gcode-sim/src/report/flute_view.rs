//! Contents of a burr's pictures: its outline, the ground flutes, and the helix angle along them.
use nalgebra::Point3;

use super::helix_courses;
use gcode_draw::{Fault, FlutePoint, FluteView, HoleStatus};
use gcode_inspect::findings::{FLUTE_EXTRA, FLUTE_MISSING};
use gcode_inspect::flutes::GrindingPass;
use gcode_inspect::verify::Answer;
use gcode_inspect::verify::flutes::{FluteVerdict, describe_kind};
use gcode_lang::units::Deg;
use gcode_part::Profile;
use gcode_session::GrindingRun;

/// Builds the view of the program `name`.
pub fn of(name: &str, grinding: &GrindingRun, verdict: &FluteVerdict) -> FluteView {
    let wanted = &grinding.nominal;
    let profile = &wanted.profile;
    let points = |pass: &GrindingPass| {
        pass.trace.samples.iter().map(|sample| flute_point(profile, sample.point)).collect()
    };
    // Every degree of the nose, from its widest circle to the pole.
    let nose = (0..=90).map(|degree| profile.point_at_polar(Deg(90.0 - f64::from(degree))));
    let nose: Vec<[f64; 2]> = nose.map(|at| [at.x, -at.y]).collect();
    let mut outline = nose;
    if 0.0 < wanted.start {
        outline.insert(0, [wanted.start, profile.radius()]);
    }
    let end = profile.point_at_polar(wanted.tip_angle);
    let number = |value: Option<f64>, places: usize| {
        value.map_or("−".to_owned(), |value| format!("{value:.places$}").replace('-', "−"))
    };
    FluteView {
        name: name.to_owned(),
        verdict: match verdict.verdict {
            Answer::Pass => (HoleStatus::Good, format!("PASS: {}", verdict.sentence())),
            Answer::Fail => (HoleStatus::Bad, format!("FAIL: {}", verdict.sentence())),
        },
        lines: vec![
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
        ],
        outline,
        tip_radius: -end.y,
        flutes: grinding.result.passes.iter().map(points).collect(),
        faults: faults(profile, verdict),
        helix: helix_courses::of(grinding, verdict),
    }
}

fn flute_point(profile: &Profile, at: Point3<f64>) -> FlutePoint {
    FlutePoint { position: at.coords.into(), normal: profile.normal(&at).into_inner().into() }
}

/// Returns the places of the findings; several at one place of a pass are merged.
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
