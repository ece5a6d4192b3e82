//! Round numbers and scales: the scale bar, the magnification of deviations, and mm to pixels.
use super::font::Font;
use super::ink::{Px, Rect, px};
use super::scene::Point;

/// Largest number of labelled holes: more labels are illegible, and the most important ones are kept.
pub(super) const LABEL_LIMIT: usize = 400;

/// Values shared by all layout steps.
pub(super) struct Frame {
    pub(super) font: Font,
    /// Size of ordinary text, pixels.
    pub(super) text_size: f64,
    pub(super) scale: Scale,
    /// Radius in pixels beyond which a dial would hide the part.
    pub(super) largest_dial: f64,
    /// Distance by which the axis arrows exceed the part, pixels.
    pub(super) axis_reach: f64,
}

/// Maps the drawing's mm to pixels, with the same scale in both directions.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scale {
    /// Pixels per mm.
    pub(super) factor: f64,
    pub(super) origin: Px,
}

impl Scale {
    /// Returns the largest scale at which `extent` (two corners, mm) fits into `area`, centred.
    pub(super) fn fitting(extent: (Point, Point), area: Rect) -> Self {
        let (low, high) = extent;
        let (wide, tall) = ((high[0] - low[0]).max(1e-6), (high[1] - low[1]).max(1e-6));
        let factor = (area.width() / wide).min(area.height() / tall);
        let middle = area.centre();
        let origin =
            px(middle.x - factor * (low[0] + high[0]) / 2.0, middle.y + factor * (low[1] + high[1]) / 2.0);
        Self { factor, origin }
    }

    pub(super) fn px(&self, at: Point) -> Px {
        px(self.origin.x + self.factor * at[0], self.origin.y - self.factor * at[1])
    }
}

/// Returns the largest of `steps`·10ⁿ that is not above `most`.
fn round_below(most: f64, steps: &[f64]) -> f64 {
    let decade = libm::pow(10.0, libm::floor(libm::log10(most)));
    // Rounding may make the decade one too high or low if `most` is a power of ten.
    let candidates = [decade / 10.0, decade, decade * 10.0].into_iter();
    let all = candidates.flat_map(|d| steps.iter().map(move |s| s * d));
    all.filter(|c| *c <= most * (1.0 + 1e-12)).fold(decade / 10.0, f64::max)
}

/// Returns the length of a scale bar: the largest of 1, 2, 5 times a power of ten up to `most` mm.
pub(super) fn bar_length(most: f64) -> f64 {
    round_below(most, &[1.0, 2.0, 5.0])
}

/// Returns the magnification of deviations: the largest easy number up to `most`.
pub(super) fn magnification(most: f64) -> f64 {
    round_below(most, &[1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0])
}

/// Formats a round number with the digits it needs: `500`, `0.02`.
pub(super) fn plain(number: f64) -> String {
    let text = format!("{number:.6}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_scale_bar_has_a_round_length() {
        let cases = [
            (260.0, 200.0),
            (200.0, 200.0),
            (199.9, 100.0),
            (1000.0, 1000.0),
            (999.0, 500.0),
            (0.7, 0.5),
            (0.001, 0.001),
        ];
        for (most, length) in cases {
            assert!((bar_length(most) - length).abs() < 1e-9 * length, "{most}: {}", bar_length(most));
        }
        assert_eq!(plain(bar_length(0.03)), "0.02");
        assert_eq!(plain(500.0), "500");
    }

    #[test]
    fn a_magnification_is_an_easy_number() {
        assert_eq!(plain(magnification(1730.0)), "1500");
        assert_eq!(plain(magnification(999.0)), "800");
        assert_eq!(plain(magnification(2000.0)), "2000");
    }

    #[test]
    fn up_in_the_drawing_is_up_on_the_sheet() {
        let area = Rect::new(10.0, 20.0, 200.0, 100.0);
        let scale = Scale::fitting(([-1.0, -1.0], [1.0, 1.0]), area);
        assert_eq!(scale.px([0.0, 0.0]), px(110.0, 70.0));
        assert_eq!(scale.px([0.0, 1.0]), px(110.0, 20.0));
    }

    proptest! {
        #[test]
        fn a_bar_fits_and_fills_two_fifths_of_its_room(most in 1e-4f64..1e6) {
            let length = bar_length(most);
            prop_assert!(length <= most * (1.0 + 1e-9));
            prop_assert!(most / 2.5 <= length * (1.0 + 1e-9));
        }
    }
}
