//! `staya experiment goals`.

use crate::goals::Plan;
use crate::goals::tune::Tuning;
use clap::Args;

#[derive(Args, Clone, Debug)]
pub struct GoalsArgs {
    #[command(flatten)]
    pub plan: Plan,
    /// Instead, search gains and R_nbh with the lowest cost of --seeds runs for each scene.
    #[arg(long, conflicts_with_all = ["k1", "k2", "k3", "neighborhoods_m"])]
    tune: bool,
    /// Particles of the search.
    #[arg(long, default_value_t = 10, requires = "tune")]
    particles: u32,
    /// Moves of the particles: the search evaluates particles times (moves + 1) costs.
    #[arg(long, default_value_t = 12, requires = "tune")]
    moves: u32,
    /// Validation runs.
    #[arg(long, default_value_t = 20, requires = "tune")]
    judged: u32,
}

impl GoalsArgs {
    pub fn tuning(&self) -> Option<Tuning> {
        let &Self { particles, moves, judged, .. } = self;
        self.tune.then(|| Tuning { plan: self.plan.clone(), particles, moves, judged })
    }
}
