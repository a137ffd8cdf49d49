use super::*;

fn value(parameters: &Parameters, name: &str) -> f64 {
    let measured = parameters.measure(5, &|_| true).unwrap();
    measured.values[name].unwrap_or_else(|| panic!("{name} is empty"))
}

#[test]
fn formula_gives_the_papers_example() {
    let whole = Parameters { pairs: 200, ..Parameters::default() };
    assert!((value(&whole, "change_mps") - 0.292_893).abs() < 1e-6);
    assert!((value(&whole, "point_x") - 1.707_107).abs() < 1e-6);
    assert!((value(&whole, "point_y") - 0.792_893).abs() < 1e-6);
    assert!(value(&whole, "off_mps") < 1e-12);
    let half = Parameters { share: 0.5, ..whole };
    assert!((value(&half, "point_x") - 1.603_553).abs() < 1e-6);
    assert!((value(&half, "point_y") - 0.896_447).abs() < 1e-6);
    assert_eq!(value(&whole, "agreement"), 1.0);
    assert!(value(&whole, "agreement_printed") < 0.9);
}

#[test]
fn a_programme_is_as_good_as_linear_programming() {
    let parameters = Parameters { task: Task::Programme, nodes: 9, pairs: 50, ..Parameters::default() };
    assert!(value(&parameters, "worst_excess_mps") < 0.01);
    assert!(value(&parameters, "excess_mps") > -1e-6);
    assert!(value(&parameters, "violation_mps") < 1e-9);
}

#[test]
fn half_planes_of_other_pairs_need_a_model_for_them() {
    let source =
        staya_sim::scenario::Source::new(Path::new("f.toml"), "[study]\ntask = 'half_planes'\nsource = 'distance'");
    let given = Given { source: source.unwrap(), measures: &[], seed: 1 };
    let Err(error) = Fvm.read(&given) else { panic!("accepted") };
    assert!(error.to_string().contains("study.source"), "{error}");
}

/// Two discs in a room: ridges between them and the walls.
#[test]
fn ridges_separate_obstacles_and_lead_past_them() {
    let parameters = Parameters { task: Task::Ridges, nodes: 65, obstacles: 6, ..Parameters::default() };
    assert_eq!(value(&parameters, "route"), 1.0);
    assert_eq!(value(&parameters, "separated"), 1.0);
    let (width, clearance_m) = (value(&parameters, "width"), value(&parameters, "clearance_m"));
    assert!(width > 0.9 && width <= 1.0 && clearance_m > 0.25, "{width} {clearance_m}");
    // Lines, not areas.
    let share = value(&parameters, "ridge_share");
    assert!(share > 0.02 && share < 0.25, "{share}");
}

#[test]
fn robots_of_the_example_collide_unless_they_correct_their_velocities() {
    let whole = Parameters { pairs: 10, ..Parameters::default() };
    let distance_m = 2.0_f64.sqrt();
    assert!((value(&whole, "closest_m") - distance_m).abs() < 1e-9);
    for share in [0.5, 1.0] {
        let corrected = value(&Parameters { share, ..whole }, "closest_corrected_m");
        assert!((corrected - 2.0).abs() < 1e-9, "{corrected}");
    }
}
