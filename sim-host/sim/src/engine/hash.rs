//! The trace hash of a run. Equal traces have equal hashes on any machine.

use crate::world::Body;
use serde::{Deserialize, Serialize};
use staya_controller::rand::Rng;
use staya_controller::robot::{Mode, RobotId};

const START: u32 = 0x0048_0001;

/// Running hash of all states of one robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct StateHash(u64);

impl StateHash {
    #[doc(hidden)]
    pub const fn new(robot: RobotId) -> Self {
        Self(Rng::keyed(0, START, robot.0, 0).next_u64())
    }

    pub(super) fn extend(&mut self, words: &[u64]) {
        for word in words {
            // The generator's step is a bijection that mixes all bits.
            self.0 = Rng::new(self.0 ^ word).next_u64();
        }
    }
}

pub(super) fn grid_words(tick: u32, body: &Body, mode: Mode) -> [u64; 2] {
    let column = u64::from(body.cell.x.cast_unsigned());
    let row = u64::from(body.cell.y.cast_unsigned());
    let place = (u64::from(tick) << 32) | (column << 16) | row;
    // A run of 2^32 ticks ends below 2^39 units, so the mode has bits of its own.
    let state = body.free_at ^ ((mode as u64) << 56);
    [place, state]
}

/// Trace hash of a swarm: a sum, so that the order of robots does not matter.
pub fn sum(chains: &[StateHash]) -> u64 {
    chains.iter().fold(0, |sum, chain| sum.wrapping_add(chain.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use staya_controller::grid::{Cell, Dir};

    const BODY: Body = Body {
        id: RobotId(1),
        cell: Cell::new(3, 4),
        entered_by: Dir::East,
        free_at: 70,
        crossing: 70,
        is_shut_in: false,
    };

    fn chain(steps: &[(u32, Body, Mode)]) -> StateHash {
        let mut chain = StateHash::new(RobotId(1));
        for (tick, body, mode) in steps {
            chain.extend(&grid_words(*tick, body, *mode));
        }
        chain
    }

    #[test]
    fn the_hash_covers_every_part_of_a_state_and_their_order() {
        let moved = |x, y| Body { cell: Cell::new(x, y), ..BODY };
        let late = Body { free_at: 71, ..BODY };
        let cases = [
            vec![],
            vec![(1, BODY, Mode::Cruise)],
            vec![(2, BODY, Mode::Cruise)],
            vec![(1, moved(4, 3), Mode::Cruise)],
            vec![(1, moved(3, 5), Mode::Cruise)],
            vec![(1, late, Mode::Cruise)],
            vec![(1, BODY, Mode::Hold)],
            vec![(1, BODY, Mode::Cruise), (2, late, Mode::Hold)],
            vec![(2, late, Mode::Hold), (1, BODY, Mode::Cruise)],
        ];
        let mut hashes: Vec<_> = cases.iter().map(|steps| chain(steps).0).collect();
        hashes.sort_unstable();
        hashes.dedup();
        assert_eq!(hashes.len(), cases.len());
    }

    #[test]
    fn the_hash_covers_robot_ids_but_not_their_order() {
        let (one, two) = (StateHash::new(RobotId(1)), StateHash::new(RobotId(2)));
        assert_ne!(one, two);
        assert_eq!(sum(&[one, two]), sum(&[two, one]));
        assert_ne!(sum(&[one, two]), sum(&[one, one]));
    }
}
