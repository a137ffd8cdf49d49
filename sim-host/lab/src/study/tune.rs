//! Tuning of a goal flock: K2 / K1, K3 / K1 and R_nbh for a scenario, which PAV mentions without a
//! description.
//!
//! Particle swarm optimisation (`argmin`) searches for the gains with the lowest cost per run:
//!
//! (1 - together) + (1 - arrived) + (time until half were at the middle / time straight there - 1).
//!
//! A cost of one means no group, or no arrivals, or twice the time. The result is judged on runs
//! that the search has not used, beside the default gains.

use super::flock::{self, Run};
use super::{Given, Study};
use crate::error::SweepError;
use crate::measure::{Job, Measured, Watch, measure};
use argmin::core::{CostFunction, Executor, State as _};
use argmin::solver::particleswarm::ParticleSwarm;
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::SeedableRng as _;
use rayon::prelude::*;
use staya_controller::agent::{GoalFlockSettings, LawSettings};
use staya_sim::scenario::{Field, Scenario, Source};
use staya_sim::table;
use std::path::PathBuf;

/// The defaults of the figure: K2 / K1, K3 / K1, R_nbh in R_MinDist.
const UNTUNED: [f64; 3] = [1.0, 2.0, 4.0];
/// Bounds of log2 of K2 / K1, log2 of K3 / K1, R_nbh in R_MinDist.
const BOUNDS: [[f64; 3]; 2] = [[-5.0, -3.0, 2.0], [3.0, 4.0, 12.0]];
/// First seed of the runs that judge.
const JUDGED_FROM: u64 = 1_000_000_000;
/// Standard PSO 2011: inertia 1 / (2 ln 2), attraction 1/2 + ln 2. Literals have the same bits on
/// every machine.
const INERTIA: f64 = 0.721_347_520_444_481_7;
const PULL: f64 = 1.193_147_180_559_945_3;
const MEASURES: [&str; 3] = ["company.together", "company.arrived", "company.half_gathered_s"];

/// The study.
#[derive(Debug)]
pub struct Tune;

table! {
    /// Parameters of a search.
    pub struct Parameters {
        part flock: flock::Parameters;
        /// Particles of the search.
        pub particles: u32 = 10, 2.0..=1e4, "";
        /// Moves of the particles: the search evaluates particles times (moves + 1) costs.
        pub moves: u32 = 12, 1.0..=1e4, "";
        /// Runs of a cost.
        pub runs: u32 = 2, 1.0..=1e4, "";
        /// Runs that judge the result.
        pub judged: u32 = 20, 1.0..=1e4, "";
    }
}

impl Study for Tune {
    fn name(&self) -> &'static str {
        "tune"
    }

    fn measures(&self) -> Vec<(String, &'static str)> {
        [
            ("k2_over_k1", "K2 / K1 found"),
            ("k3_over_k1", "K3 / K1 found"),
            ("neighborhood_over_min_distance", "R_nbh / R_MinDist found"),
            ("found_cost", "mean cost on the runs of the search"),
            ("cost", "mean cost on other runs"),
            ("untuned_cost", "mean cost of the default gains on these"),
            ("cost_over_untuned", "ratio of the two"),
        ]
        .map(|(name, meaning)| (name.to_owned(), meaning))
        .to_vec()
    }

    fn takes_scenario(&self) -> bool {
        true
    }

    fn read(&self, given: &Given<'_>) -> Result<Job, SweepError> {
        let parameters: Parameters = given.parameters()?;
        let run = Run::read(given, parameters.flock.clone())?;
        let wrong = || given.error("particles", "the scenario has no goal flock", "name one with a goal flock");
        let (straight_s, k1, unit_m) = way(&run.scenario).ok_or_else(wrong)?;
        let (text, path) = (given.source.written(), given.source.path().to_owned());
        let search = Search { parameters, text, path, straight_s, k1, unit_m, seed: given.seed };
        Ok(Box::new(move |watch| search.tuned(watch)))
    }
}

struct Search {
    parameters: Parameters,
    /// Fields of the scenario and the study.
    text: String,
    path: PathBuf,
    straight_s: f64,
    k1: f64,
    unit_m: f64,
    seed: u64,
}

impl Search {
    /// Mean cost of runs `first..first + count` with these gains. Runs are parallel and summed in
    /// order.
    fn cost(&self, [k2, k3, neighborhood]: [f64; 3], first: u64, count: u32, watch: &Watch<'_>) -> Result<f64, String> {
        let mut source = Source::new(&self.path, &self.text).map_err(|error| error.to_string())?;
        let fields = [("k2", self.k1 * k2), ("k3", self.k1 * k3), ("neighborhood_m", self.unit_m * neighborhood)];
        let fields = fields.map(|(name, value)| (format!("plane.goal_flock.{name}"), format!("{value:?}")));
        for (name, value) in &fields {
            source.set(&Field::read(name).ok_or("a field")?, value)?;
        }
        let text = source.written();
        let run = |seed: u64| {
            let source = Source::new(&self.path, &text).map_err(|error| error.to_string())?;
            let given = Given { source, measures: &[], seed };
            let run = Run::read(&given, self.parameters.flock.clone()).map_err(|error| error.to_string())?;
            let measured = measure(&run.scenario, &MEASURES.map(str::to_owned), watch, &|each| run.simulate(each))?;
            let [together, arrived, half_s] = MEASURES.map(|name| measured.values.get(name).copied().flatten());
            let half_s = half_s.unwrap_or(f64::from(run.scenario.ticks) * run.scenario.tick_s());
            if measured.is_cut {
                return Err("stopped".to_owned());
            }
            Ok(1.0 - together.unwrap_or(0.0) + 1.0 - arrived.unwrap_or(0.0) + half_s / self.straight_s - 1.0)
        };
        let costs: Vec<f64> =
            (first..first + u64::from(count)).into_par_iter().map(run).collect::<Result<_, String>>()?;
        Ok(costs.iter().sum::<f64>() / f64::from(count))
    }

    fn tuned(&self, watch: &Watch<'_>) -> Result<Measured, String> {
        let Parameters { particles, moves, runs, judged, .. } = self.parameters;
        let [low, high] = BOUNDS.map(|bound| bound.to_vec());
        let swarm = ParticleSwarm::new((low, high), particles as usize)
            .with_inertia_factor(INERTIA)
            .and_then(|swarm| swarm.with_cognitive_factor(PULL))
            .and_then(|swarm| swarm.with_social_factor(PULL))
            .map_err(|error| format!("the search cannot begin: {error}"))?
            .with_rng_generator(Xoshiro256PlusPlus::seed_from_u64(self.seed));
        let problem = Cost { search: self, watch };
        let search = Executor::new(problem, swarm).configure(|state| state.max_iters(moves.into())).timer(false);
        let state = match search.run() {
            Ok(done) => done.state,
            Err(_) if !watch(0) => return Ok(Measured { is_cut: true, ..Measured::default() }),
            Err(error) => return Err(format!("the search failed: {error}")),
        };
        let best = state.get_best_param().ok_or("the search found nothing")?;
        let [k2, k3, neighborhood] = gains(&best.position);
        let found = self.cost([k2, k3, neighborhood], self.seed, runs, watch)?;
        let cost = self.cost([k2, k3, neighborhood], JUDGED_FROM, judged, watch)?;
        let untuned = self.cost(UNTUNED, JUDGED_FROM, judged, watch)?;
        let values = [
            ("k2_over_k1", k2),
            ("k3_over_k1", k3),
            ("neighborhood_over_min_distance", neighborhood),
            ("found_cost", found),
            ("cost", cost),
            ("untuned_cost", untuned),
            ("cost_over_untuned", cost / untuned),
        ];
        Ok(Measured::of(values.map(|(name, value)| (name, Some(value)))))
    }
}

struct Cost<'a> {
    search: &'a Search,
    watch: &'a Watch<'a>,
}

impl CostFunction for Cost<'_> {
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, place: &Vec<f64>) -> Result<f64, argmin::core::Error> {
        let Search { parameters, seed, .. } = self.search;
        self.search.cost(gains(place), *seed, parameters.runs, self.watch).map_err(argmin::core::Error::msg)
    }
}

/// Time straight from the middle of the starts to where robots have gathered, K1 and R_MinDist;
/// `None` without a goal flock.
fn way(scenario: &Scenario) -> Option<(f64, f64, f64)> {
    let plane = scenario.plane()?;
    let Some(LawSettings::GoalFlock(GoalFlockSettings { arrival_m, params, .. })) = plane.general.law.built_in() else {
        return None;
    };
    let mean =
        |places: &[[f64; 3]], axis: usize| places.iter().map(|place| place[axis]).sum::<f64>() / places.len() as f64;
    let starts: Vec<_> = plane.starts.iter().map(|start| start.position_m).collect();
    let goals: Vec<_> = plane.starts.first()?.places.iter().map(|goal| goal.position_m).collect();
    let [x, y] = [0, 1].map(|axis| mean(&goals, axis) - mean(&starts, axis));
    let [arrival_m, speed_mps, k1, unit_m] =
        [*arrival_m, params.speed_mps, params.goal_gain, params.min_distance_m].map(f64::from);
    Some(((libm::hypot(x, y) - arrival_m) / speed_mps, k1, unit_m))
}

fn gains(place: &[f64]) -> [f64; 3] {
    let at = |axis: usize| place.get(axis).copied().unwrap_or_default();
    [libm::exp2(at(0)), libm::exp2(at(1)), at(2)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn read(fields: &str) -> Result<Measured, String> {
        let scenario = include_str!("../../../../papers/pav/goals/scenario.toml").replace("count = 225", "count = 12");
        let mut source = Source::new(Path::new("s.toml"), &scenario).unwrap();
        for field in ["ticks = 300"].into_iter().chain(fields.lines()) {
            let (name, value) = field.split_once(" = ").unwrap();
            let name = if name == "ticks" { name.to_owned() } else { format!("study.{name}") };
            source.set(&Field::read(&name).unwrap(), value).unwrap();
        }
        let given = Given { source, measures: &[], seed: 3 };
        Tune.read(&given).map_err(|error| error.to_string())?(&|_| true)
    }

    #[test]
    fn search_depends_only_on_its_seed_and_improves_bad_gains() {
        let small = "particles = 3\nmoves = 2\nruns = 1\njudged = 2";
        let [one, again] = [read(small), read(small)].map(|measured| measured.unwrap().values);
        assert_eq!(one, again);
        let value = |name: &str| one[name].unwrap();
        assert!(value("found_cost") < 3.0, "{one:?}");
        assert!((value("cost") / value("untuned_cost") - value("cost_over_untuned")).abs() < 1e-12);
        assert!((2.0..=12.0).contains(&value("neighborhood_over_min_distance")));
    }

    #[test]
    fn invalid_searches_are_refused_with_the_reason() {
        for (fields, expected) in
            [("particles = 1", "give 2 to"), ("moves = 0", "study.moves: 0"), ("judged = 0", "give 1 to")]
        {
            let error = read(fields).unwrap_err();
            assert!(error.contains(expected), "{error}");
        }
    }
}
