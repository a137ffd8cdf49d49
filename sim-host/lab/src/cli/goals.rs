//! `staya experiment goals`.

use crate::goals::Plan;
use crate::goals::tune::Tuning;
use clap::Args;

/// The goal flock of Pavlovsky and Pavlovsky, 225 robots and three goals, group order over K1 / K2
/// and R_nbh.
///
/// All lists are crossed with each other; a further table has the K1 / K2 from which on robots are
/// no longer a group.
#[derive(Args, Clone, Debug)]
pub struct GoalsArgs {
    #[command(flatten)]
    pub plan: Plan,
    /// Instead, search K2 / K1, K3 / K1 and R_nbh for each scene: those whose --seeds runs cost
    /// least, judged on other runs.
    #[arg(long, conflicts_with_all = ["k1", "k2", "k3", "neighborhoods_m"])]
    tune: bool,
    /// Particles of the search.
    #[arg(long, default_value_t = 10, requires = "tune")]
    particles: u32,
    /// Moves of its swarm: it asks for particles times moves + 1 costs.
    #[arg(long, default_value_t = 12, requires = "tune")]
    moves: u32,
    /// Runs that judge what it found.
    #[arg(long, default_value_t = 20, requires = "tune")]
    judged: u32,
}

impl GoalsArgs {
    /// Plan of the search for gains, if requested.
    pub fn tuning(&self) -> Option<Tuning> {
        let &Self { particles, moves, judged, .. } = self;
        self.tune.then(|| Tuning { plan: self.plan.clone(), particles, moves, judged })
    }
}
