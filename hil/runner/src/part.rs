//! The parts that emulators run.

use std::path::{Path, PathBuf};

/// A microcontroller that an emulator runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Part {
    /// STM32F405 (Cortex-M4F), QEMU's `netduinoplus2`.
    Stm32f405,
    /// The micro:bit's nRF51 (Cortex-M0), QEMU's `microbit`.
    Microbit,
    /// RISC-V without an FPU, QEMU's `virt`.
    Riscv32,
}

impl Part {
    /// Every part.
    pub const ALL: [Self; 3] = [Self::Stm32f405, Self::Microbit, Self::Riscv32];

    /// As people write it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Stm32f405 => "stm32f405",
            Self::Microbit => "microbit",
            Self::Riscv32 => "riscv32",
        }
    }

    /// As its firmware says it, and the folder that the firmware is built in.
    #[must_use]
    pub const fn firmware_name(self) -> &'static str {
        match self {
            Self::Stm32f405 => "stm32f405",
            Self::Microbit => "nrf51",
            Self::Riscv32 => "riscv32",
        }
    }

    /// The program that emulates it.
    #[must_use]
    pub const fn emulator(self) -> &'static str {
        self.machine().0
    }

    /// The program that emulates it, the machine and what else that needs; the Debian package of the program.
    pub(crate) const fn machine(self) -> (&'static str, &'static [&'static str], &'static str) {
        match self {
            Self::Stm32f405 => ("qemu-system-arm", &["-machine", "netduinoplus2"], "qemu-system-arm"),
            Self::Microbit => ("qemu-system-arm", &["-machine", "microbit"], "qemu-system-arm"),
            Self::Riscv32 => ("qemu-system-riscv32", &["-machine", "virt", "-bios", "none"], "qemu-system-misc"),
        }
    }

    /// Its firmware below a folder of firmware, as `cargo xtask firmware` lays it out; or the file itself, if it is one.
    #[must_use]
    pub fn elf(self, folder: &Path) -> PathBuf {
        if folder.is_file() {
            return folder.to_owned();
        }
        folder.join(self.firmware_name()).join("lockstep")
    }
}
