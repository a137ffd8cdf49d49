mod flocks;
mod groups;
mod remarks;
mod sensing;

use super::super::Overrides;
use super::super::ScenarioError;
use super::*;
use proptest::prelude::*;
use staya_controller::agent::{AnyHalfPlanes, ContactLossPolicy, GuidanceSetup, SafetyKind, SafetySetup};
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
        let (params, inflation) = (AvoidParams::default(), StalenessInflation { growth_mps: 0.25, max_m: 0.75 });
        let safety = SafetySetup::Orca { params, inflation, source: AnyHalfPlanes::Analytic };
        assert_eq!(setup(&format!("{HEAD}{PLANE}{table}{TWO}")).general.safety, safety);
    }
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
    let (params, inflation) = (AvoidParams::default(), StalenessInflation { growth_mps: 1.0, max_m: 0.2 });
    assert_eq!(group.guidance, GuidanceSetup::Waypoint { speed_mps: 1.0, tolerance_m: 0.02 });
    assert_eq!(group.safety, SafetySetup::Orca { params, inflation, source: AnyHalfPlanes::Analytic });
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
fn the_defaults_of_orca_match_the_readme() {
    let readme = include_str!("../../../../../scenarios/README.md");
    let row = |field: &str| {
        let mut rows = readme.lines().skip_while(|line| !line.contains("`[plane.orca]`"));
        let row = rows.find(|line| line.starts_with(&format!("| `{field}`")));
        let row = row.unwrap_or_else(|| panic!("no row of {field}"));
        row.trim_end_matches(" |").rsplit(" | ").next().expect("a column")
    };
    let params = AvoidParams::<f32>::default();
    let horizons = format!("{}, {}", params.horizon_s, params.wall_horizon_s);
    assert_eq!(row("horizon_s"), horizons);
    assert_eq!(row("share"), params.share.to_string());
    assert_eq!(row("margin_m"), params.margin_m.to_string());
}

#[test]
fn every_mistake_is_named_with_line_field_and_remedy() {
    let with = |plane: &str| format!("{HEAD}{PLANE}{plane}{TWO}");
    let after = |rest: &str| format!("{HEAD}{PLANE}{TWO}{rest}");
    let robots = |robots: &str| format!("{HEAD}{PLANE}[plane.robots]\n{robots}\n");
    let flock = |name: &str, table: &str, goals: &str| {
        format!(
            "{HEAD}{PLANE}guidance = \"{name}\"\n[plane.robots]\n\
             cloud = {{ count = 2, from_m = [0, 0], to_m = [9, 9]{goals} }}\n[plane.{name}]\n{table}\n"
        )
    };
    let cases = [
        (
            with("").replace("radius_m = 0.2", "radius_m = -1"),
            "s.toml:4:12: plane.radius_m: -1 is out of range; give 0.001 to 65 metres",
        ),
        (
            with("").replace("max_speed_mps = 1", "max_speed_mps = 33"),
            "s.toml:5:17: plane.max_speed_mps: 33 is out of range; give 0.001 to 32 m/s",
        ),
        (with("max_acceleration_mps2 = nan\n"), "s.toml:6:25: plane.max_acceleration_mps2: NaN is out of range"),
        (with("max_acceleration_mps2 = 0\n"), "s.toml:6:25: plane.max_acceleration_mps2: 0 is out of range"),
        (with("cruise_mps = 0\n"), "s.toml:6:14: plane.cruise_mps: 0 is out of range; give 0.001 to 1 m/s"),
        (with("tolerance_m = 0\n"), "s.toml:6:15: plane.tolerance_m: 0 is out of range"),
        (with("sight_m = inf\n"), "s.toml:6:11: plane.sight_m: inf is out of range"),
        (with("guidance = \"sheep\"\n"), "s.toml:6:12: plane.guidance: unknown value `sheep`"),
        (with("safety = \"luck\"\n"), "s.toml:6:10: plane.safety: unknown value `luck`"),
        (with("colour = 1\n"), "s.toml:6:1: plane.colour: unknown field `colour`"),
        (
            robots("list = [{ start_m = [0] }]"),
            "s.toml:7:21: plane.robots.list[0].start_m: expected [x, y] or [x, y, z]",
        ),
        (
            robots("scattered = { count = 200, from_m = [0, 0], to_m = [3, 3] }"),
            "s.toml:7:13: plane.robots.scattered: robot",
        ),
        (
            robots("scattered = { count = 2, from_m = [0, 0], to_m = [9, 9], spacing_m = 0.1 }"),
            "s.toml:7:70: plane.robots.scattered.spacing_m: 0.1 is out of range; give 0.4 to",
        ),
        (
            robots("scattered = { count = 2, from_m = [0, 0], to_m = [9, 9], travel_m = 0 }"),
            "s.toml:7:69: plane.robots.scattered.travel_m: 0 is out of range",
        ),
        (
            robots("scattered = { count = 2, from_m = [0, 0], to_m = [9e9, 9] }"),
            "s.toml:7:51: plane.robots.scattered.to_m[0]: 9000000000 is out of range",
        ),
        (
            after("[[plane.balls]]\ncount = 50\nradius_m = 1\nfrom_m = [9, 9]\nto_m = [12, 12]\n"),
            "s.toml:8:1: plane.balls[0]: ball",
        ),
        (
            after("[[plane.balls]]\ncount = 0\nradius_m = 1\nfrom_m = [9, 9]\nto_m = [12, 12]\n"),
            "s.toml:9:9: plane.balls[0].count: 0 is out of range; give 1 to 1000000 balls",
        ),
        (
            format!("{HEAD}{PLANE}"),
            "s.toml:3:1: plane.robots: the robots are not defined exactly once; give either plane.robots",
        ),
        (robots(""), "s.toml:6:1: plane.robots: a field is missing; give exactly one of `list`"),
        (robots("list = []"), "s.toml:7:8: plane.robots.list: 0 is out of range; give 1 to 1000000 robots"),
        (robots("circle = { count = 0, radius_m = 3 }"), "s.toml:7:20: plane.robots.circle.count: 0 is out of range"),
        (
            robots("circle = { count = 3, radius_m = nan }"),
            "s.toml:7:34: plane.robots.circle.radius_m: NaN is out of range",
        ),
        (
            robots("circle = { count = 1000001, radius_m = 3 }"),
            "s.toml:7:20: plane.robots.circle.count: 1000001 is out of range",
        ),
        (
            robots("circle = { count = 3, radius_m = 3 }\nlist = []"),
            "s.toml:8:1: plane.robots.list: `circle` is given, too; give exactly one of `list`",
        ),
        (
            robots("cloud = { count = 100, from_m = [0, 0], to_m = [1, 1] }"),
            "s.toml:7:9: plane.robots.cloud: the robots find no room",
        ),
        (
            robots("cloud = { count = 1, from_m = [-inf, 0], to_m = [inf, 1] }"),
            "s.toml:7:32: plane.robots.cloud.from_m[0]: -inf is out of range",
        ),
        (
            robots("cloud = { count = 1, from_m = [0, 0], to_m = [nan, 1] }"),
            "s.toml:7:47: plane.robots.cloud.to_m[0]: NaN is out of range",
        ),
        (
            robots("cloud = { count = 1, from_m = [0, 0], to_m = [1, 1], velocity_to_mps = [99, 0] }"),
            "s.toml:7:73: plane.robots.cloud.velocity_to_mps[0]: 99 is out of range",
        ),
        (
            robots("cloud = { count = 1, from_m = [0, 0], to_m = [1, 1], goals_m = [[1, 2], [3, 4]] }"),
            "s.toml:7:64: plane.robots.cloud.goals_m: 2 goals are too many for guidance \"waypoint\"",
        ),
        (
            format!("{HEAD}{LAND}{PLANE}{TWO}[robots]\nscattered = {{ count = 2 }}\n"),
            "s.toml:9:1: plane.robots: the robots are not defined exactly once",
        ),
        (
            format!("{HEAD}{PLANE}[robots]\nscattered = {{ count = 2 }}\n"),
            "s.toml:6:1: robots: there are no cells; give [terrain]",
        ),
        (
            robots("list = [{ start_m = [0, 0] }, { start_m = [2000001, 0] }]"),
            "s.toml:7:44: plane.robots.list[1].start_m[0]: 2000001 is out of range",
        ),
        (
            robots("list = [{ start_m = [0, 0], goal_m = [0, nan] }]"),
            "s.toml:7:42: plane.robots.list[0].goal_m[1]: NaN is out of range",
        ),
        (
            robots("list = [{ start_m = [0, 0], velocity_mps = [0, -32.5] }]"),
            "s.toml:7:48: plane.robots.list[0].velocity_mps[1]: -32.5 is out of range",
        ),
        (
            robots("list = [{ start_m = [0, 0] }, { start_m = [4, 0] }, { start_m = [0, 0.39] }]"),
            "s.toml:6:1: plane.robots: robots 1 and 3 overlap at the start; put them 0.4 m apart",
        ),
        (
            robots("circle = { count = 40, radius_m = 2 }"),
            "s.toml:6:1: plane.robots: robots 1 and 2 overlap at the start",
        ),
        (
            with("guidance = \"route\"\n"),
            "s.toml:6:12: plane.guidance: this guidance goes from cell to cell; give [terrain]",
        ),
        (
            format!("{HEAD}{LAND}[robots]\nscattered = {{ count = 2 }}\n{PLANE}guidance = \"formation\"\n"),
            "s.toml:11:12: plane.guidance: robots.formation and guidance \"formation\" go together",
        ),
        (with("guidance = \"lattice\"\n"), "s.toml:3:1: plane.lattice: this guidance needs distances"),
        (
            after("[plane.boids]\ncrowded_m = 1\nclosest_m = 2\n"),
            "s.toml:8:1: plane.boids: these robots have another guidance",
        ),
        (with("safety = \"push_out\"\n"), "s.toml:3:1: plane.push_out: safety \"push_out\" and its table go together"),
        (
            after("[plane.push_out]\nmin_distance_m = 1\n"),
            "s.toml:8:1: plane.push_out: safety \"push_out\" and its table go together",
        ),
        (
            format!("{}[plane.orca]\nshare = 0.5\n", with("safety = \"none\"\n")),
            "s.toml:9:1: plane.orca: these robots have another safety layer",
        ),
        (
            format!(
                "{}[plane.push_out]\nmin_distance_m = 1\nmodel = \"tangential\"\n",
                with("safety = \"push_out\"\n")
            ),
            "s.toml:11:9: plane.push_out.model: robots that go straight to a place jam for ever",
        ),
        (
            after("[[plane.wall]]\npoints_m = [[1, 2]]\n"),
            "s.toml:9:12: plane.wall[0].points_m: this is not a wall; give two or more points",
        ),
        (
            after("[[plane.wall]]\npoints_m = [[1, 2], [3, 1e300]]\n"),
            "s.toml:9:25: plane.wall[0].points_m[1][1]: 1e300 is out of range",
        ),
        (
            after("[[plane.wall]]\npoints_m = [[1, 2], [3, 2], [3, 4]]\ndoor_m = 1\n"),
            "s.toml:10:10: plane.wall[0].door_m: only a wall of two points has a door",
        ),
        (
            after("[[plane.wall]]\npoints_m = [[1, 2], [3, 2]]\ndoor_m = 3\n"),
            "s.toml:10:10: plane.wall[0].door_m: 3 is out of range; give 0 to 2 metres",
        ),
        (
            after("[[plane.ball]]\ncenter_m = [1, 2]\nradius_m = 0\n"),
            "s.toml:10:12: plane.ball[0].radius_m: 0 is out of range",
        ),
        (
            after("[[plane.ball]]\ncenter_m = [nan, 2]\nradius_m = 1\n"),
            "s.toml:9:13: plane.ball[0].center_m[0]: NaN is out of range",
        ),
        (
            after("[[plane.half_space]]\npoint_m = [0, inf]\nnormal = [1, 0]\n"),
            "s.toml:9:15: plane.half_space[0].point_m[1]: inf is out of range",
        ),
        (
            after("[[plane.half_space]]\npoint_m = [0, -9]\nnormal = [0, 0]\n"),
            "s.toml:10:10: plane.half_space[0].normal: this is not a direction",
        ),
        (
            after("[[plane.ball]]\ncenter_m = [3.5, 0, 1]\nradius_m = 0.31\n"),
            "s.toml:6:1: plane.robots: robot 2 starts in an obstacle",
        ),
        (
            after("[plane.orca]\nhorizon_s = 0\n"),
            "s.toml:9:13: plane.orca.horizon_s: 0 is out of range; give 0.01 to 60 seconds",
        ),
        (after("[plane.orca]\nshare = 1.1\n"), "s.toml:9:9: plane.orca.share: 1.1 is out of range; give 0 to 1"),
        (
            after("[plane.orca]\ndownwash = 3\n"),
            "s.toml:9:12: plane.orca.downwash: robots in the plane are not above each other; give safety = \"fly\"",
        ),
        (
            format!("{}[plane.orca]\ndownwash = 0.5\n", with("safety = \"fly\"\n")),
            "s.toml:10:12: plane.orca.downwash: 0.5 is out of range; give 1 to 10",
        ),
        (after("[plane.orca]\nlisten_s = 601\n"), "s.toml:9:12: plane.orca.listen_s: 601 is out of range"),
        (
            after("[plane.orca]\nremember_s = 60\n"),
            "s.toml:9:1: plane.orca.remember_s: unknown field `remember_s`; the field is called `stands_after_s` now",
        ),
        (after("[plane.orca]\nalone_mps = -1\n"), "s.toml:9:13: plane.orca.alone_mps: -1 is out of range"),
        (after("[plane.orca]\ninflation_m = -1\n"), "s.toml:9:15: plane.orca.inflation_m: -1 is out of range"),
        (
            flock("lattice", "spacing_m = 1\nalgorithm = 4", ""),
            "s.toml:11:13: plane.lattice.algorithm: 4 is out of range; give 1 to 3",
        ),
        (flock("lattice", "spacing_m = nan", ""), "s.toml:10:13: plane.lattice.spacing_m: NaN is out of range"),
        (
            flock("goal_flock", "min_distance_m = 1\nneighborhood_m = 1", ""),
            "s.toml:11:18: plane.goal_flock.neighborhood_m: 1 is out of range; give 2 to",
        ),
        (
            flock("goal_flock", "min_distance_m = 1", ", goals_m = [[1, 1], [2, 2], [3, 3], [4, 4], [5, 5]]"),
            "s.toml:8:64: plane.robots.cloud.goals_m: 5 goals are too many for guidance \"goal_flock\"",
        ),
        (
            flock("goal_flock", "min_distance_m = 1", ", goals_m = [[1, 1]], goal_velocity_mps = [33, 0]"),
            "s.toml:8:95: plane.robots.cloud.goal_velocity_mps[0]: 33 is out of range",
        ),
        (
            flock("boids", "crowded_m = 1\nclosest_m = 3", ", goals_m = [[1, 1]]"),
            "s.toml:8:64: plane.robots.cloud.goals_m: 1 goals are too many for guidance \"boids\"",
        ),
        (
            flock("boids", "crowded_m = 1\nclosest_m = 3\nmax_turn = 4", ""),
            "s.toml:12:12: plane.boids.max_turn: 4 is out of range",
        ),
        (
            after("[[plane.order]]\nat_s = nan\nplace_m = [1, 1]\n"),
            "s.toml:9:8: plane.order[0].at_s: NaN is out of range",
        ),
        (
            after("[[plane.order]]\nat_s = 1\ngoal = 1\nplace_m = [1, 1]\n"),
            "s.toml:10:8: plane.order[0].goal: robots with guidance \"waypoint\" have no goal 1",
        ),
        (
            after("[[plane.order]]\nat_s = 1\nplace_m = [1, 9e6]\n"),
            "s.toml:10:15: plane.order[0].place_m[1]: 9000000 is out of range",
        ),
        (
            after("[[plane.order]]\nat_s = 1\nplace_m = [1, 9]\nvelocity_mps = [33, 0]\n"),
            "s.toml:11:17: plane.order[0].velocity_mps[0]: 33 is out of range",
        ),
        (
            flock("boids", "crowded_m = 1\nclosest_m = 3\n[[plane.order]]\nat_s = 1\nplace_m = [1, 1]", ""),
            "s.toml:12:1: plane.order[0].goal: robots with guidance \"boids\" have no goal 0",
        ),
    ];
    refused(&cases);
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
    let text =
        format!("{HEAD}{LAND}[robots]\nlist = [{{ start = [0, 1], goal = [3, 8] }}]\n{PLANE}guidance = \"route\"\n");
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
            "[plane.robots.cloud]\ncount = 9\nfrom_m = [-4, 3]\nto_m = [9, 9]\nvelocity_to_mps = [0.8, 0.5]\n\
             goals_m = [[1, 2]]\ngoal_velocity_mps = [0.1, 0]\n",
            "[robots]\nlist = [{ start = [0, 0], goal = [3, 2] }]\n",
        ][which];
        let text = format!(
            "tick_s = 0.5\n{HEAD}{LAND}{PLANE}max_acceleration_mps2 = 3\ncruise_mps = 0.5\ntolerance_m = 0.1\nsight_m = 5\n\
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
        "{HEAD}tick_s = 0.1\n{PLANE}guidance = \"lattice\"\n[plane.robots]\ncloud = {{ count = 2, from_m = [0, 0], to_m = [9, 9] }}\n\
         [plane.lattice]\nspacing_m = 1\n{gains}\n[radio]\n{radio}\n"
    );
    let scenario = Scenario::parse(&text, Path::new("s.toml"), &Overrides::default()).unwrap();
    let remarks = scenario.remarks();
    match &scenario.plane().unwrap().general.guidance {
        GuidanceSetup::Lattice { params, .. } => (params.alpha.position, params.gamma.position, remarks),
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
    let (alpha, gamma, said) = gains("delay_ms = 100", "c_alpha = 10");
    assert_eq!((alpha, gamma), (10.0, 2.0));
    assert!(said[0].contains("c_alpha = 10") && said[0].contains("at most 1.00"), "{said:?}");
    // In algorithm 2 the goal compresses the flock.
    let (alpha, gamma, said) = gains("", "algorithm = 2");
    assert!((alpha / gamma - 50.0).abs() < 1e-3 && said.is_empty());
    let (_, _, said) = gains("", "algorithm = 2\nc_gamma = 1");
    assert!(said[0].contains("c_gamma = 1: in algorithm 2"), "{said:?}");
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
