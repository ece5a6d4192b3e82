//! The development: a cylinder about x, cut open along one line and unrolled.
//!
//! It is seen from outside: the azimuth (from z towards y) increases to the right, from 0 to 360, and x
//! increases downwards. The cut is the seam: its left and right edges are the same line of the part. A
//! development much longer round than along x is cut into strips, one below the other, so that holes are as
//! large as the sheet allows.
use super::top::{Cylinder, DrawnHole, MAX_NUMBERED, TopView, number_few};
use crate::measure::{bar_length, plain};
use crate::picture::{LegendItem, Picture, Sample};
use crate::scene::{Axis, Mark, Pen, Point, Scene, Shape, Stroke, ZoneDeviation};
use gcode_lang::units::Deg;

/// Builds the picture of a development; `None` if the part is not a cylinder.
pub fn development(view: &TopView) -> Option<Picture> {
    let sheet = UnrolledCylinder::of(view.cylinder?, view);
    let mut marks: Vec<Mark> = view.holes.iter().filter_map(|hole| sheet.mark(hole, view)).collect();
    number_few(&mut marks);
    let what = format!("Development of diameter {}, seen from outside", plain(2.0 * sheet.cylinder.radius));
    let turn = if view.is_rotary_reversed { "−" } else { "" };
    let axes = vec![Axis { name: format!("{turn}{}", view.rotary), direction: [1.0, 0.0] }];
    let legend = sheet.legend(view, &marks);
    let title = view.title(what, view.tolerance, Some(sheet.range()));
    let scene = Scene { axes, strokes: sheet.strokes(), marks, zone: view.tolerance };
    Some(Picture { title, scene, legend, table: view.table(), ..Picture::default() })
}

/// Possible numbers of strips: every strip spans a whole number of degrees.
const STRIPS: [u32; 7] = [1, 2, 3, 4, 6, 8, 12];
/// Approximate width over height of a sheet's drawing.
const SHEET: f64 = 1.05;
/// Least gain in hole size that justifies more strips.
const WORTH: f64 = 1.15;

/// Maps the cylinder to the sheet, mm.
struct UnrolledCylinder {
    cylinder: Cylinder,
    strips: u32,
    /// Range of x with nominal or actual holes.
    low: f64,
    high: f64,
    /// Radius of a hole drilled by a tool of unknown diameter.
    usual: f64,
    /// Whether the holes are few enough for dials, from which the scales keep clear.
    few: bool,
}

impl UnrolledCylinder {
    /// Chooses the number of strips that draws the holes largest.
    fn of(cylinder: Cylinder, view: &TopView) -> Self {
        let shown = view.holes.iter().filter_map(DrawnHole::shown);
        let reach = |(low, high): (f64, f64), x: f64| (low.min(x), high.max(x));
        let (low, high) = shown.map(|hole| hole.entry[0]).fold((0.0, cylinder.length), reach);
        let diameter = view.holes.iter().find_map(|hole| hole.nominal.as_ref()?.diameter);
        let (usual, few) = (diameter.unwrap_or(0.0) / 2.0, view.holes.len() <= MAX_NUMBERED);
        let cut = |strips: u32| Self { cylinder, strips, low, high, usual, few };
        let scale = |sheet: &Self| {
            let wide = 1.1 * sheet.width() + sheet.margin();
            (SHEET / wide).min(1.0 / (f64::from(sheet.strips) * sheet.height()))
        };
        let better = |best: Self, next: Self| if WORTH * scale(&best) < scale(&next) { next } else { best };
        STRIPS.into_iter().skip(1).map(cut).fold(cut(1), better)
    }

    fn range(&self) -> String {
        format!("rows r0 to r{}, x 0 to {}", self.cylinder.rows.max(1) - 1, plain(self.cylinder.length))
    }

    /// Returns the width of one strip.
    fn width(&self) -> f64 {
        std::f64::consts::TAU * self.cylinder.radius / f64::from(self.strips)
    }

    /// Returns the length of the ticks that carry numbers.
    fn tick(&self) -> f64 {
        0.05 * self.width()
    }

    /// Returns the distance from the holes to their scales, which no dial exceeds (see
    /// `Frame::largest_dial`).
    fn margin(&self) -> f64 {
        if self.few { 0.065 * self.width() } else { 0.01 * self.width() }
    }

    /// Returns the pitch of the strips: holes, numbers above and below, and a gap.
    fn height(&self) -> f64 {
        self.high - self.low + 2.0 * self.margin() + 2.4 * self.tick()
    }

    /// Returns the strip of an azimuth and its distance from the left edge. A hole on the seam or on a cut
    /// lies at the left, whatever the rounding.
    fn right(&self, azimuth: Deg) -> (u32, f64) {
        let turn = azimuth.0.rem_euclid(360.0);
        let turn = if turn > 360.0 - 1e-3 { turn - 360.0 } else { turn };
        let span = 360.0 / f64::from(self.strips);
        let strip = ((turn + 1e-3) / span).floor().clamp(0.0, f64::from(self.strips - 1));
        (strip as u32, Deg(turn - strip * span).to_rad() * self.cylinder.radius)
    }

    /// Returns the ordinate of x on a strip; 0 − x avoids negative zeros.
    fn down(&self, strip: u32, x: f64) -> f64 {
        0.0 - (f64::from(strip) * self.height() + x)
    }

    fn mark(&self, hole: &DrawnHole, view: &TopView) -> Option<Mark> {
        let shown = hole.shown()?;
        let (strip, right) = self.right(Deg::atan2(shown.entry[1], shown.entry[2]));
        // Along the circumference and along x.
        let azimuth = Deg::atan2(shown.axis[1], shown.axis[2]);
        let seen = |[x, y, z]: [f64; 3]| [y * azimuth.cos() - z * azimuth.sin(), 0.0 - x];
        let deviation = hole.deviation();
        Some(Mark {
            radius: shown.diameter.map_or(self.usual, |diameter| diameter / 2.0),
            label: view.label(hole),
            deviation: deviation
                .map(|off| ZoneDeviation { entry: seen(off.entry), bottom: seen(off.bottom) }),
            ..Mark::new([right, self.down(strip, shown.entry[0])], hole.status)
        })
    }

    /// Draws the edges of every strip, the ends of the pattern, and scales: rows above, degrees below, x at
    /// the left.
    fn strokes(&self) -> Vec<Stroke> {
        let (width, length, tick) = (self.width(), self.cylinder.length, self.tick());
        let mut strokes = Vec::new();
        for strip in 0..self.strips {
            let y = |x: f64| self.down(strip, x);
            let (top, bottom) = (y(self.low) + self.margin(), y(self.high) - self.margin());
            let left = 0.0 - self.margin();
            let mut line = |from: Point, to: Point, pen: Pen, caption: Option<String>| {
                strokes.push(Stroke { caption, ..Stroke::new(pen, Shape::Line(vec![from, to])) });
            };
            for (at, is_seam) in [(0.0, strip == 0), (width, strip + 1 == self.strips)] {
                let pen = if is_seam { Pen::Outline } else { Pen::Construction };
                line([at, y(0.0)], [at, y(length)], pen, None);
            }
            for x in [0.0, length] {
                line([0.0, y(x)], [width, y(x)], Pen::Construction, None);
            }
            for part in 0..=4u32 {
                let at = width * f64::from(part) / 4.0;
                let degrees = 360.0 * (f64::from(strip) + f64::from(part) / 4.0) / f64::from(self.strips);
                let caption = Some(format!("{}°", plain(degrees)));
                line([at, bottom], [at, bottom - tick], Pen::Scale, caption);
            }
            for x in marks_along(length, (length / 6.0).max(0.04 * width)) {
                let caption = Some(if x == 0.0 { "x 0".to_owned() } else { plain(x) });
                line([left, y(x)], [left - 0.6 * tick, y(x)], Pen::Scale, caption);
            }
            for (row, at, is_named) in self.rows(strip) {
                let caption = is_named.then(|| format!("r{row}"));
                let long = if is_named { tick } else { 0.3 * tick };
                line([at, top], [at, top + long], Pen::Scale, caption);
            }
        }
        strokes
    }

    /// Returns the rows of a strip with a tick: row, position, and whether it is numbered. All rows are
    /// numbered if there is room, else every fifth, tenth and so on; ticks that would collide are limited to
    /// the numbered rows.
    fn rows(&self, strip: u32) -> impl Iterator<Item = (u32, f64, bool)> {
        let apart = self.width() * f64::from(self.strips) / f64::from(self.cylinder.rows);
        let least = 0.09 * self.width() / apart;
        let named = [1, 5, 10, 50, 100, 500, 1000].into_iter().find(|every| least <= f64::from(*every));
        let named = named.unwrap_or(5000u32);
        let every = if apart < 0.008 * self.width() { named } else { 1 };
        let step = 360.0 / f64::from(self.cylinder.rows);
        let all = (0..self.cylinder.rows).step_by(every as usize);
        let placed = all.map(move |row| (row, self.right(Deg(f64::from(row) * step))));
        let here = placed.filter(move |(_, (on, _))| *on == strip);
        here.map(move |(row, (_, at))| (row, at, row % named == 0))
    }

    fn legend(&self, view: &TopView, marks: &[Mark]) -> Vec<LegendItem> {
        let mut items = view.status_legend(marks);
        let thin = match self.strips {
            1 => "ends of the pattern",
            _ => "cuts: continued on the next strip; ends of the pattern",
        };
        items.push(LegendItem::new(Sample::Pen(Pen::Outline), "seam: both edges are one line"));
        items.push(LegendItem::new(Sample::Pen(Pen::Construction), thin));
        items
    }
}

/// Returns the multiples of a round number from 0 on, at least `least` apart, and the end.
fn marks_along(end: f64, least: f64) -> Vec<f64> {
    // A bar is at least 1/2.5 of its largest length.
    let step = bar_length(2.5 * least);
    let all = (0u32..).map(|n| f64::from(n) * step).take_while(|at| *at < end - least);
    all.chain([end]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use gcode_part::Hole;

    fn hole(x: f64, azimuth: f64, radius: f64) -> Hole {
        let (s, c) = (Deg(azimuth).sin(), Deg(azimuth).cos());
        let entry = [x, radius * s, radius * c];
        Hole { id: None, entry, axis: [0.0, s, c], depth: 5.0, diameter: Some(3.0), ..Hole::default() }
    }

    /// Draws a hole on a cylinder of radius 100 with 8 rows.
    fn scene(nominal: Option<Hole>, actual: Hole, length: f64) -> Scene {
        let cylinder = Some(Cylinder { outer: 110.0, radius: 100.0, length, rows: 8 });
        let hole = DrawnHole { nominal, actual: Some(actual), ..DrawnHole::default() };
        development(&TopView { cylinder, holes: vec![hole], ..TopView::default() }).unwrap().scene
    }

    fn mark(nominal: Hole, actual: Hole, length: f64) -> Mark {
        scene(Some(nominal), actual, length).marks.remove(0)
    }

    /// A quarter turn of radius 100 is 157.08 mm, whatever the diameter on which the hole begins.
    #[test]
    fn azimuth_goes_right_as_an_arc_and_x_down() {
        let mark = mark(hole(20.0, 90.0, 110.0), hole(20.0, 90.0, 112.0), 400.0);
        assert!((mark.position[0] - 157.079_632_679).abs() < 1e-6 && mark.position[1] == -20.0, "{mark:?}");
    }

    #[test]
    fn a_hole_on_the_seam_is_drawn_at_the_left_edge() {
        for azimuth in [0.0, 360.0, -0.000_1, 359.999_9] {
            let mark = mark(hole(0.0, azimuth, 100.0), hole(0.0, azimuth, 100.0), 400.0);
            assert!(mark.position[0].abs() < 0.001, "{azimuth}: {mark:?}");
        }
        let mark = mark(hole(0.0, -1.0, 100.0), hole(0.0, -1.0, 100.0), 400.0);
        assert!((mark.position[0] - 359.0 * 100.0 * std::f64::consts::PI / 180.0).abs() < 1e-6);
    }

    /// 0.02 mm towards larger azimuth at 90°, which is −z there, and 0.03 mm in x.
    #[test]
    fn a_deviation_points_from_nominal_to_actual() {
        let mut found = hole(20.03, 90.0, 100.0);
        found.entry[2] -= 0.02;
        let deviation = mark(hole(20.0, 90.0, 100.0), found, 400.0).deviation.unwrap();
        assert!(
            (deviation.entry[0] - 0.02).abs() < 1e-9 && (deviation.entry[1] + 0.03).abs() < 1e-9,
            "{deviation:?}"
        );
    }

    /// 628 mm round and 30 mm long: three strips of 120°.
    #[test]
    fn a_long_circumference_is_cut_into_strips_and_no_hole_lies_across_a_cut() {
        let at = |azimuth: f64| mark(hole(20.0, azimuth, 100.0), hole(20.0, azimuth, 100.0), 30.0).position;
        let third = 209.439_510_239;
        let block = at(0.0)[1] - at(120.0)[1];
        assert!(30.0 < block && block < 90.0, "{block}");
        for (azimuth, right, down) in [
            (0.0, 0.0, 0.0),
            (119.0, 119.0 / 120.0 * third, 0.0),
            (120.0, 0.0, block),
            (119.999_999, 0.0, block),
            (250.0, 10.0 / 120.0 * third, 2.0 * block),
            (359.999_999, 0.0, 0.0),
        ] {
            let at = at(azimuth);
            let off = libm::hypot(at[0] - right, at[1] + 20.0 + down);
            assert!(off < 1e-5, "{azimuth}: {at:?}, nominal {right} {down}");
        }
    }

    /// A rotary axis of opposite sign presents a hole at minus its azimuth.
    #[test]
    fn the_axis_is_named_as_the_rotary_counts() {
        let cylinder = Some(Cylinder { outer: 110.0, radius: 100.0, length: 60.0, rows: 8 });
        let name = |backwards: bool| {
            let view = TopView {
                cylinder,
                is_rotary_reversed: backwards,
                rotary: "A".to_owned(),
                ..TopView::default()
            };
            development(&view).unwrap().scene.axes.remove(0).name
        };
        assert_eq!((name(false), name(true)), ("A".to_owned(), "−A".to_owned()));
    }

    /// With 100 rows on one strip every tenth is numbered and the others have a tick; with 8 rows all are
    /// numbered.
    #[test]
    fn rows_without_a_number_have_a_tick() {
        let of = |rows: u32| {
            let cylinder = Some(Cylinder { outer: 110.0, radius: 100.0, length: 400.0, rows });
            let scene = development(&TopView { cylinder, ..TopView::default() }).unwrap().scene;
            let named = scene.strokes.iter().filter_map(|stroke| stroke.caption.clone());
            let named: Vec<String> = named.filter(|caption| caption.starts_with('r')).collect();
            (named, scene.strokes.len())
        };
        let (named, strokes) = of(100);
        assert_eq!(named.join(" "), "r0 r10 r20 r30 r40 r50 r60 r70 r80 r90");
        let (few, fewer_strokes) = of(8);
        assert_eq!((few.len(), strokes - fewer_strokes), (8, 92));
    }

    /// A hole far beyond the length must not land on the next strip.
    #[test]
    fn a_hole_beyond_the_length_does_not_reach_the_next_strip() {
        let scene = scene(None, hole(170.0, 0.0, 100.0), 30.0);
        let zeros = scene.strokes.iter().filter(|stroke| stroke.caption.as_deref() == Some("x 0")).count();
        assert_eq!(zeros, 2, "of 170, not of 30, which would be cut into three");
    }
}
