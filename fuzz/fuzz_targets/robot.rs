//! A robot YAML, to its base parameters.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| dynid_fuzz::robot(bytes));
