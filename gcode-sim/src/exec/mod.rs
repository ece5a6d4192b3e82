//! Operations to events.
