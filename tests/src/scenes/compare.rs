//! Comparison with an earlier run of the same scenes.

use super::Row;
use super::table::{by_kind, geometric_mean};
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// Compares rows with earlier ones of the same seeds. "last" is the geometric mean of the ratios of
/// last arrivals, "over" the number of scenes in which all robots arrive in both. "packets" is the
/// ratio of all packets, "a second" the geometric mean of the ratios of packets per simulated
/// second.
#[must_use]
pub fn comparison(rows: &[Row], earlier: &[Row]) -> String {
    let earlier: BTreeMap<u32, &Row> = earlier.iter().map(|row| (row.seed, row)).collect();
    let both: Vec<&Row> =
        rows.iter().filter(|row| earlier.get(&row.seed).is_some_and(|old| old.kind == row.kind)).collect();
    let mut text = format!(
        "{:<16}{:>6}{:>16}{:>16}{:>8}{:>9}{:>10}{:>12}\n",
        "kind", "runs", "overlap", "missing", "last", "over", "packets", "a second"
    );
    for (kind, rows) in by_kind(&both) {
        line(&mut text, kind.name(), &rows, &earlier);
    }
    line(&mut text, "all", &both, &earlier);
    let is_new = |row: &&&Row| row.overlaps() && !earlier[&row.seed].overlaps();
    let new: Vec<_> = both.iter().filter(is_new).map(|row| row.seed.to_string()).collect();
    if !new.is_empty() {
        let _ = writeln!(text, "new overlaps: seeds {}", new.join(", "));
    }
    let equal = both.iter().filter(|row| earlier[&row.seed].trace == row.trace).count();
    let _ = writeln!(text, "{equal} of {} traces are identical", both.len());
    text
}

fn line(text: &mut String, name: &str, rows: &[&Row], earlier: &BTreeMap<u32, &Row>) {
    let pairs: Vec<(&Row, &Row)> = rows.iter().map(|row| (earlier[&row.seed], *row)).collect();
    let counts = |is_so: fn(&Row) -> bool| {
        let count = |of: &dyn Fn(&(&Row, &Row)) -> bool| pairs.iter().filter(|pair| of(pair)).count();
        format!("{} -> {}", count(&|pair| is_so(pair.0)), count(&|pair| is_so(pair.1)))
    };
    let arrived = || pairs.iter().filter_map(|(old, new)| Some(new.last_s? / old.last_s?));
    let ratio = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |value| format!("{value:.3}"));
    let sent = |of: fn(&Row) -> u64| pairs.iter().map(move |(old, new)| [of(old) as f64, of(new) as f64]);
    let [before, after] = sent(|row| row.packets).fold([0.0; 2], |[a, b], [old, new]| [a + old, b + new]);
    let rates = pairs.iter().map(|(old, new)| (new.packets as f64 / new.run_s) / (old.packets as f64 / old.run_s));
    let _ = writeln!(
        text,
        "{name:<16}{:>6}{:>16}{:>16}{:>8}{:>9}{:>10.3}{:>12}",
        rows.len(),
        counts(Row::overlaps),
        counts(|row| row.missing > 0),
        ratio(geometric_mean(arrived())),
        arrived().count(),
        after / before,
        ratio(geometric_mean(rates)),
    );
}
