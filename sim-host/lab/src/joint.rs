//! Optima of several robots by the two criteria of A. V. Kuznetsov 2017 (KUZ), section 2: the last
//! arrival (4) and the distance from the formation (5).
//!
//! A search over the positions of all robots would have cells^robots states. Both ends of the
//! trade-off are exact without it, on maps of any size:
//!
//! - **Fastest.** No robot can be faster than alone on its fastest route, so the slowest of them
//!   bounds the last arrival from below. If all follow these routes, wait where a cell is occupied,
//!   and the last one still arrives at that time, it is the optimum of (4).
//! - **Rigid.** A formation that is never left has distance 0 at all times. All robots then move at
//!   once, a move takes as long as the slowest of them needs, and the shortest route of the
//!   formation is the fastest journey with the optimum of (5).
//!
//! Between these ends nothing is known here. Times are continuous; in the simulator moves start at
//! whole ticks. Diagonal moves may cross, as in the paper.

use staya_controller::grid::{BLOCKED, Cell, Dir, Norm};
use staya_sim::terrain::Terrain;
use staya_sim::terrain::optimal::Planner;

/// The last arrival of robots without formation, [`UNIT`](staya_controller::grid::UNIT)ths of a
/// tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fastest {
    /// No plan has an earlier one.
    pub bound: u64,
    /// That of the fastest routes with waiting; equal to `bound` if it is the optimum. `None`:
    /// robots wait for each other for ever.
    pub reached: Option<u64>,
}

/// Finds the last arrival of robots with these starts and goals; `None` if a robot has no route.
/// O(robots * size).
#[must_use]
pub fn fastest(land: &Terrain, trips: &[(Cell, Cell)], norm: Norm, corner_cutting: bool) -> Option<Fastest> {
    let mut planner = Planner::default();
    let routes = trips.iter().map(|&(from, to)| planner.route(land, from, to, norm, corner_cutting));
    let routes: Vec<_> = routes.collect::<Option<_>>()?;
    let bound = routes.iter().map(|route| route.cost).max()?;
    let mut walkers: Vec<Walker> =
        routes.into_iter().map(|route| Walker { cells: route.cells, at: 0, free_at: 0, to_go: route.cost }).collect();
    Some(Fastest { bound, reached: reached(land, &mut walkers, norm) })
}

struct Walker {
    cells: Vec<Cell>,
    at: usize,
    free_at: u64,
    /// Cost of the rest of its route.
    to_go: u64,
}

/// The robot with the longest way goes first where two want a cell.
fn reached(land: &Terrain, walkers: &mut [Walker], norm: Norm) -> Option<u64> {
    let mut now = 0;
    loop {
        walkers.sort_by_key(|walker| std::cmp::Reverse(walker.free_at + walker.to_go));
        let taken: Vec<Cell> = walkers.iter().map(|walker| walker.cells[walker.at]).collect();
        let may_move = |walker: &Walker| {
            let next = walker.cells.get(walker.at + 1);
            walker.free_at <= now && next.is_some_and(|next| !taken.contains(next))
        };
        if let Some(walker) = walkers.iter_mut().find(|walker| may_move(walker)) {
            let [from, to] = [walker.cells[walker.at], walker.cells[walker.at + 1]];
            let cost = Dir::between(from, to).map_or(0, |dir| u64::from(dir.length(norm))) * u64::from(land.get(to));
            walker.at += 1;
            walker.free_at = now + cost;
            walker.to_go -= cost;
        } else if walkers.iter().all(|walker| walker.to_go == 0) {
            return walkers.iter().map(|walker| walker.free_at).max();
        } else {
            now = walkers.iter().map(|walker| walker.free_at).filter(|&at| at > now).min()?;
        }
    }
}

/// Travel time of the fastest journey of a formation that is never left, in the same unit; `None`
/// if there is none. `places` are relative to the first robot, which goes `from` one cell `to`
/// another. O(robots * size).
#[must_use]
pub fn rigid(
    land: &Terrain,
    places: &[Cell],
    (from, to): (Cell, Cell),
    norm: Norm,
    corner_cutting: bool,
) -> Option<u64> {
    let (width, height) = (land.width(), land.height());
    let slowest = |at: Cell| {
        let classes = || places.iter().map(|&place| land.get(at + place));
        if classes().any(|class| class == BLOCKED) { BLOCKED } else { classes().max().unwrap_or(BLOCKED) }
    };
    let cells = (0..height as i16).flat_map(|y| (0..width as i16).map(move |x| Cell::new(x, y)));
    let merged = Terrain::from_cells(width, height, cells.map(slowest).collect()).ok()?;
    Planner::default().route(&merged, from, to, norm, corner_cutting).map(|route| route.cost)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use staya_controller::grid::UNIT;
    use std::collections::BTreeSet;

    const TICK: u64 = UNIT as u64;

    /// Last arrival of two robots in whole ticks, by a search over both positions.
    fn by_definition(land: &Terrain, trips: [(Cell, Cell); 2], limit: u64) -> Option<u64> {
        let mut states = BTreeSet::from([trips.map(|(from, _)| (from.x, from.y, 0u64))]);
        for tick in 0..=limit {
            let is_done = |state: &[(i16, i16, u64); 2]| {
                state.iter().zip(trips).all(|(&(x, y, rest), (_, to))| (x, y) == (to.x, to.y) && rest == 0)
            };
            if states.iter().any(is_done) {
                return Some(tick);
            }
            let moves = |&(x, y, rest): &(i16, i16, u64)| {
                let here = Cell::new(x, y);
                let mut next = vec![(x, y, rest.saturating_sub(1))];
                for dir in Dir::MOVES.into_iter().filter(|_| rest == 0) {
                    let to = here + dir.offset();
                    if land.is_passable(to) {
                        next.push((to.x, to.y, u64::from(land.get(to)) - 1));
                    }
                }
                next
            };
            states = states
                .iter()
                .flat_map(|[a, b]| moves(a).into_iter().flat_map(move |a| moves(b).into_iter().map(move |b| [a, b])))
                .filter(|[a, b]| (a.0, a.1) != (b.0, b.1))
                .collect();
        }
        None
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]
        #[test]
        fn no_plan_of_two_robots_is_faster_than_the_bound_and_a_reached_bound_is_the_optimum(
            cells in prop::collection::vec(1..=3_u8, 12),
            ends in prop::sample::subsequence((0..12_i16).collect::<Vec<_>>(), 4).prop_shuffle(),
        ) {
            let land = Terrain::from_cells(4, 3, cells).unwrap();
            let cell = |at: i16| Cell::new(at % 4, at / 4);
            let trips = [(cell(ends[0]), cell(ends[1])), (cell(ends[2]), cell(ends[3]))];
            let found = fastest(&land, &trips, Norm::Chebyshev, true).unwrap();
            let optimum = by_definition(&land, trips, 40).unwrap() * TICK;
            prop_assert!(found.bound <= optimum);
            if let Some(reached) = found.reached {
                prop_assert!(reached >= optimum, "{found:?}, {optimum}");
            }
        }
    }

    #[test]
    fn a_formation_moves_as_slowly_as_its_slowest_robot() {
        let places = [Cell::new(0, 0), Cell::new(0, 2)];
        let ends = (Cell::new(0, 0), Cell::new(3, 0));
        let flat = Terrain::flat(4, 3);
        assert_eq!(rigid(&flat, &places, ends, Norm::Chebyshev, true), Some(3 * TICK));
        let mut land = flat;
        land.set(Cell::new(1, 0), 5);
        land.set(Cell::new(2, 2), 7);
        assert_eq!(rigid(&land, &places, ends, Norm::Chebyshev, true), Some((5 + 7 + 1) * TICK));
        let alone = fastest(&land, &[ends], Norm::Chebyshev, true).unwrap();
        assert_eq!(alone, Fastest { bound: 3 * TICK, reached: Some(3 * TICK) });
        land.set(Cell::new(2, 2), BLOCKED);
        assert_eq!(rigid(&land, &places, ends, Norm::Chebyshev, true), None);
    }

    #[test]
    fn a_robot_waits_for_the_one_ahead_and_two_that_meet_in_a_corridor_never_arrive() {
        let corridor = Terrain::from_cells(5, 1, vec![1, 1, 1, 4, 1]).unwrap();
        let at = |x| Cell::new(x, 0);
        let behind = fastest(&corridor, &[(at(1), at(4)), (at(0), at(3))], Norm::Euclidean, true).unwrap();
        // The first is in cell 3 from tick 1 to 5; the second enters it then and takes four ticks.
        assert_eq!(behind, Fastest { bound: 6 * TICK, reached: Some(9 * TICK) });
        let meeting = fastest(&corridor, &[(at(0), at(4)), (at(4), at(0))], Norm::Euclidean, true).unwrap();
        assert_eq!(meeting.reached, None);
        assert_eq!(fastest(&corridor, &[(at(0), at(5))], Norm::Euclidean, true), None);
    }
}
