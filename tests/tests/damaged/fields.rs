//! A value of another kind in each field is refused in words of the file.

use staya_mav::companion::Config;
use staya_sim::scenario::{Overrides, Scenario};
use staya_tests::mutants::type_name;
use staya_tests::root;
use std::path::Path;
use toml::{Table, Value};

/// Nearly every field of robots in cells.
const CELLS: &str = r#"
name = "cells"
seed = 1
ticks = 50
tick_s = 0.5
[terrain]
uniform = { width = 12, height = 9, classes = 1, seed = 2 }
crop = { x = 0, y = 0, width = 12, height = 8 }
cell_m = 1.5
[[terrain.change]]
at_s = 2
every_s = 9
for_s = 3
class = 0
cells = [[5, 5], [6, 5]]
[[terrain.change]]
every_s = 2
rectangle = { x = 9, y = 6, width = 2, height = 2 }
drift = { share = 0.5, step = 1, classes = 4 }
[[terrain.change]]
class = 2
polygon_m = [[12, 9], [16, 9], [16, 12]]
[grid]
radius = 8
norm = "chebyshev"
corner_cutting = true
moves = 8
simultaneous = false
law = "formation"
[grid.formation]
exit = "best"
replan = "each_cell"
a0 = 1
a1 = 1.5
a2 = 1
a3 = 1
halved_per_ticks = 2
eps_cells = 2
place_gain = 3
halt_cells = 2
resume_cells = 1
lead_cells = 2
footprint = 1
patience = 9
waits = true
closes_ranks = true
prediction = "reflexive"
recovery = "def"
[radio]
format = "postcard"
range_m = 40.5
loss = 0.1
burst = { share = 0.1, mean_ms = 1000, loss = 0.9 }
delay_ms = 10
jitter_ms = 5
duplicate = 0.1
reorder = 0.1
reorder_ms = 50
bit_error_rate = 0.001
bandwidth_bytes_per_s = 5000
blackout_s = [[1, 2], [4, 5.5]]
[[radio.fault]]
from = [1]
to = [2, 3]
both_ways = true
loss = 0.95
at_s = 1
for_s = 2.5
[robots]
formation = { rows = 2, columns = 2, spacing = [2, 2], start = [1, 1], goal = [7, 2], rho = 3 }
[[fault]]
robot = 2
at_s = 3
down_s = 2
[[misnumbered]]
robot = 3
number = 7
[authentication]
master = "passphrase: secret"
place_m = [3, 4]
overlap_s = 4
roll = [{ at_s = 5, revoke = [2] }]
[plausibility]
bounded = true
max_radius_m = 3
max_speed_mps = 9
slack_m = 4
settle_s = 5
last_robot = 20
[[attack]]
kind = "insider"
place_m = [1, 2]
from_s = 1
to_s = 9
lure_m = [5, 5]
claims = 2
lies = ["ghosts", "jump"]
ghosts = 3
[[attack]]
kind = "replay"
place_m = [1, 2]
delay_s = 3
[[intervention]]
at_s = 1
do = { kind = "goal", robot = 1, place_m = [4, 5, 0] }
[[intervention]]
at_s = 1
do = { kind = "down", robot = 3, for_s = 5 }
[[intervention]]
at_s = 2
do = { kind = "radio", loss = 1, range_m = 50 }
[[intervention]]
at_s = 3
do = { kind = "cell", cell = [3, 4], class = 0 }
"#;

/// Nearly every field of robots in the plane.
const BODIES: &str = r#"
name = "bodies"
ticks = 50
tick_s = 0.1
[terrain]
uniform = { width = 30, height = 30, classes = 1 }
[scouting]
unknown = 0.1
wrong = 0.1
patch_cells = 2
assumed = 3
seed = 4
radius = 12
[robots]
list = [{ id = 1, start = [1, 1], goal = [9, 1] }, { id = 2, start = [1, 5], goal = [9, 5] }]
[plane]
radius_m = 0.2
max_speed_mps = 1
max_acceleration_mps2 = 2
lag_s = 0.1
cruise_mps = 0.7
tolerance_m = 0.1
sight_m = 5
law = "route"
route = { replan = "each_cell" }
safety = "orca"
[plane.orca]
horizon_s = 4
wall_horizon_s = 3
share = 0.5
margin_m = 0.05
inflation_mps = 0.5
inflation_m = 0.2
stands_after_s = 5
listen_s = 1
expects_others = true
alone_mps = 0.5
[[plane.group]]
flock = 3
law = "lattice"
lattice = { spacing_m = 1, algorithm = 3, c1_alpha = 1, c1_beta = 1, c1_gamma = 1, goal_moves = false, goal_rest_m = 1, takes_turns = true, obstacle_ratio = 0.6 }
[plane.group.robots.cloud]
count = 3
from_m = [12, 12]
to_m = [16, 16]
velocity_from_mps = [0, 0]
velocity_to_mps = [0.5, 0.5]
goals_m = [[20, 20]]
goal_velocity_mps = [0.1, 0]
[[plane.group]]
law = "goal_flock"
goal_flock = { min_distance_m = 0.6, neighborhood_m = 3, k1 = 1, k2 = 1, k3 = 1, tolerance_m = 2 }
robots = { list = [{ start_m = [20, 3], goal_m = [25, 3] }] }
[[plane.group]]
law = "boids"
boids = { crowded_m = 1, closest_m = 4, max_turn = 0.1, max_turn_away = 0.1 }
robots = { list = [{ start_m = [20, 6, 0], velocity_mps = [0.4, 0], max_speed_mps = 0.8, radius_m = 0.3 }] }
[[plane.group]]
law = "waypoint"
safety = "push_out"
push_out = { min_distance_m = 0.8, model = "radial", single = true }
robots = { scattered = { count = 2, from_m = [20, 12], to_m = [28, 18], travel_m = 5, spacing_m = 1 } }
[[plane.intruder]]
start_m = [2, 20]
velocity_mps = [0.3, 0]
radius_m = 0.3
heard = true
[[plane.wall]]
points_m = [[5, 25], [8, 25], [8, 28]]
closed = true
[[plane.ball]]
center_m = [26, 26]
radius_m = 0.5
[[plane.balls]]
count = 2
radius_m = 0.2
from_m = [1, 26]
to_m = [4, 29]
gap_m = 0.1
[[plane.half_space]]
point_m = [-50, 0]
normal = [1, 0]
[[plane.order]]
at_s = 2
goal = 0
place_m = [20, 22]
velocity_mps = [0.1, 0.1]
[[intervention]]
at_s = 1
do = { kind = "waypoint", goal = 0, place_m = [4, 5, 0] }
[[intervention]]
at_s = 1
do = { kind = "parameter", name = "k1", value = 2, robot = 6 }
[[intervention]]
at_s = 1
do = { kind = "solid", solid = { kind = "circle", center_m = [1, 2], radius_m = 0.5 } }
[[intervention]]
at_s = 1
do = { kind = "solid", solid = { kind = "polygon", points_m = [[1, 2], [2, 2], [2, 3]] } }
[[intervention]]
at_s = 2
do = { kind = "move", index = 0, by_m = [1, 0] }
[[intervention]]
at_s = 3
do = { kind = "remove", index = 0 }
"#;

const SENSING: &str = r#"
name = "sensing"
ticks = 50
tick_s = 0.1
[plane]
radius_m = 0.2
max_speed_mps = 1
robots = { circle = { count = 5, radius_m = 5, noise_m = 0.1 } }
[plane.sensing]
range_m = 5
noise_m = 0.1
occlusion = true
names = true
every_ticks = 2
delay_ticks = 1
beacons = false
acceleration_mps2 = 2
gate = 4
margin = 2
forget_s = 3
"#;

/// Nearly every field of a companion.
const COMPANION: &str = r#"
scenario = "../scenarios/swap-circle.toml"
origin = { latitude_deg = 55.75, longitude_deg = 37.62 }
link_key = "k"
[air]
multicast = "239.1.2.3:5"
interface = "10.0.0.2"
key = "k"
overlap_s = 9
[rules]
entry = "once"
arm = true
takeoff = true
altitude_m = 9
stale_s = 1
link_lost_s = 3
setpoint_hz = 20
position_hz = 9
lag_s = 1
reach_m = 900
error_m = 2
[[vehicle]]
robot = 3
link = "udpin:127.0.0.1:14550"
autopilot = "ardupilot-rover"
system = 3
goal_deg = [55.7, 37.6]
altitude_m = 5
"#;

type Parse = fn(&str, &Path) -> Result<(), String>;

fn scenario(text: &str, path: &Path) -> Result<(), String> {
    let overrides = Overrides { seed: None, ticks: Some(5) };
    Scenario::parse_with(text, path, &overrides, &[]).map(drop).map_err(|error| error.to_string())
}

fn companion(text: &str, path: &Path) -> Result<(), String> {
    Config::parse(text, path).map(drop).map_err(|error| error.to_string())
}

/// Paths of all values in a table, as keys and indices.
fn paths(value: &Value, at: &[String], all: &mut Vec<Vec<String>>) {
    let inner: Vec<(String, &Value)> = match value {
        Value::Table(table) => table.iter().map(|(key, value)| (key.clone(), value)).collect(),
        Value::Array(list) => list.iter().enumerate().map(|(index, value)| (index.to_string(), value)).collect(),
        _ => return,
    };
    for (step, value) in inner {
        let at = [at, &[step]].concat();
        all.push(at.clone());
        paths(value, &at, all);
    }
}

fn value_at<'v>(value: &'v mut Value, path: &[String]) -> &'v mut Value {
    path.iter().fold(value, |value, step| match value {
        Value::Table(table) => table.get_mut(step).expect("a field"),
        Value::Array(list) => &mut list[step.parse::<usize>().expect("an index")],
        _ => unreachable!("{step}"),
    })
}

/// Values of all kinds. For a table also its values as a list, for a list also a longer and a
/// shorter one.
fn replacements(value: &Value) -> Vec<Value> {
    let words = ["5", "-3.5", "nan", "1e300", "9223372036854775807", "\"word\"", "true", "[]", "[1]", "[[1, 2], [3]]"];
    let others = ["{}", "{ x = 1 }", "{ x = 1, y = [2] }", "1979-05-27T07:32:00Z", "07:32:00"];
    let text = |word: &&str| format!("v = {word}").parse::<Table>().expect("TOML")["v"].clone();
    let mut all: Vec<Value> = words.iter().chain(&others).map(text).collect();
    match value {
        Value::Table(table) => all.push(Value::Array(table.values().cloned().collect())),
        Value::Array(list) => {
            all.push(Value::Array(list.iter().chain(list.first()).cloned().collect()));
            all.push(Value::Array(list.iter().skip(1).cloned().collect()));
        }
        _ => {}
    }
    all
}

#[test]
fn messages_about_a_value_of_another_kind_name_no_rust_type() {
    let (mut refusals, mut wrong) = (0, Vec::new());
    let path = root().join("companions/s.toml");
    let kinds: [(&str, Parse); 4] =
        [(CELLS, scenario), (BODIES, scenario), (SENSING, scenario), (COMPANION, companion)];
    for (text, parse) in kinds {
        parse(text, &path).unwrap_or_else(|error| panic!("{error}"));
        let whole = Value::Table(text.parse().expect("TOML"));
        let mut all = Vec::new();
        paths(&whole, &[], &mut all);
        for at in all.iter().filter(|at| *at != &["scenario"]) {
            for new in replacements(value_at(&mut whole.clone(), at)) {
                let mut mutant = whole.clone();
                let old = std::mem::replace(value_at(&mut mutant, at), new.clone());
                let mutant = toml::to_string(&mutant).expect("TOML");
                let Err(message) = parse(&mutant, &path) else {
                    if old.is_table() && new.is_array() {
                        wrong.push(format!("{at:?} = {new} is read by position"));
                    }
                    continue;
                };
                let place = message.strip_prefix(&format!("{}:", path.display()));
                if place.is_none_or(|text| type_name(text).is_some() || !text.contains("; ")) {
                    wrong.push(format!("{at:?} = {new}: {message}"));
                }
                refusals += 1;
            }
        }
    }
    assert!(wrong.is_empty(), "{} of {refusals}:\n{}", wrong.len(), wrong.join("\n"));
    assert!(refusals > 2500, "only {refusals}");
}
