use super::{assert_readable, assert_texts_apart, decode};
use crate::canvas::{Canvas, Shape};
use crate::colour;
use crate::flock::{Body, MOST_DISCS, Sheet, Snapshot, marks};
use staya_sim::world::plane::Solid;

fn ring(robots: u32, radius_m: f64) -> Snapshot {
    let angle = |robot: u32| f64::from(robot) / f64::from(robots) * std::f64::consts::TAU;
    let body = |(sin, cos): (f64, f64)| Body {
        position_m: [20.0 * cos, 20.0 * sin, 0.0],
        velocity_mps: [-sin, cos, 0.0],
        radius_m,
        ..Body::default()
    };
    let bodies = (0..robots).map(|robot| body(libm::sincos(angle(robot)))).collect();
    Snapshot { title: format!("{robots} robots"), bodies, ..Snapshot::default() }
}

fn everything(is_space: bool) -> Snapshot {
    let ball = |center_m: [f64; 3], radius_m| Solid::Ball { center_m, radius_m };
    let mut all = Snapshot {
        edges: vec![[0, 1], [1, 2], [2, 99]],
        solids: vec![
            ball([0.0; 3], 5.0),
            Solid::Wall([[30.0, -20.0], [30.0, 20.0]]),
            Solid::Plane { point_m: [0.0; 3], normal: [0.0, 0.0, 1.0] },
        ]
        .into(),
        goals: vec![([25.0, 25.0, 0.0], colour::nth(1))],
        trails: vec![(vec![[20.0, 0.0, 0.0], [25.0, -5.0, 0.0], [28.0, -12.0, 0.0]], colour::nth(0))],
        is_space,
        downwash: 3.0,
        ..ring(12, 1.0)
    };
    for (body, height) in all.bodies.iter_mut().zip(0_u32..) {
        body.position_m[2] = if is_space { f64::from(height) } else { 0.0 };
    }
    all
}

fn circles(canvas: &Canvas) -> Vec<([f64; 2], f64)> {
    let circle = |shape: &Shape| match shape {
        Shape::Circle { centre, radius, .. } => Some((*centre, *radius)),
        _ => None,
    };
    canvas.shapes.iter().filter_map(circle).collect()
}

fn columns(canvas: &Canvas) -> usize {
    let is_air = |shape: &&Shape| matches!(shape, Shape::Path { fill: Some(fill), .. } if fill.alpha == marks::AIR);
    canvas.shapes.iter().filter(is_air).count()
}

#[test]
fn full_and_empty_snapshots_are_readable() {
    let dir = tempfile::tempdir().unwrap();
    let cases = [
        everything(false),
        everything(true),
        Snapshot::default(),
        Snapshot { is_space: true, ..Snapshot::default() },
        ring(1, 0.2),
        ring(200, 0.01),
        ring(MOST_DISCS as u32 + 1, 1.0),
        Snapshot { is_space: true, ..ring(MOST_DISCS as u32 + 1, 1.0) },
        Snapshot { size: [f64::NAN, 10.0], ..everything(false) },
        Snapshot { size: [f64::NAN, 10.0], ..everything(true) },
    ];
    for (index, snapshot) in cases.iter().enumerate() {
        let canvas = snapshot.draw();
        assert_texts_apart(&canvas);
        assert_readable(&canvas.write(&dir.path().join(index.to_string())).unwrap());
    }
    let keys = vec![("group 1".to_owned(), colour::nth(1))];
    let sheet = cases.into_iter().fold(Sheet::new("All", 2).with_legend(keys), Sheet::with).draw();
    assert_texts_apart(&sheet);
    assert_readable(&sheet.write(&dir.path().join("sheet")).unwrap());
    assert_texts_apart(&Sheet::new("", 0).draw());
}

#[test]
fn from_above_both_axes_have_one_scale_and_north_is_up() {
    let body = |x, y| Body { position_m: [x, y, 9.0], radius_m: 3.0, ..Body::default() };
    let snapshot = Snapshot { bodies: vec![body(0.0, 0.0), body(100.0, 0.0), body(0.0, 10.0)], ..Snapshot::default() };
    let circles = circles(&snapshot.draw());
    let [(a, radius), (b, _), (c, _)] = circles[..] else {
        panic!("{circles:?}");
    };
    let scale = radius / 3.0;
    assert!((b[0] - a[0] - 100.0 * scale).abs() < 1e-9 && (b[1] - a[1]).abs() < 1e-9);
    assert!((a[1] - c[1] - 10.0 * scale).abs() < 1e-9 && (c[0] - a[0]).abs() < 1e-9);
}

#[test]
fn in_space_far_bodies_are_smaller_and_behind_near_ones_and_heights_show() {
    let body = |x, y, z| Body { position_m: [x, y, z], radius_m: 2.0, ..Body::default() };
    let bodies = vec![body(0.0, -20.0, 0.0), body(0.0, 20.0, 0.0), body(0.0, -20.0, 9.0)];
    let flyers = Snapshot { bodies, is_space: true, downwash: 3.0, ..Snapshot::default() };
    let canvas = flyers.draw();
    let [far, near, high] = circles(&canvas)[..] else { panic!("three") };
    assert!(far.1 < near.1 && far.0[1] < near.0[1], "north is far away and above: {far:?} {near:?}");
    assert!(high.0[1] < near.0[1] - 20.0, "height shows: {high:?} {near:?}");
    assert_eq!(columns(&canvas), 3);
    assert_eq!(columns(&Snapshot { downwash: 1.0, ..flyers.clone() }.draw()), 0);
    let flat = Snapshot { is_space: false, ..flyers }.draw();
    let [a, _, b] = circles(&flat)[..] else { panic!("three") };
    assert_eq!((a, columns(&flat)), (b, 0), "from above heights do not show");
}

#[test]
fn moving_robots_have_arrows_and_pairs_have_edges() {
    let body = |x, velocity_mps| Body { position_m: [x, 0.0, 0.0], velocity_mps, radius_m: 1.0, ..Body::default() };
    let bodies = vec![body(0.0, [1.0, 0.0, 0.0]), body(10.0, [0.0; 3]), body(40.0, [f64::NAN, 1.0, 0.0])];
    let lines = |snapshot: Snapshot| {
        let open = |shape: &Shape| match shape {
            Shape::Path { lines, closed: false, .. } => Some(lines.len()),
            _ => None,
        };
        snapshot.draw().shapes.iter().filter_map(open).collect::<Vec<_>>()
    };
    let three = Snapshot { bodies, edges: vec![[0, 1]], ..Snapshot::default() };
    assert_eq!(lines(three.clone())[1..], [1, 1, 2], "an edge with its margin, and an arrow");
    let still = three.bodies.iter().map(|body| Body { velocity_mps: [0.0; 3], ..*body }).collect();
    assert_eq!(lines(Snapshot { bodies: still, edges: vec![], ..three }).len(), 1);
}

#[test]
fn large_swarms_need_few_shapes() {
    let crowd = ring(MOST_DISCS as u32 + 1, 5.0).draw();
    assert!(circles(&crowd).is_empty() && crowd.shapes.len() < 60);
    assert_eq!(circles(&ring(20, 5.0).draw()).len(), 20);
    let goals = |count: u32| (0..count).map(|at| ([f64::from(at), 0.0, 0.0], colour::nth(0))).collect();
    let with = |count| Snapshot { goals: goals(count), ..ring(1, 1.0) }.draw().shapes.len();
    assert!(with(1000) < with(100), "many goals are dots");
}

#[test]
fn invalid_items_are_skipped_and_a_chosen_range_is_kept() {
    let mut wild = everything(false);
    for place in [[f64::NAN, 0.0, 0.0], [f64::INFINITY, 0.0, 0.0]] {
        wild.bodies.push(Body { position_m: place, ..Body::default() });
    }
    wild.goals.push(([0.0, f64::NEG_INFINITY, 0.0], colour::nth(0)));
    wild.trails.push((vec![[f64::NAN; 3], [0.0; 3], [1.0; 3]], colour::nth(0)));
    let nowhere = Solid::Ball { center_m: [f64::NAN; 3], radius_m: 2.0 };
    wild.solids = wild.solids.iter().copied().chain([nowhere]).collect();
    assert_eq!(circles(&wild.draw()), circles(&everything(false).draw()));
    let of = |snapshot: Snapshot, low, high| Snapshot { span_m: Some([[low; 3], [high; 3]]), ..snapshot };
    let near = of(ring(12, 1.0), -50.0, 50.0);
    let far = of(Snapshot { goals: vec![([900.0, 0.0, 0.0], colour::nth(0))], ..ring(12, 1.0) }, -50.0, 50.0);
    assert_eq!(circles(&near.draw()), circles(&far.draw()));
    let senseless = of(ring(12, 1.0), 5.0, f64::NAN);
    assert_eq!(circles(&senseless.draw()), circles(&ring(12, 1.0).draw()));
}

#[test]
fn equal_snapshots_give_equal_bytes() {
    let dir = tempfile::tempdir().unwrap();
    let write = |name: &str| everything(true).draw().write(&dir.path().join(name)).unwrap();
    let (one, two) = (write("one"), write("two"));
    for (a, b) in one.iter().zip(&two) {
        assert_eq!(std::fs::read(a).unwrap(), std::fs::read(b).unwrap());
    }
    let (_, _, bytes) = decode(&one[1]);
    let is_coloured = |pixel: &[u8]| pixel[0].abs_diff(pixel[2]) > 60;
    assert!(bytes.chunks(3).filter(|pixel| is_coloured(pixel)).count() > 500);
}
