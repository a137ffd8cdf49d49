use std::collections::{HashMap, VecDeque};
use std::net::SocketAddr;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

pub(super) const QUEUE: usize = 512;
/// Time that an answer costs its source: 1000 per second.
const ANSWER: Duration = Duration::from_millis(1);
/// Cost at once: 1000 answers.
const BURST: Duration = Duration::from_secs(1);

/// The other end of a link.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Peer {
    /// A socket address.
    Address(SocketAddr),
    /// The other end of a serial port.
    Wire,
}

/// A received frame.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Received {
    /// Index of the link in [`Lines::open`](super::Lines::open).
    pub line: usize,
    /// Sender.
    pub peer: Peer,
    /// One whole frame, see [`staya_mavlink::frame::RawFrame`].
    pub frame: Vec<u8>,
}

type Source = (usize, Option<Peer>);

#[derive(Debug, Default)]
struct Waiting {
    queues: HashMap<Source, VecDeque<Received>>,
    /// Sources in the order of service.
    turn: VecDeque<Source>,
    paid_at: HashMap<Source, Instant>,
    served: Option<Source>,
}

#[derive(Debug, Default)]
pub(super) struct Inbox {
    waiting: Mutex<Waiting>,
    news: Condvar,
}

impl Inbox {
    fn lock(&self) -> MutexGuard<'_, Waiting> {
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns false if the queue is full.
    pub(super) fn put(&self, received: Received, is_known: bool) -> bool {
        let source = (received.line, is_known.then_some(received.peer));
        let mut waiting = self.lock();
        let queue = waiting.queues.entry(source).or_default();
        if queue.len() >= QUEUE {
            return false;
        }
        queue.push_back(received);
        if queue.len() == 1 {
            waiting.turn.push_back(source);
            self.news.notify_one();
        }
        true
    }

    /// O(peers).
    pub(super) fn next(&self, timeout: Duration) -> Option<Received> {
        let until = Instant::now() + timeout;
        let mut waiting = self.lock();
        loop {
            let now = Instant::now();
            if let Some(received) = waiting.next(now) {
                return Some(received);
            }
            let next = waiting.paid_at.values().copied().filter_map(|at| at.checked_sub(BURST));
            let wake = next.filter(|at| *at > now).fold(until, Instant::min);
            if now >= until {
                return None;
            }
            let waited = self.news.wait_timeout(waiting, wake.saturating_duration_since(now));
            waiting = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
    }

    pub(super) fn len(&self) -> u64 {
        self.lock().queues.values().map(|queue| queue.len() as u64).sum()
    }

    /// A source above its limit is not served for a while.
    pub(super) fn charge(&self, answers: usize) {
        let mut waiting = self.lock();
        let cost = ANSWER * u32::try_from(answers).unwrap_or(u32::MAX).min(1 << 20);
        if let Some(source) = waiting.served.filter(|_| !cost.is_zero()) {
            let now = Instant::now();
            waiting.paid_at.retain(|_, at| *at > now);
            let at = waiting.paid_at.entry(source).or_insert(now);
            *at += cost;
        }
    }
}

impl Waiting {
    fn next(&mut self, now: Instant) -> Option<Received> {
        for _ in 0..self.turn.len() {
            let source = self.turn.pop_front()?;
            if self.paid_at.get(&source).is_some_and(|at| at.saturating_duration_since(now) > BURST) {
                self.turn.push_back(source);
                continue;
            }
            let queue = self.queues.get_mut(&source)?;
            let received = queue.pop_front();
            if queue.is_empty() {
                self.queues.remove(&source);
            } else {
                self.turn.push_back(source);
            }
            self.served = Some(source);
            return received;
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn from(port: u16, frame: u8) -> Received {
        let peer = Peer::Address(SocketAddr::from(([127, 0, 0, 1], port)));
        Received { line: 0, peer, frame: vec![frame] }
    }

    fn next(inbox: &Inbox) -> Option<(u16, u8)> {
        let received = inbox.next(Duration::ZERO)?;
        let Peer::Address(address) = received.peer else {
            panic!("no address");
        };
        Some((address.port(), received.frame[0]))
    }

    #[test]
    fn a_flooding_peer_loses_only_its_own_frames() {
        let inbox = Inbox::default();
        let taken = (0..10_000).filter(|_| inbox.put(from(1, 0), true)).count();
        assert_eq!(taken, QUEUE);
        assert!(inbox.put(from(2, 1), true) && inbox.put(from(2, 2), true));
        let order: Vec<_> = (0..5).map(|_| next(&inbox).expect("a frame")).collect();
        assert_eq!(order, [(1, 0), (2, 1), (1, 0), (2, 2), (1, 0)]);
    }

    #[test]
    fn unknown_peers_share_one_queue() {
        let inbox = Inbox::default();
        let taken = (0..60_000).filter(|port| inbox.put(from(*port, 0), false)).count();
        assert_eq!(taken, QUEUE);
        assert!(inbox.put(from(1, 7), true));
        assert_eq!((next(&inbox), next(&inbox)), (Some((0, 0)), Some((1, 7))));
        let rest = std::iter::from_fn(|| next(&inbox)).count();
        assert_eq!(rest, QUEUE - 1);
        assert_eq!(inbox.lock().queues.len(), 0, "empty queues are removed");
    }

    #[test]
    fn a_peer_above_its_answer_limit_waits() {
        let inbox = Inbox::default();
        for port in [1, 2] {
            for frame in 0..3 {
                assert!(inbox.put(from(port, frame), true));
            }
        }
        assert_eq!(next(&inbox), Some((1, 0)));
        inbox.charge(100_000);
        let order: Vec<_> = std::iter::from_fn(|| next(&inbox)).collect();
        assert_eq!(order, [(2, 0), (2, 1), (2, 2)]);
        let later = Instant::now() + Duration::from_secs(120);
        assert_eq!(inbox.lock().next(later).map(|received| received.frame), Some(vec![1]));
    }

    #[test]
    fn a_waiting_receiver_wakes_up_for_a_frame() {
        let inbox = std::sync::Arc::new(Inbox::default());
        let other = std::sync::Arc::clone(&inbox);
        let thread = std::thread::spawn(move || other.next(Duration::from_secs(60)));
        assert!(inbox.put(from(1, 5), true));
        assert_eq!(thread.join().expect("no panic").map(|received| received.frame), Some(vec![5]));
    }
}
