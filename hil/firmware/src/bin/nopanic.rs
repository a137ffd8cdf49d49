//! Links only if no panic is reachable from a step of any behaviour, from received packets, or from
//! the device's end of the link; not meant to be run.
//!
//! The panic handler calls an undefined function, which the optimiser must remove. All inputs go
//! through `black_box`. `cargo xtask plants` shows that a program with a panic does not link.
#![cfg_attr(target_os = "none", no_std, no_main)]

staya_firmware::entry!(program::run);
staya_firmware::panics_do_not_link!();

#[cfg(target_os = "none")]
mod program {
    use core::hint::black_box;
    #[cfg(not(part = "nrf51"))]
    use staya_cases::Opaque;
    #[cfg(not(part = "nrf51"))]
    use staya_link::robot::{Large as Robot, SMALL_INBOX};
    #[cfg(part = "nrf51")]
    use staya_link::robot::{SMALL_INBOX, Small as Robot};
    use staya_link::session::{About, Meter, Reaction, Session, content_bytes};

    pub fn run() -> ! {
        // The small part's flash fits the link, but not each kind of agent as well.
        #[cfg(not(part = "nrf51"))]
        swarms();
        link();
        loop {
            core::hint::spin_loop();
        }
    }

    #[cfg(not(part = "nrf51"))]
    fn swarms() {
        use staya_cases::{Case, WorstCase, packets_over};
        use staya_controller::scalar::Q16;
        use staya_mavlink::wire::Mavlink;
        for &case in black_box(Case::ALL) {
            black_box(case.run::<f32, _>(&mut Opaque));
            black_box(case.run::<Q16, _>(&mut Opaque));
        }
        black_box(packets_over::<f32, _, _>(black_box(Mavlink), &mut Opaque));
        for &case in black_box(WorstCase::ALL) {
            black_box(case.run::<f32, _, 8, 16>(&mut Opaque));
        }
    }

    fn link() {
        const CONTENT: usize = content_bytes(169, 32, SMALL_INBOX);
        let about = About { part: "nopanic", firmware: "nopanic", boot: 0, ticks_per_second: 1 };
        let mut session = Session::<Robot, CONTENT>::new(Robot::new(), black_box(about));
        black_box(session.hello());
        let mut meter = black_box(());
        let mut wants_more = true;
        while wants_more {
            let session = black_box(&mut session);
            wants_more = hear(session, &mut meter);
        }
    }

    fn hear<const CONTENT: usize>(session: &mut Session<Robot, CONTENT>, meter: &mut impl Meter) -> bool {
        match session.receive(black_box(0), meter) {
            Reaction::None => true,
            Reaction::Answer(frame) => !black_box(frame).is_empty(),
            Reaction::Restart => false,
        }
    }
}
