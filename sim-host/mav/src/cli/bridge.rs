use super::signing;
use crate::bridge::{BridgeReport, LineReport, Options, Refused, Swarm};
use crate::terminal::{number, say};
use crate::{Counts, Endpoint};
use anyhow::Result;
use clap::Args;
use staya_console::{Ended, Global, Progress, Stop, print, print_json};
use staya_sim::scenario::{Overrides, Scenario, Setting};
use staya_view::watch::Watcher;
use std::fmt::Write as _;
use std::path::PathBuf;

/// Run a scenario in real time with each robot as a MAVLink vehicle for ground stations and
/// scripts.
#[derive(Args, Clone, Debug)]
#[command(allow_negative_numbers = true)]
pub struct BridgeArgs {
    /// Scenario, a .toml file with at most 254 robots.
    scenario: PathBuf,
    #[command(flatten)]
    options: Options,
    #[command(flatten)]
    page: staya_console::WatchArgs,
    /// Stop after this many simulated seconds, instead of ticks.
    #[arg(long, value_name = "S", conflicts_with = "ticks", value_parser = number(0.001, 1e6))]
    seconds: Option<f64>,
    /// Sign sent messages and reject those without a valid signature; a file with 64 hex digits, or
    /// "passphrase: WORDS".
    #[arg(long, value_name = "FILE")]
    key: Option<PathBuf>,
    /// With --key: reject messages whose timestamp is more than this many seconds ahead of the
    /// clock.
    #[arg(long, value_name = "S", default_value_t = 60.0, requires = "key", value_parser = number(0.1, 1e8))]
    lead: f64,
    /// Seed of all random numbers, instead of the scenario's.
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Override a scenario field, for example radio.loss=0.3 or plane.orca.horizon_s=3; may be
    /// repeated.
    #[arg(long = "set", value_name = "FIELD=VALUE")]
    settings: Vec<Setting>,
}

fn lines(swarm: &Swarm, endpoints: &[Endpoint]) -> String {
    let named = endpoints.iter().enumerate().map(|(line, endpoint)| {
        let local = swarm.lines().local(line);
        local.map_or_else(|| endpoint.to_string(), |local| format!("{endpoint} (here {local})"))
    });
    named.collect::<Vec<_>>().join(", ")
}

impl BridgeArgs {
    /// Runs the command.
    ///
    /// # Errors
    /// The scenario or key is invalid, a link cannot be opened, or the log cannot be created.
    pub fn run(&self, global: &Global) -> Result<Ended> {
        let overrides = Overrides { seed: self.seed, ticks: None };
        let mut scenario = Scenario::load_with(&self.scenario, &overrides, &self.settings)?;
        scenario.origin.files.extend(self.key.clone());
        for remark in scenario.remarks() {
            say(&remark);
        }
        let ticks_in = |seconds: f64| libm::ceil(seconds / scenario.tick_s()) as u32;
        let ticks = self.options.ticks.or(self.seconds.map(ticks_in));
        let signing = signing(self.key.as_deref(), 0)?.map(|signing| signing.with_lead((self.lead * 1e5) as u64));
        let options = Options { ticks, signing, ..self.options.clone() };
        let stop = Stop::on_ctrl_c()?;
        let swarm = Swarm::new(&scenario, options)?;
        let count = scenario.robots.len();
        let lines = lines(&swarm, &self.options.mavlink);
        let mut progress = ticks.map(|ticks| Progress::new(&scenario.name, ticks.into(), global));
        if progress.is_none() && !global.quiet {
            say(&format!("{count} vehicles at {lines}; press Ctrl-C to stop"));
        }
        let mut shown = None;
        let mut page = Watcher::by_options(&self.page, &scenario)?;
        let is_over = |ticks: u32| {
            if let Some(progress) = &mut progress
                && shown != Some(ticks)
            {
                shown = Some(ticks);
                progress.set(ticks.into(), || format!("ticks, {count} vehicles at {lines}"));
            }
            stop.is_requested()
        };
        let report = swarm.run(is_over, &mut |moment, robots| {
            if let Some(page) = &mut page {
                page.tick(moment, robots);
            }
        });
        if let Some(progress) = progress {
            progress.finish();
        }
        if global.json {
            print_json(&report)?;
        } else {
            print(&table(&scenario.name, &report)?)?;
        }
        // A run without an end is stopped by Ctrl-C, so that is not an interruption.
        Ok(match ticks {
            None => Ended::Done,
            Some(_) => Ended::by(&stop),
        })
    }
}

fn table(name: &str, report: &BridgeReport) -> Result<String, std::fmt::Error> {
    let BridgeReport { vehicles, ticks, sim_seconds, wall_seconds, slowest_seconds, frames_waiting, .. } = report;
    let BridgeReport { deadlines_missed, frames_heard, frames_ignored, frames_refused, .. } = report;
    let Refused { unsigned, forged, replayed, ahead, no_room, unanswerable } = report.refused;
    let commands: Vec<_> = report.commands.iter().map(|(result, count)| format!("{count} {result}")).collect();
    let commands = if commands.is_empty() { "none".into() } else { commands.join(", ") };
    let signing = match report.is_exhausted {
        true => "  signing         timestamps used up, commands are refused; give the swarm a new key\n",
        false => "",
    };
    let mut text = format!(
        "{name}\n  vehicles        {vehicles}\n  \
         simulated       {sim_seconds} s in {ticks} ticks, {wall_seconds:.1} s of real time\n  \
         deadlines       {deadlines_missed} missed in {ticks} ticks, slowest tick {slowest_seconds:.4} s\n  \
         commands        {commands}\n  \
         frames          {frames_heard} handled, {frames_ignored} for other systems, {frames_waiting} still queued\n  \
         frames rejected {frames_refused}: {unsigned} unsigned, {forged} forged, {replayed} replayed, \
         {ahead} with future timestamps, {no_room} from new senders with the table full, {unanswerable} not \
         answerable\n\
         {signing}  collisions      {}\n  trace hash      {}\n",
        report.collisions, report.trace_hash
    );
    writeln!(
        text,
        "\n{:<32}{:>10}{:>10}{:>12}{:>8}{:>12}{:>8}",
        "line", "frames in", "out", "kB/s out", "lost", "junk bytes", "lost in"
    )?;
    for LineReport { endpoint, counts, bytes_out_per_s } in &report.lines {
        let Counts { frames_in, frames_out, lost_out, junk_bytes, lost_in, .. } = counts;
        let kb_per_s = bytes_out_per_s / 1000.0;
        writeln!(
            text,
            "{endpoint:<32}{frames_in:>10}{frames_out:>10}{kb_per_s:>12.1}{lost_out:>8}{junk_bytes:>12}{lost_in:>8}",
        )?;
    }
    if let Some(error) = &report.log_error {
        writeln!(text, "\n{error}; {}", report.log_missing)?;
    }
    Ok(text)
}
