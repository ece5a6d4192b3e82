//! Job files and the nominal part, computed from the geometry of the part alone.
//!
//! In goes the text of a job file or of a hole list. Out come the surface, the nominal holes or flutes in the part's
//! frame, and the limits of the process. The crate knows no NC code and shares no formula with the generator.
//!
//! [`job`] reads job files and [`reader`] the keys of any TOML file; [`NominalPart`] and [`ProbedPart`] derive the
//! part from a job. [`gauge`] stacks gauge blocks for a sine table.
//!
//! ```
//! use gcode_part::NominalPart;
//!
//! let job = r#"
//! family = "pin-holes"
//! control = { dialect = "fanuc-31i", increment = "IS-B" }
//! machine = { rotary = { letter = "B", sign = 1 } }
//! surface = { kind = "ellipsoid", a = 5.0, b = 4.0 }
//! tolerance = { position = 0.1 }
//!
//! [[hole]]
//! id = "1"
//! radius = 3.0
//! azimuth = 0.0
//! axis = "axial"
//! diameter = 2.0
//! depth = 1.5
//! "#;
//! let reference = NominalPart::parse(job).unwrap().into_holes().unwrap();
//! let hole = &reference.holes[0];
//! // The height of the ellipse at x = 3 is 4·√(1 − (3/5)²) = 3.2.
//! assert!((hole.entry[1] - 3.2).abs() < 1e-9);
//! assert_eq!((hole.axis, hole.depth), ([0.0, 1.0, 0.0], 1.5));
//! assert_eq!(reference.position, Some(0.1));
//! ```
#![warn(missing_docs)]

mod assumption;
mod clusters;
mod contact;
mod csv_list;
mod distance;
mod drawn_pattern;
mod drill_size;
mod entry_planes;
mod entry_search;
mod facing;
mod feature;
mod flutes;
pub mod gauge;
mod hand;
mod hole;
mod honeycomb;
mod indicator;
pub mod job;
mod limits;
mod local_search;
mod nominal;
mod nominal_axes;
mod overlap;
mod part_solid;
mod pattern;
mod pin_holes;
mod point_tree;
mod probed_part;
mod profile;
mod read;
pub mod reader;
mod reference;
mod solid;
mod stock;
mod surface;
mod thread_size;
mod touch_uncertainty;
mod travel_shares;

pub use assumption::{Assumption, AssumptionPlace, Total};
pub use clusters::clusters;
pub use contact::Frustum;
pub use csv_list::STOPPED;
pub use entry_planes::{
    Collar, EntryPlanes, MAX_BREAK_THROUGH, MAX_EDGE_BREAK, Metal, PARALLEL_COSINE, POINT_LENGTH, SAME_END,
    Step,
};
pub use entry_search::EntrySearch;
pub use feature::{DepthTo, Feature, FeatureKind};
pub use flutes::Flutes;
pub use hand::Hand;
pub use hole::{Hole, HoleList, MM_PER_INCH, Origin, Unit};
pub use indicator::tilted_ellipsoid;
pub use limits::{NOISE, exceeds};
pub use local_search::LocalSearch;
pub use nominal::NominalPart;
pub use nominal_axes::{NominalAxes, NominalAxis, NominalThread};
pub use overlap::{Overlap, overlaps};
pub use part_solid::PartSolid;
pub use pattern::{Pattern, azimuth};
pub use point_tree::PointTree;
pub use probed_part::ProbedPart;
pub use profile::Profile;
pub use reference::{ProcessLimits, Reference, ToolProcess};
pub use solid::{NearestPoint, Rod, Taper};
pub use stock::{Stock, StockAxis, StockRegion};
pub use surface::{Surface, bisect};
pub use touch_uncertainty::{FitError, FitUncertainty, TouchPlan};
pub use travel_shares::{common_shares, shares_between, shares_within};
