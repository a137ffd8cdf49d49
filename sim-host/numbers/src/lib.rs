//! Robots of a scenario with `numbers = "fast32"`, `"q16"` or `"f64"`: the engine computes in
//! `f32`, so these are external to it, in this process.
//!
//! A program of its own, not part of the engine: each format is another copy of the controller's
//! machine code, which most runs do not need (30 November 2026).

#[cfg(test)]
mod tests;

use staya_controller::agent::{AnyInputs, HALF_PLANES, LEARNED, NEIGHBORS, Setup, Task, VISITS};
use staya_controller::scalar::{Fast32, NumberFormat, Q16};
use staya_controller::time::Instant;
use staya_link::capacities::Capacities;
use staya_link::message::StepResult;
use staya_link::robot::{Controller, Robot};
use staya_link::surroundings::OBSTACLE_BYTES;
use staya_mavlink::any::AnyWire;
use staya_sim::engine::{Decision, ExternalController, Misplaced, Outcome, Status, WIDE, Watch, simulate_with};
use staya_sim::scenario::{LawSetup, Scenario};
use std::sync::{Arc, Mutex, PoisonError};

/// Obstacles of a step; the farthest of more are left out, as on a device.
const OBSTACLES: usize = 32;
/// Bytes of received packets in a step.
const INBOX: u16 = u16::MAX;

type In<S> = Robot<S, WIDE, VISITS, NEIGHBORS, HALF_PLANES, OBSTACLES, AnyWire, LEARNED>;

/// A robot with any built-in law that computes in `numbers`, as large as the engine's own.
#[must_use]
pub fn robot(numbers: NumberFormat) -> Box<dyn Controller + Send> {
    match numbers {
        NumberFormat::F32 => Box::new(In::<f32>::new()),
        NumberFormat::Q16 => Box::new(In::<Q16>::new()),
        NumberFormat::Fast32 => Box::new(In::<Fast32>::new()),
        NumberFormat::F64 => Box::new(In::<f64>::new()),
    }
}

/// A law that is not the controller's own, so that robots outside the engine do not have it.
#[must_use]
pub fn added_law(scenario: &Scenario) -> Option<&LawSetup> {
    scenario.laws().find(|law| law.built_in().is_none())
}

/// A field that robots outside the engine do not have, and the remedy; `None`: the scenario suits
/// them.
#[must_use]
pub fn unsuitable(scenario: &Scenario) -> Option<(&'static str, &'static str)> {
    let models = || scenario.plane().is_some_and(|plane| plane.kinds().any(|group| group.half_planes.is_some()));
    let wrong: [(bool, &'static str, &'static str); 6] = [
        (scenario.laws.maps.is_some(), "maps.share", "remove [maps]"),
        (scenario.land.known.is_some(), "scouting.model_bytes", "leave it out"),
        (models(), "plane.orca.model", "leave it out"),
        (scenario.sensing().is_some(), "plane.sensing", "remove it"),
        (!scenario.clocks.is_synchronous(), "[clocks]", "remove it and phase_s"),
        (scenario.trust.keys.is_some(), "[authentication]", "remove it"),
    ];
    wrong.into_iter().find(|(is_wrong, ..)| *is_wrong).map(|(_, what, remedy)| (what, remedy))
}

/// The error for something that a number format lacks.
#[must_use]
pub fn unavailable(what: &str, remedy: &str, numbers: NumberFormat) -> String {
    format!("{what} is not available with numbers = \"{numbers}\"; {remedy}, or leave out numbers")
}

/// Runs a scenario in its number format; see [`simulate_with`].
///
/// # Errors
/// The robots cannot be placed, or something in the scenario is not available in its number format.
pub fn simulate(scenario: &Scenario, watch: &mut Watch<'_>) -> Result<Outcome, String> {
    let misplaced = |error: Misplaced| error.to_string();
    let Some(robots) = OnHost::of(scenario)? else {
        return simulate_with(scenario, None, watch).map_err(misplaced);
    };
    let trouble = robots.trouble();
    let outcome = simulate_with(&in_f32(scenario), Some(Box::new(robots)), watch).map_err(misplaced)?;
    trouble.get().map_or(Ok(outcome), Err)
}

/// The scenario for an engine whose robots in another number format are external.
#[must_use]
pub fn in_f32(scenario: &Scenario) -> Scenario {
    let mut scenario = scenario.clone();
    scenario.laws.numbers = NumberFormat::F32;
    scenario
}

/// The first error of a robot, shared by all clones.
#[derive(Clone, Debug, Default)]
pub struct Trouble(Arc<Mutex<Option<String>>>);

impl Trouble {
    /// The error; `None` so far.
    #[must_use]
    pub fn get(&self) -> Option<String> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    fn set(&self, trouble: String) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(trouble);
    }
}

struct Unit {
    index: usize,
    controller: Box<dyn Controller + Send>,
    wire: AnyWire,
    decision: Option<Decision>,
}

/// Robots in this process that compute in one number format.
pub struct OnHost {
    units: Vec<Unit>,
    law: Box<dyn Fn(usize) -> Vec<u8> + Send>,
    packed: Vec<u8>,
    trouble: Trouble,
}

impl std::fmt::Debug for OnHost {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("OnHost").field("robots", &self.units.len()).finish_non_exhaustive()
    }
}

impl OnHost {
    /// All robots of the scenario; `None` if they compute in `f32`, as the engine does.
    ///
    /// # Errors
    /// Something in the scenario is not available in its number format.
    pub fn of(scenario: &Scenario) -> Result<Option<Self>, String> {
        let numbers = scenario.laws.numbers;
        if numbers == NumberFormat::F32 {
            return Ok(None);
        }
        let law = added_law(scenario).map(|law| (format!("law = \"{}\"", law.name()), "give another law"));
        if let Some((what, remedy)) = law.or_else(|| unsuitable(scenario).map(|(what, remedy)| (what.into(), remedy))) {
            return Err(unavailable(&what, remedy, numbers));
        }
        Ok(Some(Self::new(0..scenario.robots.len(), || robot(numbers), Box::new(|_| Vec::new()))))
    }

    /// The robots with these indices, in ascending order; `law(index)` is a law of their own, see
    /// [`Controller::configure`].
    pub fn new(
        indices: impl IntoIterator<Item = usize>,
        controller: impl Fn() -> Box<dyn Controller + Send>,
        law: Box<dyn Fn(usize) -> Vec<u8> + Send>,
    ) -> Self {
        let unit = |index| Unit {
            index,
            controller: controller(),
            wire: AnyWire::new(staya_controller::wire::Format::Postcard),
            decision: None,
        };
        Self {
            units: indices.into_iter().map(unit).collect(),
            law,
            packed: vec![0; OBSTACLES * OBSTACLE_BYTES],
            trouble: Trouble::default(),
        }
    }

    /// The place of the first error.
    #[must_use]
    pub fn trouble(&self) -> Trouble {
        self.trouble.clone()
    }

    fn at(&self, index: usize) -> Option<usize> {
        self.units.binary_search_by_key(&index, |unit| unit.index).ok()
    }
}

/// The engine's form of a result.
#[must_use]
pub fn decision(result: StepResult) -> Decision {
    Decision {
        status: Status {
            mode: result.mode,
            leader: result.leader,
            target: result.target.unwrap_or_default(),
            wait: result.outputs.wait,
        },
        command: result.outputs.command,
        outbox: result.outputs.outbox,
        rejected: result.outputs.rejected,
    }
}

impl ExternalController for OnHost {
    fn robots(&self) -> Vec<usize> {
        self.units.iter().map(|unit| unit.index).collect()
    }

    fn start(&mut self, index: usize, setup: Setup, task: Task) {
        let Some(at) = self.at(index) else { return };
        let unit = &mut self.units[at];
        unit.wire = AnyWire::new(setup.format);
        if let Err(refusal) = unit.controller.configure(&setup, Some(&task), &(self.law)(index)) {
            self.trouble.set(format!("robot {} refuses: {refusal}", setup.agent.id.0));
        }
    }

    fn has_restarted(&mut self, _: usize) -> bool {
        false
    }

    fn send(&mut self, index: usize, tick: u32, now: Instant, inputs: &AnyInputs<'_, f32>) {
        let Some(at) = self.at(index) else { return };
        let unit = &mut self.units[at];
        let room = Capacities { inbox_bytes: INBOX, ..unit.controller.capacities() };
        let stepped = match room.fit(tick, now, inputs, &unit.wire, &mut self.packed) {
            Ok((step, _)) => unit.controller.step(&step).map_err(|refusal| refusal.to_string()),
            Err(error) => Err(error.to_string()),
        };
        match stepped {
            Ok(()) => unit.decision = unit.controller.result().map(decision),
            Err(why) => self.trouble.set(format!("robot at index {index}, tick {tick}: {why}")),
        }
    }

    fn collect(&mut self, index: usize) -> Option<Decision> {
        let at = self.at(index)?;
        self.units[at].decision.take()
    }
}
