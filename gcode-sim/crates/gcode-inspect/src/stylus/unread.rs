//! Feeds on which no dial is read: the way to the surface and the way from it are none of the path; whatever else isn't
//! read is missing from it, and is told.
use super::REACH;
use gcode_lang::diag::Diagnostic;
use gcode_lang::motion::Backtrace;

/// How a feed that isn't read goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum UnreadReason {
    /// To the surface, steeper than what goes along it.
    Nearer,
    /// Away from it, as steeply.
    Farther,
    /// Neither all the way.
    Astray,
}

/// A feed that isn't read.
#[derive(Debug)]
pub(super) struct Unread {
    pub place: Backtrace,
    pub way: UnreadReason,
    /// How long it is, mm.
    pub length: f64,
    /// The least and the greatest distance of the ball from the surface, mm; below 0 the ball is in the part.
    pub least: f64,
    pub greatest: f64,
}

/// A stretch of the path without a reading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap {
    /// So many passes come before it.
    pub behind: usize,
    pub length: f64,
}

/// What wasn't read so far.
#[derive(Debug, Default)]
pub(super) struct UnreadFeeds {
    /// Feeds since the last reading or rapid.
    feeds: Vec<Unread>,
    /// Whether anything was read since the last rapid.
    touched: bool,
    /// Feeds between two rapids on which nothing was read, and the passes before them: whether they are missing from the
    /// path shows with the next pass, or at the end.
    between: Vec<(Vec<Unread>, usize)>,
    pub gaps: Vec<Gap>,
    /// Feeds to the surface and feeds from it.
    pub ways: [usize; 2],
    pub findings: Vec<Diagnostic>,
}

impl UnreadFeeds {
    pub(super) fn feed(&mut self, feed: Unread) {
        self.feeds.push(feed);
    }

    /// A feed along the surface begins; so many passes were read before.
    pub(super) fn read(&mut self, passes: usize) {
        for (feeds, behind) in std::mem::take(&mut self.between) {
            if behind > 0 || has_stray_feed(&feeds) {
                self.tell(&feeds, behind);
            } else {
                self.count(&feeds);
            }
        }
        let feeds = std::mem::take(&mut self.feeds);
        if !self.touched && feeds.iter().all(|feed| feed.way == UnreadReason::Nearer && !feed.is_inside()) {
            self.count(&feeds);
        } else {
            self.tell(&feeds, passes);
        }
        self.touched = true;
    }

    /// No feed goes on from here: a rapid, or the end of the program.
    pub(super) fn leave(&mut self, passes: usize) {
        let feeds = std::mem::take(&mut self.feeds);
        let touched = std::mem::replace(&mut self.touched, false);
        let away = feeds.iter().all(|feed| feed.way == UnreadReason::Farther);
        if feeds.iter().any(Unread::is_inside) || (touched && !away) {
            self.tell(&feeds, passes);
        } else if touched {
            self.count(&feeds);
        } else if !feeds.is_empty() {
            self.between.push((feeds, passes));
        }
    }

    /// The program is at its end; so many passes were read. Where there is a path at all, a feed that goes neither to the
    /// surface nor from it is missing from it.
    pub(super) fn end(&mut self, passes: usize) {
        self.leave(passes);
        for (feeds, behind) in std::mem::take(&mut self.between) {
            if passes > 0 && has_stray_feed(&feeds) {
                self.tell(&feeds, behind);
            } else {
                self.count(&feeds);
            }
        }
    }

    fn count(&mut self, feeds: &[Unread]) {
        for feed in feeds {
            self.ways[usize::from(feed.way == UnreadReason::Farther)] += 1;
        }
    }

    fn tell(&mut self, feeds: &[Unread], behind: usize) {
        let Some(first) = feeds.iter().find(|feed| feed.is_inside()).or(feeds.first()) else { return };
        let length = feeds.iter().map(|feed| feed.length).sum();
        self.gaps.push(Gap { behind, length });
        let number = match feeds.len() {
            1 => "1 feed gives no readings over".to_owned(),
            n => format!("{n} feeds give no readings over"),
        };
        let least = feeds.iter().map(|feed| feed.least).fold(f64::INFINITY, f64::min);
        let greatest = feeds.iter().map(|feed| feed.greatest).fold(f64::NEG_INFINITY, f64::max);
        let finding = if least < -REACH {
            let message = format!(
                "the ball is fed into the part: {number} {length:.3} mm, up to {:.3} mm deep",
                -least
            );
            Diagnostic::error("ball-into-part", message)
        } else {
            let message = format!(
                "{number} {length:.3} mm: up to {:.3} mm off the surface, neither straight to it nor from it",
                greatest.max(-least)
            );
            Diagnostic::error("path-not-read", message)
        };
        let help = format!(
            "keep the ball within {REACH} mm of the surface, at less than 30° to it, to get readings"
        );
        self.findings.push(finding.with_backtrace(first.place.clone()).help(help));
    }
}

fn has_stray_feed(feeds: &[Unread]) -> bool {
    feeds.iter().any(|feed| feed.way == UnreadReason::Astray)
}

impl Unread {
    fn is_inside(&self) -> bool {
        self.least < -REACH
    }
}
