use super::{assert_readable, assert_texts_apart, decode};
use crate::canvas::{Canvas, Shape};
use crate::flock::{MOST_DISCS, Obstacle, Sheet, Snapshot, View};

fn ring(robots: u32, radius_m: f64) -> Snapshot {
    let angle = |robot: u32| f64::from(robot) / f64::from(robots) * std::f64::consts::TAU;
    let around = |robot| libm::sincos(angle(robot));
    Snapshot {
        title: format!("{robots} robots"),
        positions_m: (0..robots).map(around).map(|(sin, cos)| [20.0 * cos, 20.0 * sin]).collect(),
        velocities_mps: (0..robots).map(around).map(|(sin, cos)| [-sin, cos]).collect(),
        radius_m,
        ..Snapshot::default()
    }
}

fn everything() -> Snapshot {
    Snapshot {
        edges_within_m: Some(12.0),
        groups: vec![0, 1, 2],
        obstacles: vec![
            Obstacle::Disc { centre_m: [0.0, 0.0], radius_m: 5.0 },
            Obstacle::Polygon(vec![[-30.0, -30.0], [-25.0, -30.0], [-25.0, -22.0]]),
            Obstacle::Segment([[30.0, -20.0], [30.0, 20.0]]),
        ],
        goals_m: vec![[25.0, 25.0]],
        trails_m: vec![vec![[20.0, 0.0], [25.0, -5.0], [28.0, -12.0]]],
        ..ring(12, 1.0)
    }
}

fn circles(canvas: &Canvas) -> Vec<([f64; 2], f64)> {
    let circle = |shape: &Shape| match shape {
        Shape::Circle { centre, radius, .. } => Some((*centre, *radius)),
        _ => None,
    };
    canvas.shapes.iter().filter_map(circle).collect()
}

fn lines(canvas: &Canvas) -> Vec<usize> {
    let open = |shape: &Shape| match shape {
        Shape::Path { lines, closed: false, .. } => Some(lines.len()),
        _ => None,
    };
    canvas.shapes.iter().filter_map(open).collect()
}

#[test]
fn full_and_empty_snapshots_are_readable() {
    let dir = tempfile::tempdir().unwrap();
    let cases = [
        everything(),
        Snapshot::default(),
        ring(1, 0.2),
        ring(200, 0.01),
        ring(MOST_DISCS as u32 + 1, 1.0),
        Snapshot { size: [f64::NAN, 10.0], ..everything() },
    ];
    for (index, snapshot) in cases.iter().enumerate() {
        let canvas = snapshot.draw();
        assert_texts_apart(&canvas);
        assert_readable(&canvas.write(&dir.path().join(index.to_string())).unwrap());
    }
    let sheet = cases.into_iter().fold(Sheet::new("All", 2), Sheet::with).draw();
    assert_texts_apart(&sheet);
    assert_readable(&sheet.write(&dir.path().join("sheet")).unwrap());
    assert_texts_apart(&Sheet::new("", 0).draw());
}

#[test]
fn both_axes_have_one_scale_and_north_is_up() {
    let snapshot =
        Snapshot { positions_m: vec![[0.0, 0.0], [100.0, 0.0], [0.0, 10.0]], radius_m: 3.0, ..Snapshot::default() };
    let circles = circles(&snapshot.draw());
    let [(a, radius), (b, _), (c, _)] = circles[..] else {
        panic!("{circles:?}");
    };
    let scale = radius / 3.0;
    assert!((b[0] - a[0] - 100.0 * scale).abs() < 1e-9 && (b[1] - a[1]).abs() < 1e-9);
    assert!((a[1] - c[1] - 10.0 * scale).abs() < 1e-9 && (c[0] - a[0]).abs() < 1e-9);
}

#[test]
fn near_robots_have_edges_and_moving_robots_have_arrows() {
    let three = Snapshot {
        positions_m: vec![[0.0, 0.0], [10.0, 0.0], [40.0, 0.0]],
        velocities_mps: vec![[1.0, 0.0], [0.0; 2], [f64::NAN, 1.0]],
        radius_m: 1.0,
        edges_within_m: Some(10.0),
        ..Snapshot::default()
    };
    let plain = Snapshot { velocities_mps: Vec::new(), edges_within_m: None, ..three.clone() };
    assert_eq!(lines(&plain.draw()).len(), 1);
    assert_eq!(lines(&three.draw())[1..], [1, 2]);
}

#[test]
fn large_swarms_need_few_shapes() {
    let crowd = ring(MOST_DISCS as u32 + 1, 5.0).draw();
    assert!(circles(&crowd).is_empty() && crowd.shapes.len() < 60);
    assert_eq!(circles(&ring(20, 5.0).draw()).len(), 20);
}

#[test]
fn invalid_items_are_skipped_and_a_chosen_view_is_kept() {
    let mut wild = everything();
    wild.positions_m.push([f64::NAN, 0.0]);
    wild.positions_m.push([f64::INFINITY, 0.0]);
    wild.goals_m.push([0.0, f64::NEG_INFINITY]);
    wild.trails_m.push(vec![[f64::NAN; 2], [0.0; 2], [1.0; 2]]);
    let nowhere = Obstacle::Disc { centre_m: [f64::NAN; 2], radius_m: 2.0 };
    wild.obstacles.push(nowhere);
    assert_eq!(circles(&wild.draw()), circles(&everything().draw()));
    let view = |snapshot: Snapshot, view_m| Snapshot { view_m: Some(view_m), ..snapshot };
    let near = view(ring(12, 1.0), [[-50.0, 50.0]; 2]);
    let far = view(Snapshot { goals_m: vec![[900.0, 0.0]], ..ring(12, 1.0) }, [[-50.0, 50.0]; 2]);
    assert_eq!(circles(&near.draw()), circles(&far.draw()));
    let senseless = view(ring(12, 1.0), [[5.0, 5.0], [f64::NAN, 1.0]]);
    assert_eq!(circles(&senseless.draw()), circles(&ring(12, 1.0).draw()));
}

#[test]
fn equal_snapshots_give_equal_bytes() {
    let dir = tempfile::tempdir().unwrap();
    let write = |name: &str| everything().draw().write(&dir.path().join(name)).unwrap();
    let (one, two) = (write("one"), write("two"));
    for (a, b) in one.iter().zip(&two) {
        assert_eq!(std::fs::read(a).unwrap(), std::fs::read(b).unwrap());
    }
    let (_, _, bytes) = decode(&one[1]);
    let is_coloured = |pixel: &[u8]| pixel[0].abs_diff(pixel[2]) > 60;
    assert!(bytes.chunks(3).filter(|pixel| is_coloured(pixel)).count() > 500);
}

#[test]
fn views_project_space() {
    let at = [3.0, 4.0, 5.0];
    assert_eq!(View::Plan.of(at), [3.0, 4.0]);
    assert_eq!(View::Elevation.of(at), [3.0, 5.0]);
    let [x, up] = View::Oblique.of(at);
    let north = 2.0_f64.sqrt();
    assert!((x - 3.0 - north).abs() < 1e-12 && (up - 5.0 - north).abs() < 1e-12);
    assert!(View::Elevation.labels()[1].starts_with('z'));
}
