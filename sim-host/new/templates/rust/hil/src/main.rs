//! Robots of my-swarm, some of them on emulated parts or boards; the arguments are those of `staya hil`.

use my_swarm::Law;

fn main() -> std::process::ExitCode {
    staya_hil::Own::new(staya_hil::package!(), |_robot| Law::new(0.5, 0.02, 0.6)).main()
}
