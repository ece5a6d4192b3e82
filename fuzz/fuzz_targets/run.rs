//! Any bytes run to an end, an alarm or a limit, and twice to the same one.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| gcode_tests::fuzz::run(bytes));
