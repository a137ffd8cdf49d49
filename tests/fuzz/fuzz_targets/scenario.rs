//! See [`staya_fuzz::scenario`].
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| staya_fuzz::scenario(bytes));
