//! `staya hil SCENARIO`: some of the robots run as firmware on emulated parts or boards, in lockstep with the rest.

mod devices;
mod firmware;

use crate::run::ScenarioArgs;
use anyhow::{Context as _, Result, bail};
use clap::Args;
use devices::{DevicePlan, Log, OnDevices};
use serde::Serialize;
use staya_console::{Ended, Global, Progress, Stop, print, print_json};
use staya_controller::formation::published::FormationLaw;
use staya_runner::{Device, LineFaults, Options, Part, Reset, Spread, Statistics};
use staya_sim::engine::{Moment, Outcome, simulate, simulate_with};
use staya_sim::expected::Expected;
use staya_sim::record::RobotRow;
use staya_sim::scenario::Scenario;
use staya_view::watch::{About, DeviceFigures, Insight};
use std::fmt::Write as _;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// Run some robots of a scenario as firmware, on emulated microcontrollers or boards.
///
/// The other robots run in this process. For every robot on a device a shadow runs here too: the first step at which both differ
/// by a bit ends the run and is printed. Exit code 1 if that happens, or a device falls silent.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Examples:\n  staya hil scenarios/six-robots.toml --device qemu:stm32f405 --devices 4\n  \
    staya hil scenarios/swap-circle.toml --device qemu:stm32f405 --device qemu:microbit --devices 6\n  \
    staya hil scenarios/six-robots.toml --device serial:/dev/ttyACM0,baud=115200 --real-time")]
pub struct HilArgs {
    #[command(flatten)]
    scenario: ScenarioArgs,
    /// Where a robot runs: qemu:stm32f405, qemu:microbit, qemu:riscv32 or serial:PORT[,baud=N]; may be repeated to mix kinds.
    #[arg(long = "device", value_name = "DEVICE", required = true)]
    kinds: Vec<Device>,
    /// How many robots run on devices: the first ones of the scenario, kinds taken in turn [default: one per --device].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    devices: Option<u32>,
    /// Run in real time, and count the ticks that are late.
    #[arg(long)]
    real_time: bool,
    #[command(flatten)]
    page: crate::watch::WatchArgs,
    /// Folder with firmware, PART/lockstep [default: $STAYA_FIRMWARE, or the repository's target/firmware (`cargo run` there builds
    /// it when needed), or ~/.local/share/staya/firmware].
    #[arg(long, value_name = "DIR")]
    firmware: Option<PathBuf>,
    /// Folder for the logs of emulated devices, one file per robot [default: no logs].
    #[arg(long, value_name = "DIR")]
    logs: Option<PathBuf>,
    /// Probability that a frame between host and device is lost.
    #[arg(long, value_name = "P", default_value_t = 0.0, value_parser = probability, help_heading = "Faults of the line")]
    loss: f64,
    /// Probability that a bit between host and device flips.
    #[arg(long, value_name = "P", default_value_t = 0.0, value_parser = probability, help_heading = "Faults of the line")]
    bit_errors: f64,
    /// Delay of each frame, milliseconds.
    #[arg(long, value_name = "MS", default_value_t = 0, value_parser = clap::value_parser!(u64).range(..=10_000), help_heading = "Faults of the line")]
    delay: u64,
    /// Reset the devices one after the other from this tick on; may be repeated.
    #[arg(long, value_name = "TICK", help_heading = "Faults of the line")]
    reset: Vec<u32>,
    /// Ticks for which a robot that was reset stands still.
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..), help_heading = "Faults of the line")]
    down: u32,
}

fn probability(text: &str) -> Result<f64, String> {
    let value: Option<f64> = text.parse().ok();
    value.filter(|value| (0.0..1.0).contains(value)).ok_or_else(|| String::from("a number from 0 to less than 1"))
}

/// The figures of a run, as with `--json`.
#[derive(Clone, Debug, Serialize)]
struct Summary {
    scenario: String,
    seed: u64,
    robots: usize,
    /// Ticks done.
    ticks: u32,
    sim_seconds: f64,
    /// Of the run, starting the devices included.
    wall_seconds: f64,
    /// Stopped by Ctrl-C.
    interrupted: bool,
    arrived: usize,
    collisions: u64,
    /// 16 hex digits; equal for equal traces.
    trace_hash: String,
    /// The same scenario with all robots in this process; null when the run ended early.
    trace_hash_without_devices: Option<String>,
    /// With `--real-time`.
    real_time: Option<RealTime>,
    /// What ended the run, if it did not end by itself.
    trouble: Option<String>,
    devices: Vec<Statistics>,
}

/// How a run kept up with the clock.
#[derive(Clone, Copy, Debug, Serialize)]
struct RealTime {
    tick_seconds: f64,
    /// Ticks whose work was not done when the next one was due.
    deadlines_missed: u32,
    /// The longest that a tick's work took, seconds.
    slowest_seconds: f64,
}

impl HilArgs {
    /// Runs the command.
    ///
    /// # Errors
    /// A scenario that cannot be read or is wrong; devices or firmware that are not there; a device that fell silent or differed
    /// from its shadow.
    pub fn run(&self, global: &Global) -> Result<Ended> {
        let scenario = self.scenario.load()?;
        if scenario.published.is_some() || scenario.looks_ahead {
            let law = if scenario.looks_ahead { FormationLaw::Lookahead } else { FormationLaw::Paper };
            bail!("formation.law = \"{law}\" is in no firmware; give \"staya\", or run it without devices");
        }
        if scenario.maps.is_some() {
            bail!("maps.share is in no firmware for devices; leave [maps] out, or run it without devices");
        }
        if scenario.eyes.is_some() {
            bail!("no link tells devices whom they see (plane.eyes); leave it out, or run it without devices");
        }
        if scenario.key.is_some() {
            bail!(
                "the robots of {} have a key, and the link does not carry keys to devices; leave [authentication] out",
                scenario.name
            );
        }
        let plan = self.plan(&scenario)?;
        let mut parts: Vec<Part> = Vec::new();
        for (_, device) in &plan.devices {
            if let Device::Emulated(part) = device
                && !parts.contains(part)
            {
                parts.push(*part);
            }
        }
        let mut options = Options::new(firmware::folder(&parts, self.firmware.as_deref())?);
        if let Some(folder) = &self.logs {
            std::fs::create_dir_all(folder).with_context(|| format!("{}", folder.display()))?;
            options.logs = Some(folder.clone());
        }
        let stop = Stop::on_ctrl_c()?;
        options.stop = stop.flag();
        let summary = self.drive(&scenario, plan, options, &stop, global)?;
        if global.json {
            print_json(&summary)?;
        } else if !summary.devices.is_empty() {
            print(&summary.table()?)?;
        }
        match summary.trouble {
            Some(trouble) => bail!("{}", trouble.trim_end()),
            None => Ok(Ended::by(&stop)),
        }
    }

    /// Which robots run where.
    fn plan(&self, scenario: &Scenario) -> Result<DevicePlan> {
        let count = self.devices.map_or(self.kinds.len(), |n| n as usize);
        let robots = scenario.robots.len();
        if count > robots {
            bail!("--devices {count}: {} has {robots} robots", scenario.name);
        }
        if count < self.kinds.len() {
            bail!("--devices {count}: fewer than the {} given with --device", self.kinds.len());
        }
        let mut devices: Vec<(usize, Device)> = Vec::new();
        // A port has one board; emulators there are as many as anybody wants.
        let emulated: Vec<&Device> = self.kinds.iter().filter(|kind| is_emulated(kind)).collect();
        for index in 0..count {
            let device = match self.kinds.get(index) {
                Some(device) => device,
                None if emulated.is_empty() => {
                    bail!("--devices {count}: a port has one board, and {} are given with --device", self.kinds.len())
                }
                None => emulated[(index - self.kinds.len()) % emulated.len()],
            };
            if !is_emulated(device) && devices.iter().any(|(_, other)| other == device) {
                bail!("--device {device} is given twice: a port has one board");
            }
            devices.push((index, device.clone()));
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

    fn drive(
        &self,
        scenario: &Scenario,
        plan: DevicePlan,
        options: Options,
        stop: &Stop,
        global: &Global,
    ) -> Result<Summary> {
        let began = Instant::now();
        let (devices, log) = OnDevices::new(plan, options);
        let mut progress = Progress::new(&scenario.name, scenario.ticks.into(), global);
        let count = scenario.robots.len();
        let mut pace = self.real_time.then(|| Pace::new(scenario.tick_s()));
        let mut page = self.page.watcher(scenario)?;
        let mut expected = Expected::new(scenario.ticks);
        let mut watch = |moment: &Moment<'_>, robots: &mut dyn Iterator<Item = RobotRow>| {
            let mut robots = robots.inspect(|robot| expected.see(robot));
            if let Some(page) = &mut page
                && page.is_due()
            {
                page.show(moment, &mut robots, &log);
            } else {
                robots.for_each(drop);
            }
            progress.of(expected.ticks(moment.row.tick).into());
            progress.set(moment.row.tick.into(), || format!("ticks, {} of {count} robots arrived", moment.arrived));
            if stop.is_requested() || log.trouble().is_some() {
                return ControlFlow::Break(());
            }
            if let Some(pace) = &mut pace {
                pace.wait(moment.row.tick, stop);
            }
            ControlFlow::Continue(())
        };
        let outcome = simulate_with(scenario, Some(Box::new(devices)), &mut watch);
        let outcome = outcome.context("the robots cannot be placed")?;
        progress.finish();
        let (trouble, interrupted) = (log.trouble(), stop.is_requested());
        let wall_seconds = began.elapsed().as_secs_f64();
        let without = if trouble.is_none() && !interrupted {
            let outcome = simulate(scenario, |_, _| ControlFlow::Continue(()));
            Some(outcome.context("the robots cannot be placed")?)
        } else {
            None
        };
        let hash = |outcome: &Outcome| format!("{:016x}", outcome.trace_hash);
        Ok(Summary {
            scenario: scenario.name.clone(),
            seed: scenario.seed,
            robots: count,
            ticks: outcome.ticks,
            sim_seconds: outcome.seconds,
            wall_seconds,
            interrupted,
            arrived: outcome.arrived,
            collisions: outcome.collisions,
            trace_hash: hash(&outcome),
            trace_hash_without_devices: without.as_ref().map(hash),
            real_time: pace.map(|pace| pace.report),
            trouble,
            devices: log.statistics(),
        })
    }
}

impl Insight for Log {
    fn about(&self, index: usize) -> About {
        let device = self.load(index).map(|load| DeviceFigures {
            instructions: load.instructions,
            most_instructions: load.most_instructions,
            ticks: load.ticks,
            stack: load.stack_bytes,
            mismatches: load.mismatches,
            steps: load.steps,
            resets: load.resets,
        });
        About { device, ..About::default() }
    }
}

fn is_emulated(device: &Device) -> bool {
    matches!(device, Device::Emulated(_))
}

/// Keeps a run to the clock.
struct Pace {
    report: RealTime,
    /// When tick 0 began, and since when the present one is at work.
    began: Option<(Instant, Instant)>,
}

impl Pace {
    const fn new(tick_seconds: f64) -> Self {
        Self { report: RealTime { tick_seconds, deadlines_missed: 0, slowest_seconds: 0.0 }, began: None }
    }

    /// Waits until the tick after `ticks` ticks is due. Those that came late are not made up for: the clock starts anew with them.
    /// The first tick does not count: it starts the devices.
    fn wait(&mut self, ticks: u32, stop: &Stop) {
        let now = Instant::now();
        let tick = Duration::from_secs_f64(self.report.tick_seconds);
        let due = match self.began {
            Some((due, since)) if ticks > 1 => {
                let took = now.duration_since(since).as_secs_f64();
                self.report.slowest_seconds = self.report.slowest_seconds.max(took);
                let next = due + tick;
                if now > next {
                    self.report.deadlines_missed += 1;
                }
                next.max(now)
            }
            _ => now,
        };
        while !stop.is_requested() {
            let left = due.saturating_duration_since(Instant::now());
            if left.is_zero() {
                break;
            }
            // Looks at the request to stop now and then.
            std::thread::sleep(left.min(Duration::from_millis(100)));
        }
        self.began = Some((due, Instant::now()));
    }
}

impl Summary {
    /// The figures for a reader.
    fn table(&self) -> Result<String, std::fmt::Error> {
        let mut text = String::new();
        let stopped = if self.interrupted { ", stopped" } else { "" };
        writeln!(text, "{} (seed {}{stopped})", self.scenario, self.seed)?;
        let mut line = |name: &str, value: String| writeln!(text, "  {name:<16}{value}");
        line("simulated", format!("{} s in {} ticks", self.sim_seconds, self.ticks))?;
        line("took", format!("{:.2} s", self.wall_seconds))?;
        line("arrived", format!("{} of {} robots", self.arrived, self.robots))?;
        line("collisions", self.collisions.to_string())?;
        line("trace hash", self.trace_hash.clone())?;
        if let Some(hash) = &self.trace_hash_without_devices {
            let verdict = if *hash == self.trace_hash {
                "the same"
            } else {
                "another one: numbers, capacities or resets of the devices differ"
            };
            line("without devices", format!("{hash}, {verdict}"))?;
        }
        if let Some(pace) = &self.real_time {
            line(
                "real time",
                format!(
                    "{} of {} deadlines of {} s missed, slowest tick {:.4} s",
                    pace.deadlines_missed, self.ticks, pace.tick_seconds, pace.slowest_seconds
                ),
            )?;
        }
        writeln!(
            text,
            "\n{:>6}  {:<24}{:>7}{:>11}{:>16}{:>21}{:>8}{:>8}{:>7}",
            "robot", "device", "steps", "mismatches", "round trip ms", "instructions", "stack", "resent", "resets"
        )?;
        for device in &self.devices {
            let of = |spread: Option<Spread>, show: &dyn Fn(Spread) -> String| {
                spread.map_or_else(|| String::from("-"), show)
            };
            let ms = |us: u64| us as f64 / 1000.0;
            writeln!(
                text,
                "{:>6}  {:<24}{:>7}{:>11}{:>16}{:>21}{:>8}{:>8}{:>7}",
                device.robot,
                device.device,
                device.steps,
                device.mismatches,
                of(device.round_trip_us, &|s| format!("{:.1} / {:.1}", ms(s.median), ms(s.p99))),
                of(device.instructions.or(device.ticks), &|s| format!("{} / {}", s.median, s.max)),
                device.stack_bytes,
                device.resent,
                device.resets
            )?;
        }
        text.push_str(
            "round trip: median / p99; instructions (of boards: clock ticks) of a step: median / most; stack: most bytes of a step\n",
        );
        Ok(text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;
    use staya_sim::scenario::Overrides;

    #[derive(Parser)]
    struct Line {
        #[command(flatten)]
        hil: HilArgs,
    }

    fn plan(arguments: &str) -> Result<Vec<(usize, String)>, String> {
        let line = Line::try_parse_from(format!("hil s.toml {arguments}").split_whitespace());
        let line = line.map_err(|error| error.to_string())?;
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
        let path = path.join("../scenarios/six-robots.toml");
        let scenario = Scenario::load(&path, &Overrides::default()).expect("a good scenario");
        let plan = line.hil.plan(&scenario).map_err(|error| error.to_string())?;
        let devices = plan.devices.into_iter();
        Ok(devices.map(|(at, device)| (at, device.to_string())).collect())
    }

    #[test]
    fn kinds_are_taken_in_turn_and_a_port_once() {
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
    fn plans_that_cannot_be_carried_out_say_why() {
        for (arguments, why) in [
            ("--device qemu:z80", "no part `z80`"),
            ("--device qemu:stm32f405 --devices 7", "has 6 robots"),
            ("--device serial:/dev/x --devices 2", "a port has one board"),
            ("--device serial:/dev/x --device serial:/dev/x", "given twice"),
            ("--device qemu:microbit --device qemu:riscv32 --devices 1", "fewer than the 2"),
            ("--device qemu:microbit --loss 1", "less than 1"),
            ("", "--device"),
        ] {
            let error = plan(arguments).expect_err(arguments);
            assert!(error.contains(why), "{arguments}: {error}");
        }
    }
}
