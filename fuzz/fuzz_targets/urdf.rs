//! A URDF, to its table and into a copy of it.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| dynid_fuzz::urdf(bytes));
