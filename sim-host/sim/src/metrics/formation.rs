//! Quality of a formation (KUZ section 6).

use crate::scenario::{Formation, Scenario};
use crate::terrain::Terrain;
use serde::{Deserialize, Serialize};
use staya_controller::grid::Cell;

/// Quality of a formation at one moment.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FormationQuality {
    /// Mean of |desired - actual| over robots that are not down, cells, with the graph at the first
    /// of them (error 0).
    pub error_per_agent: f64,
    /// The mean error with the graph at its least-squares place: distortion without mere lag.
    pub best_fit_error_per_agent: f64,
    /// Graph distance, see [`FormationMeter`].
    pub graph_distance: f64,
}

impl std::ops::AddAssign for FormationQuality {
    fn add_assign(&mut self, other: Self) {
        self.error_per_agent += other.error_per_agent;
        self.best_fit_error_per_agent += other.best_fit_error_per_agent;
        self.graph_distance += other.graph_distance;
    }
}

/// Time that a formation may take to form before its error counts, seconds.
pub const FORMED_AFTER_S: f64 = 10.0;

/// A robot's body as [`FormationMeter`] sees it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Member {
    /// Position of the body, cells.
    pub at: [f64; 2],
    /// Its computer is down: it neither leads nor counts in mean errors.
    pub is_down: bool,
}

/// Distance of robots in the plane from their places relative to the first robot that is not down,
/// after [`FORMED_AFTER_S`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlaceError {
    /// Mean over robots that are not down (the first counts, with 0) and ticks, metres.
    pub mean_m: f64,
    /// Largest error of any such robot in any tick, metres.
    pub worst_m: f64,
    /// Place of that robot, from 1; 0 if all errors are 0.
    pub robot: u32,
    /// Time of the largest error, seconds.
    pub at_s: f64,
}

/// Measures a formation tick by tick: the formation error dPhi = (1/T) sum over robots and ticks of
/// |desired - actual|, here per robot, and the graph distance.
///
/// The graph distance is m0 + m1 + kappa * sum of |desired - actual| over the common vertices, with
/// kappa = 1 / diagonal of the map and the graph placed at the first robot that is not down. A
/// vertex is common if its robot is within `eps` cells (along either axis, as in algorithm 5) of
/// its place. m0 counts missed places. m1 counts those within `eps` of another robot that has
/// itself lost its place; otherwise every robot of a formation narrower than eps would stand in for
/// all others.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct FormationMeter {
    places: Vec<[f64; 2]>,
    eps: f64,
    kappa: f64,
    ticks: u32,
    sum: FormationQuality,
    errors: Vec<f64>,
    missing: Vec<usize>,
    cell_m: f64,
    tick_s: f64,
    steady: Steady,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Steady {
    ticks: u32,
    sum: f64,
    worst: PlaceError,
}

impl FormationMeter {
    /// Creates a meter without measurements.
    #[must_use]
    pub fn new(formation: &Formation, eps: u8, terrain: &Terrain, tick_s: f64) -> Self {
        let [width, height] = [terrain.width(), terrain.height()].map(|side| f64::from(side) - 1.0);
        let diagonal = (width * width + height * height).sqrt().max(1.0);
        Self {
            places: formation.places.iter().map(|&place| in_cells(place)).collect(),
            eps: eps.into(),
            kappa: 1.0 / diagonal,
            ticks: 0,
            sum: FormationQuality { error_per_agent: 0.0, best_fit_error_per_agent: 0.0, graph_distance: 0.0 },
            errors: Vec::new(),
            missing: Vec::new(),
            cell_m: terrain.cell_m,
            tick_s,
            steady: Steady { ticks: 0, sum: 0.0, worst: PlaceError { mean_m: 0.0, worst_m: 0.0, robot: 0, at_s: 0.0 } },
        }
    }

    pub(crate) fn is_of(&self, other: &Self) -> bool {
        self.places == other.places && self.errors.len() <= self.places.len()
    }

    /// Measures one tick and adds it to the means; see [`FormationMeter::look`].
    ///
    /// # Panics
    /// If there are no bodies, or more bodies than places.
    pub fn measure(&mut self, bodies: &[Member]) -> FormationQuality {
        let now = self.look(bodies);
        self.sum += now;
        self.ticks += 1;
        let at_s = f64::from(self.ticks) * self.tick_s;
        if at_s > FORMED_AFTER_S {
            let Steady { ticks, sum, worst } = &mut self.steady;
            *ticks += 1;
            *sum += now.error_per_agent;
            let up = (1..).zip(&self.errors).zip(bodies).filter(|(_, body)| !body.is_down);
            for ((robot, error), _) in up {
                let error_m = error * self.cell_m;
                if error_m > worst.worst_m {
                    *worst = PlaceError { worst_m: error_m, robot, at_s, ..*worst };
                }
            }
        }
        now
    }

    /// Place errors after the first [`FORMED_AFTER_S`]; `None` if the run was shorter.
    #[must_use]
    pub fn place_error(&self) -> Option<PlaceError> {
        let Steady { ticks, sum, worst } = self.steady;
        (ticks > 0).then(|| PlaceError { mean_m: sum / f64::from(ticks) * self.cell_m, ..worst })
    }

    /// Measures the current quality; `bodies[i]` is the robot of place i. O(n), and O(m^2) for m
    /// lost robots. If all are down, errors are 0 and the graph is at the first robot.
    ///
    /// # Panics
    /// If there are no bodies, or more bodies than places.
    pub fn look(&mut self, bodies: &[Member]) -> FormationQuality {
        let leader = bodies.iter().position(|body| !body.is_down).unwrap_or(0);
        let top = offset(bodies[leader].at, self.places[leader]);
        self.errors.clear();
        self.missing.clear();
        let (mut graph, mut mean) = (0.0, [0.0; 2]);
        for (index, body) in bodies.iter().enumerate() {
            let [x, y] = offset(body.at, self.places[index]);
            let off = [x - top[0], y - top[1]];
            if !body.is_down {
                mean = [mean[0] + x, mean[1] + y];
            }
            let error = length(off);
            self.errors.push(error);
            if off.iter().all(|d| d.abs() <= self.eps) {
                graph += self.kappa * error;
            } else {
                self.missing.push(index);
            }
        }
        let up = || bodies.iter().enumerate().filter(|(_, body)| !body.is_down);
        let count = up().count().max(1) as f64;
        let mean = mean.map(|sum| sum / count);
        let fit: f64 = up()
            .map(|(index, body)| {
                let [x, y] = offset(body.at, self.places[index]);
                length([x - mean[0], y - mean[1]])
            })
            .sum();
        FormationQuality {
            error_per_agent: up().map(|(index, _)| self.errors[index]).sum::<f64>() / count,
            best_fit_error_per_agent: fit / count,
            graph_distance: graph + (self.missing.len() + self.taken(bodies, top)) as f64,
        }
    }

    fn taken(&self, bodies: &[Member], top: [f64; 2]) -> usize {
        let is_near = |place: usize, robot: usize| {
            let [x, y] = offset(bodies[robot].at, self.places[place]);
            (x - top[0]).abs() <= self.eps && (y - top[1]).abs() <= self.eps
        };
        let missing = self.missing.iter();
        missing.filter(|&&place| self.missing.iter().any(|&robot| is_near(place, robot))).count()
    }

    /// Last distance of each robot from its place relative to the first that is not down, cells.
    #[must_use]
    pub fn errors(&self) -> &[f64] {
        &self.errors
    }

    /// Means over all ticks so far; `None` before the first.
    #[must_use]
    pub fn mean(&self) -> Option<FormationQuality> {
        let ticks = f64::from(self.ticks);
        (self.ticks > 0).then(|| FormationQuality {
            error_per_agent: self.sum.error_per_agent / ticks,
            best_fit_error_per_agent: self.sum.best_fit_error_per_agent / ticks,
            graph_distance: self.sum.graph_distance / ticks,
        })
    }
}

/// Centre of a cell, in cells from that of (0, 0).
pub fn in_cells(cell: Cell) -> [f64; 2] {
    [cell.x, cell.y].map(f64::from)
}

/// Longest time that a robot of a formation in the plane would need alone, seconds: straight to its
/// goal on easy land, with full acceleration and braking. `None` without such a formation.
#[must_use]
pub fn free_formation_s(scenario: &Scenario) -> Option<f64> {
    let plane = scenario.plane().filter(|_| !scenario.formations.is_empty())?;
    let keeps_one = |(index, _): &(usize, _)| scenario.formation_of(*index).is_some();
    let free = plane.starts.iter().enumerate().filter(keeps_one).filter_map(|(index, start)| {
        let group = plane.group(index);
        let goal_m = start.places.first()?.position_m;
        let off = [0, 1].map(|axis| goal_m[axis] - start.position_m[axis]);
        let (way_m, speed) = (length(off), group.cruise_mps);
        let by_inertia = speed / group.abilities.max_acceleration_mps2;
        // A short way ends before the robot reaches its top speed.
        let most_m = speed * by_inertia;
        let short = 2.0 * by_inertia * libm::sqrt(way_m / most_m);
        Some(if way_m < most_m { short } else { way_m / speed + by_inertia })
    });
    free.fold(None, |longest: Option<f64>, free| Some(longest.map_or(free, |longest| longest.max(free))))
}

fn offset(body: [f64; 2], place: [f64; 2]) -> [f64; 2] {
    [body[0] - place[0], body[1] - place[1]]
}

fn length([x, y]: [f64; 2]) -> f64 {
    (x * x + y * y).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bodies(cells: &[(i16, i16)]) -> Vec<Member> {
        cells.iter().map(|&(x, y)| Member { at: in_cells(Cell::new(x, y)), is_down: false }).collect()
    }

    #[test]
    fn errors_are_measured_at_the_first_robot_that_is_not_down_and_only_of_such_robots() {
        let mut meter = meter(&[(0, 0), (-3, 0), (-6, 0)], 5);
        let mut bodies = bodies(&[(10, 0), (70, 0), (67, 4)]);
        bodies[0].is_down = true;
        let now = meter.measure(&bodies);
        assert_eq!(meter.errors(), [63.0, 0.0, 4.0]);
        assert_eq!((now.error_per_agent, now.best_fit_error_per_agent), (2.0, 2.0));
        assert_eq!(now.graph_distance, 1.0 + 4.0 / 5.0, "the place of the dead robot is missed");
        for _ in 0..2 {
            meter.measure(&bodies);
        }
        let error = PlaceError { mean_m: 2.0, worst_m: 4.0, robot: 3, at_s: 12.0 };
        assert_eq!(meter.place_error(), Some(error));
        bodies.iter_mut().for_each(|body| body.is_down = true);
        let now = meter.measure(&bodies);
        assert_eq!((now.error_per_agent, now.best_fit_error_per_agent), (0.0, 0.0));
    }

    fn meter(places: &[(i16, i16)], eps: u8) -> FormationMeter {
        let formation = Formation {
            places: places.iter().map(|&(x, y)| Cell::new(x, y)).collect(),
            edges: Vec::new(),
            templates: Vec::new(),
            first: 0,
        };
        FormationMeter::new(&formation, eps, &Terrain::flat(5, 4), 4.0)
    }

    #[test]
    fn a_formation_in_place_has_no_error_anywhere_on_the_map() {
        let mut meter = meter(&[(0, 0), (-3, 0), (0, -3)], 2);
        for (x, y) in [(0, 0), (30, -7), (i16::MAX, i16::MAX)] {
            let now = meter.measure(&bodies(&[(x, y), (x - 3, y), (x, y - 3)]));
            let none = FormationQuality { error_per_agent: 0.0, best_fit_error_per_agent: 0.0, graph_distance: 0.0 };
            assert_eq!(now, none);
            assert_eq!(meter.errors(), [0.0; 3]);
        }
    }

    #[test]
    fn errors_are_per_robot_and_averaged_over_ticks() {
        let mut meter = meter(&[(0, 0), (-3, 0)], 5);
        assert!(meter.mean().is_none());
        // Robot 2 is off by (3, 4), half of which a translation explains.
        let now = meter.measure(&bodies(&[(10, 10), (10, 14)]));
        assert_eq!(meter.errors(), [0.0, 5.0]);
        assert_eq!((now.error_per_agent, now.best_fit_error_per_agent), (2.5, 2.5));
        assert_eq!(now.graph_distance, 1.0);
        meter.measure(&bodies(&[(10, 10), (7, 10)]));
        meter.look(&bodies(&[(10, 10), (90, 90)]));
        let mean = meter.mean().expect("two ticks");
        assert_eq!((mean.error_per_agent, mean.graph_distance), (1.25, 0.5));
    }

    #[test]
    fn the_best_fit_ignores_a_leader_that_runs_ahead() {
        let mut meter = meter(&[(0, 0), (-3, 0), (-6, 0), (-9, 0)], 5);
        let now = meter.measure(&bodies(&[(14, 0), (7, 0), (4, 0), (1, 0)]));
        assert_eq!(now.error_per_agent, 3.0);
        assert_eq!(now.best_fit_error_per_agent, 1.5);
    }

    #[test]
    fn the_graph_distance_counts_missed_and_taken_places() {
        let places = [(0, 0), (-3, 0), (-6, 0)];
        // The place of robot 2 is missed; robot 3 is near it but has its own: only m0.
        let now = meter(&places, 3).measure(&bodies(&[(10, 0), (90, 0), (4, 0)]));
        assert_eq!(now.graph_distance, 1.0);
        // Robots 2 and 3 have swapped places: m0 = m1 = 2.
        let now = meter(&places, 2).measure(&bodies(&[(10, 0), (4, 0), (7, 0)]));
        assert_eq!(now.graph_distance, 4.0);
        let now = meter(&places, 3).measure(&bodies(&[(10, 0), (4, 0), (7, 0)]));
        assert!((now.graph_distance - 6.0 / 5.0).abs() < 1e-12);
    }

    #[test]
    fn errors_in_metres_count_after_the_forming_time() {
        let mut meter = meter(&[(0, 0), (-3, 0)], 5);
        for away in [90, 90] {
            meter.measure(&bodies(&[(10, 10), (away, 10)]));
            assert_eq!(meter.place_error(), None, "8 s at most");
        }
        meter.measure(&bodies(&[(10, 10), (7, 10)]));
        let mut off = bodies(&[(10, 10), (7, 10)]);
        off[1].at[1] += 0.5;
        meter.measure(&off);
        let error = PlaceError { mean_m: 0.125, worst_m: 0.5, robot: 2, at_s: 16.0 };
        assert_eq!(meter.place_error(), Some(error));
    }
}
