//! Robots whose controllers run on emulated parts or on boards, as the engine sees them.

use staya_controller::agent::{AnyInputs, Setup, Task};
use staya_controller::time::Instant;
use staya_numbers::decision;
use staya_runner::{Answer, Cause, Device, DeviceConfig, Fleet, LineFaults, Load, Options, Reset, Statistics};
use staya_sim::engine::{Decision, ExternalController};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

#[derive(Clone, Debug)]
pub struct DevicePlan {
    /// Index and device of each robot, by index.
    pub devices: Vec<(usize, Device)>,
    /// Faults of all serial links.
    pub faults: LineFaults,
    /// Times of planned restarts. At each, the devices restart one per tick.
    pub resets: Vec<Reset>,
}

/// Results of the devices, shared by all clones.
#[derive(Clone, Debug, Default)]
pub struct Log(Arc<Mutex<Entries>>);

#[derive(Debug, Default)]
struct Entries {
    trouble: Option<String>,
    statistics: Vec<Statistics>,
    loads: Vec<(usize, Load)>,
}

impl Log {
    fn entries(&self) -> MutexGuard<'_, Entries> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The first error, which should end the run.
    #[must_use]
    pub fn trouble(&self) -> Option<String> {
        self.entries().trouble.clone()
    }

    /// `None` if the robot runs on no device.
    #[must_use]
    pub fn load(&self, index: usize) -> Option<Load> {
        let entries = self.entries();
        let at = entries.loads.binary_search_by_key(&index, |(robot, _)| *robot).ok()?;
        entries.loads.get(at).map(|(_, load)| *load)
    }

    #[must_use]
    pub fn statistics(&self) -> Vec<Statistics> {
        self.entries().statistics.clone()
    }
}

pub struct OnDevices {
    plan: DevicePlan,
    options: Option<Options>,
    law: Box<dyn Fn(usize) -> Vec<u8> + Send>,
    orders: Vec<Option<DeviceConfig>>,
    fleet: Option<Fleet>,
    asked: Vec<usize>,
    decisions: Vec<Option<Decision>>,
    /// These devices were reset, and their robots did not restart yet.
    lost: Vec<bool>,
    log: Log,
}

impl OnDevices {
    #[must_use]
    pub fn new(plan: DevicePlan, options: Options, law: Box<dyn Fn(usize) -> Vec<u8> + Send>) -> (Self, Log) {
        let (log, count) = (Log::default(), plan.devices.len());
        let devices = Self {
            plan,
            options: Some(options),
            law,
            orders: (0..count).map(|_| None).collect(),
            fleet: None,
            asked: Vec::new(),
            decisions: vec![None; count],
            lost: vec![false; count],
            log: log.clone(),
        };
        (devices, log)
    }

    fn at(&self, index: usize) -> Option<usize> {
        let devices = &self.plan.devices;
        devices.binary_search_by_key(&index, |(robot, _)| *robot).ok()
    }

    fn fail(&self, trouble: String) {
        self.log.entries().trouble.get_or_insert(trouble);
    }

    fn begin(&mut self) {
        let Some(options) = self.options.take() else {
            return;
        };
        let orders: Option<Vec<DeviceConfig>> = self.orders.iter_mut().map(Option::take).collect();
        // The engine starts all robots before the first step.
        let Some(orders) = orders else {
            return self.fail(String::from("a robot on a device was never started"));
        };
        match Fleet::start(orders, options) {
            Ok(fleet) => self.fleet = Some(fleet),
            Err(error) => self.fail(error.to_string()),
        }
    }

    fn gather(&mut self) {
        let Some(fleet) = &mut self.fleet else {
            return;
        };
        let answers = fleet.collect();
        let robots = self.plan.devices.iter().map(|(robot, _)| *robot);
        self.log.entries().loads = robots.zip(fleet.loads()).collect();
        for (at, answer) in std::mem::take(&mut self.asked).into_iter().zip(answers) {
            match answer {
                Answer::Decided(result) => {
                    self.decisions[at] = Some(decision(*result));
                }
                Answer::Down => self.lost[at] = true,
                Answer::Mismatch(mismatch) => self.fail(mismatch.to_string()),
                Answer::Failed(error) => match *error.cause {
                    Cause::Stopped => {}
                    _ => self.fail(error.to_string()),
                },
            }
        }
    }
}

impl ExternalController for OnDevices {
    fn robots(&self) -> Vec<usize> {
        self.plan.devices.iter().map(|&(index, _)| index).collect()
    }

    fn start(&mut self, index: usize, setup: Setup, task: Task) {
        let Some(at) = self.at(index) else { return };
        if let Some(fleet) = &mut self.fleet {
            fleet.assign(at, setup, Some(task));
            return;
        }
        let resets =
            self.plan.resets.iter().map(|reset| Reset { tick: reset.tick.saturating_add(at as u32), ..*reset });
        self.orders[at] = Some(DeviceConfig {
            device: self.plan.devices[at].1.to_string(),
            setup,
            task: Some(task),
            law: (self.law)(index),
            faults: self.plan.faults,
            resets: resets.collect(),
        });
    }

    fn has_restarted(&mut self, index: usize) -> bool {
        // The fleet has configured the device again, but only the engine knows its present task.
        let (Some(at), Some(fleet)) = (self.at(index), &self.fleet) else {
            return false;
        };
        self.lost[at] && !fleet.is_down(at) && std::mem::take(&mut self.lost[at])
    }

    fn send(&mut self, index: usize, tick: u32, now: Instant, inputs: &AnyInputs<'_, f32>) {
        self.begin();
        if let (Some(at), Some(fleet)) = (self.at(index), &mut self.fleet) {
            self.asked.push(at);
            fleet.send(at, tick, now, inputs);
        }
    }

    fn collect(&mut self, index: usize) -> Option<Decision> {
        // The first call collects the answers of all devices.
        if !self.asked.is_empty() {
            self.gather();
        }
        let at = self.at(index)?;
        self.decisions[at].take()
    }
}

impl Drop for OnDevices {
    fn drop(&mut self) {
        if let Some(fleet) = &self.fleet {
            self.log.entries().statistics = fleet.statistics();
        }
    }
}
