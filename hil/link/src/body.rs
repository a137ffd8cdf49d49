//! Memory for one agent, and the conversion of a step from link inputs to a link result.

use crate::capacities::Capacities;
use crate::message::{StepInputs, StepResult};
use crate::refusal::Refusal;
use heapless::Vec;
use serde::Serialize;
use staya_controller::agent::{
    Agent, AnySurroundings, Command, ImplausibleCounts, InAny, InCell, InCells, InPlane, Inputs, KinematicState, Law,
    OnGrid, Outputs, Refused, Safety, Setup, Task, Wait,
};
use staya_controller::obstacle::Obstacle;
use staya_controller::robot::RobotId;
use staya_controller::scalar::{Scalar, cast};
use staya_controller::time::Instant;
use staya_controller::wire::Wire;

pub(crate) fn count(n: usize) -> u16 {
    u16::try_from(n).unwrap_or(u16::MAX)
}

pub(crate) fn capacities(neighbors: usize, half_planes: usize, obstacles: usize) -> Capacities {
    Capacities {
        neighbors: count(neighbors),
        search_cells: 0,
        visits: 0,
        half_planes: count(half_planes),
        obstacles: count(obstacles),
        inbox_bytes: 0,
    }
}

/// Checks the robot id and the packet format.
pub(crate) fn check(setup: &Setup) -> Result<(), Refusal> {
    if setup.agent.id == RobotId::NONE {
        return Err(Refusal::NoRobot);
    }
    Ok(())
}

/// `None` is all zeros, so that an unconfigured robot lies in `.bss` and takes no flash.
#[derive(Clone, Debug)]
#[repr(u8)]
enum Slot<A> {
    Empty = 0,
    Full(A) = 1,
}

impl<A> Slot<A> {
    const fn as_ref(&self) -> Option<&A> {
        match self {
            Self::Empty => None,
            Self::Full(inside) => Some(inside),
        }
    }

    const fn as_mut(&mut self) -> Option<&mut A> {
        match self {
            Self::Empty => None,
            Self::Full(inside) => Some(inside),
        }
    }
}

#[derive(Clone, Debug)]
pub(crate) struct Body<S: Scalar, G: Law<S>, A, W, const N: usize, const O: usize> {
    agent: Slot<Agent<S, G, N, A, W>>,
    workspace: G::Workspace,
    obstacles: Vec<Obstacle<S>, O>,
    outputs: Outputs<S>,
}

impl<S: Scalar, G: Law<S>, A, W, const N: usize, const O: usize> Body<S, G, A, W, N, O> {
    pub(crate) const fn new(workspace: G::Workspace) -> Self {
        Self {
            agent: Slot::Empty,
            workspace,
            obstacles: Vec::new(),
            outputs: Outputs {
                command: Command::Hold,
                // Not read before the robot is configured; `None` is not zero.
                wait: Some(Wait::Team),
                received: 0,
                rejected: 0,
                refused: Refused { unsigned: 0, forged: 0, replayed: 0, no_room: 0 },
                implausible: ImplausibleCounts { numbers: 0, radii: 0, speeds: 0, jumps: 0 },
                outbox: Vec::new(),
                events: Vec::new(),
                call_again: Instant::from_micros(0),
            },
        }
    }

    pub(crate) const fn agent(&self) -> Option<&Agent<S, G, N, A, W>> {
        self.agent.as_ref()
    }

    pub(crate) fn forget(&mut self) {
        self.agent = Slot::Empty;
    }
}

impl<S, G, A, W, const N: usize, const O: usize> Body<S, G, A, W, N, O>
where
    S: Scalar,
    G: Law<S, Protocol: InAny> + Serialize,
    A: Safety<S> + Serialize,
    W: Wire + Serialize,
{
    /// Returns the digest of the agent's state. Inlined, so that the agent is built in place.
    #[inline(always)]
    pub(crate) fn start(
        &mut self,
        task: Option<&Task>,
        make: impl FnOnce() -> Agent<S, G, N, A, W>,
    ) -> Result<u64, Refusal> {
        self.outputs = Outputs::default();
        self.agent = Slot::Full(make());
        if let Some(agent) = self.agent.as_mut()
            && task.is_none_or(|task| agent.assign(task).is_ok())
        {
            return Ok(agent.digest());
        }
        self.agent = Slot::Empty;
        Err(Refusal::Task)
    }

    pub(crate) fn step(&mut self, inputs: &StepInputs<'_>) -> Result<(), Refusal> {
        let agent = self.agent.as_mut().ok_or(Refusal::NotConfigured)?;
        let window = match &inputs.window {
            Some(window) => Some(window.window().ok_or(Refusal::Nonsense)?),
            None => None,
        };
        self.obstacles.clear();
        if let Some(packed) = &inputs.surroundings {
            for obstacle in packed.obstacles() {
                let obstacle = obstacle.ok_or(Refusal::Nonsense)?;
                let kept = self.obstacles.push(obstacle);
                kept.map_err(|_| Refusal::Obstacles { room: O })?;
            }
        }
        if inputs.surroundings.is_some_and(|packed| !packed.is_whole()) {
            return Err(Refusal::Nonsense);
        }
        let grid = inputs.cell.map(|cell| OnGrid { cell, window });
        let plane = inputs
            .surroundings
            .map(|packed| InPlane { max_speed_mps: cast(packed.max_speed_mps), obstacles: self.obstacles.as_slice() });
        let place = inputs.surroundings.and_then(|packed| packed.in_cell);
        let surroundings = match (grid, plane, place) {
            (Some(grid), None, _) => AnySurroundings::OnGrid(grid),
            (None, Some(plane), None) => AnySurroundings::InPlane(plane),
            (Some(grid), Some(plane), Some(place)) => AnySurroundings::InCells(InCells {
                grid,
                plane,
                in_cell: InCell { offset_m: place.offset_m.cast(), cell_m: cast(place.cell_m) },
            }),
            _ => return Err(Refusal::Nonsense),
        };
        let own = Inputs {
            state: KinematicState { position: inputs.state.position, velocity_mps: inputs.state.velocity_mps.cast() },
            surroundings: surroundings.try_into().map_err(|_| Refusal::Nonsense)?,
            inbox: inputs.inbox,
        };
        agent.step_into(&own, inputs.now, &mut self.workspace, &mut self.outputs);
        Ok(())
    }

    pub(crate) fn result(&self) -> Option<StepResult> {
        let agent = self.agent.as_ref()?;
        Some(StepResult {
            outputs: in_f32(&self.outputs),
            mode: agent.mode(),
            leader: agent.leader(),
            target: agent.target(),
            digest: agent.digest(),
        })
    }
}

fn in_f32<S: Scalar>(outputs: &Outputs<S>) -> Outputs<f32> {
    Outputs {
        command: match &outputs.command {
            Command::Hold => Command::Hold,
            Command::Move(moves) => Command::Move(moves.clone()),
            Command::Velocity(velocity_mps) => Command::Velocity(velocity_mps.cast()),
        },
        wait: outputs.wait,
        received: outputs.received,
        rejected: outputs.rejected,
        refused: outputs.refused,
        implausible: outputs.implausible,
        outbox: outputs.outbox.clone(),
        events: outputs.events.clone(),
        call_again: outputs.call_again,
    }
}
