//! Ranks as threads of one process, for tests and for use without MPI.

use super::exchange::{Exchange, Lost};
use std::sync::mpsc::{Receiver, Sender, channel};

/// A rank with a channel to each other one.
#[derive(Debug)]
pub struct Threads {
    rank: usize,
    to: Vec<Sender<Vec<u8>>>,
    from: Vec<Receiver<Vec<u8>>>,
}

impl Threads {
    /// Creates connected ranks.
    #[must_use]
    pub fn connected(ranks: usize) -> Vec<Self> {
        let mut all: Vec<_> = (0..ranks).map(|rank| Self { rank, to: Vec::new(), from: Vec::new() }).collect();
        for from in 0..ranks {
            for to in 0..ranks {
                let (sender, receiver) = channel();
                all[from].to.push(sender);
                all[to].from.push(receiver);
            }
        }
        all
    }

    fn hear(&self, rank: usize) -> Result<Vec<u8>, Lost> {
        self.from[rank].recv().map_err(|_| gone(rank))
    }
}

fn gone(rank: usize) -> Lost {
    Lost { rank, why: String::from("is gone") }
}

impl Exchange for Threads {
    fn rank(&self) -> usize {
        self.rank
    }

    fn ranks(&self) -> usize {
        self.to.len()
    }

    fn gather(&mut self, own: Vec<u8>) -> Result<Vec<Vec<u8>>, Lost> {
        for (rank, to) in self.to.iter().enumerate() {
            to.send(own.clone()).map_err(|_| gone(rank))?;
        }
        (0..self.from.len()).map(|rank| self.hear(rank)).collect()
    }

    fn swap(&mut self, out: Vec<(usize, Vec<u8>)>, from: &[usize]) -> Result<Vec<Vec<u8>>, Lost> {
        for (rank, bytes) in out {
            self.to[rank].send(bytes).map_err(|_| gone(rank))?;
        }
        from.iter().map(|&rank| self.hear(rank)).collect()
    }
}
