//! Cuts of a line or a circle by modal state, each with its first block and its feeds.
use super::cutting::{CuttingState, FeedAtSpeed, widen};
use super::offset_origin::OffsetOrigin;
use gcode_lang::motion::{Backtrace, SpindleDirection};
use gcode_lang::units::MmPerMin;

/// Feeds that cut in one modal state.
#[derive(Clone, Debug)]
pub(super) struct StateCut {
    pub state: CuttingState,
    /// Block of the first feed.
    pub backtrace: Backtrace,
    /// Block that puts the length offset in force; `None` without an offset.
    pub offset_origin: Option<OffsetOrigin>,
    /// Slowest and fastest feed.
    pub feed_range: [MmPerMin; 2],
    /// Feeds that cut least and most in a revolution, with their speeds; `None` if all enter a hole that is cut.
    pub extremes: Option<[FeedAtSpeed; 2]>,
}

/// Modal states in which a line or a circle is cut, in order of first occurrence.
#[derive(Clone, Debug, Default)]
pub(super) struct CutStates {
    list: Vec<StateCut>,
    /// Index of the last feed's state, and its rate.
    last: Option<(usize, MmPerMin)>,
}

impl StateCut {
    /// Returns a feed in a state; `cuts` is false if it enters a hole that is cut.
    pub(super) fn new(
        state: CuttingState,
        feed: MmPerMin,
        cuts: bool,
        backtrace: Backtrace,
        offset_origin: Option<&OffsetOrigin>,
    ) -> Self {
        let offset_origin = offset_origin.filter(|origin| origin.is_of(state.compensation)).cloned();
        let extremes = cuts.then_some([(feed, state.speed); 2]);
        Self { state, backtrace, offset_origin, feed_range: [feed; 2], extremes }
    }

    pub(super) fn is_stopped(&self) -> bool {
        self.state.spindle_direction == SpindleDirection::Off
    }

    fn widen(&mut self, feed: MmPerMin, cuts: bool) {
        let [min, max] = self.feed_range;
        self.feed_range = [if feed < min { feed } else { min }, if max < feed { feed } else { max }];
        if cuts {
            let own = [(feed, self.state.speed); 2];
            self.extremes = Some(self.extremes.map_or(own, |all| widen(all, own)));
        }
    }
}

impl CutStates {
    /// Records a feed; `first` makes the entry of a new state.
    pub(super) fn record(
        &mut self,
        state: &CuttingState,
        feed: MmPerMin,
        cuts: bool,
        first: impl FnOnce() -> StateCut,
    ) {
        // Most feeds are in the state of the one before.
        let index = match self.last.filter(|(last, _)| self.list[*last].state.is_alike(state)) {
            Some((last, _)) => Some(last),
            None => self.list.iter().position(|cut| cut.state.is_alike(state)),
        };
        match index {
            Some(index) => self.list[index].widen(feed, cuts),
            None => self.list.push(first()),
        }
        self.last = Some((index.unwrap_or(self.list.len() - 1), feed));
    }

    /// Adds the states of another circle of the same hole.
    pub(super) fn append(&mut self, other: &Self) {
        for cut in &other.list {
            if !self.list.iter().any(|own| own.state.is_alike(&cut.state)) {
                self.list.push(cut.clone());
            }
        }
    }

    /// Returns the rate of the last feed.
    pub(super) fn last_feed(&self) -> Option<MmPerMin> {
        self.last.map(|(_, feed)| feed)
    }

    /// Returns the feeds that cut least and most in a revolution of all states, with their speeds.
    pub(super) fn extremes(&self) -> Option<[FeedAtSpeed; 2]> {
        self.list.iter().filter_map(|cut| cut.extremes).reduce(widen)
    }

    /// Returns the states, each with true if it is that of the last feed.
    pub(super) fn iter(&self) -> impl ExactSizeIterator<Item = (&StateCut, bool)> {
        let last = self.last.map(|(index, _)| index);
        self.list.iter().enumerate().map(move |(index, cut)| (cut, Some(index) == last))
    }

    pub(super) fn is_empty(&self) -> bool {
        self.list.is_empty()
    }
}
