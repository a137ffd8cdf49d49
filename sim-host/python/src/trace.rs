use numpy::IntoPyArray as _;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use staya_sim::engine::{Engine, Moment};
use staya_sim::record::RobotRow;

const NO_WAIT: u8 = u8::MAX;

/// Lines of robots every n-th tick, and of the swarm every tick.
#[derive(Debug, Default)]
pub struct Trace {
    every: u32,
    last: Option<u32>,
    robots: Robots,
    swarm: Swarm,
}

#[derive(Debug, Default)]
struct Robots {
    tick: Vec<u32>,
    time_s: Vec<f64>,
    robot: Vec<u32>,
    cell: [Vec<i16>; 2],
    place_m: [Vec<f64>; 3],
    velocity_mps: [Vec<f64>; 3],
    mode: Vec<u8>,
    leader: Vec<u32>,
    formation_error_cells: Vec<f32>,
    wait: Vec<u8>,
}

#[derive(Debug, Default)]
struct Swarm {
    tick: Vec<u32>,
    time_s: Vec<f64>,
    arrived: Vec<u64>,
    waiting: Vec<u64>,
    collisions: Vec<u64>,
    formation_error: Vec<f64>,
    graph_distance: Vec<f64>,
    sent: Vec<u64>,
    delivered: Vec<u64>,
    lost: Vec<u64>,
    damaged: Vec<u64>,
    rejected: Vec<u64>,
}

impl Trace {
    /// With `every` = 0 the interval is that of `staya run`, one tick per started thousand robots.
    pub fn new(every: u32, robots: usize) -> Self {
        let usual = u32::try_from(robots.div_ceil(1000)).unwrap_or(u32::MAX).max(1);
        Self { every: if every == 0 { usual } else { every }, ..Self::default() }
    }

    pub fn take(&mut self, engine: &Engine) {
        engine.show(&mut |moment, rows| {
            self.swarm.take(moment);
            if moment.row.tick.is_multiple_of(self.every) {
                self.take_robots(moment, rows);
            }
        });
    }

    pub fn finish(&mut self, engine: &Engine) {
        engine.show(&mut |moment, rows| {
            if self.last != Some(moment.row.tick) {
                self.take_robots(moment, rows);
            }
        });
    }

    fn take_robots(&mut self, moment: &Moment<'_>, rows: &mut dyn Iterator<Item = RobotRow>) {
        self.last = Some(moment.row.tick);
        for row in rows {
            self.robots.take(moment, &row);
        }
    }

    /// The columns of `trace` and `series`, named as in the CSV files.
    ///
    /// # Errors
    /// Python is out of memory.
    pub fn columns<'py>(self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let both = PyDict::new(py);
        both.set_item("trace", self.robots.columns(py)?)?;
        both.set_item("series", self.swarm.columns(py)?)?;
        Ok(both)
    }
}

macro_rules! columns {
    ($py:expr, $($name:literal: $column:expr),* $(,)?) => {{
        let columns = PyDict::new($py);
        $(columns.set_item($name, $column.into_pyarray($py))?;)*
        Ok(columns)
    }};
}

impl Robots {
    fn take(&mut self, moment: &Moment<'_>, row: &RobotRow) {
        let motion = &row.motion;
        self.tick.push(moment.row.tick);
        self.time_s.push(moment.row.time_s);
        self.robot.push(row.id);
        for (column, value) in self.cell.iter_mut().zip([motion.cell.x, motion.cell.y]) {
            column.push(value);
        }
        for (column, value) in self.place_m.iter_mut().zip(motion.position_m) {
            column.push(value);
        }
        for (column, value) in self.velocity_mps.iter_mut().zip(motion.velocity_mps) {
            column.push(value);
        }
        self.mode.push(row.mode as u8);
        self.leader.push(row.leader);
        self.formation_error_cells.push(row.formation_error_cells);
        self.wait.push(row.wait.map_or(NO_WAIT, |wait| wait as u8));
    }

    fn columns(self, py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
        let [x_cell, y_cell] = self.cell;
        let [x_m, y_m, z_m] = self.place_m;
        let [vx_mps, vy_mps, vz_mps] = self.velocity_mps;
        columns!(py,
            "tick": self.tick, "time_s": self.time_s, "robot": self.robot, "x_cell": x_cell, "y_cell": y_cell,
            "x_m": x_m, "y_m": y_m, "z_m": z_m, "vx_mps": vx_mps, "vy_mps": vy_mps, "vz_mps": vz_mps,
            "mode": self.mode, "leader": self.leader, "formation_error_cells": self.formation_error_cells,
            "wait": self.wait,
        )
    }
}

impl Swarm {
    fn take(&mut self, moment: &Moment<'_>) {
        let (row, packets) = (moment.row, moment.row.packets);
        self.tick.push(row.tick);
        self.time_s.push(row.time_s);
        self.arrived.push(moment.arrived as u64);
        self.waiting.push(moment.waiting as u64);
        self.collisions.push(moment.collisions);
        self.formation_error.push(row.formation_error_per_agent);
        self.graph_distance.push(row.graph_distance);
        self.sent.push(packets.sent);
        self.delivered.push(packets.delivered);
        self.lost.push(packets.lost);
        self.damaged.push(packets.damaged);
        self.rejected.push(packets.rejected);
    }

    fn columns(self, py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
        columns!(py,
            "tick": self.tick, "time_s": self.time_s, "formation_error": self.formation_error,
            "graph_distance": self.graph_distance, "sent": self.sent, "delivered": self.delivered, "lost": self.lost,
            "damaged": self.damaged, "rejected": self.rejected, "arrived": self.arrived, "waiting": self.waiting,
            "collisions": self.collisions,
        )
    }
}
