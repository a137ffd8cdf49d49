use super::*;

fn small() -> Plan {
    Plan {
        k1: vec![50.0],
        k2: vec![0.0, 15.0, 50.0, 150.0],
        neighborhoods_m: vec![40.0],
        robots: vec![60],
        seconds: 120.0,
        step_s: 0.2,
        runs: 3,
        ..Plan::default()
    }
}

fn agents() -> Plan {
    Plan { knows: vec![Knowledge::Packets], safeties: vec![SafetyKind::Orca], start_sides: vec![2.0], ..small() }
}

fn report(plan: &Plan) -> Report {
    plan.measure().unwrap()
}

/// A dense start is one group already, which K2 far above K1 can only split.
#[test]
fn attraction_to_neighbours_forms_the_group_and_shows_from_a_scattered_start() {
    let scattered = report(&small());
    let gains: Vec<f64> = scattered.points[1..].iter().map(|point| point.company_gain.unwrap()).collect();
    assert!(gains[0] > 0.0 && gains[1] > gains[0] && gains[2] > gains[1], "{gains:?}");
    assert_eq!(scattered.points[0].company_gain, None, "independent robots are the reference");
    let [alone, .., last] = &scattered.points[..] else { panic!() };
    assert!(alone.together.unwrap() < 0.5 && last.together.unwrap() > alone.together.unwrap());
    let dense = report(&Plan { start_sides: vec![2.0], k2: vec![0.0, 50.0], ..small() });
    assert!(dense.points[0].together.unwrap() > 0.8, "{:?}", dense.points[0].together);
}

#[test]
fn larger_neighbourhood_forms_the_group_too() {
    let plan = Plan { k2: vec![0.0, 50.0], neighborhoods_m: vec![20.0, 40.0, 80.0], ..small() };
    let report = report(&plan);
    let gains: Vec<f64> = report.points.iter().filter_map(|point| point.company_gain).collect();
    assert!(gains.len() == 3 && gains[1] > gains[0] && gains[2] > gains[1], "{gains:?}");
}

#[test]
fn robots_stay_without_k1_and_with_it_gather_draw_a_goal_and_arrive() {
    for plan in [small(), agents()] {
        let plan = Plan { k1: vec![0.0, 50.0], k2: vec![50.0], runs: 1, seconds: 200.0, ..plan };
        let report = report(&plan);
        let [still, group] = &report.points[..] else { panic!() };
        assert_eq!((still.gathered, still.arrived), (0.0, 0.0));
        assert!(still.polarisation.unwrap() < 0.5);
        assert!(group.gathered >= 0.9 && group.overlaps == 0, "{} {}", group.gathered, group.overlaps);
        assert!(group.arrived >= 0.8, "{}", group.arrived);
        assert!(group.polarisation.unwrap() > still.polarisation.unwrap() + 0.2);
        assert!(group.goal_shares.iter().all(|share| *share > 0.1), "{:?}", group.goal_shares);
    }
}

#[test]
fn moving_goals_are_reached_at_their_current_place() {
    for plan in [small(), agents()] {
        let plan = Plan { k1: vec![150.0], k2: vec![50.0], k3: vec![300.0], runs: 1, seconds: 200.0, ..plan };
        let moved = &report(&Plan { moves_goal: true, ..plan.clone() }).points[0];
        assert!(moved.arrived >= 0.9 && moved.goal_shares[0] > 0.1, "{} {:?}", moved.arrived, moved.goal_shares);
        let drifting = &report(&Plan { goal_speeds_mps: vec![2.0], ..plan }).points[0];
        assert!(drifting.arrived >= 0.5, "{}", drifting.arrived);
    }
}

#[test]
fn safety_layers_prevent_overlaps() {
    let plan = Plan { k1: vec![150.0], k2: vec![50.0], runs: 1, ..small() };
    let bare = &report(&Plan { safeties: vec![SafetyKind::None], ..plan.clone() }).points[0];
    assert!(bare.overlaps > 0);
    let both = |plan| Plan {
        models: vec![Model::Radial, Model::Tangential],
        evasions: vec![Evasion::Single, Evasion::Multiple],
        obstacles: vec![4],
        // Two moving robots may come two steps nearer than permitted.
        step_s: 0.1,
        ..plan
    };
    let pushed = report(&both(plan.clone()));
    assert_eq!(pushed.points.len(), 4);
    for point in &pushed.points {
        // A robot that evades one robot may meet another one.
        let most = if point.setting.evasion == Evasion::Multiple { 0 } else { bare.overlaps / 10 };
        assert!(point.overlaps <= most, "{:?}", point.setting);
    }
    let orca = report(&Plan { safeties: vec![SafetyKind::Orca], ..both(Plan { k2: vec![50.0], ..agents() }) });
    assert_eq!(orca.points.len(), 1, "models are push-out's");
    assert_eq!(orca.points[0].overlaps, 0);
}

#[test]
fn knowledge_of_sixteen_equals_perfect_knowledge_in_small_swarms() {
    let knows = |knows, robots| {
        let plan = Plan {
            knows: vec![knows],
            robots: vec![robots],
            k2: vec![50.0],
            start_sides: vec![1.5],
            runs: 1,
            seconds: 20.0,
            ..small()
        };
        report(&plan).points[0].trace_hash.clone()
    };
    assert_eq!(knows(Knowledge::All, 17), knows(Knowledge::Nearest, 17));
    assert_ne!(knows(Knowledge::All, 120), knows(Knowledge::Nearest, 120));
}

#[test]
fn random_goals_differ_between_runs() {
    let plan = Plan { random_goals: true, ..small() };
    let setting = plan.settings()[0];
    let goals = |run| Scene::new(&plan, &setting, run).unwrap().goals_at(0);
    assert_eq!(goals(1), goals(1));
    assert_ne!(goals(1), goals(2));
}

#[test]
fn threads_and_early_ends_change_nothing() {
    let plan = Plan { seconds: 10.0, ..small() };
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| plan.carry_out(|_| true).unwrap())
    };
    assert_eq!(on(1), on(3));
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
    assert!(refused(|p| p.k1.clear()).contains("such as --k1 50"));
    assert!(refused(|p| p.k3 = vec![1.0, f64::NAN]).contains("a gain of NaN"));
    assert!(refused(|p| p.robots = vec![1]).contains("2 to 2000"));
    assert!(refused(|p| p.goals = vec![5]).contains("1 to 4"));
    assert!(refused(|p| p.goal_speeds_mps = vec![6.0]).contains("at most half"));
    assert!(refused(|p| p.min_distance_m = 0.0).contains("0.1 to 30"));
    assert!(refused(|p| p.neighborhoods_m = vec![19.0]).contains("must be 20"));
    assert!(refused(|p| p.step_s = 0.6).contains("0.001 to 0.5"));
    assert!(refused(|p| p.seconds = f64::INFINITY).contains("1 to 1,000,000 steps"));
    assert!(refused(|p| p.obstacles = vec![900]).contains("900 obstacles find no room"));
    assert!(refused(|p| p.safeties = vec![SafetyKind::Orca]).contains("--knows packets"));
    assert!(refused(|p| p.k1 = (0..2000).map(f64::from).collect()).contains("at most 5000"));
}

#[test]
fn pictures_are_written() {
    let dir = tempfile::tempdir().unwrap();
    let plan =
        Plan { k1: vec![0.0, 50.0, 150.0], neighborhoods_m: vec![20.0, 40.0], seconds: 10.0, runs: 1, ..small() };
    let runs = plan.carry_out(|_| true).unwrap();
    let files = plan.report(&runs).draw(dir.path()).unwrap();
    assert_eq!(files.len(), 8);
    for file in &files {
        assert!(file.metadata().unwrap().len() > 1000, "{}", file.display());
    }
}
