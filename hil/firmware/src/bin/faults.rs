//! Goes wrong on purpose, one way per start: a panic, then an exception of the processor. At the third start it ends
//! the emulator. `cargo xtask test` reads from the line what it said.
#![cfg_attr(target_os = "none", no_std, no_main)]

staya_firmware::entry!(program::run);
staya_firmware::faults_go_over_the_link!();

#[cfg(target_os = "none")]
mod program {
    use core::hint::black_box;
    use staya_firmware::runtime;

    /// The part has nothing there.
    const NOWHERE: usize = if cfg!(part = "nrf51") { 0x7000_0000 } else { 0xF000_0000 };

    pub fn run() -> ! {
        let start = runtime::start();
        match start.boots {
            1 => panic!("on purpose on {}", start.part),
            2 => {
                // SAFETY: there is none: the exception is what is wanted, and nothing is read.
                let _ = unsafe { (black_box(NOWHERE) as *const u32).read_volatile() };
                runtime::exit(1)
            }
            boots => runtime::exit(if boots == 3 { 0 } else { 2 }),
        }
    }
}
