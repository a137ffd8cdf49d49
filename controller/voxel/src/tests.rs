use crate::*;
use proptest::prelude::*;
use staya_controller::geom::Vec2;
use staya_controller::obstacle::Obstacle;
use staya_controller::orca::{HalfSpaces as _, MovingBall, Params, half_plane};
use staya_controller::scalar::{Q16, Scalar};
use std::string::ToString as _;
use std::vec::Vec;

/// The same plane in each node: a linear function with the value 0 in the first node.
fn linear(variables: u8, depth: u8, nodes: [u16; 3], slopes: [f64; 3]) -> Vec<u8> {
    let axes = usize::from(variables);
    let mut step = [0.0; 3];
    step[..axes].fill(0.5);
    let header = Header { variables, depth, nodes, first: [0.0; 3], step, unit: 2.0 };
    let mut bytes = header.to_bytes().to_vec();
    let whole = f64::from((1_i32 << (depth - 1)) - 1);
    for node in 0..header.count() {
        let mut rest = node;
        let (mut value, mut components) = (0.0, Vec::new());
        for axis in 0..axes {
            let along = usize::from(nodes[axis]);
            value += slopes[axis] * 0.5 * (rest % along) as f64;
            rest /= along;
            components.push(slopes[axis] * 0.25 * (along - 1) as f64 / 2.0);
        }
        components.extend([-1.0, -value / 2.0]);
        let length = components.iter().map(|c| c * c).sum::<f64>().sqrt();
        for component in components {
            let level = libm_round(component / length * whole);
            bytes.extend_from_slice(&level.to_le_bytes()[..header.component_len()]);
        }
    }
    seal(&mut bytes);
    bytes
}

fn libm_round(x: f64) -> i16 {
    (x + 0.5_f64.copysign(x)) as i16
}

fn seal(bytes: &mut [u8]) {
    let sum = checksum(bytes).to_le_bytes();
    bytes[44..48].copy_from_slice(&sum);
}

fn plane(depth: u8) -> Vec<u8> {
    linear(2, depth, [5, 3, 1], [1.0, -0.5, 0.0])
}

#[test]
fn a_linear_function_is_exact_to_its_depth_up_to_the_edge_and_undefined_beyond() {
    for (depth, most) in [(8, 0.05), (12, 0.003), (16, 0.0002)] {
        let bytes = plane(depth);
        let model = Model::<f64, 2>::from_bytes(&bytes).unwrap();
        assert_eq!(model.extent(), [[0.0, 2.0], [0.0, 1.0]]);
        for at in [[0.0, 0.0], [2.0, 1.0], [2.0, 0.0], [0.0, 1.0], [0.25, 0.25], [1.0, 0.5], [1.999, 0.751]] {
            for found in [model.nearest(at), model.blend(at)] {
                let found = found.unwrap();
                assert!((found.value - (at[0] - 0.5 * at[1])).abs() < most, "{at:?} {found:?}");
                assert!((found.gradient[0] - 1.0).abs() < most && (found.gradient[1] + 0.5).abs() < most);
            }
        }
        for at in [[-1e-9, 0.5], [2.000001, 0.5], [1.0, -0.1], [1.0, 1.1], [f64::NAN, 0.5], [1.0, f64::INFINITY]] {
            assert_eq!((model.nearest(at), model.blend(at)), (None, None), "{at:?}");
        }
    }
}

#[test]
fn three_variables_are_exact_in_each_corner() {
    let bytes = linear(3, 16, [2, 3, 4], [0.5, 1.0, -0.25]);
    let model = Model::<f64, 3>::from_bytes(&bytes).unwrap();
    for corner in 0..8 {
        let at = core::array::from_fn(|axis| if corner >> axis & 1 == 1 { model.extent()[axis][1] } else { 0.0 });
        let [x, y, z] = at;
        for found in [model.nearest(at), model.blend(at)] {
            assert!((found.unwrap().value - (0.5 * x + y - 0.25 * z)).abs() < 2e-4);
        }
    }
    assert!(model.node([1, 2, 3]).is_some());
    assert_eq!((model.node([2, 0, 0]), model.node([0, 3, 0])), (None, None));
}

#[test]
fn invalid_models_return_their_error() {
    let whole = plane(16);
    let refused = |change: &dyn Fn(&mut Vec<u8>)| {
        let mut bytes = whole.clone();
        change(&mut bytes);
        Model::<f32, 2>::from_bytes(&bytes).unwrap_err()
    };
    let field = |at: usize, value: &[u8]| {
        refused(&|bytes| {
            bytes[at..at + value.len()].copy_from_slice(value);
            seal(bytes);
        })
    };
    assert_eq!(refused(&|bytes| bytes.truncate(3)), FileError::Length { needed: 48, found: 3 });
    assert_eq!(refused(&|bytes| bytes.clear()), FileError::Length { needed: 48, found: 0 });
    assert_eq!(refused(&|bytes| bytes.truncate(47)), FileError::Length { needed: 48, found: 47 });
    assert_eq!(refused(&|bytes| bytes.truncate(100)), FileError::Length { needed: 168, found: 100 });
    assert_eq!(refused(&|bytes| bytes.push(0)), FileError::Length { needed: 168, found: 169 });
    assert_eq!(field(0, b"PNG"), FileError::NotAModel);
    assert_eq!(field(4, &[9, 0]), FileError::Version(9));
    assert_eq!(field(6, &[4]), FileError::Field(6));
    assert_eq!(field(7, &[17]), FileError::Field(7));
    assert_eq!(field(8, &[1, 0]), FileError::Field(8));
    assert_eq!(field(12, &[2, 0]), FileError::Field(12));
    assert_eq!(field(20, &f32::NAN.to_le_bytes()), FileError::Field(20));
    assert_eq!(field(28, &(-1.0_f32).to_le_bytes()), FileError::Field(28));
    assert_eq!(field(40, &[0; 4]), FileError::Field(40));
    assert!(matches!(refused(&|bytes| bytes[100] ^= 1), FileError::Checksum { .. }));
    let space = linear(3, 16, [2; 3], [1.0; 3]);
    let wrong = Model::<f32, 2>::from_bytes(&space).unwrap_err();
    assert_eq!(wrong, FileError::Variables { needed: 2, found: 3 });
    for error in [wrong, FileError::NotAModel, FileError::Version(9), FileError::Field(20)] {
        assert!(error.to_string().len() > 30, "{error}");
    }
}

#[test]
fn a_level_function_has_no_direction_and_no_distance() {
    let bytes = linear(2, 16, [2, 2, 1], [0.0; 3]);
    let model = Model::<f32, 2>::from_bytes(&bytes).unwrap();
    let found = model.blend([0.2, 0.2]).unwrap();
    assert_eq!((found.value, found.direction(), found.distance()), (0.0, None, None));
    assert_eq!(velocity_half_plane(&model, Vec2::ZERO, Vec2::new(0.2, 0.2), 0.5), None);
    assert_eq!(obstacles(&model, Vec2::new(0.2, 0.2), 0.1), None);
}

#[test]
fn a_straight_wall_is_one_plane() {
    // Positive to the east of x = 0: 0.3 m inside the wall.
    let bytes = linear(2, 16, [5, 3, 1], [1.0, 0.0, 0.0]);
    let model = Model::<f32, 2>::from_bytes(&bytes).unwrap();
    let found = obstacles(&model, Vec2::new(0.3, 0.5), 0.1).unwrap();
    let [Obstacle::Plane { normal, distance_m }] = found[..] else { panic!("{found:?}") };
    assert!((normal.x + 1.0).abs() < 1e-3 && normal.y.abs() < 1e-3 && (distance_m + 0.3).abs() < 1e-3);
    assert_eq!(obstacles(&model, Vec2::new(-0.1, 0.5), 0.1), None);
}

#[test]
fn overlapping_neighbors_and_invalid_input_use_the_formula() {
    let bytes = linear(3, 16, [3; 3], [1.0, 1.0, 1.0]);
    let source = VoxelNeighbor::new(Model::<f64, 3>::from_bytes(&bytes).unwrap());
    let params = Params { horizon_s: 2.0, separation_s: 0.05, share: 0.5 };
    for (x, radii_m) in [(0.5, 1.0), (1.0, 1.0), (0.0, 1.0), (f64::NAN, 1.0), (3.0, f64::NAN), (3.0, -1.0)] {
        let ball =
            MovingBall { offset_m: Vec2::new(x, 0.0), velocity_mps: Vec2::new(0.1, 0.2), radii_m, tie: Vec2::ZERO };
        let own = Vec2::new(0.3, 0.1);
        assert_eq!(source.half_space(own, &ball, &params), half_plane(own, &ball, &params), "{x} {radii_m}");
    }
}

proptest! {
    #[test]
    fn damaged_bytes_never_panic(mut bytes in prop::collection::vec(any::<u8>(), 0..400), is_sealed: bool) {
        let whole = plane(8);
        let length = bytes.len().min(40);
        if is_sealed && bytes.len() > 48 {
            bytes[..length].copy_from_slice(&whole[..length]);
            bytes[40..44].copy_from_slice(&whole[40..44]);
            bytes.resize(whole.len(), 0);
            seal(&mut bytes);
        }
        if let Ok(model) = Model::<f32, 2>::from_bytes(&bytes) {
            let _ = (model.nearest([0.3, 0.4]), model.blend([0.3, 0.4]));
            let _ = obstacles(&model, Vec2::new(0.3, 0.4), 0.2);
        }
    }

    #[test]
    fn a_flipped_bit_is_detected(at in 0_usize..168, bit in 0..8) {
        let mut bytes = plane(16);
        bytes[at] ^= 1_u8 << bit;
        prop_assert!(Model::<f32, 2>::from_bytes(&bytes).is_err());
    }

    #[test]
    fn single_precision_and_fixed_point_agree_with_double(x in 0.0_f64..2.0, y in 0.0_f64..1.0) {
        fn value<S: Scalar>(bytes: &[u8], at: [f64; 2]) -> f64 {
            let model = Model::<S, 2>::from_bytes(bytes).unwrap();
            let at = at.map(|x| S::from_f64(x).unwrap());
            model.blend(at).unwrap().value.to_f64()
        }
        let bytes = plane(16);
        let exact = value::<f64>(&bytes, [x, y]);
        prop_assert!((value::<f32>(&bytes, [x, y]) - exact).abs() < 1e-5);
        prop_assert!((value::<Q16>(&bytes, [x, y]) - exact).abs() < 1e-3);
    }
}
