//! The smallest travel time on changing land, with perfect knowledge of all changes.
//!
//! Dijkstra's algorithm over arrival times. A cell is crossed at its pace on entry, so waiting may
//! pay off. With waiting, an earlier arrival is never worse, and the search is exact (S. E.
//! Dreyfus, "An appraisal of some shortest-path algorithms", Operations Research 17, 1969). Here, a
//! wait may end between two ticks, so the result is a lower bound for robots.

use super::{Kind, Probe};
use staya_controller::grid::{BLOCKED, Cell, Dir, Norm, UNIT};
use staya_sim::engine::Outcome;
use staya_sim::scenario::Scenario;
use staya_sim::terrain::Terrain;
use staya_sim::terrain::change::{LandChange, change};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

pub const KIND: Kind = Kind {
    name: "foresight",
    measures: &[(
        "loss_percent",
        "travel time of the first robot above the least one, percent; empty: it did not arrive",
    )],
    new: |_| Box::new(Least),
};

struct Least;

impl Probe for Least {
    fn values(&self, scenario: &Scenario, outcome: &Outcome) -> Vec<Option<f64>> {
        let (robot, time) = (scenario.robots.first(), outcome.arrival_times.first().copied().flatten());
        let loss = robot.zip(time).map(|(robot, time)| {
            let land = (&scenario.land.terrain, &scenario.land.changes[..], scenario.seed);
            let ends = [robot.start, robot.goal];
            // The least travel time is at most that of the robot.
            let params = scenario.route().params;
            let moves = (params.norm, params.corner_cutting);
            let least = Foresight::default().least_cost(land, ends, moves, time).unwrap_or(time);
            100.0 * (time as f64 / least.max(1) as f64 - 1.0)
        });
        vec![loss]
    }
}

/// Land, its changes and the seed of random ones.
type Changing<'a> = (&'a Terrain, &'a [LandChange], u64);

#[derive(Default)]
struct Foresight {
    classes: Vec<Vec<(u32, u8)>>,
    arrival: Vec<u64>,
    queue: BinaryHeap<Reverse<(u64, u32)>>,
}

impl Foresight {
    /// Smallest travel time, [`UNIT`]ths of a tick; `None` above `most`. Routes may wait for closed
    /// cells, and cut corners of cells that open at some time. O((cells + changes) log cells).
    fn least_cost(
        &mut self,
        (land, changes, seed): Changing<'_>,
        [from, to]: [Cell; 2],
        (norm, corner_cutting): (Norm, bool),
        most: u64,
    ) -> Option<u64> {
        self.foresee((land, changes, seed), most.div_ceil(u64::from(UNIT)) as u32);
        self.arrival.clear();
        self.arrival.resize(land.cells().len(), u64::MAX);
        self.queue.clear();
        let (start, goal) = (land.index(from)?, land.index(to)?);
        self.arrival[start] = 0;
        self.queue.push(Reverse((0, start as u32)));
        while let Some(Reverse((now, at))) = self.queue.pop() {
            let at = at as usize;
            if at == goal {
                return Some(now);
            }
            if now > self.arrival[at] {
                continue;
            }
            let cell = cell_of(land, at);
            for dir in Dir::MOVES {
                let Some(next) = land.index(cell + dir.offset()) else { continue };
                let Cell { x, y } = dir.offset();
                let is_wall = |side: Cell| land.index(cell + side).is_some_and(|at| self.is_wall(at));
                if dir.is_diagonal() && !corner_cutting && [Cell::new(x, 0), Cell::new(0, y)].into_iter().any(is_wall) {
                    continue;
                }
                let there = self.crossed(next, now, dir.length(norm).into());
                if there <= most && there < self.arrival[next] {
                    self.arrival[next] = there;
                    self.queue.push(Reverse((there, next as u32)));
                }
            }
        }
        None
    }

    /// Whether a cell never opens.
    fn is_wall(&self, cell: usize) -> bool {
        self.classes[cell].iter().all(|&(_, class)| class == BLOCKED)
    }

    fn crossed(&self, cell: usize, now: u64, length: u64) -> u64 {
        let classes = &self.classes[cell];
        let tick = now.div_ceil(u64::from(UNIT));
        let first = classes.partition_point(|&(since, _)| u64::from(since) <= tick).saturating_sub(1);
        let mut best = u64::MAX;
        for &(since, class) in &classes[first..] {
            // Decisions right after the previous tick count for this tick.
            let start = now.max((u64::from(since) * u64::from(UNIT)).saturating_sub(u64::from(UNIT) - 1));
            if start + length >= best {
                break;
            }
            if class != BLOCKED {
                best = best.min(start + length * u64::from(class));
            }
        }
        best
    }

    fn foresee(&mut self, (land, changes, seed): Changing<'_>, last: u32) {
        let mut land = land.clone();
        self.classes.resize_with(land.cells().len(), Vec::new);
        for (classes, class) in self.classes.iter_mut().zip(land.cells()) {
            classes.clear();
            classes.push((0, *class));
        }
        let width = usize::from(land.width());
        for tick in 0..=last {
            let classes = &mut self.classes;
            change(&mut land, changes, seed, tick, |cell, class| {
                let classes = &mut classes[cell.y as usize * width + cell.x as usize];
                // The last change in a tick holds.
                classes.pop_if(|(since, _)| *since == tick);
                classes.push((tick, class));
            });
        }
    }
}

fn cell_of(land: &Terrain, at: usize) -> Cell {
    let width = usize::from(land.width());
    Cell::new((at % width) as i16, (at / width) as i16)
}

#[cfg(test)]
mod tests;
