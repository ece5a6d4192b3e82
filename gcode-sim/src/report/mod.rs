//! Data to words: what the terminal, JSON and CSV say of runs, holes and verdicts.
pub mod budget;
pub mod changes;
pub mod check;
pub mod diagnostic;
pub mod explain;
pub mod figures;
pub mod flute_table;
pub mod flute_view;
pub mod holes;
pub mod junit;
pub mod page;
pub mod readings;
pub mod run;
pub mod sarif;
pub mod tested;
pub mod top;
mod verdict_summary;
pub mod verdict_table;
