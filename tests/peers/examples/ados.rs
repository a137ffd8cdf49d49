//! Prints what Staya's drones and those of `ados-swarm` do in the same scenes.

use staya_peers::drones::{Ados, FLOOR_M, Outcome, Scene, Staya, Swarm, run};

const SEEDS: std::ops::Range<u32> = 0..100;
/// Drones, and the radius of their circle, metres.
const CIRCLES: [(usize, f64); 4] = [(4, 20.0), (8, 30.0), (12, 40.0), (20, 60.0)];

/// Runs scenes and describes the outcomes.
fn runs<S: Swarm>(scenes: &[Scene]) -> String {
    let all: Vec<Outcome> = scenes.iter().map(run::<S>).collect();
    let below = all.iter().filter(|one| one.least_m < FLOOR_M).count();
    let least_m = all.iter().map(|one| one.least_m).fold(f64::INFINITY, f64::min);
    let greatest = |of: fn(&Outcome) -> f64| all.iter().map(of).fold(0.0, f64::max);
    let (climb_m, error_m) = (greatest(|one| one.climb_m), greatest(|one| one.error_m));
    let times: Vec<f64> = all.iter().filter_map(|one| one.arrival_s).collect();
    let mut text = format!("{below} below the floor, least {least_m:.2} m; climb {climb_m:.2} m");
    if !times.is_empty() {
        let mean = times.iter().sum::<f64>() / times.len() as f64;
        let last = times.iter().copied().fold(0.0, f64::max);
        text += &format!("; {} arrive in {mean:.1} s, at most {last:.1} s; error {error_m:.3} m", times.len());
    }
    text
}

fn both(name: &str, scenes: &[Scene]) {
    println!("{name}, runs: {}", scenes.len());
    println!("  ados-swarm  {}", runs::<Ados>(scenes));
    println!("  Staya       {}", runs::<Staya>(scenes));
}

fn main() {
    let each = |scene: &dyn Fn(u32) -> Scene| SEEDS.map(scene).collect::<Vec<_>>();
    both("collision course", &[Scene::collision_course()]);
    both("flock of 8 over 500 m", &each(&Scene::flock));
    both("wedge of 7, by formation", &each(&Scene::wedge));
    both("wedge of 7, by goals", &each(&Scene::stations));
    let scene = Scene::beacon_loss();
    let dropped_s = [run::<Ados>(&scene), run::<Staya>(&scene)].map(|one| one.dropped_s.unwrap_or(f64::NAN));
    println!("dead drone dropped after: ados-swarm {:.1} s, Staya {:.1} s", dropped_s[0], dropped_s[1]);
    for (drones, radius_m) in CIRCLES {
        let name = format!("circle of {drones}, radius {radius_m} m");
        let scene = |seed| Scene::circle(drones, radius_m, seed);
        both(&name, &each(&scene));
        both(&format!("{name}, 30 % loss"), &each(&|seed| scene(seed).lossy(0.3, seed)));
        both(&format!("{name}, one dies"), &each(&|seed| scene(seed).deadly(seed)));
    }
}
