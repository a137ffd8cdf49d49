#![allow(dead_code, reason = "each test program uses its own part")]

use staya_controller::agent::{
    AgentConfig, AnyInputs, AnySurroundings, CellState, Grid, GridPayload, InPlane, Inputs, KinematicState,
    LawSettings, LayerSettings, OnGrid, OrcaSettings, Protocol as _, RouteSettings, Setup, Task, UnguardedSettings,
    Waypoint, WaypointSettings,
};
use staya_controller::geom::{Position, Vec2, Vec3};
use staya_controller::grid::{Cell, Window};
use staya_controller::neighbor::StalenessInflation;
use staya_controller::obstacle::Obstacle;
use staya_controller::orca::AvoidParams;
use staya_controller::robot::{Mode, RobotId};
use staya_controller::time::{Duration, Instant};
use staya_controller::wire::{Beacon, Content as _, Format, Header, Message, Wire};
use staya_link::robot::Controller;
use staya_link::session::{About, Reaction, Session};
use staya_mavlink::any::AnyWire;
use staya_runner::{Channel, DeviceConfig, LineFaults};
use std::io::{ErrorKind, Read, Write};
use std::os::unix::net::UnixStream;

/// Robots use ORCA in the plane or, for every other number, the grid.
pub fn config(robot: u32, device: &str) -> DeviceConfig {
    let agent = AgentConfig {
        seed: 7,
        max_acceleration_mps2: 2.0,
        ..AgentConfig::new(RobotId(robot), 0.25, Duration::from_millis(100))
    };
    let waypoint = Waypoint::fixed(Position::from_mm([30_000, 500, 0]));
    let (law, safety, task) = if robot.is_multiple_of(2) {
        let law = LawSettings::Route(RouteSettings::default());
        (law, LayerSettings::None(UnguardedSettings), Task::Cell(Cell::new(90, 40)))
    } else {
        let law = LawSettings::Waypoint(WaypointSettings { speed_mps: 1.0, tolerance_m: 0.05 });
        let safety = LayerSettings::Orca(OrcaSettings {
            params: AvoidParams::default(),
            inflation: StalenessInflation { growth_mps: 0.5, max_m: 0.25 },
        });
        let waypoints = [(0, waypoint)].into_iter().collect();
        (law, safety, Task::Waypoints(waypoints))
    };
    DeviceConfig {
        device: device.to_owned(),
        setup: Setup { agent, law, safety, format: Format::Postcard },
        task: Some(task),
        law: Vec::new(),
        faults: LineFaults::default(),
        resets: Vec::new(),
    }
}

/// Sensor readings that do not depend on the robot's decisions.
pub struct Scene {
    wire: AnyWire,
    inbox: Vec<u8>,
    land: Vec<u8>,
    cell: Cell,
    position: Position,
    obstacles: Vec<Obstacle<f32>>,
    on_grid: bool,
}

impl Scene {
    pub fn new(robot: u32, tick: u32) -> Self {
        Self::over(Format::Postcard, robot, tick)
    }

    /// Neighbours use this packet format.
    pub fn over(format: Format, robot: u32, tick: u32) -> Self {
        let cell = Cell::new((tick / 5) as i16, (robot % 7) as i16);
        let mm = [(tick * 60) as i32, robot as i32 * 300, 0];
        let mut scene = Self {
            wire: AnyWire::new(format),
            inbox: Vec::new(),
            land: (0..121).map(|i: u32| (i * 31 + tick / 5) as u8 % 4).collect(),
            cell,
            position: Position::from_mm(mm),
            obstacles: vec![
                Obstacle::Wall([Vec2::new(4.0, -1.0), Vec2::new(4.0, 1.0)]),
                Obstacle::Ball { center_m: Vec3::new(3.0, 2.5, 0.0), radius_m: 0.5 },
            ],
            on_grid: robot.is_multiple_of(2),
        };
        for other in 100..104 {
            scene.hear(other, tick);
        }
        scene
    }

    /// Some beacons are damaged.
    pub fn hear(&mut self, sender: u32, tick: u32) {
        let [x, y, _] = self.position.mm;
        let aside = (sender % 5) as i32 * 700 - 1400;
        let cell = self.cell + Cell::new(2, (sender % 3) as i16 - 1);
        let (protocol, payload) = GridPayload { cell, ..GridPayload::default() }.encode(Grid::ID).expect("fits");
        let beacon = Beacon {
            position_mm: [x + 1500 + aside / 3, y + aside, 0],
            velocity_mmps: [-400, 20, 0],
            radius_mm: 250,
            mode: Mode::Cruise,
            protocol,
            payload,
            ..Beacon::default()
        };
        let header = Header { boot: 0, sender: RobotId(sender), sequence: tick as u16 };
        let mut out = heapless::Vec::<u8, 128>::new();
        let beacon = Message::Beacon(beacon);
        self.wire.encode(header, &beacon, &mut out).expect("fits");
        if (tick + sender).is_multiple_of(9) {
            out[10] ^= 1;
        }
        self.inbox.extend(out);
    }

    pub fn see(&mut self, distance_m: f32) {
        self.obstacles.push(Obstacle::Ball { center_m: Vec3::new(0.0, distance_m, 0.0), radius_m: 0.1 });
    }

    pub fn inputs(&self) -> AnyInputs<'_, f32> {
        let cell = CellState { cell: self.cell, busy: Duration::ZERO };
        Inputs {
            state: KinematicState { position: self.position, velocity_mps: Vec3::new(0.5, 0.0, 0.0) },
            surroundings: if self.on_grid {
                let window = Window::new(&self.land, self.cell - Cell::new(5, 5), 11, 11);
                AnySurroundings::OnGrid(OnGrid { cell, window })
            } else {
                AnySurroundings::InPlane(InPlane { max_speed_mps: 1.0, obstacles: &self.obstacles })
            },
            inbox: &self.inbox,
        }
    }
}

pub fn now(tick: u32) -> Instant {
    Instant::from_micros(tick * 100_000)
}

/// Misbehaviour at these steps, counted over the device's whole life.
#[derive(Clone, Copy, Debug, Default)]
pub struct Mischief {
    pub resets_at: Option<u32>,
    pub silent_at: Option<u32>,
    pub leaves_at: Option<u32>,
}

pub fn device<B: Controller + Send + 'static, const N: usize>(
    new: fn() -> B,
    part: &'static str,
    mischief: Mischief,
) -> Channel {
    let (ours, theirs) = UnixStream::pair().expect("sockets");
    std::thread::spawn(move || live::<B, N>(new, part, mischief, theirs));
    Channel::new(ours.try_clone().expect("a second handle"), ours)
}

pub fn live<B: Controller, const N: usize>(
    new: fn() -> B,
    part: &'static str,
    mischief: Mischief,
    mut line: impl Read + Write,
) {
    let mut about = About { part, firmware: "a thread", boot: 0, ticks_per_second: 1_000_000_000 };
    let mut steps = 0;
    'boots: loop {
        about.boot += 1;
        let mut session = Session::<B, N>::new(new(), about);
        if line.write_all(session.hello()).is_err() {
            return;
        }
        let mut buffer = [0; 256];
        loop {
            let count = match line.read(&mut buffer) {
                Ok(count @ 1..) => count,
                Err(error) if error.kind() == ErrorKind::TimedOut => continue,
                _ => return,
            };
            for byte in &buffer[..count] {
                let before = session.counts().steps;
                match session.receive(*byte, &mut ()) {
                    Reaction::None => continue,
                    Reaction::Restart => continue 'boots,
                    Reaction::Answer(_) if mischief.silent_at.is_some_and(|at| at <= steps) => {}
                    Reaction::Answer(frame) => {
                        if line.write_all(frame).is_err() {
                            return;
                        }
                    }
                }
                steps += session.counts().steps - before;
                if mischief.leaves_at == Some(steps) {
                    return;
                }
                if session.counts().steps > before && mischief.resets_at == Some(steps) {
                    continue 'boots;
                }
            }
        }
    }
}
