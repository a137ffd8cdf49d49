//! Recorded flights with ArduPilot's own code, from outside the repository: one vehicle's side, fed into its state machine.

use super::kind::Kind;
use super::offboard::{AUTOPILOT, Event, OffboardStateMachine, Rules};
use flate2::read::GzDecoder;
use staya_mavlink::dialect::MavMessage;
use staya_mavlink::frame::{Scan, scan};
use std::fs::File;
use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Between two polls.
const STEP: Duration = Duration::from_millis(10);

/// What autopilots said, and when, from the first frame on.
pub struct Recording(Vec<(Duration, u8, MavMessage)>);

impl Recording {
    /// The recording `name` beside the repository, or where `STAYA_SHARED` says. Without it, says so and answers `None`.
    pub fn shared(name: &str) -> Option<Self> {
        let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared");
        let folder = std::env::var_os("STAYA_SHARED").map_or_else(beside, PathBuf::from);
        let path = folder.join(format!("data/ardupilot/{name}.tlog.gz"));
        let Ok(file) = File::open(&path) else {
            println!("skipped: {} is not there; STAYA_SHARED names another folder", path.display());
            return None;
        };
        let mut bytes = Vec::new();
        GzDecoder::new(file).read_to_end(&mut bytes).expect("a whole gzip file");
        Some(Self::read(&bytes))
    }

    fn read(bytes: &[u8]) -> Self {
        let (mut all, mut rest, mut first) = (Vec::new(), bytes, None);
        while let Some((time, frames)) = rest.split_first_chunk::<8>() {
            let micros = u64::from_be_bytes(*time);
            let Scan::Frame { junk: 0, frame } = scan(frames, true) else {
                panic!("no frame behind a time, {} bytes before the end", frames.len());
            };
            let at = Duration::from_micros(micros - *first.get_or_insert(micros));
            let sender = frame.sender();
            if let Some(message) = frame.message().filter(|_| sender.component == AUTOPILOT) {
                all.push((at, sender.system, message));
            }
            rest = &frames[frame.bytes().len()..];
        }
        Self(all)
    }

    /// What the autopilot of `system` said.
    pub fn of(&self, system: u8) -> impl Iterator<Item = (Duration, &MavMessage)> {
        self.0.iter().filter(move |(_, from, _)| *from == system).map(|(at, _, message)| (*at, message))
    }

    /// Feeds the messages of `system` into a state machine that is polled meanwhile; `look` sees it after each poll, with what it has sent.
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
            offboard.hear(message, at);
        }
    }
}

mod needs_shared {
    use super::*;
    use crate::companion::offboard::Entry;

    const RULES: Rules = Rules {
        entry: Entry::Wait,
        arm: false,
        takeoff: false,
        altitude_m: None,
        stale: Duration::from_secs(1),
        link_lost: Duration::from_secs(3),
        setpoint_every: Duration::from_millis(50),
        position_hz: 10.0,
    };

    fn is_setpoint(message: &MavMessage) -> bool {
        matches!(message, MavMessage::SET_POSITION_TARGET_LOCAL_NED(_))
    }

    /// What the autopilot says of its landing, by time.
    fn landed_at(recording: &Recording, system: u8, at: Duration) -> Option<u8> {
        let said = recording.of(system).take_while(|(then, _)| *then <= at);
        let landed = said.filter_map(|(_, message)| match message {
            MavMessage::EXTENDED_SYS_STATE(state) => Some(state.landed_state),
            _ => None,
        });
        landed.last()
    }

    #[test]
    fn the_pilots_takeoff_is_not_taken_away() {
        let Some(recording) = Recording::shared("copters-pilot-takeoff") else { return };
        for system in 1..=4 {
            let mut first = None;
            recording.replay(system, Kind::ArduCopter, RULES, |now, offboard, sent, _| {
                if sent.iter().any(is_setpoint) {
                    let fix = offboard.fix().expect("a position");
                    first.get_or_insert((now, fix));
                }
            });
            let (at, fix) = first.expect("it steers once the takeoff is over");
            assert_eq!(landed_at(&recording, system, at), Some(2), "system {system} at {at:?}");
            let [_, _, down] = fix.velocity_ned_mps;
            assert!(down.abs() < 0.5, "system {system} climbs at {} m/s", -down);
        }
    }

    #[test]
    fn after_its_own_takeoff_it_steers_until_the_pilot_lands() {
        let Some(recording) = Recording::shared("copter-crossing") else { return };
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
        // LAND was chosen with the heartbeat at 69.991 s.
        assert!((69.9..=70.0).contains(&last.0.as_secs_f64()), "{last:?}");
        let rate = (setpoints.len() - 1) as f64 / (last.0 - first.0).as_secs_f64();
        assert!((19.5..=20.5).contains(&rate), "{rate} setpoints a second");
    }
}
