//! The interface between the engine and a world: sensing, and execution of commands.

use super::state::{Reader, StateError};
use super::{Grid, PlaneGround, Status};
use crate::record::Motion;
use crate::scenario::{Intervention, Movement, Scenario};
use crate::terrain::Terrain;
use crate::world::plane::{Barrier, Clearance, CommandAge, Disc, Solid};
use crate::world::{Misplaced, Refusal};
use staya_controller::agent::{AgentConfig, AnyInputs, Command, Task, WAYPOINTS};
use staya_controller::grid::Cell;
use staya_controller::neighbor::Sighting;
use staya_controller::obstacle::Obstacle;
use std::ops::{Deref, DerefMut};

/// A world with bodies. `number` is the index of a robot in [`Scenario::robots`], `index` that of
/// its body in this process. They differ only if other MPI ranks hold part of the robots.
pub trait Ground: Send + Sync {
    /// Appends the mutable state of body `index`, with the world's records about its robot.
    fn save_body(&self, index: usize, bytes: &mut Vec<u8>);

    /// Restores the state of robot `number` and its body `index`; `None`: the body is on another
    /// rank, and only the robot's goal is restored. Until all bodies are restored, their places may
    /// collide.
    ///
    /// # Errors
    /// The state is impossible in this world.
    fn load_body(&mut self, number: usize, index: Option<usize>, from: &mut Reader<'_>) -> Result<(), StateError>;

    /// Appends the state of the world apart from its bodies.
    fn save_shared(&self, bytes: &mut Vec<u8>);

    /// Restores the shared state in a world before its first tick.
    ///
    /// # Errors
    /// The state belongs to another world.
    fn load_shared(&mut self, from: &mut Reader<'_>) -> Result<(), StateError>;

    /// Whether the states of all bodies are consistent with each other.
    fn is_sound(&self) -> bool {
        true
    }

    /// Configuration of a robot's agent, and its task if it starts at `tick`.
    fn setup(&self, number: usize, tick: u32) -> (AgentConfig<f32>, Task);

    /// Clears the terrain memory of the robot of body `index`, because its computer restarts.
    fn forget(&mut self, index: usize);

    /// Sensor data of the robot of body `index` at the start of `tick`; the inbox is empty.
    fn sense<'a>(&'a self, index: usize, tick: u32, senses: &'a mut Senses) -> AnyInputs<'a, f32>;

    /// Replaces `sightings` with the robots that body `index` detects at the start of `tick`, if
    /// its sensor is due then or was due in the `within_ticks` ticks that end there.
    fn sightings(&self, _index: usize, _tick: u32, _within_ticks: u32, sightings: &mut Vec<Sighting<f32>>) {
        sightings.clear();
    }

    /// Motion of a body at the start of `tick`.
    fn motion(&self, index: usize, tick: u32) -> Motion;

    /// Moves the bodies according to the commands, which have these ages. Returns the number of
    /// collisions after `tick`, from the positions of the bodies alone.
    fn advance(&mut self, tick: u32, commands: &[Command<f32>], ages: &[CommandAge]) -> u64;

    /// State of a body after `tick`, for the trace hash.
    fn words(&self, index: usize, tick: u32, status: &Status) -> StateWords;

    /// Time at which the body arrived, in [`UNIT`](staya_controller::grid::UNIT)ths of a tick after
    /// the start; `None` if the robot is not at its goal.
    fn arrival(&self, index: usize, tick: u32, status: &Status) -> Option<u64>;

    /// Target of robot `index` at `tick`, metres; `None` if it has none or its law chooses it.
    fn target_m(&self, index: usize, tick: u32, status: &Status) -> Option<[f64; 3]>;

    /// Goal of a robot, metres; `None`: it has no fixed goal.
    fn goal_m(&self, number: usize) -> Option<[f64; 3]>;

    /// Those of the bodies `of` whose goal no motion leads to, with the reason.
    fn barriers(&self, tick: u32, of: &[usize]) -> Vec<(usize, Barrier)>;

    /// Sets the goal of a robot from `tick` on.
    fn set_goal(&mut self, number: usize, tick: u32, place_m: [f64; 3]);

    /// Changes the world before `tick`. Interventions in robots and their radio have no effect
    /// here.
    ///
    /// # Errors
    /// The cell, obstacle or goal does not exist in this world.
    fn change(&mut self, tick: u32, what: &Intervention) -> Result<(), Refusal>;

    /// Gives new classes to cells, by a rule of the scenario
    /// ([`LandChange`](crate::terrain::change::LandChange)). A robot inside a closing cell may
    /// leave; no robot may enter.
    fn change_land(&mut self, cells: &[(Cell, u8)]);

    /// The world at `tick`. O(goals).
    fn view(&self, tick: u32) -> View<'_>;
}

/// A world at one moment, for displays and interventions.
#[derive(Clone, Copy, Debug, Default)]
pub struct View<'a> {
    /// The terrain, if there is any.
    pub terrain: Option<&'a Terrain>,
    /// Static obstacles in the plane.
    pub solids: &'a [Solid],
    /// Bodies with a size; empty on the grid.
    pub discs: &'a [Disc],
    /// Foreign bodies.
    pub intruders: &'a [Disc],
    /// Goals of a goal flock, metres.
    pub goals_m: [Option<[f64; 3]>; WAYPOINTS],
    /// Smallest gaps over the whole run and overlaps summed over ticks; `None` on the grid.
    pub clearance: Option<Clearance>,
    /// Smallest distance between the surfaces of two bodies after the last tick, metres.
    pub gap_m: Option<f64>,
    /// Encoded frames of the operator's orders to all robots at this tick.
    pub orders: &'a [u8],
}

impl View<'_> {
    /// Whether a body could stand at a place, metres.
    #[must_use]
    pub fn is_open(&self, [x, y, _]: [f64; 3]) -> bool {
        self.terrain.is_none_or(|land| land.cell_at([x, y]).is_some_and(|cell| land.is_passable(cell)))
    }
}

/// Buffers for a robot's sensor data.
#[derive(Default)]
pub struct Senses {
    pub(super) cells: Vec<u8>,
    pub(super) known: Vec<u8>,
    pub(super) obstacles: Vec<Obstacle<f32>>,
}

/// The world of a scenario.
pub enum AnyGround {
    /// Bodies that hold one cell each.
    Cells(Box<Grid>),
    /// Bodies in the plane or in space.
    Plane(Box<PlaneGround>),
}

impl AnyGround {
    /// Creates the scenario's bodies at their starts.
    ///
    /// # Errors
    /// See [`Grid::new`].
    pub fn new(scenario: &Scenario) -> Result<Self, Misplaced> {
        Ok(match &scenario.movement {
            Movement::Plane(setup) => Self::Plane(Box::new(PlaneGround::new(scenario, setup).with_company(scenario))),
            Movement::Cells(rules) => Self::Cells(Box::new(Grid::new(scenario, *rules)?)),
        })
    }
}

impl Deref for AnyGround {
    type Target = dyn Ground;

    fn deref(&self) -> &Self::Target {
        match self {
            Self::Cells(grid) => &**grid,
            Self::Plane(plane) => &**plane,
        }
    }
}

impl DerefMut for AnyGround {
    fn deref_mut(&mut self) -> &mut Self::Target {
        match self {
            Self::Cells(grid) => &mut **grid,
            Self::Plane(plane) => &mut **plane,
        }
    }
}

/// State of a body as 64-bit words.
pub type StateWords = heapless::Vec<u64, 8>;
