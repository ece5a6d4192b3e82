//! Depths that a list of holes leaves out.
use super::{Request, SessionError, simulate};
use gcode_inspect::verify::OpenDepths;
use gcode_lang::program::Library;
use gcode_part::Reference;

/// Sets the depths that a list of holes leaves out to those of the program's holes, which one more run finds. Where that finds none, as
/// of a mill that is fed from hole to hole, another run looks for them on the axes of the list.
///
/// # Errors
/// A run that cannot begin.
pub fn complete_depths(
    request: &Request,
    library: &mut impl Library,
    reference: &mut Reference,
) -> Result<(), SessionError> {
    if reference.open_depths.is_empty() {
        return Ok(());
    }
    let alone = simulate(request, library, None)?;
    let OpenDepths { depths, unmatched } = OpenDepths::of(reference, &alone.extracted);
    reference.set_depths(depths);
    if !unmatched.is_empty() {
        let on_axes = simulate(&request.for_reference(reference), library, request.metal(reference))?;
        let found = OpenDepths::of(reference, &on_axes.extracted);
        reference.set_depths(found.depths.into_iter().filter(|(index, _)| unmatched.contains(index)));
    }
    Ok(())
}
