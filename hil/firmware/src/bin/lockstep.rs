//! The device's side of the link: a controller that steps when the host says so.
#![cfg_attr(target_os = "none", no_std, no_main)]

staya_firmware::entry!(program::run);

#[cfg(target_os = "none")]
mod program {
    use staya_firmware::{runtime, stack};

    pub fn run() -> ! {
        let start = runtime::start();
        defmt::info!(
            "{}: {} Hz, start {}",
            start.part,
            start.clock_hz,
            start.boots
        );
        runtime::start_watchdog();
        let mut painted = stack::paint();
        let mut length = 0u32;
        loop {
            runtime::feed_watchdog();
            while let Some(byte) = runtime::receive() {
                length += 1;
                runtime::send(&[byte]);
                if byte == 0 {
                    defmt::info!(
                        "frame of {} bytes, {} lost, {} bytes of stack, tick {}",
                        length,
                        runtime::lost(),
                        painted.deepest(),
                        runtime::ticks()
                    );
                    length = 0;
                    painted = stack::paint();
                }
            }
            runtime::sleep();
        }
    }
}

staya_firmware::panic_prints!();
