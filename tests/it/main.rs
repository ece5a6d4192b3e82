//! Properties and whole-program tests that are not cases: house rules, round trips, published numbers, the README.
#![expect(clippy::unwrap_used, clippy::disallowed_methods, reason = "tests read files and may panic")]

mod accepted;
mod alignment;
mod alignment_state;
mod arithmetic;
mod assumptions;
mod blocks;
mod budget;
mod burr;
mod case_folders;
mod changes;
mod check;
mod checked_in_programs;
mod chord_limits;
mod ci;
mod compensation;
mod control;
mod control_page;
mod corpus;
mod docs;
mod ellipse;
mod equivalent_programs;
mod every_word;
mod example_pictures;
mod explain;
mod five_axes;
mod flute_sites;
mod formats;
mod honeycomb;
mod house_rules;
mod limits;
mod misplaced;
mod module_circles;
mod mutations;
mod one_verdict;
#[cfg(feature = "browser")]
mod page;
mod pin_holes;
mod real_files;
mod results;
mod round_trip;
mod schemas;
mod sheet;
mod start_state;
mod watch;
mod words;
