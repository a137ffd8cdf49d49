//! Parallel jobs, one per core, whose results are delivered as they finish.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// Executes the jobs `0..count` in order, on as many threads as rayon has here, at most `at_once`.
///
/// Surplus threads are available for parallel work inside jobs. `take` receives one result at a
/// time, as soon as it is available. After it returns `Break`, no further job starts, and jobs in
/// progress are finished and delivered, so that finished jobs form a prefix.
pub fn each<T: Send>(
    count: usize,
    at_once: usize,
    job: impl Fn(usize) -> T + Sync,
    take: impl FnMut(usize, T) -> ControlFlow<()> + Send,
) {
    let threads = rayon::current_num_threads();
    let workers = threads.min(count).min(at_once.max(1));
    let (next, is_over) = (AtomicUsize::new(0), AtomicBool::new(false));
    let take = Mutex::new(take);
    let work = || {
        // If its own pool cannot be created (out of memory), a job uses the slower global one.
        let inner = rayon::ThreadPoolBuilder::new().num_threads(threads / workers).use_current_thread();
        let _inner = inner.build();
        while !is_over.load(Ordering::Relaxed) {
            let index = next.fetch_add(1, Ordering::Relaxed);
            if index >= count {
                break;
            }
            let result = job(index);
            let mut take = take.lock().unwrap_or_else(PoisonError::into_inner);
            if take(index, result).is_break() {
                is_over.store(true, Ordering::Relaxed);
            }
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..workers {
            scope.spawn(work);
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    fn within<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads").install(work)
    }

    #[test]
    fn each_job_is_executed_and_delivered_once() {
        for (threads, count) in [(1, 0), (1, 5), (2, 1), (4, 1000), (8, 3)] {
            let mut seen = vec![0; count];
            within(threads, || {
                each(
                    count,
                    usize::MAX,
                    |index| 2 * index,
                    |index, double| {
                        assert_eq!(double, 2 * index);
                        seen[index] += 1;
                        ControlFlow::Continue(())
                    },
                );
            });
            assert!(seen.iter().all(|&times| times == 1), "{threads} {count}");
        }
    }

    #[test]
    fn finished_jobs_form_a_prefix_after_an_early_end() {
        for threads in [1, 2, 4] {
            let mut done = Vec::new();
            let take = |index, ()| {
                done.push(index);
                if done.len() < 10 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
            };
            within(threads, || each(1000, usize::MAX, |_| (), take));
            done.sort_unstable();
            assert!((10..10 + threads).contains(&done.len()), "{done:?}");
            assert_eq!(done, (0..done.len()).collect::<Vec<_>>());
        }
    }

    #[test]
    fn job_has_one_thread_unless_threads_outnumber_jobs() {
        for (threads, jobs, at_once, each_has) in
            [(4, 8, 8, 1), (4, 4, 4, 1), (4, 3, 8, 1), (4, 2, 8, 2), (4, 1, 8, 4), (4, 8, 1, 4), (4, 3, 2, 2)]
        {
            let mut inside = Vec::new();
            within(threads, || {
                each(
                    jobs,
                    at_once,
                    |_| rayon::current_num_threads(),
                    |_, n| {
                        inside.push(n);
                        ControlFlow::Continue(())
                    },
                );
            });
            assert_eq!(inside, vec![each_has; jobs]);
        }
    }
}
