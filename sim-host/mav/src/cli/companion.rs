mod page;

use super::number;
use crate::Tlog;
use crate::companion::{Config, Options, Sight, run};
use anyhow::Result;
use clap::Args;
use page::Page;
use staya_console::{Ended, Global, Stop, WatchArgs, print, print_json};
use staya_sim::record::Files;
use staya_view::watch::Watcher;
use std::path::PathBuf;
use std::time::Duration;

/// Control ArduPilot or PX4 vehicles as a swarm.
#[derive(Args, Clone, Debug)]
pub struct CompanionArgs {
    /// Configuration, a .toml file; docs/autopilots.md lists its fields, companions/ has examples.
    config: PathBuf,
    /// Show the messages that would be sent, and send nothing.
    #[arg(long)]
    dry_run: bool,
    /// Simulate the configured vehicles in this process, without links; ends when all have
    /// arrived.
    #[arg(long, conflicts_with = "dry_run")]
    demo: bool,
    /// End with an error if no autopilot is heard in this many seconds; 0 waits forever.
    #[arg(long, value_name = "N", default_value = "60", value_parser = number(0.0, 1e6))]
    wait: f64,
    /// Stop after this many seconds [default: run until Ctrl-C].
    #[arg(long, value_name = "N", value_parser = number(0.0, 1e6))]
    seconds: Option<f64>,
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
        let inputs = config.scenario.files.iter().chain(&config.key).chain(&config.link_key);
        let mut files = Files::reading(inputs);
        let tlog = self.tlog.as_deref().map(|path| Tlog::create(path, &mut files)).transpose()?;
        let stop = Stop::on_ctrl_c()?;
        let page = Watcher::by_options(&self.page, &config.scenario)?;
        let mut options = Options {
            dry_run: self.dry_run,
            quiet: global.quiet,
            seconds: self.seconds,
            demo: self.demo,
            is_real_time: page.is_some(),
            wait: (self.wait > 0.0).then(|| Duration::from_secs_f64(self.wait)),
            tlog,
        };
        let mut page = page.map(|watcher| Page::new(watcher, &config.scenario)).transpose()?;
        let look = |sight: &Sight<'_>| {
            if let Some(page) = &mut page {
                page.look(sight);
            }
        };
        let report = run(&config, &mut options, || !stop.is_requested(), look)?;
        if global.json {
            print_json(&report)?;
        } else {
            print(&report.to_string())?;
        }
        Ok(Ended::by(&stop))
    }
}
