//! Statistics of waiting robots.

use serde::{Deserialize, Serialize};
use staya_controller::agent::Wait;
use staya_controller::names::Named;

/// A cause of waiting, with totals over a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WaitCount {
    /// The cause.
    pub wait: Wait,
    /// Robots that waited for it at any time.
    pub robots: usize,
    /// Robots that wait for it now.
    pub now: usize,
    /// Sum of the waiting ticks of all robots.
    pub robot_ticks: u64,
    /// Longest uninterrupted wait, ticks.
    pub longest_ticks: u32,
}

#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Robot {
    wait: Option<Wait>,
    ticks: u32,
    /// Causes for which it has waited: one bit each.
    seen: u8,
}

/// Counts waits tick by tick; 12 bytes per robot.
#[derive(Clone, Debug)]
pub struct Waits {
    robots: Vec<Robot>,
    counts: Vec<WaitCount>,
}

impl Waits {
    /// Creates statistics without waits.
    #[must_use]
    pub fn new(robots: usize) -> Self {
        let count = |&(_, wait)| WaitCount { wait, robots: 0, now: 0, robot_ticks: 0, longest_ticks: 0 };
        Self { robots: vec![Robot::default(); robots], counts: Wait::NAMES.iter().map(count).collect() }
    }

    /// Records the wait of robot `index` after a tick.
    ///
    /// # Panics
    /// If there is no such robot.
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

    pub(crate) fn robot(&self, index: usize) -> Robot {
        self.robots[index]
    }

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

    /// Appends a robot that comes from another MPI rank.
    pub fn admit(&mut self) {
        self.robots.push(Robot::default());
    }

    /// Removes a robot that goes to another MPI rank; the last robot takes its index.
    pub fn dismiss(&mut self, index: usize) {
        self.set_robot(index, Robot::default());
        self.robots.swap_remove(index);
    }

    /// For each cause, the ticks of all robots and the longest wait.
    pub fn ticks(&self) -> Vec<(u64, u32)> {
        self.counts.iter().map(|count| (count.robot_ticks, count.longest_ticks)).collect()
    }

    /// Restores the value of [`Waits::ticks`].
    pub fn set_ticks(&mut self, ticks: &[(u64, u32)]) {
        for (count, &(robot_ticks, longest_ticks)) in self.counts.iter_mut().zip(ticks) {
            (count.robot_ticks, count.longest_ticks) = (robot_ticks, longest_ticks);
        }
    }

    /// Number of robots that wait now, without those that have arrived next to their goal.
    #[must_use]
    pub fn now(&self) -> usize {
        self.counts.iter().filter(|count| count.wait != Wait::GoalTaken).map(|count| count.now).sum()
    }

    /// All causes. Ticks of robots that went to another rank stay here.
    pub fn all(&self) -> &[WaitCount] {
        &self.counts
    }

    /// The causes that occurred.
    #[must_use]
    pub fn counts(&self) -> Vec<WaitCount> {
        self.counts.iter().copied().filter(|count| count.robots > 0).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn robots_count_once_and_waits_are_uninterrupted() {
        let mut waits = Waits::new(2);
        let (turn, others) = (Some(Wait::Turn), Some(Wait::Robots));
        for [one, two] in [[turn, None], [turn, others], [None, others], [turn, others], [others, None]] {
            waits.note(0, one);
            waits.note(1, two);
        }
        assert_eq!(waits.now(), 1);
        let expected = [(Wait::Turn, 1, 0, 3, 2), (Wait::Robots, 2, 1, 4, 3)];
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
