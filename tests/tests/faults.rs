//! Radios that fail and robots that reboot: the swarm comes through, and finds its formation again.

use staya_controller::robot::{Mode, RobotId};
use staya_sim::engine::Outcome;
use staya_sim::record::{RobotRow, TickRow};
use staya_sim::scenario::{Fault, Scenario};
use staya_tests::{run, scenario};

type Rows = [(TickRow, Vec<RobotRow>)];

/// The formation error at its best within some ticks, cells per robot.
fn best_error(rows: &Rows, ticks: std::ops::Range<u32>) -> f64 {
    let within = rows.iter().filter(|(row, _)| ticks.contains(&row.tick));
    within.map(|(row, _)| row.formation_error_per_agent).fold(f64::INFINITY, f64::min)
}

fn assert_all_arrive(scenario: &Scenario, outcome: &Outcome) {
    let name = &scenario.name;
    assert_eq!(outcome.arrived, scenario.robots.len(), "{name}");
    assert_eq!(outcome.collisions, 0, "{name}");
    assert!(outcome.ticks < scenario.ticks, "{name} took all its ticks");
}

#[test]
fn a_swarm_recovers_from_a_blackout() {
    let scenario = scenario("blackout", None);
    let [from_s, to_s] = scenario.radio.blackout_s[0];
    let (outcome, rows) = run(&scenario);
    assert_all_arrive(&scenario, &outcome);
    // The row of tick t holds the packets sent in the tick before.
    let (from, to) = (from_s as u32 + 1, to_s as u32 + 1);
    for (row, _) in &rows[from as usize..to as usize] {
        assert_eq!(row.packets.delivered, 0, "tick {}", row.tick);
        assert!(row.packets.lost > 0, "tick {}", row.tick);
    }
    let before = best_error(&rows, 20..from);
    let after = best_error(&rows, to..to + 30);
    assert!(before < 1.5, "the formation never stood: {before}");
    assert!(after < 1.5, "the formation was never restored: {after}");
}

/// In the plane, behind ORCA: in the thick of a swap, head on, for seconds and for minutes.
#[test]
fn a_radio_that_dies_lets_nobody_touch_and_all_arrive_when_it_is_back() {
    for name in ["radio-dies", "head-on"] {
        let scenario = scenario(name, None);
        let (outcome, _) = run(&scenario);
        assert_all_arrive(&scenario, &outcome);
        let [_, to_s] = *scenario.radio.blackout_s.last().expect("a blackout");
        let at_s = f64::from(outcome.ticks) * f64::from(scenario.tick_us) / 1e6;
        assert!(at_s > to_s, "{name}: all arrived by {at_s} s, before the radio was back");
    }
}

#[test]
fn ten_dead_seconds_of_radio_change_little() {
    let mut scenario = scenario("figure-6", None);
    let (undisturbed, _) = run(&scenario);
    scenario.radio.blackout_s = vec![[100.0, 110.0]];
    let (outcome, _) = run(&scenario);
    assert_all_arrive(&scenario, &outcome);
    assert_ne!(outcome.trace_hash, undisturbed.trace_hash);
    assert!(
        outcome.ticks < undisturbed.ticks + undisturbed.ticks / 4,
        "{} ticks instead of {}",
        outcome.ticks,
        undisturbed.ticks
    );
}

#[test]
fn any_robot_may_reboot_in_the_middle() {
    for robot in 1..=6 {
        for down in [0, 15, 40] {
            let mut scenario = scenario("figure-6", None);
            scenario.faults = vec![Fault { robot: RobotId(robot), from_tick: 120, to_tick: 120 + down }];
            let (outcome, rows) = run(&scenario);
            let who = format!("robot {robot}, {down} ticks");
            assert_eq!((outcome.arrived, outcome.collisions), (6, 0), "{who}");
            let modes = rows.iter().map(|(_, robots)| robots[robot as usize - 1].mode);
            let faulty = modes.filter(|&mode| mode == Mode::Fault).count();
            assert_eq!(faulty, down as usize, "{who}");
            let after = best_error(&rows, 120 + down..120 + down + 100);
            assert!(after < 1.5, "{who}: it never came back: {after}");
        }
    }
}

#[test]
fn a_robot_that_stays_down_does_not_hold_up_those_who_do_not_follow_it() {
    // Robot 6 leads nobody. It is down for good.
    let mut scenario = scenario("figure-6", Some(900));
    scenario.faults = vec![Fault { robot: RobotId(6), from_tick: 100, to_tick: u32::MAX }];
    let (outcome, _) = run(&scenario);
    assert_eq!(outcome.arrived, 5);
    assert_eq!(outcome.arrival_times[5], None);
}

#[test]
fn a_radio_that_loses_everything_leaves_robots_that_arrive_alone() {
    let mut scenario = scenario("figure-6", None);
    scenario.radio.loss = 1.0;
    let (outcome, _) = run(&scenario);
    assert_eq!(outcome.packets.delivered, 0);
    assert_all_arrive(&scenario, &outcome);
}

#[test]
fn bits_that_flip_cost_packets_and_nothing_else() {
    let mut scenario = scenario("figure-6", None);
    scenario.radio.bit_error_rate = 0.003;
    let (outcome, _) = run(&scenario);
    assert_all_arrive(&scenario, &outcome);
    let packets = outcome.packets;
    assert!(packets.corrupted > packets.delivered / 2, "{packets:?}");
    // Every damaged packet is refused (CRC-16 lets one in 65536 through); one in which a byte became
    // zero falls into two frames, both of them refused.
    assert!(packets.rejected + 2 >= packets.corrupted, "{packets:?}");
    assert!(packets.rejected < packets.corrupted * 5 / 4, "{packets:?}");
}
