//! Runs 20 robots in the simulator with a user-defined guidance law, the ring patrol of
//! `own_part/src/lib.rs`: `cargo run --release --example own_guidance -- out/patrol`.
//!
//! Without a folder it writes neither pictures nor a recording. `staya hil` runs the same law on
//! emulated parts: see docs/project.md.

use patrol::Patrol;
use staya_plot::run_pictures;
use staya_record::recording::RunRecorder;
use staya_sim::engine::simulate_own;
use staya_sim::record::{Options, Output, Recorder};
use staya_sim::scenario::{Overrides, Scenario};
use std::path::{Path, PathBuf};
use std::{error::Error, f64::consts::TAU, fs, ops::ControlFlow};

fn main() -> Result<(), Box<dyn Error>> {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("own_part/patrol.toml");
    let scenario = Scenario::load(&file, &Overrides::default())?;
    let folder = std::env::args().nth(1).map(PathBuf::from);
    let mut recorder = Recorder::in_memory(Options::default());
    let mut recording = match &folder {
        Some(folder) => {
            fs::create_dir_all(folder)?;
            let path = folder.join("patrol.staya");
            Some(RunRecorder::new(Output::create(&path)?, &path, &scenario, 1)?)
        }
        None => None,
    };
    let mut bearings = Vec::new();
    let outcome = simulate_own(
        &scenario,
        |_robot| Patrol::RING,
        |moment, rows| {
            let rows: Vec<_> = rows.collect();
            bearings = rows
                .iter()
                .map(|row| libm::atan2(row.motion.position_m[1], row.motion.position_m[0]))
                .collect();
            recorder.tick(moment.row, rows.iter().copied()).expect("memory takes everything");
            if let Some(recording) = &mut recording {
                recording.tick(moment, rows.into_iter()).expect("the disk has room");
            }
            ControlFlow::Continue(())
        },
    )?;
    if let (Some(folder), Some(recording)) = (folder, recording) {
        recording.finish(&())?.finish()?;
        for file in run_pictures(&scenario, &recorder.finish()?, &folder)? {
            println!("{}", file.display());
        }
        println!("look at it: staya view {}/patrol.staya", folder.display());
    }
    bearings.sort_by(f64::total_cmp);
    let next = bearings.iter().skip(1).copied().chain([bearings[0] + TAU]);
    let gaps = next.zip(&bearings).map(|(next, own)| (next - own) * 360.0 / TAU);
    let (least, most) = gaps.fold((360.0_f64, 0.0_f64), |(least, most), gap| (least.min(gap), most.max(gap)));
    let collisions = outcome.collisions;
    println!(
        "20 robots, {least:.1} to {most:.1} degrees apart (18 would be even), {collisions} overlaps, trace hash {:016x}",
        outcome.trace_hash
    );
    assert!(least > 17.0 && most < 19.0 && collisions == 0, "no patrol");
    Ok(())
}
