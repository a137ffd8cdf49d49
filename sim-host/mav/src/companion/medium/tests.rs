use super::*;
use staya_controller::robot::RobotId;
use staya_controller::wire::{Header, Message, Postcard, encode};

fn frames(count: u16) -> Vec<u8> {
    let mut bytes = Vec::new();
    for sequence in 0..count {
        let header = Header { boot: 0, sender: RobotId(1), sequence };
        let mut frame = heapless::Vec::<u8, 64>::new();
        encode(header, &Message::Beacon(Default::default()), &mut frame).unwrap();
        bytes.extend_from_slice(&frame);
    }
    bytes
}

#[test]
fn tunnel_messages_contain_whole_frames() {
    for count in 0..12 {
        let frames = frames(count);
        let messages = tunnel(&Postcard, &frames);
        let mut back = Vec::new();
        for message in &messages {
            let MavMessage::TUNNEL(data) = message else {
                panic!("a tunnel");
            };
            assert!(data.payload_type >= 32_768);
            let part = tunnelled(data).unwrap();
            assert_eq!(part.last(), Some(&0), "ends with a delimiter");
            back.extend_from_slice(part);
        }
        assert_eq!(back, frames);
    }
}

#[test]
fn tunnel_messages_of_other_types_are_ignored() {
    let other = TUNNEL_DATA { payload_type: 7, payload_length: 4, ..TUNNEL_DATA::DEFAULT };
    assert_eq!(tunnelled(&other), None);
    let too_long = TUNNEL_DATA { payload_type: PAYLOAD_TYPE, payload_length: 129, ..TUNNEL_DATA::DEFAULT };
    assert_eq!(tunnelled(&too_long), None);
}

fn heard(medium: &mut Medium) -> Vec<Vec<u8>> {
    let mut all = Vec::new();
    for _ in 0..100 {
        medium.receive(|bytes| all.push(bytes.to_vec()));
        if !all.is_empty() {
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    all
}

#[test]
fn peers_receive_each_others_datagrams() {
    let free = || {
        let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
        socket.local_addr().unwrap()
    };
    let (a, b) = (free(), free());
    let open = |bind, peer| Medium::open(&MediumSetup::Peers { bind, peers: vec![peer] });
    let (mut first, mut second) = (open(a, b).unwrap(), open(b, a).unwrap());
    first.send(b"one");
    assert_eq!(heard(&mut second), [b"one"]);
    second.send(b"two");
    assert_eq!(heard(&mut first), [b"two"]);
    let error = open(a, b).unwrap_err().to_string();
    assert!(error.contains(&a.to_string()), "{error}");
}

#[test]
fn no_network_receives_nothing() {
    for setup in [MediumSetup::Here, MediumSetup::Tunnel] {
        let mut medium = Medium::open(&setup).unwrap();
        medium.send(b"nothing");
        medium.receive(|_| panic!("received a datagram"));
    }
}

#[test]
fn own_multicast_datagrams_are_dropped() {
    let port = UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    let setup = MediumSetup::Multicast {
        group: SocketAddrV4::new(Ipv4Addr::new(239, 255, 77, 1), port),
        interface: Ipv4Addr::LOCALHOST,
    };
    let (mut first, mut second) = (Medium::open(&setup).unwrap(), Medium::open(&setup).unwrap());
    first.send(b"one");
    second.send(b"two");
    assert_eq!(heard(&mut second), [b"one"]);
    assert_eq!(heard(&mut first), [b"two"]);
}
