//! What the first of many threads that ask for it makes, while the others wait: once in a process, and without a lock that
//! a forked process could inherit. That has the memory of the thread that makes it and not the thread, so it makes its own.

use std::{
    fmt, process,
    sync::{
        OnceLock,
        atomic::{AtomicU32, Ordering::Relaxed},
    },
    thread,
    time::Duration,
};

/// How often a process may be forked off one that was itself forked off, each while the value was made, without any wait.
const GENERATIONS: usize = 3;
/// Time between two looks at whether another thread has made the value.
const PAUSE: Duration = Duration::from_micros(100);

/// A value that is made on demand.
pub(crate) struct OnDemand<T> {
    attempts: [Attempt<T>; GENERATIONS],
    /// For processes of later generations, which wait for whatever they inherit.
    last: OnceLock<T>,
}

/// Room for the value, and the only process that may fill it, by its id; 0 for none yet.
struct Attempt<T> {
    process: AtomicU32,
    /// Filled by one thread of that process, so that no thread ever waits for it.
    value: OnceLock<T>,
}

impl<T> OnDemand<T> {
    /// Not made yet.
    pub const fn new() -> Self {
        Self { attempts: [const { Attempt::new() }; GENERATIONS], last: OnceLock::new() }
    }

    /// The value, where it has been made.
    #[inline]
    pub fn get(&self) -> Option<&T> {
        let value = self.attempts.iter().find_map(|attempt| attempt.value.get());
        value.or_else(|| self.last.get())
    }

    /// The value, made by `make` where it has not been.
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
                    // Of a process that this one was forked off, while the value was made there.
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

    /// Makes the value, for the one thread that may.
    fn fill(&self, make: impl FnOnce() -> T) -> &T {
        /// Where this thread panics, another may try.
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
