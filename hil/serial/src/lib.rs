//! Serial ports in textual notation, opened as a reader and a writer.
//!
//! ```ignore
//! use std::io::{Read, Write};
//! use std::time::Duration;
//! let port: staya_serial::SerialPort = "/dev/ttyACM0,baud=57600".parse()?;
//! let (mut reader, mut writer) = port.open(Duration::from_millis(500))?;
//! writer.write_all(b"?")?;
//! let len = reader.read(&mut [0; 64])?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use std::fmt;
use std::io::{Read, Write};
use std::path::PathBuf;
use std::str::FromStr;
use std::time::Duration;

/// Default baud rate, bits per second.
pub const DEFAULT_BAUD: u32 = 115_200;

/// A serial port and its speed, written `PORT[,baud=N]`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SerialPort {
    /// Path of the device file, or the port's name where ports are not files.
    pub path: PathBuf,
    /// Bits per second, above 0.
    pub baud: u32,
}

/// Reason why a text does not denote a port.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[expect(missing_docs, reason = "each text says it")]
pub enum ParseError {
    #[error("no port; write for instance serial:/dev/ttyACM0,baud={DEFAULT_BAUD}")]
    NoPort,
    #[error("no option `{0}`; there is `baud`")]
    Option(String),
    #[error("baud `{0}` is not a whole number above 0")]
    Baud(String),
}

/// Reason why a port cannot be opened.
#[derive(Debug, thiserror::Error)]
#[error("cannot open {}: {source}{}", .path.display(), there_are(.ports))]
pub struct OpenError {
    /// The port.
    pub path: PathBuf,
    /// The error of the operating system.
    pub source: serialport::Error,
    /// The ports of this machine.
    pub ports: Vec<String>,
}

/// Receiving side of a port.
pub type Reader = Box<dyn Read + Send>;
/// Sending side of a port.
pub type Writer = Box<dyn Write + Send>;

impl SerialPort {
    /// Opens the port with 8 bits, no parity and one stop bit. A read or write that takes longer
    /// than `timeout` fails with [`TimedOut`](std::io::ErrorKind::TimedOut).
    ///
    /// # Errors
    /// See [`OpenError`].
    pub fn open(&self, timeout: Duration) -> Result<(Reader, Writer), OpenError> {
        let failed = |source| {
            let found = serialport::available_ports().unwrap_or_default();
            OpenError { path: self.path.clone(), source, ports: found.into_iter().map(|port| port.port_name).collect() }
        };
        let name = self.path.to_string_lossy();
        let port = serialport::new(name, self.baud).timeout(timeout).open();
        let writer = port.map_err(failed)?;
        let reader = writer.try_clone().map_err(failed)?;
        Ok((Box::new(reader), Box::new(writer)))
    }

    /// Transmission time of a byte: start bit, eight bits, stop bit.
    #[must_use]
    pub fn byte_time(&self) -> Duration {
        Duration::from_secs(10) / self.baud.max(1)
    }
}

fn there_are(ports: &[String]) -> String {
    if ports.is_empty() {
        return String::from("; this machine shows no serial port");
    }
    format!("; there are {}", ports.join(", "))
}

impl FromStr for SerialPort {
    type Err = ParseError;

    fn from_str(text: &str) -> Result<Self, ParseError> {
        let mut pieces = text.split(',');
        let path = pieces.next().filter(|path| !path.is_empty());
        let path = path.ok_or(ParseError::NoPort)?.into();
        let mut baud = DEFAULT_BAUD;
        for piece in pieces {
            let (key, value) = piece.split_once('=').unwrap_or((piece, ""));
            if key != "baud" {
                return Err(ParseError::Option(key.to_owned()));
            }
            let number = value.parse().ok().filter(|number| *number > 0);
            baud = number.ok_or_else(|| ParseError::Baud(value.to_owned()))?;
        }
        Ok(Self { path, baud })
    }
}

impl fmt::Display for SerialPort {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{},baud={}", self.path.display(), self.baud)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn written_ports_are_read_back() {
        let port: SerialPort = "/dev/ttyACM0,baud=9600".parse().expect("a port");
        assert_eq!(port.to_string(), "/dev/ttyACM0,baud=9600");
        let port: SerialPort = "/dev/ttyUSB1".parse().expect("a port");
        assert_eq!(port.to_string(), "/dev/ttyUSB1,baud=115200");
        assert_eq!(port.byte_time(), Duration::from_nanos(86_805));
    }

    #[test]
    fn errors_name_the_wrong_piece() {
        for (text, pieces) in [
            ("", ["no port", "/dev/ttyACM0"]),
            (",baud=9600", ["no port", "/dev/ttyACM0"]),
            ("/dev/x,speed=1", ["`speed`", "`baud`"]),
            ("/dev/x,baud=fast", ["`fast`", "whole number"]),
            ("/dev/x,baud=0", ["`0`", "above 0"]),
        ] {
            let error = text.parse::<SerialPort>().expect_err(text).to_string();
            for piece in pieces {
                assert!(error.contains(piece), "{text}: {error}");
            }
        }
    }

    #[test]
    fn missing_port_is_named() {
        let port: SerialPort = "/dev/no-such-port".parse().expect("a port");
        let Err(error) = port.open(Duration::from_millis(1)) else {
            panic!("there is none");
        };
        let text = error.to_string();
        assert!(text.starts_with("cannot open /dev/no-such-port: "), "{text}");
        assert!(text.contains("; "), "{text}");
    }
}
