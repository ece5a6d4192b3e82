//! Laws and whole-program tests that are not cases: house rules, round trips, published numbers, the README.
#![expect(clippy::unwrap_used, clippy::disallowed_methods, reason = "tests read files and may panic")]

mod accepted;
mod alignment;
mod arithmetic;
mod blocks;
mod budget;
mod burr;
mod changes;
mod check;
mod chord_limits;
mod ci;
mod collection;
mod compensation;
mod control;
mod control_page;
mod corpus;
mod docs;
mod ellipse;
mod emitted;
mod explain;
mod flute_sites;
mod formats;
mod honeycomb;
mod limits;
mod misplaced;
mod packaging;
mod page;
mod pin_holes;
mod real_files;
mod results;
mod round_trip;
mod schemas;
mod sheet;
mod sine_table;
mod tidy;
mod watch;
