use super::*;
use staya_controller::flock::lattice::ReferenceMotion;

#[test]
fn a_goal_that_stays_may_give_rest_and_one_that_moves_may_not() {
    let motion = |fields: &str| {
        let text = format!(
            "{HEAD}tick_s = 0.02\n{PLANE}guidance = \"lattice\"\n[plane.robots]\ncloud = {{ count = 2, from_m = [0, 0], to_m = [9, 9] }}\n\
             [plane.lattice]\nspacing_m = 1\n{fields}\n"
        );
        let scenario = Scenario::parse(&text, Path::new("s.toml"), &Overrides::default());
        scenario.map(|scenario| match scenario.plane.unwrap().general.guidance {
            GuidanceSetup::Lattice { params, motion } => (params.obstacle_ratio, motion),
            other => panic!("{other:?}"),
        })
    };
    assert_eq!(motion("").unwrap(), (0.6, ReferenceMotion::Dynamic));
    assert_eq!(motion("goal_moves = false\nobstacle_ratio = 0.4").unwrap(), (0.4, ReferenceMotion::Static));
    assert_eq!(motion("goal_moves = false\ngoal_rest_m = 10").unwrap(), (0.6, ReferenceMotion::Resting(10.0)));
    for (fields, said) in [
        ("goal_rest_m = 10", "goal_moves = false"),
        ("goal_moves = false\ngoal_rest_m = 0", "plane.lattice.goal_rest_m"),
        ("obstacle_ratio = 5", "plane.lattice.obstacle_ratio"),
    ] {
        let error = motion(fields).unwrap_err().to_string();
        assert!(error.contains(said), "{error}");
    }
}
