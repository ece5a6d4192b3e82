//! File formats of pictures.
use std::path::Path;

use super::PictureError;
use super::pdf::pdf;
use super::raster::{paint, png};
use super::sheet::Sheet;
use super::svg::svg_file;

/// File format of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileFormat {
    /// Pixels.
    Png,
    /// Lines and texts for a page on the screen.
    Svg,
    /// Lines and texts for paper.
    Pdf,
}

impl FileFormat {
    /// Returns the format that the ending of a file's name states; PNG for a name without one.
    ///
    /// # Errors
    /// [`PictureError::NoFormat`] for any other ending.
    pub fn of_name(path: &Path) -> Result<Self, PictureError> {
        let ending = path.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase());
        match ending.as_deref() {
            None | Some("png") => Ok(Self::Png),
            Some("svg") => Ok(Self::Svg),
            Some("pdf") => Ok(Self::Pdf),
            Some(_) => Err(PictureError::NoFormat(path.display().to_string())),
        }
    }

    /// Writes a sheet in this format; the title is that of SVG and PDF.
    pub(super) fn encode(self, sheet: &Sheet, title: &str) -> Result<Vec<u8>, PictureError> {
        match self {
            Self::Png => png(&paint(sheet)),
            Self::Svg => Ok(svg_file(sheet, title).into_bytes()),
            Self::Pdf => Ok(pdf(sheet, title)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ending_names_the_format() {
        let of = |name: &str| FileFormat::of_name(Path::new(name));
        assert_eq!(of("top.png").unwrap(), FileFormat::Png);
        assert_eq!(of("a/TOP.SVG").unwrap(), FileFormat::Svg);
        assert_eq!(of("top.v2.pdf").unwrap(), FileFormat::Pdf);
        assert_eq!(of("top").unwrap(), FileFormat::Png);
        assert_eq!(of("top.jpg").unwrap_err().to_string(), "top.jpg: a picture is a .png, .svg or .pdf file");
    }
}
