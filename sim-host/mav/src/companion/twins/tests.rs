use super::*;
use staya_mavlink::dialect::{GLOBAL_POSITION_INT_DATA, HEARTBEAT_DATA};
use std::net::SocketAddr;

fn peer(port: u16) -> Peer {
    Peer::Address(SocketAddr::from(([127, 0, 0, 1], port)))
}

fn ms(ms: u64) -> Duration {
    Duration::from_millis(ms)
}

fn beat() -> MavMessage {
    MavMessage::HEARTBEAT(HEARTBEAT_DATA::DEFAULT)
}

/// At metres north of a place, with a speed in m/s.
fn position(boot_ms: u64, north_m: f64, speed_mps: f64) -> MavMessage {
    MavMessage::GLOBAL_POSITION_INT(GLOBAL_POSITION_INT_DATA {
        time_boot_ms: boot_ms as u32,
        lat: 470_000_000 + (north_m * 1e7 / 111_200.0) as i32,
        lon: 80_000_000,
        vx: (speed_mps * 100.0) as i16,
        ..GLOBAL_POSITION_INT_DATA::DEFAULT
    })
}

/// The first evidence and its time, of messages every 50 ms.
fn judged(count: u64, each: impl Fn(u64) -> (Peer, MavMessage)) -> Option<(u64, Evidence)> {
    let mut twins = Twins::default();
    (0..count).find_map(|step| {
        let (peer, message) = each(step);
        twins.hear(peer, &message, ms(step * 50)).map(|evidence| (step, evidence))
    })
}

#[test]
fn two_vehicles_are_recognised_by_peer_clock_or_place() {
    let of = |step: u64| u16::try_from(step % 2).expect("one of two");
    let peers = judged(60, |step| (peer(of(step)), beat())).expect("two");
    assert!(peers.0 <= 6 && matches!(peers.1, Evidence::Peers(..)), "{peers:?}");
    let clocks = judged(60, |step| (peer(1), position(9_000 * u64::from(of(step)) + step * 50, 0.0, 0.0)));
    assert!(matches!(clocks, Some((..=6, Evidence::Clocks))), "{clocks:?}");
    for off_m in [1.5, 3.0, 12.0, 800.0] {
        let places = judged(60, |step| (peer(1), position(step * 50, off_m * f64::from(of(step)), 0.0)));
        let Some((..=6, Evidence::Places(found_m))) = places else { panic!("{off_m}: {places:?}") };
        assert!((found_m - off_m).abs() < 0.1 + 0.001 * off_m, "{found_m}");
    }
    // One of them sends positions at 1 Hz, the other one at 20 Hz.
    let rare = judged(200, |step| (peer(1), position(step * 50, if step % 20 == 0 { 30.0 } else { 0.0 }, 0.0)));
    assert!(matches!(rare, Some((..=80, Evidence::Places(_)))), "{rare:?}");
}

#[test]
fn one_vehicle_is_not_two() {
    let silent = [
        (
            "parked, with drift",
            judged(2000, |step| (peer(1), position(step * 50, 0.3 * libm::sin(step as f64 * 0.1), 0.0))),
        ),
        ("moving", judged(2000, |step| (peer(1), position(step * 50, step as f64 * 0.75, 15.0)))),
        (
            "rare positions",
            judged(2000, |step| {
                let held = step - step % 40;
                (peer(1), position(held * 50, held as f64 * 0.25, 5.0))
            }),
        ),
        ("a restart", judged(400, |step| (peer(1), position((step % 200) * 50, 0.0, 0.0)))),
        (
            "a reset of the estimate",
            judged(400, |step| (peer(1), position(step * 50, if step < 90 { 0.0 } else { 25.0 }, 0.0))),
        ),
        ("a disturbance", judged(400, |step| (peer(1), position(step * 50, if step == 90 { 25.0 } else { 0.0 }, 0.0)))),
        ("a new address", judged(400, |step| (peer(if step < 50 { 1 } else { 2 }), beat()))),
        ("new addresses", judged(400, |step| (peer(step as u16 / 20), beat()))),
        ("delays", judged(400, |step| (peer(1), position((step - (step % 3) * 5 % (step + 1)) * 50, 0.0, 0.0)))),
    ];
    for (what, evidence) in silent {
        assert_eq!(evidence, None, "{what}");
    }
}

#[test]
fn one_vehicle_is_left_ten_seconds_after_the_last_return() {
    let mut twins = Twins::default();
    let mut now = Duration::ZERO;
    for step in 0..20 {
        now = ms(step * 100);
        let _ = twins.hear(peer((step % 2) as u16), &beat(), now);
    }
    assert!(twins.are_two());
    for later in [WINDOW + ms(1), CLEAR] {
        assert_eq!(twins.hear(peer(1), &beat(), now + later), None, "told once");
        assert!(!twins.become_one(now + later));
    }
    assert!(twins.become_one(now + CLEAR + ms(1)) && !twins.are_two());
    assert!(!twins.become_one(now + CLEAR + ms(2)));
}
