//! Negotiation of robots on a grid, all at once.

use crate::pool;
use numpy::{PyArray2, PyReadonlyArray2, PyReadonlyArray3};
use pyo3::prelude::*;
use pyo3::sync::MutexExt as _;
use rayon::prelude::*;
use staya_controller::grid::{Cell, Dir};
use staya_controller::negotiation::{Moves, Negotiator, Report, Said, Sensed, Sight};
use staya_controller::robot::RobotId;
use std::sync::{Mutex, PoisonError};

/// Robots in a plan.
const MEMBERS: usize = 64;
const BATCH: usize = 4;
/// Distance at which occupied cells are sensed, cells.
const SENSED: u32 = 5;

/// Robots on a grid that plan together, with the memory of each between steps.
#[pyclass(frozen, module = "staya._staya")]
pub struct Negotiators {
    ids: Vec<RobotId>,
    all: Mutex<Vec<Negotiator<MEMBERS>>>,
}

#[pymethods]
impl Negotiators {
    /// Robots at their starts, (x, y), which they have as goals.
    #[new]
    fn new(ids: Vec<u32>, starts: PyReadonlyArray2<'_, i16>, diagonals: bool) -> PyResult<Self> {
        let moves = Moves { diagonals, ..Moves::FOUR };
        let ids: Vec<RobotId> = ids.into_iter().map(RobotId).collect();
        let robot = |(&id, cell)| Negotiator::new(id, cell, moves);
        let all = ids.iter().zip(cells(&starts)?).map(robot).collect();
        Ok(Self { ids, all: Mutex::new(all) })
    }

    /// Runs one step of all robots. `sights[i, y, x]` are 11 x 11 cells around robot i, above 0 if
    /// closed, row 0 in the south. `beacons[i, j]` and `reports[i, j]`: whether robot i receives
    /// those of j. `sensing`: 0 nothing, 1 occupied cells, 2 robots. Returns the moves (x, y). Runs
    /// on all cores, without the interpreter lock.
    #[expect(clippy::too_many_arguments, reason = "Python gives them by name")]
    fn step<'py>(
        &self,
        py: Python<'py>,
        at: PyReadonlyArray2<'py, i16>,
        goals: PyReadonlyArray2<'py, i16>,
        sights: PyReadonlyArray3<'py, u8>,
        beacons: PyReadonlyArray2<'py, bool>,
        reports: PyReadonlyArray2<'py, bool>,
        sensing: u8,
    ) -> PyResult<Bound<'py, PyArray2<i16>>> {
        let (at, goals) = (cells(&at)?, cells(&goals)?);
        let (sights, beacons, reports) = (sights.as_slice()?, beacons.as_slice()?, reports.as_slice()?);
        let mut all = self.all.lock_py_attached(py).unwrap_or_else(PoisonError::into_inner);
        let all: &mut [Negotiator<MEMBERS>] = &mut all;
        let moves = pool::detached(py, || {
            let said: Vec<Said> = begin(all, &at, &goals, sights);
            self.each(all, beacons, |robot, id, from| robot.hear(id, &said[from]));
            let told: Vec<Report> = all.iter().map(Negotiator::report).collect();
            self.each(all, reports, |robot, id, from| robot.hear_report(id, &told[from], true));
            let robots = all.par_iter_mut().zip(&at).with_min_len(BATCH);
            let moves = robots.map(|(robot, &own)| self.decide(robot, own, &at, sensing).offset());
            moves.map(|Cell { x, y }| vec![x, y]).collect::<Vec<_>>()
        })?;
        Ok(PyArray2::from_vec2(py, &moves)?)
    }
}

impl Negotiators {
    /// Calls `hears` for each robot with the numbers of those whose packets it receives.
    fn each(
        &self,
        all: &mut [Negotiator<MEMBERS>],
        received: &[bool],
        hears: impl Fn(&mut Negotiator<MEMBERS>, RobotId, usize) + Sync,
    ) {
        let count = self.ids.len().max(1);
        all.par_iter_mut().zip(received.par_chunks(count)).with_min_len(BATCH).for_each(|(robot, received)| {
            for (from, &id) in self.ids.iter().enumerate().filter(|&(from, _)| received[from]) {
                hears(robot, id, from);
            }
        });
    }

    fn decide(&self, robot: &mut Negotiator<MEMBERS>, own: Cell, at: &[Cell], sensing: u8) -> Dir {
        let near = self.ids.iter().zip(at).filter(|&(_, &cell)| cell != own && cell.chebyshev(own) <= SENSED);
        let near: Vec<(RobotId, Cell)> = near.map(|(&id, &cell)| (id, cell)).collect();
        let occupied: Vec<Cell> = near.iter().map(|&(_, cell)| cell).collect();
        robot.decide(match sensing {
            0 => Sensed::Nothing,
            1 => Sensed::Cells(&occupied),
            _ => Sensed::Robots(&near),
        })
    }
}

fn begin(all: &mut [Negotiator<MEMBERS>], at: &[Cell], goals: &[Cell], sights: &[u8]) -> Vec<Said> {
    let robots = all.par_iter_mut().zip(at).zip(goals).zip(sights.as_chunks::<121>().0).with_min_len(BATCH);
    let said = robots.map(|(((robot, &cell), &goal), sight)| {
        if robot.goal() != goal {
            robot.set_goal(goal);
        }
        let is_closed = |seen: Cell| {
            let Cell { x, y } = seen - cell;
            sight[(y + 5) as usize * 11 + (x + 5) as usize] > 0
        };
        robot.see(cell, &Sight::new(cell, is_closed))
    });
    said.collect()
}

fn cells(array: &PyReadonlyArray2<'_, i16>) -> PyResult<Vec<Cell>> {
    Ok(array.as_slice()?.as_chunks::<2>().0.iter().map(|&[x, y]| Cell::new(x, y)).collect())
}
