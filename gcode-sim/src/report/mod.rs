//! Data to words: terminal and JSON.
