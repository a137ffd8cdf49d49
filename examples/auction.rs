//! An auction without an auctioneer: 16 robots share out 16 places.
//!
//! With its beacons, each robot broadcasts the place that it bids for and its distance to it. The
//! farther of two bidders for one place withdraws and bids for the nearest place without a nearer
//! bidder: a greedy form of H.-L. Choi, L. Brunet, J. P. How 2009, "Consensus-based decentralized
//! auctions for robust task allocation", section III. Run it with `cargo run --example auction`.

use serde::{Deserialize, Serialize};
use staya_controller::agent::*;
use staya_controller::geom::{Position, Vec3};
use staya_controller::grid::Dir;
use staya_controller::robot::RobotId;
use staya_controller::wire::{Content, Never, ProtocolId};
use staya_sim::engine::simulate_own;
use staya_sim::scenario::{Overrides, Scenario};
use std::{collections::BTreeSet, error::Error, ops::ControlFlow, path::Path};

const SCENARIO: &str = r#"
name = "auction"
seed = 1
ticks = 1200
tick_s = 0.1
[radio]
range_m = 30
loss = 0.2
[plane]
radius_m = 0.15
max_speed_mps = 0.8
[plane.robots.cloud]
count = 16
from_m = [-6, -6]
to_m = [6, 6]
"#;
const TASKS: u8 = 16;
const NEAR_M: f32 = 0.05;

/// Four rows of four places, 2 m apart.
fn place(task: u8) -> Position {
    let along = |number: u8| 2000 * i32::from(number) - 3000;
    Position::from_mm([along(task % 4), along(task / 4), 0])
}

/// A part of each beacon: at most 7 bytes, with the byte of the `Option`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Bid {
    task: u8,
    distance_mm: u32,
}

impl Content for Bid {}

#[derive(Clone, Debug, Default, Serialize, Deserialize)]
struct Auction {
    bid: Option<Bid>,
}

#[derive(Clone, Debug)]
struct Bids;

impl Protocol for Bids {
    const ID: ProtocolId = ProtocolId(64);
    type Payload = Option<Bid>;
    type Message = Never;
    type Order = Never;
}

impl InAny for Bids {}

impl Law<f32> for Auction {
    type Surroundings<'a> = InPlane<'a, f32>;
    type Protocol = Bids;
    type Workspace = ();

    fn decide(
        &mut self,
        view: &View<'_, f32, Bids>,
        _: &InPlane<'_, f32>,
        _: Tools<'_, f32, Self>,
    ) -> Result<Decision<f32>, BadInput> {
        let way_m = |task: u8| place(task).since::<f32>(view.state.position);
        let own = |task: u8| Bid { task, distance_mm: (way_m(task).norm() * 1000.0) as u32 };
        // Of two equal bids, the one of the lower robot id wins.
        let is_outbid = |own: &Bid| {
            let rank = |bid: &Bid, id: RobotId| (bid.distance_mm, id);
            let bids = view.peers().filter_map(|(other, bid)| Some((bid?, other.id)));
            bids.filter(|(bid, _)| bid.task == own.task).any(|(bid, id)| rank(&bid, id) < rank(own, view.id))
        };
        let kept = self.bid.map(|bid| own(bid.task)).filter(|bid| !is_outbid(bid));
        let open = || (0..TASKS).map(own).filter(|bid| !is_outbid(bid)).min_by_key(|bid| bid.distance_mm);
        self.bid = kept.or_else(open);
        let Some(bid) = self.bid else { return Ok(Decision::default()) };
        let way_m: Vec3<f32> = way_m(bid.task);
        let progress = Progress::at_goal(way_m.norm() <= NEAR_M);
        let action = Action::Velocity { wish_mps: (way_m * 2.0).clamp_norm(0.8), way_m: Some(way_m) };
        Ok(Decision::new(action, progress))
    }

    fn payload(&mut self, _: &InPlane<'_, f32>, _: Dir, _: &mut Radio<'_, Bids>) -> Option<Bid> {
        self.bid
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let scenario = Scenario::parse(SCENARIO, Path::new("auction.toml"), &Overrides::default())?;
    let mut places_m = Vec::new();
    let outcome = simulate_own(
        &scenario,
        |_| Auction::default(),
        |moment, rows| {
            places_m = rows.map(|row| row.motion.position_m).collect();
            if moment.row.tick % 100 == 0 {
                println!("{:4.0} s: {} of 16 are at a place", moment.row.time_s, taken(&places_m).len());
            }
            ControlFlow::Continue(())
        },
    )?;
    let taken = taken(&places_m);
    println!("{} places taken, {} overlaps", taken.len(), outcome.collisions);
    assert!(taken.len() == 16 && outcome.collisions == 0, "two for one place, or none");
    Ok(())
}

fn taken(places_m: &[[f64; 3]]) -> BTreeSet<u8> {
    let off = |task: u8, [x, y, _]: [f64; 3]| {
        let [at_x, at_y, _] = place(task).mm.map(|mm| f64::from(mm) / 1000.0);
        libm::hypot(x - at_x, y - at_y)
    };
    (0..TASKS).filter(|&task| places_m.iter().any(|&at| off(task, at) <= 0.1)).collect()
}
