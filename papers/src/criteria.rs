//! Criteria of formation keeping as published: A. V. Kuznetsov 2017 (KUZ), section 7, algorithms 2,
//! 5, 6 and 7. Algorithm 5 is [`find_neighbors`](staya_controller::formation::find_neighbors).
//! Misprints are resolved as in [`staya_controller::formation`]; sums hold each neighbour's offset.

use serde::{Deserialize, Serialize};
use staya_controller::cost::{EXCLUDED, Gain, Weights};
use staya_controller::formation::{Found, Member, Prediction, deviation};
use staya_controller::grid::{Cell, Dir, UNIT};
use staya_controller::robot::RobotId;
use staya_controller::template::TemplateEntry;

/// Parameters of the paper's law.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct PublishedParams {
    /// How far from its place a neighbour still counts as found, cells (eps of algorithm 5).
    /// According to the paper, a larger value gives a smaller error.
    pub eps: u8,
    /// Price of a cell of deviation from one neighbour, ticks (1 in the paper).
    pub gain: Gain,
    /// Sum of deviations from all neighbours at which the formation is lost (`>> r0`), [`UNIT`]s.
    pub halt: u16,
    /// Sum at which the formation is kept again (about r0), [`UNIT`]s; at most `halt`.
    pub resume: u16,
    /// Missing and surplus robots above which others are asked to turn aside (item 6).
    pub crowd: u8,
    /// How robots predict the positions of others.
    pub prediction: Prediction,
}

impl Default for PublishedParams {
    /// The paper specifies only gain and prediction. eps is 10 cells, as in Staya's law, and r0 is
    /// a sum of 30 cells (10 per neighbour) down to 9. With `halved_per_ticks = 0.5` the error is
    /// then 1 to 1.6 times the published one (`paper-light` of `staya experiment formation`). A
    /// gain of 2, an eps of 15 and `halved_per_ticks = 1` keep it below, for half as much time
    /// again (`paper`). With the lighter weights a smaller r0 makes most runs jam.
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

/// Sum of the distances of a robot in `cell` from the places given by the predicted positions of
/// its neighbours, [`UNIT`]s (the inner sum of algorithm 7). O(members).
#[must_use]
pub fn sum_of_deviations(cell: Cell, members: &[Member]) -> u32 {
    let each = members.iter().map(|member| deviation(cell, member.seen.predicted, member.offset));
    each.fold(0, u32::saturating_add)
}

/// The cost of each move for the formation (algorithm 7): `gain` times [`sum_of_deviations`].
#[must_use]
pub fn sums(gain: Gain, cell: Cell, members: &[Member]) -> Weights {
    // A great distance must not act as a wall.
    let price = |dir: Dir| gain.of(sum_of_deviations(cell + dir.offset(), members)).min(EXCLUDED - 1);
    Weights::new(Dir::MOVES.map(price))
}

/// The neighbour to follow (algorithm 6): the smallest number below the own one among all found;
/// [`RobotId::NONE`]: the robot leads. With templates of geodesic radius 1 this gives figure 5.
#[must_use]
pub fn smallest_below(own: RobotId, members: &[Member]) -> RobotId {
    let smaller = members.iter().map(|member| member.seen.id).filter(|&id| id < own);
    smaller.min().unwrap_or(RobotId::NONE)
}

/// The state of a formation by its sum of deviations (algorithm 2).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kept {
    /// About r0 or less: lines 14 and 21.
    Well,
    /// In between: the previous decision holds.
    Fairly,
    /// Much more than r0: lines 10 and 17.
    Lost,
}

impl PublishedParams {
    /// Classifies a sum of deviations, [`UNIT`]s.
    #[must_use]
    pub fn judge(&self, sum: u32) -> Kept {
        match sum {
            _ if sum > u32::from(self.halt) => Kept::Lost,
            _ if sum <= u32::from(self.resume.min(self.halt)) => Kept::Well,
            _ => Kept::Fairly,
        }
    }

    /// Whether too many robots are missing or surplus (line 24).
    #[must_use]
    pub const fn is_crowded<const F: usize>(&self, found: &Found<F>) -> bool {
        found.less.saturating_add(found.more) > self.crowd
    }
}

/// The cost of each move of another robot from its view: the sum over the `entries` that `cell_of`
/// knows, and this robot in `own`, from their current positions (`predict` of algorithm 5).
/// O(entries).
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
    use staya_controller::formation::{Seen, find_neighbors};
    use staya_controller::robot::Mode;
    use staya_controller::template::Template;
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
            leader: RobotId::NONE,
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
        assert_eq!(leaders(3), [0, 1, 1, 1, 1, 1], "a robot that knows all follows the first");
    }

    #[test]
    fn sums_count_every_neighbour_found_and_restart_for_each_direction() {
        // Robot 2, north of robot 5, is a cell too far east.
        let east = |other| if other == 1 { Cell::new(1, 0) } else { Cell::default() };
        let found = found(4, 1, east);
        assert_eq!(found.members.len(), 3);
        assert_eq!(sum_of_deviations(PLACES[4], &found.members), UNIT);
        let sums = sums(Gain::ONE, PLACES[4], &found.members);
        assert_eq!(sums.get(Dir::East), Gain::ONE.of(2 * UNIT));
        assert_eq!(sums.get(Dir::West), Gain::ONE.of(4 * UNIT));
    }

    #[test]
    fn a_prediction_counts_the_own_robot_and_the_known_ones() {
        // Robot 2 has fallen back by a cell; 3 and 5 are behind it in their places.
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
        assert_eq!(alone.get(Dir::West), Gain::ONE.of(2 * UNIT), "alone");
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
