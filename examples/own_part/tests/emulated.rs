//! The law on emulated parts, run by `cargo xtask test`. By hand: `cargo xtask firmware --crate
//! examples/own_part stm32f405`, then `cargo test -p patrol --test emulated`.

use clap::Parser;
use patrol::Patrol;
use serde::{Deserialize, Serialize};
use staya_console::{Global, WatchArgs};
use staya_controller::agent::*;
use staya_hil::{DeviceArgs, Own, Package, package};
use staya_link::own::LinkedLaw;
use staya_sim::engine::OwnLaw;
use staya_sim::scenario::{Overrides, Scenario};
use std::path::Path;
use std::process::Command;

const DEVICES: [&str; 6] = ["--device", "qemu:stm32f405", "--devices", "4", "--firmware", FIRMWARE];
const FIRMWARE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/target/firmware");
const SCENARIO: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/patrol.toml");

fn refusal<G: OwnLaw + LinkedLaw<f32>>(own: &Own<G>) -> String {
    #[derive(Parser)]
    struct Line {
        #[command(flatten)]
        devices: DeviceArgs,
        #[command(flatten)]
        page: WatchArgs,
    }
    let line = Line::parse_from([&["test"], DEVICES.as_slice()].concat());
    let short = Overrides { ticks: Some(40), ..Overrides::default() };
    let scenario = Scenario::load(Path::new(SCENARIO), &short).expect("a scenario");
    let global = Global { quiet: true, ..Global::default() };
    own.run(&scenario, &line.devices, &line.page, &global).expect_err("another law or version").to_string()
}

#[test]
fn four_of_twenty_robots_on_parts_decide_like_their_shadows() {
    let mut patrol = Command::new(env!("CARGO_BIN_EXE_patrol"));
    let output = patrol.arg(SCENARIO).args(DEVICES).args(["--ticks", "150", "--json", "--quiet"]).output();
    let output = output.expect("it runs");
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{errors}");
    let summary: serde_json::Value = serde_json::from_slice(&output.stdout).expect("one object");
    assert_eq!(summary["trace_hash"], summary["trace_hash_without_devices"]);
    let devices = summary["devices"].as_array().expect("a list");
    assert_eq!(devices.len(), 4);
    for device in devices {
        assert_eq!((&device["steps"], &device["mismatches"]), (&150.into(), &0.into()));
        assert_eq!(device["firmware"], concat!("patrol ", env!("CARGO_PKG_VERSION")));
    }
}

/// A host that was changed after its firmware was flashed: 1 um/s faster.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Changed(Patrol);

impl Law<f32> for Changed {
    type Surroundings<'a> = InPlane<'a, f32>;
    type Protocol = ();
    type Workspace = ();

    fn decide(
        &mut self,
        view: &View<'_, f32>,
        here: &InPlane<'_, f32>,
        tools: Tools<'_, f32, Self>,
    ) -> Result<Decision<f32>, BadInput> {
        let Tools { rng, radio, workspace } = tools;
        let mut decision = self.0.decide(view, here, Tools { rng, radio, workspace })?;
        if let Action::Velocity { wish_mps, .. } = &mut decision.action {
            wish_mps.x += 1e-6;
        }
        Ok(decision)
    }
}

#[test]
fn law_that_differs_from_the_firmware_is_detected_at_once() {
    // Until step 8 a robot listens.
    let error = refusal(&Own::new(package!(), |_| Changed(Patrol::RING)));
    assert!(error.contains("robot 1 on qemu:stm32f405") && error.contains("differs at step 8"), "{error}");
}

#[test]
fn firmware_of_another_version_is_refused_before_it_starts() {
    let error = refusal(&Own::new(Package { version: "9.9.9", ..package!() }, |_| Patrol::RING));
    assert!(error.contains("is `patrol 0.1.0`, and this program steps `patrol 9.9.9`"), "{error}");
}
