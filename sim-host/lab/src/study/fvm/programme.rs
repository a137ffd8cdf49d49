//! The velocity nearest to a wish within half-planes and a speed limit, by functional voxels.
//!
//! The paper leaves this step to its reference 12 (A. V. Tolok and N. B. Tolok 2018, "Mathematical
//! programming problems solving by functional voxel method"), which was not available. Here the
//! permitted region is an R-function, the conjunction of the half-planes and the disc of speeds.
//! Its model gives the permitted node nearest to the wish, or else the node with the greatest
//! value, from which the velocity ascends into the region along local planes. Then it descends
//! towards the wish, and along the local plane of the function where that is the border.

use super::{Parameters, Values};
use staya_controller::geom::Vec2;
use staya_controller::orca::{HalfPlane, Solution, solve};
use staya_controller::rand::Rng;
use staya_fvm::{Function, Grid, System, build};
use staya_voxel::Model;
use std::f64::consts::TAU;

type V = Vec2<f64>;

pub const MEASURES: &[(&str, &str)] = &[
    ("excess_mps", "mean distance from the wish beyond that of the optimum, m/s; of programmes with a solution"),
    ("worst_excess_mps", "largest such distance"),
    ("violation_mps", "largest violation of a half-plane or the speed limit, m/s"),
    ("found", "share of the programmes with a solution for which a permitted velocity was found"),
    ("node_found", "share of them for which a permitted node was found"),
    ("solvable", "share of the programmes with a solution"),
];

const PROGRAMMES: u32 = 0x0046_0302;
const SPEED_MPS: f64 = 1.0;
/// Border of the model around the disc of speeds, so that gradients exist at its nodes.
const EDGE_MPS: f64 = 1.0;
const DESCENTS: u32 = 16;
const ASCENTS: u32 = 5000;
const BISECTIONS: u32 = 40;
/// Distance over which gradients are taken, and from which a point counts as on the border.
const NEAR_MPS: f64 = 1e-6;

struct Programme {
    planes: Vec<HalfPlane<f64>>,
    wish: V,
}

impl Programme {
    /// Borders 0.05 to 0.95 m/s off the origin, on its other side: most are solvable.
    fn draw(parameters: &Parameters, seed: u64, number: u32) -> Self {
        let mut rng = Rng::keyed(seed, PROGRAMMES, number, 0);
        let mut unit = || f64::from(rng.next_u32()) / f64::from(u32::MAX);
        let plane = |turn: f64, off: f64| {
            let (sin, cos) = libm::sincos(TAU * turn);
            let normal = V::new(cos, sin);
            HalfPlane { point: normal * (0.05 - off), normal }
        };
        let planes = (0..parameters.half_planes).map(|_| plane(unit(), 0.8 * unit())).collect();
        let (sin, cos) = libm::sincos(TAU * unit());
        Self { planes, wish: V::new(cos, sin) * (SPEED_MPS * libm::sqrt(unit())) }
    }

    /// Positive where all half-planes and the speed limit permit the velocity.
    fn permitted(&self) -> Function<2> {
        let limit = Function::new(|[x, y]: [f64; 2]| SPEED_MPS - libm::hypot(x, y));
        self.planes.iter().fold(limit, |all, &plane| {
            let one = Function::new(move |[x, y]: [f64; 2]| -plane.penetration(V::new(x, y)));
            all.and(one, System::R1)
        })
    }

    /// The velocity, if a permitted one was found, and whether a node was permitted.
    fn by_voxels(&self, parameters: &Parameters) -> Result<(Option<V>, bool), String> {
        let function = self.permitted();
        let value = |v: V| function.value([v.x, v.y]);
        let nodes = parameters.nodes;
        let grid = Grid { extent: [[-EDGE_MPS, EDGE_MPS]; 2], nodes: [nodes; 2] };
        let bytes = build(&function, &grid, parameters.depth).map_err(|error| error.to_string())?;
        let model = Model::<f64, 2>::from_bytes(&bytes).map_err(|error| error.to_string())?;
        if value(self.wish) >= 0.0 {
            return Ok((Some(self.wish), true));
        }
        let along = |index: u16| -EDGE_MPS + 2.0 * EDGE_MPS * f64::from(index) / f64::from(nodes - 1);
        let places = || (0..nodes).flat_map(|y| (0..nodes).map(move |x| V::new(along(x), along(y))));
        let stored = |v: &V| model.nearest([v.x, v.y]).map_or(f64::NEG_INFINITY, |local| local.value);
        let off = |v: &V| (*v - self.wish).norm();
        let permitted = places().filter(|v| stored(v) >= 0.0 && value(*v) >= 0.0);
        let node = permitted.min_by(|a, b| off(a).total_cmp(&off(b)));
        let gradient = |v: V| {
            let [x, y] = function.gradient([v.x, v.y], [NEAR_MPS; 2]);
            V::new(x, y).normalized()
        };
        let highest = || places().max_by(|a, b| stored(a).total_cmp(&stored(b)));
        let Some(mut here) = node.or_else(highest) else { return Ok((None, false)) };
        for _ in 0..ASCENTS {
            let lack = -value(here);
            let Some(up) = gradient(here).filter(|_| lack > 0.0) else { break };
            here += up * (lack + NEAR_MPS);
        }
        if value(here) < 0.0 {
            return Ok((None, false));
        }
        // As far as permitted along a way.
        let walk = |from: V, way: V| {
            let (mut low, mut high) = (0.0, 1.0);
            if value(from + way) >= 0.0 {
                return from + way;
            }
            for _ in 0..BISECTIONS {
                let middle = 0.5 * (low + high);
                if value(from + way * middle) >= 0.0 { low = middle } else { high = middle }
            }
            from + way * low
        };
        for _ in 0..DESCENTS {
            here = walk(here, self.wish - here);
            let Some(normal) = gradient(here) else { break };
            // A little off the border, which else stops a way along it by rounding.
            let inner = here + normal * NEAR_MPS;
            let from = if value(inner) >= 0.0 { inner } else { here };
            let border = normal.perp();
            here = walk(from, border * border.dot(self.wish - from));
        }
        Ok((Some(walk(here, self.wish - here)), node.is_some()))
    }
}

pub fn measure(parameters: &Parameters, seed: u64) -> Result<Values, String> {
    let (mut sum, mut worst, mut violation) = (0.0, 0.0_f64, 0.0_f64);
    let (mut found, mut by_node, mut solvable) = (0_u32, 0_u32, 0_u32);
    for number in 0..parameters.pairs {
        let programme = Programme::draw(parameters, seed, number);
        let best: Solution<V> = solve::<V, 16>(&programme.planes, 0, programme.wish, SPEED_MPS);
        if best.penetration_mps > 0.0 {
            continue;
        }
        solvable += 1;
        let (velocity, has_node) = programme.by_voxels(parameters)?;
        by_node += u32::from(has_node);
        let Some(velocity) = velocity else { continue };
        found += 1;
        let off = |v: V| (v - programme.wish).norm();
        let excess = off(velocity) - off(best.velocity_mps);
        sum += excess;
        worst = worst.max(excess);
        let depths = programme.planes.iter().map(|plane| plane.penetration(velocity));
        violation = depths.fold(violation, f64::max).max(velocity.norm() - SPEED_MPS);
    }
    let share = |part: u32, whole: u32| (whole > 0).then(|| f64::from(part) / f64::from(whole));
    let of_found = |value: f64| (found > 0).then_some(value);
    Ok(vec![
        ("excess_mps", of_found(sum / f64::from(found.max(1)))),
        ("worst_excess_mps", of_found(worst)),
        ("violation_mps", of_found(violation)),
        ("found", share(found, solvable)),
        ("node_found", share(by_node, solvable)),
        ("solvable", share(solvable, parameters.pairs)),
    ])
}
