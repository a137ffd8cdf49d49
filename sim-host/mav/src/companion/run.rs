//! The main loop of companions.

mod demo;
mod machine;
mod shown;
mod telemetry;
mod vehicle;

pub(crate) use vehicle::Vehicle;

use super::config::{Config, VehicleSetup};
use super::controller::Controller;
use super::medium::{Medium, MediumSetup, tunnel, tunnelled};
use super::offboard::{Event, OffboardStateMachine, Rules, State, status_text};
use super::report::CompanionReport;
use super::roll::{Roll, Turn};
use super::seal::Seal;
use super::twins::{LISTEN, Twins};
use crate::boot::fresh_boot;
use crate::framed::framed;
use crate::geo::ned;
use crate::terminal::{number, say};
use crate::{Lines, Received, Tlog};
use anyhow::{Result, anyhow, bail};
use clap::Args;
use demo::Demo;
use machine::{Host, Machine};
use staya_controller::robot::Mode;
use staya_mavlink::any::AnyWire;
use staya_mavlink::constants::MAV_COMP_ID_AUTOPILOT1;
use staya_mavlink::dialect::MavMessage;
use staya_mavlink::frame::{RawFrame, Sender};
use staya_mavlink::signing::Signing;
use staya_mavlink::wire::COMPONENT;
use staya_sim::engine::PlaneGround;
use staya_sim::key::{self, KeyFile};
use staya_sim::radio::HostWire;
use staya_sim::record;
use std::io;
use std::sync::Arc;
use std::time::{Duration, Instant};
use vehicle::is_within;

/// Longest waits: with a LAN to poll, and without.
const LAN_GLANCE: Duration = Duration::from_millis(5);
const GLANCE: Duration = Duration::from_millis(20);
/// Zero-velocity setpoints at the end, and their interval.
const FAREWELLS: (u32, Duration) = (5, Duration::from_millis(40));

const FEW_TIMESTAMPS: u64 = 1000;
const LOOK: Duration = Duration::from_secs(1);
/// Smallest age limit of positions in a dry run.
const SELDOM: Duration = Duration::from_secs(3);

/// Longest demo, seconds.
const DEMO_S: f64 = 600.0;

/// Options of a run.
#[derive(Args, Clone, Copy, Debug, Default)]
pub struct Options {
    /// Show the messages that would be sent, and send nothing.
    #[arg(long)]
    pub dry_run: bool,
    /// Simulate the configured vehicles in this process, without links; ends when all have
    /// arrived.
    #[arg(long, conflicts_with = "dry_run")]
    pub demo: bool,
    /// End with an error if no autopilot is heard in this many seconds; 0 waits forever.
    #[arg(long, value_name = "N", default_value = "60", value_parser = number(0.0, 1e6))]
    pub wait: f64,
    /// Stop after this many seconds [default: run until Ctrl-C].
    #[arg(long, value_name = "N", value_parser = number(0.0, 1e6))]
    pub seconds: Option<f64>,
    /// Do not show changes of state.
    #[arg(skip)]
    pub quiet: bool,
    /// Runs the demo in real time.
    #[arg(skip)]
    pub is_real_time: bool,
}

/// The vehicles of this process at one moment, in the order of the configuration.
#[derive(Clone, Copy)]
pub struct Sight<'a> {
    pub(crate) vehicles: &'a [Vehicle],
    pub(crate) config: &'a Config,
    /// Time since the start.
    pub(crate) now: Duration,
}

struct Link {
    trouble: Option<String>,
    signing: Option<Signing>,
    is_end_told: bool,
}

struct Companions<'a> {
    config: &'a Config,
    machine: Box<dyn Machine>,
    links: Vec<Link>,
    next_look: Duration,
    vehicles: Vec<Vehicle>,
    roll: Roll,
    options: &'a Options,
    log_error: Option<record::Error>,
    output_error: Option<io::Error>,
    has_said_farewell: bool,
}

/// Runs the companions of a configuration until the time is over or `is_wanted` returns false.
/// `look` observes them between two steps and must be fast. `tlog` gets all sent and accepted
/// messages.
///
/// A log that cannot be written does not end the run. At any end, controlled vehicles stop.
///
/// # Errors
/// A key, link or network cannot be opened at the start, no autopilot is heard in the time that the
/// options set, or standard output fails in a dry run.
pub fn run(
    config: &Config,
    options: &Options,
    tlog: Option<Tlog>,
    is_wanted: impl Fn() -> bool,
    mut look: impl FnMut(&Sight<'_>),
) -> Result<CompanionReport> {
    let seal = config.key.as_deref().map(Seal::read).transpose()?;
    let link_key = config.link_key.as_deref().map(KeyFile::read).transpose()?;
    let remarks = [seal.as_ref().map(|seal| &seal.remark), link_key.as_ref().map(|file| &file.remark)];
    remarks.into_iter().flatten().flatten().for_each(|remark| say(remark));
    let boot = if options.demo { 0 } else { fresh_boot() };
    let machine: Box<dyn Machine> = if options.demo {
        Box::new(Demo::new(config, tlog, options.is_real_time))
    } else {
        Box::new(Host {
            lines: Lines::open(&config.lines)?,
            medium: Medium::open(&config.air)?,
            tlog,
            key: seal.as_ref().map(Seal::watch),
            began: Instant::now(),
        })
    };
    let link_key = link_key.filter(|_| !options.demo);
    let mut companions = Companions::new(config, options, seal.as_ref(), link_key, machine, boot);
    let (seconds, interrupted) = companions.run(is_wanted, &mut look);
    if let Some(error) = companions.no_autopilot() {
        companions.has_said_farewell = true;
        return Err(error);
    }
    companions.say_farewell();
    companions.close_log();
    match companions.output_error.take() {
        Some(error) => bail!("cannot write to standard output: {error}"),
        None => Ok(companions.report(seconds, interrupted)),
    }
}

/// A dry run cannot request a position rate, so it accepts older positions.
fn rules(setup: &VehicleSetup, options: &Options) -> Rules {
    let Rules { stale, .. } = setup.rules;
    let stale = if options.dry_run { stale.max(SELDOM) } else { stale };
    Rules { rehearses: options.dry_run, stale, ..setup.rules }
}

impl<'a> Companions<'a> {
    fn new(
        config: &'a Config,
        options: &'a Options,
        seal: Option<&Seal>,
        link_key: Option<KeyFile>,
        machine: Box<dyn Machine>,
        boot: u8,
    ) -> Self {
        let ground = Arc::new(PlaneGround::new(&config.scenario, &config.plane));
        let format = config.scenario.radio.format;
        let link = |number: usize| Link {
            trouble: None,
            signing: link_key.as_ref().map(|file| Signing::new(file.key.clone(), number as u8, key::timestamp())),
            is_end_told: false,
        };
        let vehicle = |setup: &VehicleSetup| Vehicle {
            setup: setup.clone(),
            offboard: OffboardStateMachine::new(setup.system, setup.kind, rules(setup, options)),
            controller: Controller::new(
                &config.scenario,
                &ground,
                setup.index,
                boot,
                config.error_m,
                seal.map_or_else(|| HostWire::new(format), |seal| seal.wire(format)),
            ),
            peer: None,
            twins: Twins::default(),
            first_heard: None,
            has_mavlink_2: false,
            is_version_told: false,
            is_signing_told: false,
            sender: Sender { system: setup.system, component: COMPONENT, sequence: 0 },
            shown: None,
            inbox: Vec::new(),
            next_step: Duration::ZERO,
            has_arrived: false,
            is_far: false,
            heard: 0,
            refused: 0,
        };
        Companions {
            config,
            machine,
            links: (0..config.lines.len()).map(link).collect(),
            next_look: Duration::ZERO,
            vehicles: config.vehicles.iter().map(vehicle).collect(),
            roll: Roll::new(config.overlap, seal.is_some_and(Seal::has_old)),
            options,
            log_error: None,
            output_error: None,
            has_said_farewell: false,
        }
    }

    /// Returns the duration in seconds, and whether the run was interrupted.
    fn run(&mut self, is_wanted: impl Fn() -> bool, look: &mut dyn FnMut(&Sight<'_>)) -> (f64, bool) {
        let limit = self.options.seconds.or(self.options.demo.then_some(DEMO_S)).map(Duration::from_secs_f64);
        let mut interrupted = false;
        while limit.is_none_or(|limit| self.now() < limit) && self.output_error.is_none() {
            let is_done = self.options.demo && self.vehicles.iter().all(|vehicle| vehicle.has_arrived);
            if is_done || self.no_autopilot().is_some() {
                break;
            }
            if !is_wanted() {
                interrupted = true;
                break;
            }
            self.turn();
            look(&Sight { vehicles: &self.vehicles, config: self.config, now: self.now() });
        }
        (self.now().as_secs_f64(), interrupted)
    }

    /// The error if all autopilots have been silent for too long since the start.
    fn no_autopilot(&self) -> Option<anyhow::Error> {
        let wait = Some(self.options.wait).filter(|&wait| wait > 0.0 && self.now().as_secs_f64() >= wait)?;
        let is_silent = self.vehicles.iter().all(|vehicle| vehicle.offboard.tally().heartbeats == 0);
        let links = self.links.iter().zip(&self.config.lines).enumerate().map(|(line, (link, endpoint))| {
            let junk = self.machine.lines().map_or(0, |lines| lines.counts(line).junk_bytes);
            match &link.trouble {
                Some(why) => format!("{endpoint} ({why})"),
                None if junk > 0 => format!("{endpoint} ({junk} bytes that are not MAVLink: check the baud rate)"),
                None => endpoint.to_string(),
            }
        });
        is_silent.then(|| {
            anyhow!(
                "no autopilot heard within {wait} s on {}; start the vehicles or correct `link`, wait longer with \
                 --wait N (0: forever), or try --demo, which simulates the vehicles",
                links.collect::<Vec<_>>().join(", ")
            )
        })
    }

    fn now(&self) -> Duration {
        self.machine.now()
    }

    fn turn(&mut self) {
        let now = self.now();
        let due = |vehicle: &Vehicle| vehicle.next_step.min(vehicle.offboard.due(now));
        let due = self.vehicles.iter().map(due).min().unwrap_or_default();
        let glance = match self.config.air {
            MediumSetup::Multicast { .. } | MediumSetup::Peers { .. } => LAN_GLANCE,
            MediumSetup::Here | MediumSetup::Tunnel => GLANCE,
        };
        let mut wait = due.saturating_sub(now).min(glance);
        // Limited, so that a flood of frames does not block the loop.
        for _ in 0..1024 {
            let Some(received) = self.machine.receive(wait) else {
                break;
            };
            wait = Duration::ZERO;
            self.hear(&received);
        }
        let vehicles = &mut self.vehicles;
        self.machine.hear_others(&mut |frames| {
            for vehicle in &mut *vehicles {
                vehicle.listen(frames);
            }
        });
        self.look_at_links(now);
        self.look_at_timestamps();
        self.roll_key(now);
        for index in 0..self.vehicles.len() {
            self.step(index);
            self.poll(index);
        }
    }

    fn roll_key(&mut self, now: Duration) {
        let turn = match self.machine.new_key() {
            None => self.roll.turn(now),
            Some(Ok(key)) => Some(self.roll.begin(now, key)),
            Some(Err(error)) => return self.say(&format!("staya: {error}; the previous key stays in use")),
        };
        let Some(turn) = turn else { return };
        for vehicle in &mut self.vehicles {
            self.roll.apply(&turn, vehicle.controller.wire_mut());
        }
        self.say(match turn {
            Turn::Hear(_) => "staya: new key: accepted; sending with the old key",
            Turn::Speak => "staya: new key: sending with it; the old key is still accepted",
            Turn::Forget => "staya: old key no longer accepted",
        });
    }

    fn log(&mut self, frame: &[u8]) {
        if let Err(error) = self.machine.log(frame)
            && self.log_error.is_none()
        {
            self.log_fails(error);
        }
    }

    fn log_fails(&mut self, error: record::Error) {
        self.say(&format!("staya: {error}; continuing without a log"));
        self.log_error = Some(error);
        for index in 0..self.vehicles.len() {
            self.send(index, &status_text("staya: the log cannot be written", true));
        }
    }

    fn close_log(&mut self) {
        if let Err(error) = self.machine.close_log()
            && self.log_error.is_none()
        {
            self.log_fails(error);
        }
    }

    fn hear(&mut self, received: &Received) {
        let Some(frame) = RawFrame::new(&received.frame) else { return };
        let signing = self.links[received.line].signing.as_mut();
        let is_open = signing.is_none();
        let is_refused = signing.is_some_and(|signing| {
            signing.advance_to(key::timestamp());
            !signing.verify(&frame).is_accepted()
        });
        if is_refused || (is_open && frame.signature().is_some()) {
            self.tell_of_signing(received.line, frame.sender(), is_open);
        }
        if is_refused {
            return;
        }
        self.log(frame.bytes());
        let Some(message) = frame.message() else { return };
        if let Some(lines) = self.machine.lines() {
            lines.believe(received.line, received.peer);
        }
        let (sender, now) = (frame.sender(), self.now());
        if let MavMessage::TUNNEL(tunnel) = &message {
            // Packets of other companions. Own packets may return.
            let is_own = sender.component == COMPONENT
                && self.vehicles.iter().any(|vehicle| vehicle.setup.system == sender.system);
            if let Some(frames) = tunnelled(tunnel).filter(|_| !is_own) {
                for vehicle in &mut self.vehicles {
                    vehicle.listen(frames);
                }
            }
            return;
        }
        let found = self
            .vehicles
            .iter_mut()
            .find(|vehicle| (vehicle.setup.line, vehicle.setup.system) == (received.line, sender.system));
        let Some(vehicle) = found.filter(|_| sender.component == MAV_COMP_ID_AUTOPILOT1) else { return };
        if vehicle.first_heard.is_none() && self.machine.lines().is_some() {
            vehicle.offboard.listen_until(now + LISTEN);
        }
        vehicle.first_heard.get_or_insert(now);
        vehicle.has_mavlink_2 |= frame.version() == 2;
        vehicle.peer = Some(received.peer);
        let (robot, evidence) = (vehicle.setup.robot, vehicle.twins.hear(received.peer, &message, now));
        vehicle.offboard.set_ambiguous(vehicle.twins.are_two(), now);
        if !vehicle.twins.are_two() {
            vehicle.offboard.hear(&message, now);
        }
        if let Some(evidence) = evidence {
            self.tell_of_twins(robot, received.line, evidence);
        }
    }

    fn step(&mut self, index: usize) {
        let (now, tick) = (self.now(), Duration::from_micros(self.config.scenario.tick_us.into()));
        let vehicle = &mut self.vehicles[index];
        if now < vehicle.next_step {
            return;
        }
        // The agent's clock advances by whole ticks. Missed ticks are skipped.
        let missed = now.saturating_sub(vehicle.next_step).as_micros() / tick.as_micros().max(1);
        let moment = vehicle.next_step + tick * u32::try_from(missed).unwrap_or(u32::MAX);
        vehicle.next_step = moment + tick;
        let body = vehicle.body(self.config, now);
        let is_far =
            vehicle.offboard.fix().is_some() && !body.is_some_and(|body| is_within(&body, self.config.reach_m));
        let is_news = is_far && !vehicle.is_far;
        vehicle.is_far = is_far;
        if is_news {
            self.tell(index, "too far from the origin (rules.reach_m)");
        }
        let vehicle = &mut self.vehicles[index];
        // Outside the map of the swarm the vehicle sends no beacons.
        let Some(body) = body else {
            vehicle.inbox.clear();
            return;
        };
        let steers = vehicle.offboard.state() == State::Steering && !is_far;
        if let AnyWire::Signed(signed) = vehicle.controller.wire_mut() {
            // A companion that starts later must not take the packet for a replay.
            signed.signing_mut().advance_to(key::timestamp());
        }
        let out = vehicle.controller.step(&body, steers, &vehicle.inbox, moment);
        vehicle.inbox.clear();
        vehicle.heard += u64::from(out.received);
        vehicle.refused += u64::from(out.rejected);
        let (said, events) = (out.outbox.clone(), out.events.clone());
        if steers {
            let velocity = ned(vehicle.controller.velocity_mps());
            vehicle.offboard.steer(velocity, now);
            let is_there = vehicle.controller.agent().mode() == Mode::Arrived;
            if is_there && !vehicle.has_arrived {
                self.tell(index, "arrived");
            }
            self.vehicles[index].has_arrived = is_there;
        }
        for event in events {
            self.tell_of(index, event);
        }
        self.speak(index, &said);
    }

    fn speak(&mut self, index: usize, said: &[u8]) {
        if said.is_empty() {
            return;
        }
        for (other, vehicle) in self.vehicles.iter_mut().enumerate() {
            if other != index {
                vehicle.listen(said);
            }
        }
        if !self.options.dry_run {
            self.machine.tell_others(said);
        }
        if self.config.air == MediumSetup::Tunnel {
            let messages = tunnel(self.vehicles[index].controller.wire_mut(), said);
            messages.iter().for_each(|message| self.send(index, message));
        }
    }

    fn poll(&mut self, index: usize) {
        let now = self.now();
        let mut messages = Vec::new();
        self.vehicles[index].offboard.poll(now, &mut messages);
        while let Some(event) = self.vehicles[index].offboard.event() {
            self.tell(index, &event.to_string());
            if let Event::State(to) = event {
                let text = format!("staya: {}", to.words());
                messages.push(status_text(&text, to.is_worrying()));
            }
        }
        for message in &messages {
            self.send(index, message);
        }
    }

    fn send(&mut self, index: usize, message: &MavMessage) {
        if self.options.dry_run {
            return self.show(index, message);
        }
        let vehicle = &mut self.vehicles[index];
        let line = vehicle.setup.line;
        let mut signing = self.links[line].signing.as_mut();
        if let Some(signing) = &mut signing {
            signing.advance_to(key::timestamp());
        }
        // Autopilots reject unsigned frames, so a frame that cannot be signed is not sent.
        let Some(frame) = framed(&mut vehicle.sender, message, signing) else { return };
        self.machine.send(line, vehicle.peer, &frame);
        self.log(&frame);
    }

    fn say_farewell(&mut self) {
        self.has_said_farewell = true;
        let (times, pause) = FAREWELLS;
        for _ in 0..times {
            let now = self.now();
            for index in 0..self.vehicles.len() {
                if let Some(message) = self.vehicles[index].offboard.farewell(now) {
                    self.send(index, &message);
                }
            }
            self.machine.pause(pause);
        }
    }
}

impl Drop for Companions<'_> {
    fn drop(&mut self) {
        // Vehicles must stop even after a panic.
        if !self.has_said_farewell {
            self.say_farewell();
        }
    }
}

#[cfg(test)]
mod tests;
