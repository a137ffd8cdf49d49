//! The host's end of the link: what to send, and when to look again. Read [`Port::poll`] and [`Port::receive`] first.
//!
//! One request is on its way at a time. It is resent until its answer is there or the attempts are used up: nothing
//! waits forever. Time comes in as an argument, in microseconds of any clock that does not go back.

use crate::frame::{Deframer, Frame, FrameError, TooLong, VERSION};
use crate::message::{
    Configured, Fault, FaultKind, Greeting, Hello, MAX_ANSWER, Restart, Step, StepInputs, Stepped, Token, kind,
};
use core::fmt;
use postcard::from_bytes;
use serde::ser::{Serialize, SerializeTuple as _, Serializer};
use staya_controller::agent::{Setup, Task};

/// How long to wait for a device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// A request is sent again after this at the latest, microseconds: more than the line needs for a request and its answer. A step
    /// is sent again sooner, by the round trips of steps before it (see [`Port`]).
    pub resend_after_us: u64,
    /// A device that has not answered for so long is given up, microseconds; it is asked once at least.
    pub give_up_after_us: u64,
}

/// Steps are not sent again sooner than this: no host looks more often.
const LEAST_RESEND_US: u64 = 1000;
/// The time to wait doubles at most so often.
const MOST_DOUBLINGS: u32 = 10;

/// How long steps have taken: the retransmission timer of RFC 6298 (section 2), in microseconds.
#[derive(Clone, Copy, Debug, Default)]
struct RoundTrip {
    /// The mean, by an eighth of each; 0: none yet.
    mean_us: u64,
    /// The mean distance from it, by a quarter of each.
    deviation_us: u64,
    /// How often the time to wait has doubled since the last step that was answered at once (section 5.5).
    doublings: u32,
}

impl RoundTrip {
    /// A step that was sent once took so long. One that was sent again says nothing: which of them was answered, nobody knows (Karn).
    fn note(&mut self, took_us: u64) {
        let Self { mean_us, deviation_us, doublings } = self;
        *doublings = 0;
        if *mean_us == 0 {
            (*mean_us, *deviation_us) = (took_us.max(1), took_us >> 1);
            return;
        }
        let off = took_us.abs_diff(*mean_us);
        *deviation_us = deviation_us.saturating_sub(*deviation_us >> 2).saturating_add(off >> 2);
        *mean_us = mean_us.saturating_sub(*mean_us >> 3).saturating_add(took_us >> 3).max(1);
    }

    /// How long to wait for the next one, at most `most_us`.
    fn patience_us(self, most_us: u64) -> u64 {
        if self.mean_us == 0 {
            return most_us;
        }
        let usual_us = self.mean_us.saturating_add(self.deviation_us.saturating_mul(4)).max(LEAST_RESEND_US);
        usual_us.saturating_mul(1_u64 << self.doublings.min(MOST_DOUBLINGS)).min(most_us)
    }

    fn double(&mut self) {
        self.doublings = self.doublings.saturating_add(1).min(MOST_DOUBLINGS);
    }
}

/// What the device was asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Asked {
    /// Its name.
    Hello,
    /// To be a robot.
    Configure,
    /// To start anew.
    Restart,
    /// A step, by the host's count.
    Step(u32),
}

impl fmt::Display for Asked {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Hello => f.write_str("greeting"),
            Self::Configure => f.write_str("setup"),
            Self::Restart => f.write_str("restart"),
            Self::Step(tick) => write!(f, "step {tick}"),
        }
    }
}

/// Why a device was given up.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PortError {
    /// No answer.
    Silent {
        /// To what.
        asked: Asked,
        /// How often.
        attempts: u32,
        /// Since the first of them, microseconds.
        waited_us: u64,
    },
    /// The device speaks another version of the link.
    Version {
        /// Its version.
        device: u8,
    },
    /// The device says why it cannot.
    Fault {
        /// What it was asked for.
        asked: Option<Asked>,
        /// Its answer.
        fault: Fault,
    },
}

impl fmt::Display for PortError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Silent { asked, attempts, waited_us } => {
                let millis = waited_us.checked_div(1000).unwrap_or(0);
                write!(f, "no answer to {asked} within {millis} ms ({attempts} attempts)")
            }
            Self::Version { device } => write!(
                f,
                "the device speaks version {device} of the link, this host version {VERSION}: build firmware and host from the same source"
            ),
            Self::Fault { asked, fault } => {
                let Fault { kind, text, .. } = fault;
                match asked {
                    Some(asked) => write!(f, "the device answers to {asked}: {kind:?}: {text}"),
                    None => write!(f, "the device says: {kind:?}: {text}"),
                }
            }
        }
    }
}

impl core::error::Error for PortError {}

/// What to do next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use]
pub enum Next<'a> {
    /// Send this frame, then ask again.
    Send(&'a [u8]),
    /// Nothing before this time unless bytes arrive.
    WaitUntil(u64),
    /// Nothing: no request is on its way.
    Idle,
}

/// What came of the bytes.
#[derive(Clone, Debug, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "there is no allocator, and it is taken apart at once")]
pub enum Event {
    /// The answer to a greeting.
    Hello(Hello),
    /// The answer to a setup.
    Configured(Configured),
    /// The answer to a step.
    Stepped(Stepped),
    /// The device has started anew, asked or not: greet it and tell it what to be. The request is over.
    Restarted,
}

/// What went over the line; the counts wrap.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Frames sent, resent ones included.
    pub sent: u32,
    /// Frames sent again.
    pub resent: u32,
    /// Bytes sent.
    pub sent_bytes: u64,
    /// Bytes received.
    pub received_bytes: u64,
    /// Frames damaged, too long or unreadable.
    pub damaged: u32,
    /// Sound frames that nobody waited for.
    pub stale: u32,
}

/// The host's end for one device; requests of at most `N` bytes.
///
/// A lost frame costs about a round trip: a step is sent again after the mean of the round trips and four times their deviation,
/// then after twice as long, and so on up to [`Limits::resend_after_us`]. The device answers a repeated step with the same bytes.
#[derive(Clone, Debug)]
pub struct Port<const N: usize> {
    deframer: Deframer<MAX_ANSWER>,
    request: Frame<N>,
    limits: Limits,
    token: Token,
    seq: u16,
    boot: Option<u32>,
    waiting: Option<Waiting>,
    round_trip: RoundTrip,
    counts: Counts,
}

#[derive(Clone, Copy, Debug)]
struct Waiting {
    asked: Asked,
    attempts: u32,
    since_us: u64,
    due_us: u64,
}

impl<const N: usize> Port<N> {
    /// Nothing is known of the device yet: the first thing is [`Port::greet`]. `run` tells this run of the host from
    /// others that have talked to the same device.
    #[must_use]
    pub const fn new(run: u32, limits: Limits) -> Self {
        Self {
            deframer: Deframer::new(),
            request: Frame::new(),
            limits,
            token: Token { run, number: 0 },
            seq: 0,
            boot: None,
            waiting: None,
            round_trip: RoundTrip { mean_us: 0, deviation_us: 0, doublings: 0 },
            counts: Counts { sent: 0, resent: 0, sent_bytes: 0, received_bytes: 0, damaged: 0, stale: 0 },
        }
    }

    /// Changes how long to wait, from the next request on.
    pub const fn set_limits(&mut self, limits: Limits) {
        self.limits = limits;
    }

    /// What went over the line.
    #[must_use]
    pub const fn counts(&self) -> Counts {
        self.counts
    }

    /// What the device was asked for, while it has not answered.
    #[must_use]
    pub fn asked(&self) -> Option<Asked> {
        self.waiting.map(|waiting| waiting.asked)
    }

    /// Asks the device who it is; it forgets what it was. Replaces a request that is on its way.
    pub fn greet(&mut self, now_us: u64) {
        self.token.number = self.token.number.wrapping_add(1);
        let token = self.token;
        // A greeting always fits: `N` has room for more than a dozen bytes.
        let _ = self.request.fill(kind::GREETING, &Greeting { token });
        self.ask(Asked::Hello, now_us);
    }

    /// Asks the device to start anew. Replaces a request that is on its way.
    pub fn restart(&mut self, now_us: u64) {
        let token = self.token;
        let _ = self.request.fill(kind::RESTART, &Restart { token });
        self.ask(Asked::Restart, now_us);
    }

    /// Tells the device what to be; `law` as in [`Controller::configure`](crate::robot::Controller::configure). Replaces a request that
    /// is on its way.
    ///
    /// # Errors
    /// [`TooLong`] for `N`; then nothing is on its way.
    pub fn configure(&mut self, setup: &Setup, task: Option<&Task>, law: &[u8], now_us: u64) -> Result<(), TooLong> {
        self.waiting = None;
        self.seq = self.seq.wrapping_add(1);
        self.request.fill(kind::CONFIGURE, &(self.seq, setup, task, Rest(law)))?;
        self.ask(Asked::Configure, now_us);
        Ok(())
    }

    /// Asks for a step. Replaces a request that is on its way, which the device will take for a gap: wait for answers.
    ///
    /// # Errors
    /// [`TooLong`] for `N`; then nothing is on its way. [`Capacities::fit`](crate::capacities::Capacities::fit) sees to
    /// it that [`Capacities::frame_bytes`](crate::capacities::Capacities::frame_bytes) suffice.
    pub fn step(&mut self, inputs: &StepInputs<'_>, now_us: u64) -> Result<(), TooLong> {
        self.waiting = None;
        let seq = self.seq.wrapping_add(1);
        let inputs = *inputs;
        self.request.fill(kind::STEP, &Step { seq, inputs })?;
        self.seq = seq;
        self.ask(Asked::Step(inputs.tick), now_us);
        Ok(())
    }

    const fn ask(&mut self, asked: Asked, now_us: u64) {
        self.waiting = Some(Waiting { asked, attempts: 0, since_us: now_us, due_us: now_us });
    }

    /// What to do next: call it after each request, each event and when the time that it gave has come.
    ///
    /// # Errors
    /// [`PortError::Silent`] when the attempts are used up; then nothing is on its way any more.
    pub fn poll(&mut self, now_us: u64) -> Result<Next<'_>, PortError> {
        let limits = self.limits;
        let Some(waiting) = &mut self.waiting else {
            return Ok(Next::Idle);
        };
        if now_us < waiting.due_us {
            return Ok(Next::WaitUntil(waiting.due_us));
        }
        let waited_us = now_us.saturating_sub(waiting.since_us);
        if waiting.attempts > 0 && waited_us >= limits.give_up_after_us {
            let error = PortError::Silent { asked: waiting.asked, attempts: waiting.attempts, waited_us };
            self.waiting = None;
            return Err(error);
        }
        let is_step = matches!(waiting.asked, Asked::Step(_));
        if waiting.attempts > 0 {
            self.counts.resent = self.counts.resent.wrapping_add(1);
            if is_step {
                self.round_trip.double();
            }
        }
        waiting.attempts = waiting.attempts.saturating_add(1);
        let most_us = limits.resend_after_us;
        let patience_us = if is_step { self.round_trip.patience_us(most_us) } else { most_us };
        let end_us = waiting.since_us.saturating_add(limits.give_up_after_us);
        waiting.due_us = now_us.saturating_add(patience_us).min(end_us.max(now_us.saturating_add(1)));
        let frame = self.request.bytes();
        self.counts.sent = self.counts.sent.wrapping_add(1);
        self.counts.sent_bytes = self.counts.sent_bytes.wrapping_add(frame.len() as u64);
        Ok(Next::Send(frame))
    }

    /// Takes a byte of the line; what came of it, if anything did. O(1), at the end of a frame O(its bytes).
    ///
    /// # Errors
    /// What the device cannot do, see [`PortError`]; then nothing is on its way any more.
    pub fn receive(&mut self, byte: u8, now_us: u64) -> Result<Option<Event>, PortError> {
        self.counts.received_bytes = self.counts.received_bytes.wrapping_add(1);
        let said = match self.deframer.push(byte) {
            None => return Ok(None),
            Some(Ok((kind, body))) => Said::read(kind, body),
            Some(Err(FrameError::Version(device))) => {
                self.waiting = None;
                return Err(PortError::Version { device });
            }
            Some(Err(FrameError::TooLong | FrameError::Cobs | FrameError::Crc)) => None,
        };
        let Some(said) = said else {
            self.counts.damaged = self.counts.damaged.wrapping_add(1);
            return Ok(None);
        };
        let event = self.understand(said, now_us)?;
        match event {
            Some(_) => {
                if let (Some(Event::Stepped(_)), Some(Waiting { attempts: 1, since_us, .. })) = (&event, self.waiting) {
                    self.round_trip.note(now_us.saturating_sub(since_us));
                }
                self.waiting = None;
            }
            None => self.counts.stale = self.counts.stale.wrapping_add(1),
        }
        Ok(event)
    }

    /// What a message means now; `None` for one that nobody waits for.
    fn understand(&mut self, said: Said, now_us: u64) -> Result<Option<Event>, PortError> {
        let asked = self.asked();
        let is_step = matches!(asked, Some(Asked::Step(_)));
        Ok(match said {
            Said::Hello(hello) => self.understand_hello(hello, asked, now_us),
            Said::Configured(answer) if asked == Some(Asked::Configure) => {
                (answer.seq == self.seq).then_some(Event::Configured(answer))
            }
            Said::Stepped(answer) if is_step => (answer.seq == self.seq).then_some(Event::Stepped(answer)),
            Said::Fault(fault) => {
                let is_answer = fault.seq == self.seq && asked.is_some();
                match fault.kind {
                    FaultKind::NotConfigured if is_answer && is_step => Some(Event::Restarted),
                    // Nothing but a step needs a setup: late, about one that was sent twice.
                    FaultKind::NotConfigured => None,
                    FaultKind::Panic | FaultKind::Version => {
                        self.waiting = None;
                        return Err(PortError::Fault { asked, fault });
                    }
                    _ if is_answer => {
                        self.waiting = None;
                        return Err(PortError::Fault { asked, fault });
                    }
                    _ => None,
                }
            }
            Said::Configured(_) | Said::Stepped(_) => None,
        })
    }

    fn understand_hello(&mut self, hello: Hello, asked: Option<Asked>, now_us: u64) -> Option<Event> {
        if hello.token.is_some() {
            let is_answer = hello.token == Some(self.token) && asked == Some(Asked::Hello);
            self.boot = if is_answer { Some(hello.boot) } else { self.boot };
            return is_answer.then_some(Event::Hello(hello));
        }
        match (asked, &mut self.waiting) {
            // It has just started, and our greeting may have come too early.
            (Some(Asked::Hello), Some(waiting)) => {
                waiting.due_us = now_us;
                None
            }
            (Some(Asked::Restart), _) => Some(Event::Restarted),
            // Delayed from a start that is known.
            _ if self.boot == Some(hello.boot) => None,
            _ => {
                self.boot = Some(hello.boot);
                Some(Event::Restarted)
            }
        }
    }
}

/// A message of the device.
#[expect(clippy::large_enum_variant, reason = "there is no allocator, and it is taken apart at once")]
enum Said {
    Hello(Hello),
    Configured(Configured),
    Stepped(Stepped),
    Fault(Fault),
}

impl Said {
    fn read(kind: u8, body: &[u8]) -> Option<Self> {
        match kind {
            kind::HELLO => from_bytes(body).map(Self::Hello).ok(),
            kind::CONFIGURED => from_bytes(body).map(Self::Configured).ok(),
            kind::STEPPED => from_bytes(body).map(Self::Stepped).ok(),
            kind::FAULT => from_bytes(body).map(Self::Fault).ok(),
            _ => None,
        }
    }
}

/// Bytes that end with the frame: without their number before them.
struct Rest<'a>(&'a [u8]);

impl Serialize for Rest<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut bytes = serializer.serialize_tuple(self.0.len())?;
        self.0.iter().try_for_each(|byte| bytes.serialize_element(byte))?;
        bytes.end()
    }
}
