//! A foreign body that sends beacons, such as a vehicle with a transponder.

use super::state::{Reader, StateError, write};
use super::transmitter::Transmitter;
use crate::radio::{self, HostWire};
use crate::world::plane::Disc;
use heapless::Vec as Bounded;
use staya_controller::agent::OUTBOX;
use staya_controller::robot::{Mode, RobotId};
use staya_controller::wire::{Beacon, Format, Header, Message, Wire as _};

pub(super) struct Intruder {
    id: RobotId,
    wire: HostWire,
    sequence: u16,
    /// Ticks between two beacons, as of the robots.
    period_ticks: u32,
    outbox: Vec<u8>,
}

impl Intruder {
    pub(super) fn new(id: RobotId, format: Format, period_ticks: u32) -> Self {
        Self { id, wire: radio::wire(format, None, 0), sequence: 0, period_ticks, outbox: Vec::new() }
    }

    fn disc<'a>(&self, intruders: &'a [Disc]) -> Option<&'a Disc> {
        intruders.iter().find(|disc| disc.id == self.id)
    }
}

impl Transmitter for Intruder {
    fn id(&self) -> RobotId {
        self.id
    }

    fn place_m(&self, intruders: &[Disc]) -> [f64; 3] {
        self.disc(intruders).map_or([0.0; 3], |disc| disc.position_m)
    }

    /// Prepares a beacon with position and velocity, of a robot that does not give way.
    fn act(&mut self, tick: u32, _: &[u8], intruders: &[Disc]) {
        self.outbox.clear();
        let is_due = tick.is_multiple_of(self.period_ticks);
        let Some(disc) = self.disc(intruders).filter(|_| is_due) else { return };
        let milli = |x: f64| libm::round(x * 1000.0);
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
        self.outbox.extend_from_slice(&frame);
    }

    fn outbox(&self) -> &[u8] {
        &self.outbox
    }

    fn save(&self, bytes: &mut Vec<u8>) {
        write(&(&self.wire, self.sequence), bytes);
    }

    fn load(&mut self, from: &mut Reader<'_>) -> Result<(), StateError> {
        (self.wire, self.sequence) = from.read("an intruder")?;
        Ok(())
    }
}
