//! Picture size in pixels, within the limits of legibility and memory.
use std::str::FromStr;

use super::PictureError;
use super::ink::Rect;

/// Width and height of a picture, pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size {
    width: u32,
    height: u32,
}

/// Longer and shorter side below which the smallest text is illegible.
const MIN_SIZE: (u32, u32) = (480, 360);
/// 8,192 × 8,192 pixels are 256 MB while painting.
const MAX_SIDE: u32 = 8192;

impl Size {
    /// Checks a size in pixels.
    ///
    /// # Errors
    /// [`PictureError::TooSmall`] below 480x360 (or 360x480), [`PictureError::TooLarge`] beyond 8192 a side.
    pub fn new(width: u32, height: u32) -> Result<Self, PictureError> {
        if width.max(height) < MIN_SIZE.0 || width.min(height) < MIN_SIZE.1 {
            return Err(PictureError::TooSmall(width, height));
        }
        if width.max(height) > MAX_SIDE {
            return Err(PictureError::TooLarge(width, height));
        }
        Ok(Self { width, height })
    }

    /// Returns the rectangle of the page, pixels.
    pub(super) fn page(self) -> Rect {
        Rect::new(0.0, 0.0, f64::from(self.width), f64::from(self.height))
    }

    /// Returns the height of ordinary text in pixels: it grows with the picture and stays legible.
    pub(super) fn text(self) -> f64 {
        let short = f64::from(self.width.min(self.height));
        ((6.5 + short / 110.0) * 2.0).round().clamp(21.0, 120.0) / 2.0
    }
}

impl Default for Size {
    fn default() -> Self {
        Self { width: 1600, height: 1200 }
    }
}

impl FromStr for Size {
    type Err = PictureError;

    /// Parses `1600x1200`.
    fn from_str(text: &str) -> Result<Self, PictureError> {
        let wrong = || PictureError::NoSize(text.to_owned());
        let (width, height) = text.split_once(['x', 'X', '×']).ok_or_else(wrong)?;
        Self::new(width.trim().parse().map_err(|_| wrong())?, height.trim().parse().map_err(|_| wrong())?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_size_is_width_by_height() {
        assert_eq!("800x600".parse::<Size>().unwrap(), Size { width: 800, height: 600 });
        assert_eq!("1600x1200".parse::<Size>().unwrap(), Size::default());
    }

    #[test]
    fn a_malformed_or_extreme_size_is_refused() {
        for text in ["800", "800x", "x600", "-1x5", "800x600x3", "8e2x600", ""] {
            assert!(matches!(text.parse::<Size>(), Err(PictureError::NoSize(_))), "{text}");
        }
        assert!(matches!("479x360".parse::<Size>(), Err(PictureError::TooSmall(..))));
        assert!(matches!("480x359".parse::<Size>(), Err(PictureError::TooSmall(..))));
        assert!("360x480".parse::<Size>().is_ok());
        assert!(matches!("9000x600".parse::<Size>(), Err(PictureError::TooLarge(..))));
    }
}
