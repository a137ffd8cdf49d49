//! Runs one scenario on several processes (ranks), with the results of a single process.
//!
//! The trait [`ranks::Exchange`] connects ranks; the program `staya-mpi` (feature `mpi`) uses MPI.

pub mod ranks;
