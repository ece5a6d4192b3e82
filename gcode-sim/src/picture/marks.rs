//! Holes on the sheet: symbol, direction of the axis, and round it the dial that shows the misfit enlarged.
use super::ink::{Dash, Ink, Px};
use super::labels::{Field, Obstacle};
use super::measure::magnification;
use super::palette;
use super::scene::{Mark, Scene, Standing};
use super::sheet::Frame;
use super::symbol;
use crate::units::Deg;

/// How misfits are shown on this sheet.
#[derive(Clone, Copy, Debug)]
pub(super) struct Dials {
    /// Times enlarged and radius of the zone's circle in pixels.
    shown: Option<(f64, f64)>,
    /// Radius of a verdict's sign, pixels.
    badge: f64,
    /// There are misfits but no room for them.
    crowded: bool,
}

/// A hole as drawn.
#[derive(Clone, Debug)]
pub(super) struct Drawn {
    pub(super) centre: Px,
    /// Labels keep this far from the centre.
    pub(super) clear: f64,
    pub(super) inks: Vec<Ink>,
    /// Its misfit is longer than the sheet shows.
    pub(super) cut: bool,
}

/// A misfit is drawn up to this many radii of its zone.
const LONGEST: f64 = 1.7;

impl Dials {
    /// As large as the holes' distances allow, so that the zones' circles of neighbours stay apart.
    pub(super) fn choose(scene: &Scene, frame: &Frame) -> Self {
        let text = frame.text;
        let gap = typical_gap(scene, frame);
        let any = scene.marks.iter().any(|m| m.misfit.is_some());
        let most = (0.42 * gap).min(2.4 * text);
        let shown = scene.zone.filter(|zone| any && 0.0 < *zone && 0.8 * text <= most).map(|zone| {
            let times = magnification(most / (zone / 2.0 * frame.scale.factor));
            (times, times * zone / 2.0 * frame.scale.factor)
        });
        let badge = (0.36 * gap).min(0.55 * text).max(0.28 * text);
        Self { shown, badge, crowded: any && shown.is_none() }
    }

    pub(super) fn magnification(&self) -> Option<f64> {
        self.shown.map(|(times, _)| times)
    }

    pub(super) fn notes(&self, scene: &Scene, drawn: &[Drawn]) -> Vec<String> {
        let mut notes = Vec::new();
        if self.crowded && scene.zone.is_some() {
            notes.push("misfits not drawn: no room".to_owned());
        }
        if drawn.iter().any(|d| d.cut) {
            notes.push("an arrow on a misfit: it is longer than drawn".to_owned());
        }
        notes
    }
}

/// The distance to the nearest neighbour that nine of ten holes have, pixels. Holes in the same place don't count:
/// no dial would be small enough.
fn typical_gap(scene: &Scene, frame: &Frame) -> f64 {
    let mut places: Vec<Px> = scene.marks.iter().map(|m| frame.scale.px(m.at)).collect();
    places.sort_by(|a, b| a.x.total_cmp(&b.x));
    let mut gaps: Vec<f64> = Vec::new();
    for (i, a) in places.iter().enumerate() {
        let mut least = f64::INFINITY;
        let (left, right) = places.split_at(i);
        for side in [&mut left.iter().rev() as &mut dyn Iterator<Item = &Px>, &mut right.iter().skip(1)] {
            for b in side {
                if least < (b.x - a.x).abs() {
                    break;
                }
                let distance = a.distance(*b);
                if 0.3 * frame.text < distance {
                    least = least.min(distance);
                }
            }
        }
        gaps.push(least);
    }
    gaps.sort_by(f64::total_cmp);
    gaps.get(gaps.len() / 10).copied().unwrap_or(f64::INFINITY)
}

/// Draws the holes and blocks their places for labels.
pub(super) fn draw_marks(scene: &Scene, frame: &Frame, dials: &Dials, field: &mut Field) -> Vec<Drawn> {
    let mut drawn: Vec<Drawn> = Vec::new();
    for mark in &scene.marks {
        let hole = draw_mark(mark, frame, dials, &drawn, field);
        field.block(Obstacle::Disc { centre: hole.centre, radius: hole.clear });
        drawn.push(hole);
    }
    drawn
}

fn draw_mark(mark: &Mark, frame: &Frame, dials: &Dials, before: &[Drawn], field: &mut Field) -> Drawn {
    let text = frame.text;
    let place = frame.scale.px(mark.at);
    let true_radius = mark.radius * frame.scale.factor;
    let mut inks = Vec::new();
    let mut cut = false;
    let Some((times, zone)) = dials.shown.filter(|_| mark.misfit.is_some()) else {
        return draw_sign(mark, place, true_radius, frame, dials, before, field);
    };

    let centre = place;
    inks.push(Ink::Disc { centre, radius: zone, color: palette::PAPER });
    let thin = (0.06 * text).max(1.0);
    inks.push(Ink::Ring { centre, radius: zone, width: thin, dash: Dash::Solid, color: palette::THIN });
    let hole = true_radius.max(0.2 * text);
    inks.push(Ink::Ring { centre, radius: hole, width: thin, dash: Dash::Solid, color: palette::TEXT });

    if let Some(found) = mark.found.map(|f| frame.scale.px(f)) {
        if zone * LONGEST < centre.distance(found) {
            let dash = Dash::Pattern([0.15 * text, 0.2 * text]);
            inks.push(Ink::Line {
                points: vec![centre, found],
                closed: false,
                width: thin,
                dash,
                color: palette::TEXT,
            });
            inks.push(Ink::Ring {
                centre: found,
                radius: hole.max(0.3 * text),
                width: thin,
                dash: Dash::Solid,
                color: palette::TEXT,
            });
            field.block(Obstacle::Disc { centre: found, radius: hole.max(0.3 * text) + 2.0 });
            field.block(Obstacle::Segment(centre, found));
        }
    }

    if let Some(misfit) = mark.misfit {
        let enlarged = |p: [f64; 2]| [p[0] * times * frame.scale.factor, -p[1] * times * frame.scale.factor];
        let color = palette::standing(mark.standing);
        let ends = [misfit.entry, misfit.bottom].map(|end| {
            let [x, y] = enlarged(end);
            let length = libm::hypot(x, y);
            let short = if LONGEST * zone < length { LONGEST * zone / length } else { 1.0 };
            (centre.toward([x * short, y * short], 1.0), short < 1.0)
        });
        let width = (0.13 * text).max(1.5);
        let dot = (0.17 * text).max(1.8);
        for (end, beyond) in ends {
            if beyond {
                inks.extend(symbol::arrow(centre, end, width, 0.6 * text, color));
                field.block(Obstacle::Segment(centre, end));
                cut = true;
            } else {
                inks.push(Ink::line(centre, end, width, color));
            }
        }
        // From the entry to the bottom: a tilted hole shows as a line across its dial.
        inks.push(Ink::line(ends[0].0, ends[1].0, width, color));
        if !ends[0].1 {
            inks.push(Ink::Disc { centre: ends[0].0, radius: dot, color });
        }
    }

    let mut away = Deg(45.0);
    if let Some(direction) = mark.direction {
        let projected = libm::hypot(direction[0], direction[1]);
        if 0.02 < projected {
            let along = [direction[0] / projected, -direction[1] / projected];
            inks.extend(axis_arrow(centre, along, projected, zone, text, field));
            let angle = Deg::atan2(-along[1], along[0]);
            away = badge_angle(angle);
        }
    }
    let badge = centre.toward(symbol::direction(away), zone);
    inks.extend(symbol::standing(mark.standing, badge, dials.badge));
    field.block(Obstacle::Disc { centre: badge, radius: dials.badge * 1.2 });
    Drawn { centre, clear: zone + 0.15 * text, inks, cut }
}

/// A hole without a dial: the sign itself marks the place. A second sign in one place moves aside.
fn draw_sign(
    mark: &Mark,
    place: Px,
    true_radius: f64,
    frame: &Frame,
    dials: &Dials,
    before: &[Drawn],
    field: &mut Field,
) -> Drawn {
    let text = frame.text;
    let radius = true_radius.max(dials.badge).min(1.2 * text).max(dials.badge);
    let mut inks = Vec::new();
    let thin = (0.06 * text).max(1.0);
    let mut centre = place;
    if let Some(other) = before.iter().find(|d| d.centre.distance(place) < 0.6 * (d.clear + radius)) {
        let step = other.clear + radius + 0.3 * text;
        let free =
            (0..8).map(|i| other.centre.toward(symbol::direction(Deg(200.0 + 45.0 * f64::from(i))), step));
        let mut free = free.filter(|c| before.iter().all(|d| d.clear + radius <= c.distance(d.centre)));
        if mark.standing == Standing::Extra
            && let Some(beside) = free.next()
        {
            inks.push(Ink::line(place, beside, thin, palette::TEXT));
            centre = beside;
        }
    }
    if radius < true_radius {
        inks.push(Ink::Ring {
            centre: place,
            radius: true_radius,
            width: thin,
            dash: Dash::Solid,
            color: palette::TEXT,
        });
    }
    inks.extend(symbol::standing(mark.standing, centre, radius));
    if let Some(direction) = mark.direction {
        let projected = libm::hypot(direction[0], direction[1]);
        if 0.02 < projected && 0.45 * text <= dials.badge {
            let along = [direction[0] / projected, -direction[1] / projected];
            inks.extend(axis_arrow(centre, along, projected, radius * 1.15, text, field));
        }
    }
    Drawn { centre, clear: radius * 1.2 + 0.15 * text, inks, cut: false }
}

/// The part of the hole's axis that is seen: longer, the more the hole lies across the view.
fn axis_arrow(
    centre: Px,
    along: [f64; 2],
    projected: f64,
    from: f64,
    text: f64,
    field: &mut Field,
) -> Vec<Ink> {
    let start = centre.toward(along, from);
    let end = centre.toward(along, from + text * (0.55 + 1.3 * projected));
    field.block(Obstacle::Segment(start, end));
    symbol::arrow(start, end, (0.08 * text).max(1.0), 0.5 * text, palette::TEXT)
}

/// A place for the verdict on the dial's rim that the arrow at `arrow` leaves free: upper right if possible.
fn badge_angle(arrow: Deg) -> Deg {
    let apart = |angle: f64| {
        let turn = (angle - arrow.0).rem_euclid(360.0);
        turn.min(360.0 - turn)
    };
    let choices = [45.0, 135.0, -45.0, -135.0];
    Deg(choices.into_iter().find(|a| 60.0 <= apart(*a)).unwrap_or(45.0))
}
