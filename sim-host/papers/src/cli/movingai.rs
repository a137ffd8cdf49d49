//! `staya experiment movingai`.

use super::params::RouteOptions;
use crate::movingai::{Benchmark, Memory, Report, Robots, Sight};
use anyhow::Result;
use clap::{Args, ValueEnum};
use staya_console::{Ended, Global, Progress, Stop, print, print_json};
use std::fmt::Write as _;
use std::path::PathBuf;

/// Size of the visit memory.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum MemoryArg {
    #[value(name = "16")]
    Cells16,
    #[value(name = "64")]
    Cells64,
    #[value(name = "256")]
    Cells256,
    #[value(name = "1024")]
    Cells1024,
}

impl From<MemoryArg> for Memory {
    fn from(memory: MemoryArg) -> Self {
        match memory {
            MemoryArg::Cells16 => Self::Cells16,
            MemoryArg::Cells64 => Self::Cells64,
            MemoryArg::Cells256 => Self::Cells256,
            MemoryArg::Cells1024 => Self::Cells1024,
        }
    }
}

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
    #[arg(long, value_enum, value_name = "CELLS", default_value = "64")]
    visits: MemoryArg,
    #[command(flatten)]
    route: RouteOptions,
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
    /// Runs the command.
    ///
    /// # Errors
    /// A file that cannot be read, a scenario of another map, a map too large to be seen at once.
    pub fn run(&self, global: &Global) -> Result<Ended> {
        let benchmark = Benchmark::load(&self.scen, self.map.as_deref())?;
        let stop = Stop::on_ctrl_c()?;
        let total = benchmark.queries.len() as u64;
        let mut progress = Progress::new("queries", total, global);
        let robots = Robots {
            sight: self.radius,
            memory: self.visits.into(),
            // The sight is the radius.
            params: self.route.params(1),
            replan: self.route.replan(),
        };
        let answers = benchmark.answer(&robots, |done| {
            progress.set(done as u64, String::new);
            !stop.is_requested()
        })?;
        progress.finish();
        let report = Report::of(&benchmark, &robots, &answers);
        if global.json {
            print_json(&report)?;
        } else {
            print(&table(&report)?)?;
        }
        Ok(Ended::by(&stop))
    }
}

fn table(report: &Report) -> Result<String, std::fmt::Error> {
    let mut text = String::new();
    let (width, height) = (report.width, report.height);
    writeln!(text, "{} ({width} x {height} cells)", report.map.display())?;
    let radius = report
        .radius
        .map_or_else(|| String::from("the whole map"), |r| format!("radius {r}"));
    writeln!(text, "  window                {radius}")?;
    writeln!(text, "  visit memory          {} cells", report.visits)?;
    let (answered, queries) = (report.answered, report.queries);
    writeln!(text, "  queries answered      {answered} of {queries}")?;
    writeln!(text, "  arrived               {}", report.arrived)?;
    if let Some(loss) = &report.loss_percent {
        writeln!(
            text,
            "  longer than optimal   {:.2} % on average, median {:.2} %, at most {:.2} %",
            loss.mean, loss.median, loss.max
        )?;
    }
    if let Some(error) = report.worst_price_error_percent {
        writeln!(
            text,
            "  optimal lengths       met within {error:.4} % for every query with a way"
        )?;
    }
    if let Some(without @ 1..) = report.without_price {
        writeln!(text, "  no way found          {without}")?;
    }
    Ok(text)
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
