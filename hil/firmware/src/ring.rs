//! Queue between the receive interrupt and the main loop.

use core::sync::atomic::{AtomicU8, AtomicU32, AtomicUsize, Ordering};

/// First-in first-out queue of at most `N - 1` bytes for one writer and one reader, of which one
/// may be an interrupt handler. Loads and stores only: a Cortex-M0 has no other atomic operations.
pub struct Ring<const N: usize> {
    bytes: [AtomicU8; N],
    /// Stored by the writer only.
    head: AtomicUsize,
    /// Stored by the reader only.
    tail: AtomicUsize,
    /// Stored by the writer only.
    lost: AtomicU32,
}

impl<const N: usize> Ring<N> {
    const IS_POWER_OF_TWO: () = assert!(N.is_power_of_two() && N >= 2);

    /// Creates an empty queue.
    #[must_use]
    pub const fn new() -> Self {
        let () = Self::IS_POWER_OF_TWO;
        Self {
            bytes: [const { AtomicU8::new(0) }; N],
            head: AtomicUsize::new(0),
            tail: AtomicUsize::new(0),
            lost: AtomicU32::new(0),
        }
    }

    /// Adds a byte. If the queue is full, the byte is dropped and counted. O(1).
    pub fn push(&self, byte: u8) {
        let head = self.head.load(Ordering::Relaxed);
        let next = head.wrapping_add(1) & (N - 1);
        match self.bytes.get(head) {
            Some(place) if next != self.tail.load(Ordering::Acquire) => {
                place.store(byte, Ordering::Relaxed);
                self.head.store(next, Ordering::Release);
            }
            _ => self.lose(),
        }
    }

    /// Counts a byte that was lost before it could be added, such as by an overrun of the UART.
    pub fn lose(&self) {
        let lost = self.lost.load(Ordering::Relaxed);
        self.lost.store(lost.saturating_add(1), Ordering::Relaxed);
    }

    /// Takes the oldest byte. O(1).
    pub fn pop(&self) -> Option<u8> {
        let tail = self.tail.load(Ordering::Relaxed);
        if tail == self.head.load(Ordering::Acquire) {
            return None;
        }
        let byte = self.bytes.get(tail)?.load(Ordering::Relaxed);
        self.tail.store(tail.wrapping_add(1) & (N - 1), Ordering::Release);
        Some(byte)
    }

    /// Whether the queue is empty.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.tail.load(Ordering::Relaxed) == self.head.load(Ordering::Acquire)
    }

    /// Whether another byte fits; for the writer.
    #[must_use]
    pub fn has_room(&self) -> bool {
        let next = self.head.load(Ordering::Relaxed).wrapping_add(1) & (N - 1);
        next != self.tail.load(Ordering::Acquire)
    }

    /// Bytes lost since the start.
    #[must_use]
    pub fn lost(&self) -> u32 {
        self.lost.load(Ordering::Relaxed)
    }
}

impl<const N: usize> Default for Ring<N> {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_stay_in_order_across_the_end_of_the_buffer() {
        let ring = Ring::<8>::new();
        let mut next_out = 0u8;
        for byte in 0..200u8 {
            ring.push(byte);
            if byte % 5 == 4 {
                for _ in 0..5 {
                    assert_eq!(ring.pop(), Some(next_out));
                    next_out += 1;
                }
                assert_eq!(ring.pop(), None);
                assert!(ring.is_empty());
            }
        }
        assert_eq!(ring.lost(), 0);
    }

    #[test]
    fn full_ring_drops_and_counts_the_newest_byte() {
        let ring = Ring::<4>::new();
        for byte in 1..=5 {
            assert_eq!(ring.has_room(), byte <= 3);
            ring.push(byte);
        }
        assert_eq!(ring.lost(), 2);
        let left: Vec<u8> = std::iter::from_fn(|| ring.pop()).collect();
        assert_eq!(left, [1, 2, 3]);
        ring.push(9);
        assert_eq!(ring.pop(), Some(9));
    }

    #[test]
    fn writer_and_reader_may_run_concurrently() {
        let ring = Ring::<16>::new();
        std::thread::scope(|scope| {
            scope.spawn(|| {
                for n in 0..10_000u32 {
                    while ring.tail.load(Ordering::Acquire) == (ring.head.load(Ordering::Relaxed) + 1) & 15 {
                        std::thread::yield_now();
                    }
                    ring.push(n as u8);
                }
            });
            for n in 0..10_000u32 {
                let byte = loop {
                    if let Some(byte) = ring.pop() {
                        break byte;
                    }
                    std::thread::yield_now();
                };
                assert_eq!(byte, n as u8);
            }
        });
        assert_eq!(ring.lost(), 0);
    }
}
