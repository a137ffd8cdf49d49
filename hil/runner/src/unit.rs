use crate::answer::{Answer, Cause, FleetError};
use crate::channel::Channel;
use crate::config::{DeviceConfig, Options, Shadow};
use crate::line::{Line, micros};
use crate::mismatch::Mismatch;
use crate::part::Machine;
use crate::printable::printable;
use crate::start::Start;
use crate::statistics::{Collector, Load, Spread, Statistics};
use staya_controller::agent::{AnyInputs, Setup, Task};
use staya_controller::time::Instant;
use staya_link::capacities::Capacities;
use staya_link::frame::TooLong;
use staya_link::message::{Hello, MAX_ANSWER, StepResult, Stepped};
use staya_link::port::{Asked, Counts, Event, Limits, Next, Port, PortError};
use staya_link::robot::Controller;
use staya_link::surroundings::OBSTACLE_BYTES;
use staya_mavlink::any::AnyWire;
use std::io::Write;
use std::time::Duration;

/// 1.5 times the frame length of the largest device.
const REQUEST: usize = 16_384;

#[derive(Debug)]
enum Phase {
    Greeting,
    Configuring,
    Ready,
    /// The shadow has already decided.
    Stepping(Box<Expected>),
    Restarting,
    Failed,
}

#[derive(Debug)]
struct Expected {
    tick: u32,
    result: StepResult,
    sent_us: u64,
}

pub struct Unit {
    config: DeviceConfig,
    channel: Channel,
    port: Box<Port<REQUEST>>,
    program: Option<String>,
    shadows: Vec<Shadow>,
    shadow: Option<Box<dyn Controller + Send>>,
    hello: Option<Hello>,
    there: Line,
    back: Line,
    phase: Phase,
    /// The present start, or the last one.
    start: Start,
    /// Traffic before the outstanding request.
    before: Counts,
    /// Steps for which the robot stays down after a reset.
    down: u32,
    answer: Option<Answer>,
    gone: Option<String>,
    tally: Collector,
    packed: Vec<u8>,
    resend_after: Duration,
    start_limit: Duration,
    step_limit: Duration,
}

impl Unit {
    pub fn new(config: DeviceConfig, channel: Channel, options: &Options, now_us: u64) -> Self {
        let robot = config.setup.agent.id.0;
        let faults = config.faults;
        let mut unit = Self {
            port: Box::new(Port::new(options.run, limits(Duration::ZERO, Duration::ZERO))),
            program: options.program.clone(),
            shadows: options.shadows.clone(),
            shadow: None,
            hello: None,
            there: Line::new(faults, 0, robot),
            back: Line::new(faults, 1, robot),
            phase: Phase::Ready,
            start: Start::new(now_us),
            before: Counts::default(),
            down: 0,
            answer: None,
            gone: None,
            tally: Collector::default(),
            packed: Vec::new(),
            // Delayed in both directions.
            resend_after: options.resend_after + faults.delay * 2,
            start_limit: options.start_limit,
            step_limit: options.step_limit,
            config,
            channel,
        };
        unit.greet(now_us);
        unit
    }

    pub fn robot(&self) -> u32 {
        self.config.setup.agent.id.0
    }

    pub fn process(&self) -> Option<u32> {
        self.channel.emulator.as_ref().map(|emulator| emulator.id())
    }

    /// Sets the timeouts of the request that was just made.
    fn set_limits(&mut self, bytes: usize, limit: Duration) {
        self.before = self.port.counts();
        let bytes = u32::try_from(bytes + MAX_ANSWER).unwrap_or(u32::MAX);
        let line = self.channel.per_byte.saturating_mul(bytes);
        self.port.set_limits(limits(self.resend_after + line, limit));
    }

    fn greet(&mut self, now_us: u64) {
        if !matches!(self.phase, Phase::Greeting | Phase::Configuring) {
            self.start = Start::new(now_us);
        }
        self.port.greet(now_us);
        self.set_limits(0, self.start_limit);
        self.phase = Phase::Greeting;
    }

    pub fn assign(&mut self, setup: Setup, task: Option<Task>, now_us: u64) {
        if matches!(self.phase, Phase::Failed) {
            return;
        }
        let boot = self.config.setup.agent.boot.wrapping_add(1);
        self.config.setup = setup;
        self.config.setup.agent.boot = boot;
        self.config.task = task;
        self.greet(now_us);
    }

    /// The shadow steps at once.
    pub fn send(&mut self, tick: u32, now: Instant, inputs: &AnyInputs<'_, f32>, now_us: u64) {
        if matches!(self.phase, Phase::Failed) {
            self.answer = Some(self.failed(Cause::GivenUp));
            return;
        }
        if !self.is_settled() {
            self.fail(Cause::NotReady);
            return;
        }
        if let Some(reset) = self.config.resets.iter().find(|reset| reset.tick == tick) {
            self.down = reset.down_ticks.max(1);
            self.tally.resets += 1;
            self.port.restart(now_us);
            self.set_limits(0, self.start_limit);
            self.phase = Phase::Restarting;
        }
        if self.down > 0 {
            self.down -= 1;
            self.answer = Some(Answer::Down);
            return;
        }
        if let Err(cause) = self.ask(tick, now, inputs, now_us) {
            self.fail(cause);
            return;
        }
        self.pump(now_us);
    }

    fn ask(&mut self, tick: u32, now: Instant, inputs: &AnyInputs<'_, f32>, now_us: u64) -> Result<(), Cause> {
        let (Some(hello), Some(shadow)) = (&self.hello, &mut self.shadow) else {
            return Err(Cause::NotReady);
        };
        let capacities = hello.capacities;
        let wire: AnyWire = AnyWire::new(self.config.setup.format);
        let (step, cut) = capacities.fit(tick, now, inputs, &wire, &mut self.packed).map_err(Cause::Window)?;
        self.tally.cut_inbox_bytes += cut.inbox_bytes as u64;
        self.tally.cut_obstacles += cut.obstacles as u64;
        shadow.step(&step).map_err(|refusal| Cause::Shadow(refusal.to_string()))?;
        let result = shadow.result().ok_or(Cause::NotReady)?;
        self.port.step(&step, now_us).map_err(|TooLong| Cause::TooLong(REQUEST))?;
        self.set_limits(capacities.frame_bytes(), self.step_limit);
        self.phase = Phase::Stepping(Box::new(Expected { tick, result, sent_us: now_us }));
        Ok(())
    }

    /// `bytes` is empty if the device is gone.
    pub fn arrived(&mut self, bytes: &[u8], at_us: u64) {
        if bytes.is_empty() {
            let emulator = self.channel.emulator.as_mut();
            let epitaph = emulator.and_then(|emulator| emulator.epitaph());
            self.gone = Some(epitaph.unwrap_or_else(|| String::from("the line is closed")));
            return;
        }
        self.back.push(bytes, at_us);
    }

    /// Returns when to call again; `None` if there is nothing to wait for.
    pub fn advance(&mut self, now_us: u64) -> Option<u64> {
        self.hear(now_us);
        if !self.is_settled()
            && self.back.next_us().is_none()
            && let Some(why) = self.gone.take()
        {
            self.fail(Cause::Gone(why));
        }
        let due = self.pump(now_us)?;
        let lines = [self.there.next_us(), self.back.next_us()];
        Some(lines.into_iter().flatten().fold(due, u64::min))
    }

    fn hear(&mut self, now_us: u64) {
        while let Some(due_us) = self.back.next_us() {
            let Some(bytes) = self.back.pop(now_us) else {
                return;
            };
            for byte in bytes {
                match self.port.receive(byte, due_us) {
                    Ok(None) => {}
                    Ok(Some(event)) => self.take(event, due_us),
                    Err(error) => self.fail(Cause::Device(error)),
                }
            }
        }
    }

    /// Returns when to call again; `None` without an outstanding request.
    fn pump(&mut self, now_us: u64) -> Option<u64> {
        let is_greeting = self.port.asked() == Some(Asked::Hello);
        let due = loop {
            if is_greeting && now_us < self.start.next_us() {
                break Some(self.start.next_us());
            }
            match self.port.poll(now_us) {
                Ok(Next::Send(frame)) => {
                    self.there.push(frame, now_us);
                    if is_greeting {
                        self.start.greeted(now_us, micros(self.resend_after));
                    }
                }
                Ok(Next::WaitUntil(due_us)) => break Some(due_us),
                Ok(Next::Idle) => break None,
                Err(error) => {
                    self.fail(self.silence(error));
                    break None;
                }
            }
        };
        while let Some(bytes) = self.there.pop(now_us) {
            // Bytes that cannot be written in time are lost; the reader detects a lost device.
            let _ = self.channel.write.write_all(&bytes);
            let _ = self.channel.write.flush();
        }
        due
    }

    /// Says more about a device that does not answer.
    fn silence(&self, error: PortError) -> Cause {
        let (before, now) = (self.before, self.port.counts());
        let bytes = now.received_bytes.wrapping_sub(before.received_bytes);
        let stale = now.stale.wrapping_sub(before.stale);
        let is_greeting = matches!(error, PortError::Silent { asked: Asked::Hello, .. });
        match stale {
            0 if bytes > 0 => Cause::Junk { error, bytes },
            1.. if is_greeting => Cause::Unheard { error, messages: stale },
            _ => Cause::Device(error),
        }
    }

    fn take(&mut self, event: Event, at_us: u64) {
        if matches!(self.phase, Phase::Failed) {
            return;
        }
        match event {
            Event::Hello(hello) => {
                if let Err(cause) = self.meet(hello, at_us) {
                    self.fail(cause);
                }
            }
            Event::Configured(configured) => {
                let shadow = self.shadow.as_mut();
                let (setup, task) = (&self.config.setup, self.config.task.as_ref());
                match shadow.map(|shadow| shadow.configure(setup, task, &self.config.law)) {
                    Some(Ok(digest)) if digest == configured.digest => self.phase = Phase::Ready,
                    Some(Ok(shadow)) => {
                        let device = configured.digest;
                        self.fail(Cause::Setup { device, shadow });
                    }
                    Some(Err(refusal)) => self.fail(Cause::Shadow(refusal.to_string())),
                    None => self.fail(Cause::NotReady),
                }
            }
            Event::Stepped(stepped) => self.compare(stepped, at_us),
            Event::Restarted => {
                match self.phase {
                    Phase::Stepping(_) => {
                        self.tally.resets += 1;
                        self.answer = Some(Answer::Down);
                    }
                    // Reset right after an answer: the robot is down in the next step.
                    Phase::Ready => {
                        self.tally.resets += 1;
                        self.down = self.down.max(1);
                    }
                    // Already counted: a scheduled reset, or one whose recovery was interrupted.
                    Phase::Restarting | Phase::Failed => {}
                    Phase::Greeting | Phase::Configuring => {
                        self.start.restarts = self.start.restarts.saturating_add(1);
                        if at_us.saturating_sub(self.start.since_us) > micros(self.start_limit) {
                            return self.fail(Cause::Restarts { restarts: self.start.restarts });
                        }
                    }
                }
                self.config.setup.agent.boot = self.config.setup.agent.boot.wrapping_add(1);
                self.greet(at_us);
            }
        }
    }

    fn meet(&mut self, hello: Hello, now_us: u64) -> Result<(), Cause> {
        if let Some(machine @ Machine { part, .. }) = self.channel.machine {
            let numbers = machine.computes_in();
            if hello.part != part.firmware_name() {
                return Err(Cause::OtherPart { expected: part.firmware_name(), said: hello.part.to_string() });
            }
            if hello.number != numbers {
                return Err(Cause::OtherNumbers { expected: numbers.name(), said: hello.number.name() });
            }
        }
        if let Some(expected) = &self.program
            && hello.firmware != expected.as_str()
        {
            return Err(Cause::OtherProgram { expected: expected.clone(), said: hello.firmware.to_string() });
        }
        if self.shadow.is_none() {
            let shadow = shadow(&self.shadows, &hello).ok_or_else(|| Cause::NoShadow(Box::new(hello.clone())))?;
            self.shadow = Some(shadow);
        }
        self.packed = vec![0; usize::from(hello.capacities.obstacles) * OBSTACLE_BYTES];
        self.hello = Some(hello);
        let (setup, task) = (&self.config.setup, self.config.task.as_ref());
        self.port.configure(setup, task, &self.config.law, now_us).map_err(|TooLong| Cause::TooLong(REQUEST))?;
        self.set_limits(REQUEST / 16, self.start_limit);
        self.phase = Phase::Configuring;
        Ok(())
    }

    fn compare(&mut self, stepped: Stepped, at_us: u64) {
        let Phase::Stepping(expected) = std::mem::replace(&mut self.phase, Phase::Ready) else {
            return;
        };
        let narrow = |value: u64| u32::try_from(value).unwrap_or(u32::MAX);
        let round_trip = at_us.saturating_sub(expected.sent_us);
        let tally = &mut self.tally;
        tally.steps += 1;
        tally.round_trip_us.push(narrow(round_trip));
        tally.took(stepped.cost.ticks);
        tally.stack_bytes = tally.stack_bytes.max(stepped.cost.stack_bytes);
        let on_device = stepped.result;
        self.answer = Some(if on_device.is_identical(&expected.result) {
            Answer::Decided(Box::new(on_device))
        } else {
            tally.mismatches += 1;
            Answer::Mismatch(Box::new(Mismatch {
                robot: self.config.setup.agent.id,
                device: self.config.device.clone(),
                has_own_law: !self.config.law.is_empty(),
                tick: expected.tick,
                on_device,
                in_shadow: expected.result,
            }))
        });
    }

    pub fn fail(&mut self, cause: Cause) {
        // Only the first cause is reported; others follow from it.
        if matches!(self.phase, Phase::Failed) {
            return;
        }
        self.phase = Phase::Failed;
        self.answer = Some(self.failed(cause));
    }

    fn failed(&self, cause: Cause) -> Answer {
        Answer::Failed(FleetError {
            robot: self.config.setup.agent.id,
            device: self.config.device.clone(),
            cause: Box::new(cause),
        })
    }

    pub const fn is_down(&self) -> bool {
        self.down > 0
    }

    pub fn is_settled(&self) -> bool {
        matches!(self.phase, Phase::Ready | Phase::Failed)
    }

    /// Takes the answer to the last [`Unit::send`].
    pub fn answer(&mut self) -> Option<Answer> {
        self.answer.take()
    }

    pub fn load(&self) -> Load {
        let is_emulated = self.channel.machine.is_some();
        let clock = self.hello.as_ref().map(|hello| hello.ticks_per_second);
        self.tally.load(clock.filter(|_| is_emulated))
    }

    pub fn statistics(&self) -> Statistics {
        let tally = &self.tally;
        let counts = self.port.counts();
        let text = |of: fn(&Hello) -> &str| printable(self.hello.as_ref().map_or("", of));
        let ticks_per_second = self.hello.as_ref().map_or(0, |hello| hello.ticks_per_second);
        let is_emulated = self.channel.machine.is_some();
        Statistics {
            robot: self.robot(),
            device: self.config.device.clone(),
            part: text(|hello| &hello.part),
            firmware: text(|hello| &hello.firmware),
            steps: tally.steps,
            mismatches: tally.mismatches,
            round_trip_us: Spread::of(&tally.round_trip_us),
            ticks: Spread::of(&tally.ticks),
            ticks_per_second,
            instructions: is_emulated.then(|| tally.instructions(ticks_per_second)).flatten(),
            stack_bytes: tally.stack_bytes,
            resent: counts.resent.into(),
            damaged: counts.damaged.into(),
            resets: tally.resets,
            cut_inbox_bytes: tally.cut_inbox_bytes,
            cut_obstacles: tally.cut_obstacles,
            sent_bytes: counts.sent_bytes,
            received_bytes: counts.received_bytes,
        }
    }
}

fn limits(resend_after: Duration, limit: Duration) -> Limits {
    Limits { resend_after_us: micros(resend_after).max(1), give_up_after_us: micros(limit) }
}

/// Finds the shadow with equal number format and capacities.
fn shadow(shadows: &[Shadow], hello: &Hello) -> Option<Box<dyn Controller + Send>> {
    let is_same = |controller: &dyn Controller| {
        let inbox_bytes = hello.capacities.inbox_bytes;
        let capacities = Capacities { inbox_bytes, ..controller.capacities() };
        controller.number() == hello.number && capacities == hello.capacities
    };
    shadows.iter().map(|shadow| shadow()).find(|controller| is_same(controller.as_ref()))
}
