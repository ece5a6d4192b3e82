//! Feeds without readings: approach and retract are no part of the path; other feeds are gaps in it.
use super::MAX_READING_DISTANCE;
use crate::findings::{BALL_INTO_PART, PATH_NOT_READ};
use gcode_lang::diag::Diagnostic;
use gcode_lang::motion::Backtrace;

/// Course of a feed without readings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum UnreadReason {
    /// To the surface, steeper than a feed along it.
    Approach,
    /// From the surface, as steep.
    Retract,
    /// Any other.
    Stray,
}

/// A feed without readings; lengths in mm.
#[derive(Debug)]
pub(super) struct UnreadFeed {
    pub backtrace: Backtrace,
    pub reason: UnreadReason,
    pub length: f64,
    /// Least and largest distance of the ball from the surface; negative inside the part.
    pub min_distance: f64,
    pub max_distance: f64,
}

/// A stretch of the path without readings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap {
    /// Number of passes before it.
    pub passes_before: usize,
    /// Length, mm.
    pub length: f64,
}

/// Feeds without readings so far.
#[derive(Debug, Default)]
pub(super) struct UnreadFeeds {
    /// Feeds since the last reading or rapid.
    feeds: Vec<UnreadFeed>,
    /// True if there is a reading since the last rapid.
    has_reading: bool,
    /// Feeds between two rapids without any reading, and the number of passes before them: the next pass, or the end,
    /// shows whether they are gaps.
    pending: Vec<(Vec<UnreadFeed>, usize)>,
    pub gaps: Vec<Gap>,
    /// Number of feeds to the surface and of feeds from it.
    pub approach_retract_counts: [usize; 2],
    pub findings: Vec<Diagnostic>,
}

impl UnreadFeeds {
    pub(super) fn push(&mut self, feed: UnreadFeed) {
        self.feeds.push(feed);
    }

    /// Starts a pass after `passes` others.
    pub(super) fn begin_reading(&mut self, passes: usize) {
        for (feeds, before) in std::mem::take(&mut self.pending) {
            self.settle(&feeds, before, before > 0 || has_stray_feed(&feeds));
        }
        let feeds = std::mem::take(&mut self.feeds);
        let is_approach = |feed: &UnreadFeed| feed.reason == UnreadReason::Approach && !feed.is_inside();
        self.settle(&feeds, passes, self.has_reading || !feeds.iter().all(is_approach));
        self.has_reading = true;
    }

    /// Ends the path at a rapid, or at the end of the program, after `passes` passes.
    pub(super) fn end_path(&mut self, passes: usize) {
        let feeds = std::mem::take(&mut self.feeds);
        let had_reading = std::mem::replace(&mut self.has_reading, false);
        let is_retract = feeds.iter().all(|feed| feed.reason == UnreadReason::Retract);
        let is_gap = feeds.iter().any(UnreadFeed::is_inside) || (had_reading && !is_retract);
        if is_gap || had_reading {
            self.settle(&feeds, passes, is_gap);
        } else if !feeds.is_empty() {
            self.pending.push((feeds, passes));
        }
    }

    /// Ends the program after `passes` passes. If there are any, a stray feed is missing from the path.
    pub(super) fn finish(&mut self, passes: usize) {
        self.end_path(passes);
        for (feeds, before) in std::mem::take(&mut self.pending) {
            self.settle(&feeds, before, passes > 0 && has_stray_feed(&feeds));
        }
    }

    /// Reports feeds after `passes` passes as a gap, or counts them as approach and retract.
    fn settle(&mut self, feeds: &[UnreadFeed], passes: usize, is_gap: bool) {
        if is_gap {
            self.report_gap(feeds, passes);
            return;
        }
        for feed in feeds {
            self.approach_retract_counts[usize::from(feed.reason == UnreadReason::Retract)] += 1;
        }
    }

    fn report_gap(&mut self, feeds: &[UnreadFeed], passes_before: usize) {
        let Some(first) = feeds.iter().find(|feed| feed.is_inside()).or(feeds.first()) else { return };
        let length = feeds.iter().map(|feed| feed.length).sum();
        self.gaps.push(Gap { passes_before, length });
        let number = match feeds.len() {
            1 => "1 feed gives",
            n => &format!("{n} feeds give"),
        };
        let least = feeds.iter().map(|feed| feed.min_distance).fold(f64::INFINITY, f64::min);
        let greatest = feeds.iter().map(|feed| feed.max_distance).fold(f64::NEG_INFINITY, f64::max);
        let finding = if least < -MAX_READING_DISTANCE {
            let message = format!(
                "the ball is fed into the part: {number} no readings over {length:.3} mm, up to {:.3} mm deep",
                -least
            );
            Diagnostic::new(&BALL_INTO_PART, message)
        } else {
            let message = format!(
                "{number} no readings over {length:.3} mm: up to {:.3} mm off the surface, neither straight to it nor from it",
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
