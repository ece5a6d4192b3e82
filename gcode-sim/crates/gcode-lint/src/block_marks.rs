//! What a check keeps of a block for the check after the next edit, as bits of its marks.
use gcode_lang::syntax::BlockMarks;

/// The rules about a block alone find nothing in it.
pub(crate) const FAULTLESS: BlockMarks = 1;

/// It reads no variables but commons.
pub(crate) const READS_COMMONS_ALONE: BlockMarks = 2;

/// It leaves the states of the locals as they are, on every way out of it.
pub(crate) const KEEPS_LOCALS: BlockMarks = 4;
