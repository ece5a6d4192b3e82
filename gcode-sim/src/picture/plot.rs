//! Curves over a way: two axes with numbers, a line at zero, and limits.
use super::font::Font;
use super::ink::{Align, Dash, Ink, Px, Rect, px};
use super::palette;
use super::scene::{Pen, Point, Standing};
use super::sheet::Sheet;
use super::size::Size;
use super::words::Words;
use super::{PictureError, paint, png};

/// A picture of curves.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plot {
    pub title: String,
    /// Lines below the title.
    pub notes: Vec<String>,
    /// What is counted to the right, with its unit.
    pub across: String,
    /// What is counted upwards, with its unit.
    pub up: String,
    /// Each drawn as one line.
    pub curves: Vec<Vec<Point>>,
    /// From where to where nothing is known, marked as such.
    pub gaps: Vec<[f64; 2]>,
    /// Dashed lines so far above and below zero.
    pub limit: Option<f64>,
}

impl Plot {
    /// As a PNG file of exactly this size.
    ///
    /// # Errors
    /// What the encoder has to say.
    pub fn draw(&self, size: Size) -> Result<Vec<u8>, PictureError> {
        png(&paint(&self.lay_out(size)))
    }

    /// The title and notes stand above, the numbers of the axes below and on the left.
    pub fn lay_out(&self, size: Size) -> Sheet {
        let font = Font::embedded();
        let text = size.text();
        let page = Rect::new(0.0, 0.0, f64::from(size.width()), f64::from(size.height())).grown(-2.0 * text);
        let mut words = Words::new(&font, text);
        let soft = palette::SOFT_TEXT;
        let y = words.head(&page, &self.title, &self.notes) + 2.4 * text;
        words.write(px(page.left, y), Align::Left, text, soft, &self.up, page.width());
        let all = || self.curves.iter().flatten();
        let (right, left) = spread(all().map(|p| p[0]).chain(self.gaps.iter().flatten().copied()), 1.0);
        let (high, low) =
            spread(all().map(|p| p[1]).chain(self.limit.into_iter().flat_map(|l| [l, -l])), 1e-3);
        let room = 0.05 * (high - low);
        let (high, low) = (high + room, low - room);
        let upwards = Ticks::over(low, high, 10.0);
        let across = Ticks::over(left, right, 10.0);
        let widest = upwards.all().map(|at| font.width(&upwards.name(at), text)).fold(0.0, f64::max);
        let frame = Rect {
            left: page.left + widest + text,
            top: y + text,
            right: page.right - 2.0 * text,
            bottom: page.bottom - 3.4 * text,
        };
        let place = |[x, y]: Point| {
            px(
                frame.left + frame.width() * (x - left) / (right - left),
                frame.bottom - frame.height() * (y - low) / (high - low),
            )
        };
        let grid = palette::pen(Pen::Grid, text);
        let mut rule = |from: Px, to: Px, (color, width, dash)| {
            words.inks.push(Ink::Line { points: vec![from, to], closed: false, width, dash, color });
        };
        for at in upwards.all() {
            rule(place([left, at]), place([right, at]), grid);
        }
        for at in across.all() {
            rule(place([at, low]), place([at, high]), grid);
        }
        rule(place([left, 0.0]), place([right, 0.0]), (palette::TEXT, 0.08 * text, Dash::Solid));
        for limit in self.limit.into_iter().flat_map(|limit| [limit, -limit]) {
            let color = palette::standing(Standing::Bad);
            rule(
                place([left, limit]),
                place([right, limit]),
                (color, 0.12 * text, Dash::Pattern([0.8 * text, 0.5 * text])),
            );
        }
        for [from, to] in &self.gaps {
            let color = palette::standing(Standing::Bad);
            let dash = Dash::Pattern([0.25 * text, 0.35 * text]);
            for at in [*from, *to] {
                rule(place([at, low]), place([at, high]), (color, 0.1 * text, dash));
            }
            rule(place([*from, 0.0]), place([*to, 0.0]), (color, 0.4 * text, Dash::Solid));
        }
        for at in upwards.all() {
            let base = place([left, at]);
            words.write(
                px(frame.left - 0.5 * text, base.y + 0.36 * text),
                Align::Right,
                text,
                soft,
                &upwards.name(at),
                widest,
            );
        }
        for at in across.all() {
            let base = place([at, low]);
            words.write(
                px(base.x, frame.bottom + 1.4 * text),
                Align::Centre,
                text,
                soft,
                &across.name(at),
                frame.width(),
            );
        }
        let middle = px(frame.centre().x, page.bottom);
        words.write(middle, Align::Centre, text, soft, &self.across, frame.width());
        for curve in &self.curves {
            let points = curve.iter().map(|point| place(*point)).collect();
            let color = palette::standing(Standing::Good);
            words.inks.push(Ink::Line {
                points,
                closed: false,
                width: 0.12 * text,
                dash: Dash::Solid,
                color,
            });
        }
        let Words { inks, labels, .. } = words;
        Sheet { size, inks, labels, notes: Vec::new(), magnification: None }
    }
}

/// The largest and the least value, 0 among them; where they are as good as one, `least` apart.
fn spread(values: impl Iterator<Item = f64>, least: f64) -> (f64, f64) {
    let (high, low) = values.fold((0.0_f64, 0.0_f64), |(high, low), value| (high.max(value), low.min(value)));
    if high - low < least { (high.max(least), low) } else { (high, low) }
}

/// Round numbers along an axis.
struct Ticks {
    first: i64,
    last: i64,
    /// From one to the next: `of` times a power of ten.
    of: f64,
    power: i32,
}

impl Ticks {
    /// Steps of 1, 2 or 5 times a power of ten, at most so many.
    fn over(low: f64, high: f64, most: f64) -> Self {
        let rough = (high - low) / most;
        let power = libm::floor(libm::log10(rough)) as i32;
        let of = [1.0, 2.0, 5.0, 10.0].into_iter().find(|of| rough <= of * libm::pow(10.0, f64::from(power)));
        let of = of.unwrap_or(10.0);
        let step = of * libm::pow(10.0, f64::from(power));
        let rounding = 1e-9;
        Self {
            first: (low / step - rounding).ceil() as i64,
            last: (high / step + rounding).floor() as i64,
            of,
            power,
        }
    }

    fn step(&self) -> f64 {
        self.of * libm::pow(10.0, f64::from(self.power))
    }

    fn all(&self) -> impl Iterator<Item = f64> + '_ {
        (self.first..=self.last).map(|n| n as f64 * self.step())
    }

    /// With as many places as tell it from the next one.
    fn name(&self, at: f64) -> String {
        let power = if self.of < 10.0 { self.power } else { self.power + 1 };
        let places = usize::try_from(-power).unwrap_or(0);
        let name = format!("{at:.places$}");
        if name.bytes().all(|b| matches!(b, b'-' | b'0' | b'.')) { "0".to_owned() } else { name }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plot(high: f64, length: f64) -> Plot {
        let curve = (0..=100).map(|n| [length * f64::from(n) / 100.0, high * libm::sin(f64::from(n) / 15.0)]);
        Plot {
            title: "Readings of an edge finder along O8220.nc".to_owned(),
            notes: vec!["a note".to_owned(), "and another one".to_owned()],
            across: "Way of the ball, mm".to_owned(),
            up: "Reading, mm".to_owned(),
            curves: vec![curve.collect()],
            gaps: vec![[length / 3.0, length / 2.0]],
            limit: Some(high / 2.0),
        }
    }

    #[test]
    fn no_text_covers_another_and_all_are_on_the_sheet() {
        for (width, height) in [(1200, 800), (640, 480), (2000, 500)] {
            let size = Size::new(width, height).unwrap();
            for (high, length) in [(0.083, 652.3), (1e-5, 0.02), (4.9, 12_345.0), (0.0, 0.0)] {
                let sheet = plot(high, length).lay_out(size);
                let page = Rect::new(0.0, 0.0, f64::from(width), f64::from(height));
                for (index, (place, words)) in sheet.labels.iter().enumerate() {
                    assert!(page.contains(place), "{words:?} at {place:?}");
                    let free = sheet.labels[..index].iter().all(|(other, _)| !place.overlaps(other));
                    assert!(free, "{words:?} covers another, {width}x{height}, {high}");
                }
            }
        }
    }

    /// 0 to 83 in at most ten steps: tens. −0.012 to 0.03: 0.005.
    #[test]
    fn the_axes_have_round_numbers() {
        let names = |low, high| {
            let ticks = Ticks::over(low, high, 10.0);
            ticks.all().map(|at| ticks.name(at)).collect::<Vec<_>>().join(" ")
        };
        assert_eq!(names(0.0, 83.0), "0 10 20 30 40 50 60 70 80");
        assert_eq!(names(-0.012, 0.03), "-0.010 -0.005 0 0.005 0.010 0.015 0.020 0.025 0.030");
        assert_eq!(names(0.0, 100.0), "0 10 20 30 40 50 60 70 80 90 100");
        assert_eq!(names(-0.9, 0.85), "-0.8 -0.6 -0.4 -0.2 0 0.2 0.4 0.6 0.8");
    }

    /// Twice as high is twice as far above the line at zero.
    #[test]
    fn a_curve_stands_where_its_numbers_say() {
        let mut plot = plot(0.05, 100.0);
        plot.curves = vec![vec![[0.0, 0.0], [50.0, 0.02], [100.0, 0.04]]];
        let sheet = plot.lay_out(Size::default());
        let Some(Ink::Line { points, .. }) = sheet.inks.last() else { panic!("the curve comes last") };
        let (first, middle, last) = (points[0], points[1], points[2]);
        assert!((first.y - middle.y - (middle.y - last.y)).abs() < 1e-9 && first.y - last.y > 300.0);
        assert!((middle.x - first.x - (last.x - middle.x)).abs() < 1e-9 && last.x - first.x > 1000.0);
    }
}
