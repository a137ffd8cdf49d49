use super::*;
use crate::stream::CONNECTIONS;
use crate::traffic::GLANCE;
use staya_mavlink::dialect::STAYA_GOAL_DATA;
use staya_mavlink::frame::{RawFrame, Sender, encode};
use std::io::{Read as _, Write as _};
use std::net::{TcpStream, UdpSocket};
use std::time::Instant;

const PATIENCE: Duration = Duration::from_secs(10);

fn framed(x: i16) -> Vec<u8> {
    let mut out = heapless::Vec::<u8, 64>::new();
    let goal = STAYA_GOAL_DATA { target_x: x, ..STAYA_GOAL_DATA::DEFAULT };
    encode(Sender::default(), &goal, &mut out).expect("room");
    out.to_vec()
}

fn open(text: &str) -> Lines {
    let endpoint = text.parse().expect(text);
    Lines::open(&[endpoint]).expect(text)
}

fn goal(received: &Received) -> i16 {
    let frame = RawFrame::new(&received.frame).expect("a frame");
    frame.get::<STAYA_GOAL_DATA>().expect("a goal").target_x
}

fn pair(listening: &str, calling: &str) -> (Lines, Lines) {
    let listening = open(&format!("{listening}:127.0.0.1:0"));
    let port = listening.local(0).expect("an address").port();
    (listening, open(&format!("{calling}:127.0.0.1:{port}")))
}

/// A connection takes time, and a datagram may be lost.
fn arrives(from: &Lines, to: &Lines, x: i16) -> Received {
    let began = Instant::now();
    while began.elapsed() < PATIENCE {
        from.send(0, None, &framed(x));
        if let Some(received) = to.receive(Duration::from_millis(100)) {
            to.believe(0, received.peer);
            return received;
        }
    }
    panic!("nothing arrived");
}

fn both_ways(listening: &Lines, calling: &Lines) {
    let received = arrives(calling, listening, 5);
    assert_eq!(goal(&received), 5);
    listening.send(0, Some(received.peer), &framed(6));
    let answer = calling.receive(PATIENCE).expect("an answer");
    assert_eq!(goal(&answer), 6);
    listening.send(0, None, &framed(7));
    let answer = calling.receive(PATIENCE).expect("an answer");
    assert_eq!(goal(&answer), 7);
    let bytes = 2 * framed(6).len() as u64;
    let began = Instant::now();
    while listening.counts(0).bytes_out < bytes && began.elapsed() < PATIENCE {
        std::thread::sleep(GLANCE);
    }
    let counts = listening.counts(0);
    assert_eq!((counts.frames_out, counts.bytes_out), (2, bytes));
    assert!(counts.frames_in >= 1 && counts.lost_in == 0);
}

#[test]
fn datagrams_pass_in_both_directions() {
    let (listening, calling) = pair("udpin", "udpout");
    both_ways(&listening, &calling);
}

#[test]
fn connections_pass_frames_in_both_directions() {
    let (listening, calling) = pair("tcpin", "tcpout");
    both_ways(&listening, &calling);
}

#[test]
fn a_closed_connection_is_opened_again() {
    let (listening, calling) = pair("tcpin", "tcpout");
    arrives(&calling, &listening, 1);
    let address = listening.local(0).expect("an address");
    drop(listening);
    let again = open(&format!("tcpin:{address}"));
    assert_eq!(goal(&arrives(&calling, &again, 2)), 2);
}

#[test]
fn frames_are_found_in_pieces_and_junk() {
    let listening = open("tcpin:127.0.0.1:0");
    let address = listening.local(0).expect("an address");
    let mut socket = TcpStream::connect(address).expect("a connection");
    let mut bytes = vec![0xFD, 7, 7];
    bytes.extend(framed(1));
    bytes.extend([1, 2, 3]);
    bytes.extend(framed(2));
    for piece in bytes.chunks(5) {
        socket.write_all(piece).expect("a peer");
        socket.flush().expect("a peer");
        std::thread::sleep(Duration::from_millis(1));
    }
    let found: Vec<_> = (0..2).filter_map(|_| listening.receive(PATIENCE)).collect();
    assert_eq!(found.iter().map(goal).collect::<Vec<_>>(), [1, 2]);
    assert_eq!(listening.counts(0).junk_bytes, 6);
}

#[test]
fn every_known_peer_receives_frames() {
    let listening = open("udpin:127.0.0.1:0");
    let port = listening.local(0).expect("an address").port();
    let callers: Vec<_> = (0..3).map(|_| open(&format!("udpout:127.0.0.1:{port}"))).collect();
    for (x, caller) in (0..).zip(&callers) {
        assert_eq!(goal(&arrives(caller, &listening, x)), x);
    }
    listening.send(0, None, &framed(9));
    for caller in &callers {
        assert_eq!(goal(&caller.receive(PATIENCE).expect("told")), 9);
    }
}

fn datagrams(socket: &UdpSocket) -> usize {
    let mut buffer = [0; 512];
    std::iter::from_fn(|| socket.recv(&mut buffer).ok()).count()
}

/// The attack: one frame from each of many spoofed ports would make all of them receivers.
#[test]
fn unknown_senders_receive_nothing() {
    let listening = open("udpin:127.0.0.1:0");
    let address = listening.local(0).expect("an address");
    let strangers: Vec<_> = (0..64).map(|_| UdpSocket::bind("127.0.0.1:0").expect("a port")).collect();
    for stranger in &strangers {
        stranger.set_read_timeout(Some(Duration::from_millis(1))).expect("a time");
        stranger.send_to(b"x", address).expect("sent");
        stranger.send_to(&framed(1), address).expect("sent");
    }
    let friend = open(&format!("udpout:{address}"));
    friend.send(0, None, &framed(77));
    let mut heard = 0;
    while let Some(received) = listening.receive(PATIENCE) {
        listening.send(0, Some(received.peer), &framed(2));
        listening.send(0, None, &framed(3));
        heard += 1;
        if goal(&received) == 77 {
            listening.believe(0, received.peer);
            listening.send(0, None, &framed(4));
            break;
        }
    }
    assert!(heard > 1);
    assert_eq!(goal(&friend.receive(PATIENCE).expect("told")), 4);
    assert_eq!(strangers.iter().map(datagrams).sum::<usize>(), 0);
}

#[test]
fn silent_connections_are_closed_for_new_ones() {
    let listening = open("tcpin:127.0.0.1:0");
    let address = listening.local(0).expect("an address");
    let friend = open(&format!("tcpout:{address}"));
    arrives(&friend, &listening, 1);
    let idle: Vec<_> = (0..2 * CONNECTIONS).map(|_| TcpStream::connect(address).expect("a queue")).collect();
    let late = open(&format!("tcpout:{address}"));
    assert_eq!(goal(&arrives(&late, &listening, 2)), 2);
    let ended = |mut socket: &TcpStream| {
        let _ = socket.set_read_timeout(Some(Duration::from_millis(1)));
        matches!(socket.read(&mut [0; 1]), Ok(0))
    };
    assert!(idle.iter().filter(|socket| ended(socket)).count() > CONNECTIONS);
    listening.send(0, None, &framed(3));
    assert_eq!(goal(&friend.receive(PATIENCE).expect("told")), 3);
    assert_eq!(goal(&late.receive(PATIENCE).expect("told")), 3);
}

#[test]
fn an_absent_peer_does_not_block() {
    let unused = UdpSocket::bind("127.0.0.1:0").expect("a port");
    let address = unused.local_addr().expect("an address");
    drop(unused);
    let lines = [format!("udpout:{address}"), format!("tcpout:{address}")];
    let lines = lines.map(|text| text.parse().expect("a line"));
    let lines = Lines::open(&lines).expect("lines");
    for _ in 0..50 {
        lines.send(0, None, &framed(1));
        lines.send(1, None, &framed(1));
    }
    assert_eq!(lines.receive(Duration::ZERO), None);
    assert_eq!(lines.counts(1).frames_out, 0);
}

#[test]
fn a_peer_that_does_not_read_loses_frames_without_blocking() {
    let listening = open("tcpin:127.0.0.1:0");
    let address = listening.local(0).expect("an address");
    let mut socket = TcpStream::connect(address).expect("a connection");
    socket.write_all(&framed(1)).expect("a peer");
    assert!(listening.receive(PATIENCE).is_some());
    let began = Instant::now();
    for _ in 0..400_000 {
        listening.send(0, None, &framed(1));
    }
    assert!(listening.counts(0).lost_out > 0, "some frames were dropped");
    assert!(began.elapsed() < PATIENCE);
    drop(socket);
}

#[test]
fn a_port_in_use_is_an_error_with_its_name() {
    let listening = open("udpin:127.0.0.1:0");
    let address = listening.local(0).expect("an address");
    let again = format!("udpin:{address}").parse().expect("a line");
    let error = Lines::open(&[again]).err().expect("taken").to_string();
    assert!(error.starts_with(&format!("cannot open udpin:{address}: ")), "{error}");
}

#[test]
fn a_refused_connection_is_reported_until_it_succeeds() {
    let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap();
    drop(listener);
    let lines = Lines::open(&[Endpoint::TcpOut(address)]).unwrap();
    let wait = |is_troubled: bool| {
        (0..400).any(|_| {
            std::thread::sleep(Duration::from_millis(10));
            lines.trouble(0).is_some() == is_troubled
        })
    };
    assert!(wait(true));
    assert!(lines.trouble(0).unwrap().contains("refused"));
    let _listener = std::net::TcpListener::bind(address).unwrap();
    assert!(wait(false));
}
