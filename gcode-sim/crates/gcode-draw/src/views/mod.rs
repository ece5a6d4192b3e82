//! Views of a part, one per file: each turns holes and paths into a scene.
pub(super) mod development;
pub(super) mod drawn_lines;
pub(super) mod flute_view;
pub(super) mod flutes;
pub(super) mod helix;
pub(super) mod hole_picture;
mod part_outline;
pub(super) mod path_legend;
pub(super) mod path_picture;
pub(super) mod path_places;
pub(super) mod path_strokes;
pub(super) mod path_view;
pub(super) mod purpose;
mod stock_outline;
pub(super) mod top;
pub(super) mod view_frames;
