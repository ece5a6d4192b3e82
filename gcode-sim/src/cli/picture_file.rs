//! Files of pictures that a flag names: the ending states the format.
use std::path::{Path, PathBuf};

use clap::builder::{PathBufValueParser, TypedValueParser};

use super::{UsageError, output};
use gcode_draw::{FileFormat, Picture, PictureError, Plot, Size};

/// A picture to write.
#[derive(Clone, Debug)]
pub(super) struct PictureFile {
    path: PathBuf,
    format: FileFormat,
}

impl PictureFile {
    /// Parses the value of a flag; refuses an ending that is no picture's before any work is done.
    pub(super) fn parser() -> impl TypedValueParser<Value = Self> {
        PathBufValueParser::new().try_map(|path| {
            let format = FileFormat::of_name(&path)?;
            Ok::<_, PictureError>(Self { path, format })
        })
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Draws a picture of exactly this size.
    pub(super) fn draw(&self, picture: &Picture, size: Size) -> Result<(), UsageError> {
        output::write(&self.path, &gcode_draw::draw(picture, size, self.format)?)
    }

    /// Draws a plot of exactly this size.
    pub(super) fn plot(&self, plot: &Plot, size: Size) -> Result<(), UsageError> {
        output::write(&self.path, &plot.draw(size, self.format)?)
    }
}
