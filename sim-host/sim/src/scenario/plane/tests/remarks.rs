use super::super::remarks;
use super::*;

fn said(robots: &str, rest: &str) -> Vec<String> {
    let scenario = parse(&format!("tick_s = 0.1\n{HEAD}{PLANE}{rest}\n[plane.robots]\nlist = [{robots}]\n"));
    scenario.unwrap_or_else(|error| panic!("{error}")).remarks()
}

const YARD: &str = "[[plane.wall]]\npoints_m = [[4, -2], [8, -2], [8, 2], [4, 2]]\nclosed = true\n";
const ONE: &str = "{ start_m = [0, 0], goal_m = [6, 0] }";

#[test]
fn unreachable_goals_cause_a_warning() {
    assert_eq!(said(ONE, ""), Vec::<String>::new());
    // The order may free the goal; otherwise the scenario is refused.
    let ball = "[[plane.order]]\nat_s = 0.1\nplace_m = [6, 3]\n[[plane.ball]]\ncenter_m = [6.5, 0]\nradius_m = 0.4\n";
    assert_eq!(
        said(ONE, ball),
        ["plane.robots: the goal of robot 1 is nearer to an obstacle than the body's radius and cannot be reached"]
    );
    assert_eq!(
        said(ONE, YARD),
        ["plane.robots: the goal of robot 1 is on the other side of a closed wall and cannot be reached"]
    );
    // A robot that is already inside may have its goal there, and an open wall has an entrance.
    assert_eq!(said("{ start_m = [5, 1], goal_m = [6, 0] }", YARD), Vec::<String>::new());
    assert_eq!(said(ONE, &YARD.replace("closed = true", "closed = false")), Vec::<String>::new());
    let many: Vec<_> = (0..6).map(|y| format!("{{ start_m = [0, {y}], goal_m = [6, 0] }}")).collect();
    let many = said(&many.join(", "), YARD);
    assert!(many.len() == 1 && many[0].contains("the goal of robots 1, 2, 3 and 3 more is"), "{many:?}");
    // A goal between two yards is inside neither.
    let two = format!("{YARD}{}", YARD.replace("[4, ", "[14, ").replace("[8, ", "[18, "));
    assert_eq!(said("{ start_m = [0, 0], goal_m = [11, 0] }", &two), Vec::<String>::new());
}

#[test]
fn goals_at_another_height_need_a_safety_layer_in_space() {
    let up = "{ start_m = [0, 0, 1], goal_m = [6, 0, 3] }";
    for safety in ["orca", "template_2k"] {
        let said = said(up, &format!("safety = \"{safety}\"\n"));
        assert!(said.len() == 1 && said[0].contains("keeps to the plane: give safety = \"fly\""), "{safety}: {said:?}");
    }
    for safety in ["fly", "none"] {
        assert_eq!(said(up, &format!("safety = \"{safety}\"\n")), Vec::<String>::new(), "{safety}");
    }
}

#[test]
fn a_tick_in_which_a_body_moves_more_than_its_width_causes_a_warning() {
    let of_tick = |tick_s: f64| {
        let text = format!("tick_s = {tick_s}\n{HEAD}{PLANE}[plane.robots]\nlist = [{ONE}]\n");
        parse(&text).expect("good").remarks()
    };
    assert_eq!(of_tick(0.4), Vec::<String>::new());
    let [remark] = &of_tick(0.5)[..] else { panic!("one remark") };
    assert!(remark.contains("goes 0.50 m in a tick") && remark.contains("at most 0.400 would do"), "{remark}");
}

#[test]
fn news_so_late_that_a_robot_goes_its_radius_causes_a_warning() {
    let of = |radio: &str, rest: &str, robots: &str| {
        let text = format!("tick_s = 0.1\n{HEAD}[radio]\n{radio}\n{PLANE}{rest}[plane.robots]\nlist = [{robots}]\n");
        parse(&text).expect("good").remarks()
    };
    let two = format!("{ONE}, {{ start_m = [0, 3], goal_m = [6, 3] }}");
    let late = "delay_ms = 200\njitter_ms = 200";
    // At 1 m/s, with a radius of 0.2 m.
    assert_eq!(of("delay_ms = 290", "", &two), Vec::<String>::new());
    assert_eq!(of(late, "safety = \"none\"\n", &two), Vec::<String>::new());
    assert_eq!(of(late, "", ONE), Vec::<String>::new(), "it is alone");
    let [remark] = &of(late, "", &two)[..] else { panic!("one remark") };
    assert!(remark.contains("may go 0.30 m") && remark.contains("0.67 m/s or less"), "{remark}");
    // A body that turns slowly is known for longer; one that may be quicker, for less.
    assert_eq!(of(late, "max_acceleration_mps2 = 4\n", &two), Vec::<String>::new());
    let quick = "[plane.orca]\ninflation_mps = 2\n";
    assert!(of("delay_ms = 210", quick, &two)[0].contains("may go 0.22 m"));
    assert_eq!(of("delay_ms = 210", "", &two), Vec::<String>::new());
}

#[test]
fn a_closed_wall_that_crosses_itself_causes_a_warning() {
    let bow = "[[plane.wall]]\npoints_m = [[4, 4], [8, 8], [8, 4], [4, 8]]\nclosed = true\n";
    assert_eq!(
        said("{ start_m = [0, 0] }", bow),
        ["plane.wall: sides 1 and 3 of the closed wall that begins at [4, 4] cross, so its inside is undefined"]
    );
    // A concave corner, and walls that touch at their ends, do not cross.
    let notch = "[[plane.wall]]\npoints_m = [[4, 4], [8, 4], [8, 8], [6, 6], [4, 8]]\nclosed = true\n";
    assert_eq!(said("{ start_m = [0, 0] }", notch), Vec::<String>::new());
}

#[test]
fn scenarios_of_the_repository_cause_no_warnings() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios");
    let files = std::fs::read_dir(folder).expect("scenarios").flatten().map(|entry| entry.path());
    let mut count = 0;
    for file in files.filter(|file| file.extension().is_some_and(|end| end == "toml")) {
        let scenario = Scenario::load(&file, &Overrides::default()).unwrap_or_else(|error| panic!("{error}"));
        let plane = scenario.plane().into_iter().flat_map(|setup| remarks::remarks(&scenario, setup));
        assert_eq!(plane.collect::<Vec<_>>(), Vec::<String>::new(), "{}", file.display());
        count += 1;
    }
    assert!(count > 20, "{count}");
}
