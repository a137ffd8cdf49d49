use crate::message::{StepInputs, StepResult};
use crate::port::{Event, Limits, Next, Port, PortError};
use crate::robot::Controller;
use crate::session::{About, Reaction, Session};
use crate::tests::{ABOUT, LARGE};
use staya_controller::agent::{Setup, Task};
use staya_controller::rand::Rng;
use std::vec::Vec;

pub const LIMITS: Limits = Limits { resend_after_us: 20_000, give_up_after_us: 1_200_000 };

/// Probabilities in percent.
#[derive(Clone, Copy, Debug, Default)]
pub struct Faults {
    pub lost: u32,
    pub repeated: u32,
    pub flipped: u32,
    pub cut: u32,
    /// Frames may overtake each other.
    pub delay_us: u32,
}

pub struct Line {
    pub faults: Faults,
    rng: Rng,
    pub on_the_way: Vec<(u64, Vec<u8>)>,
}

impl Line {
    pub fn new(faults: Faults, seed: u64) -> Self {
        Self { faults, rng: Rng::new(seed), on_the_way: Vec::new() }
    }

    fn happens(&mut self, percent: u32) -> bool {
        self.rng.below(100) < percent
    }

    pub fn send(&mut self, frame: &[u8], now: u64) {
        let faults = self.faults;
        let copies = 1 + usize::from(self.happens(faults.repeated));
        for _ in 0..copies {
            if self.happens(faults.lost) {
                continue;
            }
            let mut bytes = frame.to_vec();
            if self.happens(faults.flipped) {
                let at = self.rng.below(bytes.len() as u32) as usize;
                bytes[at] ^= 1 << self.rng.below(8);
            }
            if self.happens(faults.cut) {
                bytes.truncate(self.rng.below(bytes.len() as u32) as usize);
            }
            let delay = 100 + u64::from(self.rng.below(faults.delay_us));
            self.on_the_way.push((now + delay, bytes));
        }
    }

    fn next(&self) -> Option<u64> {
        self.on_the_way.iter().map(|(due, _)| *due).min()
    }

    fn arrived(&mut self, now: u64) -> Vec<Vec<u8>> {
        self.on_the_way.sort_by_key(|(due, _)| *due);
        let count = self.on_the_way.iter().filter(|(due, _)| *due <= now).count();
        self.on_the_way.drain(..count).map(|(_, bytes)| bytes).collect()
    }
}

pub struct Bench<B> {
    pub port: Port<16384>,
    pub session: Session<B, LARGE>,
    pub there: Line,
    pub back: Line,
    pub now: u64,
    pub boot: u32,
}

impl<B: Controller + Default> Bench<B> {
    pub fn new(faults: Faults, seed: u64) -> Self {
        let mut bench = Self {
            port: Port::new(seed as u32, LIMITS),
            session: Session::new(B::default(), ABOUT),
            there: Line::new(faults, seed),
            back: Line::new(faults, seed ^ 0xFFFF),
            now: 0,
            boot: ABOUT.boot,
        };
        let hello = bench.session.hello().to_vec();
        bench.back.send(&hello, 0);
        bench
    }

    pub fn reset(&mut self) {
        self.boot += 1;
        let boot = self.boot;
        self.session = Session::new(B::default(), About { boot, ..ABOUT });
        let hello = self.session.hello().to_vec();
        self.back.send(&hello, self.now);
    }

    /// Runs until the outstanding request ends.
    pub fn wait(&mut self) -> Result<Event, PortError> {
        loop {
            let until = match self.port.poll(self.now)? {
                Next::Send(frame) => {
                    self.there.send(frame, self.now);
                    continue;
                }
                Next::WaitUntil(until) => until,
                Next::Idle => panic!("nothing was asked"),
            };
            let next = [self.there.next(), self.back.next()].into_iter().flatten().min();
            self.now = next.map_or(until, |next| next.min(until)).max(self.now);
            let mut restarts = false;
            for bytes in self.there.arrived(self.now) {
                for byte in bytes {
                    match self.session.receive(byte, &mut ()) {
                        Reaction::None => {}
                        Reaction::Answer(frame) => self.back.send(frame, self.now),
                        Reaction::Restart => restarts = true,
                    }
                }
            }
            if restarts {
                self.reset();
            }
            for bytes in self.back.arrived(self.now) {
                let mut said = None;
                for byte in bytes {
                    said = self.port.receive(byte, self.now)?.or(said);
                }
                if let Some(event) = said {
                    return Ok(event);
                }
            }
        }
    }

    pub fn configure(&mut self, setup: &Setup, task: Option<&Task>) -> u64 {
        loop {
            self.port.greet(self.now);
            if !matches!(self.wait(), Ok(Event::Hello(_))) {
                continue;
            }
            self.port.configure(setup, task, &[], self.now).expect("fits");
            match self.wait() {
                Ok(Event::Configured(configured)) => return configured.digest,
                Ok(Event::Restarted) => {}
                other => panic!("{other:?}"),
            }
        }
    }

    pub fn step(&mut self, inputs: &StepInputs<'_>) -> Option<StepResult> {
        self.port.step(inputs, self.now).expect("fits");
        match self.wait() {
            Ok(Event::Stepped(stepped)) => Some(stepped.result),
            Ok(Event::Restarted) => None,
            other => panic!("step {}: {other:?}", inputs.tick),
        }
    }
}
