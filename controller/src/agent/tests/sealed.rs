//! Tests of an agent with [`Sealed`] frames.

use super::*;
use crate::auth::Key;
use crate::wire::{Sealed, Wire};

type SealedAgent = Agent<f32, RouteGuidance<CELLS, VISITS>, NEIGHBORS, Unguarded, Sealed<4>>;

fn wire(passphrase: &[u8]) -> Sealed<4> {
    Sealed::at_start(&Key::of_passphrase(passphrase), 0).unwrap()
}

fn goal_at(x: i16) -> Message {
    goal(0, x as u8, Cell::new(x, 5))
}

fn said<W: Wire>(by: &mut W, sequence: u16, message: &Message) -> Vec<u8> {
    let mut out = heapless::Vec::<u8, 64>::new();
    let header = Header { boot: 0, sender: RobotId(9), sequence };
    by.encode(header, message, &mut out).unwrap();
    out.to_vec()
}

#[test]
fn only_fresh_authentic_frames_are_obeyed_and_all_others_are_counted() {
    let guidance = RouteGuidance::new(RouteParams::default());
    let mut agent = SealedAgent::new(&config(1), guidance, Unguarded, wire(b"swarm"));
    let mut friend = wire(b"swarm");
    let first = said(&mut friend, 0, &goal_at(20));
    let attacks = [
        said(&mut Postcard, 1, &goal_at(30)),
        said(&mut wire(b"guessed"), 2, &goal_at(31)),
        said(&mut wire(b"guessed"), 3, &goal_at(32)),
        first.clone(),
    ];
    let mut ws = workspace();
    let mut hear = |inbox: &[u8], n| {
        let out = agent.step(&inputs(&FLAT, Cell::new(5, 5), inbox), tick(n), &mut ws);
        (out, agent.target())
    };
    let (out, target) = hear(&first, 0);
    assert_eq!((out.received, out.rejected), (1, 0));
    assert_eq!((out.refused, target), (Refused::default(), Some(Cell::new(20, 5))));
    let (out, target) = hear(&attacks.concat(), 1);
    let refused = Refused { unsigned: 1, forged: 2, replayed: 1, no_room: 0 };
    assert_eq!((out.received, out.rejected, out.refused), (0, 4, refused));
    assert_eq!(target, Some(Cell::new(20, 5)));
    let (out, target) = hear(&said(&mut friend, 1, &goal_at(40)), 2);
    assert_eq!((out.received, target), (1, Some(Cell::new(40, 5))));
    let mut listener = wire(b"swarm");
    let mut outbox = out.outbox.as_slice();
    let beacon = listener.next_frame(&mut outbox).unwrap();
    assert_eq!(listener.decode(beacon).unwrap().header.sender, RobotId(1));
    assert!(wire(b"guessed").decode(beacon).is_err());
}

#[test]
fn a_robot_with_an_exhausted_counter_reports_it_and_still_receives() {
    let guidance = RouteGuidance::new(RouteParams::default());
    let mut wire = wire(b"swarm");
    // 4095 wraps of the sequence: 268 million frames later.
    let mut out = heapless::Vec::<u8, 64>::new();
    for _ in 0..1 << 12 {
        for sequence in [0, 1] {
            out.clear();
            let header = Header { boot: 0, sender: RobotId(1), sequence };
            let _ = wire.encode(header, &goal_at(1), &mut out);
        }
    }
    let mut agent = SealedAgent::new(&config(1), guidance, Unguarded, wire);
    let mut ws = workspace();
    let friend = said(&mut Sealed::<4>::at_start(&Key::of_passphrase(b"swarm"), 0).unwrap(), 0, &goal_at(20));
    let out = agent.step(&inputs(&FLAT, Cell::new(5, 5), &friend), tick(0), &mut ws);
    assert!(out.outbox.is_empty() && out.events.contains(&Event::Muted), "{:?}", out.events);
    assert_eq!((out.received, agent.target()), (1, Some(Cell::new(20, 5))));
}

#[test]
fn the_numbers_of_beacons_count_periods_also_while_the_robot_pauses() {
    let guidance = RouteGuidance::new(RouteParams::default());
    let mut agent = SealedAgent::new(&config(1), guidance, Unguarded, wire(b"swarm"));
    let (mut listener, mut ws) = (wire(b"swarm"), workspace());
    let mut numbers = Vec::new();
    // Steps that are late, early, and after a pause of 40 periods.
    for ms in [0, 1000, 2400, 3000, 43_000, 44_000] {
        let now = Instant::from_micros(1000 * ms);
        let out = agent.step(&inputs(&FLAT, Cell::new(5, 5), &[]), now, &mut ws);
        let mut outbox = out.outbox.as_slice();
        while let Some(frame) = listener.next_frame(&mut outbox) {
            numbers.push((ms, listener.decode(frame).unwrap().header.sequence));
        }
    }
    // The even ones are those of beacons. The one after 600 ms waits for its period.
    assert_eq!(numbers, [(0, 0), (1000, 2), (2400, 4), (43_000, 86), (44_000, 88)]);
}

/// By its numbers, two for each period, a robot whose frames arrive at once was ten periods apart.
#[test]
fn a_robot_whose_frames_were_delayed_may_be_as_far_as_its_numbers_tell() {
    use crate::neighbor::PlausibilityLimits;
    for (x_mm, is_believed) in [(9_000, true), (25_000, false)] {
        let settle = Duration::from_millis(60_000);
        let plausibility = PlausibilityLimits { max_speed_mps: 1.0, slack_m: 0.5, settle, ..PlausibilityLimits::ANY };
        let guidance = RouteGuidance::new(RouteParams::default());
        let mut agent =
            SealedAgent::new(&AgentConfig { plausibility, ..config(1) }, guidance, Unguarded, wire(b"swarm"));
        let (mut friend, mut ws) = (wire(b"swarm"), workspace());
        let at = |x_mm: i32| Message::Beacon(Beacon { position_mm: [x_mm, 0, 0], ..beacon_at(9, 5) });
        let inbox = [said(&mut friend, 0, &at(0)), said(&mut friend, 20, &at(x_mm))].concat();
        let _ = agent.step(&inputs(&FLAT, Cell::new(5, 5), &inbox), tick(1), &mut ws);
        let known = agent.neighbors().first().map(|known| known.position.mm[0]);
        assert_eq!(known, Some(if is_believed { x_mm } else { 0 }), "{x_mm} mm");
    }
}
