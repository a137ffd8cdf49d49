//! `staya experiment flock`.

use crate::flock::Plan;
use crate::flock::closing::Closing;
use clap::Args;

/// c1 of alpha- and gamma-agents and the reference's speed, which the paper does not give, are the
/// best of those tried: A: 50 and 1. C: 10 and 0.2. D, E: 10, 200 (beta) and 2, with a reference
/// that moves at 3/7 d per second. B has no gains.
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
