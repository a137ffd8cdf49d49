//! The host's end of the link: which frame to send, and when to call again. Start with
//! [`Port::poll`] and [`Port::receive`].
//!
//! The one outstanding request is resent until it is answered or times out. Time is an argument, in
//! microseconds of any monotonic clock.

use crate::frame::{Deframer, Frame, FrameError, TooLong, VERSION};
use crate::message::{
    Configured, Fault, FaultKind, Greeting, Hello, MAX_ANSWER, Restart, Step, StepInputs, Stepped, Token, kind,
};
use core::fmt;
use postcard::from_bytes;
use serde::ser::{Serialize, SerializeTuple as _, Serializer};
use staya_controller::agent::{Setup, Task};

/// Timeouts for a device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Longest time before a request is resent, microseconds; must exceed the line's time for a
    /// request and its answer. Steps are resent sooner (see [`Port`]).
    pub resend_after_us: u64,
    /// Time without an answer after which the device counts as silent, microseconds.
    pub give_up_after_us: u64,
}

/// No host polls more often.
const LEAST_RESEND_US: u64 = 1000;
const MOST_DOUBLINGS: u32 = 10;

/// Retransmission timer of RFC 6298 (section 2) for steps.
#[derive(Clone, Copy, Debug, Default)]
struct RoundTrip {
    /// Smoothed mean with gain 1/8; 0 before the first measurement.
    mean_us: u64,
    /// Mean deviation, gain 1/4.
    deviation_us: u64,
    /// Doublings since the last step that was answered without a resend (section 5.5).
    doublings: u32,
}

impl RoundTrip {
    /// Omits resent steps: their answers may belong to either copy (Karn's algorithm).
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

/// Kind of an outstanding request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Asked {
    /// Greeting.
    Hello,
    /// Configuration.
    Configure,
    /// Restart.
    Restart,
    /// Step, with the host's step count.
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

/// Reason for giving up on a device.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PortError {
    /// The device did not answer.
    Silent {
        /// The outstanding request.
        asked: Asked,
        /// Times that it was sent.
        attempts: u32,
        /// Time since it was first sent, microseconds.
        waited_us: u64,
    },
    /// The device speaks another version of the link.
    Version {
        /// The device's version.
        device: u8,
    },
    /// The device reported a fault.
    Fault {
        /// The outstanding request.
        asked: Option<Asked>,
        /// The device's report.
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

/// Next action of the host.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use]
pub enum Next<'a> {
    /// Send this frame, then poll again.
    Send(&'a [u8]),
    /// Poll again at this time, microseconds, or when bytes arrive.
    WaitUntil(u64),
    /// Nothing to do: there is no outstanding request.
    Idle,
}

/// Result of received bytes.
#[derive(Clone, Debug, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "there is no allocator, and it is taken apart at once")]
pub enum Event {
    /// Answer to a greeting.
    Hello(Hello),
    /// Answer to a configuration.
    Configured(Configured),
    /// Answer to a step.
    Stepped(Stepped),
    /// The device has restarted: greet and configure it. There is no outstanding request.
    Restarted,
}

/// Traffic counters; they wrap.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Frames sent, resent ones included.
    pub sent: u32,
    /// Frames resent.
    pub resent: u32,
    /// Bytes sent.
    pub sent_bytes: u64,
    /// Bytes received.
    pub received_bytes: u64,
    /// Frames that were damaged, too long or unreadable.
    pub damaged: u32,
    /// Intact frames that answer no outstanding request.
    pub stale: u32,
}

/// The host's end of the link to one device, with requests of at most `N` bytes.
///
/// A step is resent after the mean round trip plus four times its deviation; the wait then doubles
/// up to [`Limits::resend_after_us`].
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
    /// Creates a port to an unknown device; call [`Port::greet`] first. `run` differs between runs.
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

    /// Changes the timeouts, from the next request on.
    pub const fn set_limits(&mut self, limits: Limits) {
        self.limits = limits;
    }

    /// Traffic counters.
    #[must_use]
    pub const fn counts(&self) -> Counts {
        self.counts
    }

    /// The outstanding request, if any.
    #[must_use]
    pub fn asked(&self) -> Option<Asked> {
        self.waiting.map(|waiting| waiting.asked)
    }

    /// Sends a greeting, which makes the device forget its robot. Replaces an outstanding request.
    pub fn greet(&mut self, now_us: u64) {
        self.token.number = self.token.number.wrapping_add(1);
        let token = self.token;
        // `N` exceeds a dozen bytes.
        let _ = self.request.fill(kind::GREETING, &Greeting { token });
        self.ask(Asked::Hello, now_us);
    }

    /// Requests a reset of the device. Replaces an outstanding request.
    pub fn restart(&mut self, now_us: u64) {
        let token = self.token;
        let _ = self.request.fill(kind::RESTART, &Restart { token });
        self.ask(Asked::Restart, now_us);
    }

    /// Sends the robot's configuration; `law` as in
    /// [`Controller::configure`](crate::robot::Controller::configure). Replaces an outstanding
    /// request.
    ///
    /// # Errors
    /// [`TooLong`] if the request exceeds `N` bytes; then there is no outstanding request.
    pub fn configure(&mut self, setup: &Setup, task: Option<&Task>, law: &[u8], now_us: u64) -> Result<(), TooLong> {
        self.waiting = None;
        self.seq = self.seq.wrapping_add(1);
        self.request.fill(kind::CONFIGURE, &(self.seq, setup, task, Rest(law)))?;
        self.ask(Asked::Configure, now_us);
        Ok(())
    }

    /// Requests a step. Wait for each answer: the device reports a replaced request as a gap.
    ///
    /// # Errors
    /// [`TooLong`] if the request exceeds `N` bytes; then there is no outstanding request. Inputs
    /// cut by [`Capacities::fit`](crate::capacities::Capacities::fit) fit into
    /// [`Capacities::frame_bytes`](crate::capacities::Capacities::frame_bytes).
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

    /// Returns the next action. Call it after requests and events, and at the returned time.
    ///
    /// # Errors
    /// [`PortError::Silent`] on a timeout; then there is no outstanding request.
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

    /// Takes one byte from the line and returns the event that it completes, if any. O(1), at the
    /// end of a frame O(its bytes).
    ///
    /// # Errors
    /// [`PortError`]: a fault or version mismatch; then there is no outstanding request.
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

    /// `None` if it is stale.
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
                    // Only a step needs a configuration: a late answer.
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
            // It has just started and may have missed the greeting.
            (Some(Asked::Hello), Some(waiting)) => {
                waiting.due_us = now_us;
                None
            }
            (Some(Asked::Restart), _) => Some(Event::Restarted),
            _ if self.boot == Some(hello.boot) => None,
            _ => {
                self.boot = Some(hello.boot);
                Some(Event::Restarted)
            }
        }
    }
}

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

struct Rest<'a>(&'a [u8]);

impl Serialize for Rest<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut bytes = serializer.serialize_tuple(self.0.len())?;
        self.0.iter().try_for_each(|byte| bytes.serialize_element(byte))?;
        bytes.end()
    }
}
