//! What the wheel does in the blank between two passes: it may go straight in where a pass begins and straight out where
//! one ends; all else is a dive.
use nalgebra::Point3;

use super::ARITHMETIC;
use crate::holes::ROUNDED;
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
    Below,
    /// A feed that doesn't turn the burr, so far along or around it, mm.
    Sideways(f64),
    /// Straight in, where no pass begins.
    Pit,
    /// A rapid that ends nearer to the blank than the job's clearance; its depth is below 0.
    Near,
}

/// Where the wheel came too near between two passes.
#[derive(Clone, Debug)]
pub struct WheelCollision {
    pub place: Backtrace,
    pub kind: CollisionKind,
    /// Where on the burr it was deepest, mm.
    pub at: Point3<f64>,
    /// Where it was nearest: below the tooth bottom if that is what's wrong, else below the blank's surface, mm.
    pub depth: f64,
    /// How often the block did it; the depth is the greatest.
    pub times: u64,
    /// Moves, of a pass in rapid motion that begins at this block more than one.
    pub moves: usize,
}

/// A feed straight into the blank, behind which a pass begins.
#[derive(Clone, Debug)]
pub struct PlungeFeed {
    pub place: Backtrace,
    /// Of the contact, mm/min.
    pub speed: f64,
    /// Where it ends, on the burr.
    pub at: Point3<f64>,
}

/// How a motion that is no pass is made.
#[derive(Clone, Copy, Debug)]
pub(super) enum MotionMode {
    /// Where it turns the burr: behind so many passes.
    Rapid {
        turns: Option<usize>,
    },
    Feed {
        seconds: f64,
    },
}

/// A rapid that ended in the cut, reckoned with axes at 0 that hadn't moved.
#[derive(Debug)]
struct EarlyRapid {
    place: Backtrace,
    depth: Depth,
    /// The axes that had moved by its end.
    moved: Moved,
}

/// The axes that the contact's place depends on and that have moved since the start, as bits, axis 1 the lowest.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Moved(pub(super) u32);

/// Motion is straight in or out if it goes no more than this part of its way sideways: 3°.
const STRAIGHT: f64 = 0.05;

/// How deep, mm, and where on the burr.
#[derive(Clone, Copy, Debug)]
struct Depth {
    depth: f64,
    at: Point3<f64>,
}

/// How the wheel stands.
#[derive(Clone, Debug, Default)]
enum WheelPosition {
    /// Off the blank, or nothing is known.
    #[default]
    Off,
    /// Fed straight in here, so far below the blank's surface, and no pass has begun yet.
    Plunged(Depth, PlungeFeed),
    /// In the cut of a pass that began here, or of a dive that is told already.
    Ground,
}

/// Looks at every motion between two passes.
#[derive(Debug, Default)]
pub(super) struct CollisionTracker {
    stand: WheelPosition,
    found: PerBlock<u8, WheelCollision>,
    /// The wheel has been off the blank: before that, nobody knows where a rapid began.
    outside: bool,
    /// Rapids that weren't looked at for that reason.
    pub(super) unseen: usize,
    /// Those of them that ended in the cut before the first pass began, if the axes stood as is reckoned.
    early: Vec<EarlyRapid>,
    /// The pass in rapid motion that goes on, in `found`, and how many there were.
    rapid: Option<usize>,
    rapids: usize,
    pub(super) plunges: Vec<PlungeFeed>,
}

impl CollisionTracker {
    /// A pass goes on, or begins where the wheel stands. An axis that hadn't moved when a rapid ended and hasn't yet stood
    /// there as it does now, where the flute is reckoned with it.
    pub(super) fn ground(&mut self, moved: Moved) {
        for early in std::mem::take(&mut self.early) {
            if early.moved == moved {
                self.unseen -= 1;
                self.add(early.place, CollisionKind::Rapid, early.depth);
            }
        }
        if let WheelPosition::Plunged(_, plunge) = std::mem::replace(&mut self.stand, WheelPosition::Ground) {
            self.plunges.push(plunge);
        }
    }

    pub(super) fn finish(mut self) -> Vec<WheelCollision> {
        self.pit();
        self.found.into_entries().map(|entry| WheelCollision { times: entry.times, ..entry.value }).collect()
    }

    /// The wheel stood in the blank and no pass began.
    fn pit(&mut self) {
        if let WheelPosition::Plunged(depth, plunge) = std::mem::take(&mut self.stand) {
            self.add(plunge.place, CollisionKind::Pit, depth);
        }
    }

    /// The deepest of each block: a loop makes all of its dives alike.
    fn add(&mut self, place: Backtrace, kind: CollisionKind, deepest: Depth) -> usize {
        let which = match kind {
            CollisionKind::Rapid => 0,
            CollisionKind::Below => 1,
            CollisionKind::Sideways(_) => 2,
            CollisionKind::Pit => 3,
            CollisionKind::RapidPass(_) => 4,
            CollisionKind::Near => 5,
        };
        let Depth { depth, at } = deepest;
        let first = || WheelCollision { place: place.clone(), kind, at, depth, times: 0, moves: 0 };
        let (index, entry) = self.found.count(place.block, which, first);
        let dive = &mut entry.value;
        dive.moves += 1;
        if dive.depth < depth && !matches!(kind, CollisionKind::RapidPass(_)) {
            dive.kind = kind;
        }
        dive.deepen(deepest);
        index
    }

    /// A rapid that goes along a flute in the blank: a pass begins with it, or goes on. `passes`: those in feed so far.
    fn rapid_pass(&mut self, place: Backtrace, depth: Depth, passes: usize) {
        self.stand = WheelPosition::Ground;
        if let Some(entry) = self.rapid.and_then(|index| self.found.get_mut(index)) {
            entry.value.moves += 1;
            entry.value.deepen(depth);
            return;
        }
        self.rapids += 1;
        self.rapid = Some(self.add(place, CollisionKind::RapidPass(passes + self.rapids), depth));
    }

    /// Looks at a motion that is no pass.
    pub(super) fn check_motion(
        &mut self,
        flutes: &Flutes,
        place: Backtrace,
        by: MotionMode,
        moved: Moved,
        path: &[Point3<f64>],
    ) {
        let way = MotionProfile::of(flutes, path);
        let known = self.outside;
        self.outside |= flutes.tooth_depth < way.last;
        if !way.starts {
            self.stand = WheelPosition::Off;
        }
        let depth = Depth { depth: (flutes.tooth_depth - way.nearest).max(0.0), at: way.deepest };
        if let (true, MotionMode::Rapid { turns: Some(passes) }, true) =
            (known, by, way.slants && way.starts && way.ends)
        {
            return self.rapid_pass(place, depth, passes);
        }
        self.rapid = None;
        let MotionMode::Feed { seconds } = by else {
            self.pit();
            self.stand = if way.ends { WheelPosition::Ground } else { WheelPosition::Off };
            // A rapid that goes straight out of the cut begins on the tooth bottom.
            let leaves = way.leaves && way.straight && -flutes.surface_tolerance - ARITHMETIC < way.first;
            if !known {
                self.unseen += 1;
                if let Some(at) = path.last().copied().filter(|_| way.ends) {
                    let depth = Depth { depth: flutes.tooth_depth - way.last, at };
                    self.early.push(EarlyRapid { place, depth, moved });
                }
            } else if !leaves && way.nearest < flutes.tooth_depth + ARITHMETIC {
                self.add(place, CollisionKind::Rapid, depth);
            } else if let (Some(clearance), Some(at)) = (flutes.clearance, path.last().copied()) {
                let above = way.last - flutes.tooth_depth;
                if above < clearance - ROUNDED {
                    self.add(place, CollisionKind::Near, Depth { depth: -above, at });
                }
            }
            return;
        };
        if way.nearest < -flutes.surface_tolerance - ARITHMETIC {
            self.add(place.clone(), CollisionKind::Below, Depth { depth: -way.nearest, at: way.deepest });
        }
        if !way.straight {
            self.add(place, CollisionKind::Sideways(way.sideways), depth);
            self.stand = if way.ends { WheelPosition::Ground } else { WheelPosition::Off };
        } else if !way.ends {
            self.pit();
        } else if way.starts && matches!(self.stand, WheelPosition::Off) {
            // Where the program begins in the cut, nobody knows how it came there.
            self.stand = WheelPosition::Ground;
        } else if way.last < way.first && !matches!(self.stand, WheelPosition::Ground) {
            let length: f64 = path.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum();
            let at = path.last().copied().unwrap_or(way.deepest);
            let here = PlungeFeed { place, speed: 60.0 * length / seconds, at };
            // Of more feeds than one the fastest.
            let plunge = match std::mem::take(&mut self.stand) {
                WheelPosition::Plunged(_, before) if here.speed <= before.speed => before,
                WheelPosition::Off | WheelPosition::Plunged(..) | WheelPosition::Ground => here,
            };
            self.stand = WheelPosition::Plunged(depth, plunge);
        }
    }
}

/// A motion as the blank sees it.
struct MotionProfile {
    /// Distances from the tooth bottom, mm.
    first: f64,
    last: f64,
    nearest: f64,
    deepest: Point3<f64>,
    /// Whether it starts and ends in the cut.
    starts: bool,
    ends: bool,
    /// It goes away from the burr all the time.
    leaves: bool,
    /// In the cut it goes straight in or out.
    straight: bool,
    /// How far it goes along and around the burr in the cut, mm.
    sideways: f64,
    /// In the cut it goes along the burr, not just around it.
    slants: bool,
}

impl WheelCollision {
    fn deepen(&mut self, Depth { depth, at }: Depth) {
        if self.depth < depth {
            (self.depth, self.at) = (depth, at);
        }
    }
}

impl MotionProfile {
    fn of(flutes: &Flutes, path: &[Point3<f64>]) -> Self {
        let profile = &flutes.profile;
        let distances: Vec<f64> = path.iter().map(|p| profile.distance(p)).collect();
        // What is as near to the tooth bottom as a pass may be is in the cut even if no blank stands above it.
        let cut = flutes.tooth_depth.max(flutes.surface_tolerance) - ARITHMETIC;
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
            first: first.unwrap_or(far),
            last: last.unwrap_or(far),
            nearest,
            deepest,
            starts: first.is_some_and(|first| first < cut),
            ends: last.is_some_and(|last| last < cut),
            leaves: distances.windows(2).all(|pair| pair[0] < pair[1]),
            straight: sideways <= flutes.surface_tolerance + STRAIGHT * length,
            sideways,
            slants: STRAIGHT * length < along,
        }
    }
}
