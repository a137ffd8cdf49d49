//! Robots on devices beside robots of this process that compute in the scenario's number format.

use crate::devices::OnDevices;
use crate::swarm::{MakeRobot, Swarm};
use anyhow::Result;
use staya_controller::agent::{AnyInputs, Setup, Task};
use staya_controller::scalar::NumberFormat;
use staya_controller::time::Instant;
use staya_numbers::{OnHost, Trouble};
use staya_sim::engine::{Decision, ExternalController};
use staya_sim::scenario::Scenario;

type Law = Box<dyn Fn(usize) -> Vec<u8> + Send>;

/// How robots of this process compute that the engine cannot step.
pub struct Others<'a> {
    numbers: NumberFormat,
    count: usize,
    make: MakeRobot,
    law: Box<dyn Fn() -> Law + 'a>,
}

impl<'a> Others<'a> {
    /// `None` if they compute in `f32`, as the engine does.
    pub fn of(swarm: &'a impl Swarm, scenario: &Scenario) -> Result<Option<Self>> {
        let numbers = scenario.laws.numbers;
        if numbers == NumberFormat::F32 {
            return Ok(None);
        }
        let (count, make) = (scenario.robots.len(), swarm.robot_in(numbers)?);
        Ok(Some(Self { numbers, count, make, law: Box::new(|| swarm.law()) }))
    }

    pub const fn numbers(&self) -> NumberFormat {
        self.numbers
    }

    /// All robots but those with these indices, which are sorted.
    pub fn except(&self, indices: &[usize]) -> OnHost {
        let here = (0..self.count).filter(|index| indices.binary_search(index).is_err());
        OnHost::new(here, &self.make, (self.law)())
    }
}

pub struct Mixed {
    devices: OnDevices,
    on_devices: Vec<usize>,
    others: Option<OnHost>,
}

impl Mixed {
    pub fn new(devices: OnDevices, others: Option<&Others<'_>>) -> Self {
        let on_devices = devices.robots();
        let others = others.map(|others| others.except(&on_devices));
        Self { devices, on_devices, others }
    }

    /// The first error of a robot of this process.
    pub fn trouble(&self) -> Option<Trouble> {
        self.others.as_ref().map(OnHost::trouble)
    }

    pub fn has_devices(&self) -> bool {
        !self.on_devices.is_empty()
    }

    fn of(&mut self, index: usize) -> &mut dyn ExternalController {
        match &mut self.others {
            Some(others) if self.on_devices.binary_search(&index).is_err() => others,
            _ => &mut self.devices,
        }
    }
}

impl ExternalController for Mixed {
    fn robots(&self) -> Vec<usize> {
        let others = self.others.iter().flat_map(OnHost::robots);
        let mut robots: Vec<usize> = self.on_devices.iter().copied().chain(others).collect();
        robots.sort_unstable();
        robots
    }

    fn start(&mut self, index: usize, setup: Setup, task: Task) {
        self.of(index).start(index, setup, task);
    }

    fn has_restarted(&mut self, index: usize) -> bool {
        self.of(index).has_restarted(index)
    }

    fn send(&mut self, index: usize, tick: u32, now: Instant, inputs: &AnyInputs<'_, f32>) {
        self.of(index).send(index, tick, now, inputs);
    }

    fn collect(&mut self, index: usize) -> Option<Decision> {
        self.of(index).collect(index)
    }
}
