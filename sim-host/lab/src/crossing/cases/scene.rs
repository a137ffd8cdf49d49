//! The scenes of [`super::Case`]: starts, goals and obstacles.

use super::{Case, Plan};
use staya_controller::agent::{GuidanceSetup, RouteSetup, SafetyKind};
use staya_controller::grid::{BLOCKED, Cell};
use staya_controller::lattice::{LatticeParams, ReferenceMotion};
use staya_controller::orca::AvoidParams;
use staya_controller::push_out::PushOutParams;
use staya_controller::rand::Rng;
use staya_controller::robot::RobotId;
use staya_sim::scenario::{Intruder, PlaneSetup, Robot, RobotGroup, Scenario, Start, Target, circle_starts};
use staya_sim::terrain::Terrain;
use staya_sim::world::plane::Solid;
use std::f64::consts::PI;

pub(super) const RADIUS_M: f64 = 0.3;
const TOLERANCE_M: f64 = 0.1;
/// Half the width of a road: three robots fit side by side.
const ROAD_M: f64 = 1.2;
const FAR_M: f64 = 30.0;
const APART_M: f64 = 0.9;
pub(super) const SPACING_M: f64 = 0.7;

const NOISE: u32 = 0x0045_0002;

fn start(at: [f64; 2], places: &[[f64; 2]]) -> Start {
    let fixed = |&[x, y]: &[f64; 2]| Target { position_m: [x, y, 0.0], velocity_mps: [0.0; 3] };
    Start {
        position_m: [at[0], at[1], 0.0],
        velocity_mps: [0.0; 3],
        places: places.iter().map(fixed).collect(),
        group: None,
    }
}

fn polygon(points: &[[f64; 2]]) -> impl Iterator<Item = Solid> {
    let next = points.iter().cycle().skip(1);
    points.iter().zip(next).map(|(&from, &to)| Solid::Wall([from, to]))
}

/// Along the direction of travel, and across it (centred).
fn in_rows(index: u32, row: u32, count: u32) -> [f64; 2] {
    let wide = row.min(count);
    [f64::from(index / row) * APART_M, (f64::from(index % row) - f64::from(wide - 1) / 2.0) * APART_M]
}

impl Plan {
    /// Builds the scenario of one run of a case.
    #[must_use]
    pub fn scenario(&self, case: Case, seed: u64) -> Scenario {
        let count = self.robots.unwrap_or_else(|| case.robots());
        let (starts, solids) = match case {
            Case::Blocks => blocks(count),
            Case::FourWays => roads(count, 4),
            Case::Tee => roads(count, 3),
            Case::Door => door(count, &[0.0]),
            Case::Doors => door(count, &[-3.0, 3.0]),
            Case::ParkedDoor => parked_door(count),
            Case::Corridor => corridor(count),
            Case::Parked => parked(count),
            Case::Mixed | Case::Intruder | Case::Blackout => (circle(count), Vec::new()),
            Case::Sphere => (sphere(count), Vec::new()),
            Case::DeadEnd => dead_end(count),
            Case::Flock => flock(count),
        };
        let mut setup = PlaneSetup::new(self.general(case), starts);
        setup.solids = solids;
        resize(&mut setup, self.size);
        if case == Case::Mixed {
            self.mix(&mut setup);
        }
        if case == Case::Intruder {
            let way_m = circle_m(count);
            setup.intruders.push(Intruder {
                position_m: [-way_m - 2.0, 0.2, 0.0].map(|x| x * self.size),
                velocity_mps: [self.conditions.speed_mps * self.size, 0.0, 0.0],
                radius_m: 2.0 * RADIUS_M * self.size,
                is_heard: true,
            });
        }
        for (index, start) in (0..).zip(&mut setup.starts) {
            let mut rng = Rng::keyed(seed, NOISE, index, 0);
            for axis in &mut start.position_m[..2] {
                *axis += (f64::from(rng.below(20_001)) / 1e4 - 1.0) * self.noise_m * self.size;
            }
        }
        let mut scenario = self.conditions.scenario(case.name(), seed, self.longest_s, setup);
        scenario.radio.range_m *= self.size;
        if case == Case::Blackout {
            let meet_s = circle_m(count) / self.conditions.speed_mps;
            scenario.radio.blackout_s = vec![[0.6 * meet_s, 0.6 * meet_s + self.blackout_s]];
        }
        if case == Case::DeadEnd {
            on_land(&mut scenario);
        }
        scenario
    }

    fn general(&self, case: Case) -> RobotGroup {
        let speed_mps = self.conditions.speed_mps * self.size;
        let group = self.conditions.group_at(speed_mps, RADIUS_M * self.size, TOLERANCE_M * self.size);
        match case {
            Case::DeadEnd => {
                let speed_mps = Some(group.cruise_mps as f32);
                RobotGroup { guidance: GuidanceSetup::Route { route: RouteSetup::default(), speed_mps }, ..group }
            }
            Case::Sphere => group.behind(SafetyKind::Fly, AvoidParams::default(), PushOutParams::new(1.0)),
            Case::Flock => {
                let mut group = self.conditions.group(SPACING_M / 7.0, TOLERANCE_M);
                let news_s = self.conditions.step_s as f32;
                let rate_hz = ((1.0 - self.conditions.loss) / self.conditions.step_s) as f32;
                let params = LatticeParams::new(SPACING_M as f32).stable_for(news_s, rate_hz);
                group.guidance = GuidanceSetup::Lattice { params, motion: ReferenceMotion::Dynamic };
                group
            }
            _ => group,
        }
    }

    fn mix(&self, setup: &mut PlaneSetup) {
        for (index, start) in setup.starts.iter_mut().enumerate() {
            let radius_m = RADIUS_M * self.size * [0.4, 0.7, 1.0, 1.3, 1.6][index % 5];
            let speed_mps = self.conditions.speed_mps * self.size * [1.0, 1.5, 2.0][index % 3];
            setup.groups.push(self.conditions.group_at(speed_mps, radius_m, TOLERANCE_M * self.size));
            start.group = Some(setup.groups.len() - 1);
        }
    }
}

/// Four square blocks between corners, with lanes that cross in the middle. Robots pass the ends of
/// the lanes as via points (RVO2's example `Blocks` at 0.15 m per unit).
fn blocks(count: u32) -> (Vec<Start>, Vec<Solid>) {
    let unit = 0.15;
    let mut solids = Vec::new();
    for [sx, sy] in [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]] {
        let corner = |x: f64, y: f64| [sx * x * unit, sy * y * unit];
        solids.extend(polygon(&[corner(10.0, 10.0), corner(40.0, 10.0), corner(40.0, 40.0), corner(10.0, 40.0)]));
    }
    let row = libm::ceil(libm::sqrt(f64::from(count))) as u32;
    let mut starts = Vec::new();
    for index in 0..count {
        for (sx, sy) in [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)] {
            let [i, j] = [index / row, index % row].map(|n| (55.0 + 10.0 * f64::from(n)) * unit);
            starts.push(start([sx * i, sy * j], &[[-sx * i, -sy * j]]));
        }
    }
    (starts, solids)
}

/// A group from each arm goes straight across; robots from the stem turn off to alternating sides.
fn roads(count: u32, arms: u32) -> (Vec<Start>, Vec<Solid>) {
    let (near, far) = (ROAD_M, FAR_M);
    let mut solids = Vec::new();
    let mut corner = |sx: f64, sy: f64| {
        solids.push(Solid::Wall([[sx * near, sy * far], [sx * near, sy * near]]));
        solids.push(Solid::Wall([[sx * near, sy * near], [sx * far, sy * near]]));
    };
    corner(-1.0, -1.0);
    corner(1.0, -1.0);
    if arms == 4 {
        corner(-1.0, 1.0);
        corner(1.0, 1.0);
    } else {
        solids.push(Solid::Wall([[-far, near], [far, near]]));
    }
    let ways = [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]];
    let mut starts = Vec::new();
    for index in 0..count {
        for [wx, wy] in ways.into_iter().take(arms as usize) {
            let [back, side] = in_rows(index, 2, count);
            let at = |along: f64| [wx * along - wy * side, wy * along + wx * side];
            // The front robot has the rearmost goal.
            let [end, _] = in_rows(count - 1 - index, 2, count);
            let goal = at(5.0 + end);
            let turn = if index % 2 == 0 { 1.0 } else { -1.0 };
            let stem = arms == 3 && wx == 0.0;
            let [behind, _] = in_rows(count + 1, 2, count);
            let turned = [turn * (5.0 + behind + end), turn * side.abs()];
            let places = if stem { vec![[0.0, 0.0], turned] } else { vec![goal] };
            starts.push(start(at(-5.0 - back), &places));
        }
    }
    (starts, solids)
}

/// Doors for one robot at these y, ascending, in a wall along x = 0.
fn wall_with_doors(doors: &[f64]) -> Vec<Solid> {
    let half = 0.5;
    let mut from = -FAR_M;
    let mut solids = Vec::new();
    for y in doors {
        solids.push(Solid::Wall([[0.0, from], [0.0, y - half]]));
        from = y + half;
    }
    solids.push(Solid::Wall([[0.0, from], [0.0, FAR_M]]));
    solids
}

/// Distance from the wall, and sideways, of robot `index` in a crowd.
fn before_wall(index: u32, count: u32) -> [f64; 2] {
    let [along, side] = in_rows(index, 5, count);
    [2.5 + along * 1.3, side * 1.6]
}

fn door(count: u32, doors: &[f64]) -> (Vec<Start>, Vec<Solid>) {
    let mut starts = Vec::new();
    for index in 0..count {
        let ([x, y], [goal_x, goal_y]) = (before_wall(index, count), before_wall(count - 1 - index, count));
        starts.push(start([-x, y], &[[goal_x, goal_y]]));
        starts.push(start([x, y], &[[-goal_x, goal_y]]));
    }
    (starts, wall_with_doors(doors))
}

/// Behind the door stand rows of parked robots, half a body apart. Half of the crowd has goals in
/// the middle of four parked robots, the others behind them all.
fn parked_door(count: u32) -> (Vec<Start>, Vec<Solid>) {
    let (first_m, parked) = (1.8, (count + count.div_ceil(2)).next_multiple_of(5).max(10));
    let mut starts = Vec::new();
    for index in 0..count {
        let [x, y] = before_wall(index, count);
        let half = index / 2;
        let goal = if index % 2 == 0 {
            let [along, side] = in_rows(half, 4, 4);
            [first_m + APART_M / 2.0 + along, side]
        } else {
            let [along, side] = in_rows(parked + half, 5, parked);
            [first_m + APART_M + along, side]
        };
        starts.push(start([-x, y], &[goal]));
    }
    for index in 0..parked {
        let [along, side] = in_rows(index, 5, parked);
        starts.push(start([first_m + along, side], &[]));
    }
    (starts, wall_with_doors(&[0.0]))
}

fn resize(setup: &mut PlaneSetup, size: f64) {
    let scale = |place: &mut [f64]| place.iter_mut().for_each(|x| *x *= size);
    for start in &mut setup.starts {
        scale(&mut start.position_m);
        start.places.iter_mut().for_each(|place| scale(&mut place.position_m));
    }
    for solid in &mut setup.solids {
        match solid {
            Solid::Wall(ends) => ends.iter_mut().for_each(|end| scale(end)),
            Solid::Ball { center_m, radius_m } => {
                scale(center_m);
                *radius_m *= size;
            }
            Solid::Plane { point_m, .. } => scale(point_m),
        }
    }
}

fn corridor(count: u32) -> (Vec<Start>, Vec<Solid>) {
    let half = 0.8;
    let solids = [-half, half].map(|y| Solid::Wall([[-FAR_M, y], [FAR_M, y]]));
    let mut starts = Vec::new();
    for index in 0..count {
        let (x, goal) = (3.0 + f64::from(index) * APART_M, 3.0 + f64::from(count - 1 - index) * APART_M);
        starts.push(start([-x, 0.0], &[[goal, 0.0]]));
        starts.push(start([x, 0.0], &[[-goal, 0.0]]));
    }
    (starts, solids.into())
}

fn parked(count: u32) -> (Vec<Start>, Vec<Solid>) {
    let mut starts = vec![start([-2.0, 0.0], &[[2.0, 0.0]])];
    for index in 0..count.saturating_sub(1) {
        let [_, side] = in_rows(index, count, count - 1);
        let at = [0.0, side * 0.75 / APART_M];
        starts.push(start(at, &[at]));
    }
    (starts, Vec::new())
}

fn circle_m(count: u32) -> f64 {
    (0.2 * f64::from(count)).max(3.0)
}

fn circle(count: u32) -> Vec<Start> {
    circle_starts(count, circle_m(count), 0.0, 0)
}

/// Evenly on a spiral; the goal of each is the opposite point.
fn sphere(count: u32) -> Vec<Start> {
    let radius_m = 3.0 * libm::sqrt(f64::from(count.max(16)) / 16.0);
    let golden = PI * (3.0 - libm::sqrt(5.0));
    let point = |index: u32| {
        let height = 1.0 - (2.0 * f64::from(index) + 1.0) / f64::from(count);
        let (ring, angle) = (libm::sqrt(1.0 - height * height), golden * f64::from(index));
        [libm::cos(angle) * ring, libm::sin(angle) * ring, height].map(|x| x * radius_m)
    };
    (0..count)
        .map(|index| Start {
            position_m: point(index),
            velocity_mps: [0.0; 3],
            places: vec![Target { position_m: point(index).map(|x| -x), velocity_mps: [0.0; 3] }],
            group: None,
        })
        .collect()
}

const LAND: i16 = 40;

fn dead_end(count: u32) -> (Vec<Start>, Vec<Solid>) {
    let starts = (0..count).map(|index| {
        let [x, y] = [14 + (index / 5) as i16, 18 + (index % 5) as i16].map(|cell| f64::from(cell) + 0.5);
        start([x, y], &[[x + 17.0, y]])
    });
    (starts.collect(), Vec::new())
}

/// Adds terrain: a bag from x = 10 to 24, open to the west.
fn on_land(scenario: &mut Scenario) {
    let mut land = Terrain::flat(LAND as u16, LAND as u16);
    for x in 10..=24 {
        land.set(Cell::new(x, 16), BLOCKED);
        land.set(Cell::new(x, 24), BLOCKED);
    }
    for y in 16..=24 {
        land.set(Cell::new(24, y), BLOCKED);
    }
    scenario.terrain = land;
    let Some(plane) = &mut scenario.plane else { return };
    plane.has_terrain = true;
    let cell = |place: [f64; 3]| Cell::new(libm::floor(place[0]) as i16, libm::floor(place[1]) as i16);
    scenario.robots = (1..)
        .zip(&plane.starts)
        .map(|(id, start)| Robot {
            id: RobotId(id),
            start: cell(start.position_m),
            goal: cell(start.places[0].position_m),
        })
        .collect();
}

fn flock(count: u32) -> (Vec<Start>, Vec<Solid>) {
    let row = libm::ceil(libm::sqrt(f64::from(count))) as u32;
    let target = Target { position_m: [0.0; 3], velocity_mps: [0.3, 0.0, 0.0] };
    let starts = (0..count).map(|index| {
        let [along, side] = in_rows(index, row, count).map(|x| x * SPACING_M / APART_M);
        Start { position_m: [-along, side, 0.0], velocity_mps: [0.0; 3], places: vec![target], group: None }
    });
    let ball = |y| Solid::Ball { center_m: [6.0, y, 0.0], radius_m: 1.0 };
    (starts.collect(), vec![ball(-2.0), ball(2.0)])
}
