//! Runs one scenario on several processes (ranks), with the results of a single process.
//!
//! The library works without MPI: the trait [`ranks::Exchange`] connects ranks. The program
//! `staya-mpi`, behind the feature `mpi`, connects them by MPI.

pub mod ranks;
