//! The one composer of behaviours: [`Agent::step`]. Read that function first.
//!
//! A step hears (`link`), decides (a [`Guidance`], then the [`crate::supervisor`]), keeps clear (a
//! [`Safety`] layer) and speaks. The guidances compose the behaviours of the layer below. Which one there is
//! says what [`Inputs`] must hold (what is missing puts the robot into [`Mode::Fault`], and it stands) and what comes out:
//!
//! | guidance | inputs besides pose and inbox | where to go | command |
//! | --- | --- | --- | --- |
//! | [`RouteGuidance`], [`FormationGuidance`] | cell, window | [`Agent::assign_goal`] | [`Command::Move`] |
//! | the same within [`InPlane`] | cell, window, surroundings with `in_cell` | [`Agent::assign_goal`] | [`Command::Velocity`] |
//! | [`WaypointGuidance`], [`GoalFlockGuidance`] | surroundings | [`Agent::assign_place`] | [`Command::Velocity`] |
//! | [`LatticeGuidance`] | surroundings | [`Agent::assign_place`], or nowhere: it flocks | [`Command::Velocity`] |
//! | [`BoidsGuidance`] | surroundings | nowhere: it roams | [`Command::Velocity`] |
//!
//! What turns velocities into PWM, bytes of a UART into an inbox and ranges into a window is in the crate `staya-robot`.
//!
//! Cell by cell, to a goal on the grid:
//!
//! ```
//! use staya_controller::agent::*;
//! use staya_controller::grid::{Cell, Window};
//! use staya_controller::route::RouteParams;
//! use staya_controller::time::{Duration, Instant};
//! use staya_controller::robot::RobotId;
//!
//! let tick = Duration::from_millis(100);
//! let config = AgentConfig::new(RobotId(3), 1, tick);
//! let mut agent = RouteAgent::new(&config, RouteGuidance::new(RouteParams::default()));
//! let mut workspace = GridWorkspace::new();
//! agent.assign_goal(Cell::new(9, 5));
//!
//! // What a robot's own sensors and radio would say: flat land, nobody heard.
//! let (land, mut cell, mut now) = ([1; 121], Cell::new(5, 5), Instant::from_micros(0));
//! for _ in 0..4 {
//!     let inputs = Inputs {
//!         pose: Pose::default(),
//!         cell: Some(CellState { cell, busy: Duration::ZERO }),
//!         window: Window::new(&land, cell - Cell::new(5, 5), 11, 11),
//!         surroundings: None,
//!         inbox: &[],
//!     };
//!     let out = agent.step(&inputs, now, &mut workspace);
//!     assert!(!out.outbox.is_empty(), "it says where it is");
//!     if let Command::Move(moves) = out.command {
//!         cell = cell + moves[0].offset();
//!     }
//!     now = now + tick;
//! }
//! assert_eq!(cell, Cell::new(9, 5));
//! ```
//!
//! By velocities, behind ORCA, to a place two metres east:
//!
//! ```
//! use staya_controller::agent::*;
//! use staya_controller::geom::Position;
//! use staya_controller::neighbor::StalenessInflation;
//! use staya_controller::orca::AvoidParams;
//! use staya_controller::time::{Duration, Instant};
//! use staya_controller::robot::{Mode, RobotId};
//!
//! let tick = Duration::from_millis(50);
//! let config = AgentConfig { radius_m: 0.1, ..AgentConfig::new(RobotId(3), 1, tick) };
//! let safety = OrcaSafety::new(AvoidParams::default(), StalenessInflation { growth_mps: 0.1, max_m: 0.2 });
//! let mut agent = OrcaAgent::guarded(&config, WaypointGuidance::new(0.5, 0.02), safety);
//! agent.assign_place(0, &Place::fixed(Position::from_mm([2000, 0, 0])));
//!
//! let (mut pose, mut now) = (Pose::default(), Instant::from_micros(0));
//! while agent.mode() != Mode::Arrived {
//!     let inputs = Inputs {
//!         pose,
//!         cell: None,
//!         window: None,
//!         surroundings: Some(Surroundings { max_speed_mps: 0.5, obstacles: &[], in_cell: None }),
//!         inbox: &[],
//!     };
//!     let out = agent.step(&inputs, now, &mut ());
//!     // A body without inertia: it goes as it is told.
//!     if let Command::Velocity(velocity_mps) = out.command {
//!         pose.velocity_mps = velocity_mps;
//!         pose.position = pose.position.moved(velocity_mps * 0.05).unwrap();
//!     }
//!     now = now + tick;
//! }
//! assert!(pose.position.since::<f32>(Position::from_mm([2000, 0, 0])).norm() <= 0.02);
//! ```

mod any;
mod commanded;
mod config;
mod flock_guidance;
mod formation_guidance;
mod guidance;
mod in_plane;
mod io;
mod link;
mod orca_safety;
mod other_safety;
mod parameter;
mod route_guidance;
mod safety;
mod setup;
mod state;
mod travel;
mod waypoint_guidance;

#[cfg(all(test, feature = "auth", feature = "fixed"))]
mod tests;

pub use any::{AnyGuidance, AnyHalfPlanes, AnySafety};
pub use commanded::{Commanded, Wish, WrongTask};
pub use config::AgentConfig;
pub use flock_guidance::{BoidsGuidance, GOALS, GoalFlockGuidance, LatticeGuidance};
pub use formation_guidance::FormationGuidance;
pub use guidance::{Ask, BadInput, Guidance, Guided, Place, View};
pub use in_plane::InPlane;
pub use io::{
    CellState, Command, EVENTS, Event, InCell, Inputs, OUTBOX, Outputs, Pose, Refused, Surroundings,
};
pub use orca_safety::{FlySafety, OrcaSafety};
pub use other_safety::PushOutSafety;
pub use parameter::Parameter;
pub use route_guidance::{GridWorkspace, RouteGuidance};
pub use safety::{Safety, Sight, Unguarded};
pub use setup::{
    AnyAgent, BoidsSetup, GuidanceSetup, PLACES, RouteSetup, SafetySetup, Setup, Task,
};
pub use waypoint_guidance::WaypointGuidance;

use crate::body::Body;
use crate::grid::{Cell, Dir};
use crate::neighbor::{Nearby, nearest};
use crate::rand::Rng;
use crate::robot::{Mode, RobotId};
use crate::scalar::Scalar;
use crate::supervisor::{Situation, moves, next_mode};
use crate::time::{Duration, Instant};
use crate::wire::{Postcard, Wire};
use heapless::Vec;
use link::{Link, Listener, News, beacon, report};
use serde::Serialize;

/// Keeps the agent's draws apart from other uses of randomness.
const PURPOSE: u32 = u32::from_be_bytes(*b"step");

/// Cells of a search for windows of radius 5 (KUZ) with their border: (2 * 5 + 3)^2.
pub const CELLS: usize = 169;
/// Neighbours that an agent of default capacity knows.
pub const NEIGHBORS: usize = 16;
/// Cells whose visits an agent of default capacity remembers.
pub const VISITS: usize = 64;
/// Neighbours in a template of default capacity.
pub const TEMPLATE: usize = 8;

/// Half-planes that a safety layer of default capacity reckons with: one per neighbour, and as many of obstacles.
pub const HALF_PLANES: usize = 2 * NEIGHBORS;

/// A robot for itself on the grid, with default capacities.
pub type RouteAgent = Agent<f32, RouteGuidance<CELLS, VISITS>, NEIGHBORS>;
/// A robot in formation on the grid, with default capacities.
pub type FormationAgent = Agent<f32, FormationGuidance<CELLS, VISITS, TEMPLATE>, NEIGHBORS>;
/// A robot for itself in the plane behind ORCA, with default capacities.
pub type OrcaAgent = Agent<f32, WaypointGuidance<f32>, NEIGHBORS, OrcaSafety<f32, HALF_PLANES>>;

// What a firmware pays: one agent, and one workspace for all agents of a processor. A change here is
// news for everybody's memory map.
const BYTES: [usize; 4] = [
    size_of::<RouteAgent>(),
    size_of::<FormationAgent>(),
    size_of::<OrcaAgent>(),
    size_of::<GridWorkspace<CELLS>>(),
];
#[cfg(target_pointer_width = "32")]
const _: () = assert!(matches!(BYTES, [2032, 2288, 1632, 2704]));
#[cfg(target_pointer_width = "64")]
const _: () = assert!(matches!(BYTES, [2064, 2320, 1648, 2712]));

/// The controller of one robot: guidance `G`, at most `N` known neighbours, safety layer `A`, wire format `W`.
///
/// Bytes for the default capacities on a 32-bit part: 2032 for [`RouteAgent`], 2288 for [`FormationAgent`], 1632 for
/// [`OrcaAgent`], and 2704 of workspace that all agents on the grid of a processor share; on a 64-bit host
/// 2064, 2320, 1648 and 2712. The build fails when one of them changes unnoticed.
#[derive(Clone, Debug, Serialize)]
pub struct Agent<S, G, const N: usize, A = Unguarded, W = Postcard> {
    config: AgentConfig<S>,
    guidance: G,
    safety: A,
    link: Link<S, N, W>,
    mode: Mode,
    goal: Option<Goal>,
    /// Decisions so far: each has random numbers of its own.
    decisions: u32,
    /// The last decision, as others and the next step need it.
    last: Last,
}

/// Where to go.
#[derive(Clone, Copy, Debug, Serialize)]
enum Goal {
    /// This robot, wherever its place in a formation is.
    Own(Cell),
    /// The top leader of its formation, and this robot beside it, wherever its place will be then.
    Formation(Cell),
}

/// What stays of a decision.
#[derive(Clone, Copy, Debug, Default, Serialize)]
struct Last {
    situation: Situation,
    target: Cell,
    leader: RobotId,
    heading: Dir,
    slot: u8,
}

impl<S: Scalar, G: Guidance<S>, const N: usize> Agent<S, G, N> {
    /// A robot that has just started: idle, without a goal, knowing nobody, and without a safety layer.
    #[must_use]
    pub const fn new(config: &AgentConfig<S>, guidance: G) -> Self {
        Self::guarded(config, guidance, Unguarded)
    }
}

impl<S: Scalar, G: Guidance<S>, const N: usize, A: Safety<S>> Agent<S, G, N, A> {
    /// A robot that has just started: idle, without a goal, knowing nobody.
    #[must_use]
    pub const fn guarded(config: &AgentConfig<S>, guidance: G, safety: A) -> Self {
        Self::speaking(config, guidance, safety, Postcard)
    }
}

impl<S: Scalar, G: Guidance<S>, const N: usize, A: Safety<S>, W: Wire> Agent<S, G, N, A, W> {
    /// [`Agent::guarded`] with another wire format than [`Postcard`]. All robots of a swarm speak the same one.
    #[must_use]
    pub const fn speaking(config: &AgentConfig<S>, guidance: G, safety: A, wire: W) -> Self {
        Self {
            config: *config,
            guidance,
            safety,
            link: Link::new(config.id, config.boot, config.ages, config.retry, wire),
            mode: Mode::Idle,
            goal: None,
            decisions: 0,
            last: Last {
                situation: Situation {
                    is_passive: false,
                    has_fault: false,
                    has_goal: false,
                    is_at_goal: false,
                    is_stopped: false,
                    is_stuck: false,
                    is_off_place: false,
                },
                target: Cell::new(0, 0),
                leader: RobotId::NOBODY,
                heading: Dir::Stay,
                slot: 0,
            },
        }
    }

    /// Gives the robot a goal of its own on the grid, which a new place in the formation does not move (one that
    /// comes as a [`GoalAssignment`](crate::wire::GoalAssignment) is the formation's and moves); whether its guidance goes to cells
    /// (to the others, see [`Self::assign_place`], it means nothing).
    pub fn assign_goal(&mut self, goal: Cell) -> bool {
        let goes_there = self.guidance.goes_to_cells();
        if goes_there {
            self.goal = Some(Goal::Own(goal));
            self.last.target = goal;
        }
        goes_there
    }

    /// Gives the robot a place to go to, number `index` of those that its guidance has room for; whether
    /// it has.
    pub fn assign_place(&mut self, index: u8, place: &Place<S>) -> bool {
        self.guidance.assign_place(index, place)
    }

    /// Gives the robot what it has to do; whether its guidance has a use for all of it.
    pub fn assign(&mut self, task: &Task) -> bool {
        match task {
            Task::Cell(goal) => self.assign_goal(*goal),
            Task::Places(places) => {
                let assigned = |(index, place): &(u8, Place<f32>)| -> bool {
                    self.assign_place(*index, &place.cast())
                };
                places.iter().map(assigned).fold(true, |all, one| all & one)
            }
        }
    }

    /// One step: hear, decide, speak. A pure function of the agent, `inputs` and `now`.
    ///
    /// Bounded work: O(frames of the inbox * N) to hear; the guidance's decision when the robot is
    /// free to move (for the grid: one search of the window, O((2r + 1)^2), with
    /// [`Prediction::Reflexive`](crate::formation::Prediction) one more per entry of the template;
    /// in the plane O(N) and the obstacles in sight) and its safety layer's (see there);
    /// at most [`OUTBOX`] bytes to send.
    pub fn step(
        &mut self,
        inputs: &Inputs<'_, S>,
        now: Instant,
        workspace: &mut G::Workspace,
    ) -> Outputs<S> {
        let mut out = Outputs::default();
        self.step_into(inputs, now, workspace, &mut out);
        out
    }

    /// [`Agent::step`] into outputs that the caller keeps, whatever was in them: some 500 bytes less on the stack.
    ///
    /// The phases are not inlined, so that each gives its stack back before the next one.
    pub fn step_into(
        &mut self,
        inputs: &Inputs<'_, S>,
        now: Instant,
        workspace: &mut G::Workspace,
        out: &mut Outputs<S>,
    ) {
        out.clear();
        self.hear(inputs, now, out);
        let nearby = self.look(inputs, now);
        let mut rng = Rng::keyed(self.config.seed, PURPOSE, self.config.id.0, self.decisions);
        let guided = self.decide(inputs, &nearby, now, &mut rng, workspace, out);
        self.supervise(inputs, guided.as_ref(), out);
        self.keep_clear(inputs, guided.as_ref(), &nearby, &mut rng, out);
        self.speak(inputs, now, out);
    }

    /// Who is near by, for robots that do not move cell by cell.
    #[inline(never)]
    fn look(&self, inputs: &Inputs<'_, S>, now: Instant) -> Vec<Nearby<S>, N> {
        if inputs.surroundings.is_none() {
            return Vec::new();
        }
        let (config, inflation) = (&self.config, self.safety.inflation());
        nearest(
            self.link.table.as_slice(),
            inputs.pose.position,
            config.radius_m,
            now,
            &config.ages,
            &inflation,
        )
    }

    fn body(&self, inputs: &Inputs<'_, S>) -> Body<S> {
        let max_speed_mps = inputs.surroundings.map_or(S::ZERO, |s| s.max_speed_mps);
        Body {
            id: self.config.id,
            velocity_mps: inputs.pose.velocity_mps,
            radius_m: self.config.radius_m,
            max_speed_mps,
            max_acceleration_mps2: self.config.max_acceleration_mps2,
            step_s: S::from_micro(self.config.tick.as_micros()),
        }
    }

    #[inline(never)]
    fn hear(&mut self, inputs: &Inputs<'_, S>, now: Instant, out: &mut Outputs<S>) {
        let Self {
            config,
            guidance,
            link,
            goal,
            last,
            ..
        } = self;
        let leader = last.leader;
        let mut pass_on = Vec::<_, 4>::new();
        let heard_at = now - config.latency;
        link.expire(now, out);
        let mut inbox = inputs.inbox;
        while let Some(bytes) = link.next_frame(&mut inbox) {
            let listener = Listener {
                position: inputs.pose.position,
                heard_at,
                needs: &|id| id == leader || guidance.needs(id),
            };
            match link.hear(bytes, now, &listener, out) {
                None => {}
                Some(News::Redirect) => guidance.redirect(),
                // To a robot that goes to places it means nothing.
                Some(News::Goal(_)) if !guidance.goes_to_cells() => {}
                Some(News::Goal(top)) => {
                    *goal = Some(Goal::Formation(top));
                    last.target = top + guidance.goal_offset();
                }
                // One that is refused is of no use, and its sender will not hear of it.
                Some(News::Template { part, is_anew }) => {
                    let _ = guidance.assign_template(&part, is_anew);
                }
                Some(News::Place {
                    index,
                    version,
                    place,
                }) => {
                    let is_of_use = guidance.assign_place(index, &place);
                    if is_of_use {
                        link.placed(index, version);
                    }
                }
                // One without room is lost: a stop is asked for again, an old one expires.
                Some(News::PassOn(request)) => drop(pass_on.push(request)),
            }
        }
        // At the end, so that what was acknowledged in this step has made room.
        for request in &pass_on {
            if leader.is_somebody() && leader != request.origin {
                let valid = Duration::from_millis(request.valid_ms.into());
                link.ask(leader, request.origin, request.kind, valid, now);
            }
        }
    }

    /// The own goal in the world.
    fn goal_cell(&self) -> Option<Cell> {
        Some(match self.goal? {
            Goal::Own(cell) => cell,
            Goal::Formation(top) => top + self.guidance.goal_offset(),
        })
    }

    /// Asks the guidance when the robot is free to move; `None` otherwise.
    #[inline(never)]
    fn decide(
        &mut self,
        inputs: &Inputs<'_, S>,
        nearby: &[Nearby<S>],
        now: Instant,
        rng: &mut Rng,
        workspace: &mut G::Workspace,
        out: &mut Outputs<S>,
    ) -> Option<Guided<S>> {
        // Asked in each step, so that its clock never goes half round unnoticed.
        let is_stopped = self.link.is_stopped(now);
        let own_goal = self.guidance.has_own_goal();
        let goal = self.goal_cell().or(own_goal.then_some(Cell::default()));
        let situation = &mut self.last.situation;
        situation.has_goal = goal.is_some();
        let Some(goal) = goal else {
            // Nothing was asked, so nothing is missing.
            (situation.is_passive, situation.has_fault) = (false, false);
            return None;
        };
        if inputs.cell.is_some_and(|cell| cell.busy > Duration::ZERO) {
            return None;
        }
        let view = View {
            id: self.config.id,
            now,
            tick: self.config.tick,
            pose: inputs.pose,
            cell: inputs.cell,
            window: inputs.window,
            goal,
            body: self.body(inputs),
            nearby,
            obstacles: inputs.surroundings.map_or(&[], |s| s.obstacles),
            in_cell: inputs.surroundings.and_then(|s| s.in_cell),
            neighbors: self.link.table.as_slice(),
            ages: self.config.ages,
        };
        self.decisions = self.decisions.wrapping_add(1);
        let guided = self.guidance.decide(&view, rng, workspace);
        let situation = &mut self.last.situation;
        situation.has_fault = guided.is_err();
        situation.is_passive = guided.as_ref().is_ok_and(|guided| guided.is_passive);
        let guided = guided.ok()?;
        for ask in &guided.asks {
            let (valid, own) = (self.config.stop_valid, self.config.id);
            self.link.ask(ask.to, own, ask.kind, valid, now);
        }
        if !own_goal && guided.target != goal && guided.target != self.last.target {
            let (from, to) = (goal, guided.target);
            report(out, Event::TargetMoved { from, to });
        }
        if guided.is_stuck && !situation.is_stuck {
            report(out, Event::NoRoute);
        }
        let leads = !guided.leader.is_somebody();
        situation.is_at_goal = guided.is_at_goal;
        situation.is_stuck = guided.is_stuck;
        situation.is_off_place = guided.is_off_place;
        situation.is_stopped = guided.waits || (leads && is_stopped && !guided.recovers);
        self.last.target = guided.target;
        self.last.leader = guided.leader;
        self.last.slot = guided.slot;
        Some(guided)
    }

    /// The mode, and what it makes of the guidance's wishes.
    #[inline(never)]
    fn supervise(
        &mut self,
        inputs: &Inputs<'_, S>,
        guided: Option<&Guided<S>>,
        out: &mut Outputs<S>,
    ) {
        let to = next_mode(self.mode, self.last.situation);
        if to != self.mode {
            let from = core::mem::replace(&mut self.mode, to);
            report(out, Event::ModeChanged { from, to });
        }
        let Some(guided) = guided else { return };
        let goes = moves(to) || (guided.makes_way && to.gives_way());
        self.last.heading = Dir::Stay;
        if goes && inputs.surroundings.is_some() {
            out.command = Command::Velocity(guided.velocity_mps);
        } else if goes && !guided.moves.is_empty() {
            self.last.heading = guided.moves.first().copied().unwrap_or_default();
            out.command = Command::Move(guided.moves.clone());
        }
    }

    /// What the safety layer makes of the wished velocity. Who stands gives way too, unless its mode says that it does not
    /// ([`Mode::gives_way`]).
    #[inline(never)]
    fn keep_clear(
        &mut self,
        inputs: &Inputs<'_, S>,
        guided: Option<&Guided<S>>,
        nearby: &[Nearby<S>],
        rng: &mut Rng,
        out: &mut Outputs<S>,
    ) {
        let Some(surroundings) = inputs.surroundings else {
            return;
        };
        if !self.mode.gives_way() {
            out.command = Command::Hold;
            return;
        }
        let wish = match out.command {
            Command::Velocity(wish) if wish.is_finite() => Some(wish),
            _ => None,
        };
        let body = self.body(inputs);
        let sight = Sight {
            body,
            wish_mps: wish.unwrap_or_default(),
            way_m: guided.and_then(|g| g.way_m).filter(|_| wish.is_some()),
            nearby,
            obstacles: surroundings.obstacles,
        };
        let safe = self.safety.keep_clear(&sight, rng);
        out.command = Command::Velocity(body.reach(safe));
    }

    #[inline(never)]
    fn speak(&mut self, inputs: &Inputs<'_, S>, now: Instant, out: &mut Outputs<S>) {
        let Self { config, last, .. } = self;
        let mode = self.mode;
        // What it does from now on is of more use to others than what it did.
        let velocity_mps = match out.command {
            Command::Velocity(velocity_mps) => velocity_mps,
            Command::Hold | Command::Move(_) => inputs.pose.velocity_mps,
        };
        let beacon = || beacon(config, last, mode, inputs, velocity_mps, now);
        self.link.speak(now, config.beacon_period, beacon, out);
        // A robot that is free decides anew after a tick at the latest.
        let busy = inputs.cell.map_or(Duration::ZERO, |cell| cell.busy);
        let decision = now
            + if busy > Duration::ZERO {
                busy
            } else {
                config.tick
            };
        if decision.is_before(out.call_again) {
            out.call_again = decision;
        }
    }
}
