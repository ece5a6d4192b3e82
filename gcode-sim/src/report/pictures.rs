//! The results of `render` and `compare` besides their pictures.
use schemars::JsonSchema;
use serde::Serialize;

use gcode_draw::Difference;
use gcode_inspect::verify::Answer;

/// The document of `render --format json`.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct RenderReport {
    /// The picture's file.
    pub(crate) picture: String,
    /// Names of the views, separated by commas.
    pub(crate) view: String,
    /// The answer of the verdict; without a reference `fail` for a run that fails, else null.
    pub(crate) verdict: Option<Answer>,
    /// The reasons for the answer in one line; null without one.
    pub(crate) summary: Option<String>,
}

impl RenderReport {
    /// Formats the result for a terminal.
    pub(crate) fn text(&self) -> String {
        let verdict = self.verdict.zip(self.summary.as_ref());
        let verdict = verdict.map(|(answer, summary)| format!("{}     {summary}\n", answer.word()));
        format!("{}picture: {}\n", verdict.unwrap_or_default(), self.picture)
    }
}

/// The document of `compare --format json`.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct CompareReport {
    /// The pictures have equal sizes and no difference beyond the tolerance.
    pub(crate) same: bool,
    /// Width and height of both pictures, pixels.
    pub(crate) sizes: [[u32; 2]; 2],
    /// Number of different pixels.
    pub(crate) pixels: u64,
    /// Largest difference of a colour value, 0 to 255.
    pub(crate) largest: u8,
    /// Left, top, right and bottom of the differences, both ends included.
    pub(crate) bounds: Option<[u32; 4]>,
    /// The file with the differences marked, if one was written.
    pub(crate) picture: Option<String>,
}

impl CompareReport {
    pub(crate) fn new(difference: &Difference, picture: Option<String>) -> Self {
        Self {
            same: difference.is_none(),
            sizes: difference.sizes.map(|(width, height)| [width, height]),
            pixels: difference.pixels,
            largest: difference.largest,
            bounds: difference.bounds,
            picture,
        }
    }

    /// Formats the result for a terminal.
    pub(crate) fn text(&self) -> String {
        if self.same {
            return "no difference between the pictures\n".to_owned();
        }
        let [[w, h], [other_w, other_h]] = self.sizes;
        let mut text = if (w, h) == (other_w, other_h) {
            format!("{} of {} pixels differ", self.pixels, u64::from(w) * u64::from(h))
        } else {
            format!("the sizes differ: {w}x{h} and {other_w}x{other_h}; {} pixels differ", self.pixels)
        };
        if let Some([left, top, right, bottom]) = self.bounds {
            text.push_str(&format!(
                ", by up to {} steps, between ({left}, {top}) and ({right}, {bottom})",
                self.largest
            ));
        }
        text.push('\n');
        if let Some(picture) = &self.picture {
            text.push_str(&format!("picture: {picture}\n"));
        }
        text
    }
}
