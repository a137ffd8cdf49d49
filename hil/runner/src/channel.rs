use crate::device::Device;
use crate::emulator::{self, Emulator, EmulatorError};
use crate::part::Machine;
use std::fmt;
use std::io::{Read, Write};
use std::path::Path;
use std::time::Duration;

/// After this time a read is repeated, and the bytes of a write count as lost.
const PATIENCE: Duration = Duration::from_millis(500);

/// Reason why a device cannot be opened.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "each text says it")]
pub enum OpenError {
    #[error(transparent)]
    Emulator(#[from] EmulatorError),
    #[error(transparent)]
    Serial(#[from] staya_serial::OpenError),
}

/// A bidirectional byte stream to a device.
pub struct Channel {
    /// Bytes from the device. Errors of kind `TimedOut`, `WouldBlock` or `Interrupted` mean none
    /// yet; the end of the stream means that the device is gone.
    pub read: Box<dyn Read + Send>,
    /// Bytes to the device.
    pub write: Box<dyn Write + Send>,
    /// Transmission time per byte; zero for a line that does not limit its ends.
    pub per_byte: Duration,
    pub(crate) emulator: Option<Emulator>,
    pub(crate) machine: Option<Machine>,
}

impl fmt::Debug for Channel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Channel").field("emulator", &self.emulator).finish_non_exhaustive()
    }
}

impl Channel {
    /// Creates a channel over any reader and writer, for instance a socket.
    #[must_use]
    pub fn new(read: impl Read + Send + 'static, write: impl Write + Send + 'static) -> Self {
        Self { read: Box::new(read), write: Box::new(write), per_byte: Duration::ZERO, emulator: None, machine: None }
    }

    /// Starts the emulator or opens the port. `firmware` is the output folder of
    /// `cargo xtask firmware`; an emulator's log goes to the file `log`.
    ///
    /// # Errors
    /// See [`OpenError`].
    pub fn open(device: &Device, firmware: &Path, log: Option<&Path>) -> Result<Self, OpenError> {
        match device {
            Device::Emulated(machine) => {
                let (emulator, socket) = emulator::start(*machine, &machine.elf(firmware), log)?;
                let failed = |source| EmulatorError::Start { program: "the emulator", source };
                socket.set_write_timeout(Some(PATIENCE)).map_err(failed)?;
                let read = socket.try_clone().map_err(failed)?;
                let mut channel = Self::new(read, socket);
                channel.emulator = Some(emulator);
                channel.machine = Some(*machine);
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
