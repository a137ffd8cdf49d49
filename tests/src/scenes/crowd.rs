//! Crowds of a scene: starts and goals, with the walls around them.

use super::draw::Draw;

/// A robot of a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Member {
    /// Start, metres.
    pub start_m: [f64; 3],
    /// Goal, metres.
    pub goal_m: [f64; 3],
    /// Radius, metres.
    pub radius_m: f64,
    /// Highest speed, m/s.
    pub speed_mps: f64,
}

/// Robots with starts and goals.
#[derive(Clone, Debug, Default)]
pub struct Crowd {
    /// The robots.
    pub members: Vec<Member>,
    /// Walls from one point to another, metres.
    pub walls_m: Vec<[[f64; 2]; 2]>,
    /// Corner of the room from the origin, metres, if there is a room; for flyers.
    pub room_m: Option<f64>,
    /// Robots that must pass one place one after the other.
    pub queue: usize,
}

/// Arrangement of starts and goals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layout {
    /// Robots on a circle with goals opposite.
    Circle,
    /// Random starts and goals in a square.
    Square,
    /// Two blocks of robots exchange places.
    Blocks,
    /// The points of a lattice exchange robots at random.
    Lattice,
    /// Two streams cross at a right angle.
    Streams,
    /// Two crowds exchange rooms through a door.
    Door,
    /// Two crowds pass each other in a corridor.
    Corridor,
    /// Random starts and goals of flyers in a cube.
    Room,
}

/// Layouts in the plane without walls.
pub const OPEN: [Layout; 5] = [Layout::Circle, Layout::Square, Layout::Blocks, Layout::Lattice, Layout::Streams];

/// Size of the robots of a crowd, the largest if they differ.
#[derive(Clone, Copy, Debug)]
pub struct Size {
    /// Number of robots, roughly.
    pub count: usize,
    /// Radius, metres.
    pub radius_m: f64,
    /// Highest speed, m/s.
    pub speed_mps: f64,
    /// Vertical over horizontal distance of flyers.
    pub downwash: f64,
    /// Whether lattices have hardly more space than the robots need.
    pub is_dense: bool,
}

type Place = [f64; 3];

impl Crowd {
    /// Draws a crowd.
    pub fn new(draw: &mut Draw, layout: Layout, size: Size) -> Self {
        let Size { count, radius_m, .. } = size;
        let gap_m = draw.within(0.5, 2.0) * radius_m + 0.05;
        let step_m = 2.0 * radius_m + gap_m;
        let (ways, walls_m) = match layout {
            Layout::Circle => (circle(draw, count, step_m), Vec::new()),
            Layout::Square => (square(draw, count, radius_m), Vec::new()),
            Layout::Blocks => (blocks(draw, count, step_m), Vec::new()),
            Layout::Lattice => (lattice(draw, &size), Vec::new()),
            Layout::Streams => (streams(draw, count, step_m), Vec::new()),
            Layout::Door => door(draw, count, radius_m, step_m),
            Layout::Corridor => corridor(draw, count, radius_m),
            Layout::Room => return room(draw, &size),
        };
        let queue = if walls_m.is_empty() { 0 } else { ways.len() };
        Self { members: members(ways, &size), walls_m, room_m: None, queue }
    }

    /// Longest distance from a start to its goal, metres.
    #[must_use]
    pub fn longest_m(&self) -> f64 {
        self.members.iter().map(|member| distance_m(member.start_m, member.goal_m)).fold(0.0, f64::max)
    }

    /// Distance of the place where two robots pass each other, metres, if both drive straight at
    /// their highest speed.
    #[must_use]
    pub fn miss_m(&self, one: usize, other: usize) -> f64 {
        let at = |member: &Member, time_s: f64| {
            let way_m = distance_m(member.start_m, member.goal_m).max(1e-9);
            let share = (time_s * member.speed_mps / way_m).min(1.0);
            [0, 1, 2].map(|axis| member.start_m[axis] + share * (member.goal_m[axis] - member.start_m[axis]))
        };
        let (one, other) = (&self.members[one], &self.members[other]);
        let end_s = self.longest_m() / one.speed_mps.min(other.speed_mps);
        let times_s = (0..=100).map(|part| f64::from(part) / 100.0 * end_s);
        times_s.map(|time_s| distance_m(at(one, time_s), at(other, time_s))).fold(f64::INFINITY, f64::min)
    }

    /// Whether the start of a robot is far from the straight ways of all others.
    #[must_use]
    pub fn is_aside(&self, robot: usize) -> bool {
        let own = &self.members[robot];
        let others = self.members.iter().enumerate().filter(|(other, _)| *other != robot);
        let mut places_m = others.flat_map(|(_, member)| {
            let [from, to] = [member.start_m, member.goal_m];
            (0..=200)
                .map(move |part| [0, 1, 2].map(|axis| from[axis] + f64::from(part) / 200.0 * (to[axis] - from[axis])))
        });
        places_m.all(|place_m| distance_m(place_m, own.start_m) > 6.0 * own.radius_m + 1.0)
    }
}

/// Distance of two places, metres.
#[must_use]
pub fn distance_m(a: Place, b: Place) -> f64 {
    libm::hypot(libm::hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2])
}

fn members(ways: Vec<[Place; 2]>, size: &Size) -> Vec<Member> {
    let (radius_m, speed_mps) = (size.radius_m, size.speed_mps);
    ways.into_iter().map(|[start_m, goal_m]| Member { start_m, goal_m, radius_m, speed_mps }).collect()
}

fn circle(draw: &mut Draw, count: usize, step_m: f64) -> Vec<[Place; 2]> {
    let around_m = count as f64 * step_m * draw.within(1.1, 1.8);
    let ring_m = (around_m / std::f64::consts::TAU).max(step_m * draw.within(2.0, 5.0));
    // Neighbours stay a step apart.
    let most = (std::f64::consts::TAU / count as f64 - step_m / ring_m).max(0.0) / 2.2;
    let way = |index: usize| {
        let angle = index as f64 / count as f64 * std::f64::consts::TAU + draw.within(-most, most);
        let [x, y] = [ring_m * libm::cos(angle), ring_m * libm::sin(angle)];
        [[x, y, 0.0], [-x, -y, 0.0]]
    };
    (0..count).map(way).collect()
}

fn square(draw: &mut Draw, count: usize, radius_m: f64) -> Vec<[Place; 2]> {
    let side_m = radius_m * draw.within(5.0, 9.0) * libm::sqrt(count as f64) + 1.0;
    let apart_m = 2.5 * radius_m + 0.05;
    let mut places =
        || scattered(draw, count, |draw| [draw.within(0.0, side_m), draw.within(0.0, side_m), 0.0], apart_m);
    let (starts, goals) = (places(), places());
    starts.into_iter().zip(goals).map(|(start, goal)| [start, goal]).collect()
}

/// Random places at least `apart_m` from each other.
fn scattered(draw: &mut Draw, count: usize, mut one: impl FnMut(&mut Draw) -> Place, apart_m: f64) -> Vec<Place> {
    let mut places: Vec<Place> = Vec::new();
    for _ in 0..100_000 {
        if places.len() == count {
            return places;
        }
        let place = one(draw);
        if places.iter().all(|&other| distance_m(place, other) >= apart_m) {
            places.push(place);
        }
    }
    unreachable!("the space has room for more than {count} robots")
}

/// The points of a grid around the origin, row by row.
fn grid(columns: usize, rows: usize, step_m: f64) -> impl Iterator<Item = [f64; 2]> {
    let off_m = move |index: usize, of: usize| (index as f64 - (of - 1) as f64 / 2.0) * step_m;
    (0..rows).flat_map(move |row| (0..columns).map(move |column| [off_m(column, columns), off_m(row, rows)]))
}

fn blocks(draw: &mut Draw, count: usize, step_m: f64) -> Vec<[Place; 2]> {
    let half = count.div_ceil(2);
    let rows = draw.whole(2, 6).min(half as u32) as usize;
    let columns = half.div_ceil(rows);
    let away_m = columns as f64 * step_m + draw.within(1.0, 5.0) * step_m;
    let off_m = draw.within(-0.5, 0.5) * step_m;
    let east = grid(columns, rows, step_m).map(|[x, y]| [[x, y, 0.0], [x + away_m, y + off_m, 0.0]]);
    let west = grid(columns, rows, step_m).map(|[x, y]| [[x + away_m, y + off_m, 0.0], [x, y, 0.0]]);
    east.take(half).chain(west.take(count - half)).collect()
}

fn lattice(draw: &mut Draw, size: &Size) -> Vec<[Place; 2]> {
    let Size { count, radius_m, is_dense, .. } = *size;
    let (low, high) = if is_dense { (3.0, 4.0) } else { (4.0, 6.0) };
    let step_m = radius_m * draw.within(low, high) + 0.05;
    let columns = libm::ceil(libm::sqrt(count as f64)) as usize;
    let starts: Vec<_> = grid(columns, count.div_ceil(columns), step_m).take(count).collect();
    let mut goals = starts.clone();
    draw.shuffle(&mut goals);
    starts.into_iter().zip(goals).map(|([x, y], [to_x, to_y])| [[x, y, 0.0], [to_x, to_y, 0.0]]).collect()
}

fn streams(draw: &mut Draw, count: usize, step_m: f64) -> Vec<[Place; 2]> {
    let half = count.div_ceil(2);
    let lanes = draw.whole(2, 4).min(half as u32) as usize;
    let length = half.div_ceil(lanes);
    let from_m = (length + lanes) as f64 * step_m / 2.0 + draw.within(1.0, 4.0) * step_m;
    let stream = |count: usize, turns: bool, back: bool| {
        grid(length, lanes, step_m).take(count).map(move |[along, across]| {
            let sign = if back { 1.0 } else { -1.0 };
            let place = |x: f64| if turns { [across, x, 0.0] } else { [x, across, 0.0] };
            [place(along + sign * from_m), place(along - sign * from_m)]
        })
    };
    let back = draw.chance(0.5);
    stream(half, false, false).chain(stream(count - half, true, back)).collect()
}

/// Two groups of starts at both sides of the origin, each `from_m` to the east or west of it, with
/// the goals on the other side.
fn opposite(count: usize, rows: usize, step_m: f64, from_m: f64) -> Vec<[Place; 2]> {
    let half = count.div_ceil(2);
    let columns = half.div_ceil(rows);
    let shift_m = from_m + (columns - 1) as f64 * step_m / 2.0;
    let side = |sign: f64, count: usize| {
        grid(columns, rows, step_m)
            .take(count)
            .map(move |[x, y]| [[x + sign * shift_m, y, 0.0], [x - sign * shift_m, y, 0.0]])
    };
    side(-1.0, half).chain(side(1.0, count - half)).collect()
}

fn door(draw: &mut Draw, count: usize, radius_m: f64, step_m: f64) -> (Vec<[Place; 2]>, Vec<[[f64; 2]; 2]>) {
    let half_m = draw.within(1.25, 3.5) * radius_m;
    let ways = opposite(count, draw.whole(2, 4) as usize, step_m, 2.0 * radius_m + draw.within(0.5, 3.0));
    let end_m = 30.0;
    (ways, vec![[[0.0, -end_m], [0.0, -half_m]], [[0.0, half_m], [0.0, end_m]]])
}

fn corridor(draw: &mut Draw, count: usize, radius_m: f64) -> (Vec<[Place; 2]>, Vec<[[f64; 2]; 2]>) {
    let half_m = draw.within(2.6, 7.0) * radius_m;
    let step_m = 2.6 * radius_m + 0.05;
    let lanes = (((2.0 * half_m - 2.2 * radius_m) / step_m) as usize + 1).min(3);
    let ways = opposite(count, lanes, step_m, 3.0 * radius_m + draw.within(0.5, 4.0));
    let far_m = ways.iter().flatten().map(|place| place[0].abs()).fold(0.0, f64::max) + 10.0;
    (ways, vec![[[-far_m, -half_m], [far_m, -half_m]], [[-far_m, half_m], [far_m, half_m]]])
}

fn room(draw: &mut Draw, size: &Size) -> Crowd {
    let Size { count, radius_m, downwash, .. } = *size;
    let side_m = radius_m * draw.within(4.5, 8.0) * libm::cbrt(count as f64 * downwash) + 1.0;
    let apart_m = 2.8 * radius_m + 0.05;
    // Vertical distances count less by the downwash.
    let one = |draw: &mut Draw| [0; 3].map(|_| draw.within(0.0, side_m));
    let mut places = || {
        let squeezed = scattered(draw, count, |draw| one(draw).map_z(|z| z / downwash), apart_m);
        squeezed.into_iter().map(|place| place.map_z(|z| z * downwash)).collect::<Vec<_>>()
    };
    let ways: Vec<_> = places().into_iter().zip(places()).map(|(start, goal)| [start, goal]).collect();
    let room_m = draw.chance(0.5).then_some(side_m);
    Crowd { members: members(ways, size), walls_m: Vec::new(), room_m, queue: 0 }
}

trait Vertical {
    fn map_z(self, to: impl Fn(f64) -> f64) -> Self;
}

impl Vertical for Place {
    fn map_z(self, to: impl Fn(f64) -> f64) -> Self {
        [self[0], self[1], to(self[2])]
    }
}
