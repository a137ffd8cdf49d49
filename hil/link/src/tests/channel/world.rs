use staya_controller::agent::*;
use staya_controller::geom::{Position, Vec2, Vec3};
use staya_controller::grid::{Cell, Window};
use staya_controller::obstacle::Obstacle;
use staya_controller::robot::{Mode, RobotId};
use staya_controller::time::{Duration, Instant};
use staya_controller::wire::{Beacon, Header, Message, encode};
use std::vec::Vec;

/// A beacon of robot 2, which circles around the first one.
pub fn inbox(tick: u32) -> Vec<u8> {
    let at = (tick % 400) as i32;
    let beacon = Beacon {
        position_mm: [at * 50 - 2000, 300 - at, 0],
        velocity_mmps: [500, -10, 0],
        radius_mm: 250,
        mode: Mode::Cruise,
        ..Beacon::default()
    };
    let header = Header { boot: 0, sender: RobotId(2), sequence: tick as u16 };
    let mut out = heapless::Vec::<u8, 128>::new();
    encode(header, &Message::Beacon(beacon), &mut out).expect("fits");
    if tick.is_multiple_of(9) {
        out[10] ^= 1;
    }
    out.to_vec()
}

/// A reference robot without faults.
pub struct World {
    pub position: Position,
    pub velocity: Vec3<f32>,
    pub cell: Cell,
}

pub struct Scene {
    pub now: Instant,
    pub inbox: Vec<u8>,
    land: Vec<u8>,
    origin: Cell,
    obstacles: [Obstacle<f32>; 2],
}

impl World {
    pub const START: Self =
        Self { position: Position::ORIGIN, velocity: Vec3::new(0.0, 0.0, 0.0), cell: Cell::new(0, 0) };

    pub fn scene(&self, tick: u32) -> Scene {
        let now = Instant::from_micros(tick.wrapping_mul(100_000));
        let origin = self.cell - Cell::new(5, 5);
        let impassability = |i: i16| {
            let (x, y) = (origin.x + i % 11, origin.y + i / 11);
            if (x * 7 + y * 3) % 5 == 1 { 0 } else { 1 + (x + y).rem_euclid(3) as u8 }
        };
        let [x, y, _] = self.position.mm.map(|mm| mm as f32 / 1000.0);
        let corner = |dx: f32, dy: f32| Vec2::new(dx - x, dy - y);
        Scene {
            now,
            inbox: inbox(tick),
            land: (0..121).map(impassability).collect(),
            origin,
            obstacles: [
                Obstacle::Wall([corner(4.0, -1.0), corner(4.0, 1.0)]),
                Obstacle::Ball { center_m: corner(8.0, 0.5).extend(0.0), radius_m: 0.5 },
            ],
        }
    }

    pub fn follow(&mut self, command: &Command<f32>) {
        match command {
            Command::Hold => self.velocity = Vec3::default(),
            Command::Velocity(velocity) => {
                self.velocity = *velocity;
                self.position = self.position.moved(*velocity * 0.1).expect("finite");
            }
            Command::Move(moves) => self.cell = self.cell + moves[0].offset(),
        }
    }
}

impl Scene {
    pub fn inputs(&self, world: &World, plane: bool) -> AnyInputs<'_, f32> {
        let cell = CellState { cell: world.cell, busy: Duration::ZERO };
        Inputs {
            state: KinematicState { position: world.position, velocity_mps: world.velocity },
            surroundings: if plane {
                AnySurroundings::InPlane(InPlane { max_speed_mps: 1.0, obstacles: &self.obstacles })
            } else {
                let window = Window::new(&self.land, self.origin, 11, 11);
                AnySurroundings::OnGrid(OnGrid { cell, window })
            },
            inbox: &self.inbox,
        }
    }
}
