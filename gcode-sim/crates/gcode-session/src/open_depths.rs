//! Depths that a list of holes leaves out.
use super::{Request, SessionError, simulate};
use gcode_inspect::verify::open_depths;
use gcode_lang::program::Library;
use gcode_part::Reference;

/// Sets the depths that a list of holes leaves out to those of the program's holes, which one more run finds.
///
/// # Errors
/// A run that cannot begin.
pub fn complete_depths(
    request: &Request,
    library: &mut impl Library,
    reference: &mut Reference,
) -> Result<(), SessionError> {
    if !reference.open_depths.is_empty() {
        let simulation = simulate(request, library, None)?;
        reference.set_depths(open_depths(reference, &simulation.extracted));
    }
    Ok(())
}
