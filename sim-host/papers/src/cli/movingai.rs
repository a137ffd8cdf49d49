//! `staya experiment movingai`.

use crate::movingai::{Benchmark, Learning, Memory, Plan, Robots, Sight};
use crate::options::RouteOptions;
use anyhow::Result;
use clap::Args;
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
    /// Radius of the robot's window in cells, or "map": the robot sees everything, and the lengths that it
    /// finds are compared with the benchmark's optimal ones.
    #[arg(long, value_name = "CELLS|map", default_value = "5", value_parser = sight)]
    radius: Sight,
    /// How many visited cells the robot remembers, which gets it out of dead ends larger than its window.
    #[arg(long, value_name = "CELLS", default_value = "64", value_enum)]
    visits: Memory,
    /// For how many cells the robot learns what the way costs at least, while it comes no nearer to its goal; 0 leaves
    /// it the walls to follow.
    #[arg(long, value_name = "CELLS", default_value = "256", value_enum)]
    learned: Learning,
    #[command(flatten)]
    route: RouteOptions,
    /// Folder for the rows.
    #[arg(long, value_name = "DIR", default_value = "out/experiment-movingai")]
    pub out: PathBuf,
}

/// Reads a window radius.
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
    /// What is to be done.
    ///
    /// # Errors
    /// A file that cannot be read, a scenario of another map.
    pub fn plan(&self) -> Result<Plan> {
        Ok(Plan {
            benchmark: Benchmark::load(&self.scen, self.map.as_deref())?,
            robots: Robots {
                sight: self.radius,
                memory: self.visits,
                learning: self.learned,
                // The sight is the radius.
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
    fn radius_is_a_number_or_the_map() {
        assert_eq!(sight("5"), Ok(Sight::Radius(5)));
        assert_eq!(sight("255"), Ok(Sight::Radius(255)));
        assert_eq!(sight("map"), Ok(Sight::Map));
        for bad in ["0", "256", "-1", "Map", ""] {
            assert!(sight(bad).unwrap_err().contains("1 to 255"), "{bad}");
        }
    }
}
