//! What a device is, as people write it: `qemu:stm32f405`, `serial:/dev/ttyACM0,baud=115200`.

use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;

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
        crate::emulator::machine(self).0
    }

    /// Its firmware below a folder of firmware, as `cargo xtask firmware` lays it out.
    #[must_use]
    pub fn elf(self, folder: &Path) -> PathBuf {
        folder.join(self.firmware_name()).join("lockstep")
    }
}

/// Where a robot's controller runs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Device {
    /// In an emulator that is started for it.
    Emulated(Part),
    /// On a board behind a serial port.
    Serial {
        /// The port.
        path: PathBuf,
        /// Bits per second.
        baud: u32,
    },
}

/// Bits per second of a serial port when nothing else is said.
pub const BAUD: u32 = 115_200;

/// A text that names no device.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{text}` is no device: {what}")]
pub struct DeviceError {
    /// All of it.
    pub text: String,
    /// What is wrong, and what there is.
    pub what: String,
}

impl FromStr for Device {
    type Err = DeviceError;

    fn from_str(text: &str) -> Result<Self, DeviceError> {
        let error = |what: String| DeviceError {
            text: text.to_owned(),
            what,
        };
        let (kind, rest) = text.split_once(':').unwrap_or((text, ""));
        match kind {
            "qemu" => {
                let part = Part::ALL.into_iter().find(|part| part.name() == rest);
                part.map(Self::Emulated).ok_or_else(|| {
                    let names: Vec<String> =
                        Part::ALL.map(|part| format!("qemu:{}", part.name())).into();
                    error(format!("no part `{rest}`; there are {}", names.join(", ")))
                })
            }
            "serial" => serial(rest).map_err(error),
            _ => Err(error(format!(
                "`{kind}` is neither `qemu:PART` nor `serial:PORT[,baud=N]`"
            ))),
        }
    }
}

fn serial(rest: &str) -> Result<Device, String> {
    let mut pieces = rest.split(',');
    let path = pieces.next().unwrap_or_default();
    if path.is_empty() {
        return Err(String::from(
            "no port; write for instance serial:/dev/ttyACM0,baud=115200",
        ));
    }
    let mut baud = BAUD;
    for piece in pieces {
        let (key, value) = piece.split_once('=').unwrap_or((piece, ""));
        if key != "baud" {
            return Err(format!("no option `{key}`; there is `baud`"));
        }
        let number = value.parse().ok().filter(|number| *number > 0);
        baud = number.ok_or_else(|| format!("baud `{value}` is no whole number above 0"))?;
    }
    let path = path.into();
    Ok(Device::Serial { path, baud })
}

impl fmt::Display for Device {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Emulated(part) => write!(f, "qemu:{}", part.name()),
            Self::Serial { path, baud } => write!(f, "serial:{},baud={baud}", path.display()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_back() {
        for text in [
            "qemu:stm32f405",
            "qemu:microbit",
            "qemu:riscv32",
            "serial:/dev/ttyACM0,baud=9600",
        ] {
            let device: Device = text.parse().expect(text);
            assert_eq!(device.to_string(), text);
        }
        let device: Device = "serial:/dev/ttyUSB1".parse().expect("a port");
        assert_eq!(device.to_string(), "serial:/dev/ttyUSB1,baud=115200");
    }

    #[test]
    fn errors_name_the_wrong_piece_and_what_there_is() {
        for (text, pieces) in [
            (
                "qemu:avr",
                ["`avr`", "qemu:stm32f405, qemu:microbit, qemu:riscv32"],
            ),
            ("qemu", ["``", "qemu:microbit"]),
            ("renode:x", ["`renode`", "serial:PORT"]),
            ("", ["``", "qemu:PART"]),
            ("serial:", ["no port", "/dev/ttyACM0"]),
            ("serial:/dev/x,speed=1", ["`speed`", "`baud`"]),
            ("serial:/dev/x,baud=fast", ["`fast`", "whole number"]),
            ("serial:/dev/x,baud=0", ["`0`", "above 0"]),
        ] {
            let error = text.parse::<Device>().expect_err(text).to_string();
            for piece in pieces {
                assert!(error.contains(piece), "{text}: {error}");
            }
            assert!(
                error.starts_with(&format!("`{text}` is no device")),
                "{error}"
            );
        }
    }
}
