//! Contact of the wheel with the blank between two passes: straight in where a pass begins, straight out where one ends; all
//! other contact is a collision.
use nalgebra::Point3;

use super::ROUNDING_ERROR;
use crate::holes::ROUNDING_ALLOWANCE;
use crate::holes::per_block::PerBlock;
use gcode_lang::motion::Backtrace;
use gcode_part::Flutes;

/// Kind of a collision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum CollisionKind {
    /// Rapid motion.
    Rapid,
    /// Rapid motion along a flute, in place of a pass; its number among all passes, from 1.
    RapidPass(usize),
    /// Feed without rotation of the burr, below the tooth bottom.
    BelowToothBottom,
    /// Feed without rotation of the burr, along or around it by this length, mm.
    Sideways(f64),
    /// Feed straight in where no pass begins.
    PlungeWithoutPass,
    /// Rapid that ends closer to the blank than the job's clearance; its depth is negative.
    LowClearance,
}

/// A collision, or a clearance that is too small.
#[derive(Clone, Debug)]
pub(crate) struct WheelCollision {
    pub backtrace: Backtrace,
    pub kind: CollisionKind,
    /// Deepest point on the burr, mm.
    pub point: Point3<f64>,
    /// Largest depth, mm: below the tooth bottom for [`CollisionKind::BelowToothBottom`], else below the blank's surface.
    pub depth: f64,
    /// Number of occurrences at the block.
    pub count: u64,
    /// Number of moves: several for a pass in rapid motion that begins at this block.
    pub moves: usize,
}

/// A feed straight into the blank that leads to a pass.
#[derive(Clone, Debug)]
pub(crate) struct PlungeFeed {
    pub backtrace: Backtrace,
    /// Speed of the contact, mm/min.
    pub speed: f64,
    /// End point on the burr.
    pub point: Point3<f64>,
}

/// Mode of a motion that is no pass.
#[derive(Clone, Copy, Debug)]
pub(super) enum MotionMode {
    /// `passes_before`: number of earlier passes, for a rapid that rotates the burr.
    Rapid {
        passes_before: Option<usize>,
    },
    Feed {
        seconds: f64,
    },
}

/// A rapid that ends in the cut if the axes that have not moved are at 0.
#[derive(Debug)]
struct EarlyRapid {
    backtrace: Backtrace,
    depth: DeepestPoint,
    /// Axes that have moved by its end.
    moved_axes: MovedAxes,
}

/// Axes that have moved since the start and move the contact, as bits, axis 1 the lowest.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct MovedAxes(pub(super) u32);

/// Largest sideways share of a motion straight in or out: 3°.
const MAX_SIDEWAYS_RATIO: f64 = 0.05;

/// Depth, mm, and point on the burr.
#[derive(Clone, Copy, Debug)]
struct DeepestPoint {
    depth: f64,
    point: Point3<f64>,
}

/// Position of the wheel relative to the blank.
#[derive(Clone, Debug, Default)]
enum WheelPosition {
    /// Off the blank, or unknown.
    #[default]
    OffBlank,
    /// Fed straight in, before the pass begins.
    Plunged(DeepestPoint, PlungeFeed),
    /// In the cut of a pass, or of a reported collision.
    InCut,
}

/// Checks the motion between passes.
#[derive(Debug, Default)]
pub(super) struct CollisionTracker {
    position: WheelPosition,
    collisions: PerBlock<u8, WheelCollision>,
    /// True once the wheel has been off the blank: the start of a rapid before that is unknown.
    has_been_outside: bool,
    /// Number of rapids not checked for that reason.
    pub(super) unchecked_rapids: usize,
    /// Those among them that may end in the cut.
    early_rapids: Vec<EarlyRapid>,
    /// Index in `collisions` of the current pass in rapid motion.
    current_rapid_pass: Option<usize>,
    /// Number of passes in rapid motion.
    rapid_passes: usize,
    pub(super) plunges: Vec<PlungeFeed>,
}

impl CollisionTracker {
    /// Begins or continues a pass. If no axis has moved for the first time since an early rapid, the position of that rapid
    /// is that of the flute, and it is a collision.
    pub(super) fn enter_cut(&mut self, moved: MovedAxes) {
        for early in std::mem::take(&mut self.early_rapids) {
            if early.moved_axes == moved {
                self.unchecked_rapids -= 1;
                self.add(early.backtrace, CollisionKind::Rapid, early.depth);
            }
        }
        if let WheelPosition::Plunged(_, plunge) = std::mem::replace(&mut self.position, WheelPosition::InCut)
        {
            self.plunges.push(plunge);
        }
    }

    pub(super) fn finish(mut self) -> Vec<WheelCollision> {
        self.report_plunge_without_pass();
        self.collisions
            .into_entries()
            .map(|entry| WheelCollision { count: entry.count, ..entry.value })
            .collect()
    }

    /// Reports a plunge that no pass follows.
    fn report_plunge_without_pass(&mut self) {
        if let WheelPosition::Plunged(depth, plunge) = std::mem::take(&mut self.position) {
            self.add(plunge.backtrace, CollisionKind::PlungeWithoutPass, depth);
        }
    }

    /// Adds a collision; one entry per block and kind has the deepest. Returns its index.
    fn add(&mut self, backtrace: Backtrace, kind: CollisionKind, deepest: DeepestPoint) -> usize {
        let which = match kind {
            CollisionKind::Rapid => 0,
            CollisionKind::BelowToothBottom => 1,
            CollisionKind::Sideways(_) => 2,
            CollisionKind::PlungeWithoutPass => 3,
            CollisionKind::RapidPass(_) => 4,
            CollisionKind::LowClearance => 5,
        };
        let DeepestPoint { depth, point: at } = deepest;
        let first =
            || WheelCollision { backtrace: backtrace.clone(), kind, point: at, depth, count: 0, moves: 0 };
        let (index, entry) = self.collisions.count(backtrace.block, which, first);
        let collision = &mut entry.value;
        collision.moves += 1;
        if collision.depth < depth && !matches!(kind, CollisionKind::RapidPass(_)) {
            collision.kind = kind;
        }
        collision.deepen(deepest);
        index
    }

    /// Begins or continues a pass in rapid motion after `passes` passes in feed.
    fn rapid_pass(&mut self, backtrace: Backtrace, depth: DeepestPoint, passes: usize) {
        self.position = WheelPosition::InCut;
        if let Some(entry) = self.current_rapid_pass.and_then(|index| self.collisions.get_mut(index)) {
            entry.value.moves += 1;
            entry.value.deepen(depth);
            return;
        }
        self.rapid_passes += 1;
        self.current_rapid_pass =
            Some(self.add(backtrace, CollisionKind::RapidPass(passes + self.rapid_passes), depth));
    }

    /// Checks a motion that is no pass.
    pub(super) fn check_motion(
        &mut self,
        flutes: &Flutes,
        backtrace: Backtrace,
        mode: MotionMode,
        moved: MovedAxes,
        path: &[Point3<f64>],
    ) {
        let motion = MotionProfile::of(flutes, path);
        let was_outside = self.has_been_outside;
        self.has_been_outside |= flutes.tooth_depth < motion.end_distance;
        if !motion.starts_in_cut {
            self.position = WheelPosition::OffBlank;
        }
        let depth = DeepestPoint {
            depth: (flutes.tooth_depth - motion.min_distance).max(0.0),
            point: motion.deepest_point,
        };
        if let (true, MotionMode::Rapid { passes_before: Some(passes) }, true) =
            (was_outside, mode, motion.is_slanted && motion.starts_in_cut && motion.ends_in_cut)
        {
            return self.rapid_pass(backtrace, depth, passes);
        }
        self.current_rapid_pass = None;
        let MotionMode::Feed { seconds } = mode else {
            self.report_plunge_without_pass();
            self.position = if motion.ends_in_cut { WheelPosition::InCut } else { WheelPosition::OffBlank };
            // A rapid straight out of the cut starts on the tooth bottom.
            let leaves = motion.is_receding
                && motion.is_straight
                && -flutes.surface_tolerance - ROUNDING_ERROR < motion.start_distance;
            if !was_outside {
                self.unchecked_rapids += 1;
                if let Some(at) = path.last().copied().filter(|_| motion.ends_in_cut) {
                    let depth = DeepestPoint { depth: flutes.tooth_depth - motion.end_distance, point: at };
                    self.early_rapids.push(EarlyRapid { backtrace, depth, moved_axes: moved });
                }
            } else if !leaves && motion.min_distance < flutes.tooth_depth + ROUNDING_ERROR {
                self.add(backtrace, CollisionKind::Rapid, depth);
            } else if let (Some(clearance), Some(at)) = (flutes.clearance, path.last().copied()) {
                let above = motion.end_distance - flutes.tooth_depth;
                if above < clearance - ROUNDING_ALLOWANCE {
                    self.add(
                        backtrace,
                        CollisionKind::LowClearance,
                        DeepestPoint { depth: -above, point: at },
                    );
                }
            }
            return;
        };
        if motion.min_distance < -flutes.surface_tolerance - ROUNDING_ERROR {
            self.add(
                backtrace.clone(),
                CollisionKind::BelowToothBottom,
                DeepestPoint { depth: -motion.min_distance, point: motion.deepest_point },
            );
        }
        if !motion.is_straight {
            self.add(backtrace, CollisionKind::Sideways(motion.sideways_length), depth);
            self.position = if motion.ends_in_cut { WheelPosition::InCut } else { WheelPosition::OffBlank };
        } else if !motion.ends_in_cut {
            self.report_plunge_without_pass();
        } else if motion.starts_in_cut && matches!(self.position, WheelPosition::OffBlank) {
            // A program that starts in the cut has an unknown approach.
            self.position = WheelPosition::InCut;
        } else if motion.end_distance < motion.start_distance
            && !matches!(self.position, WheelPosition::InCut)
        {
            let length: f64 = path.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum();
            let at = path.last().copied().unwrap_or(motion.deepest_point);
            let here = PlungeFeed { backtrace, speed: 60.0 * length / seconds, point: at };
            // Of several feeds the fastest counts.
            let plunge = match std::mem::take(&mut self.position) {
                WheelPosition::Plunged(_, before) if here.speed <= before.speed => before,
                WheelPosition::OffBlank | WheelPosition::Plunged(..) | WheelPosition::InCut => here,
            };
            self.position = WheelPosition::Plunged(depth, plunge);
        }
    }
}

/// A motion relative to the blank.
struct MotionProfile {
    /// Distances from the tooth bottom, mm.
    start_distance: f64,
    end_distance: f64,
    min_distance: f64,
    deepest_point: Point3<f64>,
    /// True if it starts and if it ends in the cut.
    starts_in_cut: bool,
    ends_in_cut: bool,
    /// True if it only moves away from the burr.
    is_receding: bool,
    /// True if it is straight in or out while in the cut.
    is_straight: bool,
    /// Length along and around the burr while in the cut, mm.
    sideways_length: f64,
    /// True if it moves along the burr while in the cut, not only around it.
    is_slanted: bool,
}

impl WheelCollision {
    fn deepen(&mut self, DeepestPoint { depth, point: at }: DeepestPoint) {
        if self.depth < depth {
            (self.depth, self.point) = (depth, at);
        }
    }
}

impl MotionProfile {
    fn of(flutes: &Flutes, path: &[Point3<f64>]) -> Self {
        let profile = &flutes.profile;
        let distances: Vec<f64> = path.iter().map(|p| profile.distance(p)).collect();
        // Within the tolerance of the tooth bottom the wheel is in the cut even without a blank above it.
        let cut = flutes.tooth_depth.max(flutes.surface_tolerance) - ROUNDING_ERROR;
        let (first, last) = (distances.first().copied(), distances.last().copied());
        let (mut sideways, mut length, mut along) = (0.0, 0.0, 0.0);
        for (points, off) in path.windows(2).zip(distances.windows(2)) {
            if cut <= off[0] || cut <= off[1] {
                continue;
            }
            let by = points[1] - points[0];
            let (meridian, around) = profile.directions(&nalgebra::center(&points[0], &points[1]));
            sideways += libm::hypot(by.dot(&meridian), by.dot(&around));
            length += by.norm();
            along += by.dot(&meridian).abs();
        }
        let far = f64::INFINITY;
        let nearer = |best: (f64, Point3<f64>), (off, at): (&f64, &Point3<f64>)| {
            if *off < best.0 { (*off, *at) } else { best }
        };
        let (nearest, deepest) = distances.iter().zip(path).fold((far, Point3::origin()), nearer);
        Self {
            start_distance: first.unwrap_or(far),
            end_distance: last.unwrap_or(far),
            min_distance: nearest,
            deepest_point: deepest,
            starts_in_cut: first.is_some_and(|first| first < cut),
            ends_in_cut: last.is_some_and(|last| last < cut),
            is_receding: distances.windows(2).all(|pair| pair[0] < pair[1]),
            is_straight: sideways <= flutes.surface_tolerance + MAX_SIDEWAYS_RATIO * length,
            sideways_length: sideways,
            is_slanted: MAX_SIDEWAYS_RATIO * length < along,
        }
    }
}
