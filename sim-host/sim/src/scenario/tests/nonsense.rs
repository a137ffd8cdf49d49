//! Files that are well-formed but contradict themselves.

use super::*;

const LIST: &str = "list = [{ start = [0, 0], goal = [3, 2] }]";

const PLANE: &str = "name = \"t\"\nticks = 5\n[plane]\nradius_m = 0.2\nmax_speed_mps = 1\n";

fn cells(rest: &str) -> String {
    format!("{}{rest}", with_robots(LIST))
}

fn metres(rest: &str) -> String {
    format!("{PLANE}{rest}")
}

#[test]
fn lists_of_another_length_and_lists_for_tables_are_refused() {
    let order = |what: &str| cells(&format!("[[intervention]]\nat_s = 1\ndo = {what}\n"));
    for (text, expected) in [
        (
            with_robots("list = [{ start = [0, 0, 77], goal = [3, 2] }]"),
            "s.toml:6:19: robots.list[0].start: the list has 3 values, 2 are needed; ",
        ),
        (
            with_robots("list = [{ start = [0], goal = [3, 2] }]"),
            "s.toml:6:19: robots.list[0].start: the list has 1 values, 2 are needed; ",
        ),
        (with_robots("list = [[1, [0, 0], [3, 2]]]"), "s.toml:6:9: robots.list[0]: a list is not a table; "),
        (cells("[radio]\nburst = [0.5, 2000, 1]\n"), "s.toml:8:9: radio.burst: a list is not a table; "),
        (order("[\"goal\", 1, [1, 1, 0]]"), "s.toml:9:6: intervention[0].do: a list is not a table; "),
        (order("\"goal\""), "s.toml:9:6: intervention[0].do: \"goal\" is not a table; "),
        (
            order("{ kind = \"goal\", place_m = [1, 1, 0, 4] }"),
            "s.toml:9:33: intervention[0].do.place_m: the list has 4 values, 3 are needed; ",
        ),
        (
            order("{ kind = \"goal\", place_m = [1, 1] }"),
            "s.toml:9:33: intervention[0].do.place_m: the list has 2 values, 3 are needed; ",
        ),
        (
            order("{ kind = \"solid\", solid = [\"circle\", [1, 2], 0.5] }"),
            "s.toml:9:32: intervention[0].do.solid: a list is not a table; ",
        ),
        (order("{ kind = 3 }"), "s.toml:9:15: intervention[0].do.kind: 3 is not a name in quotes; "),
    ] {
        let refusal = refusal(&text);
        assert!(refusal.starts_with(expected), "expected {expected}\n     got {refusal}");
    }
}

#[test]
fn faults_of_radios_without_effect_or_robots_are_refused() {
    let fault = |fields: &str| cells(&format!("[[radio.fault]]\n{fields}\n"));
    for (fields, expected) in [
        (
            "from = [1, 9]",
            "s.toml:8:12: radio.fault[0].from[1]: there is no robot 9; give the number of a robot of this",
        ),
        ("to = []", "s.toml:8:6: radio.fault[0].to: the list is empty; give robots, or leave it out for all"),
        ("from = 1", "s.toml:8:8: radio.fault[0].from: 1 is not a list; "),
        ("from = [1]\nto = [1]", "s.toml:9:6: radio.fault[0].to: robot 1 has no link to itself; give another robot"),
        (
            "both_ways = true",
            "s.toml:8:13: radio.fault[0].both_ways: a fault of all radios has both directions anyway; ",
        ),
        ("loss = 1.5", "s.toml:8:8: radio.fault[0].loss: 1.5 is not a probability; give a number from 0 to 1"),
        ("for_s = -1", "s.toml:8:9: radio.fault[0].for_s: -1 is out of range; give 0 to 1000000000 seconds"),
        ("form = [1]", "s.toml:8:1: radio.fault[0].form: unknown field `form`; did you mean `from`?"),
    ] {
        let refusal = refusal(&fault(fields));
        assert!(refusal.starts_with(expected), "expected {expected}\n     got {refusal}");
    }
}

#[test]
fn events_after_the_end_are_refused() {
    let late = "is after the end of the run at 5 s; give an earlier time or more ticks, or leave it out";
    let master = "[authentication]\nmaster = \"passphrase: a\"\n[[authentication.roll]]\nat_s = 6\n";
    let robots = "robots = { list = [{ start_m = [0, 0], goal_m = [1, 1] }] }\n";
    for (text, field) in [
        (cells("[[fault]]\nrobot = 1\nat_s = 6\n"), "9:8: fault[0].at_s"),
        (cells("[[radio.fault]]\nfrom = [1]\nat_s = 6\n"), "9:8: radio.fault[0].at_s"),
        (cells("[[intervention]]\nat_s = 6\ndo = { kind = \"down\", robot = 1 }\n"), "8:8: intervention[0].at_s"),
        (
            cells("[[attack]]\nkind = \"unsigned\"\nplace_m = [0, 0]\nlure_m = [1, 1]\nfrom_s = 6\n"),
            "11:10: attack[0].from_s",
        ),
        (cells("[[terrain.change]]\nat_s = 6\nclass = 0\ncells = [[1, 0]]\n"), "8:8: terrain.change[0].at_s"),
        (cells(master), "10:8: authentication.roll[0].at_s"),
        (metres(&format!("{robots}[[plane.order]]\nat_s = 6\nplace_m = [1, 1]\n")), "8:8: plane.order[0].at_s"),
    ] {
        let refusal = refusal(&text);
        let expected = format!("s.toml:{field}: 6 s {late}");
        assert!(refusal.starts_with(&expected), "expected {expected}\n     got {refusal}");
        parse(&text.replace("_s = 6", "_s = 5")).unwrap_or_else(|error| panic!("at the end: {error}"));
    }
}

#[test]
fn overrides_may_end_a_run_before_its_events() {
    let text = cells("[[fault]]\nrobot = 1\nat_s = 4\n");
    let dir = tempfile::tempdir().expect("temporary folder");
    let path = dir.path().join("s.toml");
    fs::write(dir.path().join("m.map"), MAP).expect("write");
    fs::write(&path, &text).expect("write");
    let ticks = |ticks| Overrides { seed: None, ticks };
    let set = |text: &str| vec![text.parse::<Setting>().expect("a setting")];
    let load = |ticks: &Overrides, settings: &[Setting]| Scenario::load_with(&path, ticks, settings);
    Scenario::load(&path, &ticks(Some(2))).expect("fewer ticks");
    load(&ticks(Some(2)), &[]).expect("fewer ticks");
    load(&ticks(None), &set("ticks=2")).expect("fewer ticks");
    load(&ticks(None), &set("fault[0].at_s=6")).expect_err("a fault after the end");
    load(&ticks(Some(6)), &set("fault[0].at_s=6")).expect("more ticks");
    Scenario::parse(&text.replace("ticks = 5", "ticks = 2"), &path, &ticks(None)).expect("a text with fewer ticks");
}

#[test]
fn attacks_end_after_they_begin() {
    let attack =
        |times: &str| cells(&format!("[[attack]]\nkind = \"unsigned\"\nplace_m = [0, 0]\nlure_m = [1, 1]\n{times}\n"));
    let expected =
        "s.toml:12:8: attack[0].to_s: the attack is over before its first tick; give a tick or more after from_s";
    for times in ["from_s = 3\nto_s = 1", "from_s = 3\nto_s = 3", "from_s = 2.5\nto_s = 2.7"] {
        let refusal = refusal(&attack(times));
        assert!(refusal.starts_with(expected), "{refusal}");
    }
    let scenario = parse(&attack("from_s = 3\nto_s = 4")).expect("good");
    assert_eq!((scenario.events.attacks[0].from_tick, scenario.events.attacks[0].to_tick), (3, 4));
}

#[test]
fn load_options_are_refused_without_a_file() {
    let uniform = "uniform = { width = 4, height = 3 }\n";
    let text = cells("").replace("file = \"m.map\"\n", &format!("{uniform}load = {{ swamp = 3 }}\n"));
    let refusal = refusal(&text);
    let expected = "s.toml:5:8: terrain.load: only map files are converted; give terrain.file, or leave it out";
    assert!(refusal.starts_with(expected), "{refusal}");
    parse(&format!("{text}[scouting]\nmap = \"m.map\"\n")).expect("the map of [scouting] is converted");
}

#[test]
fn robots_do_not_start_faster_than_their_highest_speed() {
    let list = |robot: &str| metres(&format!("robots = {{ list = [{{ start_m = [0, 0], {robot} }}] }}\n"));
    let cloud = |velocity: &str| {
        metres(&format!("[plane.robots.cloud]\ncount = 2\nfrom_m = [0, 0]\nto_m = [9, 9]\n{velocity}\n"))
    };
    for (text, expected) in [
        (
            list("velocity_mps = [30, 0]"),
            "s.toml:6:55: plane.robots.list[0].velocity_mps: 30 m/s exceeds the highest speed; give at most 1 m/s in all",
        ),
        (list("velocity_mps = [0.8, 0.8]"), "s.toml:6:55: plane.robots.list[0].velocity_mps: 1.13"),
        (
            list("velocity_mps = [0.6, 0], max_speed_mps = 0.5"),
            "s.toml:6:55: plane.robots.list[0].velocity_mps: 0.6 m/s exceeds the highest speed; give at most 0.5 m/s",
        ),
        (cloud("velocity_from_mps = [-2, 0]"), "s.toml:10:21: plane.robots.cloud.velocity_from_mps: 2 m/s exceeds"),
        (cloud("velocity_to_mps = [1, 1]"), "s.toml:10:19: plane.robots.cloud.velocity_to_mps: 1.41"),
    ] {
        let refusal = refusal(&text);
        assert!(refusal.starts_with(expected), "expected {expected}\n     got {refusal}");
    }
    parse(&list("velocity_mps = [0.6, 0.8]")).expect("the highest speed");
    parse(&cloud("velocity_from_mps = [-0.6, 0]\nvelocity_to_mps = [0, 0.8]")).expect("at most the highest speed");
}
