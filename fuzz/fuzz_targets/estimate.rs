//! A CSV file, to an estimate.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| dynid_fuzz::estimate(bytes));
