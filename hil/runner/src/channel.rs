//! Byte lines to devices.

use crate::device::Device;
use crate::emulator::{self, Emulator, EmulatorError};
use crate::part::Part;
use std::fmt;
use std::io::{Read, Write};
use std::path::Path;
use std::time::Duration;

/// How long a read or a write waits; who reads asks again, what cannot be written counts as lost.
const PATIENCE: Duration = Duration::from_millis(500);

/// Why there is no line to a device.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "each text says it")]
pub enum OpenError {
    #[error(transparent)]
    Emulator(#[from] EmulatorError),
    #[error(transparent)]
    Serial(#[from] staya_serial::OpenError),
}

/// A line to a device, in both directions.
pub struct Channel {
    /// Bytes from the device. An error of the kinds `TimedOut`, `WouldBlock` and `Interrupted` means that there are
    /// none now; the end means that the device is gone.
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
        f.debug_struct("Channel").field("emulator", &self.emulator).finish_non_exhaustive()
    }
}

impl Channel {
    /// A line over anything that can be read and written, for instance a socket to a device on another machine.
    #[must_use]
    pub fn new(read: impl Read + Send + 'static, write: impl Write + Send + 'static) -> Self {
        Self { read: Box::new(read), write: Box::new(write), per_byte: Duration::ZERO, emulator: None, part: None }
    }

    /// Starts the emulator or opens the port. `firmware` is the folder that `cargo xtask firmware` writes to; an
    /// emulator's log goes to the file `log`.
    ///
    /// # Errors
    /// See [`OpenError`].
    pub fn open(device: &Device, firmware: &Path, log: Option<&Path>) -> Result<Self, OpenError> {
        match device {
            Device::Emulated(part) => {
                let (emulator, socket) = emulator::start(*part, &part.elf(firmware), log)?;
                let failed = |source| EmulatorError::Start { program: "the emulator", source };
                socket.set_write_timeout(Some(PATIENCE)).map_err(failed)?;
                let read = socket.try_clone().map_err(failed)?;
                let mut channel = Self::new(read, socket);
                channel.emulator = Some(emulator);
                channel.part = Some(*part);
                Ok(channel)
            }
            Device::Serial(port) => {
                let (reader, writer) = port.open(PATIENCE)?;
                let mut channel = Self::new(reader, writer);
                channel.per_byte = port.byte_time();
                Ok(channel)
            }
        }
    }
}
