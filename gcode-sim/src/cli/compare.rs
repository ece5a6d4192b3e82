//! `gcode-sim compare`: where two pictures differ.
use std::path::PathBuf;

use clap::Args;

use super::{Refusal, Status, input, output};
use crate::picture;

#[derive(Debug, Args)]
pub(super) struct CompareArguments {
    /// One picture
    #[arg(value_name = "A.png")]
    left: PathBuf,

    /// The other picture
    #[arg(value_name = "B.png")]
    right: PathBuf,

    /// Where to write the picture that marks what differs
    #[arg(short, long, value_name = "DIFF.png")]
    output: Option<PathBuf>,

    /// How much a colour value may differ, 0 to 255
    #[arg(long, value_name = "STEPS", default_value_t = 1)]
    tolerance: u8,
}

pub(super) fn run(arguments: &CompareArguments) -> Result<Status, Refusal> {
    let (left, right) = (input::bytes(&arguments.left)?, input::bytes(&arguments.right)?);
    let refused = |error: picture::PictureError| Refusal::new(error.to_string());
    let difference = picture::compare(&left, &right, arguments.tolerance).map_err(refused)?;
    if difference.is_none() {
        output::print("the pictures are alike\n")?;
        return Ok(Status::Holds);
    }
    let [(w, h), (other_w, other_h)] = difference.sizes;
    let mut text = if (w, h) == (other_w, other_h) {
        format!("{} of {} pixels differ", difference.pixels, u64::from(w) * u64::from(h))
    } else {
        format!("the sizes differ: {w}x{h} and {other_w}x{other_h}; {} pixels differ", difference.pixels)
    };
    if let Some([left, top, right, bottom]) = difference.bounds {
        text.push_str(&format!(
            ", by up to {} steps, between ({left}, {top}) and ({right}, {bottom})",
            difference.largest
        ));
    }
    text.push('\n');
    if let Some(path) = &arguments.output {
        output::write(path, &difference.png().map_err(refused)?)?;
        text.push_str(&format!("picture: {}\n", path.display()));
    }
    output::print(&text)?;
    Ok(Status::Fails)
}
