use super::*;
use crate::scenario::{Order, Target};
use staya_controller::agent::{Protocol as _, WaypointOrder, Waypoints};
use staya_controller::wire::{Content as _, Format, Message, decode, frames};

fn in_plane(plane: &str, rest: &str) -> Scenario {
    let text = format!(
        "name = \"t\"\nticks = 300\ntick_s = 0.1\n{rest}\n[plane]\nradius_m = 0.2\nmax_speed_mps = 1\n{plane}\n"
    );
    let scenario = Scenario::parse(&text, Path::new("t.toml"), &Overrides::default());
    scenario.unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn tracks(scenario: &Scenario) -> (Outcome, Vec<Vec<RobotRow>>) {
    let mut rows = Vec::new();
    let outcome = simulate(scenario, |_, robots| {
        rows.push(robots.collect());
        ControlFlow::Continue(())
    });
    (outcome.expect("robots in the plane are placed"), rows)
}

#[test]
fn neither_a_run_in_the_plane_nor_its_hash_depends_on_the_number_of_threads() {
    let robots = "[plane.robots.cloud]\ncount = 200\nfrom_m = [0, 0]\nto_m = [20, 20]\ngoals_m = [[10, 10]]\n";
    let mut scenario = in_plane(robots, LOSSY);
    scenario.ticks = 30;
    let (one, rows) = trace(&scenario, 1);
    assert!(one.packets.rejected > 0 && one.packets.lost > 0);
    for threads in [2, 8] {
        let (other, other_rows) = trace(&scenario, threads);
        assert_eq!(other, one, "{threads} threads");
        let places = |rows: &[RobotRow]| rows.iter().map(|r| r.motion.position_m).collect::<Vec<_>>();
        assert_eq!(places(&other_rows), places(&rows));
    }
    scenario.seed += 1;
    assert_ne!(trace(&scenario, 1).0.trace_hash, one.trace_hash);
}

#[test]
fn a_radio_fault_without_effect_leaves_the_trace() {
    let robots = "[plane.robots.circle]\ncount = 6\nradius_m = 3\n";
    let hash = |fault: &str| {
        let scenario = in_plane(robots, &format!("{LOSSY}[[radio.fault]]\n{fault}\n"));
        simulate(&scenario, |_, _| ControlFlow::Continue(())).expect("placed").trace_hash
    };
    let scenario = in_plane(robots, LOSSY);
    let without = simulate(&scenario, |_, _| ControlFlow::Continue(())).expect("placed").trace_hash;
    assert_eq!(hash("from = [2]\nloss = 0"), without);
    assert_eq!(hash("from = [2]\nfor_s = 0"), without);
    assert_ne!(hash("from = [2]"), without);
}

/// Number of robots that pass one that goes down in the way of the first, and the final x of the
/// first. `company` adds a robot within radio range.
fn past_one_that_is_down(company: &str, silence: &str) -> (usize, f64) {
    let robots = format!(
        "[plane.robots]\nlist = [{{ start_m = [-2, 0], goal_m = [3, 0] }}, {{ start_m = [0, 0.05], goal_m = [0, 0.05] }}{company}]\n\
         [[fault]]\nrobot = 2\nat_s = 1\ndown_s = 99\n{silence}"
    );
    let (outcome, rows) = tracks(&in_plane(&robots, ""));
    let clearance = outcome.clearance.expect("bodies have sizes");
    assert!(clearance.bodies_m > 0.0, "{clearance:?}");
    assert_eq!(outcome.collisions, 0);
    let down = &rows[11..];
    for robots in down {
        assert_eq!(robots[1].mode, Mode::Fault);
        assert_eq!(robots[1].motion.position_m, down[0][1].motion.position_m);
    }
    (outcome.arrived, rows.last().expect("rows")[0].motion.position_m[0])
}

#[test]
fn robots_go_around_a_down_robot() {
    let (arrived, x) = past_one_that_is_down(", { start_m = [-1, 3], goal_m = [-1, 3] }", "");
    assert!(arrived == 2 && (x - 3.0).abs() < 0.03, "{arrived}, {x} m");
}

#[test]
fn an_isolated_robot_stops_unless_it_may_go_alone() {
    let (arrived, x) = past_one_that_is_down("", "");
    assert!(arrived == 0 && x < -0.4, "{arrived}, {x} m");
    let (arrived, x) = past_one_that_is_down("", "[plane.orca]\nalone_mps = 0.3\n");
    assert!(arrived == 1 && (x - 3.0).abs() < 0.03, "{arrived}, {x} m");
}

#[test]
fn a_restarted_robot_knows_the_current_place_of_its_moving_goal() {
    let robots = "[plane.robots.cloud]\ncount = 1\nfrom_m = [0, 0]\nto_m = [0, 0]\ngoals_m = [[1, 0]]\n\
                  goal_velocity_mps = [0.2, 0]\n[[fault]]\nrobot = 1\nat_s = 1\ndown_s = 6\n";
    let mut scenario = in_plane(robots, "");
    scenario.ticks = 200;
    // The run ends when it arrives, so it must be where the goal is then.
    let (outcome, rows) = tracks(&scenario);
    let last = rows.last().expect("rows")[0].motion.position_m;
    let wanted = 1.0 + 0.2 * f64::from(outcome.ticks) * 0.1;
    assert!(outcome.ticks > 70, "it was down until then");
    assert!((last[0] - wanted).abs() < 0.03, "{last:?} {wanted}");
}

#[test]
fn orders_arrive_and_a_restarted_robot_gets_missed_ones() {
    for fault in ["", "[[fault]]\nrobot = 1\nat_s = 1\ndown_s = 3\n"] {
        let robots = format!(
            "[plane.robots]\nlist = [{{ start_m = [0, 0], goal_m = [9, 0] }}]\n\
             [[plane.order]]\nat_s = 2\nplace_m = [1, -3]\n{fault}"
        );
        let (outcome, rows) = tracks(&in_plane(&robots, ""));
        assert_eq!(outcome.arrived, 1);
        let [x, y, _] = rows.last().expect("rows")[0].motion.position_m;
        assert!((x - 1.0).abs() < 0.03 && (y + 3.0).abs() < 0.03, "{x} {y}");
        if fault.is_empty() {
            let before = rows[20][0].motion.position_m;
            assert!((before[0] - 1.3).abs() < 1e-3, "it listens for 0.7 s: {before:?}");
        }
    }
}

#[test]
fn each_goal_has_its_own_order_version() {
    let order = |number: u32| Order {
        tick: number / 2,
        index: u8::from(number.is_multiple_of(150)),
        target: Target { position_m: [f64::from(number), 0.0, 0.0], velocity_mps: [0.0; 3] },
    };
    let orders: Vec<_> = (0..70_000).map(order).collect();
    let sent = crate::engine::plane::frames(&orders, Format::Postcard, None, 0);
    assert_eq!(sent.len(), 35_000);
    let mut last = [0_u8; 2];
    for (_, bytes) in &sent {
        assert_eq!(frames(bytes).count(), 2);
        for frame in frames(bytes) {
            let Message::Order(order) = decode(frame).expect("a sound frame").message else { panic!("an order") };
            let waypoint = WaypointOrder::decode(Waypoints::ID, order.protocol, &order.content).expect("a waypoint");
            let version = &mut last[usize::from(waypoint.index)];
            *version = version.wrapping_add(1);
            assert_eq!(order.number, *version);
        }
    }
}

#[test]
fn the_configured_latency_matches_the_radio_delay() {
    let robots = "[plane.robots]\nlist = [{ start_m = [0, 0] }]\n";
    for (delay_ms, ticks) in [(0.0, 1), (99.9, 1), (100.0, 1), (100.1, 2), (200.0, 2), (250.0, 3)] {
        let scenario = in_plane(robots, &format!("[radio]\ndelay_ms = {delay_ms}"));
        let setup = scenario.plane().expect("robots in the plane");
        let ground = PlaneGround::new(&scenario, setup);
        let (config, _) = ground.setup(0, 0);
        assert_eq!(config.latency, Duration::from_millis(100 * ticks), "{delay_ms} ms");
    }
}

#[test]
fn rough_terrain_takes_longer() {
    let ticks = |classes: u8| {
        let robots = "sight_m = 0\nsafety = \"none\"\n[plane.robots]\nlist = [{ start_m = [1, 1], goal_m = [9, 9] }]\n";
        let land = format!("[terrain]\ncell_m = 2\nuniform = {{ width = 6, height = 6, classes = {classes} }}\n");
        let (outcome, _) = tracks(&in_plane(robots, &land));
        assert_eq!(outcome.arrived, 1, "{classes} classes");
        outcome.ticks
    };
    // 11.3 m at 1 m/s.
    assert!((113..=116).contains(&ticks(1)), "{}", ticks(1));
    assert!(ticks(3) > 150, "{}", ticks(3));
}

/// Seconds (on the grid: ticks of 2 s, 1 m at 0.5 m/s) until a robot has rounded a U-shaped wall
/// that is open towards it; `None` if it fails.
fn out_of_dead_end(depth: usize, width: usize, row: usize, in_plane: bool) -> Option<f64> {
    let (west, south, north) = (16, 20 - width / 2 - 1, 20 + width / 2 + 1);
    let rows = (0..41).rev().map(|y| {
        let is_wall = |x: usize| {
            let is_side = (y == south || y == north) && (west..=west + depth).contains(&x);
            is_side || x == west + depth && (south..=north).contains(&y)
        };
        (0..41).map(|x| if is_wall(x) { '@' } else { '.' }).collect::<String>()
    });
    let map = rows.collect::<Vec<_>>().join("\n");
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("u.map"), format!("type octile\nheight 41\nwidth 41\nmap\n{map}\n"))
        .expect("a file");
    let body = "[plane]\nradius_m = 0.3\nmax_speed_mps = 0.5\nlaw = \"route\"";
    let (tick_s, ticks, body) = if in_plane { (0.1, 12_000, body) } else { (2.0, 600, "") };
    let text = format!(
        "name = \"u\"\nticks = {ticks}\ntick_s = {tick_s}\n[terrain]\nfile = \"u.map\"\n\
         [[robots.list]]\nstart = [9, 20]\ngoal = [32, {row}]\n{body}\n"
    );
    let scenario = Scenario::parse(&text, &folder.path().join("u.toml"), &Overrides::default());
    let outcome = simulate(&scenario.expect("a scenario"), |_, _| ControlFlow::Continue(())).expect("a free start");
    assert_eq!(outcome.collisions, 0);
    (outcome.arrived == 1).then_some(outcome.seconds)
}

#[test]
fn a_disc_leaves_a_dead_end_as_a_robot_on_the_grid_does() {
    for (depth, width, row) in [(2, 9, 20), (3, 3, 21), (3, 9, 21), (4, 7, 19), (5, 1, 20), (5, 9, 20), (7, 5, 20)] {
        let [grid, plane] = [false, true].map(|in_plane| out_of_dead_end(depth, width, row, in_plane));
        let is_as_good = plane.zip(grid).is_some_and(|(plane, grid)| plane <= 1.3 * grid);
        assert!(is_as_good, "{depth} {width} {row}: {plane:?} s, on the grid {grid:?} s");
    }
}

#[test]
fn groups_with_different_laws_and_safety_layers_arrive_without_collisions() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/groups.toml");
    let scenario = Scenario::load(&path, &Overrides::default()).expect("a scenario");
    let outcome = simulate(&scenario, watch_nothing).expect("room");
    assert_eq!((outcome.arrived, outcome.collisions), (scenario.robots.len(), 0));
}

#[test]
fn robots_that_start_within_radio_range_expect_each_other() {
    let company = |list: &str, rest: &str| {
        let scenario = in_plane(&format!("[plane.robots]\nlist = [{list}]\n"), rest);
        let ground =
            PlaneGround::new(&scenario, scenario.plane().expect("robots in the plane")).with_company(&scenario);
        let expects = |number| ground.setup(number, 0).0.contact_loss.expects_others;
        (0..scenario.robots.len()).map(expects).collect::<Vec<_>>()
    };
    let three = "{ start_m = [0, 0] }, { start_m = [3, 0] }, { start_m = [9, 0] }";
    assert_eq!(company(three, "[radio]\nrange_m = 4\n"), [true, true, false]);
    assert_eq!(company(three, ""), [true; 3]);
    assert_eq!(company("{ start_m = [0, 0] }", ""), [false]);
    // One that is down at the start expects others, and none expects it.
    let down = "[radio]\nrange_m = 4\n[[fault]]\nrobot = 2\nat_s = 0\ndown_s = 3\n";
    assert_eq!(company(three, down), [false, true, false]);
    assert_eq!(company(three, "[plane.sensing]\nrange_m = 9\nbeacons = false\n"), [false; 3]);
    for (given, expects) in [("true", true), ("false", false)] {
        let table = format!("[radio]\nrange_m = 4\n[plane.orca]\nexpects_others = {given}\n");
        assert_eq!(company(three, &table), [expects; 3]);
    }
}

#[test]
fn a_robot_that_has_heard_none_of_its_neighbours_stands() {
    let robots =
        "[plane.robots]\nlist = [{ start_m = [0, 0], goal_m = [9, 0] }, { start_m = [9, 0.1], goal_m = [0, 0.1] }]\n";
    for (faults, moves) in [("", true), ("[[radio.fault]]\nto = [1]\n", false)] {
        let (outcome, rows) = tracks(&in_plane(robots, faults));
        let [x, y, _] = rows.last().expect("rows")[0].motion.position_m;
        assert_eq!(libm::hypot(x, y) > 8.0, moves, "{faults}: {x} {y}");
        assert_eq!(outcome.collisions, 0, "{faults}");
    }
}
