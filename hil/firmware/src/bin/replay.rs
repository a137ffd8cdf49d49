//! Runs the canned swarms and prints the lines of `tests/golden/cases.txt`; on a part with little
//! flash, those before the ones of `replay_rest`, in fixed point.
#![cfg_attr(target_os = "none", no_std, no_main)]

staya_firmware::entry!(program::run);
staya_firmware::faults_are_printed!();

#[cfg(target_os = "none")]
mod program {
    use staya_firmware::{runtime, swarms};

    pub fn run() -> ! {
        runtime::start();
        #[cfg(not(part = "nrf51"))]
        staya_cases::every(swarms::print);
        #[cfg(part = "nrf51")]
        {
            use staya_cases::Case;
            swarms::replay(Case::Route);
            swarms::replay(Case::Formation);
            swarms::replay(Case::FormationReflexive);
            swarms::replay(Case::Packets);
            swarms::replay(Case::RouteInPlane);
            swarms::replay(Case::OrcaAnalytic);
            swarms::replay(Case::OrcaTemplate2k);
            swarms::replay(Case::Doorway);
            swarms::replay(Case::Fly);
            swarms::replay(Case::PushOut);
        }
        runtime::exit(0)
    }
}
