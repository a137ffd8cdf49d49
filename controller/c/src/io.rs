//! Inputs and outputs of a step, as plain structures.

use crate::choices::{StayaCommand, StayaEventKind, StayaMode, StayaShape, StayaWait};
use crate::chosen::Place;
use crate::memory::{Call, plain};
use crate::setup::StayaCell;
use crate::status::{Checked, StayaStatus};
use crate::{Number, OBSTACLES};
use heapless::Vec;
use staya_controller::agent::{
    AnyInputs, AnySurroundings, CellState, Command, EVENTS, Event, InCell, InCells, InPlane, Inputs, KinematicState,
    OUTBOX, OnGrid, Outputs,
};
use staya_controller::geom::{Position, Vec2, Vec3};
use staya_controller::grid::Window;
use staya_controller::neighbor::Claim;
use staya_controller::obstacle::Obstacle;
use staya_controller::scalar::{Scalar, cast};
use staya_controller::time::Duration;

/// Maximum number of bytes that one step can send.
pub const STAYA_OUTBOX: usize = 256;
/// Maximum number of events that one step can report.
pub const STAYA_EVENTS: usize = 8;

/// Size of StayaOutputs in bytes, on every machine.
pub const STAYA_OUTPUTS_SIZE: usize = 444;

const _: () = assert!(STAYA_OUTBOX == OUTBOX && STAYA_EVENTS == EVENTS);
const _: () =
    assert!(matches!([Claim::Number as u8, Claim::Radius as u8, Claim::Speed as u8, Claim::Jump as u8], [0, 1, 2, 3]));
const _: () = assert!(size_of::<StayaOutputs>() == STAYA_OUTPUTS_SIZE);

/// A static obstacle, relative to the robot's position, metres.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct StayaObstacle {
    /// StayaShape.
    pub shape: u32,
    /// A wall's first end, a ball's centre, a plane's normal.
    pub x_m: f32,
    /// See `x_m`.
    pub y_m: f32,
    /// See `x_m`.
    pub z_m: f32,
    /// A wall's second end.
    pub x2_m: f32,
    /// See `x2_m`.
    pub y2_m: f32,
    /// A ball's radius, or how far the robot is in front of a plane.
    pub size_m: f32,
}

/// The input of a step. All zeros: stationary at the origin, with nothing seen or received.
///
/// Robots with velocities as commands need `max_speed_mps`. Robots that cross land in cells need
/// `cell` and `window`; with velocities as commands also `in_cell_x_m`, `in_cell_y_m` and `cell_m`.
/// The other fields are then ignored. With the law "external" a `window` puts the robot into cells,
/// and `cell_m` above 0 lets it move by velocities there.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct StayaInputs {
    /// Position in the world: east, north, up from an origin that all robots share, millimetres.
    pub position_mm: [i32; 3],
    /// The robot's velocity in the world, m/s.
    pub velocity_mps: [f32; 3],
    /// The robot's clock, microseconds; it wraps after 71.6 minutes.
    pub now_us: u32,
    /// Highest possible speed in this place, m/s; with 0 the robot stops in STAYA_MODE_FAULT.
    pub max_speed_mps: f32,
    /// The robot's cell.
    pub cell: StayaCell,
    /// Time until it may leave its cell, microseconds; only for moves from cell to cell.
    pub busy_us: i32,
    /// Its position in its cell, metres from the cell's centre.
    pub in_cell_x_m: f32,
    /// See `in_cell_x_m`.
    pub in_cell_y_m: f32,
    /// Side of a cell, metres.
    pub cell_m: f32,
    /// South-west cell of the visible land.
    pub window_origin: StayaCell,
    /// Cells from west to east.
    pub window_width: u16,
    /// Cells from south to north.
    pub window_height: u16,
    /// How hard each cell is to cross, row by row from the south-west: 1 easy, 255 hard, 0
    /// impassable; width * height bytes. Null: the robot sees no land, and is in STAYA_MODE_FAULT.
    pub window: *const u8,
    /// Obstacles, `obstacle_count` of them, at most 32 (16 if the library was built small).
    pub obstacles: *const StayaObstacle,
    /// Length of `obstacles`.
    pub obstacle_count: usize,
    /// `inbox_bytes` bytes from the radio since the last step, in order, with damaged frames.
    pub inbox: *const u8,
    /// Length of `inbox`.
    pub inbox_bytes: usize,
}

/// An event.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct StayaEvent {
    /// The robot concerned; 0 for none.
    pub robot: u32,
    /// The previous cell.
    pub before_xy: StayaCell,
    /// The present cell.
    pub after_xy: StayaCell,
    /// StayaEventKind, which defines the fields that are used.
    pub kind: u8,
    /// The previous number.
    pub before: u8,
    /// The present number.
    pub after: u8,
}

/// The output of a step.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct StayaOutputs {
    /// World velocity until the next step, m/s; with STAYA_COMMAND_VELOCITY.
    pub velocity_mps: [f32; 3],
    /// When to call again unless bytes arrive before: the robot's clock, microseconds.
    pub call_again_us: u32,
    /// The leader that it follows; 0 if there is none.
    pub leader: u32,
    /// The cell that it is heading for; with `has_target`.
    pub target: StayaCell,
    /// Frames accepted: intact, not received before, from another robot.
    pub received: u16,
    /// Frames rejected: damaged, repeated, not authentic.
    pub rejected: u16,
    /// Of those: without a code.
    pub refused_unsigned: u16,
    /// Of those: with a code that does not match the key or the content.
    pub refused_forged: u16,
    /// Of those: replayed, or with a counter too far ahead.
    pub refused_replayed: u16,
    /// Of those: from senders that do not fit into the table.
    pub refused_no_room: u16,
    /// Beacons with a number beyond `plausibility_last_id`.
    pub implausible_numbers: u16,
    /// Beacons with too large a radius.
    pub implausible_radii: u16,
    /// Beacons with too high a speed.
    pub implausible_speeds: u16,
    /// Beacons with a position that the robot cannot have reached yet.
    pub implausible_places: u16,
    /// Length of `outbox`.
    pub outbox_bytes: u16,
    /// StayaCommand.
    pub command: u8,
    /// Moves to try in this order (StayaDir), `move_count` of them; with STAYA_COMMAND_MOVE.
    pub moves: [u8; 8],
    /// Length of `moves`.
    pub move_count: u8,
    /// Its activity: StayaMode.
    pub mode: u8,
    /// Why it waits: StayaWait.
    pub wait: u8,
    /// Whether it has a goal, and so a `target`.
    pub has_target: u8,
    /// Length of `events`.
    pub event_count: u8,
    /// The events; the oldest ones if there are more.
    pub events: [StayaEvent; STAYA_EVENTS],
    /// Bytes for the radio, `outbox_bytes` of them.
    pub outbox: [u8; STAYA_OUTBOX],
}

plain!(StayaObstacle, StayaInputs, StayaEvent, StayaOutputs);

pub(crate) fn vector<S: Scalar>([x, y, z]: [f32; 3]) -> Vec3<S> {
    Vec3::new(cast(x), cast(y), cast(z))
}

/// [`vector`] of numbers that must be finite.
pub(crate) fn finite<S: Scalar>(numbers: [f32; 3]) -> Checked<Vec3<S>> {
    let are_finite = numbers.iter().all(|number| number.is_finite());
    are_finite.then(|| vector(numbers)).ok_or(StayaStatus::Number)
}

pub(crate) fn array(vector: Vec3<Number>) -> [f32; 3] {
    [cast(vector.x), cast(vector.y), cast(vector.z)]
}

impl StayaObstacle {
    fn obstacle(&self) -> Checked<Obstacle<Number>> {
        let shape = u8::try_from(self.shape).map_err(|_| StayaStatus::Choice)?;
        let place = vector([self.x_m, self.y_m, self.z_m]);
        Ok(match StayaShape::of(shape)? {
            StayaShape::Wall => Obstacle::Wall([place.xy(), Vec2::new(cast(self.x2_m), cast(self.y2_m))]),
            StayaShape::Ball => Obstacle::Ball { center_m: place, radius_m: cast(self.size_m) },
            StayaShape::Plane => Obstacle::Plane { normal: place, distance_m: cast(self.size_m) },
        })
    }
}

pub(crate) fn read_obstacles(from: &[StayaObstacle], to: &mut Vec<Obstacle<Number>, OBSTACLES>) -> Checked<()> {
    to.clear();
    from.iter().try_for_each(|obstacle| to.push(obstacle.obstacle()?).map_err(|_| StayaStatus::TooMany))
}

impl StayaInputs {
    pub(crate) fn inputs<'a>(
        &self,
        call: Call<'a>,
        place: Place,
        obstacles: &'a mut Vec<Obstacle<Number>, OBSTACLES>,
    ) -> Checked<AnyInputs<'a, Number>> {
        let inbox = call.row(self.inbox, self.inbox_bytes)?;
        read_obstacles(call.row(self.obstacles, self.obstacle_count)?, obstacles)?;
        let plane = InPlane { max_speed_mps: cast(self.max_speed_mps), obstacles: obstacles.as_slice() };
        let place = match place {
            Place::Any if self.window.is_null() => Place::Plane,
            Place::Any if self.cell_m == 0.0 => Place::Grid,
            Place::Any => Place::Cells,
            place => place,
        };
        let surroundings = match place {
            Place::Grid => AnySurroundings::OnGrid(self.grid(call, Duration::from_micros(self.busy_us))?),
            Place::Cells => {
                if !(self.cell_m > 0.0 && self.cell_m.is_finite()) {
                    return Err(StayaStatus::Number);
                }
                let offset_m = Vec2::new(cast(self.in_cell_x_m), cast(self.in_cell_y_m));
                let in_cell = InCell { offset_m, cell_m: cast(self.cell_m) };
                AnySurroundings::InCells(InCells { grid: self.grid(call, Duration::ZERO)?, plane, in_cell })
            }
            _ => AnySurroundings::InPlane(plane),
        };
        let position = Position::from_mm(self.position_mm);
        let state = KinematicState { position, velocity_mps: vector(self.velocity_mps) };
        Ok(Inputs { state, surroundings, inbox })
    }

    fn grid<'a>(&self, call: Call<'a>, busy: Duration) -> Checked<OnGrid<'a>> {
        let cell = CellState { cell: self.cell.into(), busy };
        if self.window.is_null() {
            return Ok(OnGrid { cell, window: None });
        }
        let count = usize::from(self.window_width).saturating_mul(self.window_height.into());
        let (cells, origin) = (call.row(self.window, count)?, self.window_origin.into());
        let window = Window::new(cells, origin, self.window_width, self.window_height).ok_or(StayaStatus::Shape)?;
        Ok(OnGrid { cell, window: Some(window) })
    }
}

impl StayaEvent {
    fn of(event: Event) -> Self {
        let about = Self { kind: StayaEventKind::from(event) as u8, ..Self::default() };
        match event {
            Event::ModeChanged { from, to } => {
                Self { before: StayaMode::from(from) as u8, after: StayaMode::from(to) as u8, ..about }
            }
            Event::TargetMoved { from, to } => Self { before_xy: from.into(), after_xy: to.into(), ..about },
            Event::Implausible { id, claim } => Self { robot: id.0, after: claim as u8, ..about },
            Event::MessageExpired(id)
            | Event::NeighborFound(id)
            | Event::NeighborLost(id)
            | Event::NeighborEvicted(id)
            | Event::NeighborRebooted(id)
            | Event::DuplicateId(id) => Self { robot: id.0, ..about },
            Event::NoRoute | Event::ContactLost | Event::Muted => about,
        }
    }
}

impl StayaOutputs {
    /// Writes the output of a step; fields that do not apply remain 0.
    pub(crate) fn fill(&mut self, out: &Outputs<Number>) {
        match &out.command {
            Command::Hold => self.command = StayaCommand::Hold as u8,
            Command::Move(moves) => {
                (self.command, self.move_count) = (StayaCommand::Move as u8, moves.len() as u8);
                self.moves.iter_mut().zip(moves).for_each(|(to, dir)| *to = dir.index() as u8);
            }
            Command::Velocity(velocity_mps) => {
                (self.command, self.velocity_mps) = (StayaCommand::Velocity as u8, array(*velocity_mps));
            }
        }
        self.call_again_us = out.call_again.as_micros();
        self.wait = out.wait.map_or(StayaWait::Nothing, StayaWait::from) as u8;
        (self.received, self.rejected) = (out.received, out.rejected);
        (self.refused_unsigned, self.refused_forged) = (out.refused.unsigned, out.refused.forged);
        (self.refused_replayed, self.refused_no_room) = (out.refused.replayed, out.refused.no_room);
        (self.implausible_numbers, self.implausible_radii) = (out.implausible.numbers, out.implausible.radii);
        (self.implausible_speeds, self.implausible_places) = (out.implausible.speeds, out.implausible.jumps);
        self.event_count = out.events.len() as u8;
        self.events.iter_mut().zip(&out.events).for_each(|(to, event)| *to = StayaEvent::of(*event));
        self.outbox_bytes = out.outbox.len() as u16;
        self.outbox.iter_mut().zip(&out.outbox).for_each(|(to, byte)| *to = *byte);
    }
}
