//! Through holes: they break out, and not too far.
//!
//! Nominal holes deeper than the part is thick along their axis: a warning, since the drawing may specify a through hole.
//! The part may be thinner than its surface shows, a shell or cut off: no finding is no proof.
use super::features::{Judgement, ShapeGap};
use super::*;
use crate::findings::{HOLE_DEPTH, HOLE_NOT_THROUGH, HOLE_THROUGH};
use crate::holes::ring;
use crate::machine::PointShape;
use crate::verify::bottom;
use crate::verify::followers::Follower;
use crate::verify::hole_cuts::Cut;
use gcode_part::{Feature, POINT_LENGTH};

/// Number of points on the wall of a hole.
const RIM_POINTS: u32 = 16;

/// Distance beyond the far side at which a hole ends in a pocket or in metal, mm.
const BELOW_FAR_SIDE: f64 = 0.01;

/// Diameter up to which a drill is unknown, mm: wider holes are bored.
const MAX_DRILL: f64 = 50.0;

/// Least number of holes for one finding.
const MIN_HOLES: usize = 3;

pub(super) fn check(inspection: &HoleInspection<'_>, findings: &mut HoleFindings) {
    let comparison = &inspection.comparison;
    let Some(surface) = inspection.reference.surface else { return };
    let through = |(index, hole): (usize, &Hole)| {
        if hole.through {
            return None;
        }
        // A hole that ends inside the part does not go through it.
        let is_outside = surface.value(&bottom(hole)) >= 0.0;
        let thickness = is_outside.then(|| thickness(&surface, hole)).filter(|thick| *thick < hole.depth)?;
        Some((index, thickness))
    };
    let through: Vec<(usize, f64)> = comparison.nominal.iter().enumerate().filter_map(through).collect();
    let finding = |which: &str, (index, thick): (usize, f64)| {
        let depth = comparison.nominal[index].depth;
        let message =
            format!("{which} through: {depth} mm deep, the part is {thick:.1} mm thick along its axis");
        Diagnostic::new(&HOLE_THROUGH, message)
            .help("check depth, radius and direction, unless the drawing specifies a through hole")
    };
    let (count, all) = (through.len(), comparison.nominal.len());
    let is_summary = MIN_HOLES <= count;
    if let Some(first) = through.first().filter(|_| is_summary) {
        let id = comparison.id(first.0);
        let mut summary =
            finding(&format!("{count} of {all} holes go through; the first, {id}, goes"), *first);
        summary.notes.extend(folded_note(count));
        findings.add(Subject::Whole, summary);
    }
    for one in through {
        let finding = finding(&format!("hole {} goes", comparison.id(one.0)), one);
        let subject = Subject::Nominal(one.0);
        if is_summary { findings.add_folded(subject, finding) } else { findings.add(subject, finding) }
    }
}

/// Returns the distance from the entry along the axis to the far side; 0 if the axis only touches the part.
pub(super) fn thickness(surface: &Surface, hole: &Hole) -> f64 {
    let entry = Point3::from(hole.entry);
    let into = Unit::new_normalize(-Vector3::from(hole.axis));
    surface.exit(&entry, &into).map_or(0.0, |far| (far - entry).dot(&into).max(0.0))
}

/// Returns the largest distance from the entry plane along the axis to the far side, on the axis and at the wall of a hole.
pub(super) fn rim_thickness(surface: &Surface, hole: &Hole, radius: f64) -> f64 {
    let out = Unit::new_normalize(Vector3::from(hole.axis));
    let (entry, into) = (Point3::from(hole.entry), -out);
    let middle = entry + into.into_inner() * (hole.depth / 2.0);
    let offsets = ring(&out, &Vector3::zeros(), radius, RIM_POINTS);
    let far = offsets.iter().filter_map(|offset| surface.exit(&(middle + offset), &into));
    far.map(|far| (far - entry).dot(&into)).fold(thickness(surface, hole), f64::max)
}

/// Returns the depth at which a hole has opened with its whole rim into stated pockets or voids, if its axis ends in one: there its
/// depth is the thickness of the part. Into a round one the rim opens deeper than the axis.
fn opening_depth(openings: &[Surface], hole: &Hole, radius: f64) -> Option<f64> {
    let out = Unit::new_normalize(Vector3::from(hole.axis));
    let start = hole.depth + BELOW_FAR_SIDE;
    let below = Point3::from(hole.entry) - out.into_inner() * start;
    if !openings.iter().any(|opening| opening.value(&below) < 0.0) {
        return None;
    }
    let reach = 2.0 * radius;
    let opens = |offset: Vector3<f64>| {
        let from = below + offset;
        let to = from - out.into_inner() * reach;
        let first = |opening: &Surface| match opening.value(&from) < 0.0 {
            true => Some(hole.depth),
            false => opening.piece(&from, &to, 0.0).map(|[first, _]| start + reach * first),
        };
        openings.iter().filter_map(first).reduce(f64::min)
    };
    let rim = ring(&out, &Vector3::zeros(), radius, RIM_POINTS).into_iter();
    rim.map(opens).try_fold(hole.depth, |deepest, opens| Some(deepest.max(opens?)))
}

/// Returns the depth at which solid metal begins below a hole that ends in a pocket, on its axis and above a tip.
fn metal_below((surface, pockets): (&Surface, &[Surface]), hole: &Hole, tip: f64) -> Option<f64> {
    let (entry, into) = (Point3::from(hole.entry), -Unit::new_normalize(Vector3::from(hole.axis)));
    let mut depth = hole.depth;
    while depth + BELOW_FAR_SIDE < tip {
        let below = entry + into.into_inner() * (depth + BELOW_FAR_SIDE);
        let Some(pocket) = pockets.iter().find(|pocket| pocket.value(&below) < 0.0) else {
            return (surface.value(&below) < 0.0).then_some(depth);
        };
        depth = (pocket.exit(&below, &into)? - entry).dot(&into);
    }
    None
}

/// Returns how far the full diameter of a cut passes the far side of a hole of this thickness, mm. A tool whose end is unknown
/// counts as a drill of 118°, and one of unknown diameter in a hole without one as a point.
pub(super) fn break_through(cut: &Cut<'_>, nominal: &Hole, thickness: f64) -> f64 {
    let diameter = cut.pass.diameter.or(nominal.widest_diameter()).unwrap_or(0.0);
    cut.full_depth(diameter).unwrap_or(cut.tip - POINT_LENGTH * diameter) - thickness
}

impl Judgement<'_> {
    /// Reports the cuts that go farther beyond the far side of a through hole than any of them has to.
    pub(super) fn judge_break_through(&mut self, surface: Option<Surface>) {
        let (nominal, id) = (self.nominal, self.id);
        if !nominal.through {
            return;
        }
        self.judge_behind_pocket(surface);
        self.judge_behind_bore(surface);
        let radius = nominal.widest_diameter().unwrap_or(0.0) / 2.0;
        let opens = opening_depth(self.blank.openings, nominal, radius);
        let body = || surface.map_or(0.0, |surface| thickness(&surface, nominal));
        let thickness = opens.unwrap_or_else(body).max(nominal.depth);
        // The part is open between the holes of one axis, as between the ears of a clevis: a stroke ends behind the last one that it
        // enters.
        let thickness_of = |cut: &Cut<'_>| {
            let is_entered = |next: &&Follower| next.far - next.hole.depth < cut.tip;
            self.followers.iter().filter(is_entered).map(|next| next.far).fold(thickness, f64::max)
        };
        let beyond = |cut: &&Cut<'_>| break_through(cut, nominal, thickness_of(cut));
        let all = self.near.iter().chain(&self.far);
        let Some(cut) = all.max_by(|a, b| beyond(a).total_cmp(&beyond(b))) else { return };
        let (limit, beyond, thickness) = (MAX_BREAK_THROUGH, beyond(&cut), thickness_of(cut));
        if !exceeds(beyond, limit) {
            return;
        }
        // The point of a drill of unknown diameter may be as long as that of the widest.
        let is_open = cut.pass.diameter.or(nominal.widest_diameter()).is_none();
        if is_open && cut.point != PointShape::Flat && !exceeds(beyond - POINT_LENGTH * MAX_DRILL, limit) {
            self.gaps.push(ShapeGap::BreakThrough(cut.pass.tool));
            return;
        }
        let message = format!(
            "hole {id} is {thickness:.3} mm deep, and {} goes through it by {beyond:.3} mm besides its point: limit {limit}",
            cut.name()
        );
        let finding = Diagnostic::new(&HOLE_DEPTH, message)
            .note("below the part are the table, the vise and the parallels")
            .help("check the programmed depth, the tool length and its offset")
            .with_backtrace(cut.pass.backtrace.clone());
        self.findings.push(finding);
    }

    /// Reports a cut that goes on through the pocket in which a hole ends, into the metal behind it.
    fn judge_behind_pocket(&mut self, surface: Option<Surface>) {
        let (nominal, slack) = (self.nominal, self.comparison.tolerances.depth);
        let radius = nominal.widest_diameter().unwrap_or(0.0) / 2.0;
        let is_last = self.followers.is_empty();
        let ends_there = || is_last && opening_depth(self.blank.openings, nominal, radius).is_some();
        let Some(surface) = surface.filter(|_| ends_there()) else { return };
        let body = (&surface, self.blank.openings);
        let metal =
            |cut: &Cut<'_>| metal_below(body, nominal, cut.tip).filter(|at| exceeds(cut.tip - at, slack));
        let Some((cut, at)) = self.near.iter().find_map(|cut| Some((cut, metal(cut)?))) else { return };
        let message = format!(
            "hole {}: {} goes {:.3} mm into the metal behind the pocket in which the hole ends",
            self.id,
            cut.name(),
            cut.tip - at
        );
        let finding = Diagnostic::new(&HOLE_DEPTH, message).with_backtrace(cut.pass.backtrace.clone());
        self.findings.push(finding.help("end the stroke in the pocket"));
    }

    /// Reports a cut that goes on through the bore in which a hole ends, into its opposite wall.
    fn judge_behind_bore(&mut self, surface: Option<Surface>) {
        let (nominal, slack) = (self.nominal, self.comparison.tolerances.depth);
        let out = Vector3::from(nominal.axis);
        let is_solid = |depth: f64| {
            let point = Point3::from(nominal.entry) - out * depth;
            surface.is_some_and(|surface| surface.value(&point) < 0.0)
        };
        let deepest = self.near.iter().max_by(|a, b| a.tip.total_cmp(&b.tip)).copied();
        let Some((cut, bore)) = deepest.zip(self.comparison.bore_at_end(self.index)) else { return };
        if !exceeds(cut.tip - bore.ends, slack) || !is_solid(bore.ends + slack) {
            return;
        }
        let message = format!(
            "hole {} ends in hole {}: {} goes {:.3} mm into the opposite wall of that",
            self.id,
            self.comparison.id(bore.index),
            cut.name(),
            cut.tip - bore.ends
        );
        let finding = Diagnostic::new(&HOLE_DEPTH, message).with_backtrace(cut.pass.backtrace.clone());
        self.findings.push(finding.help("end the stroke in the bore"));
    }

    /// Reports a through hole, or a feature of one, that does not break out.
    pub(super) fn judge_through(&mut self, feature: Option<&Feature>, surface: Option<Surface>) {
        let tolerances = self.comparison.tolerances;
        let own = self.nominal.diameter.filter(|_| self.nominal.features.is_empty());
        let makes =
            |cut: &&Cut<'_>| match feature {
                Some(feature) => cut.mismatch(feature, tolerances).is_some(),
                // A pilot of another diameter doesn't make the hole.
                None => cut.pass.diameter.zip(own).is_none_or(|(diameter, nominal)| {
                    !exceeds((diameter - nominal).abs(), tolerances.diameter)
                }),
            };
        let narrowest = || self.nominal.features.iter().map(|feature| feature.diameter).reduce(f64::min);
        // Without a diameter in the list the rim is that of the tool that goes deepest.
        let made = || {
            let cuts = self.near.iter().chain(&self.far).filter(|cut| !cut.is_thread());
            cuts.max_by(|a, b| a.tip.total_cmp(&b.tip))?.pass.diameter
        };
        let stated = feature.map(|feature| feature.diameter).or(own).or_else(narrowest);
        let diameter = stated.or_else(made).unwrap_or(0.0);
        let thickness = surface.map_or(0.0, |surface| rim_thickness(&surface, self.nominal, diameter / 2.0));
        let thickest = thickness.max(self.nominal.depth);
        let mut gaps = Vec::new();
        let mut reach = |cuts: &[Cut<'_>]| {
            // Without a feature the list doesn't say how wide a tool of unknown diameter is, nor how long its point.
            let full = |cut: &Cut<'_>| {
                let is_open = feature.is_none() && own.is_none() && cut.pass.diameter.is_none();
                cut.full_depth(diameter).filter(|full| !is_open || thickest <= *full)
            };
            let depth = |cut: &Cut<'_>| full(cut).unwrap_or(cut.tip);
            let deepest = cuts.iter().filter(makes).max_by(|a, b| depth(a).total_cmp(&depth(b)))?;
            if full(deepest).is_none() {
                gaps.push(ShapeGap::FullThrough(deepest.pass.tool));
            }
            Some((depth(deepest).max(0.0), deepest.pass.backtrace.clone()))
        };
        // What a void leaves empty from the entry on needs no cut.
        let first = self.near.iter().chain(&self.far).next();
        let voids = first.map(|cut| Cut::of_voids(self.nominal, self.blank, tolerances, cut.pass.backtrace));
        let near = [&self.near[..], &voids.unwrap_or_default()].concat();
        let sides = [reach(&near), reach(&self.far)];
        self.gaps.extend(gaps);
        let depth = thickest;
        let cut: f64 = sides.iter().flatten().map(|(depth, _)| depth).sum();
        let Some((_, place)) = sides.into_iter().flatten().next() else {
            feature.into_iter().for_each(|feature| self.report_missing(feature));
            return;
        };
        if !exceeds(depth, cut) {
            return;
        }
        // A coaxial hole from the far side is the rest of this one, and above one that follows it the part is open.
        let depth = depth.min(self.comparison.counter_depth(self.nominal, diameter));
        let opens = match self.followers.is_empty() {
            true => opening_depth(self.blank.openings, self.nominal, diameter / 2.0),
            false => Some(self.nominal.depth),
        };
        let bore = || self.comparison.bore_at_end(self.index).map(|bore| bore.opens);
        let depth = opens.or_else(bore).map_or(depth, |opens| depth.min(opens));
        if exceeds(depth, cut) {
            let name = feature.map_or(String::new(), |feature| format!(": the {}", feature.describe()));
            let message =
                format!("hole {}{name} does not break out: {cut:.3} mm of {depth:.3} mm are cut", self.id);
            let finding = Diagnostic::new(&HOLE_NOT_THROUGH, message).with_backtrace(place);
            let is_listed_deeper = 0.0 < thickness
                && exceeds(self.nominal.depth - thickness, tolerances.depth)
                && !exceeds(thickness, cut);
            let help = if is_listed_deeper {
                format!(
                    "the part is {thickness:.3} mm thick there: write that as the depth of a through hole, or drill deeper"
                )
            } else {
                "drill deeper: the full diameter has to pass the far side".to_owned()
            };
            self.findings.push(finding.help(help));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn thick(surface: Surface, entry: [f64; 3], axis: [f64; 3]) -> f64 {
        thickness(&surface, &Hole { id: None, entry, axis, depth: 1.0, diameter: None, ..Hole::default() })
    }

    /// (16/20)² + (7.2/12)² = 1. Parallel to y the far side is at −7.2. The normal there is (16/400, 7.2/144) =
    /// (0.04, 0.05), so n = (4, 5)/√41, and the chord is 2·(p·M·n)/(n·M·n) with M = (1/400, 1/144):
    /// 2·(0.41/√41)/((16/400 + 25/144)/41) = 24.580.
    #[test]
    fn chords_of_an_ellipse_are_those_computed_by_hand() {
        let surface = Surface::Ellipsoid { a: 20.0, b: 12.0 };
        let s = 41f64.sqrt();
        for sign in [1.0, -1.0] {
            let entry = [0.0, 7.2, 16.0 * sign];
            assert!((thick(surface, entry, [0.0, 1.0, 0.0]) - 14.4).abs() < 1e-9);
            let normal = thick(surface, entry, [0.0, 5.0 / s, 4.0 * sign / s]);
            assert!((normal - 24.580).abs() < 1e-3, "{normal}");
        }
        assert!((thick(surface, [0.0, 12.0, 0.0], [0.0, 1.0, 0.0]) - 24.0).abs() < 1e-9);
    }

    /// Parallel to z at y 15 of a cylinder of 25 about x: the far side is at −20, at the inner wall, y 11, at −22.450.
    #[test]
    fn a_hole_beside_the_middle_is_longer_at_its_inner_wall() {
        let cylinder = Surface::Cylinder { radius: 25.0 };
        let hole = Hole { entry: [0.0, 15.0, 20.0], axis: [0.0, 0.0, 1.0], depth: 40.0, ..Hole::default() };
        assert!((thickness(&cylinder, &hole) - 40.0).abs() < 1e-9);
        let thick = rim_thickness(&cylinder, &hole, 4.0);
        assert!((thick - (20.0 + 504f64.sqrt())).abs() < 1e-9, "{thick}");
    }

    #[test]
    fn the_rim_has_no_thickness_and_a_cylinder_has_its_diameter() {
        let surface = Surface::Ellipsoid { a: 20.0, b: 12.0 };
        assert!(thick(surface, [20.0, 0.0, 0.0], [0.0, 1.0, 0.0]) < 1e-5);
        let cylinder = Surface::Cylinder { radius: 30.0 };
        assert!((thick(cylinder, [5.0, 0.0, -30.0], [0.0, 0.0, -1.0]) - 60.0).abs() < 1e-9);
    }
}
