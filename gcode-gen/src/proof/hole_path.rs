//! The hole that a way of a program drills: the moves into it, the rotary, and the head's angle.
use gcode_enclosure::{NodeId, Unary};
use gcode_lang::motion::AxisIndex;
use gcode_prove::{MoveKind, Trace, TracedMove, TracedStop, TracedWay};

/// Axes of the machine of a pin-hole job.
#[derive(Clone, Copy, Debug)]
pub(super) struct PinAxes {
    pub(super) x: AxisIndex,
    pub(super) y: AxisIndex,
    pub(super) z: AxisIndex,
    pub(super) rotary: AxisIndex,
    /// The head's, if it is an axis.
    pub(super) head: Option<AxisIndex>,
}

/// Part of a way before or after the hole, in which the tool isn't in the part's material.
#[derive(Clone, Copy, Debug)]
pub(super) enum Passage {
    /// Rapid move of the head's pivot in X and Y.
    Rapid { from: [NodeId; 2], to: [NodeId; 2] },
    /// Turn of the head while its pivot stands.
    HeadTurn { at: [NodeId; 2] },
}

/// Hole of a way, in machine coordinates.
#[derive(Clone, Debug)]
pub(super) struct HolePath {
    /// What the tool does before and after the hole, from the macro's start; `None` if it isn't followed.
    pub(super) passages: Option<Vec<Passage>>,
    /// Head's pivot at the bottom of the hole.
    pub(super) x: NodeId,
    pub(super) y: NodeId,
    pub(super) rotary: NodeId,
    /// Angle of the head in degrees.
    pub(super) angle: NodeId,
    /// Its cosine and sine as the control computes them.
    pub(super) cosine: NodeId,
    pub(super) sine: NodeId,
}

impl HolePath {
    /// Returns the only hole of a way; what isn't as a proof follows it.
    pub(super) fn of(trace: &mut Trace, way: &TracedWay, axes: PinAxes) -> Result<Self, String> {
        if let Some(other) = way.moves.iter().find(|one| one.kind == MoveKind::Other) {
            return Err(format!("{}: a move that is neither G00 nor G01", other.place));
        }
        let is_feed = |one: &TracedMove| one.kind == MoveKind::Feed;
        let first = way.moves.iter().position(is_feed).ok_or("a way without a feed")?;
        let into = &way.moves[first];
        let at = |positions: &[Option<NodeId>], axis: AxisIndex| positions.get(axis).copied().flatten();
        let is_kept =
            |axis: AxisIndex| at(&into.from, axis).is_some() && at(&into.from, axis) == at(&into.to, axis);
        let all_kept = (0..into.to.len()).filter(|axis| *axis != axes.x && *axis != axes.y).all(is_kept);
        if !all_kept {
            return Err(format!("{}: a feed that moves more than X and Y", into.place));
        }
        let z = at(&into.to, axes.z).and_then(|z| trace.arena().as_constant(z));
        if z != Some(0.0) {
            return Err(format!("{}: Z isn't 0 in the hole", into.place));
        }
        let Some(back) = way.moves.get(first + 1) else {
            return Err(format!("{}: the tool stays in the hole", into.place));
        };
        if back.to != into.from {
            return Err(format!("{}: the tool doesn't return to the start of its feed", back.place));
        }
        if let Some(again) = way.moves[first + 2..].iter().find(|one| is_feed(one)) {
            return Err(format!("{}: a second feed", again.place));
        }
        let unfollowed = || format!("{}: a position that isn't followed", into.place);
        let position = |axis: AxisIndex| at(&into.to, axis).ok_or_else(unfollowed);
        let angle = match axes.head {
            Some(axis) => position(axis)?,
            None => {
                let mut heads = way.stops.iter().filter(|stop| stop.moves <= first && names_head(&stop.text));
                let stop = heads.next_back().ok_or("the head is never set")?;
                match stop.variables.as_slice() {
                    [(_, Some(angle))] => *angle,
                    _ => return Err("a stop for the head whose angle isn't clear".to_owned()),
                }
            }
        };
        let (x, y, rotary) = (position(axes.x)?, position(axes.y)?, position(axes.rotary)?);
        let passages = passages(trace, way, axes, first);
        let (cosine, sine) = (trace.function(Unary::Cos, angle), trace.function(Unary::Sin, angle));
        Ok(Self { passages, x, y, rotary, angle, cosine, sine })
    }
}

/// Returns what the tool does outside the hole, whose feeds are a move and the next; `None` if Z leaves 0, or if something isn't
/// followed.
fn passages(trace: &Trace, way: &TracedWay, axes: PinAxes, hole: usize) -> Option<Vec<Passage>> {
    let at = |positions: &[Option<NodeId>], axis: AxisIndex| positions.get(axis).copied().flatten();
    let pivot = |positions: &[Option<NodeId>]| Some([at(positions, axes.x)?, at(positions, axes.y)?]);
    let mut passages = Vec::new();
    for (index, one) in way.moves.iter().enumerate() {
        for _ in way.stops.iter().filter(|stop| stop.moves == index && names_head(&stop.text)) {
            passages.push(Passage::HeadTurn { at: pivot(&one.from)? });
        }
        if index == hole || index == hole + 1 || is_of_request(one) {
            continue;
        }
        let is_in_plane = |positions: &[Option<NodeId>]| {
            at(positions, axes.z).and_then(|z| trace.arena().as_constant(z)) == Some(0.0)
        };
        if !is_in_plane(&one.from) || !is_in_plane(&one.to) {
            return None;
        }
        let (from, to) = (pivot(&one.from)?, pivot(&one.to)?);
        let turns_head = axes.head.is_some_and(|head| at(&one.from, head) != at(&one.to, head));
        match (turns_head, from == to) {
            (true, true) => passages.push(Passage::HeadTurn { at: from }),
            (true, false) => return None,
            (false, true) => {}
            (false, false) => passages.push(Passage::Rapid { from, to }),
        }
    }
    // A stop behind the last move is one after the hole.
    let is_last = |stop: &TracedStop| stop.moves >= way.moves.len() && names_head(&stop.text);
    (!way.stops.iter().any(is_last)).then_some(passages)
}

/// Returns true for a move of the request's own block, which has no number, and not of a macro.
fn is_of_request(one: &TracedMove) -> bool {
    one.place.starts_with("MAIN ")
}

/// Returns true for a message to the operator that has the word HEAD.
fn names_head(text: &str) -> bool {
    text.split(|c: char| !c.is_ascii_alphanumeric()).any(|word| word.eq_ignore_ascii_case("HEAD"))
}
