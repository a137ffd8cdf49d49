//! The agent: creation in the caller's memory, orders, steps and queries.

use crate::choices::StayaMode;
use crate::chosen::Place;
use crate::io::{StayaInputs, StayaOutputs, array, finite};
use crate::law::{Law, Workspace};
use crate::memory::{Call, Resident, answers, check, plain};
use crate::setup::{StayaCell, StayaSetup};
use crate::speech::Speech;
use crate::status::{Checked, StayaStatus};
use crate::{Layer, NEIGHBORS, Number, OBSTACLES};
use core::ffi::c_void;
use core::mem::MaybeUninit;
use heapless::Vec;
use staya_controller::agent::{
    Agent, AgentConfig, AnyPayload, External, Grid, GridPayload, InAny, Outputs, Safety, Task, Unguarded, WAYPOINTS,
    Waypoint,
};
use staya_controller::geom::Position;
use staya_controller::grid::Cell;
use staya_controller::neighbor::Neighbor;
use staya_controller::obstacle::Obstacle;
use staya_controller::scalar::cast;
use staya_controller::time::Instant;
use staya_controller::wire::{Content, MAX_PAYLOAD, Postcard, ProtocolId};

/// Bytes that suffice for an agent in any build of the library, including its scratch memory.
pub const STAYA_AGENT_SIZE: usize = 10240;
/// Bytes that suffice for an agent if the library lacks the features `auth` and `grid`.
pub const STAYA_AGENT_SIZE_IN_PLANE: usize = 3584;
/// Alignment of the memory for agents and avoiders, bytes.
pub const STAYA_ALIGN: usize = 8;
/// Maximum number of waypoints of an agent.
pub const STAYA_WAYPOINTS: usize = 4;
/// Maximum length of a payload in bytes.
pub const STAYA_PAYLOAD: usize = 16;
/// Maximum number of neighbours of an agent.
pub const STAYA_NEIGHBORS: usize = 16;

const _: () = assert!(size_of::<StayaAgent>() <= STAYA_AGENT_SIZE && align_of::<StayaAgent>() <= STAYA_ALIGN);
#[cfg(not(any(feature = "auth", feature = "grid")))]
const _: () = assert!(size_of::<StayaAgent>() <= STAYA_AGENT_SIZE_IN_PLANE);
const _: () = assert!(STAYA_WAYPOINTS == WAYPOINTS && STAYA_NEIGHBORS >= NEIGHBORS && STAYA_PAYLOAD == MAX_PAYLOAD);

type AnyAgent = Agent<Number, Law, NEIGHBORS, Layer, Speech>;

/// The controller of one robot. Its contents are private to the library.
// A separate item, since cbindgen would otherwise export the fields.
#[cfg_attr(all(), repr(C))]
pub struct StayaAgent {
    mark: u32,
    place: Place,
    /// Whether the next call is the second half of a step.
    has_heard: bool,
    agent: AnyAgent,
    workspace: Workspace,
    obstacles: Vec<Obstacle<Number>, OBSTACLES>,
    outputs: Outputs<Number>,
}

// SAFETY: `repr(C)`, and the mark is its first field.
unsafe impl Resident for StayaAgent {
    const MARK: u32 = u32::from_be_bytes(*b"agnt");
}

/// The halves of a step.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Part {
    Hear,
    Act,
    Both,
}

impl StayaAgent {
    /// Creates the agent in place and in parts, of which only one at a time passes through the
    /// stack.
    ///
    /// # Safety
    /// `site` was returned by [`Call::site`].
    #[inline(never)]
    unsafe fn make(site: *mut Self, setup: &StayaSetup) -> Checked<()> {
        let config = setup.config()?;
        // SAFETY: aligned space for the whole agent, not used elsewhere.
        unsafe {
            let agent = begin(&mut *(&raw mut (*site).agent).cast(), &config);
            let place = setup.law(agent.law_mut())?;
            let layer = setup.layer_settings()?;
            *agent.safety_mut() = layer.layer();
            if let Some(inflation) = agent.safety().inflation() {
                let fits = config.check_rounding(inflation.growth_mps, layer.flies());
                fits.map_err(|_| StayaStatus::Number)?;
            }
            *agent.wire_mut() = setup.speech()?;
            (&raw mut (*site).place).write(place);
            (&raw mut (*site).has_heard).write(false);
            (&raw mut (*site).workspace).write(Workspace::default());
            (&raw mut (*site).obstacles).write(Vec::new());
            (&raw mut (*site).outputs).write(Outputs::default());
            (&raw mut (*site).mark).write(Self::MARK);
        }
        Ok(())
    }

    pub(crate) fn run(&mut self, call: Call<'_>, inputs: *const StayaInputs, part: Part) -> Checked<()> {
        if part == Part::Act && !self.has_heard {
            return Err(StayaStatus::NotHeard);
        }
        let inputs = call.shared(inputs)?;
        let own = inputs.inputs(call, self.place, &mut self.obstacles)?;
        let (now, out) = (Instant::from_micros(inputs.now_us), &mut self.outputs);
        if part != Part::Act {
            self.agent.hear_into(&own, now, out);
        }
        if part != Part::Hear {
            self.agent.act_into(&own, now, &mut self.workspace, out);
        }
        self.has_heard = part == Part::Hear;
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

/// An agent with the smallest law, safety layer and wire format.
#[inline(never)]
fn begin<'a>(place: &'a mut MaybeUninit<AnyAgent>, config: &AgentConfig<Number>) -> &'a mut AnyAgent {
    let law = Law::External(External::new(ProtocolId::NONE));
    place.write(AnyAgent::new(config, law, Layer::None(Unguarded), Speech::Postcard(Postcard)))
}

/// Runs a step, or its second half, if the inputs are valid.
pub(crate) fn act(
    call: Call<'_>,
    (agent, part): (*mut StayaAgent, Part),
    inputs: *const StayaInputs,
    outputs: *mut StayaOutputs,
) -> Checked<()> {
    check(outputs)?;
    let agent = call.resident_mut(agent)?;
    agent.run(call, inputs, part)?;
    // Inputs in the same memory have been read.
    agent.tell(call.zeroed(outputs)?);
    Ok(())
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
    /// The number of its leader; 0 if it has none. Only robots that cross land in cells tell
    /// `leader`, `cell`, `target`, `slot` and `heading`. For other robots they are 0 and
    /// STAYA_DIR_STAY.
    pub leader: u32,
    /// The cell that it was in.
    pub cell: StayaCell,
    /// The cell that it was heading for.
    pub target: StayaCell,
    /// Its place in the formation.
    pub slot: u8,
    /// The number of its flock.
    pub flock: u8,
    /// Its activity: StayaMode.
    pub mode: u8,
    /// The move that it wanted to make next: StayaDir.
    pub heading: u8,
    /// Other than 0: silent for too long; only its last position still counts.
    pub is_lost: u8,
    /// The protocol of its law: 64 to 255 are those of users, 0 is none.
    pub protocol: u8,
    /// Length of `payload`.
    pub payload_count: u8,
    /// The payload of its law, `payload_count` bytes: the bytes of `staya_set_payload`.
    pub payload: [u8; STAYA_PAYLOAD],
}

plain!(StayaWaypoint, StayaNeighbor);

impl From<&Neighbor<Number, AnyPayload>> for StayaNeighbor {
    fn from(neighbor: &Neighbor<Number, AnyPayload>) -> Self {
        let on_grid = neighbor.payload.and_then(Grid::payload).unwrap_or_default();
        let GridPayload { cell, target, heading, slot, leader, .. } = on_grid;
        let encode = |payload: AnyPayload| payload.encode::<MAX_PAYLOAD>(ProtocolId::NONE);
        let (protocol, bytes) = neighbor.payload.and_then(encode).unwrap_or_default();
        let mut payload = [0; STAYA_PAYLOAD];
        payload.iter_mut().zip(&bytes).for_each(|(to, byte)| *to = *byte);
        Self {
            id: neighbor.id.0,
            heard_us: neighbor.heard.as_micros(),
            position_mm: neighbor.position.mm,
            velocity_mps: array(neighbor.velocity_mps),
            radius_m: cast(neighbor.radius_m),
            leader: leader.0,
            cell: cell.into(),
            target: target.into(),
            slot,
            flock: neighbor.flock,
            mode: StayaMode::from(neighbor.mode) as u8,
            heading: heading.index() as u8,
            is_lost: neighbor.is_lost().into(),
            protocol: protocol.0,
            payload_count: bytes.len() as u8,
            payload,
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
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_init(
    memory: *mut c_void,
    memory_bytes: usize,
    setup: *const StayaSetup,
    agent: *mut *mut StayaAgent,
) -> StayaStatus {
    answers!(|call| {
        call.write(agent, core::ptr::null_mut())?;
        let site = call.site::<StayaAgent>(memory, memory_bytes)?;
        // SAFETY: `Call::site` returned it.
        unsafe { StayaAgent::make(site, call.shared(setup)?)? };
        call.write(agent, site)
    })
}

/// Runs one step: receive, decide, send. Call it once per `tick_us` with the robot's present clock
/// and state. Bounded work. If the inputs are rejected, the agent and `outputs` are unchanged.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_step(
    agent: *mut StayaAgent,
    inputs: *const StayaInputs,
    outputs: *mut StayaOutputs,
) -> StayaStatus {
    answers!(|call| act(call, (agent, Part::Both), inputs, outputs))
}

/// Gives the robot the waypoint number `index`, below STAYA_WAYPOINTS. For the laws of the plane
/// except boids. The goal flock uses several waypoints, the other laws only number 0.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_assign_waypoint(
    agent: *mut StayaAgent,
    index: u8,
    waypoint: *const StayaWaypoint,
) -> StayaStatus {
    answers!(|call| {
        let (agent, waypoint) = (call.resident_mut(agent)?, call.shared(waypoint)?);
        let waypoint = Waypoint::<f32> {
            position: Position::from_mm(waypoint.position_mm),
            velocity_mps: finite(waypoint.velocity_mps)?,
            at: Instant::from_micros(waypoint.at_us),
        };
        let mut waypoints = Vec::new();
        waypoints.push((index, waypoint)).map_err(|_| StayaStatus::TooMany)?;
        agent.agent.assign(&Task::Waypoints(waypoints)).map_err(|_| StayaStatus::Task)
    })
}

/// Gives the robot a target cell, for laws on land in cells. A formation only needs its leader's.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_assign_cell(agent: *mut StayaAgent, x: i16, y: i16) -> StayaStatus {
    answers!(|call| {
        let agent = &mut call.resident_mut(agent)?.agent;
        agent.assign(&Task::Cell(Cell::new(x, y))).map_err(|_| StayaStatus::Task)
    })
}

/// Returns the robot's activity: StayaMode.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_mode(agent: *const StayaAgent, mode: *mut u8) -> StayaStatus {
    answers!(|call| call.write(mode, StayaMode::from(call.resident(agent)?.agent.mode()) as u8))
}

/// Returns the first `room` neighbours in ascending order of their numbers, and in `*count` the
/// number of all. A room of `STAYA_NEIGHBORS` always suffices.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_neighbors(
    agent: *const StayaAgent,
    neighbors: *mut StayaNeighbor,
    neighbor_room: usize,
    count: *mut usize,
) -> StayaStatus {
    answers!(|call| {
        let known = call.resident(agent)?.agent.neighbors();
        let places = call.room(neighbors, neighbor_room)?;
        call.write(count, known.len())?;
        for (place, neighbor) in places.iter_mut().zip(known) {
            place.write(neighbor.into());
        }
        Ok(())
    })
}

/// A hash of the agent's whole state. Agents with equal hashes behave identically on any machine.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_digest(agent: *const StayaAgent, digest: *mut u64) -> StayaStatus {
    answers!(|call| call.write(digest, call.resident(agent)?.agent.digest()))
}

/// Moves a position by a vector in metres (odometry), rounded to millimetres, saturating.
/// cbindgen:ptrs-as-arrays=[[position_mm; 3], [way_m; 3]]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn staya_move(position_mm: *mut i32, way_m: *const f32) -> StayaStatus {
    answers!(|call| {
        let from = Position::from_mm(*call.shared(position_mm.cast::<[i32; 3]>())?);
        let way = finite::<Number>(*call.shared(way_m.cast::<[f32; 3]>())?)?;
        call.write(position_mm.cast(), from.moved(way).ok_or(StayaStatus::Number)?.mm)
    })
}
