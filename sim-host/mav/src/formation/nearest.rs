//! Assignment of places to robots with short paths that do not cross (M. Turpin, N. Michael, V.
//! Kumar 2014, CAPT: concurrent assignment and planning of trajectories for multiple robots,
//! International Journal of Robotics Research 33(1), section 4).
//!
//! With the smallest sum of squared distances, no two robots collide if all move straight at
//! constant speeds and arrive at the same time. Offset and scale of the places do not matter.

use super::Graph;
use pathfinding::kuhn_munkres::kuhn_munkres;
use pathfinding::matrix::Matrix;
use staya_controller::agent::TEMPLATE;
use staya_controller::grid::Cell;

/// Position steps across the swarm; products of positions and places fit into 64 bits.
const STEPS: f64 = 1e6;

impl Graph {
    /// Reorders the places for robots at `positions` (east, north, any unit and origin) for a
    /// minimal sum of squared distances. A robot without a neighbour of a smaller number to follow
    /// gets an edge to the nearest one with capacity. O(n^3).
    pub fn nearest(&self, positions: &[[f64; 2]]) -> Self {
        let count = self.robots().min(positions.len());
        let middle = [0, 1].map(|axis| positions.iter().map(|at| at[axis]).sum::<f64>() / count.max(1) as f64);
        let off = |at: &[f64; 2]| [0, 1].map(|axis| at[axis] - middle[axis]);
        let widest = positions.iter().flat_map(off).fold(0.0, |most: f64, value| most.max(value.abs()));
        let scale = if widest > 0.0 { STEPS / widest } else { 0.0 };
        let product = |(robot, place): (usize, usize)| {
            let ([x, y], place) = (off(&positions[robot]).map(|value| (value * scale) as i64), self.places[place]);
            x * i64::from(place.x) + y * i64::from(place.y)
        };
        if count < self.robots() || count == 0 {
            return self.clone();
        }
        let (_, place_of) = kuhn_munkres(&Matrix::from_fn(count, count, product));
        let mut robot_of = vec![0_u16; count];
        for (robot, &place) in (0..).zip(&place_of) {
            robot_of[place] = robot;
        }
        let pair = |&(a, b): &(u16, u16)| {
            let [a, b] = [a, b].map(|place| robot_of[usize::from(place)]);
            (a.min(b), a.max(b))
        };
        let places: Vec<Cell> = place_of.iter().map(|&place| self.places[place]).collect();
        let mut edges: Vec<_> = self.edges.iter().map(pair).collect();
        for robot in 1..count as u16 {
            if edges.iter().any(|&(_, larger)| larger == robot) {
                continue;
            }
            let neighbors = |of: u16| edges.iter().filter(|&&(a, b)| a == of || b == of).count();
            let way = |other: u16| places[usize::from(other)].distance_squared(places[usize::from(robot)]);
            let leader =
                (0..robot).filter(|&other| neighbors(other) < TEMPLATE).min_by_key(|&other| (way(other), other));
            edges.extend(leader.map(|leader| (leader, robot)));
        }
        edges.sort_unstable();
        Self { places, edges }
    }
}
