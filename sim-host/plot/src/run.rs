//! Pictures of runs on a map.

use super::chart::{Chart, Series};
use super::colour::{self, Colour, WHITE};
use super::panels::Panels;
use super::{ticks, trajectories};
use staya_controller::grid::Cell;
use staya_sim::record::{Error, History, PacketCounts, SeriesPoint};
use staya_sim::terrain::Terrain;
use std::path::{Path, PathBuf};

/// Curves with more points get a running mean.
const NOISY: usize = 150;
const MEANS: usize = 100;

/// `changing`: cells; `edges`: of the formation, between robot ids.
pub(super) fn on_map(
    of: &str,
    terrain: &Terrain,
    changing: &[Cell],
    history: &History,
    edges: &[(u32, u32)],
    out_dir: &Path,
) -> Result<Vec<PathBuf>, Error> {
    let mut files = Vec::new();
    if !history.frames().is_empty() {
        let stem = out_dir.join("trajectories");
        let canvas = trajectories::draw(of, terrain, changing, history, edges).map_err(Error::new("draw", &stem))?;
        files.extend(canvas.write(&stem)?);
    }
    if let Some(panels) = formation(of, history.series()) {
        files.extend(panels.draw().write(&out_dir.join("formation"))?);
    }
    files.extend(packets(of, history).draw().write(&out_dir.join("packets"))?);
    Ok(files)
}

pub(super) fn formation(of: &str, series: &[SeriesPoint]) -> Option<Panels> {
    let clock = Clock::new(series);
    let curve = |title: &str, label: &str, colour, value: fn(&SeriesPoint) -> f64| {
        let points: Vec<[f64; 2]> = series.iter().map(|point| [clock.at(point), value(point)]).collect();
        points
            .iter()
            .any(|[_, value]| value.is_finite())
            .then(|| with_mean(Chart::new(title, clock.label, label), points, colour, &clock))
    };
    let charts = [
        curve("Formation error per agent", "error (cells)", 0, |point| point.formation_error_per_agent),
        curve("Graph distance", "graph distance", 1, |point| point.graph_distance),
    ];
    let mut charts = charts.into_iter().flatten().peekable();
    charts.peek()?;
    Some(charts.fold(Panels::new(format!("{of}: formation over time")), Panels::with))
}

fn with_mean(chart: Chart, points: Vec<[f64; 2]>, index: usize, clock: &Clock) -> Chart {
    let chart = chart.size(760.0, 300.0);
    let colour = colour::nth(index);
    if points.len() <= NOISY {
        return chart.with(Series::line("", points).colour(colour));
    }
    let run = points.len().div_ceil(MEANS);
    let means: Vec<[f64; 2]> = points.chunks(run).filter_map(mean).collect();
    let width = ((points[run][0] - points[0][0]).abs() * 100.0).round() / 100.0;
    let pale: Colour = colour.towards(WHITE, 0.62);
    chart
        .with(Series::line("recorded", points).colour(pale))
        .with(Series::line(format!("mean over {width} {}", clock.unit), means).colour(colour))
}

/// Mean of the existing values, so that missing ones leave gaps only in the pale curve.
fn mean(points: &[[f64; 2]]) -> Option<[f64; 2]> {
    let known: Vec<&[f64; 2]> = points.iter().filter(|[_, y]| y.is_finite()).collect();
    let count = known.len() as f64;
    let sum = known.iter().fold([0.0; 2], |sum, point| [sum[0] + point[0], sum[1] + point[1]]);
    (!known.is_empty()).then(|| sum.map(|value| value / count))
}

pub(super) fn packets(of: &str, history: &History) -> Panels {
    let series = history.series();
    let clock = Clock::new(series);
    let bins: Vec<(f64, f64, PacketCounts)> =
        series.chunks(series.len().div_ceil(MEANS).max(1)).map(|points| bin(points, &clock)).collect();
    let line = |name: &str, index: usize, count: fn(&PacketCounts) -> u64| {
        let points = bins.iter().map(|(at, length, packets)| [*at, count(packets) as f64 / length]);
        Series::line(name, points).colour(colour::nth(index))
    };
    let per = format!("packets per {}", clock.one);
    let ends = [series.first(), series.last()].map(|point| point.map_or(0.0, |point| clock.at(point)));
    let chart = |title, note| {
        let chart = Chart::new(title, clock.label, &per).size(760.0, 300.0);
        // Starts at the first tick, although the first mean is slightly later.
        Chart { x_range: Some(ends), note, ..chart }
    };
    let all = history.totals();
    let [sent, delivered, lost, damaged, rejected] =
        [all.sent, all.delivered, all.lost, all.damaged, all.rejected].map(ticks::grouped);
    let carried = format!("in all {sent} sent, {delivered} delivered (one sent packet may reach many), {lost} lost");
    let refused =
        format!("in all {damaged} damaged on the way, {rejected} rejected by receivers (damaged, foreign or replayed)");
    Panels::new(format!("{of}: packets over time"))
        .with(
            chart("Sent, delivered and lost", carried)
                .with(line("delivered", 0, |packets| packets.delivered))
                .with(line("lost", 1, |packets| packets.lost))
                .with(line("sent", 6, |packets| packets.sent)),
        )
        .with(chart("Corrupted and rejected", refused).with(line("damaged", 3, |packets| packets.damaged)).with(line(
            "rejected",
            2,
            |packets| packets.rejected,
        )))
}

fn bin(points: &[SeriesPoint], clock: &Clock) -> (f64, f64, PacketCounts) {
    let mut sum = PacketCounts::default();
    let mut ticks = 0;
    for point in points {
        sum += point.packets;
        ticks += point.ticks;
    }
    let length = f64::from(ticks.max(1)) * clock.per_tick;
    let start = points.first().map_or(0.0, |point| clock.at(point));
    let middle = start + (length - clock.per_tick) / 2.0;
    (middle, length, sum)
}

/// Seconds, or ticks if the run is too short to know their length.
struct Clock {
    per_tick: f64,
    in_ticks: bool,
    label: &'static str,
    unit: &'static str,
    one: &'static str,
}

impl Clock {
    fn new(series: &[SeriesPoint]) -> Self {
        let per_tick = match series {
            [first, .., last] => {
                let ticks = last.tick.wrapping_sub(first.tick);
                (last.time_s - first.time_s) / f64::from(ticks)
            }
            _ => f64::NAN,
        };
        if per_tick.is_finite() && per_tick > 0.0 {
            Self { per_tick, in_ticks: false, label: "simulated time (s)", unit: "s", one: "second" }
        } else {
            Self { per_tick: 1.0, in_ticks: true, label: "tick", unit: "ticks", one: "tick" }
        }
    }

    fn at(&self, point: &SeriesPoint) -> f64 {
        if self.in_ticks { f64::from(point.tick) } else { point.time_s }
    }
}
