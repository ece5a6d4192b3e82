//! Taps: they leave their thread as they came, at its pitch, and the hole before them is wide enough.
use super::features::Judgement;
use super::*;
use crate::findings::{TAP_DRILL, TAP_PITCH};
use crate::verify::hole_cuts::Cut;
use crate::verify::matching::{is_one_run, step_off};
use gcode_lang::motion::SpindleDirection;
use gcode_part::{Feature, FeatureKind, NOISE};

/// Largest distance along the axis between two passes of one thread, mm.
pub(super) const MAX_STEP: f64 = 0.05;

/// Depth of an internal thread by its pitch, in diameter (ISO 724).
pub(super) const THREAD_DEPTH: f64 = 1.082_532;

/// Part of a thread's depth from which on a cut belongs to the hole for the thread, and not to its mouth.
pub(super) const CORE_SHARE: f64 = 0.75;

/// Depth of a Whitworth thread by its pitch, in diameter (ISO 228-1): that of a metric thread, ISO 724, is less.
const WHITWORTH_DEPTH: f64 = 1.280_654;

/// Largest depth of a thread by its pitch, in diameter: the small end of a taper pipe thread.
const MAX_THREAD_DEPTH: f64 = 2.0;

/// Reports a tap that leaves its thread by a rapid, at another feed a revolution than it came in, or without a reversed spindle.
/// `diameter` is that of the thread, if it is known.
pub(super) fn uneven_retract(
    judged: &Judgement<'_>,
    diameter: Option<f64>,
    cut: &Cut<'_>,
) -> Option<Diagnostic> {
    let retract = cut.pass.cut.uneven_retract?;
    let Hole { entry, axis, .. } = judged.nominal;
    let depth = (Point3::from(*entry) - retract.from).dot(&Vector3::from(*axis));
    // Above the entry, and where the hole is wider than the thread, it is free: in its mouth, if the thread's own diameter is unknown.
    let wide = |other: &Cut<'_>| match (other.pass.diameter, diameter) {
        _ if other.is_thread() => None,
        (Some(own), Some(thread)) => (thread <= own).then(|| other.full_depth(own).unwrap_or(other.tip)),
        (_, None) => Some(other.tip).filter(|tip| *tip < cut.tip * CORE_SHARE),
        (None, Some(thread)) => {
            // It makes the feature of the list that ends where its stroke does.
            let ends_there = |feature: &&Feature| {
                let off = (feature.bottom() - other.tip).abs();
                feature.kind != FeatureKind::Tap && !exceeds(off, judged.comparison.tolerances.depth)
            };
            let feature = judged.nominal.features.iter().find(ends_there)?;
            (thread <= feature.diameter).then_some(other.tip)
        }
    };
    let free = judged.near.iter().filter_map(wide).fold(0.0, f64::max);
    if depth <= free + NOISE {
        return None;
    }
    let how = match retract.feed {
        None => "in rapid".to_owned(),
        Some(_) if retract.direction == SpindleDirection::Off => "with the spindle stopped".to_owned(),
        Some(_) if retract.direction == cut.pass.cut.direction => {
            "with the spindle turning inwards".to_owned()
        }
        Some((feed, speed)) => format!("at {}", feed_words(feed.0, speed.0)),
    };
    let message = format!(
        "hole {}: {} leaves its thread {how}, not as it came in: it tears the thread",
        judged.id,
        cut.name()
    );
    let finding = Diagnostic::new(&TAP_PITCH, message).with_backtrace(cut.pass.backtrace.clone());
    Some(finding.help(
        "reverse the spindle and feed out at the feed and the speed of the feed in, or tap with G84 or G74",
    ))
}

/// Reports a stroke of a tap that begins between the threads of its stroke before. It is a warning without rigid tapping, which
/// alone keeps the spindle's angle.
pub(super) fn out_of_step(id: &str, cuts: &[Cut<'_>]) -> Option<Diagnostic> {
    let taps = || cuts.iter().filter(|cut| cut.is_thread() && cut.thread.is_none());
    taps().zip(taps().skip(1)).find_map(|(one, again)| {
        let (before, after) = (&one.pass.cut, &again.pass.cut);
        let is_alike = one.pass.tool == again.pass.tool && before.direction == after.direction;
        let off = step_off(before, after, &again.pass.axis).filter(|off| is_alike && exceeds(*off, MAX_STEP))?;
        let message = format!(
            "hole {id}: {} begins {off:.3} mm out of step with its stroke before, limit {MAX_STEP}: it crosses the thread",
            again.name()
        );
        let finding = Diagnostic::new(&TAP_PITCH, message).with_backtrace(again.pass.backtrace.clone());
        let finding = match is_one_run(before, after) {
            true => finding,
            false => finding
                .with_severity(Severity::Warning)
                .note("without rigid tapping in one run nothing says at which angle the spindle is"),
        };
        Some(finding.help("begin each stroke at the same R, or whole pitches from it"))
    })
}

/// Returns `1.5000 mm a revolution (750 mm/min at S500)`.
pub(super) fn feed_words(feed: f64, speed: f64) -> String {
    format!("{:.4} mm a revolution ({} mm/min at S{speed})", feed / speed, cutting::round_thousandth(feed))
}

/// Reports a tap in a hole that is narrower than the thread's own core: a warning where it may be that of a taper pipe thread.
pub(super) fn narrow<'c>(judged: &Judgement<'c>, feature: &Feature, tap: &Cut<'c>) -> Option<Diagnostic> {
    let pitch = feature.pitch.filter(|_| tap.thread.is_none())?;
    // A wider drill behind the tap has its own finding.
    let drilled = judged.near.iter().filter(|cut| tap.tip * CORE_SHARE <= cut.tip);
    let from_far_side = judged.far.iter().filter(|cut| judged.nominal.depth * CORE_SHARE <= cut.tip);
    let voids = judged.voids_before(judged.nominal, tap);
    let voids = voids.iter().filter(|void| tap.tip * CORE_SHARE <= void.tip);
    let drilled = drilled.chain(from_far_side).filter(|cut| !cut.is_thread()).chain(voids);
    let widths: Option<Vec<f64>> = drilled.map(|cut| cut.pass.diameter).collect();
    let widest = widths?.into_iter().reduce(f64::max)?;
    let missing = |depth: f64| feature.diameter - depth * pitch - widest;
    let tolerance = judged.comparison.tolerances.diameter;
    if !exceeds(missing(WHITWORTH_DEPTH), tolerance) {
        return None;
    }
    let message = format!(
        "hole {}: {} taps where Φ{widest} is drilled: the core of Φ{}×{pitch} is {:.3} mm wider",
        judged.id,
        tap.name(),
        feature.diameter,
        feature.diameter - THREAD_DEPTH * pitch - widest
    );
    let finding = Diagnostic::new(&TAP_DRILL, message).with_backtrace(tap.pass.backtrace.clone());
    let help = "drill the hole for the thread wider: the tap breaks in it";
    Some(match exceeds(missing(MAX_THREAD_DEPTH), tolerance) {
        true => finding.help(help),
        false => finding
            .with_severity(Severity::Warning)
            .note("only a taper pipe thread has so narrow a hole")
            .help(help),
    })
}
