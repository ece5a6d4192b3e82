//! Tools of a pattern job: what each does, and what a pattern asks of it.
use schemars::JsonSchema;
use serde::Deserialize;

use super::PatternJob;
use crate::hand::Hand;
use crate::job::{FileError, Reader};
use crate::reader::bounds::{Depth, DrillNumber, FeedRate, Length, PointAngle, SpindleSpeed};
use crate::reader::{FileKey, Optional, Word, WordList};

/// Least difference between the diameters of a milled hole and of its mill, mm: O8503 refuses less.
const WALL: f64 = 0.02;

/// Angle of a drill's point that a job leaves out, degrees: type N of DIN 1414.
const POINT_ANGLE: f64 = 118.0;

/// Angle of a spot drill's point that a job leaves out, degrees.
const SPOT_ANGLE: f64 = 90.0;

/// Operation of a tool.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operation {
    /// Spots the hole for the tools behind it: G81. It makes no feature of the drawing.
    SpotDrill,
    /// Drills in one go: G81.
    Drill,
    /// Drills in pecks: G83.
    Peck,
    /// Taps a thread rigidly: G84, or G74 for a left-hand one.
    Tap,
    /// Bores, and feeds out: G85.
    Bore,
    /// Mills a hole by a helix and a circle.
    MillCircle,
    /// Mills a thread from its bottom upwards.
    ThreadMill,
}

impl Operation {
    /// Returns the name in job files.
    pub fn name(self) -> &'static str {
        match self {
            Self::SpotDrill => "spot-drill",
            Self::Drill => "drill",
            Self::Peck => "peck",
            Self::Tap => "tap",
            Self::Bore => "bore",
            Self::MillCircle => "mill-circle",
            Self::ThreadMill => "thread-mill",
        }
    }

    /// Returns the angle of the point of its tool that a job leaves out, degrees; `None` for a tool without a point.
    fn point_angle(self) -> Option<f64> {
        match self {
            Self::SpotDrill => Some(SPOT_ANGLE),
            Self::Drill | Self::Peck => Some(POINT_ANGLE),
            Self::Tap | Self::Bore | Self::MillCircle | Self::ThreadMill => None,
        }
    }

    /// Returns true for an operation that goes round its hole, which is wider than the tool.
    pub fn is_milling(self) -> bool {
        matches!(self, Self::MillCircle | Self::ThreadMill)
    }

    /// Returns true for an operation that makes a thread.
    pub fn is_threading(self) -> bool {
        matches!(self, Self::Tap | Self::ThreadMill)
    }
}

impl WordList for Operation {
    type Value = Self;

    fn all() -> Vec<(&'static str, Self)> {
        let all = [
            Self::SpotDrill,
            Self::Drill,
            Self::Peck,
            Self::Tap,
            Self::Bore,
            Self::MillCircle,
            Self::ThreadMill,
        ];
        all.map(|operation| (operation.name(), operation)).into()
    }
}

/// A tool and its operation.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PatternTool {
    /// Its number, and that of its length offset; unique.
    #[serde(with = "DrillNumber")]
    pub number: u32,
    /// Its name in comments and on the sheet [default: that of its operation, such as DRILL].
    name: Option<String>,
    /// What it does.
    #[serde(with = "Word::<Operation>")]
    pub operation: Operation,
    /// Diameter, mm; of a tap, that of the thread.
    #[serde(with = "Length")]
    pub diameter: f64,
    /// Angle of the point of `drill` and `peck`, degrees [default: 118], and of `spot-drill` [default: 90].
    #[serde(default, with = "Optional::<PointAngle>")]
    point_angle: Option<f64>,
    /// Spindle speed, a whole number of r/min.
    #[serde(with = "SpindleSpeed")]
    pub speed: f64,
    /// Feed, mm/min; of a mill, that of its centre. A tap has none: its pitch gives it.
    #[serde(default, with = "Optional::<FeedRate>")]
    feed: Option<f64>,
    /// Depth of cut of `peck`, or depth of a turn of `mill-circle`, mm.
    #[serde(default, with = "Optional::<Depth>")]
    peck: Option<f64>,
    /// Pitch of the thread of `tap` and `thread-mill`, mm.
    #[serde(default, with = "Optional::<Depth>")]
    pitch: Option<f64>,
    /// Hand of the thread of `tap` and `thread-mill` [default: right].
    #[serde(default, with = "Optional::<Word<ThreadHand>>")]
    hand: Option<Hand>,
}

/// The words of a thread's hand.
enum ThreadHand {}

impl WordList for ThreadHand {
    type Value = Hand;

    fn all() -> Vec<(&'static str, Hand)> {
        vec![("right", Hand::Right), ("left", Hand::Left)]
    }
}

/// One operation on every hole of a pattern.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PatternStep {
    /// Number of the tool.
    #[serde(with = "DrillNumber")]
    pub tool: u32,
    /// Depth of the tool's deepest point below the surface, mm: of a drill, that of its tip; of a thread, its length.
    #[serde(with = "Depth")]
    pub depth: f64,
    /// Diameter of the milled hole or thread, mm; other holes have that of their tool.
    #[serde(default, with = "Optional::<Length>")]
    diameter: Option<f64>,
}

impl PatternTool {
    /// Returns the name in comments and on the set-up sheet.
    pub fn name(&self) -> String {
        let of_operation = match self.operation {
            Operation::SpotDrill => "SPOT DRILL",
            Operation::Drill | Operation::Peck => "DRILL",
            Operation::Tap => "TAP",
            Operation::Bore => "BORING BAR",
            Operation::MillCircle => "END MILL",
            Operation::ThreadMill => "THREAD MILL",
        };
        self.name.clone().unwrap_or_else(|| of_operation.to_owned())
    }

    /// Returns the angle of its point, degrees; `None` for a tool without one.
    pub fn point_angle(&self) -> Option<f64> {
        self.point_angle.or(self.operation.point_angle())
    }

    /// Returns true for a spot drill, which makes no feature of the drawing.
    pub fn only_spots(&self) -> bool {
        self.operation == Operation::SpotDrill
    }

    /// Returns the hand of its thread.
    pub(crate) fn hand(&self) -> Hand {
        self.hand.unwrap_or_default()
    }

    /// Returns the feed, mm/min; `None` for a tap.
    pub fn feed(&self) -> Option<f64> {
        self.feed
    }

    /// Returns the depth of cut or of a turn, or the pitch, mm; 0 for operations without either.
    pub fn increment(&self) -> f64 {
        self.peck.or(self.pitch).unwrap_or(0.0)
    }

    /// Returns true if its thread is left-hand.
    pub fn is_left_hand(&self) -> bool {
        self.hand() == Hand::Left
    }

    pub(super) fn check(&self, reader: &Reader<'_>, key: &str) -> Result<(), FileError> {
        let operation = self.operation;
        let needs_peck = matches!(operation, Operation::Peck | Operation::MillCircle);
        let threads = operation.is_threading();
        let keys = [
            ("hand", self.hand.is_some(), self.hand.is_some() && threads),
            (
                "point_angle",
                self.point_angle.is_some(),
                self.point_angle.is_some() && operation.point_angle().is_some(),
            ),
            ("feed", self.feed.is_some(), operation != Operation::Tap),
            ("peck", self.peck.is_some(), needs_peck),
            ("pitch", self.pitch.is_some(), threads),
        ];
        for (name, is_there, is_needed) in keys {
            let of = format!("operation = \"{}\"", operation.name());
            match (is_there, is_needed) {
                (false, true) => {
                    let message = format!("key 'tool.{name}' is missing: {of} needs it");
                    return Err(reader.error_at(&format!("{key}.operation"), message));
                }
                (true, false) => {
                    let message = format!("key 'tool.{name}' is not for {of}: remove it");
                    return Err(reader.error_at(&format!("{key}.{name}"), message));
                }
                _ => {}
            }
        }
        Ok(())
    }
}

impl PatternStep {
    /// Returns the diameter of the hole or thread, mm.
    pub fn diameter(&self, tool: &PatternTool) -> f64 {
        self.diameter.unwrap_or(tool.diameter)
    }

    pub(super) fn check(&self, reader: &Reader<'_>, key: &str, job: &PatternJob) -> Result<(), FileError> {
        let Some(tool) = job.tool(self.tool) else {
            let message = format!(
                "key 'pattern.make.tool' names tool {}, which is not in [[tool]]: add it, or correct the number",
                self.tool
            );
            return Err(reader.error_at(&format!("{key}.tool"), message));
        };
        let of = format!("operation = \"{}\"", tool.operation.name());
        let width = tool.diameter;
        match (self.diameter, tool.operation.is_milling()) {
            (None, false) => Ok(()),
            (None, true) => {
                let message =
                    format!("key 'pattern.make.diameter' is missing: {of} of tool {} needs it", self.tool);
                Err(reader.error_at(&format!("{key}.tool"), message))
            }
            (Some(_), false) => {
                let message =
                    format!("key 'pattern.make.diameter' is not for {of}: remove it, the tool has its own");
                Err(reader.error_at(&format!("{key}.diameter"), message))
            }
            (Some(diameter), true) if tool.operation == Operation::ThreadMill => {
                // The mill goes down in the minor diameter of the thread, 5/8 of the sharp profile's height deep.
                let core = diameter - 1.082_532 * tool.increment();
                let allowed = format_args!(
                    "a thread whose minor diameter, here {core:.3} mm, is {WALL} mm above the mill's {width} mm"
                );
                reader.check(width + WALL <= core, &format!("{key}.diameter"), diameter, allowed)
            }
            (Some(diameter), true) => {
                let (least, most) = (width + WALL, 2.0 * width);
                let allowed = format_args!(
                    "{least} to {most} mm, for a mill of {width} mm: in a wider hole one circle leaves a core"
                );
                let is_allowed = (least..=most).contains(&diameter);
                reader.check(is_allowed, &format!("{key}.diameter"), diameter, allowed)
            }
        }
    }
}
