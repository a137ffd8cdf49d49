//! Wire formats of simulated robots, with or without a key.

use staya_controller::auth::{Key, Master, Seed};
use staya_controller::robot::RobotId;
use staya_controller::wire::{Format, Ring, Sealed};
use staya_mavlink::any::{self, AnyWire};
use staya_mavlink::signed::Signed;
use staya_mavlink::signing::MINUTE;

/// Most senders that a robot with a key knows: the robots of a scenario, and two operators.
pub const PEERS: usize = 1024;

/// The last start that [`Sealed`] counts. A robot that is started more often stays at it, and
/// others take its frames for replays.
pub const LAST_START: u32 = (1 << 20) - 1;

/// Any wire format, with room for a key.
pub type HostWire = AnyWire<Box<Sealed<PEERS>>, Box<Signed<PEERS>>>;

/// Wire of a robot after `starts` restarts, without history. Sequence numbers follow the rule
/// of [`Sealed`], or that of [`Signing`](staya_mavlink::signing::Signing) for robots without a
/// clock: the timestamp stored before each start is less than a minute old.
#[must_use]
pub fn wire(format: Format, key: Option<&Key>, starts: u32) -> HostWire {
    on_link(format, key, starts, 0)
}

/// Wire of robot `id` with its own key, and the swarm's stored or first key.
#[must_use]
pub fn own_wire(master: &Key, id: RobotId, stored: Option<(u16, Seed)>, starts: u32) -> HostWire {
    let master = Master::new(master);
    let (generation, seed) = stored.unwrap_or_else(|| (0, master.seed(0)));
    ring_wire(Ring::of_generation(generation, &seed).with_own(&master.own_key(id)), id, starts)
}

/// Wire of the owner of these keys.
#[must_use]
pub fn ring_wire(ring: Ring, id: RobotId, starts: u32) -> HostWire {
    let sealed = Sealed::with_ring(ring, id, starts.min(LAST_START)).expect("such a start has a counter");
    HostWire::Sealed(Box::new(sealed))
}

/// Wire and id of an operator: see [`any::operator`] for the `link`.
#[must_use]
pub fn operator(format: Format, key: Option<&Key>, link: u8) -> (HostWire, RobotId) {
    (on_link(format, key, u8::MAX.into(), link), any::operator(format, key.is_some(), link))
}

/// Brings the timestamps of an operator up to those of robots after at most `starts` restarts, as
/// their frames would.
pub fn keep_up(wire: &mut HostWire, starts: u32) {
    if let HostWire::Signed(signed) = wire {
        signed.signing_mut().advance_to(u64::from(starts) * MINUTE);
    }
}

fn on_link(format: Format, key: Option<&Key>, starts: u32, link: u8) -> HostWire {
    let Some(key) = key else {
        return HostWire::new(format);
    };
    let wire = HostWire::keyed(format, key, starts.min(LAST_START), link, u64::from(starts) * MINUTE);
    wire.expect("such a start has a counter")
}
