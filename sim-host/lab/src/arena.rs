//! Scenarios that experiments build instead of reading a file.

use staya_controller::agent::{GuidanceSetup, SafetyKind};
use staya_controller::orca::AvoidParams;
use staya_controller::push_out::PushOutParams;
use staya_controller::rand::Rng;
use staya_sim::radio::RadioParams;
use staya_sim::scenario::{PlaneSetup, RobotGroup, Scenario, Start, Target};
use staya_sim::world::plane::{Abilities, Solid};

pub(super) const FASTEST_MPS: f64 = 32.0;

#[derive(Clone, Debug)]
pub(super) struct Arena {
    pub name: &'static str,
    pub seed: u64,
    pub step_s: f64,
    pub seconds: f64,
    pub radius_m: f64,
    pub max_speed_mps: f64,
    pub range_m: f64,
    pub loss: f64,
    pub sight_m: f64,
    pub guidance: GuidanceSetup,
    pub safety: SafetyKind,
    pub orca: AvoidParams<f32>,
    pub push_out: PushOutParams<f32>,
    pub solids: Vec<Solid>,
}

impl Arena {
    pub fn setup(&self, starts: Vec<Start>) -> PlaneSetup {
        let abilities = Abilities {
            max_speed_mps: self.max_speed_mps,
            max_acceleration_mps2: f64::INFINITY,
            lag_s: 0.0,
            step_s: self.step_s,
        };
        let group = RobotGroup {
            sight_m: self.sight_m,
            guidance: self.guidance.clone(),
            ..RobotGroup::new(abilities, self.radius_m).behind(self.safety, self.orca, self.push_out)
        };
        PlaneSetup { solids: self.solids.clone(), ..PlaneSetup::new(group, starts) }
    }

    pub fn scenario(&self, setup: PlaneSetup) -> Scenario {
        let radio = RadioParams { range_m: self.range_m, loss: self.loss, ..RadioParams::default() };
        let ticks = ticks(self.seconds, self.step_s);
        Scenario::in_plane(self.name, self.seed, ticks, radio, setup)
    }
}

pub(super) fn ticks(seconds: f64, step_s: f64) -> u32 {
    libm::round(seconds / step_s) as u32
}

pub(super) fn uniform(rng: &mut Rng, low: f64, high: f64) -> f64 {
    low + (high - low) * ((rng.next_u64() >> 11) as f64 / (1_u64 << 53) as f64)
}

/// Mean 0 (Box and Muller).
pub(super) fn normal(rng: &mut Rng, deviation: f64) -> f64 {
    let length = libm::sqrt(-2.0 * libm::log(1.0 - uniform(rng, 0.0, 1.0)));
    deviation * length * libm::cos(2.0 * std::f64::consts::PI * uniform(rng, 0.0, 1.0))
}

const TRIES: u32 = 1000;

/// Starts at least `apart_m` from each other, or `None` without room. `draw` returns place and
/// velocity of robot i from its own generator, and is repeated until the distance fits.
pub(super) fn starts(
    count: u32,
    apart_m: f64,
    targets: &[Target],
    mut rng: impl FnMut(u32) -> Rng,
    draw: impl Fn(&mut Rng) -> ([f64; 3], [f64; 3]),
) -> Option<Vec<Start>> {
    let mut starts: Vec<Start> = Vec::new();
    for robot in 0..count {
        let mut rng = rng(robot);
        let is_free = |at: [f64; 3]| starts.iter().all(|other| distance_m(other.position_m, at) >= apart_m);
        let (position_m, velocity_mps) = (0..TRIES).map(|_| draw(&mut rng)).find(|(at, _)| is_free(*at))?;
        starts.push(Start { position_m, velocity_mps, places: targets.to_vec(), group: None });
    }
    Some(starts)
}

pub(super) fn distance_m(a: [f64; 3], b: [f64; 3]) -> f64 {
    let squares = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b));
    libm::sqrt(squares.sum())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normal_draws_have_the_given_mean_and_deviation() {
        let mut rng = Rng::new(1);
        let drawn: Vec<f64> = (0..20_000).map(|_| normal(&mut rng, 3.0)).collect();
        let mean = drawn.iter().sum::<f64>() / 20_000.0;
        let variance = drawn.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / 20_000.0;
        assert!(mean.abs() < 0.1, "{mean}");
        assert!((variance - 9.0).abs() < 0.3, "{variance}");
    }

    #[test]
    fn starts_keep_their_distance_or_fail() {
        let square = |rng: &mut Rng| ([uniform(rng, 0.0, 10.0), uniform(rng, 0.0, 10.0), 0.0], [0.0; 3]);
        let keyed = |robot| Rng::keyed(1, 2, robot, 0);
        let some = starts(30, 1.0, &[], keyed, square).unwrap();
        for (i, a) in some.iter().enumerate() {
            for b in &some[..i] {
                assert!(distance_m(a.position_m, b.position_m) >= 1.0);
            }
        }
        assert_eq!(starts(200, 1.0, &[], keyed, square), None);
    }
}
