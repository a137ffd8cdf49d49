//! Runs robots of my-swarm, some on emulated parts or boards, with the arguments of `staya hil`.

use my_swarm::MyLaw;

fn main() -> std::process::ExitCode {
    staya_hil::Own::new(staya_hil::package!(), |_robot| MyLaw::new(0.5, 0.02, 0.6))MY_FORMATS.main()
}
