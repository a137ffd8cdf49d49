//! Robots that restart more often than the boot number of a frame can count.

use super::*;
use staya_controller::agent::Protocol as _;
use staya_controller::wire::Header;

/// More restarts than the 8 bits of a boot number, by more than receivers remember.
const RESTARTS: u32 = 259;

/// Two robots; robot 2 restarts at every second step.
fn restarting(rest: &str) -> Scenario {
    let faults: String = (0..RESTARTS).map(|number| format!("[[fault]]\nrobot = 2\nat_s = {}\n", 2 + number)).collect();
    Scenario { ticks: u32::MAX, ..scenario(TWO, &format!("{rest}{faults}")) }
}

fn run(engine: &mut Engine, ticks: u32) {
    for _ in 0..ticks {
        engine.step();
    }
}

const KEY: &str = "[authentication]\nkey = \"passphrase: ours\"\n";
const MASTER: &str = "[authentication]\nmaster = \"passphrase: ours\"\n";
const MAVLINK: &str = "[radio]\nformat = \"mavlink\"\n";

#[test]
fn a_robot_that_restarts_very_often_is_still_heard() {
    for rest in ["", MAVLINK, KEY, MASTER, &format!("{MAVLINK}{KEY}")] {
        let scenario = restarting(rest);
        let mut engine = operated(&scenario).expect("they can be placed");
        run(&mut engine, 2 * (RESTARTS + 2));
        assert_eq!(engine.observation(1).starts, RESTARTS, "{rest}");
        let before = engine.packets;
        run(&mut engine, 20);
        let rejected = engine.packets.rejected - before.rejected;
        assert_eq!((engine.observation(0).neighbors, rejected), (1, 0), "{rest}");
    }
}

#[test]
fn an_operator_reaches_robots_that_restarted_very_often() {
    for rest in [KEY, MASTER, &format!("{MAVLINK}{KEY}")] {
        let mut engine = operated(&restarting(rest)).expect("they can be placed");
        run(&mut engine, 2 * (RESTARTS + 2));
        for index in 0..2 {
            let id = RobotId(index as u32 + 1);
            let goal = OnCells::order(id, 1, &GridOrder::FormationGoal(Cell::new(3, 9)));
            let header = Header { boot: 0, sender: RobotId(255), sequence: 0 };
            engine.tell(index, header, &goal.expect("a goal fits a frame"));
            engine.step();
            assert_eq!(engine.observation(index).status.target, Cell::new(3, 9), "robot {id:?}, {rest}");
        }
    }
}

#[test]
fn scripted_orders_reach_robots_that_restarted_very_often() {
    let faults: String = (0..RESTARTS)
        .map(|number| format!("[[fault]]\nrobot = 2\nat_s = {}\n", 1.0 + 0.05 * f64::from(number)))
        .collect();
    for format in ["postcard", "mavlink"] {
        let text = format!(
            "name = \"t\"\nticks = 400\ntick_s = 0.05\n[radio]\nformat = \"{format}\"\nrange_m = 20\n{KEY}\
             [plane]\nradius_m = 0.2\nmax_speed_mps = 1\n[[plane.robots.list]]\nstart_m = [0, 0]\ngoal_m = [90, 0]\n\
             [[plane.robots.list]]\nstart_m = [0, 3]\ngoal_m = [90, 3]\n\
             [[plane.order]]\nat_s = 16\nplace_m = [5, 1]\n{faults}"
        );
        let scenario = Scenario::parse(&text, Path::new("t.toml"), &Overrides::default()).expect("a good scenario");
        let mut engine = operated(&scenario).expect("they can be placed");
        run(&mut engine, 320);
        let before = engine.packets.rejected;
        run(&mut engine, 60);
        assert_eq!(engine.packets.rejected - before, 0, "{format}");
    }
}

#[test]
fn starts_beyond_the_last_one_of_a_key_end_no_run() {
    for rest in [KEY, MASTER, &format!("{MAVLINK}{KEY}")] {
        let mut engine = operated(&restarting(rest)).expect("they can be placed");
        engine.computers[1].starts = u32::MAX - 1;
        run(&mut engine, 12);
        assert_eq!(engine.observation(1).starts, u32::MAX, "{rest}");
    }
}
