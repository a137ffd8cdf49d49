use super::*;
use staya_controller::agent::{Protocol as _, Waypoint, Wish};
use staya_controller::geom::{Position, Vec3};
use staya_controller::wire::Header;

const DISCS: &str = "name = \"t\"\nticks = 120\ntick_s = 0.05\n[radio]\nrange_m = 5\nloss = 0.1\n\
     [plane]\nradius_m = 0.2\nmax_speed_mps = 1\n[[plane.robots.list]]\nstart_m = [0, 0]\ngoal_m = [4, 0]\n\
     [[plane.robots.list]]\nstart_m = [4, 0]\ngoal_m = [0, 0]\n[[plane.robots.list]]\nstart_m = [2, 3]\n\
     goal_m = [2, -3]\n[[fault]]\nrobot = 3\nat_s = 1\ndown_s = 0.5\n";

fn discs() -> Scenario {
    Scenario::parse(DISCS, Path::new("t.toml"), &Overrides::default()).expect("a good scenario")
}

fn run(swarm: &mut Engine, ticks: u32) {
    for _ in 0..ticks {
        swarm.step();
    }
}

fn hash_without_operator(scenario: &Scenario) -> u64 {
    let outcome = simulate(scenario, |_, _| ControlFlow::Continue(()));
    let outcome = outcome.expect("they can be placed");
    assert_eq!(outcome.ticks, scenario.ticks, "no robot arrives early");
    outcome.trace_hash
}

#[test]
fn a_run_without_commands_is_the_run_without_an_operator() {
    let on_grid = Scenario { ticks: 8, ..scenario(TWO, LOSSY) };
    let formation = "formation = { rows = 2, columns = 2, start = [4, 8], goal = [15, 8] }";
    let in_formation = Scenario { ticks: 8, ..scenario(formation, "") };
    for scenario in [on_grid, in_formation, discs()] {
        let mut swarm = operated(&scenario).expect("they can be placed");
        run(&mut swarm, scenario.ticks);
        let hash = swarm.outcome().trace_hash;
        assert_eq!(hash, hash_without_operator(&scenario));
    }
}

#[test]
fn commanded_robots_go_to_the_new_goal_without_collisions() {
    let scenario = discs();
    let mut swarm = operated(&scenario).expect("they can be placed");
    let meeting = Wish::Waypoint { waypoint: Waypoint::fixed(Position::from_mm([2000, 1000, 0])), valid: None };
    for robot in 0..2 {
        assert!(swarm.command(robot, meeting));
    }
    run(&mut swarm, 400);
    let off_m = [0, 1].map(|robot| {
        let observation = swarm.observation(robot);
        assert_eq!(observation.wish, meeting);
        let [x, y, _] = observation.motion.position_m;
        libm::hypot(x - 2.0, y - 1.0)
    });
    let [near_m, far_m] = [off_m[0].min(off_m[1]), off_m[0].max(off_m[1])];
    assert!(near_m < 0.1 && far_m < 0.7, "{off_m:?}");
    let outcome = swarm.outcome();
    assert_eq!(outcome.collisions, 0);
    assert_ne!(outcome.trace_hash, hash_without_operator(&scenario));
}

#[test]
fn a_down_robot_ignores_commands_and_restarts_with_the_scenarios_task() {
    let mut swarm = operated(&discs()).expect("they can be placed");
    let east = Wish::Velocity { velocity_mps: Vec3::new(1.0, 0.0, 0.0), valid: Duration::from_millis(60_000) };
    assert!(swarm.command(2, east));
    assert_eq!(swarm.set_parameter(2, "speed_mps", 0.5), Ok(()));
    run(&mut swarm, 22);
    let before = swarm.observation(2);
    assert!(!before.is_up && before.motion.velocity_mps == [0.0; 3]);
    assert!(swarm.set_parameter(2, "speed_mps", 0.5).is_err());
    assert_eq!(swarm.parameter(2, "speed_mps"), None);
    assert!(!swarm.command(2, east), "there is no such robot");
    run(&mut swarm, 19);
    let after = swarm.observation(2);
    assert!(after.is_up && after.starts != before.starts && after.wish == Wish::Own);
    assert_eq!(swarm.parameter(2, "speed_mps"), Some(1.0));
    assert!(after.motion.velocity_mps[1] < -0.5, "{:?}", after.motion);
}

#[test]
fn a_goal_message_reaches_the_controller_and_events_return() {
    let key = "[authentication]\nkey = \"passphrase: ours\"\n";
    let mavlink = "[radio]\nformat = \"mavlink\"\n";
    for rest in ["", mavlink, key, &format!("{mavlink}{key}")] {
        let scenario = scenario(TWO, rest);
        tell_a_goal(&mut operated(&scenario).expect("they can be placed"));
    }
}

fn tell_a_goal(swarm: &mut Engine) {
    let goal = OnCells::order(RobotId(1), 1, &GridOrder::FormationGoal(Cell::new(3, 9)));
    let header = Header { boot: 0, sender: RobotId(255), sequence: 0 };
    swarm.tell(0, header, &goal.expect("a goal fits a frame"));
    swarm.step();
    assert_eq!(swarm.observation(0).status.target, Cell::new(3, 9));
    let begins = Event::ModeChanged { from: Mode::Idle, to: Mode::Cruise };
    assert_eq!(swarm.events(0), [begins]);
    assert_eq!(swarm.observation(1).status.target, Cell::new(12, 5));
    run(swarm, 30);
    let there = swarm.observation(0);
    assert_eq!((there.motion.cell, there.status.mode), (Cell::new(3, 9), Mode::Arrived));
}

#[test]
fn random_commands_cause_no_collisions() {
    let crowd = "name = \"t\"\nticks = 120\ntick_s = 0.05\n[radio]\nrange_m = 20\n\
         [plane]\nradius_m = 0.2\nmax_speed_mps = 1\n[plane.robots.circle]\ncount = 8\nradius_m = 1.5\n";
    let parsed = Scenario::parse(crowd, Path::new("t.toml"), &Overrides::default());
    let scenario = parsed.expect("a good scenario");
    for seed in 0..6 {
        let mut swarm = operated(&scenario).expect("they can be placed");
        let mut rng = Rng::new(seed);
        let mut below = |n: u64| rng.next_u64() % n;
        for _ in 0..60 {
            for robot in 0..8 {
                let [x, y] = [below(4001), below(4001)].map(|mm| mm as i32 - 2000);
                let [vx, vy, _] = swarm.observation(robot).motion.velocity_mps;
                let speed = libm::hypot(vx, vy);
                let wish = match below(7) {
                    0 => Wish::Own,
                    1 => Wish::Hold,
                    6 if speed < 0.05 => Wish::Off,
                    2 | 3 => Wish::Velocity {
                        velocity_mps: Vec3::new(x as f32 / 1000.0, y as f32 / 1000.0, 0.0),
                        valid: Duration::from_millis(700),
                    },
                    4 => Wish::Waypoint { waypoint: Waypoint::fixed(Position::ORIGIN), valid: None },
                    _ => Wish::Waypoint { waypoint: Waypoint::fixed(Position::from_mm([x, y, 0])), valid: None },
                };
                assert!(swarm.command(robot, wish));
            }
            run(&mut swarm, 10);
        }
        let outcome = swarm.outcome();
        assert_eq!(outcome.collisions, 0, "seed {seed}: {:?}", outcome.clearance);
    }
}
