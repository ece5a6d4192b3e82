//! Holes to a verdict.
