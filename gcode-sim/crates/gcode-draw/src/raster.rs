//! Paints a sheet to pixels with tiny-skia, and writes and reads PNG; makes no layout decision.
use tiny_skia::{
    FillRule, LineCap, LineJoin, Paint, Path, PathBuilder, Pixmap, Stroke, StrokeDash, Transform,
};

use super::PictureError;
use super::font::Font;
use super::ink::{DrawCommand, Ink, Px, Rgb};
use super::palette;
use super::sheet::Sheet;
use gcode_lang::units::Deg;

/// Number of displaced copies of a text that make its halo.
const HALO_COPIES: u32 = 12;

/// Paints a sheet: an opaque picture of exactly its size.
pub fn paint(sheet: &Sheet) -> Pixmap {
    let (width, height) = (sheet.page.width().ceil() as u32, sheet.page.height().ceil() as u32);
    let mut pixmap = Pixmap::new(width, height).expect("a sheet is neither empty nor too large");
    let Rgb(r, g, b) = palette::PAPER;
    pixmap.fill(tiny_skia::Color::from_rgba8(r, g, b, 255));
    let font = Font::embedded();
    for command in &sheet.commands {
        put(&mut pixmap, &font, command);
    }
    pixmap
}

/// Encodes a PNG file: 8-bit RGB, no time stamp, the same bytes for the same pixels. Line drawings compress
/// best without a filter.
///
/// # Errors
/// [`PictureError::Encode`] if the PNG encoder fails.
pub fn png(pixmap: &Pixmap) -> Result<Vec<u8>, PictureError> {
    let rgb: Vec<u8> = pixmap.data().chunks_exact(4).flat_map(|p| p[..3].iter().copied()).collect();
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, pixmap.width(), pixmap.height());
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_compression(png::Compression::High);
    encoder.set_filter(png::Filter::NoFilter);
    let written = encoder.write_header().and_then(|mut writer| writer.write_image_data(&rgb));
    written.map_err(|error| PictureError::Encode(error.to_string()))?;
    Ok(bytes)
}

fn put(pixmap: &mut Pixmap, font: &Font, command: &DrawCommand) {
    match command {
        DrawCommand::Line { points, closed, ink } => stroke(pixmap, polygon(points, *closed), *ink),
        DrawCommand::Area { points, color } => fill(pixmap, polygon(points, true), *color),
        DrawCommand::Ring { centre, radius, ink } => stroke(pixmap, circle(*centre, *radius), *ink),
        DrawCommand::Disc { centre, radius, color } => fill(pixmap, circle(*centre, *radius), *color),
        DrawCommand::Halo { at, align, size, text } => {
            let left = at.x - align.fraction_left() * font.width(text, *size);
            let rim = DrawCommand::halo_width(*size);
            for turn in 0..HALO_COPIES {
                let angle = Deg(360.0 / f64::from(HALO_COPIES) * f64::from(turn));
                let at = Px { x: left + rim * angle.cos(), y: at.y.round() + rim * angle.sin() };
                font.cover(text, *size, at, |x, y, coverage| blend(pixmap, x, y, coverage, palette::PAPER));
            }
        }
        DrawCommand::Text { at, align, size, text, color } => {
            // A base line on whole pixels keeps small text sharp.
            let at = Px { x: at.x - align.fraction_left() * font.width(text, *size), y: at.y.round() };
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
    pixmap.fill_path(&path, &paint_of(color), FillRule::Winding, Transform::identity(), None);
}

/// Strokes a path; a line thinner than a pixel would fade.
fn stroke(pixmap: &mut Pixmap, path: Option<Path>, Ink { color, width, dash, phase }: Ink) {
    let Some(path) = path else { return };
    let stroke = Stroke {
        width: width.max(1.0) as f32,
        line_cap: if dash.is_none() { LineCap::Round } else { LineCap::Butt },
        line_join: LineJoin::Round,
        dash: dash
            .and_then(|pattern| StrokeDash::new(pattern.map(|length| length as f32).to_vec(), phase as f32)),
        ..Stroke::default()
    };
    pixmap.stroke_path(&path, &paint_of(color), &stroke, Transform::identity(), None);
}

fn paint_of(Rgb(r, g, b): Rgb) -> Paint<'static> {
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
