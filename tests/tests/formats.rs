//! A scenario runs identically with both wire formats, except for bit errors and bandwidth.

use staya_controller::wire::Format;
use staya_sim::scenario::Scenario;
use staya_tests::{run, scenario};

fn same_over_either(name: &str, ticks: Option<u32>, prepare: impl Fn(&mut Scenario)) {
    let over = |format: Format| {
        let mut scenario = scenario(name, ticks);
        scenario.radio.format = format;
        scenario.radio.bit_error_rate = 0.0;
        scenario.radio.bandwidth_bytes_per_s = None;
        prepare(&mut scenario);
        let (outcome, rows) = run(&scenario);
        assert!(outcome.packets.delivered > 1000, "{name}: too few packets");
        (outcome.trace_hash, outcome.packets, format!("{rows:?}"))
    };
    let (postcard, mavlink) = (over(Format::Postcard), over(Format::Mavlink));
    assert_eq!(mavlink.0, postcard.0, "{name}: hashes");
    assert_eq!(mavlink.1, postcard.1, "{name}: packets");
    assert!(mavlink.2 == postcard.2, "{name}: traces differ");
}

#[test]
fn six_robots_with_a_bad_radio_run_identically_in_both_formats() {
    same_over_either("six-robots", None, |_| ());
}

#[test]
fn restarting_robots_run_identically_in_both_formats() {
    same_over_either("blackout", None, |_| ());
}

#[test]
fn a_crossing_with_orca_runs_identically_in_both_formats() {
    same_over_either("swap-circle", None, |scenario| scenario.radio.loss = 0.1);
}

#[test]
fn flocks_run_identically_in_both_formats() {
    same_over_either("flock-squeeze", Some(120), |_| ());
    // The scenario's operator moves a goal during the run.
    let moves_goal = |scenario: &mut Scenario| {
        let orders = &scenario.plane().expect("a plane").orders;
        assert!(orders.first().is_some_and(|order| order.tick + 50 < scenario.ticks), "{orders:?}");
    };
    same_over_either("goal-flock", Some(900), moves_goal);
}

#[test]
fn transmitted_bytes_are_those_of_the_format() {
    let damaged = |format: Format| {
        let mut scenario = scenario("six-robots", Some(200));
        scenario.radio.format = format;
        scenario.radio.bit_error_rate = 1e-3;
        let packets = run(&scenario).0.packets;
        // A damaged frame may look like two, or like a message of another robot.
        assert!(packets.rejected > packets.damaged / 2 && packets.damaged > 0);
        packets.damaged
    };
    assert_ne!(damaged(Format::Postcard), damaged(Format::Mavlink));
}
