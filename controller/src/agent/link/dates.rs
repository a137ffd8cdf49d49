//! Dates the frames of authenticated senders, whose numbers count beacon periods: an attacker that
//! repeats a frame which this robot has not received cannot make it younger than it is.

use super::{Link, Protocol};
use crate::robot::RobotId;
use crate::scalar::Scalar;
use crate::time::{Duration, Instant};
use crate::wire::{Arrival, Header, MOST_PERIODS, SequenceWindow, Wire, next_beacon};
use serde::{Deserialize, Serialize};

/// A clock may be slower than this robot's by 1/32, as RC oscillators are.
const DRIFT: u32 = 5;

/// The longest silence after which a sender's numbers still say when it sent a frame.
const LONGEST: Duration = Duration::from_millis(30 * 60 * 1000);

/// The numbers and the time of the frames of one sender.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Sender {
    pub(super) id: RobotId,
    pub(super) window: SequenceWindow,
    /// When it sent the newest frame, at the latest.
    sent: Instant,
}

impl Sender {
    /// A robot of which no frame was received.
    pub(super) const fn silent(id: RobotId) -> Self {
        Self { id, window: SequenceWindow::new(), sent: Instant::from_micros(0) }
    }

    /// A robot with its first frame.
    pub(super) fn first(id: RobotId, header: Header, sent: Instant) -> Self {
        let mut window = SequenceWindow::new();
        let _ = window.check(header);
        Self { id, window, sent }
    }

    /// Classifies and records a frame. Returns also when it was sent at the latest: `heard_at` if
    /// it was not delayed beyond the latency.
    ///
    /// The newest frame was sent at the latest at `sent`, and this one as many periods later as
    /// their numbers say. A frame may come earlier than assumed, by up to the latency, so a later
    /// one that comes later by so much need not have been delayed.
    pub(super) fn date(&mut self, header: Header, heard_at: Instant, by: &Pace) -> (Arrival, Instant) {
        let is_first = self.window == SequenceWindow::new();
        let periods = self.window.periods(header);
        let arrival = self.window.check(header);
        if is_first || arrival == Arrival::Rebooted {
            self.sent = heard_at;
        } else if arrival.is_accepted() {
            let counted = by.period.saturating_mul(periods.into()).as_micros();
            let latest = self.sent + Duration::from_micros(counted.saturating_add(counted >> DRIFT));
            self.sent = earlier(latest, heard_at);
        }
        (arrival, earlier(self.sent + by.latency, heard_at))
    }
}

/// The beacon period and the latency of a swarm.
pub(super) struct Pace {
    pub(super) period: Duration,
    pub(super) latency: Duration,
}

const fn earlier(one: Instant, other: Instant) -> Instant {
    if one.is_before(other) { one } else { other }
}

impl<S: Scalar, const N: usize, W: Wire, Q: Protocol> Link<S, N, W, Q> {
    /// Remembers a sender, instead of one that is in no table any more if there are too many.
    pub(super) fn note_sender(&mut self, sender: Sender) {
        self.senders.retain(|known| known.id != sender.id);
        if self.senders.len() == N {
            let table = &self.table;
            let gone = self.senders.iter().map(|known| known.id).find(|id| !table.iter().any(|known| known.id == *id));
            self.senders.retain(|known| Some(known.id) != gone);
        }
        // Cannot fail: there are as many places as in the table.
        let _ = self.senders.push(sender);
    }

    /// Forgets the numbers of a sender before they can look older than they are. O(N).
    pub(super) fn forget_numbers(&mut self, now: Instant, period: Duration) {
        let longest = period.saturating_mul(MOST_PERIODS.into()).min(LONGEST);
        for sender in &mut self.senders {
            let silence = now.since(sender.sent);
            if silence < Duration::ZERO || silence > longest {
                *sender = Sender { sent: now, ..Sender::silent(sender.id) };
            }
        }
    }

    /// Gives the next beacon a number that counts the periods since the last one.
    pub(super) fn count_periods(&mut self, now: Instant, period: Duration) {
        if !self.wire.is_authenticated() {
            return;
        }
        let passed = now.since(self.counted).as_micros().checked_div(period.as_micros()).unwrap_or(1);
        let periods = u16::try_from(passed).unwrap_or(1).clamp(1, MOST_PERIODS);
        let counted = self.counted + period.saturating_mul(periods.into());
        self.counted = if self.has_sent && !now.is_before(counted) { counted } else { now };
        self.header.sequence = next_beacon(self.header.sequence, if self.has_sent { periods } else { 1 });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::agent::AgentConfig;
    use crate::geom::Position;
    use crate::neighbor::Neighbor;
    use crate::wire::{Beacon, Postcard};
    use proptest::prelude::*;

    const PACE: Pace = Pace { period: Duration::from_millis(100), latency: Duration::from_millis(50) };

    fn at(ms: u32) -> Instant {
        Instant::from_micros(1000 * ms)
    }

    fn header(sequence: u16) -> Header {
        Header { boot: 0, sender: RobotId(7), sequence }
    }

    /// A sender whose beacons 0 to 18 were heard without a delay from 0 to 0.9 s.
    fn heard() -> Sender {
        let mut sender = Sender::first(RobotId(7), header(0), at(0));
        for n in 1..10_u16 {
            let heard_at = at(100 * u32::from(n));
            assert_eq!(sender.date(header(2 * n), heard_at, &PACE), (Arrival::New, heard_at));
        }
        sender
    }

    #[test]
    fn a_repeated_frame_is_as_old_as_its_number_says() {
        for (n, delay_ms) in [(10, 1500), (15, 800), (20, 3000)] {
            let sent_ms = 100 * u32::from(n);
            let (arrival, date) = heard().date(header(2 * n), at(sent_ms + delay_ms), &PACE);
            assert_eq!(arrival, Arrival::New);
            let late_ms = date.since(at(sent_ms)).as_micros() / 1000;
            assert!((0..=50 + 11 * 100 / 32).contains(&late_ms), "beacon {n}: {late_ms} ms too young");
        }
    }

    #[test]
    fn an_attacker_that_delays_all_frames_gains_a_32nd_of_the_time() {
        let mut sender = heard();
        for n in 10..200 {
            // Each one is delayed more than the last.
            let sent_ms = 100 * u32::from(n);
            let (_, date) = sender.date(header(2 * n), at(sent_ms + 20 * u32::from(n)), &PACE);
            let most_ms = 50 + 100 * (i32::from(n) - 9) / 32;
            let late_ms = date.since(at(sent_ms)).as_micros() / 1000;
            assert!(late_ms <= most_ms, "beacon {n}: {late_ms} ms too young");
        }
    }

    #[test]
    fn delayed_frames_leave_prompt_ones_as_young_as_they_are() {
        let mut sender = heard();
        let _ = sender.date(header(30), at(3000), &PACE);
        assert_eq!(sender.date(header(62), at(3100), &PACE), (Arrival::New, at(3100)));
        assert_eq!(sender.date(header(64), at(3200), &PACE), (Arrival::New, at(3200)));
    }

    #[test]
    fn a_sender_that_paused_or_restarted_is_not_late() {
        // It counts the periods of its pause.
        let sequence = next_beacon(19, 40);
        assert_eq!(sequence, 98);
        assert_eq!(heard().date(header(sequence), at(4900), &PACE), (Arrival::New, at(4900)));
        let restarted = Header { boot: 1, ..header(0) };
        assert_eq!(heard().date(restarted, at(9000), &PACE), (Arrival::Rebooted, at(9000)));
    }

    #[test]
    fn the_even_number_of_a_period_is_its_beacons() {
        assert_eq!([next_beacon(8, 1), next_beacon(9, 1), next_beacon(8, 3)], [8, 10, 12]);
        assert_eq!(next_beacon(8, 0), 8, "a beacon that is early");
        assert_eq!(next_beacon(u16::MAX, 1), 0);
        assert!(next_beacon(0, u16::MAX) < 1 << 14, "it does not look older");
    }

    #[test]
    fn a_new_sender_replaces_one_that_is_in_no_table() {
        let config = AgentConfig::<f32>::new(RobotId(9), 0.2, Duration::from_millis(100));
        let mut link = Link::<f32, 3, Postcard, ()>::new(&config, Postcard);
        for id in [1, 2, 3] {
            link.note_sender(Sender::silent(RobotId(id)));
        }
        for id in [1, 3, 4] {
            let beacon = Beacon::default();
            let robot = Neighbor::from_beacon(RobotId(id), &beacon, <()>::ID, at(0));
            let _ = link.table.put(robot, Position::ORIGIN, at(0), |_| false);
        }
        for (id, known) in [(4, [1, 3, 4]), (3, [1, 4, 3])] {
            link.note_sender(Sender::silent(RobotId(id)));
            assert!(link.senders.iter().map(|sender| sender.id.0).eq(known), "{id}: {:?}", link.senders);
        }
    }

    #[test]
    fn numbers_are_forgotten_before_they_wrap_after_half_an_hour_and_if_the_clock_has_wrapped() {
        let config = AgentConfig::<f32>::new(RobotId(9), 0.2, Duration::from_millis(100));
        let is_kept = |period_ms: i32, silence: Duration| {
            let mut link = Link::<f32, 3, Postcard, ()>::new(&config, Postcard);
            let now = at(2_000_000) + Duration::from_micros(1);
            link.note_sender(Sender { sent: now - silence, ..heard() });
            link.forget_numbers(now, Duration::from_millis(period_ms));
            assert!(link.senders.iter().all(|sender| sender.id == RobotId(7)));
            link.senders.iter().all(|sender| sender.window == heard().window)
        };
        let micro = Duration::from_micros;
        let half_an_hour = 30 * 60 * 1_000_000;
        // 8192 periods of 10 ms.
        for (period_ms, longest_us) in [(10, 81_920_000), (1000, half_an_hour)] {
            for (silence_us, wanted) in [(-1, false), (0, true), (longest_us, true), (longest_us + 1, false)] {
                assert_eq!(is_kept(period_ms, micro(silence_us)), wanted, "{period_ms} ms, {silence_us} us");
            }
        }
    }

    proptest! {
        #[test]
        fn frames_within_the_latency_are_not_delayed(early_ms in proptest::collection::vec(0_u32..=50, 1..60)) {
            let mut sender = Sender::first(RobotId(7), header(0), at(100));
            for (n, early_ms) in (1_u16..).zip(early_ms) {
                let heard_at = at(100 + 100 * u32::from(n) - early_ms);
                prop_assert_eq!(sender.date(header(2 * n), heard_at, &PACE).1, heard_at);
            }
        }
    }
}
