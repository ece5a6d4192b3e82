//! Compares two pictures and marks the differences in a third.
use image::{ImageFormat, Rgb, RgbImage};

use super::PictureError;
use super::raster;

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
    pub(super) picture: RgbImage,
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
        raster::encode(self.picture.as_raw(), self.picture.width(), self.picture.height())
    }
}

/// Colours of Okabe and Ito's palette.
const ONLY_FIRST: Rgb<u8> = Rgb([0, 114, 178]);
const ONLY_SECOND: Rgb<u8> = Rgb([213, 94, 0]);
const FRAME: Rgb<u8> = Rgb([204, 121, 167]);

/// Compares two PNG files pixel by pixel; channels that differ by at most `tolerance` are equal.
///
/// # Errors
/// [`PictureError::Decode`] if a file is not a PNG; the message names the first or the second file.
pub fn compare(first: &[u8], second: &[u8], tolerance: u8) -> Result<Difference, PictureError> {
    let (a, b) = (decode("the first file", first)?, decode("the second file", second)?);
    let (width, height) = (a.width().max(b.width()), a.height().max(b.height()));
    let mut picture = RgbImage::from_pixel(width, height, Rgb([255, 255, 255]));
    let (mut pixels, mut largest, mut bounds) = (0, 0, None::<[u32; 4]>);
    for y in 0..height {
        for x in 0..width {
            let (in_a, in_b) = (a.get_pixel_checked(x, y), b.get_pixel_checked(x, y));
            let off = match (in_a, in_b) {
                (Some(a), Some(b)) => (0..3).map(|i| a.0[i].abs_diff(b.0[i])).max().unwrap_or(0),
                _ => u8::MAX,
            };
            largest = largest.max(off);
            if tolerance < off {
                pixels += 1;
                let [left, top, right, bottom] = bounds.unwrap_or([x, y, x, y]);
                bounds = Some([left.min(x), top.min(y), right.max(x), bottom.max(y)]);
                picture.put_pixel(
                    x,
                    y,
                    if darkness(in_a) < darkness(in_b) { ONLY_SECOND } else { ONLY_FIRST },
                );
            } else if let Some(pixel) = in_a {
                picture.put_pixel(x, y, Rgb(pixel.0.map(|v| 170 + v / 3)));
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
fn darkness(pixel: Option<&Rgb<u8>>) -> u32 {
    pixel.map_or(0, |p| p.0.iter().map(|v| u32::from(u8::MAX - v)).sum())
}

fn decode(which: &str, bytes: &[u8]) -> Result<RgbImage, PictureError> {
    image::load_from_memory_with_format(bytes, ImageFormat::Png)
        .map(|picture| picture.to_rgb8())
        .map_err(|error| PictureError::Decode { which: which.to_owned(), reason: error.to_string() })
}

/// Draws a frame of two pixels, three pixels outside the differing area, clipped to the picture.
fn frame(picture: &mut RgbImage, [left, top, right, bottom]: [u32; 4]) {
    for off in [3, 4] {
        let (l, t, r, b) = (left.checked_sub(off), top.checked_sub(off), right + off, bottom + off);
        let columns = l.unwrap_or(0)..=r.min(picture.width() - 1);
        let rows = t.unwrap_or(0)..=b.min(picture.height() - 1);
        let level = columns.flat_map(|x| [t, Some(b)].into_iter().flatten().map(move |y| (x, y)));
        let upright = rows.flat_map(|y| [l, Some(r)].into_iter().flatten().map(move |x| (x, y)));
        for (x, y) in level.chain(upright) {
            if let Some(pixel) = picture.get_pixel_mut_checked(x, y) {
                *pixel = FRAME;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn png(width: u32, height: u32, dots: &[(u32, u32, u8)]) -> Vec<u8> {
        let mut picture = RgbImage::from_pixel(width, height, Rgb([200, 200, 200]));
        for (x, y, grey) in dots {
            picture.put_pixel(*x, *y, Rgb([*grey; 3]));
        }
        raster::encode(picture.as_raw(), width, height).unwrap()
    }

    #[test]
    fn a_picture_equals_itself() {
        let picture = png(30, 20, &[(3, 4, 0)]);
        let difference = compare(&picture, &picture, 0).unwrap();
        assert!(difference.is_none() && difference.bounds.is_none());
    }

    #[test]
    fn what_differs_is_counted_bounded_and_marked() {
        let (a, b) = (png(30, 20, &[]), png(30, 20, &[(12, 10, 0), (15, 8, 100), (20, 20 - 1, 201)]));
        let difference = compare(&a, &b, 1).unwrap();
        assert_eq!(difference.pixels, 2);
        assert_eq!(difference.largest, 200);
        assert_eq!(difference.bounds, Some([12, 8, 15, 10]));
        assert_eq!(difference.picture.get_pixel(12, 10), &ONLY_SECOND);
        assert_eq!(compare(&b, &a, 1).unwrap().picture.get_pixel(12, 10), &ONLY_FIRST);
        assert_eq!(difference.picture.get_pixel(9, 9), &FRAME);
        assert_eq!(compare(&a, &b, 0).unwrap().pixels, 3);
    }

    #[test]
    fn a_larger_picture_differs_where_the_smaller_ends() {
        let difference = compare(&png(10, 10, &[]), &png(12, 10, &[]), 1).unwrap();
        assert!(!difference.is_none());
        assert_eq!((difference.pixels, difference.bounds), (20, Some([10, 0, 11, 9])));
    }

    #[test]
    fn what_is_no_picture_is_named() {
        let error = compare(&png(4, 4, &[]), b"G0 X0", 1).unwrap_err().to_string();
        assert!(error.starts_with("the second file cannot be read as a picture"), "{error}");
    }
}
