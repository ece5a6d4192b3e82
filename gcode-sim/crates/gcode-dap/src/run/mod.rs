//! A run that goes forwards and backwards. It knows no protocol.
mod checkpoints;
mod reversible;

pub(crate) use reversible::{Change, ChangeRefusal, PositionedSink, ReversibleRun};
