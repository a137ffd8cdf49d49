//! The least travel time on land that changes, of somebody who knows all of it at all times.
//!
//! Dijkstra's algorithm over times of arrival. A cell is crossed at the pace that it has when it is entered, so it can be worth
//! waiting before it; then who comes earlier is never later, and the search is exact (S. E. Dreyfus, "An appraisal of some shortest-path
//! algorithms", Operations Research 17, 1969). Whoever waits may go on at any time here, robots only at ticks: a bound below all of them.

use super::walk::Changing;
use staya_controller::grid::{BLOCKED, Cell, Dir, Norm, UNIT};
use staya_sim::terrain::Terrain;
use staya_sim::terrain::change::change;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Scratch memory of searches.
#[derive(Default)]
pub(super) struct Foresight {
    /// By cell: from which ticks on it has which class.
    classes: Vec<Vec<(u32, u8)>>,
    arrival: Vec<u64>,
    queue: BinaryHeap<Reverse<(u64, u32)>>,
}

impl Foresight {
    /// The least time, [`UNIT`]ths of a tick; `None` when there is no way that takes at most `most`. Cells closed at some time are
    /// waited for, corners of closed cells may be cut. O((cells + changes) log cells).
    pub fn least_cost(
        &mut self,
        (land, changes, seed): Changing<'_>,
        [from, to]: [Cell; 2],
        norm: Norm,
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
                let there = self.crossed(next, now, dir.length(norm).into());
                if there <= most && there < self.arrival[next] {
                    self.arrival[next] = there;
                    self.queue.push(Reverse((there, next as u32)));
                }
            }
        }
        None
    }

    /// When a cell is crossed at the earliest by who is before it at `now`.
    fn crossed(&self, cell: usize, now: u64, length: u64) -> u64 {
        let classes = &self.classes[cell];
        let tick = now.div_ceil(u64::from(UNIT));
        let first = classes.partition_point(|&(since, _)| u64::from(since) <= tick).saturating_sub(1);
        let mut best = u64::MAX;
        for &(since, class) in &classes[first..] {
            // From just after the tick before on, decisions are those of this tick.
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

    /// Notes what all cells will be up to a tick.
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
                // What changes more than once in a tick is what it is then.
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
