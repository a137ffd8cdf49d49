//! `staya experiment movingai`.

use crate::movingai::{Benchmark, GroupPlan, Learning, Memory, Plan, Robots, Sight};
use anyhow::Result;
use clap::Args;
use staya_console::options::RouteOptions;
use std::path::PathBuf;

#[derive(Args, Clone, Debug)]
#[command(allow_negative_numbers = true)]
pub struct MovingAiArgs {
    /// Scenario (.scen); its map is expected in the same folder.
    scen: PathBuf,
    /// Map, if it is elsewhere or has another name than in the scenario.
    #[arg(long, value_name = "FILE")]
    map: Option<PathBuf>,
    /// Radius of the robot's window in cells, or "map" for the whole map.
    #[arg(long, value_name = "CELLS|map", default_value = "5", value_parser = sight)]
    radius: Sight,
    /// Visited cells that the robot remembers, to leave dead ends larger than its window.
    #[arg(long, value_name = "CELLS", default_value = "64", value_enum)]
    visits: Memory,
    /// Cells with learned travel costs, used while the robot comes no nearer; 0: walls only.
    #[arg(long, value_name = "CELLS", default_value = "256", value_enum)]
    learned: Learning,
    #[command(flatten)]
    route: RouteOptions,
    /// Instead, run groups with and without shared maps; results go to the folder's `share`.
    #[arg(long, conflicts_with_all = ["visits", "learned", "replan", "exit"])]
    share: bool,
    /// Robots per group.
    #[arg(long, value_name = "ROBOTS,...", value_delimiter = ',', default_value = "6,20", requires = "share")]
    group: Vec<u32>,
    /// Losses of packets, 0 to 1.
    #[arg(long, value_name = "LOSS,...", value_delimiter = ',', default_value = "0,0.3,0.6", requires = "share")]
    losses: Vec<f64>,
    /// Groups of each size.
    #[arg(long, default_value_t = 50, requires = "share")]
    runs: u32,
    /// Seed; equal seeds give equal results. Shared maps were developed on seed 1.
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
    pub fn share(&self) -> Result<Option<GroupPlan>> {
        if !self.share {
            return Ok(None);
        }
        let (groups, losses) = (self.group.clone(), self.losses.clone());
        Ok(Some(GroupPlan { robots: self.plan()?, groups, losses, runs: self.runs, seed: self.seed }))
    }

    pub fn plan(&self) -> Result<Plan> {
        Ok(Plan {
            benchmark: Benchmark::load(&self.scen, self.map.as_deref())?,
            robots: Robots {
                sight: self.radius,
                memory: self.visits,
                learning: self.learned,
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
