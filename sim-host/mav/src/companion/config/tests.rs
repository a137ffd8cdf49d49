use super::*;
use staya_sim::scenario::{Line, Read as _};

const SCENARIO: &str = "../scenarios/swap-circle.toml";

fn parse(text: &str) -> Result<Config, ScenarioError> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../companions");
    Config::parse(text, &folder.join("test.toml"))
}

fn text(top: &str, bottom: &str) -> String {
    format!(
        "scenario = \"{SCENARIO}\"\norigin = {{ latitude_deg = 55.75, longitude_deg = 37.62 }}\n{top}\n[[vehicle]]\nrobot = 3\n\
         link = \"udpin:127.0.0.1:14550\"\nautopilot = \"ardupilot-rover\"\n{bottom}\n"
    )
}

#[test]
fn defaults_are_cautious() {
    let config = parse(&text("", "")).unwrap();
    let [vehicle] = config.vehicles.as_slice() else {
        panic!("one vehicle");
    };
    assert_eq!((vehicle.robot, vehicle.index, vehicle.system), (RobotId(3), 2, 3));
    assert_eq!(vehicle.rules.entry, Entry::Wait);
    assert!(!vehicle.rules.arm && !vehicle.rules.takeoff);
    assert_eq!(vehicle.rules.stale, Duration::from_secs(1));
    assert_eq!(config.air, MediumSetup::Here);
}

#[test]
fn bodies_have_the_longer_lag_of_rules_and_scenario() {
    let lags = |rules: &str, scenario: &str| {
        let config = parse(&text(rules, "").replace(SCENARIO, scenario)).unwrap();
        let plane = config.scenario.plane().unwrap();
        assert_eq!((&plane.general, &plane.groups), (&config.plane.general, &config.plane.groups));
        let groups = core::iter::once(&plane.general).chain(&plane.groups);
        groups.map(|group| group.abilities.lag_s).collect::<Vec<_>>()
    };
    assert_eq!(lags("", SCENARIO), [0.5]);
    assert_eq!(lags("[rules]\nlag_s = 0", SCENARIO), [0.0]);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("lags.toml");
    let bodies = "name = \"lags\"\nticks = 9\ntick_s = 0.1\n[radio]\nrange_m = 99\n[plane]\nradius_m = 1\nmax_speed_mps = 2\n\
                  lag_s = 0.7\n[[plane.group]]\nrobots = { list = [{ start_m = [0, 0] }] }\nlag_s = 0.2\n\
                  [[plane.group]]\nrobots = { list = [{ start_m = [9, 0] }, { start_m = [0, 9] }] }\n";
    std::fs::write(&path, bodies).unwrap();
    assert_eq!(lags("[rules]\nlag_s = 0.4", path.to_str().unwrap()), [0.7, 0.4, 0.7]);
}

#[test]
fn vehicles_may_share_links_and_are_sorted() {
    let more = "[[vehicle]]\nrobot = 1\nsystem = 9\nlink = \"udpin:127.0.0.1:14550\"\nautopilot = \"px4\"\n\
                [[vehicle]]\nrobot = 2\nlink = \"tcpout:127.0.0.1:5760\"\nautopilot = \"px4-rover\"";
    let config = parse(&text("", more)).unwrap();
    let found = config.vehicles.iter().map(|v| (v.robot.0, v.system, v.line));
    assert_eq!(found.collect::<Vec<_>>(), [(1, 9, 0), (2, 2, 1), (3, 3, 0)]);
    assert_eq!(config.lines.len(), 2);
    assert_eq!(config.vehicles[0].kind, Kind::Px4Copter);
}

#[test]
fn only_flying_vehicles_have_heights() {
    let rules = "[rules]\nentry = \"once\"\narm = true\ntakeoff = true\naltitude_m = 10";
    let more =
        "[[vehicle]]\nrobot = 1\nlink = \"udpin:127.0.0.1:1\"\nautopilot = \"ardupilot-copter\"\naltitude_m = 12";
    let config = parse(&text(rules, more)).unwrap();
    let found = config.vehicles.iter().map(|v| (v.rules.takeoff, v.rules.altitude_m));
    assert_eq!(found.collect::<Vec<_>>(), [(true, Some(12.0)), (false, None)]);
}

#[test]
fn the_height_is_fixed_in_the_plane_and_commanded_in_space() {
    let config = parse(&text("", "")).unwrap();
    assert!(config.vehicles[0].rules.keeps_altitude);
    let config = parse(&text("", "").replace(SCENARIO, "../scenarios/bridge-fly.toml")).unwrap();
    assert!(!config.vehicles[0].rules.keeps_altitude);
}

#[test]
fn a_geographic_goal_is_converted_to_metres() {
    let config = parse(&text("", "goal_deg = [55.751, 37.62]")).unwrap();
    let goal = config.plane.starts[2].places[0].position_m;
    assert!(goal[0].abs() < 0.01 && (goal[1] - 111.34).abs() < 0.01, "{goal:?}");
    assert_eq!(config.scenario.plane().unwrap().starts[2].places[0].position_m, goal);
}

#[test]
fn each_network_to_other_companions_parses() {
    let config = parse(&text("[air]\nmulticast = \"239.1.2.3:5000\"", "")).unwrap();
    assert!(matches!(config.air, MediumSetup::Multicast { .. }));
    let config = parse(&text("[air]\nbind = \"0.0.0.0:5000\"\npeers = [\"10.0.0.2:5000\"]", ""));
    assert!(matches!(config.unwrap().air, MediumSetup::Peers { .. }));
    let config = parse(&text("[air]\ntunnel = true", "")).unwrap();
    assert_eq!(config.air, MediumSetup::Tunnel);
}

#[test]
fn errors_name_line_field_and_remedy() {
    let twice = "[[vehicle]]\nrobot = 3\nlink = \"udpin:127.0.0.1:14550\"\nautopilot = \"px4\"";
    let same_system = "[[vehicle]]\nrobot = 4\nsystem = 3\nlink = \"udpin:127.0.0.1:14550\"\nautopilot = \"px4\"";
    for (top, bottom, expected) in [
        ("nonsense = 1", "", "test.toml:3:1: nonsense"),
        ("[rules]\nstale_s = 0", "", "test.toml:4:11: rules.stale_s: 0 is out of range; give 0.1 to 60 seconds"),
        ("[rules]\nsetpoint_hz = 2", "", "rules.setpoint_hz: 2 is out of range; give 3 to 100 Hz"),
        ("[rules]\narm = true", "", "rules.arm: only the pilot arms with entry \"wait\""),
        ("[rules]\nentry = \"once\"\ntakeoff = true", "", "rules.takeoff: a takeoff needs an armed vehicle"),
        ("[rules]\nentry = \"always\"", "", "rules.entry"),
        ("[air]\ntunnel = true\nmulticast = \"239.1.2.3:5\"", "", "air: the network to other companions is ambiguous"),
        ("[air]\nmulticast = \"10.1.2.3:5\"", "", "`10.1.2.3:5` is not an IPv4 multicast group"),
        ("[air]\npeers = [\"10.1.2.3:5\"]", "", "air.peers: the network to other companions is ambiguous"),
        (
            "[air]\nbind = \"0.0.0.0:5\"\npeers = [\"there\"]",
            "",
            "test.toml:5:10: air.peers[0]: `there` is not an address",
        ),
        ("", "altitude_m = 0", "vehicle[0].altitude_m: 0 is out of range"),
        ("", "goal_deg = [-55.0, 37.62]", "vehicle[0].goal_deg: not a position near the origin"),
        (
            "",
            "system = 255",
            "test.toml:8:10: vehicle[0].system: 255 is not a MAVLink system id of a vehicle; give 1 to 254",
        ),
        ("", twice, "vehicle[1].robot: robot 3 is listed twice"),
        ("", same_system, "vehicle[1].system: system 3 is used twice on this link"),
    ] {
        let error = parse(&text(top, bottom)).expect_err(expected).to_string();
        assert!(error.contains(expected), "{error}\n{expected}");
    }
    for (from, to, expected) in [
        ("robot = 3", "robot = 99", "vehicle[0].robot: the scenario has no robot 99; give the number of one of its 16"),
        ("udpin:127.0.0.1:14550", "udp:1", "vehicle[0].link: `udp:1`: `udp` is not a kind of link"),
        ("ardupilot-rover", "betaflight", "vehicle[0].autopilot"),
        ("latitude_deg = 55.75", "latitude_deg = 95", "test.toml:2:10: origin: not a position on the Earth"),
        ("[[vehicle]]", "[other]", "other"),
        ("swap-circle", "no-such-file", "no-such-file.toml"),
        ("swap-circle", "six-robots", "scenario: its robots move from cell to cell"),
        (
            "swap-circle",
            "out-of-phase",
            "scenario: real vehicles have clocks of their own; remove [clocks] and phase_s",
        ),
    ] {
        let error = parse(&text("", "").replace(from, to)).expect_err(expected).to_string();
        assert!(error.contains(expected), "{error}\n{expected}");
    }
    let none = format!("scenario = \"{SCENARIO}\"\norigin = {{ latitude_deg = 5, longitude_deg = 7 }}\n");
    let error = parse(&none).expect_err("a configuration without a vehicle is invalid").to_string();
    assert!(error.contains("vehicle: no vehicle is listed; add [[vehicle]]"), "{error}");
}

fn names(lines: Vec<Line>) -> Vec<&'static str> {
    lines.into_iter().flat_map(|line| [vec![line.name], names(line.inner)].concat()).collect()
}

#[test]
fn documentation_lists_every_field() {
    let text = include_str!("../../../../../docs/autopilots.md");
    let names = names(ConfigFile::lines());
    let missing: Vec<_> = names.iter().filter(|name| !text.contains(&format!("{name}`"))).collect();
    assert!(missing.is_empty(), "{missing:?}");
    assert!(names.len() > 30, "only {} were found", names.len());
}

#[test]
fn every_example_and_its_scenario_are_valid() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../companions");
    let mut found = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let text = std::fs::read_to_string(&path).unwrap();
        if text.contains("[[vehicle]]") {
            let config = Config::load(&path).unwrap_or_else(|error| panic!("{error}"));
            assert!(!config.vehicles.is_empty());
            found += 1;
        } else {
            Scenario::load(&path, &Overrides::default()).unwrap_or_else(|error| panic!("{error}"));
        }
    }
    assert!(found >= 6, "{found} configurations");
}
