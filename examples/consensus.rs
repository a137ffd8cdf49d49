//! A payload in beacons: 20 robots on a line agree on the mean of their positions and meet there.
//!
//! Each robot hears only its nearest neighbours. It moves its estimate of the meeting point towards
//! the estimates that it receives (R. Olfati-Saber, J. A. Fax, R. M. Murray 2007, "Consensus and
//! cooperation in networked multi-agent systems", section II). Run it with `cargo run --example
//! consensus`.

use serde::{Deserialize, Serialize};
use staya_controller::agent::*;
use staya_controller::geom::{Position, Vec3};
use staya_controller::grid::Dir;
use staya_controller::time::Instant;
use staya_controller::wire::{Content, Never, ProtocolId};
use staya_sim::engine::simulate_own;
use staya_sim::scenario::{Overrides, Scenario};
use std::{error::Error, ops::ControlFlow, path::Path};

const ROBOTS: u32 = 20;
const SPACING_M: f64 = 0.6;
/// Time of departure, s; convergence takes longer with the square of the number of robots.
const TALK_S: f64 = 100.0;
/// Lower with many neighbours, for stability.
const STEP: f32 = 0.2;

/// Estimate of the meeting point, metres; `None` before the first decision.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Meeting {
    belief_m: Option<[f32; 2]>,
}

/// A part of each beacon: 9 bytes, or 1 without an estimate.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Estimate(Option<[f32; 2]>);

impl Content for Estimate {}

#[derive(Clone, Debug)]
struct Estimates;

impl Protocol for Estimates {
    const ID: ProtocolId = ProtocolId(64);
    type Payload = Estimate;
    type Message = Never;
    type Order = Never;
}

impl InAny for Estimates {}

impl Law<f32> for Meeting {
    type Surroundings<'a> = InPlane<'a, f32>;
    type Protocol = Estimates;
    type Workspace = ();

    fn decide(
        &mut self,
        view: &View<'_, f32, Estimates>,
        _: &InPlane<'_, f32>,
        _: Tools<'_, f32, Self>,
    ) -> Result<Decision<f32>, BadInput> {
        let place = view.state.position.since::<f32>(Position::default());
        let [mut x, mut y] = self.belief_m.unwrap_or([place.x, place.y]);
        let own = [x, y];
        let step = STEP.min(1.0 / (1 + view.neighbors().count()) as f32);
        for [other_x, other_y] in view.peers().filter_map(|(_, Estimate(belief_m))| belief_m) {
            x += step * (other_x - own[0]);
            y += step * (other_y - own[1]);
        }
        self.belief_m = Some([x, y]);
        let way_m = Vec3::new(x, y, 0.0) - place;
        let goes = view.now.since(Instant::from_micros(0)).as_micros() >= (TALK_S * 1e6) as i32;
        let wish_mps = if goes { way_m.clamp_norm(0.5) } else { Vec3::ZERO };
        Ok(Decision::new(Action::Velocity { wish_mps, way_m: goes.then_some(way_m) }, Progress::Going))
    }

    fn payload(&mut self, _: &InPlane<'_, f32>, _: Dir, _: &mut Radio<'_, Estimates>) -> Estimate {
        Estimate(self.belief_m)
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let starts: Vec<_> =
        (0..ROBOTS).map(|i| format!("{{ start_m = [{}, {}] }}", SPACING_M * f64::from(i), i % 2)).collect();
    let text = format!(
        "name = \"consensus\"\nseed = 1\nticks = 1300\ntick_s = 0.1\n[radio]\nrange_m = 1.2\nloss = 0.1\n[plane]\n\
         radius_m = 0.1\nmax_speed_mps = 0.5\n[plane.robots]\nlist = [{}]\n",
        starts.join(", ")
    );
    let scenario = Scenario::parse(&text, Path::new("consensus.toml"), &Overrides::default())?;
    let mean_m = [SPACING_M * f64::from(ROBOTS - 1) / 2.0, 0.5];
    let spread = |places: &[[f64; 3]]| {
        let off = |[x, y, _]: &[f64; 3]| libm::hypot(x - mean_m[0], y - mean_m[1]);
        places.iter().map(off).fold(0.0, f64::max)
    };
    let (mut first_m, mut last_m) = (0.0, 0.0);
    let outcome = simulate_own(
        &scenario,
        |_| Meeting { belief_m: None },
        |moment, rows| {
            let places: Vec<_> = rows.map(|row| row.motion.position_m).collect();
            last_m = spread(&places);
            if moment.row.tick == 0 {
                first_m = last_m;
            }
            if moment.row.tick % 100 == 0 {
                println!(
                    "{:5.0} s: the farthest is {last_m:.2} m from where the mean was",
                    moment.row.time_s
                );
            }
            ControlFlow::Continue(())
        },
    )?;
    println!(
        "{} packets delivered, {} lost, {} overlaps",
        outcome.packets.delivered, outcome.packets.lost, outcome.collisions
    );
    assert!(first_m > 5.0 && last_m < 1.5 && outcome.collisions == 0, "they have not met");
    Ok(())
}
