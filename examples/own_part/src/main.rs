//! Twenty robots on patrol, some of them emulated or boards; takes the options of `staya hil`.

use patrol::Patrol;

fn main() -> std::process::ExitCode {
    staya_hil::Own::new(staya_hil::package!(), |_robot| Patrol::RING).in_fixed_point().main()
}
