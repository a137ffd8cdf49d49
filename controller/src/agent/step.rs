//! One step of an agent: [`Agent::step_into`]. Phases are not inlined, so each frees its stack.

use super::contact_loss::ContactState;
use super::link::{Hearing, ReceiveContext, Received, beacon, report};
use super::{
    Action, Agent, AgentConfig, Command, Decision, Event, Inputs, KinematicState, Known, Last, Law, OrderOf, Outgoing,
    Outputs, Perception, Progress, Radio, Report, Safety, SafetyInput, Scene, Surroundings, Tools, View, Wait,
};
use crate::body::Body;
use crate::geom::Vec3;
use crate::grid::{Cell, Dir};
use crate::laws::cells::is_over;
use crate::neighbor::{GapLimit, Nearby, add_lost, nearest};
use crate::rand::Rng;
use crate::robot::Mode;
use crate::safety::is_hindered;
use crate::scalar::Scalar;
use crate::supervisor::{Situation, moves, next_mode};
use crate::time::{Duration, Instant};
use crate::wire::{Frame, Wire};
use heapless::Vec;

const PURPOSE: u32 = u32::from_be_bytes(*b"step");

impl<S: Scalar, L: Law<S>, const N: usize, A: Safety<S>, W: Wire, P: Perception<S>> Agent<S, L, N, A, W, P> {
    /// Runs one step: receive, decide, avoid collisions, send. A pure function of the agent,
    /// `inputs` and `now`.
    ///
    /// Bounded work:
    /// - Receiving: O(frames of the inbox * N).
    /// - Deciding, when free to move: on the grid one search, O((2r + 1)^2), plus one per entry of
    ///   the template with [`Prediction::Reflexive`](crate::formation::Prediction); in the plane
    ///   O(N + obstacles in sight).
    /// - The safety layer: see its documentation.
    /// - Sending: at most [`OUTBOX`](super::OUTBOX) bytes.
    pub fn step(
        &mut self,
        inputs: &Inputs<'_, S, L::Surroundings<'_>>,
        now: Instant,
        workspace: &mut L::Workspace,
    ) -> Outputs<S> {
        let mut out = Outputs::default();
        self.step_into(inputs, now, workspace, &mut out);
        out
    }

    /// Runs [`Agent::step`] into `out`, discarding its contents; saves about 500 bytes of stack.
    pub fn step_into(
        &mut self,
        inputs: &Inputs<'_, S, L::Surroundings<'_>>,
        now: Instant,
        workspace: &mut L::Workspace,
        out: &mut Outputs<S>,
    ) {
        self.hear_into(inputs, now, out);
        self.act_into(inputs, now, workspace, out);
    }

    /// The first half of [`Agent::step_into`]: clears `out` and receives frames and detections.
    pub fn hear_into(&mut self, inputs: &Inputs<'_, S, L::Surroundings<'_>>, now: Instant, out: &mut Outputs<S>) {
        self.hear_decoded_into(core::iter::empty(), inputs, now, out);
    }

    /// [`Agent::hear_into`] with frames that came before the bytes of the inbox, and that its wire
    /// format has already decoded: for a host whose robots hear the same frames. O(frames * N).
    pub fn hear_decoded_into<'f>(
        &mut self,
        frames: impl Iterator<Item = &'f Frame>,
        inputs: &Inputs<'_, S, L::Surroundings<'_>>,
        now: Instant,
        out: &mut Outputs<S>,
    ) {
        out.clear();
        self.hear(frames, inputs, now, out);
        self.merge_sightings(inputs.state.position, now, out);
    }

    /// The second half: decides, avoids collisions and sends. Takes what [`Agent::hear_into`] took,
    /// and its `out`; does not read the inbox.
    pub fn act_into(
        &mut self,
        inputs: &Inputs<'_, S, L::Surroundings<'_>>,
        now: Instant,
        workspace: &mut L::Workspace,
        out: &mut Outputs<S>,
    ) {
        let mut nearby = self.look(inputs, now);
        let mut rng = Rng::keyed(self.config.seed, PURPOSE, self.config.id.0, self.decisions);
        let decision = self.decide(inputs, &nearby, now, &mut rng, workspace, out);
        let before = self.mode;
        self.supervise(inputs, decision.as_ref(), out);
        self.keep_clear(inputs, decision.as_ref(), &mut nearby, (before, now), &mut rng, out);
        self.speak(inputs, (before, now), out);
    }

    #[inline(never)]
    fn look(&self, inputs: &Inputs<'_, S, L::Surroundings<'_>>, now: Instant) -> Vec<Nearby<S>, N> {
        if inputs.surroundings.in_plane().is_none() {
            return Vec::new();
        }
        let (config, inflation) = (&self.config, self.safety.inflation().unwrap_or_default());
        let (known, own, now) = (self.link.table.as_slice(), self.steered(inputs).position, now);
        let mut nearby = nearest(known, config.flock, own, config.radius_m, now, &config.ages, &inflation);
        if config.lag_s > S::ZERO {
            for other in &mut nearby {
                other.offset_m += other.velocity_mps * config.lag_s;
            }
        }
        nearby
    }

    /// The state that laws and the safety layer control. The point ahead of a body with a lag, at
    /// its velocity times the lag, moves exactly as commanded, as a body without a lag does; the
    /// body itself follows it on the straight line. [`GapLimit`] keeps that line free.
    fn steered(&self, inputs: &Inputs<'_, S, L::Surroundings<'_>>) -> KinematicState<S> {
        let state = inputs.state;
        if self.config.lag_s <= S::ZERO {
            return state;
        }
        let position = state.position.moved(self.ahead_m(inputs)).unwrap_or(state.position);
        KinematicState { position, velocity_mps: self.commanded_mps }
    }

    fn ahead_m(&self, inputs: &Inputs<'_, S, L::Surroundings<'_>>) -> Vec3<S> {
        inputs.state.velocity_mps * self.config.lag_s.max(S::ZERO)
    }

    fn body(&self, inputs: &Inputs<'_, S, L::Surroundings<'_>>) -> Body<S> {
        let plane = inputs.surroundings.in_plane();
        Body {
            id: self.config.id,
            velocity_mps: self.steered(inputs).velocity_mps,
            radius_m: self.config.radius_m,
            max_speed_mps: plane.map_or(S::ZERO, |plane| plane.max_speed_mps),
            max_acceleration_mps2: self.config.max_acceleration_mps2,
            step_s: S::from_micro(self.config.tick.as_micros()),
        }
    }

    #[inline(never)]
    fn hear<'f>(
        &mut self,
        mut frames: impl Iterator<Item = &'f Frame>,
        inputs: &Inputs<'_, S, L::Surroundings<'_>>,
        now: Instant,
        out: &mut Outputs<S>,
    ) {
        let body = self.body(inputs);
        let Self { config, law, safety, link, last, .. } = self;
        let leader = law.report().leader;
        let mut outgoing = Outgoing::default();
        // Only a safety layer that tracks silent neighbours needs their last positions.
        let keeps_clear = inputs.surroundings.in_plane().is_some() && safety.inflation().is_some();
        // Frames may have waited since the previous step, and their senders have decided since.
        let tick_us = config.tick.as_micros();
        let late_us = link.listening.elapsed(now, config.tick).as_micros() - tick_us;
        let is_late = keeps_clear && late_us > tick_us >> 3;
        let heard_at = now - config.latency - Duration::from_micros(if is_late { late_us } else { 0 });
        let fastest_mps = safety.inflation().map(|inflation| inflation.growth_mps);
        let fastest_mps = fastest_mps.filter(|fastest| keeps_clear && *fastest > S::ZERO);
        let own = inputs.state.position;
        link.expire(own, &body, now, config, keeps_clear, out);
        let table = &link.table;
        // A robot that was lost at about the same time may be there, or the own radio has failed.
        let is_recent = |at: Instant, heard: Instant| at.since(heard) <= config.ages.expire_after;
        let last_left = |at| table.is_empty() && !table.lost().iter().any(|lost| is_recent(at, lost.heard));
        if keeps_clear && link.contact.passes(now, last_left, config) {
            report(out, Event::ContactLost);
        }
        let mut inbox = inputs.inbox;
        loop {
            let own_frame;
            let frame = if let Some(frame) = frames.next() {
                frame
            } else {
                let Some(bytes) = link.next_frame(&mut inbox) else { break };
                let Some(frame) = link.decode(bytes, out) else { continue };
                own_frame = frame;
                &own_frame
            };
            let listener = ReceiveContext {
                position: own,
                velocity_mps: inputs.state.velocity_mps,
                heard_at,
                fastest_mps,
                period: config.beacon_period,
                latency: config.latency,
                relays: config.relays,
                plausibility: &config.plausibility,
                needs: &|id| id == leader || id == config.id.duplicate() || law.needs(id),
            };
            match link.hear(frame, now, &listener, out) {
                Some(Received::Payload(from, payload, sent)) => law.receive_payload(from, &payload, sent),
                Some(Received::Message(from, message, receipt)) => {
                    let takes = law.receive(from, &message, &mut Radio::new(now, config.message_valid, &mut outgoing));
                    if let Some(receipt) = receipt.filter(|_| takes) {
                        link.take_message(&receipt, now, out);
                    }
                }
                Some(Received::Order(given, receipt)) => {
                    let takes = order(law, last, &given);
                    Some(receipt).filter(|_| takes).into_iter().for_each(|receipt| link.take_order(receipt));
                }
                None => {}
            }
        }
        // At the end, when messages acknowledged in this step have freed their entries.
        link.send(&outgoing, now, out);
    }

    /// Gives the law an order. Returns whether the law takes it.
    pub fn order(&mut self, given: &OrderOf<L, S>) -> bool {
        order(&mut self.law, &mut self.last, given)
    }

    #[inline(never)]
    fn decide(
        &mut self,
        inputs: &Inputs<'_, S, L::Surroundings<'_>>,
        nearby: &[Nearby<S>],
        now: Instant,
        rng: &mut Rng,
        workspace: &mut L::Workspace,
        out: &mut Outputs<S>,
    ) -> Option<Decision<S>> {
        let on_grid = inputs.surroundings.on_grid();
        if on_grid.is_some_and(|grid| grid.cell.busy > Duration::ZERO) {
            return None;
        }
        let scene = Scene {
            id: self.config.id,
            now,
            tick: self.config.tick,
            state: self.steered(inputs),
            ahead_m: self.ahead_m(inputs),
            lag_s: self.config.lag_s,
            body: self.body(inputs),
            nearby,
            ages: self.config.ages,
            sent_to: None,
            cells: inputs.surroundings.cell_frame(inputs.state.position),
        };
        let view = View { scene, known: &self.link.table.as_slice() };
        let mut outgoing = Outgoing::default();
        let tools = Tools { rng, radio: Radio::new(now, self.config.message_valid, &mut outgoing), workspace };
        let target = self.law.report().target;
        let decision = self.law.decide(&view, &inputs.surroundings, tools);
        self.link.send(&outgoing, now, out);
        let before = self.last.situation;
        let Ok(decision) = decision else {
            self.decisions = self.decisions.wrapping_add(1);
            self.last.situation = Situation::Fault;
            return None;
        };
        if decision.progress == Progress::Idle {
            self.last.situation = Situation::Idle;
            return None;
        }
        self.decisions = self.decisions.wrapping_add(1);
        let shown = self.law.report();
        if let Report { goal: Some(from), target: Some(to), .. } = shown
            && from != to
            && Some(to) != target
        {
            report(out, Event::TargetMoved { from, to });
        }
        let is_stopped = !shown.leader.is_some() && shown.stopped_until.is_some_and(|until| !is_over(until, now));
        let is_held = self.is_left() || (is_stopped && decision.progress != Progress::Recovering);
        self.last.situation = match decision.progress {
            _ if decision.action == Action::Release => Situation::Passive,
            Progress::Idle => Situation::Idle,
            progress if progress.has_arrived() => Situation::Arrived,
            Progress::Stuck => Situation::Stuck,
            Progress::Waiting(_) => Situation::Waiting,
            _ if is_held => Situation::Stopped,
            Progress::Forming => Situation::Forming,
            _ => Situation::Going,
        };
        if self.last.situation == Situation::Stuck && before != Situation::Stuck {
            report(out, Event::NoRoute);
        }
        Some(decision)
    }

    fn is_left(&self) -> bool {
        self.link.contact == ContactState::Forgotten && !self.config.contact_loss.may_be_alone()
    }

    #[inline(never)]
    fn supervise(
        &mut self,
        inputs: &Inputs<'_, S, L::Surroundings<'_>>,
        decision: Option<&Decision<S>>,
        out: &mut Outputs<S>,
    ) {
        let to = next_mode(self.mode, self.last.situation);
        if to != self.mode {
            let from = core::mem::replace(&mut self.mode, to);
            report(out, Event::ModeChanged { from, to });
        }
        let Some(decision) = decision else { return };
        let goes = moves(to) || (decision.makes_way && to.gives_way());
        let cell = inputs.surroundings.on_grid().map_or_else(Cell::default, |grid| grid.cell.cell);
        let before = core::mem::replace(&mut self.last.cell, cell);
        let heading = core::mem::replace(&mut self.last.heading, Dir::Stay);
        out.wait = match (to, decision.progress) {
            (Mode::Hold, _) if self.is_left() => Some(Wait::Radio),
            (Mode::Hold | Mode::Arrived, Progress::Waiting(wait)) => Some(wait),
            (Mode::Arrived, _) => None,
            (Mode::Hold, Progress::Stuck) => Some(Wait::Route),
            (Mode::Hold, _) => Some(Wait::Stopped),
            _ if goes && heading != Dir::Stay && cell == before => Some(Wait::Robots),
            (Mode::Cruise, _) if decision.makes_way && inputs.surroundings.in_plane().is_some() => Some(Wait::Turn),
            _ => None,
        };
        match &decision.action {
            Action::Velocity { wish_mps, .. } if goes => out.command = Command::Velocity(*wish_mps),
            Action::Moves(moves) if goes && !moves.is_empty() => {
                self.last.heading = moves.first().copied().unwrap_or_default();
                out.command = Command::Move(moves.clone());
            }
            _ => {}
        }
    }

    /// A stationary robot gives way too, except in modes without [`Mode::gives_way`].
    #[inline(never)]
    fn keep_clear(
        &mut self,
        inputs: &Inputs<'_, S, L::Surroundings<'_>>,
        decision: Option<&Decision<S>>,
        nearby: &mut Vec<Nearby<S>, N>,
        (before, now): (Mode, Instant),
        rng: &mut Rng,
        out: &mut Outputs<S>,
    ) {
        let Some(plane) = inputs.surroundings.in_plane() else {
            return;
        };
        // In the step after such a mode others may still take the whole gap.
        let is_trusted = !before.gives_way() && self.safety.inflation().is_some();
        if !self.mode.gives_way() || is_trusted {
            let misses = self.link.misses_robots();
            let _ = self.link.listening.passes(now, self.config.contact_loss.listen, (false, misses));
            self.link.table.forget_gaps();
            self.commanded_mps = Vec3::ZERO;
            out.command = Command::Hold;
            return;
        }
        let action = decision.map(|decision| &decision.action);
        let (wish_mps, way_m) = match (&out.command, action) {
            (Command::Velocity(wish), Some(Action::Velocity { way_m, .. })) if wish.is_finite() => (*wish, *way_m),
            _ => (Vec3::ZERO, None),
        };
        let (body, steered) = (self.body(inputs), self.steered(inputs).position);
        let Self { link, safety, config, .. } = self;
        let elapsed = link.listening.elapsed(now, config.tick);
        let (hearing, misses) = (link.hearing(), link.misses_robots());
        let is_heard = hearing == Hearing::Heard;
        let (table, inflation) = (&mut link.table, safety.inflation());
        let mut wish_mps = wish_mps;
        if let Some(inflation) = inflation {
            let doubts = hearing == Hearing::Unclear;
            let is_listening = link.listening.passes(now, config.contact_loss.listen, (doubts, misses));
            if is_listening || hearing == Hearing::NoLonger {
                // A robot that has no wish keeps the reason of its law.
                if wish_mps != Vec3::ZERO {
                    out.wait = Some(Wait::Radio);
                }
                wish_mps = Vec3::ZERO;
            }
            nearby.iter_mut().for_each(|other| other.gives_way &= is_heard);
            add_lost(nearby, table.lost(), steered, body.radius_m, now, &config.ages, &inflation);
            if link.contact.is_lost() && config.contact_loss.may_be_alone() {
                wish_mps = wish_mps.clamp_norm(config.contact_loss.alone_mps);
            }
        }
        let is_agreed = decision.is_some_and(|decision| decision.is_agreed);
        if is_agreed {
            let known = table.as_slice();
            let shares = |id| known.find(id).is_some_and(|other| other.payload.is_some());
            nearby.retain(|other| !(other.gives_way && shares(other.id)));
        }
        let input = SafetyInput { body, wish_mps, way_m, nearby, obstacles: plane.obstacles };
        let mut safe = safety.keep_clear(&input, rng);
        let mut is_hidden = false;
        if let Some(inflation) = inflation {
            let (stands_after, may_be_alone) = (config.contact_loss.stands_after, config.contact_loss.may_be_alone());
            let KinematicState { position: own, velocity_mps: own_mps } = inputs.state;
            let AgentConfig { tick, latency, is_synchronous, lag_s, .. } = *config;
            let room = GapLimit {
                body: &body,
                own,
                own_mps,
                lag_s,
                now,
                tick,
                elapsed,
                is_synchronous,
                latency,
                inflation,
                may_be_alone,
                stands_after,
                is_agreed,
                is_heard,
                downwash: safety.downwash(),
            };
            let within = room.limit(table, plane.obstacles, safe);
            is_hidden = within.is_none();
            if !is_heard {
                table.forget_gaps();
            }
            safe = within.unwrap_or(Vec3::ZERO);
        }
        if is_hindered(&input, safe) {
            out.wait = Some(match () {
                () if is_hidden || link.contact.is_lost() => Wait::Radio,
                () if safety.waits_for_turn() => Wait::Turn,
                () if input.nearby.is_empty() => Wait::Route,
                () => Wait::Robots,
            });
        }
        self.commanded_mps = body.reach(safe);
        out.command = Command::Velocity(self.commanded_mps);
    }

    /// Whether a body that is commanded to hold stands at once.
    fn stops_at_once(&self, before: Mode) -> bool {
        let Self { config, mode, .. } = self;
        let is_steered = matches!((before, *mode), (Mode::Passive, Mode::Passive));
        !is_steered && config.max_acceleration_mps2 >= S::MAX && config.lag_s <= S::ZERO
    }

    #[inline(never)]
    fn speak(
        &mut self,
        inputs: &Inputs<'_, S, L::Surroundings<'_>>,
        (before, now): (Mode, Instant),
        out: &mut Outputs<S>,
    ) {
        let is_standing = inputs.surroundings.in_plane().is_some() && self.stops_at_once(before);
        let Self { config, last, law, .. } = self;
        let mode = self.mode;
        // The velocity of the next step is more useful to other robots than the previous one.
        let (own_mps, step_s) = (inputs.state.velocity_mps, S::from_micro(config.tick.as_micros()));
        let velocity_mps = match out.command {
            // A first-order system goes this part of the way in a step, to second order.
            Command::Velocity(velocity_mps) if config.lag_s > S::ZERO => {
                let part = step_s.checked_div(config.lag_s + step_s * S::HALF).unwrap_or(S::ONE).min(S::ONE);
                own_mps + (velocity_mps - own_mps) * part
            }
            Command::Velocity(velocity_mps) => velocity_mps,
            // It stands from now on, unless it is steered by another controller.
            Command::Hold if is_standing => Vec3::ZERO,
            Command::Hold | Command::Move(_) => own_mps,
        };
        let heading = last.heading;
        let payload = |radio: &mut Radio<'_, L::Protocol>| law.payload(&inputs.surroundings, heading, radio);
        let has_sent = self.link.speak(now, config, beacon(config, mode, &inputs.state, velocity_mps), payload, out);
        if has_sent {
            self.link.relay(config.relays, |id| law.needs(id), now, out);
        }
        let busy = inputs.surroundings.on_grid().map_or(Duration::ZERO, |grid| grid.cell.busy);
        let decision = now + if busy > Duration::ZERO { busy } else { config.tick };
        if decision.is_before(out.call_again) {
            out.call_again = decision;
        }
    }
}

fn order<S: Scalar, L: Law<S>>(law: &mut L, last: &mut Last, order: &OrderOf<L, S>) -> bool {
    let takes = law.order(order);
    if takes {
        // At once, even if it decides only after it has crossed its cell.
        if last.situation == Situation::Idle && law.report().goal.is_some() {
            last.situation = Situation::Going;
        }
    }
    takes
}
