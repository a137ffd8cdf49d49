//! What robots speak: a wire format, with a key or without one.

use staya_controller::auth::Key;
use staya_controller::robot::RobotId;
use staya_controller::wire::{Format, Sealed};
use staya_mavlink::any::{self, AnyWire};
use staya_mavlink::signed::Signed;
use staya_mavlink::signing::MINUTE;

/// Senders that a robot with a key knows: the robots of a scenario with a key, and two operators.
pub const PEERS: usize = 1024;

/// Any wire format, with room for a key.
pub type HostWire = AnyWire<Box<Sealed<PEERS>>, Box<Signed<PEERS>>>;

/// What a robot speaks at its start number `starts`, without a past. By the rule of [`Sealed`], and that of
/// [`Signing`](staya_mavlink::signing::Signing) for robots without a clock: what was stored before each start is less
/// than a minute of timestamps behind.
#[must_use]
pub fn wire(format: Format, key: Option<&Key>, starts: u8) -> HostWire {
    on_link(format, key, starts, 0)
}

/// What an operator beside the robots speaks, and his number: see [`any::operator`] for the `link`.
#[must_use]
pub fn operator(format: Format, key: Option<&Key>, link: u8) -> (HostWire, RobotId) {
    (on_link(format, key, u8::MAX, link), any::operator(format, key.is_some(), link))
}

fn on_link(format: Format, key: Option<&Key>, starts: u8, link: u8) -> HostWire {
    let Some(key) = key else {
        return HostWire::new(format);
    };
    let wire = HostWire::keyed(format, key, starts.into(), link, u64::from(starts) * MINUTE);
    wire.expect("a byte is less than 2^20")
}
