//! What the engine asks of a world: what a robot senses there, and what its command does to its body.

use super::inspect::Scratchpad;
use super::{Change, Status};
use crate::metrics::{FormationKept, FormationMeters, Keeping, PlaceError};
use crate::record::Motion;
use crate::terrain::Terrain;
use crate::world::Refusal;
use crate::world::plane::{Clearance, Disc, Solid};
use serde::Serialize;
use serde::de::DeserializeOwned;
use staya_controller::agent::{AgentConfig, AnyInputs, AnySurroundings, Command, Guidance, Task, WAYPOINTS};
use staya_controller::grid::Cell;
use staya_controller::neighbor::Sighting;
use staya_controller::time::Duration;

/// A world with bodies, as the engine needs it. `number` is the place of a robot in
/// [`Scenario::robots`](crate::scenario::Scenario::robots), `index` that of its body here: the same, unless other ranks have other robots.
pub trait Ground: Send + Sync {
    /// Scratch memory of a thread for [`Ground::sense`].
    type Scratch: Default + Send;

    /// What of a body changes.
    type Body: Serialize + DeserializeOwned;
    /// What else of the world does.
    type Shared: Serialize + DeserializeOwned;

    /// Body `index`, with what the world keeps of it.
    fn body(&self, index: usize) -> Self::Body;

    /// Puts it back. Until all are, bodies may be in each other's places.
    ///
    /// # Errors
    /// No body of this world can be so.
    fn set_body(&mut self, index: usize, body: Self::Body) -> Result<(), &'static str>;

    /// What of the body of a robot on another rank is known here, too: where the robot is to go.
    fn note(&mut self, number: usize, body: Self::Body);

    /// The world but for its bodies.
    fn shared(&self) -> Self::Shared;

    /// Puts it back into a world before its first tick.
    ///
    /// # Errors
    /// It is of another world.
    fn set_shared(&mut self, shared: Self::Shared) -> Result<(), &'static str>;

    /// Whether bodies are as they can be, together.
    fn is_sound(&self) -> bool {
        true
    }

    /// The robot of body `index` forgets what it has seen: its computer starts anew.
    fn forget(&mut self, _index: usize) {}

    /// What the robot of body `index` senses at the start of `tick`; the inbox is empty.
    fn sense<'a>(&'a self, index: usize, tick: u32, scratch: &'a mut Self::Scratch) -> AnyInputs<'a, f32>;

    /// Whom the robot of body `index` sees at the start of `tick`, in place of what is in `sightings`.
    fn sightings(&self, _index: usize, _tick: u32, sightings: &mut Vec<Sighting<f32>>) {
        sightings.clear();
    }

    /// Whether robots have no transmitter: what they would say, nobody hears.
    fn is_mute(&self) -> bool {
        false
    }

    /// How the body moves at the start of `tick`.
    fn motion(&self, index: usize, tick: u32) -> Motion;

    /// Moves the bodies as their robots command.
    fn advance(&mut self, tick: u32, commands: &[Command<f32>]);

    /// How many collisions there are after `tick`; looks at the bodies alone.
    fn count_collisions(&mut self, tick: u32) -> u64;

    /// The state of a body after `tick`, for the fingerprint.
    fn words(&self, index: usize, tick: u32, status: &Status) -> StateWords;

    /// When the body's journey was over, [`UNIT`](staya_controller::grid::UNIT)ths of a tick after the start;
    /// `None` when its robot is not where it should be.
    fn arrival(&self, index: usize, tick: u32, status: &Status) -> Option<u64>;

    /// What a robot must know of its body and its radio.
    fn config(&self, number: usize, tick: Duration) -> AgentConfig<f32>;

    /// What a robot has to do if it starts at `tick`.
    fn task(&self, number: usize, tick: u32) -> Task;

    /// Whether a body could stand at a place, metres.
    fn is_open(&self, place_m: [f64; 3]) -> bool;

    /// Where a robot is to go, metres; `None`: nowhere in particular.
    fn goal_m(&self, number: usize) -> Option<[f64; 3]>;

    /// Gives it another goal from `tick` on.
    fn set_goal(&mut self, number: usize, tick: u32, place_m: [f64; 3]);

    /// Changes the world itself before `tick`.
    ///
    /// # Errors
    /// There is no such thing in this world.
    fn change(&mut self, tick: u32, change: Change<'_>) -> Result<(), Refusal>;

    /// How well a formation is kept now, if there is one; `counts`: a tick is over.
    fn keeping(&mut self, _counts: bool) -> Option<Keeping> {
        None
    }

    /// What [`Ground::keeping`] counted.
    fn formations(&self) -> Option<&FormationMeters> {
        None
    }

    /// Whether bodies are in the plane or in space: distances in metres mean something then.
    fn has_bodies(&self) -> bool {
        self.clearance().is_some()
    }

    /// What is known of all formations, and of each.
    fn kept(&self) -> (Option<Keeping>, Option<PlaceError>, Vec<FormationKept>) {
        let Some(meters) = self.formations() else {
            return (None, None, Vec::new());
        };
        // On the grid places are cells.
        let place_error = meters.place_error().filter(|_| self.has_bodies());
        (meters.mean(), place_error, meters.each(self.has_bodies()))
    }

    /// How far a robot was from its place in the formation when [`Ground::keeping`] last looked, cells; NaN when it
    /// has none.
    fn formation_error(&self, _number: usize) -> f64 {
        f64::NAN
    }

    /// How near bodies have come to each other and to obstacles in the whole run, and how often they overlapped, summed over
    /// ticks; `None` where bodies have no size.
    fn clearance(&self) -> Option<Clearance> {
        None
    }

    /// The least distance between the surfaces of two bodies when collisions were last counted, metres.
    fn gap_m(&self) -> Option<f64> {
        None
    }

    /// Where in the world robot `index` heads for at `tick`; `None`: nowhere, or that is for its law to choose.
    fn target_m(&self, _index: usize, _tick: u32, _status: &Status) -> Option<[f64; 3]> {
        None
    }

    /// The radius of body `index`, metres; `None` where bodies have no size.
    fn radius_m(&self, _index: usize) -> Option<f64> {
        None
    }

    /// The land, if there is any.
    fn terrain(&self) -> Option<&Terrain>;

    /// What stands in the plane.
    fn solids(&self) -> &[Solid] {
        &[]
    }

    /// The goals of a goal flock at `tick`, metres.
    fn goals_m(&self, _tick: u32) -> [Option<[f64; 3]>; WAYPOINTS] {
        [None; WAYPOINTS]
    }

    /// Bodies that are no robots.
    fn intruders(&self) -> &[Disc] {
        &[]
    }

    /// Bodies that are no robots and say where they are, with the cells that they are in.
    fn heard(&self) -> impl Iterator<Item = (&Disc, Option<Cell>)> {
        core::iter::empty()
    }

    /// An order of the operator to everybody that is due at `tick`: frames.
    fn orders(&self, _tick: u32) -> Option<&[u8]> {
        None
    }
}

/// A guidance law as a host has it: it is told whatever its world senses, and threads have it in turn.
pub trait HostLaw: for<'a> Guidance<f32, Input<'a> = AnySurroundings<'a, f32>, Workspace: Scratchpad> + Send {}

impl<G> HostLaw for G where G: for<'a> Guidance<f32, Input<'a> = AnySurroundings<'a, f32>, Workspace: Scratchpad> + Send {}

/// A state in words of 64 bits.
pub type StateWords = heapless::Vec<u64, 8>;
