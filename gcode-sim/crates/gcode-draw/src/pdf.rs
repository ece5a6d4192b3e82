//! Writes a sheet as a PDF file of one page, with the texts as text; makes no layout decision.
use std::collections::BTreeMap;
use std::io::Write as _;

use flate2::Compression;
use flate2::write::ZlibEncoder;
use pdf_writer::types::{
    CidFontType, FontFlags, LineCapStyle, LineJoinStyle, SystemInfo, TextRenderingMode, UnicodeCmap,
};
use pdf_writer::{Content, Filter, Finish as _, Name, Pdf, Rect, Ref, Str, TextStr};

use super::font::{ASCENT, DESCENT, Font};
use super::ink::{DrawCommand, Ink, Px, Rgb};
use super::palette;
use super::scene::Align;
use super::sheet::Sheet;

/// Length of a pixel in points: 96 pixels are an inch.
const POINTS: f32 = 0.75;
/// Distance of the control points of a quarter of a circle from its ends, in radii.
const QUARTER: f64 = 0.552_284_749_830_793_4;
const FONT: Name<'static> = Name(b"F");
const FONT_NAME: Name<'static> = Name(b"DejaVuSans");
const ADOBE_IDENTITY: SystemInfo<'static> =
    SystemInfo { registry: Str(b"Adobe"), ordering: Str(b"Identity"), supplement: 0 };

/// Writes a sheet as a PDF file with a title, 96 pixels an inch; the same bytes for the same sheet.
pub(super) fn pdf(sheet: &Sheet, title: &str) -> Vec<u8> {
    let mut ids = (1..).map(Ref::new);
    let mut next = || ids.next().expect("there is no last number");
    let [catalog, pages, page, information, content] = [(); 5].map(|()| next());
    let fonts = [(); 5].map(|()| next());
    let mut writing = Writing { content: Content::new(), font: Font::embedded(), glyphs: BTreeMap::new() };
    let (width, height) = (sheet.page.width() as f32 * POINTS, sheet.page.height() as f32 * POINTS);
    // The sheet's ordinate points downwards.
    writing.content.transform([POINTS, 0.0, 0.0, -POINTS, 0.0, height]);
    writing.content.set_line_join(LineJoinStyle::RoundJoin);
    sheet.commands.iter().for_each(|command| writing.put(command));

    let mut file = Pdf::new();
    file.catalog(catalog).pages(pages);
    file.pages(pages).kids([page]).count(1);
    file.document_info(information).title(TextStr(title));
    let mut one = file.page(page);
    one.parent(pages).media_box(Rect::new(0.0, 0.0, width, height)).contents(content);
    one.resources().fonts().pair(FONT, fonts[0]);
    one.finish();
    write_font(&mut file, fonts, &writing.font, &writing.glyphs);
    let bytes = deflated(&writing.content.finish());
    file.stream(content, &bytes).filter(Filter::FlateDecode);
    file.finish()
}

/// The content of the page while it is written.
struct Writing {
    content: Content,
    font: Font,
    /// Character and width of each glyph that a text has used, in thousandths of the em.
    glyphs: BTreeMap<u16, (char, f32)>,
}

impl Writing {
    fn put(&mut self, command: &DrawCommand) {
        match command {
            DrawCommand::Line { points, closed, ink } => {
                self.set_ink(*ink);
                self.polygon(points, *closed);
                self.content.stroke();
            }
            DrawCommand::Area { points, color } => {
                self.set_fill(*color);
                self.polygon(points, true);
                self.content.fill_nonzero();
            }
            DrawCommand::Ring { centre, radius, ink } => {
                self.set_ink(*ink);
                self.circle(*centre, *radius);
                self.content.stroke();
            }
            DrawCommand::Disc { centre, radius, color } => {
                self.set_fill(*color);
                self.circle(*centre, *radius);
                self.content.fill_nonzero();
            }
            DrawCommand::Halo { at, align, size, text } => {
                let [r, g, b] = components(palette::PAPER);
                let width = 2.0 * DrawCommand::halo_width(*size);
                self.content.set_stroke_rgb(r, g, b).set_line_width(width as f32);
                self.content.set_dash_pattern([], 0.0);
                self.text((*at, *align), *size, text, TextRenderingMode::Stroke);
            }
            DrawCommand::Text { at, align, size, text, color } => {
                self.set_fill(*color);
                self.text((*at, *align), *size, text, TextRenderingMode::Fill);
            }
        }
    }

    fn text(&mut self, (at, align): (Px, Align), size: f64, text: &str, mode: TextRenderingMode) {
        let left = at.x - align.fraction_left() * self.font.width(text, size);
        let mut codes = Vec::with_capacity(2 * text.len());
        for character in text.chars() {
            let glyph = self.font.glyph(character);
            let width = self.font.width(character.encode_utf8(&mut [0; 4]), 1000.0);
            self.glyphs.entry(glyph).or_insert((character, width as f32));
            codes.extend(glyph.to_be_bytes());
        }
        self.content.begin_text().set_font(FONT, size as f32).set_text_rendering_mode(mode);
        self.content.set_text_matrix([1.0, 0.0, 0.0, -1.0, left as f32, at.y as f32]);
        self.content.show(Str(&codes)).end_text();
    }

    fn polygon(&mut self, points: &[Px], is_closed: bool) {
        let mut points = points.iter().map(|point| (point.x as f32, point.y as f32));
        if let Some((x, y)) = points.next() {
            self.content.move_to(x, y);
        }
        for (x, y) in points {
            self.content.line_to(x, y);
        }
        if is_closed {
            self.content.close_path();
        }
    }

    fn circle(&mut self, centre: Px, radius: f64) {
        let at =
            |right: f64, down: f64| ((centre.x + right * radius) as f32, (centre.y + down * radius) as f32);
        let (x, y) = at(1.0, 0.0);
        self.content.move_to(x, y);
        for [from, to] in [
            [(1.0, 0.0), (0.0, 1.0)],
            [(0.0, 1.0), (-1.0, 0.0)],
            [(-1.0, 0.0), (0.0, -1.0)],
            [(0.0, -1.0), (1.0, 0.0)],
        ] {
            let (first, second) = (
                at(from.0 + QUARTER * to.0, from.1 + QUARTER * to.1),
                at(to.0 + QUARTER * from.0, to.1 + QUARTER * from.1),
            );
            let end = at(to.0, to.1);
            self.content.cubic_to(first.0, first.1, second.0, second.1, end.0, end.1);
        }
        self.content.close_path();
    }

    fn set_ink(&mut self, Ink { color, width, dash, phase }: Ink) {
        let [r, g, b] = components(color);
        let cap = if dash.is_none() { LineCapStyle::RoundCap } else { LineCapStyle::ButtCap };
        let lengths = dash.into_iter().flatten().map(|length| length as f32);
        self.content.set_stroke_rgb(r, g, b).set_line_width(width as f32);
        self.content.set_line_cap(cap).set_dash_pattern(lengths, phase as f32);
    }

    fn set_fill(&mut self, color: Rgb) {
        let [r, g, b] = components(color);
        self.content.set_fill_rgb(r, g, b);
    }
}

fn components(Rgb(r, g, b): Rgb) -> [f32; 3] {
    [r, g, b].map(|part| f32::from(part) / 255.0)
}

/// Writes the embedded font; its codes are numbers of glyphs, and a map gives the characters back for copying.
fn write_font(
    file: &mut Pdf,
    [composite, glyph_font, descriptor, map, program]: [Ref; 5],
    font: &Font,
    glyphs: &BTreeMap<u16, (char, f32)>,
) {
    file.type0_font(composite)
        .base_font(FONT_NAME)
        .encoding_predefined(Name(b"Identity-H"))
        .descendant_font(glyph_font)
        .to_unicode(map);
    let mut outlines = file.cid_font(glyph_font);
    outlines.subtype(CidFontType::Type2).base_font(FONT_NAME).system_info(ADOBE_IDENTITY);
    outlines.font_descriptor(descriptor).cid_to_gid_map_predefined(Name(b"Identity"));
    let mut widths = outlines.widths();
    for (glyph, (_, width)) in glyphs {
        widths.same(*glyph, *glyph, *width);
    }
    widths.finish();
    outlines.finish();
    let height = |share: f64| (1000.0 * share) as f32;
    file.font_descriptor(descriptor)
        .name(FONT_NAME)
        .flags(FontFlags::SYMBOLIC)
        .bbox(Rect::new(-1000.0, height(-DESCENT), 2000.0, 1000.0))
        .italic_angle(0.0)
        .ascent(height(ASCENT))
        .descent(height(-DESCENT))
        .cap_height(height(ASCENT))
        .stem_v(80.0)
        .font_file2(program);
    let mut characters = UnicodeCmap::new(Name(b"Characters"), ADOBE_IDENTITY);
    for (glyph, (character, _)) in glyphs {
        characters.pair(*glyph, *character);
    }
    file.cmap(map, &characters.finish());
    let outlines = deflated(font.file());
    let mut stream = file.stream(program, &outlines);
    stream.filter(Filter::FlateDecode).pair(Name(b"Length1"), font.file().len() as i32);
}

fn deflated(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(bytes).and_then(|()| encoder.finish()).expect("a vector takes all bytes")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Pen, Scene, Shape, Stroke};

    /// Returns the content of the page of a scene at 2 units a millimetre, its zero point 30 units from the top.
    fn content(shape: Shape) -> (String, BTreeMap<u16, (char, f32)>) {
        let scene = Scene { strokes: vec![Stroke::new(Pen::Outline, shape)], ..Scene::default() };
        let sheet = Sheet::to_scale(&scene, [100.0, 50.0], [0.0, 30.0], 2.0, 10.0);
        let mut writing =
            Writing { content: Content::new(), font: Font::embedded(), glyphs: BTreeMap::new() };
        sheet.commands.iter().for_each(|command| writing.put(command));
        (String::from_utf8_lossy(&writing.content.finish()).into_owned(), writing.glyphs)
    }

    #[test]
    fn a_line_and_a_circle_are_paths_at_their_positions() {
        let (line, _) = content(Shape::Line(vec![[0.0, 0.0], [10.0, 5.0]]));
        assert!(line.contains("0 30 m\n20 20 l\nS"), "{line}");
        // Four arcs through the ends of the diameters, 6 units from (20, 20).
        let (circle, _) = content(Shape::Circle { centre: [10.0, 5.0], radius: 3.0 });
        assert!(circle.contains("26 20 m\n") && circle.matches(" c\n").count() == 4, "{circle}");
        for end in [" 20 26 c", " 14 20 c", " 20 14 c", " 26 20 c"] {
            assert!(circle.contains(end), "{circle}");
        }
    }

    /// DejaVu Sans: a digit is 1303/2048 of the em wide.
    #[test]
    fn a_text_keeps_its_characters_and_widths() {
        let (_, glyphs) =
            content(Shape::Text { at: [0.0, 0.0], align: Align::Left, text: "Φ88".to_owned() });
        let used: Vec<_> = glyphs.values().map(|(character, width)| (*character, width.round())).collect();
        assert!(used.len() == 2 && used.contains(&('8', 636.0)), "{used:?}");
    }

    #[test]
    fn a_file_has_one_page_of_the_sheet_s_size() {
        let sheet = Sheet::to_scale(&Scene::default(), [1600.0, 1200.0], [0.0, 0.0], 1.0, 10.0);
        let file = pdf(&sheet, "O8100.nc");
        let text = String::from_utf8_lossy(&file);
        assert!(text.starts_with("%PDF-1.7") && text.contains("/MediaBox [0 0 1200 900]"), "{text}");
        assert!(text.contains("/Title (O8100.nc)") && text.trim_end().ends_with("%%EOF"));
        assert_eq!(file, pdf(&sheet, "O8100.nc"), "the same bytes for the same sheet");
    }
}
