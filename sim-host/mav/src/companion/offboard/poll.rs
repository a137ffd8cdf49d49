use super::{Ask, Event, HEARTBEAT, OffboardStateMachine, Rules, State, out};
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
        if self.state == State::Silent {
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
    #[must_use]
    pub fn due(&self, now: Duration) -> Duration {
        let setpoint = self.setpoint(now).map(|_| self.next_setpoint);
        setpoint.map_or(self.next_heartbeat, |due| due.min(self.next_heartbeat))
    }

    fn setpoint(&self, now: Duration) -> Option<[f64; 3]> {
        const STAND: [f64; 3] = [0.0; 3];
        match self.state {
            State::Steering => {
                let command = self.command;
                let command = command.filter(|(at, _)| now.saturating_sub(*at) <= COMMAND_VALID);
                let velocity = command.map_or(STAND, |(_, velocity)| velocity);
                Some(self.at_altitude(velocity))
            }
            State::Stopped | State::Distrusted => Some(STAND),
            State::Entering if self.kind.needs_stream() => Some(self.at_altitude(STAND)),
            // PX4 accepts the mode only while setpoints arrive. It ignores them in other modes.
            State::Pilot | State::Disarmed | State::Grounded
                if self.kind.needs_stream() && now >= self.quiet_until && self.fresh_fix(now).is_some() =>
            {
                Some(STAND)
            }
            _ => None,
        }
    }

    /// Adds the climb to the set height, and holds it unless the agent controls the height.
    fn at_altitude(&self, [north, east, down]: [f64; 3]) -> [f64; 3] {
        let is_armed = self.beat.is_some_and(|beat| beat.is_armed && beat.is_controlled);
        let is_told = self.rules.keeps_altitude || self.state == State::Entering;
        let height = self.rules.altitude_m.zip(self.fix).filter(|_| is_armed && is_told);
        let down = height.map_or(down, |(altitude_m, fix)| -(0.5 * (altitude_m - fix.above_home_m)).clamp(-1.0, 1.0));
        [north, east, down]
    }

    fn look(&mut self, now: Duration, out: &mut Vec<MavMessage>) {
        if self.next_look.is_some_and(|at| now < at) {
            return;
        }
        let is_first = self.next_look.is_none();
        // A dry run gets no answers, so it requests once.
        if self.rules.rehearses && !is_first {
            return;
        }
        let got = self.tally.positions - self.positions_at_look;
        let wanted = self.rules.position_hz * LOOK.as_secs_f64();
        if is_first || (got as f64) < wanted / 2.0 {
            out.extend(out::intervals(self.system, self.kind, self.rules.position_hz));
        }
        self.looks = if is_first { 0 } else { self.looks.saturating_add(1) };
        let has_health = !is_first && self.health.reports > self.reports_at_look;
        if !has_health && self.looks < HEALTH_LOOKS {
            out.extend(out::health_intervals(self.system, self.kind));
        } else if !has_health && self.looks == HEALTH_LOOKS {
            self.events.push_back(Event::NoHealth);
        }
        self.positions_at_look = self.tally.positions;
        self.reports_at_look = self.health.reports;
        self.next_look = Some(now + LOOK);
    }

    fn enter(&mut self, now: Duration, out: &mut Vec<MavMessage>) {
        let Some(beat) = self.beat else { return };
        let ask = match (beat.is_controlled, beat.is_armed) {
            (false, _) => Ask::Mode,
            (true, false) => Ask::Arm,
            (true, true) => Ask::Takeoff,
        };
        // ArduPilot answers a second request during the climb with "failed".
        if ask == Ask::Takeoff && self.is_taking_off() {
            return;
        }
        let is_streaming = |since: Duration| now.saturating_sub(since) >= STREAM;
        if ask == Ask::Mode && self.kind.needs_stream() && !self.streaming_since.is_some_and(is_streaming) {
            return;
        }
        let attempt = match self.asked {
            Some((last, attempt, at)) if last == ask => {
                if now.saturating_sub(at) < RETRY {
                    return;
                }
                attempt + 1
            }
            _ => 1,
        };
        if attempt > ATTEMPTS {
            self.end_entry(Some(Event::GaveUp));
            return;
        }
        self.asked = Some((ask, attempt, now));
        match ask {
            Ask::Mode => out.push(out::set_mode(self.system, self.kind)),
            Ask::Arm => out.push(out::arm(self.system)),
            // PX4 climbs by its setpoints.
            Ask::Takeoff if self.kind.needs_stream() => {}
            Ask::Takeoff => {
                let altitude_m = self.rules.altitude_m.unwrap_or(0.0);
                out.push(out::takeoff(self.system, altitude_m));
            }
        }
    }

    fn rehearse_entry(&mut self, out: &mut Vec<MavMessage>) {
        if !std::mem::take(&mut self.may_enter) {
            return;
        }
        let Rules { arm, takeoff, altitude_m, .. } = self.rules;
        out.push(out::set_mode(self.system, self.kind));
        out.extend(arm.then(|| out::arm(self.system)));
        let height = altitude_m.filter(|_| takeoff && !self.kind.needs_stream());
        out.extend(height.map(|altitude_m| out::takeoff(self.system, altitude_m)));
    }

    /// Zero velocity, if the companion has control; send it a few times before the end.
    #[must_use]
    pub fn farewell(&self, now: Duration) -> Option<MavMessage> {
        self.state.has_control().then(|| out::setpoint(self.system, self.kind, [0.0; 3], now))
    }
}
