use std::sync::Arc;

pub(super) const MOST: usize = 256 << 20;

/// Frames by tick. Above the limit every second one is dropped, and added from then on.
#[derive(Clone, Debug)]
pub(super) struct Memory {
    frames: Vec<(u32, Arc<[u8]>)>,
    bytes: usize,
    most: usize,
    every: u32,
}

impl Default for Memory {
    fn default() -> Self {
        Self { frames: Vec::new(), bytes: 0, most: MOST, every: 1 }
    }
}

impl Memory {
    /// Drops frames from this tick on.
    pub fn put(&mut self, tick: u32, frame: &[u8]) {
        self.forget_from(tick);
        if !tick.is_multiple_of(self.every) {
            return;
        }
        self.bytes += frame.len();
        self.frames.push((tick, frame.into()));
        while self.bytes > self.most && self.frames.len() > 2 && self.every <= u32::MAX / 2 {
            self.every *= 2;
            let every = self.every;
            self.frames.retain(|(tick, _)| tick.is_multiple_of(every));
            self.bytes = self.frames.iter().map(|(_, frame)| frame.len()).sum();
        }
    }

    pub fn forget_from(&mut self, tick: u32) {
        while self.frames.last().is_some_and(|(last, _)| *last >= tick) {
            let gone = self.frames.pop();
            self.bytes -= gone.map_or(0, |(_, frame)| frame.len());
        }
    }

    pub fn last(&self) -> Option<u32> {
        self.frames.last().map(|(tick, _)| *tick)
    }

    /// The last frame at or before a tick.
    pub fn at(&self, tick: u32) -> Option<&[u8]> {
        let behind = self.frames.partition_point(|(kept, _)| *kept <= tick);
        self.frames.get(behind.checked_sub(1)?).map(|(_, frame)| &**frame)
    }

    /// Size of the stored frames.
    pub const fn bytes(&self) -> usize {
        self.bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_stays_within_its_limit_and_thins_out_evenly() {
        let mut memory = Memory { most: 1000, ..Memory::default() };
        for tick in 0..1000_u32 {
            memory.put(tick, &[tick as u8; 10]);
            assert!(memory.bytes <= 1000);
            assert_eq!(memory.bytes, memory.frames.iter().map(|(_, frame)| frame.len()).sum::<usize>());
        }
        let ticks: Vec<u32> = memory.frames.iter().map(|(tick, _)| *tick).collect();
        assert!(ticks.len() > 40 && ticks[0] == 0 && ticks.windows(2).all(|pair| pair[1] - pair[0] == memory.every));
        assert_eq!(memory.at(999).map(|frame| frame[0]), ticks.last().map(|tick| *tick as u8));
        memory.forget_from(500);
        assert!(memory.frames.iter().all(|(tick, _)| *tick < 500));
        memory.put(512, &[7; 10]);
        assert_eq!(memory.at(600), Some(&[7; 10][..]));
        memory.forget_from(0);
        assert_eq!((memory.bytes, memory.at(5)), (0, None));
    }
}
