//! Passes of tools: feeds into the part along one line, and circles of mills.
use nalgebra::{Point3, Unit, Vector3};

use crate::machine::{Machine, ToolKind};
use gcode_lang::motion::{Backtrace, Position, SpindleDirection, UnknownAxes};
use gcode_lang::units::{Deg, MmPerMin, Rpm};

/// Extent of a pass in the part's frame, with its feed and its spindle.
#[derive(Clone, Copy, Debug)]
pub struct PassCut {
    /// Point at which the feed starts.
    pub start: Point3<f64>,
    /// Deepest point.
    pub bottom: Point3<f64>,
    /// Feed at the deepest point; `None` if unknown.
    pub feed: Option<MmPerMin>,
    /// Feeds that cut least and most in a revolution down to there, with their speeds; `None` if unknown.
    pub extremes: Option<[(MmPerMin, Rpm); 2]>,
    /// Speed of the spindle in the last feed that cuts.
    pub speed: Rpm,
    /// Direction of the spindle in the last feed that cuts.
    pub direction: SpindleDirection,
    /// True if the spindle reverses in the hole, as it does for a tap.
    pub is_tapping: bool,
    /// Deepest motion of a tap out of its thread whose feed a revolution is not that of the feed in; `None` if all are alike.
    pub uneven_retract: Option<TapRetract>,
    /// Run of rigid tapping: in one run the spindle keeps its angle at each height; 0 outside.
    pub rigid_run: u32,
    /// Figures of a mill's circle; `None` for a stroke.
    pub milled: Option<MilledCut>,
    /// Place among all passes of holes, in the order of the program.
    pub order: usize,
    /// Number of sweeps that had removed metal before it.
    pub(crate) sweeps_before: u32,
}

/// Component of a unit vector below which an axis is square enough to it; the least of three is smaller.
const MAX_SQUARE_COMPONENT: f64 = 0.58;

/// Largest relative deviation of a thread's feed a revolution from its pitch: rounding of F.
pub(crate) const PITCH_TOLERANCE: f64 = 0.005;

/// Motion of a tap out of its thread.
#[derive(Clone, Copy, Debug)]
pub struct TapRetract {
    /// Point at which it begins, in the part's frame.
    pub from: Point3<f64>,
    /// Feed, and the speed of the spindle; `None` for a rapid.
    pub feed: Option<(MmPerMin, Rpm)>,
    /// Direction of the spindle.
    pub direction: SpindleDirection,
}

/// Figures of a circle that a mill cuts, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MilledCut {
    /// Radius of the path.
    pub radius: f64,
    /// Largest minus least distance of the path from the axis.
    pub roundness: f64,
    /// Height above the bottom up to which the edges cut the whole wall; infinite without a length of the flutes.
    pub wall: f64,
    /// Diameter of the metal that the mill leaves on the axis; `None` without any, or if it is unknown.
    pub core: Option<f64>,
    /// Helix of the path; `None` if it is level anywhere.
    pub helix: Option<Helix>,
}

/// Helix along which a mill goes round.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Helix {
    /// Height of a turn, mm; negative if it is left-hand.
    pub lead: f64,
    /// Lead of the first arc whose own is another one; `None` if all turns are alike.
    pub uneven_lead: Option<f64>,
    /// Height at which it crosses the direction from which angles count, from 0 to a turn, mm.
    pub phase: f64,
    /// Height of the whole helix, mm.
    pub height: f64,
    /// Largest distance of a turn's circle from the last one, in radius, mm.
    pub wander: f64,
    /// True if it makes no hole: the mill comes up along it, or goes round once.
    pub is_thread: bool,
}

impl Helix {
    /// Returns the height at which a helix crosses a direction that its axis alone gives; a point of it lies at a spoke and a
    /// height.
    pub(super) fn phase_of(lead: f64, spoke: &Vector3<f64>, out: &Unit<Vector3<f64>>, height: f64) -> f64 {
        // The same axis from both sides of the part, whatever rounding makes of a component that is 0.
        let square = (0..3).find(|axis| out[*axis].abs() < MAX_SQUARE_COMPONENT).unwrap_or(0);
        let begin = out.cross(&[Vector3::x(), Vector3::y(), Vector3::z()][square]);
        let turn = Deg::atan2(begin.cross(spoke).dot(out), begin.dot(spoke)).0;
        (height - lead * turn / 360.0).rem_euclid(lead.abs())
    }
}

impl PassCut {
    /// Returns the helix along which a mill goes round; `None` of any other pass.
    pub(crate) fn helix(&self) -> Option<Helix> {
        self.milled?.helix
    }

    /// Returns the helix of a mill that makes no hole but a thread.
    pub(crate) fn thread(&self) -> Option<Helix> {
        self.helix().filter(|helix| helix.is_thread)
    }

    /// Returns a pass of which only the extent is known.
    pub fn new(start: Point3<f64>, bottom: Point3<f64>) -> Self {
        let (speed, direction) = (Rpm(0.0), SpindleDirection::Off);
        Self {
            start,
            bottom,
            feed: None,
            extremes: None,
            speed,
            direction,
            is_tapping: false,
            uneven_retract: None,
            rigid_run: 0,
            milled: None,
            order: 0,
            sweeps_before: 0,
        }
    }
}

/// A feed into the part along one line, in the part's frame.
#[derive(Clone, Debug)]
pub(super) struct DrillPass {
    pub cut: PassCut,
    /// Direction of the tool out of the part; that of the feed if the tool's is unknown.
    pub axis: Unit<Vector3<f64>>,
    /// False if that is the direction of the feed.
    pub is_tool_axis_known: bool,
    /// Direction of the feed, out of the part.
    pub feed_direction: Unit<Vector3<f64>>,
    pub tool: Option<u32>,
    pub backtrace: Backtrace,
    pub axis_position: Position,
    /// Axes of unknown position on the part.
    pub unknown_axes: UnknownAxes,
}

impl DrillPass {
    /// Returns the diameter that the pass cuts; `None` if the tool table lacks the tool.
    pub(super) fn diameter(&self, machine: &Machine) -> Option<f64> {
        let cutter = machine.diameter_of(self.tool)?;
        let Some(circle) = self.cut.milled else { return Some(cutter) };
        // Without the noise of the arithmetic, which would be printed.
        Some(((cutter + 2.0 * circle.radius) * 1e9).round() / 1e9)
    }

    /// Returns true if the pass cuts at least as wide as another one. Of a tool of unknown diameter only the path counts; of
    /// two such tools the later one does, and so does a reamer or a boring bar, which widens what is there.
    pub(super) fn is_as_wide(&self, other: &Self, machine: &Machine) -> bool {
        let widens = matches!(machine.kind_of(self.tool), Some(ToolKind::Reamer | ToolKind::BoringBar));
        if widens && machine.diameter_of(self.tool).is_none() && self.cut.milled.is_none() {
            return true;
        }
        let path = |pass: &Self| 2.0 * pass.cut.milled.map_or(0.0, |circle| circle.radius);
        let diameter = |pass: &Self| pass.diameter(machine);
        let is_comparable = self.tool == other.tool || diameter(self).is_some() || diameter(other).is_some();
        !is_comparable || diameter(other).unwrap_or(path(other)) <= diameter(self).unwrap_or(path(self))
    }

    /// Returns true if a stroke of a tap goes on with the one before as one: at its feed and speed, in its sense, from its start, and
    /// the tap has come out as it went in.
    pub(super) fn goes_on_tapping(&self, before: &Self, rounding: f64) -> bool {
        let (own, other) = (&self.cut, &before.cut);
        own.feed == other.feed
            && own.speed == other.speed
            && (own.direction, own.rigid_run) == (other.direction, other.rigid_run)
            && other.uneven_retract.is_none()
            && (own.start - other.start).norm() <= 2.0 * rounding
    }
}
