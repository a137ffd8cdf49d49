//! The loop around companions: frames in, steps of agents and duties when they are due, frames out.

use super::config::{Config, VehicleSetup};
use super::controller::{Body, Controller};
use super::medium::{Medium, MediumError, tunnel, tunnelled};
use super::offboard::{AUTOPILOT, COMPONENT, Event, OffboardStateMachine, State, status_text};
use super::report::{CompanionReport, LineReport, VehicleReport};
use super::seal::{Seal, SealError};
use crate::geo::{Origin, enu, ned};
use crate::{Lines, OpenError, Peer, Received, Tlog, TlogError};
use staya_controller::agent::Event as AgentEvent;
use staya_controller::robot::Mode;
use staya_mavlink::any::AnyWire;
use staya_mavlink::dialect::MavMessage;
use staya_mavlink::frame::{MAX_FRAME_LEN, RawFrame, Sender, encode_message};
use staya_mavlink::signing::Signing;
use staya_sim::engine::PlaneGround;
use staya_sim::key::{self, KeyError, KeyFile};
use staya_sim::radio::HostWire;
use std::io::{self, Write as _};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Longest wait for a frame when packets may come from the LAN meanwhile, and else.
const GLANCES: [Duration; 2] = [Duration::from_millis(5), Duration::from_millis(20)];
/// Bytes of packets that wait for an agent's next step; the rest is lost, as on a radio.
const INBOX: usize = 16 * 1024;
/// Setpoints to stand, and the time between them, at the end.
const FAREWELLS: (u32, Duration) = (5, Duration::from_millis(40));

/// What the command line says.
#[derive(Debug, Default)]
pub struct Options {
    /// Show what would be sent, and send nothing.
    pub dry_run: bool,
    /// Show no changes of state.
    pub quiet: bool,
    /// End after so long; `None`: when asked to.
    pub seconds: Option<f64>,
    /// Where all messages of all links go.
    pub tlog: Option<Tlog>,
}

/// Why companions cannot go on.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// A line cannot be opened.
    #[error(transparent)]
    Line(#[from] OpenError),
    /// The LAN cannot be used.
    #[error(transparent)]
    Medium(#[from] MediumError),
    /// The key of packets cannot be used.
    #[error(transparent)]
    Seal(#[from] SealError),
    /// The key of links cannot be had.
    #[error(transparent)]
    Key(#[from] KeyError),
    /// The log cannot be written.
    #[error(transparent)]
    Tlog(#[from] TlogError),
    /// What would be sent cannot be shown.
    #[error("cannot write to standard output: {0}")]
    Output(io::Error),
}

/// A vehicle and its companion.
struct Vehicle {
    setup: VehicleSetup,
    /// How fast it can be, m/s.
    max_speed_mps: f64,
    offboard: OffboardStateMachine,
    controller: Controller<HostWire>,
    /// Where its autopilot was heard.
    peer: Option<Peer>,
    sequence: u8,
    inbox: Vec<u8>,
    next_step: Duration,
    has_arrived: bool,
    /// It is so far from the origin that it is not steered.
    is_far: bool,
    heard: u64,
    refused: u64,
}

struct Companions<'a> {
    origin: Origin,
    reach_m: f64,
    error_m: f64,
    tick: Duration,
    lines: Lines,
    medium: Medium,
    vehicles: Vec<Vehicle>,
    /// One for each line, with a key for links.
    signing: Option<Vec<Signing>>,
    wire: AnyWire,
    options: &'a mut Options,
    began: Instant,
}

/// Runs the companions of a configuration until the time is over or `is_wanted` says no.
///
/// # Errors
/// What cannot be opened or written; an autopilot that is not there is none.
pub fn run(config: &Config, options: &mut Options, is_wanted: impl Fn() -> bool) -> Result<CompanionReport, RunError> {
    let ground = Arc::new(PlaneGround::new(&config.scenario, &config.plane));
    let boot = (micros_since_1970() >> 20) as u8;
    let format = config.scenario.radio.format;
    let seal = config.key.as_deref().map(Seal::read).transpose()?;
    let link_key = config.link_key.as_deref().map(KeyFile::read).transpose()?;
    let remarks =
        [seal.as_ref().and_then(|seal| seal.remark.as_ref()), link_key.as_ref().and_then(|file| file.remark.as_ref())];
    for remark in remarks.into_iter().flatten() {
        // A closed standard error must not stop it.
        let _ = writeln!(io::stderr(), "staya: {remark}");
    }
    let signing = link_key.map(|file| {
        let line = |link| Signing::new(file.key.clone(), link, key::timestamp());
        (0..=u8::MAX).map(line).take(config.lines.len()).collect()
    });
    let vehicle = |setup: &VehicleSetup| Vehicle {
        setup: setup.clone(),
        max_speed_mps: config.plane.group(setup.index).abilities.max_speed_mps,
        offboard: OffboardStateMachine::new(setup.system, setup.kind, setup.rules),
        controller: Controller::new(
            &config.scenario,
            &ground,
            setup.index,
            boot,
            config.lag_s,
            seal.as_ref().map_or_else(|| HostWire::new(format), |seal| seal.wire(format)),
        ),
        peer: None,
        sequence: 0,
        inbox: Vec::new(),
        next_step: Duration::ZERO,
        has_arrived: false,
        is_far: false,
        heard: 0,
        refused: 0,
    };
    let mut companions = Companions {
        origin: config.origin,
        reach_m: config.reach_m,
        error_m: config.error_m,
        tick: Duration::from_micros(config.scenario.tick_us.into()),
        lines: Lines::open(&config.lines)?,
        medium: Medium::open(&config.air)?,
        vehicles: config.vehicles.iter().map(vehicle).collect(),
        signing,
        wire: AnyWire::new(format),
        options,
        began: Instant::now(),
    };
    let limit = companions.options.seconds.map(Duration::from_secs_f64);
    let mut interrupted = false;
    while limit.is_none_or(|limit| companions.now() < limit) {
        if !is_wanted() {
            interrupted = true;
            break;
        }
        companions.turn()?;
    }
    let seconds = companions.now().as_secs_f64();
    companions.say_farewell()?;
    let report = companions.report(config, seconds, interrupted);
    if let Some(tlog) = options.tlog.take() {
        tlog.finish()?;
    }
    Ok(report)
}

/// Whether a body is so near the origin, along the ground.
fn is_within(body: &Body, reach_m: f64) -> bool {
    let [x, y, _] = body.position_m;
    x * x + y * y <= reach_m * reach_m
}

fn micros_since_1970() -> u128 {
    let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
    now.map_or(0, |time| time.as_micros())
}

impl Companions<'_> {
    fn now(&self) -> Duration {
        self.began.elapsed()
    }

    /// Waits for a frame until something is due, then does all that is.
    fn turn(&mut self) -> Result<(), RunError> {
        let now = self.now();
        let due = |vehicle: &Vehicle| vehicle.next_step.min(vehicle.offboard.due(now));
        let due = self.vehicles.iter().map(due).min().unwrap_or_default();
        let [lan, else_] = GLANCES;
        let glance = if self.medium.is_lan() { lan } else { else_ };
        let mut wait = due.saturating_sub(now).min(glance);
        // What has come in meanwhile, but not what a flood would bring in.
        for _ in 0..1024 {
            let Some(received) = self.lines.receive(wait) else {
                break;
            };
            wait = Duration::ZERO;
            self.hear(&received)?;
        }
        let vehicles = &mut self.vehicles;
        self.medium.receive(|frames| {
            for vehicle in &mut *vehicles {
                vehicle.listen(frames);
            }
        });
        for index in 0..self.vehicles.len() {
            self.step(index)?;
            self.poll(index)?;
        }
        Ok(())
    }

    fn signing_of(&mut self, line: usize) -> Option<&mut Signing> {
        self.signing.as_mut()?.get_mut(line)
    }

    fn log(&mut self, frame: &[u8]) -> Result<(), RunError> {
        if let Some(tlog) = &mut self.options.tlog {
            tlog.add(frame)?;
        }
        Ok(())
    }

    fn hear(&mut self, received: &Received) -> Result<(), RunError> {
        let Some(frame) = RawFrame::new(&received.frame) else {
            return Ok(());
        };
        self.log(frame.bytes())?;
        if let Some(signing) = self.signing_of(received.line)
            && !signing.verify(&frame).is_accepted()
        {
            return Ok(());
        }
        let Some(message) = frame.message() else {
            return Ok(());
        };
        let (sender, now) = (frame.sender(), self.now());
        if let MavMessage::TUNNEL(tunnel) = &message {
            // What others say through the links. Own packets may come back.
            let is_own = sender.component == COMPONENT
                && self.vehicles.iter().any(|vehicle| vehicle.setup.system == sender.system);
            if let Some(frames) = tunnelled(tunnel).filter(|_| !is_own) {
                for vehicle in &mut self.vehicles {
                    vehicle.listen(frames);
                }
            }
            return Ok(());
        }
        let found = self
            .vehicles
            .iter_mut()
            .find(|vehicle| (vehicle.setup.line, vehicle.setup.system) == (received.line, sender.system));
        if let Some(vehicle) = found.filter(|_| sender.component == AUTOPILOT) {
            vehicle.peer = Some(received.peer);
            vehicle.offboard.hear(&message, now);
        }
        Ok(())
    }

    /// The agent's step, if it is due.
    fn step(&mut self, index: usize) -> Result<(), RunError> {
        let (now, tick) = (self.now(), self.tick);
        let vehicle = &mut self.vehicles[index];
        if now < vehicle.next_step {
            return Ok(());
        }
        // The agent's clock goes in whole ticks, whatever the system's timers do; what was slept through is left out.
        let missed = now.saturating_sub(vehicle.next_step).as_micros() / tick.as_micros().max(1);
        let moment = vehicle.next_step + tick * u32::try_from(missed).unwrap_or(u32::MAX);
        vehicle.next_step = moment + tick;
        let body = vehicle.body(&self.origin, self.error_m, now);
        let is_far = vehicle.offboard.fix().is_some() && !body.is_some_and(|body| is_within(&body, self.reach_m));
        let is_news = is_far && !vehicle.is_far;
        vehicle.is_far = is_far;
        if is_news {
            self.tell(index, "is too far from the origin (rules.reach_m): not steered");
        }
        let vehicle = &mut self.vehicles[index];
        // Who has no place in the swarm's world has nothing to say.
        let Some(body) = body else {
            vehicle.inbox.clear();
            return Ok(());
        };
        let steers = vehicle.offboard.state() == State::Steering && !is_far;
        if let AnyWire::Signed(signed) = vehicle.controller.wire_mut() {
            // So that who starts later does not take it for a recording.
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
            let is_there = vehicle.controller.mode() == Mode::Arrived;
            if is_there && !vehicle.has_arrived {
                self.tell(index, "arrived");
            }
            self.vehicles[index].has_arrived = is_there;
        }
        for event in events {
            self.tell_of(index, event);
        }
        self.speak(index, &said)
    }

    /// To all other robots, here and elsewhere.
    fn speak(&mut self, index: usize, said: &[u8]) -> Result<(), RunError> {
        if said.is_empty() {
            return Ok(());
        }
        for (other, vehicle) in self.vehicles.iter_mut().enumerate() {
            if other != index {
                vehicle.listen(said);
            }
        }
        if !self.options.dry_run {
            self.medium.send(said);
        }
        if self.medium.is_tunnel() {
            for message in tunnel(&self.wire, said) {
                self.send(index, &message)?;
            }
        }
        Ok(())
    }

    /// The duties, if they are due.
    fn poll(&mut self, index: usize) -> Result<(), RunError> {
        let now = self.now();
        let mut messages = Vec::new();
        self.vehicles[index].offboard.poll(now, &mut messages);
        while let Some(event) = self.vehicles[index].offboard.event() {
            self.tell(index, &event.to_string());
            if let Event::State { to, .. } = event {
                let text = format!("staya: {}", to.words());
                messages.push(status_text(&text, to.is_worrying()));
            }
        }
        for message in &messages {
            self.send(index, message)?;
        }
        Ok(())
    }

    /// Sends a message to a vehicle's autopilot, or shows it.
    fn send(&mut self, index: usize, message: &MavMessage) -> Result<(), RunError> {
        let vehicle = &mut self.vehicles[index];
        let sender = Sender { system: vehicle.setup.system, component: COMPONENT, sequence: vehicle.sequence };
        if self.options.dry_run {
            let (at, robot) = (self.began.elapsed().as_secs_f64(), vehicle.setup.robot.0);
            return writeln!(io::stdout(), "{at:9.3} robot {robot}: {message:?}").map_err(RunError::Output);
        }
        let mut frame = heapless::Vec::<u8, MAX_FRAME_LEN>::new();
        // A frame has room for any message.
        if encode_message(sender, message, &mut frame).is_err() {
            return Ok(());
        }
        vehicle.sequence = vehicle.sequence.wrapping_add(1);
        let (line, peer) = (vehicle.setup.line, vehicle.peer);
        if let Some(signing) = self.signing_of(line) {
            signing.advance_to(key::timestamp());
            // What cannot be signed would not be heard.
            let Ok(signature) = signing.sign(&mut frame) else {
                return Ok(());
            };
            // There is room: see `MAX_FRAME_LEN`.
            let _ = frame.extend_from_slice(&signature);
        }
        match peer {
            Some(peer) => self.lines.send_to(line, peer, &frame),
            None => self.lines.send(line, &frame),
        }
        self.log(&frame)
    }

    /// A line for the person at the terminal.
    fn tell(&self, index: usize, what: &str) {
        if !self.options.quiet {
            let (at, robot) = (self.now().as_secs_f64(), self.vehicles[index].setup.robot.0);
            // A closed standard error must not stop a vehicle's companion.
            let _ = writeln!(io::stderr(), "{at:9.3} robot {robot}: {what}");
        }
    }

    fn tell_of(&self, index: usize, event: AgentEvent) {
        match event {
            AgentEvent::NeighborFound(id) => self.tell(index, &format!("hears robot {}", id.0)),
            AgentEvent::NeighborLost(id) => self.tell(index, &format!("has lost robot {id}")),
            AgentEvent::DuplicateId(id) => self.tell(index, &format!("two robots have number {id}: give one another")),
            AgentEvent::NobodyHeard => self.tell(index, "hears nobody any more"),
            AgentEvent::NoRoute => self.tell(index, "finds no way"),
            AgentEvent::ModeChanged { to: Mode::Fault, .. }
                if self.vehicles[index].offboard.state() == State::Steering =>
            {
                self.tell(index, "stands: it is off the scenario's map, or has no goal");
            }
            _ => {}
        }
    }

    /// Tells those to stand that are steered.
    fn say_farewell(&mut self) -> Result<(), RunError> {
        let (times, pause) = FAREWELLS;
        for _ in 0..times {
            let now = self.now();
            for index in 0..self.vehicles.len() {
                if let Some(message) = self.vehicles[index].offboard.farewell(now) {
                    self.send(index, &message)?;
                }
            }
            std::thread::sleep(pause);
        }
        Ok(())
    }

    fn report(&self, config: &Config, seconds: f64, interrupted: bool) -> CompanionReport {
        let vehicles = self.vehicles.iter().map(|vehicle| VehicleReport {
            robot: vehicle.setup.robot.0,
            system: vehicle.setup.system,
            autopilot: vehicle.setup.kind,
            state: vehicle.offboard.state(),
            agent: vehicle.controller.mode(),
            has_arrived: vehicle.has_arrived,
            position_m: vehicle.offboard.fix().and_then(|fix| self.origin.to_enu_m(&fix.place)),
            tally: vehicle.offboard.tally(),
            packets_heard: vehicle.heard,
            packets_refused: vehicle.refused,
            neighbors: vehicle.controller.neighbors(),
        });
        let links = config.lines.iter().enumerate();
        let links = links.map(|(line, endpoint)| LineReport {
            link: endpoint.to_string(),
            counts: self.lines.counts(line),
            refused: self
                .signing
                .as_ref()
                .and_then(|signing| signing.get(line))
                .map_or(0, |signing| signing.counts().refused()),
        });
        CompanionReport {
            scenario: config.scenario.name.clone(),
            seconds,
            interrupted,
            dry_run: self.options.dry_run,
            vehicles: vehicles.collect(),
            links: links.collect(),
        }
    }
}

impl Vehicle {
    /// Packets for the next step.
    fn listen(&mut self, frames: &[u8]) {
        if self.inbox.len() + frames.len() <= INBOX {
            self.inbox.extend_from_slice(frames);
        }
    }

    /// Where it is by now, and how fast. Whose telemetry is old or not to be believed is somewhere about its last place, the farther off the older that is, up to
    /// `error_m`: told to stop, it has rolled on, or a pilot drives it.
    fn body(&self, origin: &Origin, error_m: f64, now: Duration) -> Option<Body> {
        let last = self.offboard.fix()?;
        let at = origin.to_enu_m(&last.place)?;
        let age_s = now.saturating_sub(last.at).as_secs_f64();
        if self.offboard.fresh_fix(now).is_none() {
            let error_m = (self.max_speed_mps * age_s).min(error_m);
            return Some(Body { position_m: at, velocity_mps: [0.0; 3], error_m });
        }
        let velocity_mps = enu(last.velocity_ned_mps);
        let position_m = [0, 1, 2].map(|axis| at[axis] + velocity_mps[axis] * age_s);
        Some(Body { position_m, velocity_mps, error_m: 0.0 })
    }
}
