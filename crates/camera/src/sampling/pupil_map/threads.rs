//! Processing of several items in parallel on the processor's cores.

use std::{
    iter,
    num::NonZero,
    panic::resume_unwind,
    process,
    sync::atomic::{AtomicU32, AtomicUsize, Ordering::Relaxed},
    thread,
};

/// Applies a function to each item and returns the results in order. The calling thread takes part; it does
/// all of the work if the system provides no other thread or if the process was forked.
///
/// The threads have the standard library's default stack size, because building a table takes more than half
/// a megabyte of stack without optimisation and with AVX-512.
pub fn made_of_each<'a, T: Sync, R: Send>(items: &'a [T], make: impl Fn(&'a T) -> R + Sync) -> Vec<R> {
    let next = AtomicUsize::new(0);
    let take_turns = || -> Vec<(usize, R)> {
        let one = || {
            let number = next.fetch_add(1, Relaxed);
            Some((number, make(items.get(number)?)))
        };
        iter::from_fn(one).collect()
    };
    let cores =
        if may_create_threads() { thread::available_parallelism().map_or(1, NonZero::get) } else { 1 };
    let others = cores.min(items.len()).saturating_sub(1);
    let mut made = thread::scope(|scope| {
        let spawn = |_| thread::Builder::new().spawn_scoped(scope, take_turns).ok();
        let threads: Vec<_> = (0..others).map_while(spawn).collect();
        let mut made = take_turns();
        for thread in threads {
            made.extend(thread.join().unwrap_or_else(|panic| resume_unwind(panic)));
        }
        made
    });
    made.sort_by_key(|(number, _)| *number);
    made.into_iter().map(|(_, made)| made).collect()
}

/// Whether this process is the first that called this function. A forked process must not create threads:
/// locks of the C library that other threads held during the fork stay locked, and POSIX allows such a
/// process only the functions that a signal handler may call.
fn may_create_threads() -> bool {
    static FIRST: AtomicU32 = AtomicU32::new(0);
    let own = process::id();
    FIRST.compare_exchange(0, own, Relaxed, Relaxed).map_or_else(|first| first == own, |_| true)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::panic::{AssertUnwindSafe, catch_unwind};

    #[test]
    fn results_are_in_order_whichever_thread_made_them() {
        let items: Vec<usize> = (0..100).collect();
        let slowly = |&number: &usize| {
            thread::sleep(std::time::Duration::from_micros((number * 37 % 100) as u64));
            2 * number
        };
        assert_eq!(made_of_each(&items, slowly), (0..100).map(|number| 2 * number).collect::<Vec<_>>());
        assert_eq!(made_of_each(&items[..0], slowly), Vec::<usize>::new());
    }

    #[test]
    fn a_panic_of_any_thread_is_the_callers() {
        let items: Vec<usize> = (0..20).collect();
        for bad in [0, 7, 19] {
            let make = |&number: &usize| assert_ne!(number, bad);
            assert!(catch_unwind(AssertUnwindSafe(|| made_of_each(&items, make))).is_err());
        }
    }
}
