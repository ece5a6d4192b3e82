//! Threads: the hole is drilled deeper than its thread, before it, and no wider than the thread leaves metal; feed and speed
//! give the pitch, and the spindle the hand.
use super::features::{Judgement, ShapeGap, drilled_depths};
use super::tap_motion::{self, CORE_SHARE, MAX_STEP, THREAD_DEPTH};
use super::*;
use crate::findings::{FEATURE_DEPTH, HOLE_ROUNDNESS, TAP_DRILL, TAP_HAND, TAP_PITCH};
use crate::holes::{Helix, PITCH_TOLERANCE};
use crate::machine::PointShape;
use crate::verify::hole_cuts::{Cut, assign};
use crate::verify::outline::{CutShape, Outline};
use gcode_lang::motion::SpindleDirection;
use gcode_part::{Feature, FeatureKind, Hand, NOISE, POINT_LENGTH};

/// Largest deviation of a milled turn from the pitch, mm: half the least increment in inches, for 1/18 in is commanded as
/// .0556.
pub(super) const LEAD_TOLERANCE: f64 = 0.00127;

/// Turns that a comb mill makes at most without a step: one, and its lead-in and lead-out.
const MAX_COMB_TURNS: f64 = 2.0;

/// Adds the findings on the threads of a hole, from both sides of a through hole. `on_axis` are the cuts of other holes of the list on
/// the same axis that are made before.
pub(super) fn judge<'c>(judged: &mut Judgement<'c>, on_axis: &[Cut<'c>]) {
    let nominal = judged.nominal.from_far_side();
    let mut findings = Vec::new();
    for cut in judged.near.iter().filter(|cut| cut.is_thread()) {
        let earlier = [on_axis, &judged.voids_before(judged.nominal, cut)].concat();
        findings.extend(drilled_depth(judged, cut, (&judged.near, &judged.far), &earlier));
    }
    for cut in judged.far.iter().filter(|cut| cut.is_thread()) {
        let earlier = judged.voids_before(&nominal, cut);
        findings.extend(drilled_depth(judged, cut, (&judged.far, &judged.near), &earlier));
    }
    judged.findings.extend(findings);
    judge_side(judged);
    let Judgement { comparison, index, id, .. } = *judged;
    let (near, far) = (judged.far.clone(), judged.near.clone());
    let mut from_far_side = Judgement {
        comparison,
        index,
        nominal: &nominal,
        id,
        near,
        far,
        followers: Vec::new(),
        blank: judged.blank,
        findings: Vec::new(),
        gaps: Vec::new(),
    };
    judge_side(&mut from_far_side);
    let Judgement { findings, gaps, .. } = from_far_side;
    judged.findings.extend(findings);
    judged.gaps.extend(gaps);
}

/// Adds the findings on the threads that are cut from the side of the entry.
fn judge_side(judged: &mut Judgement<'_>) {
    if !judged.near.iter().any(Cut::is_thread) {
        return;
    }
    let (nominal, id) = (judged.nominal, judged.id);
    let mut findings = Vec::new();
    let width = judged.comparison.tolerances.diameter;
    findings
        .extend((0..judged.near.len()).find_map(|cut| drilled_after(nominal, id, &judged.near, cut, width)));
    judged.gaps.extend(open_depths(&judged.near));
    let voids = judged.near.iter().filter(|cut| cut.is_thread()).map(|cut| judged.voids_before(nominal, cut));
    let before = voids.max_by_key(Vec::len).unwrap_or_default();
    let wide: Vec<WideCut> =
        before.iter().chain(&judged.near).filter_map(|cut| wide_cut(judged, cut)).collect();
    for cut in wide {
        match cut {
            WideCut::Fault(finding) => findings.push(finding),
            WideCut::SpotDrill(tool) => judged.gaps.push(ShapeGap::SpotDrill(tool)),
        }
    }
    findings.extend(out_of_step(id, &judged.near));
    findings.extend(tap_motion::out_of_step(id, &judged.near));
    let made_by = assign(&nominal.features, &judged.near, judged.comparison.tolerances);
    for (feature, cut) in nominal.features.iter().zip(made_by).filter(|(one, _)| one.kind == FeatureKind::Tap)
    {
        let Some(cut) = cut.map(|cut| &judged.near[cut]) else { continue };
        let turns = turns(judged, feature, cut);
        let faults = [
            turns.iter().find_map(|cut| pitch(id, feature, cut)),
            turns.iter().find_map(|cut| tap_motion::uneven_retract(judged, Some(feature.diameter), cut)),
            tap_motion::narrow(judged, feature, cut),
            turns.iter().find_map(|cut| hand(id, feature, cut)),
            turns.iter().find_map(|cut| tapered(id, cut, width)),
        ];
        let is_even = faults.iter().all(Option::is_none);
        findings.extend(faults.into_iter().flatten());
        match milled_length(judged, feature, cut).filter(|_| is_even) {
            Some(MilledLength::Fault(finding)) => findings.push(finding),
            Some(MilledLength::Comb) => judged.gaps.push(ShapeGap::ThreadLength(cut.pass.tool)),
            None => {}
        }
    }
    if stated_threads(nominal).is_empty() {
        let taps = judged.near.iter().filter(|cut| cut.is_thread() && cut.thread.is_none());
        findings.extend(taps.filter_map(|tap| tap_motion::uneven_retract(judged, tap.pass.diameter, tap)));
    }
    judged.findings.extend(findings);
}

/// Returns the drills whose unknown points decide whether they are deep enough for a thread: their tips are deeper than the tap,
/// and with points of 118° their full diameters are not.
fn open_depths(cuts: &[Cut<'_>]) -> Vec<ShapeGap> {
    let taps = cuts.iter().filter(|cut| cut.is_thread()).map(|cut| cut.tip);
    let Some(thread) = taps.reduce(f64::max) else { return Vec::new() };
    let drills = || cuts.iter().filter(|cut| !cut.is_thread());
    let full = |cut: &Cut<'_>| {
        let diameter = cut.pass.diameter.unwrap_or(0.0);
        cut.full_depth(diameter).unwrap_or(cut.tip - POINT_LENGTH * diameter)
    };
    if drills().map(full).any(|full| thread < full) {
        return Vec::new();
    }
    let is_open = |cut: &&Cut<'_>| cut.point == PointShape::Unknown && thread < cut.tip;
    drills().filter(is_open).map(|cut| ShapeGap::FullDepth(cut.pass.tool)).collect()
}

/// Judgement of a cut that leaves too little metal for a thread.
enum WideCut {
    Fault(Diagnostic),
    /// Taken for a spot drill, the tool leaves enough.
    SpotDrill(Option<u32>),
}

/// Judges a cut that is wider than the hole that the reference has for a thread. Without one the limit is the thread's diameter
/// less half its pitch, the hole for a forming tap.
fn wide_cut(judged: &Judgement<'_>, cut: &Cut<'_>) -> Option<WideCut> {
    let diameter = cut.pass.diameter.filter(|_| !cut.is_thread())?;
    let (core, bottom) = core(judged)?;
    let excess = |full: f64| {
        let (radius, tip) = (diameter / 2.0, full.min(bottom));
        let shape = CutShape { radius, path: 0.0, start: cut.start, tip, point: PointShape::Flat };
        if tip <= cut.start.max(0.0) { 0.0 } else { -2.0 * core.margin(&shape) }
    };
    let is_wide = |full: f64| exceeds(excess(full), judged.comparison.tolerances.diameter);
    let full = cut.full_depth(diameter).unwrap_or_else(|| judged.unknown_full_depth(cut, diameter));
    // A list that describes no feature may have left out the mouth of the hole.
    let may_be_mouth =
        judged.nominal.features.is_empty() && judged.nominal.diameter.is_none() && full < bottom * CORE_SHARE;
    if may_be_mouth || !is_wide(full) {
        let is_spot_drill = cut.kind.is_none() && cut.point == PointShape::Unknown && is_wide(cut.tip);
        return is_spot_drill.then_some(WideCut::SpotDrill(cut.pass.tool));
    }
    let made = match cut.is_void {
        true => format!("is {full:.3} mm deep"),
        false => format!("cuts {full:.3} mm deep at its full diameter"),
    };
    let message = format!(
        "hole {}: {} {made}, {:.3} mm wider than the hole for the thread",
        judged.id,
        cut.name(),
        excess(full)
    );
    let finding = Diagnostic::new(&TAP_DRILL, message).with_backtrace(cut.pass.backtrace.clone());
    Some(WideCut::Fault(
        finding.help("use the tapping drill: where the metal is cut away there is no thread"),
    ))
}

/// Returns the outline of a hole without its threads, and the depth of the deepest thread; `None` without a thread of known
/// diameter.
fn core(judged: &Judgement<'_>) -> Option<(Outline, f64)> {
    let Judgement { nominal, comparison, near, .. } = judged;
    let slack = comparison.tolerances.depth;
    let stated = stated_threads(nominal);
    let threads = match stated[..] {
        [] => {
            let size = |cut: &Cut<'_>| {
                let pitch = cut.pass.cut.feed.map_or(0.0, |feed| feed.0 / cut.pass.cut.speed.0);
                Some((cut.pass.diameter?, pitch, cut.tip))
            };
            near.iter().filter(|cut| cut.is_thread()).filter_map(size).collect()
        }
        _ => stated,
    };
    let deepest = threads.iter().map(|(.., bottom)| *bottom).reduce(f64::max)?;
    Some((Outline::of_core(nominal, &threads, slack)?, deepest))
}

/// Returns diameter, pitch and bottom of the threads that the reference has in a hole.
pub(super) fn stated_threads(nominal: &Hole) -> Vec<(f64, f64, f64)> {
    let threads = nominal.features.iter().filter(|feature| feature.kind == FeatureKind::Tap);
    threads.map(|one| (one.diameter, one.pitch.unwrap_or(0.0), one.bottom())).collect()
}

/// Reports a thread that the spindle cuts with the wrong hand, or a tap of the other hand.
fn hand(id: &str, feature: &Feature, cut: &Cut<'_>) -> Option<Diagnostic> {
    let (own, remedy) = match (cut.thread, cut.pass.cut.direction) {
        (Some(Helix { lead, .. }), _) => {
            (if lead < 0.0 { Hand::Left } else { Hand::Right }, "mill it in the other sense")
        }
        (None, SpindleDirection::Clockwise) => (Hand::Right, "tap with G74"),
        (None, SpindleDirection::Counterclockwise) => (Hand::Left, "tap with G84"),
        (None, SpindleDirection::Off) => return None,
    };
    let name = |hand| if hand == Hand::Left { "left-hand" } else { "right-hand" };
    let nominal = name(feature.hand);
    let (message, remedy) = match cut.hand.filter(|_| cut.thread.is_none()) {
        _ if own != feature.hand => {
            (format!("cuts a {} thread, nominal {nominal}", name(own)), remedy.to_owned())
        }
        Some(tap) if tap != feature.hand => {
            let word = if feature.hand == Hand::Left { "left" } else { "right" };
            let remedy = format!("use a {nominal} tap, with hand = \"{word}\" in the machine file");
            (format!("is a {} tap, nominal {nominal}", name(tap)), remedy)
        }
        _ => return None,
    };
    let message = format!("hole {id}: {} {message}", cut.name());
    let finding = Diagnostic::new(&TAP_HAND, message).with_backtrace(cut.pass.backtrace.clone());
    Some(finding.help(format!("{remedy}, or correct the hand of the thread in the reference")))
}

/// Reports a thread that ends no higher than what is drilled before it, from its side and from the other one; `earlier` is there
/// before all of them. A thread in a hole that the program doesn't drill is left open.
fn drilled_depth(
    judged: &Judgement<'_>,
    tap: &Cut<'_>,
    (cuts, others): (&[Cut<'_>], &[Cut<'_>]),
    earlier: &[Cut<'_>],
) -> Option<Diagnostic> {
    if !cuts.iter().chain(others).chain(earlier).any(|cut| !cut.is_thread()) {
        return None;
    }
    let (nominal, id) = (judged.nominal, judged.id);
    let depth = |cut: &Cut<'_>| cut.full_depth(nominal.diameter.unwrap_or(0.0)).unwrap_or(cut.tip);
    let deepest = |cuts: &[Cut<'_>]| {
        cuts.iter().filter(|cut| !cut.is_thread() && tap.follows(cut)).map(depth).fold(0.0, f64::max)
    };
    let (drilled, from_other_side) = (deepest(cuts).max(deepest(earlier)), deepest(others));
    // A mill needs no room below the thread.
    let room = if tap.thread.is_some() { -NOISE } else { NOISE };
    if judged.is_drilled_through(drilled, from_other_side) || tap.tip + room < drilled {
        return None;
    }
    let verb = if tap.thread.is_some() { "mills a thread" } else { "taps" };
    let message = format!(
        "hole {id}: {} {verb} {:.3} mm deep where {} are drilled before it",
        tap.name(),
        tap.tip,
        drilled_depths(drilled, from_other_side)
    );
    let finding = Diagnostic::new(&TAP_DRILL, message).with_backtrace(tap.pass.backtrace.clone());
    Some(finding.help(
        "drill deeper than the thread, before the tap, by the point of the drill and the lead of the tap",
    ))
}

/// Reports a thread in a hole that is drilled to its width only afterwards.
fn drilled_after(
    nominal: &Hole,
    id: &str,
    cuts: &[Cut<'_>],
    index: usize,
    tolerance: f64,
) -> Option<Diagnostic> {
    let tap = cuts.get(index).filter(|cut| cut.is_thread())?;
    let is_core = |cut: &&Cut<'_>| {
        let full = cut.full_depth(nominal.diameter.unwrap_or(0.0)).unwrap_or(cut.tip);
        !cut.is_thread() && CORE_SHARE * tap.tip <= full
    };
    let width = |cut: &Cut<'_>| cut.pass.diameter;
    let before = cuts[..index]
        .iter()
        .filter(is_core)
        .map(width)
        .try_fold(0.0_f64, |most, own| Some(most.max(own?)))?;
    let is_wider = |cut: &&Cut<'_>| width(cut).is_some_and(|own| exceeds(own - before, tolerance));
    let after = cuts[index + 1..].iter().filter(is_core).find(is_wider).filter(|_| 0.0 < before)?;
    let verb = if tap.thread.is_some() { "mills a thread" } else { "taps" };
    let message = format!(
        "hole {id}: {} {verb} where Φ{before} is drilled before it, and {} follows",
        tap.name(),
        after.name()
    );
    let finding = Diagnostic::new(&TAP_DRILL, message).with_backtrace(tap.pass.backtrace.clone());
    Some(finding.help("drill the hole for the thread to its width before the thread"))
}

/// Reports a thread whose feed per revolution is not the pitch.
fn pitch(id: &str, feature: &Feature, cut: &Cut<'_>) -> Option<Diagnostic> {
    let nominal = feature.pitch?;
    if let Some(helix) = cut.thread {
        return milled_pitch(id, nominal, cut, &helix);
    }
    // The feed that is farther off decides: each cuts a part of the thread.
    let last = (cut.pass.cut.feed?, cut.pass.cut.speed);
    let feeds = cut.pass.cut.extremes.unwrap_or([last; 2]).map(|(feed, speed)| (feed.0, speed.0));
    let off = |(feed, speed): &(f64, f64)| (feed / speed - nominal).abs();
    let (feed, speed) = feeds.into_iter().max_by(|one, other| off(one).total_cmp(&off(other)))?;
    let actual = feed / speed;
    if !exceeds((actual - nominal).abs(), PITCH_TOLERANCE * nominal) {
        return None;
    }
    let message = format!(
        "hole {id}: {} feeds {}, the pitch is {}",
        cut.name(),
        tap_motion::feed_words(feed, speed),
        cutting::to_places(nominal)
    );
    let finding = Diagnostic::new(&TAP_PITCH, message).with_backtrace(cut.pass.backtrace.clone());
    Some(finding.help(format!(
        "command a feed of {} mm/min at S{speed}, or correct the pitch",
        cutting::round_thousandth(nominal * speed)
    )))
}

/// Returns the cuts that make a thread: the one that makes it whole, and all taps and helices that cut its flanks.
fn turns<'c>(judged: &Judgement<'c>, feature: &Feature, made: &Cut<'c>) -> Vec<Cut<'c>> {
    let minor = feature.diameter - THREAD_DEPTH * feature.pitch.unwrap_or(feature.diameter);
    let is_single = stated_threads(judged.nominal).len() == 1;
    let is_turn = |cut: &&Cut<'_>| {
        std::ptr::eq(cut.pass.backtrace, made.pass.backtrace)
            || is_single && cut.is_thread() && cut.pass.diameter.is_none_or(|own| minor < own)
    };
    judged.near.iter().filter(is_turn).copied().collect()
}

/// Reports a milled thread with a turn that is not as high as its pitch.
fn milled_pitch(id: &str, nominal: f64, cut: &Cut<'_>, helix: &Helix) -> Option<Diagnostic> {
    let is_off = |lead: &f64| exceeds((lead - nominal).abs(), LEAD_TOLERANCE);
    let lead = helix.uneven_lead.into_iter().chain([helix.lead]).map(f64::abs).find(is_off)?;
    let pitch = cutting::to_places(nominal);
    let message =
        format!("hole {id}: {} goes {lead:.4} mm along the axis in a turn, the pitch is {pitch}", cut.name());
    let finding = Diagnostic::new(&TAP_PITCH, message).with_backtrace(cut.pass.backtrace.clone());
    Some(finding.help(format!("command a turn of {pitch} mm, or correct the pitch")))
}

/// Reports a milled thread whose turns are not as wide as its last one, or not in its place.
fn tapered(id: &str, cut: &Cut<'_>, limit: f64) -> Option<Diagnostic> {
    let wander = cut.thread?.wander;
    let message = format!(
        "hole {id}: {} mills turns that are up to {wander:.3} mm off the circle of the last one, limit {limit}",
        cut.name()
    );
    let finding = Diagnostic::new(&HOLE_ROUNDNESS, message).with_backtrace(cut.pass.backtrace.clone());
    exceeds(wander, limit).then(|| {
        finding.help("mill all turns of a thread on one circle: check I and J, and the ends of the arcs")
    })
}

/// Reports passes along a thread that cut beside each other.
fn out_of_step(id: &str, cuts: &[Cut<'_>]) -> Option<Diagnostic> {
    let helices = || cuts.iter().filter_map(|cut| Some((cut, cut.thread?)));
    let (first, one) = helices().next()?;
    helices().skip(1).find_map(|(cut, helix)| {
        let lead = one.lead.abs();
        let off = (helix.phase - one.phase).rem_euclid(lead);
        let off = off.min(lead - off);
        // Another lead has its own finding.
        let is_even = helix.uneven_lead.is_none() && one.uneven_lead.is_none();
        let is_alike = is_even && !exceeds((helix.lead - one.lead).abs(), LEAD_TOLERANCE);
        if !is_alike || !exceeds(off, MAX_STEP) {
            return None;
        }
        let message = format!(
            "hole {id}: {} follows the thread {off:.3} mm beside the pass of {}, limit {MAX_STEP}",
            cut.name(),
            first.name().trim_end_matches(',')
        );
        let finding = Diagnostic::new(&TAP_PITCH, message).with_backtrace(cut.pass.backtrace.clone());
        Some(finding.help("begin each pass at the same angle, or higher by its part of the pitch"))
    })
}

/// Judgement of a milled thread that is not cut all along.
enum MilledLength {
    Fault(Diagnostic),
    /// In one turn a comb mill cuts more than the turn.
    Comb,
}

/// Judges how far the helices of full width cover a milled thread, which begins at the entry, below wider features, or less than half
/// a turn deeper: the tooth of a mill is above its tip. A narrower turn above them leaves metal in the thread.
fn milled_length(judged: &Judgement<'_>, feature: &Feature, made: &Cut<'_>) -> Option<MilledLength> {
    let lead = made.thread?.lead.abs();
    let tolerances = judged.comparison.tolerances;
    let widest = widest_path(judged, made);
    let is_whole = |cut: &Cut<'_>| {
        let path = cut.pass.cut.milled.map_or(0.0, |circle| circle.radius);
        cut.pass.diameter.is_some() || !exceeds(2.0 * (widest - path), tolerances.diameter)
    };
    let is_full = |cut: &&Cut<'_>| cut.mismatch(feature, tolerances).is_some() && is_whole(cut);
    let covered = covered_depths(judged.near.iter().filter(is_full));
    let [top, _] = *covered.first()?;
    let begin = thread_begin(judged.nominal, feature);
    let is_narrow = |cut: &Cut<'_>| {
        let upper = cut.thread.map(|helix| cut.tip - helix.height);
        cut.pass.tool == made.pass.tool
            && !is_full(&cut)
            && upper.is_some_and(|upper| exceeds(top - upper, MAX_STEP) && exceeds(cut.tip - begin, MAX_STEP))
    };
    let narrow = judged.near.iter().find(|cut| is_narrow(cut));
    let limit = begin + lead / 2.0;
    let gap = covered.get(1).filter(|[_, lower]| begin < *lower).map(|[_, lower]| *lower);
    let may_end = narrow.is_none() && !exceeds(top - limit, LEAD_TOLERANCE);
    if gap.is_none() && (may_end || !exceeds(top - begin, MAX_STEP)) {
        return None;
    }
    let own = covered_depths(judged.near.iter().filter(|cut| cut.pass.tool == made.pass.tool));
    if own.iter().all(|[upper, lower]| lower - upper < MAX_COMB_TURNS * lead) {
        return Some(MilledLength::Comb);
    }
    let (id, name) = (judged.id, made.name());
    let (message, cut) = match (gap, narrow) {
        (Some(from), _) => (
            format!("{name} mills no thread from {from:.3} to {top:.3} mm below the entry, limit {MAX_STEP}"),
            made,
        ),
        (None, Some(narrow)) => {
            let name = narrow.name();
            let message = format!(
                "a narrower turn of {name} ends the thread {top:.3} mm below the entry: it leaves metal above"
            );
            (message, narrow)
        }
        (None, None) => {
            let message = format!(
                "the thread by {name} begins {top:.3} mm below the entry, limit {limit:.3} (half a turn below its nominal start at \
                 {begin:.3})"
            );
            (message, made)
        }
    };
    let upper_end = match begin {
        0.0 => "the entry".to_owned(),
        _ => format!("{begin:.3} mm below the entry"),
    };
    let finding = Diagnostic::new(&FEATURE_DEPTH, format!("hole {id}: {message}"))
        .with_backtrace(cut.pass.backtrace.clone());
    Some(MilledLength::Fault(
        finding.help(format!("mill up to {upper_end}, each turn to the diameter of the thread")),
    ))
}

/// Returns the radius of the widest helix of the tool of a cut, mm.
fn widest_path(judged: &Judgement<'_>, made: &Cut<'_>) -> f64 {
    let own = judged.near.iter().filter(|cut| cut.thread.is_some() && cut.pass.tool == made.pass.tool);
    own.filter_map(|cut| Some(cut.pass.cut.milled?.radius)).fold(0.0, f64::max)
}

/// Returns the depth at which a thread begins, below the features above it that are as wide, mm.
fn thread_begin(nominal: &Hole, thread: &Feature) -> f64 {
    let is_as_wide = |other: &&Feature| !std::ptr::eq(*other, thread) && thread.diameter <= other.diameter;
    let bottom = |feature: &Feature| match (feature.kind, feature.angle) {
        (FeatureKind::Countersink, Some(angle)) => {
            (feature.diameter - thread.diameter) / 2.0 / Deg(angle / 2.0).tan()
        }
        _ => feature.bottom(),
    };
    let bottoms = nominal.features.iter().filter(is_as_wide).map(bottom);
    bottoms.filter(|bottom| *bottom < thread.bottom()).fold(0.0, f64::max)
}

/// Returns the depths that some helices cover without a step between them, from the top of each stretch to its bottom, the
/// deepest first.
fn covered_depths<'c>(cuts: impl Iterator<Item = &'c Cut<'c>>) -> Vec<[f64; 2]> {
    let mut spans: Vec<[f64; 2]> =
        cuts.filter_map(|cut| Some([cut.tip - cut.thread?.height, cut.tip])).collect();
    spans.sort_by(|a, b| b[1].total_cmp(&a[1]));
    let mut covered: Vec<[f64; 2]> = Vec::new();
    for [upper, lower] in spans {
        match covered.last_mut() {
            Some(last) if last[0] <= lower + MAX_STEP => last[0] = last[0].min(upper),
            _ => covered.push([upper, lower]),
        }
    }
    covered
}
