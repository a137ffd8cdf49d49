use super::branch::Branch;
use anyhow::{Result, ensure};
use serde::Deserialize;
use staya_controller::rand::Rng;
use staya_sim::scenario::{Scenario, with_interventions};
use std::fmt::Write as _;

const RANDOM: u32 = u32::from_be_bytes(*b"view");

pub(super) fn with_top_field(text: &str, name: &str, value: &str) -> String {
    let mut lines: Vec<&str> = text.lines().collect();
    let top = lines.iter().position(|line| line.trim_start().starts_with('[')).unwrap_or(lines.len());
    let is_it = |line: &&str| line.split_once('=').is_some_and(|(field, _)| field.trim() == name);
    let field = format!("{name} = {value}");
    match lines[..top].iter().position(is_it) {
        Some(at) => lines[at] = &field,
        None => lines.insert(0, &field),
    }
    lines.join("\n") + "\n"
}

pub(super) fn saved(text: &str, scenario: &Scenario, branch: &Branch, tick: u32, hash: &str) -> String {
    let Branch { number, from, done, .. } = branch;
    let text = with_top_field(text, "seed", &scenario.seed.to_string());
    // No event of the file may be after the end.
    let last_change = done.last().map_or(0, |(tick, _)| *tick);
    let ticks = scenario.ticks.max(tick).max(scenario.last_event()).max(last_change);
    let text = with_top_field(&text, "ticks", &ticks.to_string());
    let (changes, from_s) = (done.len(), f64::from(*from) * scenario.tick_s());
    let unit = if changes == 1 { "change" } else { "changes" };
    let origin = if *number > 1 { format!(", which begins at {from_s} s") } else { String::new() };
    let head = format!(
        "# Saved from a view: branch {number}{origin}, with {changes} {unit} by pages.\n\
         # Trace hash after tick {tick}: {hash}\n\
         # Relative paths refer to the folder of the original scenario.\n"
    );
    head + &with_interventions(&text, scenario.tick_us, done)
}

/// Parameters of a run in which robots flock to goals among obstacles (V. E. and V. V. Pavlovsky).
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Configuration {
    /// Number of robots, 1 to 2000.
    pub robots: u32,
    /// Number of goals, 1 to 4.
    pub goals: u32,
    /// Number of round obstacles, 0 to 200.
    pub obstacles: u32,
    /// Seed of positions and of the run.
    pub seed: u64,
}

impl Configuration {
    /// Generates the scenario: starts in the west, goals in the east, obstacles between.
    ///
    /// # Errors
    /// Names the number that is out of its range, and the range.
    pub fn scenario(self) -> Result<String> {
        let Self { robots, goals, obstacles, seed } = self;
        for (what, count, least, most) in
            [("robots", robots, 1, 2000), ("goals", goals, 1, 4), ("obstacles", obstacles, 0, 200)]
        {
            ensure!((least..=most).contains(&count), "{count} {what} are out of range; give {least} to {most}");
        }
        let side_m = libm::ceil(libm::sqrt(f64::from(robots))) * 1.2 + 3.0;
        let width_m = side_m * 2.0 + 16.0;
        let mut draws = Rng::keyed(seed, RANDOM, robots, obstacles);
        let mut draw = |low: f64, high: f64| low + (high - low) * f64::from(draws.below(1 << 20)) / f64::from(1 << 20);
        let place = |goal: u32| {
            let y = side_m * (f64::from(goal) + 0.5) / f64::from(goals);
            format!("[{:.2}, {y:.2}]", width_m - side_m / 2.0)
        };
        let places: Vec<String> = (0..goals).map(place).collect();
        let mut text = format!(
            "name = \"new-run\"\nseed = {seed}\nticks = 4000\ntick_s = 0.1\n[radio]\nrange_m = 20\n\
             [plane]\nradius_m = 0.2\nmax_speed_mps = 1\nlaw = \"goal_flock\"\nsafety = \"orca\"\n\
             [plane.robots.cloud]\ncount = {robots}\nfrom_m = [0, 0]\nto_m = [{side_m:.2}, {side_m:.2}]\n\
             goals_m = [{}]\n[plane.goal_flock]\nmin_distance_m = 0.6\ntolerance_m = {:.2}\n",
            places.join(", "),
            0.6 * libm::sqrt(f64::from(robots)).max(2.0),
        );
        for _ in 0..obstacles {
            let radius_m = draw(0.2, 0.8);
            let (x, y) = (draw(side_m + 2.0, width_m - side_m - 2.0), draw(-1.0, side_m + 1.0));
            let _ = writeln!(text, "[[plane.ball]]\ncenter_m = [{x:.2}, {y:.2}]\nradius_m = {radius_m:.2}");
        }
        let _ = writeln!(text, "# {robots} robots, {goals} goals, {obstacles} obstacles.");
        Ok(text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use staya_sim::scenario::Overrides;
    use std::path::Path;

    #[test]
    fn top_level_fields_are_replaced_or_added_and_others_unchanged() {
        let text = "# a\nname = \"t\"\nseed=3\n[radio]\nseed = 5\n";
        assert_eq!(with_top_field(text, "seed", "7"), "# a\nname = \"t\"\nseed = 7\n[radio]\nseed = 5\n");
        assert_eq!(with_top_field(text, "ticks", "9"), format!("ticks = 9\n{text}"));
    }

    #[test]
    fn a_saved_run_that_was_shortened_ends_after_its_events() {
        let text = "name = \"t\"\nticks = 90\n[plane]\nradius_m = 0.2\nmax_speed_mps = 1\n[[plane.robots.list]]\n\
                    start_m = [0, 0]\ngoal_m = [6, 0]\n[[fault]]\nrobot = 1\nat_s = 70\n";
        let (path, shorter) = (Path::new("t.toml"), Overrides { seed: None, ticks: Some(20) });
        let scenario = Scenario::parse_with(text, path, &shorter, &[]).expect("good");
        let saved = saved(text, &scenario, &Branch::default(), 30, "");
        let read = Scenario::parse_with(&saved, path, &Overrides::default(), &[]).expect("good");
        assert_eq!(read.ticks, 70);
    }

    #[test]
    fn every_configuration_is_a_valid_scenario() {
        for (robots, goals, obstacles) in [(1, 1, 0), (20, 3, 12), (600, 4, 60), (2000, 1, 200)] {
            for seed in 0..4 {
                let configuration = Configuration { robots, goals, obstacles, seed };
                let text = configuration.scenario().expect("numbers in range");
                let scenario = Scenario::parse(&text, Path::new("new.toml"), &Overrides::default());
                let scenario = scenario.unwrap_or_else(|error| panic!("{configuration:?}: {error}"));
                assert_eq!(scenario.robots.len(), robots as usize);
            }
        }
    }

    #[test]
    fn numbers_out_of_range_are_refused() {
        for (robots, goals, obstacles, expected) in [
            (0, 1, 0, "0 robots are out of range; give 1 to 2000"),
            (2001, 1, 0, "2001 robots are out of range; give 1 to 2000"),
            (u32::MAX, 1, 0, "4294967295 robots are out of range; give 1 to 2000"),
            (9, 0, 0, "0 goals are out of range; give 1 to 4"),
            (9, 5, 0, "5 goals are out of range; give 1 to 4"),
            (9, 1, 201, "201 obstacles are out of range; give 0 to 200"),
        ] {
            let configuration = Configuration { robots, goals, obstacles, seed: 1 };
            assert_eq!(configuration.scenario().expect_err(expected).to_string(), expected);
        }
    }
}
