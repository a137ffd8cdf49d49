use super::{
    Ask, Check, Control, Entering, Event, HEARTBEAT, OffboardCounters, OffboardStateMachine, Request, Rules, State, out,
};
use staya_mavlink::dialect::MavMessage;
use std::time::Duration;

const LOOK: Duration = Duration::from_secs(3);
/// Requests of the estimator status, which not every autopilot has.
const HEALTH_LOOKS: u8 = 3;
/// PX4 receives setpoints for this time before the mode is requested.
const STREAM: Duration = Duration::from_secs(1);
const RETRY: Duration = Duration::from_secs(2);
/// Two minutes, since autopilots refuse arming and modes long after their first position.
pub(super) const ATTEMPTS: u8 = 60;
const COMMAND_VALID: Duration = Duration::from_millis(500);

impl OffboardStateMachine {
    /// Appends the messages due at `now`, which must not go back: at most one of each kind and
    /// three requests. Call it more often than setpoints are due.
    pub fn poll(&mut self, now: Duration, out: &mut Vec<MavMessage>) {
        self.settle(now);
        if now >= self.next_heartbeat {
            self.next_heartbeat = now + HEARTBEAT;
            out.push(out::heartbeat());
        }
        if matches!(self.state, State::Silent | State::Ambiguous) {
            return;
        }
        self.look(now, out);
        if self.rules.rehearses && self.state == State::Steering {
            self.rehearse_entry(out);
        }
        if self.state == State::Entering {
            self.enter(now, out);
        }
        if let Some(velocity) = self.setpoint(now).filter(|_| now >= self.next_setpoint) {
            // A late call does not cause a burst.
            let next = self.next_setpoint + self.rules.setpoint_every;
            self.next_setpoint = next.max(now);
            if now.saturating_sub(next) < self.rules.setpoint_every {
                self.next_setpoint = next;
            }
            self.streaming_since.get_or_insert(now);
            self.tally.setpoints += 1;
            out.push(out::setpoint(self.system, self.kind, velocity, now));
        }
    }

    /// Time of the next message of [`poll`](Self::poll) without new input.
    pub fn due(&self, now: Duration) -> Duration {
        let setpoint = self.setpoint(now).map(|_| self.next_setpoint);
        setpoint.map_or(self.next_heartbeat, |due| due.min(self.next_heartbeat))
    }

    fn setpoint(&self, now: Duration) -> Option<[f64; 3]> {
        const STAND: [f64; 3] = [0.0; 3];
        match self.state {
            State::Steering => {
                let command = self.command.filter(|(at, _)| now.saturating_sub(*at) <= COMMAND_VALID);
                Some(self.at_altitude(command.map_or(STAND, |(_, velocity)| velocity)))
            }
            State::Stopped | State::Distrusted => Some(STAND),
            State::Entering if self.kind.is_px4() => Some(self.at_altitude(STAND)),
            // PX4 accepts the mode only while setpoints arrive. It ignores them in other modes.
            State::Pilot | State::Disarmed | State::Grounded
                if self.kind.is_px4()
                    && now >= self.quiet_until.max(self.listens_until)
                    && self.fresh_fix(now).is_some() =>
            {
                Some(STAND)
            }
            _ => None,
        }
    }

    /// Adds the climb to the set height, and holds it unless the agent controls the height.
    fn at_altitude(&self, [north, east, down]: [f64; 3]) -> [f64; 3] {
        let is_armed = self.beat.is_some_and(|beat| beat.is_armed && beat.control != Control::Pilot);
        let is_told = self.rules.keeps_altitude || self.state == State::Entering;
        let height = self.rules.altitude_m.zip(self.fix()).filter(|_| is_armed && is_told);
        let down = height.map_or(down, |(altitude_m, fix)| -(0.5 * (altitude_m - fix.above_home_m)).clamp(-1.0, 1.0));
        [north, east, down]
    }

    /// Requests message rates at first, and again if too few messages arrived.
    fn look(&mut self, now: Duration, out: &mut Vec<MavMessage>) {
        // A dry run gets no answers, so it requests once.
        if self.check.is_some_and(|last| now < last.next || self.rules.rehearses) {
            return;
        }
        let Self { system, kind, tally: OffboardCounters { positions, .. }, .. } = *self;
        let reports = self.boot.health.reports;
        let wanted = self.rules.position_hz * LOOK.as_secs_f64();
        if self.check.is_none_or(|last| ((positions - last.positions) as f64) < wanted / 2.0) {
            out.extend(out::intervals(system, kind, self.rules.position_hz));
        }
        let count = self.check.map_or(0, |last| last.count.saturating_add(1));
        let has_health = self.check.is_some_and(|last| reports > last.reports);
        if !has_health && count < HEALTH_LOOKS {
            out.extend(out::health_intervals(system, kind));
        } else if !has_health && count == HEALTH_LOOKS {
            self.events.push_back(Event::NoHealth);
        }
        self.check = Some(Check { next: now + LOOK, positions, reports, count });
    }

    fn enter(&mut self, now: Duration, out: &mut Vec<MavMessage>) {
        let Some(beat) = self.beat else { return };
        let ask = match (beat.control, beat.is_armed) {
            (Control::Pilot, _) => Ask::Mode,
            (_, false) => Ask::Arm,
            (_, true) => Ask::Takeoff,
        };
        // ArduPilot answers a second request during the climb with "failed".
        if ask == Ask::Takeoff && self.is_taking_off() {
            return;
        }
        let is_streaming = |since: Duration| now.saturating_sub(since) >= STREAM;
        if ask == Ask::Mode && self.kind.is_px4() && !self.streaming_since.is_some_and(is_streaming) {
            return;
        }
        let Some(Entering { request, .. }) = &mut self.entering else { return };
        let attempt = match *request {
            Some(last) if last.ask == ask && now.saturating_sub(last.at) < RETRY => return,
            Some(last) if last.ask == ask => last.attempt + 1,
            _ => 1,
        };
        if attempt > ATTEMPTS {
            return self.end_entry(Some(Event::GaveUp));
        }
        *request = Some(Request { ask, attempt, at: now });
        out.extend(out::request(self.system, self.kind, ask, self.rules.altitude_m.unwrap_or(0.0)));
    }

    fn rehearse_entry(&mut self, out: &mut Vec<MavMessage>) {
        if self.entering.take().is_none() {
            return;
        }
        let Rules { arm, takeoff, altitude_m, .. } = self.rules;
        let asks = [(Ask::Mode, true), (Ask::Arm, arm), (Ask::Takeoff, takeoff && altitude_m.is_some())];
        let asks = asks.into_iter().filter(|(_, is_asked)| *is_asked);
        out.extend(asks.filter_map(|(ask, _)| out::request(self.system, self.kind, ask, altitude_m.unwrap_or(0.0))));
    }

    /// Zero velocity, if the companion has control; send it a few times before the end.
    #[must_use]
    pub fn farewell(&self, now: Duration) -> Option<MavMessage> {
        self.state.has_control().then(|| out::setpoint(self.system, self.kind, [0.0; 3], now))
    }
}
