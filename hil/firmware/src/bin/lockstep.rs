//! The device's side of the link: a robot that steps when the host says so.
#![cfg_attr(target_os = "none", no_std, no_main)]

staya_firmware::entry!(program::run);
// What is flashed has no panic, which the linker has seen: start-up, interrupts, logs and exceptions included. Built for debugging it
// has those of the checks that are on then.
#[cfg(debug_assertions)]
staya_firmware::faults_go_over_the_link!();
#[cfg(not(debug_assertions))]
staya_firmware::panics_do_not_link!();
#[cfg(not(debug_assertions))]
staya_firmware::exceptions_go_over_the_link!();

#[cfg(target_os = "none")]
mod program {
    use core::ptr::addr_of_mut;
    use staya_firmware::fault;
    use staya_firmware::runtime::{self, Start};
    use staya_firmware::stack::{self, Painted};
    use staya_link::message::Cost;
    use staya_link::robot;
    use staya_link::session::{About, Meter, Reaction, Session, content_bytes};

    /// The robot that the part has room for, and the content of its longest frame.
    #[cfg(not(part = "nrf51"))]
    type Robot = robot::Large;
    #[cfg(not(part = "nrf51"))]
    const CONTENT: usize = content_bytes(169, 32, robot::LARGE_INBOX);
    #[cfg(part = "nrf51")]
    type Robot = robot::Small;
    #[cfg(part = "nrf51")]
    const CONTENT: usize = content_bytes(169, 16, robot::SMALL_INBOX);

    const FIRMWARE: &str = concat!("lockstep ", env!("CARGO_PKG_VERSION"));

    /// Too large for a stack, so made where it stays; [`Start`] is known only later.
    static mut SESSION: Session<Robot, CONTENT> = Session::unnamed(Robot::new());

    pub fn run() -> ! {
        let start = runtime::start();
        defmt::info!(
            "{=str} at {=u32} Hz, start {=u32}, {=u32} bytes of stack",
            start.part,
            start.clock_hz,
            start.boots,
            stack::size()
        );
        // SAFETY: the only place that names it, which runs once.
        let session = unsafe { &mut *addr_of_mut!(SESSION) };
        session.introduce(about(&start));
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

    fn about(start: &Start) -> About {
        About { part: start.part, firmware: FIRMWARE, boot: start.boots, ticks_per_second: start.tick_hz }
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
}
