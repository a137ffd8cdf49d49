//! Derives the part from the target triple and passes its linker script to the linker.

use std::env;
use std::path::Path;

/// The variable `STAYA_BAUD` overrides it.
const BAUD: u32 = 115_200;
/// Crystal of an STM32F405 board; the variable `STAYA_HSE_HZ` overrides it.
const HSE_HZ: u32 = 8_000_000;

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rustc-check-cfg=cfg(part, values(\"stm32f405\", \"nrf51\", \"riscv32\"))");
    println!("cargo:rustc-check-cfg=cfg(numbers, values(\"f32\", \"fast32\", \"q16\"))");
    number("STAYA_BAUD", BAUD, 1200..=2_000_000);
    // The PLL divides the crystal down to 1 MHz.
    let hse_hz = number("STAYA_HSE_HZ", HSE_HZ, 4_000_000..=26_000_000);
    assert!(hse_hz.is_multiple_of(1_000_000), "STAYA_HSE_HZ is not in whole megahertz");

    let target = env::var("TARGET").unwrap_or_default();
    let (part, scripts): (&str, &[&str]) = match target.as_str() {
        // cortex-m-rt's link.x includes memory.x: the workspace's, for the STM32F405.
        "thumbv7em-none-eabihf" => ("stm32f405", &["link.x"]),
        "thumbv6m-none-eabi" => ("nrf51", &["nrf51-memory.x", "nrf51.x"]),
        "riscv32imac-unknown-none-elf" => ("riscv32", &["riscv32.x", "link.x"]),
        _ => return,
    };
    println!("cargo:rustc-cfg=part=\"{part}\"");
    println!("cargo:rustc-cfg=numbers=\"{}\"", numbers(part));
    let here = env::var("CARGO_MANIFEST_DIR").unwrap_or_default();
    let here = Path::new(&here);
    for watched in [here.to_path_buf(), here.join("../../memory.x")] {
        println!("cargo:rerun-if-changed={}", watched.display());
    }
    println!("cargo:rustc-link-search={}", here.display());
    let is_optimised = env::var("PROFILE").is_ok_and(|profile| profile == "release");
    offer_script(here, part, scripts, is_optimised);
    for bin in bins(here) {
        let is_only_linked = bin.starts_with("nopanic");
        for script in scripts.iter().chain(&["defmt.x", "note.x"]) {
            let script = match *script {
                "nrf51-memory.x" if is_only_linked => "nrf51-nopanic-memory.x",
                script => script,
            };
            println!("cargo:rustc-link-arg-bin={bin}=-T{script}");
        }
        if is_only_linked || (bin == "lockstep" && is_optimised) {
            // defmt's script keeps the panic behind `panic`, `assert` and `unwrap` even in programs
            // without them (`cargo xtask check` verifies it).
            println!("cargo:rustc-link-arg-bin={bin}=--defsym=__defmt_default_panic=0");
        }
    }
    // Relocations show `cargo xtask size` which code and constants a behaviour's step needs.
    println!("cargo:rustc-link-arg-bin=bench=--emit-relocs");
    // No padding to pages of 64 KiB.
    println!("cargo:rustc-link-arg-bins=--nmagic");
}

/// Offers firmware in other crates a single script, `-Tstaya-firmware.x`: all scripts of the part,
/// and the STM32F405's memory map for crates without a memory.x.
fn offer_script(here: &Path, part: &str, scripts: &[&str], is_optimised: bool) {
    let out = std::path::PathBuf::from(env::var_os("OUT_DIR").unwrap_or_default());
    let mut all: String =
        scripts.iter().chain(&["defmt.x", "note.x"]).map(|name| format!("INCLUDE {name}\n")).collect();
    if is_optimised {
        all += "__defmt_default_panic = 0;\n";
    }
    let write = |name: &str, text: &[u8]| {
        let path = out.join(name);
        std::fs::write(&path, text).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    };
    write("staya-firmware.x", all.as_bytes());
    if part == "stm32f405" {
        let map = here.join("../../memory.x");
        write("memory.x", &std::fs::read(&map).unwrap_or_else(|error| panic!("{}: {error}", map.display())));
    }
    println!("cargo:rustc-link-search={}", out.display());
}

fn bins(here: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(here.join("src/bin")).into_iter().flatten();
    entries.filter_map(|entry| Some(entry.ok()?.path().file_stem()?.to_str()?.to_string())).collect()
}

/// The number format of `lockstep`: the variable `STAYA_NUMBERS`, or the part's usual one.
fn numbers(part: &str) -> String {
    println!("cargo:rerun-if-env-changed=STAYA_NUMBERS");
    // Software floats and their functions do not fit beside all behaviours in 256 KiB.
    let choice: &[&str] = if part == "nrf51" { &["q16"] } else { &["f32", "fast32", "q16"] };
    let numbers = env::var("STAYA_NUMBERS").unwrap_or_else(|_| choice[0].into());
    assert!(choice.contains(&numbers.as_str()), "STAYA_NUMBERS={numbers}: {part} computes in {}", choice.join(", "));
    numbers
}

fn number(name: &str, default: u32, range: std::ops::RangeInclusive<u32>) -> u32 {
    println!("cargo:rerun-if-env-changed={name}");
    let value = match env::var(name) {
        Ok(text) => text.parse().unwrap_or_else(|_| panic!("{name} is not a number: {text}")),
        Err(_) => default,
    };
    assert!(range.contains(&value), "{name} is outside {range:?}");
    println!("cargo:rustc-env={name}={value}");
    value
}
