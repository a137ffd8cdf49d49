//! Two robots that exchange messages over a radio that loses, duplicates and reorders packets,
//! while either robot may restart at any time. The messages are those of laws on the grid.

use arbitrary::{Result, Unstructured};
use heapless::Vec as Bounded;
use staya_controller::agent::{Grid, GridMessage, GridTask, Outgoing, Protocol as _, Radio};
use staya_controller::robot::RobotId;
use staya_controller::time::{Duration, Instant};
use staya_controller::wire::{
    Ack, Arrival, Content as _, Due, Header, IncomingMessages, MAX_FRAME_LEN, Message, OutgoingMessages, Retry,
    SequenceWindow, decode, encode,
};
use std::collections::BTreeMap;

/// Redirections, and the stops of two origins.
const SUBJECTS: usize = 3;
const DELAY_MS: i32 = 500;
/// Longer than all attempts of a message and the delay of the last one.
const MEMORY: Duration = Duration::from_millis(5_000);
/// Long enough that sequence numbers do not wrap while packets are in the air.
const STEP_MS: i32 = 100;
const GRAIN_MS: i32 = 10;
const SILENCE_MS: i32 = 3_000;

struct Packet {
    to: usize,
    sent_ms: i32,
    bytes: Vec<u8>,
    /// The message that the frame carries or acknowledges, in the order of sending.
    place: usize,
}

struct Said {
    message: GridMessage,
    number: Option<u8>,
    sends: u32,
    was_acknowledged: bool,
    /// Acknowledged, replaced, expired, or lost when its sender rebooted.
    ends: u32,
}

/// The newest message about a subject that the law took.
struct Newest {
    boot: u8,
    place: usize,
}

struct Robot {
    id: RobotId,
    boot: u8,
    sequence: u16,
    outgoing: OutgoingMessages<SUBJECTS>,
    incoming: IncomingMessages<SUBJECTS>,
    task: GridTask,
    window: SequenceWindow,
    /// All messages of this robot, across restarts.
    said: Vec<Said>,
    /// Model: the pending message about each subject.
    pending: BTreeMap<u32, usize>,
    /// Model: the newest message about each subject that the law took.
    newest: BTreeMap<u32, Newest>,
    /// Model: when the stop of each origin ends.
    stops_ms: BTreeMap<RobotId, i32>,
    heard_ms: i32,
}

impl Robot {
    fn new(id: u32) -> Self {
        Self {
            id: RobotId(id),
            boot: 0,
            sequence: 0,
            outgoing: OutgoingMessages::new(RobotId(id), 0, Retry::default()),
            incoming: IncomingMessages::new(MEMORY),
            task: GridTask::NEW,
            window: SequenceWindow::new(),
            said: Vec::new(),
            pending: BTreeMap::new(),
            newest: BTreeMap::new(),
            stops_ms: BTreeMap::new(),
            heard_ms: 0,
        }
    }

    fn reboot(&mut self, sequence: u16) {
        for place in std::mem::take(&mut self.pending).into_values() {
            self.said[place].ends += 1;
        }
        self.boot = self.boot.wrapping_add(1);
        self.sequence = sequence;
        self.outgoing = OutgoingMessages::new(self.id, self.boot, Retry::default());
        self.incoming = IncomingMessages::new(MEMORY);
        self.task = GridTask::NEW;
        self.window = SequenceWindow::new();
        self.newest.clear();
        self.stops_ms.clear();
    }

    fn say(&mut self, to: RobotId, message: GridMessage, valid_ms: u16, now: Instant) {
        let subject = Grid::subject(&message);
        let (protocol, content) = message.encode(Grid::ID).expect("every message fits");
        let valid = Duration::from_millis(valid_ms.into());
        let sent = self.outgoing.send(to, subject, (protocol, &content), valid, now);
        sent.expect("every subject has a place");
        if let Some(place) = self.pending.get(&subject) {
            if self.said[*place].message == message {
                return;
            }
            self.said[*place].ends += 1;
        }
        self.pending.insert(subject, self.said.len());
        self.said.push(Said { message, number: None, sends: 0, was_acknowledged: false, ends: 0 });
    }

    fn poll(&mut self, to: usize, now_ms: i32, now: Instant, air: &mut Vec<Packet>) {
        while let Some(due) = self.outgoing.poll(now) {
            let sent = match due {
                Due::Send(sent) => sent,
                Due::Expired(by) => {
                    self.expire(by);
                    continue;
                }
            };
            let message = GridMessage::decode(Grid::ID, sent.protocol, &sent.content).expect("it was encoded");
            let place = self.pending[&Grid::subject(&message)];
            let has_number = |other: &usize| *other != place && self.said[*other].number == Some(sent.number);
            assert!(!self.pending.values().any(has_number), "number {} was on its way", sent.number);
            let said = &mut self.said[place];
            assert_eq!(said.message, message);
            assert_eq!(*said.number.get_or_insert(sent.number), sent.number);
            said.sends += 1;
            assert!(said.sends <= u32::from(Retry::default().attempts));
            let bytes = self.encoded(Message::Law(sent));
            air.push(Packet { to, sent_ms: now_ms, bytes, place });
        }
        assert_eq!(self.outgoing.len(), self.pending.len());
    }

    /// One message is no longer pending although no acknowledgement by `by` arrived.
    fn expire(&mut self, by: RobotId) {
        let is_gone = |place: usize| {
            let number = self.said[place].number.expect("it was sent");
            let ack = Ack { to: self.id, boot: self.boot, number };
            !self.outgoing.clone().acknowledged(by, &ack)
        };
        let sent = self.pending.iter().filter(|(_, place)| self.said[**place].sends > 0);
        let gone: Vec<_> = sent.filter(|(_, place)| is_gone(**place)).map(|(subject, _)| *subject).collect();
        let [subject] = gone[..] else { panic!("{gone:?} expired at once") };
        let place = self.pending.remove(&subject).expect("it was pending");
        self.said[place].ends += 1;
    }

    fn encoded(&mut self, message: Message) -> Vec<u8> {
        self.sequence = self.sequence.wrapping_add(1);
        let header = Header { boot: self.boot, sender: self.id, sequence: self.sequence };
        let mut out = Bounded::<u8, MAX_FRAME_LEN>::new();
        encode(header, &message, &mut out).expect("every message fits");
        out[..out.len() - 1].to_vec()
    }

    /// `takes`: whether the law takes messages except repeats.
    fn receive(&mut self, packet: &Packet, takes: bool, peer: &mut Self, now_ms: i32, now: Instant) -> Option<Vec<u8>> {
        let frame = decode(&packet.bytes).expect("the radio damages nothing here");
        let header = frame.header;
        let arrival = self.window.check(header);
        if arrival == Arrival::Rebooted {
            self.incoming.forget(header.sender);
            self.newest.clear();
        }
        // The table of messages must tolerate duplicates too.
        if matches!(arrival, Arrival::PreviousBoot | Arrival::TooOld) {
            return None;
        }
        if arrival.is_accepted() {
            self.heard_ms = now_ms;
        }
        match frame.message {
            Message::Law(told) => {
                assert_eq!(told.to, self.id);
                let message = GridMessage::decode(Grid::ID, told.protocol, &told.content).expect("it was encoded");
                let subject = Grid::subject(&message);
                let is_repeat = self.incoming.is_repeat(header, told.number, subject, now);
                assert_eq!(is_repeat, self.expects_repeat(header, subject, packet.place));
                if !is_repeat && !takes {
                    return None;
                }
                if !is_repeat {
                    self.incoming.note(header, told.number, subject, now);
                    self.newest.insert(subject, Newest { boot: header.boot, place: packet.place });
                    self.obey(header.sender, &message, now_ms, now);
                }
                peer.said[packet.place].was_acknowledged = true;
                let ack = Ack { to: header.sender, boot: header.boot, number: told.number };
                Some(self.encoded(Message::Ack(ack)))
            }
            Message::Ack(ack) => {
                assert_eq!(ack.to, self.id);
                let ended = self.outgoing.acknowledged(header.sender, &ack);
                let is_meant = |place: &usize| self.said[*place].number == Some(ack.number);
                let pending = self.pending.iter().find(|(_, place)| is_meant(place)).map(|(subject, _)| *subject);
                assert_eq!(ended, pending.is_some() && ack.boot == self.boot);
                if ended {
                    let place = pending.and_then(|subject| self.pending.remove(&subject));
                    assert_eq!(place, Some(packet.place), "another message was meant");
                    let said = &mut self.said[packet.place];
                    assert!(said.was_acknowledged);
                    said.ends += 1;
                }
                None
            }
            other => panic!("{other:?} was never sent"),
        }
    }

    /// Returns whether the law took this message, or a later one about its subject.
    fn expects_repeat(&self, header: Header, subject: u32, place: usize) -> bool {
        let newest = self.newest.get(&subject).filter(|newest| newest.boot == header.boot);
        newest.is_some_and(|newest| place <= newest.place)
    }

    fn obey(&mut self, from: RobotId, message: &GridMessage, now_ms: i32, now: Instant) {
        self.task.receive(from, message, &mut Radio::new(now, Duration::ZERO, &mut Outgoing::default()));
        match *message {
            GridMessage::Stop { origin, valid_ms } => {
                self.stops_ms.insert(origin, now_ms + i32::from(valid_ms));
            }
            GridMessage::Resume { origin } => drop(self.stops_ms.remove(&origin)),
            GridMessage::Redirect | GridMessage::Land(_) => {}
        }
    }

    fn check(&mut self, now_ms: i32, now: Instant) {
        let last_ms = self.stops_ms.values().copied().filter(|until_ms| now_ms < *until_ms).max();
        assert_eq!(self.task.is_stopped(now), last_ms.is_some());
        if let Some(last_ms) = last_ms {
            let last = self.task.stopped_until().map(|until| until.since(now));
            assert_eq!(last, Some(Duration::from_millis(last_ms - now_ms)));
        }
        let is_due = |due: Instant| !now.is_before(due);
        assert!(!self.outgoing.poll_at(now).is_some_and(is_due));
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
                    assert_eq!(robot.outgoing.poll(now), None, "due before it said");
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
            let due = robot.outgoing.poll_at(now).map(|due| {
                let left_us = due.since(now).as_micros();
                self.now_ms + (left_us + GRAIN_MS * 1000 - 1) / 1000 / GRAIN_MS * GRAIN_MS
            });
            let ends = robot.stops_ms.values().copied();
            due.into_iter().chain(ends.filter(|until_ms| *until_ms > self.now_ms))
        });
        moments.map(|moment| moment.max(self.now_ms + GRAIN_MS)).min()
    }

    fn deliver(&mut self, which: usize, keep: bool, takes: bool) {
        let (now_ms, now) = (self.now_ms, self.now());
        let packet = self.air.swap_remove(which);
        let [a, b] = &mut self.robots;
        let (robot, peer) = if packet.to == 0 { (a, b) } else { (b, a) };
        if let Some(bytes) = robot.receive(&packet, takes, peer, now_ms, now) {
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
                let origin = RobotId(10 + u32::from(bits >> 3 & 1));
                // Equal messages are frequent.
                let valid_ms = u16::from(choice.arbitrary::<u8>()? >> 5) * 700;
                let message = match bits >> 1 & 3 {
                    0 | 1 => GridMessage::Stop { origin, valid_ms },
                    2 => GridMessage::Resume { origin },
                    _ => GridMessage::Redirect,
                };
                let (to, now) = (self.robots[1 - which].id, self.now());
                self.robots[which].say(to, message, valid_ms, now);
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
            what @ 4..=7 if !self.air.is_empty() => {
                self.deliver(choice.choose_index(self.air.len())?, what == 7, what != 6);
            }
            _ => self.pass(10),
        }
        Ok(())
    }

    fn end(&mut self) {
        self.pass(10_000);
        let now = self.now();
        for robot in &self.robots {
            assert!(robot.outgoing.is_empty() && robot.pending.is_empty());
            assert!(robot.said.iter().all(|said| said.ends == 1));
            assert!(!robot.task.is_stopped(now));
        }
        let (origin, valid_ms) = (RobotId(10), 60_000);
        for message in [GridMessage::Stop { origin, valid_ms }, GridMessage::Resume { origin }] {
            for which in [0, 1] {
                let (to, now) = (self.robots[1 - which].id, self.now());
                self.robots[which].say(to, message.clone(), valid_ms, now);
            }
            self.pass(10);
            while !self.air.is_empty() {
                self.deliver(0, false, true);
            }
            let now = self.now();
            let is_stop = matches!(message, GridMessage::Stop { .. });
            for robot in &self.robots {
                assert!(robot.outgoing.is_empty());
                assert_eq!(robot.task.is_stopped(now), is_stop);
            }
        }
    }
}

/// Executes the actions that the bytes describe and compares both robots with a model at each step.
pub fn messages_model(bytes: &[u8]) {
    let mut choice = Unstructured::new(bytes);
    let start = Instant::from_micros(choice.arbitrary().unwrap_or_default());
    let mut world = World { robots: [Robot::new(1), Robot::new(2)], air: Vec::new(), start, now_ms: 0 };
    while !choice.is_empty() && world.act(&mut choice).is_ok() {}
    world.end();
}

#[cfg(test)]
mod tests {
    use super::*;

    const STOP: GridMessage = GridMessage::Stop { origin: RobotId(10), valid_ms: 1_000 };

    fn world() -> World {
        World { robots: [Robot::new(1), Robot::new(2)], air: Vec::new(), start: Instant::default(), now_ms: 0 }
    }

    fn say(world: &mut World, message: GridMessage) {
        let now = world.now();
        world.robots[0].say(RobotId(2), message, 1_000, now);
        world.pass(10);
    }

    #[test]
    fn late_acknowledgement_from_before_a_reboot_ends_no_message() {
        // Around the number of messages at which the numbers of both lives meet.
        for messages in 90..=100 {
            let mut world = world();
            for _ in 0..messages {
                say(&mut world, GridMessage::Redirect);
                world.pass(STEP_MS);
                world.deliver(0, false, true);
                world.air.truncate(1);
                world.deliver(0, false, true);
                world.air.clear();
            }
            say(&mut world, STOP);
            world.deliver(0, false, true);
            world.robots[0].reboot(0);
            world.pass(DELAY_MS / 2 + 10);
            say(&mut world, STOP);
            while !world.air.is_empty() {
                let oldest = (0..world.air.len()).min_by_key(|at| world.air[*at].sent_ms);
                world.deliver(oldest.unwrap_or(0), false, true);
            }
            world.end();
        }
    }
}
