//! `staya bridge SCENARIO`: the simulated swarm for ground stations and scripts, by MAVLink.

use crate::Endpoint;
use crate::bridge::{BridgeReport, Options, Refused, Swarm};
use crate::geo::{Global as Place, Origin};
use anyhow::Result;
use clap::Args;
use staya_console::{Ended, Global, Progress, Stop, print, print_json};
use staya_mavlink::signing::Signing;
use staya_sim::key::{KeyFile, timestamp};
use staya_sim::scenario::{Overrides, Scenario, Setting};
use staya_view::watch::Watcher;
use std::fmt::Write as _;
use std::io::{self, Write as _};
use std::path::PathBuf;

/// Run a scenario in real time, each robot a MAVLink vehicle that ground stations and scripts see and command.
#[derive(Args, Clone, Debug)]
#[command(allow_negative_numbers = true)]
pub struct BridgeArgs {
    /// The scenario, a .toml file, with at most 254 robots.
    scenario: PathBuf,
    /// Line to clients: udpout:HOST:PORT, udpin:HOST:PORT, tcpin:HOST:PORT, tcpout:HOST:PORT or serial:PORT,baud=N; may be repeated.
    #[arg(long, value_name = "LINE", default_value = "udpout:127.0.0.1:14550")]
    mavlink: Vec<Endpoint>,
    #[command(flatten)]
    page: staya_console::WatchArgs,
    /// Simulated seconds per second of real time.
    #[arg(long, value_name = "X", default_value_t = 1.0, value_parser = speed)]
    speed: f64,
    /// End after this many simulated seconds [default: at Ctrl-C].
    #[arg(long, value_name = "S", value_parser = seconds)]
    seconds: Option<f64>,
    /// End after this many ticks instead.
    #[arg(long, value_name = "N", conflicts_with = "seconds", value_parser = clap::value_parser!(u32).range(1..))]
    ticks: Option<u32>,
    /// Positions per second, of each vehicle and each kind, until a client asks for another rate.
    #[arg(long, value_name = "HZ", default_value_t = 10.0, value_parser = rate)]
    rate: f64,
    /// Robots wait, disarmed, for the operator, instead of following the scenario until they get a command.
    #[arg(long)]
    disarmed: bool,
    /// Where on the Earth the scenario's origin is: degrees north, degrees east, metres above the sea.
    #[arg(long, value_name = "LAT,LON,ALT", default_value = "47.397742,8.545594,488", value_parser = origin)]
    origin: Origin,
    /// Sign what is sent, and refuse what is not signed with this key: a file with 64 hex digits, or "passphrase: WORDS".
    #[arg(long, value_name = "FILE")]
    key: Option<PathBuf>,
    /// With a key: refuse frames whose timestamp is more than this many seconds ahead of the clock.
    #[arg(long, value_name = "S", default_value_t = 60.0, requires = "key", value_parser = lead)]
    lead: f64,
    /// Write what is sent and what is believed to a log that MAVExplorer and mavlogdump read.
    #[arg(long, value_name = "FILE")]
    tlog: Option<PathBuf>,
    /// Seed of all random numbers, instead of the scenario's.
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Say something else in a field of the scenario, as in radio.loss=0.3 or plane.orca.horizon_s=3; as often as needed.
    #[arg(long = "set", value_name = "FIELD=VALUE")]
    settings: Vec<Setting>,
}

/// A number within limits.
fn within(text: &str, least: f64, most: f64) -> Result<f64, String> {
    let value: Option<f64> = text.parse().ok();
    value.filter(|value| (least..=most).contains(value)).ok_or_else(|| format!("a number from {least} to {most}"))
}

fn speed(text: &str) -> Result<f64, String> {
    within(text, 0.01, 1000.0)
}

fn seconds(text: &str) -> Result<f64, String> {
    within(text, 0.001, 1e6)
}

fn rate(text: &str) -> Result<f64, String> {
    within(text, 0.1, 1000.0)
}

fn lead(text: &str) -> Result<f64, String> {
    within(text, 0.1, 1e8)
}

fn origin(text: &str) -> Result<Origin, String> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|part| part.trim().parse()).collect();
    let place = match numbers.as_deref() {
        Ok(&[latitude_deg, longitude_deg, altitude_m]) => Some(Place { latitude_deg, longitude_deg, altitude_m }),
        _ => None,
    };
    place.and_then(Origin::new).ok_or_else(|| "three numbers: -90 to 90, -180 to 180, metres".into())
}

/// The lines as they were given, and where those are that listen.
fn lines(swarm: &Swarm, endpoints: &[Endpoint]) -> String {
    let named = endpoints.iter().enumerate().map(|(line, endpoint)| {
        let local = swarm.lines().local(line);
        local.map_or_else(|| endpoint.to_string(), |local| format!("{endpoint} (here {local})"))
    });
    named.collect::<Vec<_>>().join(", ")
}

/// Tells people something beside the results.
fn say(remark: Option<&str>) {
    if let Some(remark) = remark {
        // Standard error may be closed; it is only a remark.
        let _ = writeln!(io::stderr(), "staya: {remark}");
    }
}

impl BridgeArgs {
    /// Runs the command.
    ///
    /// # Errors
    /// A scenario or key that cannot be read or is wrong, too many robots, a line that cannot be opened, a log that cannot be written.
    pub fn run(&self, global: &Global) -> Result<Ended> {
        let overrides = Overrides { seed: self.seed, ticks: None };
        let scenario = Scenario::load_with(&self.scenario, &overrides, &self.settings)?;
        for remark in scenario.remarks() {
            say(Some(&remark));
        }
        let ticks = match (self.ticks, self.seconds) {
            (Some(ticks), _) => Some(ticks),
            (None, Some(seconds)) => Some(libm::ceil(seconds / scenario.tick_s()) as u32),
            (None, None) => None,
        };
        let signing = match &self.key {
            Some(path) => {
                let file = KeyFile::read(path)?;
                say(file.remark.as_deref());
                // Timestamps count tens of microseconds.
                Some(Signing::new(file.key, 0, timestamp()).with_lead((self.lead * 1e5) as u64))
            }
            None => None,
        };
        let options = Options {
            endpoints: self.mavlink.clone(),
            speed: self.speed,
            ticks,
            position_hz: self.rate,
            starts_armed: !self.disarmed,
            origin: self.origin,
            signing,
            tlog: self.tlog.clone(),
        };
        let stop = Stop::on_ctrl_c()?;
        let swarm = Swarm::new(&scenario, options)?;
        let count = scenario.robots.len();
        let lines = lines(&swarm, &self.mavlink);
        // What has no end of its own has no progress.
        let mut progress = ticks.map(|ticks| Progress::new(&scenario.name, ticks.into(), global));
        if progress.is_none() && !global.quiet {
            say(Some(&format!("{count} vehicles at {lines}; Ctrl-C ends")));
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
        let report = swarm.run_watched(is_over, &mut |moment, robots| {
            if let Some(page) = &mut page {
                page.tick(moment, robots);
            }
        })?;
        if let Some(progress) = progress {
            progress.finish();
        }
        if global.json {
            print_json(&report)?;
        } else {
            print(&table(&scenario.name, &report)?)?;
        }
        // Without an end of its own, Ctrl-C is how it ends.
        Ok(match ticks {
            None => Ended::Done,
            Some(_) => Ended::by(&stop),
        })
    }
}

/// The figures for a reader.
fn table(name: &str, report: &BridgeReport) -> Result<String, std::fmt::Error> {
    let mut text = String::new();
    writeln!(text, "{name}")?;
    let mut line = |name: &str, value: String| writeln!(text, "  {name:<16}{value}");
    line("vehicles", report.vehicles.to_string())?;
    line(
        "simulated",
        format!("{} s in {} ticks, {:.1} s on the wall", report.sim_seconds, report.ticks, report.wall_seconds),
    )?;
    let (missed, ticks, slowest) = (report.deadlines_missed, report.ticks, report.slowest_seconds);
    line("deadlines", format!("{missed} missed in {ticks} ticks, {slowest:.4} s at most until one was done"))?;
    let commands = report.commands.iter();
    let commands: Vec<_> = commands.map(|(result, count)| format!("{count} {result}")).collect();
    let commands = match commands.is_empty() {
        true => "none".into(),
        false => commands.join(", "),
    };
    line("commands", commands)?;
    let Refused { unsigned, forged, replayed, ahead, no_room, unanswerable } = report.refused;
    let (heard, ignored, refused) = (report.frames_heard, report.frames_ignored, report.frames_refused);
    line("frames", format!("{heard} heard, {ignored} for nobody here, {} still waiting", report.frames_waiting))?;
    line(
        "frames refused",
        format!(
            "{refused}: {unsigned} unsigned, {forged} forged, {replayed} replayed, {ahead} too far ahead, {no_room} of new \
             senders without room, {unanswerable} that could not be answered"
        ),
    )?;
    if report.is_exhausted {
        line("signing", String::from("no timestamp is left, nothing is obeyed: give the swarm a new key"))?;
    }
    line("collisions", report.collisions.to_string())?;
    line("trace hash", report.trace_hash.clone())?;
    writeln!(
        text,
        "\n{:<32}{:>10}{:>10}{:>12}{:>8}{:>12}{:>8}",
        "line", "frames in", "out", "kB/s out", "lost", "junk bytes", "lost in"
    )?;
    for line in &report.lines {
        writeln!(
            text,
            "{:<32}{:>10}{:>10}{:>12.1}{:>8}{:>12}{:>8}",
            line.endpoint,
            line.frames_in,
            line.frames_out,
            line.bytes_out_per_s / 1000.0,
            line.lost_out,
            line.junk_bytes,
            line.lost_in
        )?;
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn origins_are_places_on_the_earth() {
        let zurich = origin("47.4, 8.5,488").expect("a place").place();
        assert_eq!((zurich.latitude_deg, zurich.altitude_m), (47.4, 488.0));
        for bad in ["", "1,2", "1,2,3,4", "91,0,0", "0,181,0", "a,b,c", "nan,0,0"] {
            assert!(origin(bad).is_err(), "{bad}");
        }
    }
}
