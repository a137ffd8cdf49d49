use crate::canvas::Shape;
use crate::flock::Sheet;
use crate::motion_sheet;
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
    let (setup, history) = (scenario.plane.as_ref().expect("a plane"), recorder.finish().expect("no file"));
    motion_sheet("t", setup, setup.has_terrain.then_some(&scenario.terrain), &history)
}

#[test]
fn goals_follow_orders_and_everything_is_visible() {
    let sheet = sheet(TEXT);
    let [first, .., last] = &sheet.snapshots[..] else { panic!("moments") };
    assert_eq!(first.goals_m, [[8.0, 2.0], [8.0, 9.0]]);
    let [[x, y]] = last.goals_m[..] else { panic!("one goal: {:?}", last.goals_m) };
    assert!((x - 5.0).abs() < 1e-9 && (y - 30.0).abs() < 1e-9, "{x} {y}");
    let [[west, east], [south, north]] = first.view_m.expect("a view");
    assert!(west < 2.0 && east > 17.0 && south < -8.0 && north > 30.0, "{:?}", first.view_m);
    assert!(sheet.snapshots.iter().all(|moment| moment.view_m == first.view_m));
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
    let [[west, east], [south, north]] = sheet(&format!("{TEXT}{walls}")).snapshots[0].view_m.expect("a view");
    assert!(east - west < 30.0 && south > -20.0 && north < 40.0, "{west} {east} {south} {north}");
}
