use crate::pace::RealTime;
use serde::Serialize;
use staya_controller::scalar::NumberFormat;
use staya_runner::{Spread, Statistics};
use std::fmt::Write as _;

/// The output of `--json`.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Summary {
    pub(crate) scenario: String,
    pub(crate) seed: u64,
    pub(crate) robots: usize,
    pub(crate) ticks: u32,
    pub(crate) sim_seconds: f64,
    /// Real time of the run, with the start of the devices.
    pub(crate) wall_seconds: f64,
    pub(crate) interrupted: bool,
    pub(crate) arrived: usize,
    pub(crate) collisions: u64,
    /// 16 hex digits, equal for equal traces.
    pub(crate) trace_hash: String,
    /// Number format of the robots in this process.
    pub(crate) numbers: NumberFormat,
    /// Trace hash of the scenario with all robots in this process; null if the run ended early.
    pub(crate) trace_hash_without_devices: Option<String>,
    pub(crate) real_time: Option<RealTime>,
    pub(crate) trouble: Option<String>,
    pub(crate) devices: Vec<Statistics>,
}

impl Summary {
    pub(crate) fn table(&self) -> Result<String, std::fmt::Error> {
        let mut text = String::new();
        let stopped = if self.interrupted { ", stopped" } else { "" };
        writeln!(text, "{} (seed {}{stopped})", self.scenario, self.seed)?;
        let mut line = |name: &str, value: String| writeln!(text, "  {name:<16}{value}");
        line("simulated", format!("{} s in {} ticks", self.sim_seconds, self.ticks))?;
        line("took", format!("{:.2} s", self.wall_seconds))?;
        line("arrived", format!("{} of {} robots", self.arrived, self.robots))?;
        line("collisions", self.collisions.to_string())?;
        line("trace hash", self.trace_hash.clone())?;
        if self.numbers != NumberFormat::F32 {
            line("numbers", self.numbers.to_string())?;
        }
        if let Some(hash) = &self.trace_hash_without_devices {
            let verdict = if *hash == self.trace_hash {
                "identical"
            } else {
                "different: the devices' numbers, capacities or resets differ"
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
        if self.devices.is_empty() {
            return Ok(text);
        }
        let width = self.devices.iter().map(|device| device.device.len() + 1).fold(24, usize::max);
        writeln!(
            text,
            "\n{:>6}  {:<width$}{:>7}{:>11}{:>16}{:>21}{:>8}{:>8}{:>7}",
            "robot", "device", "steps", "mismatches", "round trip ms", "instructions", "stack", "resent", "resets"
        )?;
        for device in &self.devices {
            let of = |spread: Option<Spread>, show: &dyn Fn(Spread) -> String| {
                spread.map_or_else(|| String::from("-"), show)
            };
            let ms = |us: u64| us as f64 / 1000.0;
            writeln!(
                text,
                "{:>6}  {:<width$}{:>7}{:>11}{:>16}{:>21}{:>8}{:>8}{:>7}",
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
            "round trip: median / p99; instructions (on boards: clock ticks) per step: median / max; stack: max bytes\n",
        );
        Ok(text)
    }
}
