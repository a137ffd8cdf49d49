//! The device's side of the link as a whole program: a robot that steps when the host says so. `lockstep!` makes a
//! firmware of it for a guidance law of one's own; `src/bin/lockstep.rs` is the one for all laws of Staya's.

use crate::fault;
use crate::runtime::{self, Start};
use crate::stack::{self, Painted};
use staya_link::frame::VERSION;
use staya_link::message::Cost;
use staya_link::robot::{self, Controller};
use staya_link::session::{About, Meter, Reaction, Session, content_bytes};

/// The robot with law `G` that this part has room for.
#[cfg(not(part = "nrf51"))]
pub type Own<G> = staya_link::own::OwnLarge<G>;
#[cfg(not(part = "nrf51"))]
/// Bytes of the content of its longest frame, see [`content_bytes`].
pub const OWN_CONTENT: usize = content_bytes(0, 32, robot::LARGE_INBOX);
/// The robot with law `G` that this part has room for.
#[cfg(part = "nrf51")]
pub type Own<G> = staya_link::own::OwnSmall<G>;
#[cfg(part = "nrf51")]
/// Bytes of the content of its longest frame, see [`content_bytes`].
pub const OWN_CONTENT: usize = content_bytes(0, 16, robot::SMALL_INBOX);

/// Is the robot of `session`, which must not be known to anybody else, for good. `firmware` is what it says that it runs.
pub fn run<C: Controller, const CONTENT: usize>(
    session: &'static mut Session<C, CONTENT>,
    firmware: &'static str,
) -> ! {
    let start = runtime::start();
    defmt::info!(
        "{=str} at {=u32} Hz, start {=u32}, {=u32} bytes of stack",
        start.part,
        start.clock_hz,
        start.boots,
        stack::size()
    );
    session.introduce(about(&start, firmware));
    runtime::send(session.hello());
    runtime::start_watchdog();
    let mut gauge = Gauge::default();
    let mut lost = 0;
    loop {
        let Some(byte) = runtime::receive() else {
            if lost != runtime::lost() {
                lost = runtime::lost();
                defmt::warn!("{=u32} bytes lost since the start", lost);
            }
            runtime::feed_watchdog();
            runtime::sleep();
            continue;
        };
        match session.receive(byte, &mut gauge) {
            Reaction::None => {}
            Reaction::Answer(frame) => {
                runtime::send(frame);
                runtime::feed_watchdog();
            }
            Reaction::Restart => runtime::reset(),
        }
    }
}

fn about(start: &Start, firmware: &'static str) -> About {
    About { part: start.part, firmware, boot: start.boots, ticks_per_second: start.tick_hz }
}

/// Ticks and stack of a step.
#[derive(Default)]
struct Gauge {
    painted: Option<Painted>,
    began: u32,
}

impl Meter for Gauge {
    fn start(&mut self) {
        self.painted = Some(stack::paint());
        self.began = runtime::ticks();
    }

    fn finish(&mut self) -> Cost {
        let ticks = runtime::ticks().wrapping_sub(self.began);
        let painted = self.painted.take();
        if painted.is_some_and(|painted| !painted.has_room()) {
            // What lies below the stack is not to be trusted any more.
            fault::over_the_link(format_args!("stack overflow: all of {} bytes used", stack::size()));
        }
        Cost { ticks, stack_bytes: painted.map_or(0, |painted| painted.deepest()) }
    }
}

/// What stands in the ELF file beside the program, and takes no flash: which part it is for and what it is, so that a host need not
/// start it to know. `staya`, the link's version, the part's name and the firmware's, filled up with zeros.
pub type Note = [u8; 62];

/// The note of a firmware; what is too long is cut, as [`Hello`](staya_link::message::Hello) cuts it.
#[must_use]
pub const fn note(firmware: &str) -> Note {
    let note = write([0; 62], 0, 5, "staya");
    let note = write(note, 6, 24, crate::part::NAME);
    let mut note = write(note, 30, 32, firmware);
    note[5] = VERSION;
    note
}

/// Writes text of at most `room` bytes.
const fn write(mut note: Note, at: usize, room: usize, text: &str) -> Note {
    let (text, mut count) = (text.as_bytes(), 0);
    while count < text.len() && count < room {
        note[at + count] = text[count];
        count += 1;
    }
    note
}
