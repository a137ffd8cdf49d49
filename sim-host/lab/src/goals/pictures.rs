//! Pictures of the goal flock.

use super::Report;
use super::report::Point;
use super::setting::{Setting, short, varying};
use staya_plot::flock::{Obstacle, Sheet, Snapshot};
use staya_plot::{Chart, HeatMap, Panels, Series};
use staya_sim::record::Error;
use staya_sim::world::plane::Solid;
use std::path::{Path, PathBuf};

const CURVES: usize = 10;

/// First runs to draw: smallest, middle and largest K1 above 0 of the last curve.
pub(super) fn drawn(settings: &[Setting]) -> Vec<usize> {
    let Some(last) = settings.last() else {
        return Vec::new();
    };
    let is_of_last = |s: &Setting| s.k1 > 0.0 && Setting { k1: 0.0, ..*s } == Setting { k1: 0.0, ..*last };
    let row: Vec<usize> = (0..settings.len()).filter(|&point| is_of_last(&settings[point])).collect();
    let mut drawn: Vec<usize> =
        [0, row.len() / 2, row.len().saturating_sub(1)].iter().filter_map(|&at| row.get(at).copied()).collect();
    drawn.dedup();
    drawn
}

impl Report {
    /// Draws the charts, and the paths of three runs of the last curve (smallest, middle and
    /// largest K1), into `dir` (SVG and PNG), and returns the files.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn draw(&self, dir: &Path) -> Result<Vec<PathBuf>, Error> {
        let mut files = self.order().write(&dir.join("order"))?;
        let curves = self.curves();
        if let Some(map) = self.heat(&curves) {
            files.extend(map.draw().write(&dir.join("company"))?);
        }
        for point in self.points.iter().filter(|point| !point.frames.is_empty()) {
            let name = format!("way-k1-{}", point.setting.k1);
            files.extend(self.sheet(point).draw().write(&dir.join(name))?);
        }
        Ok(files)
    }

    fn curves(&self) -> Vec<Setting> {
        let mut curves: Vec<Setting> = Vec::new();
        for point in &self.points {
            let common = point.setting.without_gains();
            if !curves.contains(&common) {
                curves.push(common);
            }
        }
        curves
    }

    fn order(&self) -> Panels {
        let curves = self.curves();
        let differ = varying(&curves);
        let chart = |title: &str, y: &str, value: fn(&Point) -> Option<f64>| {
            let mut chart = Chart::new(title, "K1 / K2", y).size(560.0, 300.0).log_x();
            for curve in curves.iter().take(CURVES) {
                let own = || self.points.iter().filter(|point| point.setting.without_gains() == *curve);
                let mut values: Vec<[f64; 2]> =
                    own().filter_map(|point| Some([point.k1_over_k2?, value(point)?])).collect();
                values.retain(|[ratio, _]| *ratio > 0.0);
                values.sort_by(|a, b| a[0].total_cmp(&b[0]));
                let given = curve.given();
                let words = differ.iter().filter(|place| **place > 1);
                let words: Vec<_> = words.map(|&p| format!("{} {}", short(given[p].0), given[p].1)).collect();
                let name = if words.is_empty() { "measured".to_owned() } else { words.join(", ") };
                let ends = values.first().zip(values.last()).map(|(first, last)| [first[0], last[0]]);
                chart = chart.with(Series::points(name.clone(), values).joined());
                let alone = own().filter_map(|point| {
                    let with = own().find(|other| other.setting.k1 == point.setting.k1 && other.k1_over_k2.is_some());
                    if point.setting.k2 == 0.0 { Some([with?.k1_over_k2?, value(point)?]) } else { None }
                });
                let mut alone: Vec<[f64; 2]> = alone.filter(|[ratio, _]| *ratio > 0.0).collect();
                alone.sort_by(|a, b| a[0].total_cmp(&b[0]));
                if let ([[_, y]], Some([low, high])) = (&alone[..], ends) {
                    alone = vec![[low, *y], [high, *y]];
                }
                if !alone.is_empty() {
                    chart = chart.with(Series::line(format!("{name}, K2 = 0"), alone).like_previous().dashed());
                }
            }
            chart
        };
        let hidden = curves.len().saturating_sub(CURVES);
        let more = if hidden == 0 { String::new() } else { format!("; {hidden} further curves are in rows.csv") };
        let title = format!(
            "Group order over K1 / K2, R_MinDist = {} m; dashed: independent robots (K2 = 0){more}",
            self.min_distance_m
        );
        Panels::new(title)
            .columns(2)
            .with(chart("Share of the largest group on the way", "0 to 1", |p| p.together).y_range(0.0, 1.05))
            .with(chart("Company: robots within 4 R_MinDist on the way", "robots", |p| p.company))
            .with(chart("Polarisation on the way", "0 to 1", |p| p.polarisation).y_range(0.0, 1.05))
            .with(chart("Radius of the crowd on the way, over that at the start", "ratio", |p| p.spread))
            .with(chart("Share of robots at a goal at the end", "0 to 1", |p| Some(p.arrived)).y_range(0.0, 1.05))
            .with(chart("Time until half were at the middle", "s", |p| p.half_gathered_s))
    }

    fn heat(&self, curves: &[Setting]) -> Option<HeatMap> {
        let first = curves.first()?;
        let is_alike = |s: &Setting| Setting { neighborhood_m: first.neighborhood_m, ..*s } == *first;
        if curves.len() < 2 || !curves.iter().all(is_alike) {
            return None;
        }
        let mut ratios: Vec<f64> = self.points.iter().filter_map(|point| point.k1_over_k2).collect();
        ratios.sort_by(f64::total_cmp);
        ratios.dedup();
        if ratios.len() < 2 {
            return None;
        }
        let value = |curve: &Setting, ratio: f64| {
            let mut own = self.points.iter().filter(|point| point.setting.without_gains() == *curve);
            own.find(|point| point.k1_over_k2 == Some(ratio))?.company
        };
        Some(HeatMap {
            title: "Company on the way: robots within 4 R_MinDist of one".to_owned(),
            note: format!("{} robots, start side {}, {} runs a square", first.robots, first.start_side, self.plan.runs),
            x_label: "K1 / K2".to_owned(),
            y_label: "R_nbh (m)".to_owned(),
            columns: ratios
                .iter()
                .map(|ratio| format!("{ratio:.3}").trim_end_matches('0').trim_end_matches('.').to_owned())
                .collect(),
            rows: curves.iter().map(|curve| curve.neighborhood_m.to_string()).collect(),
            values: curves.iter().flat_map(|curve| ratios.iter().map(move |&ratio| value(curve, ratio))).collect(),
        })
    }

    fn sheet(&self, point: &Point) -> Sheet {
        let setting = &point.setting;
        let title = format!(
            "K1 = {}, K2 = {}, K3 = {}, R_nbh = {} m, robots know {}, safety {}",
            setting.k1,
            setting.k2,
            setting.k3,
            setting.neighborhood_m,
            staya_controller::names::Named::name(setting.knows),
            setting.safety
        );
        let mut sheet = Sheet::new(title, 2);
        let Some(scene) = self.scene(setting) else {
            return sheet;
        };
        let obstacles = scene.solids.iter().filter_map(|solid| match solid {
            Solid::Ball { center_m: [x, y, _], radius_m } => {
                Some(Obstacle::Disc { centre_m: [*x, *y], radius_m: *radius_m })
            }
            _ => None,
        });
        let obstacles: Vec<Obstacle> = obstacles.collect();
        for frame in &point.frames {
            let time_s = f64::from(frame.tick) * self.step_s;
            let goals_m = scene.goals_at(frame.tick).iter().map(|[x, y, _]| [*x, *y]).collect();
            let d = self.min_distance_m;
            let half = setting.start_half().max(36.0);
            let north = setting.goal_speed_mps / d * time_s;
            sheet = sheet.with(Snapshot {
                title: format!("t = {time_s:.0} s"),
                positions_m: frame.places_m.clone(),
                velocities_mps: frame.velocities_mps.clone(),
                radius_m: self.radius_m,
                goals_m,
                obstacles: obstacles.clone(),
                view_m: Some([[-half * d, 110.0 * d], [-half * d, (half + north) * d]]),
                size: [560.0, 390.0],
                ..Snapshot::default()
            });
        }
        sheet
    }
}
