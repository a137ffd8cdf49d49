use super::closing::{Closing, Flock, Sides};
use super::*;
use crate::experiment::rows::RowRetention;

fn small(case: Case, robots: u32, seconds: f64) -> Plan {
    Plan {
        cases: vec![case],
        references: vec![Reference::Moving],
        runs: 2,
        robots: Some(robots),
        seconds: Some(seconds),
        ..Plan::default()
    }
}

fn report(plan: &Plan) -> CaseReport {
    let mut report = plan.measure().unwrap();
    report.cases.remove(0)
}

#[test]
fn free_flock_forms_and_the_iteration_is_reported() {
    let case = report(&small(Case::Free, 30, 15.0));
    assert_eq!((case.robots, case.runs, case.ticks), (30, 2, 500));
    assert_eq!((case.one_flock, case.alpha_flocking), (2, 2), "{:?}", case.each);
    assert!(case.deviation_energy < 0.005 && case.velocity_mismatch < 0.001);
    assert!(case.connected_from_latest.unwrap() < 250);
    assert!(case.alpha_from_latest.unwrap() > case.connected_from_latest.unwrap());
    assert_eq!((case.overlaps, case.past, case.least_clearance_over_d), (0, None, None));
}

#[test]
fn without_a_reference_the_group_breaks_up() {
    let case = report(&small(Case::Fragment, 40, 30.0));
    assert_eq!((case.one_flock, case.alpha_flocking), (0, 0));
    assert!(case.connectivity < 0.95, "{}", case.connectivity);
    for (run, trace) in case.each.iter().zip(&case.traces) {
        assert!(run.end.unwrap().radius_m > 1.1 * trace[0].unwrap().radius_m);
        assert!(run.end.unwrap().velocity_mismatch > 0.001);
    }
}

#[test]
fn robots_meet_in_space_even_with_orca() {
    for safety in [SafetyKind::None, SafetyKind::Orca] {
        let plan = Plan { safety, ..small(Case::Rendezvous3d, 20, 30.0) };
        let case = report(&plan);
        assert_eq!((case.one_flock, case.overlaps), (2, 0), "{:?}", case.each);
        let frames = plan.carry_out(|_| true).unwrap()[0][0].frames.clone();
        let heights = frames.last().unwrap().places_m.iter().map(|at| at[2]);
        let (low, high) = heights.fold((f64::MAX, f64::MIN), |(low, high), z| (low.min(z), high.max(z)));
        assert!(high - low > plan.spacing_m, "a body in space, not a layer");
    }
}

#[test]
fn obstacles_are_passed_without_contact() {
    for case in [Case::Split, Case::Squeeze] {
        let case = report(&small(case, 25, 100.0));
        assert_eq!((case.past, case.inside), (Some(50), 0), "{:?}", case.each);
        assert!(case.least_clearance_over_d.unwrap() > 0.4, "{:?}", case.each);
        assert_eq!(case.overlaps, 0);
    }
}

#[test]
fn results_are_proportional_to_the_spacing() {
    let large = report(&small(Case::Split, 25, 30.0));
    let plan = Plan { spacing_m: 0.7, ..small(Case::Split, 25, 30.0) };
    let little = report(&plan);
    let ratio = large.radius_m / little.radius_m;
    assert!((ratio - 10.0).abs() < 0.5, "{ratio}");
    let [a, b] = [large, little].map(|case| case.least_clearance_over_d.unwrap());
    assert!((a - b).abs() < 0.02, "{a} {b}");
}

#[test]
fn threads_and_early_ends_change_nothing() {
    let plan = Plan { cases: vec![Case::Free, Case::Squeeze], ..small(Case::Free, 10, 3.0) };
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| plan.carry_out(|_| true).unwrap())
    };
    let all = on(1);
    assert_eq!(all, on(3));
    assert_eq!(all.concat().len(), 4);
    let none = plan.carry_out(|_| false).unwrap();
    assert!(plan.report(&none).cases.is_empty());
}

#[test]
fn invalid_plans_are_refused_with_the_reason() {
    let refused = |change: fn(&mut Plan)| {
        let mut plan = Plan::default();
        change(&mut plan);
        plan.check().unwrap_err().to_string()
    };
    assert!(refused(|p| p.runs = 0).contains("1 or more"));
    assert!(refused(|p| p.cases.clear()).contains("give one or more"));
    assert!(refused(|p| p.robots = Some(1)).contains("2 to 2000"));
    assert!(refused(|p| p.spacing_m = f64::NAN).contains("0.1 to 50"));
    assert!(refused(|p| p.horizon_s = 0.0).contains("0.01 to 60"));
    assert!(refused(|p| p.step_s = 0.2).contains("0.001 to 0.1"));
    assert!(refused(|p| p.seconds = Some(0.0)).contains("1 to 1,000,000 steps"));
    assert!(refused(|p| p.c_beta = Some(-1.0)).contains("a gain of -1"));
    assert!(refused(|p| p.c2_gamma = Some(f64::NAN)).contains("a gain of NaN"));
    assert!(refused(|p| p.references.clear()).contains("give one or more"));
    assert!(refused(|p| p.rest = 0.0).contains("0.1 to 1,000,000"));
    assert!(refused(|p| p.obstacle_ratio = Some(5.0)).contains("0.01 to 4"));
    assert!(refused(|p| p.fastest = Some(0.0)).contains("above 0"));
    assert!(refused(|p| p.loss = 1.5).contains("between 0 and 1"));
    assert!(refused(|p| p.safety = SafetyKind::PushOut).contains("goal flock"));
    let closing = Closing { speeds: vec![10.0], ..Closing::default() };
    let error = closing.check().unwrap_err().to_string();
    assert!(error.contains("at most 9.14"), "{error}");
}

#[test]
fn pictures_and_series_are_written() {
    let dir = tempfile::tempdir().unwrap();
    let plan = Plan { cases: vec![Case::Rendezvous3d, Case::Squeeze], ..small(Case::Free, 10, 3.0) };
    let files = plan.measure().unwrap().draw(dir.path());
    let files = files.unwrap();
    assert_eq!(files.len(), 10);
    for file in &files {
        assert!(file.metadata().unwrap().len() > 1000, "{}", file.display());
    }
    let series = std::fs::read_to_string(dir.path().join("squeeze-measures.csv")).unwrap();
    let fields = |line: &str| line.split(',').count();
    assert!(series.lines().all(|line| fields(line) == 10));
    assert_eq!(series.lines().count(), 1 + 2 * 101);
}

#[test]
fn closing_flocks_overlap_without_orca_and_not_with_it() {
    let plan = Closing { speeds: vec![1.0, 4.0, 8.0], runs: 4, ..Closing::default() };
    let report = plan.measure().unwrap();
    assert_eq!((plan.total(), report.lines.len()), (18 * 4 * 2, 18));
    for line in &report.lines {
        assert_eq!(line.orca.overlaps, 0, "{line:?}");
        assert!(line.orca.least_pair_over_d > 1.0 / 7.0 - 1e-6, "{line:?}");
    }
    let breaks = |flock, sides, speed: f64| {
        let wanted = |line: &&closing::Line| (line.flock, line.sides) == (flock, sides) && line.speed_over_d == speed;
        report.lines.iter().find(wanted).unwrap().bare.overlaps > 0
    };
    assert!(!breaks(Flock::Alpha, Sides::Groups, 1.0));
    assert!(breaks(Flock::Alpha, Sides::Groups, 8.0));
    assert!(breaks(Flock::Boids, Sides::Pair, 1.0));
    assert!(breaks(Flock::Boids, Sides::Groups, 8.0));
}

#[test]
fn law_alone_forms_a_flock_soon_and_only_loses_energy() {
    let quick = Plan {
        ideal: true,
        c_alpha: Some(70.0),
        c2_alpha: Some(7.0),
        c_gamma: Some(2.0),
        c2_gamma: Some(3.0),
        ..small(Case::Free, 150, 12.0)
    };
    let usual =
        Plan { c_alpha: None, c2_alpha: None, c_gamma: None, c2_gamma: None, seconds: Some(30.0), ..quick.clone() };
    let [quick, usual] = [quick, usual].map(|plan| report(&plan));
    assert_eq!((quick.alpha_flocking, usual.alpha_flocking), (2, 2));
    assert!(quick.alpha_from_latest.unwrap() < 260, "{:?}", quick.alpha_from_latest);
    assert!(quick.alpha_from_median.unwrap() < 0.8 * usual.alpha_from_median.unwrap());
    for case in [&quick, &usual] {
        assert!(case.hamiltonian_rise < 1e-3, "{}", case.hamiltonian_rise);
        assert!(case.energies.iter().all(|run| run[0] > run[run.len() - 1] && run.len() == case.ticks + 1));
    }
}

#[test]
fn agents_match_the_law_alone_unless_it_is_limited() {
    let agents = report(&small(Case::Free, 30, 15.0));
    let ideal = Plan { ideal: true, ..small(Case::Free, 30, 15.0) };
    let law = report(&ideal);
    // Lattices of equal energy may have different outlines.
    assert!((agents.hamiltonian / law.hamiltonian - 1.0).abs() < 0.01, "{} {}", agents.hamiltonian, law.hamiltonian);
    let soon = law.connected_from_latest.unwrap();
    let slow = report(&Plan { fastest: Some(5.0), ..ideal.clone() });
    assert!(slow.connected_from_latest.is_none_or(|late| late > soon + 50), "{soon} {:?}", slow.connected_from_latest);
    let blind = report(&Plan { nearest: Some(0), ..ideal });
    assert_eq!(blind.alpha_flocking, 0);
}

#[test]
fn resting_reference_gathers_a_flock_that_a_static_one_splits() {
    for case in [Case::Split, Case::Squeeze, Case::Forest] {
        let references = vec![Reference::Static, Reference::Resting];
        let plan = Plan { references, ideal: true, ..small(case, 60, 150.0) };
        let report = plan.measure().unwrap();
        let [apart, together] = &report.cases[..] else { panic!("two lines") };
        assert_eq!((apart.reference, together.reference), (Some(Reference::Static), Some(Reference::Resting)));
        assert!(apart.one_flock < 2, "{case:?}: {}", apart.one_flock);
        assert_eq!((together.one_flock, together.past), (2, Some(120)), "{case:?}");
        assert_eq!((together.inside, apart.inside), (0, 0));
    }
}

#[test]
fn finished_runs_are_not_repeated_for_their_pictures() {
    let plan = small(Case::Free, 5, 0.2);
    let dir = tempfile::tempdir().unwrap();
    let perform =
        |keeping: &RowRetention| plan.perform(&Jobs::new(&plan, &|_| true, Some((dir.path(), keeping)))).unwrap();
    let made = perform(&RowRetention::default());
    let file = dir.path().join("courses/0-1.postcard");
    let mut other = Run::kept(&file, made[0][1].hash).unwrap();
    assert_eq!(other, made[0][1]);
    other.energies[0] = 12345.0;
    other.keep(&file).unwrap();
    let resume = RowRetention { resume: true, ..RowRetention::default() };
    assert_eq!(perform(&resume)[0][1], other);
    // A missing time series, or that of another run, is computed again.
    std::fs::copy(dir.path().join("courses/0-0.postcard"), &file).unwrap();
    assert_eq!(perform(&resume), made);
    std::fs::remove_dir_all(dir.path().join("courses")).unwrap();
    assert_eq!(perform(&resume), made);
}
