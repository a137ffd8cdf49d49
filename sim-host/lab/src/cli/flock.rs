//! `staya experiment flock`.

use crate::flock::Plan;
use crate::flock::closing::Closing;
use clap::Args;

#[derive(Args, Clone, Debug)]
pub struct FlockArgs {
    #[command(flatten)]
    pub plan: Plan,
    /// Instead, drive flocks at each other, without and with ORCA: overlaps and gaps by speed.
    #[arg(
        long,
        conflicts_with_all = ["cases", "robots", "safety", "horizon_s", "seconds", "c_alpha", "c_beta", "c_gamma", "c2_alpha", "c2_gamma", "obstacle_ratio", "references", "rest", "takes_turns", "gap", "ideal", "loss"]
    )]
    closing: bool,
    /// Closing speeds, spacings per second.
    #[arg(long, value_name = "SPEED,...", value_delimiter = ',', default_value = "1,2,4,8", requires = "closing")]
    speeds: Vec<f64>,
}

impl FlockArgs {
    pub fn closing(&self) -> Option<Closing> {
        self.closing.then(|| Closing {
            speeds: self.speeds.clone(),
            runs: self.plan.runs,
            spacing_m: self.plan.spacing_m,
            step_s: self.plan.step_s,
            seed: self.plan.seed,
        })
    }
}
