//! Auto-tuning of the goal flock: K2 / K1, K3 / K1 and R_nbh for a scene, which PAV mentions
//! without a description.
//!
//! Particle swarm optimisation (`argmin`) searches for the gains with the lowest cost per run:
//!
//! (1 - together) + (1 - arrived) + (time until half were at the middle / time straight there - 1).
//!
//! A cost of one means no group, or no arrivals, or twice the time. The result is validated on runs
//! that the search has not used, next to the experiment's default gains.

use super::setting::{Setting, short, varying};
use super::{Plan, Run};
use crate::experiment::rows::{Each, Jobs, Record};
use crate::experiment::{Experiment, Maybe, check_runs};
use crate::sweep::Value;
use anyhow::{Result, anyhow, bail, ensure};
use argmin::core::{CostFunction, Executor, State as _};
use argmin::solver::particleswarm::ParticleSwarm;
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::SeedableRng as _;
use rayon::prelude::*;
use serde::Serialize;
use std::fmt::{self, Display, Formatter};

/// Only ratios of gains matter, as long as the sum of the terms is longer than 1.
const K1: f64 = 50.0;
/// The experiment's defaults: K2 / K1, K3 / K1, R_nbh in R_MinDist.
const UNTUNED: [f64; 3] = [1.0, 2.0, 4.0];
/// Bounds of log2 of K2 / K1, log2 of K3 / K1, R_nbh in R_MinDist.
const BOUNDS: [[f64; 3]; 2] = [[-5.0, -3.0, 2.0], [3.0, 4.0, 12.0]];
const JUDGED_FROM: u32 = 1_000_000_000;
/// Standard PSO 2011: inertia 1 / (2 ln 2), attraction 1/2 + ln 2. Literals have the same bits on
/// every machine.
const INERTIA: f64 = 0.721_347_520_444_481_7;
const PULL: f64 = 1.193_147_180_559_945_3;

/// A search for gains, one for each scene of the plan's lists.
#[derive(Clone, Debug)]
pub struct Tuning {
    /// Scenes and runs; gains and neighbourhoods are ignored. A cost is the mean of `runs` runs.
    pub plan: Plan,
    /// Number of particles.
    pub particles: u32,
    /// Number of moves of the particles.
    pub moves: u32,
    /// Number of runs for validation.
    pub judged: u32,
}

/// Mean figures of some runs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Verdict {
    /// Mean cost.
    pub cost: f64,
    /// Mean share of the largest group on the way.
    pub together: f64,
    /// Mean share of robots at a goal at the end.
    pub arrived: f64,
    /// Mean time until half were at the middle / time straight there; at most that of the run.
    pub time_ratio: f64,
}

/// Result of one search.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tuned {
    /// K2 / K1, K3 / K1, R_nbh in R_MinDist.
    gains: [f64; 3],
    evaluations: u64,
    found: Verdict,
    judged: Verdict,
    untuned: Verdict,
    hash: u64,
}

impl Record for Tuned {
    fn figures(&mut self, each: &mut Each<'_>) {
        let [k2, k3, neighborhood] = &mut self.gains;
        each("k2_over_k1", "K2 / K1 found", k2);
        each("k3_over_k1", "K3 / K1 found", k3);
        each("neighborhood_over_min_distance", "R_nbh / R_MinDist found", neighborhood);
        each("evaluations", "costs that the search asked for", &mut self.evaluations);
        each("found_cost", "cost on the runs of the search", &mut self.found.cost);
        each("found_together", "largest group on the runs of the search", &mut self.found.together);
        each("found_arrived", "share that arrived on the runs of the search", &mut self.found.arrived);
        each("found_time_ratio", "time over the straight one on the runs of the search", &mut self.found.time_ratio);
        each("cost", "cost on runs not seen by the search", &mut self.judged.cost);
        each("together", "largest group on runs not seen", &mut self.judged.together);
        each("arrived", "share that arrived on runs not seen", &mut self.judged.arrived);
        each("time_ratio", "time over the straight one on runs not seen", &mut self.judged.time_ratio);
        each("untuned_cost", "cost of the default gains on runs not seen", &mut self.untuned.cost);
        each("untuned_together", "largest group with the default gains", &mut self.untuned.together);
        each("untuned_arrived", "share that arrived with the default gains", &mut self.untuned.arrived);
        each("untuned_time_ratio", "time over the straight one with the default gains", &mut self.untuned.time_ratio);
    }

    fn trace_hash(&mut self) -> Option<&mut u64> {
        Some(&mut self.hash)
    }
}

impl Tuning {
    fn scenes(&self) -> Vec<Setting> {
        let mut scenes: Vec<Setting> = Vec::new();
        for setting in self.plan.settings() {
            if !scenes.iter().any(|other| other.scene() == setting.scene()) {
                scenes.push(setting);
            }
        }
        scenes
    }

    fn with(&self, scene: &Setting, [k2, k3, neighborhood]: [f64; 3]) -> Setting {
        Setting { k1: K1, k2: K1 * k2, k3: K1 * k3, neighborhood_m: neighborhood * self.plan.min_distance_m, ..*scene }
    }

    /// Means of runs `first..first + count`, and the exclusive or of their trace hashes. Runs are
    /// parallel and summed in order.
    fn judge(&self, setting: &Setting, first: u32, count: u32) -> Result<(Verdict, u64)> {
        let runs = (first..first + count).into_par_iter().map(|number| self.plan.run(setting, number, false));
        let runs: Vec<Run> = runs.collect::<Result<_>>()?;
        let (mut sum, mut hash) = (Verdict::default(), 0);
        for run in &runs {
            let verdict = self.verdict(setting, run);
            sum.cost += verdict.cost;
            sum.together += verdict.together;
            sum.arrived += verdict.arrived;
            sum.time_ratio += verdict.time_ratio;
            hash ^= run.hash;
        }
        let mean = |sum: f64| sum / f64::from(count);
        let verdict = Verdict {
            cost: mean(sum.cost),
            together: mean(sum.together),
            arrived: mean(sum.arrived),
            time_ratio: mean(sum.time_ratio),
        };
        Ok((verdict, hash))
    }

    fn verdict(&self, setting: &Setting, run: &Run) -> Verdict {
        let straight_s = super::scene::way(setting) * self.plan.min_distance_m / self.plan.speed_mps();
        let together = run.way.map_or(0.0, |way| way.together);
        let arrived = run.at_goals.iter().sum::<usize>() as f64 / f64::from(setting.robots);
        let time_ratio = run.half_gathered_s.unwrap_or(self.plan.seconds) / straight_s;
        Verdict { cost: (1.0 - together) + (1.0 - arrived) + (time_ratio - 1.0), together, arrived, time_ratio }
    }

    fn tune(&self, scene: &Setting, may_continue: &(dyn Fn() -> bool + Sync)) -> Result<Option<Tuned>> {
        let bounds = BOUNDS.map(|bound| bound.to_vec());
        let [low, high] = bounds;
        let swarm = ParticleSwarm::new((low, high), self.particles as usize)
            .with_inertia_factor(INERTIA)
            .and_then(|swarm| swarm.with_cognitive_factor(PULL))
            .and_then(|swarm| swarm.with_social_factor(PULL))
            .map_err(|error| anyhow!("the search cannot begin: {error}"))?
            .with_rng_generator(Xoshiro256PlusPlus::seed_from_u64(self.plan.seed));
        let cost = Cost { tuning: self, scene, may_continue };
        let search = Executor::new(cost, swarm).configure(|state| state.max_iters(u64::from(self.moves))).timer(false);
        let state = match search.run() {
            Ok(done) => done.state,
            Err(_) if !may_continue() => return Ok(None),
            Err(error) => return Err(anyhow!("the search came to no end: {error}")),
        };
        let Some(best) = state.get_best_param() else {
            bail!("the search found nothing");
        };
        let gains = gains(&best.position);
        let setting = self.with(scene, gains);
        let (judged, hash) = self.judge(&setting, JUDGED_FROM, self.judged)?;
        Ok(Some(Tuned {
            gains,
            evaluations: u64::from(self.particles) * (u64::from(self.moves) + 1),
            found: self.judge(&setting, 0, self.plan.runs)?.0,
            judged,
            untuned: self.judge(&self.with(scene, UNTUNED), JUDGED_FROM, self.judged)?.0,
            hash,
        }))
    }
}

fn gains(place: &[f64]) -> [f64; 3] {
    let at = |axis: usize| place.get(axis).copied().unwrap_or_default();
    [libm::exp2(at(0)), libm::exp2(at(1)), at(2)]
}

struct Cost<'a> {
    tuning: &'a Tuning,
    scene: &'a Setting,
    may_continue: &'a (dyn Fn() -> bool + Sync),
}

impl CostFunction for Cost<'_> {
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, place: &Vec<f64>) -> Result<f64> {
        ensure!((self.may_continue)(), "ended");
        let setting = self.tuning.with(self.scene, gains(place));
        Ok(self.tuning.judge(&setting, 0, self.tuning.plan.runs)?.0.cost)
    }
}

impl Experiment for Tuning {
    const NAME: &'static str = "goals-tuned";
    const UNIT: &'static str = "searches";
    type Run = Tuned;
    type Report = Report;

    fn check(&self) -> Result<()> {
        self.plan.check()?;
        check_runs(self.judged, "to judge by")?;
        ensure!((2..=1000).contains(&self.particles), "{} particles; give 2 to 1000", self.particles);
        ensure!((1..=10_000).contains(&self.moves), "{} moves; give 1 to 10,000", self.moves);
        Ok(())
    }

    fn points(&self) -> usize {
        self.scenes().len()
    }

    fn runs(&self) -> u32 {
        1
    }

    fn given(&self, point: usize) -> Vec<(&'static str, Value)> {
        let tuned = ["k1", "k2", "k3", "neighborhood_m"];
        let mut given = self.scenes()[point].given();
        given.retain(|(name, _)| !tuned.contains(name));
        given.extend(self.plan.common());
        given.extend([
            ("tuning_runs", self.plan.runs.into()),
            ("particles", self.particles.into()),
            ("moves", self.moves.into()),
            ("judged", Value::from(self.judged)),
        ]);
        given
    }

    fn seed(&self, _: usize, _: u32) -> u64 {
        self.plan.seed
    }

    fn blank(&self, _: usize, _: u32) -> Tuned {
        Tuned::default()
    }

    fn perform(&self, jobs: &Jobs<'_, Self>) -> Result<Vec<Vec<Tuned>>> {
        let scenes = self.scenes();
        jobs.each(|(): &mut (), point, _| self.tune(&scenes[point], &|| jobs.may_continue()))
    }

    fn report(&self, runs: &[Vec<Tuned>]) -> Report {
        let scenes = self.scenes();
        let differ = varying(&scenes);
        let line = |(scene, runs): (&Setting, &Vec<Tuned>)| {
            let tuned = runs.first()?;
            let given = scene.given();
            let own = differ.iter().filter(|place| **place >= 4);
            let words: Vec<_> = own.map(|&place| format!("{} {}", short(given[place].0), given[place].1)).collect();
            let [k2_over_k1, k3_over_k1, neighborhood_over_min_distance] = tuned.gains;
            Some(Line {
                scene: if words.is_empty() { "all".to_owned() } else { words.join(", ") },
                k2_over_k1,
                k3_over_k1,
                neighborhood_over_min_distance,
                found: tuned.found,
                judged: tuned.judged,
                untuned: tuned.untuned,
            })
        };
        Report {
            seed: self.plan.seed,
            tuning_runs: self.plan.runs,
            judged_runs: self.judged,
            evaluations: self.particles * (self.moves + 1),
            scenes: scenes.iter().zip(runs).filter_map(line).collect(),
        }
    }
}

/// Result for one scene.
#[derive(Clone, Debug, Serialize)]
pub struct Line {
    /// Parameters in which the scene differs from others.
    pub scene: String,
    /// Best K2 / K1.
    pub k2_over_k1: f64,
    /// Best K3 / K1.
    pub k3_over_k1: f64,
    /// Best R_nbh / R_MinDist.
    pub neighborhood_over_min_distance: f64,
    /// Mean figures on the runs of the search.
    pub found: Verdict,
    /// Mean figures on the validation runs.
    pub judged: Verdict,
    /// Mean figures of the default gains on the validation runs.
    pub untuned: Verdict,
}

/// Results of the tuning.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Seed of the tuning.
    pub seed: u64,
    /// Runs per cost evaluation.
    pub tuning_runs: u32,
    /// Validation runs.
    pub judged_runs: u32,
    /// Cost evaluations per search.
    pub evaluations: u32,
    /// One result per scene.
    pub scenes: Vec<Line>,
}

impl Display for Report {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{} costs a search, each the mean of {} runs; judged on {} others; seed {}",
            self.evaluations, self.tuning_runs, self.judged_runs, self.seed
        )?;
        writeln!(
            f,
            "{:<24}{:<11}{:>8}{:>8}{:>8}{:>9}{:>10}{:>9}{:>7}",
            "scene", "", "K2/K1", "K3/K1", "R_nbh", "cost", "together", "arrived", "time"
        )?;
        for line in &self.scenes {
            let own = [line.k2_over_k1, line.k3_over_k1, line.neighborhood_over_min_distance];
            let rows = [("search", own, line.found), ("judged", own, line.judged), ("default", UNTUNED, line.untuned)];
            for (name, [k2, k3, neighborhood], verdict) in rows {
                writeln!(
                    f,
                    "{:<24}{name:<11}{k2:>8.3}{k3:>8.3}{neighborhood:>8.2}{:>9}{:>10.3}{:>9.3}{:>7.2}",
                    line.scene,
                    Maybe(Some(verdict.cost), 3),
                    verdict.together,
                    verdict.arrived,
                    verdict.time_ratio
                )?;
            }
        }
        f.write_str("cost: (1 - together) + (1 - arrived) + (time - 1), the mean of runs; together: share of the largest group on the way; arrived: share at a goal at\n")?;
        f.write_str("the end; time: until half were at the middle, over the time straight there; R_nbh in R_MinDist. search: on its own runs; judged: on others\n")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn small() -> Tuning {
        let plan = Plan { robots: vec![30], seconds: 120.0, step_s: 0.2, runs: 2, ..Plan::default() };
        Tuning { plan, particles: 4, moves: 3, judged: 2 }
    }

    #[test]
    fn search_depends_only_on_its_seed_and_improves_bad_gains() {
        let tuning = small();
        let report = tuning.measure().unwrap();
        let [line] = &report.scenes[..] else { panic!("{report:?}") };
        let again = tuning.measure().unwrap();
        assert_eq!(format!("{report}"), format!("{again}"));
        let scene = tuning.scenes()[0];
        let worst = tuning.judge(&tuning.with(&scene, [8.0, 0.125, 2.0]), 0, 2).unwrap().0;
        assert!(line.found.cost < worst.cost, "{} {}", line.found.cost, worst.cost);
        let other = Tuning { plan: Plan { seed: 12, ..tuning.plan.clone() }, ..tuning };
        assert_ne!(other.measure().unwrap().scenes[0].k2_over_k1, line.k2_over_k1);
    }

    #[test]
    fn validation_runs_differ_from_those_of_the_search() {
        let tuning = small();
        let setting = tuning.with(&tuning.scenes()[0], UNTUNED);
        let [seen, unseen] = [0, JUDGED_FROM].map(|first| tuning.judge(&setting, first, 2).unwrap().1);
        assert_ne!(seen, unseen);
    }

    #[test]
    fn invalid_searches_are_refused_with_the_reason() {
        let refused = |change: fn(&mut Tuning)| {
            let mut tuning = small();
            change(&mut tuning);
            tuning.check().unwrap_err().to_string()
        };
        assert!(refused(|t| t.particles = 1).contains("2 to 1000"));
        assert!(refused(|t| t.moves = 0).contains("1 to 10,000"));
        assert!(refused(|t| t.judged = 0).contains("1 or more to judge by"));
    }
}
