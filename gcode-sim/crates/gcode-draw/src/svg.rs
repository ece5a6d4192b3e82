//! Writes a sheet as SVG; makes no layout decision.
use super::ink::{DrawCommand, Ink, Px, Rgb};
use super::palette;
use super::scene::Align;
use super::sheet::Sheet;

/// Writes a sheet as an SVG element with a title for screen readers, as a part of a page.
///
/// Texts name the font that the layout measures, and the usual sans serif where it is not installed.
pub fn svg(sheet: &Sheet, title: &str) -> String {
    written(sheet, title, "", "")
}

/// Writes a sheet as an SVG file of its size on white.
pub(super) fn svg_file(sheet: &Sheet, title: &str) -> String {
    let [width, height] = [sheet.page.width(), sheet.page.height()].map(number);
    let paper = format!("<rect width=\"{width}\" height=\"{height}\" fill=\"{}\"/>", colour(palette::PAPER));
    written(sheet, title, &format!(" width=\"{width}\" height=\"{height}\""), &paper)
}

fn written(sheet: &Sheet, title: &str, size: &str, paper: &str) -> String {
    let [width, height] = [sheet.page.width(), sheet.page.height()].map(number);
    let elements: String = sheet.commands.iter().map(element).collect();
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\"{size} viewBox=\"0 0 {width} {height}\" role=\"img\" \
         font-family=\"DejaVu Sans, Arial, sans-serif\" fill=\"none\" stroke-linecap=\"round\" \
         stroke-linejoin=\"round\"><title>{}</title>{paper}{elements}</svg>",
        escaped(title)
    )
}

fn element(command: &DrawCommand) -> String {
    match command {
        DrawCommand::Line { points, closed, ink } => {
            let name = if *closed { "polygon" } else { "polyline" };
            format!("<{name} points=\"{}\" {}/>", coordinates(points), stroke(*ink))
        }
        DrawCommand::Area { points, color } => {
            format!("<polygon points=\"{}\" fill=\"{}\"/>", coordinates(points), colour(*color))
        }
        DrawCommand::Ring { centre, radius, ink } => circle(*centre, *radius, &stroke(*ink)),
        DrawCommand::Disc { centre, radius, color } => {
            circle(*centre, *radius, &format!("fill=\"{}\"", colour(*color)))
        }
        DrawCommand::Halo { at, align, size, text } => {
            let width = 2.0 * DrawCommand::halo_width(*size);
            let rim = format!("stroke=\"{}\" stroke-width=\"{}\"", colour(palette::PAPER), number(width));
            written_text(*at, *align, *size, text, &rim)
        }
        DrawCommand::Text { at, align, size, text, color } => {
            written_text(*at, *align, *size, text, &format!("fill=\"{}\"", colour(*color)))
        }
    }
}

fn written_text(at: Px, align: Align, size: f64, text: &str, look: &str) -> String {
    let anchor = match align {
        Align::Left => "start",
        Align::Centre => "middle",
        Align::Right => "end",
    };
    let [x, y, size] = [at.x, at.y, size].map(number);
    let text = escaped(text);
    format!("<text x=\"{x}\" y=\"{y}\" font-size=\"{size}\" text-anchor=\"{anchor}\" {look}>{text}</text>")
}

fn circle(centre: Px, radius: f64, style: &str) -> String {
    let [x, y, radius] = [centre.x, centre.y, radius].map(number);
    format!("<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\" {style}/>")
}

fn coordinates(points: &[Px]) -> String {
    let pairs = points.iter().map(|point| format!("{},{}", number(point.x), number(point.y)));
    pairs.collect::<Vec<_>>().join(" ")
}

fn stroke(Ink { color, width, dash, phase }: Ink) -> String {
    let dash = dash.map_or(String::new(), |lengths| {
        let offset =
            if phase == 0.0 { String::new() } else { format!(" stroke-dashoffset=\"{}\"", number(phase)) };
        format!(" stroke-dasharray=\"{}\"{offset} stroke-linecap=\"butt\"", lengths.map(number).join(" "))
    });
    format!("stroke=\"{}\" stroke-width=\"{}\"{dash}", colour(color), number(width))
}

fn colour(Rgb(r, g, b): Rgb) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Formats a length to a hundredth, without trailing zeros or a negative zero.
fn number(value: f64) -> String {
    (0.0 + (value * 100.0).round() / 100.0).to_string()
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Pen, Point, Scene, Shape, Stroke};

    /// 10 mm at 2 units a millimetre, from the left edge and 30 units from the top.
    #[test]
    fn every_shape_is_an_element_at_its_position() {
        let of = |shape: Shape| {
            let scene = Scene { strokes: vec![Stroke::new(Pen::Rapid, shape)], ..Scene::default() };
            let text = svg(&Sheet::to_scale(&scene, [100.0, 50.0], [0.0, 30.0], 2.0, 10.0), "A & B");
            text.split("</title>").nth(1).unwrap().trim_end_matches("</svg>").to_owned()
        };
        let (from, to): (Point, Point) = ([0.0, 0.0], [10.0, 5.0]);
        let line = "stroke=\"#2d87be\" stroke-width=\"0.7\" stroke-dasharray=\"2.5 2.5 2.5 2.5\" stroke-linecap=\"butt\"/>";
        assert_eq!(of(Shape::Line(vec![from, to])), format!("<polyline points=\"0,30 20,20\" {line}"));
        let circle = Shape::Circle { centre: to, radius: 3.0 };
        assert_eq!(of(circle), format!("<circle cx=\"20\" cy=\"20\" r=\"6\" {line}"));
        let text = Shape::Text { at: to, align: Align::Right, text: "Φ < 3".to_owned() };
        let words =
            "<text x=\"20\" y=\"20\" font-size=\"10\" text-anchor=\"end\" fill=\"#000000\">Φ &lt; 3</text>";
        assert_eq!(of(text), words);
        // The head is as long as the text is high, less a quarter.
        let arrow = of(Shape::Arrow([from, [10.0, 0.0]]));
        assert!(
            arrow.starts_with("<polyline points=\"0,30 12.5,30\"")
                && arrow.contains("\"20,30 12.5,32.7 12.5,27.3\"")
        );
        assert_eq!(of(Shape::Zero(from)).matches("<polygon").count(), 2);
    }

    #[test]
    fn a_title_ends_no_element() {
        let sheet = Sheet::to_scale(&Scene::default(), [100.0, 50.0], [0.0, 0.0], 1.0, 10.0);
        assert!(svg(&sheet, "<b> & \"").contains("<title>&lt;b&gt; &amp; &quot;</title>"));
    }
}
