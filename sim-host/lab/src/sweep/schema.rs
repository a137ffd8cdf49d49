//! Description of the columns of rows.

use crate::sweep::plan::Plan;

/// Contents of `rows.schema.json`: name, unit and meaning of each column, like `trace.schema.json`.
#[must_use]
pub fn schema(plan: &Plan) -> String {
    let column = |name: &str, kind: &str, unit: &str, meaning: &str| serde_json::json!({ "name": name, "type": kind, "unit": unit, "meaning": meaning });
    let mut columns = vec![column("run", "integer", "1", "number of the run")];
    columns.extend(plan.axes().map(|name| column(name, "value", unit(name), "a parameter")));
    columns.push(column("seed", "integer", "1", "seed of the run"));
    columns.push(column("outcome", "string", "", "done, or impossible: then there are no figures"));
    let figures = plan.measures();
    columns.extend(figures.iter().map(|name| column(name, "number", unit(name), plan.meaning(name))));
    for (name, meaning) in [
        ("trace_hash", "h and the trace hash of the run, of all bytes and movements; empty: there are none"),
        ("plan", "h and the fingerprint of the plan: rows of one plan go together"),
        ("version", "version of the program, and its git commit where that is known"),
        ("crc32", "h and the CRC-32 (ISO-HDLC) of the line before the last comma, 8 hex digits"),
    ] {
        columns.push(column(name, "string", "", meaning));
    }
    let schema = serde_json::json!({
        "file": "rows.csv",
        "format": "CSV: one header line, comma, no quotes, lines end with \\n, an empty field is an unknown value",
        "columns": columns,
    });
    format!("{schema:#}\n")
}

fn unit(name: &str) -> &'static str {
    match name.rsplit('_').next().unwrap_or_default() {
        "m" => "m",
        "s" | "seconds" => "s",
        "ms" => "ms",
        "us" => "us",
        "mps" => "m/s",
        "cells" => "cells",
        "ticks" => "ticks",
        "percent" => "%",
        _ => "",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_follow_from_name_suffixes() {
        let units = ["circle_m", "last_s", "arrival_last_seconds", "speed_mps", "time_ticks", "arrived", "m"].map(unit);
        assert_eq!(units, ["m", "s", "s", "m/s", "ticks", "", "m"]);
    }
}
