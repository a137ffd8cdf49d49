//! The header in `include/` is what the sources say.

use std::path::Path;
use std::{env, fs};

/// The header as cbindgen makes it, without what it says for the safe use of functions by Rust.
fn generated() -> String {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let config = cbindgen::Config::from_file(here.join("cbindgen.toml")).unwrap();
    let source = here.join("src/lib.rs");
    let bindings = cbindgen::Builder::new().with_config(config).with_src(source).generate().unwrap();
    let mut text = Vec::new();
    bindings.write(&mut text);
    let text = String::from_utf8(text).unwrap();
    let safety = " *\n * # Safety\n * See the header's introduction.\n";
    text.replace(safety, "")
}

#[test]
fn golden_header_is_what_the_sources_say() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("include/staya.h");
    let header = generated();
    if env::var_os("STAYA_BLESS").is_some() {
        fs::write(&file, &header).unwrap();
    }
    let there = fs::read_to_string(&file).unwrap_or_default();
    assert!(there == header, "include/staya.h is not what the sources say: run `cargo xtask bless header`");
}
