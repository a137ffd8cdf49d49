//! Options that commands which run a scenario have in common.

use anyhow::Result;
use clap::Args;
use staya_sim::scenario::{Overrides, Scenario, Setting};
use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::path::{Path, PathBuf};

/// Which scenario, and what of it is otherwise.
#[derive(Args, Clone, Debug)]
pub struct ScenarioArgs {
    /// The scenario, a .toml file; scenarios/README.md lists the ones that come with Staya, and all fields.
    scenario: PathBuf,
    /// Seed of all random numbers, instead of the scenario's.
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// End after this many ticks, instead of the scenario's number.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    ticks: Option<u32>,
    /// Say something else in a field of the scenario, as in radio.loss=0.3 or plane.orca.horizon_s=3; as often as needed.
    #[arg(long = "set", value_name = "FIELD=VALUE")]
    settings: Vec<Setting>,
}

impl ScenarioArgs {
    /// The file.
    pub fn path(&self) -> &Path {
        &self.scenario
    }

    /// Which fields say something else.
    pub fn settings(&self) -> &[Setting] {
        &self.settings
    }

    /// What is otherwise than in the file.
    pub const fn overrides(&self) -> Overrides {
        Overrides { seed: self.seed, ticks: self.ticks }
    }

    /// Reads it.
    ///
    /// # Errors
    /// It cannot be read, or is wrong.
    pub fn load(&self) -> Result<Scenario> {
        let scenario = Scenario::load_with(&self.scenario, &self.overrides(), &self.settings)?;
        for remark in scenario.remarks() {
            eprintln!("{remark}");
        }
        Ok(scenario)
    }
}

/// Pages that look on.
#[derive(Args, Clone, Copy, Debug)]
pub struct WatchArgs {
    /// Serve a page that looks on while this goes on, and ends with it; to take hold of a run, or to look at a short one, there is
    /// `staya view`. Nobody waits for the page, and nothing becomes different by it.
    #[arg(long, help_heading = "A page that looks on")]
    view: bool,
    /// Address and port of the page; port 0: any that is free. Beyond this machine (0.0.0.0) whoever has the address that is
    /// printed, with its token, can watch, unencrypted.
    #[arg(
        long,
        value_name = "ADDRESS",
        requires = "view",
        default_value_t = SocketAddr::new(IpAddr::V4(Ipv4Addr::LOCALHOST), 0),
        help_heading = "A page that looks on"
    )]
    listen: SocketAddr,
}

impl WatchArgs {
    /// Where the page is to be served; `None`: no page is wanted.
    #[must_use]
    pub fn address(&self) -> Option<SocketAddr> {
        self.view.then_some(self.listen)
    }
}
