//! Holes and verdict to a picture.
