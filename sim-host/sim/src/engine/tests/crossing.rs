//! Diagonal moves of robots on the grid across each other.

use super::*;
use crate::scenario::Movement;
use staya_controller::grid::BLOCKED;

/// Robots 1 and 2 (or 2 and 1) on their way to the opposite corners of a square. The second one
/// starts `behind` cells farther away from the crossing; `classes` are those west and east of it.
fn two(is_reversed: bool, classes: [u8; 2], behind: i16) -> Scenario {
    let ways = [([3, 3], [15, 15]), ([15 + behind, 3 - behind], [3, 15])];
    let [(a, to_a), (b, to_b)] = if is_reversed { [ways[1], ways[0]] } else { ways };
    let list = format!("list = [{{ start = {a:?}, goal = {to_a:?} }}, {{ start = {b:?}, goal = {to_b:?} }}]");
    let mut scenario = scenario(&list, "");
    for (x, y) in (0..20).flat_map(|x| (0..20).map(move |y| (x, y))) {
        scenario.land.terrain.set(Cell::new(x, y), classes[usize::from(x > 9)]);
    }
    scenario
}

/// A swarm of 60 robots, and the shares of walls and of hard land, percent.
fn swarm(seed: u64, [walls, hard]: [u32; 2], loss: f64) -> Scenario {
    let radio = format!("[radio]\nrange_m = 12\nloss = {loss}\n");
    let mut scenario = scenario("scattered = { count = 60 }", &radio);
    (scenario.seed, scenario.ticks) = (seed, 120);
    let used: Vec<_> = scenario.robots.iter().flat_map(|robot| [robot.start, robot.goal]).collect();
    let mut draws = Rng::new(seed);
    for (x, y) in (0..20).flat_map(|x| (0..20).map(move |y| (x, y))) {
        let (draw, cell) = (draws.below(100), Cell::new(x, y));
        let class = if draw < walls && !used.contains(&cell) { BLOCKED } else { 1 + 4 * u8::from(draw > 99 - hard) };
        scenario.land.terrain.set(cell, class);
    }
    scenario
}

fn world(engine: &Engine) -> &crate::world::World {
    let AnyGround::Cells(grid) = &engine.ground else { panic!("a grid") };
    grid.world()
}

/// Runs the scenario; fails at a shared cell or a swap. Returns the crossed diagonals per tick,
/// summed, those that the world counted, and those of which one began in a later tick.
fn crossings(scenario: &Scenario) -> [u64; 3] {
    let mut engine = Engine::new(scenario, agents(scenario)).expect("free starts");
    let (mut crossed, mut late) = (0, 0);
    for tick in 0..scenario.ticks {
        let before = world(&engine).bodies().to_vec();
        engine.step();
        let bodies = world(&engine).bodies();
        let now = u64::from(tick) * 70;
        let mut others = Vec::new();
        for (old, new) in before.iter().zip(bodies) {
            let start = new.cell - new.entered_by.offset();
            let moves = old.cell != new.cell;
            for &(other, from, to, is_under_way, has_moved) in &others {
                assert_ne!(new.cell, to, "robot {other} is there");
                assert!(!moves || old.cell != to || new.cell != from, "tick {tick}: {old:?} with robot {other}");
                let meet = start + new.cell == from + to && new.free_at > now && is_under_way;
                if meet && start != new.cell && from != to {
                    crossed += 1;
                    late += u64::from(moves != has_moved);
                }
            }
            others.push((new.id.0, start, new.cell, new.free_at > now, moves));
        }
    }
    [crossed, engine.outcome().collisions, late]
}

#[test]
fn two_robots_whose_ways_cross_both_arrive_and_never_cross_at_once() {
    for classes in [[1, 1], [1, 2], [3, 1], [2, 2]] {
        for (behind, is_reversed) in (-2..=2).flat_map(|behind| [(behind, false), (behind, true)]) {
            let scenario = two(is_reversed, classes, behind);
            assert_eq!(crossings(&scenario), [0; 3], "{classes:?} {behind}");
            let outcome = simulate(&scenario, watch_nothing).expect("free starts");
            assert_eq!((outcome.arrived, outcome.collisions), (2, 0), "{classes:?} {behind}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn in_a_swarm_no_robots_cross_swap_or_share_a_cell(
        seed: u64,
        walls in 0..25_u32,
        hard in 0..50_u32,
        loss in prop_oneof![Just(0.0), Just(0.1), Just(0.3), 0.0..1.0_f64],
    ) {
        prop_assert_eq!(crossings(&swarm(seed, [walls, hard], loss)), [0; 3]);
    }
}

/// The laws alone, in a world that counts crossings. They cannot avoid moves that begin in the same
/// tick, nor a robot that could not make its announced move and took another one.
#[test]
fn the_laws_alone_avoid_diagonals_under_way_and_the_world_counts_the_others() {
    let count = |loss| {
        let mut sums = [0; 2];
        for seed in 1..=20 {
            let mut scenario = swarm(seed, [10, 20], loss);
            let Movement::Cells(rules) = &mut scenario.movement else { panic!("robots in cells") };
            rules.crossing = true;
            let [crossed, counted, late] = crossings(&scenario);
            assert_eq!(crossed, counted, "seed {seed}");
            sums = [sums[0] + crossed, sums[1] + late];
        }
        sums
    };
    let counts = [0.0, 0.1, 0.3, 0.999].map(count);
    println!("crossed and begun late at 0, 10, 30 and 99.9 % loss, summed over ticks of 20 runs: {counts:?}");
    assert!(counts[0][1] < counts[3][1], "{counts:?}");
}
