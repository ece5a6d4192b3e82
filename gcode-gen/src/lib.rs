//! Emits programs.
