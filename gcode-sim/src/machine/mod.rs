//! Events to the tool on the part.
