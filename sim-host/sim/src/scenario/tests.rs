mod mistakes;
mod mutated;
mod nonsense;
mod readme;

use super::*;
use proptest::prelude::*;
use staya_controller::agent::{FormationSettings, LawSettings};
use staya_controller::cost::Gain;
use staya_controller::formation::{FormationParams, Prediction, Recovery};
use staya_controller::grid::Cell;
use staya_controller::negotiation::Moves;
use staya_controller::route::{ExitRule, Replan};
use staya_controller::shuffle::Sharpness;
use staya_papers::LookaheadSettings;
use staya_papers::criteria::PublishedParams;
use std::fs;

const MAP: &str = "type octile\nheight 3\nwidth 4\nmap\n....\n.@..\n....\n";

const HEAD: &str = "name = \"t\"\nticks = 5\n[terrain]\nfile = \"m.map\"\n";

fn parse(text: &str) -> Result<Scenario, ScenarioError> {
    let dir = tempfile::tempdir().expect("temporary folder");
    fs::write(dir.path().join("m.map"), MAP).expect("write");
    let path = dir.path().join("s.toml");
    fs::write(&path, text).expect("write");
    Scenario::load(&path, &Overrides::default())
}

fn refusal(text: &str) -> String {
    let error = parse(text).expect_err("a refusal").to_string();
    let at = error.find("s.toml").unwrap_or_else(|| panic!("names no file: {error}"));
    error[at..].to_owned()
}

fn with_robots(robots: &str) -> String {
    format!("{HEAD}[robots]\n{robots}\n")
}

#[test]
fn the_smallest_scenario_has_the_documented_defaults() {
    let scenario = parse(&with_robots("list = [{ start = [0, 0], goal = [3, 2] }]")).expect("good");
    assert_eq!((scenario.seed, scenario.ticks, scenario.tick_us), (0, 5, 1_000_000));
    assert!(matches!(scenario.movement, Movement::Cells(rules) if rules == MoveRules::default()));
    assert_eq!(scenario.radio, RadioParams::default());
    let [robot] = scenario.robots[..] else { panic!("one robot") };
    assert_eq!((robot.id, robot.start, robot.goal), (RobotId(1), Cell::new(0, 0), Cell::new(3, 2)));
}

#[test]
fn the_command_line_overrides_the_file() {
    let text = with_robots("list = [{ start = [0, 0], goal = [3, 2] }]");
    let dir = tempfile::tempdir().expect("temporary folder");
    fs::write(dir.path().join("m.map"), MAP).expect("write");
    let overrides = Overrides { seed: Some(77), ticks: Some(9) };
    let scenario = Scenario::parse(&text, &dir.path().join("s.toml"), &overrides).expect("good");
    assert_eq!((scenario.seed, scenario.ticks), (77, 9));
}

#[test]
fn a_law_gets_the_moves_of_the_bodies() {
    let robots = with_robots("list = [{ start = [0, 0], goal = [3, 2] }]");
    let of = |grid: &str| {
        let scenario = parse(&format!("{robots}[grid]\nlaw = \"negotiation\"\n{grid}")).expect("good");
        let Movement::Cells(rules) = scenario.movement else { panic!("robots in cells") };
        let LawSetup::Added(law) = scenario.laws.on_grid else { panic!("negotiation") };
        (rules.orthogonal, rules.simultaneous, law.moves)
    };
    assert_eq!(of(""), (false, false, Moves::EIGHT));
    assert_eq!(of("moves = 4\nsimultaneous = true"), (true, true, Moves::FOUR));
    assert_eq!(of("moves = 4"), (true, false, Moves { diagonals: false, circles: false }));
}

#[test]
fn robots_that_negotiate_in_the_plane_fit_around_corners_and_have_goals_in_cells() {
    let with = |robots: &str, plane: &str| {
        format!("{HEAD}cell_m = 0.5\n{robots}[plane]\nmax_speed_mps = 1\nlaw = \"negotiation\"\n{plane}")
    };
    let cells = "[robots]\nlist = [{ start = [0, 0], goal = [3, 2] }]\n";
    let scenario = parse(&with(cells, "radius_m = 0.15\n")).expect("good");
    let LawSetup::Added(law) = scenario.law(0) else { panic!("negotiation") };
    assert_eq!(law.cruise_mps, Some(1.0));
    let wide = refusal(&with(cells, "radius_m = 0.2\n"));
    assert!(wide.starts_with("s.toml:11:12: plane.radius_m: 0.2 m are more than 0.35 cells"), "{wide}");
    let in_metres = "radius_m = 0.15\n[plane.robots]\nlist = [{ start_m = [0.25, 0.25], goal_m = [1.75, 1.25] }]\n";
    let said = refusal(&with("", in_metres));
    assert!(said.contains("plane.law: this law goes from cell to cell; give [terrain] and the top-level"), "{said}");
}

#[test]
fn a_missing_file_is_named() {
    let error = Scenario::load(Path::new("no/such.toml"), &Overrides::default()).expect_err("none");
    assert!(error.to_string().starts_with("no/such.toml: "), "{error}");
}

#[test]
fn the_order_of_a_list_matters_only_for_ids() {
    let one = parse(&with_robots(
        "list = [{ id = 7, start = [0, 0], goal = [3, 2] }, { id = 3, start = [1, 0], goal = [2, 2] }]",
    ));
    let two = parse(&with_robots(
        "list = [{ id = 3, start = [1, 0], goal = [2, 2] }, { id = 7, start = [0, 0], goal = [3, 2] }]",
    ));
    let (one, two) = (one.expect("good"), two.expect("good"));
    assert_eq!(one.robots, two.robots);
    assert_eq!(one.robots[0].id, RobotId(3));
}

#[test]
fn grid_formation_is_numbered_row_by_row_with_edges_to_both_sides() {
    let text = with_robots("formation = { rows = 2, columns = 2, spacing = [1, -1], start = [2, 2], goal = [2, 1] }");
    let scenario = parse(&text).expect("good");
    let starts = scenario.robots.iter().map(|r| (r.id.0, r.start.x, r.start.y));
    assert!(starts.eq([(1, 2, 2), (2, 3, 2), (3, 2, 1), (4, 3, 1)]));
    let edges = &scenario.formations[0].edges;
    assert_eq!(*edges, [(0, 1), (0, 2), (1, 3), (2, 3)]);
}

#[test]
fn only_the_top_leader_of_a_formation_needs_a_free_goal() {
    let at = |x| {
        with_robots(&format!(
            "formation = {{ places = [[0, 0], [-1, 0]], edges = [[2, 1], [1, 2]], start = [3, 2], goal = [{x}, 1] }}"
        ))
    };
    let scenario = parse(&at(2)).expect("robot 2 moves its goal itself");
    let formation = &scenario.formations[0];
    assert_eq!(formation.edges, [(0, 1)]);
    assert!(refusal(&at(1)).contains("the goal (1, 1) of robot 1 is in a wall"));
}

#[test]
fn scattered_goals_are_far_enough_and_hills_have_a_shape() {
    let land = |rest: &str| {
        format!("name = 't'\nticks = 5\n[terrain.natural]\nwidth = 30\nheight = 30\nobstacles = 9\n{rest}")
    };
    let far = parse(&land("[robots.scattered]\ncount = 40\nleast = 12\n")).expect("good");
    assert!(far.robots.iter().all(|robot| robot.start.chebyshev(robot.goal) >= 12));
    let error = parse(&land("[robots.scattered]\ncount = 4\nleast = 40\n")).expect_err("too far").to_string();
    assert!(error.contains("no free goal is left within reach"), "{error}");
    let cells = |hills: &str| {
        let text = land(&format!("hills = '{hills}'\n[robots.scattered]\ncount = 1\n"));
        parse(&text).expect("good").land.terrain.cells().to_vec()
    };
    let even = parse(&land("[robots.scattered]\ncount = 1\n")).expect("good").land.terrain.cells().to_vec();
    assert!(cells("even") == even && cells("rough") != even && cells("wide") != even);
}

#[test]
fn scattered_robots_fill_even_a_full_map_and_keep_within_travel() {
    let scenario = parse(&with_robots("scattered = { count = 11 }")).expect("good");
    assert_eq!(scenario.robots.len(), 11);
    let scenario = parse(&with_robots("scattered = { count = 5, travel = 1 }"));
    for robot in scenario.expect("good").robots {
        assert!(robot.start.chebyshev(robot.goal) <= 1);
    }
}

#[test]
fn a_multi_agent_scenario_gives_starts_and_goals() {
    let dir = tempfile::tempdir().expect("temporary folder");
    fs::write(dir.path().join("m.map"), MAP).expect("write");
    let scen = "version 1\n0\tm.map\t4\t3\t0\t0\t3\t2\t4.2\n0\tm.map\t4\t3\t1\t0\t2\t2\t3.0\n";
    fs::write(dir.path().join("m.scen"), scen).expect("write");
    let load = |count| {
        let text = with_robots(&format!("scen = {{ file = \"m.scen\", count = {count} }}"));
        Scenario::parse(&text, &dir.path().join("s.toml"), &Overrides::default())
    };
    let robots = load(2).expect("good").robots;
    assert_eq!((robots[0].start, robots[0].goal), (Cell::new(0, 2), Cell::new(3, 0)));
    for count in [0, 3] {
        let error = load(count).expect_err("too few or too many").to_string();
        assert!(error.contains("robots.scen.count"), "{error}");
    }
}

#[test]
fn misnumbered_robots_claim_another_id_and_mistakes_are_named() {
    let with = |tables: &str| {
        let list = "list = [{ start = [0, 0], goal = [1, 2] }, { start = [1, 0], goal = [2, 2] }]";
        format!("{}{tables}", with_robots(list))
    };
    let table = |robot: u32, number: u32| format!("[[misnumbered]]\nrobot = {robot}\nnumber = {number}\n");
    let scenario = parse(&with(&table(2, 1))).expect("good");
    assert_eq!(scenario.robots.iter().map(|robot| robot.id.0).collect::<Vec<_>>(), [1, 2]);
    assert_eq!(scenario.numbered().iter().map(|robot| robot.id.0).collect::<Vec<_>>(), [1, 1]);
    let cases = [
        (table(3, 1), "misnumbered[0].robot: there is no robot 3; give the number of a robot"),
        (table(2, 2), "misnumbered[0].number: robot 2 has this number anyway; give that of another"),
        (table(2, 0), "misnumbered[0].number: 0 is not a valid robot number; give 1 to 2147483646"),
        (table(2, 1) + &table(2, 7), "misnumbered[1].robot: robot 2 has been given a number before; give each"),
    ];
    for (tables, expected) in cases {
        let refusal = refusal(&with(&tables));
        assert!(refusal.contains(expected), "{refusal}");
    }
}

#[test]
fn fault_times_are_converted_to_ticks() {
    let text = format!(
        "tick_s = 0.5\n{}[[fault]]\nrobot = 1\nat_s = 1.2\ndown_s = 1\n",
        with_robots("list = [{ start = [0, 0], goal = [1, 2] }]")
    );
    let fault = Fault { robot: RobotId(1), from_tick: 3, to_tick: 5 };
    assert_eq!(parse(&text).expect("good").events.faults, [fault]);
}

const FORMATION: &str = "formation = { rows = 1, columns = 2, spacing = [1, 1], start = [0, 0], goal = [2, 0] }";

fn formation(law: &LawSetup) -> &FormationSettings {
    match law {
        LawSetup::BuiltIn(LawSettings::Formation(settings)) | LawSetup::Lookahead(LookaheadSettings(settings)) => {
            settings
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn parameters_of_routes_and_formations_are_checked() {
    let with = |rest: &str| format!("{}{rest}", with_robots(FORMATION));
    let usual = parse(&with("")).expect("good").laws.on_grid;
    assert_eq!(usual, LawSetup::BuiltIn(LawSettings::Formation(FormationSettings::default())));
    let scenario = parse(&with(
        "[grid]\ncorner_cutting = true\nradius = 16\n[grid.formation]\nexit = \"ray\"\n\
         a2 = 0.5\nhalved_per_ticks = 2\nhalt_cells = 2\nplace_gain = 4095\nfootprint = 1\n\
         prediction = \"reflexive\"\nrecovery = \"def\"\nwaits = true\ncloses_ranks = true\n",
    ));
    let law = scenario.expect("good").laws.on_grid;
    let FormationSettings { route, params, .. } = formation(&law);
    assert_eq!((route.params.radius, route.params.exit), (16, ExitRule::Ray));
    assert_eq!(route.params.a2, Gain::from_sixteenths(8));
    assert!(route.params.corner_cutting && params.closes_ranks);
    assert_eq!(route.sharpness, Sharpness::HalvedPer(Gain::from_int(2)));
    assert_eq!((params.halt_lag, params.resume_lag), (140, 140));
    assert_eq!((params.gain, params.footprint), (Gain::from_int(4095), 16));
    assert_eq!((params.prediction, params.recovery), (Prediction::Reflexive, Recovery::Def));
    for (row, expected) in [
        ("a3 = -1", "a3: -1 is out of range; give 0 to 4095"),
        ("a0 = nan", "a0: NaN is out of range"),
        ("exit = \"door\"", "exit: unknown value `door`; give one of `best`, `ray`"),
        ("exit = 1", "exit: 1 is not a name in quotes"),
        ("waits = \"no\"", "waits: \"no\" is not true or false"),
        ("replan = \"until_changed\"", "replan: robots in formation search in each cell"),
        ("eps_cells = 1.5", "eps_cells: 1.5 is not a whole number; give 2, or another whole number"),
        ("place_gain = 4096", "place_gain: 4096 is out of range"),
        ("resume_cells = 5", "resume_cells: more than halt_cells; give at most halt_cells"),
        ("footprint = 1.1", "footprint: 1.1 is out of range"),
        ("gain = 1", "gain: this field is of an earlier version; write `place_gain = 1` in [grid.formation]"),
        ("crowd = 2", "crowd: unknown field `crowd`"),
    ] {
        let refusal = refusal(&with(&format!("[grid.formation]\n{row}\n")));
        let column = if row.starts_with("crowd") { 1 } else { row.find("= ").expect("a field") + 3 };
        let expected = format!("s.toml:8:{column}: grid.formation.{expected}");
        assert!(refusal.starts_with(&expected), "{refusal}\n{expected}");
    }
    for (rest, expected) in [
        ("[grid]\nradius = 0\n", "s.toml:8:10: grid.radius: 0 is out of range; give 1 to 16 cells"),
        (
            "[grid]\nlaw = \"other\"\n",
            "s.toml:8:7: grid.law: this program has no law \"other\"; it has waypoint, lattice",
        ),
        (
            "[grid]\nlaw = \"formations\"\n",
            "s.toml:8:7: grid.law: this program has no law \"formations\"; did you mean \"formation\"?",
        ),
        ("[grid]\nlaw = 3\n", "s.toml:8:7: grid.law: 3 is not a name in quotes"),
        ("[grid]\nradius = 17\n", "s.toml:8:10: grid.radius: 17 is out of range"),
        (
            "[grid]\nlaw = \"route\"\n",
            "s.toml:8:7: grid.law: robots.formation and the law \"route\" do not go together",
        ),
        ("[grid]\nlaw = \"boids\"\n", "s.toml:8:7: grid.law: the law \"boids\" goes by velocities, and these robots"),
        ("[grid]\nlaw = \"waypoint\"\n", "s.toml:8:7: grid.law: the law \"waypoint\" goes by velocities"),
    ] {
        let refusal = refusal(&with(rest));
        assert!(refusal.starts_with(expected), "{refusal}");
    }
}

#[test]
fn a_formation_has_the_law_of_its_file() {
    let with = |law: &str, rest: &str| {
        let table = if law.is_empty() { "formation" } else { law };
        let law = if law.is_empty() { String::new() } else { format!("law = \"{law}\"\n") };
        format!("{}[grid]\n{law}[grid.{table}]\n{rest}", with_robots(FORMATION))
    };
    let ours = parse(&with("", "waits = false\n")).expect("good").laws.on_grid;
    assert!(!formation(&ours).waits);
    let paper = "eps_cells = 3\nhalt_cells = 6\nresume_cells = 2\ncrowd = 2\n";
    let paper = parse(&with("formation_paper", paper)).expect("good");
    let expected = PublishedParams { eps: 3, halt: 420, resume: 140, crowd: 2, ..PublishedParams::default() };
    let LawSetup::Published(published) = &paper.laws.on_grid else { panic!("the paper's") };
    assert_eq!((published.params, paper.laws.on_grid.eps()), (expected, 3));
    assert!(matches!(paper.law(1), LawSetup::Published(settings) if settings.template.slot == 1));
    let ahead = parse(&with("formation_lookahead", "")).expect("good");
    assert_eq!(formation(&ahead.laws.on_grid).params, FormationParams::looking_ahead());
    assert_eq!(formation(&ahead.law(1)).template.slot, 1);
    assert_ne!(ahead.fingerprint(), parse(&with("", "")).expect("good").fingerprint());
    let low = parse(&with("formation_paper", "halt_cells = 1\n")).expect("good").laws.on_grid;
    assert!(matches!(low, LawSetup::Published(settings) if settings.params.resume == 70), "resume is at most halt");
    for (law, rest, expected) in [
        ("formation_paper", "lead_cells = 2\n", "grid.formation_paper.lead_cells: unknown field `lead_cells`"),
        (
            "formation_lookahead",
            "waits = false\nresume_cells = 2\n",
            "grid.formation_lookahead.resume_cells: with waits = false no robot waits",
        ),
        ("formation_paper", "replan = \"until_changed\"\n", "grid.formation_paper.replan: robots in formation search"),
        ("formation_lookahead", "crowd = 2\n", "grid.formation_lookahead.crowd: unknown field `crowd`"),
        ("formation_lookahead", "resume_cells = 3.1\n", "grid.formation_lookahead.resume_cells: more than halt_cells"),
        ("", "waits = false\nhalt_cells = 3\n", "grid.formation.halt_cells: with waits = false no robot waits"),
        ("formation_paper", "halt_cells = 938\n", "grid.formation_paper.halt_cells: 938 is out of range"),
    ] {
        let refusal = refusal(&with(law, rest));
        assert!(refusal.contains(expected), "{refusal}");
    }
}

#[test]
fn values_of_another_law_are_refused() {
    let list = with_robots("list = [{ start = [0, 0], goal = [2, 0] }]");
    let scenario = parse(&format!("{list}[grid.route]\nreplan = \"until_changed\"\n")).expect("good");
    assert_eq!(scenario.route().replan, Replan::UntilChanged);
    for (rest, expected) in [
        (
            "[grid.formation]\neps_cells = 2\n",
            "s.toml:7:1: grid.formation: these robots have the law \"route\"; give law = \"formation\", or leave this table out",
        ),
        (
            "[grid.route]\na3 = 2\n[grid.formation]\neps_cells = 2\n",
            "s.toml:9:1: grid.formation: these robots have the law \"route\"; give law = \"formation\"",
        ),
        ("[grid]\nlaw = \"formation\"\n", "s.toml:8:7: grid.law: robots.formation and the law \"formation\" do not go"),
    ] {
        let refusal = refusal(&format!("{list}{rest}"));
        assert!(refusal.starts_with(expected), "{refusal}");
    }
}

#[test]
fn fields_of_earlier_versions_are_refused_with_the_line_to_write() {
    let list = with_robots("list = [{ start = [0, 0], goal = [2, 0] }]");
    let in_plane = "[plane]\nradius_m = 0.2\nmax_speed_mps = 1\n";
    for (rest, expected) in [
        (
            "[route]\nradius = 4\n",
            "s.toml:8:10: route.radius: this field is of an earlier version; write `radius = 4` in [grid];",
        ),
        (
            "[route]\na3 = 4\n",
            "s.toml:8:6: route.a3: this field is of an earlier version; write `a3 = 4` in [grid.route];",
        ),
        (
            "[formation]\nrho = 4\n",
            "formation.rho: this field is of an earlier version; write `rho = 4` in [robots.formation];",
        ),
        ("[formation]\nlaw = \"paper\"\n", "write `law = \"formation_paper\"` in [grid];"),
        (
            "[law]\nname = \"negotiation\"\n",
            "law: this field is of an earlier version; write `law = \"negotiation\"` in [grid];",
        ),
        (&format!("{in_plane}guidance = \"route\"\n"), "write `law = \"route\"` in [plane];"),
        (&format!("{in_plane}[route]\nexit = \"ray\"\n"), "write `exit = \"ray\"` in [plane.route];"),
        (
            &format!("{in_plane}[[plane.group]]\nlattice = {{ c_alpha = 3 }}\n"),
            "plane.group[0].lattice.c_alpha: this field is of an earlier version; write `c1_alpha = 3` in [plane.group[0].lattice]",
        ),
    ] {
        let refusal = refusal(&format!("{list}{rest}"));
        assert!(refusal.contains(expected) && refusal.contains("`staya migrate FILE` rewrites a file"), "{refusal}");
    }
}

#[test]
fn maps_are_shared_if_robots_plan_on_terrain() {
    let list = with_robots("list = [{ start = [0, 0], goal = [2, 0] }]");
    let with = |rest: &str| format!("{list}{rest}");
    assert_eq!(parse(&list).expect("good").laws.maps, None);
    let silent = parse(&with("[maps]\nshare = false\n")).expect("good");
    assert_eq!((silent.laws.maps, silent.fingerprint()), (None, parse(&list).expect("good").fingerprint()));
    let shared = parse(&with("[maps]\nshare = true\n")).expect("good");
    assert_eq!(shared.laws.maps, Some(MapParams::default()));
    assert_ne!(shared.fingerprint(), silent.fingerprint());
    let brief = parse(&with("[maps]\nshare = true\nforget_after_s = 1.5\n")).expect("good");
    assert_eq!(brief.laws.maps.map(|maps| maps.forget_after.as_micros()), Some(1_500_000));
    for (rest, expected) in [
        (
            "[maps]\nforget_after_s = 9\n",
            "s.toml:8:18: maps.forget_after_s: no robot shares a map; give maps.share = true",
        ),
        (
            "[maps]\nshare = true\nforget_after_s = 0.5\n",
            "s.toml:9:18: maps.forget_after_s: 0.5 is out of range; give 1 to 2100",
        ),
        ("[maps]\nshares = true\n", "s.toml:8:1: maps.shares: unknown field `shares`"),
        ("[maps]\nshare = true\n[grid.route]\nexit = \"ray\"\n", "s.toml:8:9: maps.share: exit = \"ray\""),
        ("[maps]\nshare = true\n[scouting]\n", "s.toml:8:9: maps.share: robots that have a map"),
        ("[maps]\nshare = true\n[grid.route]\nreplan = \"until_changed\"\n", "s.toml:8:9: maps.share: replan"),
    ] {
        let refusal = refusal(&with(rest));
        assert!(refusal.starts_with(expected), "{refusal}");
    }
}

#[test]
fn a_formation_too_large_for_the_controller_is_refused() {
    let star = |leaves: usize| {
        let places: Vec<_> = (0..=leaves).map(|i| format!("[{}, {}]", i % 3, i / 3)).collect();
        let edges: Vec<_> = (2..=leaves + 1).map(|i| format!("[1, {i}]")).collect();
        let (places, edges) = (places.join(", "), edges.join(", "));
        with_robots(&format!("formation = {{ places = [{places}], edges = [{edges}], start = [0, 0], goal = [0, 0] }}"))
    };
    let refused = |text: &str, expected: &str| {
        let refusal = refusal(text);
        assert!(refusal.contains(expected), "{refusal}");
    };
    let too_many =
        "robots.formation.rho: a robot would have more than 8 neighbours in the formation; give a smaller rho";
    refused(&star(9), too_many);
    refused(&star(8), "is in a wall");
    refused(&star(255), "256 robots are more than a formation holds; give at most 255");
    let wide = "formation = { rows = 16, columns = 16, start = [0, 0], goal = [0, 0] }";
    refused(&with_robots(wide), "16 rows of 16 robots do not fit any map or any memory");
    let rho =
        with_robots("formation = { rho = 5, rows = 3, columns = 4, spacing = [1, 1], start = [0, 0], goal = [0, 0] }");
    refused(&rho, "s.toml:6:21: robots.formation.rho");
    refused(
        &rho.replace("rho = 5", "rho = 0"),
        "s.toml:6:21: robots.formation.rho: with rho = 0 no robot knows its neighbours; give 1 or more",
    );
    let chain = |edges: &str| {
        with_robots(&format!(
            "formation = {{ places = [[0, 0], [1, 0], [2, 0], [3, 0]], edges = [{edges}], start = [0, 0], goal = [0, 2] }}"
        ))
    };
    parse(&chain("[3, 4], [2, 3], [1, 2]")).expect("all are joined");
    refused(
        &chain("[1, 2], [3, 4]"),
        "robots.formation.edges: no edges lead from robot 1 to robot 3; join every robot",
    );
    refused(&chain(""), "no edges lead from robot 1 to robot 2");
}

proptest! {
    #[test]
    fn arbitrary_text_never_panics(text in "\\PC{0,200}") {
        let _ = Scenario::parse(&text, Path::new("x.toml"), &Overrides::default());
    }

    #[test]
    fn arbitrary_changes_to_a_good_scenario_never_panic(
        changes in prop::collection::vec((0..600_usize, "[-0-9a-z\\[\\]{}=., \\n\"]{0,3}"), 1..6),
    ) {
        let mut text: Vec<char> = format!(
            "tick_s = 0.5\n{HEAD}crop = {{ x = 0, y = 0, width = 4, height = 3 }}\n[grid]\nnorm = \"chebyshev\"\n[radio]\nrange_m = 3\n\
             loss = 0.5\nburst = {{ share = 0.1, mean_ms = 1000 }}\nblackout_s = [[1, 2]]\n[robots]\n\
             formation = {{ rows = 1, columns = 2, spacing = [1, 1], start = [0, 0], goal = [2, 0], rho = 2 }}\n[grid.formation]\na1 = 2\n[[fault]]\nrobot = 1\nat_s = 3\n"
        ).chars().collect();
        for (at, change) in changes {
            let at = at % text.len();
            let end = (at + change.len()).min(text.len());
            text.splice(at..end, change.chars());
        }
        let _ = parse(&text.into_iter().collect::<String>());
    }
}
