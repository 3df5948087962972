//! The YAML of a recording.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| dynid_fuzz::manifest(bytes));
