use super::*;
use crate::geo::{Global, Origin};
use crate::tlog::Missing;
use staya_controller::auth::Key;
use staya_mavlink::dialect::{COMMAND_LONG_DATA, HEARTBEAT_DATA};
use staya_mavlink::frame::Sender;
use staya_sim::scenario::Overrides;
use std::net::{SocketAddr, UdpSocket};
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

const PATIENCE: Duration = Duration::from_secs(20);
const LAST: u64 = (1 << 48) - 1;

fn key() -> Key {
    Key::of_passphrase(b"swarm")
}

fn ten(signing: Option<Signing>) -> (Swarm, SocketAddr) {
    logged(signing, None)
}

fn logged(signing: Option<Signing>, tlog: Option<PathBuf>) -> (Swarm, SocketAddr) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/bridge.toml");
    let scenario = Scenario::load(&path, &Overrides::default()).expect("a scenario");
    let place = Global { latitude_deg: 47.0, longitude_deg: 8.0, altitude_m: 400.0 };
    let options = Options {
        mavlink: vec!["udpin:127.0.0.1:0".parse().expect("a line")],
        speed: 1.0,
        ticks: None,
        rate: 1.0,
        disarmed: true,
        origin: Origin::new(place).expect("a place"),
        signing,
        tlog,
    };
    let swarm = Swarm::new(&scenario, options).expect("a swarm");
    let address = swarm.lines().local(0).expect("an address");
    (swarm, address)
}

struct Client {
    socket: UdpSocket,
    to: SocketAddr,
    signing: Option<Signing>,
    said: u64,
}

impl Client {
    fn new(to: SocketAddr, signing: Option<Signing>) -> Self {
        let socket = UdpSocket::bind("127.0.0.1:0").expect("a port");
        socket.set_read_timeout(Some(Duration::from_millis(20))).expect("a time");
        Self { socket, to, signing, said: 0 }
    }

    fn framed(&mut self, message: &MavMessage) -> Vec<u8> {
        self.framed_as(Sender { system: 255, component: 190, sequence: 0 }, message)
    }

    fn framed_as(&mut self, mut sender: Sender, message: &MavMessage) -> Vec<u8> {
        let frame = framed(&mut sender, message, self.signing.as_mut()).expect("a timestamp");
        frame.to_vec()
    }

    fn say(&mut self, message: &MavMessage) {
        let frame = self.framed(message);
        self.socket.send_to(&frame, self.to).expect("sent");
        self.said += 1;
    }

    fn is_obeyed(&mut self) -> bool {
        let began = Instant::now();
        while began.elapsed() < PATIENCE {
            self.say(&arm(3));
            if self.hears(|message| matches!(message, MavMessage::COMMAND_ACK(ack) if ack.target_component == 190)) {
                return true;
            }
        }
        false
    }

    fn hears(&self, mut is_it: impl FnMut(&MavMessage) -> bool) -> bool {
        let mut buffer = [0; 512];
        let frames = std::iter::from_fn(|| self.socket.recv(&mut buffer).ok().map(|len| buffer[..len].to_vec()));
        let messages = frames.filter_map(|bytes| RawFrame::new(&bytes)?.message());
        messages.into_iter().any(|message| is_it(&message))
    }
}

fn arm(system: u8) -> MavMessage {
    MavMessage::COMMAND_LONG(COMMAND_LONG_DATA {
        param1: 1.0,
        command: staya_mavlink::constants::MAV_CMD_COMPONENT_ARM_DISARM,
        target_system: system,
        target_component: 1,
        ..COMMAND_LONG_DATA::DEFAULT
    })
}

fn beside(swarm: Swarm, test: impl FnOnce()) -> BridgeReport {
    let is_over = AtomicBool::new(false);
    struct Ends<'a>(&'a AtomicBool);
    impl Drop for Ends<'_> {
        fn drop(&mut self) {
            self.0.store(true, Ordering::Relaxed);
        }
    }
    std::thread::scope(|scope| {
        let run = scope.spawn(|| swarm.run(|_| is_over.load(Ordering::Relaxed), &mut |_, _| {}));
        let ends = Ends(&is_over);
        test();
        drop(ends);
        run.join().expect("no panic")
    })
}

/// The attack: an attacker without the key replays a frame with the last possible timestamp.
#[test]
fn a_frame_of_the_far_future_does_not_mute_the_bridge() {
    let (swarm, address) = ten(Some(Signing::new(key(), 0, timestamp())));
    let mut insider = Client::new(address, Some(Signing::new(key(), 9, LAST)));
    let evil = insider.framed(&arm(1));
    let mut client = Client::new(address, Some(Signing::new(key(), 1, timestamp())));
    let report = beside(swarm, || {
        for _ in 0..3 {
            insider.socket.send_to(&evil, address).expect("sent");
            assert!(client.is_obeyed());
        }
    });
    assert_eq!((report.frames_ahead, report.frames_refused, report.is_exhausted), (3, 3, false));
}

#[test]
fn a_bridge_without_timestamps_refuses_commands_and_reports_why() {
    let left = 20_000;
    let (swarm, address) = ten(Some(Signing::new(key(), 0, LAST - left).with_lead(LAST)));
    let mut client = Client::new(address, Some(Signing::new(key(), 1, LAST - left)));
    let report = beside(swarm, || {
        let began = Instant::now();
        let is_said = |message: &MavMessage| match message {
            MavMessage::STATUSTEXT(text) => text.text.to_str().is_ok_and(|text| text.contains("new key")),
            _ => false,
        };
        let heartbeat = MavMessage::HEARTBEAT(HEARTBEAT_DATA::DEFAULT);
        let mut is_told = false;
        while !is_told && began.elapsed() < PATIENCE {
            client.say(&heartbeat);
            client.say(&arm(1));
            is_told = client.hears(is_said);
        }
        assert!(is_told);
    });
    assert!(report.is_exhausted && report.frames_refused > 0);
    assert!(report.commands.is_empty(), "{:?}", report.commands);
}

#[test]
fn a_flood_from_one_client_does_not_delay_answers_to_others() {
    let (swarm, address) = ten(None);
    let mut client = Client::new(address, None);
    let mut flooder = Client::new(address, None);
    let frame = flooder.framed(&arm(0));
    let (is_over, sent) = (AtomicBool::new(false), AtomicUsize::new(0));
    let report = std::thread::scope(|scope| {
        scope.spawn(|| {
            while !is_over.load(Ordering::Relaxed) {
                for _ in 0..200 {
                    let _ = flooder.socket.send_to(&frame, address);
                }
                sent.fetch_add(200, Ordering::Relaxed);
                std::thread::sleep(Duration::from_millis(2));
            }
        });
        let report = beside(swarm, || {
            while sent.load(Ordering::Relaxed) < 20_000 {
                assert!(client.is_obeyed());
            }
            for _ in 0..10 {
                assert!(client.is_obeyed());
            }
        });
        is_over.store(true, Ordering::Relaxed);
        report
    });
    let [line] = &report.lines[..] else {
        panic!("one line");
    };
    assert!(line.counts.lost_in > 0, "{line:?}");
    // The flooder got only the answers that its rate limit allows.
    let answers = report.commands.values().sum::<u64>().saturating_sub(client.said);
    assert!((answers as f64) < 2.0 * (1100.0 + 1000.0 * report.wall_seconds), "{answers} in {}", report.wall_seconds);
}

#[test]
fn every_frame_is_accounted_for() {
    let (swarm, address) = ten(Some(Signing::new(key(), 0, timestamp())));
    let mut client = Client::new(address, Some(Signing::new(key(), 1, timestamp())));
    let mut stranger = Client::new(address, None);
    let mut forger = Client::new(address, Some(Signing::new(Key::of_passphrase(b"another"), 2, timestamp())));
    let mut hasty = Client::new(address, Some(Signing::new(key(), 3, LAST - 100)));
    let heartbeat = MavMessage::HEARTBEAT(HEARTBEAT_DATA::DEFAULT);
    let report = beside(swarm, || {
        assert!(client.is_obeyed());
        let recorded = client.framed(&heartbeat);
        for _ in 0..4 {
            client.socket.send_to(&recorded, address).expect("sent");
        }
        (0..5).for_each(|_| stranger.say(&heartbeat));
        (0..6).for_each(|_| forger.say(&heartbeat));
        (0..7).for_each(|_| hasty.say(&heartbeat));
        (0..8).for_each(|_| client.say(&arm(77)));
        assert!(client.is_obeyed());
        std::thread::sleep(Duration::from_millis(300));
    });
    let refused = Refused { unsigned: 5, forged: 6, replayed: 3, ahead: 7, ..Refused::default() };
    assert_eq!((report.refused, report.frames_refused), (refused, 21));
    assert_eq!(report.frames_ignored, 8);
    // Of the recorded frames only the first is valid.
    assert_eq!(report.frames_heard, 1 + client.said - 8);
    let lines = report.lines.iter().map(|line| line.counts.frames_in - line.counts.lost_in).sum::<u64>();
    assert_eq!(lines, report.frames_heard + report.frames_ignored + report.frames_refused + report.frames_waiting);
}

/// Companion computers and MAVROS have the system id of their vehicle by convention.
#[test]
fn all_senders_but_the_vehicle_itself_are_answered() {
    let (swarm, address) = ten(None);
    let mut client = Client::new(address, None);
    let report = beside(swarm, || {
        assert!(client.is_obeyed());
        for (system, component) in [(255, 190), (2, 1), (3, 191), (3, 240), (3, 0), (3, 255), (250, 1)] {
            let frame = client.framed_as(Sender { system, component, sequence: 0 }, &arm(3));
            client.socket.send_to(&frame, address).expect("sent");
            let is_mine = |ack: &staya_mavlink::dialect::COMMAND_ACK_DATA| {
                (ack.target_system, ack.target_component) == (system, component)
            };
            let answered = (0..50)
                .any(|_| client.hears(|message| matches!(message, MavMessage::COMMAND_ACK(ack) if is_mine(ack))));
            assert!(answered, "{system}:{component}");
        }
        let echo = client.framed_as(Sender { system: 3, component: 1, sequence: 0 }, &arm(3));
        client.socket.send_to(&echo, address).expect("sent");
        assert!(!client.hears(|message| matches!(message, MavMessage::COMMAND_ACK(_))), "its own frame");
    });
    assert_eq!(report.frames_ignored, 1);
}

#[test]
fn frames_cut_at_datagrams_are_answered_and_junk_is_counted() {
    use staya_mavlink::dialect::PING_DATA;
    let (swarm, address) = ten(None);
    let mut client = Client::new(address, None);
    let report = beside(swarm, || {
        assert!(client.is_obeyed());
        let ping = |seq| MavMessage::PING(PING_DATA { time_usec: 1 << 40, seq, ..PING_DATA::DEFAULT });
        for (round, cuts) in [(0, vec![37, 53, 36]), (10, vec![1, 20, 105]), (20, vec![60, 0, 66])] {
            let mut bytes: Vec<u8> = (1..=6).flat_map(|seq| client.framed(&ping(round + seq))).collect();
            for len in cuts {
                let piece: Vec<u8> = bytes.drain(..len.min(bytes.len())).collect();
                client.socket.send_to(&piece, address).expect("sent");
            }
            client.socket.send_to(&bytes, address).expect("sent");
            let mut missing: Vec<u32> = (1..=6).map(|seq| round + seq).collect();
            let began = Instant::now();
            while !missing.is_empty() && began.elapsed() < PATIENCE {
                let _ = client.hears(|message| {
                    if let MavMessage::PING(ping) = message {
                        missing.retain(|seq| *seq != ping.seq);
                    }
                    false
                });
            }
            assert!(missing.is_empty(), "no answer to {missing:?}");
        }
        client.socket.send_to(b"$GPGGA,", address).expect("sent");
        assert!(client.is_obeyed());
    });
    assert_eq!(report.lines[0].counts.junk_bytes, 7);
}

#[test]
fn a_full_disk_ends_the_log_but_not_the_bridge() {
    let full = PathBuf::from("/dev/full");
    if !full.exists() {
        return;
    }
    let (swarm, address) = logged(None, Some(full));
    let mut client = Client::new(address, None);
    let heartbeat = MavMessage::HEARTBEAT(HEARTBEAT_DATA::DEFAULT);
    let report = beside(swarm, || {
        let began = Instant::now();
        let is_said = |message: &MavMessage| match message {
            MavMessage::STATUSTEXT(text) => text.text.to_str().is_ok_and(|text| text.contains("log cannot be written")),
            _ => false,
        };
        let mut is_told = false;
        while !is_told && began.elapsed() < PATIENCE {
            client.say(&heartbeat);
            is_told = client.hears(is_said);
        }
        assert!(is_told);
        assert!(client.is_obeyed(), "the bridge answers without its log");
    });
    let error = report.log_error.expect("the log failed");
    assert!(error.contains("/dev/full") && error.contains("free some space"), "{error}");
    let Missing { log_frames_lost, log_bytes_lost } = report.log_missing;
    assert!(log_frames_lost > 0 && log_bytes_lost >= 20 * log_frames_lost, "{:?}", report.log_missing);
}
