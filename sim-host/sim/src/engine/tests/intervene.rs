use super::*;
use crate::scenario::{Intervention, with_interventions};
use crate::world::plane::Shape;

const ON_GRID: &str = "name = \"t\"\nticks = 200\ntick_s = 0.5\n[radio]\nrange_m = 12\nloss = 0.2\n[terrain]\ncell_m = 2\n\
     uniform = { width = 20, height = 20, classes = 3 }\n[robots]\n\
     list = [{ start = [3, 3], goal = [16, 3] }, { start = [5, 3], goal = [16, 5] }]\n";

const IN_FORMATION: &str = "name = \"t\"\nticks = 300\ntick_s = 0.5\n[terrain]\ncell_m = 2\n\
     uniform = { width = 30, height = 20, classes = 1 }\n[robots]\n\
     formation = { rows = 2, columns = 2, start = [4, 8], goal = [25, 8] }\n";

const IN_PLANE: &str = "name = \"t\"\nticks = 1500\ntick_s = 0.05\n[radio]\nrange_m = 9\nloss = 0.1\n\
     [plane]\nradius_m = 0.2\nmax_speed_mps = 1\n[[plane.robots.list]]\nstart_m = [0, 0]\ngoal_m = [6, 0]\n\
     [[plane.robots.list]]\nstart_m = [6, 0.1]\ngoal_m = [0, 0]\n[[plane.robots.list]]\nstart_m = [2, 3]\n\
     goal_m = [2, -3]\n[[plane.ball]]\ncenter_m = [4, 2]\nradius_m = 0.3\n";

fn parse(text: &str) -> Scenario {
    Scenario::parse(text, Path::new("t.toml"), &Overrides::default()).expect("a good scenario")
}

fn goal(robot: Option<u32>, x: f64, y: f64) -> Intervention {
    Intervention::Goal { robot, place_m: [x, y, 0.0] }
}

fn by_hand_and_again(text: &str, done: &[(u32, Intervention)]) -> [Outcome; 2] {
    let scenario = parse(text);
    let mut swarm = operated(&scenario).expect("they can be placed");
    let mut left = done.iter().peekable();
    loop {
        let is_over = left.peek().is_none() && swarm.is_over();
        if is_over || swarm.outcome().ticks >= scenario.ticks {
            break;
        }
        while let Some((_, what)) = left.next_if(|(tick, _)| *tick == swarm.outcome().ticks) {
            swarm.intervene(what).expect("it makes sense");
        }
        swarm.step();
    }
    let saved = parse(&with_interventions(text, scenario.tick_us, done));
    assert_eq!(saved.events.interventions, done);
    let again = simulate(&saved, |_, _| ControlFlow::Continue(()));
    [swarm.outcome(), again.expect("they can be placed")]
}

#[test]
fn interventions_by_hand_equal_those_of_a_scenario() {
    let on_grid = [
        (3, goal(Some(1), 31.0, 35.0)),
        (5, Intervention::Cell { cell: [10, 10], class: 0 }),
        (5, Intervention::Parameter { robot: None, name: "a3".into(), value: 2.5 }),
        (9, Intervention::Radio { loss: Some(0.9), range_m: Some(40.0) }),
        (11, Intervention::Down { robot: 2, for_s: Some(4.0) }),
        (12, goal(Some(2), 1.0, 1.0)),
    ];
    let in_plane = [
        (7, Intervention::Solid { solid: Shape::Segment { from_m: [3.0, -1.0], to_m: [3.0, 1.0] } }),
        (20, Intervention::Move { index: 0, by_m: [-1.0, -1.0] }),
        (20, Intervention::Parameter { robot: Some(2), name: "speed_mps".into(), value: 0.5 }),
        (33, Intervention::Down { robot: 3, for_s: Some(1.0) }),
        (40, goal(None, 5.0, 3.0)),
        (90, Intervention::Radio { loss: Some(0.5), range_m: None }),
        (100, Intervention::Remove { index: 1 }),
        (101, goal(Some(3), -1.0, -1.0)),
    ];
    let in_formation = [(10, goal(None, 11.0, 31.0)), (30, goal(None, 41.0, 9.0))];
    for (text, done) in [(ON_GRID, &on_grid[..]), (IN_PLANE, &in_plane[..]), (IN_FORMATION, &in_formation[..])] {
        let [by_hand, again] = by_hand_and_again(text, done);
        assert_eq!((by_hand.ticks, by_hand.trace_hash), (again.ticks, again.trace_hash));
        assert_eq!(by_hand.arrived, parse(text).robots.len(), "all have arrived");
        assert_eq!(by_hand.collisions, 0);
        let [undisturbed, _] = by_hand_and_again(text, &[]);
        assert_ne!(undisturbed.trace_hash, by_hand.trace_hash);
    }
}

#[test]
fn a_formation_with_a_new_goal_keeps_its_shape() {
    let scenario = parse(IN_FORMATION);
    let mut swarm = operated(&scenario).expect("they can be placed");
    swarm.intervene(&goal(None, 11.0, 31.0)).expect("it makes sense");
    while !swarm.is_over() && swarm.outcome().ticks < scenario.ticks {
        swarm.step();
    }
    let cells = [0, 1, 2, 3].map(|index| swarm.observation(index).motion.cell);
    assert_eq!(cells, [(5, 15), (8, 15), (5, 12), (8, 12)].map(|(x, y)| Cell::new(x, y)));
}

#[test]
fn a_restarted_robot_keeps_its_changed_goal_and_parameters() {
    let mut swarm = operated(&parse(IN_PLANE)).expect("they can be placed");
    swarm.intervene(&Intervention::Parameter { robot: Some(3), name: "speed_mps".into(), value: 0.25 }).expect("known");
    swarm.intervene(&Intervention::Down { robot: 3, for_s: Some(0.5) }).expect("known");
    swarm.intervene(&goal(Some(3), 4.0, -2.0)).expect("known");
    for _ in 0..20 {
        swarm.step();
    }
    assert_eq!(swarm.observation(2).starts, 1);
    assert_eq!(swarm.parameter(2, "speed_mps"), Some(0.25));
    assert_eq!(swarm.goal_m(2), Some([4.0, -2.0, 0.0]));
    for _ in 0..800 {
        swarm.step();
    }
    let [x, y, _] = swarm.observation(2).motion.position_m;
    assert!(libm::hypot(x - 4.0, y + 2.0) < 0.1, "{x} {y}");
}

#[test]
fn interventions_without_effect_are_refused() {
    let wrong = [
        (ON_GRID, goal(Some(1), -1.0, 5.0)),
        (ON_GRID, goal(Some(7), 5.0, 5.0)),
        (ON_GRID, Intervention::Remove { index: 0 }),
        (ON_GRID, Intervention::Cell { cell: [3, 3], class: 0 }),
        (ON_GRID, Intervention::Cell { cell: [20, 3], class: 0 }),
        (ON_GRID, Intervention::Parameter { robot: None, name: "horizon_s".into(), value: 1.0 }),
        (ON_GRID, Intervention::Waypoint { goal: 0, place_m: [1.0; 3] }),
        (IN_PLANE, Intervention::Cell { cell: [3, 3], class: 0 }),
        (IN_PLANE, Intervention::Move { index: 1, by_m: [1.0, 0.0] }),
        (IN_PLANE, Intervention::Waypoint { goal: 1, place_m: [1.0; 3] }),
        (IN_FORMATION, Intervention::Parameter { robot: None, name: "resume_cells".into(), value: 5.0 }),
    ];
    for (text, what) in wrong {
        let scenario = parse(text);
        let mut swarm = operated(&scenario).expect("they can be placed");
        let refusal = swarm.intervene(&what).expect_err("it does not apply").to_string();
        assert!(refusal.contains("; "), "{refusal}");
        for _ in 0..8 {
            swarm.step();
        }
        let hash = simulate(&Scenario { ticks: 8, ..scenario }, |_, _| ControlFlow::Continue(()));
        assert_eq!(swarm.outcome().trace_hash, hash.expect("they can be placed").trace_hash, "{what:?}");
    }
}

#[test]
fn inspection_does_not_change_the_run() {
    for text in [ON_GRID, IN_PLANE, IN_FORMATION] {
        let scenario = Scenario { ticks: 20, ..parse(text) };
        let mut swarm = operated(&scenario).expect("they can be placed");
        swarm.log_receptions(true);
        let (mut known, mut receptions) = (0, 0);
        for _ in 0..20 {
            for index in 0..scenario.robots.len() {
                let seen = swarm.inspect(index);
                known += seen.known.len();
                receptions += swarm.receptions(index).len();
                assert!(!seen.parameters.is_empty());
                assert_eq!(seen.land.is_some(), scenario.plane().is_none());
                assert_eq!(seen.choice.is_some(), scenario.plane().is_some());
            }
            swarm.step();
        }
        assert!(known > 20 && receptions > 20, "{known} {receptions}");
        let hash = simulate(&scenario, |_, _| ControlFlow::Continue(())).expect("they can be placed").trace_hash;
        assert_eq!(swarm.outcome().trace_hash, hash);
    }
}

#[test]
fn the_velocity_chosen_by_orca_is_permitted() {
    let mut swarm = operated(&parse(IN_PLANE)).expect("they can be placed");
    let mut constrained = 0;
    for _ in 0..120 {
        for index in 0..3 {
            let choice = swarm.inspect(index).choice.expect("it goes by velocities");
            let [x, y, _] = choice.chosen_mps;
            constrained += choice.permitted.len();
            for Permitted { point_mps: [px, py, _], normal: [nx, ny, _], .. } in choice.permitted {
                assert!((x - px) * nx + (y - py) * ny >= -0.02, "tick {}", swarm.outcome().ticks);
            }
        }
        swarm.step();
    }
    assert!(constrained > 100);
}
