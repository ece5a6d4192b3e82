//! Differences that say the same, told once with how often.
use super::change::Change;
use super::record::Record;
use super::steps::Step;

/// Differences of one kind that say the same.
struct Group {
    code: &'static str,
    /// What is different, without how often.
    text: String,
    /// What it is that is different, "move", "dwell", and how often; of moves that go elsewhere each kind.
    counts: Vec<(&'static str, usize)>,
    /// How many times as fast a move is; of moves that end elsewhere nothing.
    factor: Option<f64>,
    /// The first of them say other numbers, but the same factor.
    varies: bool,
    old: Option<usize>,
    new: Option<usize>,
}

/// All of them, in the order in which they first came up.
#[derive(Default)]
pub(super) struct Groups(Vec<Group>);

/// The steps that something is told of, before and now.
pub(super) type Sides<'a> = (Option<&'a Step>, Option<&'a Step>);

impl Groups {
    /// One difference more: `what` it is that is different, and how.
    pub(super) fn tell(&mut self, code: &'static str, what: &'static str, text: String, sides: Sides<'_>) {
        let known = self.0.iter_mut().find(|group| group.code == code && group.text == text);
        match known {
            Some(group) => group.count(what),
            None => self.begin(code, what, text, sides, None),
        }
    }

    /// A move at another feed. In one block feeds that are all so many times as fast say the same: of G93 each is another.
    pub(super) fn tell_feed(&mut self, was: f64, is: f64, (old, new): (&Step, &Step)) {
        let text = format!("feed F{} instead of F{}", short(is), short(was));
        let factor = is / was;
        let is_alike = |group: &&mut Group| {
            let is_place = group.old == Some(old.place) && group.new == Some(new.place);
            let is_factor = group.factor.is_some_and(|known| (known - factor).abs() <= 1e-6 * known.abs());
            group.code == "feed" && (group.text == text || is_place && is_factor)
        };
        match self.0.iter_mut().find(is_alike) {
            Some(group) => {
                group.varies |= group.text != text;
                group.count("move");
            }
            None => self.begin("feed", "move", text, (Some(old), Some(new)), Some(factor)),
        }
    }

    fn begin(
        &mut self,
        code: &'static str,
        what: &'static str,
        text: String,
        (old, new): Sides<'_>,
        factor: Option<f64>,
    ) {
        let place = |step: Option<&Step>| step.map(|step| step.place);
        let counts = vec![(what, 1)];
        let (old, new) = (place(old), place(new));
        self.0.push(Group { code, text, counts, factor, varies: false, old, new });
    }

    pub(super) fn changes(self, old: &Record, new: &Record) -> Vec<Change> {
        self.0.into_iter().map(|group| group.change(old, new)).collect()
    }
}

impl Group {
    fn count(&mut self, what: &'static str) {
        match self.counts.iter_mut().find(|(known, _)| *known == what) {
            Some((_, count)) => *count += 1,
            None => self.counts.push((what, 1)),
        }
    }

    fn change(self, old: &Record, new: &Record) -> Change {
        let message = if self.code == "move-shifted" { self.shifted() } else { self.counted() };
        Change::new(self.code, message)
            .once_at(self.old.and_then(|place| old.places.get(place)))
            .now_at(self.new.and_then(|place| new.places.get(place)))
    }

    fn counted(&self) -> String {
        let counted: Vec<String> = self.counts.iter().map(|(what, n)| format!("{n} {what}s")).collect();
        match (self.varies, &self.counts[..]) {
            (true, _) => format!("{} ({}, all by the same factor)", self.text, counted.join(", ")),
            (false, [(_, 1)]) => self.text.clone(),
            (false, _) => format!("{} ({})", self.text, counted.join(", ")),
        }
    }

    /// Moves that end elsewhere, by `text`.
    fn shifted(&self) -> String {
        let text = &self.text;
        let first = match (self.old, self.new) {
            (None, Some(_)) => ", the first of them new",
            (Some(_), None) => ", the first of them gone",
            _ => "",
        };
        match self.counts[..] {
            [(what, 1)] => format!("{} ends elsewhere, by {text}", one(what)),
            [(what, n)] => format!("{} ends elsewhere, by {text} ({n} moves{first})", one(what)),
            _ => {
                let each = |(what, n): &(&str, usize)| match n {
                    1 => one(what),
                    _ => format!("{n} {what}s"),
                };
                let each: Vec<String> = self.counts.iter().map(each).collect();
                format!("moves end elsewhere, by {text} ({}{first})", each.join(", "))
            }
        }
    }
}

/// With its article.
fn one(what: &str) -> String {
    format!("{} {what}", if what.starts_with('a') { "an" } else { "a" })
}

/// A feed without digits nobody can set.
pub(super) fn short(rate: f64) -> f64 {
    (rate * 1e4).round() / 1e4
}
