//! The Debug Adapter Protocol as serde structs: <https://microsoft.github.io/debug-adapter-protocol/specification>.
//!
//! Names and optional fields are those of the protocol.
pub(crate) mod arguments;
pub(crate) mod bodies;
pub(crate) mod message;
