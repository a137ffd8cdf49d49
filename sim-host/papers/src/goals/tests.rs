use super::*;

/// Small enough for a test, large enough to show something.
fn small() -> Plan {
    Plan {
        k1: vec![0.0, 50.0, 150.0],
        neighborhoods_m: vec![40.0],
        robots: 40,
        seconds: 200.0,
        step_s: 0.2,
        ..Plan::default()
    }
}

fn report(plan: &Plan) -> Report {
    plan.measure().unwrap()
}

#[test]
fn robots_gather_draw_and_arrive_and_without_k1_nobody_goes() {
    let report = report(&small());
    assert_eq!(report.points.len(), 3);
    let [still, group, single] = [0, 1, 2].map(|index| &report.points[index]);
    assert_eq!((still.gathered, still.arrived), (0.0, 0.0));
    assert!(still.polarisation.unwrap() < 0.5);
    for point in [group, single] {
        // Steps are coarse here, and so nobody takes more than half of a gap: some are late.
        assert!(point.gathered >= 0.9 && point.overlaps == 0, "{} {}", point.gathered, point.overlaps);
        assert!(point.arrived >= 0.8, "{}", point.arrived);
        assert!(point.polarisation.unwrap() > 0.9);
        assert!(point.goal_shares.iter().all(|share| *share > 0.1), "{:?}", point.goal_shares);
    }
    assert!(single.arrived >= 0.9, "{}", single.arrived);
    // Where neighbours pull as hard as the goal, headings differ more. (How far the crowd spreads depends on the seed.)
    assert!(group.polarisation < single.polarisation, "{:?} {:?}", group.polarisation, single.polarisation);
}

#[test]
fn a_goal_that_is_moved_on_the_way_is_reached_where_it_is() {
    let plan = Plan { k1: vec![150.0], moves_goal: true, ..small() };
    let moved = &report(&plan).points[0];
    assert!(moved.arrived >= 0.9, "{}", moved.arrived);
    assert!(moved.goal_shares[0] > 0.15);
}

#[test]
fn safety_layers_keep_bodies_apart_that_overlap_without() {
    let plan = |safety, (model, evasion)| Plan { k1: vec![150.0], safety, model, evasion, ..small() };
    let multiple = (Model::Radial, Evasion::Multiple);
    let bare = &report(&plan(SafetyKind::None, multiple)).points[0];
    assert!(bare.overlaps > 0);
    for safety in [SafetyKind::Orca, SafetyKind::PushOut] {
        let point = &report(&plan(safety, multiple)).points[0];
        assert_eq!(point.overlaps, 0, "{safety:?}");
    }
    let words = [
        (multiple, "push-out (radial, multiple)"),
        ((Model::Tangential, Evasion::Single), "push-out (tangential, single)"),
    ];
    for (push_out, wanted) in words {
        let plan = Plan { seconds: 20.0, ..plan(SafetyKind::PushOut, push_out) };
        assert_eq!(report(&plan).safety, wanted);
    }
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
fn plans_that_cannot_be_carried_out_say_why() {
    let refused = |change: fn(&mut Plan)| {
        let mut plan = small();
        change(&mut plan);
        plan.check().unwrap_err().to_string()
    };
    assert!(refused(|p| p.runs = 0).contains("1 or more"));
    assert!(refused(|p| p.k1.clear()).contains("one K1"));
    assert!(refused(|p| p.k3 = f64::NAN).contains("a gain of NaN"));
    assert!(refused(|p| p.robots = 1).contains("2 to 2000"));
    assert!(refused(|p| p.min_distance_m = 0.0).contains("0.1 to 30"));
    assert!(refused(|p| p.neighborhoods_m = vec![19.0]).contains("must be 20"));
    assert!(refused(|p| p.step_s = 0.6).contains("0.001 to 0.5"));
    assert!(refused(|p| p.seconds = f64::INFINITY).contains("1 to 1,000,000 steps"));
}

#[test]
fn pictures_are_written() {
    let dir = tempfile::tempdir().unwrap();
    let plan = Plan { seconds: 10.0, ..small() };
    let files = report(&plan).draw(dir.path()).unwrap();
    // The order; K1 = 50 and 150.
    assert_eq!(files.len(), 6);
    for file in &files {
        assert!(file.metadata().unwrap().len() > 1000, "{}", file.display());
    }
}
