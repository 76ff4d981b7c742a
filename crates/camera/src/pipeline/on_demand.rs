//! A lazily built value that survives `fork`. Within a process, one thread builds the value once while the
//! others wait, without a lock that a forked process could inherit. A child process inherits the memory but
//! not the thread that builds the value, so the child builds its own.

use std::{
    fmt, process,
    sync::{
        OnceLock,
        atomic::{AtomicU32, Ordering::Relaxed},
    },
    thread,
    time::Duration,
};

/// Number of nested forks, each during construction of the value, up to which no process has to wait for an
/// inherited construction.
const GENERATIONS: usize = 3;
/// Interval at which a waiting thread checks whether another thread has built the value.
const PAUSE: Duration = Duration::from_micros(100);

/// A lazily built value.
pub struct OnDemand<T> {
    attempts: [Attempt<T>; GENERATIONS],
    /// The value for processes of later generations, which wait for any inherited construction.
    last: OnceLock<T>,
}

/// A slot for the value, and the id of the only process that may fill the slot; 0 if unclaimed.
struct Attempt<T> {
    process: AtomicU32,
    /// The value; only one thread of that process sets it, so that no thread ever waits for this cell.
    value: OnceLock<T>,
}

impl<T> OnDemand<T> {
    /// Returns an empty cell.
    pub(crate) const fn new() -> Self {
        Self { attempts: [const { Attempt::new() }; GENERATIONS], last: OnceLock::new() }
    }

    /// Returns the value if it has been built.
    #[inline]
    pub fn get(&self) -> Option<&T> {
        let value = self.attempts.iter().find_map(|attempt| attempt.value.get());
        value.or_else(|| self.last.get())
    }

    /// Returns the value; calls `make` if the value has not been built.
    #[inline]
    pub fn get_or_make(&self, make: impl FnOnce() -> T) -> &T {
        self.get().unwrap_or_else(|| self.made(make))
    }

    #[cold]
    fn made(&self, make: impl FnOnce() -> T) -> &T {
        let own = process::id();
        for attempt in &self.attempts {
            loop {
                match attempt.process.compare_exchange(0, own, Relaxed, Relaxed) {
                    Ok(_) => return attempt.fill(make),
                    Err(process) if process == own => thread::sleep(PAUSE),
                    // The slot is claimed by the parent process, which was forked during construction.
                    Err(_) => break,
                }
                if let Some(value) = attempt.value.get() {
                    return value;
                }
            }
        }
        self.last.get_or_init(make)
    }
}

impl<T> Attempt<T> {
    const fn new() -> Self {
        Self { process: AtomicU32::new(0), value: OnceLock::new() }
    }

    /// Builds the value; only the thread that holds the claim calls this.
    fn fill(&self, make: impl FnOnce() -> T) -> &T {
        /// Releases the claim if this thread panics, so that another may try.
        struct Release<'a>(&'a AtomicU32);
        impl Drop for Release<'_> {
            fn drop(&mut self) {
                self.0.store(0, Relaxed);
            }
        }
        let release = Release(&self.process);
        let value = make();
        std::mem::forget(release);
        self.value.get_or_init(|| value)
    }
}

impl<T: Clone> Clone for OnDemand<T> {
    fn clone(&self) -> Self {
        let clone = Self::new();
        if let Some(value) = self.get() {
            clone.get_or_make(|| value.clone());
        }
        clone
    }
}

impl<T: fmt::Debug> fmt::Debug for OnDemand<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("OnDemand").field(&self.get()).finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::{
        panic::{AssertUnwindSafe, catch_unwind},
        sync::{Barrier, atomic::AtomicUsize},
    };

    #[test]
    fn one_of_many_threads_makes_it_and_all_have_it() {
        const THREADS: usize = 8;
        let (value, made, start) = (OnDemand::new(), AtomicUsize::new(0), Barrier::new(THREADS));
        thread::scope(|scope| {
            for _ in 0..THREADS {
                scope.spawn(|| {
                    start.wait();
                    let got = value.get_or_make(|| {
                        thread::sleep(Duration::from_millis(5));
                        made.fetch_add(1, Relaxed);
                        7
                    });
                    assert_eq!(*got, 7);
                });
            }
        });
        assert_eq!((made.into_inner(), value.get(), value.clone().get()), (1, Some(&7), Some(&7)));
    }

    #[test]
    fn a_thread_that_panics_leaves_it_to_the_next() {
        let value = OnDemand::new();
        assert!(catch_unwind(AssertUnwindSafe(|| value.get_or_make(|| panic!("not made")))).is_err());
        assert_eq!((value.get(), *value.get_or_make(|| 3), value.get()), (None, 3, Some(&3)));
    }

    #[test]
    fn what_other_processes_never_finished_is_made_anew() {
        for inherited in 0..=GENERATIONS {
            let value = OnDemand::new();
            for attempt in &value.attempts[..inherited] {
                attempt.process.store(process::id() + 1, Relaxed);
            }
            assert_eq!((value.get(), *value.get_or_make(|| 5), value.get()), (None, 5, Some(&5)));
        }
    }
}
