//! Job files and the nominal part: what the drawing asks for, computed from the geometry of the part and nothing else.
//!
//! In goes the text of a job file or of a hole list; out come the surface, the holes or flutes in the part's frame, and the
//! limits of the process. The crate knows no NC code and shares no formula with the generator.
mod clusters;
mod distance;
mod flutes;
pub mod gauge;
mod hole;
mod honeycomb;
mod indicator;
pub mod job;
mod nominal;
mod overlap;
mod pattern;
mod pin_holes;
mod point_tree;
mod probed;
mod process;
mod profile;
mod read;
pub mod reader;
mod reference;
mod surface;
mod touch_uncertainty;

pub use clusters::Clusters;
pub use distance::NearestPoint;
pub use flutes::Flutes;
pub use hole::{Hole, HoleList, Origin, Unit};
pub use indicator::tilted_ellipsoid;
pub use nominal::NominalPart;
pub use overlap::overlaps;
pub use pattern::{Pattern, azimuth};
pub use point_tree::PointTree;
pub use probed::ProbedPart;
pub use process::{ProcessLimits, ToolProcess};
pub use profile::Profile;
pub use reference::Reference;
pub use surface::{Surface, bisect};
pub use touch_uncertainty::{FitError, FitUncertainty, TouchPlan};
