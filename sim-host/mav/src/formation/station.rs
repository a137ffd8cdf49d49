//! A ground station that sends orders to a formation and collects the confirmations.

use super::{Graph, Order, STATION, orders};
use crate::framed::{framed, signed};
use crate::geo::{Global, Origin};
use crate::{Endpoint, Lines};
use anyhow::{Result, bail};
use clap::ValueEnum;
use serde::Serialize;
use staya_controller::grid::Dir;
use staya_mavlink::constants::{MAV_COMP_ID_AUTOPILOT1, MAV_SEVERITY_WARNING, MAV_TYPE_GCS};
use staya_mavlink::dialect::{HEARTBEAT_DATA, MavMessage};
use staya_mavlink::frame::{RawFrame, Sender};
use staya_mavlink::signing::Signing;
use staya_mavlink::wire::MAX_ROBOT;
use std::collections::{BTreeMap, BTreeSet};
use std::time::{Duration, Instant};

const EVERY: Duration = Duration::from_millis(500);
/// Robots send heartbeats at 1 Hz, so all follow the first one within this time.
const GATHER: Duration = Duration::from_millis(1500);
/// Less than the capacity of a peer's queue.
const AT_ONCE: usize = 100;
const GLANCE: Duration = Duration::from_millis(20);

/// Confirmations of the orders.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Given {
    /// Robots of the formation.
    pub robots: BTreeSet<u8>,
    /// Robots that confirmed their places.
    pub placed: BTreeSet<u8>,
    /// Robots that confirmed the goal.
    pub heading_for_goal: BTreeSet<u8>,
    /// Refusals, with robot numbers.
    pub objections: Vec<(u8, String)>,
    /// Frames of orders sent, repetitions included.
    pub frames: usize,
}

impl Given {
    /// Robots that have not confirmed their places, or the goal if they got one.
    pub fn silent(&self, has_goal: bool) -> BTreeSet<u8> {
        let confirms = |robot: &u8| self.placed.contains(robot) && (!has_goal || self.heading_for_goal.contains(robot));
        self.robots.iter().copied().filter(|robot| !confirms(robot)).collect()
    }
}

/// Assignment of places to robots.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Places {
    /// Smallest sum of squared distances, so that paths do not cross.
    Nearest,
    /// In the order of robot numbers, the first in front.
    Number,
}

/// Selection of robots and their places.
#[derive(Clone, Debug)]
pub struct Members {
    /// Selected robots; `None` for all that are found.
    pub robots: Option<BTreeSet<u8>>,
    /// Assignment of places.
    pub places: Places,
    /// Heading of the formation; `Stay` means east.
    pub heading: Dir,
}

struct Station<'a> {
    lines: Lines,
    signing: Option<&'a mut Signing>,
    heard: BTreeSet<u8>,
    at: BTreeMap<u8, Global>,
    greeted: Option<Instant>,
    sender: Sender,
    given: Given,
}

impl Station<'_> {
    /// A listening link sends only to peers from which it received frames.
    fn greet(&mut self) {
        if self.greeted.is_some_and(|at| at.elapsed() < EVERY) {
            return;
        }
        self.greeted = Some(Instant::now());
        // 8: not an autopilot.
        let beat =
            HEARTBEAT_DATA { mavtype: MAV_TYPE_GCS, autopilot: 8, mavlink_version: 3, ..HEARTBEAT_DATA::DEFAULT };
        let frame = framed(&mut self.sender, &MavMessage::HEARTBEAT(beat), self.signing.as_deref_mut());
        frame.iter().for_each(|frame| self.lines.send_all(frame));
    }

    fn listen(&mut self) {
        self.greet();
        let until = Instant::now() + GLANCE;
        while let Some(received) = self.lines.receive(until.saturating_duration_since(Instant::now())) {
            let Some(frame) = RawFrame::new(&received.frame) else {
                continue;
            };
            let is_believed = self.signing.as_mut().is_none_or(|signing| signing.verify(&frame).is_accepted());
            let Sender { system, component, .. } = frame.sender();
            let is_robot = component == MAV_COMP_ID_AUTOPILOT1 && (1..=MAX_ROBOT).contains(&system);
            if !is_robot || !is_believed {
                continue;
            }
            self.lines.believe(received.line, received.peer);
            match frame.message() {
                Some(MavMessage::HEARTBEAT(_)) => drop(self.heard.insert(system)),
                Some(MavMessage::GLOBAL_POSITION_INT(fix)) => {
                    self.at.insert(system, Global::from_e7(fix.lat, fix.lon, 0));
                }
                Some(MavMessage::STATUSTEXT(said)) => {
                    self.note(system, said.severity, said.text.to_str().unwrap_or(""))
                }
                _ => {}
            }
        }
    }

    fn note(&mut self, robot: u8, severity: u8, text: &str) {
        if text.starts_with("new formation: place ") {
            self.given.placed.insert(robot);
        } else if text.starts_with("goal: cell ") {
            self.given.heading_for_goal.insert(robot);
        } else if severity <= MAV_SEVERITY_WARNING && text.starts_with("STAYA_") {
            let objection = (robot, text.to_owned());
            if !self.given.objections.contains(&objection) {
                self.given.objections.push(objection);
            }
        }
    }

    /// Positions are needed for nearest places only.
    fn gather(&mut self, endpoint: &Endpoint, wanted: &Members, until: Instant) -> Result<BTreeSet<u8>> {
        let mut first = None;
        loop {
            let robots = wanted.robots.as_ref().unwrap_or(&self.heard).clone();
            let missing: BTreeSet<u8> = robots.difference(&self.heard).copied().collect();
            let is_placed = |robot: &u8| wanted.places == Places::Number || self.at.contains_key(robot);
            let nowhere: BTreeSet<u8> = robots.iter().copied().filter(|robot| !is_placed(robot)).collect();
            let may_follow = wanted.robots.is_none() && first.is_none_or(|at: Instant| at.elapsed() < GATHER);
            let is_whole = missing.is_empty() && nowhere.is_empty() && !may_follow;
            if !is_whole && Instant::now() < until {
                self.listen();
                if !self.heard.is_empty() {
                    first.get_or_insert_with(Instant::now);
                }
                continue;
            }
            let (missing, heard, nowhere) = (numbers(&missing), numbers(&self.heard), numbers(&nowhere));
            return match () {
                () if heard.is_empty() => bail!(
                    "{endpoint}: no robot found; start `staya bridge SCENARIO --mavlink udpin:HOST:PORT` there, or give \
                     more time (--wait) or the key (--key)"
                ),
                () if !missing.is_empty() => bail!(
                    "{endpoint}: robots {missing} not found, only {heard}; select other robots (--robots) or give more \
                     time (--wait)"
                ),
                () if !nowhere.is_empty() => bail!(
                    "robots {nowhere} sent no position (GLOBAL_POSITION_INT); give more time (--wait), or \
                     `--places number`"
                ),
                () => Ok(robots),
            };
        }
    }

    /// Positions in metres east and north of the first robot.
    fn positions(&self, robots: &BTreeSet<u8>) -> Vec<[f64; 2]> {
        let places: Vec<_> = robots.iter().filter_map(|robot| self.at.get(robot)).collect();
        let origin = places.first().and_then(|&&first| Origin::new(first));
        let position = |place: &Global| origin?.to_enu_m(place).map(|[east, north, _]| [east, north]);
        places.into_iter().filter_map(position).collect()
    }
}

/// Formats numbers as ranges: "1 to 4, 7".
pub fn numbers(robots: &BTreeSet<u8>) -> String {
    let mut runs: Vec<[u8; 2]> = Vec::new();
    for &robot in robots {
        match runs.last_mut() {
            Some([_, last]) if last.checked_add(1) == Some(robot) => *last = robot,
            _ => runs.push([robot, robot]),
        }
    }
    let text = |[first, last]: &[u8; 2]| match last - first {
        0 => first.to_string(),
        1 => format!("{first}, {last}"),
        _ => format!("{first} to {last}"),
    };
    runs.iter().map(text).collect::<Vec<_>>().join(", ")
}

/// Sends the orders to the swarm at `endpoint` until all robots confirm them or `wait` is over.
///
/// # Errors
/// The link cannot be opened, the formation is invalid, or selected robots or their positions are
/// not found. Robots without a confirmation are not an error: see [`Given`].
pub fn give(
    endpoint: &Endpoint,
    signing: Option<&mut Signing>,
    graph: impl FnOnce(usize) -> Result<Graph>,
    members: &Members,
    order: &Order,
    wait: Duration,
) -> Result<Given> {
    let lines = Lines::open(std::slice::from_ref(endpoint))?;
    let until = Instant::now() + wait;
    let (heard, at, given) = (BTreeSet::new(), BTreeMap::new(), Given::default());
    let sender = Sender { system: STATION, component: 190, sequence: 0 };
    let mut station = Station { lines, signing, heard, at, greeted: None, sender, given };
    let robots = station.gather(endpoint, members, until)?;
    let mut graph = graph(robots.len())?.turned(members.heading)?;
    if graph.robots() != robots.len() {
        bail!(
            "the formation is for {} robots, but {} are selected; select others (--robots)",
            graph.robots(),
            robots.len()
        );
    }
    if members.places == Places::Nearest {
        graph = graph.nearest(&station.positions(&robots));
    }
    let order = Order { to_all: robots == station.heard, ..*order };
    let numbers: Vec<u8> = robots.iter().copied().collect();
    let frames = orders(&graph, &numbers, &order)?;
    station.given.robots = robots;
    // Robots found at the last moment receive their orders at least once.
    let until = until.max(Instant::now() + EVERY * 2);
    while Instant::now() < until {
        for chunk in frames.chunks(AT_ONCE) {
            for frame in chunk {
                let frame = signed(frame.clone(), station.signing.as_deref_mut());
                frame.iter().for_each(|frame| station.lines.send_all(frame));
            }
            station.listen();
        }
        station.given.frames += frames.len();
        let again = Instant::now() + EVERY;
        while Instant::now() < again {
            station.listen();
            if station.given.silent(order.goal.is_some()).is_empty() || !station.given.objections.is_empty() {
                return Ok(station.given);
            }
        }
    }
    Ok(station.given)
}
