//! A robot that steps on request of the host, as a whole program. `lockstep!` defines such a
//! firmware for a user-defined guidance law.

use crate::fault;
use crate::runtime::{self, Start};
use crate::stack::{self, Painted};
use staya_link::frame::VERSION;
use staya_link::message::Cost;
use staya_link::robot::{self, Controller};
use staya_link::session::{About, Meter, Reaction, Session, content_bytes};

/// The number format that the firmware was built for; see `cargo xtask firmware --numbers`.
#[cfg(numbers = "f32")]
pub type Number = f32;
/// The number format that the firmware was built for; see `cargo xtask firmware --numbers`.
#[cfg(numbers = "fast32")]
pub type Number = staya_controller::scalar::Fast32;
/// The number format that the firmware was built for; see `cargo xtask firmware --numbers`.
#[cfg(numbers = "q16")]
pub type Number = staya_controller::scalar::Q16;
/// The robot with law `G` that fits this part.
#[cfg(not(part = "nrf51"))]
pub type Own<G> = staya_link::own::OwnLarge<G, Number>;
#[cfg(not(part = "nrf51"))]
/// Content of its longest frame, bytes; see [`content_bytes`].
pub const OWN_CONTENT: usize = content_bytes(0, 32, robot::LARGE_INBOX);
/// The robot with law `G` that fits this part.
#[cfg(part = "nrf51")]
pub type Own<G> = staya_link::own::OwnSmall<G>;
#[cfg(part = "nrf51")]
/// Content of its longest frame, bytes; see [`content_bytes`].
pub const OWN_CONTENT: usize = content_bytes(0, 16, robot::SMALL_INBOX);

/// Runs the robot of `session` forever. `firmware` is the name that it reports.
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
            // The memory below the stack may be damaged.
            fault::over_the_link(format_args!("stack overflow: all of {} bytes used", stack::size()));
        }
        Cost { ticks, stack_bytes: painted.map_or(0, |painted| painted.deepest()) }
    }
}

/// Identification of a firmware in its ELF file, without flash: `staya`, the link's version, the
/// part's name and the firmware's name, padded with zeros.
pub type Note = [u8; 62];

/// Creates the note; longer names are cut as in [`Hello`](staya_link::message::Hello).
#[must_use]
pub const fn note(firmware: &str) -> Note {
    let note = write([0; 62], 0, 5, "staya");
    let note = write(note, 6, 24, crate::part::NAME);
    let mut note = write(note, 30, 32, firmware);
    note[5] = VERSION;
    note
}

const fn write(mut note: Note, at: usize, room: usize, text: &str) -> Note {
    let (text, mut count) = (text.as_bytes(), 0);
    while count < text.len() && count < room {
        note[at + count] = text[count];
        count += 1;
    }
    note
}
