use staya_controller::scalar::NumberFormat;
use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;

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

    /// Number formats that its firmware can be built for; the first one is the usual one.
    #[must_use]
    pub const fn numbers(self) -> &'static [NumberFormat] {
        match self {
            Self::Microbit => &[NumberFormat::Q16],
            Self::Stm32f405 | Self::Riscv32 => &[NumberFormat::F32, NumberFormat::Fast32, NumberFormat::Q16],
        }
    }
}

/// A part with firmware for one number format: `stm32f405`, or `stm32f405,numbers=fast32`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Machine {
    /// The part.
    pub part: Part,
    /// One of [`Part::numbers`]; `None`: the usual one.
    pub numbers: Option<NumberFormat>,
}

impl From<Part> for Machine {
    fn from(part: Part) -> Self {
        Self { part, numbers: None }
    }
}

impl Machine {
    /// The number format that it computes in.
    #[must_use]
    pub const fn computes_in(self) -> NumberFormat {
        match self.numbers {
            Some(numbers) => numbers,
            None => self.part.numbers()[0],
        }
    }

    /// Its number format, unless that is the part's usual one.
    #[must_use]
    pub fn other_numbers(self) -> Option<NumberFormat> {
        self.numbers.filter(|&numbers| numbers != self.part.numbers()[0])
    }

    /// Name of the folder that its firmware is built in.
    #[must_use]
    pub fn folder(self) -> String {
        let part = self.part.firmware_name();
        self.other_numbers().map_or_else(|| part.into(), |numbers| format!("{part}-{}", numbers.name()))
    }

    /// Options of `cargo xtask firmware` that build its firmware.
    #[must_use]
    pub fn build(self) -> String {
        let part = self.part.firmware_name();
        self.other_numbers().map_or_else(|| part.into(), |numbers| format!("--numbers {} {part}", numbers.name()))
    }

    /// Path of its firmware in `folder` (from `cargo xtask firmware`), or `folder` if a file.
    #[must_use]
    pub fn elf(self, folder: &Path) -> PathBuf {
        if folder.is_file() {
            return folder.to_owned();
        }
        folder.join(self.folder()).join("lockstep")
    }
}

impl fmt::Display for Machine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.part.name())?;
        self.numbers.map_or(Ok(()), |numbers| write!(f, ",numbers={}", numbers.name()))
    }
}

impl FromStr for Machine {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, options) = text.split_once(',').map_or((text, None), |(name, options)| (name, Some(options)));
        let part = Part::ALL.into_iter().find(|part| part.name() == name).ok_or_else(|| {
            let names: Vec<String> = Part::ALL.map(|part| format!("qemu:{}", part.name())).into();
            format!("no part `{name}`; there are {}", names.join(", "))
        })?;
        let Some(options) = options else { return Ok(part.into()) };
        let word = options.strip_prefix("numbers=");
        let word = word.ok_or_else(|| format!("no option `{options}`; there is `numbers=FORMAT`"))?;
        let numbers = part.numbers().iter().find(|numbers| numbers.name() == word);
        let numbers = numbers.ok_or_else(|| {
            let names: Vec<&str> = part.numbers().iter().map(|numbers| numbers.name()).collect();
            format!("{name} does not compute in `{word}`; give one of {}", names.join(", "))
        })?;
        Ok(Self { part, numbers: Some(*numbers) })
    }
}
