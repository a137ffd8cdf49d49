//! See [`staya_fuzz::mavlink_decode`].
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| staya_fuzz::mavlink_decode(bytes));
