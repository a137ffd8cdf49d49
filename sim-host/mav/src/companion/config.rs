//! What stands in `CONFIG.toml`: every field is documented here, and listed in docs/autopilots.md.

use super::kind::Kind;
use super::medium::MediumSetup;
use super::offboard::{Entry, Rules};
use crate::Endpoint;
use crate::geo::{Global, Origin};
use serde::Deserialize;
use staya_controller::agent::{GuidanceKind, SafetyKind};
use staya_controller::robot::RobotId;
use staya_sim::file::{TEXT, read_text};
use staya_sim::scenario::{Overrides, PlaneSetup, Scenario, ScenarioError, Source, within};
use std::net::{Ipv4Addr, SocketAddr};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Where the fields are listed.
const LIST: &str = "docs/autopilots.md";
/// MAVLink systems that vehicles can be.
const SYSTEMS: u32 = 254;
/// Largest window of routes.
const RADIUS: u8 = 16;

/// A whole file.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct ConfigFile {
    /// What the swarm does: a scenario with `[plane]`.
    scenario: PathBuf,
    /// Where the scenario's (0, 0) is.
    origin: OriginTable,
    /// How companions in other processes are reached.
    #[serde(default)]
    air: AirTable,
    /// A key file: with it all messages on all links are signed, and only signed ones are heard. Default: none.
    link_key: Option<PathBuf>,
    /// By what rules vehicles are steered.
    #[serde(default)]
    rules: RulesTable,
    /// The vehicles of this process.
    #[serde(default)]
    vehicle: Vec<VehicleTable>,
}

/// `[origin]`.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct OriginTable {
    /// Degrees north.
    latitude_deg: f64,
    /// Degrees east.
    longitude_deg: f64,
    /// Metres above sea level, for swarms in space. Default: 0.
    #[serde(default)]
    altitude_m: f64,
}

/// `[air]`.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct AirTable {
    /// `GROUP:PORT`, IPv4: packets go to all who have joined the group.
    multicast: Option<String>,
    /// Own address on the network of the group. Default: the system chooses.
    interface: Option<Ipv4Addr>,
    /// `HOST:PORT`: where packets of `peers` arrive.
    bind: Option<String>,
    /// `HOST:PORT` of each other companion.
    peers: Vec<String>,
    /// Whether packets go through the vehicles' MAVLink links, as TUNNEL messages to everybody. Default: false.
    tunnel: bool,
    /// A key file: with it packets are sealed, and only sealed ones are heard. Default: none.
    key: Option<PathBuf>,
    /// With a key: how long the old one is heard too when the file changes, seconds; the new one is spoken after half of that. Default: 60.
    overlap_s: Option<f64>,
}

/// `[rules]`.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct RulesTable {
    /// Who puts vehicles into GUIDED or OFFBOARD: `"wait"` (the pilot; the default) or `"once"` (the companion, once after its start).
    entry: Entry,
    /// With `"once"`: whether it also arms. Default: false.
    arm: bool,
    /// With `arm`: whether it also takes off, to `altitude_m`. Default: false.
    takeoff: bool,
    /// Height above home that what flies takes off to, metres, and keeps if the scenario is in the plane. Default: none, vertical velocities are the agent's.
    altitude_m: Option<f64>,
    /// Positions that are older are stale, and the vehicle is told to stop, seconds. Default: 1.
    stale_s: f64,
    /// An autopilot silent for longer is gone, seconds. Default: 3.
    link_lost_s: f64,
    /// Setpoints a second. Default: 20.
    setpoint_hz: f64,
    /// Positions a second that the autopilot is asked for. Default: 10.
    position_hz: f64,
    /// Time that a vehicle needs to follow a velocity, seconds: it brakes so much earlier. Default: 0.5.
    lag_s: f64,
    /// Vehicles farther from the origin are not steered, metres. Default: 10000.
    reach_m: f64,
    /// How far a vehicle whose position is old or not to be believed may be from it at most, metres: others keep so much more room after a while. Default: 10.
    error_m: f64,
}

impl Default for RulesTable {
    fn default() -> Self {
        Self {
            entry: Entry::Wait,
            arm: false,
            takeoff: false,
            altitude_m: None,
            stale_s: 1.0,
            link_lost_s: 3.0,
            setpoint_hz: 20.0,
            position_hz: 10.0,
            lag_s: 0.5,
            reach_m: 10_000.0,
            error_m: 10.0,
        }
    }
}

/// `[[vehicle]]`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct VehicleTable {
    /// Its number in the scenario.
    robot: u32,
    /// Its MAVLink system id. Default: the same number.
    system: Option<u32>,
    /// The line to its autopilot, as in `udpin:127.0.0.1:14550`. Several vehicles may share one.
    link: String,
    /// `"ardupilot-rover"`, `"ardupilot-copter"`, `"px4-copter"` (or `"px4"`), `"px4-rover"`.
    autopilot: Kind,
    /// `[latitude, longitude]` in degrees to go to instead of the scenario's goal; for guidance "waypoint".
    goal_deg: Option<[f64; 2]>,
    /// Instead of that of `rules`.
    altitude_m: Option<f64>,
}

/// A vehicle of this process.
#[derive(Clone, Debug, PartialEq)]
pub struct VehicleSetup {
    /// Its number.
    pub robot: RobotId,
    /// Its place in [`Scenario::robots`].
    pub index: usize,
    /// Its MAVLink system id, 1 to 254.
    pub system: u8,
    /// Number of its line in [`Config::lines`].
    pub line: usize,
    /// What drives it.
    pub kind: Kind,
    /// By what rules.
    pub rules: Rules,
}

/// A checked configuration.
#[derive(Clone, Debug)]
pub struct Config {
    /// What the swarm does; goals on the Earth are already metres.
    pub scenario: Scenario,
    /// What bodies are: `scenario.plane`.
    pub plane: PlaneSetup,
    /// Where that is.
    pub origin: Origin,
    /// How packets of other processes come and go.
    pub air: MediumSetup,
    /// Where the key of packets is.
    pub key: Option<PathBuf>,
    /// How long two keys of packets are good when the file changes.
    pub overlap: Duration,
    /// Where the key of links is.
    pub link_key: Option<PathBuf>,
    /// The lines to autopilots, each once.
    pub lines: Vec<Endpoint>,
    /// The vehicles, by rising number of their robots.
    pub vehicles: Vec<VehicleSetup>,
    /// How long a vehicle needs to follow a velocity, seconds.
    pub lag_s: f64,
    /// Vehicles farther from the origin are not steered, metres.
    pub reach_m: f64,
    /// How far a vehicle may be from where it was known to be last, metres.
    pub error_m: f64,
}

impl Config {
    /// Reads and checks a file and the scenario that it names.
    ///
    /// # Errors
    /// [`ScenarioError`], naming file, line, field and remedy.
    pub fn load(path: &Path) -> Result<Self, ScenarioError> {
        let text = read_text(path, TEXT).map_err(|source| ScenarioError::Io { path: path.to_owned(), source })?;
        Self::parse(&text, path)
    }

    /// As [`Config::load`], of a text that stands (or might stand) in the file `path`.
    ///
    /// # Errors
    /// See [`Config::load`].
    pub fn parse(text: &str, path: &Path) -> Result<Self, ScenarioError> {
        let source = Source::new(path, text)?;
        let file: ConfigFile = source.read(LIST)?;
        let origin = Origin::new(Global {
            latitude_deg: file.origin.latitude_deg,
            longitude_deg: file.origin.longitude_deg,
            altitude_m: file.origin.altitude_m,
        });
        let origin = origin.ok_or_else(|| {
            let remedy = "give latitude_deg from -90 to 90 and longitude_deg from -180 to 180";
            source.error("origin", "this is no place on the Earth", remedy)
        })?;
        check_rules(&source, &file.rules)?;
        let mut scenario = Scenario::load(&source.folder().join(&file.scenario), &Overrides::default())?;
        // A vehicle that does not know well where it is says that it is so much larger, and jumps when it knows again.
        scenario.claims.max_radius_m += file.rules.error_m as f32;
        scenario.claims.slack_m += file.rules.error_m as f32;
        check_scenario(&source, &scenario)?;
        let air = air(&source, &file.air)?;
        let (lines, vehicles) = vehicles(&source, &file, &origin, &mut scenario)?;
        let Some(plane) = scenario.plane.clone() else {
            return Err(no_plane(&source));
        };
        let overlap_s = file.air.overlap_s.unwrap_or(60.0);
        within(&source, "air.overlap_s", overlap_s, 2.0, 86_400.0, "seconds")?;
        let beside = |path: &PathBuf| source.folder().join(path);
        Ok(Self {
            scenario,
            plane,
            origin,
            air,
            key: file.air.key.as_ref().map(beside),
            overlap: Duration::from_secs_f64(overlap_s),
            link_key: file.link_key.as_ref().map(beside),
            lines,
            vehicles,
            lag_s: file.rules.lag_s,
            reach_m: file.rules.reach_m,
            error_m: file.rules.error_m,
        })
    }
}

fn no_plane(source: &Source<'_>) -> ScenarioError {
    let remedy = "name one with [plane]: autopilots follow velocities";
    source.error("scenario", "its robots go from cell to cell", remedy)
}

fn check_scenario(source: &Source<'_>, scenario: &Scenario) -> Result<(), ScenarioError> {
    let Some(plane) = &scenario.plane else {
        return Err(no_plane(source));
    };
    let refused = |what: String, remedy: &str| Err(source.error("scenario", what, remedy));
    if scenario.tick_us > 500_000 {
        let what = format!("its tick of {} s is too long for vehicles", scenario.tick_s());
        return refused(what, "give it tick_s = 0.5 or less; 0.1 is good");
    }
    if !plane.orders.is_empty() {
        let what = String::from("[[plane.order]] has no meaning here");
        return refused(what, "leave it out: orders come from an operator, as packets");
    }
    if !plane.intruders.is_empty() {
        let what = String::from("[[plane.intruder]] has no meaning here");
        return refused(what, "leave it out: whoever comes is real");
    }
    if plane.torus_m.is_some() {
        let what = String::from("vehicles do not come in on one side when they leave on the other");
        return refused(what, "leave plane.torus_m out");
    }
    if scenario.eyes.is_some() {
        let what = String::from("autopilots do not tell whom their vehicles see");
        return refused(what, "leave plane.eyes out");
    }
    if scenario.route.params.radius > RADIUS {
        let what = format!("route.radius {} is too large", scenario.route.params.radius);
        return refused(what, "give 16 or less");
    }
    Ok(())
}

fn check_rules(source: &Source<'_>, rules: &RulesTable) -> Result<(), ScenarioError> {
    for (field, value, low, high, unit) in [
        ("stale_s", rules.stale_s, 0.1, 60.0, "seconds"),
        ("link_lost_s", rules.link_lost_s, 1.5, 60.0, "seconds"),
        ("setpoint_hz", rules.setpoint_hz, 3.0, 100.0, "Hz; PX4 needs more than 2"),
        ("position_hz", rules.position_hz, 1.0, 100.0, "Hz"),
        ("lag_s", rules.lag_s, 0.0, 10.0, "seconds"),
        ("reach_m", rules.reach_m, 1.0, 500_000.0, "metres"),
        ("error_m", rules.error_m, 0.0, 50.0, "metres"),
    ] {
        within(source, &format!("rules.{field}"), value, low, high, unit)?;
    }
    if rules.arm && rules.entry != Entry::Once {
        let what = "with entry \"wait\" the pilot arms";
        return Err(source.error("rules.arm", what, "give rules.entry = \"once\", or leave it out"));
    }
    if rules.takeoff && !rules.arm {
        let what = "what is not armed does not take off";
        return Err(source.error("rules.takeoff", what, "give rules.arm = true, or leave it out"));
    }
    Ok(())
}

fn address(source: &Source<'_>, field: &str, text: &str) -> Result<SocketAddr, ScenarioError> {
    text.parse().map_err(|_| {
        let remedy = "write an address and a port, as in 192.168.1.7:14999";
        source.error(field, format!("`{text}` is no address"), remedy)
    })
}

fn air(source: &Source<'_>, table: &AirTable) -> Result<MediumSetup, ScenarioError> {
    let clash = |field: &str, remedy: &str| Err(source.error(field, "it is not clear how packets go", remedy));
    if table.bind.is_some() == table.peers.is_empty() {
        return clash("air.peers", "give bind and peers together, or none of them");
    }
    match (&table.multicast, &table.bind, table.tunnel) {
        (None, None, false) => Ok(MediumSetup::Here),
        (None, None, true) => Ok(MediumSetup::Tunnel),
        (Some(group), None, false) => {
            let given = address(source, "air.multicast", group)?;
            match given {
                SocketAddr::V4(group) if group.ip().is_multicast() && group.port() > 0 => {
                    Ok(MediumSetup::Multicast { group, interface: table.interface.unwrap_or(Ipv4Addr::UNSPECIFIED) })
                }
                _ => {
                    let what = format!("`{group}` is no IPv4 multicast group");
                    let remedy = "take one of your own, as in 239.255.77.1:14999";
                    Err(source.error("air.multicast", what, remedy))
                }
            }
        }
        (None, Some(bind), false) => {
            let bind = address(source, "air.bind", bind)?;
            let peers = table.peers.iter().enumerate();
            let peers = peers.map(|(i, peer)| address(source, &format!("air.peers[{i}]"), peer));
            let peers = peers.collect::<Result<Vec<_>, _>>()?;
            Ok(MediumSetup::Peers { bind, peers })
        }
        _ => clash("air", "give only one of multicast, peers and tunnel"),
    }
}

fn rules(table: &RulesTable, vehicle: &VehicleTable, safety: SafetyKind) -> Rules {
    Rules {
        entry: table.entry,
        arm: table.arm,
        takeoff: table.takeoff && vehicle.autopilot.flies(),
        altitude_m: vehicle.altitude_m.or(table.altitude_m).filter(|_| vehicle.autopilot.flies()),
        // In space heights are what robots give each other room by.
        keeps_altitude: safety != SafetyKind::Fly,
        stale: Duration::from_secs_f64(table.stale_s),
        link_lost: Duration::from_secs_f64(table.link_lost_s),
        setpoint_every: Duration::from_secs_f64(1.0 / table.setpoint_hz),
        position_hz: table.position_hz,
        rehearses: false,
    }
}

/// The lines, each once, and who is at them; goals on the Earth go into the scenario.
fn vehicles(
    source: &Source<'_>,
    file: &ConfigFile,
    origin: &Origin,
    scenario: &mut Scenario,
) -> Result<(Vec<Endpoint>, Vec<VehicleSetup>), ScenarioError> {
    let (mut lines, mut vehicles) = (Vec::new(), Vec::<VehicleSetup>::new());
    for (number, table) in file.vehicle.iter().enumerate() {
        let field = |name: &str| format!("vehicle[{number}].{name}");
        let found = scenario.robots.binary_search_by_key(&RobotId(table.robot), |r| r.id);
        let Ok(index) = found else {
            let what = format!("the scenario has no robot {}", table.robot);
            let remedy = format!("give the number of one of its {}", scenario.robots.len());
            return Err(source.error(&field("robot"), what, remedy));
        };
        let endpoint = table.link.parse::<Endpoint>().map_err(|error| {
            let remedy = "for instance udpin:127.0.0.1:14550, tcpout:127.0.0.1:5760 or serial:/dev/ttyACM0,baud=57600";
            source.error(&field("link"), format!("`{}`: {}", error.text, error.what), remedy)
        })?;
        let line = lines.iter().position(|known| *known == endpoint);
        let line = line.unwrap_or_else(|| {
            lines.push(endpoint);
            lines.len() - 1
        });
        let system = table.system.unwrap_or(table.robot);
        if system == 0 || system > SYSTEMS {
            let what = format!("{system} is no vehicle's MAVLink system");
            return Err(source.error(&field("system"), what, "give 1 to 254"));
        }
        let system = system as u8;
        for known in &vehicles {
            if known.index == index {
                let what = format!("robot {} is there twice", table.robot);
                return Err(source.error(&field("robot"), what, "give each vehicle its own"));
            }
            if (known.line, known.system) == (line, system) {
                let what = format!("system {system} is there twice on this link");
                let remedy = "give each vehicle its own (ArduPilot: SYSID_THISMAV, PX4: MAV_SYS_ID)";
                return Err(source.error(&field("system"), what, remedy));
            }
        }
        if let Some(altitude_m) = table.altitude_m.or(file.rules.altitude_m) {
            let name = match table.altitude_m {
                Some(_) => field("altitude_m"),
                None => String::from("rules.altitude_m"),
            };
            within(source, &name, altitude_m, 0.5, 1000.0, "metres")?;
        }
        let rules = rules(&file.rules, table, scenario.safety(index).kind());
        if file.rules.takeoff && table.autopilot.flies() && rules.altitude_m.is_none() {
            let what = "it is not said how high it takes off";
            return Err(source.error("rules.takeoff", what, "give altitude_m"));
        }
        if let Some(goal) = table.goal_deg {
            assign_goal(source, &field("goal_deg"), goal, origin, scenario, index)?;
        }
        vehicles.push(VehicleSetup { robot: RobotId(table.robot), index, system, line, kind: table.autopilot, rules });
    }
    if vehicles.is_empty() {
        let remedy = "add [[vehicle]] with robot, link and autopilot";
        return Err(source.error("vehicle", "there is none", remedy));
    }
    vehicles.sort_by_key(|vehicle| vehicle.robot);
    Ok((lines, vehicles))
}

fn assign_goal(
    source: &Source<'_>,
    field: &str,
    [latitude_deg, longitude_deg]: [f64; 2],
    origin: &Origin,
    scenario: &mut Scenario,
    index: usize,
) -> Result<(), ScenarioError> {
    let place = origin.to_enu_m(&Global { latitude_deg, longitude_deg, altitude_m: origin.place().altitude_m });
    let plane = scenario.plane.as_mut();
    let target = plane.filter(|plane| plane.group(index).guidance.kind() == GuidanceKind::Waypoint);
    let target = target.and_then(|plane| plane.starts.get_mut(index)?.places.last_mut());
    match (place, target) {
        (Some(place), Some(target)) => {
            target.position_m = [place[0], place[1], target.position_m[2]];
            Ok(())
        }
        (None, _) => {
            let what = "this is no place near the origin";
            Err(source.error(field, what, "give [latitude, longitude] in degrees"))
        }
        (_, None) => {
            let what = "the scenario gives this robot no goal of its own that could be replaced";
            Err(source.error(field, what, "leave it out, or take guidance \"waypoint\""))
        }
    }
}

#[cfg(test)]
mod tests;
