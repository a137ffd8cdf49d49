use super::{number, signing};
use crate::Endpoint;
use crate::boot::fresh_boot;
use crate::formation::station::{Given, Members, Places, give, numbers};
use crate::formation::{Graph, Order, Shape};
use anyhow::{Context as _, Result, bail};
use clap::Args;
use staya_console::{Ended, Global, one_line, print, print_json};
use staya_controller::grid::{Cell, Dir};
use staya_sim::shown::Shown as _;
use std::collections::BTreeSet;
use std::path::Path;
use std::time::Duration;

/// Send a new shape or goal to a formation over MAVLink.
///
/// All robots that answer on the link, or those selected with --robots, receive nearby places of
/// the shape. Exit code 1 if a robot does not confirm its orders. Robots that receive their orders
/// in separate calls form separate formations.
#[derive(Args, Clone, Debug)]
#[command(
    allow_negative_numbers = true,
    after_help = "Example, in two terminals:\n  \
        staya bridge scenarios/six-robots.toml --speed 20 --mavlink udpin:127.0.0.1:14551\n  \
        staya formation wedge --to udpout:127.0.0.1:14551 --goal 60,40"
)]
pub struct FormationArgs {
    /// line, column, wedge, grid, circle, or a .toml file with `places` and `edges` as in the
    /// scenario table robots.formation.
    shape: String,
    /// Link to the swarm: udpout:HOST:PORT, udpin:HOST:PORT, tcpout:HOST:PORT, tcpin:HOST:PORT or
    /// serial:PORT,baud=N.
    #[arg(long, value_name = "LINE")]
    to: Endpoint,
    /// Robots to command: numbers and ranges, as in 3,5,8-12 [default: all that answer].
    #[arg(long, value_name = "NUMBERS", value_parser = robots)]
    robots: Option<Numbers>,
    /// Assignment of places.
    #[arg(long, value_name = "BY", value_enum, default_value_t = Places::Nearest)]
    places: Places,
    /// Goal of the front of the formation, a grid cell: east, north [default: the robots' present
    /// goal].
    #[arg(long, value_name = "X,Y", value_parser = cell)]
    goal: Option<Cell>,
    /// Cells between neighbours; without effect on a shape from a file.
    #[arg(long, value_name = "CELLS", default_value_t = 3, value_parser = clap::value_parser!(i16).range(1..=100))]
    spacing: i16,
    /// Heading of the formation: E, NE, N, NW, W, SW, S or SE.
    #[arg(long, value_name = "DIRECTION", default_value = "E", value_parser = heading)]
    heading: Dir,
    /// Time to wait for robots and their answers, seconds.
    #[arg(long, value_name = "S", default_value_t = 8.0, value_parser = number(1.0, 600.0))]
    wait: f64,
    /// Sign the orders with the bridge's key in this file.
    #[arg(long, value_name = "FILE")]
    key: Option<std::path::PathBuf>,
}

fn cell(text: &str) -> Result<Cell, String> {
    let numbers: Result<Vec<i16>, _> = text.split(',').map(|part| part.trim().parse()).collect();
    match numbers.as_deref() {
        Ok(&[x, y]) => Ok(Cell::new(x, y)),
        _ => Err(String::from("give two whole numbers, as in 60,40")),
    }
}

type Numbers = BTreeSet<u8>;

fn robots(text: &str) -> Result<Numbers, String> {
    let mut robots = Numbers::new();
    for part in text.split(',').map(str::trim) {
        let (first, last) = part.split_once('-').unwrap_or((part, part));
        let number = |text: &str| text.trim().parse::<u8>().ok().filter(|robot| (1..=254).contains(robot));
        match (number(first), number(last)) {
            (Some(first), Some(last)) if first <= last => robots.extend(first..=last),
            _ => {
                return Err(format!(
                    "`{part}` is not a robot number or range; give numbers from 1 to 254, as in 3,5,8-12"
                ));
            }
        }
    }
    Ok(robots)
}

fn heading(text: &str) -> Result<Dir, String> {
    const NAMES: [&str; 8] = ["E", "NE", "N", "NW", "W", "SW", "S", "SE"];
    let found = NAMES.iter().zip(Dir::MOVES).find(|(name, _)| name.eq_ignore_ascii_case(text));
    found.map(|(_, heading)| heading).ok_or_else(|| format!("give one of {}", NAMES.join(", ")))
}

impl FormationArgs {
    /// Runs the command.
    ///
    /// # Errors
    /// The shape is unknown or invalid, a link cannot be opened, no robot is found, or one refuses.
    pub fn run(&self, global: &Global) -> Result<Ended> {
        let graph: Box<dyn FnOnce(usize) -> Result<Graph>> = match Shape::from_name(&self.shape) {
            Some(shape) => Box::new(move |robots| shape.graph(robots, self.spacing)),
            None => self.read(Path::new(&self.shape)).map(|graph| Box::new(|_| Ok(graph)))?,
        };
        let mut signing = signing(self.key.as_deref(), 2)?;
        // Another number than that of the previous call, so robots accept version 1.
        let order = Order { goal: self.goal, to_all: true, boot: fresh_boot(), version: 1 };
        let members = Members { robots: self.robots.clone(), places: self.places, heading: self.heading };
        let wait = Duration::from_secs_f64(self.wait);
        let given = give(&self.to, signing.as_mut(), graph, &members, &order, wait)
            .with_context(|| one_line(&self.shape).into_owned())?;
        if global.json {
            print_json(&given)?;
        } else {
            print(&self.table(&given))?;
        }
        let silent = given.silent(self.goal.is_some());
        if let Some((robot, objection)) = given.objections.first() {
            bail!("robot {robot}: {objection}; add [robots.formation] to the scenario");
        }
        if !silent.is_empty() {
            bail!("robots {} did not confirm their orders; run the command again", numbers(&silent));
        }
        Ok(Ended::Done)
    }

    fn read(&self, path: &Path) -> Result<Graph> {
        if path.extension().is_none_or(|extension| extension != "toml") {
            let names = Shape::NAMES.map(|(name, _)| name).join(", ");
            bail!("`{}` is not a shape; give {names}, or a .toml file", one_line(&self.shape));
        }
        let text = std::fs::read_to_string(path).with_context(|| path.shown().to_string())?;
        Graph::parse(&text, path)
    }

    fn table(&self, given: &Given) -> String {
        let goal = self.goal.map_or_else(String::new, |goal| {
            format!(", {} robots head for cell ({}, {})", given.heading_for_goal.len(), goal.x, goal.y)
        });
        format!(
            "{}: {} of {} robots confirmed their places{goal} ({} frames sent)\n",
            self.shape,
            given.placed.len(),
            given.robots.len(),
            given.frames
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_headings_and_robot_ranges_parse() {
        assert_eq!(cell("60, -4"), Ok(Cell::new(60, -4)));
        assert_eq!((heading("nw"), heading("S")), (Ok(Dir::NorthWest), Ok(Dir::South)));
        for bad in ["", "1", "1,2,3", "a,b", "40000,0"] {
            assert!(cell(bad).is_err(), "{bad}");
        }
        assert!(heading("up").is_err());
        assert_eq!(robots("3, 5,8-12,12"), Ok(Numbers::from([3, 5, 8, 9, 10, 11, 12])));
        assert_eq!(numbers(&Numbers::from([1, 2, 5, 7, 8, 9])), "1, 2, 5, 7 to 9");
        for bad in ["", "0", "255", "3-", "5-3", "a", "1;2"] {
            let error = robots(bad).expect_err(bad);
            assert!(error.contains("as in 3,5,8-12"), "{error}");
        }
    }
}
