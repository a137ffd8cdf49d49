//! A guidance law that Staya does not have, run by 20 robots in the simulator: each goes round a ring at the pace that keeps it
//! midway between the two whom it hears ahead and behind, so that all become a patrol with even gaps. Run it by
//! `cargo run --release --example own_guidance -- out/patrol`; without a folder it draws and records nothing.

use serde::{Deserialize, Serialize};
use staya_controller::agent::*;
use staya_controller::geom::{Position, Vec3};
use staya_controller::{rand::Rng, scalar::Scalar};
use staya_plot::motion_pictures;
use staya_sim::engine::simulate_own;
use staya_sim::record::{Options, Recorder};
use staya_sim::scenario::{Overrides, Scenario};
use staya_view::recording::RunRecorder;
use std::f32::consts::TAU;
use std::{error::Error, fs, ops::ControlFlow, path::Path};

/// Bodies, radio and what keeps them apart are the scenario's, a file's or a text's: scenarios/README.md has all fields.
const SCENARIO: &str = r#"
name = "patrol"
seed = 1
ticks = 1800
tick_s = 0.1
[radio]
range_m = 12
loss = 0.1
[plane]
radius_m = 0.2
max_speed_mps = 1.0
[plane.robots.cloud]
count = 20
from_m = [-5, -5]
to_m = [5, 5]
"#;
const RING_M: f32 = 8.0;
const CRUISE_MPS: f32 = 0.5;

/// What the law keeps between decisions. Serde carries it through checkpoints and into the run's fingerprint.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Patrol {
    ring_m: f32,
}

impl Teamwork for Patrol {}

impl<S: Scalar> Guidance<S> for Patrol {
    type Input<'a> = InPlane<'a, S>;
    type Destination = Roams;
    type Workspace = ();
    type Payload = ();

    fn decide(
        &mut self,
        input: &GuidanceInput<'_, S>,
        _: &InPlane<'_, S>,
        _: &mut Rng,
        (): &mut (),
    ) -> Result<Decision<S>, BadInput> {
        input.can_go()?;
        let number = |x: f32| S::from_f32(x).unwrap_or(S::ZERO);
        let (turn, place) = (number(TAU), input.state.position.since::<S>(Position::default()));
        let bearing = |place: Vec3<S>| place.y.atan2(place.x);
        // How far others are round the ring, ahead of this robot and behind it.
        let (mut ahead, mut behind) = (turn, turn);
        for other in input.nearby {
            let angle = bearing(place + other.offset_m) - bearing(place);
            let angle = if angle < S::ZERO { angle + turn } else { angle };
            (ahead, behind) = (ahead.min(angle), behind.min(turn - angle));
        }
        let out = place.normalized().unwrap_or_default();
        let along = out.xy().perp().extend(S::ZERO);
        let pace = number(CRUISE_MPS) + ((ahead - behind) * number(4.0)).clamp(-number(0.4), number(0.4));
        let wish_mps = along * pace + out * (number(self.ring_m) - place.norm());
        let wish_mps = wish_mps.clamp_norm(input.body.max_speed_mps);
        Ok(Decision { action: Action::Velocity { wish_mps, way_m: None }, ..Decision::default() })
    }

    fn has_own_goal(&self) -> bool {
        true
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let scenario = Scenario::parse(SCENARIO, Path::new("patrol.toml"), &Overrides::default())?;
    let folder = std::env::args().nth(1);
    let mut recorder = Recorder::in_memory(Options::default());
    let mut recording = match &folder {
        Some(folder) => {
            fs::create_dir_all(folder)?;
            let path = Path::new(folder).join("patrol.staya");
            Some(RunRecorder::new(fs::File::create(&path)?, &path, &scenario, 1)?)
        }
        None => None,
    };
    let mut places_m = Vec::new();
    let outcome = simulate_own(
        &scenario,
        |_| Patrol { ring_m: RING_M },
        |moment, rows| {
            let rows: Vec<_> = rows.collect();
            places_m = rows.iter().map(|row| row.motion.position_m).collect();
            recorder.tick(moment.row, rows.iter().copied()).expect("memory takes everything");
            if let Some(recording) = &mut recording {
                recording.tick(moment, rows.into_iter()).expect("the disk has room");
            }
            ControlFlow::Continue(())
        },
    )?;
    if let (Some(folder), Some(recording), Some(plane)) = (folder, recording, &scenario.plane) {
        recording.finish(&())?;
        for file in motion_pictures(&scenario, plane, &recorder.finish()?, Path::new(&folder))? {
            println!("{}", file.display());
        }
        println!("look at it: staya view {folder}/patrol.staya");
    }
    let mut bearings: Vec<f64> = places_m.iter().map(|[x, y, _]| libm::atan2(*y, *x)).collect();
    bearings.sort_by(f64::total_cmp);
    let turn = f64::from(TAU);
    let next = bearings.iter().skip(1).copied().chain([bearings[0] + turn]);
    let gaps: Vec<f64> = next.zip(&bearings).map(|(next, own)| (next - own) * 360.0 / turn).collect();
    let (least, most) =
        gaps.iter().fold((360.0_f64, 0.0_f64), |(least, most), &gap| (least.min(gap), most.max(gap)));
    let collisions = outcome.collisions;
    println!(
        "20 robots, {:.1} to {:.1} degrees apart (18 would be even), {collisions} overlaps, trace hash {:016x}",
        least, most, outcome.trace_hash
    );
    assert!(least > 17.0 && most < 19.0 && collisions == 0, "no patrol");
    Ok(())
}
