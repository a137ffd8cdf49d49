//! Radio failures and restarts: the swarm recovers its formation.

use staya_controller::robot::{Mode, RobotId};
use staya_sim::engine::Outcome;
use staya_sim::record::{RobotRow, TickRow};
use staya_sim::scenario::{Fault, Scenario};
use staya_tests::{run, scenario};

type Rows = [(TickRow, Vec<RobotRow>)];

fn best_error(rows: &Rows, ticks: std::ops::Range<u32>) -> f64 {
    let within = rows.iter().filter(|(row, _)| ticks.contains(&row.tick));
    within.map(|(row, _)| row.formation_error_per_agent).fold(f64::INFINITY, f64::min)
}

fn assert_all_arrive(scenario: &Scenario, outcome: &Outcome) {
    let name = &scenario.name;
    assert_eq!(outcome.arrived, scenario.robots.len(), "{name}");
    assert_eq!(outcome.collisions, 0, "{name}");
    assert!(outcome.ticks < scenario.ticks, "{name} did not finish early");
}

#[test]
fn a_swarm_recovers_from_a_blackout() {
    let scenario = scenario("blackout", None);
    let [from_s, to_s] = scenario.radio.blackout_s[0];
    let (outcome, rows) = run(&scenario);
    assert_all_arrive(&scenario, &outcome);
    // Row t contains the packets sent in tick t - 1.
    let (from, to) = (from_s as u32 + 1, to_s as u32 + 1);
    for (row, _) in &rows[from as usize..to as usize] {
        assert_eq!(row.packets.delivered, 0, "tick {}", row.tick);
        assert!(row.packets.lost > 0, "tick {}", row.tick);
    }
    let before = best_error(&rows, 20..from);
    let after = best_error(&rows, to..to + 30);
    assert!(before < 1.5, "the formation was never complete: {before}");
    assert!(after < 1.5, "the formation was never restored: {after}");
}

#[test]
fn without_radio_robots_do_not_collide_and_arrive_later() {
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
fn ten_seconds_without_radio_change_little() {
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
fn any_robot_may_restart_during_the_run() {
    for robot in 1..=6 {
        for down in [0, 15, 40] {
            let mut scenario = scenario("figure-6", None);
            scenario.events.faults = vec![Fault { robot: RobotId(robot), from_tick: 120, to_tick: 120 + down }];
            let (outcome, rows) = run(&scenario);
            let who = format!("robot {robot}, {down} ticks");
            assert_eq!((outcome.arrived, outcome.collisions), (6, 0), "{who}");
            let modes = rows.iter().map(|(_, robots)| robots[robot as usize - 1].mode);
            let faulty = modes.filter(|&mode| mode == Mode::Fault).count();
            assert_eq!(faulty, down as usize, "{who}");
            let after = best_error(&rows, 120 + down..120 + down + 100);
            assert!(after < 1.5, "{who}: the formation was never restored: {after}");
        }
    }
}

#[test]
fn a_robot_that_stays_down_delays_its_followers_only() {
    // Robot 6 has no followers.
    let mut scenario = scenario("figure-6", Some(900));
    scenario.events.faults = vec![Fault { robot: RobotId(6), from_tick: 100, to_tick: u32::MAX }];
    let (outcome, _) = run(&scenario);
    assert_eq!(outcome.arrived, 5);
    assert_eq!(outcome.arrival_times[5], None);
}

#[test]
fn robots_without_any_radio_arrive_alone() {
    let mut scenario = scenario("figure-6", None);
    scenario.radio.loss = 1.0;
    let (outcome, _) = run(&scenario);
    assert_eq!(outcome.packets.delivered, 0);
    assert_all_arrive(&scenario, &outcome);
}

#[test]
fn bit_errors_cost_packets_only() {
    let mut scenario = scenario("figure-6", None);
    scenario.radio.bit_error_rate = 0.003;
    let (outcome, _) = run(&scenario);
    assert_all_arrive(&scenario, &outcome);
    let packets = outcome.packets;
    assert!(packets.damaged > packets.delivered / 2, "{packets:?}");
    // A packet in which a byte became zero splits into two frames, both of them rejected.
    assert!(packets.rejected + 2 >= packets.damaged, "{packets:?}");
    assert!(packets.rejected < packets.damaged * 5 / 4, "{packets:?}");
}
