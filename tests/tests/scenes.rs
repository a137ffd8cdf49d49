//! The random scenes are reproducible and fair; nothing is run here except a few of them.

use staya_sim::scenario::{Overrides, Scenario};
use staya_tests::scenes::{Kind, Member, PERIOD, Row, Scene, UNSEEN, comparison, distance_m, run};
use std::path::Path;

#[test]
fn a_seed_has_one_scene() {
    for seed in [0, 7, 499, UNSEEN + 3] {
        assert_eq!(Scene::new(seed).text, Scene::new(seed).text);
        assert_ne!(Scene::new(seed).text, Scene::new(seed + PERIOD).text.replace(&(seed + PERIOD).to_string(), ""));
        assert_eq!(Scene::new(seed).kind, Scene::new(seed + PERIOD).kind);
    }
}

#[test]
fn the_weights_of_the_kinds_are_their_numbers_of_scenes() {
    for (kind, name, weight) in Kind::ALL {
        let count = (0..PERIOD).filter(|seed| Kind::of(*seed) == *kind).count();
        assert_eq!(count, *weight as usize, "{name}");
        assert_eq!(name.parse(), Ok(*kind));
    }
    assert!("fade".parse::<Kind>().is_err_and(|error| error.contains("fades")));
}

/// Smallest gap between two of the bodies at these places, metres; distances of flyers count less
/// in the vertical.
fn least_gap_m(members: &[Member], place: impl Fn(&Member) -> [f64; 3]) -> f64 {
    let pairs = members.iter().enumerate().flat_map(|(at, one)| members[..at].iter().map(move |other| (one, other)));
    let gaps = pairs.map(|(one, other)| distance_m(place(one), place(other)) - one.radius_m - other.radius_m);
    gaps.fold(f64::INFINITY, f64::min)
}

/// Distance of a place to a wall, metres.
fn to_wall_m([x, y, _]: [f64; 3], [from, to]: [[f64; 2]; 2]) -> f64 {
    let (along, off) = ([to[0] - from[0], to[1] - from[1]], [x - from[0], y - from[1]]);
    let share = (along[0] * off[0] + along[1] * off[1]) / (along[0] * along[0] + along[1] * along[1]);
    let share = share.clamp(0.0, 1.0);
    distance_m([x, y, 0.0], [from[0] + share * along[0], from[1] + share * along[1], 0.0])
}

#[test]
fn starts_and_goals_have_room_and_the_scenario_is_valid() {
    for seed in (0..PERIOD).chain(UNSEEN..UNSEEN + PERIOD) {
        let Scene { kind, crowd, text, .. } = Scene::new(seed);
        let members = &crowd.members;
        let gap_m = least_gap_m(members, |member| member.start_m).min(least_gap_m(members, |member| member.goal_m));
        let largest_m = members.iter().map(|member| member.radius_m).fold(0.0, f64::max);
        assert!(gap_m > 0.04, "seed {seed}, {kind}: gap {gap_m} m");
        for wall_m in &crowd.walls_m {
            let places = members.iter().flat_map(|member| [member.start_m, member.goal_m]);
            let off_m = places.map(|place_m| to_wall_m(place_m, *wall_m)).fold(f64::INFINITY, f64::min);
            assert!(off_m > 1.05 * largest_m, "seed {seed}, {kind}: a wall at {off_m} m, radius {largest_m} m");
        }
        assert!((5..=200).contains(&members.len()), "seed {seed}: {} robots", members.len());
        let scenario = Scenario::parse(&text, Path::new("scene.toml"), &Overrides::default());
        let scenario = scenario.unwrap_or_else(|error| panic!("seed {seed}: {error}\n{text}"));
        let way_s = crowd.longest_m() / members.iter().map(|member| member.speed_mps).fold(f64::INFINITY, f64::min);
        assert!(f64::from(scenario.ticks) * scenario.tick_s() > 8.0 * way_s, "seed {seed}: too short");
    }
}

#[test]
fn all_robots_arrive_with_a_perfect_radio() {
    let perfect = ["radio={}".parse().expect("a setting")];
    // One of each of these kinds, in which all robots keep running.
    for kind in [Kind::Fades, Kind::Door, Kind::Corridor, Kind::Space, Kind::Mixed, Kind::Inertia, Kind::WeakRadios] {
        let seed = (0..PERIOD).find(|seed| Kind::of(*seed) == kind).expect("each kind has scenes");
        let row = run(&Scene::new(seed), &perfect).expect("placed");
        assert_eq!((row.missing, row.overlap_mm), (0, 0.0), "seed {seed}, {kind}");
        assert_eq!(row.to_string().parse::<Row>().expect("a row").to_string(), row.to_string());
        let same = comparison(std::slice::from_ref(&row), std::slice::from_ref(&row));
        assert!(same.contains("1.000") && same.contains("1 of 1 traces are identical"), "{same}");
    }
}
