//! A Parquet file.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| dynid_fuzz::parquet(bytes));
