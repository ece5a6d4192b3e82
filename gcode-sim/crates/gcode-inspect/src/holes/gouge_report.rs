//! Messages on feeds that cut what has to stay.
use nalgebra::Point3;

use super::HoleExtractor;
use super::feed_law::{Gouge, ToolRegion};
use super::hole_circles::HoleCircles;
use super::per_block::Findings;
use super::rapids::format_point;
use super::unsized_tool::MAX_RADIUS;
use crate::findings::FEED_BESIDE_HOLE;
use crate::machine::{TOUCH_DEPTH, tool_name};
use gcode_lang::diag::Diagnostic;
use gcode_lang::motion::Backtrace;
use gcode_part::Collar;

/// Largest radius of a hole of unknown diameter that is milled, mm.
const MAX_OPEN_RADIUS: f64 = 50.0;

/// Largest difference of the distances of an arc's points from its axis, mm.
const ROUND: f64 = 0.05;

/// Feed beside a nominal hole without a diameter, which may be as wide as the circle that mills it.
#[derive(Debug)]
pub(super) struct OpenFeed {
    /// Points of its path.
    path: Vec<Point3<f64>>,
    findings: Findings,
}

/// Nominal hole above a feed.
#[derive(Clone, Copy)]
struct HoleAbove<'a> {
    id: &'a str,
    collar: &'a Collar,
}

impl HoleExtractor<'_> {
    /// Reports the feeds beside holes without a diameter whose paths leave the circles that an engagement mills.
    pub(super) fn report_open_feeds(&mut self, feeds: Vec<OpenFeed>, holes: &[HoleCircles]) {
        for OpenFeed { path, findings } in feeds {
            if !holes.iter().any(|circles| path.iter().all(|tip| circles.contains(tip))) {
                self.findings.append(findings);
            }
        }
    }

    /// Reports where a feed along a path cuts what has to stay.
    pub(super) fn report_gouge(
        &mut self,
        backtrace: &Backtrace,
        path: &[Point3<f64>],
        Gouge { at, part }: Gouge,
    ) {
        let (depth, point) = (at.depth, format_point(&at.point));
        let level = self.metal.level_at(&at.point);
        let (message, help) = match (part, self.metal.holes.as_ref()) {
            (ToolRegion::TipBeyond(hole), Some(holes)) => (
                format!(
                    "the tool is fed through hole {} and {depth:.3} mm below its entry, at {point}: limit {:.3}",
                    holes.id(hole),
                    holes.collar(hole).max_depth()
                ),
                "feed less deep: what is below the part, a table or a vise, is not in the machine file's [stock]",
            ),
            (ToolRegion::Shank, _) => {
                let tool = tool_name(self.setup.tool);
                let message = format!(
                    "the shank or the holder of {tool} touches metal, {depth:.3} mm below {level} at {point}"
                );
                let number = self.setup.tool.unwrap_or(0);
                // The tool is the same in all its feeds.
                let help = match self.is_probe() {
                    true => "use a longer stylus, or keep the body of the probe away from the part",
                    false => {
                        "use a tool whose flutes are longer than the metal beside them is high, or cut that metal before"
                    }
                };
                self.findings.add_in_program(&FEED_BESIDE_HOLE, backtrace, number, 1, |kind| {
                    Diagnostic::new(kind, message).help(help)
                });
                return;
            }
            (ToolRegion::Tip | ToolRegion::Side | ToolRegion::TipBeyond(_), _) => {
                let is_stock = self.surface.is_some();
                let hole = self.metal.hole_at(&at.point).filter(|_| !is_stock);
                let reach = self.tool_radius().unwrap_or(MAX_RADIUS);
                let pocket = self.metal.distance_from_pocket(&at.point).filter(|distance| *distance <= reach);
                let above = self.hole_above(&at.point);
                let place = match (above, hole, pocket, part) {
                    (Some(above), ..) => format!("below hole {}", above.id),
                    (None, Some(id), ..) => format!("beside hole {id}"),
                    (None, None, Some(distance), ToolRegion::Tip) => {
                        format!("{distance:.3} mm outside its pocket")
                    }
                    (None, None, Some(_), _) => "the part beside its pocket".to_owned(),
                    // Farther from every pocket than the tool is wide, or without any.
                    (None, None, None, _)
                        if self.metal.holes.as_ref().is_some_and(|holes| holes.is_empty()) =>
                    {
                        "the part outside its pockets".to_owned()
                    }
                    (None, None, None, _) => "the part beside its holes".to_owned(),
                };
                let what = if matches!(part, ToolRegion::Side) { "the side of the tool" } else { "the feed" };
                let is_milled = above.is_some_and(|above| self.circles_about(above.collar, path));
                let help = match is_stock {
                    _ if is_milled => {
                        "mill no deeper than the hole, or correct its depth in the list: it is full to the deepest whole circle, which \
                         a helix lacks at its end"
                    }
                    true => {
                        "keep the tool's radius away from what has to stay, or state in [[stock.pocket]] what the \
                         program mills besides the holes"
                    }
                    false => "retract above the entry of the hole before a motion beside it",
                };
                (format!("{what} cuts {place}, {depth:.3} mm below {level} at {point}"), help)
            }
        };
        let mut findings = Findings::default();
        findings.add(&FEED_BESIDE_HOLE, backtrace, 0, |kind| Diagnostic::new(kind, message).help(help));
        match self.is_at_open_hole(&at.point) {
            true => self.engagement.open_feeds.push(OpenFeed { path: path.to_vec(), findings }),
            false => self.findings.append(findings),
        }
    }

    /// Returns where a feed beside the stated pockets cuts; `None` without pockets.
    pub(super) fn pocket_note(&self, Gouge { at, part }: Gouge) -> Option<String> {
        let distance = self.metal.distance_from_pocket(&at.point)?;
        let what = if matches!(part, ToolRegion::Tip) { "the feed" } else { "the side of the tool" };
        let (depth, point) = (at.depth, format_point(&at.point));
        Some(format!(
            "{what} cuts {distance:.3} mm outside the nearest pocket, {depth:.3} mm below the surface at {point}"
        ))
    }

    /// Returns the nominal hole within whose diameter a point lies, deeper than the hole: the nearest one.
    fn hole_above(&self, p: &Point3<f64>) -> Option<HoleAbove<'_>> {
        let holes = self.metal.holes.as_ref()?;
        let mut nearest: Option<(f64, usize)> = None;
        holes.below(p, p, (MAX_OPEN_RADIUS, 0.0), &mut |hole| {
            let collar = holes.collar(hole);
            let is_inside = collar.has_diameter && collar.from_axis(p) < collar.hole_radius;
            let distance = collar.depth(p) - collar.max_depth();
            if is_inside && 0.0 < distance && nearest.is_none_or(|(least, _)| distance < least) {
                nearest = Some((distance, hole));
            }
        });
        nearest.map(|(_, hole)| HoleAbove { id: holes.id(hole), collar: holes.collar(hole) })
    }

    /// Returns true if the engagement has gone round the axis of a hole, or a feed along `path` does.
    fn circles_about(&self, collar: &Collar, path: &[Point3<f64>]) -> bool {
        let is_round = |corners: &[Point3<f64>]| {
            let distances = || corners.iter().map(|p| collar.from_axis(p));
            2 < corners.len()
                && distances().fold(0.0, f64::max) - distances().fold(f64::INFINITY, f64::min) <= ROUND
        };
        is_round(path) || self.engagement.circles_about(collar)
    }

    /// Returns true if a point is beside a nominal hole without a diameter, and no deeper than that.
    fn is_at_open_hole(&self, p: &Point3<f64>) -> bool {
        let mut is_open = false;
        if let Some(holes) = self.metal.holes.as_ref().filter(|_| self.surface.is_some()) {
            holes.below(p, p, (MAX_OPEN_RADIUS, 0.0), &mut |hole| {
                let collar = holes.collar(hole);
                is_open |= !collar.has_diameter && collar.depth(p) <= collar.max_depth() + TOUCH_DEPTH;
            });
        }
        is_open
    }
}
