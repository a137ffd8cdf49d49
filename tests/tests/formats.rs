//! The wire format is how robots say something, not what: the same scenario is the same run over either. Bit errors and bandwidth act on
//! bytes, and so are left out here.

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
        assert!(outcome.packets.delivered > 1000, "{name}: hardly a word");
        (outcome.trace_hash, outcome.packets, format!("{rows:?}"))
    };
    let (postcard, mavlink) = (over(Format::Postcard), over(Format::Mavlink));
    assert_eq!(mavlink.0, postcard.0, "{name}: hashes");
    assert_eq!(mavlink.1, postcard.1, "{name}: packets");
    assert!(mavlink.2 == postcard.2, "{name}: traces differ");
}

#[test]
fn six_robots_over_a_bad_radio_go_the_same_way_in_either_format() {
    same_over_either("six-robots", None, |_| ());
}

#[test]
fn robots_that_reboot_go_the_same_way_in_either_format() {
    same_over_either("blackout", None, |_| ());
}

#[test]
fn a_crossing_behind_orca_is_the_same_in_either_format() {
    same_over_either("swap-circle", None, |scenario| scenario.radio.loss = 0.1);
}

#[test]
fn flocks_are_the_same_in_either_format() {
    same_over_either("flock-squeeze", Some(120), |_| ());
    // Its operator moves a goal on the way.
    same_over_either("goal-flock", Some(200), |_| ());
}

#[test]
fn bytes_of_the_air_are_those_of_the_format() {
    let corrupted = |format: Format| {
        let mut scenario = scenario("six-robots", Some(200));
        scenario.radio.format = format;
        scenario.radio.bit_error_rate = 1e-3;
        let packets = run(&scenario).0.packets;
        // Not one for one: a broken frame may look like two, or like somebody else's message.
        assert!(packets.rejected > packets.corrupted / 2 && packets.corrupted > 0);
        packets.corrupted
    };
    assert_ne!(corrupted(Format::Postcard), corrupted(Format::Mavlink));
}
