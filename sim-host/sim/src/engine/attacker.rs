//! An attacker with a radio like the robots' own, but without their key.

use crate::radio::{self, HostWire};
use crate::scenario::{Attack, AttackKind};
use heapless::Vec as Bounded;
use staya_controller::agent::OUTBOX;
use staya_controller::auth::Key;
use staya_controller::grid::Cell;
use staya_controller::robot::RobotId;
use staya_controller::wire::{Format, GoalAssignment, Header, Message, WaypointAssignment, Wire};
use std::collections::VecDeque;

/// The start number that it claims to be at: so high that only the missing key gives it away.
const STARTS: u8 = u8::MAX;

/// What it is doing.
pub(super) struct Attacker {
    attack: Attack,
    cell_m: f64,
    wire: HostWire,
    /// Of its next frame.
    sequence: u16,
    version: u8,
    /// What it heard of late, and when.
    heard: VecDeque<(u32, Vec<u8>)>,
    outbox: Vec<u8>,
}

impl Attacker {
    /// One among robots that speak `format`, on cells of `cell_m`.
    pub(super) fn new(attack: &Attack, format: Format, cell_m: f64) -> Self {
        let guess = Key::of_passphrase(b"guessed");
        let key = Some(&guess).filter(|_| attack.kind == AttackKind::Forge);
        Self {
            attack: *attack,
            cell_m,
            wire: radio::wire(format, key, STARTS),
            sequence: 0,
            version: 0,
            heard: VecDeque::new(),
            outbox: Vec::new(),
        }
    }

    /// Its number on the air, where it is one of `index` others; never in a frame.
    pub(super) fn id(index: usize) -> RobotId {
        RobotId(u32::MAX - 1 - u32::try_from(index).unwrap_or(u32::MAX / 2))
    }

    pub(super) fn place_m(&self) -> [f64; 2] {
        self.attack.place_m
    }

    /// What it sends in this tick.
    pub(super) fn outbox(&self) -> &[u8] {
        &self.outbox
    }

    /// Hears what arrived and decides what to send.
    pub(super) fn act(&mut self, tick: u32, inbox: &[u8]) {
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
            AttackKind::Forge | AttackKind::Unsigned => {}
        }
    }

    /// Sends everybody to the lure, be it on the grid or in the plane.
    fn lure(&mut self) {
        self.version = self.version.wrapping_add(1);
        let [x_m, y_m] = self.attack.lure_m;
        let cell = |m: f64| libm::floor(m / self.cell_m) as i16;
        let mm = |m: f64| libm::round(m * 1000.0) as i32;
        self.say(&Message::Goal(GoalAssignment {
            to: RobotId::NOBODY,
            version: self.version,
            target: Cell::new(cell(x_m), cell(y_m)),
        }));
        self.say(&Message::Waypoint(WaypointAssignment {
            to: RobotId::NOBODY,
            version: self.version,
            index: 0,
            position_mm: [mm(x_m), mm(y_m), 0],
            velocity_mmps: [0; 3],
        }));
    }

    fn say(&mut self, message: &Message) {
        let header = Header { boot: STARTS, sender: self.attack.claims, sequence: self.sequence };
        self.sequence = self.sequence.wrapping_add(1);
        let mut frame = Bounded::<u8, OUTBOX>::new();
        self.wire.encode(header, message, &mut frame).expect("the scenario was checked for its number");
        self.outbox.extend_from_slice(&frame);
    }
}
