//! See [`staya_fuzz::messages_model`].
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| staya_fuzz::messages_model(bytes));
