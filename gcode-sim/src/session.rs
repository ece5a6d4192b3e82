//! One program through the whole chain.
