//! Attackers with a radio: outsiders without the key, and insiders that control a robot.

use super::state::{Reader, StateError, write};
use super::transmitter::Transmitter;
use crate::radio::{self, HostWire};
use crate::scenario::{Attack, AttackKind, Lie, Scenario};
use crate::world::plane::Disc;
use heapless::Vec as Bounded;
use staya_controller::agent::{Grid, GridOrder, GridPayload, Protocol, Waypoint, WaypointOrder, Waypoints};
use staya_controller::auth::Key;
use staya_controller::geom::Position;
use staya_controller::grid::Cell;
use staya_controller::robot::{Mode, RobotId};
use staya_controller::wire::{Beacon, Content as _, Frame, Header, KeyHeld, MAX_FRAME_LEN, Message, Ring, Wire};
use std::collections::VecDeque;
use std::f64::consts::TAU;

/// Restart number of an outsider: the highest, so that only the missing key exposes it.
const STARTS: u8 = u8::MAX;
/// Restart number of an insider: one above that of the robot it replaces.
const TAKEN: u8 = 1;
const RING_M: f64 = 1.5;

pub(super) struct Attacker {
    /// Id at the radio; it never appears in a frame.
    id: RobotId,
    attack: Attack,
    cell_m: f64,
    /// Ids of invented robots start after this one.
    last: u32,
    radius_mm: u16,
    wire: HostWire,
    starts: u8,
    sequence: u16,
    version: u8,
    heard: VecDeque<(u32, Vec<u8>)>,
    outbox: Vec<u8>,
}

impl Attacker {
    pub(super) fn new(attack: &Attack, number: usize, scenario: &Scenario) -> Self {
        let guess = Key::of_passphrase(b"guessed");
        let (key, starts) = match attack.kind {
            AttackKind::Forge => (Some(&guess), STARTS),
            AttackKind::Insider => (scenario.key(), TAKEN),
            AttackKind::Replay | AttackKind::Unsigned => (None, STARTS),
        };
        let index = scenario.robots.binary_search_by_key(&attack.claims, |robot| robot.id);
        let radius_m = index.ok().zip(scenario.plane()).map_or(0.0, |(at, plane)| plane.group(at).radius_m);
        Self {
            id: RobotId(u32::MAX - 1 - u32::try_from(number).unwrap_or(u32::MAX / 2)),
            attack: attack.clone(),
            cell_m: scenario.land.terrain.cell_m,
            last: scenario.usual_claims().last.0,
            radius_mm: libm::round(radius_m * 1000.0) as u16,
            wire: radio::wire(scenario.radio.format, key, starts.into()),
            starts,
            sequence: 0,
            version: 0,
            heard: VecDeque::new(),
            outbox: Vec::new(),
        }
    }

    /// Answers new keys as the robot would, until the robot is revoked.
    fn keep_up(&mut self, inbox: &[u8]) {
        let mut rest = inbox;
        while let Some(frame) = self.wire.next_frame(&mut rest) {
            if let Ok(Frame { header, message: Message::Key(_), .. }) = self.wire.decode(frame)
                && let Some((generation, phase)) = self.wire.held()
            {
                let held = KeyHeld { to: header.sender, generation, phase };
                self.tell(self.attack.claims, &Message::KeyHeld(held));
            }
        }
    }

    fn lie(&mut self, lie: Lie, tick: u32) {
        let Attack { place_m, lure_m, claims, ghosts, .. } = self.attack;
        let [x_m, y_m] = lure_m;
        let honest = self.beacon(place_m);
        match lie {
            Lie::Orders => self.lure(),
            Lie::Radius => self.say(claims, Beacon { radius_mm: u16::MAX, ..self.beacon(lure_m) }),
            Lie::Speed => {
                let way = [0, 1].map(|axis| lure_m[axis] - place_m[axis]);
                let length = libm::hypot(way[0], way[1]).max(1e-9);
                let [vx, vy] = way.map(|way| libm::round(way / length * 32_000.0) as i16);
                self.say(claims, Beacon { velocity_mmps: [vx, vy, 0], ..honest });
            }
            Lie::Jump => self.say(claims, if tick.is_multiple_of(2) { honest } else { self.beacon(lure_m) }),
            Lie::Ghosts => {
                for number in 0..ghosts {
                    let angle = TAU * f64::from(number) / f64::from(ghosts);
                    let at_m = [x_m + RING_M * libm::cos(angle), y_m + RING_M * libm::sin(angle)];
                    self.say(RobotId(self.last + 1 + u32::from(number)), self.beacon(at_m));
                }
            }
        }
    }

    fn beacon(&self, [x_m, y_m]: [f64; 2]) -> Beacon {
        let cell = self.cell([x_m, y_m]);
        let payload = GridPayload { cell, target: cell, ..GridPayload::default() };
        let (protocol, payload) = payload.encode(Grid::ID).expect("a payload of the grid fits a beacon");
        Beacon {
            position_mm: [millis(x_m), millis(y_m), 0],
            radius_mm: self.radius_mm,
            mode: Mode::Hold,
            protocol,
            payload,
            ..Beacon::default()
        }
    }

    fn lure(&mut self) {
        self.version = self.version.wrapping_add(1);
        let [x_m, y_m] = self.attack.lure_m;
        self.order::<Grid>(&GridOrder::FormationGoal(self.cell([x_m, y_m])));
        let position = Position::from_mm([millis(x_m), millis(y_m), 0]);
        self.order::<Waypoints>(&WaypointOrder::first(Waypoint::fixed(position)));
    }

    fn order<P: Protocol>(&mut self, order: &P::Order) {
        let message = P::order(RobotId::NONE, self.version, order).expect("an order fits a frame");
        self.tell(self.attack.claims, &message);
    }

    fn cell(&self, place_m: [f64; 2]) -> Cell {
        let [x, y] = place_m.map(|m| libm::floor(m / self.cell_m) as i16);
        Cell::new(x, y)
    }

    fn say(&mut self, sender: RobotId, beacon: Beacon) {
        self.tell(sender, &Message::Beacon(beacon));
    }

    fn tell(&mut self, sender: RobotId, message: &Message) {
        let header = Header { boot: self.starts, sender, sequence: self.sequence };
        // Two for a tick, as a robot with the key numbers its beacons.
        self.sequence = self.sequence.wrapping_add(2);
        let mut frame = Bounded::<u8, { 2 * MAX_FRAME_LEN }>::new();
        self.wire.encode(header, message, &mut frame).expect("the scenario was checked for its numbers");
        self.outbox.extend_from_slice(&frame);
    }
}

impl Transmitter for Attacker {
    fn id(&self) -> RobotId {
        self.id
    }

    fn place_m(&self, _: &[Disc]) -> [f64; 3] {
        let [x, y] = self.attack.place_m;
        [x, y, 0.0]
    }

    fn act(&mut self, tick: u32, inbox: &[u8], _: &[Disc]) {
        self.outbox.clear();
        let is_active = (self.attack.from_tick..self.attack.to_tick).contains(&tick);
        match self.attack.kind {
            AttackKind::Replay => {
                self.heard.push_back((tick, inbox.to_vec()));
                while let Some((at, frames)) = self.heard.front()
                    && tick - at >= self.attack.delay_ticks
                {
                    if is_active {
                        self.outbox.extend_from_slice(frames);
                    }
                    self.heard.pop_front();
                }
            }
            AttackKind::Forge | AttackKind::Unsigned if is_active => self.lure(),
            AttackKind::Insider if is_active => {
                self.keep_up(inbox);
                for lie in self.attack.lies.clone() {
                    self.lie(lie, tick);
                }
            }
            AttackKind::Forge | AttackKind::Unsigned | AttackKind::Insider => {}
        }
    }

    fn outbox(&self) -> &[u8] {
        &self.outbox
    }

    fn captures(&self, tick: u32) -> Option<RobotId> {
        let is_now = self.attack.kind == AttackKind::Insider && tick == self.attack.from_tick;
        is_now.then_some(self.attack.claims)
    }

    fn take(&mut self, ring: &Ring) {
        self.wire = radio::ring_wire(ring.clone(), self.attack.claims, self.starts.into());
    }

    fn save(&self, bytes: &mut Vec<u8>) {
        write(&(&self.wire, self.sequence, self.version, &self.heard), bytes);
    }

    fn load(&mut self, from: &mut Reader<'_>) -> Result<(), StateError> {
        (self.wire, self.sequence, self.version, self.heard) = from.read("an attacker")?;
        Ok(())
    }
}

fn millis(m: f64) -> i32 {
    libm::round(m * 1000.0) as i32
}
