use super::*;
use staya_controller::geom::Vec3;

const ABILITIES: Abilities =
    Abilities { max_speed_mps: 2.0, max_acceleration_mps2: f64::INFINITY, lag_s: 0.0, step_s: 0.5, tick_s: 0.5 };

fn disc(id: u32, x: f64, y: f64) -> Disc {
    Disc {
        id: RobotId(id),
        radius_m: 0.5,
        position_m: [x, y, 0.0],
        velocity_mps: [0.0; 3],
        target_mps: [0.0; 3],
        abilities: ABILITIES,
        downwash: 1.0,
    }
}

fn go(x: f32, y: f32) -> Command<f32> {
    Command::Velocity(Vec3::new(x, y, 0.0))
}

#[test]
fn a_body_follows_commands_within_its_speed_limit() {
    let mut plane = Plane::new(None, vec![], vec![disc(1, 0.0, 0.0)]);
    plane.advance(&[go(1.0, -0.5)], &[CommandAge::New; 4]);
    assert_eq!(plane.discs()[0].position_m, [0.5, -0.25, 0.0]);
    plane.advance(&[go(40.0, 0.0)], &[CommandAge::New; 4]);
    assert_eq!(plane.discs()[0].position_m, [1.5, -0.25, 0.0]);
    plane.advance(&[go(f32::NAN, 0.0)], &[CommandAge::New; 4]);
    plane.advance(&[Command::Hold], &[CommandAge::New; 4]);
    assert_eq!(plane.discs()[0].position_m, [1.5, -0.25, 0.0]);
}

#[test]
fn inertia_takes_time() {
    let slow = Abilities { max_acceleration_mps2: 1.0, ..ABILITIES };
    let slow_one = Disc { abilities: slow, ..disc(1, 0.0, 0.0) };
    let mut plane = Plane::new(None, vec![], vec![slow_one]);
    let mut speeds = Vec::new();
    for command in [go(2.0, 0.0), go(2.0, 0.0), Command::Hold, Command::Hold] {
        plane.advance(&[command], &[CommandAge::New; 4]);
        speeds.push(plane.discs()[0].velocity_mps[0]);
    }
    assert_eq!(speeds, [0.5, 1.0, 0.5, 0.0]);
}

#[test]
fn rough_land_slows_bodies_and_walls_count_as_intrusions() {
    let mut terrain = Terrain::flat(3, 1);
    terrain.cell_m = 10.0;
    terrain.set(Cell::new(1, 0), 4);
    terrain.set(Cell::new(2, 0), BLOCKED);
    let discs = vec![disc(1, 5.0, 5.0), disc(2, 15.0, 5.0), disc(3, -5.0, 5.0), disc(4, 25.0, 5.0)];
    let mut plane = Plane::new(Some(terrain), vec![], discs);
    let speeds: Vec<f64> = [5.0, 15.0, -5.0].map(|x| plane.max_speed_mps(0, [x, 5.0, 0.0])).into();
    assert_eq!(speeds, [2.0, 0.5, 2.0]);
    assert_eq!(plane.clearance().intrusions, 1);
    assert_eq!(plane.cell([15.0, 5.0, 3.0]), Some(Cell::new(1, 0)));
    assert_eq!([-0.1, 30.0, f64::NAN].map(|x| plane.cell([x, 5.0, 0.0])), [None; 3]);
    plane.advance(&[go(9.0, 0.0), go(9.0, 0.0), go(9.0, 0.0), go(0.0, 0.0)], &[CommandAge::New; 4]);
    let places: Vec<f64> = plane.discs().iter().map(|d| d.position_m[0]).collect();
    assert_eq!(places, [6.0, 15.25, -4.0, 25.0]);
}

#[test]
fn clearances_and_overlaps_are_between_surfaces() {
    let wall = Solid::Wall([[2.0, -5.0], [2.0, 5.0]]);
    let ball = Solid::Ball { center_m: [-3.0, 0.0, 0.0], radius_m: 1.0 };
    let floor = Solid::Plane { point_m: [0.0, 0.0, -8.0], normal: [0.0, 0.0, 1.0] };
    let discs = vec![disc(1, 0.0, 0.0), disc(2, 0.0, 1.25), disc(3, 0.0, -0.75), disc(4, 1.75, 9.0)];
    let mut plane = Plane::new(None, vec![wall, ball, floor], discs);
    let clearance = plane.clearance();
    assert_eq!(clearance.bodies_m, -0.25);
    assert_eq!(clearance.solids_m, 1.5);
    assert_eq!((clearance.overlaps, clearance.intrusions), (1, 0));
    let inside = Plane::new(None, vec![ball], vec![disc(1, -3.0, 0.0)]).clearance();
    assert_eq!((inside.solids_m, inside.intrusions), (-1.5, 1));
    let alone = Plane::new(None, vec![], vec![disc(1, 0.0, 0.0)]).clearance();
    assert_eq!((alone.bodies_m, alone.solids_m), (f64::INFINITY, f64::INFINITY));
}

#[test]
fn each_body_has_its_own_size_and_speed() {
    let large = Disc { radius_m: 2.0, ..disc(1, 0.0, 0.0) };
    let fast = Abilities { max_speed_mps: 8.0, ..ABILITIES };
    let quick = Disc { radius_m: 0.25, abilities: fast, ..disc(2, 2.5, 0.0) };
    let mut plane = Plane::new(None, vec![], vec![large, quick]);
    assert_eq!(plane.clearance().bodies_m, 0.25);
    plane.advance(&[go(40.0, 0.0), go(40.0, 0.0)], &[CommandAge::New; 4]);
    let places: Vec<f64> = plane.discs().iter().map(|disc| disc.position_m[0]).collect();
    assert_eq!(places, [1.0, 6.5]);
}

#[test]
fn intruders_pass_through_everything_and_are_counted_separately() {
    let intruder = Disc { velocity_mps: [-40.0, 0.0, 0.0], target_mps: [-40.0, 0.0, 0.0], ..disc(9, 21.0, 0.0) };
    let mut plane = Plane::new(None, vec![], vec![disc(1, 0.0, 0.0)]).with_intruders(vec![intruder]);
    assert_eq!(plane.clearance().intruders_m, 20.0);
    plane.advance(&[Command::Hold], &[CommandAge::New; 4]);
    let clearance = plane.clearance();
    assert_eq!((clearance.intruders_m, clearance.intruder_overlaps, clearance.overlaps), (0.0, 0, 0));
    let at = Disc { position_m: [0.75, 0.0, 0.0], ..intruder };
    let clearance = Plane::new(None, vec![], vec![disc(1, 0.0, 0.0)]).with_intruders(vec![at]).clearance();
    assert_eq!((clearance.intruders_m, clearance.intruder_overlaps, clearance.overlaps), (-0.25, 1, 0));
}

#[test]
fn downwash_is_below_a_body_and_not_beside_it() {
    let washed = |downwash: f64, x: f64, z: f64| {
        let one = Disc { downwash, ..disc(1, 0.0, 0.0) };
        let other = Disc { position_m: [x, 0.0, z], ..disc(2, 0.0, 0.0) };
        let clearance = Plane::new(None, vec![], vec![one, other]).clearance();
        (clearance.washed, clearance.overlaps)
    };
    assert_eq!(washed(3.0, 0.0, -2.9), (1, 0));
    assert_eq!(washed(3.0, 0.0, -3.1), (0, 0));
    assert_eq!(washed(3.0, 1.1, 0.0), (0, 0));
    assert_eq!(washed(3.0, 0.0, -0.9), (0, 1));
    assert_eq!(washed(1.0, 0.0, -1.1), (0, 0));
}

#[test]
fn the_nearest_of_many_obstacles_is_found_anywhere() {
    let ball = |x: f64, y: f64| Solid::Ball { center_m: [x, y, 0.0], radius_m: 1.0 };
    let solids: Vec<_> = (0..400).map(|index| ball(f64::from(index % 20) * 9.0, f64::from(index / 20) * 9.0)).collect();
    for at in [[4.5, 4.5], [3.0, 0.5], [-60.0, 20.0], [500.0, -500.0], [90.2, 89.9]] {
        let discs = vec![disc(1, at[0], at[1]), disc(2, at[0] - 40.0, at[1] - 40.0)];
        let gap = |disc: &Disc| {
            let gaps = solids.iter().map(|solid| solid.distance_m(disc.position_m));
            gaps.fold(f64::INFINITY, f64::min) - disc.radius_m
        };
        let gaps: Vec<_> = discs.iter().map(gap).collect();
        let mut plane = Plane::new(None, solids.clone(), discs.clone());
        for sight_m in [0.0, 7.0, 1000.0] {
            plane = plane.with_sight(sight_m);
            let clearance = plane.clearance();
            assert_eq!(clearance.solids_m, gaps[0].min(gaps[1]), "{at:?} {sight_m}");
            assert_eq!(clearance.intrusions, gaps.iter().filter(|&&gap| gap < -1e-9).count() as u64, "{at:?}");
        }
    }
}
