//! Faults of single radios and links: which packets they remove.

use super::medium::Packet;
use super::params::{RadioFault, q32};
use staya_controller::rand::Rng;
use staya_controller::robot::RobotId;

const FAULT: u32 = 0x0052_0004;

/// The faults of a radio. They have no state.
#[derive(Clone, Debug)]
pub(super) struct Faults(Vec<Fault>);

#[derive(Clone, Debug)]
struct Fault {
    from: Ends,
    to: Ends,
    both_ways: bool,
    /// Probability of loss, Q0.32.
    loss: u32,
    /// Begin and end, microseconds after the start.
    span_us: [f64; 2],
}

/// Sorted numbers of robots; `None`: all robots.
#[derive(Clone, Debug)]
struct Ends(Option<Vec<RobotId>>);

impl Faults {
    pub(super) fn new(faults: &[RadioFault]) -> Self {
        Self(faults.iter().map(Fault::new).collect())
    }

    /// Whether a fault removes the packet. Draws of its own keep the fates of all other packets
    /// independent of faults. O(faults log robots).
    pub(super) fn remove(&self, packet: &Packet, receiver: RobotId, now_us: f64) -> bool {
        let mut active = self.0.iter().filter(|fault| fault.is_active(now_us, packet.sender, receiver)).peekable();
        if active.peek().is_none() {
            return false;
        }
        let mut draws = Rng::keyed(packet.key, FAULT, receiver.0, packet.number);
        active.any(|fault| draws.chance_q32(fault.loss))
    }
}

impl Fault {
    fn new(fault: &RadioFault) -> Self {
        let RadioFault { from, to, both_ways, loss, at_s, for_s } = fault;
        let end_s = for_s.map_or(f64::INFINITY, |for_s| at_s + for_s);
        Self {
            from: Ends::new(from.as_deref()),
            to: Ends::new(to.as_deref()),
            both_ways: *both_ways,
            loss: q32(*loss),
            span_us: [at_s * 1e6, end_s * 1e6],
        }
    }

    fn is_active(&self, now_us: f64, sender: RobotId, receiver: RobotId) -> bool {
        let [begin_us, end_us] = self.span_us;
        let is_on = |from, to| self.from.has(from) && self.to.has(to);
        begin_us <= now_us && now_us < end_us && (is_on(sender, receiver) || self.both_ways && is_on(receiver, sender))
    }
}

impl Ends {
    fn new(numbers: Option<&[u32]>) -> Self {
        Self(numbers.map(|numbers| {
            let mut ids: Vec<_> = numbers.iter().copied().map(RobotId).collect();
            ids.sort_unstable();
            ids
        }))
    }

    fn has(&self, id: RobotId) -> bool {
        self.0.as_ref().is_none_or(|ids| ids.binary_search(&id).is_ok())
    }
}
