//! Draws holes, tool paths, flutes and charts as PNG, SVG and PDF, and compares pictures.
//!
//! **In:** a [`Scene`]: lines, circles, texts and marks in mm, each with its meaning, on the part (3 dimensions)
//! or on a sheet (2). **Out:** the bytes of a PNG, SVG or PDF file, the text of an SVG element, or the scene itself as JSON
//! for a viewer; the same bytes for the same scene.
//!
//! A [`Sheet`] has every symbol and text at its position on the paper. [`Sheet::to_scale`] draws a scene as it
//! is; [`lay_out`] chooses scale and detail of a [`Picture`], a scene with title block and legend, so that no
//! label covers another. Sheets are written by [`paint`] and [`png()`], or by [`svg`]; a new file format is a new
//! writer of sheets.
//!
//! ```
//! use gcode_draw::{Pen, Scene, Shape, Sheet, Side, Stroke, svg};
//!
//! let path = Shape::Line(vec![[0.0, 0.0, 5.0], [40.0, 0.0, 5.0], [40.0, 20.0, 5.0]]);
//! let part = Scene { strokes: vec![Stroke::new(Pen::Feed, path)], ..Scene::default() };
//! let seen = part.seen_from(Side::Z);
//! assert_eq!(seen.strokes[0].shape, Shape::Line(vec![[0.0, 0.0], [40.0, 0.0], [40.0, 20.0]]));
//!
//! // 2 units of paper a millimetre; the zero point is 10 units from the left and 60 from the top.
//! let sheet = Sheet::to_scale(&seen, [100.0, 70.0], [10.0, 60.0], 2.0, 12.0);
//! assert!(svg(&sheet, "Tool path").contains("<polyline points=\"10,60 90,60 90,20\""));
//!
//! let json = serde_json::to_string(&part)?;
//! assert_eq!(json, r#"{"strokes":[{"line":[0,0,5,40,0,5,40,20,5],"pen":"feed"}],"marks":[]}"#);
//! # Ok::<(), serde_json::Error>(())
//! ```
//!
//! The pictures of holes and flutes are made from their contents, [`TopView`] and [`FluteView`], by [`main_view`],
//! [`top_view`], [`development`], [`side_view`], [`tip_view`] and [`helix_graph`]; a new one is a new file in
//! `views`. [`draw`] lays out, paints and encodes; [`Plot`] is a chart alone.
//!
//! ```
//! use gcode_draw::{DrawnHole, FileFormat, HoleStatus, Size, TopView, compare, draw, main_view};
//! use gcode_part::Hole;
//!
//! let nominal =
//!     Hole { id: None, entry: [40.0, 0.0, 0.0], axis: [0.0, 1.0, 0.0], depth: 15.0, diameter: Some(6.0), ..Hole::default() };
//! let actual = Hole { entry: [40.02, 0.0, 0.01], ..nominal.clone() };
//! let hole = DrawnHole {
//!     id: "1".to_owned(),
//!     nominal: Some(nominal),
//!     actual: Some(actual),
//!     status: HoleStatus::Good,
//!     position_deviation: Some(0.0447),
//!     ..DrawnHole::default()
//! };
//! let (name, tolerance) = ("O8100.nc".to_owned(), Some(0.1));
//! let view = TopView { name, tolerance, holes: vec![hole], ..TopView::default() };
//! let png = draw(&main_view(&view), Size::new(800, 600)?, FileFormat::Png)?;
//! assert!(png.starts_with(b"\x89PNG"));
//!
//! let again = draw(&main_view(&view), Size::new(800, 600)?, FileFormat::Png)?;
//! assert!(compare(&png, &again, 0)?.is_none());
//! # Ok::<(), gcode_draw::PictureError>(())
//! ```
#![warn(missing_docs)]
use std::borrow::Cow;

mod chart;
mod compare;
mod deviation_dials;
mod file_format;
mod font;
mod hole_table;
mod ink;
mod label_layout;
mod labels;
mod layout;
mod lines;
mod marks;
mod measure;
mod missing_glyphs;
mod obstacle;
mod palette;
mod panel;
mod path_cover;
mod pdf;
mod picture;
mod plot;
mod raster;
mod scene;
mod sheet;
mod side;
mod sign_places;
mod size;
mod svg;
mod symbol;
mod ticks;
mod views;
mod words;

pub use chart::{Chart, ChartMarker, Curve, Graph};
pub use compare::{Difference, compare};
pub use file_format::FileFormat;
pub use ink::Rect;
pub use layout::lay_out;
pub use picture::Picture;
pub use plot::{Bar, Plot, PlotBody};
pub use raster::{paint, png};
pub use scene::{
    Align, Axis, HoleStatus, Mark, Pen, Point, Scene, Shape, Sign, Stroke, Style, Tint, ZoneDeviation, arc,
};
pub use sheet::Sheet;
pub use side::{Projection, Side};
pub use size::Size;
pub use svg::svg;
pub use views::development::development;
pub use views::flute_view::{Fault, FlutePoint, FluteView, HelixCourses, HelixPoint};
pub use views::flutes::{side_view, tip_view};
pub use views::helix::helix_graph;
pub use views::hole_picture::top_view;
pub use views::path_picture::path_picture;
pub use views::path_view::{
    Arrangement, ColorBy, DrawnTool, PathPlace, PathRun, PathView, RunAxis, RunKind, StandardView,
    TravelLimit,
};
pub use views::purpose::PicturePurpose;
pub use views::top::{Cylinder, DrawnHole, TopView};

/// An error in making or comparing pictures.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// The size is below the limit of legibility; width and height in pixels.
    #[error("a picture of {0}x{1} pixels is too small to read: the minimum is 480x360")]
    TooSmall(u32, u32),
    /// The size is above the limit of memory; width and height in pixels.
    #[error("a picture of {0}x{1} pixels is too large: at most 8192 pixels a side")]
    TooLarge(u32, u32),
    /// A text is not a size.
    #[error("`{0}` is not a picture size: write width x height in pixels, such as 1600x1200")]
    NoSize(String),
    /// A coordinate of the scene cannot be drawn; the hole or line that has it.
    #[error("{0} has a coordinate that is not a number or lies beyond 1000000 mm")]
    OffTheSheet(String),
    /// The ending of a file's name names no format of pictures; the name.
    #[error("{0}: a picture is a .png, .svg or .pdf file")]
    NoFormat(String),
    /// The PNG encoder fails.
    #[error("the picture cannot be written as PNG: {0}")]
    Encode(String),
    /// A file is not a PNG.
    #[error("{which} cannot be read as a picture: {reason}")]
    Decode {
        /// The first or the second file.
        which: String,
        /// The decoder's message.
        reason: String,
    },
}

/// Builds the picture that shows all holes at once: the development of a cylinder, else the top view.
pub fn main_view(view: &TopView) -> Picture {
    development(view).unwrap_or_else(|| top_view(view))
}

/// Draws a picture as a file of exactly this size; in SVG and PDF 96 pixels are an inch. A reader of an SVG has fonts of its own,
/// the other formats have the embedded one alone: letters that it lacks are numbers there.
///
/// # Errors
/// [`PictureError::OffTheSheet`] if a coordinate cannot be drawn, see [`lay_out`].
pub fn draw(picture: &Picture, size: Size, format: FileFormat) -> Result<Vec<u8>, PictureError> {
    let drawn = match format {
        FileFormat::Svg => Cow::Borrowed(picture),
        FileFormat::Png | FileFormat::Pdf => missing_glyphs::spelt_out(picture),
    };
    format.encode(&lay_out(&drawn, size)?, &picture.title.name)
}
