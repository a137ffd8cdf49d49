//! The companion's `CONFIG.toml`; docs/autopilots.md describes its fields, units and defaults.

use super::kind::Kind;
use super::medium::MediumSetup;
use super::offboard::{Entry, Rules};
use crate::Endpoint;
use crate::endpoint::EndpointError;
use crate::geo::{Global, Origin};
use staya_controller::agent::Goals;
use staya_controller::robot::RobotId;
use staya_controller::scalar::NumberFormat;
use staya_sim::file::{TEXT, read_text};
use staya_sim::scenario::{LawSetup, Overrides, PlaneSetup, Scenario, ScenarioError, Source};
use staya_sim::{defaults, table};
use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::time::Duration;

const LIST: &str = "docs/autopilots.md";
const SYSTEMS: u8 = 254;
const RADIUS: u8 = 16;

table! {
    /// A whole file.
    pub struct ConfigFile {
        /// Path of the scenario.
        pub scenario: PathBuf;
        /// Geographic position of the scenario's (0, 0).
        pub origin: Global;
        /// Network to companions in other processes.
        pub air: AirTable = Default::default();
        /// File with the key of links.
        pub link_key: Option<PathBuf>;
        /// Rules of control.
        pub rules: RulesTable = Default::default();
        /// Vehicles controlled by this process.
        pub vehicle: Vec<VehicleTable> = Vec::new();
    }
}

table! {
    /// `[air]`.
    pub struct AirTable {
        /// Multicast group and port.
        pub multicast: Option<String>;
        /// Address of the interface for multicast.
        pub interface: Option<String>;
        /// Own address, with `peers`.
        pub bind: Option<String>;
        /// Addresses of the other companions.
        pub peers: Vec<String> = Vec::new();
        /// Whether packets travel in the vehicles' links.
        pub tunnel: bool = false;
        /// File with the key of packets.
        pub key: Option<PathBuf>;
        /// Time for which the old packet key stays valid. Default: 60 s.
        pub overlap_s: f64 = 60.0, 2.0..=86_400.0, "seconds";
    }
}

table! {
    /// `[rules]`.
    #[derive(Copy)]
    pub struct RulesTable {
        /// Selection of the external control mode.
        pub entry: Entry = Entry::Wait;
        /// Whether the companion arms.
        pub arm: bool = false;
        /// Whether it takes off.
        pub takeoff: bool = false;
        /// Takeoff height above home.
        pub altitude_m: Option<f64>, 0.5..=1000.0, "metres";
        /// Age at which telemetry is stale.
        pub stale_s: f64 = 1.0, 0.1..=60.0, "seconds";
        /// Silence after which a link is lost.
        pub link_lost_s: f64 = 3.0, 1.5..=60.0, "seconds";
        /// Rate of setpoints.
        pub setpoint_hz: f64 = 20.0, 3.0..=100.0, "Hz; PX4 needs more than 2";
        /// Requested rate of positions.
        pub position_hz: f64 = 10.0, 1.0..=100.0, "Hz";
        /// Lag of the vehicle's velocity control.
        pub lag_s: f64 = 0.5, 0.0..=10.0, "seconds";
        /// Largest distance from the origin.
        pub reach_m: f64 = 10_000.0, 1.0..=500_000.0, "metres";
        /// Largest position error.
        pub error_m: f64 = 10.0, 0.0..=50.0, "metres";
    }
}

table! {
    /// `[[vehicle]]`.
    pub struct VehicleTable {
        /// Number of the robot in the scenario.
        pub robot: u32;
        /// MAVLink system id. Default: the robot's number.
        pub system: Option<u32>;
        /// Link to the autopilot.
        pub link: String;
        /// The autopilot.
        pub autopilot: Kind;
        /// Goal: latitude and longitude.
        pub goal_deg: Option<[f64; 2]>;
        /// Takeoff height above home.
        pub altitude_m: Option<f64>, 0.5..=1000.0, "metres";
    }
}

defaults!(AirTable, RulesTable);

/// A vehicle controlled by this process.
#[derive(Clone, Debug, PartialEq)]
pub struct VehicleSetup {
    /// Robot number.
    pub robot: RobotId,
    /// Index in [`Scenario::robots`].
    pub index: usize,
    /// Its MAVLink system id, 1 to 254.
    pub system: u8,
    /// Index of its link in [`Config::lines`].
    pub line: usize,
    /// Autopilot.
    pub kind: Kind,
    /// Rules of control.
    pub rules: Rules,
}

/// A validated configuration.
#[derive(Clone, Debug)]
pub struct Config {
    /// The scenario, with geographic goals converted to metres.
    pub scenario: Scenario,
    /// The bodies: `scenario.plane()`, with a lag of at least `rules.lag_s`.
    pub plane: PlaneSetup,
    /// Geographic position of the scenario's (0, 0).
    pub origin: Origin,
    /// Network to companions in other processes.
    pub air: MediumSetup,
    /// File with the key of packets.
    pub key: Option<PathBuf>,
    /// Time for which the old packet key stays valid after the file changes.
    pub overlap: Duration,
    /// File with the key of links.
    pub link_key: Option<PathBuf>,
    /// Links to autopilots, without duplicates.
    pub lines: Vec<Endpoint>,
    /// Vehicles sorted by robot number.
    pub vehicles: Vec<VehicleSetup>,
    /// Largest distance from the origin at which vehicles are controlled, metres.
    pub reach_m: f64,
    /// Largest position error of a vehicle with stale or untrusted telemetry, metres.
    pub error_m: f64,
}

impl Config {
    /// Reads and validates a file and the scenario that it names.
    ///
    /// # Errors
    /// [`ScenarioError`] with file, line, field and remedy.
    pub fn load(path: &Path) -> Result<Self, ScenarioError> {
        let text = read_text(path, TEXT).map_err(|source| ScenarioError::Io { path: path.to_owned(), source })?;
        Self::parse(&text, path)
    }

    /// Validates `text` as the content of `path`, to which relative paths and errors refer.
    ///
    /// # Errors
    /// See [`Config::load`].
    pub fn parse(text: &str, path: &Path) -> Result<Self, ScenarioError> {
        let source = Source::new(path, text)?;
        let file: ConfigFile = source.read(LIST)?;
        let origin = Origin::new(file.origin).ok_or_else(|| {
            let remedy = "give latitude_deg from -90 to 90 and longitude_deg from -180 to 180";
            source.error("origin", "not a position on the Earth", remedy)
        })?;
        check_rules(&source, &file.rules)?;
        let mut scenario = Scenario::load(&source.file(&file.scenario), &Overrides::default())?;
        // A vehicle with an uncertain position adds the error to its radius, and may jump later.
        scenario.trust.plausibility.max_radius_m += file.rules.error_m as f32;
        scenario.trust.plausibility.slack_m += file.rules.error_m as f32;
        if let Some(plane) = scenario.plane_mut() {
            let groups = core::iter::once(&mut plane.general).chain(&mut plane.groups);
            groups.for_each(|group| group.raise_lag(file.rules.lag_s));
        }
        check_scenario(&source, &scenario)?;
        let air = air(&source, &file.air)?;
        let (lines, vehicles) = vehicles(&source, &file, &origin, &mut scenario)?;
        let Some(plane) = scenario.plane().cloned() else {
            return Err(no_plane(&source));
        };
        let beside = |path: &PathBuf| source.file(path);
        let (key, link_key) = (file.air.key.as_ref().map(beside), file.link_key.as_ref().map(beside));
        scenario.origin.files.extend(source.files());
        Ok(Self {
            scenario,
            plane,
            origin,
            air,
            key,
            overlap: Duration::from_secs_f64(file.air.overlap_s),
            link_key,
            lines,
            vehicles,
            reach_m: file.rules.reach_m,
            error_m: file.rules.error_m,
        })
    }
}

fn no_plane(source: &Source<'_>) -> ScenarioError {
    let remedy = "give a scenario with [plane]; autopilots follow velocities";
    source.error("scenario", "its robots move from cell to cell", remedy)
}

fn check_scenario(source: &Source<'_>, scenario: &Scenario) -> Result<(), ScenarioError> {
    let Some(plane) = scenario.plane() else {
        return Err(no_plane(source));
    };
    let tick = format!("its tick of {} s is too long for vehicles", scenario.tick_s());
    let radius = format!("grid.radius {} is too large", scenario.laws.radius);
    let added = scenario.laws().find(|law| law.built_in().is_none());
    let law = format!("companions do not have the law \"{}\"", added.map_or("", LawSetup::name));
    let faults: [(bool, &str, &str); 9] = [
        (added.is_some(), &law, "give one of the controller's laws"),
        (scenario.tick_us > 500_000, &tick, "give it tick_s = 0.5 or less; 0.1 is good"),
        (
            !plane.orders.is_empty(),
            "[[plane.order]] is not supported on real vehicles",
            "remove it; an operator sends orders as packets",
        ),
        (
            !plane.intruders.is_empty(),
            "[[plane.intruder]] is not supported on real vehicles",
            "remove it; intruders are simulated only",
        ),
        (plane.torus_m.is_some(), "plane.torus_m is not supported on real vehicles", "remove plane.torus_m"),
        (!scenario.clocks.is_synchronous(), "real vehicles have clocks of their own", "remove [clocks] and phase_s"),
        (scenario.sensing().is_some(), "autopilots report no detections of other vehicles", "remove plane.sensing"),
        (scenario.laws.numbers != NumberFormat::F32, "companions compute in f32", "remove numbers"),
        (scenario.laws.radius > RADIUS, &radius, "give 16 or less"),
    ];
    match faults.into_iter().find(|(is_wrong, ..)| *is_wrong) {
        Some((_, what, remedy)) => Err(source.error("scenario", what, remedy)),
        None => Ok(()),
    }
}

fn check_rules(source: &Source<'_>, rules: &RulesTable) -> Result<(), ScenarioError> {
    if rules.arm && rules.entry != Entry::Once {
        let what = "only the pilot arms with entry \"wait\"";
        return Err(source.error("rules.arm", what, "give rules.entry = \"once\", or remove it"));
    }
    if rules.takeoff && !rules.arm {
        let what = "a takeoff needs an armed vehicle";
        return Err(source.error("rules.takeoff", what, "give rules.arm = true, or remove it"));
    }
    Ok(())
}

fn address(source: &Source<'_>, field: &str, text: &str) -> Result<SocketAddr, ScenarioError> {
    text.parse().map_err(|_| {
        let remedy = "give an address and a port, as in 192.168.1.7:14999";
        source.error(field, format!("`{text}` is not an address"), remedy)
    })
}

fn air(source: &Source<'_>, table: &AirTable) -> Result<MediumSetup, ScenarioError> {
    let clash =
        |field: &str, remedy: &str| Err(source.error(field, "the network to other companions is ambiguous", remedy));
    if table.bind.is_some() == table.peers.is_empty() {
        return clash("air.peers", "give bind and peers together, or neither");
    }
    match (&table.multicast, &table.bind, table.tunnel) {
        (None, None, false) => Ok(MediumSetup::Here),
        (None, None, true) => Ok(MediumSetup::Tunnel),
        (Some(group), None, false) => {
            let group = match address(source, "air.multicast", group)? {
                SocketAddr::V4(group) if group.ip().is_multicast() && group.port() > 0 => group,
                _ => {
                    let what = format!("`{group}` is not an IPv4 multicast group");
                    return Err(source.error("air.multicast", what, "give one such as 239.255.77.1:14999"));
                }
            };
            let interface = table.interface.as_deref().unwrap_or("0.0.0.0");
            let interface = interface.parse().map_err(|_| {
                let what = format!("`{interface}` is not an IPv4 address");
                source.error("air.interface", what, "give that of an own interface, as in 192.168.1.7")
            })?;
            Ok(MediumSetup::Multicast { group, interface })
        }
        (None, Some(bind), false) => {
            let bind = address(source, "air.bind", bind)?;
            let peers = (0..).zip(&table.peers).map(|(i, peer)| address(source, &format!("air.peers[{i}]"), peer));
            Ok(MediumSetup::Peers { bind, peers: peers.collect::<Result<_, _>>()? })
        }
        _ => clash("air", "give only one of multicast, peers and tunnel"),
    }
}

fn rules(table: &RulesTable, vehicle: &VehicleTable, flies: bool) -> Rules {
    Rules {
        entry: table.entry,
        arm: table.arm,
        takeoff: table.takeoff && vehicle.autopilot.flies(),
        altitude_m: vehicle.altitude_m.or(table.altitude_m).filter(|_| vehicle.autopilot.flies()),
        // Flying robots avoid each other by height too, so the height is the controller's.
        keeps_altitude: !flies,
        stale: Duration::from_secs_f64(table.stale_s),
        link_lost: Duration::from_secs_f64(table.link_lost_s),
        setpoint_every: Duration::from_secs_f64(1.0 / table.setpoint_hz),
        position_hz: table.position_hz,
        rehearses: false,
    }
}

fn vehicles(
    source: &Source<'_>,
    file: &ConfigFile,
    origin: &Origin,
    scenario: &mut Scenario,
) -> Result<(Vec<Endpoint>, Vec<VehicleSetup>), ScenarioError> {
    let (mut lines, mut vehicles) = (Vec::new(), Vec::<VehicleSetup>::new());
    for (number, table) in file.vehicle.iter().enumerate() {
        let fail =
            |name: &str, what: String, remedy: &str| source.error(&format!("vehicle[{number}].{name}"), what, remedy);
        let robot = RobotId(table.robot);
        let index = scenario.robots.binary_search_by_key(&robot, |robot| robot.id).map_err(|_| {
            let remedy = format!("give the number of one of its {}", scenario.robots.len());
            fail("robot", format!("the scenario has no robot {robot}"), &remedy)
        })?;
        let endpoint = table.link.parse::<Endpoint>().map_err(|EndpointError { text, what }| {
            let remedy = "give a link, for example udpin:127.0.0.1:14550, tcpout:127.0.0.1:5760 or serial:/dev/ttyACM0,baud=57600";
            fail("link", format!("`{text}`: {what}"), remedy)
        })?;
        let line = lines.iter().position(|known| *known == endpoint);
        let line = line.unwrap_or_else(|| {
            lines.push(endpoint);
            lines.len() - 1
        });
        let system = table.system.unwrap_or(table.robot);
        let Some(system) = u8::try_from(system).ok().filter(|system| (1..=SYSTEMS).contains(system)) else {
            return Err(fail("system", format!("{system} is not a MAVLink system id of a vehicle"), "give 1 to 254"));
        };
        if vehicles.iter().any(|known| known.index == index) {
            return Err(fail("robot", format!("robot {robot} is listed twice"), "give each vehicle its own number"));
        }
        if vehicles.iter().any(|known| (known.line, known.system) == (line, system)) {
            let remedy = "give each vehicle its own id (ArduPilot: SYSID_THISMAV, PX4: MAV_SYS_ID)";
            return Err(fail("system", format!("system {system} is used twice on this link"), remedy));
        }
        let rules = rules(&file.rules, table, scenario.safety(index).flies());
        if file.rules.takeoff && table.autopilot.flies() && rules.altitude_m.is_none() {
            let what = "the takeoff height is missing";
            return Err(source.error("rules.takeoff", what, "give altitude_m"));
        }
        if let Some(goal) = table.goal_deg {
            assign_goal(goal, origin, scenario, index)
                .map_err(|[what, remedy]| fail("goal_deg", what.into(), remedy))?;
        }
        vehicles.push(VehicleSetup { robot, index, system, line, kind: table.autopilot, rules });
    }
    if vehicles.is_empty() {
        let remedy = "add [[vehicle]] with robot, link and autopilot";
        return Err(source.error("vehicle", "no vehicle is listed", remedy));
    }
    vehicles.sort_by_key(|vehicle| vehicle.robot);
    Ok((lines, vehicles))
}

/// The error is the problem and the remedy.
fn assign_goal(
    [latitude_deg, longitude_deg]: [f64; 2],
    origin: &Origin,
    scenario: &mut Scenario,
    index: usize,
) -> Result<(), [&'static str; 2]> {
    let place = origin.to_enu_m(&Global { latitude_deg, longitude_deg, altitude_m: origin.place().altitude_m });
    let [x, y, _] = place.ok_or(["not a position near the origin", "give [latitude, longitude] in degrees"])?;
    let plane = scenario.plane_mut();
    let target = plane.filter(|plane| plane.group(index).law.goals() == Goals::Waypoints);
    let target = target.and_then(|plane| plane.starts.get_mut(index)?.places.last_mut());
    let target = target
        .ok_or(["this robot's law in the scenario has no goal to replace", "remove it, or give law = \"waypoint\""])?;
    target.position_m = [x, y, target.position_m[2]];
    Ok(())
}

#[cfg(test)]
mod tests;
