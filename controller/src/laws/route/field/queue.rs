//! A ring of buckets by cost (Dial 1969), each a linked list in arrays.

pub(super) const RING: u32 = 64;
/// Zero, so that a zeroed queue is empty.
const NIL: u16 = 0;
pub(super) const MOST_CELLS: usize = u16::MAX as usize;

const fn name(cell: usize) -> u16 {
    cell.wrapping_add(1) as u16
}

const fn cell(name: u16) -> usize {
    (name as usize).wrapping_sub(1)
}

/// Cells 0 to `CELLS` - 1, each in at most one bucket. Numbers 64 apart are one bucket.
#[derive(Clone, Debug)]
pub(super) struct Queue<const CELLS: usize> {
    next: [u16; CELLS],
    previous: [u16; CELLS],
    /// The bucket that holds the cell plus one, or `NIL`.
    bucket: [u8; CELLS],
    heads: [u16; RING as usize],
    occupied: u64,
}

impl<const CELLS: usize> Queue<CELLS> {
    /// All zeros, so that it takes no flash in firmware.
    pub(super) const fn new() -> Self {
        Self { next: [0; CELLS], previous: [0; CELLS], bucket: [0; CELLS], heads: [0; RING as usize], occupied: 0 }
    }

    /// Removes the first `used` cells; no other cells may be in the queue. O(used).
    pub(super) fn clear(&mut self, used: usize) {
        for bucket in self.bucket.iter_mut().take(used) {
            *bucket = NIL as u8;
        }
        self.heads = [NIL; RING as usize];
        self.occupied = 0;
    }

    pub(super) const fn is_empty(&self) -> bool {
        self.occupied == 0
    }

    /// The first bucket with a cell from number `at` on. The queue must not be empty.
    pub(super) const fn next_from(&self, at: u32) -> u32 {
        at.saturating_add(self.occupied.rotate_right(at & (RING - 1)).trailing_zeros())
    }

    pub(super) fn holds(&self, cell: usize) -> bool {
        self.bucket.get(cell).is_some_and(|&bucket| u16::from(bucket) != NIL)
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = usize> + '_ {
        let heads = self.heads.iter().copied().filter(|&head| head != NIL);
        let cells = heads.flat_map(|head| {
            core::iter::successors(Some(head), |&at| self.next.get(cell(at)).copied().filter(|&next| next != NIL))
        });
        cells.map(cell)
    }

    /// The cell must be in no bucket.
    #[inline]
    pub(super) fn link(&mut self, at: usize, bucket: u32) {
        let slot = bucket & (RING - 1);
        let (Some(head), Some(next), Some(previous), Some(of)) = (
            self.heads.get_mut(slot as usize),
            self.next.get_mut(at),
            self.previous.get_mut(at),
            self.bucket.get_mut(at),
        ) else {
            return;
        };
        let second = *head;
        *next = second;
        *previous = NIL;
        *of = slot as u8 + 1;
        *head = name(at);
        if let Some(back) = self.previous.get_mut(cell(second)) {
            *back = name(at);
        }
        self.occupied |= 1 << slot;
    }

    #[inline]
    pub(super) fn unlink(&mut self, at: usize) {
        let Some(of) = self.bucket.get_mut(at) else {
            return;
        };
        let Some(slot) = of.checked_sub(1) else {
            return;
        };
        *of = NIL as u8;
        let next = self.next.get(at).copied().unwrap_or(NIL);
        let previous = self.previous.get(at).copied().unwrap_or(NIL);
        if let Some(back) = self.previous.get_mut(cell(next)) {
            *back = previous;
        }
        match self.next.get_mut(cell(previous)) {
            Some(forth) => *forth = next,
            None => {
                if let Some(head) = self.heads.get_mut(usize::from(slot)) {
                    *head = next;
                }
                if next == NIL {
                    self.occupied &= !(1 << slot);
                }
            }
        }
    }

    #[inline]
    pub(super) fn pop(&mut self, bucket: u32) -> Option<usize> {
        let head = self.heads.get((bucket & (RING - 1)) as usize).copied().filter(|&head| head != NIL)?;
        self.unlink(cell(head));
        Some(cell(head))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    #[test]
    fn cells_leave_in_the_order_of_their_buckets() {
        let mut queue = Queue::<8>::new();
        assert!(queue.is_empty());
        assert!(!queue.holds(0) && queue.iter().next().is_none());
        for (at, bucket) in [(1, 70), (2, 66), (3, 70), (4, 100)] {
            queue.link(at, bucket);
        }
        queue.unlink(4);
        queue.unlink(5);
        let mut left: Vec<usize> = queue.iter().collect();
        left.sort_unstable();
        assert_eq!(left, [1, 2, 3]);
        assert!(queue.holds(2) && !queue.holds(4) && !queue.holds(99));
        assert_eq!(queue.next_from(65), 66);
        assert_eq!((queue.pop(66), queue.pop(66)), (Some(2), None));
        assert_eq!(queue.next_from(66), 70);
        assert_eq!((queue.pop(70), queue.pop(70), queue.is_empty()), (Some(3), Some(1), true));
        queue.link(7, 0);
        queue.clear(8);
        assert!(queue.is_empty() && !queue.holds(7) && queue.iter().next().is_none());
    }
}
