//! Random requests leave the debugger able to start again.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| gcode_tests::fuzz_sessions::debugger(bytes));
