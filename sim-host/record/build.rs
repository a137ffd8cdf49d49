//! Embeds the page (`web/`) into the program.

use std::fmt::Write as _;
use std::path::Path;
use std::{env, fs};

fn main() {
    println!("cargo::rerun-if-changed=web");
    let web = Path::new(&env::var("CARGO_MANIFEST_DIR").expect("set by cargo")).join("web");
    let mut names: Vec<String> = fs::read_dir(&web).map_or_else(
        |_| Vec::new(),
        |found| found.flatten().filter_map(|entry| entry.file_name().into_string().ok()).collect(),
    );
    names.retain(|name| [".html", ".css", ".js"].iter().any(|end| name.ends_with(end)));
    names.sort();
    let mut code = String::from("&[\n");
    for name in names {
        let path = web.join(&name);
        writeln!(code, "    ({name:?}, include_str!({:?})),", path.display().to_string()).expect("memory");
    }
    code.push_str("]\n");
    let out = Path::new(&env::var("OUT_DIR").expect("set by cargo")).join("web.rs");
    fs::write(out, code).expect("cargo's own folder can be written to");
}
