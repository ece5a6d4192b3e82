//! Compares two pictures and marks the differences in a third.
use tiny_skia::{Pixmap, PremultipliedColorU8};

use super::PictureError;
use super::ink::Rgb;
use super::{palette, raster};

/// Differences between two pictures.
#[derive(Clone, Debug)]
pub struct Difference {
    /// Number of pixels that differ by more than the tolerance in a channel; pixels in one picture alone
    /// count too.
    pub pixels: u64,
    /// Largest difference of a channel.
    pub largest: u8,
    /// Left, top, right, bottom of the differing area, pixels, inclusive; `None` without a difference.
    pub bounds: Option<[u32; 4]>,
    /// Width and height of both pictures.
    pub sizes: [(u32, u32); 2],
    /// The first picture, faded. A differing pixel is blue if it is darker in the first picture and vermilion
    /// if it is darker in the second; a frame encloses the differences.
    pub(super) picture: Pixmap,
}

impl Difference {
    /// Returns true if no pixel differs and the sizes are equal.
    pub fn is_none(&self) -> bool {
        self.pixels == 0 && self.sizes[0] == self.sizes[1]
    }

    /// Encodes the marked picture as a PNG file.
    ///
    /// # Errors
    /// [`PictureError::Encode`] if the PNG encoder fails.
    pub fn png(&self) -> Result<Vec<u8>, PictureError> {
        raster::png(&self.picture)
    }
}

const FRAME: Rgb = Rgb(204, 121, 167);

/// Compares two PNG files pixel by pixel; channels that differ by at most `tolerance` are equal.
///
/// # Errors
/// [`PictureError::Decode`] if a file is not a PNG; the message names the first or the second file.
pub fn compare(first: &[u8], second: &[u8], tolerance: u8) -> Result<Difference, PictureError> {
    let (a, b) = (decode("the first file", first)?, decode("the second file", second)?);
    let (width, height) = (a.width().max(b.width()), a.height().max(b.height()));
    let mut picture = Pixmap::new(width, height).expect("a decoded picture is neither empty nor too large");
    picture.fill(tiny_skia::Color::WHITE);
    let (mut pixels, mut largest, mut bounds) = (0, 0, None::<[u32; 4]>);
    for y in 0..height {
        for x in 0..width {
            let (in_a, in_b) = (channels(&a, x, y), channels(&b, x, y));
            let off = match (in_a, in_b) {
                (Some(a), Some(b)) => (0..3).map(|i| a[i].abs_diff(b[i])).max().unwrap_or(0),
                _ => u8::MAX,
            };
            largest = largest.max(off);
            if tolerance < off {
                pixels += 1;
                let [left, top, right, bottom] = bounds.unwrap_or([x, y, x, y]);
                bounds = Some([left.min(x), top.min(y), right.max(x), bottom.max(y)]);
                put(
                    &mut picture,
                    x,
                    y,
                    if darkness(in_a) < darkness(in_b) { palette::VERMILION } else { palette::BLUE },
                );
            } else if let Some([r, g, b]) = in_a.map(|pixel| pixel.map(|v| 170 + v / 3)) {
                put(&mut picture, x, y, Rgb(r, g, b));
            }
        }
    }
    if let Some(bounds) = bounds {
        frame(&mut picture, bounds);
    }
    let sizes = [(a.width(), a.height()), (b.width(), b.height())];
    Ok(Difference { pixels, largest, bounds, sizes, picture })
}

/// Returns the darkness of a pixel; a pixel outside the picture counts as paper.
fn darkness(pixel: Option<[u8; 3]>) -> u32 {
    pixel.map_or(0, |channels| channels.iter().map(|v| u32::from(u8::MAX - v)).sum())
}

fn decode(which: &str, bytes: &[u8]) -> Result<Pixmap, PictureError> {
    let decode_error = |error: png::DecodingError| PictureError::Decode {
        which: which.to_owned(),
        reason: error.to_string(),
    };
    Pixmap::decode_png(bytes).map_err(decode_error)
}

/// Returns red, green and blue of a pixel; `None` outside the picture.
fn channels(picture: &Pixmap, x: u32, y: u32) -> Option<[u8; 3]> {
    let pixel = picture.pixel(x, y).filter(|_| x < picture.width())?;
    Some([pixel.red(), pixel.green(), pixel.blue()])
}

/// Colours a pixel; nothing outside the picture.
fn put(picture: &mut Pixmap, x: u32, y: u32, Rgb(r, g, b): Rgb) {
    let index = (y * picture.width() + x) as usize;
    let is_inside = x < picture.width();
    if let Some(pixel) = picture.pixels_mut().get_mut(index).filter(|_| is_inside) {
        *pixel = PremultipliedColorU8::from_rgba(r, g, b, u8::MAX).expect("an opaque colour");
    }
}

/// Draws a frame of two pixels, three pixels outside the differing area, clipped to the picture.
fn frame(picture: &mut Pixmap, [left, top, right, bottom]: [u32; 4]) {
    for off in [3, 4] {
        let (l, t, r, b) = (left.checked_sub(off), top.checked_sub(off), right + off, bottom + off);
        let columns = l.unwrap_or(0)..=r.min(picture.width() - 1);
        let rows = t.unwrap_or(0)..=b.min(picture.height() - 1);
        let level = columns.flat_map(|x| [t, Some(b)].into_iter().flatten().map(move |y| (x, y)));
        let upright = rows.flat_map(|y| [l, Some(r)].into_iter().flatten().map(move |x| (x, y)));
        for (x, y) in level.chain(upright) {
            put(picture, x, y, FRAME);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn png(width: u32, height: u32, dots: &[(u32, u32, u8)]) -> Vec<u8> {
        let mut picture = Pixmap::new(width, height).unwrap();
        picture.fill(tiny_skia::Color::from_rgba8(200, 200, 200, 255));
        for (x, y, grey) in dots {
            put(&mut picture, *x, *y, Rgb(*grey, *grey, *grey));
        }
        raster::png(&picture).unwrap()
    }

    #[test]
    fn a_picture_equals_itself() {
        let picture = png(30, 20, &[(3, 4, 0)]);
        let difference = compare(&picture, &picture, 0).unwrap();
        assert!(difference.is_none() && difference.bounds.is_none());
    }

    #[test]
    fn differing_pixels_are_counted_bounded_and_marked() {
        let (a, b) = (png(30, 20, &[]), png(30, 20, &[(12, 10, 0), (15, 8, 100), (20, 20 - 1, 201)]));
        let difference = compare(&a, &b, 1).unwrap();
        assert_eq!(difference.pixels, 2);
        assert_eq!(difference.largest, 200);
        assert_eq!(difference.bounds, Some([12, 8, 15, 10]));
        let of =
            |difference: &Difference, x, y| channels(&difference.picture, x, y).map(|[r, g, b]| Rgb(r, g, b));
        assert_eq!(of(&difference, 12, 10), Some(palette::VERMILION));
        assert_eq!(of(&compare(&b, &a, 1).unwrap(), 12, 10), Some(palette::BLUE));
        assert_eq!(of(&difference, 9, 9), Some(FRAME));
        assert_eq!(compare(&a, &b, 0).unwrap().pixels, 3);
    }

    #[test]
    fn a_larger_picture_differs_where_the_smaller_ends() {
        let difference = compare(&png(10, 10, &[]), &png(12, 10, &[]), 1).unwrap();
        assert!(!difference.is_none());
        assert_eq!((difference.pixels, difference.bounds), (20, Some([10, 0, 11, 9])));
    }

    #[test]
    fn a_file_that_is_not_a_png_is_named() {
        let error = compare(&png(4, 4, &[]), b"G0 X0", 1).unwrap_err().to_string();
        assert!(error.starts_with("the second file cannot be read as a picture"), "{error}");
    }
}
