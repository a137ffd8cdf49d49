//! Byte lines to devices.

use crate::device::{Device, Part};
use crate::emulator::{self, Emulator};
use std::fmt;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// How long a read or a write waits; who reads asks again, what cannot be written counts as lost.
const PATIENCE: Duration = Duration::from_millis(500);

/// Why there is no line to a device.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "each text says it")]
pub enum OpenError {
    #[error("{program} is missing: on Debian run, as root, `apt-get install {package}`")]
    NoEmulator {
        program: &'static str,
        package: &'static str,
    },
    #[error("no firmware in {}: run `cargo xtask firmware {part}`", .elf.display())]
    NoFirmware { elf: PathBuf, part: &'static str },
    #[error("cannot start {program}: {source}")]
    Start {
        program: &'static str,
        source: io::Error,
    },
    #[error("cannot write the log {}: {source}", .path.display())]
    Log { path: PathBuf, source: io::Error },
    #[error("cannot open {}: {source}{}", .path.display(), .ports)]
    Serial {
        path: PathBuf,
        source: serialport::Error,
        /// What ports there are, for people.
        ports: String,
    },
}

/// A line to a device, in both directions.
pub struct Channel {
    /// Bytes from the device. An error of the kinds `TimedOut`, `WouldBlock` and `Interrupted` means that there are none now; the end means that the
    /// device is gone.
    pub read: Box<dyn Read + Send>,
    /// Bytes to the device.
    pub write: Box<dyn Write + Send>,
    /// How long the line takes per byte; nothing for one that is as fast as its ends.
    pub per_byte: Duration,
    pub(crate) emulator: Option<Emulator>,
    pub(crate) part: Option<Part>,
}

impl fmt::Debug for Channel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Channel")
            .field("emulator", &self.emulator)
            .finish_non_exhaustive()
    }
}

impl Channel {
    /// A line over anything that can be read and written, for instance a socket to a device on another machine.
    #[must_use]
    pub fn new(read: impl Read + Send + 'static, write: impl Write + Send + 'static) -> Self {
        Self {
            read: Box::new(read),
            write: Box::new(write),
            per_byte: Duration::ZERO,
            emulator: None,
            part: None,
        }
    }

    /// Starts the emulator or opens the port. `firmware` is the folder that `cargo xtask firmware` writes to; an emulator's log goes
    /// to the file `log`.
    ///
    /// # Errors
    /// See [`OpenError`].
    pub fn open(device: &Device, firmware: &Path, log: Option<&Path>) -> Result<Self, OpenError> {
        match device {
            Device::Emulated(part) => {
                let (emulator, socket) = emulator::start(*part, &part.elf(firmware), log)?;
                let failed = |source| OpenError::Start {
                    program: "the emulator",
                    source,
                };
                socket.set_write_timeout(Some(PATIENCE)).map_err(failed)?;
                let read = socket.try_clone().map_err(failed)?;
                let mut channel = Self::new(read, socket);
                channel.emulator = Some(emulator);
                channel.part = Some(*part);
                Ok(channel)
            }
            Device::Serial { path, baud } => {
                let failed = |source| OpenError::Serial {
                    path: path.clone(),
                    source,
                    ports: ports(),
                };
                let name = path.to_string_lossy();
                let port = serialport::new(name, *baud).timeout(PATIENCE).open();
                let port = port.map_err(failed)?;
                let read = port.try_clone().map_err(failed)?;
                let mut channel = Self::new(read, port);
                // A start bit, eight bits, a stop bit.
                channel.per_byte = Duration::from_secs(10) / (*baud).max(1);
                Ok(channel)
            }
        }
    }
}

/// The serial ports of this machine, as the end of a sentence.
fn ports() -> String {
    let found = serialport::available_ports().unwrap_or_default();
    let names: Vec<String> = found.into_iter().map(|port| port.port_name).collect();
    if names.is_empty() {
        return String::from("; this machine shows no serial port");
    }
    format!("; there are {}", names.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn missing_port_is_named() {
        let device: Device = "serial:/dev/no-such-port".parse().expect("a device");
        let error = Channel::open(&device, Path::new("."), None).expect_err("no port");
        let text = error.to_string();
        assert!(
            text.starts_with("cannot open /dev/no-such-port: "),
            "{text}"
        );
        assert!(text.contains("; "), "{text}");
    }
}
