//! `staya experiment movingai`.

use crate::movingai::{Benchmark, GroupPlan, Learning, Memory, Plan, Robots, Sight};
use anyhow::Result;
use clap::Args;
use staya_console::options::RouteOptions;
use std::path::PathBuf;

/// The queries of a Moving AI benchmark: how many robots arrive, and how much longer they take.
#[derive(Args, Clone, Debug)]
#[command(allow_negative_numbers = true)]
pub struct MovingAiArgs {
    /// The scenario (.scen); its map is looked for beside it.
    scen: PathBuf,
    /// The map, if it is not beside the scenario under the name that the scenario gives.
    #[arg(long, value_name = "FILE")]
    map: Option<PathBuf>,
    /// Radius of the robot's window in cells, or "map": the robot sees everything, and the lengths
    /// that it finds are compared with the benchmark's optimal ones.
    #[arg(long, value_name = "CELLS|map", default_value = "5", value_parser = sight)]
    radius: Sight,
    /// How many visited cells the robot remembers, which gets it out of dead ends larger than its
    /// window.
    #[arg(long, value_name = "CELLS", default_value = "64", value_enum)]
    visits: Memory,
    /// For how many cells the robot learns what the way costs at least, while it comes no nearer to
    /// its goal; 0 leaves it the walls to follow.
    #[arg(long, value_name = "CELLS", default_value = "256", value_enum)]
    learned: Learning,
    #[command(flatten)]
    route: RouteOptions,
    /// Send groups of robots, each with a query of its own, through the whole simulator, with maps
    /// shared over the radio and without; results go to the folder's `share`.
    #[arg(long, conflicts_with_all = ["visits", "learned", "replan", "exit"])]
    share: bool,
    /// Robots of a group.
    #[arg(long, value_name = "ROBOTS,...", value_delimiter = ',', default_value = "6,20", requires = "share")]
    group: Vec<u32>,
    /// Losses of packets, 0 to 1.
    #[arg(long, value_name = "LOSS,...", value_delimiter = ',', default_value = "0,0.3,0.6", requires = "share")]
    losses: Vec<f64>,
    /// Groups of each size.
    #[arg(long, default_value_t = 50, requires = "share")]
    runs: u32,
    /// Equal seeds give equal results; what robots make of maps was chosen on seed 1 of natural
    /// land.
    #[arg(long, default_value_t = 3, requires = "share")]
    seed: u64,
    /// Folder for the rows.
    #[arg(long, value_name = "DIR", default_value = "out/experiment-movingai")]
    pub out: PathBuf,
}

fn sight(word: &str) -> Result<Sight, String> {
    if word == "map" {
        return Ok(Sight::Map);
    }
    match word.parse() {
        Ok(radius @ 1..=u8::MAX) => Ok(Sight::Radius(radius)),
        _ => Err(String::from("give a number from 1 to 255, or the word map")),
    }
}

impl MovingAiArgs {
    /// Plan for groups of robots, if requested.
    ///
    /// # Errors
    /// Those of [`Self::plan`].
    pub fn share(&self) -> Result<Option<GroupPlan>> {
        if !self.share {
            return Ok(None);
        }
        let (groups, losses) = (self.group.clone(), self.losses.clone());
        Ok(Some(GroupPlan { robots: self.plan()?, groups, losses, runs: self.runs, seed: self.seed }))
    }

    /// Converts the options to a plan.
    ///
    /// # Errors
    /// A file cannot be read, or the scenario belongs to another map.
    pub fn plan(&self) -> Result<Plan> {
        Ok(Plan {
            benchmark: Benchmark::load(&self.scen, self.map.as_deref())?,
            robots: Robots {
                sight: self.radius,
                memory: self.visits,
                learning: self.learned,
                // The sight determines the radius.
                params: self.route.params(1),
                replan: self.route.replan,
            },
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn radius_is_a_number_or_the_word_map() {
        assert_eq!(sight("5"), Ok(Sight::Radius(5)));
        assert_eq!(sight("255"), Ok(Sight::Radius(255)));
        assert_eq!(sight("map"), Ok(Sight::Map));
        for bad in ["0", "256", "-1", "Map", ""] {
            assert!(sight(bad).unwrap_err().contains("1 to 255"), "{bad}");
        }
    }
}
