//! Passes the linker script of the part's firmware to the linker.

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    if std::env::var("CARGO_CFG_TARGET_OS").is_ok_and(|system| system == "none") {
        println!("cargo:rustc-link-arg-bins=-Tstaya-firmware.x");
        println!("cargo:rustc-link-arg-bins=--nmagic");
    }
}
