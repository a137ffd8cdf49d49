//! Communication of a rank with traffic counters.

use super::exchange::{Exchange, RankError, Traffic, decode, encode};
use super::ground::Talk;
use super::region::Region;

pub(super) struct Wire<'a> {
    pub(super) exchange: &'a mut dyn Exchange,
    pub(super) regions: Vec<Region>,
    neighbors: Vec<usize>,
    pub(super) traffic: Traffic,
}

impl<'a> Wire<'a> {
    pub(super) fn new(exchange: &'a mut dyn Exchange) -> Self {
        Self { exchange, regions: Vec::new(), neighbors: Vec::new(), traffic: Traffic::default() }
    }

    pub(super) fn rank(&self) -> usize {
        self.exchange.rank()
    }

    pub(super) fn gather(&mut self, own: Vec<u8>) -> Result<Vec<Vec<u8>>, RankError> {
        self.traffic.told += own.len() as u64;
        Ok(self.exchange.gather(own)?)
    }

    pub(super) fn choose(&mut self, is_beside: impl Fn(&Region, &Region) -> bool) {
        let own = self.rank();
        let others = (0..self.regions.len()).filter(|&rank| rank != own);
        self.neighbors = others.filter(|&rank| is_beside(&self.regions[own], &self.regions[rank])).collect();
    }

    pub(super) fn halo(&mut self, message: impl Fn(&Region) -> Vec<u8>) -> Result<Vec<(usize, Vec<u8>)>, RankError> {
        let out: Vec<_> = self.neighbors.iter().map(|&rank| (rank, message(&self.regions[rank]))).collect();
        self.traffic.halo += out.iter().map(|(_, bytes)| bytes.len() as u64).sum::<u64>();
        let heard = self.exchange.swap(out, &self.neighbors)?;
        Ok(self.neighbors.iter().copied().zip(heard).collect())
    }

    /// Sends to rank 0, which returns all messages; other ranks return none.
    pub(super) fn gather_first(&mut self, own: Vec<u8>) -> Result<Vec<Vec<u8>>, RankError> {
        if self.rank() > 0 {
            self.traffic.recorded += own.len() as u64;
            self.exchange.swap(vec![(0, own)], &[])?;
            return Ok(Vec::new());
        }
        let others: Vec<_> = (1..self.exchange.ranks()).collect();
        let heard = self.exchange.swap(Vec::new(), &others)?;
        Ok(std::iter::once(own).chain(heard).collect())
    }
}

impl Talk for Wire<'_> {
    fn sum(&mut self, own: u64) -> Result<u64, RankError> {
        let all = self.gather(encode(&own))?;
        let all = all.iter().enumerate().map(|(rank, bytes)| decode::<u64>(rank, "a number", bytes));
        let sum = all.sum::<Result<u64, _>>()?;
        self.traffic.rounds += u64::from(sum > 0);
        Ok(sum)
    }

    fn swap(&mut self, message: &dyn Fn(&Region) -> Vec<u8>) -> Result<Vec<(usize, Vec<u8>)>, RankError> {
        self.halo(message)
    }
}
