//! Feeds on which no dial is read: the way to the surface and the way from it are none of the path; whatever else isn't
//! read is missing from it, and is told.
use super::MAX_READING_DISTANCE;
use crate::findings::{BALL_INTO_PART, PATH_NOT_READ};
use gcode_lang::diag::Diagnostic;
use gcode_lang::motion::Backtrace;

/// How a feed that isn't read goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum UnreadReason {
    /// To the surface, steeper than what goes along it.
    Approach,
    /// Away from it, as steeply.
    Retract,
    /// Neither all the way.
    Stray,
}

/// A feed that isn't read.
#[derive(Debug)]
pub(super) struct UnreadFeed {
    pub backtrace: Backtrace,
    pub reason: UnreadReason,
    /// How long it is, mm.
    pub length: f64,
    /// The least and the greatest distance of the ball from the surface, mm; below 0 the ball is in the part.
    pub min_distance: f64,
    pub max_distance: f64,
}

/// A stretch of the path without a reading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap {
    /// So many passes come before it.
    pub passes_before: usize,
    pub length: f64,
}

/// What wasn't read so far.
#[derive(Debug, Default)]
pub(super) struct UnreadFeeds {
    /// Feeds since the last reading or rapid.
    feeds: Vec<UnreadFeed>,
    /// Whether anything was read since the last rapid.
    has_reading: bool,
    /// Feeds between two rapids on which nothing was read, and the passes before them: whether they are missing from the
    /// path shows with the next pass, or at the end.
    pending: Vec<(Vec<UnreadFeed>, usize)>,
    pub gaps: Vec<Gap>,
    /// Feeds to the surface and feeds from it.
    pub approach_retract_counts: [usize; 2],
    pub findings: Vec<Diagnostic>,
}

impl UnreadFeeds {
    pub(super) fn push(&mut self, feed: UnreadFeed) {
        self.feeds.push(feed);
    }

    /// A feed along the surface begins; so many passes were read before.
    pub(super) fn begin_reading(&mut self, passes: usize) {
        for (feeds, behind) in std::mem::take(&mut self.pending) {
            if behind > 0 || has_stray_feed(&feeds) {
                self.report_gap(&feeds, behind);
            } else {
                self.count(&feeds);
            }
        }
        let feeds = std::mem::take(&mut self.feeds);
        if !self.has_reading
            && feeds.iter().all(|feed| feed.reason == UnreadReason::Approach && !feed.is_inside())
        {
            self.count(&feeds);
        } else {
            self.report_gap(&feeds, passes);
        }
        self.has_reading = true;
    }

    /// No feed goes on from here: a rapid, or the end of the program.
    pub(super) fn end_path(&mut self, passes: usize) {
        let feeds = std::mem::take(&mut self.feeds);
        let touched = std::mem::replace(&mut self.has_reading, false);
        let away = feeds.iter().all(|feed| feed.reason == UnreadReason::Retract);
        if feeds.iter().any(UnreadFeed::is_inside) || (touched && !away) {
            self.report_gap(&feeds, passes);
        } else if touched {
            self.count(&feeds);
        } else if !feeds.is_empty() {
            self.pending.push((feeds, passes));
        }
    }

    /// The program is at its end; so many passes were read. Where there is a path at all, a feed that goes neither to the
    /// surface nor from it is missing from it.
    pub(super) fn finish(&mut self, passes: usize) {
        self.end_path(passes);
        for (feeds, behind) in std::mem::take(&mut self.pending) {
            if passes > 0 && has_stray_feed(&feeds) {
                self.report_gap(&feeds, behind);
            } else {
                self.count(&feeds);
            }
        }
    }

    fn count(&mut self, feeds: &[UnreadFeed]) {
        for feed in feeds {
            self.approach_retract_counts[usize::from(feed.reason == UnreadReason::Retract)] += 1;
        }
    }

    fn report_gap(&mut self, feeds: &[UnreadFeed], behind: usize) {
        let Some(first) = feeds.iter().find(|feed| feed.is_inside()).or(feeds.first()) else { return };
        let length = feeds.iter().map(|feed| feed.length).sum();
        self.gaps.push(Gap { passes_before: behind, length });
        let number = match feeds.len() {
            1 => "1 feed gives no readings over".to_owned(),
            n => format!("{n} feeds give no readings over"),
        };
        let least = feeds.iter().map(|feed| feed.min_distance).fold(f64::INFINITY, f64::min);
        let greatest = feeds.iter().map(|feed| feed.max_distance).fold(f64::NEG_INFINITY, f64::max);
        let finding = if least < -MAX_READING_DISTANCE {
            let message = format!(
                "the ball is fed into the part: {number} {length:.3} mm, up to {:.3} mm deep",
                -least
            );
            Diagnostic::new(&BALL_INTO_PART, message)
        } else {
            let message = format!(
                "{number} {length:.3} mm: up to {:.3} mm off the surface, neither straight to it nor from it",
                greatest.max(-least)
            );
            Diagnostic::new(&PATH_NOT_READ, message)
        };
        let help = format!(
            "keep the ball within {MAX_READING_DISTANCE} mm of the surface, at less than 30° to it, to get readings"
        );
        self.findings.push(finding.with_backtrace(first.backtrace.clone()).help(help));
    }
}

fn has_stray_feed(feeds: &[UnreadFeed]) -> bool {
    feeds.iter().any(|feed| feed.reason == UnreadReason::Stray)
}

impl UnreadFeed {
    fn is_inside(&self) -> bool {
        self.min_distance < -MAX_READING_DISTANCE
    }
}
