//! Tables of the rows of many runs.

use super::{Kind, Row};
use std::fmt::Write as _;

/// Geometric mean; `None` without values.
pub(super) fn geometric_mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (mut sum, mut count) = (0.0, 0_u32);
    for value in values.filter(|value| *value > 0.0) {
        sum += libm::log(value);
        count += 1;
    }
    (count > 0).then(|| libm::exp(sum / f64::from(count)))
}

/// The kinds of these rows, each with its rows, in the order of [`Kind::ALL`].
pub(super) fn by_kind<'a>(rows: &[&'a Row]) -> Vec<(Kind, Vec<&'a Row>)> {
    let of = |kind| rows.iter().copied().filter(|row: &&Row| row.kind == kind).collect::<Vec<_>>();
    let all = Kind::ALL.iter().map(|(kind, ..)| (*kind, of(*kind)));
    all.filter(|(_, rows)| !rows.is_empty()).collect()
}

/// One line per kind, and one for all. "missing" and "covered" count scenes.
#[must_use]
pub fn table(rows: &[Row]) -> String {
    let mut text = format!(
        "{:<16}{:>6}{:>9}{:>10}{:>9}{:>9}{:>9}{:>8}{:>12}\n",
        "kind", "runs", "overlap", "worst mm", "walls", "missing", "covered", "last s", "packets"
    );
    let rows: Vec<_> = rows.iter().collect();
    for (kind, rows) in by_kind(&rows) {
        line(&mut text, kind.name(), &rows);
    }
    line(&mut text, "all", &rows);
    text
}

fn line(text: &mut String, name: &str, rows: &[&Row]) {
    let count = |is_so: fn(&Row) -> bool| rows.iter().filter(|row| is_so(row)).count();
    let worst_mm = rows.iter().map(|row| row.overlap_mm).fold(0.0, f64::max);
    let last_s = geometric_mean(rows.iter().filter_map(|row| row.last_s));
    let packets: u64 = rows.iter().map(|row| row.packets).sum();
    let _ = writeln!(
        text,
        "{name:<16}{:>6}{:>9}{worst_mm:>10.0}{:>9}{:>9}{:>9}{:>8}{packets:>12}",
        rows.len(),
        count(Row::overlaps),
        count(|row| row.wall_overlap_mm > 1.0),
        count(|row| row.missing > 0),
        count(|row| row.covered > 0),
        last_s.map_or_else(|| "-".to_owned(), |last_s| format!("{last_s:.1}")),
    );
}

/// The scenes in which robots overlap or are missing, one line each.
#[must_use]
pub fn failures(rows: &[Row]) -> String {
    let mut text = String::new();
    for row in rows.iter().filter(|row| row.overlaps() || row.wall_overlap_mm > 1.0 || row.missing > 0) {
        let Row { seed, kind, robots, overlap_mm, missing, run_s, .. } = row;
        let _ = writeln!(
            text,
            "seed {seed:>5} {kind:<16}{robots:>4} robots, overlap {overlap_mm:>5.0} mm, {missing:>3} missing after {run_s:.0} s"
        );
    }
    text
}
