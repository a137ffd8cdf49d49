use super::*;
use crate::experiment::Experiment as _;
use std::sync::atomic::{AtomicUsize, Ordering};

#[test]
fn few_robots_swap_without_contact_and_are_measured() {
    let plan = swap::Plan { robots: vec![2, 5, 12], ..swap::Plan::default() };
    let report = plan.measure().expect("a sound plan");
    assert_eq!(report.rows.len(), 3);
    for row in &report.rows {
        assert_eq!((row.runs, row.clean, row.overlaps), (1, 1, 0), "{row:?}");
        assert_eq!(row.arrived, row.robots as usize);
        let ratio = row.worst_time_ratio.expect("all arrived");
        assert!((1.0..=1.5).contains(&ratio), "{row:?}");
        let gap = row.least_gap_m.expect("all pass near the middle");
        assert!((0.0..0.3).contains(&gap), "{row:?}");
    }
}

#[test]
fn without_a_safety_layer_robots_overlap() {
    let plan = swap::Plan {
        robots: vec![4],
        conditions: Conditions { safety: SafetyKind::None, ..Conditions::default() },
        ..swap::Plan::default()
    };
    let report = plan.measure().expect("a sound plan");
    assert!(report.rows[0].overlaps > 0 && report.rows[0].clean == 0);
    assert!(report.rows[0].least_gap_m.is_some_and(|gap| gap < -0.2));
}

#[test]
fn stopped_run_is_left_out() {
    let plan = swap::Plan { robots: vec![4], ..swap::Plan::default() };
    let looks = AtomicUsize::new(0);
    let runs = plan.carry_out(|_| looks.fetch_add(1, Ordering::Relaxed) < 20);
    let report = plan.report(&runs.expect("a sound plan"));
    assert!(report.runs.is_empty() && report.rows.is_empty());
    let plan = doorway::Plan::default();
    let runs = plan.carry_out(|_| false).expect("a sound plan");
    assert!(plan.report(&runs).runs.is_empty());
}

#[test]
fn each_case_has_its_robots_and_invalid_plans_are_refused() {
    for case in cases::Case::ALL {
        let scenario = cases::Plan::default().scenario(case, 1);
        let groups = match case {
            cases::Case::Blocks | cases::Case::FourWays => 4,
            cases::Case::Tee => 3,
            cases::Case::Door | cases::Case::Doors | cases::Case::Corridor => 2,
            _ => 1,
        };
        let parked = if case == cases::Case::ParkedDoor { 15 } else { 0 };
        assert_eq!(scenario.robots.len(), (groups * case.robots() + parked) as usize, "{case:?}");
        let plane = scenario.plane.expect("bodies");
        for (index, one) in plane.starts.iter().enumerate() {
            for (other_index, other) in plane.starts[..index].iter().enumerate() {
                let apart = plane.group(index).radius_m + plane.group(other_index).radius_m;
                let way = crate::arena::distance_m(one.position_m, other.position_m);
                assert!(way > apart, "{case:?}: robots {} and {}", other_index + 1, index + 1);
            }
        }
    }
    let refused = [
        cases::Plan { robots: Some(0), ..cases::Plan::default() },
        cases::Plan { robots: Some(31), ..cases::Plan::default() },
        cases::Plan { noise_m: 0.2, ..cases::Plan::default() },
        cases::Plan { seeds: 0, ..cases::Plan::default() },
        cases::Plan { size: 0.0, ..cases::Plan::default() },
        cases::Plan { size: 2.0, ..cases::Plan::default() },
        cases::Plan { blackout_s: f64::NAN, ..cases::Plan::default() },
    ];
    for plan in refused {
        assert!(plan.check().is_err(), "{plan:?}");
    }
}

#[test]
fn robots_without_a_radio_collide_and_the_depth_is_reported() {
    let conditions = Conditions { range_m: 0.0, ..Conditions::default() };
    let plan = cases::Plan {
        cases: vec![cases::Case::Mixed],
        robots: Some(6),
        seeds: 1,
        conditions,
        ..cases::Plan::default()
    };
    let run = &plan.measure().expect("a sound plan").runs[0];
    assert!(run.overlaps > 0 && run.deepest_m > 0.1, "{run:?}");
    let ratio = run.time_ratio.expect("nothing stops them");
    assert!((0.98..1.1).contains(&ratio), "{run:?}");
}

#[test]
fn run_ends_at_its_time_limit() {
    let plan = swap::Plan { robots: vec![2], patience: 0.5, ..swap::Plan::default() };
    let report = plan.measure().expect("a sound plan");
    assert_eq!((report.runs[0].arrived, report.runs[0].time_ratio), (0, None));
    assert_eq!(report.rows[0].worst_time_ratio, None);
}

#[test]
fn two_crowds_pass_a_door_that_is_one_robot_wide() {
    let plan = doorway::Plan { widths_m: vec![0.8], robots: 4, ..doorway::Plan::default() };
    let run = &plan.measure().expect("a sound plan").runs[0];
    assert_eq!((run.arrived, run.robots, run.overlaps), (8, 8, 0), "{run:?}");
    assert_eq!(run.through, [4, 4]);
    assert!(run.turns >= 1 && run.last_s.is_some(), "{run:?}");
    assert!(run.least_wall_gap_m.is_some_and(|gap| gap > 0.0), "{run:?}");
}

/// A robot of 0.3 m needs 1.2 s at 0.5 m/s to pass the place of the one before it.
#[test]
fn robots_pass_a_door_close_behind_each_other() {
    let conditions = Conditions { range_m: 6.0, ..Conditions::default() };
    for loss in [0.0, 0.1, 0.3] {
        let conditions = Conditions { loss, ..conditions };
        let (widths_m, seeds) = (vec![0.7], if loss > 0.0 { 4 } else { 1 });
        let plan = doorway::Plan { widths_m, robots: 5, seed: 40, seeds, conditions, ..doorway::Plan::default() };
        for run in plan.measure().expect("a sound plan").runs {
            assert_eq!((run.arrived, run.overlaps, run.through), (10, 0, [5, 5]), "{run:?}");
            assert!(run.turns <= 3 && run.last_s.is_some_and(|last| last < 50.0), "{run:?}");
        }
    }
}
