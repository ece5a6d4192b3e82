//! Random edits and requests leave the language server in the state of a fresh start.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| gcode_tests::fuzz_sessions::language_server(bytes));
