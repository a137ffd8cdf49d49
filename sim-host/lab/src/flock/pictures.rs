//! Pictures of flocks: OLF figures 7 to 12.

use super::watch::Frame;
use super::{Case, CaseReport, Point, Reference, Report};
use crate::arena::distance_m;
use staya_plot::flock::{Obstacle, Sheet, Snapshot, View};
use staya_plot::{Chart, Panels, Series};
use staya_sim::metrics::flock::FlockMeasure;
use staya_sim::record::{Error, write_atomically};
use staya_sim::world::plane::Solid;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

const POINTS: usize = 400;

impl Report {
    /// Draws the first run of each case, and the measures over time of all runs, into `dir` (SVG
    /// and PNG), writes the measures as CSV, and returns the files.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn draw(&self, dir: &Path) -> Result<Vec<PathBuf>, Error> {
        let mut files = Vec::new();
        for case in &self.cases {
            let name = Point { case: case.case, reference: case.reference }.name();
            files.extend(self.sheet(case).draw().write(&dir.join(&name))?);
            let stem = dir.join(format!("{name}-measures"));
            files.extend(self.measures(case).write(&stem)?);
            let table = stem.with_extension("csv");
            write_atomically(&table, self.csv(case).as_bytes())?;
            files.push(table);
        }
        Ok(files)
    }

    fn sheet(&self, case: &CaseReport) -> Sheet {
        let title = format!("{}: {} robots, d = {} m, {}", title(case), case.robots, self.spacing_m, self.setting());
        let moments = case.case.setting().moments;
        let mut sheet = Sheet::new(title, 3);
        for (number, share) in (0..).zip(moments) {
            let tick = libm::round(share * case.ticks as f64) as u32;
            let view = if case.case == Case::Rendezvous3d && number >= 3 { View::Elevation } else { View::Plan };
            if let Some(frame) = case.frames.iter().find(|frame| frame.tick == tick) {
                sheet = sheet.with(self.snapshot(case, frame, view));
            }
        }
        sheet
    }

    fn snapshot(&self, case: &CaseReport, frame: &Frame, view: View) -> Snapshot {
        let seen = |vectors: &[[f64; 3]]| vectors.iter().map(|&v| view.of(v)).collect::<Vec<_>>();
        let positions_m = seen(&frame.places_m);
        let disc = |solid: &Solid| match *solid {
            Solid::Ball { center_m, radius_m } => Some(Obstacle::Disc { centre_m: view.of(center_m), radius_m }),
            Solid::Wall(_) | Solid::Plane { .. } => None,
        };
        let solids = case.case.solids((self.spacing_m, self.gap), self.seed, 0);
        let (is_flat, range_m) = (case.case != Case::Rendezvous3d, 1.2 * self.spacing_m);
        let axis = if view == View::Plan { "" } else { ", from the south" };
        Snapshot {
            title: format!("t = {:.1} s, iteration {}{axis}", f64::from(frame.tick) * self.step_s, frame.tick),
            view_m: around(&positions_m, self.spacing_m),
            positions_m,
            velocities_mps: seen(&frame.velocities_mps),
            radius_m: if is_flat { self.radius_m } else { 0.0 },
            edges_within_m: is_flat.then_some(range_m),
            trails_m: if is_flat { Vec::new() } else { edges(&frame.places_m, range_m, view) },
            obstacles: solids.iter().filter_map(disc).collect(),
            labels: view.labels(),
            size: [380.0, 360.0],
            ..Snapshot::default()
        }
    }

    /// C, R, E~ and K~ (figure 12).
    fn measures(&self, case: &CaseReport) -> Panels {
        let unit_m = self.spacing_m / 7.0;
        let still = libm::log10(0.001 * unit_m * unit_m);
        let ends = |level: f64| [[0.0, level], [case.ticks as f64, level]];
        let log = |value: f64| libm::log10(value);
        let chart = |title: &str, label: &str, value: &dyn Fn(&FlockMeasure) -> f64| {
            let mut chart = Chart::new(title, format!("iteration ({} s)", self.step_s), label).size(560.0, 300.0);
            for (name, points) in curves(case, value) {
                let series = Series::line(name, points);
                chart = chart.with(match name {
                    "first run" => series,
                    _ => series.like_previous().dashed(),
                });
            }
            chart
        };
        let radius_label = "R (m)";
        let energy = chart("Deviation energy", "log10 E~", &|m| log(m.deviation_energy))
            .with(Series::reference("e1 = 0.005", ends(log(0.005))));
        let mismatch = chart("Velocity mismatch", "log10 K~", &|m| log(m.velocity_mismatch))
            .with(Series::reference("e2", ends(still)));
        let title = format!("{}: {} runs of {} robots, {}", title(case), case.runs, case.robots, self.setting());
        let hamiltonian = self.hamiltonian(case);
        Panels::new(title)
            .columns(2)
            .with(chart("Relative connectivity", "C", &|m| m.connectivity).y_range(0.0, 1.05))
            .with(chart("Cohesion radius", radius_label, &|m| m.radius_m))
            .with(energy)
            .with(mismatch)
            .with(hamiltonian)
    }

    fn hamiltonian(&self, case: &CaseReport) -> Chart {
        let label = format!("iteration ({} s)", self.step_s);
        let mut chart = Chart::new("Structural Hamiltonian", label, "log10 H / n").size(560.0, 300.0);
        for (number, energies) in case.energies.iter().enumerate() {
            let points: Vec<[f64; 2]> =
                thinned(energies).map(|(at, energy)| [at as f64, libm::log10(*energy)]).collect();
            let name = if number == 0 { "each run" } else { "" };
            let series = Series::line(name, points);
            chart = chart.with(if number == 0 { series } else { series.like_previous() });
        }
        chart
    }

    fn csv(&self, case: &CaseReport) -> String {
        let mut text = String::from(
            "run,iteration,time_s,connectivity,components,radius_m,deviation_energy,velocity_mismatch_m2ps2,polarisation,hamiltonian_per_robot\n",
        );
        for (run, trace) in case.traces.iter().enumerate() {
            for (iteration, moment) in thinned(trace) {
                let Some(m) = moment else { continue };
                let _ = writeln!(
                    text,
                    "{run},{iteration},{:.3},{:.6},{},{:.4},{:.8},{:.8},{:.6},{:.6}",
                    iteration as f64 * self.step_s,
                    m.connectivity,
                    m.components,
                    m.radius_m,
                    m.deviation_energy,
                    m.velocity_mismatch,
                    m.polarisation,
                    case.energies[run][iteration]
                );
            }
        }
        text
    }
}

fn title(case: &CaseReport) -> String {
    match case.reference {
        Some(reference) if reference != Reference::Moving => {
            format!("{}, {} reference", case.case.title(), reference.name())
        }
        _ => case.case.title().to_owned(),
    }
}

fn thinned<T>(trace: &[T]) -> impl Iterator<Item = (usize, &T)> {
    let every = trace.len().div_ceil(POINTS).max(1);
    let last = trace.len().saturating_sub(1);
    let all = trace.iter().enumerate();
    all.filter(move |(at, _)| at % every == 0 || *at == last)
}

fn curves(case: &CaseReport, value: &dyn Fn(&FlockMeasure) -> f64) -> Vec<(&'static str, Vec<[f64; 2]>)> {
    let first: Vec<[f64; 2]> =
        thinned(&case.traces[0]).filter_map(|(at, moment)| Some([at as f64, value(moment.as_ref()?)])).collect();
    if case.traces.len() < 2 {
        return vec![("first run", first)];
    }
    let over = |pick: fn(f64, f64) -> f64| -> Vec<[f64; 2]> {
        thinned(&case.traces[0])
            .filter_map(|(at, _)| {
                let values = case.traces.iter().filter_map(|trace| trace[at].as_ref());
                Some([at as f64, values.map(value).reduce(pick)?])
            })
            .collect()
    };
    vec![("first run", first), ("least and greatest of all runs", over(f64::min)), ("", over(f64::max))]
}

/// In space, a picture does not show the distances of robots.
fn edges(places_m: &[[f64; 3]], range_m: f64, view: View) -> Vec<Vec<[f64; 2]>> {
    let mut lines = Vec::new();
    for (number, &a) in places_m.iter().enumerate() {
        let others = places_m[..number].iter();
        let near = others.filter(|&&b| distance_m(a, b) <= range_m);
        lines.extend(near.map(|&b| vec![view.of(a), view.of(b)]));
    }
    lines
}

fn around(places_m: &[[f64; 2]], spacing_m: f64) -> Option<[[f64; 2]; 2]> {
    let along = |axis: usize| {
        let values = || places_m.iter().map(|place| place[axis]);
        let (low, high) = (values().reduce(f64::min)?, values().reduce(f64::max)?);
        Some([low - 2.0 * spacing_m, high + 2.0 * spacing_m])
    };
    Some([along(0)?, along(1)?])
}
