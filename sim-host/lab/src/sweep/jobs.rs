//! Jobs done in parallel, each on a core of its own, and handed over as they come to an end.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// Does the jobs `0..count`, as many at once as rayon has threads here, and not more than `at_once`.
///
/// Jobs are begun in order, by threads that each have a scratch memory; a job must not depend on what that holds. What is
/// parallel inside of a job shares the threads that there are too many for jobs, usually none. `take` gets each result
/// as soon as it is there, one at a time. When it breaks, no further job is begun; those under way are finished and
/// handed over, so that what is done is always a beginning of the whole.
pub fn each<S: Default, T: Send>(
    count: usize,
    at_once: usize,
    job: impl Fn(&mut S, usize) -> T + Sync,
    take: impl FnMut(usize, T) -> ControlFlow<()> + Send,
) {
    let threads = rayon::current_num_threads();
    let workers = threads.min(count).min(at_once.max(1));
    let (next, is_over) = (AtomicUsize::new(0), AtomicBool::new(false));
    let take = Mutex::new(take);
    let work = || {
        // Without a pool of its own (there is no memory for it) a job uses the one of all: slower, and right.
        let inner = rayon::ThreadPoolBuilder::new().num_threads(threads / workers).use_current_thread();
        let _inner = inner.build();
        let mut scratch = S::default();
        while !is_over.load(Ordering::Relaxed) {
            let index = next.fetch_add(1, Ordering::Relaxed);
            if index >= count {
                break;
            }
            let result = job(&mut scratch, index);
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
    fn each_job_is_done_once_and_handed_over() {
        for (threads, count) in [(1, 0), (1, 5), (2, 1), (4, 1000), (8, 3)] {
            let mut seen = vec![0; count];
            within(threads, || {
                each(
                    count,
                    usize::MAX,
                    |(): &mut (), index| 2 * index,
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
    fn what_is_done_at_an_early_end_is_a_beginning() {
        for threads in [1, 2, 4] {
            let mut done = Vec::new();
            let take = |index, ()| {
                done.push(index);
                if done.len() < 10 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
            };
            within(threads, || each(1000, usize::MAX, |(): &mut (), _| (), take));
            done.sort_unstable();
            assert!((10..10 + threads).contains(&done.len()), "{done:?}");
            assert_eq!(done, (0..done.len()).collect::<Vec<_>>());
        }
    }

    #[test]
    fn a_job_has_one_thread_unless_there_are_too_many_for_jobs() {
        for (threads, jobs, at_once, each_has) in
            [(4, 8, 8, 1), (4, 4, 4, 1), (4, 3, 8, 1), (4, 2, 8, 2), (4, 1, 8, 4), (4, 8, 1, 4), (4, 3, 2, 2)]
        {
            let mut inside = Vec::new();
            within(threads, || {
                each(
                    jobs,
                    at_once,
                    |(): &mut (), _| rayon::current_num_threads(),
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
