//! States that robots tell of each other.

use super::plane::{Robot, STEP, body_at, in_plane, orca, place, step_number, waypoint};
use super::*;
use crate::agent::contact_loss::Listening;
use crate::agent::link::Hearing;
use crate::neighbor::{PlausibilityLimits, Trace};
use crate::wire::{LostRobot, Message, decode};

type Listener = Robot<f32, WaypointGuidance<f32>, OrcaSafety<f32, 16>>;

/// Robot 1, which hears robot 2.
struct Pair {
    robot: Listener,
    next: i32,
}

impl Pair {
    fn new(config: &AgentConfig<f32>) -> Self {
        Self { robot: Robot::new(config, waypoint(), orca(), [0.0; 2]), next: 0 }
    }

    /// Steps without packets until step `n`, in which robot 2 says `messages`. Returns what robot 1
    /// tells then.
    fn hear(&mut self, n: i32, messages: &[Message]) -> Option<LostRobot> {
        for silent in self.next..n {
            let _ = self.robot.step(step_number(silent), &[]);
        }
        self.next = n + 1;
        told_in(&self.robot.step(step_number(n), &bytes(2, 0, 8 * n as u16, messages)).outbox)
    }

    /// Place and way of reception of a robot.
    fn known(&self, id: u32) -> Option<(i32, Trace)> {
        let mut all = self.robot.agent.link.table.all();
        all.find(|known| known.id == RobotId(id)).map(|known| (known.position.mm[0], known.trace))
    }
}

fn told_in(outbox: &[u8]) -> Option<LostRobot> {
    let said = outbox.split(|byte| *byte == 0).filter_map(|frame| Some(decode(frame).ok()?.message));
    said.filter_map(|said| if let Message::Lost(told) = said { Some(told) } else { None }).next()
}

/// Near robot 1, far enough for any motion.
fn near() -> Message {
    body_at([-3000, 0], [0, 0], Mode::Idle)
}

fn told(id: u32, is_lost: bool, age_cs: u16, x_mm: i32) -> Message {
    Message::Lost(LostRobot { id: RobotId(id), is_lost, age_cs, position_mm: [x_mm, 100, 0], radius_mm: 200 })
}

#[test]
fn the_newest_state_of_a_robot_counts_whoever_tells_it() {
    let mut pair = Pair::new(&in_plane(1));
    pair.hear(0, &[near(), told(3, false, 20, 1000)]);
    assert_eq!(pair.known(3), Some((1000, Trace::Told)));
    pair.hear(1, &[near(), told(3, false, 60, 1100)]);
    assert_eq!(pair.known(3), Some((1000, Trace::Told)), "older");
    pair.hear(2, &[near(), told(3, false, 1, 1200)]);
    assert_eq!(pair.known(3), Some((1200, Trace::Told)), "newer");
    // Its own beacon, then a newer state of it.
    let _ = pair.robot.step(step_number(3), &bytes(3, 0, 9, &[body_at([1300, 100], [0, 0], Mode::Cruise)]));
    assert_eq!(pair.known(3), Some((1300, Trace::Heard)));
    pair.next = 4;
    pair.hear(12, &[near(), told(3, false, 2, 1400)]);
    assert_eq!(pair.known(3), Some((1400, Trace::Told)));
    // A robot in contact is not lost because another robot has lost it.
    pair.hear(14, &[near(), told(3, true, 1, 1500)]);
    assert_eq!(pair.known(3), Some((1400, Trace::Told)));
    pair.hear(90, &[near()]);
    assert_eq!(pair.known(3), Some((1400, Trace::Lost)));
    pair.hear(91, &[near(), told(3, true, 1, 1600)]);
    assert_eq!(pair.known(3), Some((1600, Trace::Lost)));
    pair.hear(92, &[near(), told(3, true, 200, 1700)]);
    assert_eq!(pair.known(3), Some((1600, Trace::Lost)), "older");
    pair.hear(100, &[near(), told(3, false, 2, 1800)]);
    assert_eq!(pair.known(3), Some((1800, Trace::Told)), "it lives");
}

#[test]
fn an_operator_clears_the_place_of_a_lost_robot_only() {
    let clear =
        |id| Message::Lost(LostRobot { id: RobotId(id), is_lost: false, age_cs: 0, position_mm: [0; 3], radius_mm: 0 });
    let mut pair = Pair::new(&in_plane(1));
    pair.hear(0, &[near(), told(3, true, 50, 5000)]);
    pair.hear(1, &[near(), clear(3), clear(2), clear(4)]);
    assert_eq!([2, 3, 4].map(|id| pair.known(id).is_some()), [true, false, false]);
}

#[test]
fn some_states_are_never_stored() {
    let plausibility = PlausibilityLimits { last: RobotId(20), ..PlausibilityLimits::<f32>::ANY };
    let mut pair = Pair::new(&AgentConfig { plausibility, ..in_plane(1) });
    let twice = |x_mm| bytes(5, 0, (x_mm / 100) as u16, &[body_at([x_mm, 0], [0, 0], Mode::Cruise)]);
    let _ = pair.robot.step(step_number(0), &twice(4000));
    let _ = pair.robot.step(step_number(1), &twice(-8000));
    let _ = pair.robot.step(step_number(2), &bytes(6, 0, 0, &[body_at([2000, 0], [0, 0], Mode::Cruise)]));
    pair.next = 3;
    // The own id, one of two robots, an unknown one out of reach, beyond the last id, none, and one
    // that cannot have come there.
    let messages = [told(1, false, 1, 100), told(5, false, 1, 2100), told(7, false, 1, 7500), told(21, false, 1, 100)];
    pair.hear(10, &[&[near()][..], &messages, &[told(0, false, 1, 100), told(6, false, 1, -6500)]].concat());
    let places = [1, 5, 6, 7, 21, 0].map(|id| pair.known(id).map(|(x_mm, _)| x_mm));
    assert_eq!(places, [None, Some(4000), Some(2000), None, None, None]);
    // A lost robot that lives out of reach is elsewhere.
    pair.hear(11, &[near(), told(7, true, 50, 1000)]);
    assert!(pair.known(7).is_some());
    pair.hear(12, &[near(), told(7, false, 1, 7500)]);
    assert_eq!(pair.known(7), None);
}

#[test]
fn an_old_state_is_answered_unless_another_robot_has() {
    let next_after = |messages: &[Message]| {
        let mut pair = Pair::new(&in_plane(1));
        let fresh: Vec<_> = [&[near()][..], &(3..9).map(|id| told(id, false, 1, 2000)).collect::<Vec<_>>()].concat();
        let mut last = None;
        let mut n = 0;
        while last != Some(5) {
            last = pair.hear(n, &fresh).map(|told| told.id.0).or(last);
            n += 1;
        }
        let mut next = pair.hear(n, &[&fresh, messages].concat());
        let mut others = fresh.clone();
        others.remove(1);
        for said in [&others, &fresh, &fresh, &fresh] {
            n += 1;
            next = next.or(pair.hear(n, said));
        }
        next.map(|told| (told.id.0, told.is_lost))
    };
    assert_eq!(next_after(&[]), Some((6, false)), "in turn");
    assert_eq!(next_after(&[told(3, true, 90, 2000)]), Some((3, false)));
    assert_eq!(next_after(&[told(3, false, 90, 2000)]), Some((3, false)));
    assert_eq!(next_after(&[told(3, true, 20, 2000)]), Some((6, false)), "it is not old");
    assert_eq!(next_after(&[told(3, true, 90, 2000), told(3, false, 2, 2000)]), Some((6, false)), "answered");
}

#[test]
fn states_are_told_in_turn_and_silent_robots_every_other_time() {
    let mut pair = Pair::new(&in_plane(1));
    let far = |id| told(id, true, 300, 5000 + 1000 * id as i32);
    pair.hear(0, &[near(), far(3), far(4), told(5, false, 1, 2000)]);
    let mut said = Vec::new();
    for n in 1..60 {
        let others = [near(), told(5, false, 1, 2000)];
        said.extend(pair.hear(n, &others).map(|told| (n, told.id.0, told.is_lost)));
    }
    // Behind each beacon first: it has just started.
    said.drain(..4);
    let times: Vec<i32> = said.windows(2).map(|pair| pair[1].0 - pair[0].0).collect();
    assert!(times.iter().all(|&time| time == 2), "{times:?}");
    let ids: Vec<u32> = said.iter().map(|told| told.1).collect();
    for pair in ids.chunks_exact(2) {
        assert!(pair.iter().any(|id| [3, 4].contains(id)), "{ids:?}");
    }
    for id in 2..6 {
        assert!(ids.iter().filter(|told| **told == id).count() >= 3, "{ids:?}");
    }
    assert!(said.iter().all(|told| told.2 == [3, 4].contains(&told.1)));
}

#[test]
fn near_robots_are_told_more_often() {
    let mut pair = Pair::new(&in_plane(1));
    let place = |id: u32| told(id, false, 1, if id < 7 { 300 + 100 * id as i32 } else { 1300 + 100 * id as i32 });
    let mut said = Vec::new();
    for n in 0..800 {
        let others: Vec<Message> = (3..10).map(place).collect();
        said.extend(pair.hear(n, &[&[near()][..], &others].concat()).map(|told| told.id.0));
    }
    let times = |id: u32| said.iter().filter(|told| **told == id).count();
    let far = (7..10).map(times);
    // No robot is silent, so every fourth beacon has a state.
    assert!((190..=210).contains(&said.len()), "{}", said.len());
    assert!(far.clone().min() >= Some(6), "{:?}", far.collect::<Vec<_>>());
    for id in 3..7 {
        assert!(far.clone().all(|far| times(id) > 2 * far), "{id}: {said:?}");
    }
}

#[test]
fn a_robot_that_finds_others_late_listens_longer() {
    let contact_loss = ContactLossPolicy { listen: STEP.saturating_mul(3), ..ContactLossPolicy::DEFAULT };
    // From some steps on robot 1 hears other robots; in one it hears of another one.
    let start = |found: &[(i32, u32)], told_at: i32| {
        let mut pair = Pair::new(&AgentConfig { contact_loss, ..in_plane(1) });
        let is_over = |n: &i32| {
            let ids = found.iter().filter(|(step, _)| step <= n).map(|(_, id)| *id);
            let heard =
                ids.flat_map(|id| bytes(id, 0, *n as u16, &[body_at([-400 * id as i32, 0], [0, 0], Mode::Idle)]));
            let told = (*n == told_at).then(|| bytes(2, 0, *n as u16, &[near(), told(3, false, 1, -2000)]));
            let _ = pair.robot.step(step_number(*n), &heard.chain(told.into_iter().flatten()).collect::<Vec<_>>());
            matches!(pair.robot.agent.link.listening, Listening::Over(_))
        };
        (0..200).find(is_over).unwrap()
    };
    assert_eq!(start(&[], 200), 3);
    assert_eq!(start(&[(1, 5)], 200), 4, "three steps after it has found one");
    assert_eq!(start(&[(1, 5), (3, 6)], 200), 6);
    assert_eq!(start(&[(2, 5), (4, 6)], 200), 8, "as long as the search took");
    let all = [2, 4, 7, 13, 25, 49].map(|n| (n, 4 + n as u32));
    assert_eq!(start(&all, 200), 50, "not for ever");
    assert_eq!(start(&[], 2), 2 + 6 * 3, "six times as long while others tell of one that it does not hear");
}

#[test]
fn a_robot_that_others_do_not_hear_notices() {
    // Robot 2, three metres to the west of robot 1, tells of one robot.
    let hear = |pair: &mut Pair, times: i32, (id, age_cs, x_mm): (u32, u16, i32)| {
        let mut speed = 0.0;
        for _ in 0..times {
            // It starts, whatever it does.
            (pair.robot.at_m, pair.robot.velocity_mps) = ([0.0; 2], [0.0; 2]);
            pair.hear(pair.next, &[near(), told(id, false, age_cs, x_mm)]);
            speed = pair.robot.speed();
        }
        (pair.robot.agent.link.hearing(), speed > 0.0)
    };
    let start = || {
        let mut pair = Pair::new(&in_plane(1));
        let _ = pair.robot.agent.order(&WaypointOrder::first(place(0, 90_000)));
        pair
    };
    let mut pair = start();
    assert_eq!(hear(&mut pair, 40, (3, 1, -1500)), (Hearing::Heard, true), "it may have forgotten the own robot");
    let mut pair = start();
    let farther = (3, 1, 3000);
    assert_eq!(hear(&mut pair, 6, farther), (Hearing::Unclear, false), "it listens");
    assert_eq!(hear(&mut pair, 1, farther), (Hearing::Never, true), "three times for each of two robots");
    assert_eq!(hear(&mut pair, 1, (1, 200, 0)), (Hearing::Never, true), "heard long ago");
    assert_eq!(hear(&mut pair, 1, (1, 2, 0)), (Hearing::Heard, true));
    assert_eq!(hear(&mut pair, 30, farther), (Hearing::Heard, true), "it was heard once");
}

#[test]
fn a_robot_that_is_lost_for_others_stands_until_one_hears_it() {
    // Robot 2 tells of robot 1 or 3, and whether that is lost.
    let hear = |pair: &mut Pair, times: i32, (id, is_lost, age_cs): (u32, bool, u16)| {
        for _ in 0..times {
            (pair.robot.at_m, pair.robot.velocity_mps) = ([0.0; 2], [0.0; 2]);
            let x_mm = if id == 1 { 0 } else { -9000 };
            pair.hear(pair.next, &[near(), told(id, is_lost, age_cs, x_mm)]);
        }
        (pair.robot.agent.link.hearing(), pair.robot.speed() > 0.0)
    };
    let mut pair = Pair::new(&in_plane(1));
    let _ = pair.robot.agent.order(&WaypointOrder::first(place(0, 90_000)));
    let lost = (1, true, 90);
    assert_eq!(hear(&mut pair, 9, lost), (Hearing::Heard, true), "before a restart it was lost");
    assert_eq!(hear(&mut pair, 1, (1, false, 2)), (Hearing::Heard, true));
    assert_eq!(hear(&mut pair, 2, lost), (Hearing::Heard, true), "another one may correct it");
    assert_eq!(hear(&mut pair, 1, (1, false, 2)), (Hearing::Heard, true), "and does");
    assert_eq!(hear(&mut pair, 2, lost), (Hearing::Heard, true));
    assert_eq!(hear(&mut pair, 9, (3, true, 90)), (Hearing::Heard, true), "a third one is lost");
    assert_eq!(hear(&mut pair, 1, lost), (Hearing::NoLonger, false));
    assert_eq!(hear(&mut pair, 20, (3, false, 2)), (Hearing::NoLonger, false));
    assert_eq!(hear(&mut pair, 1, (1, false, 2)), (Hearing::Heard, true));
    // Alone it need not stand.
    assert_eq!(hear(&mut pair, 3, lost), (Hearing::NoLonger, false));
    for n in pair.next..pair.next + 100 {
        let _ = pair.robot.step(step_number(n), &[]);
    }
    assert_eq!(pair.robot.agent.link.hearing(), Hearing::Heard);
}

#[test]
fn a_robot_listens_until_others_tell_of_it() {
    let contact_loss = ContactLossPolicy { listen: STEP.saturating_mul(3), ..ContactLossPolicy::DEFAULT };
    let start = |told_at: i32| {
        let mut pair = Pair::new(&AgentConfig { contact_loss, ..in_plane(1) });
        let is_over = |n: &i32| {
            let third = bytes(3, 0, *n as u16, &[body_at([1000, 0], [0, 0], Mode::Idle)]);
            let id = if *n == told_at { 1 } else { 3 };
            let second = bytes(2, 0, 8 * *n as u16, &[near(), told(id, false, 1, 1000)]);
            let _ = pair.robot.step(step_number(*n), &[third, second].concat());
            matches!(pair.robot.agent.link.listening, Listening::Over(_))
        };
        (0..200).find(is_over).unwrap()
    };
    assert_eq!(start(0), 3, "no doubt");
    assert_eq!(start(5), 5, "told of");
    assert_eq!(start(200), 6, "it is not heard at all");
}
