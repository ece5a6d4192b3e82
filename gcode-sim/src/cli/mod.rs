//! The only place that prints and opens files.
