//! Draws holes, tool paths, flutes and charts as PNG, and compares pictures.
//!
//! **In:** the contents of a view in mm ([`TopView`], [`FluteView`]) or of a chart ([`Bars`], [`Plot`]), and a
//! [`Size`] in pixels. **Out:** the bytes of a PNG file, the same bytes for the same contents.
//!
//! A view turns its contents into a [`Scene`] in mm, without pixels or colours: [`main_view`], [`top_view`],
//! [`development`], [`side_view`], [`tip_view`], [`helix_graph`]. [`lay_out`] places a scene on a [`Sheet`], where
//! every symbol and label has its position in pixels and no label covers another. [`paint`] paints the sheet, and
//! [`png`] encodes it; [`draw`] does all three. [`compare()`] compares two PNG files pixel by pixel. A new view is a
//! new file in `views`; a new file format is a new painter of sheets.
//!
//! ```
//! use gcode_draw::{DrawnHole, HoleStatus, Size, TopView, draw, main_view};
//! use gcode_part::Hole;
//!
//! let nominal =
//!     Hole { id: None, entry: [40.0, 0.0, 0.0], axis: [0.0, 1.0, 0.0], depth: 15.0, diameter: Some(6.0), from: None };
//! let actual = Hole { entry: [40.02, 0.0, 0.01], ..nominal.clone() };
//! let hole = DrawnHole {
//!     id: "1".to_owned(),
//!     nominal: Some(nominal),
//!     actual: Some(actual),
//!     status: HoleStatus::Good,
//!     position_deviation: Some(0.0447),
//!     rotary_angle: None,
//!     remarks: Vec::new(),
//! };
//! let view =
//!     TopView { name: "O8100.nc".to_owned(), tolerance: Some(0.1), holes: vec![hole], ..TopView::default() };
//! let png = draw(&main_view(&view), Size::new(800, 600)?)?;
//! assert!(png.starts_with(b"\x89PNG"));
//! # Ok::<(), gcode_draw::PictureError>(())
//! ```
#![warn(missing_docs)]
mod bars;
mod chart;
mod compare;
mod deviation_dials;
mod font;
mod frame;
mod ink;
mod label_layout;
mod labels;
mod lines;
mod marks;
mod measure;
mod obstacle;
mod palette;
mod panel;
mod plot;
mod raster;
mod role;
mod scene;
mod sheet;
mod size;
mod symbol;
mod ticks;
mod views;
mod words;

pub use bars::{Bar, Bars};
pub use chart::{Chart, ChartMarker, Curve, Graph};
pub use compare::{Difference, compare};
pub use ink::Rect;
pub use plot::Plot;
pub use raster::{paint, png};
pub use role::{HoleStatus, Pen, Point};
pub use scene::Scene;
pub use sheet::{Sheet, lay_out};
pub use size::Size;
pub use views::development::development;
pub use views::flute_view::{Fault, FlutePoint, FluteView, HelixCourses, HelixPoint};
pub use views::flutes::{side_view, tip_view};
pub use views::helix::helix_graph;
pub use views::purpose::PicturePurpose;
pub use views::side::Side;
pub use views::top::{Cylinder, DrawnHole, PathKind, PathPiece, TopView, top_view};

/// An error in making or comparing pictures.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// The size is below the limit of legibility.
    #[error("a picture of {width}x{height} pixels is too small to read: the minimum is {least}")]
    TooSmall {
        /// Width in pixels.
        width: u32,
        /// Height in pixels.
        height: u32,
        /// The smallest size.
        least: &'static str,
    },
    /// The size is above the limit of memory.
    #[error("a picture of {width}x{height} pixels is too large: at most {most} pixels a side")]
    TooLarge {
        /// Width in pixels.
        width: u32,
        /// Height in pixels.
        height: u32,
        /// The largest number of pixels a side.
        most: u32,
    },
    /// A text is not a size.
    #[error("`{0}` is not a picture size: write width x height in pixels, such as 1600x1200")]
    NoSize(String),
    /// A coordinate of the scene cannot be drawn.
    #[error("{what} has a coordinate that is not a number or lies beyond {limit} mm")]
    OffTheSheet {
        /// The hole or line with the coordinate.
        what: String,
        /// The largest coordinate, mm.
        limit: f64,
    },
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

/// Builds the scene that shows all holes at once: the development of a cylinder, else the top view.
pub fn main_view(view: &TopView) -> Scene {
    development(view).unwrap_or_else(|| top_view(view))
}

/// Draws a scene as a PNG file of exactly this size.
///
/// # Errors
/// [`PictureError::OffTheSheet`] if a coordinate cannot be drawn, see [`lay_out`].
pub fn draw(scene: &Scene, size: Size) -> Result<Vec<u8>, PictureError> {
    png(&paint(&lay_out(scene, size)?))
}
