//! Robots with an enum of laws act and speak exactly as robots with the law itself.

use super::*;
use crate::formation::NextMove;
use crate::geom::{Position, Vec2};
use crate::land::MapParams;
use crate::laws::any::large;
use core::ops::Range;

type Map = SharedMap<256>;
type Route = RouteGuidance<CELLS, VISITS, 0, Map>;
type Formation = FormationGuidance<CELLS, VISITS, TEMPLATE, 0, NextMove, Map>;
type Any = AnyLaw<f32, CELLS, VISITS, 0, Map>;

fn map() -> Map {
    SharedMap::new(MapParams::default())
}

fn route() -> Route {
    RouteGuidance::with_map(RouteParams::default(), map())
}

fn formation(id: u32) -> Formation {
    let template = formation_agent(id).law.template().clone();
    FormationGuidance::steered(RouteParams::default(), FormationParams::default(), template, NextMove, map())
}

/// The bytes, places and modes of the robots in each step.
#[derive(Debug, PartialEq)]
struct Track {
    said: Vec<Vec<u8>>,
    went: Vec<[i32; 2]>,
    modes: Vec<Mode>,
}

impl Track {
    fn count(&self, is_it: impl Fn(&Message) -> bool) -> usize {
        let messages = self.said.iter().flat_map(|said| frames(said)).map(|frame| decode(frame).unwrap().message);
        messages.filter(is_it).count()
    }

    /// Messages to one robot, acknowledgements, and messages to all.
    fn counts(&self) -> [usize; 3] {
        [
            self.count(|message| matches!(message, Message::Law(_))),
            self.count(|message| matches!(message, Message::Ack(_))),
            self.count(|message| matches!(message, Message::Broadcast(_))),
        ]
    }
}

/// A wall with a door, which is `gap` cells wide.
fn land(gap: Range<i16>) -> impl Fn(Cell) -> u8 {
    move |cell| if cell.x == 12 && !gap.contains(&cell.y) { BLOCKED } else { 1 }
}

fn seen(land: &dyn Fn(Cell) -> u8, at: Cell) -> Vec<u8> {
    let origin = at - Cell::new(5, 5);
    (0..11).flat_map(|y| (0..11).map(move |x| origin + Cell::new(x, y))).map(land).collect()
}

/// Runs robots cell by cell; a robot whose next cells are occupied stays. All hear `orders` first.
fn on_grid<A>(
    mut robots: Vec<(A, Cell)>,
    land: &dyn Fn(Cell) -> u8,
    orders: &[Message],
    steps: u32,
    mut step: impl FnMut(&mut A, &Inputs<'_, f32, OnGrid<'_>>, Instant) -> (Outputs<f32>, Mode),
) -> Track {
    let mut track = Track { said: vec![], went: vec![], modes: vec![] };
    let mut air = bytes(99, 0, 0, orders);
    for n in 0..steps {
        let mut next = vec![];
        for index in 0..robots.len() {
            let cells: Vec<Cell> = robots.iter().map(|(_, cell)| *cell).collect();
            let (robot, cell) = &mut robots[index];
            let view = seen(land, *cell);
            let (out, mode) = step(robot, &inputs(&view, *cell, &air), tick(n));
            if let Command::Move(moves) = &out.command {
                let free = moves.iter().map(|dir| *cell + dir.offset()).find(|to| !cells.contains(to));
                *cell = free.unwrap_or(*cell);
            }
            track.went.push([cell.x.into(), cell.y.into()]);
            track.modes.push(mode);
            next.extend_from_slice(&out.outbox);
            track.said.push(out.outbox.to_vec());
        }
        air = next;
    }
    track
}

/// Runs robots in the plane, in cells of 1 m. A robot does not come nearer than 0.8 m to another.
fn in_cells<A>(
    mut robots: Vec<(A, [f32; 2])>,
    land: &dyn Fn(Cell) -> u8,
    orders: &[Message],
    steps: u32,
    mut step: impl FnMut(&mut A, &Inputs<'_, f32, InCells<'_, f32>>, Instant) -> (Outputs<f32>, Mode),
) -> Track {
    let mut track = Track { said: vec![], went: vec![], modes: vec![] };
    let mut air = bytes(99, 0, 0, orders);
    for n in 0..steps {
        let mut next = vec![];
        for index in 0..robots.len() {
            let others: Vec<[f32; 2]> = robots.iter().map(|(_, at_m)| *at_m).collect();
            let (robot, at_m) = &mut robots[index];
            let cell = at_m.map(f32::floor);
            let under = Cell::new(cell[0] as i16, cell[1] as i16);
            let view = seen(land, under);
            let surroundings = InCells {
                grid: inputs(&view, under, &[]).surroundings,
                plane: InPlane { max_speed_mps: 0.5, obstacles: &[] },
                in_cell: InCell { offset_m: Vec2::new(at_m[0] - cell[0] - 0.5, at_m[1] - cell[1] - 0.5), cell_m: 1.0 },
            };
            let position = Position::from_mm([(at_m[0] * 1e3) as i32, (at_m[1] * 1e3) as i32, 0]);
            let state = KinematicState { position, ..KinematicState::default() };
            let (out, mode) = step(robot, &Inputs { state, surroundings, inbox: &air }, tick(n));
            if let Command::Velocity(velocity_mps) = &out.command {
                let to = [at_m[0] + velocity_mps.x, at_m[1] + velocity_mps.y];
                let apart = |from: [f32; 2], other: [f32; 2]| Vec2::new(from[0] - other[0], from[1] - other[1]).norm();
                let hits =
                    |(at, other): (usize, &[f32; 2])| at != index && apart(to, *other) < apart(*at_m, *other).min(0.8);
                *at_m = if others.iter().enumerate().any(hits) { *at_m } else { to };
            }
            track.went.push(position.mm[..2].try_into().unwrap());
            track.modes.push(mode);
            next.extend_from_slice(&out.outbox);
            track.said.push(out.outbox.to_vec());
        }
        air = next;
    }
    track
}

fn agent<L: Law<f32>>(id: u32, law: L) -> Agent<f32, L, NEIGHBORS> {
    Agent::new(&config(id), law, Unguarded, Postcard)
}

fn on_grid_as_any(robots: Vec<(Any, Cell)>, land: &dyn Fn(Cell) -> u8, orders: &[Message], steps: u32) -> Track {
    let mut ws = workspace();
    let robots = (1..).zip(robots).map(|(id, (law, cell))| (agent(id, law), cell)).collect();
    on_grid(robots, land, orders, steps, |agent, inputs, now| (agent.step(&inputs.any(), now, &mut ws), agent.mode()))
}

fn in_cells_as_any(robots: Vec<(Any, [f32; 2])>, land: &dyn Fn(Cell) -> u8, orders: &[Message], steps: u32) -> Track {
    let mut ws = workspace();
    let robots = (1..).zip(robots).map(|(id, (law, at_m))| (agent(id, law), at_m)).collect();
    in_cells(robots, land, orders, steps, |agent, inputs, now| (agent.step(&inputs.any(), now, &mut ws), agent.mode()))
}

/// Two robots meet head on in a corridor of one cell.
#[test]
fn routes_on_the_grid_are_equal() {
    let corridor = |cell: Cell| if cell.y == 5 { 1 } else { BLOCKED };
    let orders = [1, 2].map(|to| {
        let goal = Cell::new(if to == 1 { 30 } else { -30 }, 5);
        Grid::order(RobotId(to), 1, &GridOrder::Goal(goal)).unwrap()
    });
    let cells = [Cell::new(3, 5), Cell::new(8, 5)];
    let mut ws = workspace();
    let robots = (1..).zip(cells).map(|(id, cell)| (agent(id, route()), cell)).collect();
    let typed =
        on_grid(robots, &corridor, &orders, 60, |agent, inputs, now| (agent.step(inputs, now, &mut ws), agent.mode()));
    let any =
        on_grid_as_any(cells.map(|cell| (Any::Route(OverCells::OnGrid(route())), cell)).into(), &corridor, &orders, 60);
    assert_eq!(typed, any);
    assert!(typed.counts().iter().all(|count| *count > 0), "{:?}", typed.counts());
}

/// Robot 3 begins far behind its place, and so does robot 2 behind a door; templates come by radio.
fn formation_orders() -> Vec<Message> {
    let mut orders = vec![goal(0, 1, Cell::new(40, 5))];
    for id in [2, 3] {
        let template = formation_agent(id).law.template().clone();
        let parts = TemplatePart::split(1, template.slot, template.offset, &template.entries).unwrap();
        orders.extend(template_orders(id, parts));
    }
    orders
}

#[test]
fn formations_on_the_grid_are_equal() {
    let cells = [Cell::new(10, 5), Cell::new(7, 5), Cell::new(-3, 9)];
    let orders = formation_orders();
    let land = land(4..7);
    let mut ws = workspace();
    let robots = (1..).zip(cells).map(|(id, cell)| (agent(id, formation(id)), cell)).collect();
    let typed =
        on_grid(robots, &land, &orders, 90, |agent, inputs, now| (agent.step(inputs, now, &mut ws), agent.mode()));
    let any =
        (1..).zip(cells).map(|(id, cell)| (Any::Formation(OverCells::OnGrid(large(formation(id)))), cell)).collect();
    assert_eq!(typed, on_grid_as_any(any, &land, &orders, 90));
    assert!(typed.counts().iter().all(|count| *count > 0), "{:?}", typed.counts());
    assert!(typed.went.ends_with(&[[40, 5], [37, 5], [34, 5]]), "{:?}", typed.went.last());
}

#[test]
fn routes_in_the_plane_are_equal() {
    let corridor = |cell: Cell| if cell.y == 5 { 1 } else { BLOCKED };
    let orders = [1, 2].map(|to| {
        let goal = Cell::new(if to == 1 { 30 } else { 6 }, 5);
        Grid::order(RobotId(to), 1, &GridOrder::Goal(goal)).unwrap()
    });
    let places = [[3.5, 5.5], [6.5, 5.5]];
    let law = || CellFollower::new(route(), 0.5);
    let mut ws = workspace();
    let robots = (1..).zip(places).map(|(id, at_m)| (agent(id, law()), at_m)).collect();
    let typed =
        in_cells(robots, &corridor, &orders, 80, |agent, inputs, now| (agent.step(inputs, now, &mut ws), agent.mode()));
    let any = places.map(|at_m| (Any::Route(OverCells::InPlane(large(law()))), at_m)).into();
    assert_eq!(typed, in_cells_as_any(any, &corridor, &orders, 80));
    assert!(typed.counts().iter().all(|count| *count > 0), "{:?}", typed.counts());
}

#[test]
fn formations_in_the_plane_are_equal() {
    let places = [[10.5, 5.5], [7.5, 5.5], [-3.5, 9.5]];
    let orders = formation_orders();
    let land = land(3..8);
    let law = |id| FormationInPlane::new(formation(id), 0.5);
    let mut ws = workspace();
    let robots = (1..).zip(places).map(|(id, at_m)| (agent(id, law(id)), at_m)).collect();
    let typed =
        in_cells(robots, &land, &orders, 150, |agent, inputs, now| (agent.step(inputs, now, &mut ws), agent.mode()));
    let any = (1..).zip(places).map(|(id, at_m)| (Any::Formation(OverCells::InPlane(large(law(id)))), at_m)).collect();
    assert_eq!(typed, in_cells_as_any(any, &land, &orders, 150));
    assert!(typed.counts().iter().all(|count| *count > 0), "{:?}", typed.counts());
}

#[test]
fn robots_with_waypoints_are_equal() {
    let places = [[0.0, 0.0], [4.0, 2.0]];
    let orders = [(1, [4_000, 0, 0]), (2, [0, 2_000, 0])].map(|(to, mm)| {
        let waypoint = Waypoint::fixed(Position::from_mm(mm));
        Waypoints::order(RobotId(to), 1, &WaypointOrder::first(waypoint)).unwrap()
    });
    let law = || WaypointGuidance::new(0.5, 0.02);
    let robots = (1..).zip(places).map(|(id, at_m)| (agent(id, law()), at_m)).collect();
    let typed = in_cells(robots, &|_| 1, &orders, 20, |agent, inputs, now| {
        let Inputs { state, surroundings, inbox } = *inputs;
        let out = agent.step(&Inputs { state, surroundings: InPlane::from(surroundings), inbox }, now, &mut ());
        (out, agent.mode())
    });
    let any = places.map(|at_m| (Any::Waypoint(law()), at_m)).into();
    assert_eq!(typed, in_cells_as_any(any, &|_| 1, &orders, 20));
    assert!(typed.modes.ends_with(&[Mode::Arrived; 2]));
}
