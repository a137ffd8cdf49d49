use crate::part::Machine;
use staya_serial::SerialPort;
use std::fmt;
use std::str::FromStr;

/// The place of a robot's controller: `qemu:stm32f405`, `qemu:stm32f405,numbers=fast32`,
/// `serial:/dev/ttyACM0,baud=115200`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Device {
    /// In an emulator process of its own.
    Emulated(Machine),
    /// On a board behind a serial port.
    Serial(SerialPort),
}

/// Text that does not denote a device.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{text}` is not a device: {what}")]
pub struct DeviceError {
    /// The whole text.
    pub text: String,
    /// The error, and the permitted values.
    pub what: String,
}

impl FromStr for Device {
    type Err = DeviceError;

    fn from_str(text: &str) -> Result<Self, DeviceError> {
        let error = |what: String| DeviceError { text: text.to_owned(), what };
        let (kind, rest) = text.split_once(':').unwrap_or((text, ""));
        match kind {
            "qemu" => rest.parse().map(Self::Emulated).map_err(error),
            "serial" => match rest.parse() {
                Ok(port) => Ok(Self::Serial(port)),
                Err(reason) => Err(error(reason.to_string())),
            },
            _ => Err(error(format!("`{kind}` is neither `qemu:PART` nor `serial:PORT[,baud=N]`"))),
        }
    }
}

impl fmt::Display for Device {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Emulated(machine) => write!(f, "qemu:{machine}"),
            Self::Serial(port) => write!(f, "serial:{port}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn written_devices_are_read_back() {
        for text in [
            "qemu:stm32f405",
            "qemu:stm32f405,numbers=fast32",
            "qemu:microbit",
            "qemu:riscv32",
            "qemu:riscv32,numbers=q16",
            "serial:/dev/ttyACM0,baud=9600",
        ] {
            let device: Device = text.parse().expect(text);
            assert_eq!(device.to_string(), text);
        }
        let folder = |text: &str| text.parse::<Machine>().expect(text).folder();
        assert_eq!(folder("riscv32,numbers=f32"), "riscv32");
        assert_eq!(folder("microbit,numbers=q16"), "nrf51");
        assert_eq!(folder("stm32f405,numbers=fast32"), "stm32f405-fast32");
        let device: Device = "serial:/dev/ttyUSB1".parse().expect("a port");
        assert_eq!(device.to_string(), "serial:/dev/ttyUSB1,baud=115200");
    }

    #[test]
    fn errors_name_the_wrong_piece_and_the_permitted_values() {
        for (text, pieces) in [
            ("qemu:avr", ["`avr`", "qemu:stm32f405, qemu:microbit, qemu:riscv32"]),
            ("qemu", ["``", "qemu:microbit"]),
            ("qemu:microbit,numbers=f32", ["microbit does not compute in `f32`", "give one of q16"]),
            ("qemu:riscv32,numbers=f64", ["`f64`", "f32, fast32, q16"]),
            ("qemu:riscv32,speed=1", ["`speed=1`", "`numbers=FORMAT`"]),
            ("renode:x", ["`renode`", "serial:PORT"]),
            ("", ["``", "qemu:PART"]),
            ("serial:", ["no port", "/dev/ttyACM0"]),
            ("serial:/dev/x,speed=1", ["`speed`", "`baud`"]),
        ] {
            let error = text.parse::<Device>().expect_err(text).to_string();
            for piece in pieces {
                assert!(error.contains(piece), "{text}: {error}");
            }
            assert!(error.starts_with(&format!("`{text}` is not a device")), "{error}");
        }
    }
}
