//! Canned swarms, one for each behaviour, to compare targets with each other.
//!
//! A case runs a few agents that receive each other's packets and move simulated bodies on terrain
//! from a formula. The same code runs on a host and on a microcontroller; equal hashes of commands,
//! of transmitted bytes and of agents' states show that both computed the same, and tell apart what
//! a change affects. Nothing here allocates or panics. `inline(never)` keeps the cases from
//! sharing one large stack frame: the largest runs in 16 KiB of RAM.
#![no_std]

#[cfg(test)]
extern crate std;

mod grid;
mod hash;
mod land;
mod medium;
#[cfg(feature = "all-cases")]
mod negotiation;
mod plane;
mod scene;
mod swarms;
#[cfg(test)]
mod tests;
mod worst;

pub use scene::{FOUND, ROBOTS, Scene};
pub use swarms::Case;
pub use worst::{WorstCase, worst_orca};

use core::fmt::{Display, Formatter};
use core::hint::black_box;
use staya_controller::agent::{Agent, HALF_PLANES, Inputs, Law, NEIGHBORS, Outputs, Safety};
use staya_controller::scalar::{Q16, Scalar};
use staya_controller::time::Instant;
use staya_controller::wire::Wire;
use staya_mavlink::wire::Mavlink;

/// Wrapper around each [`Agent::step`] of a case, in which firmware measures it.
pub trait Probe<S: Scalar> {
    /// Calls `agent.step_into(inputs, now, workspace, out)`.
    fn step<G: Law<S>, A: Safety<S>, W: Wire, const N: usize>(
        &mut self,
        agent: &mut Agent<S, G, N, A, W>,
        inputs: &Inputs<'_, S, G::Surroundings<'_>>,
        now: Instant,
        workspace: &mut G::Workspace,
        out: &mut Outputs<S>,
    );
}

/// Measures nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unmeasured;

impl<S: Scalar> Probe<S> for Unmeasured {
    fn step<G: Law<S>, A: Safety<S>, W: Wire, const N: usize>(
        &mut self,
        agent: &mut Agent<S, G, N, A, W>,
        inputs: &Inputs<'_, S, G::Surroundings<'_>>,
        now: Instant,
        workspace: &mut G::Workspace,
        out: &mut Outputs<S>,
    ) {
        agent.step_into(inputs, now, workspace, out);
    }
}

/// Measures nothing, and hides the inputs and outputs of a step from the optimiser.
#[derive(Clone, Copy, Debug, Default)]
pub struct Opaque;

impl<S: Scalar> Probe<S> for Opaque {
    fn step<G: Law<S>, A: Safety<S>, W: Wire, const N: usize>(
        &mut self,
        agent: &mut Agent<S, G, N, A, W>,
        inputs: &Inputs<'_, S, G::Surroundings<'_>>,
        now: Instant,
        workspace: &mut G::Workspace,
        out: &mut Outputs<S>,
    ) {
        let (agent, inputs, out) = (black_box(agent), black_box(inputs), black_box(out));
        agent.step_into(inputs, black_box(now), black_box(workspace), out);
        black_box(out);
    }
}

/// Runs every case with every number format of parts, in the order of the golden table.
pub fn every(mut done: impl FnMut(&'static str, &'static str, &Summary)) {
    each::<f32>("f32", &mut done);
    each::<Q16>("Q16", &mut done);
}

fn each<S: Scalar>(number: &'static str, done: &mut impl FnMut(&'static str, &'static str, &Summary)) {
    for &case in Case::ALL {
        done(case.name(), number, &case.run::<S, _>(&mut Unmeasured));
    }
    in_mavlink::<S>(number, done);
    for &worst in WorstCase::ALL {
        let summary = worst.run::<S, _, NEIGHBORS, HALF_PLANES>(&mut Unmeasured);
        done(worst.name(), number, &summary);
    }
}

/// Runs [`Case::Packets`] in MAVLink; only its bytes differ from those of the case itself.
pub fn in_mavlink<S: Scalar>(number: &'static str, done: &mut impl FnMut(&'static str, &'static str, &Summary)) {
    done("packets_mavlink", number, &packets_over::<S, _, _>(Mavlink, &mut Unmeasured));
}

/// Runs [`Case::Packets`] in one wire format.
pub fn packets_over<S: Scalar, W: Wire, P: Probe<S>>(wire: W, probe: &mut P) -> Summary {
    swarms::on_grid::packets(wire, probe)
}

/// Result of a case.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Summary {
    /// Hash of all commands and positions, in each tick.
    pub commands: u64,
    /// Hash of all transmitted bytes and numbers of accepted and rejected frames, in each tick.
    pub bytes: u64,
    /// Hash of the digests of all agents, in each tick.
    pub digest: u64,
    /// Ticks until all robots had arrived, or the case's limit.
    pub ticks: u32,
    /// Steps of all agents together.
    pub steps: u32,
    /// Agents whose mode was "arrived" at the end.
    pub arrived: u32,
    /// Pairs of overlapping bodies, summed over the ticks.
    pub overlaps: u32,
    /// Smallest and largest distance of two bodies at the end, millimetres; 0 on the grid.
    pub apart_mm: [u32; 2],
    /// Frames that agents rejected as damaged or repeated.
    pub rejected: u32,
    /// Size of one agent, bytes.
    pub agent_bytes: u32,
    /// Size of the workspace shared by all agents, bytes.
    pub workspace_bytes: u32,
}

/// The columns of the golden table behind case and number format.
impl Display for Summary {
    fn fmt(&self, f: &mut Formatter<'_>) -> core::fmt::Result {
        let Self { commands, bytes, digest, steps, .. } = self;
        write!(f, "{commands:016x} {bytes:016x} {digest:016x} {steps}")
    }
}

impl Summary {
    fn of<A, W>() -> Self {
        Self {
            commands: 0,
            bytes: 0,
            digest: 0,
            ticks: 0,
            steps: 0,
            arrived: 0,
            overlaps: 0,
            apart_mm: [0; 2],
            rejected: 0,
            agent_bytes: size_of::<A>() as u32,
            workspace_bytes: size_of::<W>() as u32,
        }
    }

    fn count<S>(&mut self, out: &Outputs<S>) {
        self.steps = self.steps.saturating_add(1);
        self.rejected = self.rejected.saturating_add(out.rejected.into());
    }
}
