use super::*;
use staya_controller::lattice::{Algorithm, ReferenceMotion};

#[test]
fn only_a_stationary_goal_may_have_a_rest_distance() {
    let motion = |fields: &str| {
        let text = format!(
            "{HEAD}tick_s = 0.02\n{PLANE}law = \"lattice\"\n[plane.robots]\ncloud = {{ count = 2, from_m = [0, 0], to_m = [9, 9] }}\n\
             [plane.lattice]\nspacing_m = 1\n{fields}\n"
        );
        let scenario = Scenario::parse(&text, Path::new("s.toml"), &Overrides::default());
        scenario.map(|scenario| match &scenario.plane().unwrap().general.law {
            LawSetup::BuiltIn(LawSettings::Lattice(lattice)) => {
                assert_eq!(lattice.params.algorithm == Algorithm::ThreeInTurn, fields.contains("takes_turns = true"));
                (lattice.params.obstacle_ratio, lattice.motion())
            }
            other => panic!("{other:?}"),
        })
    };
    assert_eq!(motion("takes_turns = true").unwrap(), (0.6, ReferenceMotion::Dynamic));
    assert_eq!(motion("takes_turns = false").unwrap(), (0.6, ReferenceMotion::Dynamic));
    assert_eq!(motion("").unwrap(), (0.6, ReferenceMotion::Dynamic));
    assert_eq!(motion("goal_moves = false\nobstacle_ratio = 0.4").unwrap(), (0.4, ReferenceMotion::Static));
    assert_eq!(motion("goal_moves = false\ngoal_rest_m = 10").unwrap(), (0.6, ReferenceMotion::Resting(10.0)));
    for (fields, said) in [
        ("goal_rest_m = 10", "goal_moves = false"),
        ("goal_moves = false\ngoal_rest_m = 0", "plane.lattice.goal_rest_m"),
        ("obstacle_ratio = 5", "plane.lattice.obstacle_ratio"),
        ("algorithm = 2\ntakes_turns = true", "plane.lattice.takes_turns: robots take turns in algorithm 3 only"),
    ] {
        let error = motion(fields).unwrap_err().to_string();
        assert!(error.contains(said), "{error}");
    }
}

#[test]
fn a_torus_is_only_for_boids_and_in_whole_millimetres() {
    let plane = "[plane]\nradius_m = 0.2\nmax_speed_mps = 1\nlaw = \"boids\"\n";
    let boids = "[plane.boids]\ncrowded_m = 1\nclosest_m = 4\n";
    let text = |fields: &str, starts: &str, more: &str| {
        format!("{HEAD}{plane}{fields}\n{boids}[plane.robots]\nlist = [{starts}]\n{more}")
    };
    let two = "{ start_m = [0, 0] }, { start_m = [8.5, 7] }";
    let setup = setup(&text("torus_m = [9, 8]", two, ""));
    assert_eq!(setup.torus_m, Some([9.0, 8.0]));
    assert_eq!(setup.space().offset([0.0; 3], [8.5, 7.0, 0.0]), [-0.5, -1.0, 0.0]);
    let lattice =
        format!("{HEAD}[plane]\nradius_m = 0.2\nmax_speed_mps = 1\ntorus_m = [9, 8]\n[plane.robots]\nlist = [{two}]\n");
    for (text, said) in [
        (text("torus_m = [9, 0]", two, ""), "plane.torus_m[1]: 0 is out of range"),
        (text("torus_m = [9, 8.0005]", two, ""), "plane.torus_m[1]: 8.0005 m is not a whole number of millimetres"),
        (text("torus_m = [9, 7]", two, ""), "give sides of twice plane.boids.closest_m"),
        (text("torus_m = [8.5, 8]", two, ""), "plane.robots: robot 2 starts beside the torus"),
        (text("torus_m = [9, 8]", "{ start_m = [0, 0, 1] }", ""), "at height 0"),
        (text("torus_m = [9, 8]", two, "[[plane.ball]]\ncenter_m = [4, 4]\nradius_m = 1\n"), "know of no torus"),
        (text("torus_m = [9, 8]", "{ start_m = [0, 0] }, { start_m = [8.8, 0] }", ""), "robots 1 and 2 overlap"),
        (lattice, "plane.torus_m: robots with the law \"waypoint\" know of no torus"),
    ] {
        let error = parse(&text).unwrap_err().to_string();
        assert!(error.contains(said), "{error}");
    }
}
