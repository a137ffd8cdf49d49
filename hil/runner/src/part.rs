use std::path::{Path, PathBuf};

/// A microcontroller that can be emulated.
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
    /// All parts.
    pub const ALL: [Self; 3] = [Self::Stm32f405, Self::Microbit, Self::Riscv32];

    /// Name in options and files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Stm32f405 => "stm32f405",
            Self::Microbit => "microbit",
            Self::Riscv32 => "riscv32",
        }
    }

    /// Name in the firmware's hello, and of the folder that the firmware is built in.
    #[must_use]
    pub const fn firmware_name(self) -> &'static str {
        match self {
            Self::Stm32f405 => "stm32f405",
            Self::Microbit => "nrf51",
            Self::Riscv32 => "riscv32",
        }
    }

    /// The emulator's program name.
    #[must_use]
    pub const fn emulator(self) -> &'static str {
        self.machine().0
    }

    /// Program, machine and arguments, and the Debian package.
    pub(crate) const fn machine(self) -> (&'static str, &'static [&'static str], &'static str) {
        match self {
            Self::Stm32f405 => ("qemu-system-arm", &["-machine", "netduinoplus2"], "qemu-system-arm"),
            Self::Microbit => ("qemu-system-arm", &["-machine", "microbit"], "qemu-system-arm"),
            Self::Riscv32 => ("qemu-system-riscv32", &["-machine", "virt", "-bios", "none"], "qemu-system-misc"),
        }
    }

    /// Path of the part's firmware in `folder` (from `cargo xtask firmware`), or `folder` if a
    /// file.
    #[must_use]
    pub fn elf(self, folder: &Path) -> PathBuf {
        if folder.is_file() {
            return folder.to_owned();
        }
        folder.join(self.firmware_name()).join("lockstep")
    }
}
