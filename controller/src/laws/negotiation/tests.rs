mod small_maps;

use super::*;
use crate::grid::{Cell, Dir};
use crate::rand::Rng;
use crate::robot::RobotId;
use std::collections::{BTreeSet, VecDeque};
use std::format;
use std::vec::Vec;

/// A world in which all robots move at once: robots may follow each other; who meets another one
/// stays where it is, and so does who would come into its cell.
#[derive(Clone)]
struct World {
    map: Vec<&'static [u8]>,
    robots: Vec<Negotiator<16>>,
    cells: Vec<Cell>,
    /// Number of dead robots, the first ones.
    dead: usize,
    refused: usize,
}

impl World {
    /// `.` is open.
    fn new(map: &'static str, ends: &[(Cell, Cell)], moves: Moves) -> Self {
        let robot = |(&(start, goal), number): (&(Cell, Cell), u32)| {
            let mut robot = Negotiator::new(RobotId(number), start, moves);
            robot.set_goal(goal);
            robot
        };
        let cells = ends.iter().map(|&(start, _)| start).collect();
        let robots = ends.iter().zip(1..).map(robot).collect();
        Self { map: map.split_whitespace().map(str::as_bytes).collect(), robots, cells, dead: 0, refused: 0 }
    }

    fn is_closed(&self, cell: Cell) -> bool {
        let row = usize::try_from(cell.y).ok().and_then(|y| self.map.get(y));
        let column = usize::try_from(cell.x).ok();
        row.zip(column).and_then(|(row, x)| row.get(x)) != Some(&b'.')
    }

    /// `is_lost(from, to, is_report)`
    fn step(&mut self, mut is_lost: impl FnMut(usize, usize, bool) -> bool) {
        let sights: Vec<Sight> = self.cells.iter().map(|&cell| Sight::new(cell, |cell| self.is_closed(cell))).collect();
        let robots = self.robots.iter_mut().zip(&self.cells).zip(&sights);
        let said: Vec<Said> = robots.map(|((robot, &cell), sight)| robot.see(cell, sight)).collect();
        let id = |index: usize| RobotId(index as u32 + 1);
        let count = self.robots.len();
        let pairs = || (0..count).flat_map(|to| (0..count).map(move |from| (from, to))).filter(|(from, to)| from != to);
        let dead = self.dead;
        let mut is_lost = |from: usize, to: usize, is_report: bool| from < dead || is_lost(from, to, is_report);
        for (from, to) in pairs() {
            if !is_lost(from, to, false) {
                self.robots[to].hear(id(from), &said[from]);
            }
        }
        let reports: Vec<Report> = self.robots.iter().map(Negotiator::report).collect();
        for (from, to) in pairs() {
            if !is_lost(from, to, true) {
                self.robots[to].hear_report(id(from), &reports[from], true);
            }
        }
        let before = self.cells.clone();
        let dirs: Vec<Dir> = self.robots.iter_mut().map(|robot| robot.decide(Sensed::Nothing)).collect();
        let mut next: Vec<Cell> = before.iter().zip(&dirs).map(|(&cell, dir)| cell + dir.offset()).collect();
        next[..dead].copy_from_slice(&before[..dead]);
        // Until no robot has to stay any more.
        while let Some(stays) = (0..count).find(|&index| {
            let meets = |other: usize| {
                next[other] == next[index] || (next[other] == before[index] && next[index] == before[other])
            };
            next[index] != before[index]
                && (self.is_closed(next[index]) || (0..count).any(|other| other != index && meets(other)))
        }) {
            next[stays] = before[stays];
            self.refused += 1;
        }
        self.cells = next;
    }

    fn has_arrived(&self) -> bool {
        self.robots.iter().zip(&self.cells).skip(self.dead).all(|(robot, &cell)| robot.goal() == cell)
    }

    /// Steps until all have arrived.
    fn run(&mut self, most: u32, mut is_lost: impl FnMut(usize, usize, bool) -> bool) -> Option<u32> {
        (1..=most).find(|_| {
            self.step(&mut is_lost);
            self.has_arrived()
        })
    }
}

fn random_cell(rng: &mut Rng, side: u32) -> Cell {
    Cell::new(rng.below(side) as i16, rng.below(side) as i16)
}

#[test]
fn an_area_keeps_what_is_near_and_forgets_what_is_far() {
    let mut area = Area::new(Cell::new(0, 0));
    area.close(Cell::new(3, 4));
    area.close(Cell::new(-31, 0));
    assert!(!area.is_open(Cell::new(3, 4)) && !area.is_open(Cell::new(-31, 0)));
    area.follow(Cell::new(1, -2));
    assert!(!area.is_open(Cell::new(3, 4)), "still inside");
    area.follow(Cell::new(0, 0));
    assert!(area.is_open(Cell::new(-31, 0)), "it was outside for a while");
    area.follow(Cell::new(1000, 0));
    assert!(area.is_open(Cell::new(1003, 4)) && !area.is_open(Cell::new(3, 4)), "one is unknown, one outside");
}

#[test]
fn distances_are_those_of_a_search_by_cells() {
    for (seed, moves) in [(1, Moves::FOUR), (2, Moves::EIGHT), (3, Moves::FOUR), (4, Moves::EIGHT)] {
        let mut rng = Rng::new(seed);
        let center = Cell::new(500, -300);
        let mut area = Area::new(center);
        for _ in 0..900 {
            area.close(center + random_cell(&mut rng, 63) - Cell::new(31, 31));
        }
        let goal = center + Cell::new(5, 7);
        let mut distances = Distances::EMPTY;
        distances.search(goal, &area, moves.diagonals);
        let mut far = std::collections::BTreeMap::from([((goal.x, goal.y), 0u32)]);
        let mut queue = VecDeque::from([goal]);
        while let Some(cell) = queue.pop_front() {
            let distance = far[&(cell.x, cell.y)] + 1;
            for next in area.around(cell, moves.dirs()) {
                far.entry((next.x, next.y)).or_insert_with(|| {
                    queue.push_back(next);
                    distance
                });
            }
        }
        assert!(far.len() > 1000);
        for &(x, y) in far.keys() {
            let cell = Cell::new(x, y);
            for next in area.around(cell, moves.dirs()) {
                let expected = far.get(&(next.x, next.y)).map(|there| there.cmp(&far[&(x, y)]));
                assert_eq!(distances.compare(next, cell), expected, "{next:?} and {cell:?}");
            }
        }
    }
}

#[test]
fn plans_never_collide() {
    let mut rng = Rng::new(7);
    let mut moved = 0;
    for round in 0..400 {
        let moves = if round % 2 == 0 { Moves::FOUR } else { Moves::EIGHT };
        let mut area = Area::new(Cell::new(4, 4));
        let frame = (-1..=8).flat_map(|at| [(-1, at), (8, at), (at, -1), (at, 8)]);
        frame.for_each(|(x, y)| area.close(Cell::new(x, y)));
        for _ in 0..rng.below(30) {
            area.close(random_cell(&mut rng, 8));
        }
        let mut members: Vec<Member> = Vec::new();
        for number in 1..=12 {
            let (cell, goal) = (random_cell(&mut rng, 8), random_cell(&mut rng, 8));
            if area.is_open(cell) && members.iter().all(|other| other.cell != cell) {
                let waiting = rng.below(5) as u16;
                let manners = Manners { is_last: rng.below(4) == 0, keeps_on: rng.below(4) == 0 };
                members.push(Member {
                    id: RobotId(number),
                    cell,
                    goal,
                    waiting,
                    step: 0,
                    manners,
                    wish: Wish::towards(cell, goal, &area, moves),
                    holds: false,
                    busy: 0,
                    leaves_by: None,
                });
            }
        }
        let plan: Plan<'_, 16> = Plan::new(&members, &area, moves);
        let next: Vec<Cell> = (0..members.len()).map(|index| plan.next(index as u8).unwrap()).collect();
        let cells: BTreeSet<(i16, i16)> = next.iter().map(|cell| (cell.x, cell.y)).collect();
        assert_eq!(cells.len(), members.len(), "two in one cell, round {round}");
        for (index, (member, &to)) in members.iter().zip(&next).enumerate() {
            assert!(to == member.cell || area.around(member.cell, moves.dirs()).any(|cell| cell == to));
            moved += usize::from(to != member.cell);
            for (other, &other_to) in members.iter().zip(&next).skip(index + 1) {
                assert!((to, other_to) != (other.cell, member.cell), "an exchange, round {round}");
                let dirs =
                    [(member.cell, to), (other.cell, other_to)].map(|(from, to)| Dir::between(from, to).unwrap());
                let middle = |from: Cell, to: Cell| (from.x + to.x, from.y + to.y);
                let crosses =
                    dirs.iter().all(|dir| dir.is_diagonal()) && middle(member.cell, to) == middle(other.cell, other_to);
                assert!(!crosses, "diagonals cross, round {round}");
            }
        }
    }
    assert!(moved > 1000);
}

/// In a corridor, robot 2 is in the cell of robot 1, to the west of its centre, and robot 3 is west
/// of both. Robot 3, who wants to go east, makes way.
#[test]
fn a_robot_in_the_cell_of_another_leaves_it_and_others_make_way() {
    let mut area = Area::new(Cell::new(4, 1));
    (0..9).flat_map(|x| [(x, 0), (x, 2)]).for_each(|(x, y)| area.close(Cell::new(x, y)));
    let member = |id: u32, x: i16, leaves_by: Option<Dir>| Member {
        id: RobotId(id),
        cell: Cell::new(x, 1),
        goal: Cell::new(8, 1),
        waiting: id as u16,
        step: 0,
        manners: Manners::default(),
        wish: Wish::towards(Cell::new(x, 1), Cell::new(8, 1), &area, Moves::FOUR),
        holds: false,
        busy: 0,
        leaves_by,
    };
    let west = Some(Dir::West);
    let next = |members: &[Member]| -> Vec<i16> {
        let plan: Plan<'_, 8> = Plan::new(members, &area, Moves::FOUR);
        (0..members.len()).map(|index| plan.next(index as u8).unwrap().x).collect()
    };
    let moves = next(&[member(1, 4, None), member(2, 4, west), member(3, 3, None)]);
    assert_eq!(moves[1..], [3, 2], "{moves:?}");
    // Where it cannot leave, the other one does.
    let blocked = Member { holds: true, ..member(3, 3, None) };
    assert_eq!(next(&[member(1, 4, None), member(2, 4, west), blocked]), [5, 4, 3]);
}

/// Robots 2 and 3 are in the cell of robot 1; each leaves it to its side.
#[test]
fn all_robots_that_share_a_cell_leave_it() {
    let cell = Cell::new(4, 1);
    let mut robot: Negotiator<8> = Negotiator::new(RobotId(1), cell, Moves::FOUR);
    let said = robot.see(cell, &Sight::new(cell, |_| false));
    for (id, by) in [(2, Dir::West), (3, Dir::East)] {
        robot.hear(RobotId(id), &said);
        robot.share(RobotId(id), by);
    }
    robot.decide(Sensed::Nothing);
    let expected = [2, 3].map(|id| robot.expects(RobotId(id)));
    assert_eq!(expected, [Some(Cell::new(3, 1)), Some(Cell::new(5, 1))]);
}

const CORRIDOR: &str = "
    ...####################...
    ..........................
    ...####################...";

/// Two robots in the rooms at the ends of a corridor, which is walled up beyond its length.
#[test]
fn two_robots_pass_each_other_in_corridors_at_any_loss() {
    for length in [1, 2, 5, 10, 20] {
        for percent in [0, 10, 30, 60] {
            for seed in 0..3 {
                let row = |side: char| -> std::string::String {
                    let middle: std::string::String = (0..length).map(|_| side).collect();
                    format!("...{middle}...\n")
                };
                let map = std::boxed::Box::leak(format!("{}{}{}", row('#'), row('.'), row('#')).into_boxed_str());
                let (west, east) = (Cell::new(1, 1), Cell::new(length + 4, 1));
                let mut world = World::new(map, &[(west, east), (east, west)], Moves::FOUR);
                let mut rng = Rng::new(seed);
                let steps = world.run(400, |_, _, _| rng.below(100) < percent);
                assert!(steps.is_some(), "{length} cells, {percent} % lost, seed {seed}: {:?}", world.cells);
            }
        }
    }
    let (west, east) = (Cell::new(1, 1), Cell::new(24, 1));
    let mut world = World::new(CORRIDOR, &[(west, east), (east, west)], Moves::FOUR);
    let steps = world.run(100, |_, _, _| false);
    assert!(steps.is_some_and(|steps| steps < 80), "{steps:?}");
    assert_eq!(world.refused, 0, "they know the same");
}

fn bytes(message: &impl serde::Serialize) -> Vec<u8> {
    let mut buffer = [0; 64];
    postcard::to_slice(message, &mut buffer).unwrap().to_vec()
}

#[test]
fn messages_fit_their_frames() {
    let mut report = Report { cell: [255; 2], sight: Sight([255; 16]), ..Report::default() };
    while report.heard.push((255, 255)).is_ok() {}
    let bytes = bytes(&report);
    assert!(bytes.len() < crate::wire::MAX_CONTENT, "{}, and one byte for the kind", bytes.len());
    assert_eq!(postcard::from_bytes(&bytes), Ok(report));
}

/// Robots in a corridor, west of each other, with wishes to the given sides.
fn corridor(robots: &[(i16, i16, Dir, u8)]) -> Vec<(Cell, bool)> {
    let mut area = Area::new(Cell::new(5, 1));
    (1..10).flat_map(|x| [(x, 0), (x, 2)]).for_each(|(x, y)| area.close(Cell::new(x, y)));
    let member = |(&(x, goal, best, busy), number): (&(i16, i16, Dir, u8), u32)| {
        let mut wish = Wish::CLOSED;
        for dir in [Dir::East, Dir::West] {
            wish.set(dir, if dir == best { 0 } else { 2 });
        }
        wish.then = if (x - goal).abs() == 1 { Dir::Stay } else { best };
        Member {
            id: RobotId(number),
            cell: Cell::new(x, 1),
            goal: Cell::new(goal, 1),
            waiting: 100 - number as u16,
            step: 0,
            manners: Manners::default(),
            wish,
            holds: false,
            busy,
            leaves_by: None,
        }
    };
    let members: Vec<Member> = robots.iter().zip(1..).map(member).collect();
    let plan: Plan<'_, 8> = Plan::new(&members, &area, Moves::FOUR);
    (0..members.len() as u8).map(|index| (plan.next(index).unwrap(), plan.moves_now(index))).collect()
}

#[test]
fn a_robot_that_meets_another_in_a_corridor_pulls_it_back_to_the_fork_behind() {
    let at = |x| Cell::new(x, 1);
    assert_eq!(corridor(&[(4, 8, Dir::East, 0), (5, -9, Dir::West, 0)]), [(at(3), true), (at(4), true)]);
    // Behind a robot with the same way it continues.
    assert_eq!(corridor(&[(4, 8, Dir::East, 0), (5, 9, Dir::East, 0)]), [(at(5), true), (at(6), true)]);
    // The goal of the other one lies behind it in the corridor: no robot has to pass.
    assert_eq!(corridor(&[(4, 4, Dir::Stay, 0), (5, 7, Dir::East, 0)])[1], (at(6), true));
}

#[test]
fn a_move_waits_for_a_robot_on_its_way_and_an_exchange_too() {
    let at = |x| Cell::new(x, 1);
    let next = corridor(&[(4, 20, Dir::East, 0), (5, 20, Dir::East, 2)]);
    assert_eq!(next[1], (at(6), false), "it is planned as if it were free, but does not move");
    assert!(!next[0].1, "its cell is not free: {next:?}");
    let next = corridor(&[(4, 8, Dir::East, 0), (5, -9, Dir::West, 1)]);
    assert_eq!(next[0], (at(4), false), "both begin at once");
}

#[test]
fn a_wish_keeps_the_loss_of_each_move() {
    let mut wish = Wish::CLOSED;
    assert!(Dir::MOVES.into_iter().all(|dir| wish.lost(dir).is_none()) && wish.best().is_none());
    for (dir, lost) in Dir::MOVES.into_iter().zip([3, 0, 14, 15, 200, 1, 2, 0]) {
        wish.set(dir, lost);
    }
    wish.set(Dir::Stay, 9);
    let lost = Dir::MOVES.map(|dir| wish.lost(dir).unwrap());
    assert_eq!(lost, [3, 0, 14, 14, 14, 1, 2, 0], "more than the most is the most");
    assert_eq!((wish.best(), wish.lost(Dir::Stay)), (Some(Dir::NorthEast), Some(Wish::STAYING)));
}

/// Nothing in it is smaller on this host than on a 32-bit part.
#[cfg(feature = "agent")]
#[test]
fn the_law_fits_the_memory_of_its_documentation() {
    let sizes = [size_of::<NegotiationGuidance<16>>(), size_of::<NegotiationGuidance<64>>()];
    assert!(sizes[0] <= 4636 + 96 * 16 && sizes[1] <= 4636 + 96 * 64, "{sizes:?}");
}

#[cfg(feature = "agent")]
#[test]
fn payloads_keep_their_fields_in_16_bytes() {
    let mut wish = Wish::CLOSED;
    wish.then = Dir::SouthEast;
    for (dir, lost) in Dir::MOVES.into_iter().zip(7..) {
        wish.set(dir, lost);
    }
    let (cell, manners) = (Cell::new(i16::MIN, i16::MAX), Manners { is_last: true, keeps_on: false });
    let said = Said { cell, goal: Cell::new(-2, 3), waiting: MOST_WAITING, wish, step: 15, manners };
    let payload = NegotiationPayload { said, by: Dir::West, busy: 62 };
    assert_eq!(bytes(&payload).len(), crate::wire::MAX_PAYLOAD);
    assert_eq!(postcard::from_bytes(&bytes(&payload)), Ok(payload));
    let most = NegotiationPayload { said: Said { waiting: u16::MAX, step: 255, ..said }, busy: 255, ..payload };
    let read = postcard::from_bytes::<NegotiationPayload>(&bytes(&most)).unwrap();
    assert_eq!((read.said.waiting, read.said.step, read.busy), (MOST_WAITING, 15, 63));

    let mut wish = Wish::CLOSED;
    wish.set(Dir::North, 14);
    wish.set(Dir::West, 0);
    wish.then = Dir::South;
    let said = Said { wish, step: 255, ..said };
    let payload = InStepPayload { said, by: Dir::Stay, beat: Beat { phase: 127, is_late: true } };
    assert!(bytes(&payload).len() <= crate::wire::MAX_PAYLOAD);
    assert_eq!(postcard::from_bytes(&bytes(&payload)), Ok(payload));
}

#[test]
fn a_robot_just_heard_replaces_one_that_is_farther_or_was_not_heard() {
    let mut robot = Negotiator::<2>::new(RobotId(1), Cell::new(0, 0), Moves::FOUR);
    let said = |x| Said { cell: Cell::new(x, 0), waiting: 1, ..Said::default() };
    let heard = |robot: &Negotiator<2>| robot.report().heard.iter().map(|&(id, _)| id).collect::<Vec<_>>();
    for (id, x) in [(2, 3), (3, 5), (4, 4), (5, 6)] {
        robot.hear(RobotId(id), &said(x));
    }
    assert_eq!(heard(&robot), [2, 4]);
    let _ = robot.decide(Sensed::Nothing);
    robot.hear(RobotId(5), &said(6));
    assert_eq!(heard(&robot), [5]);
}

#[test]
fn robots_walk_around_a_dead_one_and_wait_beside_it_if_it_stands_on_the_goal() {
    let map = ".......\n.#####.\n.#####.\n.......";
    let [dead, start, second] = [Cell::new(3, 0), Cell::new(0, 0), Cell::new(0, 1)];
    let goal = Cell::new(6, 0);
    // Without the cell of the dead robot they cannot change their order.
    for (first, last) in [(Cell::new(6, 1), goal), (dead, goal)] {
        let mut world = World::new(map, &[(dead, dead), (start, first), (second, last)], Moves::FOUR);
        world.dead = 1;
        world.run(40, |_, _, _| false);
        assert_eq!(world.cells[2], last);
        if first == dead {
            assert!(world.robots[1].is_beside_goal() && world.cells[1].chebyshev(dead) == 1);
        } else {
            assert_eq!(world.cells[1], first);
        }
    }
}

#[test]
fn a_robot_that_says_that_it_stays_is_a_wall_until_it_moves() {
    let mut robot = Negotiator::<8>::new(RobotId(1), Cell::new(0, 0), Moves::FOUR);
    robot.set_goal(Cell::new(5, 0));
    let stays = Said { cell: Cell::new(1, 0), goal: Cell::new(1, 0), waiting: 1, ..Said::default() };
    for (is_held, expected) in [(true, false), (false, true), (true, false)] {
        robot.see(Cell::new(0, 0), &Sight::default());
        if is_held {
            robot.hear_staying(RobotId(2), &stays);
        } else {
            robot.hear(RobotId(2), &stays);
        }
        robot.decide(Sensed::Nothing);
        assert_eq!(robot.see(Cell::new(0, 0), &Sight::default()).wish.lost(Dir::East).is_some(), expected);
    }
}
