//! Runs those canned swarms in fixed point for which `replay` has no room on a part with little
//! flash.
#![cfg_attr(target_os = "none", no_std, no_main)]

staya_firmware::entry!(program::run);
staya_firmware::faults_are_printed!();

#[cfg(target_os = "none")]
mod program {
    use staya_cases::Case;
    use staya_controller::scalar::Q16;
    use staya_firmware::{runtime, swarms};

    pub fn run() -> ! {
        runtime::start();
        swarms::replay(Case::Lattice);
        swarms::replay(Case::GoalFlock);
        swarms::replay(Case::Boids);
        staya_cases::in_mavlink::<Q16>("Q16", &mut swarms::print);
        runtime::exit(0)
    }
}
