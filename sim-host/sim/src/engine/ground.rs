//! The interface between the engine and a world: sensing, and execution of commands.

use super::inspect::Scratchpad;
use super::{Change, Status};
use crate::metrics::{FormationKept, FormationMeters, FormationQuality, PlaceError};
use crate::record::Motion;
use crate::terrain::Terrain;
use crate::world::Refusal;
use crate::world::plane::{Clearance, Disc, Solid};
use serde::Serialize;
use serde::de::DeserializeOwned;
use staya_controller::agent::{AgentConfig, AnyInputs, AnyOrder, Command, Law, Protocol, Task, WAYPOINTS};
use staya_controller::neighbor::Sighting;
use staya_controller::time::Duration;
use thiserror::Error;

/// A world with bodies. `number` is the index of a robot in
/// [`Scenario::robots`](crate::scenario::Scenario::robots), `index` that of its body in this
/// process. They differ only if other MPI ranks hold part of the robots.
pub trait Ground: Send + Sync {
    /// Per-thread scratch memory of [`Ground::sense`].
    type Scratch: Default + Send;

    /// Mutable state of a body.
    type Body: Serialize + DeserializeOwned;
    /// Mutable state of the world apart from its bodies.
    type Shared: Serialize + DeserializeOwned;

    /// State of body `index`, including the world's records about it.
    fn body(&self, index: usize) -> Self::Body;

    /// Restores the state of a body. Until all bodies are restored, their places may collide.
    ///
    /// # Errors
    /// The state is impossible in this world.
    fn set_body(&mut self, index: usize, body: Self::Body) -> Result<(), &'static str>;

    /// Updates what this rank stores about a robot of another rank: its goal.
    fn note(&mut self, number: usize, body: Self::Body);

    /// State of the world apart from its bodies.
    fn shared(&self) -> Self::Shared;

    /// Restores the shared state in a world before its first tick.
    ///
    /// # Errors
    /// The state belongs to another world.
    fn set_shared(&mut self, shared: Self::Shared) -> Result<(), &'static str>;

    /// Whether the states of all bodies are consistent with each other.
    fn is_sound(&self) -> bool {
        true
    }

    /// Clears the terrain memory of the robot of body `index`, because its computer restarts.
    fn forget(&mut self, _index: usize) {}

    /// Sensor data of the robot of body `index` at the start of `tick`; the inbox is empty.
    fn sense<'a>(&'a self, index: usize, tick: u32, scratch: &'a mut Self::Scratch) -> AnyInputs<'a, f32>;

    /// Replaces `sightings` with the robots that body `index` detects at the start of `tick`.
    fn sightings(&self, _index: usize, _tick: u32, sightings: &mut Vec<Sighting<f32>>) {
        sightings.clear();
    }

    /// Whether robots have no transmitter.
    fn is_mute(&self) -> bool {
        false
    }

    /// Motion of a body at the start of `tick`.
    fn motion(&self, index: usize, tick: u32) -> Motion;

    /// Moves the bodies according to the commands.
    fn advance(&mut self, tick: u32, commands: &[Command<f32>]);

    /// Number of collisions after `tick`, from the positions of the bodies alone.
    fn count_collisions(&mut self, tick: u32) -> u64;

    /// State of a body after `tick`, for the trace hash.
    fn words(&self, index: usize, tick: u32, status: &Status) -> StateWords;

    /// Time at which the body arrived, in [`UNIT`](staya_controller::grid::UNIT)ths of a tick after
    /// the start; `None` if the robot is not at its goal.
    fn arrival(&self, index: usize, tick: u32, status: &Status) -> Option<u64>;

    /// Configuration of a robot's agent: body, radio and tick length.
    fn config(&self, number: usize, tick: Duration) -> AgentConfig<f32>;

    /// Task of a robot that starts at `tick`.
    fn task(&self, number: usize, tick: u32) -> Task;

    /// Whether a body could stand at a place, metres.
    fn is_open(&self, place_m: [f64; 3]) -> bool;

    /// Goal of a robot, metres; `None`: it has no fixed goal.
    fn goal_m(&self, number: usize) -> Option<[f64; 3]>;

    /// Sets the goal of a robot from `tick` on.
    fn set_goal(&mut self, number: usize, tick: u32, place_m: [f64; 3]);

    /// Changes the world before `tick`.
    ///
    /// # Errors
    /// The cell, obstacle or goal does not exist in this world.
    fn change(&mut self, tick: u32, change: Change<'_>) -> Result<(), Refusal>;

    /// Current quality of the formations, if any; `counts` adds it to the run's statistics.
    /// `is_down` is whether the computer of the body with that index is down.
    fn keeping(&mut self, _counts: bool, _is_down: &dyn Fn(usize) -> bool) -> Option<FormationQuality> {
        None
    }

    /// Statistics that [`Ground::keeping`] has collected.
    fn formations(&self) -> Option<&FormationMeters> {
        None
    }

    /// Whether bodies have positions in metres rather than cells.
    fn has_bodies(&self) -> bool {
        self.clearance().is_some()
    }

    /// Mean quality of all formations, and the quality of each.
    fn kept(&self) -> (Option<FormationQuality>, Option<PlaceError>, Vec<FormationKept>) {
        let Some(meters) = self.formations() else {
            return (None, None, Vec::new());
        };
        let place_error = meters.place_error().filter(|_| self.has_bodies());
        (meters.mean(), place_error, meters.each(self.has_bodies()))
    }

    /// Distance from the robot's place at the last [`Ground::keeping`], cells; NaN without one.
    fn formation_error(&self, _number: usize) -> f64 {
        f64::NAN
    }

    /// Smallest gaps over the whole run and overlaps summed over ticks; `None` without body sizes.
    fn clearance(&self) -> Option<Clearance> {
        None
    }

    /// Smallest distance between the surfaces of two bodies at the last collision count, metres.
    fn gap_m(&self) -> Option<f64> {
        None
    }

    /// Target of robot `index` at `tick`, metres; `None` if it has none or its law chooses it.
    fn target_m(&self, _index: usize, _tick: u32, _status: &Status) -> Option<[f64; 3]> {
        None
    }

    /// Radius of body `index`, metres; `None` if bodies have no size.
    fn radius_m(&self, _index: usize) -> Option<f64> {
        None
    }

    /// The terrain, if there is any.
    fn terrain(&self) -> Option<&Terrain>;

    /// Static obstacles in the plane.
    fn solids(&self) -> &[Solid] {
        &[]
    }

    /// Goals of a goal flock at `tick`, metres.
    fn goals_m(&self, _tick: u32) -> [Option<[f64; 3]>; WAYPOINTS] {
        [None; WAYPOINTS]
    }

    /// Foreign bodies.
    fn intruders(&self) -> &[Disc] {
        &[]
    }

    /// Foreign bodies that send beacons.
    fn heard(&self) -> impl Iterator<Item = &Disc> {
        core::iter::empty()
    }

    /// Encoded frames of the operator's orders to all robots at `tick`.
    fn orders(&self, _tick: u32) -> Option<&[u8]> {
        None
    }
}

/// The law needs other surroundings than the scenario's robots have.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
pub enum WrongWorld {
    /// The scenario has no `[plane]`.
    #[error("the scenario has no table [plane], and the law goes by velocities; give it one")]
    Grid,
    /// The scenario has `[plane]` and no land.
    #[error("the scenario has no [terrain], and the law plans on land; give it one")]
    Plane,
    /// The scenario has `[plane]` on land.
    #[error("the scenario has a table [plane], and the law moves from cell to cell; leave it out")]
    Land,
}

/// A law that can change threads, whose scratch memory displays can show, and whose orders can be
/// made of the goals in scenario files.
pub trait HostLaw: Law<f32, Workspace: Scratchpad, Protocol: Protocol<Order: TryFrom<AnyOrder>>> + Send {}

impl<L> HostLaw for L where L: Law<f32, Workspace: Scratchpad, Protocol: Protocol<Order: TryFrom<AnyOrder>>> + Send {}

/// State of a body as 64-bit words.
pub type StateWords = heapless::Vec<u64, 8>;
