//! Data to words: what the terminal, JSON and CSV say of runs, holes and verdicts.
pub mod budget;
pub mod changes;
pub mod check;
pub mod diagnostic;
pub mod explain;
pub mod flute_table;
pub mod flute_view;
pub mod holes;
pub mod run;
pub mod tested;
pub mod top;
pub mod verdict_table;
