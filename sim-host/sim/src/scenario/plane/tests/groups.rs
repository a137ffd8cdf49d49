use super::*;

fn by_route(list: &str) -> String {
    format!("{HEAD}{LAND}{PLANE}[[plane.group]]\nlaw = \"route\"\nrobots.list = [{list}]\n")
}

fn in_formation(fields: &str) -> String {
    let formation = format!("{{ rows = 1, columns = 2, spacing = [2, 2], {fields} }}");
    format!("{HEAD}{LAND}{PLANE}[[plane.group]]\nlaw = \"formation\"\nrobots.formation = {formation}\n")
}

#[test]
fn mistakes_in_groups_waypoints_and_intruders_name_line_field_and_remedy() {
    let after = |rest: &str| format!("{HEAD}{PLANE}{TWO}{rest}");
    let robots = |robots: &str| format!("{HEAD}{PLANE}[plane.robots]\n{robots}\n");
    let group = |fields: &str| after(&format!("[[plane.group]]\n{fields}\nrobots.list = [{{ start_m = [9, 9] }}]\n"));
    let cases = [
        (
            format!(
                "{HEAD}{PLANE}[[plane.group]]\nlaw = \"route\"\nrobots.list = [{{ start_m = [1, 1], goal_m = [9, 1] }}]\n"
            ),
            "s.toml:7:7: plane.group[0].law: this law goes from cell to cell; give [terrain]",
        ),
        (
            by_route("{ start_m = [1, 1] }"),
            "s.toml:11:1: plane.group[0].robots: robot 1 of the group goes from cell to cell and has no",
        ),
        (
            by_route("{ start_m = [1, 1], goal_m = [9, 1] }, { start_m = [19, 1], goal_m = [9, 1] }"),
            "s.toml:11:67: plane.group[0].robots.list[1].start_m: [19, 1] is not on the map; the map has x from 0 to 18 m",
        ),
        (
            by_route("{ start_m = [1, 1], goal_m = [9, -0.1] }"),
            "s.toml:11:45: plane.group[0].robots.list[0].goal_m: [9, -0.1] is not on the map",
        ),
        (
            by_route("{ start_m = [1, 1], goal_m = [9, 1] }").replace("\"route\"", "\"formation\""),
            "s.toml:10:7: plane.group[0].law: the law \"formation\" and robots.formation go together, without other",
        ),
        (
            in_formation("start = [0, 0], goal = [0, 8]").replace("\"formation\"", "\"route\""),
            "s.toml:10:7: plane.group[0].law: the law \"formation\" and robots.formation go together, without other",
        ),
        (
            in_formation("goal = [0, 8]"),
            "s.toml:11:20: plane.group[0].robots.formation: a field is missing; give exactly one of `start`, `starts`",
        ),
        (
            in_formation("start = [0, 0], goal = [99, 9]"),
            "s.toml:11:86: plane.group[0].robots.formation.goal: the goal (99, 9) of robot 1 is not on the map",
        ),
        (
            format!(
                "{HEAD}{LAND}{PLANE}[plane.robots.formation]\nrows = 1\ncolumns = 2\nstart = [0, 0]\ngoal = [0, 8]\n"
            ),
            "s.toml:9:1: plane.robots.formation: a formation stands in cells; give it as the top-level robots.formation, or",
        ),
        (group("radius_m = -1"), "s.toml:9:12: plane.group[0].radius_m: -1 is out of range; give 0.001 to 65 metres"),
        (
            group("max_speed_mps = 0.5\ncruise_mps = 0.6"),
            "s.toml:10:14: plane.group[0].cruise_mps: 0.6 is out of range",
        ),
        (group("colour = 1"), "s.toml:9:1: plane.group[0].colour: unknown field `colour`"),
        (
            group("law = \"lattice\""),
            "s.toml:8:1: plane.group[0].lattice: the law \"lattice\" needs `spacing_m`: distance of neighbours in the lattice (d); give spacing_m, 0.01 to 100 metres, in [plane.group[0].lattice]",
        ),
        (group("law = \"route\""), "s.toml:9:7: plane.group[0].law: this law goes from cell to cell; give [terrain]"),
        (group("orca = { share = 2 }"), "s.toml:9:18: plane.group[0].orca.share: 2 is out of range; give 0 to 1"),
        (
            group("safety = \"none\"\norca = { share = 0.5 }"),
            "s.toml:10:8: plane.group[0].orca: these robots have the safety layer \"none\"; give plane.group[0].safety",
        ),
        (
            group("boids = { crowded_m = 1, closest_m = 2 }"),
            "s.toml:9:9: plane.group[0].boids: these robots have the law \"waypoint\"; give law = \"boids\", or leave",
        ),
        (
            format!("{HEAD}{PLANE}[[plane.group]]\nrobots = {{ }}\n"),
            "s.toml:7:10: plane.group[0].robots: a field is missing; give exactly one of",
        ),
        (
            format!("{HEAD}{PLANE}[[plane.group]]\nrobots.list = [{{ start_m = [nan, 0] }}]\n"),
            "s.toml:7:29: plane.group[0].robots.list[0].start_m[0]: NaN is out of range",
        ),
        (
            format!("{HEAD}{PLANE}{TWO}[[plane.group]]\nradius_m = 3\nrobots.list = [{{ start_m = [6.0, 0] }}]\n"),
            "s.toml:6:1: plane.robots: robots 2 and 3 overlap at the start; put them 3.2 m apart",
        ),
        (
            robots("list = [{ start_m = [0, 0], radius_m = 66 }]"),
            "s.toml:7:40: plane.robots.list[0].radius_m: 66 is out of range",
        ),
        (
            robots("list = [{ start_m = [0, 0], max_speed_mps = 0 }]"),
            "s.toml:7:45: plane.robots.list[0].max_speed_mps: 0 is out of range",
        ),
        (
            robots("list = [{ start_m = [0, 0], via_m = [[1, 0]] }]"),
            "s.toml:7:37: plane.robots.list[0].via_m: a way needs an end; give goal_m too",
        ),
        (
            robots("list = [{ start_m = [0, 0], goal_m = [9, 9], via_m = [[1, 0], [2, 0], [3, 0], [4, 0]] }]"),
            "s.toml:7:54: plane.robots.list[0].via_m: 4 places on the way are too many; give at most 3",
        ),
        (
            robots("list = [{ start_m = [0, 0], goal_m = [9, 9], via_m = [[1, 0], [nan, 0]] }]"),
            "s.toml:7:64: plane.robots.list[0].via_m[1][0]: NaN is out of range",
        ),
        (
            format!(
                "{HEAD}{PLANE}law = \"lattice\"\nlattice = {{ spacing_m = 1 }}\n[plane.robots]\n\
                 list = [{{ start_m = [0, 0], goal_m = [9, 9], via_m = [[1, 0]] }}]\n"
            ),
            "s.toml:9:54: plane.robots.list[0].via_m: robots with the law \"lattice\" go by no places",
        ),
        (
            after("[[plane.intruder]]\nstart_m = [9, 9]\nvelocity_mps = [33, 0]\nradius_m = 1\n"),
            "s.toml:10:17: plane.intruder[0].velocity_mps[0]: 33 is out of range",
        ),
        (
            after("[[plane.intruder]]\nstart_m = [9, inf]\nvelocity_mps = [1, 0]\nradius_m = 1\n"),
            "s.toml:9:15: plane.intruder[0].start_m[1]: inf is out of range",
        ),
        (
            after("[[plane.intruder]]\nstart_m = [9, 9]\nvelocity_mps = [1, 0]\nradius_m = 0\n"),
            "s.toml:11:12: plane.intruder[0].radius_m: 0 is out of range",
        ),
        (
            after("[[plane.intruder]]\nstart_m = [0, 1]\nvelocity_mps = [1, 0]\nradius_m = 1\n"),
            "s.toml:6:1: plane.robots: robot 1 starts in an intruder; keep its start 0.2 m away",
        ),
        (
            after(
                "[[plane.intruder]]\nstart_m = [9, 9]\nvelocity_mps = [1, 0]\nradius_m = 1\n\
                 [authentication]\nkey = \"passphrase: open sesame now\"\n",
            ),
            "s.toml:8:1: plane.intruder[0].heard: an intruder does not have the key, so robots reject its beacons; give heard = false",
        ),
    ];
    refused(&cases);
}

#[test]
fn groups_and_robots_override_fields_and_inherit_the_rest() {
    let text = format!(
        "{HEAD}{PLANE}sight_m = 5\nsafety = \"template_2k\"\norca = {{ share = 0.6 }}\n{}\
         [[plane.group]]\nradius_m = 0.5\nmax_speed_mps = 2\nrobots.list = [{{ start_m = [9, 9], goal_m = [0, 9] }}, \
         {{ start_m = [6, 9], radius_m = 1 }}]\n\
         [[plane.group]]\nlaw = \"boids\"\nboids = {{ crowded_m = 1, closest_m = 2 }}\nsafety = \"none\"\n\
         robots.cloud = {{ count = 9, from_m = [0, 0], to_m = [4, 4] }}\n",
        TWO.replace(
            "start_m = [3, 0, 1]",
            "start_m = [3, 0], max_speed_mps = 0.5, goal_m = [0, 0], via_m = [[3, 3], [2, 2]]"
        )
    );
    let plane = setup(&text);
    let bodies: Vec<_> = (0..4).map(|i| plane.group(i)).map(|g| (g.radius_m, g.abilities.max_speed_mps)).collect();
    assert_eq!(bodies, [(0.2, 1.0), (0.2, 0.5), (0.5, 2.0), (1.0, 2.0)]);
    let share = |index: usize| match plane.group(index).safety {
        LayerSettings::Template2k(TableSettings(orca)) => orca.params.share,
        other => panic!("{other:?}"),
    };
    assert_eq!([0, 1, 2, 3].map(share), [0.6; 4]);
    let large = plane.group(2);
    assert_eq!((large.cruise_mps, large.tolerance_m, large.sight_m), (2.0, 0.05, 5.0));
    let ways: Vec<_> = plane.starts[1].places.iter().map(|target| target.position_m).collect();
    assert_eq!(ways, [[3.0, 3.0, 0.0], [2.0, 2.0, 0.0], [0.0; 3]]);
    assert_eq!((plane.starts.len(), plane.group(12).law.name()), (13, "boids"));
    assert_eq!(plane.group(12).safety, LayerSettings::None(UnguardedSettings));
}

#[test]
fn groups_in_metres_mix_with_robots_in_cells_and_may_use_routes() {
    let text = by_route("{ start_m = [1, 1], goal_m = [9, 5] }").replace("[plane]\n", "[plane]\nlaw = \"route\"\n");
    let text = format!(
        "{text}[[plane.group]]\nlaw = \"waypoint\"\nsafety = \"none\"\nrobots.list = [{{ start_m = [17, 17] }}]\n"
    );
    let text = format!("{text}[robots]\nlist = [{{ id = 4, start = [3, 3], goal = [5, 5] }}]\n");
    let scenario = parse(&text).unwrap_or_else(|error| panic!("{error}\n{text}"));
    let robots: Vec<_> = scenario.robots.iter().map(|robot| (robot.id.0, robot.start, robot.goal)).collect();
    let cell = Cell::new;
    assert_eq!(robots, [(4, cell(3, 3), cell(5, 5)), (5, cell(0, 0), cell(4, 2)), (6, cell(0, 0), cell(0, 0))]);
    let kinds: Vec<_> = (0..3).map(|index| (scenario.law_of(index).name(), scenario.safety(index).name())).collect();
    let expected = [("route", "orca"), ("route", "orca"), ("waypoint", "none")];
    assert_eq!(kinds, expected);
}

#[test]
fn formations_differ_by_ids_and_groups_by_flocks() {
    let one = in_formation("start = [0, 0], goal = [0, 8]");
    let text = format!(
        "{one}[[plane.group]]\nlaw = \"formation\"\nsafety = \"none\"\nradius_m = 0.3\n\
         robots.formation = {{ rows = 1, columns = 3, spacing = [2, 2], start = [0, 4], goal = [3, 4] }}\n\
         [[plane.group]]\nlaw = \"waypoint\"\nrobots.list = [{{ start_m = [13, 17] }}]\n\
         [robots]\nlist = [{{ id = 4, start = [8, 8], goal = [5, 5] }}]\n"
    );
    let text = text.replace("[plane]\n", "[plane]\nlaw = \"route\"\n");
    let scenario = parse(&text).unwrap_or_else(|error| panic!("{error}\n{text}"));
    let members: Vec<_> = scenario.formations.iter().map(|formation| formation.members()).collect();
    assert_eq!(members, [1..3, 3..6]);
    let named = |index: usize| match scenario.law(index) {
        LawSetup::BuiltIn(LawSettings::Formation(FormationSettings { template, .. })) => {
            (template.slot, template.entries.iter().map(|entry| entry.id.0).collect::<Vec<_>>())
        }
        other => panic!("{other:?}"),
    };
    // Robot 4 stands in a cell, 5 and 6 are the first formation, 7 to 9 the second.
    let templates: Vec<_> = (1..6).map(named).collect();
    let expected: [(u8, &[u32]); 5] = [(0, &[6]), (1, &[5]), (0, &[8, 9]), (1, &[7, 9]), (2, &[8, 7])];
    assert_eq!(templates, expected.map(|(slot, ids)| (slot, ids.to_vec())));
    let plane = scenario.plane().expect("a plane");
    let flocks: Vec<_> = (0..7).map(|index| plane.group(index).flock).collect();
    assert_eq!(flocks, [0, 1, 1, 2, 2, 2, 3], "a flock for each group");
    let safety: Vec<_> = (0..7).map(|index| scenario.safety(index).name()).collect();
    assert_eq!((safety[1], safety[4], plane.group(4).radius_m), ("orca", "none", 0.3));
    let parts: Vec<_> = scenario.origin.parts.iter().map(|part| (part.table.as_str(), part.members.clone())).collect();
    let of = |index: usize| ["plane", "plane.group[0]", "plane.group[1]", "plane.group[2]"][index];
    assert_eq!(parts, [(of(0), 0..1), (of(1), 1..3), (of(2), 3..6), (of(3), 6..7)]);
    assert_eq!(scenario.numbered_edges(), [(5, 6), (7, 8), (8, 9)]);
}
