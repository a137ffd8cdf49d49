mod flocks;
mod groups;
mod mistakes;
mod models;
mod remarks;
mod sensing;

use super::super::Overrides;
use super::super::ScenarioError;
use super::super::law::LawSetup;
use super::*;
use proptest::prelude::*;
use staya_controller::agent::{
    ContactLossPolicy, FormationSettings, LawSettings, LayerSettings, OrcaSettings, TableSettings, UnguardedSettings,
    WaypointSettings,
};
use staya_controller::neighbor::StalenessInflation;
use staya_controller::orca::AvoidParams;
use staya_controller::time::Duration;
use std::path::Path;

const HEAD: &str = "name = \"t\"\nticks = 5\n";
const PLANE: &str = "[plane]\nradius_m = 0.2\nmax_speed_mps = 1\n";
const TWO: &str = "[plane.robots]\nlist = [{ start_m = [0, 0], goal_m = [5, 0] }, { start_m = [3, 0, 1] }]\n";
const LAND: &str = "[terrain]\nuniform = { width = 9, height = 9, classes = 1 }\ncell_m = 2\n";

fn parse(text: &str) -> Result<Scenario, ScenarioError> {
    Scenario::parse(text, Path::new("s.toml"), &Overrides::default())
}

fn setup(text: &str) -> PlaneSetup {
    let scenario = parse(text).unwrap_or_else(|error| panic!("{error}\n{text}"));
    scenario.plane().expect("robots in the plane").clone()
}

#[test]
fn staleness_inflation_accepts_its_former_names() {
    for (growth, most) in [("inflation_mps", "inflation_m"), ("doubt_mps", "doubt_m")] {
        let table = format!("[plane.orca]\n{growth} = 0.25\n{most} = 0.75\n");
        let (params, inflation) =
            (AvoidParams::for_body(0.2, 1.0), StalenessInflation { growth_mps: 0.25, max_m: 0.75 });
        let safety = LayerSettings::Orca(OrcaSettings { params, inflation });
        assert_eq!(setup(&format!("{HEAD}{PLANE}{table}{TWO}")).general.safety, safety);
    }
}

#[test]
fn a_given_growth_is_kept_and_others_are_those_of_the_fastest() {
    let growth = |own: &str| {
        let fast = "[[plane.group]]\nmax_speed_mps = 3\nrobots.list = [{ start_m = [9, 9] }]\n";
        let plane = setup(&format!("{HEAD}{PLANE}{own}{TWO}{fast}"));
        [0, 2].map(|index| plane.group(index).safety.orca().expect("ORCA").inflation.growth_mps)
    };
    assert_eq!(growth(""), [3.0, 3.0]);
    // The speed of the slow robots, which is also the default of one group alone.
    assert_eq!(growth("orca = { inflation_mps = 1 }\n"), [1.0, 1.0]);
}

#[test]
fn a_raised_lag_is_as_one_in_the_file() {
    for safety in ["orca", "push_out", "fly"] {
        let table = if safety == "push_out" { "[plane.push_out]\nmin_distance_m = 1\n" } else { "" };
        let with = |lag_s| {
            let bodies = format!("max_acceleration_mps2 = 0.5\nlag_s = {lag_s}\nsafety = \"{safety}\"\n{table}");
            setup(&format!("{HEAD}{PLANE}{bodies}{TWO}")).general
        };
        let mut group = with(0.2);
        for (lag_s, raised_s) in [(0.1, 0.2), (0.7, 0.7), (0.3, 0.7)] {
            group.raise_lag(lag_s);
            assert_eq!(group, with(raised_s), "{safety}");
        }
    }
}

#[test]
fn the_smallest_plane_has_the_documented_defaults() {
    let scenario = parse(&format!("{HEAD}{PLANE}{TWO}")).expect("good");
    assert_eq!(scenario.robots.len(), 2);
    let plane = scenario.plane().expect("robots in the plane").clone();
    let group = &plane.general;
    assert_eq!(group.abilities.max_acceleration_mps2, f64::INFINITY);
    assert_eq!((group.cruise_mps, group.sight_m), (1.0, 10.0));
    assert!((group.tolerance_m - 0.02).abs() < 1e-12);
    let (params, inflation) = (AvoidParams::for_body(0.2, 1.0), StalenessInflation { growth_mps: 1.0, max_m: 0.2 });
    assert!((0.7399..0.7401).contains(&params.horizon_s), "0.5 s and 1.2 radii");
    let waypoint = LawSettings::Waypoint(WaypointSettings { speed_mps: 1.0, tolerance_m: 0.02 });
    assert_eq!(group.law, LawSetup::BuiltIn(waypoint));
    assert_eq!(group.safety, LayerSettings::Orca(OrcaSettings { params, inflation }));
    assert!(!plane.has_terrain);
    let [one, two] = &plane.starts[..] else { panic!("two robots") };
    assert_eq!(one.places[0].position_m, [5.0, 0.0, 0.0]);
    assert_eq!((two.position_m, two.places.len()), ([3.0, 0.0, 1.0], 0));
    assert_eq!(plane.general.contact_loss, ContactLossPolicy::DEFAULT);
}

#[test]
fn the_reaction_to_silence_is_read() {
    let table = "[plane.orca]\nstands_after_s = 2.5\nlisten_s = 0.5\nexpects_others = true\nalone_mps = inf\n";
    let group = setup(&format!("{HEAD}{PLANE}{table}{TWO}")).general;
    let given = ContactLossPolicy {
        stands_after: Duration::from_millis(2500),
        alone_mps: f32::MAX,
        ..ContactLossPolicy::DEFAULT
    };
    assert_eq!(group.contact_loss, given);
    assert_eq!((group.listen, group.expects_others), (Some(Duration::from_millis(500)), Some(true)));
}

#[test]
fn the_documented_reaction_to_silence_is_the_usual_one() {
    let usual = |field: &str| {
        let line = <super::super::OrcaTable as super::super::Read>::lines().into_iter().find(|line| line.name == field);
        line.expect("a field").default.to_string().parse::<f64>().expect("a number")
    };
    let policy = ContactLossPolicy::<f32>::DEFAULT;
    assert_eq!(usual("stands_after_s"), f64::from(policy.stands_after.as_micros()) / 1e6);
    assert_eq!(usual("alone_mps"), f64::from(policy.alone_mps));
}

fn refused(cases: &[(String, &str)]) {
    let mut wrong = String::new();
    for (text, expected) in cases {
        let refusal = match parse(text) {
            Err(error) => error.to_string(),
            Ok(_) => "nothing".to_owned(),
        };
        if !refusal.starts_with(expected) || !refusal.contains("; ") {
            wrong += &format!("expected {expected}\n     got {refusal}\n");
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}

#[test]
fn walls_are_chains_and_polygons() {
    let points = "points_m = [[1, 2], [3, 2], [3, 4]]";
    let solids = |closed: &str| setup(&format!("{HEAD}{PLANE}{TWO}[[plane.wall]]\n{points}\n{closed}")).solids;
    let open = solids("");
    assert_eq!(open.len(), 2);
    let polygon = solids("closed = true\n");
    assert_eq!(polygon[..2], open[..]);
    assert_eq!(polygon[2], Solid::Wall([[3.0, 4.0], [1.0, 2.0]]));
}

#[test]
fn a_door_is_in_the_middle_of_its_wall() {
    let text = format!("{HEAD}{PLANE}{TWO}[[plane.wall]]\npoints_m = [[0, -5], [0, 5]]\ndoor_m = 0.8\n");
    let walls = [[[0.0, -5.0], [0.0, -0.4]], [[0.0, 0.4], [0.0, 5.0]]].map(Solid::Wall);
    assert_eq!(setup(&text).solids, walls);
}

#[test]
fn listed_starts_are_off_by_their_noise() {
    let noisy = |seed| setup(&format!("{HEAD}seed = {seed}\n{PLANE}{TWO}noise_m = 0.1\n")).starts;
    let exact = setup(&format!("{HEAD}{PLANE}{TWO}")).starts;
    for (start, exact) in noisy(1).iter().zip(&exact) {
        let off = [0, 1].map(|axis| start.position_m[axis] - exact.position_m[axis]);
        assert!(off.iter().all(|off| *off != 0.0 && off.abs() <= 0.1), "{off:?}");
        assert_eq!((start.position_m[2], &start.places), (exact.position_m[2], &exact.places));
    }
    assert_ne!(noisy(1)[0].position_m, noisy(2)[0].position_m);
}

#[test]
fn a_normal_may_have_any_length() {
    let text = format!("{HEAD}{PLANE}{TWO}[[plane.half_space]]\npoint_m = [0, -9]\nnormal = [0, 8]\n");
    let [Solid::Plane { normal, .. }] = setup(&text).solids[..] else { panic!("one half-space") };
    assert_eq!(normal, [0.0, 1.0, 0.0]);
}

#[test]
fn a_cloud_has_no_overlaps_and_is_reproducible() {
    let text = format!("{HEAD}{PLANE}[plane.robots]\ncloud = {{ count = 100, from_m = [-4, 4], to_m = [4, -4] }}\n");
    let starts = setup(&text).starts;
    assert_eq!(starts, setup(&text).starts);
    for (index, one) in starts.iter().enumerate() {
        assert!(one.position_m[..2].iter().all(|x| x.abs() <= 4.0));
        assert_eq!(one.position_m[2], 0.0);
        for other in &starts[..index] {
            let [dx, dy] = [0, 1].map(|i| one.position_m[i] - other.position_m[i]);
            assert!(libm::hypot(dx, dy) >= 0.4);
        }
    }
}

#[test]
fn orders_are_sorted_by_time() {
    let order = |at_s: f64, x: f64| format!("[[plane.order]]\nat_s = {at_s}\nplace_m = [{x}, 0]\n");
    let text = format!("tick_s = 0.5\n{HEAD}{PLANE}{TWO}{}{}{}", order(3.1, 1.0), order(0.0, 2.0), order(3.0, 3.0));
    let orders = setup(&text).orders;
    let of = |order: &Order| (order.tick, order.target.position_m[0]);
    let all: Vec<_> = orders.iter().map(of).collect();
    assert_eq!(all, [(0, 2.0), (6, 3.0), (7, 1.0)]);
}

#[test]
fn robots_of_the_grid_start_at_cell_centres() {
    let text = format!("{HEAD}{LAND}[robots]\nlist = [{{ start = [0, 1], goal = [3, 8] }}]\n{PLANE}law = \"route\"\n");
    let plane = setup(&text);
    assert!(plane.has_terrain);
    assert_eq!(plane.starts[0].position_m, [1.0, 3.0, 0.0]);
    assert_eq!(plane.starts[0].places[0].position_m, [7.0, 17.0, 0.0]);
}

proptest! {
    #[test]
    fn arbitrary_changes_to_a_good_plane_never_panic(
        changes in prop::collection::vec((0..2000_usize, "[-0-9a-z\\[\\]{}=., \\n\"]{0,3}"), 1..6),
        which in 0..4_usize,
    ) {
        let robots = [
            TWO,
            "[plane.robots.circle]\ncount = 9\nradius_m = 4\nnoise_m = 0.1\n",
            "[plane.robots.cloud]\ncount = 9\nfrom_m = [1, 3]\nto_m = [9, 9]\nvelocity_to_mps = [0.8, 0.5]\n\
             goals_m = [[1, 2]]\ngoal_velocity_mps = [0.1, 0]\n",
            "[robots]\nlist = [{ start = [0, 0], goal = [3, 2] }]\n",
        ][which];
        // The circle leaves the map.
        let land = if which == 1 { "" } else { LAND };
        let text = format!(
            "tick_s = 0.5\n{HEAD}{land}{PLANE}max_acceleration_mps2 = 3\ncruise_mps = 0.5\ntolerance_m = 0.1\nsight_m = 5\n\
             {robots}[[plane.wall]]\npoints_m = [[1, 12], [3, 12], [3, 14]]\nclosed = true\n[[plane.ball]]\ncenter_m = [15, -9]\n\
             radius_m = 2\n[[plane.half_space]]\npoint_m = [0, -9]\nnormal = [0, 1]\n[plane.orca]\nhorizon_s = 3\nmargin_m = 0.01\n\
             [[plane.order]]\nat_s = 2\nplace_m = [3, 4]\nvelocity_mps = [0.1, 0.1]\n"
        );
        prop_assert!(parse(&text).is_ok_and(|scenario| scenario.plane().is_some()), "{text}");
        let mut text: Vec<char> = text.chars().collect();
        for (at, change) in changes {
            let at = at % text.len();
            let end = (at + change.len()).min(text.len());
            text.splice(at..end, change.chars());
        }
        let _ = parse(&text.into_iter().collect::<String>());
    }
}

fn gains(radio: &str, gains: &str) -> (f32, f32, Vec<String>) {
    let text = format!(
        "{HEAD}tick_s = 0.1\n{PLANE}law = \"lattice\"\n[plane.robots]\ncloud = {{ count = 2, from_m = [0, 0], to_m = [9, 9] }}\n\
         [plane.lattice]\nspacing_m = 1\n{gains}\n[radio]\n{radio}\n"
    );
    let scenario = Scenario::parse(&text, Path::new("s.toml"), &Overrides::default()).unwrap();
    let remarks = scenario.remarks();
    match &scenario.plane().unwrap().general.law {
        LawSetup::BuiltIn(LawSettings::Lattice(lattice)) => {
            (lattice.params.alpha.position, lattice.params.gamma.position, remarks)
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn default_gains_are_stable_and_unstable_ones_cause_a_warning() {
    // Beacons every 0.1 s are too infrequent for gains of 10.
    let (alpha, gamma, said) = gains("", "");
    assert!((alpha - 4.0).abs() < 1e-3 && (gamma - 0.8).abs() < 1e-3 && said.is_empty(), "{alpha} {gamma} {said:?}");
    let (late, _, said) = gains("delay_ms = 100", "");
    assert!((late - 1.0).abs() < 1e-3 && said.is_empty());
    let (lossy, _, _) = gains("delay_ms = 100\nloss = 0.5", "");
    assert!((lossy - 4.0 / 9.0).abs() < 1e-3);
    let (alpha, gamma, said) = gains("delay_ms = 100", "c1_alpha = 10");
    assert_eq!((alpha, gamma), (10.0, 2.0));
    assert!(said[0].contains("c1_alpha = 10") && said[0].contains("at most 1.00"), "{said:?}");
    // In algorithm 2 the goal compresses the flock.
    let (alpha, gamma, said) = gains("", "algorithm = 2");
    assert!((alpha / gamma - 50.0).abs() < 1e-3 && said.is_empty());
    let (_, _, said) = gains("", "algorithm = 2\nc1_gamma = 1");
    assert!(said[0].contains("c1_gamma = 1: in algorithm 2"), "{said:?}");
}

#[test]
fn scattered_robots_have_separate_goals_clear_of_balls() {
    let text = format!(
        "{HEAD}{PLANE}[plane.robots]\nscattered = {{ count = 200, from_m = [0, 0], to_m = [20, 20], travel_m = 5 }}\n\
         [[plane.balls]]\ncount = 20\nradius_m = 0.5\nfrom_m = [0, 0]\nto_m = [20, 20]\ngap_m = 1\n"
    );
    let setup = setup(&text);
    assert_eq!((setup.starts.len(), setup.solids.len()), (200, 20));
    let starts: Vec<_> = setup.starts.iter().map(|start| start.position_m).collect();
    let goals: Vec<_> = setup.starts.iter().map(|start| start.places[0].position_m).collect();
    let apart = |one: &[f64; 3], other: &[f64; 3]| libm::hypot(one[0] - other[0], one[1] - other[1]);
    for places in [&starts, &goals] {
        for (index, one) in places.iter().enumerate() {
            assert!(one[..2].iter().all(|x| (0.0..=20.0).contains(x)) && one[2] == 0.0);
            assert!(places[..index].iter().all(|other| apart(one, other) >= 0.6), "{one:?}");
            assert!(setup.solids.iter().all(|solid| solid.distance_m(*one) >= 0.4), "{one:?}");
        }
    }
    let ways = starts.iter().zip(&goals).map(|(start, goal)| [0, 1].map(|axis| (start[axis] - goal[axis]).abs()));
    let ways: Vec<_> = ways.collect();
    assert!(ways.iter().flatten().all(|&way| way <= 5.0) && ways.iter().flatten().any(|&way| way > 4.0));
    for (index, one) in setup.solids.iter().enumerate() {
        let Solid::Ball { center_m, .. } = one else { panic!("no ball") };
        assert!(setup.solids[..index].iter().all(|other| other.distance_m(*center_m) >= 1.5), "{one:?}");
    }
}
