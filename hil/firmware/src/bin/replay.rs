//! Runs the canned swarms and prints the lines of `tests/golden/cases.txt`.
#![cfg_attr(target_os = "none", no_std, no_main)]

staya_firmware::entry!(program::run);
staya_firmware::faults_are_printed!();

#[cfg(target_os = "none")]
mod program {
    use staya_cases::Summary;
    use staya_firmware::runtime;

    pub fn run() -> ! {
        runtime::start();
        #[cfg(not(part = "nrf51"))]
        staya_cases::every(print);
        #[cfg(part = "nrf51")]
        for &case in staya_cases::Case::ALL {
            // No FPU, and flash for one number format only; MAVLink is in `replay_mavlink`.
            use staya_controller::scalar::Q16;
            let summary = case.run::<Q16, _>(&mut staya_cases::Unmeasured);
            print(case.name(), "Q16", &summary);
        }
        runtime::exit(0)
    }

    fn print(name: &str, number: &str, summary: &Summary) {
        runtime::print(format_args!("{name} {number} {summary}\n"));
    }
}
