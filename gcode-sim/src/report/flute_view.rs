//! What the pictures of a burr show: its outline, the flutes that were ground, and the helix angle along one.
use nalgebra::Point3;

use super::helix_courses;
use crate::flutes::Pass;
use crate::part::profile::Profile;
use crate::picture::{Fault, FluteView, Spot, Standing};
use crate::session::Grinding;
use crate::units::Deg;
use crate::verify::Answer;
use crate::verify::flutes::{FluteVerdict, in_words};

/// Of the program `name`.
pub fn of(name: &str, grinding: &Grinding, verdict: &FluteVerdict) -> FluteView {
    let wanted = &grinding.wanted;
    let profile = &wanted.profile;
    let spot = |at: Point3<f64>| Spot { at: at.coords.into(), out: profile.normal(&at).into_inner().into() };
    let spots = |pass: &Pass| pass.trace.samples.iter().map(|sample| spot(sample.at)).collect();
    // Every degree of the nose from its widest to the pole.
    let nose = (0..=90).map(|degree| profile.at_polar(Deg(90.0 - f64::from(degree))));
    let nose: Vec<[f64; 2]> = nose.map(|at| [at.x, -at.y]).collect();
    let mut outline = nose;
    if 0.0 < wanted.start {
        outline.insert(0, [wanted.start, profile.radius()]);
    }
    let end = profile.at_polar(wanted.tip_angle);
    let number = |value: Option<f64>, places: usize| {
        value.map_or("−".to_owned(), |value| format!("{value:.places$}").replace('-', "−"))
    };
    FluteView {
        name: name.to_owned(),
        verdict: match verdict.verdict {
            Answer::Pass => (Standing::Good, format!("PASS: {}", verdict.sentence())),
            Answer::Fail => (Standing::Bad, format!("FAIL: {}", verdict.sentence())),
        },
        lines: vec![
            format!("Law: {}, {}° on the cylinder", verdict.law, verdict.helix),
            format!(
                "Helix angle {}° to {}°, largest deviation from the law on pass {}",
                number(verdict.helix_min, 2),
                number(verdict.helix_max, 2),
                verdict.along_pass
            ),
            format!(
                "Contact deviation from the surface: at most {} mm",
                number(verdict.surface_deviation, 4)
            ),
        ],
        outline,
        tip_radius: -end.y,
        flutes: grinding.ground.passes.iter().map(spots).collect(),
        faults: faults(profile, verdict),
        helix: helix_courses::of(grinding, verdict),
    }
}

fn spot(profile: &Profile, at: Point3<f64>) -> Spot {
    Spot { at: at.coords.into(), out: profile.normal(&at).into_inner().into() }
}

/// Where the findings are; several in one place of a pass are one.
fn faults(profile: &Profile, verdict: &FluteVerdict) -> Vec<Fault> {
    let mut faults: Vec<Fault> = Vec::new();
    for finding in &verdict.findings {
        for (index, site) in finding.sites.iter().enumerate() {
            let what = if index == 0 { in_words(&finding.code) } else { None };
            let (spot, pass) = (spot(profile, site.at.into()), site.pass.map(|pass| pass - 1));
            let is_here = |fault: &&mut Fault| fault.pass == pass && fault.spot.at == spot.at;
            if let Some(fault) = faults.iter_mut().find(is_here) {
                fault.what.extend(what);
                continue;
            }
            let standing = match finding.code.as_str() {
                "flute-missing" => Standing::Missing,
                "flute-extra" => Standing::Extra,
                _ => Standing::Bad,
            };
            faults.push(Fault { spot, pass, standing, what: what.into_iter().collect() });
        }
    }
    faults
}
