//! Rows of `trace.csv` and `series.csv`, and the schema files that describe them.

use super::{Error, RobotRow, TickRow, write_atomically};
use staya_controller::agent::Wait;
use std::io::Write;
use std::path::Path;

type Column = (&'static str, &'static str, &'static str, &'static str);

pub const TRACE: [Column; 21] = [
    ("tick", "integer", "1", "number of the tick"),
    ("time_s", "number", "s", "simulated time"),
    ("robot", "integer", "1", "the robot's number"),
    ("x_cell", "integer", "cells", "column of its cell, growing east; empty: there are no cells"),
    ("y_cell", "integer", "cells", "row of its cell, growing north; empty: there are no cells"),
    ("x_m", "number", "m", "world position, east"),
    ("y_m", "number", "m", "world position, north"),
    ("z_m", "number", "m", "world position, up"),
    ("vx_mps", "number", "m/s", "world velocity, east"),
    ("vy_mps", "number", "m/s", "world velocity, north"),
    ("vz_mps", "number", "m/s", "world velocity, up"),
    ("mode", "string", "", "idle, forming, cruise, hold, arrived, down or passive"),
    ("leader", "integer", "1", "its leader's number, 0 = none"),
    ("goal_x_cell", "integer", "cells", "column of the cell it heads for; empty: there are no cells"),
    ("goal_y_cell", "integer", "cells", "row of the cell it heads for; empty: there are no cells"),
    ("formation_error_cells", "number", "cells", "distance from its place in the formation; empty: it has none"),
    (
        "wait",
        "string",
        "",
        "team, stopped, route, radio, turn, robots or goal_taken: reason for waiting; empty: it does not wait",
    ),
    (
        "goal_x_m",
        "number",
        "m",
        "where in the world it heads for, east; empty: nowhere, or that is for its law to choose",
    ),
    ("goal_y_m", "number", "m", "the same, north"),
    ("goal_z_m", "number", "m", "the same, up"),
    ("radius_m", "number", "m", "radius of its body; empty: bodies have no size"),
];

pub const SERIES: [Column; 9] = [
    ("tick", "integer", "1", "number of the tick"),
    ("time_s", "number", "s", "simulated time"),
    ("formation_error", "number", "cells", "mean distance of the robots from their places; empty: no formation"),
    ("graph_distance", "number", "1", "distance of the actual from the wanted graph; empty: no formation"),
    ("sent", "integer", "packets", "handed to the radio in this tick"),
    ("delivered", "integer", "packets", "handed to a receiver in this tick"),
    ("lost", "integer", "packets", "lost on the way in this tick"),
    ("damaged", "integer", "packets", "delivered with flipped bits in this tick"),
    ("rejected", "integer", "packets", "refused by a receiver in this tick"),
];

pub fn header(columns: &[Column]) -> String {
    let names: Vec<_> = columns.iter().map(|column| column.0).collect();
    names.join(",") + "\n"
}

pub fn write_schema(dir: &Path, name: &str, columns: &[Column]) -> Result<(), Error> {
    let columns: Vec<_> = columns
        .iter()
        .map(|(name, kind, unit, meaning)| {
            serde_json::json!({ "name": name, "type": kind, "unit": unit, "meaning": meaning })
        })
        .collect();
    let schema = serde_json::json!({
        "file": format!("{name}.csv"),
        "format": "CSV: one header line, comma, no quotes, lines end with \\n, an empty field is an unknown value",
        "columns": columns,
    });
    write_atomically(&dir.join(format!("{name}.schema.json")), format!("{schema:#}\n").as_bytes())
}

pub fn trace_line(out: &mut Vec<u8>, tick: &TickRow, robot: &RobotRow) {
    let ([x, y, z], [vx, vy, vz]) = (robot.motion.position_m, robot.motion.velocity_mps);
    let [goal_x, goal_y, goal_z] = robot.target_m.unwrap_or([f64::NAN; 3]);
    let cell = |x: i16| Number(if robot.has_cells { x.into() } else { f64::NAN });
    append(
        out,
        format_args!(
            "{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n",
            tick.tick,
            Number(tick.time_s),
            robot.id,
            cell(robot.motion.cell.x),
            cell(robot.motion.cell.y),
            Number(x),
            Number(y),
            Number(z),
            Number(vx),
            Number(vy),
            Number(vz),
            robot.mode.name(),
            robot.leader,
            cell(robot.target.x),
            cell(robot.target.y),
            Number(f64::from(robot.formation_error_cells)),
            robot.wait.map_or("", Wait::name),
            Number(goal_x),
            Number(goal_y),
            Number(goal_z),
            Number(robot.radius_m.unwrap_or(f64::NAN)),
        ),
    );
}

pub fn series_line(out: &mut Vec<u8>, tick: &TickRow) {
    let packets = &tick.packets;
    append(
        out,
        format_args!(
            "{},{},{},{},{},{},{},{},{}\n",
            tick.tick,
            Number(tick.time_s),
            Number(tick.formation_error_per_agent),
            Number(tick.graph_distance),
            packets.sent,
            packets.delivered,
            packets.lost,
            packets.damaged,
            packets.rejected,
        ),
    );
}

fn append(out: &mut Vec<u8>, line: std::fmt::Arguments) {
    out.write_fmt(line).expect("memory takes every line");
}

/// Six decimals without trailing zeros (micrometres and microseconds); empty for NaN and infinity.
struct Number(f64);

impl std::fmt::Display for Number {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        if !self.0.is_finite() {
            return Ok(());
        }
        let text = format!("{:.6}", self.0);
        f.write_str(text.trim_end_matches('0').trim_end_matches('.'))
    }
}
