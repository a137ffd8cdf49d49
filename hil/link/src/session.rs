//! The device's end of the link: takes received bytes and returns answers. Start with
//! [`Session::receive`].
//!
//! ```
//! use staya_link::robot::{SMALL_INBOX, Small};
//! use staya_link::session::{About, Reaction, Session, content_bytes};
//!
//! const CONTENT: usize = content_bytes(169, 16, SMALL_INBOX);
//! let (part, firmware) = ("nrf51", "lockstep");
//! let about = About { part, firmware, boot: 0, ticks_per_second: 16_000_000 };
//! let mut session = Session::<Small, CONTENT>::new(Small::new(), about);
//! let mut meter = ();
//! // Sent once after each start; then feed each received byte.
//! assert!(!session.hello().is_empty());
//! for byte in [0, 1, 2, 0] {
//!     match session.receive(byte, &mut meter) {
//!         Reaction::None => {}
//!         Reaction::Answer(frame) => drop(frame), // send it
//!         Reaction::Restart => {}                 // write the reset register
//!     }
//! }
//! assert_eq!(session.counts().damaged, 1);
//! ```

use crate::capacities::{self, Capacities};
use crate::frame::{Deframer, Frame, FrameError, VERSION};
use crate::message::{
    Configured, Cost, Fault, FaultKind, Greeting, Hello, MAX_ANSWER, MAX_CONFIGURE, Restart, StepInputs, Token, kind,
};
use crate::refusal::Refusal;
use crate::robot::Controller;
use core::fmt::{Display, Write};
use heapless::String;
use postcard::take_from_bytes;

/// Largest frame other than answers to requests, bytes. A test fills one.
const MAX_NOTE: usize = 128;

/// Computes `CONTENT` of a [`Session`] for this search, number of obstacles and inbox.
#[must_use]
pub const fn content_bytes(search_cells: usize, obstacles: usize, inbox_bytes: usize) -> usize {
    let step = capacities::step_bytes(search_cells, obstacles, inbox_bytes);
    if step > MAX_CONFIGURE { step } else { MAX_CONFIGURE }
}

/// Measures the cost of a step.
pub trait Meter {
    /// Called right before the step: paints the free stack and reads the clock.
    fn start(&mut self);

    /// Called right after the step: reads the clock and the overwritten stack paint.
    fn finish(&mut self) -> Cost;
}

/// Measures nothing.
impl Meter for () {
    fn start(&mut self) {}

    fn finish(&mut self) -> Cost {
        Cost::default()
    }
}

/// Description of a device, without its controller's capacities.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct About {
    /// Name of the part; at most 24 bytes.
    pub part: &'static str,
    /// Name and version of the firmware; at most 32 bytes.
    pub firmware: &'static str,
    /// Start number. Differs after each start if the part's memory allows.
    pub boot: u32,
    /// Rate of the meter's clock, per second.
    pub ticks_per_second: u32,
}

/// Action of the device after a received byte.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use]
pub enum Reaction<'a> {
    /// Do nothing.
    None,
    /// Send this frame; it is unchanged until the next byte.
    Answer(&'a [u8]),
    /// Reset the device.
    Restart,
}

/// Counters of steps and of unusable frames; they wrap.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Steps executed.
    pub steps: u32,
    /// Requests answered a second time.
    pub repeated: u32,
    /// Requests older than the last one.
    pub stale: u32,
    /// Frames that were damaged or too long.
    pub damaged: u32,
}

/// The device's end of the link, with controller `C` and `CONTENT` bytes per frame
/// ([`content_bytes`]).
#[derive(Clone, Debug)]
pub struct Session<C, const CONTENT: usize> {
    deframer: Deframer<CONTENT>,
    core: Core<C, CONTENT>,
}

#[derive(Clone, Debug)]
struct Core<C, const CONTENT: usize> {
    controller: C,
    about: Option<About>,
    token: Option<Token>,
    /// The request that `answer` answers; `None` if no robot is configured.
    last: Option<u16>,
    answer: Frame<MAX_ANSWER>,
    /// Any other frame: `answer` is kept for a repeated request.
    note: Frame<MAX_NOTE>,
    counts: Counts,
}

enum Freshness {
    Repeated,
    Stale,
    Next,
    Ahead,
    First,
}

impl<C: Controller, const CONTENT: usize> Session<C, CONTENT> {
    /// Creates a session with no robot configured.
    #[must_use]
    pub const fn new(controller: C, about: About) -> Self {
        let mut session = Self::unnamed(controller);
        session.introduce(about);
        session
    }

    /// Creates a session without a description; call [`Session::introduce`] before
    /// [`Session::hello`]. All zeros if `controller` is, so that a static session takes no flash.
    #[must_use]
    pub const fn unnamed(controller: C) -> Self {
        const { assert!(CONTENT >= MAX_CONFIGURE, "no room for a setup") };
        Self {
            deframer: Deframer::new(),
            core: Core {
                controller,
                about: None,
                token: None,
                last: None,
                answer: Frame::new(),
                note: Frame::new(),
                counts: Counts::default_const(),
            },
        }
    }

    /// Sets the description of the device.
    pub const fn introduce(&mut self, about: About) {
        self.core.about = Some(about);
    }

    /// Returns the frame that the device sends after each start.
    pub fn hello(&mut self) -> &[u8] {
        self.core.say_hello();
        self.core.note.bytes()
    }

    /// The controller.
    pub const fn controller(&self) -> &C {
        &self.core.controller
    }

    /// Counters of steps and of unusable frames.
    #[must_use]
    pub const fn counts(&self) -> Counts {
        self.core.counts
    }

    /// Takes one byte from the line. Bounded work: O(1), at the end of a frame O(its bytes), plus
    /// one step of the robot if the frame requests it.
    pub fn receive(&mut self, byte: u8, meter: &mut impl Meter) -> Reaction<'_> {
        match self.deframer.push(byte) {
            None => Reaction::None,
            Some(Ok((kind, body))) => self.core.handle(kind, body, meter),
            Some(Err(error)) => self.core.refuse(error),
        }
    }
}

impl Counts {
    const fn default_const() -> Self {
        Self { steps: 0, repeated: 0, stale: 0, damaged: 0 }
    }
}

impl<C: Controller, const CONTENT: usize> Core<C, CONTENT> {
    fn refuse(&mut self, error: FrameError) -> Reaction<'_> {
        match error {
            FrameError::Version(theirs) => self.fault(
                0,
                FaultKind::Version,
                format_args!("the device speaks version {VERSION} of the link, not {theirs}"),
            ),
            FrameError::TooLong | FrameError::Cobs | FrameError::Crc => {
                self.counts.damaged = self.counts.damaged.wrapping_add(1);
                Reaction::None
            }
        }
    }

    fn handle(&mut self, kind: u8, body: &[u8], meter: &mut impl Meter) -> Reaction<'_> {
        match kind {
            kind::GREETING => match take_from_bytes::<Greeting>(body) {
                Ok((greeting, _)) => self.greet(greeting.token),
                Err(_) => self.malformed(0),
            },
            kind::RESTART => match take_from_bytes::<Restart>(body) {
                Ok((restart, _)) if self.token == Some(restart.token) => Reaction::Restart,
                Ok(_) => {
                    self.say_hello();
                    Reaction::Answer(self.note.bytes())
                }
                Err(_) => self.malformed(0),
            },
            kind::CONFIGURE | kind::STEP => {
                // The rest of a repeated or stale message is not parsed.
                let Ok((seq, rest)) = take_from_bytes::<u16>(body) else {
                    return self.malformed(0);
                };
                self.request(kind, seq, rest, meter)
            }
            _ => self.fault(0, FaultKind::Malformed, format_args!("no message has the number {kind}")),
        }
    }

    fn greet(&mut self, token: Token) -> Reaction<'_> {
        let is_new = self.token.is_none_or(|own| {
            let ahead = token.number.wrapping_sub(own.number).cast_signed();
            own.run != token.run || ahead > 0
        });
        if is_new {
            self.token = Some(token);
            self.last = None;
            self.controller.forget();
        }
        self.say_hello();
        Reaction::Answer(self.note.bytes())
    }

    fn request(&mut self, kind: u8, seq: u16, body: &[u8], meter: &mut impl Meter) -> Reaction<'_> {
        match (self.place(seq), kind) {
            (Freshness::Repeated, _) => {
                self.counts.repeated = self.counts.repeated.wrapping_add(1);
                Reaction::Answer(self.answer.bytes())
            }
            (Freshness::Stale, _) => {
                self.counts.stale = self.counts.stale.wrapping_add(1);
                Reaction::None
            }
            (Freshness::First | Freshness::Next | Freshness::Ahead, kind::CONFIGURE) => self.configure(seq, body),
            (Freshness::First, _) => self.fault(seq, FaultKind::NotConfigured, format_args!("a step, but no setup")),
            (Freshness::Ahead, _) => {
                let last = self.last.unwrap_or_default();
                self.fault(seq, FaultKind::Gap, format_args!("request {seq} after {last}"))
            }
            (Freshness::Next, _) => self.step(seq, body, meter),
        }
    }

    fn place(&self, seq: u16) -> Freshness {
        let Some(last) = self.last else {
            return Freshness::First;
        };
        match seq.wrapping_sub(last).cast_signed() {
            0 => Freshness::Repeated,
            1 => Freshness::Next,
            2.. => Freshness::Ahead,
            _ => Freshness::Stale,
        }
    }

    /// Not inlined: its setup would take stack from a step.
    #[inline(never)]
    fn configure(&mut self, seq: u16, body: &[u8]) -> Reaction<'_> {
        self.last = None;
        let Ok((Setting { setup, task }, law)) = take_from_bytes(body) else {
            self.controller.forget();
            return self.malformed(seq);
        };
        match self.controller.configure(&setup, task.as_ref(), law) {
            Ok(digest) => {
                let _ = self.answer.fill(kind::CONFIGURED, &Configured { seq, digest });
                self.last = Some(seq);
                Reaction::Answer(self.answer.bytes())
            }
            Err(refusal) => self.refused(seq, refusal),
        }
    }

    fn step(&mut self, seq: u16, body: &[u8], meter: &mut impl Meter) -> Reaction<'_> {
        let Ok((inputs, [])) = take_from_bytes::<StepInputs<'_>>(body) else {
            return self.malformed(seq);
        };
        meter.start();
        let stepped = self.controller.step(&inputs);
        let cost = meter.finish();
        match stepped {
            Ok(()) => self.tell(seq, cost),
            Err(refusal) => self.refused(seq, refusal),
        }
    }

    /// Not inlined: the result would take stack from the step.
    #[inline(never)]
    fn tell(&mut self, seq: u16, cost: Cost) -> Reaction<'_> {
        let Some(result) = self.controller.result() else {
            return self.refused(seq, Refusal::NotConfigured);
        };
        let filled = self.answer.fill(kind::STEPPED, &(seq, &result, cost));
        if filled.is_err() {
            let text = format_args!("an answer of more than {MAX_ANSWER} bytes");
            return self.fault(seq, FaultKind::Capacity, text);
        }
        self.last = Some(seq);
        self.counts.steps = self.counts.steps.wrapping_add(1);
        Reaction::Answer(self.answer.bytes())
    }

    fn refused(&mut self, seq: u16, refusal: Refusal) -> Reaction<'_> {
        let kind = match refusal {
            Refusal::NotConfigured => FaultKind::NotConfigured,
            Refusal::NoRobot | Refusal::Format(_) | Refusal::Task | Refusal::Law => FaultKind::Setup,
            Refusal::Search { .. } | Refusal::Obstacles { .. } => FaultKind::Capacity,
            Refusal::Nonsense => FaultKind::Malformed,
        };
        self.fault(seq, kind, refusal)
    }

    fn malformed(&mut self, seq: u16) -> Reaction<'_> {
        let text = "a sound frame that cannot be read";
        self.fault(seq, FaultKind::Malformed, text)
    }

    fn fault(&mut self, seq: u16, kind: FaultKind, text: impl Display) -> Reaction<'_> {
        fill_fault(&mut self.note, seq, kind, text);
        Reaction::Answer(self.note.bytes())
    }

    fn say_hello(&mut self) {
        let Self { controller, .. } = self;
        let about = self.about.unwrap_or(About { part: "", firmware: "", boot: 0, ticks_per_second: 0 });
        let hello = Hello {
            token: self.token,
            boot: about.boot,
            ticks_per_second: about.ticks_per_second,
            number: controller.number(),
            capacities: Self::capacities(controller),
            part: text(about.part),
            firmware: text(about.firmware),
        };
        let _ = self.note.fill(kind::HELLO, &hello);
    }

    fn capacities(controller: &C) -> Capacities {
        let capacities = controller.capacities();
        let (cells, obstacles) = (capacities.search_cells, capacities.obstacles);
        let rest = capacities::step_bytes(cells.into(), obstacles.into(), 0);
        let inbox = CONTENT.saturating_sub(rest);
        Capacities { inbox_bytes: u16::try_from(inbox).unwrap_or(u16::MAX), ..capacities }
    }
}

/// [`Configure`](crate::message::Configure) without its number and the law after it.
#[derive(serde::Deserialize)]
struct Setting {
    setup: staya_controller::agent::Setup,
    task: Option<staya_controller::agent::Task>,
}

#[must_use]
/// Builds a fault frame for a panic handler, which has no session. Text beyond 80 bytes is cut.
pub fn fault_frame(kind: FaultKind, text: impl Display) -> Frame<MAX_NOTE> {
    let mut frame = Frame::new();
    fill_fault(&mut frame, 0, kind, text);
    frame
}

fn fill_fault(frame: &mut Frame<MAX_NOTE>, seq: u16, kind: FaultKind, text: impl Display) {
    let mut cut = Cut(String::new());
    let _ = write!(cut, "{text}");
    let text = cut.0;
    let _ = frame.fill(kind::FAULT, &Fault { seq, kind, text });
}

/// Keeps the text that fits.
struct Cut<const N: usize>(String<N>);

impl<const N: usize> Write for Cut<N> {
    fn write_str(&mut self, text: &str) -> core::fmt::Result {
        for letter in text.chars() {
            self.0.push(letter).map_err(|_| core::fmt::Error)?;
        }
        Ok(())
    }
}

fn text<const N: usize>(text: &str) -> String<N> {
    let mut cut = Cut(String::new());
    let _ = cut.write_str(text);
    cut.0
}
