use super::*;
use crate::geo::{Global, Origin};
use flate2::read::GzDecoder;
use staya_mavlink::dialect::MavMessage;
use staya_mavlink::frame::RawFrame;
use std::fs::File;
use std::io::Read as _;
use std::path::Path;
use std::time::Duration;

const STATION: u8 = 250;
const STEP: Duration = Duration::from_millis(10);

fn frame_len(bytes: &[u8]) -> usize {
    const SIGNED: u8 = 1;
    match *bytes {
        [0xFD, len, flags, ..] => usize::from(len) + if flags & SIGNED == 0 { 12 } else { 25 },
        [0xFE, len, ..] => usize::from(len) + 8,
        _ => panic!("no frame behind a time, {} bytes before the end", bytes.len()),
    }
}

/// Times are relative to the first message.
pub struct Recording(Vec<(Duration, Vec<u8>)>);

impl Recording {
    pub fn load(name: &str) -> Self {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/ardupilot");
        let path = folder.join(format!("{name}.tlog.gz"));
        let file = File::open(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let mut bytes = Vec::new();
        GzDecoder::new(file).read_to_end(&mut bytes).expect("a whole gzip file");
        Self::read(&bytes)
    }

    fn read(bytes: &[u8]) -> Self {
        let (mut all, mut rest, mut first) = (Vec::new(), bytes, None);
        while let Some((time, frames)) = rest.split_first_chunk::<8>() {
            let micros = u64::from_be_bytes(*time);
            let at = Duration::from_micros(micros - *first.get_or_insert(micros));
            let (frame, behind) = frames.split_at(frame_len(frames));
            rest = behind;
            if RawFrame::new(frame).is_some_and(|frame| frame.sender().component == MAV_COMP_ID_AUTOPILOT1) {
                all.push((at, frame.to_vec()));
            }
        }
        Self(all)
    }

    pub fn frames(self) -> Vec<(Duration, Vec<u8>)> {
        let vehicle = |frame: &[u8]| RawFrame::new(frame).is_some_and(|frame| frame.sender().system < STATION);
        self.0.into_iter().filter(|(_, frame)| vehicle(frame)).collect()
    }

    pub fn of(&self, system: u8) -> impl Iterator<Item = (Duration, MavMessage)> {
        self.0.iter().filter_map(move |(at, frame)| {
            let frame = RawFrame::new(frame).filter(|frame| frame.sender().system == system)?;
            Some((*at, frame.message()?))
        })
    }

    pub fn replay(
        &self,
        system: u8,
        kind: Kind,
        rules: Rules,
        mut look: impl FnMut(Duration, &OffboardStateMachine, &[MavMessage], &[Event]),
    ) {
        let mut offboard = OffboardStateMachine::new(system, kind, rules);
        let (mut now, mut sent) = (Duration::ZERO, Vec::new());
        for (at, message) in self.of(system) {
            while now < at {
                sent.clear();
                offboard.poll(now, &mut sent);
                let events: Vec<_> = std::iter::from_fn(|| offboard.event()).collect();
                look(now, &offboard, &sent, &events);
                now += STEP;
            }
            offboard.hear(&message, at);
        }
    }
}

mod tests {
    use super::*;
    use crate::companion::offboard::tests::RULES;
    use crate::companion::offboard::{Doubt, Entry, State};

    fn is_setpoint(message: &MavMessage) -> bool {
        matches!(message, MavMessage::SET_POSITION_TARGET_LOCAL_NED(_))
    }

    fn landed_at(recording: &Recording, system: u8, at: Duration) -> Option<u8> {
        let said = recording.of(system).take_while(|(then, _)| *then <= at);
        let landed = said.filter_map(|(_, message)| match message {
            MavMessage::EXTENDED_SYS_STATE(state) => Some(state.landed_state),
            _ => None,
        });
        landed.last()
    }

    #[test]
    fn the_companion_waits_for_the_pilots_takeoff_to_end() {
        let recording = Recording::load("copters-pilot-takeoff");
        for system in 1..=4 {
            let mut first = None;
            recording.replay(system, Kind::ArduCopter, RULES, |now, offboard, sent, _| {
                if sent.iter().any(is_setpoint) {
                    let fix = offboard.fix().expect("a position");
                    first.get_or_insert((now, fix));
                }
            });
            let (at, fix) = first.expect("setpoints start after the takeoff");
            assert_eq!(landed_at(&recording, system, at), Some(2), "system {system} at {at:?}");
            let [_, _, down] = fix.velocity_ned_mps;
            assert!(down.abs() < 0.5, "system {system} climbs at {} m/s", -down);
        }
    }

    #[test]
    fn after_its_own_takeoff_the_companion_has_control_until_the_pilot_lands() {
        let recording = Recording::load("copter-crossing");
        let rules = Rules { entry: Entry::Once, arm: true, takeoff: true, altitude_m: Some(10.0), ..RULES };
        let mut setpoints = Vec::new();
        recording.replay(1, Kind::ArduCopter, rules, |now, offboard, sent, _| {
            if sent.iter().any(is_setpoint) {
                setpoints.push((now, offboard.fix().expect("a position").above_home_m));
            }
        });
        let (first, last) = (setpoints[0], setpoints[setpoints.len() - 1]);
        assert_eq!(landed_at(&recording, 1, first.0), Some(2), "{first:?}");
        assert!((9.0..=10.5).contains(&first.1), "{first:?}");
        // The pilot selected LAND with the heartbeat at 69.991 s.
        assert!((69.9..=70.0).contains(&last.0.as_secs_f64()), "{last:?}");
        let rate = (setpoints.len() - 1) as f64 / (last.0 - first.0).as_secs_f64();
        assert!((19.5..=20.5).contains(&rate), "{rate} setpoints a second");
    }

    fn north_east_m(offboard: &OffboardStateMachine) -> [f64; 2] {
        let place = offboard.fix().expect("a position").place;
        let origin = Origin::new(Global { latitude_deg: -35.363_262, longitude_deg: 149.165_237, altitude_m: 584.0 });
        let [east, north, _] = origin.expect("an origin").to_enu_m(&place).expect("near");
        [north, east]
    }

    fn off(a: [f64; 2], b: [f64; 2]) -> f64 {
        libm::hypot(a[0] - b[0], a[1] - b[1])
    }

    const ROVER: Rules = Rules { entry: Entry::Once, arm: true, ..RULES };

    /// The recorded vehicle reports its GPS at 1 Hz and lost it between 6.0 and 7.0 s. Its own
    /// failsafe triggered at 14.2 s.
    #[test]
    fn a_lost_gps_ends_control_and_regains_trust_later() {
        let recording = Recording::load("rovers-gps-lost");
        let (mut states, mut doubts, mut start, mut lost, mut end) = (Vec::new(), Vec::new(), None, None, None);
        recording.replay(3, Kind::ArduRover, ROVER, |now, offboard, sent, events| {
            let seconds = now.as_secs_f64();
            states.push((seconds, offboard.state()));
            doubts.extend(events.iter().filter_map(|event| match event {
                Event::Doubts(doubt) => Some((seconds, *doubt)),
                _ => None,
            }));
            if (1.0..7.0).contains(&seconds) {
                start.get_or_insert_with(|| north_east_m(offboard));
            }
            if (7.05..46.0).contains(&seconds) {
                let sure = north_east_m(offboard);
                assert!(off(*lost.get_or_insert(sure), sure) < 1e-6, "{seconds}: {sure:?} must not be trusted");
                assert!(offboard.fresh_fix(now).is_none(), "{seconds}");
            }
            if (7.05..14.2).contains(&seconds) {
                assert_eq!(offboard.state(), State::Distrusted, "{seconds}");
                for message in sent {
                    if let MavMessage::SET_POSITION_TARGET_LOCAL_NED(setpoint) = message {
                        assert_eq!([setpoint.vx, setpoint.vy, setpoint.vz], [0.0; 3], "{seconds}");
                    }
                }
            }
            end = offboard.fix().map(|_| north_east_m(offboard));
        });
        assert_eq!(doubts.len(), 1, "{doubts:?}");
        assert_eq!(doubts[0].1, Doubt::Gps);
        assert!((7.0..7.1).contains(&doubts[0].0), "{doubts:?}");
        let [start, lost, end] = [start, lost, end].map(|place| place.expect("recorded"));
        let from_start = |place: [f64; 2]| [place[0] - start[0], place[1] - start[1]];
        // True positions of the simulator (SIMSTATE) at 7.0 s and at the end.
        assert!(off(from_start(lost), [3.12, 5.85]) < 0.3, "{lost:?}");
        assert!(off(from_start(end), [-0.68, 14.09]) < 0.3, "{end:?}");
    }

    #[test]
    fn healthy_vehicles_are_always_trusted() {
        for name in ["rovers-crossing", "rovers-pilot-hold"] {
            let recording = Recording::load(name);
            for system in 1..=6 {
                recording.replay(system, Kind::ArduRover, ROVER, |now, offboard, _, events| {
                    assert!(!events.iter().any(|event| matches!(event, Event::Doubts(_))), "{name} {system} {now:?}");
                    assert_ne!(offboard.state(), State::Distrusted, "{name} {system} {now:?}");
                });
            }
        }
    }

    #[test]
    fn after_a_restart_the_last_position_is_kept_until_a_new_one_arrives() {
        let recording = Recording::load("rovers-restart");
        let (mut steered, mut last) = (Vec::new(), None);
        recording.replay(3, Kind::ArduRover, ROVER, |now, offboard, _, _| {
            let seconds = now.as_secs_f64();
            // Killed at about 6.9 s; the next trusted position arrived at 55 s.
            if (8.0..54.9).contains(&seconds) {
                assert!(offboard.fresh_fix(now).is_none(), "{seconds}");
                let known = north_east_m(offboard);
                assert!(off(*last.get_or_insert(known), known) < 1e-6, "{seconds}: {known:?}");
            }
            if offboard.state() == State::Steering {
                steered.push(seconds);
            }
        });
        assert!(
            steered.iter().all(|seconds| *seconds < 8.0 || *seconds >= 77.9),
            "only after the pilot selects the mode"
        );
        assert!(steered.iter().any(|seconds| *seconds < 2.0) && steered.iter().any(|seconds| *seconds > 78.0));
    }
}
