use super::say;
use anyhow::Result;
use clap::Args;
use staya_sim::scenario::{Overrides, Scenario, Setting};
use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::path::{Path, PathBuf};

/// A scenario with overrides.
#[derive(Args, Clone, Debug)]
pub struct ScenarioArgs {
    /// Scenario, a .toml file; scenarios/README.md lists the included ones and all fields.
    scenario: PathBuf,
    /// Seed of all random numbers, instead of the scenario's.
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Stop after this many ticks, instead of the scenario's number.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    ticks: Option<u32>,
    /// Override a scenario field, for example radio.loss=0.3 or plane.orca.horizon_s=3; may be
    /// repeated.
    #[arg(long = "set", value_name = "FIELD=VALUE")]
    settings: Vec<Setting>,
}

impl ScenarioArgs {
    /// Path of the file.
    pub fn path(&self) -> &Path {
        &self.scenario
    }

    /// Overridden fields.
    pub fn settings(&self) -> &[Setting] {
        &self.settings
    }

    /// Overridden seed and number of ticks.
    pub const fn overrides(&self) -> Overrides {
        Overrides { seed: self.seed, ticks: self.ticks }
    }

    /// Loads the scenario with the overrides and prints its remarks on standard error.
    ///
    /// # Errors
    /// The file is unreadable or invalid.
    pub fn load(&self) -> Result<Scenario> {
        let scenario = Scenario::load_with(&self.scenario, &self.overrides(), &self.settings)?;
        for remark in scenario.remarks() {
            say(&remark);
        }
        Ok(scenario)
    }
}

/// Options of a live page.
#[derive(Args, Clone, Copy, Debug)]
pub struct WatchArgs {
    /// Serve a live page that shows the run while it lasts. The page cannot change or delay the
    /// run; for interaction or short runs use `staya view`.
    #[arg(long, help_heading = "Live page")]
    view: bool,
    /// Address and port of the page; port 0 selects a free port. With an address other than
    /// loopback, such as 0.0.0.0, anyone with the printed address and its token can watch the run;
    /// the connection is not encrypted.
    #[arg(
        long,
        value_name = "ADDRESS",
        requires = "view",
        default_value_t = SocketAddr::new(IpAddr::V4(Ipv4Addr::LOCALHOST), 0),
        help_heading = "Live page"
    )]
    listen: SocketAddr,
}

impl WatchArgs {
    /// Address of the page; `None` without a page.
    #[must_use]
    pub fn address(&self) -> Option<SocketAddr> {
        self.view.then_some(self.listen)
    }
}
