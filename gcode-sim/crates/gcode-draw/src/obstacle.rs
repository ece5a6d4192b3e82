//! Obstacles on a sheet for labels and their leaders.
use super::ink::{Px, Rect, px};

/// An area or line that labels must not cover.
#[derive(Clone, Copy, Debug)]
pub(super) enum Obstacle {
    Box(Rect),
    Disc {
        centre: Px,
        radius: f64,
    },
    /// A circle's line; its inside is free.
    Ring {
        centre: Px,
        radius: f64,
    },
    Segment(Px, Px),
}

impl Obstacle {
    pub(super) fn bounds(&self) -> Rect {
        match *self {
            Self::Box(rect) => rect,
            Self::Disc { centre, radius } | Self::Ring { centre, radius } => {
                Rect::around(centre, (2.0 * radius, 2.0 * radius))
            }
            Self::Segment(a, b) => Rect::enclosing(a, &[b]),
        }
    }

    /// Returns true if a label in `rect` would cover part of the obstacle.
    pub(super) fn hits(&self, rect: &Rect) -> bool {
        match *self {
            Self::Box(other) => other.overlaps(rect),
            Self::Disc { centre, radius } => rect.nearest(centre).distance(centre) < radius,
            Self::Ring { centre, radius } => {
                rect.nearest(centre).distance(centre) <= radius && radius <= rect.farthest(centre)
            }
            Self::Segment(a, b) => enters(rect, a, b),
        }
    }

    /// Returns true if a leader would cross the obstacle; it may cross the thin line of a circle.
    pub(super) fn crosses(&self, from: Px, to: Px) -> bool {
        match *self {
            Self::Box(rect) => enters(&rect, from, to),
            Self::Disc { centre, radius } => distance_to(centre, from, to) < radius * 0.98,
            Self::Ring { .. } => false,
            Self::Segment(a, b) => {
                let side = |p: Px, q: Px, r: Px| (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
                side(a, b, from) * side(a, b, to) <= 0.0 && side(from, to, a) * side(from, to, b) <= 0.0
            }
        }
    }
}

/// Returns true if a segment has points inside the rectangle (clipping by Liang and Barsky).
fn enters(rect: &Rect, a: Px, b: Px) -> bool {
    let (dx, dy) = (b.x - a.x, b.y - a.y);
    let (mut first, mut last) = (0.0f64, 1.0f64);
    for (slope, room) in
        [(-dx, a.x - rect.left), (dx, rect.right - a.x), (-dy, a.y - rect.top), (dy, rect.bottom - a.y)]
    {
        if slope == 0.0 {
            if room < 0.0 {
                return false;
            }
        } else if slope < 0.0 {
            first = first.max(room / slope);
        } else {
            last = last.min(room / slope);
        }
    }
    first < last
}

fn distance_to(point: Px, a: Px, b: Px) -> f64 {
    let (dx, dy) = (b.x - a.x, b.y - a.y);
    let square = (dx * dx + dy * dy).max(1e-12);
    let along = (((point.x - a.x) * dx + (point.y - a.y) * dy) / square).clamp(0.0, 1.0);
    point.distance(px(a.x + along * dx, a.y + along * dy))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_inside_a_ring_is_off_its_line() {
        let ring = Obstacle::Ring { centre: px(0.0, 0.0), radius: 10.0 };
        assert!(!ring.hits(&Rect::new(-5.0, -5.0, 10.0, 10.0)));
        assert!(ring.hits(&Rect::new(5.0, -2.0, 10.0, 4.0)));
        assert!(!ring.hits(&Rect::new(8.0, 8.0, 5.0, 5.0)));
    }

    #[test]
    fn a_segment_hits_the_boxes_it_passes() {
        let segment = Obstacle::Segment(px(0.0, 0.0), px(10.0, 10.0));
        assert!(segment.hits(&Rect::new(4.0, 4.0, 2.0, 2.0)));
        assert!(!segment.hits(&Rect::new(0.0, 5.0, 3.0, 3.0)));
        assert!(!segment.hits(&Rect::new(11.0, 11.0, 3.0, 3.0)));
    }

    #[test]
    fn a_leader_crosses_lines_and_discs_but_not_rings() {
        let (from, to) = (px(0.0, 5.0), px(10.0, 5.0));
        assert!(Obstacle::Segment(px(5.0, 0.0), px(5.0, 10.0)).crosses(from, to));
        assert!(!Obstacle::Segment(px(15.0, 0.0), px(15.0, 10.0)).crosses(from, to));
        assert!(Obstacle::Disc { centre: px(5.0, 7.0), radius: 3.0 }.crosses(from, to));
        assert!(!Obstacle::Disc { centre: px(5.0, 9.0), radius: 3.0 }.crosses(from, to));
        assert!(!Obstacle::Ring { centre: px(5.0, 7.0), radius: 3.0 }.crosses(from, to));
    }
}
