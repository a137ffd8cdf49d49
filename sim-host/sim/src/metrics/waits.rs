//! Who waited for what, and for how long.

use serde::{Deserialize, Serialize};
use staya_controller::agent::Wait;
use staya_controller::names::Named;

/// One reason to wait, over a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WaitCount {
    /// What they waited for.
    pub wait: Wait,
    /// Robots that did so at some time.
    pub robots: usize,
    /// Robots that do so now.
    pub now: usize,
    /// Ticks of all these robots together.
    pub robot_ticks: u64,
    /// Ticks of the longest time on end.
    pub longest_ticks: u32,
}

/// What one robot waits for.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Robot {
    wait: Option<Wait>,
    /// For so many ticks.
    ticks: u32,
    /// What it has waited for at some time: a bit each.
    seen: u8,
}

/// Takes note of waits, tick by tick; 12 bytes per robot.
#[derive(Clone, Debug)]
pub struct Waits {
    robots: Vec<Robot>,
    counts: Vec<WaitCount>,
}

impl Waits {
    /// Nobody has waited yet.
    #[must_use]
    pub fn new(robots: usize) -> Self {
        let count = |&(_, wait)| WaitCount { wait, robots: 0, now: 0, robot_ticks: 0, longest_ticks: 0 };
        Self { robots: vec![Robot::default(); robots], counts: Wait::NAMES.iter().map(count).collect() }
    }

    /// Takes note of what robot number `index` waits for after a tick.
    ///
    /// # Panics
    /// When there is no such robot.
    pub fn note(&mut self, index: usize, wait: Option<Wait>) {
        let robot = &mut self.robots[index];
        if wait.is_none() && robot.wait.is_none() {
            return;
        }
        robot.ticks = if wait == robot.wait { robot.ticks + 1 } else { 1 };
        let before = std::mem::replace(&mut robot.wait, wait);
        for (bit, count) in self.counts.iter_mut().enumerate() {
            count.now -= usize::from(before == Some(count.wait));
            if wait == Some(count.wait) {
                count.now += 1;
                count.robots += usize::from(robot.seen & (1 << bit) == 0);
                robot.seen |= 1 << bit;
                count.robot_ticks += 1;
                count.longest_ticks = count.longest_ticks.max(robot.ticks);
            }
        }
    }

    /// The account of robot number `index`.
    pub(crate) fn robot(&self, index: usize) -> Robot {
        self.robots[index]
    }

    /// Puts it back.
    pub(crate) fn set_robot(&mut self, index: usize, robot: Robot) {
        let before = std::mem::replace(&mut self.robots[index], robot);
        for (bit, count) in self.counts.iter_mut().enumerate() {
            let of = |robot: &Robot| {
                let waits = robot.wait == Some(count.wait);
                (usize::from(waits), usize::from(robot.seen & (1 << bit) != 0))
            };
            let ((now_before, seen_before), (now, seen)) = (of(&before), of(&robot));
            count.now = count.now + now - now_before;
            count.robots = count.robots + seen - seen_before;
        }
    }

    /// A robot comes from another rank, behind those that are here.
    pub fn admit(&mut self) {
        self.robots.push(Robot::default());
    }

    /// Robot number `index` goes to another rank with its account; the last one takes its place.
    pub fn dismiss(&mut self, index: usize) {
        self.set_robot(index, Robot::default());
        self.robots.swap_remove(index);
    }

    /// For each reason the ticks of all robots together, and of the longest time on end.
    pub fn ticks(&self) -> Vec<(u64, u32)> {
        self.counts.iter().map(|count| (count.robot_ticks, count.longest_ticks)).collect()
    }

    /// Puts them back.
    pub fn set_ticks(&mut self, ticks: &[(u64, u32)]) {
        for (count, &(robot_ticks, longest_ticks)) in self.counts.iter_mut().zip(ticks) {
            (count.robot_ticks, count.longest_ticks) = (robot_ticks, longest_ticks);
        }
    }

    /// How many wait for something now; not those that have arrived beside their places.
    #[must_use]
    pub fn now(&self) -> usize {
        self.counts.iter().filter(|count| count.wait != Wait::Place).map(|count| count.now).sum()
    }

    /// All reasons; robots that have gone to another rank have left their ticks behind.
    pub fn all(&self) -> &[WaitCount] {
        &self.counts
    }

    /// The reasons that there were.
    #[must_use]
    pub fn counts(&self) -> Vec<WaitCount> {
        self.counts.iter().copied().filter(|count| count.robots > 0).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_robots_once_and_times_on_end() {
        let mut waits = Waits::new(2);
        let (turn, others) = (Some(Wait::Turn), Some(Wait::Others));
        for [one, two] in [[turn, None], [turn, others], [None, others], [turn, others], [others, None]] {
            waits.note(0, one);
            waits.note(1, two);
        }
        assert_eq!(waits.now(), 1);
        let expected = [(Wait::Turn, 1, 0, 3, 2), (Wait::Others, 2, 1, 4, 3)];
        let counts = waits.counts();
        let seen: Vec<_> = counts.iter().map(|c| (c.wait, c.robots, c.now, c.robot_ticks, c.longest_ticks)).collect();
        assert_eq!(seen, expected);
    }

    #[test]
    fn every_reason_has_a_bit() {
        assert!(Wait::NAMES.len() <= 8);
        let mut waits = Waits::new(1);
        for &(_, wait) in Wait::NAMES {
            waits.note(0, Some(wait));
        }
        assert_eq!(waits.counts().len(), Wait::NAMES.len());
    }
}
