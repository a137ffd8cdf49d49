use super::super::*;
use super::lattice;
use staya_controller::body::Body;
use staya_controller::flock::action::{PhiAlpha, sigma_norm};
use staya_controller::geom::Vec3;
use staya_controller::lattice::{Algorithm, Gain, LatticeParams, Reference, acceleration};
use staya_controller::neighbor::Nearby;
use staya_controller::obstacle::Obstacle;
use staya_controller::robot::{Mode, RobotId};

fn params(algorithm: Algorithm) -> LatticeParams<f64> {
    let gamma = Gain::critical(1.0);
    LatticeParams { algorithm, alpha: Gain::critical(10.0), gamma, ..LatticeParams::new(7.0) }
}

fn meter(params: &LatticeParams<f64>) -> EnergyMeter<2> {
    EnergyMeter::new(params).expect("sound")
}

fn step(params: &LatticeParams<f64>, dt: f64, places: &mut [[f64; 2]], velocities: &mut [[f64; 2]]) {
    let vec = |[x, y]: [f64; 2]| Vec3::new(x, y, 0.0);
    let changes: Vec<Vec3<f64>> = (0..places.len())
        .map(|robot| {
            let body = Body {
                id: RobotId(robot as u32 + 1),
                velocity_mps: vec(velocities[robot]),
                radius_m: 0.0,
                max_speed_mps: f64::MAX,
                max_acceleration_mps2: f64::MAX,
                step_s: dt,
            };
            let others = (0..places.len()).filter(|other| *other != robot).map(|other| Nearby {
                id: RobotId(other as u32 + 1),
                offset_m: vec(minus(places[other], places[robot])),
                velocity_mps: vec(velocities[other]),
                radius_m: 0.0,
                gives_way: true,
                mode: Mode::Cruise,
                is_stranger: false,
            });
            let offset_m = vec(minus([0.0, 0.0], places[robot]));
            let reference = Reference { offset_m, velocity_mps: Vec3::ZERO };
            acceleration(params, &body, &others.collect::<Vec<_>>(), &[], Some(&reference))
        })
        .collect();
    for ((place, velocity), change) in places.iter_mut().zip(velocities).zip(changes) {
        *velocity = [velocity[0] + change.x * dt, velocity[1] + change.y * dt];
        *place = [place[0] + velocity[0] * dt, place[1] + velocity[1] * dt];
    }
}

fn crowd() -> (Vec<[f64; 2]>, Vec<[f64; 2]>) {
    let share = |i: u32, by: f64| (f64::from(i) * by).fract();
    let place = |i| [50.0 * share(i, 0.618_033_988_7), 50.0 * share(i, 0.414_213_562_4)];
    let velocity = |i| [4.0 * share(i, 0.732_050_807_6) - 2.0, 4.0 * share(i, 0.236_067_977_5) - 2.0];
    ((1..31).map(place).collect(), (1..31).map(velocity).collect())
}

#[test]
fn the_pair_potential_is_least_at_the_spacing_and_its_slope_is_the_force() {
    let meter = meter(&params(Algorithm::One));
    let sigma = |distance: f64| sigma_norm(distance * distance).sigma;
    let phi = PhiAlpha { r_alpha: sigma(8.4), d_alpha: sigma(7.0), a: 5.0, b: 5.0, c: 0.0 };
    assert!(meter.pair(phi.d_alpha).abs() < 1e-6);
    for distance in [0.5, 2.0, 5.0, 6.8, 7.3, 8.2] {
        let z = sigma(distance);
        let slope = (meter.pair(z + 0.01) - meter.pair(z - 0.01)) / 0.02;
        let force = phi.at(z, phi.adjacency(z));
        assert!((slope - force).abs() < 2e-3, "{distance}: {slope} {force}");
        assert!(meter.pair(z) >= 0.0);
    }
    assert_eq!(meter.pair(2.0 * phi.r_alpha), meter.pair(phi.r_alpha));
}

#[test]
fn a_lattice_at_rest_has_no_energy_but_that_of_pairs_out_of_range() {
    let params = params(Algorithm::Two);
    let mut meter = meter(&params);
    let places = lattice(7.0);
    let energy = meter.look(&places, &[[3.0, -1.0]; 9]).expect("robots");
    let centre = mean(&places);
    let spread: f64 = places.iter().map(|&place| squared(minus(place, centre)) / 2.0).sum();
    // Sixteen of the 36 pairs are neighbours.
    let lattice = params.alpha.position * 20.0 * meter.pair(f64::MAX);
    assert!(energy.kinetic < 1e-20, "{energy:?}");
    assert!((energy.lattice - lattice).abs() < 1e-3, "{energy:?} {lattice}");
    assert!((energy.reference - spread).abs() < 1e-9, "{energy:?} {spread}");
    let small = EnergyMeter::<2>::new(&LatticeParams { spacing_m: 0.7, ..params });
    let shrunk = lattice_of(&places, 0.1);
    let again = small.expect("sound").look(&shrunk, &[[0.0; 2]; 9]).expect("robots");
    assert!((again.hamiltonian() - energy.hamiltonian()).abs() < 1e-6, "{again:?}");
    assert!(EnergyMeter::<2>::new(&LatticeParams { range_ratio: 0.5, ..params }).is_none());
    assert_eq!(meter.look(&[[f64::NAN, 0.0]], &[[0.0; 2]]), None);
}

fn lattice_of(places: &[[f64; 2]], scale: f64) -> Vec<[f64; 2]> {
    places.iter().map(|place| place.map(|c| c * scale)).collect()
}

fn largest_rise(algorithm: Algorithm, dt: f64) -> f64 {
    let params = params(algorithm);
    let mut meter = meter(&params);
    let (mut places, mut velocities) = crowd();
    let mut energies = Vec::new();
    for _ in 0..(20.0 / dt) as u32 {
        energies.push(meter.look(&places, &velocities).expect("robots").hamiltonian());
        step(&params, dt, &mut places, &mut velocities);
    }
    let lost = energies[0] - energies[energies.len() - 1];
    assert!(lost > 100.0, "{algorithm:?}: {lost}");
    energies.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max) / lost
}

#[test]
fn the_hamiltonian_falls_in_each_step_of_the_papers_length() {
    for algorithm in [Algorithm::One, Algorithm::Two] {
        for dt in [0.01, 0.03] {
            let rise = largest_rise(algorithm, dt);
            assert!(rise < 1e-4, "{algorithm:?} at {dt} s: {rise}");
        }
    }
}

#[test]
fn steps_that_are_too_long_gain_energy() {
    let rise = largest_rise_or_blast(0.2);
    assert!(rise > 1e-2, "{rise}");
}

fn largest_rise_or_blast(dt: f64) -> f64 {
    let params = params(Algorithm::Two);
    let mut meter = meter(&params);
    let (mut places, mut velocities) = crowd();
    let (mut first, mut before, mut rise) = (None, f64::MAX, 0.0_f64);
    for _ in 0..100 {
        let Some(energy) = meter.look(&places, &velocities) else { break };
        let now = energy.hamiltonian();
        rise = rise.max(now - before);
        before = now;
        first.get_or_insert(now);
        step(&params, dt, &mut places, &mut velocities);
    }
    rise / first.unwrap_or(1.0)
}

/// Acceleration of a robot at rest in the origin by an obstacle or a reference.
fn alone(params: &LatticeParams<f64>, obstacles: &[Obstacle<f64>], reference: Option<&Reference<f64>>) -> Vec3<f64> {
    let body = Body {
        id: RobotId(1),
        velocity_mps: Vec3::ZERO,
        radius_m: 0.0,
        max_speed_mps: f64::MAX,
        max_acceleration_mps2: f64::MAX,
        step_s: 0.01,
    };
    acceleration(params, &body, &[], obstacles, reference)
}

#[test]
fn slopes_of_the_potentials_of_obstacle_and_reference_are_the_forces_of_algorithm_three() {
    for spacing_m in [7.0, 0.7] {
        let params = LatticeParams { spacing_m, ..params(Algorithm::Three) };
        let (meter, unit_m) = (meter(&params), spacing_m / 7.0);
        for distance in [0.1, 1.0, 3.0, 4.1] {
            let ball =
                Obstacle::Ball { center_m: Vec3::new(10.0 + distance, 0.0, 0.0) * unit_m, radius_m: 10.0 * unit_m };
            let force = alone(&params, &[ball], None).x / unit_m;
            let at = |off: f64| meter.obstacle((distance + off) * unit_m);
            let slope = (at(0.01) - at(-0.01)) / 0.02;
            assert!(force < 0.0 && (force - slope).abs() < 0.01 * force.abs() + 1e-3, "{distance}: {force} {slope}");
        }
        assert_eq!(meter.obstacle(4.3 * unit_m), 0.0);
        assert_eq!(meter.obstacle(-unit_m), meter.obstacle(0.0));
        for distance in [0.1, 1.0, 20.0] {
            let offset_m = Vec3::new(distance * unit_m, 0.0, 0.0);
            let reference = Reference { offset_m, velocity_mps: Vec3::ZERO };
            let force = alone(&params, &[], Some(&reference)).x / unit_m;
            let at = |off: f64| meter.pull([(distance + off) * unit_m, 0.0]);
            let slope = (at(0.001) - at(-0.001)) / 0.002;
            assert!((force - slope).abs() < 1e-4, "{distance}: {force} {slope}");
        }
    }
}
