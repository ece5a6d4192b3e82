//! Letters that the embedded font lacks, as in Chinese names: PNG and PDF have their numbers in Unicode, `‹5B54›`, and a line that
//! says so. As boxes two names of equal length would be one.
use std::borrow::Cow;
use std::fmt::Write as _;

use super::chart::{Chart, Graph};
use super::font::Font;
use super::picture::Picture;
use super::scene::{Scene, Shape, Stroke};

/// Line of the title block.
const NOTE: &str = "‹…›: Unicode numbers of letters that the font lacks; SVG has the letters";

/// Returns the picture with the numbers of the letters that the font lacks.
pub(super) fn spelt_out(picture: &Picture) -> Cow<'_, Picture> {
    let font = Font::embedded();
    let mut is_complete = true;
    for_each_text(&mut texts_alone(picture), &mut |text| is_complete &= numbered(text, &font).is_none());
    if is_complete {
        return Cow::Borrowed(picture);
    }
    let mut spelt = picture.clone();
    for_each_text(&mut spelt, &mut |text| {
        if let Some(words) = numbered(text, &font) {
            *text = words;
        }
    });
    spelt.title.lines.push(NOTE.to_owned());
    Cow::Owned(spelt)
}

/// Returns a picture without the lines that have no text: a path has millions of points.
fn texts_alone(picture: &Picture) -> Picture {
    let Picture { title, scene: Scene { axes, strokes, marks, zone: _ }, legend, table, chart } = picture;
    let has_text = |stroke: &&Stroke| stroke.caption.is_some() || matches!(stroke.shape, Shape::Text { .. });
    let strokes = strokes.iter().filter(has_text).cloned().collect();
    let scene = Scene { axes: axes.clone(), strokes, marks: marks.clone(), zone: None };
    Picture {
        title: title.clone(),
        scene,
        legend: legend.clone(),
        table: table.clone(),
        chart: chart.clone(),
    }
}

/// Returns a text with the numbers of the letters that the font lacks; `None` if it has all of them.
fn numbered(text: &str, font: &Font) -> Option<String> {
    let is_known = |letter: char| letter.is_ascii() || font.glyph(letter) != 0;
    if text.chars().all(is_known) {
        return None;
    }
    let mut words = String::new();
    let mut is_open = false;
    for letter in text.chars() {
        if is_known(letter) {
            words.push_str(if is_open { "›" } else { "" });
            words.push(letter);
            is_open = false;
        } else {
            words.push_str(if is_open { "," } else { "‹" });
            let _ = write!(words, "{:04X}", u32::from(letter));
            is_open = true;
        }
    }
    words.push_str(if is_open { "›" } else { "" });
    Some(words)
}

/// Calls `change` with each text of a picture that a file or a program can bring.
fn for_each_text(picture: &mut Picture, change: &mut impl FnMut(&mut String)) {
    let Picture { title, scene: Scene { axes, strokes, marks, zone: _ }, legend, table, chart } = picture;
    change(&mut title.name);
    change(&mut title.view);
    title.verdict.iter_mut().for_each(|(_, words)| change(words));
    title.lines.iter_mut().for_each(&mut *change);
    axes.iter_mut().for_each(|axis| change(&mut axis.name));
    for stroke in strokes {
        stroke.caption.iter_mut().for_each(&mut *change);
        if let Shape::Text { text, .. } = &mut stroke.shape {
            change(text);
        }
    }
    marks.iter_mut().flat_map(|mark| &mut mark.label).for_each(&mut *change);
    legend.iter_mut().for_each(|item| change(&mut item.text));
    table.rows.iter_mut().flat_map(|(_, cells)| cells).for_each(&mut *change);
    let Some(Chart { x_label, guides, gaps: _, graphs }) = chart else { return };
    change(x_label);
    guides.iter_mut().for_each(|(_, caption)| change(caption));
    for Graph { y_label, markers, .. } in graphs {
        change(y_label);
        markers.iter_mut().for_each(|marker| change(&mut marker.name));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{HoleStatus, Mark};
    use crate::{FileFormat, Size, draw};

    /// 孔 is U+5B54, 二 U+4E8C. Umlauts, Greek and Cyrillic are in the font.
    #[test]
    fn letters_that_the_font_lacks_are_numbers() {
        let font = Font::embedded();
        assert_eq!(numbered("孔二", &font).as_deref(), Some("‹5B54,4E8C›"));
        assert_eq!(numbered("Φ30 孔.nc", &font).as_deref(), Some("Φ30 ‹5B54›.nc"));
        for known in ["Gehäuse Ø30", "дыра 3", "Ёжик Їжак Ґ ђ", "διάμετρος Φ", "șurub", "‹5B54›"]
        {
            assert_eq!(numbered(known, &font), None, "{known}");
        }
    }

    /// Two holes whose names have one length: their pictures differ, and a line says what the numbers are. SVG has the letters.
    #[test]
    fn holes_with_chinese_names_are_told_apart() {
        let picture = |id: &str| {
            let mark = Mark { label: vec![id.to_owned()], ..Mark::new([0.0; 2], HoleStatus::Good) };
            Picture { scene: Scene { marks: vec![mark], ..Scene::default() }, ..Picture::default() }
        };
        let file = |id: &str, format: FileFormat| draw(&picture(id), Size::default(), format).unwrap();
        for format in [FileFormat::Png, FileFormat::Pdf] {
            assert_ne!(file("孔一", format), file("孔二", format));
        }
        let text = |id: &str| String::from_utf8(file(id, FileFormat::Svg)).unwrap();
        assert!(text("孔二").contains("孔二") && !text("孔二").contains('‹'));
        let two = picture("孔二");
        assert_eq!(spelt_out(&two).title.lines, [NOTE]);
        let plain = picture("H2");
        assert!(matches!(spelt_out(&plain), Cow::Borrowed(_)));
    }
}
