//! Moves, feeds, tools, spindle and stops that are different and that no changed hole explains.
use std::collections::BTreeSet;

use super::align::StepPair;
use super::arcs::reshaped;
use super::cause::is_same_block;
use super::change::Change;
use super::condition_changes::{Conditions, Strokes};
use super::descriptions::{code, describe, point};
use super::end_state::mode;
use super::groups::{Groups, StepRefs};
use super::holes::ExplainedSteps;
use super::record::Record;
use super::redundant_commands::{is_redundant, is_speed_alone, redundant_commands};
use super::reordered_cuts::ReorderedCuts;
use super::return_rapids::find_return_rapids;
use super::same_block::{steps_with_m_code, steps_with_moves};
use super::shifted_events::{shifted_events, take_with_runs};
use super::steps::{Step, StepKind, UnsimulatedKind, difference, goes_with, near};
use super::tool_setup::{relied_on_changes, set_up};
use gcode_lang::motion::{Axes, MAX_AXES, Position};

pub(super) fn compare(
    (old, new): (&Record, &Record),
    links: &[StepPair],
    (explained, displaced): (&ExplainedSteps, &ReorderedCuts<'_>),
    tolerance: f64,
    is_one_edit: bool,
) -> (Vec<Change>, BTreeSet<u32>) {
    let conditions = Conditions::new(old, new, links);
    let strokes = conditions.strokes();
    let (records, axes) = ((old, new), &old.axes);
    let mut motion = Motion {
        old: &old.steps,
        new: &new.steps,
        axes,
        tolerance,
        groups: Groups::new(old, new, tolerance),
        strokes,
        elsewhere: elsewhere(links, &old.steps, &new.steps, tolerance),
        records,
    };
    for mut region in regions(links, &old.steps, &new.steps) {
        region.retain(|(_, link)| !displaced.contains(link));
        motion.region(&region, links, explained);
    }
    let mut shifted = shifted_events(links, (&old.steps, &new.steps), tolerance);
    let mut set_up = set_up(links, explained, (&old.steps, &new.steps));
    set_up.extend(take_with_runs(&mut shifted, links, displaced));
    let untold = |k| set_up.contains(&k) && !shifted.contains_key(&k);
    let relied = relied_on_changes(links, untold, records, tolerance);
    set_up.extend(steps_with_m_code(links, &old.steps, &new.steps));
    set_up.extend(steps_with_moves(links, &old.steps, &new.steps));
    set_up.extend(redundant_commands(links, &old.steps, &new.steps));
    for (k, link) in links.iter().enumerate() {
        match shifted.get(&k) {
            None if set_up.contains(&k) => {}
            None => motion.step(*link, explained),
            Some(None) => {}
            // Beside the rapids of another level the same block stands at another time, and so does the spindle's
            // turn in another cycle.
            Some(Some((i, j, _))) if motion.is_of_strokes(*i, *j) => {}
            Some(Some((i, j, _))) if is_redundant(&old.steps, *i) && is_redundant(&new.steps, *j) => {}
            Some(Some((i, j, word))) => motion.shifted(*i, *j, word),
        }
    }
    let (mut changes, mut modes) = conditions.changes();
    let kinds = [("G00", "G01", KINDS[0]), ("G01", "G00", KINDS[1])];
    let left = (mode(old, 1), mode(new, 1));
    let kind = kinds
        .into_iter()
        .find(|(was, is, _)| (left.0.as_deref(), left.1.as_deref()) == (Some(was), Some(is)));
    if kind.is_some_and(|(_, _, text)| motion.groups.stays("move-kind", text)) {
        modes.insert(1);
    }
    if is_one_edit {
        motion.groups.join_shifts();
    }
    changes.extend(motion.groups.changes());
    changes.extend(displaced.changes(links));
    changes.extend(relied);
    (changes, modes)
}

/// What is said of G01 where G00 was, and of G00 where G01 was.
const KINDS: [&str; 2] = ["a feed instead of a rapid", "a rapid instead of a feed"];

/// Moves next to one another that are all different, each with its place among the links; other steps between them
/// don't part them.
fn regions(links: &[StepPair], old: &[Step], new: &[Step]) -> Vec<Vec<(usize, StepPair)>> {
    let mut regions = vec![Vec::new()];
    for (k, link) in links.iter().enumerate() {
        let (i, j) = link.sides();
        let is_move = i.map(|i| &old[i]).or(j.map(|j| &new[j])).is_some_and(Step::is_move);
        match (is_move, link) {
            (false, _) => {}
            (true, StepPair::Same(..)) => regions.push(Vec::new()),
            (true, _) => regions.last_mut().into_iter().for_each(|region| region.push((k, *link))),
        }
    }
    regions.retain(|region| !region.is_empty());
    regions
}

/// More ways than these aren't kept: a new move is looked for among them.
const MOST_WAYS: usize = 64;

/// By how much moves end elsewhere.
fn elsewhere(links: &[StepPair], old: &[Step], new: &[Step], tolerance: f64) -> Vec<Position> {
    let mut ways: Vec<Position> = Vec::new();
    for link in links {
        let StepPair::Changed(i, j) = *link else { continue };
        let way = difference(&new[j].to, &old[i].to);
        let is_known = |known: &Position| near(known, &way, tolerance);
        if old[i].is_move() && !is_known(&Position::default()) && !ways.iter().any(is_known) {
            ways.push(way);
        }
        if ways.len() == MOST_WAYS {
            break;
        }
    }
    ways
}

/// A feed of a changed hole.
#[derive(Clone, Copy)]
pub(super) struct Feed {
    link: StepPair,
    /// How much deeper the hole is, mm; `None` for one that is lost, added or made at another time.
    pub deeper: Option<f64>,
}

pub(super) fn feed_of(link: &StepPair, explained: &ExplainedSteps) -> Option<Feed> {
    let (old, new) = link.sides();
    let (shifted, elsewhen) = (&explained.shifted, &explained.elsewhen);
    let deeper = old.and_then(|i| shifted.0.get(&i)).or_else(|| new.and_then(|j| shifted.1.get(&j)));
    let is_elsewhen =
        old.is_some_and(|i| elsewhen.0.contains(&i)) || new.is_some_and(|j| elsewhen.1.contains(&j));
    match (is_elsewhen, deeper) {
        (true, _) => Some(Feed { link: *link, deeper: None }),
        (false, Some(deeper)) => Some(Feed { link: *link, deeper: Some(*deeper) }),
        (false, None) => None,
    }
}

/// For every link the last feed so far.
fn nearest<'a>(
    links: impl Iterator<Item = &'a StepPair>,
    feed: impl Fn(&StepPair) -> Option<Feed>,
) -> Vec<Option<Feed>> {
    let mut last = None;
    links
        .map(|link| {
            last = feed(link).or(last);
            last
        })
        .collect()
}

struct Motion<'a> {
    old: &'a [Step],
    new: &'a [Step],
    axes: &'a Axes,
    tolerance: f64,
    groups: Groups<'a>,
    strokes: Strokes,
    /// By how much moves of all regions end elsewhere, the first of these ways.
    elsewhere: Vec<Position>,
    records: (&'a Record, &'a Record),
}

/// A move that ends elsewhere by as much as the one before it, in axes that it doesn't move itself.
fn is_carried(old: &Step, new: &Step, before: &Position, tolerance: f64) -> bool {
    let shift = difference(&new.to, &old.to);
    let (was, is) = (old.way(), new.way());
    let is_from_before = |axis: usize| {
        shift[axis].abs() <= tolerance
            || was[axis].abs() <= tolerance
                && is[axis].abs() <= tolerance
                && (shift[axis] - before[axis]).abs() <= tolerance
    };
    std::mem::discriminant(&old.kind) == std::mem::discriminant(&new.kind)
        && !matches!(old.kind, StepKind::Arc(..))
        && (0..MAX_AXES).all(is_from_before)
}

/// The old revision's last move before a link.
fn moves_before(links: &[StepPair], at: usize, old: &[Step]) -> Option<usize> {
    links[..at].iter().rev().filter_map(|link| link.sides().0).find(|i| old[*i].is_move())
}

impl<'a> Motion<'a> {
    /// Moves that are different, but for those of changed holes: the way there and back is part of the change.
    fn region(&mut self, placed: &[(usize, StepPair)], links: &[StepPair], explained: &ExplainedSteps) {
        let region: Vec<StepPair> = placed.iter().map(|(_, link)| *link).collect();
        let region = &region[..];
        // For every move the nearest feed of a changed hole before and behind it.
        let before = nearest(region.iter(), |link| feed_of(link, explained));
        let mut behind = nearest(region.iter().rev(), |link| feed_of(link, explained));
        behind.reverse();
        let gone = before.iter().flatten().any(|feed| feed.deeper.is_none());
        // One peck more or fewer.
        let is_peck = |k: usize| {
            let feeds = [before[k], behind[k]];
            feeds.iter().flatten().any(|feed| self.is_peck_of(&region[k], feed))
        };
        let pecks: Vec<bool> = (0..region.len()).map(is_peck).collect();
        let is_part = |k: usize| {
            let feeds = [before[k], behind[k]];
            feeds.iter().flatten().any(|feed| self.is_part_of_hole(&region[k], feed))
        };
        let parts: Vec<bool> = (0..region.len()).map(is_part).collect();
        let shifts = self.shifts(region, &parts);
        let ways: Vec<Position> = shifts.iter().map(|(way, _)| *way).collect();
        let returns = find_return_rapids(placed, links, (self.old, self.new), &ways, self.tolerance);
        // The last move that ends elsewhere: by how much, and where it is told; nowhere if it goes with its hole.
        let mut last: Option<(Position, Option<usize>)> = None;
        for (k, (link, is_back)) in region.iter().zip(returns).enumerate() {
            let is_part = parts[k];
            if pecks[k] || is_back || self.strokes.explain(link, self.records.0, self.records.1) {
                continue;
            }
            match *link {
                StepPair::Changed(i, j) => {
                    let (old, new) = (&self.old[i], &self.new[j]);
                    let shift = difference(&new.to, &old.to);
                    let carried = last.filter(|(way, _)| is_carried(old, new, way, self.tolerance));
                    let told = match carried {
                        _ if is_part => None,
                        None => self.changed(old, new),
                        Some((_, None)) => None,
                        Some((_, Some(group))) => {
                            self.groups.carry(group, new.kind.name(), &shift);
                            Some(group)
                        }
                    };
                    last = Some((shift, told));
                }
                StepPair::Lost(i) if !(is_part && gone) => {
                    let step = &self.old[i];
                    let text = format!("{} to {} is removed", step.kind.one(), point(step, self.axes));
                    self.alone(&shifts, "move-lost", text, (Some(step), None), false);
                }
                StepPair::Added(j) if !(is_part && gone) => {
                    let step = &self.new[j];
                    let text = format!("{} to {} is added", step.kind.one(), point(step, self.axes));
                    let stand = moves_before(links, placed[k].0, self.old).map(|i| &self.old[i]);
                    let begins = stand.is_some_and(|stand| self.near(&stand.to, &step.from));
                    self.alone(&shifts, "move-added", text, (None, Some(step)), begins);
                }
                _ => {}
            }
        }
    }

    /// A move that is there once only. One that goes the way by which those next to it end elsewhere, where none was
    /// needed before, is one of these; one that makes up for that way is no difference of its own. One that begins
    /// where the old revision stands may also go the way by which moves of other regions end elsewhere.
    fn alone(
        &mut self,
        shifts: &[(Position, bool)],
        code: &'static str,
        text: String,
        sides: StepRefs<'a>,
        begins: bool,
    ) {
        let (Some(step), is_new) = (sides.0.or(sides.1), sides.1.is_some()) else { return };
        let way = if is_new { step.way() } else { opposite(&step.way()) };
        let with = shifts.iter().find(|(shift, _)| self.near(&way, shift));
        let back = shifts.iter().any(|(shift, _)| self.near(&opposite(&way), shift));
        match with {
            Some((shift, false)) => {
                self.groups.add_shift(step.kind.name(), shift, sides);
            }
            None if begins && self.elsewhere.iter().any(|shift| self.near(shift, &way)) => {
                self.groups.add_shift(step.kind.name(), &way, sides);
            }
            None if !back => self.groups.add(code, "move", text, sides),
            _ => {}
        }
    }

    /// How far moves of a region end from where they ended, and whether that is because a hole is moved.
    fn shifts(&self, region: &[StepPair], parts: &[bool]) -> Vec<(Position, bool)> {
        let mut shifts: Vec<(Position, bool)> = Vec::new();
        for (link, is_part) in region.iter().zip(parts) {
            let StepPair::Changed(i, j) = link else { continue };
            let shift = difference(&self.new[*j].to, &self.old[*i].to);
            let is_none = self.near(&shift, &Position::default());
            match shifts.iter_mut().find(|(known, _)| self.near(known, &shift)) {
                Some((_, is_hole)) => *is_hole &= is_part,
                None if !is_none => shifts.push((shift, *is_part)),
                None => {}
            }
        }
        shifts
    }

    fn near(&self, a: &Position, b: &Position) -> bool {
        near(a, b, self.tolerance)
    }

    /// Whether a move belongs to the hole that `feed` cuts. Of a hole that is there before and now, it does what it
    /// did, seen from the hole; of a lost or added one it is a rapid next to it, or a feed on the same line.
    fn is_part_of_hole(&self, link: &StepPair, feed: &Feed) -> bool {
        if let (StepPair::Changed(i, j), Some(deeper)) = (*link, feed.deeper)
            && let [Some(before), Some(now)] = self.sides(&feed.link)
        {
            return goes_with((&self.old[i], before), (&self.new[j], now), deeper, self.tolerance);
        }
        self.sides(link).into_iter().flatten().all(|step| {
            let feeds = self.sides(&feed.link).into_iter().flatten();
            step.kind == StepKind::Rapid || feeds.into_iter().any(|feed| step.is_on_line_of(feed))
        })
    }

    /// A step that comes at another time because its cycle is another one, or the level that its rapids run at.
    fn is_of_strokes(&self, i: usize, j: usize) -> bool {
        let (old, new) = (self.old[i].place, self.new[j].place);
        let is_same_block = || is_same_block(&self.records.0.places[old], &self.records.1.places[new]);
        self.strokes.is_any()
            && (is_same_block()
                || self.strokes.explain(&StepPair::Changed(i, j), self.records.0, self.records.1))
    }

    /// Whether a move that is there once only is on the line of a hole that is deeper now or less deep, made by its
    /// block.
    fn is_peck_of(&self, link: &StepPair, feed: &Feed) -> bool {
        let alone = match link {
            StepPair::Lost(_) | StepPair::Added(_) => self.sides(link),
            StepPair::Same(..) | StepPair::Changed(..) => return false,
        };
        let is_deeper = feed.deeper.is_some_and(|mm| mm.abs() > self.tolerance);
        let mut both = alone.into_iter().zip(self.sides(&feed.link));
        is_deeper
            && both.any(|(step, feed)| {
                step.zip(feed)
                    .is_some_and(|(step, feed)| step.place == feed.place && step.is_on_line_of(feed))
            })
    }

    /// The steps of a link, old and new.
    fn sides(&self, link: &StepPair) -> [Option<&'a Step>; 2] {
        let (i, j) = link.sides();
        [i.map(|i| &self.old[i]), j.map(|j| &self.new[j])]
    }

    /// A move that goes elsewhere or in another way; gives the group that says where.
    fn changed(&mut self, old: &'a Step, new: &'a Step) -> Option<usize> {
        let sides = (Some(old), Some(new));
        let (was, is) = (old.kind.one(), new.kind.one());
        if was != is {
            self.groups.add("move-kind", "move", format!("{is} instead of {was}"), sides);
        }
        let way = difference(&new.to, &old.to);
        let is_moved = !self.near(&way, &Position::default());
        if let (StepKind::Arc(a, _), StepKind::Arc(b, _)) = (&old.kind, &new.kind) {
            let is_moved = is_moved || !self.near(&new.from, &old.from);
            if let Some(text) = reshaped((old, a), (new, b), is_moved, self.tolerance) {
                self.groups.add("move-arc", "arc", text, sides);
            }
        }
        is_moved.then(|| self.groups.add_shift(new.kind.name(), &way, sides))
    }

    /// Feeds, and everything that is no move.
    fn step(&mut self, link: StepPair, explained: &ExplainedSteps) {
        let is_stroke = self.strokes.explain(&link, self.records.0, self.records.1);
        match link {
            StepPair::Same(i, j) | StepPair::Changed(i, j) => {
                let (old, new) = (&self.old[i], &self.new[j]);
                if let (Some(was), Some(is)) = (old.kind.rate(), new.kind.rate())
                    && (was - is).abs() > 1e-6 * was.abs().max(is.abs())
                {
                    // In G93 a move takes its time, and is slower where its way is shorter.
                    let (before, now) = (old.length() / was, new.length() / is);
                    let is_way = (old.length() - new.length()).abs() > 1e-9;
                    if !(is_way && (before - now).abs() <= 1e-5 * before) {
                        self.groups.add_feed(was, is, (old, new));
                    }
                }
                if matches!(link, StepPair::Changed(..)) && !is_stroke {
                    self.swapped(old, new, explained);
                }
            }
            StepPair::Lost(_) | StepPair::Added(_) if is_stroke => {}
            StepPair::Lost(i) if !self.old[i].is_move() => {
                let step = &self.old[i];
                if is_told_of_holes((Some(&step.kind), None), explained) {
                    return;
                }
                let text = format!("{} is removed", self.called(self.old, i));
                self.groups.add(code(&step.kind), step.kind.name(), text, (Some(step), None));
            }
            StepPair::Added(j) if !self.new[j].is_move() => {
                let step = &self.new[j];
                if is_told_of_holes((None, Some(&step.kind)), explained) {
                    return;
                }
                let text = format!("{} is added", self.called(self.new, j));
                self.groups.add(code(&step.kind), step.kind.name(), text, (None, Some(step)));
            }
            StepPair::Lost(_) | StepPair::Added(_) => {}
        }
    }

    /// What a step that is there once only says: where the spindle turns already, its speed.
    fn called(&self, steps: &[Step], step: usize) -> String {
        match steps[step].kind {
            StepKind::Spindle(_, speed) if is_speed_alone(steps, step) => format!("S{speed}"),
            ref kind => describe(kind, self.axes),
        }
    }

    /// A step that comes at another time.
    fn shifted(&mut self, i: usize, j: usize, word: &str) {
        let (old, new) = (&self.old[i], &self.new[j]);
        let text = format!("{} is executed {word} than before", self.called(self.old, i));
        self.groups.add(code(&old.kind), old.kind.name(), text, (Some(old), Some(new)));
    }

    /// The same kind of step with other values.
    fn swapped(&mut self, old: &'a Step, new: &'a Step, explained: &ExplainedSteps) {
        if !old.is_move() && !is_told_of_holes((Some(&old.kind), Some(&new.kind)), explained) {
            let text =
                format!("{} instead of {}", describe(&new.kind, self.axes), describe(&old.kind, self.axes));
            match (&old.kind, &new.kind) {
                (StepKind::Spindle(was, a), StepKind::Spindle(is, b)) if was == is => {
                    self.groups.tell_speed(*a, *b, text, (old, new));
                }
                _ => self.groups.add(code(&old.kind), old.kind.name(), text, (Some(old), Some(new))),
            }
        }
    }
}

fn opposite(way: &Position) -> Position {
    difference(&Position::default(), way)
}

/// Entries about holes that are made by another tool name what is put in now and before. A change that is lost leaves
/// another tool in the spindle, and its T may stay.
fn is_told_of_holes((old, new): (Option<&StepKind>, Option<&StepKind>), explained: &ExplainedSteps) -> bool {
    let is_call = |kind: Option<&StepKind>| matches!(kind, Some(StepKind::Silent(UnsimulatedKind::Tool, _)));
    let told = |is: &dyn Fn(&(u32, u32)) -> bool| explained.tools.iter().any(is);
    match (old, new) {
        (Some(StepKind::Tool(was)), Some(StepKind::Tool(is))) => explained.tools.contains(&(*was, *is)),
        (Some(StepKind::Tool(was)), _) => told(&|(before, _)| before == was),
        (_, Some(StepKind::Tool(is))) => told(&|(_, now)| now == is),
        _ => (is_call(old) || is_call(new)) && !explained.tools.is_empty(),
    }
}
