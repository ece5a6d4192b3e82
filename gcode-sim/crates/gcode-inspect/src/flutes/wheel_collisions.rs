//! What the wheel does in the blank between two passes: it may go straight in where a pass begins and straight out where
//! one ends; all else is a dive.
use nalgebra::Point3;

use super::ROUNDING_ERROR;
use crate::holes::ROUNDING_ALLOWANCE;
use crate::holes::per_block::PerBlock;
use gcode_lang::motion::Backtrace;
use gcode_part::Flutes;

/// How the wheel came into the burr where no pass was.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CollisionKind {
    /// In rapid motion.
    Rapid,
    /// In rapid motion along a flute, as a pass would go; which of all passes it is, counted from 1.
    RapidPass(usize),
    /// A feed that doesn't turn the burr, below the tooth bottom.
    BelowToothBottom,
    /// A feed that doesn't turn the burr, so far along or around it, mm.
    Sideways(f64),
    /// Straight in, where no pass begins.
    PlungeWithoutPass,
    /// A rapid that ends nearer to the blank than the job's clearance; its depth is below 0.
    LowClearance,
}

/// Where the wheel came too near between two passes.
#[derive(Clone, Debug)]
pub struct WheelCollision {
    pub backtrace: Backtrace,
    pub kind: CollisionKind,
    /// Where on the burr it was deepest, mm.
    pub point: Point3<f64>,
    /// Where it was nearest: below the tooth bottom if that is what's wrong, else below the blank's surface, mm.
    pub depth: f64,
    /// How often the block did it; the depth is the greatest.
    pub count: u64,
    /// Moves, of a pass in rapid motion that begins at this block more than one.
    pub moves: usize,
}

/// A feed straight into the blank, behind which a pass begins.
#[derive(Clone, Debug)]
pub struct PlungeFeed {
    pub backtrace: Backtrace,
    /// Of the contact, mm/min.
    pub speed: f64,
    /// Where it ends, on the burr.
    pub point: Point3<f64>,
}

/// How a motion that is no pass is made.
#[derive(Clone, Copy, Debug)]
pub(super) enum MotionMode {
    /// Where it turns the burr: behind so many passes.
    Rapid {
        passes_before: Option<usize>,
    },
    Feed {
        seconds: f64,
    },
}

/// A rapid that ended in the cut, reckoned with axes at 0 that hadn't moved.
#[derive(Debug)]
struct EarlyRapid {
    backtrace: Backtrace,
    depth: DeepestPoint,
    /// The axes that had moved by its end.
    moved_axes: MovedAxes,
}

/// The axes that the contact's place depends on and that have moved since the start, as bits, axis 1 the lowest.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct MovedAxes(pub(super) u32);

/// Motion is straight in or out if it goes no more than this part of its way sideways: 3°.
const MAX_SIDEWAYS_RATIO: f64 = 0.05;

/// How deep, mm, and where on the burr.
#[derive(Clone, Copy, Debug)]
struct DeepestPoint {
    depth: f64,
    point: Point3<f64>,
}

/// How the wheel stands.
#[derive(Clone, Debug, Default)]
enum WheelPosition {
    /// Off the blank, or nothing is known.
    #[default]
    OffBlank,
    /// Fed straight in here, so far below the blank's surface, and no pass has begun yet.
    Plunged(DeepestPoint, PlungeFeed),
    /// In the cut of a pass that began here, or of a dive that is told already.
    InCut,
}

/// Looks at every motion between two passes.
#[derive(Debug, Default)]
pub(super) struct CollisionTracker {
    position: WheelPosition,
    collisions: PerBlock<u8, WheelCollision>,
    /// The wheel has been off the blank: before that, nobody knows where a rapid began.
    has_been_outside: bool,
    /// Rapids that weren't looked at for that reason.
    pub(super) unchecked_rapids: usize,
    /// Those of them that ended in the cut before the first pass began, if the axes stood as is reckoned.
    early_rapids: Vec<EarlyRapid>,
    /// The pass in rapid motion that goes on, in `found`, and how many there were.
    current_rapid_pass: Option<usize>,
    rapid_passes: usize,
    pub(super) plunges: Vec<PlungeFeed>,
}

impl CollisionTracker {
    /// A pass goes on, or begins where the wheel stands. An axis that hadn't moved when a rapid ended and hasn't yet stood
    /// there as it does now, where the flute is reckoned with it.
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

    /// The wheel stood in the blank and no pass began.
    fn report_plunge_without_pass(&mut self) {
        if let WheelPosition::Plunged(depth, plunge) = std::mem::take(&mut self.position) {
            self.add(plunge.backtrace, CollisionKind::PlungeWithoutPass, depth);
        }
    }

    /// The deepest of each block: a loop makes all of its dives alike.
    fn add(&mut self, place: Backtrace, kind: CollisionKind, deepest: DeepestPoint) -> usize {
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
            || WheelCollision { backtrace: place.clone(), kind, point: at, depth, count: 0, moves: 0 };
        let (index, entry) = self.collisions.count(place.block, which, first);
        let dive = &mut entry.value;
        dive.moves += 1;
        if dive.depth < depth && !matches!(kind, CollisionKind::RapidPass(_)) {
            dive.kind = kind;
        }
        dive.deepen(deepest);
        index
    }

    /// A rapid that goes along a flute in the blank: a pass begins with it, or goes on. `passes`: those in feed so far.
    fn rapid_pass(&mut self, place: Backtrace, depth: DeepestPoint, passes: usize) {
        self.position = WheelPosition::InCut;
        if let Some(entry) = self.current_rapid_pass.and_then(|index| self.collisions.get_mut(index)) {
            entry.value.moves += 1;
            entry.value.deepen(depth);
            return;
        }
        self.rapid_passes += 1;
        self.current_rapid_pass =
            Some(self.add(place, CollisionKind::RapidPass(passes + self.rapid_passes), depth));
    }

    /// Looks at a motion that is no pass.
    pub(super) fn check_motion(
        &mut self,
        flutes: &Flutes,
        place: Backtrace,
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
            return self.rapid_pass(place, depth, passes);
        }
        self.current_rapid_pass = None;
        let MotionMode::Feed { seconds } = mode else {
            self.report_plunge_without_pass();
            self.position = if motion.ends_in_cut { WheelPosition::InCut } else { WheelPosition::OffBlank };
            // A rapid that goes straight out of the cut begins on the tooth bottom.
            let leaves = motion.is_receding
                && motion.is_straight
                && -flutes.surface_tolerance - ROUNDING_ERROR < motion.start_distance;
            if !was_outside {
                self.unchecked_rapids += 1;
                if let Some(at) = path.last().copied().filter(|_| motion.ends_in_cut) {
                    let depth = DeepestPoint { depth: flutes.tooth_depth - motion.end_distance, point: at };
                    self.early_rapids.push(EarlyRapid { backtrace: place, depth, moved_axes: moved });
                }
            } else if !leaves && motion.min_distance < flutes.tooth_depth + ROUNDING_ERROR {
                self.add(place, CollisionKind::Rapid, depth);
            } else if let (Some(clearance), Some(at)) = (flutes.clearance, path.last().copied()) {
                let above = motion.end_distance - flutes.tooth_depth;
                if above < clearance - ROUNDING_ALLOWANCE {
                    self.add(place, CollisionKind::LowClearance, DeepestPoint { depth: -above, point: at });
                }
            }
            return;
        };
        if motion.min_distance < -flutes.surface_tolerance - ROUNDING_ERROR {
            self.add(
                place.clone(),
                CollisionKind::BelowToothBottom,
                DeepestPoint { depth: -motion.min_distance, point: motion.deepest_point },
            );
        }
        if !motion.is_straight {
            self.add(place, CollisionKind::Sideways(motion.sideways_length), depth);
            self.position = if motion.ends_in_cut { WheelPosition::InCut } else { WheelPosition::OffBlank };
        } else if !motion.ends_in_cut {
            self.report_plunge_without_pass();
        } else if motion.starts_in_cut && matches!(self.position, WheelPosition::OffBlank) {
            // Where the program begins in the cut, nobody knows how it came there.
            self.position = WheelPosition::InCut;
        } else if motion.end_distance < motion.start_distance
            && !matches!(self.position, WheelPosition::InCut)
        {
            let length: f64 = path.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum();
            let at = path.last().copied().unwrap_or(motion.deepest_point);
            let here = PlungeFeed { backtrace: place, speed: 60.0 * length / seconds, point: at };
            // Of more feeds than one the fastest.
            let plunge = match std::mem::take(&mut self.position) {
                WheelPosition::Plunged(_, before) if here.speed <= before.speed => before,
                WheelPosition::OffBlank | WheelPosition::Plunged(..) | WheelPosition::InCut => here,
            };
            self.position = WheelPosition::Plunged(depth, plunge);
        }
    }
}

/// A motion as the blank sees it.
struct MotionProfile {
    /// Distances from the tooth bottom, mm.
    start_distance: f64,
    end_distance: f64,
    min_distance: f64,
    deepest_point: Point3<f64>,
    /// Whether it starts and ends in the cut.
    starts_in_cut: bool,
    ends_in_cut: bool,
    /// It goes away from the burr all the time.
    is_receding: bool,
    /// In the cut it goes straight in or out.
    is_straight: bool,
    /// How far it goes along and around the burr in the cut, mm.
    sideways_length: f64,
    /// In the cut it goes along the burr, not just around it.
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
        // What is as near to the tooth bottom as a pass may be is in the cut even if no blank stands above it.
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
