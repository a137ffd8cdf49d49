use crate::devices::DevicePlan;
use anyhow::{Result, bail};
use clap::Args;
use staya_controller::scalar::NumberFormat;
use staya_runner::{Device, LineFaults, Machine, Reset};
use staya_sim::scenario::Scenario;
use std::path::PathBuf;
use std::time::Duration;

/// Devices, their robots and faults.
#[derive(Args, Clone, Debug)]
pub struct DeviceArgs {
    /// Device of a robot: qemu:stm32f405, qemu:microbit, qemu:riscv32 (with ,numbers=f32, fast32 or
    /// q16) or serial:PORT[,baud=N]; may be repeated for a mix.
    #[arg(long = "device", value_name = "DEVICE")]
    kinds: Vec<Device>,
    /// Number of robots on devices: the first ones of the scenario, with device kinds in turn
    /// [default: one per --device].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    devices: Option<u32>,
    /// Run in real time and count late ticks.
    #[arg(long)]
    pub(crate) real_time: bool,
    /// Firmware of emulated devices: a folder with PART/lockstep, or one ELF file [default:
    /// $STAYA_FIRMWARE, or firmware installed beside this program, or built from the sources of
    /// this program].
    #[arg(long, value_name = "DIR|FILE")]
    pub(crate) firmware: Option<PathBuf>,
    /// Folder for the logs of emulated devices, one file per robot [default: no logs].
    #[arg(long, value_name = "DIR")]
    pub(crate) logs: Option<PathBuf>,
    /// Probability that a frame between host and device is lost.
    #[arg(long, value_name = "P", default_value_t = 0.0, value_parser = probability, help_heading = "Faults of the line")]
    loss: f64,
    /// Probability that a bit between host and device is flipped.
    #[arg(long, value_name = "P", default_value_t = 0.0, value_parser = probability, help_heading = "Faults of the line")]
    bit_errors: f64,
    /// Delay of each frame, milliseconds.
    #[arg(long, value_name = "MS", default_value_t = 0, value_parser = clap::value_parser!(u64).range(..=10_000), help_heading = "Faults of the line")]
    delay: u64,
    /// Reset the devices one after the other from this tick; may be repeated.
    #[arg(long, value_name = "TICK", help_heading = "Faults of the line")]
    reset: Vec<u32>,
    /// Ticks for which a robot stops after its device was reset.
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..), help_heading = "Faults of the line")]
    down: u32,
}

fn probability(text: &str) -> Result<f64, String> {
    let value: Option<f64> = text.parse().ok();
    value.filter(|value| (0.0..1.0).contains(value)).ok_or_else(|| String::from("give a number from 0 to below 1"))
}

impl DeviceArgs {
    pub(crate) fn plan(&self, scenario: &Scenario) -> Result<DevicePlan> {
        let count = self.devices.map_or(self.kinds.len(), |n| n as usize);
        let (robots, numbers) = (scenario.robots.len(), scenario.laws.numbers);
        if self.kinds.is_empty() && (count > 0 || numbers == NumberFormat::F32) {
            bail!("no device; give --device qemu:stm32f405, or another one of --help");
        }
        if count > robots {
            bail!("--devices {count}: {} has {robots} robots; give at most this number", scenario.name);
        }
        if count < self.kinds.len() {
            bail!(
                "--devices {count}: fewer than the {} given with --device; give at least this number",
                self.kinds.len()
            );
        }
        let mut devices: Vec<(usize, Device)> = Vec::new();
        // A port has one board; the number of emulators is unlimited.
        let emulated: Vec<&Device> = self.kinds.iter().filter(|kind| is_emulated(kind)).collect();
        for index in 0..count {
            let device = match self.kinds.get(index) {
                Some(device) => device,
                None if emulated.is_empty() => {
                    bail!(
                        "--devices {count}: a port has one board, and {} are given with --device; add --device options",
                        self.kinds.len()
                    )
                }
                None => emulated[(index - self.kinds.len()) % emulated.len()],
            };
            if !is_emulated(device) && devices.iter().any(|(_, other)| other == device) {
                bail!("--device {device} is given twice; give each port once, since it has one board");
            }
            devices.push((index, in_numbers(device, numbers)?));
        }
        Ok(DevicePlan {
            devices,
            faults: LineFaults {
                loss: self.loss,
                bit_errors: self.bit_errors,
                delay: Duration::from_millis(self.delay),
                seed: scenario.seed,
            },
            resets: self.reset.iter().map(|&tick| Reset { tick, down_ticks: self.down }).collect(),
        })
    }
}

pub(crate) fn emulated(plan: &DevicePlan) -> Vec<Machine> {
    let mut machines: Vec<Machine> = Vec::new();
    for (_, device) in &plan.devices {
        if let Device::Emulated(machine) = device
            && !machines.contains(machine)
        {
            machines.push(*machine);
        }
    }
    machines
}

/// A device that the user gave no number format has that of the scenario.
fn in_numbers(device: &Device, numbers: NumberFormat) -> Result<Device> {
    match device {
        Device::Emulated(Machine { part, numbers: None }) if numbers != NumberFormat::F32 => {
            if !part.numbers().contains(&numbers) {
                bail!(
                    "--device {device}: the part does not compute in the scenario's numbers = \"{numbers}\"; add `,numbers=FORMAT` \
                     to the device, or change the scenario"
                );
            }
            Ok(Device::Emulated(Machine { part: *part, numbers: Some(numbers) }))
        }
        _ => Ok(device.clone()),
    }
}

fn is_emulated(device: &Device) -> bool {
    matches!(device, Device::Emulated(_))
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;
    use staya_sim::scenario::Overrides;

    #[derive(Parser)]
    struct Line {
        #[command(flatten)]
        devices: DeviceArgs,
    }

    fn plan(arguments: &str) -> Result<Vec<(usize, String)>, String> {
        let line = Line::try_parse_from(format!("hil {arguments}").split_whitespace());
        let line = line.map_err(|error| error.to_string())?;
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
        let path = path.join("../../scenarios/six-robots.toml");
        let scenario = Scenario::load(&path, &Overrides::default()).expect("a good scenario");
        let plan = line.devices.plan(&scenario).map_err(|error| error.to_string())?;
        let devices = plan.devices.into_iter();
        Ok(devices.map(|(at, device)| (at, device.to_string())).collect())
    }

    #[test]
    fn device_kinds_repeat_in_turn_except_ports() {
        let names = |arguments: &str| {
            let devices = plan(arguments).expect(arguments).into_iter().enumerate();
            let named = devices.map(|(at, (index, name))| {
                assert_eq!(at, index);
                name
            });
            named.collect::<Vec<_>>().join(" ")
        };
        assert_eq!(names("--device qemu:microbit"), "qemu:microbit");
        assert_eq!(
            names("--device qemu:stm32f405 --device serial:/dev/x --device qemu:riscv32 --devices 6"),
            "qemu:stm32f405 serial:/dev/x,baud=115200 qemu:riscv32 qemu:stm32f405 qemu:riscv32 qemu:stm32f405"
        );
    }

    #[test]
    fn impossible_plans_are_errors_with_a_reason() {
        for (arguments, why) in [
            ("--device qemu:z80", "no part `z80`"),
            ("--device qemu:stm32f405 --devices 7", "has 6 robots"),
            ("--device serial:/dev/x --devices 2", "a port has one board"),
            ("--device serial:/dev/x --device serial:/dev/x", "given twice"),
            ("--device qemu:microbit --device qemu:riscv32 --devices 1", "fewer than the 2"),
            ("--device qemu:microbit --loss 1", "below 1"),
            ("", "give --device"),
            ("--devices 2", "give --device"),
        ] {
            let error = plan(arguments).expect_err(arguments);
            assert!(error.contains(why), "{arguments}: {error}");
        }
    }
}
