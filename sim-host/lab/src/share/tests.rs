use super::*;

fn small() -> Plan {
    Plan {
        obstacles: vec![100],
        groups: vec![6],
        starts: vec![Starts::InTurn],
        losses: vec![0.0, 0.6],
        runs: 4,
        size: 60,
        ..Plan::default()
    }
}

#[test]
fn followers_are_faster_with_the_maps_of_robots_ahead() {
    let report = small().measure().unwrap();
    let [alone, perfect, lossy] = &report.points[0].outlooks[..] else { panic!("{report}") };
    for outlook in [alone, perfect, lossy] {
        assert_eq!((outlook.arrived, outlook.collisions), (24, 0));
    }
    // The first robot has no predecessor.
    let last = |outlook: &Outlook| outlook.last_percent.unwrap();
    assert!(last(perfect) < 0.6 * last(alone), "{report}");
    assert!(last(lossy) < 0.8 * last(alone), "{report}");
    assert!(perfect.packets > alone.packets, "{report}");
}

#[test]
fn each_group_has_distinct_places_and_the_requested_start() {
    let plan = small();
    for starts in [Starts::Anywhere, Starts::Together, Starts::InTurn] {
        for group in [1, 6, 20] {
            let case = Case { obstacles: 100, group, starts, shared: None };
            let places = Plan { size: 100, ..plan.clone() }.places(case, 0);
            assert_eq!(places.len(), group as usize);
            for (n, &(start, goal)) in places.iter().enumerate() {
                assert!(start.chebyshev(goal) >= 50);
                for cell in [start, goal] {
                    assert!((1..99).contains(&cell.x) && (1..99).contains(&cell.y), "{starts:?} {cell:?}");
                }
                assert!(places[..n].iter().all(|&(s, g)| s != start && g != goal));
            }
        }
    }
    let in_turn = plan.scenario(Case { obstacles: 100, group: 6, starts: Starts::InTurn, shared: None }, 0).unwrap();
    let departures: Vec<u32> = in_turn.faults.iter().map(|fault| fault.to_tick).collect();
    assert_eq!(departures, [100, 200, 300, 400, 500]);
}

#[test]
fn invalid_plans_are_refused_with_a_remedy() {
    let refused = |plan: Plan| plan.check().unwrap_err().to_string();
    assert!(refused(Plan { groups: vec![0], ..small() }).contains("it must be 1..=50"));
    assert!(refused(Plan { losses: vec![1.5], ..small() }).contains("between 0 and 1"));
    assert!(refused(Plan { size: 39, ..small() }).contains("40..=500"));
    assert!(refused(Plan { obstacles: vec![], ..small() }).contains("give one number"));
    assert!(refused(Plan { starts: vec![], ..small() }).contains("--starts"));
    assert!(refused(Plan { interval: 1001, ..small() }).contains("1000 or less"));
}
