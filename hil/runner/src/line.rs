use staya_controller::rand::Rng;
use std::collections::VecDeque;
use std::time::Duration;

const PURPOSES: [u32; 2] = [u32::from_be_bytes(*b"to d"), u32::from_be_bytes(*b"from")];

/// Faults of a line, such as a bad cable or a radio, equal in both directions; none by default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LineFaults {
    /// Probability that a frame is lost.
    pub loss: f64,
    /// Probability that a bit flips.
    pub bit_errors: f64,
    /// Additional delay of each frame.
    pub delay: Duration,
    /// Seed of the random numbers.
    pub seed: u64,
}

#[derive(Debug)]
pub struct Line {
    faults: LineFaults,
    purpose: u32,
    robot: u32,
    /// Frames so far; each has its own random numbers.
    frames: u32,
    open: Vec<u8>,
    on_the_way: VecDeque<(u64, Vec<u8>)>,
}

impl Line {
    /// `direction` is to the device (0) or from it (1).
    pub fn new(faults: LineFaults, direction: usize, robot: u32) -> Self {
        Self {
            faults,
            purpose: PURPOSES.get(direction).copied().unwrap_or_default(),
            robot,
            frames: 0,
            open: Vec::new(),
            on_the_way: VecDeque::new(),
        }
    }

    /// Complete frames are put in transit.
    pub fn push(&mut self, bytes: &[u8], now_us: u64) {
        let is_perfect = self.faults.loss <= 0.0 && self.faults.bit_errors <= 0.0;
        let due_us = now_us.saturating_add(micros(self.faults.delay));
        if is_perfect {
            self.on_the_way.push_back((due_us, bytes.to_vec()));
            return;
        }
        for &byte in bytes {
            self.open.push(byte);
            if byte != 0 {
                continue;
            }
            let frame = std::mem::take(&mut self.open);
            let frame = if frame.len() > 1 { self.fate(frame) } else { Some(frame) };
            self.on_the_way.extend(frame.map(|frame| (due_us, frame)));
        }
    }

    fn fate(&mut self, mut frame: Vec<u8>) -> Option<Vec<u8>> {
        let LineFaults { loss, bit_errors, seed, .. } = self.faults;
        let mut rng = Rng::keyed(seed, self.purpose, self.robot, self.frames);
        self.frames = self.frames.wrapping_add(1);
        if rng.chance_q32(q32(loss)) {
            return None;
        }
        if bit_errors > 0.0 {
            let probability = q32(bit_errors);
            for byte in &mut frame {
                for bit in 0..8 {
                    *byte ^= u8::from(rng.chance_q32(probability)) << bit;
                }
            }
        }
        Some(frame)
    }

    /// Arrival time of the next bytes.
    pub fn next_us(&self) -> Option<u64> {
        self.on_the_way.front().map(|(due, _)| *due)
    }

    pub fn pop(&mut self, now_us: u64) -> Option<Vec<u8>> {
        let (due_us, _) = self.on_the_way.front()?;
        if *due_us > now_us {
            return None;
        }
        self.on_the_way.pop_front().map(|(_, bytes)| bytes)
    }
}

fn q32(probability: f64) -> u32 {
    (probability * 4_294_967_296.0) as u32
}

pub fn micros(span: Duration) -> u64 {
    u64::try_from(span.as_micros()).unwrap_or(u64::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn through(faults: LineFaults, frames: usize) -> Vec<Vec<u8>> {
        let mut line = Line::new(faults, 0, 7);
        let frame = [0, 1, 2, 3, 0];
        for _ in 0..frames {
            line.push(&frame[..2], 10);
            line.push(&frame[2..], 10);
        }
        std::iter::from_fn(|| line.pop(10_000)).collect()
    }

    #[test]
    fn perfect_line_changes_nothing() {
        let bytes = through(LineFaults::default(), 3).concat();
        assert_eq!(bytes, [0, 1, 2, 3, 0].repeat(3));
    }

    #[test]
    fn losses_and_flips_follow_their_probabilities_and_their_seed() {
        let loss = LineFaults { loss: 0.25, seed: 3, ..LineFaults::default() };
        let frames = |faults| {
            let pieces = through(faults, 4000);
            pieces.into_iter().filter(|piece| piece.len() > 1).collect::<Vec<_>>()
        };
        let kept = frames(loss).len();
        assert!((2900..3100).contains(&kept), "{kept}");
        let flips = LineFaults { bit_errors: 0.01, seed: 3, ..LineFaults::default() };
        let damaged = frames(flips).iter().filter(|frame| **frame != [1, 2, 3, 0]).count();
        // 1 - 0.99^32 of 4000.
        assert!((1000..1200).contains(&damaged), "{damaged}");
        assert_eq!(frames(flips), frames(flips));
        assert_ne!(frames(flips), frames(LineFaults { seed: 4, ..flips }));
    }

    #[test]
    fn delayed_frames_arrive_late_and_in_order() {
        let delay = Duration::from_millis(2);
        let mut line = Line::new(LineFaults { delay, ..LineFaults::default() }, 1, 7);
        line.push(&[1, 0], 100);
        line.push(&[2, 0], 150);
        assert_eq!((line.next_us(), line.pop(2099)), (Some(2100), None));
        assert_eq!(line.pop(2149), Some(vec![1, 0]));
        assert_eq!((line.pop(2149), line.pop(2150)), (None, Some(vec![2, 0])));
    }
}
