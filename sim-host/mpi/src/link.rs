//! Connects ranks by MPI. The main thread makes all MPI calls, and the run has its own thread, so
//! that it receives signals even while MPI waits for a dead rank.

use mpi::datatype::PartitionMut;
use mpi::request::{WaitGuard, scope};
use mpi::topology::SimpleCommunicator;
use mpi::traits::{Communicator as _, CommunicatorCollectives as _, Destination as _, Source as _};
use staya_console::Stop;
use staya_mpi::ranks::{Exchange, Lost};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::{Duration, Instant};

/// Time between a signal and giving up on silent ranks; mpirun kills a second after its signal.
const PATIENCE: Duration = Duration::from_millis(300);

pub enum Call {
    Gather(Vec<u8>),
    Swap(Vec<(usize, Vec<u8>)>, Vec<usize>),
}

/// The end of the link in the run's thread.
pub struct Link {
    rank: usize,
    ranks: usize,
    calls: Sender<Call>,
    answers: Receiver<Vec<Vec<u8>>>,
    stop: Stop,
}

/// The end of the link in the main thread.
pub struct Server {
    world: SimpleCommunicator,
    calls: Receiver<Call>,
    answers: Sender<Vec<Vec<u8>>>,
}

pub fn connect(world: SimpleCommunicator, stop: Stop) -> (Link, Server) {
    let (calls, called) = channel();
    let (answers, answered) = channel();
    let number = |number: i32| usize::try_from(number).unwrap_or_default();
    let (rank, ranks) = (number(world.rank()), number(world.size()));
    (Link { rank, ranks, calls, answers: answered, stop }, Server { world, calls: called, answers })
}

impl Link {
    /// `whom`: the ranks that must answer.
    fn call(&self, call: Call, whom: &[usize]) -> Result<Vec<Vec<u8>>, Lost> {
        let lost = || {
            let others = (0..self.ranks).filter(|&rank| rank != self.rank);
            let rank = whom.first().copied().or(others.into_iter().next()).unwrap_or_default();
            let among = if whom.len() > 1 { "(or another rank) " } else { "" };
            Lost { rank, why: format!("{among}did not answer before this run was stopped; see the messages of mpirun") }
        };
        self.calls.send(call).map_err(|_| lost())?;
        let mut told = None;
        loop {
            match self.answers.recv_timeout(Duration::from_millis(50)) {
                Ok(answer) => return Ok(answer),
                Err(RecvTimeoutError::Disconnected) => return Err(lost()),
                Err(RecvTimeoutError::Timeout) if self.stop.is_requested() => {
                    if told.get_or_insert_with(Instant::now).elapsed() > PATIENCE {
                        return Err(lost());
                    }
                }
                Err(RecvTimeoutError::Timeout) => {}
            }
        }
    }
}

impl Exchange for Link {
    fn rank(&self) -> usize {
        self.rank
    }

    fn ranks(&self) -> usize {
        self.ranks
    }

    fn gather(&mut self, own: Vec<u8>) -> Result<Vec<Vec<u8>>, Lost> {
        let others: Vec<_> = (0..self.ranks).filter(|&rank| rank != self.rank).collect();
        self.call(Call::Gather(own), &others)
    }

    fn swap(&mut self, out: Vec<(usize, Vec<u8>)>, from: &[usize]) -> Result<Vec<Vec<u8>>, Lost> {
        if out.is_empty() && from.is_empty() {
            return Ok(Vec::new());
        }
        self.call(Call::Swap(out, from.to_vec()), from)
    }
}

impl Server {
    pub fn serve(self) {
        while let Ok(call) = self.calls.recv() {
            let answer = match call {
                Call::Gather(own) => self.gather(&own),
                Call::Swap(out, from) => self.swap(&out, &from),
            };
            if self.answers.send(answer).is_err() {
                return;
            }
        }
    }

    fn gather(&self, own: &[u8]) -> Vec<Vec<u8>> {
        // A byte in front, because OpenMPI takes the address of an empty buffer for MPI_IN_PLACE.
        let own = &[&[0], own].concat()[..];
        let ranks = usize::try_from(self.world.size()).unwrap_or_default();
        let mut lengths = vec![0_i32; ranks];
        let length = i32::try_from(own.len()).expect("broadcast messages are short");
        self.world.all_gather_into(&length, &mut lengths[..]);
        let starts = lengths.iter().scan(0, |end, &length| {
            let start = *end;
            *end += length;
            Some(start)
        });
        let starts: Vec<i32> = starts.collect();
        let size = |length: i32| usize::try_from(length).unwrap_or_default();
        let mut all = vec![0_u8; lengths.iter().map(|&length| size(length)).sum()];
        self.world.all_gather_varcount_into(own, &mut PartitionMut::new(&mut all[..], &lengths[..], &starts[..]));
        let parts = starts.iter().zip(&lengths);
        parts.map(|(&start, &length)| all[size(start) + 1..size(start + length)].to_vec()).collect()
    }

    fn swap(&self, out: &[(usize, Vec<u8>)], from: &[usize]) -> Vec<Vec<u8>> {
        let at = |rank: usize| self.world.process_at_rank(i32::try_from(rank).unwrap_or(i32::MAX));
        scope(|scope| {
            let sends = out.iter().map(|(rank, bytes)| at(*rank).immediate_send(scope, &bytes[..]));
            let _waits: Vec<_> = sends.map(WaitGuard::from).collect();
            from.iter().map(|&rank| at(rank).receive_vec::<u8>().0).collect()
        })
    }
}
