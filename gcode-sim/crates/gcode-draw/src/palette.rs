//! Colours and line styles of the pens and statuses: Okabe and Ito's palette, safe for colour-blind readers,
//! on white.
//!
//! Colour never carries meaning alone: every status has its own shape and mark (`symbol`), every pen its own
//! width or dash pattern.
use super::ink::{Ink, Rgb};
use super::scene::{HoleStatus, Pen, Style, Tint};

pub(super) const PAPER: Rgb = Rgb(255, 255, 255);
pub(super) const TEXT: Rgb = Rgb(0, 0, 0);
pub(super) const SOFT_TEXT: Rgb = Rgb(70, 70, 70);
/// Leaders, direction arrows, tolerance zones.
pub(super) const THIN: Rgb = Rgb(90, 90, 90);
/// Tolerance band of a graph.
pub(super) const BAND: Rgb = Rgb(238, 238, 238);
/// Frames and rules between the parts of a sheet.
pub(super) const RULE: Ink = Ink::solid(1.0, Rgb(150, 150, 150));

pub(super) const BLUE: Rgb = Rgb(0, 114, 178);
pub(super) const VERMILION: Rgb = Rgb(213, 94, 0);

pub(super) fn status_colour(status: HoleStatus) -> Rgb {
    match status {
        HoleStatus::Good => BLUE,
        HoleStatus::Bad => VERMILION,
        HoleStatus::Missing => TEXT,
        HoleStatus::Extra => Rgb(230, 159, 0),
        HoleStatus::Unjudged => THIN,
    }
}

/// Returns a thin solid line at a text height of `text` pixels.
pub(super) fn thin(text: f64, color: Rgb) -> Ink {
    Ink::solid(0.06 * text, color)
}

/// Returns the line of a tolerance zone at a text height of `text` pixels: a chain line, which no edge of a part has.
pub(super) fn zone(text: f64) -> Ink {
    Ink { dash: Some([0.5, 0.16, 0.12, 0.16].map(|length| length * text)), ..thin(text, THIN) }
}

/// Returns the line of a leader from a label at a text height of `text` pixels.
pub(super) fn leader(text: f64) -> Ink {
    Ink::solid(0.05 * text, THIN)
}

/// Dark end to light end of the scale of shades: viridis without its bright end, which is faint on white. Lightness grows
/// steadily, so that the order shows without colour too.
const SHADES: [Rgb; 7] = [
    Rgb(68, 1, 84),
    Rgb(72, 35, 116),
    Rgb(64, 67, 135),
    Rgb(52, 94, 141),
    Rgb(41, 120, 142),
    Rgb(32, 144, 140),
    Rgb(53, 183, 121),
];

/// Returns the colour of a value on a scale from 0 to 1.
pub(super) fn shade(value: f64) -> Rgb {
    let at = value.clamp(0.0, 1.0) * (SHADES.len() - 1) as f64;
    let index = (at as usize).min(SHADES.len() - 2);
    let (Rgb(r, g, b), Rgb(r2, g2, b2)) = (SHADES[index], SHADES[index + 1]);
    let mixed = |from: u8, to: u8| {
        (f64::from(from) + (f64::from(to) - f64::from(from)) * (at - index as f64)).round() as u8
    };
    Rgb(mixed(r, r2), mixed(g, g2), mixed(b, b2))
}

/// Colours of classes: dark enough for thin lines on white, and apart for colour-blind readers too, of whom Okabe and Ito's orange and
/// vermilion are not. Rapids alone are light blue.
const CLASSES: [Rgb; 6] =
    [Rgb(0, 158, 115), VERMILION, Rgb(175, 100, 150), Rgb(75, 50, 200), Rgb(0, 0, 0), Rgb(150, 0, 25)];

/// Length of a line in the legend, in text heights.
pub(super) const SAMPLE: f64 = 1.75;

/// Number of dash patterns.
pub(super) const PATTERNS: u8 = 6;

/// Dash patterns in text heights, from 1 on; 0 is a solid line. In the legend each has two dashes at least.
const DASHES: [[f64; 4]; PATTERNS as usize - 1] = [
    [0.6, 0.3, 0.6, 0.3],
    [0.7, 0.18, 0.14, 0.18],
    [0.18, 0.18, 0.18, 0.18],
    [1.0, 0.35, 1.0, 0.35],
    [0.34, 0.14, 0.34, 0.14],
];

/// Returns the line style of a stroke at a text height of `text` pixels and `scale` pixels a millimetre.
pub(super) fn ink(of: Pen, style: Option<Style>, text: f64, scale: f64) -> Ink {
    let base = pen(of, text);
    let Some(Style { tint, pattern, width, phase }) = style else { return base };
    let color = match tint {
        None => base.color,
        Some(Tint::Shade(value)) => shade(value),
        Some(Tint::Class(class)) => CLASSES[class % CLASSES.len()],
        Some(Tint::Pale) => Rgb(226, 226, 226),
    };
    let pattern = usize::from(pattern % PATTERNS).checked_sub(1).and_then(|index| DASHES.get(index));
    let dash = pattern.map(|lengths| lengths.map(|length| length * text)).or(base.dash);
    Ink { color, width: width.map_or(base.width, |mm| mm * scale), dash, phase: phase * scale }
}

/// Returns the line style of a pen at a text height of `text` pixels.
pub(super) fn pen(pen: Pen, text: f64) -> Ink {
    // Long dash, gap, short dash, gap.
    let chain = [1.32, 0.22, 0.165, 0.22];
    let dashed = |dash: f64, gap: f64| Some([dash, gap, dash, gap]);
    // Widths and lengths in text heights.
    let (color, width, dash) = match pen {
        Pen::Outline => (TEXT, 0.13, None),
        Pen::Edge => (TEXT, 0.1, None),
        Pen::Thread => (TEXT, 0.06, dashed(0.3, 0.15)),
        Pen::Dimension => (THIN, 0.05, None),
        Pen::Centre => (THIN, 0.06, Some(chain)),
        Pen::Tool => (BLUE, 0.1, None),
        Pen::Construction => (Rgb(120, 120, 120), 0.06, dashed(0.55, 0.4)),
        Pen::Scale | Pen::Ruler => (Rgb(120, 120, 120), 0.06, None),
        Pen::Feed => (Rgb(0, 158, 115), 0.1, None),
        Pen::Faulty | Pen::New => (VERMILION, 0.24, None),
        Pen::FaultyFarSide => (VERMILION, 0.08, dashed(0.4, 0.3)),
        Pen::Rapid => (Rgb(45, 135, 190), 0.07, dashed(0.25, 0.25)),
        Pen::Probe => (Rgb(170, 60, 120), 0.14, dashed(0.15, 0.2)),
        Pen::Unchanged => (Rgb(150, 150, 150), 0.07, None),
        Pen::Old => (TEXT, 0.09, dashed(0.4, 0.3)),
        Pen::Grid => (Rgb(205, 205, 205), 0.05, None),
        Pen::Nominal => (TEXT, 0.12, dashed(0.8, 0.5)),
        Pen::Measured => (BLUE, 0.14, None),
        Pen::MeasuredOther => (Rgb(150, 150, 150), 0.05, None),
        Pen::Limit => (VERMILION, 0.12, dashed(0.8, 0.5)),
        Pen::Comparison => (Rgb(204, 121, 167), 0.14, dashed(0.22, 0.3)),
    };
    let dash = dash.map(|lengths: [f64; 4]| lengths.map(|length| length * text));
    Ink { color, width: width * text, dash, phase: 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sample of the legend shows a gap and the dash behind it, and no two patterns have the same lengths.
    #[test]
    fn a_pattern_is_recognised_in_the_legend() {
        for (index, pattern) in DASHES.iter().enumerate() {
            assert!(pattern[0] + pattern[1] + 0.12 <= SAMPLE, "{pattern:?}");
            assert!(DASHES[..index].iter().all(|other| other != pattern), "{pattern:?}");
        }
    }

    /// Returns lightness and chromaticities (CIELAB, D65) of a colour as seen with linear RGB mixed by a matrix.
    fn seen(Rgb(r, g, b): Rgb, vision: &[[f64; 3]; 3]) -> [f64; 3] {
        let linear = [r, g, b].map(|part| match f64::from(part) / 255.0 {
            low if low <= 0.04045 => low / 12.92,
            part => libm::pow((part + 0.055) / 1.055, 2.4),
        });
        let times = |rows: &[[f64; 3]; 3], of: [f64; 3]| {
            rows.map(|row| (0..3).map(|n| row[n] * of[n]).sum::<f64>().clamp(0.0, 1.0))
        };
        // Rows of the sRGB primaries, divided by the white point.
        let xyz = [[0.43395, 0.37622, 0.18983], [0.21267, 0.71515, 0.07218], [0.01776, 0.10947, 0.87276]];
        let [x, y, z] = times(&xyz, times(vision, linear)).map(|part| match part {
            part if 0.008856 < part => libm::cbrt(part),
            part => 7.787 * part + 16.0 / 116.0,
        });
        [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
    }

    /// The eyes of readers without red, green and blue cones (Machado, Oliveira and Fernandes 2009, severity 1), and those of others.
    /// A difference of 2.3 is just noticeable side by side; thin lines apart need several times that.
    #[test]
    fn classes_look_different_to_colour_blind_readers() {
        let visions = [
            [
                [0.152286, 1.052583, -0.204868],
                [0.114503, 0.786281, 0.099216],
                [-0.003882, -0.048116, 1.051998],
            ],
            [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.01182, 0.04294, 0.968881]],
            [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.3039]],
            [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        ];
        let difference = |one: Rgb, other: Rgb| {
            let least = |vision| {
                let (one, other) = (seen(one, vision), seen(other, vision));
                (0..3).map(|n| (one[n] - other[n]) * (one[n] - other[n])).sum::<f64>().sqrt()
            };
            visions.iter().map(least).fold(f64::INFINITY, f64::min)
        };
        for (index, one) in CLASSES.iter().enumerate() {
            for other in &CLASSES[..index] {
                assert!(15.0 < difference(*one, *other), "{one:?} {other:?} {}", difference(*one, *other));
            }
        }
        let orange = Rgb(190, 132, 0);
        assert!(difference(orange, VERMILION) < 12.0, "{}", difference(orange, VERMILION));
    }

    /// Rapids are blue, with blue as the strongest part of their colour by far.
    #[test]
    fn no_class_has_the_colour_of_rapids() {
        let Rgb(r, g, b) = pen(Pen::Rapid, 1.0).color;
        for Rgb(red, green, blue) in CLASSES {
            let apart = [(r, red), (g, green), (b, blue)].map(|(one, other)| one.abs_diff(other));
            assert!(apart.into_iter().any(|apart| 64 < apart), "{red} {green} {blue}");
        }
    }
}
