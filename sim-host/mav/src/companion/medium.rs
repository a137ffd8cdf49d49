//! Packets between companions: the frames that robots exchange by radio. A datagram on a LAN has
//! those of one agent in one step; a TUNNEL message over MAVLink has up to 128 bytes of them.

use anyhow::{Result, anyhow};
use socket2::{Domain, Protocol, Socket, Type};
use staya_controller::wire::Wire;
use staya_mavlink::dialect::{MavMessage, TUNNEL_DATA};
use std::collections::VecDeque;
use std::io;
use std::net::{Ipv4Addr, SocketAddr, SocketAddrV4, UdpSocket};

/// Private payload types start at 32768.
const PAYLOAD_TYPE: u16 = 0xD53A;
const AT_A_TIME: usize = 256;

/// The network to companions in other processes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum MediumSetup {
    /// No network.
    Here,
    /// IPv4 multicast.
    Multicast {
        /// Group address and port.
        group: SocketAddrV4,
        /// Own address in the network of the group; unspecified lets the system choose.
        interface: Ipv4Addr,
    },
    /// Unicast to listed peers.
    Peers {
        /// Own address and port.
        bind: SocketAddr,
        /// Addresses of the other companions.
        peers: Vec<SocketAddr>,
    },
    /// TUNNEL messages over the autopilots' links.
    Tunnel,
}

/// The network to companions in other processes.
#[derive(Debug, Default)]
pub struct Medium {
    socket: Option<UdpSocket>,
    to: Vec<SocketAddr>,
    /// Recent own datagrams, which a multicast group returns to the sender.
    sent: VecDeque<Vec<u8>>,
}

impl Medium {
    /// Opens the network.
    ///
    /// # Errors
    /// An address is unavailable.
    pub fn open(setup: &MediumSetup) -> Result<Self> {
        let (over, socket, to) = match setup {
            MediumSetup::Here | MediumSetup::Tunnel => return Ok(Self::default()),
            MediumSetup::Multicast { group, interface } => {
                (group.to_string(), join(*group, *interface), vec![SocketAddr::V4(*group)])
            }
            MediumSetup::Peers { bind, peers } => (bind.to_string(), UdpSocket::bind(bind), peers.clone()),
        };
        let socket = socket.and_then(|socket| socket.set_nonblocking(true).map(|()| socket));
        let socket = socket.map_err(|error| {
            anyhow!("cannot exchange packets with other companions over {over}: {error}; check the addresses in [air]")
        })?;
        Ok(Self { socket: Some(socket), to, sent: VecDeque::new() })
    }

    /// Sends the frames of one agent. Datagrams that the network refuses are lost, as on a radio.
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

    /// Passes received datagrams to `heard`, at most 256 and without the own ones.
    pub fn receive(&mut self, mut heard: impl FnMut(&[u8])) {
        let Some(socket) = &self.socket else { return };
        let mut buffer = [0; 2048];
        for _ in 0..AT_A_TIME {
            match socket.recv_from(&mut buffer) {
                Ok((len, _)) => match self.sent.iter().position(|own| *own == buffer[..len]) {
                    Some(own) => drop(self.sent.remove(own)),
                    None => heard(&buffer[..len]),
                },
                Err(_) => return,
            }
        }
    }
}

/// Other processes on this computer can open the same group.
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
    Ok(socket.into())
}

/// Packs whole frames into broadcast TUNNEL messages. No frame is longer than their 128 bytes.
pub fn tunnel<W: Wire>(wire: &W, frames: &[u8]) -> Vec<MavMessage> {
    let mut parts = Vec::<Vec<u8>>::new();
    let mut rest = frames;
    loop {
        let before = rest;
        if wire.next_frame(&mut rest).is_none() {
            break;
        }
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

/// `None` if the message is not one of Staya's.
pub fn tunnelled(message: &TUNNEL_DATA) -> Option<&[u8]> {
    let frames = message.payload.get(..message.payload_length.into())?;
    (message.payload_type == PAYLOAD_TYPE).then_some(frames)
}

#[cfg(test)]
mod tests;
