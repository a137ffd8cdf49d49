//! Mistakes in `[plane]`, each with its place and the remedy.

use super::*;

#[test]
fn every_mistake_is_named_with_line_field_and_remedy() {
    let with = |plane: &str| format!("{HEAD}{PLANE}{plane}{TWO}");
    let after = |rest: &str| format!("{HEAD}{PLANE}{TWO}{rest}");
    let robots = |robots: &str| format!("{HEAD}{PLANE}[plane.robots]\n{robots}\n");
    let flock = |name: &str, table: &str, goals: &str| {
        format!(
            "{HEAD}{PLANE}law = \"{name}\"\n[plane.robots]\n\
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
        (
            with("law = \"sheep\"\n"),
            "s.toml:6:7: plane.law: this program has no law \"sheep\"; it has waypoint, lattice",
        ),
        // Also with its values.
        (with("law = \"sheep\"\nsheep = { k1 = 1 }\n"), "s.toml:6:7: plane.law: this program has no law \"sheep\""),
        (with("law = \"sheep\"\nwolf = { k1 = 1 }\n"), "s.toml:7:1: plane.wolf: unknown field `wolf`"),
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
            "s.toml:7:64: plane.robots.cloud.goals_m: 2 goals are too many for the law \"waypoint\"",
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
        (with("law = \"route\"\n"), "s.toml:6:7: plane.law: this law goes from cell to cell; give [terrain]"),
        (
            format!("{HEAD}{LAND}[robots]\nscattered = {{ count = 2 }}\n{PLANE}law = \"formation\"\n"),
            "s.toml:11:7: plane.law: robots.formation and the law \"formation\" go together",
        ),
        (with("law = \"lattice\"\n"), "s.toml:3:1: plane.lattice: the law \"lattice\" needs `spacing_m`"),
        (
            after("[plane.boids]\ncrowded_m = 1\nclosest_m = 2\n"),
            "s.toml:8:1: plane.boids: these robots have the law \"waypoint\"",
        ),
        (with("safety = \"push_out\"\n"), "s.toml:3:1: plane.push_out: the layer \"push_out\" needs `min_distance_m`"),
        (
            after("[plane.push_out]\nmin_distance_m = 1\n"),
            "s.toml:8:1: plane.push_out: these robots have the safety layer \"orca\"; give plane.safety = \"push_out\"",
        ),
        (
            format!("{}[plane.orca]\nshare = 0.5\n", with("safety = \"none\"\n")),
            "s.toml:9:1: plane.orca: these robots have the safety layer \"none\"; give plane.safety = \"orca\"",
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
            "s.toml:7:60: plane.robots.list[1].start_m: robot 2 starts in an obstacle; keep its start 0.2 m away",
        ),
        (
            after("[[plane.ball]]\ncenter_m = [5, 0]\nradius_m = 0.31\n"),
            "s.toml:7:38: plane.robots.list[0].goal_m: an obstacle is nearer to the goal than the body's radius; keep the",
        ),
        (
            after("[plane.orca]\nhorizon_s = 0\n"),
            "s.toml:9:13: plane.orca.horizon_s: 0 is out of range; give 0.01 to 60 seconds",
        ),
        (after("[plane.orca]\nshare = 1.1\n"), "s.toml:9:9: plane.orca.share: 1.1 is out of range; give 0 to 1"),
        (
            after("[plane.orca]\ndownwash = 3\n"),
            "s.toml:9:12: plane.orca.downwash: the layer \"orca\" has no such value; give safety = \"fly\"",
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
            "s.toml:11:18: plane.goal_flock.neighborhood_m: less than 2 min_distance_m; give more",
        ),
        (
            flock("goal_flock", "min_distance_m = 1", ", goals_m = [[1, 1], [2, 2], [3, 3], [4, 4], [5, 5]]"),
            "s.toml:8:64: plane.robots.cloud.goals_m: 5 goals are too many for the law \"goal_flock\"",
        ),
        (
            flock("goal_flock", "min_distance_m = 1", ", goals_m = [[1, 1]], goal_velocity_mps = [33, 0]"),
            "s.toml:8:95: plane.robots.cloud.goal_velocity_mps[0]: 33 is out of range",
        ),
        (
            flock("boids", "crowded_m = 1\nclosest_m = 3", ", goals_m = [[1, 1]]"),
            "s.toml:8:64: plane.robots.cloud.goals_m: the law \"boids\" takes no goal; leave it out",
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
            "s.toml:10:8: plane.order[0].goal: robots with the law \"waypoint\" have no goal 1",
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
            "s.toml:12:1: plane.order[0].goal: robots with the law \"boids\" have no goal 0",
        ),
    ];
    refused(&cases);
}

#[test]
fn starts_and_goals_off_the_map_or_in_blocked_cells_name_line_and_cell() {
    // Ten cells of 2 m; the south-west corner is the origin.
    let map = "type octile\nheight 2\nwidth 5\nmap\n.....\n..@..\n";
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("m.map"), map).unwrap();
    let path = folder.path().join("s.toml");
    let message = |robots: &str, rest: &str| {
        let land = "[terrain]\nfile = \"m.map\"\ncell_m = 2\n";
        let text = format!("{HEAD}{land}{PLANE}[plane.robots]\n{robots}\n{rest}");
        match Scenario::parse(&text, &path, &Overrides::default()) {
            Ok(_) => String::new(),
            Err(error) => error.to_string().split_once("s.toml:").unwrap().1.to_owned(),
        }
    };
    let list = |entry: &str| format!("list = [{{ {entry} }}]");
    let opens = "[[terrain.change]]\nat_s = 1\nclass = 1\ncells = [[2, 0]]\n";
    let cases = [
        (
            list("start_m = [-0.1, 1]"),
            "",
            "10:21: plane.robots.list[0].start_m: [-0.1, 1] is not on the map; the map has x from 0 to 10 m and y from 0 to 4 m",
        ),
        (
            list("start_m = [1, 1], goal_m = [1, 4.5]"),
            "",
            "10:38: plane.robots.list[0].goal_m: [1, 4.5] is not on the map",
        ),
        (
            list("start_m = [4.5, 1.5]"),
            "",
            "10:21: plane.robots.list[0].start_m: [4.5, 1.5] is in the cell [2, 0], which is closed; give a place in an open cell",
        ),
        (
            list("start_m = [1, 1], goal_m = [5, 1]"),
            "",
            "10:38: plane.robots.list[0].goal_m: [5, 1] is in the cell [2, 0], which is closed",
        ),
        (
            list("start_m = [1, 1], via_m = [[1, 3], [5, 1]], goal_m = [9, 1]"),
            "",
            "10:46: plane.robots.list[0].via_m[1]: [5, 1] is in the cell",
        ),
        (list("start_m = [1, 1], goal_m = [5, 1]"), opens, ""),
        (list("start_m = [5, 1], goal_m = [1, 1]"), opens, "10:21: plane.robots.list[0].start_m: [5, 1] is in"),
        ("circle = { count = 2, radius_m = 1 }".to_owned(), "", "10:34: plane.robots.circle.radius_m: [-1, "),
        (
            "cloud = { count = 2, from_m = [4.1, 0.1], to_m = [5.9, 1.9] }".to_owned(),
            "",
            "10:9: plane.robots.cloud: the robots find no room",
        ),
        (
            "scattered = { count = 1, from_m = [4, 0], to_m = [6, 2] }".to_owned(),
            "",
            "10:13: plane.robots.scattered: robot 1 finds no free start",
        ),
    ];
    for (robots, rest, expected) in cases {
        let message = message(&robots, rest);
        assert!(
            if expected.is_empty() { message.is_empty() } else { message.starts_with(expected) },
            "{robots}: {message}"
        );
    }
}

#[test]
fn random_places_keep_two_radii_from_blocked_cells_and_from_the_sides() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(
        folder.path().join("m.map"),
        "type octile\nheight 4\nwidth 6\nmap\n......\n.@..@.\n..@@..\n......\n",
    )
    .unwrap();
    let path = folder.path().join("s.toml");
    for kind in ["scattered", "cloud"] {
        for seed in 0..30 {
            let text = format!(
                "seed = {seed}\n{HEAD}[terrain]\nfile = \"m.map\"\n{PLANE}[plane.robots.{kind}]\ncount = 6\nfrom_m = [0, 0]\nto_m = [6, 4]\n"
            );
            let scenario =
                Scenario::parse(&text, &path, &Overrides::default()).unwrap_or_else(|error| panic!("{error}"));
            let places = scenario
                .plane()
                .unwrap()
                .starts
                .iter()
                .flat_map(|start| start.places.iter().map(|goal| goal.position_m).chain([start.position_m]));
            let mut count = 0;
            for [x, y, _] in places {
                assert!(scenario.land.terrain.is_clear([x, y], 0.4), "{kind}, seed {seed}: [{x}, {y}]");
                count += 1;
            }
            assert_eq!(count, if kind == "cloud" { 6 } else { 12 });
        }
    }
}
