//! A foreign body that sends beacons, such as a vehicle with a transponder.

use crate::radio::{self, HostWire};
use crate::world::plane::Disc;
use heapless::Vec as Bounded;
use serde::Serialize;
use staya_controller::agent::OUTBOX;
use staya_controller::robot::{Mode, RobotId};
use staya_controller::wire::{Beacon, Format, Header, Message, Wire as _};

pub struct Intruder {
    pub id: RobotId,
    pub position_m: [f64; 2],
    wire: HostWire,
    sequence: u16,
    outbox: Vec<u8>,
}

pub(super) type IntruderState = (HostWire, u16);

impl Intruder {
    pub fn new(disc: &Disc, format: Format) -> Self {
        let [x, y, _] = disc.position_m;
        let wire = radio::wire(format, None, 0);
        Self { id: disc.id, position_m: [x, y], wire, sequence: 0, outbox: Vec::new() }
    }

    pub fn state(&self) -> impl Serialize {
        (&self.wire, self.sequence)
    }

    pub fn restore(&mut self, (wire, sequence): IntruderState) {
        (self.wire, self.sequence) = (wire, sequence);
    }

    pub fn outbox(&self) -> &[u8] {
        &self.outbox
    }

    /// Prepares a beacon with position and velocity, of a robot that does not give way.
    pub fn speak(&mut self, disc: &Disc) {
        let milli = |x: f64| libm::round(x * 1000.0);
        let [x, y, _] = disc.position_m;
        self.position_m = [x, y];
        let beacon = Beacon {
            position_mm: disc.position_m.map(|x| milli(x) as i32),
            velocity_mmps: disc.velocity_mps.map(|v| milli(v) as i16),
            radius_mm: milli(disc.radius_m) as u16,
            mode: Mode::Passive,
            ..Beacon::default()
        };
        let header = Header { boot: 0, sender: self.id, sequence: self.sequence };
        self.sequence = self.sequence.wrapping_add(1);
        let mut frame = Bounded::<u8, OUTBOX>::new();
        let said = self.wire.encode(header, &Message::Beacon(beacon), &mut frame);
        said.expect("the scenario was checked for its number");
        self.outbox.clear();
        self.outbox.extend_from_slice(&frame);
    }
}
