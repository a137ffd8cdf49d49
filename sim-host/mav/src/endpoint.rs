//! Endpoints of MAVLink links, for example `udpout:127.0.0.1:14550`.

use staya_serial::SerialPort;
use std::fmt;
use std::net::{SocketAddr, ToSocketAddrs};
use std::str::FromStr;

/// The address of a link, in the notation of pymavlink, MAVProxy and MAVSDK.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Endpoint {
    /// `udpout:HOST:PORT`: sends datagrams to this address, receives answers on the same socket.
    UdpOut(SocketAddr),
    /// `udpin:HOST:PORT`: receives datagrams here, answers up to 16 authenticated senders.
    UdpIn(SocketAddr),
    /// `tcpout:HOST:PORT`: connects to this address, and reconnects after a disconnect.
    TcpOut(SocketAddr),
    /// `tcpin:HOST:PORT`: accepts up to 32 connections at this address.
    TcpIn(SocketAddr),
    /// `serial:PORT[,baud=N]`: a serial port.
    Serial(SerialPort),
}

/// A text that is not an endpoint.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "`{text}` is not a MAVLink link: {what}; give for example udpout:127.0.0.1:14550, udpin:0.0.0.0:14550, \
     tcpin:127.0.0.1:5760, tcpout:127.0.0.1:5760 or serial:/dev/ttyACM0,baud=57600"
)]
pub struct EndpointError {
    /// The whole text.
    pub text: String,
    /// The problem.
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
            _ => return Err(error(format!("`{kind}` is not a kind of link"))),
        };
        let mut addresses =
            rest.to_socket_addrs().map_err(|reason| error(format!("`{rest}` is not HOST:PORT ({reason})")))?;
        // IPv4 is preferred, since most MAVLink programs listen on it.
        let first = addresses.next();
        let address = addresses
            .chain(first)
            .find(SocketAddr::is_ipv4)
            .or(first)
            .ok_or_else(|| error(format!("`{rest}` has no address")))?;
        if address.port() == 0 && matches!(kind, "udpout" | "tcpout" | "tcp") {
            return Err(error(String::from("port 0 is not usable")));
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
    fn endpoints_round_trip() {
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
    fn errors_name_the_problem_and_an_example() {
        for (text, piece) in [
            ("udp:127.0.0.1:1", "`udp` is not a kind"),
            ("udpout", "`` is not HOST:PORT"),
            ("udpout:127.0.0.1", "`127.0.0.1` is not HOST:PORT"),
            ("udpout:127.0.0.1:99999", "`127.0.0.1:99999`"),
            ("tcpout:127.0.0.1:0", "port 0"),
            ("serial:", "no port"),
            ("serial:/dev/x,baud=fast", "`fast`"),
        ] {
            let error = text.parse::<Endpoint>().expect_err(text).to_string();
            assert!(error.contains(piece), "{text}: {error}");
            assert!(error.starts_with(&format!("`{text}` is not a MAVLink link")));
            assert!(error.contains("udpout:127.0.0.1:14550"), "{error}");
        }
    }
}
