//! Two robots that exchange requests over a radio that loses, duplicates and reorders packets,
//! while either robot may restart at any time.

use arbitrary::{Result, Unstructured};
use heapless::Vec as Bounded;
use staya_controller::robot::RobotId;
use staya_controller::time::{Duration, Instant};
use staya_controller::wire::{
    Arrival, Due, Header, MAX_FRAME_LEN, Message, Orders, Request, RequestKind, Requests, Retry, SequenceWindow,
    decode, encode,
};
use std::collections::BTreeMap;

/// Two origins, with standing requests and direction requests of each.
const LINES: usize = 4;
const DELAY_MS: i32 = 500;
/// Longer than all attempts of a request and the delay of the last one.
const MEMORY: Duration = Duration::from_millis(5_000);
/// Long enough that sequence numbers do not wrap while packets are in the air.
const STEP_MS: i32 = 100;
const GRAIN_MS: i32 = 10;
const SILENCE_MS: i32 = 3_000;

struct Packet {
    to: usize,
    sent_ms: i32,
    bytes: Vec<u8>,
    /// The request that the frame carries or acknowledges, in the order of asking.
    place: usize,
}

struct Asked {
    request: Request,
    sends: u32,
    was_delivered: bool,
    /// Acknowledged, replaced, expired, or lost when its sender rebooted.
    ends: u32,
}

struct Line {
    boot: u8,
    place: usize,
    kind: RequestKind,
    until_ms: i32,
}

struct Robot {
    id: RobotId,
    boot: u8,
    sequence: u16,
    requests: Requests<LINES>,
    orders: Orders<LINES>,
    window: SequenceWindow,
    /// All requests of this robot, across restarts.
    asked: Vec<Asked>,
    pending: BTreeMap<u8, usize>,
    /// Model: by origin and whether they are standing.
    lines: BTreeMap<(RobotId, bool), Line>,
    heard_ms: i32,
}

impl Robot {
    fn new(id: u32) -> Self {
        Self {
            id: RobotId(id),
            boot: 0,
            sequence: 0,
            requests: Requests::new(RobotId(id), 0, Retry::default()),
            orders: Orders::new(MEMORY),
            window: SequenceWindow::new(),
            asked: Vec::new(),
            pending: BTreeMap::new(),
            lines: BTreeMap::new(),
            heard_ms: 0,
        }
    }

    fn reboot(&mut self, sequence: u16) {
        for place in std::mem::take(&mut self.pending).into_values() {
            self.asked[place].ends += 1;
        }
        self.boot = self.boot.wrapping_add(1);
        self.sequence = sequence;
        self.requests = Requests::new(self.id, self.boot, Retry::default());
        self.orders = Orders::new(MEMORY);
        self.window = SequenceWindow::new();
        self.lines.clear();
    }

    fn ask(&mut self, to: RobotId, origin: RobotId, kind: RequestKind, valid_ms: u16, now: Instant) {
        let same_matter =
            |request: &Request| request.origin == origin && request.kind.is_standing() == kind.is_standing();
        let older = self
            .pending
            .iter()
            .map(|(number, place)| (*number, *place))
            .find(|(_, place)| same_matter(&self.asked[*place].request));
        let number = self.requests.ask(to, origin, kind, valid_ms, now).expect("every matter has a place");
        if let Some((older_number, place)) = older {
            if self.asked[place].request.kind == kind {
                assert_eq!(number, older_number);
                return;
            }
            self.asked[place].ends += 1;
            self.pending.remove(&older_number);
        }
        let taken = self.pending.insert(number, self.asked.len());
        assert_eq!(taken, None, "number {number} was on its way");
        self.asked.push(Asked {
            request: Request { to, origin, number, kind, valid_ms },
            sends: 0,
            was_delivered: false,
            ends: 0,
        });
    }

    fn poll(&mut self, to: usize, now_ms: i32, now: Instant, air: &mut Vec<Packet>) {
        while let Some(due) = self.requests.poll(now) {
            let (Due::Send(request) | Due::Expired(request)) = due;
            let place = self.pending[&request.number];
            let asked = &mut self.asked[place];
            assert_eq!(asked.request, request);
            if let Due::Expired(_) = due {
                assert!(asked.sends > 0);
                asked.ends += 1;
                self.pending.remove(&request.number);
                continue;
            }
            asked.sends += 1;
            assert!(asked.sends <= u32::from(Retry::default().attempts));
            let bytes = self.encoded(Message::Request(request));
            air.push(Packet { to, sent_ms: now_ms, bytes, place });
        }
        assert_eq!(self.requests.len(), self.pending.len());
    }

    fn encoded(&mut self, message: Message) -> Vec<u8> {
        self.sequence = self.sequence.wrapping_add(1);
        let header = Header { boot: self.boot, sender: self.id, sequence: self.sequence };
        let mut out = Bounded::<u8, MAX_FRAME_LEN>::new();
        encode(header, &message, &mut out).expect("every message fits");
        out[..out.len() - 1].to_vec()
    }

    fn receive(&mut self, packet: &Packet, peer: &mut Self, now_ms: i32, now: Instant) -> Option<Vec<u8>> {
        let frame = decode(&packet.bytes).expect("the radio damages nothing here");
        let arrival = self.window.check(frame.header);
        if arrival == Arrival::Rebooted {
            self.orders.forget(frame.header.sender);
            self.lines.clear();
        }
        // The request layer must tolerate duplicates too.
        if matches!(arrival, Arrival::PreviousBoot | Arrival::TooOld) {
            return None;
        }
        if arrival.is_accepted() {
            self.heard_ms = now_ms;
        }
        match frame.message {
            Message::Request(request) => {
                let (accepted, is_new) = self.expected_answer(frame.header, &request, packet.place, now_ms);
                let answer = self.orders.receive(frame.header, &request, now);
                assert_eq!((answer.ack.accepted, answer.is_new), (accepted, is_new));
                peer.asked[packet.place].was_delivered = true;
                Some(self.encoded(Message::Ack(answer.ack)))
            }
            Message::Ack(ack) => {
                assert_eq!(ack.to, self.id);
                let ended = self.requests.acknowledged(frame.header.sender, &ack);
                let is_pending = self.pending.contains_key(&ack.number);
                assert_eq!(ended.is_some(), is_pending && ack.boot == self.boot);
                if ended.is_some() {
                    let place = self.pending.remove(&ack.number);
                    assert_eq!(place, Some(packet.place), "another request was meant");
                    let asked = &mut self.asked[packet.place];
                    assert!(asked.was_delivered);
                    asked.ends += 1;
                }
                None
            }
            other => panic!("{other:?} was never sent"),
        }
    }

    /// Returns whether the request is accepted and whether it is unknown.
    fn expected_answer(&mut self, header: Header, request: &Request, place: usize, now_ms: i32) -> (bool, bool) {
        let matter = (request.origin, request.kind.is_standing());
        let line = self.lines.get(&matter);
        match line.filter(|line| line.boot == header.boot) {
            Some(line) if place <= line.place => return (place == line.place, false),
            _ => {}
        }
        self.lines.insert(
            matter,
            Line { boot: header.boot, place, kind: request.kind, until_ms: now_ms + i32::from(request.valid_ms) },
        );
        (true, true)
    }

    fn check(&mut self, now_ms: i32, now: Instant) {
        let until = self
            .lines
            .values()
            .filter(|line| line.kind == RequestKind::Stop && now_ms < line.until_ms)
            .map(|line| line.until_ms - now_ms)
            .max();
        assert_eq!(self.orders.is_stopped(now), until.is_some());
        let last = self.orders.stopped_until(now).map(|until| until.since(now));
        assert_eq!(last, until.map(Duration::from_millis));
        let is_due = |due: Instant| !now.is_before(due);
        assert!(!self.requests.poll_at(now).is_some_and(is_due));
        if now_ms - self.heard_ms > SILENCE_MS {
            self.window = SequenceWindow::new();
        }
    }
}

struct World {
    robots: [Robot; 2],
    air: Vec<Packet>,
    start: Instant,
    now_ms: i32,
}

impl World {
    fn now(&self) -> Instant {
        self.start + Duration::from_millis(self.now_ms)
    }

    /// Simulates only the steps in which something can happen and those right before.
    fn pass(&mut self, span_ms: i32) {
        let end_ms = self.now_ms + span_ms / GRAIN_MS * GRAIN_MS;
        while self.now_ms < end_ms {
            let next_ms = self.next_ms().map_or(end_ms, |next_ms| next_ms.min(end_ms));
            if next_ms - GRAIN_MS > self.now_ms {
                self.now_ms = next_ms - GRAIN_MS;
                let (now_ms, now) = (self.now_ms, self.now());
                for robot in &mut self.robots {
                    assert_eq!(robot.requests.poll(now), None, "due before it said");
                    robot.check(now_ms, now);
                }
            }
            self.now_ms = next_ms;
            let (now_ms, now) = (self.now_ms, self.now());
            self.air.retain(|packet| now_ms - packet.sent_ms < DELAY_MS);
            for (which, robot) in self.robots.iter_mut().enumerate() {
                robot.poll(1 - which, now_ms, now, &mut self.air);
                robot.check(now_ms, now);
            }
        }
    }

    fn next_ms(&self) -> Option<i32> {
        let now = self.now();
        let moments = self.robots.iter().flat_map(|robot| {
            let due = robot.requests.poll_at(now).map(|due| {
                let left_us = due.since(now).as_micros();
                self.now_ms + (left_us + GRAIN_MS * 1000 - 1) / 1000 / GRAIN_MS * GRAIN_MS
            });
            let ends = robot.lines.values().map(|line| line.until_ms);
            due.into_iter().chain(ends.filter(|until_ms| *until_ms > self.now_ms))
        });
        moments.map(|moment| moment.max(self.now_ms + GRAIN_MS)).min()
    }

    fn deliver(&mut self, which: usize, keep: bool) {
        let (now_ms, now) = (self.now_ms, self.now());
        let packet = self.air.swap_remove(which);
        let [a, b] = &mut self.robots;
        let (robot, peer) = if packet.to == 0 { (a, b) } else { (b, a) };
        if let Some(bytes) = robot.receive(&packet, peer, now_ms, now) {
            self.air.push(Packet { to: 1 - packet.to, sent_ms: now_ms, bytes, place: packet.place });
        }
        robot.check(now_ms, now);
        if keep {
            self.air.push(packet);
        }
    }

    fn act(&mut self, choice: &mut Unstructured<'_>) -> Result<()> {
        match choice.int_in_range(0..=7_u8)? {
            0 | 1 => {
                let bits: u8 = choice.arbitrary()?;
                let which = usize::from(bits & 1);
                let kind = match bits >> 1 & 3 {
                    0 | 1 => RequestKind::Stop,
                    2 => RequestKind::Resume,
                    _ => RequestKind::Redirect,
                };
                let origin = RobotId(10 + u32::from(bits >> 3 & 1));
                let valid_ms = u16::from(choice.arbitrary::<u8>()?) * 20;
                let (to, now) = (self.robots[1 - which].id, self.now());
                self.robots[which].ask(to, origin, kind, valid_ms, now);
                self.pass(STEP_MS);
            }
            2 => self.pass(i32::from(choice.arbitrary::<u8>()?) * 10),
            3 => {
                let which = usize::from(choice.arbitrary::<bool>()?);
                self.robots[which].reboot(choice.arbitrary()?);
                // The air holds frames of at most two lives of one robot.
                self.pass(DELAY_MS / 2 + 10);
            }
            4 if !self.air.is_empty() => {
                self.air.swap_remove(choice.choose_index(self.air.len())?);
            }
            keep @ 4..=7 if !self.air.is_empty() => {
                self.deliver(choice.choose_index(self.air.len())?, keep == 7);
            }
            _ => self.pass(10),
        }
        Ok(())
    }

    fn end(&mut self) {
        self.pass(10_000);
        for robot in &mut self.robots {
            assert!(robot.requests.is_empty() && robot.pending.is_empty());
            assert!(robot.asked.iter().all(|asked| asked.ends == 1));
            assert!(!robot.orders.is_stopped(self.start + Duration::from_millis(self.now_ms)));
        }
        for kind in [RequestKind::Stop, RequestKind::Resume] {
            for which in [0, 1] {
                let (to, now) = (self.robots[1 - which].id, self.now());
                self.robots[which].ask(to, RobotId(10), kind, 60_000, now);
            }
            self.pass(10);
            while !self.air.is_empty() {
                self.deliver(0, false);
            }
            let now = self.now();
            for robot in &mut self.robots {
                assert!(robot.requests.is_empty());
                assert_eq!(robot.orders.is_stopped(now), kind == RequestKind::Stop);
            }
        }
    }
}

/// Executes the actions that the bytes describe and compares both robots with a model at each step.
pub fn requests_model(bytes: &[u8]) {
    let mut choice = Unstructured::new(bytes);
    let start = Instant::from_micros(choice.arbitrary().unwrap_or_default());
    let mut world = World { robots: [Robot::new(1), Robot::new(2)], air: Vec::new(), start, now_ms: 0 };
    while !choice.is_empty() && world.act(&mut choice).is_ok() {}
    world.end();
}

#[cfg(test)]
mod tests {
    use super::*;

    fn world() -> World {
        World { robots: [Robot::new(1), Robot::new(2)], air: Vec::new(), start: Instant::default(), now_ms: 0 }
    }

    fn ask(world: &mut World, kind: RequestKind) {
        let now = world.now();
        world.robots[0].ask(RobotId(2), RobotId(1), kind, 1_000, now);
        world.pass(10);
    }

    #[test]
    fn late_acknowledgement_from_before_a_reboot_ends_no_request() {
        // Around the number of requests at which the numbers of both lives meet.
        for requests in 90..=100 {
            let mut world = world();
            for _ in 0..requests {
                ask(&mut world, RequestKind::Redirect);
                world.pass(STEP_MS);
                world.deliver(0, false);
                world.air.truncate(1);
                world.deliver(0, false);
                world.air.clear();
            }
            ask(&mut world, RequestKind::Stop);
            world.deliver(0, false);
            world.robots[0].reboot(0);
            world.pass(DELAY_MS / 2 + 10);
            ask(&mut world, RequestKind::Stop);
            while !world.air.is_empty() {
                let oldest = (0..world.air.len()).min_by_key(|at| world.air[*at].sent_ms);
                world.deliver(oldest.unwrap_or(0), false);
            }
            world.end();
        }
    }
}
