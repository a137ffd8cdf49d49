use super::{assert_readable, assert_texts_apart, decode};
use crate::colour::PALETTE;
use crate::run::on_map;
use crate::{run, trajectories};
use staya_controller::grid::{BLOCKED, Cell};
use staya_controller::rand::Rng;
use staya_controller::robot::Mode;
use staya_sim::record::{History, Motion, Options, PacketCounts, Recorder, RobotRow, TickRow};
use staya_sim::terrain::Terrain;
use staya_sim::terrain::generate::{LandPlan, uniform};
use std::path::Path;

fn row(id: u32, position_m: [f64; 2], target: Cell) -> RobotRow {
    RobotRow {
        id,
        motion: Motion {
            cell: Cell { x: 0, y: 0 },
            position_m: [position_m[0], position_m[1], 0.0],
            velocity_mps: [0.0; 3],
        },
        mode: Mode::Cruise,
        leader: 0,
        target,
        target_m: None,
        wait: None,
        formation_error_cells: f32::NAN,
        radius_m: None,
        has_cells: true,
    }
}

fn tick(tick: u32, error: f64) -> TickRow {
    TickRow {
        tick,
        time_s: f64::from(tick) * 0.5,
        formation_error_per_agent: error,
        graph_distance: error * 2.0,
        packets: PacketCounts { sent: 2, delivered: 10, lost: 1, damaged: 0, rejected: 0, ..PacketCounts::default() },
    }
}

/// Robots side by side move east by `speed` cells per tick, on cells of 1 m.
fn history(robots: u32, ticks: u32, speed: f64, error: f64) -> History {
    let mut recorder = Recorder::in_memory(Options::default());
    for now in 0..ticks {
        let rows = (1..=robots).map(|id| {
            let y = f64::from(id % 256) + 0.5;
            let x = f64::from(id / 256) % 200.0 + speed * f64::from(now) + 0.5;
            row(id, [x, y], Cell { x: 30, y: (id % 256) as i16 })
        });
        recorder.tick(&tick(now, error), rows).unwrap();
    }
    recorder.finish().unwrap()
}

fn land(side: u16) -> Terrain {
    let cells = usize::from(side) * usize::from(side);
    Terrain::from_cells(side, side, vec![1; cells]).unwrap()
}

fn names(terrain: &Terrain, history: &History, edges: &[(u32, u32)], dir: &Path) -> Vec<String> {
    let files = on_map("r", terrain, &[], history, edges, dir).unwrap();
    assert_readable(&files);
    let names = files.iter().map(|path| {
        assert_eq!(path.parent(), Some(dir));
        path.file_name().unwrap().to_str().unwrap().to_owned()
    });
    names.collect()
}

const WITHOUT_FORMATION: [&str; 4] = ["trajectories.svg", "trajectories.png", "packets.svg", "packets.png"];

#[test]
fn runs_of_any_length_have_their_pictures() {
    let dir = tempfile::tempdir().unwrap();
    let nan = f64::NAN;
    for (robots, ticks) in [(0, 0), (0, 1), (1, 1), (1, 2), (3, 40), (12, 3), (13, 3), (201, 3)] {
        let out = dir.path().join(format!("{robots}-{ticks}"));
        let history = history(robots, ticks, 0.5, nan);
        let ways = if history.frames().is_empty() { 2 } else { 0 };
        assert_eq!(names(&land(40), &history, &[], &out), WITHOUT_FORMATION[ways..]);
        assert_texts_apart(&trajectories::draw("r", &land(40), &[], &history, &[]).unwrap());
        assert_texts_apart(&run::packets("r", &history).draw());
    }
    let out = dir.path().join("formation");
    let files = names(&land(40), &history(3, 5, 1.0, 0.25), &[(1, 2), (2, 3), (3, 99)], &out);
    assert_eq!(files[2..4], ["formation.svg", "formation.png"]);
    assert_eq!(files.len(), 6);
}

#[test]
fn equal_runs_give_equal_bytes() {
    let dir = tempfile::tempdir().unwrap();
    let history = history(6, 50, 0.6, 0.5);
    let draw = |name: &str| {
        let files = on_map("r", &land(60), &[], &history, &[(1, 2)], &dir.path().join(name)).unwrap();
        let bytes = files.iter().map(|path| std::fs::read(path).unwrap());
        bytes.collect::<Vec<_>>()
    };
    assert!(draw("a") == draw("b"));
}

#[test]
fn an_unwritable_directory_is_named() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("taken");
    std::fs::write(&file, "").unwrap();
    let error = on_map("r", &land(4), &[], &history(1, 2, 1.0, 1.0), &[], &file).unwrap_err();
    assert!(error.to_string().contains("taken"), "{error}");
    let out = dir.path().join("out");
    std::fs::create_dir_all(out.join("packets.svg")).unwrap();
    let error = on_map("r", &land(4), &[], &history(1, 2, 1.0, 1.0), &[], &out).unwrap_err();
    assert_eq!(error.path(), out.join("packets.svg"));
}

#[test]
fn missing_values_leave_gaps_and_an_empty_chart_is_skipped() {
    let mut recorder = Recorder::in_memory(Options::default());
    for now in 0..20 {
        let error = if (5..9).contains(&now) { f64::NAN } else { 1.0 };
        let mut values = tick(now, error);
        values.graph_distance = f64::INFINITY;
        let place = if now == 3 { [f64::NAN; 2] } else { [f64::from(now), 2.5] };
        recorder.tick(&values, [row(1, place, Cell { x: -3, y: 900 })].into_iter()).unwrap();
    }
    let history = recorder.finish().unwrap();
    let dir = tempfile::tempdir().unwrap();
    assert_eq!(names(&land(30), &history, &[(1, 1)], dir.path()).len(), 6);
    let text = std::fs::read_to_string(dir.path().join("formation.svg")).unwrap();
    assert!(text.contains("Formation error per agent") && !text.contains("Graph distance"));
    assert!(run::formation("r", super::runs::history(1, 9, 1.0, f64::NAN).series()).is_none());
}

#[test]
fn packets_are_counted_per_second() {
    for ticks in [2, 3, 101, 250, 1000] {
        let canvas = run::packets("r", &history(1, ticks, 0.0, 1.0)).draw();
        let dir = tempfile::tempdir().unwrap();
        let files = canvas.write(&dir.path().join("p")).unwrap();
        let text = std::fs::read_to_string(&files[0]).unwrap();
        assert!(text.contains("packets per second") && text.contains(">20<"), "{ticks}");
        let curve = text
            .lines()
            .find(|line| line.starts_with("<path") && line.contains("stroke=\"#0072b2\" stroke-width=\"1.8\""))
            .unwrap();
        let line = curve.split('"').nth(1).unwrap();
        let mut heights: Vec<&str> = line.split(['M', 'L']).filter_map(|point| point.split(' ').nth(1)).collect();
        heights.dedup();
        assert_eq!(heights.len(), 1, "{ticks}: {heights:?}");
    }
    let one = run::packets("r", &history(1, 1, 0.0, 1.0)).draw();
    assert!(format!("{one:?}").contains("packets per tick"));
}

#[test]
fn north_is_up_walls_are_dark_and_paths_have_their_colours() {
    let mut terrain = land(20);
    terrain.set(Cell { x: 0, y: 19 }, BLOCKED);
    let mut recorder = Recorder::in_memory(Options::default());
    for now in 0..15 {
        let place = [f64::from(now) + 2.5, 4.5];
        let robots = [row(7, place, Cell { x: 16, y: 4 })];
        recorder.tick(&tick(now, f64::NAN), robots.into_iter()).unwrap();
    }
    let history = recorder.finish().unwrap();
    let canvas = trajectories::draw("r", &terrain, &[], &history, &[]).unwrap();
    let dir = tempfile::tempdir().unwrap();
    let files = canvas.write(&dir.path().join("t")).unwrap();
    let (width, _, bytes) = decode(&files[1]);
    let frame = canvas.shapes.iter().find_map(|shape| match shape {
        crate::canvas::Shape::Clip(Some(area)) => Some(*area),
        _ => None,
    });
    let [left, top, side, _] = frame.unwrap();
    let cell = side / 20.0;
    let pixel = |x: f64, y: f64| -> [u8; 3] {
        let at = [left + (x + 0.5) * cell, top + (19.5 - y) * cell].map(|units| (units * 2.0) as usize);
        let from = (at[1] * width as usize + at[0]) * 3;
        bytes[from..from + 3].try_into().unwrap()
    };
    assert!(pixel(0.0, 19.0).iter().all(|value| *value < 90), "the wall in the north-west");
    assert_eq!(pixel(0.0, 0.0), [255; 3]);
    assert_eq!(pixel(9.0, 4.0), PALETTE[0].rgb, "on the path");
    assert_eq!(pixel(9.0, 15.0), [255; 3], "its mirror image");
}

#[test]
fn only_the_used_part_of_a_large_map_is_shown() {
    let text = |side: u16| format!("{:?}", trajectories::draw("r", &land(side), &[], &history(2, 20, 1.0, 1.0), &[]));
    assert!(text(300).contains("part of a map of 300 × 300"));
    assert!(!text(30).contains("part of"));
}

#[test]
fn large_swarms_and_noisy_terrain_give_small_files() {
    let plan = LandPlan { width: 256, height: 256, classes: 9, seed: 5 };
    let terrain = uniform(&plan).unwrap();
    for robots in [6, 200, 201, 2000, 100_000] {
        let dir = tempfile::tempdir().unwrap();
        let history = history(robots, 12, 3.0, f64::NAN);
        for path in on_map("r", &terrain, &[], &history, &[(1, 2)], dir.path()).unwrap() {
            let bytes = std::fs::metadata(&path).unwrap().len();
            assert!(bytes < 2_000_000, "{robots} robots: {} {bytes}", path.display());
        }
    }
}

#[test]
fn long_paths_give_small_files() {
    let mut recorder = Recorder::in_memory(Options::default());
    for now in 0..400 {
        let rows = (1..=200).map(|id| {
            let mut rng = Rng::keyed(1, 2, id, now);
            let mut near = |centre: u32| f64::from(centre + rng.below(40));
            row(id, [near(id), near(200 - id)], Cell { x: 9, y: 9 })
        });
        recorder.tick(&tick(now, 1.0), rows).unwrap();
    }
    let history = recorder.finish().unwrap();
    let dir = tempfile::tempdir().unwrap();
    let files = on_map("r", &land(256), &[], &history, &[], dir.path()).unwrap();
    assert_readable(&files);
    assert!(std::fs::metadata(&files[0]).unwrap().len() < 5_000_000);
}
