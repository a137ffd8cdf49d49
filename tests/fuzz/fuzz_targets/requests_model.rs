//! See [`staya_fuzz::requests_model`].
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| staya_fuzz::requests_model(bytes));
