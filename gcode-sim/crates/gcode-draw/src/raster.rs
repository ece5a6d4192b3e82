//! Paints a sheet to pixels with tiny-skia and encodes pixels as PNG; makes no layout decision.
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder as _};
use tiny_skia::{
    FillRule, LineCap, LineJoin, Paint, Path, PathBuilder, Pixmap, Stroke, StrokeDash, Transform,
};

use super::PictureError;
use super::font::Font;
use super::ink::{Align, Dash, DrawCommand, Px, Rgb};
use super::palette;
use super::sheet::Sheet;

/// Paints a sheet: an opaque picture of exactly its size.
pub fn paint(sheet: &Sheet) -> Pixmap {
    let (width, height) = (sheet.size.width(), sheet.size.height());
    let mut pixmap = Pixmap::new(width, height).expect("a Size is neither empty nor too large");
    let Rgb(r, g, b) = palette::PAPER;
    pixmap.fill(tiny_skia::Color::from_rgba8(r, g, b, 255));
    let font = Font::embedded();
    for ink in &sheet.commands {
        put(&mut pixmap, &font, ink);
    }
    pixmap
}

/// Encodes a PNG file: 8-bit RGB, no time stamp, the same bytes for the same pixels.
///
/// # Errors
/// [`PictureError::Encode`] if the PNG encoder fails.
pub fn png(pixmap: &Pixmap) -> Result<Vec<u8>, PictureError> {
    let rgb: Vec<u8> = pixmap.data().chunks_exact(4).flat_map(|p| p[..3].iter().copied()).collect();
    encode(&rgb, pixmap.width(), pixmap.height())
}

/// Encodes rows of 8-bit RGB as a PNG file. Line drawings compress best without a filter.
pub(super) fn encode(rgb: &[u8], width: u32, height: u32) -> Result<Vec<u8>, PictureError> {
    let mut bytes = Vec::new();
    PngEncoder::new_with_quality(&mut bytes, CompressionType::Best, FilterType::NoFilter)
        .write_image(rgb, width, height, ExtendedColorType::Rgb8)
        .map_err(|error| PictureError::Encode(error.to_string()))?;
    Ok(bytes)
}

fn put(pixmap: &mut Pixmap, font: &Font, ink: &DrawCommand) {
    match ink {
        DrawCommand::Line { points, closed, width, dash, color } => {
            stroke(pixmap, polygon(points, *closed), *width, *dash, *color);
        }
        DrawCommand::Area { points, color } => fill(pixmap, polygon(points, true), *color),
        DrawCommand::Ring { centre, radius, width, dash, color } => {
            stroke(pixmap, circle(*centre, *radius), *width, *dash, *color);
        }
        DrawCommand::Disc { centre, radius, color } => fill(pixmap, circle(*centre, *radius), *color),
        DrawCommand::Text { at, align, size, text, color } => {
            let left = match align {
                Align::Left => at.x,
                Align::Centre => at.x - font.width(text, *size) / 2.0,
                Align::Right => at.x - font.width(text, *size),
            };
            // A base line on whole pixels keeps small text sharp.
            let at = Px { x: left, y: at.y.round() };
            font.cover(text, *size, at, |x, y, coverage| blend(pixmap, x, y, coverage, *color));
        }
    }
}

fn polygon(points: &[Px], closed: bool) -> Option<Path> {
    let (first, rest) = points.split_first()?;
    let mut path = PathBuilder::new();
    path.move_to(first.x as f32, first.y as f32);
    for point in rest {
        path.line_to(point.x as f32, point.y as f32);
    }
    if closed {
        path.close();
    }
    path.finish()
}

fn circle(centre: Px, radius: f64) -> Option<Path> {
    PathBuilder::from_circle(centre.x as f32, centre.y as f32, radius as f32)
}

fn fill(pixmap: &mut Pixmap, path: Option<Path>, color: Rgb) {
    let Some(path) = path else { return };
    pixmap.fill_path(&path, &ink(color), FillRule::Winding, Transform::identity(), None);
}

fn stroke(pixmap: &mut Pixmap, path: Option<Path>, width: f64, dash: Dash, color: Rgb) {
    let Some(path) = path else { return };
    let pattern = match dash {
        Dash::Solid => None,
        Dash::Pattern([on, off]) => Some(vec![on as f32, off as f32]),
        Dash::Chain(unit) => {
            Some([2.4 * unit, 0.4 * unit, 0.3 * unit, 0.4 * unit].map(|v| v as f32).to_vec())
        }
    };
    let cap = if pattern.is_none() { LineCap::Round } else { LineCap::Butt };
    let stroke = Stroke {
        width: width as f32,
        line_cap: cap,
        line_join: LineJoin::Round,
        dash: pattern.and_then(|array| StrokeDash::new(array, 0.0)),
        ..Stroke::default()
    };
    pixmap.stroke_path(&path, &ink(color), &stroke, Transform::identity(), None);
}

fn ink(Rgb(r, g, b): Rgb) -> Paint<'static> {
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    paint.set_color_rgba8(r, g, b, 255);
    paint
}

/// Blends a colour over one pixel of the opaque picture.
fn blend(pixmap: &mut Pixmap, x: i64, y: i64, coverage: f32, Rgb(r, g, b): Rgb) {
    let (Ok(x), Ok(y)) = (usize::try_from(x), usize::try_from(y)) else { return };
    let (width, height) = (pixmap.width() as usize, pixmap.height() as usize);
    if width <= x || height <= y {
        return;
    }
    let start = (y * width + x) * 4;
    for (below, above) in pixmap.data_mut()[start..start + 3].iter_mut().zip([r, g, b]) {
        let mixed = f32::from(*below) + (f32::from(above) - f32::from(*below)) * coverage.clamp(0.0, 1.0);
        *below = mixed.round() as u8;
    }
}
