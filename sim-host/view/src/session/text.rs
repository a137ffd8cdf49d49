use super::branch::Branch;
use anyhow::{Result, bail, ensure};
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

/// How robots of a new run pass obstacles and each other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Avoidance {
    /// By ORCA.
    #[default]
    Orca,
    /// By the paper's first model of push-out.
    Radial,
    /// By that model, from the nearest one only.
    RadialSingle,
    /// By the second model.
    Tangential,
    /// By that model, from the nearest one only.
    TangentialSingle,
    /// Not at all: the paper's first stage.
    None,
}

impl Avoidance {
    /// Fields of `[plane]`, whose table comes last.
    fn fields(self) -> [String; 2] {
        let push_out = |model: &str, single: bool| {
            let table = format!("[plane.push_out]\nmin_distance_m = 0.6\nmodel = \"{model}\"\nsingle = {single}\n");
            ["push_out".to_owned(), table]
        };
        match self {
            Self::Orca => ["orca".to_owned(), String::new()],
            Self::None => ["none".to_owned(), String::new()],
            Self::Radial => push_out("radial", false),
            Self::RadialSingle => push_out("radial", true),
            Self::Tangential => push_out("tangential", false),
            Self::TangentialSingle => push_out("tangential", true),
        }
    }
}

const fn usual_tick_s() -> f64 {
    0.1
}

/// Duration of a new run, seconds.
const LASTS_S: f64 = 400.0;
const MOST_OBSTACLES: u32 = 200;
/// Largest coordinate of a listed obstacle, metres.
const FARTHEST_M: f64 = 10_000.0;

/// Parameters of a run in which robots flock to goals among obstacles (V. E. and V. V. Pavlovsky).
#[derive(Clone, Debug, Deserialize)]
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
    /// Obstacles instead of random ones: x, y and radius, metres. A page that could not read a
    /// number has `None` there.
    #[serde(default)]
    pub discs: Option<Vec<Vec<Option<f64>>>>,
    /// How robots pass obstacles.
    #[serde(default)]
    pub avoidance: Avoidance,
    /// Length of a tick, seconds, 0.01 to 0.1.
    #[serde(default = "usual_tick_s")]
    pub tick_s: f64,
}

impl Configuration {
    /// Generates the scenario: starts in the west, goals in the east, obstacles between.
    ///
    /// # Errors
    /// Names the number that is out of its range, and the range.
    pub fn scenario(&self) -> Result<String> {
        let &Self { robots, goals, obstacles, seed, avoidance, tick_s, .. } = self;
        let listed = self.discs.as_ref().map(|discs| listed(discs)).transpose()?;
        let obstacles = listed.as_ref().map_or(obstacles, |discs| u32::try_from(discs.len()).unwrap_or(u32::MAX));
        for (what, count, least, most) in
            [("robots", robots, 1, 2000), ("goals", goals, 1, 4), ("obstacles", obstacles, 0, MOST_OBSTACLES)]
        {
            ensure!((least..=most).contains(&count), "{count} {what} are out of range; give {least} to {most}");
        }
        ensure!((0.01..=0.1).contains(&tick_s), "a tick of {tick_s} s is out of range; give 0.01 to 0.1");
        let [safety, table] = avoidance.fields();
        let ticks = libm::ceil(LASTS_S / tick_s) as u32;
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
            "name = \"new-run\"\nseed = {seed}\nticks = {ticks}\ntick_s = {tick_s}\n[radio]\nrange_m = 20\n\
             [plane]\nradius_m = 0.2\nmax_speed_mps = 1\nlaw = \"goal_flock\"\nsafety = \"{safety}\"\n\
             [plane.robots.cloud]\ncount = {robots}\nfrom_m = [0, 0]\nto_m = [{side_m:.2}, {side_m:.2}]\n\
             goals_m = [{}]\n[plane.goal_flock]\nmin_distance_m = 0.6\ntolerance_m = {:.2}\n{table}",
            places.join(", "),
            0.6 * libm::sqrt(f64::from(robots)).max(2.0),
        );
        let random = |_| {
            let radius_m = draw(0.2, 0.8);
            let (x, y) = (draw(side_m + 2.0, width_m - side_m - 2.0), draw(-1.0, side_m + 1.0));
            [x, y, radius_m]
        };
        for [x, y, radius_m] in listed.unwrap_or_else(|| (0..obstacles).map(random).collect()) {
            let _ = writeln!(text, "[[plane.ball]]\ncenter_m = [{x:.2}, {y:.2}]\nradius_m = {radius_m:.2}");
        }
        let _ = writeln!(text, "# {robots} robots, {goals} goals, {obstacles} obstacles.");
        Ok(text)
    }
}

/// Checks the obstacles that a page lists.
fn listed(discs: &[Vec<Option<f64>>]) -> Result<Vec<[f64; 3]>> {
    let row = |(index, disc): (usize, &Vec<Option<f64>>)| {
        let line = index + 1;
        let &[Some(x), Some(y), Some(radius_m)] = &disc[..] else {
            bail!("obstacle {line} is not three numbers; give x, y and radius, in metres");
        };
        let is_near = x.abs() <= FARTHEST_M && y.abs() <= FARTHEST_M;
        ensure!(is_near, "obstacle {line} is too far away; give coordinates of at most {FARTHEST_M} m");
        ensure!((0.01..=100.0).contains(&radius_m), "obstacle {line}: its radius is not 0.01 to 100 m; give another");
        Ok([x, y, radius_m])
    };
    discs.iter().enumerate().map(row).collect()
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
                let configuration = configured(robots, goals, obstacles, seed);
                assert_eq!(parsed(&configuration).robots.len(), robots as usize);
            }
        }
    }

    fn configured(robots: u32, goals: u32, obstacles: u32, seed: u64) -> Configuration {
        let text = format!("{{\"robots\":{robots},\"goals\":{goals},\"obstacles\":{obstacles},\"seed\":{seed}}}");
        serde_json::from_str(&text).expect("the other fields have defaults")
    }

    fn parsed(configuration: &Configuration) -> Scenario {
        let text = configuration.scenario().expect("numbers in range");
        let scenario = Scenario::parse(&text, Path::new("new.toml"), &Overrides::default());
        scenario.unwrap_or_else(|error| panic!("{configuration:?}: {error}"))
    }

    /// PAV, figure 9: dt, the model of avoidance, and the places of obstacles.
    #[test]
    fn tick_avoidance_and_places_of_obstacles_can_be_given() {
        use staya_controller::agent::LayerSettings;
        use staya_controller::push_out::{Evasion, Model};
        let usual = configured(9, 2, 30, 1);
        assert_eq!(parsed(&usual).safety(0).name(), "orca");
        assert_eq!((parsed(&usual).tick_s(), parsed(&usual).ticks), (0.1, 4000));
        for (word, expected) in [
            ("orca", None),
            ("none", None),
            ("radial", Some((Model::Radial, Evasion::Multiple))),
            ("radial_single", Some((Model::Radial, Evasion::Single))),
            ("tangential", Some((Model::Tangential, Evasion::Multiple))),
            ("tangential_single", Some((Model::Tangential, Evasion::Single))),
        ] {
            let avoidance = serde_json::from_str(&format!("\"{word}\"")).expect(word);
            let scenario = parsed(&Configuration { avoidance, tick_s: 0.05, ..usual.clone() });
            assert_eq!((scenario.tick_s(), scenario.ticks), (0.05, 8000));
            let found = match scenario.safety(0) {
                LayerSettings::PushOut(settings) => Some((settings.params.model, settings.params.evasion)),
                other => {
                    assert_eq!(other.name(), word);
                    None
                }
            };
            assert_eq!(found, expected, "{word}");
        }
        let discs = Some(vec![vec![Some(12.0), Some(-4.5), Some(0.5)], vec![Some(15.0), Some(0.0), Some(2.0)]]);
        let scenario = parsed(&Configuration { discs, ..usual.clone() });
        let solids = &scenario.plane().expect("a plane").solids;
        assert_eq!(solids.len(), 2);
        assert!(solids[0].distance_m([12.0, -4.5, 0.0]) < 0.0 && solids[1].distance_m([15.0, 1.9, 0.0]) < 0.0);
        assert!(
            parsed(&Configuration { discs: Some(Vec::new()), ..usual }).plane().expect("a plane").solids.is_empty()
        );
    }

    #[test]
    fn wrong_ticks_and_places_are_refused() {
        let usual = configured(9, 2, 3, 1);
        let refused = |wrong: Configuration| wrong.scenario().expect_err("refused").to_string();
        for tick_s in [0.0, 0.009, 0.11, -1.0, f64::NAN, f64::INFINITY] {
            assert!(refused(Configuration { tick_s, ..usual.clone() }).ends_with("give 0.01 to 0.1"), "{tick_s}");
        }
        let good = vec![Some(1.0), Some(2.0), Some(0.5)];
        for (disc, expected) in [
            (vec![Some(1.0), Some(2.0)], "obstacle 2 is not three numbers; give x, y and radius, in metres"),
            (vec![Some(1.0), None, Some(0.5)], "obstacle 2 is not three numbers; give x, y and radius, in metres"),
            (vec![Some(1e9), Some(2.0), Some(0.5)], "obstacle 2 is too far away; give coordinates of at most 10000 m"),
            (vec![Some(1.0), Some(2.0), Some(0.0)], "obstacle 2: its radius is not 0.01 to 100 m; give another"),
        ] {
            assert_eq!(refused(Configuration { discs: Some(vec![good.clone(), disc]), ..usual.clone() }), expected);
        }
        let many = refused(Configuration { discs: Some(vec![good; 201]), ..usual });
        assert_eq!(many, "201 obstacles are out of range; give 0 to 200");
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
            let configuration = configured(robots, goals, obstacles, 1);
            assert_eq!(configuration.scenario().expect_err(expected).to_string(), expected);
        }
    }
}
