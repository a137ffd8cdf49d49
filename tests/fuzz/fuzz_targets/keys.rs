//! See [`staya_fuzz::keys`].
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| staya_fuzz::keys(bytes));
