use super::*;
use crate::scenario::{Overrides, Scenario};
use proptest::prelude::*;
use std::path::Path;

const BODY: &str = "[plane]\nradius_m = 0.2\nmax_speed_mps = 1\n";
const TWO: &str = "[plane.robots]\nlist = [{ start_m = [0, 0] }, { start_m = [3, 0] }]\n";

fn parse(text: &str) -> Result<Scenario, String> {
    let text = format!("name = \"t\"\nticks = 5\ntick_s = 0.02\n{text}");
    Scenario::parse(&text, Path::new("s.toml"), &Overrides::default()).map_err(|error| error.to_string())
}

fn clocks(table: &str) -> Clocks {
    parse(&format!("[clocks]\n{table}\n{BODY}{TWO}")).unwrap_or_else(|error| panic!("{error}")).clocks
}

#[test]
fn by_default_all_robots_decide_in_each_tick() {
    let without = parse(&format!("{BODY}{TWO}")).expect("a good scenario").clocks;
    for table in ["", "step_s = 0.02", "phases = \"equal\"\ndrift_ppm = 0\nlate = 0\nlate_s = 0"] {
        assert_eq!(clocks(table), without, "{table}");
    }
    assert_eq!(without, Clocks::synchronous(20_000));
    assert!(without.is_synchronous());
}

#[test]
fn any_other_clocks_are_not_synchronous() {
    for table in ["step_s = 0.04", "step_s = 0.04\nphases = \"random\"", "drift_ppm = 1", "late = 0.1\nlate_s = 0.02"] {
        assert!(!clocks(table).is_synchronous(), "{table}");
    }
    let phase = "[clocks]\nstep_s = 0.04\n[plane]\nradius_m = 0.2\nmax_speed_mps = 1\nphase_s = 0.02\n";
    let scenario = parse(&format!("{phase}{TWO}")).expect("a good scenario");
    assert!(scenario.clocks.has_own_phases && !scenario.clocks.is_synchronous());
}

#[test]
fn a_robot_has_its_own_phase_or_that_of_its_group() {
    let text = "[clocks]\nstep_s = 0.1\n[plane]\nradius_m = 0.2\nmax_speed_mps = 1\nphase_s = 0.02\n\
                [plane.robots]\nlist = [{ start_m = [0, 0] }, { start_m = [3, 0], phase_s = 0.08 }]\n\
                [[plane.group]]\nphase_s = 0\nrobots.circle = { count = 1, radius_m = 9 }\n\
                [[plane.group]]\nrobots.circle = { count = 1, radius_m = 12 }\n";
    let scenario = parse(text).expect("a good scenario");
    let phases: Vec<_> = scenario.plane().expect("a plane").starts.iter().map(|start| start.phase_ticks).collect();
    assert_eq!(phases, [Some(1), Some(4), Some(0), Some(1)]);
}

#[test]
fn errors_name_place_cause_and_remedy() {
    let grid = "[terrain]\nuniform = { width = 9, height = 9, classes = 1 }\n[robots]\nlist = [{ start = [0, 0], goal = [8, 8] }]\n";
    let body = format!("{BODY}{TWO}");
    let phase = |phase_s: &str| format!("{BODY}[plane.robots]\nlist = [{{ start_m = [0, 0], phase_s = {phase_s} }}]\n");
    let cases = [
        (
            "",
            grid,
            "4:1: clocks: robots that move from cell to cell decide in each tick; give [plane], or leave this table out",
        ),
        (
            "step_s = 0.05",
            &body,
            "5:10: clocks.step_s: 0.05 s is not a whole number of ticks; give a multiple of tick_s = 0.02",
        ),
        (
            "step_s = 0.01",
            &body,
            "5:10: clocks.step_s: 0.01 s is not a whole number of ticks; give a multiple of tick_s = 0.02",
        ),
        ("step_s = 61", &body, "5:10: clocks.step_s: 61 is out of range; give 0.001 to 60 seconds"),
        (
            "phases = \"random\"",
            &body,
            "5:10: clocks.phases: in a step of one tick there is one phase only; give step_s of two ticks or more, or leave it out",
        ),
        ("late = 0.5", &body, "5:8: clocks.late: late and late_s go together; give both above 0, or none of them"),
        ("late_s = 0.5", &body, "5:10: clocks.late_s: late and late_s go together; give both above 0, or none of them"),
        ("late = 1\nlate_s = 0.01", &body, "6:10: clocks.late_s: 0.01 s is less than a tick; give 0.02 s or more"),
        ("drift_ppm = -1", &body, "5:13: clocks.drift_ppm: -1 is out of range; give 0 to 100000 parts per million"),
        (
            "step_s = 0.04",
            &phase("0.03"),
            "10:39: plane.robots.list[0].phase_s: 0.03 s is not a whole number of ticks below a step; give a multiple of \
             tick_s = 0.02 below clocks.step_s = 0.04, or leave it out",
        ),
        (
            "",
            &phase("0.02"),
            "9:39: plane.robots.list[0].phase_s: 0.02 s is not a whole number of ticks below a step; give a multiple of \
             tick_s = 0.02 below clocks.step_s = 0.02, or leave it out",
        ),
    ];
    for (table, rest, error) in cases {
        let table = if table.is_empty() { String::new() } else { format!("{table}\n") };
        let got = parse(&format!("[clocks]\n{table}{rest}")).expect_err(error);
        assert!(got.starts_with(&format!("s.toml:{error}")), "{got}\n{error}");
    }
}

#[test]
fn a_beacon_counts_whole_steps_unless_all_robots_decide_at_once() {
    let synchronous = Clocks::synchronous(20_000);
    for (delay_us, latency_us) in [(0, 20_000), (1, 20_000), (20_000, 20_000), (20_001, 40_000), (100_000, 100_000)] {
        assert_eq!(synchronous.latency_us(delay_us), latency_us, "{delay_us}");
    }
    // A step of ten ticks. A quarter is 0.05 s; arrivals are rounded up to ticks.
    let spread = Clocks { step_ticks: 10, phases: Phases::Random, ..synchronous };
    for (delay_us, steps) in [(0, 1), (40_000, 1), (40_001, 2), (240_000, 2), (240_001, 3), (440_000, 3), (440_001, 4)]
    {
        assert_eq!(spread.latency_us(delay_us), steps * 200_000, "{delay_us}");
    }
    // A packet arrives in the next tick at the earliest, which is a whole step here.
    let late = Clocks { step_ticks: 1, late_ticks: 3, late_q32: 1, ..spread };
    assert_eq!(late.latency_us(0), 40_000);
}

proptest! {
    #[test]
    fn a_clock_shows_a_reading_in_its_tick_and_not_before(
        tick_us in 1000_u32..1_000_000, reading_us in 0_u64..1 << 40, slow_ppb in 0_u32..100_000_000,
    ) {
        let clocks = Clocks::synchronous(tick_us);
        let at = clocks.ticks_at(reading_us, slow_ppb);
        // A reading may be a microsecond off.
        prop_assert!(clocks.reading_us(at, slow_ppb) + 1 >= reading_us);
        prop_assert!(at == 0 || clocks.reading_us(at - 1, slow_ppb) <= reading_us);
    }

    #[test]
    fn readings_a_step_apart_are_a_step_of_ticks_apart(
        tick_us in 1000_u32..1_000_000, step_ticks in 1_u64..100, reading_us in 0_u64..1 << 40, slow_ppb in 0_u32..100_000_000,
    ) {
        let clocks = Clocks::synchronous(tick_us);
        let next_us = reading_us + step_ticks * u64::from(tick_us);
        let apart = clocks.ticks_at(next_us, slow_ppb) - clocks.ticks_at(reading_us, slow_ppb);
        prop_assert!(u64::from(apart) >= step_ticks);
    }
}
