mod entry;
pub(crate) mod replay;
mod telemetry;

use super::*;
use staya_mavlink::dialect::{
    COMMAND_ACK_DATA, EKF_STATUS_REPORT_DATA, EXTENDED_SYS_STATE_DATA, GLOBAL_POSITION_INT_DATA, HEARTBEAT_DATA,
    LOCAL_POSITION_NED_DATA, SET_POSITION_TARGET_LOCAL_NED_DATA,
};

pub(crate) const RULES: Rules = Rules {
    entry: Entry::Wait,
    arm: false,
    takeoff: false,
    altitude_m: None,
    keeps_altitude: true,
    stale: Duration::from_secs(1),
    link_lost: Duration::from_secs(3),
    setpoint_every: Duration::from_millis(50),
    position_hz: 10.0,
    rehearses: false,
};
const ONCE: Rules = Rules { entry: Entry::Once, ..RULES };
const FLY: Rules = Rules { arm: true, takeoff: true, altitude_m: Some(10.0), ..ONCE };
const GUIDED: u32 = 15;
const MANUAL: u32 = 0;
const OFFBOARD: u32 = 6 << 16;
const POSITION_CONTROL: u32 = 3 << 16;
const ARMED: u8 = 0x81;
const DISARMED: u8 = 0x01;

struct Bench {
    offboard: OffboardStateMachine,
    now: Duration,
    boot_ms: u32,
    mode: u32,
    base: u8,
    above_home_m: f64,
    climb_mps: f64,
    down_mps: f64,
    beats: bool,
    fixes: bool,
    reports: bool,
    ekf_flags: u16,
    sent: Vec<MavMessage>,
}

impl Bench {
    fn new(kind: Kind, rules: Rules, mode: u32, base: u8) -> Self {
        Self {
            offboard: OffboardStateMachine::new(7, kind, rules),
            now: Duration::ZERO,
            boot_ms: 60_000,
            mode,
            base,
            above_home_m: 0.0,
            climb_mps: 0.0,
            down_mps: 0.0,
            beats: true,
            fixes: true,
            reports: false,
            ekf_flags: 0x33F,
            sent: Vec::new(),
        }
    }

    fn rover(rules: Rules) -> Self {
        Self::new(Kind::ArduRover, rules, GUIDED, ARMED)
    }

    fn beat(&mut self) {
        let beat = MavMessage::HEARTBEAT(HEARTBEAT_DATA {
            custom_mode: self.mode,
            base_mode: self.base,
            ..HEARTBEAT_DATA::DEFAULT
        });
        self.offboard.hear(&beat, self.now);
    }

    fn fix(&mut self) {
        let fix = MavMessage::GLOBAL_POSITION_INT(GLOBAL_POSITION_INT_DATA {
            time_boot_ms: self.boot_ms,
            lat: 557_500_000,
            lon: 376_200_000,
            alt: 156_000,
            relative_alt: (self.above_home_m * 1e3) as i32,
            vx: 100,
            vz: (self.climb_mps * -100.0) as i16,
            ..GLOBAL_POSITION_INT_DATA::DEFAULT
        });
        self.offboard.hear(&fix, self.now);
    }

    fn ekf(&mut self) {
        let report = MavMessage::EKF_STATUS_REPORT(EKF_STATUS_REPORT_DATA {
            flags: self.ekf_flags,
            ..EKF_STATUS_REPORT_DATA::DEFAULT
        });
        self.offboard.hear(&report, self.now);
    }

    /// Steps of 10 ms.
    fn run(&mut self, seconds: f64) -> Vec<MavMessage> {
        self.sent.clear();
        for _ in 0..(seconds * 100.0).round() as u32 {
            let ms = self.now.as_millis();
            if self.beats && ms.is_multiple_of(1000) {
                self.beat();
            }
            if self.fixes && ms.is_multiple_of(100) {
                self.fix();
            }
            if self.reports && ms.is_multiple_of(250) {
                self.ekf();
            }
            if self.offboard.state() == State::Steering {
                self.offboard.steer([1.0, 2.0, self.down_mps], self.now);
            }
            self.offboard.poll(self.now, &mut self.sent);
            self.now += Duration::from_millis(10);
            self.boot_ms = self.boot_ms.wrapping_add(10);
        }
        self.sent.clone()
    }

    fn state(&self) -> State {
        self.offboard.state()
    }

    fn events(&mut self) -> Vec<Event> {
        std::iter::from_fn(|| self.offboard.event()).collect()
    }
}

fn setpoints(sent: &[MavMessage]) -> Vec<SET_POSITION_TARGET_LOCAL_NED_DATA> {
    let setpoint = |message: &MavMessage| match message {
        MavMessage::SET_POSITION_TARGET_LOCAL_NED(data) => Some(data.clone()),
        _ => None,
    };
    sent.iter().filter_map(setpoint).collect()
}

fn commands(sent: &[MavMessage], number: u16) -> usize {
    let is_it = |message: &&MavMessage| match message {
        MavMessage::COMMAND_LONG(data) => data.command == number,
        _ => false,
    };
    sent.iter().filter(is_it).count()
}

fn stands(setpoint: &SET_POSITION_TARGET_LOCAL_NED_DATA) -> bool {
    [setpoint.vx, setpoint.vy, setpoint.vz] == [0.0; 3]
}

#[test]
fn setpoints_have_their_rate_and_only_velocities() {
    let mut bench = Bench::rover(RULES);
    bench.run(1.0);
    assert_eq!(bench.state(), State::Steering);
    let sent = bench.run(10.0);
    let setpoints = setpoints(&sent);
    assert!((199..=201).contains(&setpoints.len()), "{}", setpoints.len());
    for setpoint in &setpoints {
        assert_eq!((setpoint.target_system, setpoint.target_component), (7, 1));
        assert_eq!((setpoint.coordinate_frame, setpoint.type_mask), (1, 0xDC7));
        assert_eq!([setpoint.vx, setpoint.vy, setpoint.vz], [1.0, 2.0, 0.0]);
    }
    let beats = sent.iter().filter(|m| matches!(m, MavMessage::HEARTBEAT(_)));
    assert_eq!(beats.count(), 10);
}

#[test]
fn a_stationary_ardupilot_rover_is_told_not_to_turn() {
    let masks = |kind, velocity| {
        let MavMessage::SET_POSITION_TARGET_LOCAL_NED(said) = out::setpoint(7, kind, velocity, Duration::ZERO) else {
            panic!("a setpoint");
        };
        (said.type_mask, [said.vx, said.vy, said.vz], said.yaw_rate)
    };
    for slow in [[0.0; 3], [0.03, -0.03, 0.0]] {
        assert_eq!(masks(Kind::ArduRover, slow), (0x5C7, [0.0; 3], 0.0));
    }
    assert_eq!(masks(Kind::ArduRover, [0.0, -0.051, 0.0]), (0xDC7, [0.0, -0.051, 0.0], 0.0));
    for other in [Kind::ArduCopter, Kind::Px4Copter, Kind::Px4Rover] {
        assert_eq!(masks(other, [0.0; 3]), (0xDC7, [0.0; 3], 0.0));
    }
}

#[test]
fn a_late_poll_makes_no_burst() {
    let mut bench = Bench::rover(RULES);
    bench.run(1.0);
    bench.now += Duration::from_millis(900);
    assert!(setpoints(&bench.run(0.1)).len() <= 3);
}

#[test]
fn no_requests_are_sent_while_the_pilot_has_control() {
    for kind in [Kind::ArduRover, Kind::ArduCopter] {
        let mut bench = Bench::new(kind, RULES, MANUAL, ARMED);
        let sent = bench.run(30.0);
        assert_eq!(bench.state(), State::Pilot);
        assert_eq!(setpoints(&sent).len(), 0);
        assert_eq!(commands(&sent, MAV_CMD_DO_SET_MODE), 0);
        assert_eq!(commands(&sent, MAV_CMD_COMPONENT_ARM_DISARM), 0);
    }
}

#[test]
fn without_an_autopilot_only_heartbeats_are_sent() {
    let mut bench = Bench::rover(ONCE);
    (bench.beats, bench.fixes) = (false, false);
    let sent = bench.run(10.0);
    assert_eq!(bench.state(), State::Silent);
    assert!(sent.iter().all(|m| matches!(m, MavMessage::HEARTBEAT(_))));
    assert_eq!(sent.len(), 10);
}

#[test]
fn a_disarmed_vehicle_gets_no_setpoints() {
    let mut bench = Bench::new(Kind::ArduRover, ONCE, GUIDED, DISARMED);
    let sent = bench.run(5.0);
    assert_eq!(bench.state(), State::Disarmed);
    assert_eq!(setpoints(&sent).len() + commands(&sent, MAV_CMD_COMPONENT_ARM_DISARM), 0);
    bench.base = ARMED;
    bench.run(1.0);
    assert_eq!(bench.state(), State::Steering);
}

#[test]
fn a_position_turns_stale_exactly_at_its_limit_and_stops_the_vehicle() {
    let mut bench = Bench::rover(RULES);
    bench.run(2.0);
    bench.fix();
    let (at, mut sent) = (bench.now, Vec::new());
    bench.beat();
    bench.offboard.poll(at + RULES.stale, &mut sent);
    assert_eq!(bench.state(), State::Steering);
    bench.offboard.poll(at + RULES.stale + Duration::from_micros(1), &mut sent);
    assert_eq!(bench.state(), State::Stopped);
    assert!(stands(setpoints(&sent).last().unwrap()));
}

#[test]
fn stale_telemetry_stops_and_fresh_telemetry_resumes() {
    let mut bench = Bench::rover(RULES);
    bench.run(2.0);
    bench.fixes = false;
    bench.run(1.0);
    let sent = bench.run(2.0);
    assert_eq!(bench.state(), State::Stopped);
    let stops = setpoints(&sent);
    assert!(stops.len() >= 38 && stops.iter().all(stands));
    bench.fixes = true;
    bench.run(0.2);
    assert_eq!(bench.state(), State::Steering);
    assert_eq!(bench.offboard.tally().stops, 1);
}

#[test]
fn setpoints_end_exactly_at_the_link_timeout() {
    let mut bench = Bench::rover(RULES);
    bench.run(2.0);
    (bench.beats, bench.fixes) = (false, false);
    bench.beat();
    let (at, mut sent) = (bench.now, Vec::new());
    bench.offboard.poll(at + RULES.link_lost, &mut sent);
    assert_eq!(bench.state(), State::Stopped);
    sent.clear();
    bench.offboard.poll(at + RULES.link_lost + Duration::from_micros(1), &mut sent);
    assert_eq!(bench.state(), State::Silent);
    assert_eq!(setpoints(&sent).len(), 0);
    bench.now += Duration::from_secs(10);
    bench.boot_ms += 10_000;
    (bench.beats, bench.fixes) = (true, true);
    bench.run(1.5);
    assert_eq!(bench.state(), State::Steering);
    assert!(bench.events().iter().any(|event| matches!(event, Event::Back(_))));
}

#[test]
fn the_pilot_gets_control_with_the_first_heartbeat_in_another_mode() {
    for rules in [RULES, ONCE] {
        let mut bench = Bench::rover(rules);
        bench.run(2.5);
        bench.mode = MANUAL;
        bench.beat();
        assert_eq!(bench.state(), State::Pilot);
        let sent = bench.run(60.0);
        assert_eq!(setpoints(&sent).len(), 0);
        assert_eq!(commands(&sent, MAV_CMD_DO_SET_MODE), 0, "control is not requested back");
        assert!(bench.events().contains(&Event::HandedOver(MANUAL)));
        assert_eq!(bench.offboard.tally().hand_overs, 1);
        bench.mode = GUIDED;
        bench.run(1.5);
        assert_eq!(bench.state(), State::Steering);
    }
}

#[test]
fn an_old_velocity_is_not_sent_after_an_interruption() {
    let mut bench = Bench::rover(RULES);
    bench.run(2.0);
    bench.mode = MANUAL;
    bench.beat();
    bench.mode = GUIDED;
    bench.beat();
    let mut sent = Vec::new();
    bench.offboard.poll(bench.now, &mut sent);
    assert!(stands(&setpoints(&sent)[0]), "the agent has sent no command yet");
}

#[test]
fn a_silent_agent_stops_the_vehicle() {
    let mut bench = Bench::rover(RULES);
    bench.run(2.0);
    let mut sent = Vec::new();
    for _ in 0..60 {
        bench.now += Duration::from_millis(10);
        bench.boot_ms += 10;
        bench.fix();
        bench.beat();
        bench.offboard.poll(bench.now, &mut sent);
    }
    assert!(stands(setpoints(&sent).last().unwrap()));
}

#[test]
fn poll_sends_nothing_before_the_due_time() {
    let mut bench = Bench::rover(RULES);
    bench.run(2.0);
    let due = bench.offboard.due(bench.now);
    assert!(due >= bench.now && due <= bench.now + RULES.setpoint_every);
    bench.mode = MANUAL;
    bench.run(30.2);
    assert!(bench.offboard.due(bench.now) > bench.now + RULES.setpoint_every);
}

#[test]
fn a_restart_in_the_mode_is_not_a_permission() {
    for rules in [RULES, ONCE] {
        let mut bench = Bench::rover(rules);
        bench.run(2.0);
        bench.boot_ms = 100;
        let sent = bench.run(10.0);
        assert_eq!(bench.state(), State::Restarted);
        assert!(setpoints(&sent).len() <= 1);
        assert_eq!(bench.offboard.tally().restarts, 1);
        bench.mode = MANUAL;
        bench.run(1.5);
        assert_eq!(bench.state(), State::Pilot);
        bench.mode = GUIDED;
        bench.run(1.5);
        assert_eq!(bench.state(), State::Steering);
    }
}

#[test]
fn only_a_controlled_vehicle_is_stopped_at_the_end() {
    let mut bench = Bench::rover(RULES);
    bench.run(2.0);
    assert!(bench.offboard.farewell(bench.now).is_some());
    bench.mode = MANUAL;
    bench.beat();
    assert!(bench.offboard.farewell(bench.now).is_none());
}

#[test]
fn an_ambiguous_or_new_vehicle_gets_no_setpoint_and_no_request() {
    for (kind, rules, mode) in [
        (Kind::ArduRover, Rules { arm: true, ..ONCE }, MANUAL),
        (Kind::ArduRover, RULES, GUIDED),
        (Kind::Px4Copter, RULES, POSITION_CONTROL),
    ] {
        let mut bench = Bench::new(kind, rules, mode, ARMED);
        bench.offboard.listen_until(Duration::from_secs(3));
        let early = bench.run(2.9);
        assert!(setpoints(&early).is_empty() && commands(&early, MAV_CMD_DO_SET_MODE) == 0, "{kind:?}: {early:?}");
        let later = bench.run(2.0);
        assert!(!setpoints(&later).is_empty() || commands(&later, MAV_CMD_DO_SET_MODE) > 0, "{kind:?}");
        bench.offboard.set_ambiguous(true, bench.now);
        assert_eq!(bench.state(), State::Ambiguous);
        let two = bench.run(3.0);
        assert!(two.iter().all(|message| matches!(message, MavMessage::HEARTBEAT(_))), "{kind:?}: {two:?}");
        assert!(bench.offboard.farewell(bench.now).is_none());
        bench.offboard.set_ambiguous(false, bench.now);
        assert_ne!(bench.state(), State::Ambiguous);
    }
}

#[test]
fn texts_of_states_fit_into_a_status_text() {
    for state in [
        State::Silent,
        State::Ambiguous,
        State::Pilot,
        State::Restarted,
        State::Entering,
        State::Disarmed,
        State::NoPosition,
        State::Grounded,
        State::Stopped,
        State::Distrusted,
        State::Steering,
    ] {
        assert!("staya: ".len() + state.words().len() <= 50);
    }
}
