//! Any bytes can be read, and what was read prints as something that reads the same.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| gcode_tests::fuzz::reader(bytes));
