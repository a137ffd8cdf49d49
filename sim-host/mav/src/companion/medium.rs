//! Packets between companions: the agents' own frames, as the radio of a robot would carry them.
//!
//! Over a LAN a datagram is what one agent says in one step. Through MAVLink it is one or more TUNNEL messages of up to 128 bytes to everybody.

use socket2::{Domain, Protocol, Socket, Type};
use staya_controller::wire::Wire;
use staya_mavlink::dialect::{MavMessage, TUNNEL_DATA};
use std::collections::VecDeque;
use std::io;
use std::net::{Ipv4Addr, SocketAddr, SocketAddrV4, UdpSocket};

/// The private payload type of TUNNEL messages that carry frames of Staya (private ones are 32768 and above).
const PAYLOAD_TYPE: u16 = 0xD53A;
/// Datagrams read at a time, and own ones that are remembered.
const AT_A_TIME: usize = 256;

/// How packets go to companions of other processes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum MediumSetup {
    /// There are none.
    Here,
    /// To all who have joined a group.
    Multicast {
        /// The group.
        group: SocketAddrV4,
        /// Own address on its network; unspecified: the system chooses.
        interface: Ipv4Addr,
    },
    /// To each of a list.
    Peers {
        /// Where packets arrive.
        bind: SocketAddr,
        /// Who gets them.
        peers: Vec<SocketAddr>,
    },
    /// Through the autopilots' links.
    Tunnel,
}

/// Why packets cannot come and go.
#[derive(Debug, thiserror::Error)]
#[error("cannot exchange packets with other companions over {over}: {source}")]
pub struct MediumError {
    /// Group or own address.
    over: String,
    /// Why.
    source: io::Error,
}

/// The way to other companions.
#[derive(Debug)]
pub struct Medium {
    socket: Option<UdpSocket>,
    to: Vec<SocketAddr>,
    /// The last datagrams: a group gives them back.
    sent: VecDeque<Vec<u8>>,
}

impl Medium {
    /// Opens it.
    ///
    /// # Errors
    /// When an address cannot be had.
    pub fn open(setup: &MediumSetup) -> Result<Self, MediumError> {
        let medium = |socket, to| Self { socket, to, sent: VecDeque::new() };
        match setup {
            // Through the autopilots' links packets go with the other messages.
            MediumSetup::Here | MediumSetup::Tunnel => Ok(medium(None, Vec::new())),
            MediumSetup::Multicast { group, interface } => match join(*group, *interface) {
                Ok(socket) => Ok(medium(Some(socket), vec![SocketAddr::V4(*group)])),
                Err(source) => Err(MediumError { over: group.to_string(), source }),
            },
            MediumSetup::Peers { bind, peers } => {
                let socket = UdpSocket::bind(bind).and_then(|socket| {
                    socket.set_nonblocking(true)?;
                    Ok(socket)
                });
                match socket {
                    Ok(socket) => Ok(medium(Some(socket), peers.clone())),
                    Err(source) => Err(MediumError { over: bind.to_string(), source }),
                }
            }
        }
    }

    /// Sends what an agent says; what the network does not take is lost, as on a radio.
    pub fn send(&mut self, frames: &[u8]) {
        let Some(socket) = &self.socket else { return };
        for to in &self.to {
            let _ = socket.send_to(frames, to);
            if to.ip().is_multicast() {
                self.sent.push_back(frames.to_vec());
            }
        }
        while self.sent.len() > AT_A_TIME {
            self.sent.pop_front();
        }
    }

    /// Gives what has arrived to `heard`, datagram by datagram, but not own ones; at most 256.
    pub fn receive(&mut self, mut heard: impl FnMut(&[u8])) {
        let Some(socket) = &self.socket else { return };
        let mut buffer = [0; 2048];
        for _ in 0..AT_A_TIME {
            match socket.recv_from(&mut buffer) {
                Ok((len, _)) => match self.sent.iter().position(|own| *own == buffer[..len]) {
                    Some(own) => drop(self.sent.remove(own)),
                    None => heard(&buffer[..len]),
                },
                // Nothing there, or news of a datagram that nobody took.
                Err(_) => return,
            }
        }
    }
}

/// A socket of a group that other processes of this machine may join too.
fn join(group: SocketAddrV4, interface: Ipv4Addr) -> io::Result<UdpSocket> {
    let socket = Socket::new(Domain::IPV4, Type::DGRAM, Some(Protocol::UDP))?;
    socket.set_reuse_address(true)?;
    #[cfg(unix)]
    let at = SocketAddrV4::new(*group.ip(), group.port());
    #[cfg(not(unix))]
    let at = SocketAddrV4::new(Ipv4Addr::UNSPECIFIED, group.port());
    socket.bind(&SocketAddr::V4(at).into())?;
    socket.join_multicast_v4(group.ip(), &interface)?;
    if !interface.is_unspecified() {
        socket.set_multicast_if_v4(&interface)?;
    }
    socket.set_nonblocking(true)?;
    Ok(socket.into())
}

/// What an agent says as TUNNEL messages to everybody; frames are not torn apart. What is longer than 128 bytes by itself is left out: no frame is.
pub fn tunnel<W: Wire>(wire: &W, frames: &[u8]) -> Vec<MavMessage> {
    let mut parts = Vec::<Vec<u8>>::new();
    let mut rest = frames;
    loop {
        let before = rest;
        if wire.next_frame(&mut rest).is_none() {
            break;
        }
        // With its delimiters.
        let frame = &before[..before.len() - rest.len()];
        match parts.last_mut() {
            Some(part) if part.len() + frame.len() <= 128 => part.extend_from_slice(frame),
            _ => parts.push(frame.to_vec()),
        }
    }
    let parts = parts.into_iter().filter(|part| part.len() <= 128);
    parts
        .map(|part| {
            let mut payload = [0; 128];
            payload[..part.len()].copy_from_slice(&part);
            MavMessage::TUNNEL(TUNNEL_DATA {
                payload_type: PAYLOAD_TYPE,
                target_system: 0,
                target_component: 0,
                payload_length: part.len() as u8,
                payload,
            })
        })
        .collect()
}

/// The frames in a TUNNEL message, if it is one of ours.
#[must_use]
pub fn tunnelled(message: &TUNNEL_DATA) -> Option<&[u8]> {
    let frames = message.payload.get(..message.payload_length.into())?;
    (message.payload_type == PAYLOAD_TYPE).then_some(frames)
}

#[cfg(test)]
mod tests;
