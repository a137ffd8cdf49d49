//! What a session asks of a robot's controller, and the one controller that can be any robot.

use crate::capacities::Capacities;
use crate::message::{NumberFormat, StepInputs, StepResult};
use core::fmt;
use heapless::Vec;
use staya_controller::agent::{
    AnyAgent, AnySurroundings, CELLS, Command, GridWorkspace, HALF_PLANES, InCell, InCells, InPlane, Inputs,
    KinematicState, LEARNED, NEIGHBORS, OnGrid, Outputs, Overclaims, Refused, Setup, Task, VISITS, Wait, WrongTask,
};
use staya_controller::obstacle::Obstacle;
use staya_controller::robot::RobotId;
use staya_controller::scalar::{Q16, Scalar, cast};
use staya_controller::time::Instant;
use staya_controller::wire::{Format, FromFormat, Postcard};
use staya_mavlink::any::AnyWire;

/// The robot that an STM32F405 has room for. As the small one, it speaks whatever format it is told to.
pub type Large = Robot<f32, CELLS, VISITS, NEIGHBORS, HALF_PLANES, 32, AnyWire, LEARNED>;
/// The robot that the micro:bit's nRF51 has room for.
pub type Small = Robot<Q16, CELLS, VISITS, 8, 16, 16, AnyWire>;
/// Bytes of the inbox beside a [`Large`].
pub const LARGE_INBOX: usize = 8192;
/// Bytes of the inbox beside a [`Small`].
pub const SMALL_INBOX: usize = 1024;

/// Why a controller refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// It was not told what to be.
    NotConfigured,
    /// The setup is for nobody.
    Nobody,
    /// It does not speak this format.
    Format(Format),
    /// It has no table of this size.
    Table,
    /// The guidance law has no use for the task.
    Task,
    /// A search of so many cells.
    Search {
        /// Cells.
        needs: usize,
        /// Cells that fit.
        room: usize,
    },
    /// More obstacles than this.
    Obstacles {
        /// Obstacles that fit.
        room: usize,
    },
    /// A window whose cells are not as many as its sides say, an obstacle of no known shape, or neither a cell nor surroundings.
    Nonsense,
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotConfigured => f.write_str("not configured"),
            Self::Nobody => f.write_str("a setup for nobody: numbers begin at 1"),
            Self::Format(format) => {
                write!(f, "this firmware was built without {}", format.name())
            }
            Self::Table => f.write_str("this firmware was built without voxel tables of more than 2 KiB"),
            Self::Task => fmt::Display::fmt(&WrongTask, f),
            Self::Search { needs, room } => {
                write!(f, "a search of {needs} cells, and room for {room}")
            }
            Self::Obstacles { room } => write!(f, "more than {room} obstacles"),
            Self::Nonsense => f.write_str("terrain or surroundings that make no sense"),
        }
    }
}

impl core::error::Error for Refusal {}

/// The part of a device that decides. Object-safe, so that a host can hold the shadows of different parts.
pub trait Controller {
    /// What it computes with.
    fn number(&self) -> NumberFormat;

    /// What it has room for; the inbox is up to who owns the buffer.
    fn capacities(&self) -> Capacities;

    /// Becomes this robot, just started; the digest of its state.
    ///
    /// # Errors
    /// What does not fit, see [`Refusal`]; then it is no robot at all.
    fn configure(&mut self, setup: &Setup, task: Option<&Task>) -> Result<u64, Refusal>;

    /// One step of the robot. What it decided is kept for [`Controller::result`]: on the way through a step it would only take stack.
    ///
    /// # Errors
    /// [`Refusal::NotConfigured`], or inputs that do not fit or make no sense; the robot is as it was.
    fn step(&mut self, inputs: &StepInputs<'_>) -> Result<(), Refusal>;

    /// What the last step decided; `None` for no robot.
    fn result(&self) -> Option<StepResult>;

    /// Is no robot any more.
    fn forget(&mut self);
}

/// An `Option` whose `None` is all zeros, so that a firmware's robot before its configuration takes no flash.
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

/// A robot that is told what to be. `CELLS` of a search, `M` remembered visits, `N` neighbours, `K` half-planes, `O` obstacles,
/// wire format `W`.
#[derive(Clone, Debug)]
pub struct Robot<
    S: Scalar,
    const CELLS: usize,
    const M: usize,
    const N: usize,
    const K: usize,
    const O: usize,
    W = Postcard,
    const L: usize = 0,
> {
    agent: Slot<AnyAgent<S, CELLS, M, N, K, W, L>>,
    workspace: GridWorkspace<CELLS>,
    obstacles: Vec<Obstacle<S>, O>,
    outputs: Outputs<S>,
}

impl<
    S: Scalar,
    const CELLS: usize,
    const M: usize,
    const N: usize,
    const K: usize,
    const O: usize,
    W: FromFormat,
    const L: usize,
> Robot<S, CELLS, M, N, K, O, W, L>
{
    /// Nobody yet.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            agent: Slot::Empty,
            workspace: GridWorkspace::new(),
            obstacles: Vec::new(),
            outputs: Outputs {
                command: Command::Hold,
                // Nobody sees it before it is configured; `None` would be the one byte here that is not zero.
                wait: Some(Wait::Formation),
                received: 0,
                rejected: 0,
                refused: Refused { unsigned: 0, forged: 0, replayed: 0, no_room: 0 },
                overclaims: Overclaims { numbers: 0, radii: 0, speeds: 0, jumps: 0 },
                outbox: Vec::new(),
                events: Vec::new(),
                call_again: Instant::from_micros(0),
            },
        }
    }

    /// The robot, once it was told what to be.
    #[must_use]
    pub const fn agent(&self) -> Option<&AnyAgent<S, CELLS, M, N, K, W, L>> {
        self.agent.as_ref()
    }
}

impl<
    S: Scalar,
    const CELLS: usize,
    const M: usize,
    const N: usize,
    const K: usize,
    const O: usize,
    W: FromFormat,
    const L: usize,
> Default for Robot<S, CELLS, M, N, K, O, W, L>
{
    fn default() -> Self {
        Self::new()
    }
}

impl<
    S: Scalar,
    const CELLS: usize,
    const M: usize,
    const N: usize,
    const K: usize,
    const O: usize,
    W: FromFormat,
    const L: usize,
> Controller for Robot<S, CELLS, M, N, K, O, W, L>
{
    fn number(&self) -> NumberFormat {
        if S::IS_FLOATING { NumberFormat::F32 } else { NumberFormat::Q16 }
    }

    fn capacities(&self) -> Capacities {
        let count = |n: usize| u16::try_from(n).unwrap_or(u16::MAX);
        Capacities {
            neighbors: count(N),
            search_cells: count(CELLS),
            visits: count(M),
            half_planes: count(K),
            obstacles: count(O),
            inbox_bytes: 0,
        }
    }

    fn configure(&mut self, setup: &Setup, task: Option<&Task>) -> Result<u64, Refusal> {
        self.agent = Slot::Empty;
        if setup.agent.id == RobotId::NOBODY {
            return Err(Refusal::Nobody);
        }
        let (needs, room) = (setup.cells(), CELLS);
        if needs > room {
            return Err(Refusal::Search { needs, room });
        }
        if !setup.safety.is_built() {
            return Err(Refusal::Table);
        }
        self.outputs = Outputs::default();
        let wire = W::from_format(setup.format).ok_or(Refusal::Format(setup.format))?;
        self.agent = Slot::Full(setup.speaking(wire));
        if let Some(agent) = self.agent.as_mut()
            && task.is_none_or(|task| agent.assign(task).is_ok())
        {
            return Ok(agent.digest());
        }
        self.agent = Slot::Empty;
        Err(Refusal::Task)
    }

    fn step(&mut self, inputs: &StepInputs<'_>) -> Result<(), Refusal> {
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
            surroundings,
            inbox: inputs.inbox,
        };
        agent.step_into(&own, inputs.now, &mut self.workspace, &mut self.outputs);
        Ok(())
    }

    fn result(&self) -> Option<StepResult> {
        let agent = self.agent.as_ref()?;
        Some(StepResult {
            outputs: in_f32(&self.outputs),
            mode: agent.mode(),
            leader: agent.leader(),
            target: agent.target(),
            digest: agent.digest(),
        })
    }

    fn forget(&mut self) {
        self.agent = Slot::Empty;
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
        overclaims: outputs.overclaims,
        outbox: outputs.outbox.clone(),
        events: outputs.events.clone(),
        call_again: outputs.call_again,
    }
}
