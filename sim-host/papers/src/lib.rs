//! Experiments: papers and benchmarks, run again.
//!
//! | module | paper |
//! | --- | --- |
//! | [`route`] | A. V. Kuznetsov 2017 (KUZ), section 5: windowed routing against the global optimum on random land |
//! | [`formation`] | KUZ, section 8: six robots in formation |
//! | [`movingai`] | N. Sturtevant 2012: the queries of the Moving AI benchmark |
//! | [`crossing`] | van den Berg et al. 2011 (ORCA): swaps over a circle, and doorways |
//! | [`orca`] | Tolok et al. (FVM): looked-up half-planes against the exact ones |
//! | [`flock`] | R. Olfati-Saber 2006 (OLF), section VIII: the five simulations |
//! | [`goals`] | V. E. Pavlovsky and V. V. Pavlovsky (PAV): a group on its way to three goals |
//! | [`boids`] | V. A. Starovoitova 2018 (STA), section 2.3: boids on a torus, and what finding neighbours costs |
//!
//! An experiment is a plan with a check, a function that runs it (in parallel, with the same result on any number of
//! threads; stopped early, it keeps whole runs) and a report that can be serialised.

mod arena;
pub mod boids;
pub mod cli;
pub mod crossing;
pub mod flock;
pub mod formation;
pub mod goals;
pub mod movingai;
pub mod optimal;
pub mod orca;
pub mod route;
pub mod stats;
pub mod walk;

use rayon::prelude::*;

/// Largest number of landscapes per point: some hundred megabytes of results.
pub(crate) const MAX_RUNS: u32 = 1_000_000;

/// Does the jobs `0..count` in parallel, each with a scratch memory that earlier jobs have used, and returns
/// their results in order.
///
/// `progress` is told how many are done, after each `batch` jobs per thread (some tenths of a second of work); when it
/// answers `false`, what is done so far is returned, which is always a beginning of the whole. A job must not depend on what its scratch memory holds.
///
/// # Errors
/// That of the first job that fails.
pub(crate) fn in_parallel<S: Default + Send, T: Send, E: Send>(
    count: usize,
    batch: usize,
    mut progress: impl FnMut(usize) -> bool,
    job: impl Fn(&mut S, usize) -> Result<T, E> + Sync,
) -> Result<Vec<T>, E> {
    let at_once = batch * rayon::current_num_threads();
    let mut done = Vec::new();
    while done.len() < count && progress(done.len()) {
        let jobs = done.len()..(done.len() + at_once).min(count);
        let results = jobs
            .into_par_iter()
            // Neighbours share a scratch memory.
            .with_min_len(batch.div_ceil(8))
            .map_init(S::default, &job);
        done.extend(results.collect::<Result<Vec<T>, E>>()?);
    }
    Ok(done)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn jobs_come_back_in_order_and_stop_between_batches() {
        let double = |(): &mut (), job| Ok::<_, ()>(2 * job);
        let all = in_parallel(1000, 16, |_| true, double).unwrap();
        assert_eq!(all, (0..1000).map(|job| 2 * job).collect::<Vec<_>>());
        let at_once = 3 * rayon::current_num_threads();
        let some = in_parallel(3 * at_once, 3, |done| done <= at_once, double).unwrap();
        assert_eq!(some.len(), 2 * at_once);
        assert!(some.iter().zip(0..).all(|(result, job)| *result == 2 * job));
        let none = in_parallel(1000, 16, |_| false, double).unwrap();
        assert!(none.is_empty());
    }

    #[test]
    fn failure_of_a_job_is_the_result() {
        let job = |(): &mut (), job| if job == 300 { Err(job) } else { Ok(()) };
        assert_eq!(in_parallel(1000, 16, |_| true, job), Err(300));
    }
}
