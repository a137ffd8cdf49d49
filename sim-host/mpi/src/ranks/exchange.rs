//! What ranks need of what connects them, and what they say through it.

use serde::Serialize;
use serde::de::DeserializeOwned;
use thiserror::Error;

/// Connects ranks: MPI, or channels between threads. All ranks call the same functions in the same order.
pub trait Exchange {
    /// The number of this rank, from 0.
    fn rank(&self) -> usize;

    /// How many there are.
    fn ranks(&self) -> usize;

    /// Tells everybody, and hears what everybody tells, by rank.
    ///
    /// # Errors
    /// Somebody is not there any more.
    fn gather(&mut self, own: Vec<u8>) -> Result<Vec<Vec<u8>>, Lost>;

    /// Sends to some, at most one message each, and hears from others, in the order of `from`. Each of those sends to this one in its
    /// own call. None of them is this rank.
    ///
    /// # Errors
    /// Somebody is not there any more.
    fn swap(&mut self, out: Vec<(usize, Vec<u8>)>, from: &[usize]) -> Result<Vec<Vec<u8>>, Lost>;
}

/// A rank that does not answer.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("rank {rank} {why}")]
pub struct Lost {
    /// Which.
    pub rank: usize,
    /// What is known of it.
    pub why: String,
}

/// Why ranks do not go on.
#[derive(Debug, Error)]
pub enum RankError {
    /// The robots cannot be placed.
    #[error(transparent)]
    Misplaced(#[from] staya_sim::world::Misplaced),
    /// A checkpoint that this run cannot go on from.
    #[error(transparent)]
    Restore(#[from] staya_sim::engine::StateError),
    /// There is not enough to share.
    #[error("{ranks} ranks cannot share {robots} robots: start at most {robots}")]
    TooMany {
        /// Ranks.
        ranks: usize,
        /// Robots.
        robots: usize,
    },
    /// Ranks know of no seam.
    #[error("{ranks} ranks cannot share a torus (plane.torus_m): start one, or leave it out")]
    Torus {
        /// Ranks.
        ranks: usize,
    },
    /// Ranks do not tell each other whom eyes see over their borders.
    #[error("{ranks} ranks cannot share robots with eyes (plane.eyes): start one, or leave it out")]
    Eyes {
        /// Ranks.
        ranks: usize,
    },
    /// Somebody is not there any more.
    #[error(transparent)]
    Lost(#[from] Lost),
    /// A message that cannot be read.
    #[error("rank {rank} sent {what} that cannot be read ({error}): start the same program on all ranks")]
    Garbled {
        /// Who sent it.
        rank: usize,
        /// What it should have been.
        what: &'static str,
        /// What is wrong with it.
        error: postcard::Error,
    },
    /// A robot's state does not fit.
    #[error(
        "robot {robot} came from rank {rank} in a state that does not fit ({error}): start the same program on all ranks"
    )]
    State {
        /// Which.
        robot: u32,
        /// Who sent it.
        rank: usize,
        /// What is wrong with it.
        error: String,
    },
}

/// What a rank has sent, bytes, over the run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, serde::Deserialize)]
pub struct Traffic {
    /// Ticks.
    pub ticks: u64,
    /// To its neighbours: packets and bodies near them, and moves that they had to know of.
    pub halo: u64,
    /// Robots that went to other ranks, with all that they know.
    pub moved: u64,
    /// How many robots those were.
    pub moved_robots: u64,
    /// To everybody: where its robots are, and sums.
    pub told: u64,
    /// To rank 0, for its records.
    pub recorded: u64,
    /// Rounds in which moves over borders were settled, beyond the first of each tick.
    pub rounds: u64,
    /// How often the world was cut anew.
    pub cuts: u64,
}

/// The bytes of a message.
pub(super) fn encode(message: &impl Serialize) -> Vec<u8> {
    postcard::to_stdvec(message).expect("memory takes every message")
}

/// A message of a rank.
pub(super) fn decode<T: DeserializeOwned>(rank: usize, what: &'static str, bytes: &[u8]) -> Result<T, RankError> {
    postcard::from_bytes(bytes).map_err(|error| RankError::Garbled { rank, what, error })
}
