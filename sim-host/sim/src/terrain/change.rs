//! Changes of the terrain during a run: u(t, (i, j)) of A. V. Kuznetsov 2017 (KUZ), section 2.
//!
//! A change is a function of the rules, the seed, the tick and the terrain before it, so that every
//! MPI rank and every repetition of a run has the same terrain at the same tick.

use super::Terrain;
use staya_controller::grid::{BLOCKED, Cell};
use staya_controller::rand::Rng;
use std::num::NonZeroU32;

const DRIFT: u32 = 0x004C_0001;

/// A rule that changes the terrain.
#[derive(Clone, Debug, PartialEq)]
pub struct LandChange {
    /// First tick before which the rule applies.
    pub first: u32,
    /// Period in ticks; `None`: once.
    pub every: Option<NonZeroU32>,
    /// Effect of the rule.
    pub kind: ChangeKind,
}

/// Effect of a rule.
#[derive(Clone, Debug, PartialEq)]
pub enum ChangeKind {
    /// Cells get another crossing time, or close.
    Become {
        /// Cells, each with the class that it reverts to.
        cells: Vec<(Cell, u8)>,
        /// Ticks to cross the cells; [`BLOCKED`]: closed.
        class: u8,
        /// Duration of the change, ticks; `None`: until the end of the run.
        lasts: Option<NonZeroU32>,
    },
    /// Random cells become slower or faster with equal probability; closed cells stay closed.
    Drift {
        /// The cells; `None`: the whole terrain.
        cells: Option<Vec<Cell>>,
        /// Number of draws each time; a cell may be drawn more than once.
        draws: u32,
        /// Change in ticks.
        step: u8,
        /// Largest crossing time of a cell, ticks; the smallest is 1.
        classes: u8,
    },
}

impl LandChange {
    /// Cells that change before `tick`, with their new class; `land` is the terrain before the
    /// change, and `number` the index of the rule in the run. O(cells of the rule that change).
    #[must_use]
    pub fn due(&self, number: usize, seed: u64, tick: u32, land: &Terrain) -> Vec<(Cell, u8)> {
        match &self.kind {
            ChangeKind::Become { cells, class, lasts } => match self.phase(tick) {
                Some(0) => cells.iter().map(|&(cell, _)| (cell, *class)).collect(),
                Some(phase) if lasts.is_some_and(|lasts| lasts.get() == phase) => cells.clone(),
                _ => Vec::new(),
            },
            ChangeKind::Drift { cells, draws, step, classes } if self.phase(tick) == Some(0) => {
                let mut rng = Rng::keyed(seed, DRIFT, number as u32, tick);
                let (width, count) = (u32::from(land.width()), land.cells().len());
                let count = cells.as_ref().map_or(count, Vec::len) as u32;
                let draw = |_| {
                    let at = rng.below(count);
                    let cell = match cells {
                        Some(cells) => cells[at as usize],
                        None => Cell::new((at % width) as i16, (at / width) as i16),
                    };
                    let (is_slower, u) = (rng.below(2) == 1, land.get(cell));
                    let u_then = if is_slower { u.saturating_add(*step) } else { u.saturating_sub(*step) };
                    (u != BLOCKED).then(|| (cell, u_then.clamp(1, (*classes).max(1))))
                };
                (0..if count == 0 { 0 } else { *draws }).filter_map(draw).collect()
            }
            ChangeKind::Drift { .. } => Vec::new(),
        }
    }

    /// Whether anything may change before `tick`. O(1).
    #[must_use]
    pub fn is_due(&self, tick: u32) -> bool {
        let lasts = match &self.kind {
            ChangeKind::Become { lasts, .. } => lasts.map(NonZeroU32::get),
            ChangeKind::Drift { .. } => None,
        };
        self.phase(tick).is_some_and(|phase| phase == 0 || Some(phase) == lasts)
    }

    fn phase(&self, tick: u32) -> Option<u32> {
        let since = tick.checked_sub(self.first)?;
        Some(self.every.map_or(since, |every| since % every))
    }
}

/// Applies all `changes` of `tick` to `land`, in order, and passes each changed cell to `each`.
pub fn change(land: &mut Terrain, changes: &[LandChange], seed: u64, tick: u32, mut each: impl FnMut(Cell, u8)) {
    for (number, rule) in changes.iter().enumerate() {
        for (cell, class) in rule.due(number, seed, tick, land) {
            if land.index(cell).is_some() && land.get(cell) != class {
                land.set(cell, class);
                each(cell, class);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn gate(every: Option<u32>, lasts: Option<u32>) -> LandChange {
        let [every, lasts] = [every, lasts].map(|ticks| ticks.and_then(NonZeroU32::new));
        let cells = vec![(Cell::new(1, 0), 3), (Cell::new(2, 0), 4)];
        LandChange { first: 5, every, kind: ChangeKind::Become { cells, class: BLOCKED, lasts } }
    }

    fn road() -> Terrain {
        Terrain::from_cells(4, 1, vec![1, 3, 4, 1]).expect("fits")
    }

    #[test]
    fn a_gate_closes_reopens_and_closes_again() {
        let mut land = road();
        let rules = [gate(Some(10), Some(4))];
        let mut closed = Vec::new();
        for tick in 0..40 {
            change(&mut land, &rules, 1, tick, |_, _| assert!(rules[0].is_due(tick)));
            if !land.is_passable(Cell::new(1, 0)) {
                closed.push(tick);
            } else {
                assert_eq!(land, road());
            }
        }
        let expected: Vec<u32> = [5..9, 15..19, 25..29, 35..39].into_iter().flatten().collect();
        assert_eq!(closed, expected);
    }

    #[test]
    fn a_change_without_period_happens_once_and_one_without_end_stays() {
        for (lasts, last) in [(None, 40), (Some(7), 12)] {
            let mut land = road();
            let rules = [gate(None, lasts)];
            let mut ticks = Vec::new();
            for tick in 0..40 {
                change(&mut land, &rules, 1, tick, |_, _| ticks.push(tick));
                assert_eq!(land.is_passable(Cell::new(2, 0)), !(5..last).contains(&tick), "{tick}");
            }
            assert_eq!(ticks.len(), 2 * (1 + usize::from(lasts.is_some())));
        }
    }

    #[test]
    fn later_rules_apply_to_the_result_of_earlier_ones() {
        let mut land = road();
        let drift = ChangeKind::Drift { cells: Some(vec![Cell::new(1, 0)]), draws: 50, step: 1, classes: 9 };
        let rules = [gate(None, None), LandChange { first: 5, every: None, kind: drift }];
        change(&mut land, &rules, 1, 5, |_, _| ());
        assert_eq!(land.cells(), [1, 0, 0, 1], "a closed cell does not open");
    }

    proptest! {
        #[test]
        fn drift_keeps_classes_in_range_and_walls_closed(seed: u64, draws in 0_u32..30, step in 1_u8..9) {
            let mut land = Terrain::from_cells(3, 2, vec![1, 9, 0, 5, 0, 2]).expect("fits");
            let rule = LandChange { first: 0, every: NonZeroU32::new(2), kind: ChangeKind::Drift { cells: None, draws, step, classes: 9 } };
            for tick in 0..20 {
                let before = land.clone();
                change(&mut land, std::slice::from_ref(&rule), seed, tick, |_, _| ());
                prop_assert!(tick % 2 == 0 || land == before);
                for (now, then) in land.cells().iter().zip(before.cells()) {
                    prop_assert_eq!(*now == BLOCKED, *then == BLOCKED);
                    prop_assert!(*now <= 9 && now.abs_diff(*then) <= step);
                }
            }
        }
    }

    #[test]
    fn drift_has_new_draws_for_each_time_and_rule() {
        let rule = LandChange {
            first: 0,
            every: NonZeroU32::new(1),
            kind: ChangeKind::Drift { cells: None, draws: 20, step: 1, classes: 9 },
        };
        let land = Terrain::from_cells(20, 20, vec![5; 400]).expect("fits");
        let first = rule.due(0, 1, 0, &land);
        assert_eq!(first.len(), 20);
        assert_eq!(first, rule.due(0, 1, 0, &land));
        for other in [rule.due(1, 1, 0, &land), rule.due(0, 2, 0, &land), rule.due(0, 1, 1, &land)] {
            assert_ne!(first, other);
        }
    }
}
