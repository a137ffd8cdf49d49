//! Runs the canned swarm with MAVLink frames in fixed point, for parts with flash for part of the
//! swarms only; see `replay`.
#![cfg_attr(target_os = "none", no_std, no_main)]

staya_firmware::entry!(program::run);
staya_firmware::faults_are_printed!();

#[cfg(target_os = "none")]
mod program {
    use staya_cases::Summary;
    use staya_controller::scalar::Q16;
    use staya_firmware::runtime;

    pub fn run() -> ! {
        runtime::start();
        let mut print = |name: &str, number: &str, summary: &Summary| {
            runtime::print(format_args!("{name} {number} {summary}\n"));
        };
        staya_cases::in_mavlink::<Q16>("Q16", &mut print);
        runtime::exit(0)
    }
}
