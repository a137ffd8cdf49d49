//! Creates the agents of a scenario's robots, at each of their starts.

use super::{Agents, HostAgent};
use crate::radio::{self, HostWire};
use crate::scenario::Scenario;
use serde::{Deserialize, Serialize};
use staya_controller::agent::{Agent, AgentConfig, Task};
use staya_controller::auth::Key;
use staya_controller::geom::Torus;
use staya_controller::neighbor::{PlausibilityLimits, TrackParams, Tracker};
use staya_controller::wire::{Format, Ring};

/// A parameter that an intervention has changed permanently.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Tuned {
    pub(super) robot: Option<usize>,
    pub(super) name: String,
    pub(super) value: f32,
}

pub(super) struct Roster {
    agents: Agents,
    pub(super) seed: u64,
    pub(super) format: Format,
    key: Option<Key>,
    master: Option<Key>,
    plausibility: PlausibilityLimits<f32>,
    relays: u8,
    torus: Option<Torus<f32>>,
    tracking: Option<TrackParams<f32>>,
    pub(super) tuned: Vec<Tuned>,
}

impl Roster {
    pub(super) fn new(scenario: &Scenario, agents: Agents) -> Self {
        Self {
            agents,
            seed: scenario.seed,
            format: scenario.radio.format,
            key: scenario.key().cloned(),
            master: scenario.key_rotation().map(|keeping| keeping.master.clone()),
            plausibility: scenario.trust.plausibility,
            relays: scenario.radio.relays,
            torus: scenario.torus_m().map(|sides_m| Torus { size_m: sides_m.map(|side_m| side_m as f32) }),
            tracking: scenario.sensing().map(|sensing| sensing.tracking),
            tuned: Vec::new(),
        }
    }

    /// Adds what all robots share to the configuration of one after `starts` restarts.
    pub(super) fn config(&self, config: AgentConfig<f32>, starts: u32) -> AgentConfig<f32> {
        let Self { seed, plausibility, relays, .. } = *self;
        AgentConfig { boot: starts as u8, seed, plausibility, relays, ..config }
    }

    /// Creates the agent of robot `number` with a task after `starts` restarts; `previous` is its
    /// agent before the last one.
    pub(super) fn agent(
        &self,
        number: usize,
        (config, starts): (&AgentConfig<f32>, u32),
        task: &Task,
        previous: Option<&HostAgent>,
    ) -> HostAgent {
        let (law, safety) = (self.agents)(number);
        let wire = match &self.master {
            None => radio::wire(self.format, self.key.as_ref(), starts),
            // The last key survives a restart in persistent memory.
            Some(master) => {
                let ring = previous.and_then(|agent| ring(agent.wire()));
                let stored = ring.and_then(|ring| ring.seeds()[0].map(|(generation, seed)| (generation, seed.clone())));
                radio::own_wire(master, config.id, stored, starts)
            }
        };
        let tracker = self.tracking.map(|params| Box::new(Tracker::new(params)));
        let mut agent = Agent::with_perception(config, law, safety, wire, tracker);
        if let Some(torus) = self.torus {
            agent.set_torus(torus);
        }
        // Only laws without a task refuse it; the scenario was checked for that.
        let _ = agent.assign(task);
        for Tuned { robot, name, value } in &self.tuned {
            if robot.is_none_or(|robot| robot == number) {
                // A value that was refused once is refused again.
                let _ = agent.set_parameter(name, *value);
            }
        }
        agent
    }
}

/// The keys of an authenticated radio.
pub(super) fn ring(wire: &HostWire) -> Option<&Ring> {
    match wire {
        HostWire::Sealed(sealed) => Some(sealed.ring()),
        _ => None,
    }
}
