//! Lays a scene out on a sheet of a given size: scale, dials, labels, scale bar, title block.
use super::PictureError;
use super::deviation_dials::{Detail, DeviationDials};
use super::font::Font;
use super::ink::{DrawCommand, Rect, px};
use super::label_layout::{LabelLayout, caption_strokes};
use super::labels::LabelArea;
use super::lines::{are_arrows_hidden, axes, block_stroke, scale_bar, shape_commands};
use super::marks::{draw_marks, has_axis_arrow};
use super::measure::{Frame, Scale};
use super::panel::Panel;
use super::picture::{LegendUse, Picture};
use super::scene::{HoleStatus, Pen, Point, Scene, Shape, Stroke};
use super::sheet::Sheet;
use super::sign_places::SignPlaces;
use super::size::Size;
use super::words::Words;

/// Largest coordinate, mm; larger values are mistakes.
const MAX_COORDINATE: f64 = 1e6;

impl Sheet {
    /// Draws the strokes of a scene alone, to a given scale and without moving a text.
    ///
    /// `size` is the paper's width and height, `origin` the position of the scene's zero point from its upper
    /// left corner, and `text` the height of texts, all in units of the paper; `scale` is the length of 1 mm.
    pub fn to_scale(scene: &Scene, size: [f64; 2], origin: [f64; 2], scale: f64, text: f64) -> Self {
        let scale = Scale { factor: scale, origin: px(origin[0], origin[1]) };
        let commands = scene.strokes.iter().flat_map(|stroke| shape_commands(stroke, &scale, text));
        Self { commands: commands.collect(), ..Self::empty(Rect::new(0.0, 0.0, size[0], size[1])) }
    }
}

/// Places a picture on a sheet with as much detail as leaves every hole its number.
///
/// # Errors
/// [`PictureError::OffTheSheet`] if a coordinate is not a number or lies more than a kilometre from the
/// origin.
pub fn lay_out(picture: &Picture, size: Size) -> Result<Sheet, PictureError> {
    let scene = &picture.scene;
    check(scene)?;
    let font = Font::embedded();
    let text = size.text();
    let page = size.page().grown(-(0.5 * text).round());
    let panel = Panel::beside(page, picture, &font, text);
    let strip = 2.4 * text;
    let drawing = Rect { bottom: panel.drawing.bottom - strip, ..panel.drawing };

    let extent = extent(scene);
    let largest_dial = (2.4 * text).min(0.05 * drawing.width().min(drawing.height()));
    let numbers = scale_numbers_width(scene, &font, text);
    let frame_of = |axis_reach: f64| {
        let margin = axis_reach + 0.9 * text;
        let area = drawing.grown(-margin);
        let area = Rect { left: area.left + (numbers + text - margin).max(0.0), ..area };
        let scale = Scale::fitting(extent, area);
        Frame { font: Font::embedded(), text_size: text, scale, largest_dial, axis_reach }
    };
    let mut frame = frame_of(2.0 * text);
    if are_arrows_hidden(scene, &frame, extent) {
        frame = frame_of(2.6 * text + largest_dial);
    }

    if let Some(chart) = &picture.chart {
        let mut words = Words::new(&frame.font, text, size);
        chart.draw(panel.drawing.grown(-text), &mut words);
        let mut sheet = words.sheet;
        sheet.commands.extend(panel.commands(picture, &frame, LegendUse::default(), &[]));
        return Ok(sheet);
    }
    let mut plans = Detail::ALL.iter().map(|detail| Plan::new(scene, &frame, drawing, extent, *detail));
    let mut best = plans.next().expect("there is a first detail");
    for plan in plans {
        if best.unlabelled == 0 {
            break;
        }
        if plan.unlabelled <= best.unlabelled {
            best = plan;
        }
    }
    let Plan { mut sheet, legend_use, .. } = best;
    let bar = scale_bar(&frame, &sheet.commands, extent, panel.drawing);
    sheet.commands.extend(bar);
    let texts = panel.commands(picture, &frame, legend_use, &sheet.notes);
    sheet.commands.extend(texts);
    Ok(Sheet { page: size.page(), magnification: legend_use.magnification, ..sheet })
}

/// One attempt at a layout, at a given level of detail.
struct Plan {
    sheet: Sheet,
    legend_use: LegendUse,
    /// Number of holes without a label.
    unlabelled: usize,
}

impl Plan {
    fn new(scene: &Scene, frame: &Frame, drawing: Rect, extent: (Point, Point), detail: Detail) -> Self {
        let mut field = LabelArea::new(drawing.grown(-0.3 * frame.text_size), frame.text_size);
        let mut sheet = Sheet::empty(drawing);
        let draw = |stroke: &Stroke| shape_commands(stroke, &frame.scale, frame.text_size);
        let strokes = scene.strokes.iter().filter(|stroke| !matches!(stroke.shape, Shape::Sign { .. }));
        let (ticks, strokes): (Vec<&Stroke>, Vec<&Stroke>) =
            strokes.partition(|stroke| stroke.pen == Pen::Ruler);
        sheet.commands.extend(strokes.into_iter().flat_map(draw));
        scene.strokes.iter().for_each(|stroke| block_stroke(&mut field, stroke, frame));
        sheet.commands.extend(axes(scene, frame, extent, drawing, &mut field));
        // A straight line's caption has one position, a hole's label many, the caption of a circle or path
        // any.
        let is_line = |stroke: &Stroke| matches!(stroke.shape, Shape::Line(_)) && !stroke.pen.is_path();
        let mut bare = caption_strokes(scene, is_line, frame, &mut field, &mut sheet, |_| None);
        // A tick whose number has no room says nothing.
        let has_number = |stroke: &&Stroke| {
            let (Shape::Line(points), Some(number)) = (&stroke.shape, &stroke.caption) else { return true };
            let Some(end) = points.last().map(|end| frame.scale.px(*end)) else { return true };
            let is_its = |(rect, lines): &(Rect, Vec<String>)| {
                lines == std::slice::from_ref(number)
                    && rect.nearest(end).distance(end) < 0.5 * frame.text_size
            };
            sheet.labels.iter().any(is_its)
        };
        let ticks: Vec<DrawCommand> = ticks.into_iter().filter(has_number).flat_map(draw).collect();
        sheet.commands.extend(ticks);
        let dials = DeviationDials::choose(scene, frame, detail);
        let drawn = draw_marks(scene, frame, &dials, &mut field);
        let places = SignPlaces::of(scene, &drawn, frame, drawing);
        places.block(&mut field);
        let holes = |is_good: bool| {
            let holes =
                scene.marks.iter().zip(&drawn).filter(move |(mark, _)| mark.status.is_good() == is_good);
            holes.flat_map(|(_, hole)| hole.commands.iter().cloned())
        };
        // Without room beside a hole, its place is above the symbol of a good one, and below that of another, which nothing covers.
        sheet.commands.extend(holes(true).chain(places.commands()).chain(holes(false)));
        let mut lettering = LabelLayout::of(scene, &drawn, frame, &field);
        lettering.write(scene, frame, &mut sheet);
        let is_other = |stroke: &Stroke| !is_line(stroke);
        bare.extend(caption_strokes(scene, is_other, frame, &mut lettering.field, &mut sheet, |stroke| {
            places.of_stroke(stroke)
        }));
        let notes = &mut sheet.notes;
        notes.extend(dials.note(scene));
        if drawn.iter().any(|d| d.is_truncated) {
            notes.push("Deviation with an arrow: longer than drawn.".to_owned());
        }
        notes.extend(lettering.notes(scene));
        if !bare.is_empty() {
            notes.push(format!("No room for {}.", bare.join(", ")));
        }
        if detail == Detail::SignsWithoutAxes && scene.marks.iter().any(has_axis_arrow) {
            notes.push("Axes of the holes not drawn: no room.".to_owned());
        }
        let legend_use = LegendUse {
            magnification: dials.magnification(),
            directions: drawn.iter().any(|d| d.has_axis_arrow),
            displacements: drawn.iter().any(|d| d.has_displacement_line),
            has_plain_good: dials.has_plain(scene, HoleStatus::is_good),
            has_plain_rest: dials.has_plain(scene, |status| !status.is_good()),
        };
        Self { sheet, legend_use, unlabelled: lettering.unlabelled(scene) }
    }
}

fn check(scene: &Scene) -> Result<(), PictureError> {
    let fits = |p: &Point| p.iter().all(|v| v.abs() <= MAX_COORDINATE);
    for stroke in &scene.strokes {
        let is_negative = matches!(stroke.shape, Shape::Circle { radius, .. } if radius < 0.0);
        if is_negative || !stroke.shape.points().iter().all(fits) {
            return Err(PictureError::OffTheSheet(format!("a line of the drawing ({:?})", stroke.pen)));
        }
    }
    for mark in &scene.marks {
        let positions =
            [mark.actual, mark.direction, mark.deviation.map(|m| m.entry), mark.deviation.map(|m| m.bottom)];
        if !(fits(&mark.position) && fits(&[mark.radius, 0.0]) && positions.iter().flatten().all(fits)) {
            return Err(PictureError::OffTheSheet(format!(
                "hole {}",
                mark.label.first().map_or("", String::as_str)
            )));
        }
    }
    Ok(())
}

/// Returns the width of the longest number beside an upright scale; 0 without one.
fn scale_numbers_width(scene: &Scene, font: &Font, text: f64) -> f64 {
    let width = |stroke: &Stroke| match (&stroke.shape, &stroke.caption) {
        (Shape::Line(points), Some(caption)) if stroke.pen == Pen::Ruler => {
            let [from, to] = points[..] else { return 0.0 };
            if to[0] < from[0] && to[1] == from[1] { font.width(caption, text) } else { 0.0 }
        }
        _ => 0.0,
    };
    scene.strokes.iter().map(width).fold(0.0, f64::max)
}

/// Returns the extent of the drawing, mm: all holes, all lines, and the origin if axes are drawn.
fn extent(scene: &Scene) -> (Point, Point) {
    let mut seen: Vec<(Point, f64)> = Vec::new();
    for stroke in &scene.strokes {
        seen.extend(stroke.shape.points().into_iter().map(|point| (point, 0.0)));
    }
    for mark in &scene.marks {
        let positions = [Some(mark.position), mark.actual].into_iter().flatten();
        seen.extend(positions.map(|position| (position, mark.radius)));
    }
    if !scene.axes.is_empty() || seen.is_empty() {
        seen.push(([0.0, 0.0], 0.0));
    }
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for (at, radius) in seen {
        low = [low[0].min(at[0] - radius), low[1].min(at[1] - radius)];
        high = [high[0].max(at[0] + radius), high[1].max(at[1] + radius)];
    }
    // A single hole without an outline would fill the sheet.
    let widest = (high[0] - low[0]).max(high[1] - low[1]);
    let alone = scene.strokes.iter().all(|stroke| stroke.pen.is_path());
    let least = 20.0 * scene.marks.iter().map(|m| m.radius).fold(0.5, f64::max);
    let grow = if alone { ((least - widest) / 2.0).max(0.0) } else { 0.0 };
    (low.map(|v| v - grow), high.map(|v| v + grow))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::{LegendItem, Sample, Title};
    use crate::scene::{Axis, Mark, ZoneDeviation};
    use proptest::prelude::*;

    fn picture(marks: Vec<Mark>) -> Picture {
        let circle = |radius: f64, pen: Pen| Stroke {
            caption: Some(format!("r {radius}")),
            ..Stroke::new(pen, Shape::Circle { centre: [0.0, 0.0], radius })
        };
        let axis = |name: &str, direction: Point| Axis { name: name.to_owned(), direction };
        let samples = [
            Sample::Status(HoleStatus::Good),
            Sample::Status(HoleStatus::Bad),
            Sample::Deviation,
            Sample::Direction,
            Sample::Pen(Pen::Outline),
            Sample::Pen(Pen::Construction),
        ];
        Picture {
            title: Title {
                name: "A part with quite a long name indeed, such as drawings have, and a revision"
                    .to_owned(),
                view: "Top view".to_owned(),
                position: Some(0.1),
                verdict: Some((HoleStatus::Bad, "FAIL: 2 of 5 good, 2 bad, 1 missing, 2 extra".to_owned())),
                lines: (0..6).map(|i| format!("another line about the part, number {i}")).collect(),
                caution: "Predicted by simulation, not measured".to_owned(),
            },
            scene: Scene {
                axes: vec![axis("x", [1.0, 0.0]), axis("z", [0.0, -1.0])],
                strokes: vec![circle(500.0, Pen::Outline), circle(300.0, Pen::Construction)],
                marks,
                zone: Some(0.1),
            },
            legend: samples.map(|sample| LegendItem::new(sample, "meaning of this symbol")).into(),
            ..Picture::default()
        }
    }

    fn mark(index: usize, at: Point) -> Mark {
        let standing =
            [HoleStatus::Good, HoleStatus::Good, HoleStatus::Bad, HoleStatus::Missing, HoleStatus::Extra]
                [index % 5];
        let off = 0.01 * index as f64;
        let judged = matches!(standing, HoleStatus::Good | HoleStatus::Bad);
        Mark {
            radius: 3.0,
            label: vec![format!("{}", index + 1), format!("B {index}°"), "Φ0.020".to_owned()],
            direction: Some([at[0] / 800.0, at[1] / 800.0]),
            deviation: judged.then_some(ZoneDeviation { entry: [off, 0.01], bottom: [off, -0.01] }),
            actual: judged.then_some([at[0] + off, at[1]]),
            ..Mark::new(at, standing)
        }
    }

    /// Returns the extent of a command, pixels.
    fn reach(command: &DrawCommand, font: &Font) -> Rect {
        match command {
            DrawCommand::Line { points, .. } | DrawCommand::Area { points, .. } => {
                Rect::enclosing(points[0], points)
            }
            DrawCommand::Ring { centre, radius, .. } | DrawCommand::Disc { centre, radius, .. } => {
                Rect::around(*centre, (2.0 * radius, 2.0 * radius))
            }
            DrawCommand::Text { at, align, size, text, .. } | DrawCommand::Halo { at, align, size, text } => {
                let width = font.width(text, *size);
                Rect::new(at.x - align.fraction_left() * width, at.y - 0.76 * size, width, 0.98 * size)
            }
        }
    }

    fn holds(picture: &Picture, size: Size) -> Result<(), TestCaseError> {
        let sheet = lay_out(picture, size).unwrap();
        for command in &sheet.commands {
            prop_assert!(size.page().contains(&reach(command, &Font::embedded())), "{size:?} {command:?}");
        }
        for (i, (rect, lines)) in sheet.labels.iter().enumerate() {
            for (other, _) in &sheet.labels[i + 1..] {
                prop_assert!(!rect.overlaps(other), "{size:?} {lines:?}");
            }
        }
        Ok(())
    }

    /// Returns the number of labelled holes.
    fn numbered(sheet: &Sheet) -> usize {
        sheet.labels.iter().filter(|(_, lines)| lines[0].parse::<u32>().is_ok()).count()
    }

    const SIZES: [(u32, u32); 5] = [(480, 360), (360, 480), (800, 600), (1600, 1200), (900, 500)];

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]

        #[test]
        fn nothing_is_clipped_and_no_label_covers_another(
            positions in prop::collection::vec((-480.0f64..480.0, -480.0f64..480.0), 0..40),
            which in 0usize..5,
        ) {
            let marks = positions.iter().enumerate().map(|(i, (x, y))| mark(i, [*x, *y])).collect();
            let (width, height) = SIZES[which];
            holds(&picture(marks), Size::new(width, height).unwrap())?;
        }
    }

    #[test]
    fn every_hole_of_a_ring_of_24_has_its_number() {
        let positions = (0..24).map(|i| {
            let angle = gcode_lang::units::Deg(15.0 * f64::from(i));
            [300.0 * angle.cos(), 300.0 * angle.sin()]
        });
        let picture = picture(positions.enumerate().map(|(i, at)| mark(i, at)).collect());
        for (width, height) in SIZES {
            let sheet = lay_out(&picture, Size::new(width, height).unwrap()).unwrap();
            assert_eq!(numbered(&sheet), 24, "{width}x{height}: {:?}", sheet.notes);
        }
    }

    #[test]
    fn a_note_counts_the_holes_without_a_number() {
        let positions =
            (0..900).map(|i| [f64::from(i % 30) * 30.0 - 435.0, f64::from(i / 30) * 30.0 - 435.0]);
        let marks = positions.enumerate().map(|(i, at)| Mark { status: HoleStatus::Good, ..mark(i, at) });
        let sheet = lay_out(&picture(marks.collect()), Size::new(480, 360).unwrap()).unwrap();
        let note = format!("{} of 900 holes without a number: no room.", 900 - numbered(&sheet));
        assert!(sheet.notes.contains(&note), "{note} {:?}", sheet.notes);
    }

    /// A wide and a tall part: the bar begins at the left edge of what is drawn and lies one or two lines below it.
    #[test]
    fn the_scale_bar_is_beside_the_part() {
        for (corner, size) in
            [([100.0, 10.0], (1600, 1200)), ([10.0, 100.0], (1600, 1200)), ([10.0, 100.0], (480, 360))]
        {
            let outline =
                Shape::Line(vec![[0.0, 0.0], [corner[0], 0.0], corner, [0.0, corner[1]], [0.0, 0.0]]);
            let scene = Scene { strokes: vec![Stroke::new(Pen::Outline, outline)], ..Scene::default() };
            let size = Size::new(size.0, size.1).unwrap();
            let sheet = lay_out(&Picture { scene, ..Picture::default() }, size).unwrap();
            let lines = sheet.commands.iter().filter_map(|command| match command {
                DrawCommand::Line { points, ink, .. } if 0.05 * size.text() < ink.width => Some(points),
                _ => None,
            });
            let [outline, bar, ..] = lines.collect::<Vec<_>>()[..] else { panic!("an outline and a bar") };
            let [outline, bar] = [outline, bar].map(|points| Rect::enclosing(points[0], points));
            let below = (bar.bottom - outline.bottom) / size.text();
            assert!(1.0 < below && below < 2.0, "{below} {outline:?} {bar:?}");
            assert!(
                (bar.left - outline.left).abs() < 1.0 && 0.1 * outline.width() < bar.width(),
                "{outline:?} {bar:?}"
            );
        }
    }

    /// A cut that two revisions share, farther out than the holes and the part.
    #[test]
    fn an_unchanged_cut_is_on_the_sheet() {
        let far = Shape::Line(vec![[-900.0, -700.0], [900.0, -700.0], [900.0, 700.0]]);
        let mut picture = picture(vec![mark(0, [10.0, 10.0])]);
        picture.scene.strokes.push(Stroke::new(Pen::Unchanged, far));
        for (width, height) in SIZES {
            holds(&picture, Size::new(width, height).unwrap()).unwrap();
        }
    }

    #[test]
    fn a_coordinate_that_is_not_a_number_is_refused() {
        for at in [[f64::NAN, 0.0], [0.0, f64::INFINITY], [2e6, 0.0]] {
            let error = lay_out(&picture(vec![mark(6, at)]), Size::default()).unwrap_err().to_string();
            assert!(error.starts_with("hole 7 has a coordinate that is not a number"), "{error}");
        }
    }

    #[test]
    fn an_empty_scene_is_a_sheet_with_its_title() {
        let sheet = lay_out(&Picture::default(), Size::default()).unwrap();
        assert!(sheet.labels.is_empty() && sheet.notes.is_empty());
    }
}
