//! One value of each list of a plan.

use super::Plan;
use anyhow::{Result, bail, ensure};
use clap::builder::TypedValueParser;
use staya_console::options::one_of;
use staya_controller::agent::SafetyKind;
use staya_controller::goal_flock::GoalParams;
use staya_controller::names::Named;
use staya_controller::push_out::{Evasion, Model};

/// Knowledge of the robots about each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Knowledge {
    /// All robots within R_nbh, as in the paper. Without radio and agents: the law and push-out.
    All,
    /// Like [`Knowledge::All`], for the sixteen nearest robots only.
    Nearest,
    /// Agents that receive packets from their sixteen nearest neighbours.
    Packets,
}

impl Named for Knowledge {
    const NAMES: &'static [(&'static str, Self)] =
        &[("all", Self::All), ("nearest", Self::Nearest), ("packets", Self::Packets)];

    fn name(self) -> &'static str {
        match self {
            Self::All => "all",
            Self::Nearest => "nearest",
            Self::Packets => "packets",
        }
    }
}

pub(super) fn knowledge() -> impl TypedValueParser<Value = Knowledge> {
    one_of(&[
        (Knowledge::All, "All within R_nbh, where they are: the law by itself, without agents"),
        (Knowledge::Nearest, "The same, but the sixteen nearest only"),
        (Knowledge::Packets, "Agents that hear packets of their sixteen nearest"),
    ])
}

/// One value of each list of a plan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setting {
    /// Gain of the attraction to the goal.
    pub k1: f64,
    /// Gain of the attraction to the middle of the neighbours.
    pub k2: f64,
    /// Gain of the repulsion from robots that are too near.
    pub k3: f64,
    /// Range of sight R_nbh, metres.
    pub neighborhood_m: f64,
    /// Number of robots.
    pub robots: u32,
    /// Number of goals.
    pub goals: u32,
    /// Speed of the goals, m/s, to the north.
    pub goal_speed_mps: f64,
    /// Number of obstacles.
    pub obstacles: u32,
    /// Side of the square of the starts, in R_MinDist per root of the number of robots.
    pub start_side: f64,
    /// Knowledge of the robots about each other.
    pub knows: Knowledge,
    /// Safety layer behind the flock.
    pub safety: SafetyKind,
    /// Model of push-out.
    pub model: Model,
    /// Number of robots that push-out evades at once.
    pub evasion: Evasion,
}

impl Setting {
    /// K1 / K2; `None` for independent robots (K2 = 0).
    #[must_use]
    pub fn ratio(&self) -> Option<f64> {
        (self.k2 != 0.0).then(|| self.k1 / self.k2)
    }

    /// The setting without K1 and K2.
    #[must_use]
    pub fn without_gains(&self) -> Self {
        Self { k1: 0.0, k2: 0.0, ..*self }
    }

    /// The setting without tuned parameters.
    #[must_use]
    pub fn scene(&self) -> Self {
        Self { k3: 0.0, neighborhood_m: 0.0, ..self.without_gains() }
    }

    pub(super) fn params(&self, min_distance_m: f64, speed_mps: f64) -> GoalParams<f32> {
        GoalParams {
            goal_gain: self.k1 as f32,
            center_gain: self.k2 as f32,
            repulsion_gain: self.k3 as f32,
            neighborhood_m: self.neighborhood_m as f32,
            ..GoalParams::new(min_distance_m as f32, speed_mps as f32)
        }
    }

    /// In R_MinDist: 1.5 times the radius of the lattice of the robots that go to one goal.
    pub(super) fn arrival(&self) -> f64 {
        let each = f64::from(self.robots) / f64::from(self.goals);
        let lattice = libm::sqrt(each * libm::sqrt(3.0) / (2.0 * std::f64::consts::PI));
        1.5 * lattice.max(2.0)
    }

    pub(super) fn start_half(&self) -> f64 {
        self.start_side * libm::sqrt(f64::from(self.robots)) / 2.0
    }

    fn check(&self, min_distance_m: f64, step_s: f64) -> Result<()> {
        for gain in [self.k1, self.k2, self.k3] {
            ensure!((-1e6..=1e6).contains(&gain), "a gain of {gain}; give a number within +-1,000,000");
        }
        let (wide_m, least_m) = (self.neighborhood_m, 2.0 * min_distance_m);
        ensure!(
            (least_m..=1e5).contains(&wide_m),
            "a neighbourhood of {wide_m} m; it must be {least_m} (two least distances) to 100,000"
        );
        ensure!((2..=2000).contains(&self.robots), "{} robots; give 2 to 2000", self.robots);
        ensure!((1..=4).contains(&self.goals), "{} goals; give 1 to 4", self.goals);
        let side = self.start_side;
        ensure!((1.2..=20.0).contains(&side), "a start side of {side}; it must be 1.2 to 20");
        let speed_mps = self.goal_speed_mps;
        ensure!(
            (0.0..=0.5 * min_distance_m).contains(&speed_mps),
            "goals at {speed_mps} m/s; robots go at {min_distance_m} m/s: give at most half of it"
        );
        ensure!((0.001..=0.5).contains(&step_s), "a step of {step_s} s; it must be 0.001 to 0.5");
        let goes_alone = matches!(self.safety, SafetyKind::None | SafetyKind::PushOut);
        if self.knows != Knowledge::Packets && !goes_alone {
            bail!("safety \"{}\" needs agents; give --knows packets with it, or --safety push-out", self.safety);
        }
        Ok(())
    }
}

pub(super) fn short(name: &'static str) -> &'static str {
    match name {
        "neighborhood_m" => "R_nbh",
        "k1" => "K1",
        "k2" => "K2",
        "k3" => "K3",
        "goal_speed_mps" => "goal m/s",
        "start_side" => "side",
        other => other,
    }
}

pub(super) fn varying(settings: &[Setting]) -> Vec<usize> {
    let given: Vec<_> = settings.iter().map(Setting::given).collect();
    let Some(first) = given.first() else {
        return Vec::new();
    };
    let differs = |&place: &usize| place < 2 || given.iter().any(|other| other[place].1 != first[place].1);
    (0..first.len()).filter(differs).collect()
}

fn cross<T: Copy>(settings: &[Setting], values: &[T], set: impl Fn(&mut Setting, T)) -> Vec<Setting> {
    let with = |setting: &Setting, value: T| {
        let mut setting = *setting;
        set(&mut setting, value);
        setting
    };
    settings.iter().flat_map(|setting| values.iter().map(|&value| with(setting, value)).collect::<Vec<_>>()).collect()
}

impl Plan {
    /// All settings, K1 innermost. Model and evasion vary only for push-out.
    #[must_use]
    pub fn settings(&self) -> Vec<Setting> {
        let blank = Setting {
            k1: 0.0,
            k2: 0.0,
            k3: 0.0,
            neighborhood_m: 0.0,
            robots: 0,
            goals: 0,
            goal_speed_mps: 0.0,
            obstacles: 0,
            start_side: 0.0,
            knows: Knowledge::All,
            safety: SafetyKind::None,
            model: Model::default(),
            evasion: Evasion::default(),
        };
        let all = cross(&[blank], &self.knows, |s, value| s.knows = value);
        let all = cross(&all, &self.safeties, |s, value| s.safety = value);
        let all = cross(&all, &self.models, |s, value| s.model = value);
        let mut all = cross(&all, &self.evasions, |s, value| s.evasion = value);
        let first = (self.models.first(), self.evasions.first());
        all.retain(|s| s.safety == SafetyKind::PushOut || (Some(&s.model), Some(&s.evasion)) == first);
        let all = cross(&all, &self.robots, |s, value| s.robots = value);
        let all = cross(&all, &self.goals, |s, value| s.goals = value);
        let all = cross(&all, &self.goal_speeds_mps, |s, value| s.goal_speed_mps = value);
        let all = cross(&all, &self.obstacles, |s, value| s.obstacles = value);
        let all = cross(&all, &self.start_sides, |s, value| s.start_side = value);
        let all = cross(&all, &self.neighborhoods_m, |s, value| s.neighborhood_m = value);
        let all = cross(&all, &self.k3, |s, value| s.k3 = value);
        let all = cross(&all, &self.k2, |s, value| s.k2 = value);
        cross(&all, &self.k1, |s, value| s.k1 = value)
    }

    pub(super) fn check_settings(&self) -> Result<()> {
        let settings = self.settings();
        ensure!(!settings.is_empty(), "no points; give one value or more of each list, such as --k1 50");
        ensure!(settings.len() <= 5000, "{} points; give lists that make at most 5000", settings.len());
        let distance_m = self.min_distance_m;
        ensure!((0.1..=30.0).contains(&distance_m), "a least distance of {distance_m} m; it must be 0.1 to 30");
        settings.iter().try_for_each(|setting| setting.check(distance_m, self.step_s))
    }
}
