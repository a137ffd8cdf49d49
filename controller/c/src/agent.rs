//! The agent: creation in the caller's memory, orders, steps and queries.

use crate::choices::StayaMode;
use crate::io::{StayaInputs, StayaOutputs, array, vector};
use crate::law::{Law, Workspace};
use crate::layer::Layer;
use crate::memory::{self, Resident, plain, resident, resident_mut, room, shared, site, zeroed};
use crate::setup::{StayaCell, StayaSetup};
use crate::speech::Speech;
use crate::status::{Checked, StayaStatus, answer};
use crate::{NEIGHBORS, Number, OBSTACLES};
use core::ffi::c_void;
use heapless::Vec;
use staya_controller::agent::{Agent, Command, ImplausibleCounts, Outputs, Refused, Task, WAYPOINTS, Waypoint};
use staya_controller::geom::Position;
use staya_controller::grid::Cell;
use staya_controller::neighbor::Neighbor;
use staya_controller::obstacle::Obstacle;
use staya_controller::scalar::cast;
use staya_controller::time::Instant;

/// Bytes that suffice for an agent in any build of the library, including its scratch memory.
pub const STAYA_AGENT_SIZE: usize = 10240;
/// Bytes that suffice for an agent if the library lacks the features `auth` and `grid`.
pub const STAYA_AGENT_SIZE_IN_PLANE: usize = 3328;
/// Alignment of the memory for agents and avoiders, bytes.
pub const STAYA_ALIGN: usize = 8;
/// Maximum number of waypoints of an agent.
pub const STAYA_WAYPOINTS: usize = 4;
/// Maximum number of neighbours of an agent.
pub const STAYA_NEIGHBORS: usize = 16;

const _: () = assert!(size_of::<StayaAgent>() <= STAYA_AGENT_SIZE && align_of::<StayaAgent>() <= STAYA_ALIGN);
#[cfg(not(any(feature = "auth", feature = "grid")))]
const _: () = assert!(size_of::<StayaAgent>() <= STAYA_AGENT_SIZE_IN_PLANE);
const _: () = assert!(STAYA_WAYPOINTS == WAYPOINTS && STAYA_NEIGHBORS >= NEIGHBORS);

type AnyAgent = Agent<Number, Law, NEIGHBORS, Layer, Speech>;

/// The controller of one robot. Its contents are private to the library.
// A separate item, since cbindgen would otherwise export the fields.
#[cfg_attr(all(), repr(C))]
pub struct StayaAgent {
    mark: u32,
    agent: AnyAgent,
    workspace: Workspace,
    obstacles: Vec<Obstacle<Number>, OBSTACLES>,
    outputs: Outputs<Number>,
}

// SAFETY: `repr(C)`, and the mark is its first field.
unsafe impl Resident for StayaAgent {
    const MARK: u32 = u32::from_be_bytes(*b"agnt");
}

const fn no_outputs() -> Outputs<Number> {
    Outputs {
        command: Command::Hold,
        wait: None,
        received: 0,
        rejected: 0,
        refused: Refused { unsigned: 0, forged: 0, replayed: 0, no_room: 0 },
        implausible: ImplausibleCounts { numbers: 0, radii: 0, speeds: 0, jumps: 0 },
        outbox: Vec::new(),
        events: Vec::new(),
        call_again: Instant::from_micros(0),
    }
}

impl StayaAgent {
    /// Creates the agent in place and in parts: only law and layer pass through the stack.
    ///
    /// # Safety
    /// `site` was returned by [`site`].
    #[inline(never)]
    unsafe fn make(site: *mut Self, setup: &StayaSetup) -> Checked<()> {
        let agent = AnyAgent::new(&setup.config()?, setup.law()?, setup.layer()?, setup.speech()?);
        // SAFETY: aligned space for the whole agent, not used elsewhere.
        unsafe {
            (&raw mut (*site).agent).write(agent);
            #[cfg(feature = "grid")]
            (&raw mut (*site).workspace).write(Workspace::new());
            (&raw mut (*site).obstacles).write(Vec::new());
            (&raw mut (*site).outputs).write(no_outputs());
            (&raw mut (*site).mark).write(Self::MARK);
        }
        Ok(())
    }

    /// # Safety
    /// As for [`StayaInputs::inputs`].
    unsafe fn step(&mut self, inputs: &StayaInputs) -> Checked<()> {
        let law = self.agent.law().kind();
        // SAFETY: the caller's contract.
        let own = unsafe { inputs.inputs(law, &mut self.obstacles)? };
        let now = Instant::from_micros(inputs.now_us);
        self.agent.step_into(&own, now, &mut self.workspace, &mut self.outputs);
        Ok(())
    }

    fn tell(&self, out: &mut StayaOutputs) {
        out.fill(&self.outputs);
        out.mode = StayaMode::from(self.agent.mode()) as u8;
        out.leader = self.agent.leader().0;
        if let Some(target) = self.agent.target() {
            (out.target, out.has_target) = (target.into(), 1);
        }
    }

    pub(crate) const fn inside_mut(&mut self) -> &mut AnyAgent {
        &mut self.agent
    }
}

/// A destination, which may move.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct StayaWaypoint {
    /// Its position at `at_us`, millimetres.
    pub position_mm: [i32; 3],
    /// Its velocity since then, m/s.
    pub velocity_mps: [f32; 3],
    /// Time of the position on the robot's clock, microseconds.
    pub at_us: u32,
}

/// A robot as of its last beacon.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct StayaNeighbor {
    /// Its number; from 2^31 on a second robot with the number reduced by 2^31.
    pub id: u32,
    /// Reception time on the own clock, microseconds.
    pub heard_us: u32,
    /// Its position at that time, millimetres.
    pub position_mm: [i32; 3],
    /// Its velocity at that time, m/s.
    pub velocity_mps: [f32; 3],
    /// Radius of the ball around its body, metres.
    pub radius_m: f32,
    /// The number of its leader; 0 if it has none.
    pub leader: u32,
    /// The cell that it was in.
    pub cell: StayaCell,
    /// The cell that it was heading for.
    pub target: StayaCell,
    /// Its place in the formation, or its flock.
    pub slot: u8,
    /// Its activity: StayaMode.
    pub mode: u8,
    /// The move that it wanted to make next: StayaDir.
    pub heading: u8,
    /// Other than 0: silent for too long; only its last position still counts.
    pub is_lost: u8,
}

plain!(StayaWaypoint, StayaNeighbor);

impl From<&Neighbor<Number>> for StayaNeighbor {
    fn from(neighbor: &Neighbor<Number>) -> Self {
        Self {
            id: neighbor.id.0,
            heard_us: neighbor.heard.as_micros(),
            position_mm: neighbor.position.mm,
            velocity_mps: array(neighbor.velocity_mps),
            radius_m: cast(neighbor.radius_m),
            leader: neighbor.leader.0,
            cell: neighbor.cell.into(),
            target: neighbor.target.into(),
            slot: neighbor.slot,
            mode: StayaMode::from(neighbor.mode) as u8,
            heading: neighbor.heading.index() as u8,
            is_lost: neighbor.is_lost().into(),
        }
    }
}

/// Size of an agent of this build in bytes: at most STAYA_AGENT_SIZE.
#[unsafe(no_mangle)]
pub const extern "C" fn staya_agent_bytes() -> usize {
    size_of::<StayaAgent>()
}

/// Creates an idle agent in the caller's memory and points `*agent` to it; null if the setup is
/// rejected. The agent lives as long as the memory, must not be moved, and need not be destroyed.
/// Temporarily needs some kilobytes of stack (docs/c.md).
///
/// # Safety
/// See the header's introduction.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_init(
    memory: *mut c_void,
    memory_bytes: usize,
    setup: *const StayaSetup,
    agent: *mut *mut StayaAgent,
) -> StayaStatus {
    let make = || {
        // SAFETY: a valid pointer by the caller's contract, or `write` rejects it.
        unsafe { memory::write(agent, core::ptr::null_mut())? };
        // SAFETY: this much memory by the caller's contract, or `site` rejects it.
        let site = unsafe { site::<StayaAgent>(memory, memory_bytes)? };
        // SAFETY: a valid setup by contract, or `shared` rejects it; the site is checked.
        unsafe { StayaAgent::make(site, shared(setup)?)? };
        // SAFETY: as above.
        unsafe { memory::write(agent, site) }
    };
    answer(make())
}

/// Runs one step: receive, decide, send. Call it once per `tick_us` with the robot's present clock
/// and state. Bounded work. If the inputs are rejected, the agent and `outputs` are unchanged.
///
/// # Safety
/// See the header's introduction.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_step(
    agent: *mut StayaAgent,
    inputs: *const StayaInputs,
    outputs: *mut StayaOutputs,
) -> StayaStatus {
    let step = || {
        if outputs.is_null() {
            return Err(StayaStatus::Null);
        }
        if !outputs.is_aligned() {
            return Err(StayaStatus::Alignment);
        }
        // SAFETY: an agent not used elsewhere by contract, or `resident_mut` rejects it.
        let agent = unsafe { resident_mut(agent)? };
        // SAFETY: inputs with valid pointers by the caller's contract, or they are rejected.
        unsafe { agent.step(shared(inputs)?)? };
        // SAFETY: valid space, or it is rejected. Inputs in the same memory have been read.
        agent.tell(unsafe { zeroed(outputs)? });
        Ok(())
    };
    answer(step())
}

/// Gives the robot the waypoint number `index`, below STAYA_WAYPOINTS. For the laws of the plane
/// except boids. The goal flock uses several waypoints, the other laws only number 0.
///
/// # Safety
/// See the header's introduction.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_assign_waypoint(
    agent: *mut StayaAgent,
    index: u8,
    waypoint: *const StayaWaypoint,
) -> StayaStatus {
    let assign = || {
        // SAFETY: both are valid by the caller's contract, or they are rejected.
        let (agent, waypoint) = unsafe { (resident_mut(agent)?, shared(waypoint)?) };
        let waypoint = Waypoint::<f32> {
            position: Position::from_mm(waypoint.position_mm),
            velocity_mps: waypoint.velocity_mps.into_vector()?,
            at: Instant::from_micros(waypoint.at_us),
        };
        let mut waypoints = Vec::new();
        waypoints.push((index, waypoint)).map_err(|_| StayaStatus::TooMany)?;
        agent.agent.assign(&Task::Waypoints(waypoints)).map_err(|_| StayaStatus::Task)
    };
    answer(assign())
}

trait IntoVector {
    fn into_vector(self) -> Checked<staya_controller::geom::Vec3<f32>>;
}

impl IntoVector for [f32; 3] {
    fn into_vector(self) -> Checked<staya_controller::geom::Vec3<f32>> {
        let [x, y, z] = self;
        let vector = staya_controller::geom::Vec3::new(x, y, z);
        if vector.is_finite() { Ok(vector) } else { Err(StayaStatus::Number) }
    }
}

/// Gives the robot a target cell, for laws on land in cells. A formation only needs its leader's.
///
/// # Safety
/// See the header's introduction.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_assign_cell(agent: *mut StayaAgent, x: i16, y: i16) -> StayaStatus {
    let assign = || {
        // SAFETY: an agent not used elsewhere by contract, or `resident_mut` rejects it.
        let agent = unsafe { resident_mut(agent)? };
        agent.agent.assign(&Task::Cell(Cell::new(x, y))).map_err(|_| StayaStatus::Task)
    };
    answer(assign())
}

/// Returns the robot's activity: StayaMode.
///
/// # Safety
/// See the header's introduction.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_mode(agent: *const StayaAgent, mode: *mut u8) -> StayaStatus {
    let ask = || {
        // SAFETY: an agent by the caller's contract, or `resident` rejects it.
        let known = unsafe { resident(agent)? }.agent.mode();
        // SAFETY: valid space by the caller's contract, or `write` rejects it.
        unsafe { memory::write(mode, StayaMode::from(known) as u8) }
    };
    answer(ask())
}

/// Returns the first `room` neighbours in ascending order of their numbers, and in `*count` the
/// number of all. A room of `STAYA_NEIGHBORS` always suffices.
///
/// # Safety
/// See the header's introduction.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_neighbors(
    agent: *const StayaAgent,
    neighbors: *mut StayaNeighbor,
    neighbor_room: usize,
    count: *mut usize,
) -> StayaStatus {
    let ask = || {
        // SAFETY: an agent and this much space by the caller's contract, or they are rejected.
        let (agent, places) = unsafe { (resident(agent)?, room(neighbors, neighbor_room)?) };
        let known = agent.agent.neighbors();
        // SAFETY: valid space by the caller's contract, or `write` rejects it.
        unsafe { memory::write(count, known.len())? };
        for (place, neighbor) in places.iter_mut().zip(known) {
            place.write(neighbor.into());
        }
        Ok(())
    };
    answer(ask())
}

/// A hash of the agent's whole state. Agents with equal hashes behave identically on any machine.
///
/// # Safety
/// See the header's introduction.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_digest(agent: *const StayaAgent, digest: *mut u64) -> StayaStatus {
    let ask = || {
        // SAFETY: an agent by the caller's contract, or `resident` rejects it.
        let known = unsafe { resident(agent)? }.agent.digest();
        // SAFETY: valid space by the caller's contract, or `write` rejects it.
        unsafe { memory::write(digest, known) }
    };
    answer(ask())
}

/// Moves a position by a vector in metres (odometry), rounded to millimetres, saturating.
/// cbindgen:ptrs-as-arrays=[[position_mm; 3], [way_m; 3]]
///
/// # Safety
/// See the header's introduction.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_move(position_mm: *mut i32, way_m: *const f32) -> StayaStatus {
    let go = || {
        // SAFETY: both are valid by the caller's contract, or `shared` rejects them.
        let (from, way) = unsafe { (*shared(position_mm.cast::<[i32; 3]>())?, *shared(way_m.cast::<[f32; 3]>())?) };
        way.into_vector()?;
        let to = Position::from_mm(from).moved(vector(way)).ok_or(StayaStatus::Number)?;
        // SAFETY: as above; the references have ended.
        unsafe { memory::write(position_mm.cast(), to.mm) }
    };
    answer(go())
}
