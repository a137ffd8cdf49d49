//! Keeping a formation as the paper has it: A. V. Kuznetsov 2017 (KUZ), section 7, algorithms 2, 5, 6 and 7.
//!
//! Here is what the paper decides by; who does what with it is
//! [`PublishedFormation`](crate::agent::PublishedFormation). Algorithm 5 is [`find_neighbors`](super::find_neighbors),
//! `def` is
//! [`def`](super::def); Staya's own law has them too. The misprints are resolved as the [module](super) says: `less`
//! once, the leader the smallest
//! number, sums that restart for each direction and hold each neighbour's offset.

use super::{Found, Member, Prediction, deviation};
use crate::cost::{EXCLUDED, Gain, Weights};
use crate::grid::{Cell, Dir, UNIT};
use crate::names::named;
use crate::robot::RobotId;
use crate::template::TemplateEntry;
use serde::{Deserialize, Serialize};

named! {
    /// A law by which robots keep a formation.
    #[derive(Default)]
    pub enum FormationLaw {
        /// Staya's: the top leader chooses the way for all and waits for those behind; see [`crate::formation`].
        #[default]
        Staya = "staya",
        /// The paper's: each robot weighs its own shortest way against all neighbours found; see [`PublishedParams`].
        Paper = "paper",
        /// Staya's, with followers who plan their way to where their places will be; see [`Course`](super::Course).
        Lookahead = "lookahead",
    }
}

/// Parameters of the paper's law.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PublishedParams {
    /// How far from its place a neighbour may be and still counts as found, cells (eps of algorithm 5). The paper: the
    /// larger, the smaller the error.
    pub eps: u8,
    /// Price of a cell of deviation from one neighbour, ticks (the coefficient of the scalarisation; the paper adds
    /// both, so 1).
    pub gain: Gain,
    /// Sum of deviations from all neighbours found from which the formation is lost (`>> r0`), [`UNIT`]s.
    pub halt: u16,
    /// Sum down to which it must have come to be kept again (about r0), [`UNIT`]s; at most `halt`.
    pub resume: u16,
    /// How many may be missing and too many, together, before others are asked to choose another direction (item 6).
    pub crowd: u8,
    /// How others are foreseen.
    pub prediction: Prediction,
}

impl Default for PublishedParams {
    /// The paper leaves all of them open but the gain and the prediction. eps of 10 cells as ours; r0 such that all
    /// arrive on most landscapes: a sum
    /// of 30 cells (10 for each of the three neighbours that a robot in the middle of figure 5 has) until 9 again.
    /// From 9 until 3 errors are
    /// the paper's, and most runs jam (`staya experiment formation --paper-halt 9 --paper-resume 3`).
    fn default() -> Self {
        Self {
            eps: 10,
            gain: Gain::ONE,
            halt: 30 * UNIT as u16,
            resume: 9 * UNIT as u16,
            crowd: 1,
            prediction: Prediction::Reflexive,
        }
    }
}

/// The sum over all neighbours found of how far a robot in `cell` is off its place beside where they will be, [`UNIT`]s
/// (the inner sum of algorithm 7). O(members).
#[must_use]
pub fn sum_of_deviations(cell: Cell, members: &[Member]) -> u32 {
    let each = members.iter().map(|member| deviation(cell, member.seen.predicted, member.offset));
    each.fold(0, u32::saturating_add)
}

/// What each move costs the formation (algorithm 7): `gain` times the [sum](sum_of_deviations) that it leads to.
/// O(members).
#[must_use]
pub fn sums(gain: Gain, cell: Cell, members: &[Member]) -> Weights {
    // A long way off is no wall.
    let price = |dir: Dir| gain.of(sum_of_deviations(cell + dir.offset(), members)).min(EXCLUDED - 1);
    Weights::new(Dir::MOVES.map(price))
}

/// The neighbour to follow (algorithm 6): the smallest number below one's own among all found; nobody: the robot leads.
///
/// With templates of geodesic radius 1 this gives figure 5: 2 and 4 follow 1, 3 and 5 follow 2, 6 follows 3.
#[must_use]
pub fn smallest_below(own: RobotId, members: &[Member]) -> RobotId {
    let smaller = members.iter().map(|member| member.seen.id).filter(|&id| id < own);
    smaller.min().unwrap_or(RobotId::NOBODY)
}

/// What the sum of deviations says of a formation: hysteresis around r0 (algorithm 2).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Kept {
    /// About r0 or less: lines 14 and 21.
    Well,
    /// In between: whatever was decided stands.
    Fairly,
    /// Much more than r0: lines 10 and 17.
    Lost,
}

impl PublishedParams {
    /// What a sum of deviations, [`UNIT`]s, says.
    #[must_use]
    pub fn judge(&self, sum: u32) -> Kept {
        match sum {
            _ if sum > u32::from(self.halt) => Kept::Lost,
            _ if sum <= u32::from(self.resume.min(self.halt)) => Kept::Well,
            _ => Kept::Fairly,
        }
    }

    /// Whether too many are missing or too many (line 24).
    #[must_use]
    pub const fn is_crowded<const F: usize>(&self, found: &Found<F>) -> bool {
        found.less.saturating_add(found.more) > self.crowd
    }
}

/// What each move of another robot would cost the formation in its own eyes, as far as oneself knows it: the sum over
/// those of `entries` that `cell_of` knows, and oneself in `own`, from where they are now (`predict` of algorithm 5
/// runs algorithm 7 in the
/// other's place, with no prediction inside it). O(entries).
#[must_use]
pub fn sums_of_other(
    gain: Gain,
    (other, own): (&Member, Cell),
    entries: &[TemplateEntry],
    cell_of: impl Fn(RobotId) -> Option<Cell>,
) -> Weights {
    let price = |dir: Dir| {
        let there = other.seen.cell + dir.offset();
        let of_own = deviation(there, own, Cell::default() - other.offset);
        let third = entries.iter().filter(|entry| entry.id != other.seen.id);
        let known = third.filter_map(|entry| Some(deviation(there, cell_of(entry.id)?, entry.offset - other.offset)));
        gain.of(known.fold(of_own, u32::saturating_add)).min(EXCLUDED - 1)
    };
    Weights::new(Dir::MOVES.map(price))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formation::{Seen, find_neighbors};
    use crate::robot::Mode;
    use crate::template::Template;
    use std::vec::Vec;

    /// Figure 5: rows 1 2 3 and 4 5 6, three cells apart.
    const PLACES: [Cell; 6] =
        [Cell::new(0, 0), Cell::new(-3, 0), Cell::new(-6, 0), Cell::new(0, -3), Cell::new(-3, -3), Cell::new(-6, -3)];
    const EDGES: [(u16, u16); 7] = [(0, 1), (1, 2), (3, 4), (4, 5), (0, 3), (1, 4), (2, 5)];

    fn seen(place: usize, off: Cell) -> Seen {
        let cell = PLACES[place] + off;
        Seen {
            id: RobotId(place as u32 + 1),
            cell,
            predicted: cell,
            heading: Dir::Stay,
            leader: RobotId::NOBODY,
            mode: Mode::Cruise,
        }
    }

    fn found(own: usize, rho: u8, off: impl Fn(usize) -> Cell) -> Found<8> {
        let template = Template::<8>::from_graph(&PLACES, &EDGES, own, rho).unwrap();
        let others: Vec<Seen> = (0..6).filter(|&other| other != own).map(|other| seen(other, off(other))).collect();
        find_neighbors(&template, PLACES[own], 10, others.into_iter())
    }

    #[test]
    fn geodesic_radius_one_gives_the_leaders_of_figure_5() {
        let leaders = |rho| -> Vec<u32> {
            (0..6)
                .map(|own| smallest_below(RobotId(own as u32 + 1), &found(own, rho, |_| Cell::default()).members).0)
                .collect()
        };
        assert_eq!(leaders(1), [0, 1, 2, 1, 2, 3]);
        assert_eq!(leaders(3), [0, 1, 1, 1, 1, 1], "who knows all follows the first");
    }

    #[test]
    fn sums_count_every_neighbour_found_and_restart_for_each_direction() {
        // Robot 5 has three neighbours; robot 2, north of it, is a cell too far east.
        let east = |other| if other == 1 { Cell::new(1, 0) } else { Cell::default() };
        let found = found(4, 1, east);
        assert_eq!(found.members.len(), 3);
        assert_eq!(sum_of_deviations(PLACES[4], &found.members), UNIT);
        let sums = sums(Gain::ONE, PLACES[4], &found.members);
        // One step east: right by robot 2, a cell off by the two others; west: 2 + 1 + 1.
        assert_eq!(sums.get(Dir::East), Gain::ONE.of(2 * UNIT));
        assert_eq!(sums.get(Dir::West), Gain::ONE.of(4 * UNIT));
    }

    #[test]
    fn in_the_others_place_one_counts_oneself_and_those_whom_one_knows() {
        // Robot 1 thinks for robot 2, who has fallen back by a cell; 3 and 5 are behind it in their places.
        let found = found(0, 3, |other| if other == 1 { Cell::new(-1, 0) } else { Cell::default() });
        let template = Template::<8>::from_graph(&PLACES, &EDGES, 0, 3).unwrap();
        let other = found.members.iter().find(|member| member.seen.id == RobotId(2)).unwrap();
        let known = |id: RobotId| Some(PLACES[id.0 as usize - 1]);
        let price = |dir| {
            let sums = sums_of_other(Gain::ONE, (other, PLACES[0]), &template.entries, known);
            sums.get(dir)
        };
        assert_eq!(price(Dir::East), 0, "back into its place");
        assert_eq!(price(Dir::West), Gain::ONE.of(5 * 2 * UNIT), "two cells off by all five");
        let alone = sums_of_other(Gain::ONE, (other, PLACES[0]), &template.entries, |_| None);
        assert_eq!(alone.get(Dir::West), Gain::ONE.of(2 * UNIT), "by oneself alone");
    }

    #[test]
    fn r0_has_a_hysteresis() {
        let params = PublishedParams { halt: 9, resume: 3, ..PublishedParams::default() };
        assert_eq!(
            [0, 3, 4, 9, 10].map(|sum| params.judge(sum)),
            [Kept::Well, Kept::Well, Kept::Fairly, Kept::Fairly, Kept::Lost]
        );
        let odd = PublishedParams { halt: 3, resume: 9, ..params };
        assert_eq!([3, 4].map(|sum| odd.judge(sum)), [Kept::Well, Kept::Lost], "resume is at most halt");
    }
}
