use staya_controller::scalar::NumberFormat;

pub(crate) type File<'a> = (&'a str, &'a str);

macro_rules! files {
    ($($path:literal = $template:literal,)*) => {
        &[$(($path, include_str!(concat!("../templates/", $template)))),*]
    };
}

#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Part {
    pub(crate) name: &'static str,
    pub(crate) title: &'static str,
    pub(crate) target: &'static str,
    pub(crate) is_emulated: bool,
    /// The number format that suits its processor.
    pub(crate) numbers: NumberFormat,
    pub(crate) rust: &'static [File<'static>],
    /// The repository's lock file for the firmware; `None` if the template has its own.
    pub(crate) lock: Option<&'static str>,
    /// Empty if there is no C project for this part.
    pub(crate) c: &'static [File<'static>],
}

pub(crate) static PARTS: [Part; 4] = [
    Part {
        name: "stm32f405",
        title: "STM32F405, Cortex-M4F at 168 MHz",
        target: "thumbv7em-none-eabihf",
        is_emulated: true,
        numbers: NumberFormat::F32,
        rust: files! {
            "firmware/Cargo.toml" = "stm32f405/Cargo.toml.in",
            "firmware/.cargo/config.toml" = "stm32f405/config.toml",
            "firmware/build.rs" = "firmware/build.rs",
            "firmware/src/main.rs" = "stm32f405/main.rs",
            "firmware/src/robot.rs" = "firmware/robot.rs",
        },
        lock: Some("examples/stm32f4/Cargo.lock"),
        c: files! { "firmware/memory.ld" = "stm32f405/memory.x", },
    },
    Part {
        name: "rp2350",
        title: "RP2350 (Raspberry Pi Pico 2), Cortex-M33 at 150 MHz",
        target: "thumbv8m.main-none-eabihf",
        is_emulated: false,
        numbers: NumberFormat::F32,
        rust: files! {
            "firmware/Cargo.lock" = "rp2350/Cargo.lock",
            "firmware/Cargo.toml" = "rp2350/Cargo.toml.in",
            "firmware/.cargo/config.toml" = "rp2350/config.toml",
            "firmware/build.rs" = "firmware/build.rs",
            "firmware/memory.x" = "rp2350/memory.x",
            "firmware/src/encoder.rs" = "firmware/encoder.rs",
            "firmware/src/main.rs" = "rp2350/main.rs",
            "firmware/src/robot.rs" = "firmware/robot.rs",
        },
        lock: None,
        c: &[],
    },
    Part {
        name: "nrf52840",
        title: "nRF52840, Cortex-M4F at 64 MHz",
        target: "thumbv7em-none-eabihf",
        is_emulated: false,
        numbers: NumberFormat::F32,
        rust: files! {
            "firmware/Cargo.lock" = "nrf52840/Cargo.lock",
            "firmware/Cargo.toml" = "nrf52840/Cargo.toml.in",
            "firmware/.cargo/config.toml" = "nrf52840/config.toml",
            "firmware/build.rs" = "firmware/build.rs",
            "firmware/memory.x" = "nrf52840/memory.x",
            "firmware/src/encoder.rs" = "firmware/encoder.rs",
            "firmware/src/main.rs" = "nrf52840/main.rs",
            "firmware/src/robot.rs" = "firmware/robot.rs",
        },
        lock: None,
        c: files! { "firmware/memory.ld" = "nrf52840/memory.x", },
    },
    Part {
        name: "esp32c3",
        title: "ESP32-C3, RISC-V at 160 MHz, without an FPU",
        target: "riscv32imc-unknown-none-elf",
        is_emulated: false,
        numbers: NumberFormat::Q16,
        rust: files! {
            "firmware/Cargo.lock" = "esp32c3/Cargo.lock",
            "firmware/Cargo.toml" = "esp32c3/Cargo.toml.in",
            "firmware/.cargo/config.toml" = "esp32c3/config.toml",
            "firmware/build.rs" = "esp32c3/build.rs",
            "firmware/src/encoder.rs" = "firmware/encoder.rs",
            "firmware/src/main.rs" = "esp32c3/main.rs",
            "firmware/src/robot.rs" = "firmware/robot.rs",
        },
        lock: None,
        c: &[],
    },
];

/// The repository's own list of functions whose bits differ between processors.
pub(crate) const SAME_BITS: File<'static> = ("clippy.toml", include_str!("../../../clippy.toml"));

pub(crate) const RUST: &[File<'static>] = files! {
    ".github/workflows/ci.yml" = "rust/ci.yml",
    ".gitignore" = "rust/gitignore",
    "Cargo.toml" = "rust/Cargo.toml.in",
    "README.md" = "rust/README.md",
    "examples/run.rs" = "rust/examples/run.rs",
    "hil/Cargo.toml" = "rust/hil/Cargo.toml.in",
    "hil/build.rs" = "rust/hil/build.rs",
    "hil/src/bin/firmware.rs" = "rust/hil/src/bin/firmware.rs",
    "hil/src/main.rs" = "rust/hil/src/main.rs",
    "scenario.toml" = "rust/scenario.toml",
    "src/lib.rs" = "rust/src/lib.rs",
    "tests/swarm.rs" = "rust/tests/swarm.rs",
};

pub(crate) const C: &[File<'static>] = files! {
    ".github/workflows/ci.yml" = "c/ci.yml",
    ".gitignore" = "c/gitignore",
    "Makefile" = "c/Makefile",
    "README.md" = "c/README.md",
    "firmware/board.c" = "c/firmware/board.c",
    "firmware/board.h" = "c/firmware/board.h",
    "firmware/link.ld" = "c/firmware/link.ld",
    "firmware/main.c" = "c/firmware/main.c",
    "src/robot.c" = "c/src/robot.c",
    "src/robot.h" = "c/src/robot.h",
    "tests/swarm.c" = "c/tests/swarm.c",
};

pub(crate) const PYTHON: &[File<'static>] = files! {
    ".github/workflows/ci.yml" = "python/ci.yml",
    ".gitignore" = "python/gitignore",
    "README.md" = "python/README.md",
    "my_swarm.py" = "python/my_swarm.py",
    "pyproject.toml" = "python/pyproject.toml",
    "scenario.toml" = "rust/scenario.toml",
    "show.py" = "python/show.py",
    "tests/test_law.py" = "python/tests/test_law.py",
};
