//! The clock of run times: the CPU time of this thread.
//!
//! This time equals wall time on an idle machine, and excludes the time of other processes on a busy one.

use std::time::Duration;

/// Returns the CPU time of this thread since a fixed moment.
#[cfg(target_os = "linux")]
pub fn now() -> Duration {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    Duration::new(time.tv_sec.unsigned_abs(), time.tv_nsec as u32)
}

/// Returns the wall time since a fixed moment.
#[cfg(not(target_os = "linux"))]
pub fn now() -> Duration {
    static START: std::sync::OnceLock<std::time::Instant> = std::sync::OnceLock::new();
    START.get_or_init(std::time::Instant::now).elapsed()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Instant;

    #[cfg(target_os = "linux")]
    #[test]
    fn sleep_is_not_counted_and_work_is() {
        let (wall, start) = (Instant::now(), now());
        std::thread::sleep(Duration::from_millis(30));
        assert!(now() - start < wall.elapsed());
        let before = now();
        let mut sum = 0_u64;
        while now() == before {
            sum = std::hint::black_box(sum + 1);
        }
        assert!(now() > before);
    }
}
