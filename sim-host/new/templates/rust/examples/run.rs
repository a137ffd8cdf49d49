//! Runs scenario.toml and prints the result. With a file name it also records the run: `cargo run
//! --example run -- run.staya`, then `staya view run.staya`.

use my_swarm::MyLaw;
use staya_sim::engine::simulate_own;
use staya_sim::record::Files;
use staya_sim::scenario::{Overrides, Scenario};
use staya_record::recording::RunRecorder;
use std::{error::Error, ops::ControlFlow, path::Path};

fn main() -> Result<(), Box<dyn Error>> {
    let file = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/scenario.toml"));
    let scenario = Scenario::load(file, &Overrides::default())?;
    let to = std::env::args().nth(1);
    let mut recording = match &to {
        Some(to) => {
            let output = Files::reading(&scenario.origin.files).create(Path::new(to))?;
            Some(RunRecorder::new(output, Path::new(to), &scenario, 1)?)
        }
        None => None,
    };
    let mut failed = None;
    let outcome = simulate_own(
        &scenario,
        |_robot| MyLaw::new(0.5, 0.02, 0.6),
        |moment, rows| match recording.as_mut().map(|recording| recording.tick(moment, rows)) {
            Some(Err(error)) => {
                failed = Some(error);
                ControlFlow::Break(())
            }
            _ => ControlFlow::Continue(()),
        },
    )?;
    if let Some(error) = failed {
        return Err(error.into());
    }
    if let Some(recording) = recording {
        recording.finish(&())?.finish()?;
    }
    let (arrived, all, overlaps) = (outcome.arrived, scenario.robots.len(), outcome.collisions);
    println!("{arrived} of {all} robots arrived within {:.1} s, {overlaps} overlaps", outcome.seconds);
    Ok(())
}
