mod replayed;

use super::*;
use crate::Peer;
use crate::geo::{Global, Origin};
use crate::tlog::Missing;
use staya_mavlink::dialect::{GLOBAL_POSITION_INT_DATA, HEARTBEAT_DATA};
use staya_mavlink::frame::{MAX_FRAME_LEN, encode_message};
use staya_sim::record;
use std::cell::RefCell;
use std::collections::VecDeque;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::rc::Rc;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Call {
    Receive,
    Send,
    HearOthers,
    TellOthers,
    Log,
    Tell,
    Show,
}

#[derive(Clone, Copy, Debug)]
enum Failure {
    One(usize),
    From(usize),
    Panic(usize),
}

struct Rover {
    system: u8,
    north_east_m: [f64; 2],
    velocity_mps: [f64; 2],
    setpoints: Vec<(Duration, [f64; 2])>,
    warnings: Vec<String>,
}

struct World {
    now: Duration,
    rovers: Vec<Rover>,
    frames: VecDeque<Received>,
    failing: Option<(Call, Failure)>,
    calls: usize,
    logged: usize,
    missing: Missing,
    lines: Vec<String>,
    shown: Vec<String>,
}

const STEP: Duration = Duration::from_millis(5);
const PLACE: Global = Global { latitude_deg: 55.75, longitude_deg: 37.62, altitude_m: 0.0 };

impl World {
    fn new(failing: Option<(Call, Failure)>) -> Self {
        let rover = |system: u8| Rover {
            system,
            north_east_m: [f64::from(system) * 10.0, 0.0],
            velocity_mps: [0.0; 2],
            setpoints: Vec::new(),
            warnings: Vec::new(),
        };
        Self {
            now: Duration::ZERO,
            rovers: vec![rover(1), rover(2)],
            frames: VecDeque::new(),
            failing,
            calls: 0,
            logged: 0,
            missing: Missing::default(),
            lines: Vec::new(),
            shown: Vec::new(),
        }
    }

    fn fails(&mut self, call: Call) -> bool {
        let Some((_, failure)) = self.failing.filter(|(failing, _)| *failing == call) else { return false };
        self.calls += 1;
        match failure {
            Failure::One(number) => self.calls == number,
            Failure::From(number) => self.calls >= number,
            Failure::Panic(number) => {
                assert_ne!(self.calls, number, "panic of the test");
                false
            }
        }
    }

    fn pass(&mut self, time: Duration) {
        let end = self.now + time;
        while self.now < end {
            self.now += STEP.min(end - self.now);
            let ms = self.now.as_millis();
            let origin = Origin::new(PLACE).unwrap();
            for rover in &mut self.rovers {
                for (at, speed) in rover.north_east_m.iter_mut().zip(rover.velocity_mps) {
                    *at += speed * STEP.as_secs_f64();
                }
                let [north, east] = rover.north_east_m;
                let [lat, lon, _] = origin.to_global([east, north, 0.0]).unwrap().to_e7();
                let [vx, vy] = rover.velocity_mps.map(|v| (v * 100.0) as i16);
                let mut say = |message: MavMessage| {
                    let sender = Sender { system: rover.system, component: MAV_COMP_ID_AUTOPILOT1, sequence: 0 };
                    let mut frame = heapless::Vec::<u8, MAX_FRAME_LEN>::new();
                    encode_message(sender, &message, &mut frame).unwrap();
                    self.frames.push_back(Received { line: 0, peer: Peer::Wire, frame: frame.to_vec() });
                };
                if ms.is_multiple_of(1000) {
                    let beat = HEARTBEAT_DATA { custom_mode: 15, base_mode: 0x81, ..HEARTBEAT_DATA::DEFAULT };
                    say(MavMessage::HEARTBEAT(beat));
                }
                if ms.is_multiple_of(100) {
                    say(MavMessage::GLOBAL_POSITION_INT(GLOBAL_POSITION_INT_DATA {
                        time_boot_ms: ms as u32,
                        lat,
                        lon,
                        vx,
                        vy,
                        ..GLOBAL_POSITION_INT_DATA::DEFAULT
                    }));
                }
            }
        }
    }
}

struct Shared(Rc<RefCell<World>>);

fn broken() -> io::Error {
    io::Error::other("broken by the test")
}

impl Machine for Shared {
    fn now(&self) -> Duration {
        self.0.borrow().now
    }

    fn pause(&mut self, time: Duration) {
        self.0.borrow_mut().pass(time);
    }

    fn receive(&mut self, wait: Duration) -> Option<Received> {
        let mut world = self.0.borrow_mut();
        if world.frames.is_empty() {
            world.pass(wait);
        }
        let received = world.frames.pop_front()?;
        (!world.fails(Call::Receive)).then_some(received)
    }

    fn send(&mut self, _: usize, _: Option<Peer>, frame: &[u8]) {
        let mut world = self.0.borrow_mut();
        if world.fails(Call::Send) {
            return;
        }
        let (frame, now) = (RawFrame::new(frame).expect("a frame"), world.now);
        let sender = frame.sender();
        let rover = world.rovers.iter_mut().find(|rover| rover.system == sender.system).expect("one of two");
        match frame.message() {
            Some(MavMessage::SET_POSITION_TARGET_LOCAL_NED(setpoint)) => {
                rover.velocity_mps = [setpoint.vx, setpoint.vy].map(f64::from);
                rover.setpoints.push((now, rover.velocity_mps));
            }
            Some(MavMessage::STATUSTEXT(text)) if text.severity <= 4 => {
                rover.warnings.push(text.text.to_str().unwrap_or_default().to_owned());
            }
            _ => {}
        }
    }

    fn hear_others(&mut self, heard: &mut dyn FnMut(&[u8])) {
        if !self.0.borrow_mut().fails(Call::HearOthers) {
            heard(&[]);
        }
    }

    fn tell_others(&mut self, _: &[u8]) {
        let _ = self.0.borrow_mut().fails(Call::TellOthers);
    }

    fn log(&mut self, _: &[u8]) -> Result<(), record::Error> {
        let mut world = self.0.borrow_mut();
        world.logged += 1;
        if world.fails(Call::Log) {
            world.missing.log_frames_lost += 1;
            return Err(record::Error::new("write", Path::new("flight.tlog"))(broken()));
        }
        Ok(())
    }

    fn close_log(&mut self) -> Result<(), record::Error> {
        Ok(())
    }

    fn missing(&self) -> Missing {
        self.0.borrow().missing
    }

    fn show(&mut self, line: &str) -> io::Result<()> {
        let mut world = self.0.borrow_mut();
        if world.fails(Call::Show) {
            return Err(broken());
        }
        world.shown.push(line.to_owned());
        Ok(())
    }

    fn tell(&mut self, line: &str) -> io::Result<()> {
        let mut world = self.0.borrow_mut();
        if world.fails(Call::Tell) {
            return Err(broken());
        }
        world.lines.push(line.to_owned());
        Ok(())
    }
}

const SECONDS: f64 = 2.4;

fn config() -> Config {
    let vehicle =
        |robot: u8| format!("[[vehicle]]\nrobot = {robot}\nlink = \"serial:none\"\nautopilot = \"ardupilot-rover\"\n");
    let text = format!(
        "scenario = \"crossing.toml\"\norigin = {{ latitude_deg = {}, longitude_deg = {} }}\n{}{}",
        PLACE.latitude_deg,
        PLACE.longitude_deg,
        vehicle(1),
        vehicle(2)
    );
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../companions");
    Config::parse(&text, &folder.join("test.toml")).unwrap()
}

/// The report is `None` if the run ended with an error.
fn fly(config: &Config, failing: Option<(Call, Failure)>) -> (World, Option<CompanionReport>) {
    let options = Options { seconds: Some(SECONDS), ..Options::default() };
    let world = Rc::new(RefCell::new(World::new(failing)));
    let mut companions = Companions::new(config, &options, None, None, Box::new(Shared(Rc::clone(&world))), 0);
    let ended = catch_unwind(AssertUnwindSafe(move || {
        let (seconds, interrupted) = companions.run(|| true, &mut |_| {});
        companions.say_farewell();
        companions.report(seconds, interrupted)
    }));
    (Rc::into_inner(world).expect("the loop has ended").into_inner(), ended.ok())
}

fn assert_steered(world: &World, what: &str) {
    for rover in &world.rovers {
        let all = &rover.setpoints;
        let last = all.last().unwrap_or_else(|| panic!("{what}: no setpoint"));
        assert_eq!(last.1, [0.0; 2], "{what}: farewell");
        assert!(all.iter().any(|(_, velocity)| *velocity != [0.0; 2]), "{what}: the rover never moved");
        let longest = all.windows(2).map(|pair| pair[1].0 - pair[0].0).max().expect("two");
        assert!(longest <= Duration::from_millis(110), "{what}: no setpoint for {longest:?}");
        // A lost heartbeat delays control by one second.
        assert!(all[0].0.as_secs_f64() < 2.2 && last.0.as_secs_f64() >= SECONDS, "{what}");
    }
}

#[test]
fn no_single_failure_ends_control_or_the_final_stop() {
    let config = config();
    for call in [Call::Receive, Call::Send, Call::HearOthers, Call::TellOthers, Call::Log, Call::Tell] {
        let (quiet, _) = fly(&config, Some((call, Failure::One(usize::MAX))));
        assert!(quiet.calls > 0, "{call:?} is never made");
        for number in 1..=quiet.calls {
            let (world, report) = fly(&config, Some((call, Failure::One(number))));
            assert_steered(&world, &format!("{call:?} {number} of {}", quiet.calls));
            let log_error = report.expect("the run ended normally").log_error;
            assert_eq!(log_error.is_some(), call == Call::Log);
        }
    }
}

#[test]
fn permanent_failures_do_not_end_control() {
    let config = config();
    for call in [Call::HearOthers, Call::TellOthers, Call::Log, Call::Tell] {
        for number in [1, 2, 20] {
            let (world, report) = fly(&config, Some((call, Failure::From(number))));
            assert_steered(&world, &format!("{call:?} from {number}"));
            assert!(report.is_some());
        }
    }
    for call in [Call::Receive, Call::Send] {
        let (_, report) = fly(&config, Some((call, Failure::From(1))));
        assert!(report.expect("the run ended normally").seconds >= SECONDS);
    }
}

#[test]
fn a_full_disk_is_reported_once_on_the_ground_and_on_board() {
    let (world, report) = fly(&config(), Some((Call::Log, Failure::From(50))));
    let told = world.lines.iter().filter(|line| line.contains("flight.tlog: broken by the test")).count();
    assert_eq!(told, 1);
    for rover in &world.rovers {
        assert_eq!(rover.warnings, ["staya: the log cannot be written"]);
    }
    let report = report.expect("the run ended normally").to_string();
    let lost = format!("; the log is incomplete: {} frames", world.logged - 49);
    assert!(report.contains("flight.tlog: broken by the test; ") && report.contains(&lost), "{report}");
}

#[test]
fn a_panic_stops_the_vehicles() {
    let (world, report) = fly(&config(), Some((Call::Log, Failure::Panic(100))));
    assert!(report.is_none(), "the loop panicked");
    for rover in &world.rovers {
        let farewells = rover.setpoints.iter().rev().take_while(|(_, velocity)| *velocity == [0.0; 2]).count();
        assert!(rover.setpoints.len() > 5 && farewells >= 5, "{farewells} of {}", rover.setpoints.len());
    }
}

#[test]
fn used_up_timestamps_are_reported_while_signing_is_possible() {
    let config = config();
    let options = Options { seconds: Some(SECONDS), ..Options::default() };
    let world = Rc::new(RefCell::new(World::new(None)));
    let mut companions = Companions::new(&config, &options, None, None, Box::new(Shared(Rc::clone(&world))), 0);
    let last = (1 << 48) - 1;
    companions.links[0].signing = Some(Signing::new(staya_controller::auth::Key::new([7; 32]), 0, last - 3));
    let (seconds, _) = companions.run(|| true, &mut |_| {});
    let report = companions.report(seconds, false);
    drop(companions);
    let world = world.borrow();
    assert_eq!(world.lines.iter().filter(|line| line.contains("signing timestamps are nearly used up")).count(), 1);
    for rover in &world.rovers {
        assert_eq!(rover.warnings, ["staya: link key used up, give a new one"]);
    }
    assert!(report.links[0].is_exhausted && report.to_string().contains("timestamps used up"), "{report}");
}

fn rehearse(failing: Option<(Call, Failure)>) -> (World, f64) {
    let options = Options { seconds: Some(SECONDS), dry_run: true, ..Options::default() };
    let world = Rc::new(RefCell::new(World::new(failing)));
    let config = config();
    let mut companions = Companions::new(&config, &options, None, None, Box::new(Shared(Rc::clone(&world))), 0);
    let (seconds, _) = companions.run(|| true, &mut |_| {});
    companions.has_said_farewell = true;
    drop(companions);
    (Rc::into_inner(world).expect("the loop has ended").into_inner(), seconds)
}

#[test]
fn silent_autopilots_end_the_run_with_their_links_named() {
    let options = Options { wait: 3.0, ..Options::default() };
    let world = Rc::new(RefCell::new(World::new(Some((Call::Receive, Failure::From(1))))));
    let config = config();
    let mut companions = Companions::new(&config, &options, None, None, Box::new(Shared(world)), 0);
    let (seconds, _) = companions.run(|| true, &mut |_| {});
    let error = companions.no_autopilot().expect("no autopilot").to_string();
    companions.has_said_farewell = true;
    assert!((3.0..3.2).contains(&seconds), "{seconds}");
    assert!(error.starts_with("no autopilot heard within 3 s on serial:none") && error.contains("--demo"), "{error}");
}

#[test]
fn simulated_vehicles_of_each_kind_arrive_and_the_demo_ends() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../companions");
    for name in ["six-rovers-crossing", "six-copters-crossing", "six-px4-crossing", "one-rover"] {
        let config = Config::load(&folder.join(format!("{name}.toml"))).unwrap();
        let options = Options { demo: true, quiet: true, ..Options::default() };
        let report = run(&config, &options, None, || true, |_| {}).unwrap();
        assert!(report.seconds < 60.0 && report.links.is_empty(), "{name}: {report}");
        for vehicle in &report.vehicles {
            let height_m = vehicle.position_m.expect("a position")[2];
            let is_at_height = (height_m > 9.0) == vehicle.autopilot.flies();
            assert!(vehicle.has_arrived && is_at_height && vehicle.tally.stops == 0, "{name}: {report}");
        }
    }
}

#[test]
fn a_dry_run_ends_when_its_output_is_closed() {
    let (world, seconds) = rehearse(Some((Call::Show, Failure::One(3))));
    assert!(seconds < SECONDS && world.shown.len() == 2, "{seconds}: {:?}", world.shown);
}

#[test]
fn a_dry_run_prints_velocities_and_texts() {
    let (world, seconds) = rehearse(None);
    assert!(seconds >= SECONDS);
    assert!(world.rovers.iter().all(|rover| rover.setpoints.is_empty()), "nothing is sent");
    let shown = world.shown.iter().filter(|line| line.contains("robot 1: "));
    let shown: Vec<_> = shown.map(|line| line.split_once("robot 1: ").expect("a line of robot 1").1).collect();
    assert!(shown.contains(&"COMMAND_LONG SET_MESSAGE_INTERVAL GLOBAL_POSITION_INT 10.0 Hz"), "{shown:?}");
    assert!(shown.contains(&"STATUSTEXT \"staya: companion has control\""), "{shown:?}");
    let velocities: Vec<_> = shown.iter().filter(|line| line.contains(" m/s north, ")).collect();
    assert!((2..=3).contains(&velocities.len()), "one per second: {shown:?}");
    assert!(velocities.iter().any(|line| !line.contains(" 0.00 m/s north, 0.00 m/s east")), "{velocities:?}");
}
