//! Runs the simulation in real time and connects its vehicles to the links.
//!
//! Received frames are handled between ticks, so answers do not wait for ticks. Message rates
//! follow the real clock at any `speed`; setpoints and missions follow simulated time.

use super::budget::Budget;
use super::model::VehicleModel;
use super::params::Parameters;
use super::report::{BridgeReport, LineReport, Refused};
use super::streams::Streams;
use super::vehicle::{Action, Kind, Vehicle};
use crate::framed::framed;
use crate::geo::Origin;
use crate::terminal::{number, result_words, say};
use crate::{Endpoint, Lines, Received, Tlog};
use anyhow::{Result, bail};
use clap::Args;
use staya_mavlink::constants::MAV_SEVERITY_ERROR;
use staya_mavlink::dialect::MavMessage;
use staya_mavlink::frame::RawFrame;
use staya_mavlink::mavlink_core::Message as _;
use staya_mavlink::signing::{Counts, Signing};
use staya_sim::engine::{Engine, Moment, operated};
use staya_sim::key::timestamp;
use staya_sim::record::{self, Files, RobotRow};
use staya_sim::scenario::Scenario;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

const LAST_SYSTEM: u32 = 254;
const GLANCE: Duration = Duration::from_millis(4);
/// Frames handled between two ticks even if no time is left.
const AT_LEAST: usize = 8;
const PARAMETERS_PER_S: u32 = 2000;
/// With fewer signing timestamps left, commands are refused because they could not be answered.
const RESERVE: u64 = 1 << 16;
const COMPLAIN_US: u64 = 10_000_000;

/// Options of a bridge run.
#[derive(Args, Clone, Debug)]
pub struct Options {
    /// Link to clients: udpout:HOST:PORT, udpin:HOST:PORT, tcpin:HOST:PORT, tcpout:HOST:PORT or
    /// serial:PORT,baud=N; may be repeated.
    #[arg(long, value_name = "LINE", default_value = "udpout:127.0.0.1:14550")]
    pub mavlink: Vec<Endpoint>,
    /// Simulated seconds per second of real time.
    #[arg(long, value_name = "X", default_value_t = 1.0, value_parser = number(0.01, 1000.0))]
    pub speed: f64,
    /// Stop after this many ticks [default: run until Ctrl-C].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub ticks: Option<u32>,
    /// Position messages per second and vehicle, until a client requests another rate.
    #[arg(long, value_name = "HZ", default_value_t = 10.0, value_parser = number(0.1, 1000.0))]
    pub rate: f64,
    /// Start disarmed and wait for the operator, instead of following the scenario until a command
    /// arrives.
    #[arg(long)]
    pub disarmed: bool,
    /// Geographic position of the scenario's origin: degrees north, degrees east, metres above sea
    /// level.
    #[arg(long, value_name = "LAT,LON,ALT", default_value = "47.397742,8.545594,488")]
    pub origin: Origin,
    /// Write sent and accepted messages to a log for MAVExplorer and mavlogdump; an older file, and
    /// each file at 256 MiB, is renamed to FILE.1.
    #[arg(long, value_name = "FILE")]
    pub tlog: Option<PathBuf>,
    /// Key that signs sent frames. Received frames need a valid signature.
    #[arg(skip)]
    pub signing: Option<Signing>,
}

/// A callback that observes the swarm after each tick. It delays the next tick, so it must be fast.
pub type Onlooker<'a> = dyn FnMut(&Moment<'_>, &mut dyn Iterator<Item = RobotRow>) + 'a;

/// A running bridge.
pub struct Swarm {
    engine: Engine,
    vehicles: Vec<Vehicle>,
    /// Restarts of each robot.
    starts: Vec<u32>,
    model: Arc<VehicleModel>,
    lines: Lines,
    options: Options,
    log: Option<Tlog>,
    /// Whether the operator has yet to learn that the log failed.
    has_lost_log: bool,
    tick_us: u32,
    began: Instant,
    first: usize,
    listing: Budget,
    complained_us: Option<u64>,
    report: BridgeReport,
}

impl Swarm {
    /// Loads a scenario before its first tick and opens the links.
    ///
    /// # Errors
    /// A robot's number is not a valid MAVLink system id, two robots start in one place, a link
    /// cannot be opened, or the log cannot be created.
    pub fn new(scenario: &Scenario, options: Options) -> Result<Self> {
        let numbers: Vec<u32> = scenario.robots.iter().map(|robot| robot.id.0).collect();
        if let Some(number) = numbers.iter().find(|&&number| number == 0 || number > LAST_SYSTEM) {
            bail!(
                "robot {number} cannot be a MAVLink vehicle: numbers are 1 to {LAST_SYSTEM}; give the scenario fewer \
                 robots, or other numbers"
            );
        }
        let mut engine = operated(scenario)?;
        let model = Arc::new(VehicleModel::new(scenario, options.origin));
        let count = numbers.len();
        let vehicle = |(index, number): (usize, u32)| {
            let parameters = Parameters::new(&model, &engine.parameters(index));
            let streams = Streams::new(options.rate, index as f64 / count as f64);
            let state = (0, engine.observation(index));
            Vehicle::new(number as u8, Arc::clone(&model), parameters, streams, state, !options.disarmed)
        };
        let vehicles = numbers.into_iter().enumerate().map(vehicle).collect();
        let lines = Lines::open(&options.mavlink)?;
        let create = |path: &PathBuf| Tlog::create(path, &mut Files::reading(&scenario.origin.files));
        let log = options.tlog.as_ref().map(create).transpose()?;
        let listing = Budget::per_second(parameters_per_s(&options.mavlink));
        Ok(Self {
            starts: vec![0; count],
            engine,
            vehicles,
            model,
            lines,
            options,
            log,
            has_lost_log: false,
            tick_us: scenario.tick_us,
            began: Instant::now(),
            first: 0,
            listing,
            complained_us: None,
            report: BridgeReport::default(),
        })
    }

    /// The open links.
    pub const fn lines(&self) -> &Lines {
        &self.lines
    }

    /// Runs until the ticks are used up or `is_over` returns true. `is_over` receives the number of
    /// finished ticks and is called every few milliseconds, `onlooker` after each tick.
    ///
    /// A log that cannot be written does not end the run: the report counts what the log lacks.
    pub fn run(mut self, mut is_over: impl FnMut(u32) -> bool, onlooker: &mut Onlooker<'_>) -> BridgeReport {
        let tick = Duration::from_secs_f64(f64::from(self.tick_us) / 1e6 / self.options.speed);
        for index in 0..self.vehicles.len() {
            self.carry_out(index);
        }
        self.began = Instant::now();
        let mut due = self.began + tick;
        while self.options.ticks.is_none_or(|ticks| self.report.ticks < ticks) && !is_over(self.report.ticks) {
            let now = Instant::now();
            if now >= due {
                self.tick();
                self.engine.show(onlooker);
                let done = Instant::now();
                self.report.slowest_seconds = self.report.slowest_seconds.max((done - due).as_secs_f64());
                due += tick;
                if let Some(late) = done.checked_duration_since(due) {
                    // Late ticks are not made up for.
                    let others = u32::try_from(late.as_nanos() / tick.as_nanos().max(1)).unwrap_or(u32::MAX);
                    self.report.deadlines_missed =
                        self.report.deadlines_missed.saturating_add(others).saturating_add(1);
                    due = done;
                }
            }
            self.listen(due);
            self.speak(due);
        }
        if let Some(log) = &mut self.log {
            let done = log.finish();
            self.judge_log(done);
        }
        self.report()
    }

    fn listen(&mut self, due: Instant) {
        if let Some(signing) = &mut self.options.signing {
            signing.advance_to(timestamp());
        }
        let until = due.min(Instant::now() + GLANCE);
        for served in 0.. {
            let left = until.saturating_duration_since(Instant::now());
            if left.is_zero() && served >= AT_LEAST {
                break;
            }
            let Some(received) = self.lines.receive(left) else {
                break;
            };
            let answers = self.take(&received);
            self.lines.charge(answers);
        }
    }

    fn now_us(&self) -> u64 {
        u64::try_from(self.began.elapsed().as_micros()).unwrap_or(u64::MAX)
    }

    /// Returns the number of answers.
    fn take(&mut self, received: &Received) -> usize {
        let Some(frame) = RawFrame::new(&received.frame) else {
            self.report.frames_ignored += 1;
            return 0;
        };
        if self.options.signing.as_mut().is_some_and(|signing| !signing.verify(&frame).is_accepted()) {
            return 0;
        }
        let Some(message) = frame.message() else {
            self.report.frames_ignored += 1;
            return 0;
        };
        self.lines.believe(received.line, received.peer);
        // Frames with an invalid signature are not logged: they could fill the disk.
        self.note(&received.frame);
        if self.is_exhausted() {
            self.report.refused.unanswerable += 1;
            return 0;
        }
        let mut answers = 0;
        let (from, now_us) = (frame.sender(), self.now_us());
        let system = message.target_system_id().unwrap_or(0);
        let is_for_some = !matches!(message, MavMessage::HEARTBEAT(_));
        let mut is_heard = false;
        for index in 0..self.vehicles.len() {
            let vehicle = &mut self.vehicles[index];
            let own = vehicle.sender;
            let is_own = (from.system, from.component) == (own.system, own.component);
            if is_for_some && !is_own && (system == 0 || system == vehicle.sender.system) {
                vehicle.receive(from, &message, now_us);
                is_heard = true;
                answers += self.carry_out(index);
            }
        }
        self.report.frames_heard += u64::from(is_heard || !is_for_some);
        self.report.frames_ignored += u64::from(is_for_some && !is_heard);
        answers
    }

    fn speak(&mut self, due: Instant) {
        let now_us = self.now_us();
        self.complain(now_us);
        let count = self.vehicles.len();
        for _ in 0..count {
            let index = self.first;
            let vehicle = &mut self.vehicles[index];
            vehicle.poll(now_us);
            if vehicle.parameters.is_listing() && self.listing.take(now_us) {
                vehicle.out.messages.extend(vehicle.parameters.next_listed().map(MavMessage::PARAM_VALUE));
            }
            self.carry_out(index);
            self.first = (index + 1) % count;
            if Instant::now() >= due {
                break;
            }
        }
    }

    /// The warning comes while some timestamps are left to sign it.
    fn complain(&mut self, now_us: u64) {
        if core::mem::take(&mut self.has_lost_log) {
            self.warn_all("the log cannot be written");
        }
        let is_early = |last: u64| now_us.saturating_sub(last) < COMPLAIN_US;
        if !self.is_exhausted() || self.complained_us.is_some_and(is_early) {
            return;
        }
        self.complained_us = Some(now_us);
        self.warn_all("signing timestamps used up: give a new key");
    }

    fn warn_all(&mut self, text: &str) {
        for index in 0..self.vehicles.len() {
            self.vehicles[index].text(Kind::News, MAV_SEVERITY_ERROR, text);
            self.carry_out(index);
        }
    }

    fn note(&mut self, frame: &[u8]) {
        if let Some(log) = &mut self.log {
            let done = log.add(frame);
            self.judge_log(done);
        }
    }

    /// A robot must not lose its controller because a disk is full.
    fn judge_log(&mut self, done: Result<(), record::Error>) {
        if let Err(error) = done {
            say(&format!("{error}; continuing without a log"));
            self.report.log_error = Some(error.to_string());
            self.has_lost_log = true;
        }
    }

    fn is_exhausted(&self) -> bool {
        self.options.signing.as_ref().is_some_and(|signing| signing.left() < RESERVE)
    }

    fn tick(&mut self) {
        self.engine.step();
        self.report.ticks += 1;
        let time_us = u64::from(self.report.ticks) * u64::from(self.tick_us);
        let now_us = self.now_us();
        for index in 0..self.vehicles.len() {
            let seen = self.engine.observation(index);
            if seen.is_up && seen.starts != self.starts[index] {
                self.starts[index] = seen.starts;
                let parameters = Parameters::new(&self.model, &self.engine.parameters(index));
                self.vehicles[index].restart(parameters, (time_us, seen));
            }
            let events = self.engine.events(index);
            self.vehicles[index].observe((time_us, seen), events, now_us);
            self.carry_out(index);
        }
    }

    /// Returns the number of messages.
    fn carry_out(&mut self, index: usize) -> usize {
        for action in core::mem::take(&mut self.vehicles[index].out.actions) {
            match action {
                Action::Tell(header, message) => self.engine.tell(index, header, &message),
                Action::Wish(wish) => {
                    let _ = self.engine.command(index, wish);
                }
                Action::Set(name, value) => {
                    if self.engine.set_parameter(index, name, value).is_err() {
                        let value = self.engine.parameter(index, name);
                        self.vehicles[index].set_back(name, value);
                    }
                }
            }
        }
        let mut messages = core::mem::take(&mut self.vehicles[index].out.messages);
        let answers = messages.len();
        for message in messages.drain(..) {
            if let MavMessage::COMMAND_ACK(ack) = &message {
                *self.report.commands.entry(result_words(ack.result)).or_default() += 1;
            }
            let signing = self.options.signing.as_mut();
            let Some(frame) = framed(&mut self.vehicles[index].sender, &message, signing) else { continue };
            self.note(&frame);
            self.lines.send_all(&frame);
        }
        // Keeps its memory.
        self.vehicles[index].out.messages = messages;
        answers
    }

    fn report(mut self) -> BridgeReport {
        let wall_seconds = self.began.elapsed().as_secs_f64();
        self.lines.close();
        let line = |(at, endpoint): (usize, &Endpoint)| {
            let counts = self.lines.counts(at);
            let bytes_out_per_s = counts.bytes_out as f64 / wall_seconds.max(1e-9);
            LineReport { endpoint: endpoint.to_string(), counts, bytes_out_per_s }
        };
        let counts = self.options.signing.as_ref().map(Signing::counts).unwrap_or_default();
        let Counts { unsigned, forged, replayed, ahead, no_room, .. } = counts;
        let unanswerable = self.report.refused.unanswerable;
        let outcome = self.engine.outcome();
        let gap = outcome.clearance.map(|clearance| clearance.bodies_m);
        BridgeReport {
            vehicles: self.vehicles.len(),
            sim_seconds: outcome.seconds,
            wall_seconds,
            frames_refused: u64::from(counts.refused()) + unanswerable,
            refused: Refused { unsigned, forged, replayed, ahead, no_room, unanswerable },
            frames_ahead: ahead,
            frames_waiting: self.lines.waiting(),
            is_exhausted: self.is_exhausted(),
            lines: self.options.mavlink.iter().enumerate().map(line).collect(),
            collisions: outcome.collisions,
            least_gap_m: gap.filter(|gap| gap.is_finite()),
            trace_hash: format!("{:016x}", outcome.trace_hash),
            log_missing: self.log.as_ref().map(Tlog::missing).unwrap_or_default(),
            ..self.report
        }
    }
}

/// A third of the slowest serial link's rate; the rest is for telemetry.
fn parameters_per_s(endpoints: &[Endpoint]) -> u32 {
    const BITS: u32 = 10 * 50;
    let serial = endpoints.iter().filter_map(|endpoint| match endpoint {
        Endpoint::Serial(port) => Some((port.baud / BITS / 3).max(1)),
        _ => None,
    });
    serial.fold(PARAMETERS_PER_S, u32::min)
}

#[cfg(test)]
mod tests;
