use crate::canvas::Shape;
use crate::colour::{MUTED, of_group, of_mode};
use crate::flock::Sheet;
use crate::motion_sheet;
use staya_controller::robot::Mode;
use staya_sim::engine::simulate;
use staya_sim::record::{Options, Recorder};
use staya_sim::scenario::{Overrides, Scenario};
use std::ops::ControlFlow;
use std::path::Path;

const TEXT: &str = "name = \"t\"\nticks = 90\ntick_s = 0.1\n[terrain]\nuniform = { width = 20, height = 12, classes = 3 }\n\
    [plane]\nradius_m = 0.2\nmax_speed_mps = 1\n[plane.robots]\n\
    list = [{ start_m = [2, 2], goal_m = [8, 2] }, { start_m = [4, 9], goal_m = [8, 9] }]\n\
    [[plane.order]]\nat_s = 3\nplace_m = [2, 30]\nvelocity_mps = [0.5, 0]\n\
    [[plane.ball]]\ncenter_m = [15, -6]\nradius_m = 2\n[[plane.half_space]]\npoint_m = [0, -40]\nnormal = [0, 1]\n";

fn sheet(text: &str) -> Sheet {
    let scenario = Scenario::parse(text, Path::new("t.toml"), &Overrides::default()).expect("good");
    let mut recorder = Recorder::in_memory(Options::default());
    simulate(&scenario, |moment, robots| {
        recorder.tick(moment.row, robots).expect("memory takes everything");
        ControlFlow::Continue(())
    })
    .expect("room");
    motion_sheet("t", &scenario, &recorder.finish().expect("no file"))
}

fn scenario(name: &str) -> String {
    std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios").join(name)).unwrap()
}

#[test]
fn goals_follow_orders_and_everything_is_visible() {
    let sheet = sheet(TEXT);
    let [first, .., last] = &sheet.snapshots[..] else { panic!("moments") };
    let goals = first.goals.iter().map(|(goal, _)| *goal).collect::<Vec<_>>();
    assert_eq!(goals, [[8.0, 2.0, 0.0], [8.0, 9.0, 0.0]]);
    let [([x, y, _], _)] = last.goals[..] else { panic!("one goal: {:?}", last.goals) };
    assert!((x - 5.0).abs() < 1e-9 && (y - 30.0).abs() < 1e-9, "{x} {y}");
    let [low, high] = first.span_m.expect("a range");
    assert!(low[0] < 2.0 && high[0] > 17.0 && low[1] < -8.0 && high[1] > 30.0, "{low:?} {high:?}");
    assert!(sheet.snapshots.iter().all(|moment| moment.span_m == first.span_m));
}

#[test]
fn arrows_have_one_scale_and_the_map_is_at_the_bottom() {
    let sheet = sheet(TEXT);
    let fastest = sheet.snapshots[0].fastest_mps;
    assert!(fastest > 0.5 && sheet.snapshots.iter().all(|moment| moment.fastest_mps == fastest), "{fastest}");
    let images =
        |sheet: &Sheet| sheet.draw().shapes.iter().filter(|shape| matches!(shape, Shape::Image { .. })).count();
    assert_eq!(images(&sheet), sheet.snapshots.len());
    let flat = TEXT.replace("[terrain]\nuniform = { width = 20, height = 12, classes = 3 }\n", "");
    assert_eq!(images(&self::sheet(&flat)), 0);
}

#[test]
fn a_very_long_wall_does_not_shrink_the_robots() {
    let walls = "[[plane.wall]]\npoints_m = [[5, -200], [5, -1]]\n";
    let [low, high] = sheet(&format!("{TEXT}{walls}")).snapshots[0].span_m.expect("a range");
    assert!(high[0] - low[0] < 30.0 && low[1] > -20.0 && high[1] < 40.0, "{low:?} {high:?}");
}

#[test]
fn flyers_are_drawn_in_perspective_with_their_columns_of_air() {
    let sheet = sheet(&scenario("downwash.toml"));
    for moment in &sheet.snapshots {
        assert!(moment.is_space && moment.downwash == 3.0);
        assert!(moment.trails.len() == 16 && moment.goals.iter().any(|(goal, _)| goal[2] == 4.5));
    }
    let texts = super::text_boxes(&sheet.draw());
    assert!(["column of blown air", "z (m)"].iter().all(|wanted| texts.iter().any(|(text, _)| text == wanted)));
    assert!(!self::sheet(TEXT).snapshots[0].is_space);
}

#[test]
fn flyers_over_land_have_it_on_the_floor() {
    let text =
        TEXT.replace("max_speed_mps = 1\n", "max_speed_mps = 1\nsafety = \"fly\"\n").replace("[8, 2]", "[8, 2, 4]");
    let sheet = sheet(&text);
    assert!(sheet.snapshots[0].is_space);
    let canvas = sheet.draw();
    let grey = crate::map::shade(3, 3, crate::map::PALE);
    let areas =
        canvas.shapes.iter().filter(|shape| matches!(shape, Shape::Path { fill: Some(fill), .. } if *fill == grey));
    assert_eq!(areas.count(), sheet.snapshots.len() + 1, "in each moment and in the legend");
}

#[test]
fn robots_and_goals_have_the_colour_of_their_group() {
    let sheet = sheet(&scenario("groups.toml"));
    let keys: Vec<_> = sheet.keys.clone().unwrap();
    assert_eq!(
        keys,
        [0, 1, 2].map(|group| {
            let name = if group == 0 { "no group".to_owned() } else { format!("group {group}") };
            (name, of_group(group))
        })
    );
    let moment = &sheet.snapshots[0];
    let count = |colour| moment.bodies.iter().filter(|body| body.colour == colour).count();
    let goals = |colour| moment.goals.iter().filter(|(_, goal)| *goal == colour).count();
    let texts = super::text_boxes(&sheet.draw());
    assert!(texts.iter().any(|(text, _)| text == "arrived"), "pale robots are explained");
    for (_, colour) in keys {
        assert!(count(colour) > 1 && (goals(colour) > 0 || goals(MUTED) > 0), "{colour:?}");
    }
}

#[test]
fn many_robots_have_the_colours_of_their_modes() {
    let sheet = sheet(&scenario("downwash.toml"));
    let [first, .., last] = &sheet.snapshots[..] else { panic!("moments") };
    let all = |moment: &crate::flock::Snapshot, mode| moment.bodies.iter().all(|body| body.colour == of_mode(mode));
    assert!(all(first, Mode::Idle) && all(last, Mode::Arrived));
    let names: Vec<_> = sheet.keys.unwrap().into_iter().map(|(name, _)| name).collect();
    assert_eq!(names, ["idle", "cruise", "arrived"]);
}
