mod page;

use crate::Tlog;
use crate::companion::{Config, Options, Sight, run};
use anyhow::Result;
use clap::Args;
use page::Page;
use staya_console::{Ended, Global, Stop, WatchArgs, print, print_json};
use staya_sim::record::Files;
use staya_view::watch::Watcher;
use std::path::PathBuf;

/// Control ArduPilot or PX4 vehicles as a swarm.
#[derive(Args, Clone, Debug)]
pub struct CompanionArgs {
    /// Configuration, a .toml file; docs/autopilots.md lists its fields, companions/ has examples.
    config: PathBuf,
    #[command(flatten)]
    options: Options,
    /// Write sent and accepted messages of all links to a log for mavlogdump, MAVExplorer or
    /// QGroundControl; an older file, and each file at 256 MiB, is renamed to FILE.1.
    #[arg(long, value_name = "FILE")]
    tlog: Option<PathBuf>,
    /// Encrypt packets between companions with the key in this file, and accept only encrypted
    /// ones; overrides air.key.
    #[arg(long, value_name = "FILE")]
    key: Option<PathBuf>,
    /// Sign all messages on the links with the key in this file, and accept only signed ones;
    /// overrides link_key.
    #[arg(long, value_name = "FILE")]
    link_key: Option<PathBuf>,
    #[command(flatten)]
    page: WatchArgs,
}

impl CompanionArgs {
    /// Runs the command.
    ///
    /// # Errors
    /// The configuration is invalid, a link cannot be opened, or a log cannot be written.
    pub fn run(&self, global: &Global) -> Result<Ended> {
        let mut config = Config::load(&self.config)?;
        config.key = self.key.clone().or(config.key);
        config.link_key = self.link_key.clone().or(config.link_key);
        let inputs = config.scenario.origin.files.iter().chain(&config.key).chain(&config.link_key);
        let mut files = Files::reading(inputs);
        let tlog = self.tlog.as_deref().map(|path| Tlog::create(path, &mut files)).transpose()?;
        let stop = Stop::on_ctrl_c()?;
        let page = Watcher::by_options(&self.page, &config.scenario)?;
        let options = Options { quiet: global.quiet, is_real_time: page.is_some(), ..self.options };
        let mut page = page.map(|watcher| Page::new(watcher, &config.scenario)).transpose()?;
        let look = |sight: &Sight<'_>| {
            if let Some(page) = &mut page {
                page.look(sight);
            }
        };
        let report = run(&config, &options, tlog, || !stop.is_requested(), look)?;
        if global.json {
            print_json(&report)?;
        } else {
            print(&report.to_string())?;
        }
        Ok(Ended::by(&stop))
    }
}
