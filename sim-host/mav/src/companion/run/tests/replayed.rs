use super::*;
use crate::companion::offboard::tests::replay::Recording;

struct Replay {
    now: Duration,
    frames: VecDeque<(Duration, Vec<u8>)>,
}

impl Machine for Replay {
    fn now(&self) -> Duration {
        self.now
    }

    fn pause(&mut self, time: Duration) {
        self.now += time;
    }

    fn receive(&mut self, wait: Duration) -> Option<Received> {
        let (at, _) = self.frames.front()?;
        if *at > self.now + wait {
            self.now += wait;
            return None;
        }
        self.now = self.now.max(*at);
        let (_, frame) = self.frames.pop_front()?;
        let line = usize::from(RawFrame::new(&frame)?.sender().system) - 1;
        Some(Received { line, peer: Peer::Wire, frame })
    }

    fn send(&mut self, _: usize, _: Option<Peer>, _: &[u8]) {}

    fn hear_others(&mut self, _: &mut dyn FnMut(&[u8])) {}

    fn tell_others(&mut self, _: &[u8]) {}

    fn log(&mut self, _: &[u8]) -> Result<(), record::Error> {
        Ok(())
    }

    fn close_log(&mut self) -> Result<(), record::Error> {
        Ok(())
    }

    fn missing(&self) -> Missing {
        Missing::default()
    }

    fn show(&mut self, _: &str) -> io::Result<()> {
        Ok(())
    }

    fn tell(&mut self, _: &str) -> io::Result<()> {
        Ok(())
    }
}

/// Seconds, and the radius in metres that robot 1 knows, `None` while unknown.
fn known_of_the_third(name: &str, until: f64) -> Vec<(f64, Option<f32>)> {
    let recording = Recording::load(name);
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../companions/six-rovers-crossing.toml");
    let config = Config::load(&path).unwrap();
    let options = Options { quiet: true, ..Options::default() };
    let replay = Replay { now: Duration::ZERO, frames: recording.frames().into() };
    let mut companions = Companions::new(&config, &options, None, None, Box::new(replay), 0);
    let mut known = Vec::new();
    while companions.now().as_secs_f64() < until {
        companions.turn();
        let third = companions.vehicles[0].controller.agent().neighbors().iter().find(|known| known.id.0 == 3);
        known.push((companions.now().as_secs_f64(), third.map(|known| known.radius_m)));
    }
    companions.has_said_farewell = true;
    known
}

#[test]
fn beacons_of_a_vehicle_without_gps_enlarge_its_radius() {
    let known = known_of_the_third("rovers-gps-lost", 55.0);
    let at = |seconds: f64| {
        let found = known.iter().find(|(at, _)| *at >= seconds).expect("the recording is long enough");
        f64::from(found.1.expect("always known"))
    };
    assert_eq!(at(6.9), 1.0, "the radius of the body");
    // From 7.03 s the radius grows by 2 m/s up to rules.error_m.
    assert!((at(9.03) - 5.0).abs() < 0.5, "{}", at(9.03));
    assert!((at(14.0) - 11.0).abs() < 1e-3 && (at(45.0) - 11.0).abs() < 1e-3, "{}", at(14.0));
    assert_eq!(at(47.0), 1.0, "no problem for 5 s");
}

#[test]
fn a_vehicle_is_never_lost_while_its_autopilot_restarts() {
    let known = known_of_the_third("rovers-restart", 62.0);
    let heard: Vec<_> = known.iter().filter(|(at, _)| *at > 2.0).collect();
    assert!(heard.iter().all(|(_, radius)| radius.is_some()), "robot 3 was lost");
    let widest = heard.iter().filter_map(|(_, radius)| *radius).fold(0.0, f32::max);
    assert!((widest - 11.0).abs() < 1e-3, "{widest}");
}
