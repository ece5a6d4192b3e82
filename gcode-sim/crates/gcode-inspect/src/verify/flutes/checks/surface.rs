//! Contact on the tooth bottom, between the programmed points too.
use super::super::cause::Cause;
use super::*;
use crate::findings::FLUTE_SURFACE;
use crate::flutes::ROUNDING_ERROR;

pub(super) fn check<'g>(inspection: &Inspection<'g>, findings: &mut Vec<Diagnostic>) {
    let tolerance = inspection.nominal.surface_tolerance;
    let worst_of = |(index, pass): (usize, &'g GrindingPass)| {
        let samples = pass.trace.samples.iter();
        let worst = samples.max_by(|a, b| a.deviation.abs().total_cmp(&b.deviation.abs()))?;
        (tolerance + ROUNDING_ERROR < worst.deviation.abs()).then_some((index, worst))
    };
    let passes = &inspection.actual.passes;
    let mut wrong: Vec<(usize, &Sample)> = passes.iter().enumerate().filter_map(worst_of).collect();
    wrong.sort_by(|a, b| b.1.deviation.abs().total_cmp(&a.1.deviation.abs()));
    let Some((pass, worst)) = wrong.first().copied() else { return };
    let sites = wrong.iter().map(|(pass, sample)| Site::new(Some(*pass), sample.point));
    let backtrace = passes[pass].trace.backtrace(worst).clone();
    findings.push(surface_finding(inspection, pass, worst).with_backtrace(backtrace).with_sites(sites));
}

fn surface_finding(inspection: &Inspection<'_>, pass: usize, worst: &Sample) -> Diagnostic {
    let nominal = inspection.nominal;
    let (tolerance, radius) = (nominal.surface_tolerance, nominal.profile.radius());
    let error = |message: String| Diagnostic::new(&FLUTE_SURFACE, message);
    let (side, off) = (if worst.deviation < 0.0 { "below" } else { "above" }, worst.deviation.abs());
    if let Some(height) = inspection.common_height {
        return error(format!(
            "{} ground to a diameter of {:.3} mm, nominal {:.3} mm: the contact is {:.4} mm {side} \
             the tooth bottom all along, tolerance {tolerance} mm",
            inspection.all_flutes("are", "is"),
            2.0 * (radius + height),
            2.0 * radius,
            height.abs()
        ))
        .help("check Y where the wheel is fed into the blank, the work offset in Y, and wheel.contact in the machine file");
    }
    let finding = error(format!(
        "the contact is {off:.4} mm {side} the tooth bottom at polar angle {:.1}°: tolerance {tolerance} mm",
        worst.polar.0
    ));
    match Cause::of(nominal, &inspection.actual.passes[pass], off) {
        Cause::BetweenPoints => finding
            .note("the deviation is less than half of this at the programmed points: it arises between them")
            .help("use shorter moves, or a finer increment: the present ones are too coarse for this chord error"),
        Cause::Depth(depth) => finding
            .note(format!(
                "the contact is {:.4} mm {side} the tooth bottom all along {}, at the programmed points too",
                depth.abs(),
                inspection.pass_name(pass)
            ))
            .help("check Y where the wheel is fed into the blank"),
        Cause::Offset([x, y]) => {
            let [from_x, from_y] = inspection.actual.offset.unwrap_or(nominal.c_offset);
            finding
                .note(format!(
                    "the deviation is present at the programmed points too, as if the end of the cylinder \
                     were at X{:.3} Y{:.3} from the C axis instead of X{from_x} Y{from_y}: X{x:+.3} Y{y:+.3}",
                    from_x + x,
                    from_y + y
                ))
                .help("check the numbers from which the program computes X and Y while C rotates (I and J \
                       of the call), and c_offset")
        }
        Cause::Other => finding.help(
            "check the sign of each axis, the formula for Y, and c_offset against the machine file's \
             part.origin: X and Y do not keep the arc's centre in place while C rotates",
        ),
    }
}
