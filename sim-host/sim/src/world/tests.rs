use super::*;
use proptest::prelude::*;

fn moves(dirs: &[Dir]) -> Command<f32> {
    Command::Move(dirs.iter().copied().collect())
}

fn world(terrain: Terrain, rules: MoveRules, starts: &[(i16, i16)]) -> World {
    let starts = (1..).zip(starts).map(|(id, &(x, y))| (RobotId(id), Cell::new(x, y)));
    World::new(terrain, rules, 7, starts).expect("starts are free")
}

fn walled(wall: &[(i16, i16)], width: u16, height: u16) -> Terrain {
    let mut terrain = Terrain::flat(width, height);
    for &(x, y) in wall {
        terrain.set(Cell::new(x, y), BLOCKED);
    }
    terrain
}

#[test]
fn starts_in_walls_outside_or_on_each_other_are_refused() {
    let at = |x, y| {
        World::new(
            walled(&[(1, 1)], 3, 3),
            MoveRules::default(),
            0,
            [(RobotId(4), Cell::new(0, 0)), (RobotId(9), Cell::new(x, y))],
        )
    };
    for (x, y) in [(1, 1), (3, 0), (-1, 0), (i16::MAX, i16::MIN)] {
        let (robot, cell) = (RobotId(9), Cell::new(x, y));
        assert_eq!(at(x, y).err(), Some(Misplaced::Blocked { robot, cell }));
    }
    let (first, second, cell) = (RobotId(4), RobotId(9), Cell::new(0, 0));
    assert_eq!(at(0, 0).err(), Some(Misplaced::Overlap { first, second, cell }));
    assert!(at(2, 2).is_ok());
}

#[test]
fn first_open_move_is_taken_and_nothing_open_means_stay() {
    let mut world = world(walled(&[(1, 0)], 2, 2), MoveRules::default(), &[(0, 0), (0, 1)]);
    world.advance(0, &[moves(&[Dir::East, Dir::North, Dir::South]), Command::Hold]);
    assert_eq!(world.bodies()[0].cell, Cell::new(0, 0));
    world.advance(1, &[Command::Hold, moves(&[Dir::West, Dir::East])]);
    assert_eq!(world.bodies()[1].cell, Cell::new(1, 1));
    assert_eq!(world.body_at(Cell::new(1, 1)), Some(1));
    assert_eq!(world.body_at(Cell::new(0, 1)), None);
}

#[test]
fn diagonal_between_walls_needs_corner_cutting() {
    for (wall, corner_cutting, passes) in [
        (&[(1, 0)][..], false, false),
        (&[(0, 1)][..], false, false),
        (&[(1, 0), (0, 1)][..], true, true),
        (&[][..], false, true),
    ] {
        let rules = MoveRules { corner_cutting, ..MoveRules::default() };
        let mut world = world(walled(wall, 2, 2), rules, &[(0, 0)]);
        world.advance(0, &[moves(&[Dir::NorthEast])]);
        assert_eq!(world.bodies()[0].cell == Cell::new(1, 1), passes, "{wall:?}");
    }
}

#[test]
fn robots_beside_a_diagonal_do_not_hinder_it() {
    let mut world = world(Terrain::flat(2, 2), MoveRules::default(), &[(0, 0), (1, 0), (0, 1)]);
    world.advance(0, &[moves(&[Dir::NorthEast]), Command::Hold, Command::Hold]);
    assert_eq!(world.bodies()[0].cell, Cell::new(1, 1));
}

#[test]
fn a_journey_takes_exactly_the_route_cost_of_eq_7() {
    let mut terrain = Terrain::flat(40, 40);
    let path: Vec<Dir> = (0..30).map(|i| if i % 3 == 1 { Dir::North } else { Dir::NorthEast }).collect();
    let mut cell = Cell::new(0, 0);
    let mut cost = 0;
    for (i, dir) in path.iter().enumerate() {
        cell = cell + dir.offset();
        terrain.set(cell, 1 + (i % 4) as u8);
        cost += u64::from(dir.length(Norm::Euclidean)) * u64::from(terrain.get(cell));
    }
    let mut world = world(terrain, MoveRules::default(), &[(0, 0)]);
    let mut next = path.iter();
    let mut tick = 0;
    while !next.as_slice().is_empty() {
        let before = world.bodies()[0].cell;
        world.advance(tick, &[moves(&next.as_slice()[..1])]);
        if world.bodies()[0].cell != before {
            next.next();
        }
        tick += 1;
    }
    assert_eq!(world.bodies()[0].cell, cell);
    assert_eq!(world.bodies()[0].free_at, cost);
}

#[test]
fn waiting_a_whole_tick_forfeits_the_fraction() {
    let mut world = world(Terrain::flat(9, 9), MoveRules::default(), &[(0, 0)]);
    world.advance(0, &[moves(&[Dir::NorthEast])]);
    assert_eq!(world.bodies()[0].free_at, 99);
    world.advance(1, &[moves(&[Dir::NorthEast])]);
    assert_eq!(world.bodies()[0].cell, Cell::new(1, 1), "1.41 ticks are not over at tick 1");
    world.advance(2, &[Command::Hold]);
    world.advance(3, &[moves(&[Dir::NorthEast])]);
    assert_eq!(world.bodies()[0].free_at, 3 * 70 + 99);
}

#[test]
fn two_robots_never_swap_cells() {
    let mut world = world(Terrain::flat(2, 1), MoveRules::default(), &[(0, 0), (1, 0)]);
    for tick in 0..50 {
        world.advance(tick, &[moves(&[Dir::East]), moves(&[Dir::West])]);
        assert_eq!(world.bodies()[0].cell, Cell::new(0, 0));
    }
}

/// Four cells, row by row from the south-west, with the robots `ids` in the southern two.
fn square(classes: [u8; 4], ids: [u32; 2], rules: MoveRules) -> World {
    let terrain = Terrain::from_cells(2, 2, classes.to_vec()).expect("fits");
    let starts = ids.into_iter().map(RobotId).zip([Cell::new(0, 0), Cell::new(1, 0)]);
    World::new(terrain, rules, 7, starts).expect("starts are free")
}

#[test]
fn two_diagonals_through_one_point_are_never_under_way_at_once() {
    let both = [moves(&[Dir::NorthEast]), moves(&[Dir::NorthWest])];
    for (ids, classes) in [[1, 2], [2, 1]].into_iter().flat_map(|ids| [(ids, [1; 4]), (ids, [1, 1, 7, 2])]) {
        for late in 0..4 {
            let mut world = square(classes, ids, MoveRules::default());
            let mut under_way = [0_u64; 2];
            for tick in 0..20 {
                let commands = if tick < late { [both[0].clone(), Command::Hold] } else { both.clone() };
                world.advance(tick, &commands);
                assert_eq!(world.count_collisions(tick), 0);
                let now = u64::from(tick * UNIT);
                let is_under_way = [0, 1].map(|body| world.bodies()[body].free_at > now);
                assert_ne!(is_under_way, [true; 2], "tick {tick} of {ids:?} {classes:?}");
                for (ticks, is) in under_way.iter_mut().zip(is_under_way) {
                    *ticks += u64::from(is);
                }
            }
            let cells = [0, 1].map(|body| world.bodies()[body].cell);
            assert_eq!(cells, [Cell::new(1, 1), Cell::new(0, 1)], "the second goes when the first is there");
            assert!(under_way.iter().all(|&ticks| ticks > 0));
        }
    }
}

#[test]
fn a_world_that_allows_crossing_counts_it_while_both_are_under_way() {
    let rules = MoveRules { crossing: true, ..MoveRules::default() };
    // Robot 1 is under way for 2 * 1.41 ticks, robot 2 for 1.41 or 5 * 1.41.
    for (class, late, crossed) in [(1, 0, 2), (5, 0, 3), (5, 1, 2), (5, 2, 1), (5, 3, 0)] {
        for ids in [[1, 2], [2, 1]] {
            let mut world = square([1, 1, class, 2], ids, rules);
            let mut counts = 0;
            for tick in 0..20 {
                let second = if tick < late { Command::Hold } else { moves(&[Dir::NorthWest]) };
                world.advance(tick, &[moves(&[Dir::NorthEast]), second]);
                counts += world.count_collisions(tick);
            }
            assert_eq!(counts, crossed, "{late} ticks later");
        }
    }
}

#[test]
fn a_crossed_diagonal_goes_to_each_robot_equally_often_or_leaves_an_alternative() {
    let mut wins = [0_u32; 2];
    for tick in 0..3000 {
        let mut world = square([1; 4], [1, 2], MoveRules::default());
        world.advance(tick, &[moves(&[Dir::NorthEast]), moves(&[Dir::NorthWest, Dir::North])]);
        let [first, second] = [0, 1].map(|body| world.bodies()[body].cell);
        assert_ne!((first, second), (Cell::new(1, 1), Cell::new(0, 1)));
        wins[0] += u32::from(first == Cell::new(1, 1));
        wins[1] += u32::from(second == Cell::new(0, 1));
        assert!(second.y == 1 || first == Cell::new(1, 1));
    }
    // Three standard deviations of a binomial(3000, 1/2) are 82.
    assert!(wins.iter().all(|&w| w.abs_diff(1500) < 85), "{wins:?}");
}

#[test]
fn a_contested_cell_goes_to_each_robot_equally_often() {
    let mut wins = [0_u32; 3];
    for tick in 0..3000 {
        let mut world = world(Terrain::flat(3, 2), MoveRules::default(), &[(0, 0), (1, 0), (2, 0)]);
        let up = [moves(&[Dir::NorthEast]), moves(&[Dir::North]), moves(&[Dir::NorthWest])];
        world.advance(tick, &up);
        wins[world.body_at(Cell::new(1, 1)).expect("a robot moved")] += 1;
    }
    // Three standard deviations of a binomial(3000, 1/3) are 77.
    assert!(wins.iter().all(|&w| w.abs_diff(1000) < 80), "{wins:?}");
}

#[test]
fn a_queue_moves_together_and_a_circle_does_not_move() {
    let queue: Vec<_> = (0..6).map(|x| (x, 0)).collect();
    let circle = [(0, 1), (1, 1), (1, 2), (0, 2)];
    for tick in 0..50 {
        let starts = [&queue[..], &circle[..]].concat();
        let mut world = world(Terrain::flat(7, 3), MoveRules::default(), &starts);
        let mut commands = vec![moves(&[Dir::East]); 6];
        commands.extend([Dir::East, Dir::North, Dir::West, Dir::South].map(|dir| moves(&[dir])));
        world.advance(tick, &commands);
        let cells = world.bodies().iter().map(|body| (body.cell.x, body.cell.y));
        let moved = queue.iter().map(|&(x, y)| (x + 1, y));
        assert!(cells.eq(moved.chain(circle)), "tick {tick}");
    }
}

/// The cells of robots after one simultaneous move of each.
fn at_once(starts: &[(i16, i16)], dirs: &[Dir]) -> Vec<(i16, i16)> {
    let rules = MoveRules { orthogonal: true, simultaneous: true, ..MoveRules::default() };
    let mut world = world(walled(&[(3, 0)], 4, 3), rules, starts);
    world.advance(0, &dirs.iter().map(|&dir| moves(&[dir])).collect::<Vec<_>>());
    assert!(world.is_sound());
    world.bodies().iter().map(|body| (body.cell.x, body.cell.y)).collect()
}

#[test]
fn robots_that_move_at_once_follow_each_other_and_do_not_exchange_cells() {
    use Dir::{East, North, NorthEast, South, Stay, West};
    let row = [(0, 0), (1, 0)];
    assert_eq!(at_once(&row, &[East, East]), [(1, 0), (2, 0)]);
    let circle = [(0, 0), (1, 0), (1, 1), (0, 1)];
    assert_eq!(at_once(&circle, &[East, North, West, South]), [(1, 0), (1, 1), (0, 1), (0, 0)]);
    assert_eq!(at_once(&row, &[East, West]), row);
    let corner = [(0, 0), (1, 1), (2, 0)];
    assert_eq!(at_once(&corner, &[East, South, West]), [(1, 0), (1, 1), (2, 0)], "the first one placed");
    // A wall stops the last robot, which stops the others.
    let queue = [(0, 0), (1, 0), (2, 0)];
    assert_eq!(at_once(&queue, &[East; 3]), queue);
    assert_eq!(at_once(&queue, &[East, East, Stay]), queue);
    assert_eq!(at_once(&row, &[Stay, NorthEast]), row);
}

#[test]
fn the_collision_check_does_not_trust_the_occupancy_table() {
    let mut world = world(Terrain::flat(3, 1), MoveRules::default(), &[(0, 0), (1, 0), (2, 0)]);
    assert_eq!(world.count_collisions(0), 0);
    world.bodies[0].cell = Cell::new(1, 0);
    assert_eq!(world.count_collisions(0), 1);
    world.terrain.set(Cell::new(2, 0), BLOCKED);
    assert_eq!(world.count_collisions(0), 2);
    world.bodies[2].cell = Cell::new(-1, 0);
    assert_eq!(world.count_collisions(0), 2);
}

#[test]
fn window_is_always_square_and_walled_beyond_the_map() {
    let mut terrain = Terrain::flat(5, 4);
    terrain.set(Cell::new(1, 1), 9);
    let world = world(terrain, MoveRules::default(), &[]);
    let mut buffer = vec![7; 1000];
    let corner = world.window(Cell::new(0, 0), 1, &mut buffer).expect("on the map");
    assert_eq!((corner.origin(), corner.width(), corner.height()), (Cell::new(-1, -1), 3, 3));
    assert_eq!(corner.cells(), [0, 0, 0, 0, 1, 1, 0, 1, 9]);
    let other = world.window(Cell::new(4, 3), 1, &mut buffer).expect("on the map");
    assert_eq!(other.cells(), [1, 1, 0, 1, 1, 0, 0, 0, 0]);
    let own = world.window(Cell::new(1, 1), 0, &mut buffer).expect("on the map");
    assert_eq!(own.cells(), [9]);
    for outside in [(-1, 0), (5, 0), (0, 4), (i16::MIN, i16::MAX)] {
        let cell = Cell::new(outside.0, outside.1);
        assert!(world.window(cell, 1, &mut buffer).is_none(), "{outside:?}");
    }
}

#[test]
fn every_cell_of_a_window_is_that_of_the_map() {
    let cells = (0..20).map(|i| i % 4).collect();
    let terrain = Terrain::from_cells(5, 4, cells).expect("fits");
    let world = world(terrain, MoveRules::default(), &[]);
    let mut buffer = Vec::new();
    for radius in [1, 2, 6, u8::MAX] {
        let window = world.window(Cell::new(3, 1), radius, &mut buffer).expect("on the map");
        assert_eq!(window.width(), 2 * u16::from(radius) + 1);
        for (x, y) in (-8..14).flat_map(|x| (-8..14).map(move |y| (x, y))) {
            let cell = Cell::new(x, y);
            if let Some(seen) = window.get(cell) {
                assert_eq!(seen, world.terrain().get(cell), "{cell:?}");
            } else {
                assert!(cell.chebyshev(Cell::new(3, 1)) > u32::from(radius));
            }
        }
    }
}

fn any_command() -> impl Strategy<Value = Command<f32>> {
    prop_oneof![
        1 => Just(Command::Hold),
        6 => prop::collection::vec(0_u8..=8, 0..=8)
            .prop_map(|dirs| Command::Move(dirs.into_iter().map(Dir::from_index).collect())),
    ]
}

proptest! {
    #[test]
    fn no_commands_bring_two_robots_into_one_cell_or_across_each_other(
        cells in prop::collection::vec(0_u8..4, 36),
        corner_cutting: bool,
        simultaneous: bool,
        seed: u64,
        rounds in prop::collection::vec(prop::collection::vec(any_command(), 36), 1..20),
    ) {
        let mut terrain = Terrain::flat(6, 6);
        let all = (0..36).map(|i| Cell::new(i % 6, i / 6));
        for (cell, &u) in all.clone().zip(&cells) {
            terrain.set(cell, u);
        }
        let starts: Vec<_> = (1..).map(RobotId)
            .zip(all.filter(|&c| terrain.is_passable(c)).step_by(2))
            .collect();
        let rules = MoveRules { corner_cutting, orthogonal: simultaneous, simultaneous, ..MoveRules::default() };
        let mut world = World::new(terrain, rules, seed, starts).expect("starts are free");
        for (tick, commands) in (0..).zip(&rounds) {
            let before = world.bodies().to_vec();
            world.advance(tick, commands);
            prop_assert_eq!(world.count_collisions(tick), 0);
            for pair in (0..before.len()).flat_map(|one| (0..one).map(move |other| [one, other])) {
                let [one, other] = pair.map(|index| (before[index].cell, world.bodies()[index].cell));
                prop_assert!(one.0 != other.1 || one.1 != other.0, "a swap of {:?}", one);
            }
            for (old, new) in before.iter().zip(world.bodies()) {
                prop_assert!(old.cell.chebyshev(new.cell) <= 1);
                prop_assert!(old.cell == new.cell || old.free_at <= u64::from(tick) * u64::from(UNIT));
            }
        }
    }

    #[test]
    fn the_order_of_robots_in_memory_does_not_matter(
        seed: u64,
        rounds in prop::collection::vec(prop::collection::vec(any_command(), 12), 1..10),
    ) {
        let starts: Vec<_> = (0..12).map(|i| (RobotId(i + 1), Cell::new(i as i16 % 4, i as i16 / 4))).collect();
        let terrain = Terrain::flat(5, 4);
        let build = |starts: Vec<_>| World::new(terrain.clone(), MoveRules::default(), seed, starts).expect("free");
        let mut forward = build(starts.clone());
        let mut backward = build(starts.into_iter().rev().collect());
        for (tick, commands) in (0..).zip(rounds) {
            forward.advance(tick, &commands);
            let reversed: Vec<_> = commands.into_iter().rev().collect();
            backward.advance(tick, &reversed);
        }
        let mut mirrored = backward.bodies().to_vec();
        mirrored.reverse();
        prop_assert_eq!(forward.bodies(), mirrored);
    }
}

proptest! {
    /// KUZ, section 3.1: the states of a robot with shifts of time are one category, the cells with
    /// lattice paths another, and `@` is a functor both ways. A robot is a coiterator: it produces
    /// the stream of cells that it passes.
    #[test]
    fn shifts_of_time_are_mapped_to_lattice_paths_and_their_costs_add_up(
        classes in prop::collection::vec(1..=3_u8, 30),
        wishes in prop::collection::vec([0..8_usize, 0..8, 0..8], 24),
        mut ticks in [0..=24_usize, 0..=24, 0..=24],
    ) {
        let land = Terrain::from_cells(6, 5, classes).unwrap();
        let mut world = world(land.clone(), MoveRules::default(), &[(0, 0), (3, 2), (5, 4)]);
        let mut streams: Vec<Vec<(Cell, u64)>> = world.bodies().iter().map(|body| vec![(body.cell, 0)]).collect();
        for (tick, wish) in (0..).zip(wishes) {
            world.advance(tick, &wish.map(|dir| moves(&[Dir::MOVES[dir]])));
            for (index, body) in world.bodies().iter().enumerate() {
                prop_assert_eq!(world.body_at(body.cell), Some(index), "there and back is the identity");
                streams[index].push((body.cell, body.crossing));
            }
        }
        ticks.sort_unstable();
        let [a, b, c] = ticks;
        for stream in &streams {
            let path = |from: usize, to: usize| {
                let mut cells: Vec<Cell> = stream[from..=to].iter().map(|(cell, _)| *cell).collect();
                cells.dedup();
                cells
            };
            prop_assert_eq!(path(a, a).len(), 1, "no time: the path that stays");
            let composed: Vec<Cell> = path(a, b).into_iter().chain(path(b, c).into_iter().skip(1)).collect();
            prop_assert_eq!(path(a, c), composed);
            let cost = |from: usize, to: usize| {
                let steps = path(from, to);
                let dirs = steps.windows(2).map(|pair| Dir::between(pair[0], pair[1]).map(|dir| (dir, pair[1])));
                let dirs: Option<Vec<_>> = dirs.collect();
                dirs.map(|dirs| dirs.iter().map(|(dir, to)| crossing_of(&land, *dir, *to)).sum::<u64>())
            };
            let entered = stream.windows(2).take(c).skip(a).filter(|pair| pair[0].0 != pair[1].0);
            prop_assert_eq!(cost(a, c), Some(entered.map(|pair| pair[1].1).sum()), "a lattice path, and eq. 6");
            prop_assert_eq!(cost(a, c), cost(a, b).zip(cost(b, c)).map(|(one, other)| one + other));
        }
    }
}

fn crossing_of(land: &Terrain, dir: Dir, to: Cell) -> u64 {
    u64::from(dir.length(Norm::Euclidean)) * u64::from(land.get(to))
}
