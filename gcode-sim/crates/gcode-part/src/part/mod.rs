//! What the drawing asks for, computed from the geometry of the part and nothing else.
//!
//! This module knows no NC code and shares no formula with the generator: a verifier that did would agree with
//! its mistakes.
pub mod distance;
pub mod flutes;
pub mod hole;
pub mod honeycomb;
pub mod indicator;
pub mod nominal;
pub mod overlap;
mod pin_holes;
pub mod probed;
pub mod process;
pub mod profile;
mod read;
pub mod reference;
pub mod surface;
pub mod touch_uncertainty;
