//! `staya experiment movingai`.

use crate::movingai::{Benchmark, Learning, Memory, Plan, Robots, Sight};
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
