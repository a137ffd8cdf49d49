use crate::draw::{m_images, sheet};
use crate::swarm::{Crowd, Source, Swap};
use crate::*;
use proptest::prelude::*;
use staya_controller::geom::{Vec2, Vec3};
use staya_controller::orca::{
    HalfPlane, HalfSpaces as _, InSpace, MovingBall, Params, VelocityObstacle, half_plane, half_space,
};
use staya_controller::rand::Rng;
use staya_controller::scalar::Q16;
use staya_voxel::{Header, Model, VoxelInSpace, VoxelNeighbor, obstacles, velocity_half_plane};
use std::path::Path;

type V = Vec2<f64>;

const PAIR: Pair = Pair { places_m: [[2.0, -3.0], [-2.0, 3.0]], radii_m: [1.0, 1.0], horizon_s: 2.0 };

fn plane(template: &Template, nodes: [u16; 2], depth: u8) -> Vec<u8> {
    let Templated::Plane(function, extent) = template.function().unwrap() else { panic!("of three variables") };
    build(&function, &Grid { extent, nodes }, depth).unwrap()
}

fn space(template: &Template, nodes: [u16; 3], depth: u8) -> Vec<u8> {
    let Templated::Space(function, extent) = template.function().unwrap() else { panic!("of two variables") };
    build(&function, &Grid { extent, nodes }, depth).unwrap()
}

proptest! {
    /// The sign equals the Boolean operation even where rounding could change it.
    #[test]
    fn signs_of_r_functions_are_boolean(x in -1e3_f64..1e3, y in -1e3_f64..1e3, tiny in -1e-12_f64..1e-12, alpha in -0.99_f64..1.0) {
        for system in [System::R0, System::R1, System::Alpha(alpha)] {
            for (x, y) in [(x, y), (x, tiny), (tiny, y), (x, x), (x, -x)] {
                prop_assert_eq!(system.and(x, y) > 0.0, x > 0.0 && y > 0.0, "{} {} {}", system, x, y);
                prop_assert_eq!(system.or(x, y) > 0.0, x > 0.0 || y > 0.0, "{} {} {}", system, x, y);
                prop_assert_eq!(-system.and(x, y), system.or(-x, -y));
                prop_assert_eq!(system.and(x, y), system.and(y, x));
            }
        }
    }

    #[test]
    fn r_alpha_goes_from_r_0_to_r_1(x in -9.0_f64..9.0, y in -9.0_f64..9.0) {
        prop_assert!((System::Alpha(1.0).and(x, y) - System::R1.and(x, y)).abs() < 1e-9);
        prop_assert!((System::Alpha(0.0).or(x, y) - System::R0.or(x, y)).abs() < 1e-9);
        prop_assert!((System::R0.and(x, y) - (x + y - libm::hypot(x, y))).abs() < 1e-9);
        prop_assert_eq!(System::R1.or(x, y), if x > y { x } else { y });
    }

    #[test]
    fn velocity_obstacle_agrees_with_the_controllers_formula(seed: u64) {
        let mut rng = Rng::new(seed);
        let mut number = |low: f64, high: f64| low + (high - low) * f64::from(rng.next_u32()) / f64::from(u32::MAX);
        let (x, y, sine) = (number(-2.0, 2.0), number(0.0, 2.0), number(0.01, 0.99));
        // With radii and horizon of 1 the disc has radius 1; its centre is as far as the neighbour.
        let offset = V::new(1.0 / sine, 0.0);
        let leg = [sine, libm::sqrt(1.0 - sine * sine)];
        let exact = VelocityObstacle::new(offset, 1.0, 1.0).unwrap().value(offset + V::new(x, y));
        let found = template::velocity_obstacle(VelocityForm::RFunction(System::R1), x, y, leg);
        prop_assert!((found - exact).abs() < 1e-9, "{found} {exact}");
        let ball = MovingBall { offset_m: offset, velocity_mps: V::ZERO, radii_m: 1.0, tie: V::ZERO };
        let params = Params { horizon_s: 1.0, separation_s: 1.0, share: 1.0 };
        let own = offset + V::new(x, y);
        let change = half_plane(own, &ball, &params).unwrap().penetration(own);
        let found = template::velocity_obstacle(VelocityForm::Distance, x, y, leg);
        prop_assert!((found - change).abs() < 1e-9, "{found} {change}");
    }

    /// Holds for coarse models, few bits and other gradients; both robots get opposite half-planes.
    #[test]
    fn every_half_plane_of_a_neighbor_model_forbids_the_whole_obstacle(seed: u64) {
        for (form, nodes, depth) in [
            (VelocityForm::Distance, [17, 9, 5], 16),
            (VelocityForm::Distance, [5, 3, 2], 6),
            (VelocityForm::RFunction(System::R0), [9, 5, 3], 8),
        ] {
            let bytes = space(&Template::Neighbor(form), nodes, depth);
            let source = VoxelNeighbor::new(Model::<f64, 3>::from_bytes(&bytes).unwrap());
            let (own, other) = pair(&mut Rng::new(seed));
            let params = Params { horizon_s: 2.0, separation_s: 0.05, share: 1.0 };
            let plane = source.half_space(own, &other, &params).unwrap();
            prop_assert!((plane.normal.norm() - 1.0).abs() < 1e-9);
            let obstacle = VelocityObstacle::new(other.offset_m, other.radii_m, 2.0).unwrap();
            let (tip, radius) = obstacle.disc();
            let gap = (plane.point - other.velocity_mps - tip).dot(plane.normal) - radius;
            prop_assert!(gap.abs() < 1e-9, "{gap}");
            for leg in obstacle.legs() {
                prop_assert!(leg.dot(plane.normal) < 1e-9, "{}", leg.dot(plane.normal));
            }
            let exact = half_plane(own, &other, &params).unwrap().penetration(own);
            prop_assert!(plane.penetration(own) >= exact - 1e-9);
            let theirs = MovingBall { offset_m: -other.offset_m, velocity_mps: own, ..other };
            let theirs = source.half_space(other.velocity_mps, &theirs, &params).unwrap();
            prop_assert!((plane.normal + theirs.normal).norm() < 1e-9);
        }
    }
}

proptest! {
    /// In space as in the plane: safe, opposite for the two robots, equal to those of the plane if
    /// nothing is above or below, and scaled with downwash.
    #[test]
    fn every_half_space_of_a_neighbor_model_forbids_the_whole_obstacle(seed: u64) {
        let mut rng = Rng::new(seed);
        let (own, other) = pair(&mut rng);
        let mut rise = || f64::from(rng.next_u32()) / f64::from(u32::MAX) - 0.5;
        let lifted = |v: V, z: f64| Vec3::new(v.x, v.y, z);
        let ball = MovingBall {
            offset_m: lifted(other.offset_m, 3.0 * rise()),
            velocity_mps: lifted(other.velocity_mps, 3.0 * rise()),
            radii_m: other.radii_m,
            tie: Vec3::new(1.0, 0.0, 0.0),
        };
        let own_mps = lifted(own, 3.0 * rise());
        let params = Params { horizon_s: 2.0, separation_s: 0.05, share: 1.0 };
        for (nodes, depth) in [([17, 9, 5], 16), ([5, 3, 2], 6)] {
            let bytes = space(&Template::Neighbor(VelocityForm::Distance), nodes, depth);
            let neighbor = VoxelNeighbor::new(Model::<f64, 3>::from_bytes(&bytes).unwrap());
            let exact = half_space(own_mps, &ball, &params).unwrap();
            let found = neighbor.of_ball(own_mps, &ball, &params).unwrap();
            prop_assert!((found.normal.norm() - 1.0).abs() < 1e-9);
            prop_assert!(found.penetration(own_mps) >= exact.penetration(own_mps) - 1e-9);
            // Both legs of the cone in the plane of the axis and the normal, and the disc.
            let (tip, radius) = (ball.offset_m * 0.5, ball.radii_m * 0.5);
            let gap = (found.point - ball.velocity_mps - tip).dot(found.normal) - radius;
            prop_assert!(gap.abs() < 1e-9, "{gap}");
            let (ahead, sine) = (ball.offset_m.normalized().unwrap(), ball.radii_m / ball.offset_m.norm());
            prop_assert!(found.normal.dot(ahead) < 1e-9 - sine.min(1.0), "{} {sine}", found.normal.dot(ahead));
            let theirs = MovingBall { offset_m: -ball.offset_m, velocity_mps: own_mps, ..ball };
            let theirs = neighbor.of_ball(ball.velocity_mps, &theirs, &params).unwrap();
            prop_assert!((found.normal + theirs.normal).norm() < 1e-9);
            let flat = MovingBall {
                offset_m: lifted(other.offset_m, 0.0),
                velocity_mps: lifted(other.velocity_mps, 0.0),
                ..ball
            };
            let (level, plane) =
                (neighbor.of_ball(lifted(own, 0.0), &flat, &params), neighbor.half_space(own, &other, &params));
            let (level, plane) = (level.unwrap(), plane.unwrap());
            prop_assert!((level.normal - lifted(plane.normal, 0.0)).norm() < 1e-9, "{level:?} {plane:?}");
            let low = |v: Vec3<f64>| Vec3::new(v.x, v.y, v.z / 3.0);
            let lowered =
                MovingBall { offset_m: low(ball.offset_m), velocity_mps: low(ball.velocity_mps), ..ball };
            let lowered = neighbor.of_ball(low(own_mps), &lowered, &params).unwrap();
            let tall = VoxelInSpace { neighbor, space: InSpace { downwash: 3.0 } };
            let tall = tall.half_space(own_mps, &ball, &params).unwrap();
            prop_assert!((low(tall.point) - lowered.point).norm() < 1e-9, "{tall:?} {lowered:?}");
        }
    }
}

fn pair(rng: &mut Rng) -> (V, MovingBall<V>) {
    let mut number = |low: f64, high: f64| low + (high - low) * f64::from(rng.next_u32()) / f64::from(u32::MAX);
    let radii_m = number(0.2, 1.0);
    let (distance, angle) = (number(radii_m + 1e-3, 5.0), number(0.0, std::f64::consts::TAU));
    let (sin, cos) = libm::sincos(angle);
    let own = V::new(number(-1.5, 1.5), number(-1.5, 1.5));
    let velocity_mps = V::new(number(-1.5, 1.5), number(-1.5, 1.5));
    (own, MovingBall { offset_m: V::new(cos, sin) * distance, velocity_mps, radii_m, tie: V::ZERO })
}

/// FVM: relative velocity (-1.5, 2.5), whole correction, half-plane through (1.707107, 0.792893).
#[test]
fn worked_example_of_the_paper() {
    let own = V::new(1.5, 1.0);
    let relative = V::new(-1.5, 2.5);
    let off = |plane: HalfPlane<f64>| (plane.point - V::new(1.707107, 0.792893)).norm();
    for form in [VelocityForm::Distance, VelocityForm::RFunction(System::R1)] {
        let bytes = plane(&Template::VelocityObstacle(PAIR, form), [65, 65], 16);
        let model = Model::<f64, 2>::from_bytes(&bytes).unwrap();
        let found = velocity_half_plane(&model, own, relative, 1.0).unwrap();
        assert!(off(found) < 0.007, "{form:?}: {}", off(found));
        let cos = model.blend([relative.x, relative.y]).unwrap().direction().unwrap().x;
        assert!((cos + std::f64::consts::FRAC_1_SQRT_2).abs() < 1e-3, "{cos}");
    }
    let bytes = space(&Template::Neighbor(VelocityForm::Distance), [33, 17, 9], 16);
    let source = VoxelNeighbor::new(Model::<f64, 3>::from_bytes(&bytes).unwrap());
    let other = MovingBall { offset_m: V::new(-4.0, 6.0), velocity_mps: V::new(3.0, -1.5), radii_m: 2.0, tie: V::ZERO };
    let params = Params { horizon_s: 2.0, separation_s: 0.05, share: 1.0 };
    let found = source.half_space(own, &other, &params).unwrap();
    assert!(off(found) < 0.02, "{}", off(found));
    assert!(found.penetration(own) >= 0.292893 - 1e-6);
}

/// For a smooth function, blended values and gradients converge with the square of the step,
/// gradients of the nearest node with the step. Finite differences are the reference.
#[test]
fn errors_fall_with_resolution_and_with_depth() {
    let smooth = Function::new(|[x, y]: [f64; 2]| libm::sin(2.0 * x) * libm::cos(y) + 0.3 * x);
    let errors = |nodes: u16, depth: u8, reading| {
        let grid = Grid { extent: [[-1.0, 2.0], [0.0, 3.0]], nodes: [nodes, nodes] };
        let bytes = build(&smooth, &grid, depth).unwrap();
        measure(&smooth, &Model::from_bytes(&bytes).unwrap(), reading, 4000, 1).unwrap()
    };
    for (reading, gradients) in [(Reading::Nearest, 1.8), (Reading::Blend, 3.4)] {
        let (coarse, fine) = (errors(13, 16, reading), errors(25, 16, reading));
        for (coarse, fine, least) in [
            (coarse.value.mean, fine.value.mean, 3.4),
            (coarse.value.max, fine.value.max, 3.0),
            (coarse.gradient.mean, fine.gradient.mean, gradients),
        ] {
            assert!(coarse / fine > least, "{reading:?}: {coarse} to {fine}");
        }
    }
    let rough = errors(97, 6, Reading::Blend);
    let fine = errors(97, 12, Reading::Blend);
    assert!(rough.gradient.mean > 3.0 * fine.gradient.mean && rough.value.mean > 3.0 * fine.value.mean);
}

#[test]
fn errors_name_the_point_where_a_function_cannot_be_modelled() {
    let grid = Grid { extent: [[-1.0, 1.0]; 2], nodes: [5, 5] };
    let refused = |function: &Function<2>, grid: &Grid<2>, depth| build(function, grid, depth).unwrap_err().to_string();
    let circle = shape::circle([0.0; 2], 1.0);
    assert!(refused(&circle, &grid, 3).contains("4 to 16"));
    assert!(refused(&circle, &Grid { nodes: [1, 5], ..grid }, 8).contains("axis 1"));
    assert!(refused(&circle, &Grid { extent: [[0.0, 1.0], [1.0, 1.0]], ..grid }, 8).contains("axis 2"));
    assert!(refused(&circle, &Grid { nodes: [60_000, 60_000], ..grid }, 8).contains("64 MiB"));
    assert!(refused(&circle, &Grid { extent: [[-3e38, 3e38], [0.0, 1.0]], ..grid }, 8).contains("axis 1"));
    assert!(refused(&circle, &Grid { extent: [[0.0, 1.0], [1e10, 1e10 + 1.0]], ..grid }, 8).contains("axis 2"));
    assert!(refused(&Function::new(|[x, _]: [f64; 2]| 1.0 / x), &grid, 8).contains("[0.0, -1.0]"));
    assert!(refused(&Function::new(|[x, _]: [f64; 2]| 1e39 * x), &grid, 8).contains("not finite in 32 bits at [-1.0"));
    let step = Function::new(|[x, _]: [f64; 2]| if x > 0.1 { 1.0 } else { 1e-9 });
    let steep = Grid { extent: [[-1e5, 1e5], [-1.0, 1.0]], nodes: [5, 20_001] };
    assert!(refused(&step, &Grid { nodes: [20_001, 2], ..steep }, 4).contains("too steep"));
}

#[test]
fn rooms_parse_and_errors_name_the_field() {
    let room = Room::read(
        "outline = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]]\n[[circle]]\ncenter = [1.0, 0.5]\nradius = 0.2",
        Path::new("room.toml"),
    )
    .unwrap();
    let function = room.function(System::R0);
    for (at, is_wall) in [([1.0, 0.5], true), ([1.5, 0.5], false), ([2.1, 0.5], true), ([0.5, -0.1], true)] {
        assert_eq!(function.value(at) > 0.0, is_wall, "{at:?}");
    }
    let refused = |text: &str| Room::read(text, Path::new("room.toml")).unwrap_err().to_string();
    assert!(
        refused("outline = [[0.0, 0.0], [1.0, 0.0]]")
            .contains("room.toml:1:11: outline: this is not a polygon; give three corners")
    );
    let square = "outline = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0]]\n";
    assert!(refused(&format!("{square}[[circle]]\ncenter = [0.0, 0.0]\nradius = 0.0")).contains("circle[0].radius"));
    assert!(refused(&format!("{square}[[polygon]]\ncorners = []")).contains("polygon[0].corners"));
    assert!(refused(&format!("{square}door = 1")).contains("room.toml:2:1: door: unknown field"));
}

#[test]
fn invalid_templates_are_refused() {
    for template in [
        Template::Circle([0.0; 2], 0.0),
        Template::Ball([f64::NAN; 3], 1.0),
        Template::Polygon(vec![[0.0; 2]; 3]),
        Template::VelocityObstacle(Pair { places_m: [[0.0; 2], [1.0, 0.0]], ..PAIR }, VelocityForm::Distance),
    ] {
        assert!(template.function().is_err(), "{template:?}");
    }
}

#[test]
fn obstacles_of_a_room_are_its_walls() {
    let room = Template::Room(Room::default(), System::R1);
    let bytes = plane(&room, [129, 100], 16);
    let model = Model::<f32, 2>::from_bytes(&bytes).unwrap();
    let around = |x, y| obstacles(&model, Vec2::new(x, y), 0.3).unwrap();
    let distance = |found: &staya_controller::obstacle::Obstacle<f32>| found.nearest_point().unwrap().1;
    let corner = around(-3.8, -2.7);
    assert_eq!(corner.len(), 2, "{corner:?}");
    assert!((distance(&corner[0]) - 0.2).abs() < 0.02 && (distance(&corner[1]) - 0.3).abs() < 0.02);
    let pillar = around(-0.8, 0.8);
    assert_eq!(pillar.len(), 1, "{pillar:?}");
    assert!((distance(&pillar[0]) - 0.2).abs() < 0.02);
    assert!(obstacles(&model, Vec2::new(9.0, 0.0), 0.3).is_none());
}

#[test]
fn models_and_formulas_give_similar_swarms() {
    let room = Room::default();
    let of_room = plane(&Template::Room(room.clone(), System::R1), [65, 50], 16);
    let of_neighbor = space(&Template::Neighbor(VelocityForm::Distance), [17, 9, 5], 16);
    let swap = Swap {
        crowd: Crowd { robots: 6, circle: 2.5, seed: 1, limit: 40.0 },
        room,
        room_model: &of_room,
        neighbor_model: &of_neighbor,
    };
    for (neighbors, walls) in [(Source::Formula, Source::Formula), (Source::Model, Source::Model)] {
        let outcome = swap.run(neighbors, walls).unwrap();
        assert_eq!((outcome.arrived, outcome.overlaps), (6, 0), "{outcome:?}");
        assert!(outcome.wall_gap_m > -0.01, "{outcome:?}");
    }
}

#[test]
fn pictures_contain_the_components() {
    let folder = tempfile::tempdir().unwrap();
    for (bytes, count) in [
        (plane(&Template::Circle([0.0; 2], 1.0), [9, 7], 8), 4),
        (space(&Template::Ball([0.0; 3], 1.0), [5, 4, 3], 12), 5),
    ] {
        let files = m_images(&bytes, &folder.path().join("model")).unwrap();
        assert_eq!(files.len(), count);
        let header = Header::read(&bytes).unwrap();
        let decoder = png::Decoder::new(std::io::BufReader::new(std::fs::File::open(&files[count - 2]).unwrap()));
        let mut reader = decoder.read_info().unwrap();
        assert_eq!(reader.info().width, u32::from(header.nodes[0]));
        let mut grey = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut grey).unwrap();
        assert!(grey.chunks(header.component_len()).all(|pixel| pixel[0] < 128));
        assert!(sheet(&bytes, "title", None).unwrap().shapes.len() > 8);
    }
    let ball = space(&Template::Ball([0.0; 3], 1.0), [5, 4, 3], 12);
    assert!(sheet(&ball, "title", Some(7.0)).unwrap_err().to_string().contains("third axis"));
}

#[test]
fn pictures_of_absurd_steps_are_small_or_refused() {
    let steps = [1.2e-38_f32, 1e-10, 1.0, 1e30, 3.4e38];
    let firsts = [0.0_f32, -1.0, 1e30, -3.4e38];
    let mut refusals = Vec::new();
    for number in 0..steps.len() * steps.len() * firsts.len() {
        let (x, rest) = (steps[number % 5], number / 5);
        let (y, first) = (steps[rest % 5], firsts[rest / 5]);
        let (nodes, first, step) = ([2, 3, 1], [first, 0.0, 0.0], [x, y, 0.0]);
        let header = Header { variables: 2, depth: 8, nodes, first, step, unit: 1.0 };
        let mut bytes = header.to_bytes().to_vec();
        bytes.resize(header.model_len(), 7);
        let sum = staya_voxel::checksum(&bytes).to_le_bytes();
        bytes[44..48].copy_from_slice(&sum);
        match sheet(&bytes, "title", None) {
            Ok(canvas) => assert!((1.0..2000.0).contains(&canvas.width) && (1.0..2000.0).contains(&canvas.height)),
            Err(error) => refusals.push(error.to_string()),
        }
    }
    let said = |text: &str| refusals.iter().any(|refusal| refusal.starts_with(text));
    assert!(said("axis 1 of the model goes from -1e0 to -1e0; build it again with different ends"), "{refusals:?}");
    assert!(said("axis 2 of the model goes from 0e0 to 1.797"), "{refusals:?}");
}

#[test]
fn models_work_in_fixed_point() {
    let bytes = plane(&Template::Circle([0.0; 2], 1.0), [33, 33], 16);
    let model = Model::<Q16, 2>::from_bytes(&bytes).unwrap();
    let number = |x: f64| <Q16 as staya_controller::scalar::Scalar>::from_f64(x).unwrap();
    let found = model.blend([number(0.6), number(0.0)]).unwrap();
    assert!((staya_controller::scalar::Scalar::to_f64(found.value) - 0.4).abs() < 2e-3);
}

/// `scenarios/swap-voxel.toml` and others use it.
#[test]
fn the_shipped_model_of_neighbors_is_that_of_17_nodes_and_8_bits() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/neighbor.fvm");
    let shipped = std::fs::read(path).unwrap();
    assert!(shipped == space(&Template::Neighbor(VelocityForm::Distance), [17, 9, 5], 8));
}
