//! Read-only inspection of a robot's knowledge and its next decision. The run is not affected.

use super::safety::ScenarioSafety;
use super::witness::Asked;
use super::{Engine, Senses, Tick, WIDE};
use staya_controller::agent::{
    AnySafety, AnySurroundings, Command, GridWorkspace, HALF_PLANES, Law as _, OrcaSafety, Outputs,
};
use staya_controller::cost::TICK;
use staya_controller::geom::{Position, Vec2, Vec3};
use staya_controller::grid::Cell;
use staya_controller::neighbor::Neighbor;
use staya_controller::orca::HalfSpaces;
use staya_controller::parameters::{Parameter, Parameters};
use staya_controller::robot::RobotId;
use staya_controller::time::Instant;
use std::iter;

/// Another robot, as stored by a robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Known {
    /// Id of the other robot.
    pub id: RobotId,
    /// Estimated current position, metres.
    pub position_m: [f64; 3],
    /// Velocity in its last beacon, m/s.
    pub velocity_mps: [f64; 3],
    /// Age of its last beacon, seconds.
    pub age_s: f64,
}

/// Neighbours of an agent at `now`, in table order. `own` is the agent's estimate of its position,
/// `own_m` the same place in world coordinates, metres. O(neighbours).
pub fn known<'a, P>(
    neighbors: &'a [Neighbor<f32, P>],
    own: Position,
    own_m: [f64; 3],
    now: Instant,
) -> impl Iterator<Item = Known> + 'a {
    neighbors.iter().map(move |other| {
        let longest = other.age(now).unwrap_or_default();
        let way = other.offset_at(own, now, longest);
        let way = [way.x, way.y, way.z].map(f64::from);
        Known {
            id: other.id,
            position_m: [0, 1, 2].map(|axis| own_m[axis] + way[axis]),
            velocity_mps: [other.velocity_mps.x, other.velocity_mps.y, other.velocity_mps.z].map(f64::from),
            age_s: f64::from(longest.as_micros()) / 1e6,
        }
    })
}

/// The terrain window of a robot, with path costs.
#[derive(Clone, Debug, PartialEq)]
pub struct SeenLand {
    /// South-west cell.
    pub corner: Cell,
    /// Cells from west to east.
    pub width: u16,
    /// Classes row by row from the south-west corner, as in [`Terrain`](crate::terrain::Terrain).
    pub cells: Vec<u8>,
    /// Ticks from each cell to the exit of the last search; NaN if unreachable or not searched.
    pub costs: Vec<f32>,
}

/// A half-space of permitted velocities.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Permitted {
    /// A point on its border, m/s.
    pub point_mps: [f32; 3],
    /// Unit vector into the half-space.
    pub normal: [f32; 3],
    /// Whether it comes from an obstacle, not from a robot.
    pub is_of_obstacle: bool,
}

/// Input and result of a safety layer.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// Velocity chosen by the guidance law, m/s.
    pub wish_mps: [f32; 3],
    /// Velocity commanded to the body, m/s.
    pub chosen_mps: [f32; 3],
    /// The body's highest speed at this place, m/s.
    pub max_speed_mps: f32,
    /// Half-spaces of ORCA; empty for other layers.
    pub permitted: Vec<Permitted>,
}

/// A robot's knowledge before its next step, and the decision that it will make.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Inspection {
    /// Known robots, in the order of the neighbour table.
    pub known: Vec<Known>,
    /// The cells to which its law moves it and robots nearby in this step.
    pub plan: Vec<(RobotId, Cell)>,
    /// Terrain window; only on the grid.
    pub land: Option<SeenLand>,
    /// Safety decision; only for robots controlled by velocity.
    pub choice: Option<Choice>,
    /// Parameters of the robot.
    pub parameters: Vec<(&'static Parameter, f32)>,
    /// Bytes sent since the last start.
    pub sent_bytes: u64,
    /// Bytes received since the last start.
    pub heard_bytes: u64,
}

impl Engine {
    /// The robots that robot `index` knows and does not count as lost; none if it is down or
    /// external. O(neighbours).
    #[must_use]
    pub fn known(&self, index: usize) -> Vec<RobotId> {
        let agent = self.computers[index].agent.iter().filter(|_| self.is_up(index));
        agent.flat_map(|agent| agent.neighbors()).map(|other| other.id).collect()
    }

    /// Knowledge and next decision of robot `index`, by a step of a copy of its agent; empty if it
    /// is down or external.
    #[must_use]
    pub fn inspect(&self, index: usize) -> Inspection {
        let computer = &self.computers[index];
        let Some(agent) = computer.agent.as_ref().filter(|_| self.is_up(index)) else {
            return Inspection::default();
        };
        let mut agent = agent.clone();
        agent.safety_mut().listen();
        let (mut senses, mut heard) = (Senses::default(), Vec::new());
        let orders = self.ground.view(self.tick).orders;
        let moment = Tick { tick: self.tick, ground: &*self.ground, radio: &self.radio, orders };
        let (frames, _, pieces) = moment.delivered(index, computer);
        let inputs = moment.inputs(index, computer, &mut senses, pieces, &mut heard);
        let now = computer.clock.now(self.tick, self.id(index), &self.timing);
        let mut workspace = GridWorkspace::<WIDE>::default();
        let mut seen = Vec::new();
        self.ground.sightings(index, self.tick, computer.clock.since(self.tick), &mut seen);
        let _ = agent.see(&seen, &inputs.state, now);
        let mut out = Outputs::default();
        agent.hear_decoded_into(frames, &inputs, now, &mut out);
        agent.act_into(&inputs, now, &mut workspace, &mut out);
        let own = inputs.state.position;
        let own_m = self.ground.motion(index, self.tick).position_m;
        let window = match &inputs.surroundings {
            AnySurroundings::OnGrid(grid) => grid.window,
            AnySurroundings::InCells(cells) => cells.grid.window,
            AnySurroundings::InPlane(_) => None,
        };
        let land = window.map(|window| {
            let columns = (0..window.height()).flat_map(|y| (0..window.width()).map(move |x| (x, y)));
            let cost = |(x, y): (u16, u16)| {
                let cell = window.origin() + Cell::new(x.cast_signed(), y.cast_signed());
                workspace.field().cost(cell).map_or(f32::NAN, |cost| cost as f32 / TICK as f32)
            };
            SeenLand {
                corner: window.origin(),
                width: window.width(),
                cells: window.cells().to_vec(),
                costs: columns.map(cost).collect(),
            }
        });
        let chosen = match out.command {
            Command::Velocity(v) => Some([v.x, v.y, v.z]),
            Command::Hold | Command::Move(_) => None,
        };
        let choice = agent.safety().asked().map(|asked| Choice {
            wish_mps: [asked.wish_mps.x, asked.wish_mps.y, asked.wish_mps.z],
            chosen_mps: chosen.unwrap_or_default(),
            max_speed_mps: asked.body.max_speed_mps,
            permitted: permitted(agent.safety().inside(), asked),
        });
        let planned = iter::once(self.id(index)).chain(agent.neighbors().iter().map(|other| other.id));
        let plan = planned.filter_map(|id| Some((id, agent.law().expects(id)?)));
        Inspection {
            plan: plan.collect(),
            known: known(agent.neighbors(), own, own_m, now).collect(),
            land,
            choice,
            parameters: listed(|visit| agent.parameters(visit)),
            sent_bytes: computer.sent_bytes,
            heard_bytes: computer.heard_bytes,
        }
    }
}

/// Parameters and their values in the tables that `each` visits; the first of equal names.
pub(super) fn listed(each: impl FnOnce(&mut dyn FnMut(&mut dyn Parameters))) -> Vec<(&'static Parameter, f32)> {
    let mut rows: Vec<(&Parameter, f32)> = Vec::new();
    each(&mut |table| {
        for (index, row) in table.table().iter().enumerate() {
            if rows.iter().all(|(other, _)| other.name != row.name) {
                rows.extend(table.get(index).map(|value| (row, value)));
            }
        }
    });
    rows
}

fn permitted(layer: &ScenarioSafety, asked: &Asked) -> Vec<Permitted> {
    match layer {
        ScenarioSafety::BuiltIn(AnySafety::Orca(layer) | AnySafety::Template2k(layer)) => half_planes(layer, asked),
        ScenarioSafety::Voxel(layer) => half_planes(layer, asked),
        ScenarioSafety::BuiltIn(AnySafety::Fly(layer)) => half_spaces(layer, asked),
        ScenarioSafety::VoxelInSpace(layer) => half_spaces(layer, asked),
        ScenarioSafety::BuiltIn(AnySafety::None(_) | AnySafety::PushOut(_)) => Vec::new(),
    }
}

fn half_planes<P: HalfSpaces<f32, Velocity = Vec2<f32>>>(
    layer: &OrcaSafety<f32, HALF_PLANES, P>,
    Asked { body, nearby, obstacles, .. }: &Asked,
) -> Vec<Permitted> {
    let (hard, planes) = layer.avoider().half_spaces(body, nearby, obstacles);
    let flat = |v: Vec2<f32>| [v.x, v.y, 0.0];
    let planes = planes.iter().enumerate();
    planes.map(|(at, plane)| permitting([plane.point, plane.normal].map(flat), at < hard)).collect()
}

fn half_spaces<P: HalfSpaces<f32, Velocity = Vec3<f32>>>(
    layer: &OrcaSafety<f32, HALF_PLANES, P>,
    Asked { body, nearby, obstacles, .. }: &Asked,
) -> Vec<Permitted> {
    let (hard, spaces) = layer.avoider().half_spaces(body, nearby, obstacles);
    let all = |v: Vec3<f32>| [v.x, v.y, v.z];
    let spaces = spaces.iter().enumerate();
    spaces.map(|(at, space)| permitting([space.point, space.normal].map(all), at < hard)).collect()
}

const fn permitting([point_mps, normal]: [[f32; 3]; 2], is_of_obstacle: bool) -> Permitted {
    Permitted { point_mps, normal, is_of_obstacle }
}
