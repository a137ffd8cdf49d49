//! One world over ranks: processes, each with its robots, that together make the run that one process makes.
//!
//! The library is complete without MPI: [`ranks::Exchange`] is what connects ranks. The program `staya-mpi`, behind the feature
//! `mpi`, connects them by MPI.

pub mod ranks;
