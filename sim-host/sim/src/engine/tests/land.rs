use super::*;
use staya_controller::agent::Wait;
use staya_controller::grid::{BLOCKED, UNIT};
use staya_controller::parameters::Value as _;
use staya_controller::route::Replan;

fn parse(text: &str) -> Scenario {
    Scenario::parse(text, Path::new("t.toml"), &Overrides::default()).expect("a good scenario")
}

fn door(robots: &str, changes: &str, rest: &str) -> Scenario {
    let wall = "[[terrain.change]]\nclass = 0\ncells = [[15, 0], [15, 1], [15, 2], [15, 4], [15, 5], [15, 6]]\n";
    parse(&format!(
        "name = \"t\"\nticks = 600\ntick_s = 0.5\n[terrain]\ncell_m = 2\n\
         uniform = {{ width = 30, height = 7, classes = 1 }}\n{wall}{changes}\n[robots]\n{robots}\n{rest}"
    ))
}

const ONE: &str = "list = [{ start = [2, 3], goal = [27, 3] }]";
const EIGHT: &str = "list = [{ start = [1, 1], goal = [27, 1] }, { start = [2, 3], goal = [27, 3] }, \
    { start = [3, 5], goal = [27, 5] }, { start = [4, 2], goal = [28, 2] }, { start = [28, 3], goal = [2, 3] }, \
    { start = [27, 4], goal = [3, 4] }, { start = [26, 1], goal = [1, 6] }, { start = [25, 5], goal = [4, 0] }]";

/// Also returns the ticks in which robot 1 waited for a route.
fn run(scenario: &Scenario) -> (Outcome, Vec<u32>) {
    let (mut before, mut stuck) = (Vec::new(), Vec::new());
    let outcome = simulate(scenario, |moment, rows| {
        let land = moment.land.expect("there is land");
        let rows: Vec<RobotRow> = rows.collect();
        let cells: Vec<Cell> = rows.iter().map(|row| row.motion.cell).collect();
        for (now, then) in cells.iter().zip(&before).filter(|(now, then)| now != then) {
            // The terrain of this moment is that of the tick in which the robot moved.
            assert!(land.is_passable(*now), "tick {}: from {then:?} to {now:?}", moment.row.tick);
        }
        before = cells;
        if rows[0].wait == Some(Wait::Route) {
            stuck.push(moment.row.tick);
        }
        ControlFlow::Continue(())
    });
    let outcome = outcome.expect("they can be placed");
    assert_eq!(outcome.collisions, 0);
    (outcome, stuck)
}

#[test]
fn robots_pass_a_gate_once_it_opens() {
    for replan in ["each_cell", "until_changed"] {
        let route = format!("[grid.route]\nreplan = \"{replan}\"\n");
        let free = run(&door(ONE, "", &route)).0;
        let gate = "[[terrain.change]]\nclass = 0\ncells = [[15, 3]]\nfor_s = 60\n";
        let kept = run(&door(ONE, gate, &route)).0;
        assert_eq!((free.arrived, kept.arrived), (1, 1), "{replan}");
        let ticks = kept.ticks;
        assert!(free.ticks < 60 && (130..300).contains(&ticks), "{replan}: {} and {ticks}", free.ticks);
    }
}

#[test]
fn a_robot_takes_another_route_when_one_closes_ahead() {
    for replan in ["each_cell", "until_changed"] {
        let changes = "[[terrain.change]]\nclass = 1\ncells = [[15, 0]]\n\
            [[terrain.change]]\nat_s = 5\nclass = 0\ncells = [[15, 3]]\n";
        let (outcome, _) = run(&door(ONE, changes, &format!("[grid.route]\nreplan = \"{replan}\"\n")));
        assert_eq!(outcome.arrived, 1, "{replan}");
        assert!(outcome.ticks < 60, "{replan}: {}", outcome.ticks);
    }
}

#[test]
fn a_robot_may_leave_a_closing_cell_and_none_may_enter() {
    // The door closes in the third of nine ticks in which robot 1 crosses it.
    let robots = "list = [{ start = [14, 3], goal = [20, 3] }, { start = [11, 3], goal = [20, 4] }]";
    let changes = "[[terrain.change]]\nclass = 9\ncells = [[15, 3]]\n[[terrain.change]]\nat_s = 1\nclass = 0\ncells = [[15, 3]]\n";
    let (outcome, _) = run(&door(robots, changes, ""));
    assert_eq!(outcome.arrived, 1);
    assert_eq!(outcome.arrival_times, [Some(14 * u64::from(UNIT)), None]);
}

#[test]
fn a_closed_goal_is_replaced_by_the_nearest_cell_until_it_opens() {
    let changes = "[[terrain.change]]\nat_s = 50\nclass = 0\ncells = [[27, 3]]\nfor_s = 50\n";
    let scenario = door("list = [{ start = [2, 3], goal = [27, 3] }, { start = [2, 1], goal = [2, 5] }]", changes, "");
    let mut swarm = operated(&scenario).expect("they can be placed");
    let mut cells = Vec::new();
    for _ in 0..220 {
        swarm.step();
        cells.push(swarm.observation(0).motion.cell);
    }
    let at = |seconds: usize| cells[2 * seconds - 1];
    assert_eq!(at(49), Cell::new(27, 3));
    assert_eq!(at(90).chebyshev(Cell::new(27, 3)), 1, "it has left the closed cell");
    assert_eq!(at(110), Cell::new(27, 3));
}

#[test]
fn an_enclosed_robot_stops_and_reports_it() {
    let ring = "[[terrain.change]]\nat_s = 5\nclass = 0\n\
        cells = [[1, 2], [2, 2], [3, 2], [1, 3], [3, 3], [1, 4], [2, 4], [3, 4]]\nfor_s = 100\n";
    let room = "[[terrain.change]]\nat_s = 0\nclass = 0\ncells = [[4, 1], [4, 2], [4, 3], [4, 4], [4, 5], \
        [0, 1], [0, 2], [0, 3], [0, 4], [0, 5], [1, 1], [2, 1], [3, 1], [1, 5], [2, 5], [3, 5]]\nfor_s = 100\n";
    let robots = "list = [{ start = [2, 3], goal = [27, 3] }]";
    for (changes, first) in [(ring, 10), (room, 1)] {
        let scenario = door(robots, changes, "[[fault]]\nrobot = 1\nat_s = 0\ndown_s = 5\n");
        let (outcome, stuck) = run(&scenario);
        assert_eq!(outcome.arrived, 1, "the wall goes");
        assert!(stuck.len() > 150 && stuck[0] >= first && *stuck.last().expect("some") <= 210, "{stuck:?}");
        let mut swarm = operated(&scenario).expect("it can be placed");
        let mut said = 0;
        for _ in 0..100 {
            swarm.step();
            said += swarm.events(0).iter().filter(|event| **event == Event::NoRoute).count();
        }
        assert_eq!(said, 1, "once, when it begins");
    }
}

#[test]
fn a_formation_waits_at_a_gate_and_passes_it() {
    let robots = "formation = { rows = 2, columns = 2, spacing = [2, -2], start = [4, 4], goal = [24, 4] }";
    let gate = "[[terrain.change]]\nclass = 1\ncells = [[15, 2]]\n\
        [[terrain.change]]\nat_s = 4\nevery_s = 60\nfor_s = 40\nclass = 0\ncells = [[15, 2], [15, 3]]\n";
    let (outcome, _) = run(&Scenario { ticks: 2000, ..door(robots, gate, "") });
    assert_eq!(outcome.arrived, 4, "after {} ticks", outcome.ticks);
    assert!(outcome.formation.is_some_and(|keeping| keeping.error_per_agent < 6.0), "{:?}", outcome.formation);
}

#[test]
fn terrain_changes_do_not_depend_on_threads() {
    let changes = "[[terrain.change]]\nevery_s = 8\nfor_s = 4\nclass = 0\ncells = [[15, 3]]\n\
        [[terrain.change]]\nevery_s = 1\ndrift = { share = 0.1, classes = 4 }\n";
    let scenario = door(EIGHT, changes, "[scouting]\nradius = 9\nunknown = 0.2\nwrong = 0.2\n");
    let hashes = [1, 2, 5].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| run(&scenario).0.trace_hash)
    });
    assert_eq!(hashes, [hashes[0]; 3]);
    assert_ne!(hashes[0], run(&door(EIGHT, "", "")).0.trace_hash);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn no_robot_enters_a_closed_cell(
        gates in proptest::collection::vec((8_u16..22, 0_u16..6, 1_u16..5, 1_u16..5, 0_u32..80, 1_u32..40, 1_u32..40), 1..6),
        share in 0.0..0.5_f64,
        until_changed: bool,
        is_scouted: bool,
    ) {
        let gate = |(x, y, width, height, at, lasts, rests): (u16, u16, u16, u16, u32, u32, u32)| {
            let (width, height, every) = (width.min(30 - x), height.min(7 - y), lasts + rests);
            format!(
                "[[terrain.change]]\nat_s = {at}\nevery_s = {every}\nfor_s = {lasts}\nclass = 0\n\
                 rectangle = {{ x = {x}, y = {y}, width = {width}, height = {height} }}\n"
            )
        };
        let gates: String = gates.into_iter().map(gate).collect();
        let drift = format!("[[terrain.change]]\nevery_s = 2\ndrift = {{ share = {share}, step = 2, classes = 5 }}\n");
        let replan = if until_changed { "[grid.route]\nreplan = \"until_changed\"\n" } else { "" };
        let scouting = if is_scouted { "[scouting]\nradius = 8\nunknown = 0.3\nwrong = 0.3\n" } else { "" };
        let scenario = door(EIGHT, &(gates + &drift), &format!("{replan}{scouting}"));
        run(&Scenario { ticks: 250, ..scenario });
    }
}

fn discs(first: [f64; 2], second: [f64; 2], change: &str) -> Scenario {
    parse(&format!(
        "name = \"t\"\nticks = 900\ntick_s = 0.1\n[terrain]\nuniform = {{ width = 12, height = 3, classes = 1 }}\n\
         [[terrain.change]]\nclass = 0\nrectangle = {{ x = 5, y = 0, width = 2, height = 3 }}\n{change}\n\
         [plane]\nradius_m = 0.2\nmax_speed_mps = 1\nlaw = \"route\"\n\
         [robots]\nlist = [{{ start = [{}, {}], goal = [10, 1] }}, {{ start = [{}, {}], goal = [10, 2] }}]\n",
        first[0], first[1], second[0], second[1]
    ))
}

fn class_under(land: &crate::terrain::Terrain, place_m: [f64; 3]) -> u8 {
    land.cell_at([place_m[0], place_m[1]]).map_or(BLOCKED, |cell| land.get(cell))
}

#[test]
fn in_the_plane_a_robot_may_leave_a_closing_cell_and_none_may_enter() {
    let scenario = discs([2.0, 1.0], [0.0, 1.0], "at_s = 4.3\nfor_s = 30");
    let (mut was_in, mut inside) = (Vec::new(), Vec::new());
    let outcome = simulate(&scenario, |moment, rows| {
        let land = moment.land.expect("there is land");
        let is_in: Vec<bool> = rows.map(|row| class_under(land, row.motion.position_m) == BLOCKED).collect();
        if moment.row.tick > 44 {
            for (is_in, was_in) in is_in.iter().zip(&was_in) {
                assert!(!is_in || *was_in, "tick {}: a robot has entered", moment.row.tick);
            }
        }
        inside.extend(is_in.iter().any(|&is_in| is_in).then_some(moment.row.tick));
        was_in = is_in;
        ControlFlow::Continue(())
    });
    let outcome = outcome.expect("they can be placed");
    assert!(inside.first() == Some(&44) && inside.last() < Some(&80), "one leaves it: {inside:?}");
    assert_eq!((outcome.arrived, outcome.collisions), (2, 0));
    let [first, second] = [0, 1].map(|number| outcome.arrival_times[number].expect("arrived") / u64::from(UNIT));
    assert!(first < 140 && second > 340, "{first} and {second}");
}

fn with_maps(now: &[&str], old: &[&str], rest: &str) -> Scenario {
    let dir = tempfile::tempdir().expect("a folder");
    for (name, rows) in [("now.map", now), ("old.map", old)] {
        let text = format!("type octile\nheight {}\nwidth {}\nmap\n{}\n", rows.len(), rows[0].len(), rows.join("\n"));
        std::fs::write(dir.path().join(name), text).expect("it can be written");
    }
    let text = format!(
        "name = \"t\"\nticks = 3000\n[terrain]\nfile = \"now.map\"\n[grid]\nradius = 3\n\
         [robots]\nlist = [{{ start = [1, 0], goal = [18, 0] }}]\n{rest}"
    );
    Scenario::parse(&text, &dir.path().join("t.toml"), &Overrides::default()).expect("a good scenario")
}

const WALL: [&str; 8] = [
    "....................",
    "..........@.........",
    "..........@.........",
    "..........@.........",
    "..........@.........",
    "..........@.........",
    "..........@.........",
    "..........@.........",
];
const NO_DOOR_IN_THE_NORTH: [&str; 8] = [
    "..........@.........",
    "..........@.........",
    "..........@.........",
    "..........@.........",
    "..........@.........",
    "..........@.........",
    "..........@.........",
    "....................",
];

#[test]
fn a_robot_with_a_map_goes_straight_to_an_unseen_door() {
    let ticks = |rest: &str| {
        let (outcome, _) = run(&with_maps(&WALL, &WALL, rest));
        assert_eq!(outcome.arrived, 1, "{rest}");
        outcome.ticks
    };
    let (alone, with_map) = (ticks(""), ticks("[scouting]\nmap = \"old.map\"\n"));
    // The shortest path: seven moves up and seven down among seventeen.
    assert!(with_map < 27 && alone > with_map, "{with_map} with a map, {alone} without");
    let memory = ticks("[scouting]\nunknown = 1\n");
    assert!((with_map..=2 * alone).contains(&memory), "{memory}");
    // As a table of costs to go, with a node for each cell, and of a tenth of the bytes.
    for bytes in [400, 66] {
        let with_table = ticks(&format!("[scouting]\nmap = \"old.map\"\nmodel_bytes = {bytes}\n"));
        assert!(with_table <= with_map + 2, "{with_table} by {bytes} bytes, {with_map} with a map");
        // A map that is shared, too, does not take its place.
        let both = ticks(&format!("[maps]\nshare = true\n[scouting]\nmap = \"old.map\"\nmodel_bytes = {bytes}\n"));
        assert_eq!(both, with_table, "{bytes}");
    }
}

#[test]
fn a_wrong_map_only_costs_time() {
    for replan in [Replan::EachCell, Replan::UntilChanged] {
        let [right, wrong] = [&WALL, &NO_DOOR_IN_THE_NORTH].map(|old| {
            let mut scenario = with_maps(&WALL, old, "[scouting]\nmap = \"old.map\"\n");
            scenario.set_in_laws("replan", replan.number());
            run(&scenario).0
        });
        assert_eq!((right.arrived, wrong.arrived), (1, 1), "{replan:?}");
        assert!(wrong.ticks > right.ticks, "{replan:?}: {} and {}", wrong.ticks, right.ticks);
    }
}

#[test]
fn a_map_without_a_route_does_not_prevent_exploration() {
    let closed: Vec<String> =
        (0..8).map(|row| if row == 7 { ".@@@@@@@@@@@@@@@@@@." } else { "@@@@@@@@@@@@@@@@@@@@" }.to_owned()).collect();
    let closed: Vec<&str> = closed.iter().map(String::as_str).collect();
    for how in ["", "model_bytes = 400\n"] {
        let (outcome, stuck) = run(&with_maps(&WALL, &closed, &format!("[scouting]\nmap = \"old.map\"\n{how}")));
        assert_eq!((outcome.arrived, stuck.len()), (1, 0), "{how}");
    }
    let wrong = "[scouting]\nmap = \"old.map\"\nmodel_bytes = 400\n";
    assert_eq!(run(&with_maps(&WALL, &NO_DOOR_IN_THE_NORTH, wrong)).0.arrived, 1);
}

#[test]
fn in_the_plane_a_map_leads_to_an_unseen_door_too() {
    let ticks = |rest: &str| {
        let rest = format!("{rest}[plane]\nradius_m = 0.2\nmax_speed_mps = 1\nlaw = \"route\"\n");
        let scenario = with_maps(&WALL, &WALL, &rest);
        let outcome = simulate(&scenario, |_, _| ControlFlow::Continue(())).expect("it can be placed");
        assert_eq!((outcome.arrived, outcome.collisions), (1, 0), "{rest}");
        outcome.ticks
    };
    let (alone, with_map) = (ticks(""), ticks("[scouting]\nmap = \"old.map\"\n"));
    assert!(with_map < alone, "{with_map} with a map, {alone} without");
    let with_table = ticks("[scouting]\nmap = \"old.map\"\nmodel_bytes = 400\n");
    assert!(with_table < alone, "{with_table} with a table, {alone} without");
}

#[test]
fn a_restarted_robot_keeps_its_map_but_not_its_observations() {
    let scenario = scenario(TWO, "[scouting]\nunknown = 1\nassumed = 7\n");
    let mut engine = Engine::new(&scenario, agents(&scenario)).expect("they can be placed");
    for _ in 0..10 {
        engine.step();
    }
    let known = |engine: &Engine| {
        let AnyGround::Cells(grid) = &engine.ground else { panic!("a grid") };
        grid.scouts.as_ref().map_or(0, |scouts| scouts.memory(0).iter().count())
    };
    assert!(known(&engine) > 121, "more than it sees at a time");
    engine.restart(0, 1);
    assert_eq!(known(&engine), 0);
}
