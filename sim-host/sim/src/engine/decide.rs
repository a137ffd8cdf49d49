//! The first phase of a tick: the robots that are due decide, in parallel.

use super::clock::Timing;
use super::ground::{Ground, Senses};
use super::{BATCH, Engine, OnboardComputer, Status, WIDE};
use crate::radio::{Inbox, Radio};
use crate::record::PacketCounts;
use crate::world::plane::CommandAge;
use rayon::prelude::*;
use staya_controller::agent::{AnyInputs, Command, GridWorkspace, Inputs, Outputs};
use staya_controller::neighbor::Sighting;
use staya_controller::robot::RobotId;
use staya_controller::wire::Frame;

/// Inputs that all decisions of a tick have in common.
pub(super) struct Tick<'a> {
    pub(super) tick: u32,
    pub(super) ground: &'a dyn Ground,
    pub(super) radio: &'a Radio,
    /// Frames of the operator to all robots.
    pub(super) orders: &'a [u8],
}

impl Tick<'_> {
    /// Received bytes, behind the decoded frames.
    pub(super) fn inbox<'b>(&'b self, index: usize, computer: &OnboardComputer) -> Inbox<'b> {
        let inbox = self.radio.inbox(index);
        // Frames that arrived while it was down are lost.
        let has_just_restarted = computer.starts > 0 && computer.clock.epoch == self.tick;
        if has_just_restarted { inbox.cleared() } else { inbox }
    }

    /// This tick's arrivals for a decision: frames, their length in bytes, and the bytes behind
    /// them. If earlier bytes wait, all arrivals are bytes, so that their order stays.
    pub(super) fn delivered<'b>(
        &'b self,
        index: usize,
        computer: &OnboardComputer,
    ) -> (impl Iterator<Item = &'b Frame> + use<'b>, usize, impl Iterator<Item = &'b [u8]> + use<'b>) {
        let inbox = self.inbox(index, computer);
        let has_earlier = self.has_earlier(computer);
        let (frames, skipped) = if has_earlier { (0, 0) } else { (usize::MAX, inbox.packets()) };
        let frame_bytes = if has_earlier { 0 } else { inbox.frame_bytes() };
        (inbox.frames().take(frames), frame_bytes, inbox.pieces().skip(skipped))
    }

    /// Whether ticks have passed since the last decision, whose bytes wait.
    fn has_earlier(&self, computer: &OnboardComputer) -> bool {
        computer.clock.since(self.tick) > 1
    }

    /// The inputs with these received bytes and the orders behind them, in the order of arrival.
    pub(super) fn inputs<'b, 'c>(
        &'b self,
        index: usize,
        computer: &OnboardComputer,
        senses: &'b mut Senses,
        delivered: impl Iterator<Item = &'c [u8]>,
        heard: &'b mut Vec<u8>,
    ) -> AnyInputs<'b, f32> {
        let has_earlier = self.has_earlier(computer);
        heard.clear();
        heard.extend_from_slice(if has_earlier { &computer.mail } else { &[] });
        delivered.for_each(|bytes| heard.extend_from_slice(bytes));
        heard.extend_from_slice(self.orders);
        heard.extend_from_slice(if has_earlier { &[] } else { &computer.mail });
        Inputs { inbox: heard, ..self.ground.sense(index, self.tick, senses) }
    }
}

/// Buffers of a thread, and settings of all robots.
struct Scratch<'a> {
    timing: &'a Timing,
    is_mute: bool,
    keeps_events: bool,
    workspace: GridWorkspace<WIDE>,
    senses: Senses,
    heard: Vec<u8>,
    seen: Vec<Sighting<f32>>,
    out: Outputs<f32>,
}

impl Tick<'_> {
    /// Stores the arrivals of a tick in which the robot is not due.
    fn wait(&self, index: usize, computer: &mut OnboardComputer) {
        let inbox = self.inbox(index, computer);
        inbox.pieces().for_each(|bytes| computer.mail.extend_from_slice(bytes));
        computer.mail.extend_from_slice(self.orders);
    }

    fn decide(
        &self,
        (index, robot): (usize, RobotId),
        computer: &mut OnboardComputer,
        (command, status): (&mut Command<f32>, &mut Status),
        scratch: &mut Scratch<'_>,
    ) -> PacketCounts {
        let Scratch { timing, is_mute, keeps_events, workspace, senses, heard, seen, out } = scratch;
        let now = computer.clock.now(self.tick, robot, timing);
        let (frames, frame_bytes, pieces) = self.delivered(index, computer);
        let inputs = self.inputs(index, computer, senses, pieces, heard);
        let heard_bytes = frame_bytes + inputs.inbox.len();
        let Some(agent) = &mut computer.agent else {
            return PacketCounts::default();
        };
        self.ground.sightings(index, self.tick, computer.clock.since(self.tick), seen);
        if !seen.is_empty() {
            let _ = agent.see(seen, &inputs.state, now);
        }
        agent.hear_decoded_into(frames, &inputs, now, out);
        agent.act_into(&inputs, now, workspace, out);
        if *is_mute {
            out.outbox.clear();
        }
        computer.heard_bytes += heard_bytes as u64;
        computer.sent_bytes += out.outbox.len() as u64;
        // Beacons have similar lengths, so the buffer does not need spare capacity.
        computer.outbox.reserve_exact(out.outbox.len());
        computer.outbox.extend_from_slice(&out.outbox);
        computer.mail.clear();
        if *keeps_events {
            computer.events.extend_from_slice(&out.events);
        }
        command.clone_from(&out.command);
        *status = Status {
            mode: agent.mode(),
            leader: agent.leader(),
            target: agent.target().unwrap_or(status.target),
            wait: out.wait,
        };
        computer.clock.decide(self.tick, robot, timing);
        PacketCounts::refused(out.rejected, out.refused, out.implausible)
    }
}

impl Engine {
    pub(super) fn decide_here(&mut self) -> PacketCounts {
        let (tick, is_mute, keeps_events) = (self.tick, self.is_mute, self.operator.is_some());
        let (robots, here, timing) = (&self.robots, &self.here, &self.timing);
        let orders = self.ground.view(tick).orders;
        let moment = Tick { tick, ground: &*self.ground, radio: &self.radio, orders };
        let scratch = || Scratch {
            timing,
            is_mute,
            keeps_events,
            workspace: GridWorkspace::default(),
            senses: Senses::default(),
            heard: Vec::new(),
            seen: Vec::new(),
            out: Outputs::default(),
        };
        let commands = (&mut self.commands, &mut self.ages);
        let work = (&mut self.computers, commands, &mut self.statuses, &mut self.positions_m);
        work.into_par_iter()
            .enumerate()
            .with_min_len(BATCH)
            .map_init(scratch, |scratch, (index, (computer, (command, age), status, position_m))| {
                *position_m = moment.ground.motion(index, tick).position_m;
                computer.outbox.clear();
                computer.events.clear();
                if tick < computer.down_until {
                    (*command, *age) = (Command::Hold, CommandAge::Expired);
                    computer.mail.clear();
                    status.fall_silent();
                    return PacketCounts::default();
                }
                if computer.agent.is_none() {
                    // An external controller decides in each tick.
                    (*command, *age) = (Command::Hold, CommandAge::New);
                    return PacketCounts::default();
                }
                let mut counts = PacketCounts::default();
                if computer.clock.is_due(tick) {
                    let robot = robots[here[index] as usize].id;
                    counts = moment.decide((index, robot), computer, (command, status), scratch);
                } else {
                    moment.wait(index, computer);
                }
                *age = computer.clock.age(tick, timing);
                if *age == CommandAge::Expired {
                    *command = Command::Hold;
                }
                counts
            })
            .reduce(PacketCounts::default, |one, other| one + other)
    }
}
