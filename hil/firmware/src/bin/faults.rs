//! Fails on purpose, for `cargo xtask test`: a panic in the first start, a processor exception in
//! the second. The third ends the emulator.
#![cfg_attr(target_os = "none", no_std, no_main)]

staya_firmware::entry!(program::run);
staya_firmware::faults_go_over_the_link!();

#[cfg(target_os = "none")]
mod program {
    use core::hint::black_box;
    use staya_firmware::runtime;

    const NOWHERE: usize = if cfg!(part = "nrf51") { 0x7000_0000 } else { 0xF000_0000 };

    pub fn run() -> ! {
        let start = runtime::start();
        match start.boots {
            1 => panic!("on purpose on {}", start.part),
            2 => {
                // SAFETY: unsound on purpose: the read raises the exception under test.
                let _ = unsafe { (black_box(NOWHERE) as *const u32).read_volatile() };
                runtime::exit(1)
            }
            boots => runtime::exit(if boots == 3 { 0 } else { 2 }),
        }
    }
}
