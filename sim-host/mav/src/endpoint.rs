//! `udpout:127.0.0.1:14550` and its like.

use staya_serial::SerialPort;
use std::fmt;
use std::net::{SocketAddr, ToSocketAddrs};
use std::str::FromStr;

/// Where the other side of a line is, written as pymavlink, MAVProxy and MAVSDK users know it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Endpoint {
    /// `udpout:HOST:PORT`: datagrams to this address; answers come back to the port they were sent from.
    UdpOut(SocketAddr),
    /// `udpin:HOST:PORT`: datagrams at this address; up to 16 who were heard, and believed, are answered.
    UdpIn(SocketAddr),
    /// `tcpout:HOST:PORT`: a connection to this address, made anew when it ends.
    TcpOut(SocketAddr),
    /// `tcpin:HOST:PORT`: connections at this address, up to 32.
    TcpIn(SocketAddr),
    /// `serial:PORT[,baud=N]`.
    Serial(SerialPort),
}

/// A text that names no line.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "`{text}` is no MAVLink line: {what}; write for instance udpout:127.0.0.1:14550, udpin:0.0.0.0:14550, \
     tcpin:127.0.0.1:5760, tcpout:127.0.0.1:5760 or serial:/dev/ttyACM0,baud=57600"
)]
pub struct EndpointError {
    /// All of it.
    pub text: String,
    /// What is wrong.
    pub what: String,
}

impl FromStr for Endpoint {
    type Err = EndpointError;

    fn from_str(text: &str) -> Result<Self, EndpointError> {
        let error = |what: String| EndpointError { text: text.to_owned(), what };
        let (kind, rest) = text.split_once(':').unwrap_or((text, ""));
        let make = match kind {
            "udpout" => Self::UdpOut,
            "udpin" => Self::UdpIn,
            "tcpout" | "tcp" => Self::TcpOut,
            "tcpin" => Self::TcpIn,
            "serial" => {
                let port: Result<SerialPort, _> = rest.parse();
                return port.map(Self::Serial).map_err(|reason| error(reason.to_string()));
            }
            _ => return Err(error(format!("`{kind}` is no kind of line"))),
        };
        let mut addresses =
            rest.to_socket_addrs().map_err(|reason| error(format!("`{rest}` is no HOST:PORT ({reason})")))?;
        // Where a name has several addresses, most MAVLink programs listen on the one of IPv4.
        let first = addresses.next();
        let address = addresses
            .chain(first)
            .find(SocketAddr::is_ipv4)
            .or(first)
            .ok_or_else(|| error(format!("`{rest}` has no address")))?;
        if address.port() == 0 && matches!(kind, "udpout" | "tcpout" | "tcp") {
            return Err(error(String::from("nobody listens on port 0")));
        }
        Ok(make(address))
    }
}

impl fmt::Display for Endpoint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::UdpOut(address) => write!(f, "udpout:{address}"),
            Self::UdpIn(address) => write!(f, "udpin:{address}"),
            Self::TcpOut(address) => write!(f, "tcpout:{address}"),
            Self::TcpIn(address) => write!(f, "tcpin:{address}"),
            Self::Serial(port) => write!(f, "serial:{port}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_back() {
        for text in [
            "udpout:127.0.0.1:14550",
            "udpin:0.0.0.0:14550",
            "udpin:127.0.0.1:0",
            "tcpin:[::1]:5760",
            "tcpout:127.0.0.1:5760",
            "serial:/dev/ttyACM0,baud=57600",
        ] {
            let endpoint: Endpoint = text.parse().expect(text);
            assert_eq!(endpoint.to_string(), text);
        }
        let named: Endpoint = "udpout:localhost:1".parse().expect("a name");
        assert_eq!(named.to_string(), "udpout:127.0.0.1:1");
    }

    #[test]
    fn errors_name_the_wrong_piece_and_a_right_one() {
        for (text, piece) in [
            ("udp:127.0.0.1:1", "`udp` is no kind"),
            ("udpout", "`` is no HOST:PORT"),
            ("udpout:127.0.0.1", "`127.0.0.1` is no HOST:PORT"),
            ("udpout:127.0.0.1:99999", "`127.0.0.1:99999`"),
            ("tcpout:127.0.0.1:0", "port 0"),
            ("serial:", "no port"),
            ("serial:/dev/x,baud=fast", "`fast`"),
        ] {
            let error = text.parse::<Endpoint>().expect_err(text).to_string();
            assert!(error.contains(piece), "{text}: {error}");
            assert!(error.starts_with(&format!("`{text}` is no MAVLink line")));
            assert!(error.contains("udpout:127.0.0.1:14550"), "{error}");
        }
    }
}
