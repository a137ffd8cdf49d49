//! The threads of this process.
//!
//! A process that is forked has the memory of its parent, but none of its threads: work handed to
//! the parent's pool would never be done. So each process has a pool of its own.

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::process;
use std::sync::{Arc, Mutex, PoisonError};

/// The pool, with the id of its process.
static POOL: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// Does work on the threads of this process, without the interpreter lock.
pub(crate) fn detached<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> PyResult<T> {
    let pool = own()?;
    Ok(py.detach(|| pool.install(work)))
}

/// The pool of this process. A fork takes place with the interpreter lock, which the caller has, so
/// no other thread has this lock then.
fn own() -> PyResult<Arc<ThreadPool>> {
    let mut slot = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((id, pool)) = &*slot
        && *id == process::id()
    {
        return Ok(Arc::clone(pool));
    }
    let pool = ThreadPoolBuilder::new().build().map_err(|error| {
        let what = format!("cannot start threads: {error}; start worker processes with the method \"spawn\"");
        PyRuntimeError::new_err(what)
    })?;
    let pool = Arc::new(pool);
    // The parent's pool waits for threads that are not here when it is dropped.
    std::mem::forget(slot.replace((process::id(), Arc::clone(&pool))));
    Ok(pool)
}
