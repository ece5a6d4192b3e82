//! What a job looks like, as PNG: a scene in mm, laid out on a sheet of pixels, painted; and pictures compared.
//!
//! `views` turn holes and paths into a [`Scene`], which knows mm and roles but no pixels and no NC words.
//! [`lay_out`] turns any scene into a [`Sheet`]: everything has its pixel place, no label covers another. [`paint`]
//! only paints. A new view is a new file in `views/`; a new file format is a new painter of sheets.
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
pub use ink::{Align, Dash, DrawCommand, Px, Rect, Rgb};
pub use plot::Plot;
pub use raster::{paint, png};
pub use role::{HoleStatus, Pen, Point};
pub use scene::{Axis, LegendItem, Mark, Sample, Scene, Shape, Stroke, Title, ZoneDeviation};
pub use sheet::{Sheet, lay_out};
pub use size::Size;
pub use views::development::development;
pub use views::flutes::{Fault, FlutePoint, FluteView, side_view, tip_view};
pub use views::helix::{HelixCourses, HelixPoint, helix_graph};
pub use views::purpose::PicturePurpose;
pub use views::side::Side;
pub use views::top::{Cylinder, DrawnHole, PathKind, PathPiece, TopView, top_view};

/// Why a picture can't be made or compared.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    #[error("a picture of {width}x{height} pixels is too small to read: the minimum is {least}")]
    TooSmall { width: u32, height: u32, least: &'static str },
    #[error("a picture of {width}x{height} pixels is too large: at most {most} pixels a side")]
    TooLarge { width: u32, height: u32, most: u32 },
    #[error("`{0}` is not a picture size: write width x height in pixels, such as 1600x1200")]
    NoSize(String),
    #[error("{what} has a coordinate that is not a number or lies beyond {limit} mm")]
    OffTheSheet { what: String, limit: f64 },
    #[error("the picture cannot be written as PNG: {0}")]
    Encode(String),
    #[error("{which} cannot be read as a picture: {reason}")]
    Decode { which: String, reason: String },
}

/// The view that shows all holes at once: a cylinder unrolled, everything else from above.
pub fn main_view(view: &TopView) -> Scene {
    development(view).unwrap_or_else(|| top_view(view))
}

/// The scene as a PNG file of exactly this size.
///
/// # Errors
/// A coordinate that can't be drawn, see [`lay_out`].
pub fn draw(scene: &Scene, size: Size) -> Result<Vec<u8>, PictureError> {
    png(&paint(&lay_out(scene, size)?))
}
