//! The agent: made in the caller's memory, told what to do, stepped, asked.

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
use staya_controller::agent::{Agent, Command, Outputs, Overclaims, Refused, Task, WAYPOINTS, Waypoint};
use staya_controller::geom::Position;
use staya_controller::grid::Cell;
use staya_controller::neighbor::Neighbor;
use staya_controller::obstacle::Obstacle;
use staya_controller::scalar::cast;
use staya_controller::time::Instant;

/// Bytes that are enough for an agent of any build of the library, its scratch memory included.
pub const STAYA_AGENT_SIZE: usize = 10240;
/// Bytes that are enough for one of a library without the features `auth` and `grid`.
pub const STAYA_AGENT_SIZE_IN_PLANE: usize = 3328;
/// How memory for agents and avoiders must be aligned, bytes.
pub const STAYA_ALIGN: usize = 8;
/// Waypoints that an agent has room for.
pub const STAYA_WAYPOINTS: usize = 4;
/// Neighbours that an agent knows at most.
pub const STAYA_NEIGHBORS: usize = 16;

const _: () = assert!(size_of::<StayaAgent>() <= STAYA_AGENT_SIZE && align_of::<StayaAgent>() <= STAYA_ALIGN);
#[cfg(not(any(feature = "auth", feature = "grid")))]
const _: () = assert!(size_of::<StayaAgent>() <= STAYA_AGENT_SIZE_IN_PLANE);
const _: () = assert!(STAYA_WAYPOINTS == WAYPOINTS && STAYA_NEIGHBORS >= NEIGHBORS);

type AnyAgent = Agent<Number, Law, NEIGHBORS, Layer, Speech>;

/// A robot's controller. What is in it is the library's own business.
// So that cbindgen, which does not read it like this, takes what is in it for nobody's business.
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
        overclaims: Overclaims { numbers: 0, radii: 0, speeds: 0, jumps: 0 },
        outbox: Vec::new(),
        events: Vec::new(),
        call_again: Instant::from_micros(0),
    }
}

impl StayaAgent {
    /// Made where it stays: each part is written on its own, so that only the law and the layer pass through the stack.
    ///
    /// # Safety
    /// `site` came from [`site`].
    #[inline(never)]
    unsafe fn make(site: *mut Self, setup: &StayaSetup) -> Checked<()> {
        let agent = AnyAgent::new(&setup.config()?, setup.law()?, setup.layer()?, setup.speech()?);
        // SAFETY: aligned room for all of it; nobody else uses it.
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
        let law = self.agent.guidance().kind();
        // SAFETY: the caller's promise.
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

    /// The agent itself.
    pub(crate) const fn inside(&self) -> &AnyAgent {
        &self.agent
    }

    /// The agent itself, to be changed.
    pub(crate) const fn inside_mut(&mut self) -> &mut AnyAgent {
        &mut self.agent
    }
}

/// A place to go to, which may move.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct StayaWaypoint {
    /// Where it was, millimetres.
    pub position_mm: [i32; 3],
    /// Its velocity since, m/s.
    pub velocity_mps: [f32; 3],
    /// When it was there, the robot's clock, microseconds.
    pub at_us: u32,
}

/// A robot as it was heard last.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct StayaNeighbor {
    /// Who it is; from 2^31 on a second robot of the number below.
    pub id: u32,
    /// When it was heard, the own clock, microseconds.
    pub heard_us: u32,
    /// Where it was then, millimetres.
    pub position_mm: [i32; 3],
    /// Its velocity then, m/s.
    pub velocity_mps: [f32; 3],
    /// Radius of the ball around its body, metres.
    pub radius_m: f32,
    /// Its leader; 0 for nobody.
    pub leader: u32,
    /// The cell that it was in.
    pub cell: StayaCell,
    /// The cell that it was going to.
    pub target: StayaCell,
    /// Its place in the formation, or its flock.
    pub slot: u8,
    /// What it was doing: StayaMode.
    pub mode: u8,
    /// The move that it wanted next: StayaDir.
    pub heading: u8,
    /// Silent for too long: only where it was still counts.
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
            is_lost: neighbor.is_lost.into(),
        }
    }
}

/// Bytes that an agent of this build takes: at most STAYA_AGENT_SIZE.
#[unsafe(no_mangle)]
pub const extern "C" fn staya_agent_bytes() -> usize {
    size_of::<StayaAgent>()
}

/// Makes an agent in memory of the caller's: idle, without a goal, knowing nobody. `*agent` is where it is, which is `memory`; it is
/// there for as long as the memory is, must not be moved, and needs no end. It is null if the setup is refused.
///
/// Needs some kilobytes of stack for a moment (docs/c.md).
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
        // SAFETY: the caller gives room for a pointer, or what `write` refuses.
        unsafe { memory::write(agent, core::ptr::null_mut())? };
        // SAFETY: the caller gives so much memory, or what `site` refuses.
        let site = unsafe { site::<StayaAgent>(memory, memory_bytes)? };
        // SAFETY: the caller gives a setup, or what `shared` refuses; the site is checked.
        unsafe { StayaAgent::make(site, shared(setup)?)? };
        // SAFETY: as above.
        unsafe { memory::write(agent, site) }
    };
    answer(make())
}

/// One step: hear, decide, speak. To be called once a `tick_us`, with the robot's clock and state as they are.
///
/// Bounded work; the agent and `outputs` are unchanged when the inputs are refused.
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
        // SAFETY: the caller gives an agent that nobody else uses, or what `resident_mut` refuses.
        let agent = unsafe { resident_mut(agent)? };
        // SAFETY: the caller gives inputs with sound pointers in them, or what is refused.
        unsafe { agent.step(shared(inputs)?)? };
        // SAFETY: the caller gives room for outputs; the inputs are read by now, should they lie in the same memory.
        agent.tell(unsafe { zeroed(outputs)? });
        Ok(())
    };
    answer(step())
}

/// Gives the robot a waypoint, number `index` below STAYA_WAYPOINTS: for the laws of the plane but boids. The goal flock takes
/// several, the others number 0.
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
        // SAFETY: the caller gives both, or what is refused.
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

/// Three finite numbers.
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

/// Gives the robot a cell to go to: for the laws that cross land in cells. In a formation the top leader's cell is enough.
///
/// # Safety
/// See the header's introduction.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_assign_cell(agent: *mut StayaAgent, x: i16, y: i16) -> StayaStatus {
    let assign = || {
        // SAFETY: the caller gives an agent that nobody else uses, or what `resident_mut` refuses.
        let agent = unsafe { resident_mut(agent)? };
        agent.agent.assign(&Task::Cell(Cell::new(x, y))).map_err(|_| StayaStatus::Task)
    };
    answer(assign())
}

/// What the robot is doing: StayaMode.
///
/// # Safety
/// See the header's introduction.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_mode(agent: *const StayaAgent, mode: *mut u8) -> StayaStatus {
    let ask = || {
        // SAFETY: the caller gives an agent, or what `resident` refuses.
        let known = unsafe { resident(agent)? }.agent.mode();
        // SAFETY: the caller gives room for it, or what `write` refuses.
        unsafe { memory::write(mode, StayaMode::from(known) as u8) }
    };
    answer(ask())
}

/// Whom the robot knows, by rising number: the first `room` of them; `*count` is how many there are, which may be more.
/// `STAYA_NEIGHBORS` is always room enough.
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
        // SAFETY: the caller gives an agent and so much room, or what is refused.
        let (agent, places) = unsafe { (resident(agent)?, room(neighbors, neighbor_room)?) };
        let known = agent.agent.neighbors();
        // SAFETY: the caller gives room for it, or what `write` refuses.
        unsafe { memory::write(count, known.len())? };
        for (place, neighbor) in places.iter_mut().zip(known) {
            place.write(neighbor.into());
        }
        Ok(())
    };
    answer(ask())
}

/// A fingerprint of the agent's whole state: agents with equal ones have the same future; the same on every machine.
///
/// # Safety
/// See the header's introduction.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_digest(agent: *const StayaAgent, digest: *mut u64) -> StayaStatus {
    let ask = || {
        // SAFETY: the caller gives an agent, or what `resident` refuses.
        let known = unsafe { resident(agent)? }.agent.digest();
        // SAFETY: the caller gives room for it, or what `write` refuses.
        unsafe { memory::write(digest, known) }
    };
    answer(ask())
}

/// Moves a place by a way in metres, rounded to millimetres, saturating: for odometry, and for bodies in a simulation.
/// cbindgen:ptrs-as-arrays=[[position_mm; 3], [way_m; 3]]
///
/// # Safety
/// See the header's introduction.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_move(position_mm: *mut i32, way_m: *const f32) -> StayaStatus {
    let go = || {
        // SAFETY: the caller gives both, or what `shared` refuses.
        let (from, way) = unsafe { (*shared(position_mm.cast::<[i32; 3]>())?, *shared(way_m.cast::<[f32; 3]>())?) };
        way.into_vector()?;
        let to = Position::from_mm(from).moved(vector(way)).ok_or(StayaStatus::Number)?;
        // SAFETY: as above, and the references are no more.
        unsafe { memory::write(position_mm.cast(), to.mm) }
    };
    answer(go())
}
