//! The microcontrollers that there is firmware for.

/// A microcontroller that there is firmware for.
pub struct Part {
    /// As in `hil/firmware` and on the command line.
    pub name: &'static str,
    /// What its code is compiled for.
    pub target: &'static str,
    /// The emulator that runs it.
    pub emulator: &'static str,
}

/// Every part.
pub const PARTS: [Part; 3] = [
    Part { name: "stm32f405", target: "thumbv7em-none-eabihf", emulator: "qemu-system-arm" },
    Part { name: "nrf51", target: "thumbv6m-none-eabi", emulator: "qemu-system-arm" },
    Part { name: "riscv32", target: "riscv32imac-unknown-none-elf", emulator: "qemu-system-riscv32" },
];

/// The part of this name.
pub fn part(name: &str) -> Option<&'static Part> {
    PARTS.iter().find(|part| part.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_part_is_found_by_its_name() {
        for wanted in &PARTS {
            assert_eq!(part(wanted.name).map(|found| found.target), Some(wanted.target));
        }
        assert!(part("stm32").is_none());
    }
}
