//! Letters holes and lines: as many lines of every label as there is room for, and a note of what had none.
use super::font::{ASCENT, DESCENT};
use super::ink::{Ink, Px, Rect, px};
use super::labels::{Field, Spot};
use super::marks::Drawn;
use super::palette;
use super::scene::{Scene, Shape};
use super::sheet::Frame;
use super::symbol;
use crate::units::Deg;

/// Beyond so many holes labels could not be told apart: the most important ones get theirs.
const LABEL_LIMIT: usize = 400;

/// Height of a line of text in parts of its size.
const LEADING: f64 = 1.18;

/// Labels every hole, all with as many lines as all have room for; says what found no place.
pub(super) fn label_marks(
    scene: &Scene,
    drawn: &[Drawn],
    frame: &Frame,
    field: &mut Field,
    inks: &mut Vec<Ink>,
    labels: &mut Vec<(Rect, Vec<String>)>,
) -> Vec<String> {
    let mut order: Vec<usize> = (0..scene.marks.len()).collect();
    order.sort_by_key(|i| (scene.marks[*i].standing, *i));
    order.truncate(LABEL_LIMIT);
    let most = scene.marks.iter().map(|m| m.label.len()).max().unwrap_or(0);
    let reach = if scene.marks.len() <= 60 { 8 } else { 4 };

    let mut best: Option<(Field, Vec<(usize, Spot, usize)>, usize)> = None;
    for lines in (1..=most).rev() {
        let mut trial = field.clone();
        let mut spots = Vec::new();
        for i in &order {
            let mark = &scene.marks[*i];
            let full = if mark.standing.is_good() { lines } else { most };
            let tries = (1..=full.min(mark.label.len())).rev().filter(|n| *n <= lines || *n == full);
            for n in tries {
                let box_size = text_box(&mark.label[..n], frame);
                let line = frame.text * LEADING;
                if let Some(spot) = trial.place(drawn[*i].centre, drawn[*i].clear, box_size, line, reach) {
                    spots.push((*i, spot, n));
                    break;
                }
            }
        }
        let done = spots.len() == order.len()
            && spots.iter().all(|(i, _, n)| lines.min(scene.marks[*i].label.len()) <= *n);
        let better = best.as_ref().is_none_or(|(_, old, _)| old.len() < spots.len());
        if done || better {
            best = Some((trial, spots, lines));
        }
        if done {
            break;
        }
    }
    let Some((trial, spots, _)) = best else { return Vec::new() };
    *field = trial;
    for (i, spot, n) in &spots {
        let lines = scene.marks[*i].label[..*n].to_vec();
        if let Some((from, to)) = spot.leader {
            inks.push(Ink::line(from, to, (0.05 * frame.text).max(1.0), palette::THIN));
        }
        write(&lines, spot.rect, frame, inks);
        labels.push((spot.rect, lines));
    }
    let mut notes = Vec::new();
    let without = scene.marks.iter().filter(|m| !m.label.is_empty()).count() - spots.len();
    if 0 < without {
        notes.push(format!("{without} of {} holes without a number: no room", scene.marks.len()));
    }
    let cut = spots.iter().filter(|(i, _, n)| *n < scene.marks[*i].label.len()).count();
    if 0 < cut {
        notes.push(format!("{cut} labels shortened: no room"));
    }
    notes
}

/// Radii and the like, on their lines: at 8 places round a circle, at thirds of a straight line.
pub(super) fn caption_strokes(
    scene: &Scene,
    frame: &Frame,
    field: &mut Field,
    inks: &mut Vec<Ink>,
    labels: &mut Vec<(Rect, Vec<String>)>,
) {
    for stroke in &scene.strokes {
        let Some(caption) = &stroke.caption else { continue };
        let lines = vec![caption.clone()];
        let places: Vec<Px> = match &stroke.shape {
            Shape::Circle { centre, radius } => {
                let (centre, radius) = (frame.scale.px(*centre), radius * frame.scale.factor);
                let angles = (0..48).map(|i| Deg(f64::from(i) * 7.5 + 225.0));
                angles.map(|angle| centre.toward(symbol::direction(angle), radius)).collect()
            }
            Shape::Line(points) => {
                let middles =
                    points.windows(2).map(|w| [(w[0][0] + w[1][0]) / 2.0, (w[0][1] + w[1][1]) / 2.0]);
                middles.map(|p| frame.scale.px(p)).collect()
            }
        };
        let size = text_box(&lines, frame);
        if let Some(spot) = field.place_on(places, size) {
            write(&lines, spot.rect, frame, inks);
            labels.push((spot.rect, lines));
        }
    }
}

fn text_box(lines: &[String], frame: &Frame) -> (f64, f64) {
    let widest = lines.iter().map(|l| frame.font.width(l, frame.text)).fold(0.0, f64::max);
    let height = frame.text * (LEADING * (lines.len() as f64 - 1.0) + ASCENT + DESCENT);
    (widest + 0.3 * frame.text, height + 0.1 * frame.text)
}

/// The lines in a box that interrupts what is below it, as a dimension interrupts its line.
fn write(lines: &[String], rect: Rect, frame: &Frame, inks: &mut Vec<Ink>) {
    inks.push(Ink::area(rect, palette::PAPER));
    for (n, line) in lines.iter().enumerate() {
        let y = rect.top + frame.text * (0.05 + ASCENT + LEADING * n as f64);
        let color = if n == 0 { palette::TEXT } else { palette::SOFT_TEXT };
        inks.push(Ink::text(px(rect.left + 0.15 * frame.text, y), frame.text, line.clone(), color));
    }
}
