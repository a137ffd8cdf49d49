//! Robots that negotiate in the simulator.

use staya_controller::grid::{BLOCKED, Cell};
use staya_sim::record::RobotRow;
use staya_sim::scenario::{Overrides, Scenario};
use staya_sim::terrain::Terrain;
use staya_tests::{root, run, scenario};
use std::path::PathBuf;

/// Cells of half a metre, for discs 0.3 m wide.
fn in_plane(map: &str, ends: &[([u8; 2], [u8; 2])], loss: f64, more: &str) -> Scenario {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let rows: Vec<&str> = map.split_whitespace().collect();
    let (width, height) = (rows[0].len(), rows.len());
    let map = format!("type octile\nheight {height}\nwidth {width}\nmap\n{}\n", rows.join("\n"));
    std::fs::write(folder.path().join("maze.map"), map).expect("a map");
    let list = ends.iter().map(|(start, goal)| format!("{{ start = {start:?}, goal = {goal:?} }}"));
    let text = format!(
        "name = \"maze\"\nticks = 2400\ntick_s = 0.05\n\
         [terrain]\nfile = \"maze.map\"\ncell_m = 0.5\n\
         [robots]\nlist = [{}]\n\
         [radio]\nrange_m = 3\nloss = {loss}\n\
         [plane]\nradius_m = 0.15\nmax_speed_mps = 1\nmax_acceleration_mps2 = 2\nlaw = \"negotiation\"\n\
         [plane.orca]\nhorizon_s = 1\nwall_horizon_s = 0.3\nalone_mps = 1\n{more}",
        list.collect::<Vec<_>>().join(", "),
    );
    let overrides = Overrides { seed: None, ticks: None };
    Scenario::parse(&text, &folder.path().join("s.toml"), &overrides).unwrap_or_else(|error| panic!("{error}"))
}

/// Distance of a disc to the walls, metres.
fn to_walls(land: &Terrain, robot: &RobotRow) -> f64 {
    let [x, y, _] = robot.motion.position_m;
    let Cell { x: column, y: row } = robot.motion.cell;
    let around = (-1..=1).flat_map(|dx| (-1..=1).map(move |dy| Cell::new(column + dx, row + dy)));
    let walls = around.filter(|&cell| land.index(cell).is_some() && land.get(cell) == BLOCKED).map(|cell| {
        let [at_x, at_y] = land.center_m(cell);
        let [dx, dy] = [x - at_x, y - at_y].map(|way| (way.abs() - land.cell_m / 2.0).max(0.0));
        (dx * dx + dy * dy).sqrt()
    });
    walls.fold(f64::INFINITY, f64::min) - 0.15
}

/// All arrive, and touch neither each other nor a wall. Returns the ticks.
fn all_arrive(scenario: &Scenario, what: &str) -> u32 {
    let (outcome, rows) = run(scenario);
    let gap_m = outcome.clearance.expect("bodies").bodies_m;
    assert_eq!((outcome.arrived, outcome.collisions), (scenario.robots.len(), 0), "{what}");
    assert!(gap_m > 0.001, "{what}: {gap_m} m");
    let robots = rows.iter().flat_map(|(_, robots)| robots);
    let wall_m = robots.map(|robot| to_walls(&scenario.land.terrain, robot)).fold(f64::INFINITY, f64::min);
    assert!(wall_m > 0.001, "{what}: {wall_m} m from a wall");
    outcome.ticks
}

#[test]
fn two_discs_pass_each_other_at_the_only_side_cell_of_a_corridor() {
    let map = "@@@@.@@@@@ .......... @@@@@@@@@@";
    for loss in [0.0, 0.3, 0.6] {
        for seed in 1..=3 {
            let mut scenario = in_plane(map, &[([0, 1], [9, 1]), ([9, 1], [0, 1])], loss, "");
            scenario.seed = seed;
            let ticks = all_arrive(&scenario, &format!("seed {seed}, loss {loss}"));
            // Nine cells at a cell in 0.6 s are 108 ticks.
            assert!(ticks < 400, "seed {seed}, loss {loss}: {ticks} ticks");
        }
    }
}

/// Four robots whose ways cross in a maze of corridors one cell wide.
const MAZE: &str = ".@...@. ...@... .@.@.@. .....@. @@.@@@. ....... .@...@.";
const CROSSING: [([u8; 2], [u8; 2]); 4] = [([0, 0], [6, 6]), ([6, 6], [0, 0]), ([0, 6], [6, 0]), ([6, 0], [0, 6])];

#[test]
fn four_discs_cross_a_maze_at_any_loss() {
    for loss in [0.0, 0.3, 0.6] {
        for seed in 1..=3 {
            let mut scenario = in_plane(MAZE, &CROSSING, loss, "");
            scenario.seed = seed;
            all_arrive(&scenario, &format!("seed {seed}, loss {loss}"));
        }
    }
}

/// A robot that restarts has another clock, and no memory; it stands between cells.
#[test]
fn a_robot_that_restarts_in_the_maze_joins_the_steps_of_the_others() {
    for tenths in (5..65).step_by(5) {
        for down_s in [0.0, 1.33] {
            let (robot, at_s) = (tenths / 5 % 4 + 1, f64::from(tenths) / 10.0);
            let fault = format!("[[fault]]\nrobot = {robot}\nat_s = {at_s}\ndown_s = {down_s}\n");
            let what = format!("robot {robot} restarts after {at_s} s, down for {down_s} s");
            all_arrive(&in_plane(MAZE, &CROSSING, 0.0, &fault), &what);
        }
    }
}

#[test]
fn robots_pass_each_other_in_a_corridor_at_any_loss() {
    for loss in [0.0, 0.1, 0.3, 0.6] {
        for seed in 1..=5 {
            let mut scenario = scenario("corridor", None);
            scenario.seed = seed;
            scenario.radio.loss = loss;
            let (outcome, _) = run(&scenario);
            assert_eq!((outcome.arrived, outcome.collisions), (4, 0), "seed {seed}, loss {loss}");
        }
    }
}

#[test]
fn a_disc_walks_around_one_that_died_in_a_corridor() {
    let map = ".......... .@@@@@@@@. ..........";
    let ends = [([3, 0], [9, 0]), ([0, 0], [9, 1])];
    for loss in [0.0, 0.3, 0.6] {
        let scenario = in_plane(map, &ends, loss, "[[fault]]\nrobot = 1\nat_s = 4\ndown_s = 1000\n");
        let (outcome, _) = run(&scenario);
        assert_eq!((outcome.arrived, outcome.collisions), (1, 0), "loss {loss}");
    }
}

#[test]
fn a_lone_robot_that_negotiates_moves_as_by_a_route() {
    for seed in 1..=8 {
        let text = |law: &str| {
            format!(
                "name = \"lone\"\nseed = {seed}\nticks = 600\n{law}\
                 [terrain.natural]\nwidth = 100\nheight = 100\nobstacles = 70\n\
                 [robots]\nlist = [{{ start = [1, 1], goal = [98, 98] }}]\n[radio]\nrange_m = 8\n"
            )
        };
        let run = |law: &str| {
            let none = Overrides { seed: None, ticks: None };
            run(&Scenario::parse(&text(law), &root().join("scenarios/lone.toml"), &none).unwrap()).0
        };
        let (route, negotiated) = (run(""), run("grid = { law = \"negotiation\" }\n"));
        assert_eq!((route.arrived, route.trace_hash), (1, negotiated.trace_hash), "seed {seed}");
    }
}

const LAW: &str = "law = \"negotiation\"\n";

/// Sixty robots of a benchmark among walls.
fn crowd() -> (PathBuf, String) {
    let file = root().join("scenarios/moving-ai-20.toml");
    let text = std::fs::read_to_string(&file).unwrap().replace("count = 20", "count = 60");
    assert!(text.contains(LAW));
    (file, text)
}

#[test]
fn a_crowd_walks_around_dead_robots() {
    let (file, mut text) = crowd();
    for (robot, at_s) in [(10, 3), (21, 4), (34, 5), (46, 6), (55, 7)] {
        text += &format!("[[fault]]\nrobot = {robot}\nat_s = {at_s}\ndown_s = 10000\n");
    }
    // With the last three, two robots want the cell of a dead one, and hear of it from each other.
    for seed in [4, 5, 6, 12, 19, 38] {
        let scenario = Scenario::parse(&text, &file, &Overrides { seed: Some(seed), ticks: Some(200) }).unwrap();
        let (outcome, _) = run(&scenario);
        assert_eq!((outcome.arrived, outcome.collisions), (55, 0), "seed {seed}");
    }
}

#[test]
fn a_crowd_arrives_sooner_by_negotiation_than_by_routes() {
    let (file, text) = crowd();
    for seed in 4..=6 {
        let run = |text: &str| {
            let overrides = Overrides { seed: Some(seed), ticks: None };
            run(&Scenario::parse(text, &file, &overrides).unwrap()).0
        };
        let (by_routes, negotiated) = (run(&text.replace(LAW, "")), run(&text));
        assert_eq!((negotiated.arrived, negotiated.collisions), (60, 0), "seed {seed}");
        assert!(negotiated.ticks < by_routes.ticks, "seed {seed}: {} and {}", negotiated.ticks, by_routes.ticks);
    }
}

/// A scene on the grid; `S` costs `swamp`.
fn on_grid(rows: &str, ends: &[([u8; 2], [u8; 2])], (loss, swamp, seed): (f64, u8, u64), more: &str) -> Scenario {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let rows: Vec<&str> = rows.split_whitespace().collect();
    let (width, height) = (rows[0].len(), rows.len());
    let map = format!("type octile\nheight {height}\nwidth {width}\nmap\n{}\n", rows.join("\n"));
    std::fs::write(folder.path().join("scene.map"), map).expect("a map");
    let list = ends.iter().map(|(start, goal)| format!("{{ start = {start:?}, goal = {goal:?} }}"));
    let text = format!(
        "name = \"scene\"\nticks = 600\n[terrain]\nfile = \"scene.map\"\nload.swamp = {swamp}\n\
         [robots]\nlist = [{}]\n[radio]\nrange_m = 12\nloss = {loss}\n[grid]\n{LAW}{more}",
        list.collect::<Vec<_>>().join(", "),
    );
    let overrides = Overrides { seed: Some(seed), ticks: None };
    Scenario::parse(&text, &folder.path().join("s.toml"), &overrides).unwrap_or_else(|error| panic!("{error}"))
}

/// A map, its robots, and ticks within which they arrive on flat land with a perfect radio.
type Scene = (&'static str, &'static str, &'static [([u8; 2], [u8; 2])], u32);

/// Where two robots or more need the same cells in opposite directions. The rule was made without
/// those of the second half.
const SCENES: [Scene; 10] = [
    ("a door between two rooms", "....@....  .........  ....@....", &[([0, 1], [8, 1]), ([8, 1], [0, 1])], 25),
    (
        "two from each side through a corridor",
        "...@@@@@@...  ............  ...@@@@@@...",
        &[([0, 1], [11, 1]), ([0, 0], [11, 0]), ([11, 1], [0, 1]), ([11, 2], [0, 2])],
        60,
    ),
    (
        "a corridor with one side cell",
        "@@@@@.@@@@@  ...........  @@@@@@@@@@@",
        &[([0, 1], [10, 1]), ([10, 1], [0, 1])],
        40,
    ),
    (
        "a crossing",
        "@@@.@@@  @@@.@@@  @@@.@@@  .......  @@@.@@@  @@@.@@@  @@@.@@@",
        &[([0, 3], [6, 3]), ([6, 3], [0, 3]), ([3, 0], [3, 6]), ([3, 6], [3, 0])],
        40,
    ),
    (
        "out of a dead end past one that comes in",
        "@@@@@@....  ..........  @@@@@@....",
        &[([0, 1], [9, 1]), ([9, 1], [0, 1])],
        40,
    ),
    (
        "a slow corridor beside a long way around",
        "..............  .@@@@@@@@@@@@.  .@@@@@@@@@@@@.  SSSSSSSSSSSSSS  ..............",
        &[([0, 1], [13, 1]), ([13, 1], [0, 1]), ([0, 0], [13, 0]), ([13, 0], [0, 0])],
        60,
    ),
    (
        "three from each side through a long corridor",
        "....@@@@@@@@@@@@....  ....................  ....@@@@@@@@@@@@....",
        &[
            ([0, 0], [19, 0]),
            ([0, 1], [19, 1]),
            ([0, 2], [19, 2]),
            ([19, 0], [0, 0]),
            ([19, 1], [0, 1]),
            ([19, 2], [0, 2]),
        ],
        110,
    ),
    (
        "a room that all leave while others enter",
        "......@....  ......@....  ...........  ......@....  ......@....",
        &[([1, 0], [9, 0]), ([1, 2], [9, 2]), ([1, 4], [9, 4]), ([9, 1], [1, 1]), ([9, 3], [1, 3])],
        50,
    ),
    (
        "a robot that stands in the corridor at its goal",
        "...@@@@@@@...  .............  ...@@@@@@@...",
        &[([6, 1], [6, 1]), ([0, 1], [12, 1]), ([12, 0], [0, 0])],
        80,
    ),
    (
        "two corridors in a row with a hall between",
        "..@@@@....@@@@..  ................  ..@@@@....@@@@..",
        &[([0, 1], [15, 1]), ([15, 1], [0, 1]), ([0, 0], [15, 0]), ([15, 2], [0, 2])],
        80,
    ),
];

#[test]
fn robots_pass_each_other_wherever_there_is_room_to_step_aside() {
    let mut late = Vec::new();
    for (what, map, ends, most) in SCENES {
        for (loss, swamp) in [(0.0, 1), (0.3, 1), (0.6, 1), (0.0, 4), (0.3, 9)] {
            for seed in 1..=3 {
                let (outcome, _) = run(&on_grid(map, ends, (loss, swamp, seed), ""));
                let case = format!("{what}: loss {loss}, swamp {swamp}, seed {seed}");
                assert_eq!(outcome.collisions, 0, "{case}");
                let is_easy = (loss, swamp) == (0.0, 1);
                if outcome.arrived < ends.len() || (is_easy && outcome.ticks > most) {
                    late.push(format!("{case}: {} of {} after {} ticks", outcome.arrived, ends.len(), outcome.ticks));
                }
            }
        }
    }
    assert!(late.is_empty(), "{}", late.join("\n"));
}
