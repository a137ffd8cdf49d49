use super::*;
use staya_controller::cost::Gain;

fn small() -> Plan {
    Plan {
        obstacles: vec![0, 10],
        runs: 4,
        size: 40,
        other_eps: vec![2],
        other_losses: vec![0.6],
        seed: 1,
        other_laws: Vec::new(),
        ..Plan::default()
    }
}

fn report(plan: &Plan) -> Report {
    plan.measure().unwrap()
}

#[test]
fn formation_is_kept_and_all_robots_arrive() {
    let report = report(&small());
    assert_eq!(report.points.len(), 2);
    for point in &report.points {
        let journey = &point.formation;
        assert_eq!((point.runs, point.alone_arrived, journey.arrived), (4, 4, 4));
        assert_eq!(journey.collisions, 0);
        assert!(journey.error_per_agent.mean < 1.5, "{journey:?}");
        assert!(journey.worst_error < 8.0, "{journey:?}");
        let ratio = journey.time_ratio.unwrap();
        assert!((0.9..2.0).contains(&ratio), "{ratio}");
        // The best fit minimises squares; its mean distance is similar.
        assert!(journey.best_fit_error_per_agent < journey.error_per_agent.mean * 1.5);
        assert_eq!((point.other_eps.len(), point.other_losses.len()), (1, 1));
        assert_eq!(point.other_losses[0].arrived, 4, "also at 60 % loss");
    }
    let fit = report.fit.unwrap();
    assert!((fit.at(0.0) - report.points[0].formation.error_per_agent.mean).abs() < 1e-9);
}

#[test]
fn formation_parameters_reduce_the_error() {
    let loose = Plan {
        formation: FormationParams { halt_lag: u16::MAX, gain: Gain::ZERO, ..FormationParams::default() },
        ..small()
    };
    let error = |plan: &Plan| report(plan).points[1].formation.error_per_agent.mean;
    assert!(error(&small()) < error(&loose));
}

#[test]
fn followers_with_lookahead_are_nearer_and_faster() {
    let plan = Plan {
        obstacles: vec![20],
        runs: 20,
        size: 70,
        other_losses: vec![],
        other_laws: vec![Law::Lookahead],
        ..small()
    };
    let report = report(&plan);
    let (ours, ahead) = (&report.points[0].formation, &report.points[0].other_laws[0].journey);
    assert_eq!((ours.arrived, ahead.arrived), (20, 20));
    assert_eq!(ahead.collisions, 0);
    assert!(ahead.error_per_agent.mean < ours.error_per_agent.mean, "{report}");
    assert!(ahead.time_ratio < ours.time_ratio, "{report}");
}

#[test]
fn report_compares_ours_with_the_papers_law_and_without_waiting() {
    let plan = Plan { obstacles: vec![10], other_laws: vec![Law::Unwaiting, Law::Paper], ..small() };
    let report = report(&plan);
    let laws: Vec<(Law, f64)> = report.points[0].other_laws.iter().map(|o| (o.law, o.journey.loss)).collect();
    assert_eq!(laws, [(Law::Unwaiting, 0.0), (Law::Unwaiting, 0.6), (Law::Paper, 0.0), (Law::Paper, 0.6)]);
    let ours = &report.points[0].formation;
    for other in &report.points[0].other_laws {
        assert_eq!(other.journey.collisions, 0);
        assert_ne!(other.journey.error_per_agent, ours.error_per_agent, "{:?} is another law", other.law);
    }
    let paper = &report.points[0].other_laws[2].journey;
    assert!(paper.arrived > 0 && paper.error_per_agent.mean < 6.0, "{paper:?}");
    let text = report.to_string();
    assert!(text.contains("what our waiting buys") && text.contains("      paper"), "{text}");
    let dir = tempfile::tempdir().unwrap();
    let files = report.draw(dir.path()).unwrap();
    assert!(files.iter().any(|file| file.ends_with("laws.svg")), "{files:?}");
}

#[test]
fn threads_and_early_ends_change_nothing() {
    let plan = small();
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| plan.carry_out(|_| true).unwrap())
    };
    let all = on(1);
    assert_eq!(all, on(4));
    assert_eq!(all.concat().len(), 8 * 4);
    let none = plan.carry_out(|_| false).unwrap();
    assert!(plan.report(&none).points.is_empty());
}

#[test]
fn invalid_plans_are_refused_with_the_reason() {
    let refused = |change: fn(&mut Plan)| {
        let mut plan = small();
        change(&mut plan);
        plan.check().unwrap_err().to_string()
    };
    assert!(refused(|p| p.runs = 0).contains("1 or more"));
    assert!(refused(|p| p.obstacles.clear()).contains("give one number"));
    assert!(refused(|p| p.ticks = 0).contains("time to arrive"));
    assert!(refused(|p| p.size = 9).contains("10..=2000"));
    assert!(refused(|p| p.spacing = 0).contains("1..=10"));
    assert!(refused(|p| p.other_losses = vec![1.5]).contains("between 0 and 1"));
    assert!(refused(|p| p.loss = f64::NAN).contains("between 0 and 1"));
    assert!(refused(|p| p.route.radius = 17).contains("1..=16"));
    assert!(refused(|p| p.obstacles = vec![2000]).contains("2000"));
    let least = Plan { size: small().least_size(), obstacles: vec![0], ..small() };
    assert_eq!(report(&least).points[0].formation.arrived, 4);
}

#[test]
fn pictures_are_written() {
    let dir = tempfile::tempdir().unwrap();
    let files = report(&small()).draw(dir.path()).unwrap();
    assert_eq!(files.len(), 6);
    assert!(files.iter().all(|file| file.metadata().unwrap().len() > 1000));
}
