//! Features of each hole: each is made, to its depth, and no tool cuts wider than the hole is.
use super::*;
use crate::findings::{FEATURE_DEPTH, FEATURE_MISSING, HOLE_DEPTH};
use crate::machine::{PointShape, ToolKind};
use crate::verify::followers::Follower;
use crate::verify::hole_cuts::{Cut, assign, deepest_circle, widest_circle};
use crate::verify::mill_size::size_mills;
use crate::verify::outline::Outline;
use crate::verify::voids::Blank;
use gcode_lang::shares;
use gcode_part::{Feature, FeatureKind, POINT_LENGTH};

/// What the end of a tool leaves open, by the tool's number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(in crate::verify) enum ShapeGap {
    /// The tool counts as a spot drill.
    SpotDrill(Option<u32>),
    /// The depth of its full diameter is unknown.
    FullDepth(Option<u32>),
    /// The depth of its full diameter is unknown, which has to pass the far side.
    FullThrough(Option<u32>),
    /// How far it goes beyond the far side is unknown, since its point is.
    BreakThrough(Option<u32>),
    /// The angle of its countersink is unknown.
    Angle(Option<u32>),
    /// The floor of its counterbore is unknown: it counts as flat.
    Floor(Option<u32>),
    /// It may be a comb mill, whose teeth are as long as its thread.
    ThreadLength(Option<u32>),
    /// It cuts a thread that the reference doesn't have.
    Thread(Option<u32>),
    /// It only widens or threads a hole, and the program doesn't drill that.
    Undrilled(Option<u32>),
}

/// Findings on the features of a nominal hole, and what they leave open.
pub(in crate::verify) struct FeatureFindings {
    pub nominal: usize,
    findings: Vec<Diagnostic>,
    pub gaps: Vec<ShapeGap>,
}

/// Cuts of a nominal hole, its findings and what they leave open.
pub(super) struct Judgement<'c> {
    pub comparison: &'c Comparison<'c>,
    /// Index of the nominal hole.
    pub index: usize,
    pub nominal: &'c Hole,
    pub id: &'c str,
    /// Cuts from the side of the nominal entry, in the order of the program.
    pub near: Vec<Cut<'c>>,
    /// Cuts of a through hole from its far side.
    pub far: Vec<Cut<'c>>,
    /// Nominal holes that follow a through hole on its axis.
    pub followers: Vec<Follower>,
    pub blank: Blank<'c>,
    pub findings: Vec<Diagnostic>,
    pub gaps: Vec<ShapeGap>,
}

pub(super) fn check(inspection: &HoleInspection<'_>, findings: &mut HoleFindings) {
    for hole in &inspection.features {
        for finding in &hole.findings {
            findings.add(Subject::Nominal(hole.nominal), finding.clone());
        }
    }
}

/// Judges the features of all holes; returns those with findings or gaps.
pub(in crate::verify) fn judge_all(
    comparison: &Comparison<'_>,
    blank: Blank<'_>,
    machine: &Machine,
) -> Vec<FeatureFindings> {
    let judge = |pair: &HolePair| {
        let Judgement { findings, gaps, .. } = judge(comparison, pair, blank, machine)?;
        let is_whole = findings.is_empty() && gaps.is_empty();
        (!is_whole).then_some(FeatureFindings { nominal: pair.nominal, findings, gaps })
    };
    shares::map_shares(&comparison.pairs, |pairs| pairs.iter().filter_map(judge).collect())
}

/// Judges the features of a hole; `None` for a hole of one diameter and one pass, which other checks cover.
fn judge<'c>(
    comparison: &'c Comparison<'_>,
    pair: &HolePair,
    blank: Blank<'c>,
    machine: &Machine,
) -> Option<Judgement<'c>> {
    let (nominal, drilled) = (&comparison.nominal[pair.nominal], &comparison.actual[pair.actual]);
    let is_plain = nominal.features.is_empty() && !nominal.through;
    if is_plain && drilled.earlier_passes.is_empty() && tool_kinds::is_usual(drilled, machine) {
        return None;
    }
    let out = Vector3::from(nominal.axis);
    let others = pair.from_far_side.map(|index| &comparison.actual[index]);
    let (mut near, mut far) = (Vec::new(), Vec::new());
    for drilled in [drilled].into_iter().chain(others) {
        let side = if drilled.axis.dot(&out) < 0.0 { &mut far } else { &mut near };
        side.extend(Cut::all(nominal, drilled, machine));
    }
    let followers = comparison.followers(nominal);
    let through = next_hole::strokes_through(comparison, pair, &followers, machine);
    if !through.is_empty() {
        near.extend(through);
        near.sort_by_key(|cut| cut.pass.cut.order);
    }
    size_mills(nominal, &mut near, comparison.tolerances);
    let id = comparison.id(pair.nominal);
    let (findings, gaps) = (Vec::new(), Vec::new());
    let index = pair.nominal;
    let mut judged =
        Judgement { comparison, index, nominal, id, near, far, followers, blank, findings, gaps };
    let surface = blank.body;
    if nominal.features.is_empty() {
        judged.judge_one_diameter(drilled, surface);
    } else {
        judged.judge_features(surface);
    }
    judged.judge_far_widths(drilled);
    judged.judge_both_sides();
    judged.judge_break_through(surface);
    judged.judge_next_holes(drilled, machine);
    let on_axis = earlier_on_axis(&judged, drilled, machine);
    threads::judge(&mut judged, &on_axis);
    tool_kinds::judge(&mut judged, &on_axis);
    Some(judged)
}

/// Returns the cuts of other holes of the list on the axis of a hole, from the same side or through from the other one, which are
/// made before it; none for a hole whose tools all make one.
fn earlier_on_axis<'c>(judged: &Judgement<'c>, drilled: &DrilledHole, machine: &Machine) -> Vec<Cut<'c>> {
    if !judged.near.iter().any(tool_kinds::needs_earlier_cut) {
        return Vec::new();
    }
    let own = drilled.passes().map(|pass| pass.cut.order).min();
    let is_before = |cut: &Cut<'_>| own.is_some_and(|own| cut.pass.cut.order < own);
    let others = judged.comparison.drilled_on_axis(judged.nominal);
    let cuts = others.flat_map(|other| {
        let out = Vector3::from(judged.nominal.axis);
        let cuts = Cut::all(judged.nominal, other, machine).into_iter();
        cuts.filter_map(move |cut| {
            if 0.0 < other.axis.dot(&out) { Some(cut) } else { cut.through_from_behind(judged.nominal) }
        })
    });
    cuts.filter(is_before).collect()
}

impl<'c> Judgement<'c> {
    /// Returns the voids on the axis of a hole in which a cut works that needs a hole before it: those that leave it metal.
    pub(super) fn voids_before(&self, nominal: &Hole, cut: &Cut<'c>) -> Vec<Cut<'c>> {
        let mut voids = Cut::of_voids(nominal, self.blank, self.comparison.tolerances, cut.pass.backtrace);
        voids.retain(|void| void.is_void_within(cut));
        voids
    }
}

impl Judgement<'_> {
    fn judge_features(&mut self, surface: Option<Surface>) {
        let tolerances = self.comparison.tolerances;
        let made_by = assign(&self.nominal.features, &self.near, tolerances);
        for (feature, cut) in self.nominal.features.iter().zip(&made_by) {
            if self.goes_through(feature) {
                self.judge_through(Some(feature), surface);
            } else {
                match *cut {
                    Some(cut) => {
                        let made = self.near[cut];
                        let deepest = deepest_circle(feature, cut, &self.near, &made_by, tolerances);
                        self.judge_depth(feature, &deepest);
                        self.judge_milling(feature, &made);
                        if made.tip < deepest.tip {
                            self.judge_milling(feature, &deepest);
                        }
                    }
                    None => self.report_missing(feature),
                }
            }
        }
        // The list says how thick the part is, and not which diameter goes through.
        if self.nominal.through && !self.nominal.features.iter().any(|feature| self.goes_through(feature)) {
            self.judge_through(None, surface);
        }
        for feature in &self.nominal.features {
            self.judge_wall(feature);
        }
        let tips = made_by.iter().flatten().map(|cut| self.near[*cut].tip);
        let bottom = tips.fold(self.nominal.depth, f64::max);
        let outline = Outline::of(self.nominal, tolerances.depth);
        let mut deepest = f64::NEG_INFINITY;
        for cut in 0..self.near.len() {
            // Another pass of a tool is judged by the feature that the tool makes.
            let own = self.near[cut].pass;
            if !made_by.iter().flatten().any(|made| self.near[*made].is_same_size(&own)) {
                self.judge_width(&self.near[cut].clone(), outline.as_ref(), deepest);
                self.judge_bottom(cut, bottom);
            }
            deepest = deepest.max(self.near[cut].tip);
        }
    }

    /// Judges a hole of one diameter that several passes make.
    fn judge_one_diameter(&mut self, drilled: &DrilledHole, surface: Option<Surface>) {
        if self.nominal.through {
            self.judge_through(None, surface);
        } else {
            self.judge_finished_depth();
        }
        if let Some(diameter) = self.nominal.diameter {
            let depth = Some(self.nominal.depth);
            self.judge_wall(&Feature { diameter, depth, ..Feature::of(FeatureKind::Bore) });
        }
        let outline = Outline::of(self.nominal, self.comparison.tolerances.depth);
        self.judge_widths(&self.near.clone(), outline.as_ref(), drilled);
    }

    /// Returns true if what is drilled from both sides of a through hole, each from its own entry, meets.
    pub(super) fn is_drilled_through(&self, drilled: f64, from_other_side: f64) -> bool {
        let Hole { through, depth, .. } = *self.nominal;
        through && !exceeds(depth - from_other_side - drilled, self.comparison.tolerances.depth)
    }

    fn goes_through(&self, feature: &Feature) -> bool {
        self.nominal.through && !exceeds(self.nominal.depth, feature.bottom())
    }

    fn judge_depth(&mut self, feature: &Feature, cut: &Cut<'_>) {
        let limit = self.comparison.tolerances.depth;
        let nominal = feature.bottom();
        let is_cone_open = cut.point == PointShape::Unknown || cut.may_be_cone;
        if feature.kind == FeatureKind::Countersink && is_cone_open {
            self.gaps.push(ShapeGap::Angle(cut.pass.tool));
        }
        if feature.kind == FeatureKind::Counterbore && cut.point == PointShape::Unknown {
            self.gaps.push(ShapeGap::Floor(cut.pass.tool));
        }
        let Some(actual) = cut.depth_of(feature) else {
            self.gaps.push(ShapeGap::FullDepth(cut.pass.tool));
            // The full diameter ends above the tip.
            if exceeds(nominal - cut.tip, limit) {
                self.report_depth(feature, cut, cut.tip);
            }
            return;
        };
        if exceeds((actual - nominal).abs(), limit) {
            self.report_depth(feature, cut, actual);
        }
    }

    /// Judges the circle of a mill that makes a feature.
    fn judge_milling(&mut self, feature: &Feature, cut: &Cut<'_>) {
        let Some(milled) = cut.pass.cut.milled else { return };
        let what = format!("hole {}: the {}", self.id, feature.describe());
        let finding = roundness::finding(&what, &milled, self.comparison.tolerances.diameter);
        self.findings.extend(finding.map(|finding| finding.with_backtrace(cut.pass.backtrace.clone())));
    }

    fn report_depth(&mut self, feature: &Feature, cut: &Cut<'_>, actual: f64) {
        let (id, limit) = (self.id, self.comparison.tolerances.depth);
        let error = actual - feature.bottom();
        let side = if error > 0.0 { "deep" } else { "shallow" };
        let off = format!("{:.3} mm too {side} (tolerance ±{limit})", error.abs());
        let message = match (feature.kind, feature.angle) {
            (FeatureKind::Countersink, Some(angle)) => {
                let wide = 2.0 * actual * Deg(angle / 2.0).tan();
                let wide = cut.pass.diameter.map_or(wide, |diameter| wide.min(diameter));
                format!(
                    "hole {id}: the {} is Φ{wide:.3} at the entry: its point is {off}",
                    feature.describe()
                )
            }
            _ => format!("hole {id}: the {} is {actual:.3} mm deep: {off}", feature.describe()),
        };
        let finding = Diagnostic::new(&FEATURE_DEPTH, message)
            .help("check the programmed depth, the tool length and its offset")
            .with_backtrace(cut.pass.backtrace.clone());
        self.findings.push(finding);
    }

    pub(super) fn report_missing(&mut self, feature: &Feature) {
        let message = format!("hole {}: no tool makes the {}", self.id, feature.describe());
        let cuts: Vec<_> =
            self.near.iter().map(|cut| format!("{} to {:.3} mm", cut.name(), cut.tip)).collect();
        let finding = Diagnostic::new(&FEATURE_MISSING, message)
            .note(format!("the hole is cut by {}", cuts.join(", by ")));
        let finding = match self.wrong_size(feature) {
            Some((cut, own)) => finding.help(format!(
                "{} reaches its depth, but the diameter is {}, not {}: correct the tool, the tool table or the reference",
                cut.name(),
                cutting::to_places(own),
                cutting::to_places(feature.diameter)
            )),
            None => finding.help("add its pass, or correct the tool, the tool table or the reference"),
        };
        let stuck =
            self.near.iter().find(|cut| cut.is_stuck_tap()).filter(|_| feature.kind == FeatureKind::Tap);
        let finding = stuck.into_iter().fold(finding, |finding, tap| {
            finding.note(format!("the spindle does not reverse while {} is in the hole", tap.name()))
        });
        let sized = self.near.iter().find_map(Cut::mill_note);
        let finding = sized.into_iter().fold(finding, Diagnostic::note);
        let place = self.near.last().or(self.far.last()).map(|cut| cut.pass.backtrace.clone());
        self.findings.push(place.into_iter().fold(finding, Diagnostic::with_backtrace));
    }

    /// Returns the depth of the full diameter of a cut whose tool's end is unknown: a drill has 118°, a tool that may make a
    /// countersink its angle, one that cuts before all deeper ones counts as a spot drill, any other as flat.
    pub(super) fn unknown_full_depth(&self, cut: &Cut<'_>, diameter: f64) -> f64 {
        let is_same = |other: &&Cut<'_>| std::ptr::eq(other.pass.backtrace, cut.pass.backtrace);
        let is_first = self.near.iter().take_while(|other| !is_same(other)).all(|other| other.tip <= cut.tip);
        let tolerances = self.comparison.tolerances;
        let is_made = |feature: &&Feature| {
            let deep = cut.depth_of(feature).map(|depth| (depth - feature.bottom()).abs());
            cut.mismatch(feature, tolerances).is_some()
                && !deep.is_some_and(|off| exceeds(off, tolerances.depth))
        };
        let countersinks = self.nominal.features.iter().filter(|f| f.kind == FeatureKind::Countersink);
        let angle = countersinks.filter(is_made).find_map(|feature| feature.angle);
        let point = match (cut.kind, angle) {
            (Some(ToolKind::Drill), _) => PointShape::DRILL,
            (_, Some(angle)) => PointShape::Pointed(Deg(angle)),
            _ if is_first => PointShape::SPOT_DRILL,
            _ => PointShape::Flat,
        };
        cut.tip - point.length(diameter).unwrap_or(0.0)
    }

    /// Returns a cut that would make a feature if the diameter was right, with that diameter.
    fn wrong_size(&self, feature: &Feature) -> Option<(&Cut<'_>, f64)> {
        let tolerances = self.comparison.tolerances;
        self.near.iter().find_map(|cut| {
            let own = cut.pass.diameter?;
            let resized = Feature { diameter: own, ..*feature };
            let depth = cut.depth_of(feature).unwrap_or(cut.tip);
            let is_as_deep = !exceeds((depth - feature.bottom()).abs(), tolerances.depth);
            let is_cylinder = feature.kind != FeatureKind::Countersink;
            (is_cylinder && is_as_deep && cut.mismatch(&resized, tolerances).is_some()).then_some((cut, own))
        })
    }

    /// Reports a cut that makes no feature and goes deeper than `bottom`, the deepest tip that makes one.
    fn judge_bottom(&mut self, index: usize, bottom: f64) {
        let cut = self.near[index];
        let limit = self.comparison.tolerances.depth;
        // The check on the depth covers a hole that is deeper than its features.
        let deepest = self.nominal.features.iter().map(Feature::bottom).fold(0.0, f64::max);
        if self.nominal.through || exceeds(self.nominal.depth, deepest) || !exceeds(cut.tip - bottom, limit) {
            return;
        }
        let error = cut.tip - self.nominal.depth;
        let message = format!(
            "hole {}: {} goes {:.3} mm deep, nominal {}: {error:.3} mm too deep (tolerance ±{limit})",
            self.id,
            cut.name(),
            cut.tip,
            self.nominal.depth
        );
        let finding = Diagnostic::new(&HOLE_DEPTH, message).with_backtrace(cut.pass.backtrace.clone());
        self.findings.push(finding.help("check the programmed depth, the tool length and its offset"));
    }

    /// Reports a finishing tool or a tap that ends above the bottom of a hole of one diameter. A hole without a diameter may
    /// have a thread of any depth.
    fn judge_finished_depth(&mut self) {
        let tolerances = self.comparison.tolerances;
        let (depth, diameter) = (self.nominal.depth, self.nominal.diameter);
        let is_sized = |cut: &&Cut<'_>| {
            let off = cut.pass.diameter.zip(diameter).map(|(own, nominal)| (own - nominal).abs());
            off.is_some_and(|off| !exceeds(off, tolerances.diameter))
        };
        let (cut, missed, note) = if let Some(tap) = deepest(self.near.iter().filter(|cut| cut.is_thread())) {
            if diameter.is_none() {
                // The depth may be that of the drill, which has to go deeper than the tap.
                self.gaps.push(ShapeGap::Thread(tap.pass.tool));
                return;
            }
            (tap, depth - tap.tip, None)
        } else if let Some(sized) = deepest(self.near.iter().filter(is_sized)) {
            let is_known = self.near.iter().all(|cut| cut.pass.diameter.is_some() || cut.tip <= sized.tip);
            if !is_known {
                return;
            }
            let own = sized.pass.diameter.unwrap_or(0.0);
            let missed = match (sized.is_circle(), sized.point) {
                (true, _) => depth - sized.full_depth(own).unwrap_or(sized.tip),
                // A drill leaves its cone.
                (false, PointShape::Unknown) if sized.kind == Some(ToolKind::Drill) => depth - sized.tip,
                (false, point) => {
                    let cone = POINT_LENGTH * own - point.length(own).unwrap_or(0.0);
                    depth - sized.tip - cone.max(0.0)
                }
            };
            if sized.point == PointShape::Unknown
                && sized.kind.is_none()
                && exceeds(depth - sized.tip, tolerances.depth)
            {
                self.gaps.push(ShapeGap::FullDepth(sized.pass.tool));
            }
            (sized, missed, sized.is_circle().then(|| sized.cone_note(own)).flatten())
        } else if let Some(widest) = widest_circle(&self.near, tolerances).filter(|_| diameter.is_some()) {
            (widest, depth - widest.tip, None)
        } else {
            return;
        };
        if !exceeds(missed, tolerances.depth) {
            return;
        }
        let verb = if cut.is_thread() { "taps" } else { "finishes" };
        let made = if note.is_some() { (depth - missed).max(0.0) } else { cut.tip };
        let message = format!("hole {}: {} {verb} {made:.3} mm of {depth} mm", self.id, cut.name());
        let finding = note.into_iter().fold(Diagnostic::new(&FEATURE_DEPTH, message), Diagnostic::note);
        let finding = finding
            .note("the reference gives the hole one diameter all the way down")
            .help("correct the programmed depth, or give the hole's features in the reference")
            .with_backtrace(cut.pass.backtrace.clone());
        self.findings.push(finding);
    }
}

/// Returns how deep a hole is drilled from this side and from the other, in words.
pub(super) fn drilled_depths(drilled: f64, from_other_side: f64) -> String {
    match from_other_side {
        0.0 => format!("{drilled:.3} mm"),
        _ => format!("{drilled:.3} mm, and {from_other_side:.3} mm from the other side,"),
    }
}

/// Returns the deepest of some cuts.
fn deepest<'c>(cuts: impl Iterator<Item = &'c Cut<'c>>) -> Option<Cut<'c>> {
    cuts.max_by(|a, b| a.tip.total_cmp(&b.tip)).copied()
}
