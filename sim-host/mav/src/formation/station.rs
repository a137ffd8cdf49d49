//! A ground station that gives a formation its orders and hears who has them.

use super::{Graph, GraphError, Order, STATION, orders};
use crate::{Endpoint, Lines, OpenError};
use serde::Serialize;
use staya_mavlink::constants::{MAV_COMP_ID_AUTOPILOT1, MAV_SEVERITY_WARNING, MAV_TYPE_GCS};
use staya_mavlink::dialect::{HEARTBEAT_DATA, MavMessage};
use staya_mavlink::frame::{MAX_FRAME_LEN, RawFrame, Sender, encode};
use staya_mavlink::signing::{Signing, Verdict};
use staya_mavlink::wire::MAX_ROBOT;
use std::collections::BTreeSet;
use std::time::{Duration, Instant};

/// Our own heartbeat comes so often, and orders are repeated so often.
const EVERY: Duration = Duration::from_millis(500);
/// Robots say that they are there once a second: after the first one, the others have so long.
const GATHER: Duration = Duration::from_millis(1500);
/// Frames sent at once; a peer's queue has room for more.
const AT_ONCE: usize = 100;
/// A glance at what comes in.
const GLANCE: Duration = Duration::from_millis(20);

/// What became of the orders.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Given {
    /// Robots that are there.
    pub robots: usize,
    /// Who has said that it has its place.
    pub placed: BTreeSet<u8>,
    /// Who has said that it has the goal.
    pub heading_for_goal: BTreeSet<u8>,
    /// What robots objected, with their numbers.
    pub objections: Vec<(u8, String)>,
    /// Frames of orders sent, repeated ones included.
    pub frames: usize,
}

/// Why nothing was sent.
#[derive(Debug, thiserror::Error)]
pub enum StationError {
    /// The line cannot be opened.
    #[error(transparent)]
    Line(#[from] OpenError),
    /// There is no such formation.
    #[error(transparent)]
    Graph(#[from] GraphError),
    /// Nobody is there.
    #[error(
        "no robot is heard at {0}: run `staya bridge SCENARIO --mavlink udpin:HOST:PORT` there, or give it more time (--wait), or its key (--key)"
    )]
    Nobody(String),
    /// Places are those of robots 1 to n.
    #[error("the robots that are heard are not 1 to {0}, but {1}: a formation's robots have the numbers of its places")]
    Numbers(usize, String),
    /// A file's formation is for another number of robots.
    #[error("the formation is for {0} robots, and {1} are heard")]
    Count(usize, usize),
}

/// A line to a swarm.
struct Station<'a> {
    lines: Lines,
    signing: Option<&'a mut Signing>,
    heard: BTreeSet<u8>,
    greeted: Option<Instant>,
    sequence: u8,
    given: Given,
}

impl Station<'_> {
    fn send(&mut self, frame: &[u8]) {
        let mut frame = frame.to_vec();
        if let Some(signing) = &mut self.signing {
            match signing.sign(&mut frame) {
                Ok(signature) => frame.extend_from_slice(&signature),
                // Better nothing than something that is not signed.
                Err(_) => return,
            }
        }
        self.lines.send(0, &frame);
    }

    /// Says that we are there, when that is due: who does not hear us does not speak to us.
    fn greet(&mut self) {
        if self.greeted.is_some_and(|at| at.elapsed() < EVERY) {
            return;
        }
        self.greeted = Some(Instant::now());
        let sender = Sender { system: STATION, component: 190, sequence: self.sequence };
        self.sequence = self.sequence.wrapping_add(1);
        // 8: no autopilot.
        let beat =
            HEARTBEAT_DATA { mavtype: MAV_TYPE_GCS, autopilot: 8, mavlink_version: 3, ..HEARTBEAT_DATA::DEFAULT };
        let mut frame = heapless::Vec::<u8, MAX_FRAME_LEN>::new();
        if encode(sender, &beat, &mut frame).is_ok() {
            self.send(&frame);
        }
    }

    /// Takes in what has come, for a glance.
    fn listen(&mut self) {
        self.greet();
        let until = Instant::now() + GLANCE;
        while let Some(received) = self.lines.receive(until.saturating_duration_since(Instant::now())) {
            let Some(frame) = RawFrame::new(&received.frame) else {
                continue;
            };
            let verdict = self.signing.as_mut().map_or(Verdict::Unsigned, |signing| signing.verify(&frame));
            let Sender { system, component, .. } = frame.sender();
            let is_robot = component == MAV_COMP_ID_AUTOPILOT1 && (1..=MAX_ROBOT).contains(&system);
            if !is_robot || !matches!(verdict, Verdict::Authentic | Verdict::Unsigned) {
                continue;
            }
            self.lines.believe(received.line, received.peer);
            match frame.message() {
                Some(MavMessage::HEARTBEAT(_)) => drop(self.heard.insert(system)),
                Some(MavMessage::STATUSTEXT(said)) => {
                    self.note(system, said.severity, said.text.to_str().unwrap_or(""))
                }
                _ => {}
            }
        }
    }

    fn note(&mut self, robot: u8, severity: u8, text: &str) {
        if text.starts_with("place ") && text.ends_with(" of a new formation") {
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

    /// Waits for all robots that there are; their numbers are 1 to what it returns.
    fn gather(&mut self, endpoint: &Endpoint, until: Instant) -> Result<usize, StationError> {
        let mut first = None;
        while Instant::now() < until && first.is_none_or(|at: Instant| at.elapsed() < GATHER) {
            self.listen();
            if !self.heard.is_empty() {
                first.get_or_insert_with(Instant::now);
            }
        }
        let count = self.heard.len();
        match self.heard.last() {
            None => Err(StationError::Nobody(endpoint.to_string())),
            Some(&last) if usize::from(last) != count => {
                let numbers: Vec<_> = self.heard.iter().map(u8::to_string).collect();
                Err(StationError::Numbers(count, numbers.join(", ")))
            }
            Some(_) => Ok(count),
        }
    }
}

/// Gives the swarm at `endpoint` these orders, again and again until every robot has said that it has them or `wait` is over.
///
/// # Errors
/// See [`StationError`]. Robots that do not answer are none: see [`Given`].
pub fn give(
    endpoint: &Endpoint,
    signing: Option<&mut Signing>,
    graph: impl FnOnce(usize) -> Result<Graph, GraphError>,
    order: &Order,
    wait: Duration,
) -> Result<Given, StationError> {
    let lines = Lines::open(std::slice::from_ref(endpoint))?;
    let until = Instant::now() + wait;
    let (heard, given) = (BTreeSet::new(), Given::default());
    let mut station = Station { lines, signing, heard, greeted: None, sequence: 0, given };
    let robots = station.gather(endpoint, until)?;
    let graph = graph(robots)?;
    if graph.robots() != robots {
        return Err(StationError::Count(graph.robots(), robots));
    }
    station.given.robots = robots;
    let frames = orders(&graph, order)?;
    // Whoever was found at the last moment is told at least once.
    let until = until.max(Instant::now() + EVERY * 2);
    while Instant::now() < until {
        for chunk in frames.chunks(AT_ONCE) {
            chunk.iter().for_each(|frame| station.send(frame));
            station.listen();
        }
        station.given.frames += frames.len();
        let again = Instant::now() + EVERY;
        while Instant::now() < again {
            station.listen();
            let Given { placed, heading_for_goal, objections, .. } = &station.given;
            let has_all = placed.len() == robots && (order.goal.is_none() || heading_for_goal.len() == robots);
            if has_all || !objections.is_empty() {
                return Ok(station.given);
            }
        }
    }
    Ok(station.given)
}
