//! Makes Rust of the messages' definitions.

use mavlink_bindgen::{XmlDefinitions, generate};
use std::path::Path;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("cargo:rerun-if-changed=messages");
    let out = std::env::var("OUT_DIR")?;
    let out = Path::new(&out);
    let definitions = XmlDefinitions::Files(vec![Path::new("messages/staya.xml")]);
    generate(definitions, out)?;
    // What is made has attributes of a file, and so must be a module's file.
    let module = out.join("staya.rs");
    let module = format!("#[path = {module:?}] pub mod dialect;");
    std::fs::write(out.join("module.rs"), module)?;
    Ok(())
}
