//! Tree to operations.
