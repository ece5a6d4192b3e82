//! What the pictures of a burr show: its outline, the flutes that were ground, and the helix angle along one.
use crate::job::FluteLaw;
use crate::picture::{FluteView, Spot, Standing};
use crate::session::Grinding;
use crate::units::Deg;
use crate::verify::Answer;
use crate::verify::flutes::FluteVerdict;

/// Of the program `name`.
pub fn of(name: &str, grinding: &Grinding, verdict: &FluteVerdict) -> FluteView {
    let wanted = &grinding.wanted;
    let profile = &wanted.profile;
    let spots = |pass: &crate::flutes::Pass| {
        let spot = |at: nalgebra::Point3<f64>| Spot {
            at: at.coords.into(),
            out: profile.normal(&at).into_inner().into(),
        };
        pass.trace.samples.iter().map(|sample| spot(sample.at)).collect()
    };
    // Every degree of the nose from its widest to the pole.
    let nose = (0..=90).map(|degree| profile.at_polar(Deg(90.0 - f64::from(degree))));
    let nose: Vec<[f64; 2]> = nose.map(|at| [at.x, -at.y]).collect();
    let mut outline = nose;
    if 0.0 < wanted.start {
        outline.insert(0, [wanted.start, profile.radius()]);
    }
    let end = profile.at_polar(wanted.tip_angle);
    let law = |law: FluteLaw| {
        let polar = (0..=180).map(|half| f64::from(half) / 2.0).filter(|polar| wanted.tip_angle.0 <= *polar);
        polar.map(|polar| [polar, wanted.angle(law, Deg(polar)).0]).collect()
    };
    let number =
        |value: Option<f64>, places: usize| value.map_or("-".to_owned(), |value| format!("{value:.places$}"));
    FluteView {
        name: name.to_owned(),
        verdict: match verdict.verdict {
            Answer::Pass => (Standing::Good, format!("PASS: {}", verdict.sentence())),
            Answer::Fail => (Standing::Bad, format!("FAIL: {}", verdict.sentence())),
        },
        lines: vec![
            format!("Law: {}, {}° on the cylinder", verdict.law, verdict.helix),
            format!(
                "Helix angle {}° to {}°, farthest from the law on pass {}",
                number(verdict.helix_min, 2),
                number(verdict.helix_max, 2),
                verdict.along_pass
            ),
            format!("Contact off the surface: {} mm at most", number(verdict.surface_deviation, 4)),
        ],
        outline,
        tip_radius: -end.y,
        flutes: grinding.ground.passes.iter().map(spots).collect(),
        measured: verdict.along.iter().map(|angles| [angles.polar.0, angles.helix.0]).collect(),
        constant_helix: law(FluteLaw::ConstantHelix),
        published: law(FluteLaw::Published),
    }
}
