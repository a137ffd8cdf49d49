//! A convoy that agrees on a pace and counts itself: a law with a payload, messages and a name for
//! scenario files. Run it with `cargo run --example convoy`.
//!
//! Each beacon tells the slowest pace that its sender knows. The last robot tells the one ahead
//! that it is 1, that one tells the next one 2, until the first robot knows the number of all.

use serde::{Deserialize, Serialize};
use staya_controller::agent::*;
use staya_controller::geom::Vec3;
use staya_controller::grid::Dir;
use staya_controller::neighbor::Nearby;
use staya_controller::robot::RobotId;
use staya_controller::wire::{Content, Never, ProtocolId};
use staya_sim::engine::{add_law, simulate};
use staya_sim::scenario::{Overrides, Scenario};
use std::{error::Error, ops::ControlFlow, path::Path};

#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Pace(u16);
impl Content for Pace {}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct Count(u16);
impl Content for Count {}

#[derive(Clone, Debug)]
struct Words;

impl Protocol for Words {
    const ID: ProtocolId = ProtocolId(65);
    type Payload = Pace;
    type Message = Count;
    type Order = Never;
}

impl InAny for Words {}

#[derive(Clone, Debug, Default, Serialize, Deserialize)]
struct Convoy {
    pace: Pace,
    counted: u16,
    has_told: bool,
}

impl Law<f32> for Convoy {
    type Surroundings<'a> = InPlane<'a, f32>;
    type Protocol = Words;
    type Workspace = ();

    fn decide(
        &mut self,
        view: &View<'_, f32, Words>,
        _: &InPlane<'_, f32>,
        mut tools: Tools<'_, f32, Self>,
    ) -> Result<Decision<f32>, BadInput> {
        view.can_move()?;
        let own_mmps = if view.id == RobotId(3) { 300 } else { 500 };
        self.pace = Pace(view.peers().map(|(_, pace)| pace.0).fold(own_mmps, u16::min));
        let east = |other: &Nearby<f32>| other.offset_m.x > 0.0;
        let is_last = view.nearby.iter().all(east) && !view.nearby.is_empty();
        if let Some(ahead) = view.nearby.iter().find(|other| east(other))
            && (is_last || self.counted > 0)
            && !self.has_told
        {
            let valid = tools.radio.valid;
            self.has_told = tools.radio.send(ahead.id, &Count(self.counted + 1), valid);
        }
        let wish_mps = Vec3::new(f32::from(self.pace.0) / 1000.0, 0.0, 0.0);
        Ok(Decision::new(Action::Velocity { wish_mps, way_m: None }, Progress::Going))
    }

    fn payload(&mut self, _: &InPlane<'_, f32>, _: Dir, _: &mut Radio<'_, Words>) -> Pace {
        self.pace
    }

    fn receive(&mut self, _: RobotId, behind: &Count, _: &mut Radio<'_, Words>) -> bool {
        self.counted = behind.0;
        true
    }

    /// The leader's number in records shows the robots behind this one.
    fn report(&self) -> Report {
        Report { leader: RobotId(self.counted.into()), ..Report::default() }
    }
}

const SCENARIO: &str = r#"
name = "convoy"
ticks = 300
tick_s = 0.1
[radio]
range_m = 2.5
loss = 0.3
[plane]
law = "convoy"
radius_m = 0.15
max_speed_mps = 0.8
robots.list = [
  { start_m = [0, 0] }, { start_m = [1.5, 0] }, { start_m = [3, 0] }, { start_m = [4.5, 0] }, { start_m = [6, 0] },
]
"#;

fn main() -> Result<(), Box<dyn Error>> {
    add_law::<Convoy>("convoy");
    let scenario = Scenario::parse(SCENARIO, Path::new("convoy.toml"), &Overrides::default())?;
    let mut robots = Vec::new();
    let outcome = simulate(&scenario, |_, rows| {
        robots = rows.map(|row| (row.leader, row.motion.velocity_mps[0])).collect();
        ControlFlow::Continue(())
    })?;
    for ((behind, mps), id) in robots.iter().zip(1..) {
        println!("robot {id}: {behind} behind it, {mps:.2} m/s");
    }
    let counted: Vec<u32> = robots.iter().map(|(behind, _)| *behind).collect();
    assert_eq!((counted, outcome.collisions), (vec![0, 1, 2, 3, 4], 0));
    assert!(robots.iter().all(|(_, mps)| (mps - 0.3).abs() < 0.01), "all at the slowest pace");
    Ok(())
}
