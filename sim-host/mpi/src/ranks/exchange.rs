//! Communication between ranks.

use serde::Serialize;
use serde::de::DeserializeOwned;
use thiserror::Error;

/// Connects ranks by MPI or channels. All ranks must call the same functions in the same order.
pub trait Exchange {
    /// Number of this rank, from 0.
    fn rank(&self) -> usize;

    /// Number of ranks.
    fn ranks(&self) -> usize;

    /// Sends `own` to all ranks. Returns the messages of all ranks, in order.
    ///
    /// # Errors
    /// A rank does not answer.
    fn gather(&mut self, own: Vec<u8>) -> Result<Vec<Vec<u8>>, Lost>;

    /// Sends at most one message to each rank in `out`, and receives one from each rank in `from`,
    /// in that order. Those ranks must send to this one in the same call, and this rank is in
    /// neither.
    ///
    /// # Errors
    /// A rank does not answer.
    fn swap(&mut self, out: Vec<(usize, Vec<u8>)>, from: &[usize]) -> Result<Vec<Vec<u8>>, Lost>;
}

/// A rank that does not answer.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("rank {rank} {why}")]
pub struct Lost {
    /// Its number.
    pub rank: usize,
    /// The reason, as far as known.
    pub why: String,
}

/// Why a run on ranks ends.
#[derive(Debug, Error)]
pub enum RankError {
    /// The robots cannot be placed.
    #[error(transparent)]
    Misplaced(#[from] staya_sim::world::Misplaced),
    /// The checkpoint does not fit this run.
    #[error(transparent)]
    Restore(#[from] staya_sim::engine::StateError),
    /// There are more ranks than robots.
    #[error("{ranks} ranks cannot share {robots} robots; start at most {robots} ranks")]
    TooMany {
        /// Number of ranks.
        ranks: usize,
        /// Number of robots.
        robots: usize,
    },
    /// Ranks do not support the wrap-around of a torus.
    #[error("{ranks} ranks cannot share a torus; start one rank, or remove plane.torus_m")]
    Torus {
        /// Number of ranks.
        ranks: usize,
    },
    /// Ranks do not exchange detections across their borders.
    #[error("{ranks} ranks cannot share robots with sensors; start one rank, or remove plane.sensing")]
    Sensing {
        /// Number of ranks.
        ranks: usize,
    },
    /// Ranks do not decide simultaneous moves.
    #[error("ranks cannot share robots that move at once; use `staya run`, or remove grid.simultaneous")]
    Simultaneous,
    /// A rank does not answer.
    #[error(transparent)]
    Lost(#[from] Lost),
    /// A message cannot be decoded.
    #[error("rank {rank} sent {what} that cannot be decoded ({error}); start the same program on all ranks")]
    Garbled {
        /// Sender.
        rank: usize,
        /// Kind of message.
        what: &'static str,
        /// Cause.
        error: postcard::Error,
    },
    /// The state of a robot cannot be restored.
    #[error(
        "robot {robot} arrived from rank {rank} with an incompatible state ({error}); start the same program on all ranks"
    )]
    State {
        /// Number of the robot.
        robot: u32,
        /// Sender.
        rank: usize,
        /// Cause.
        error: String,
    },
}

/// Bytes that a rank sent during the run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, serde::Deserialize)]
pub struct Traffic {
    /// Number of ticks.
    pub ticks: u64,
    /// Bytes to neighbours: packets, bodies and moves near their borders.
    pub halo: u64,
    /// Bytes of robots that moved to other ranks, with their whole state.
    pub moved: u64,
    /// Number of these robots.
    pub moved_robots: u64,
    /// Bytes to all ranks: regions and sums.
    pub told: u64,
    /// Bytes to rank 0 for its records.
    pub recorded: u64,
    /// Rounds of moves across borders, beyond the first of each tick.
    pub rounds: u64,
    /// Number of new divisions of the world.
    pub cuts: u64,
}

pub(super) fn encode(message: &impl Serialize) -> Vec<u8> {
    postcard::to_stdvec(message).expect("encoding to memory cannot fail")
}

pub(super) fn decode<T: DeserializeOwned>(rank: usize, what: &'static str, bytes: &[u8]) -> Result<T, RankError> {
    postcard::from_bytes(bytes).map_err(|error| RankError::Garbled { rank, what, error })
}
