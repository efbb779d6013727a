//! The clock of measurements: time that a thread has run for, which another process beside it hardly disturbs.

use std::time::Duration;

/// Time that this thread has run for, to the nanosecond. A call takes a fraction of a microsecond.
#[cfg(unix)]
pub fn thread_time() -> Duration {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    Duration::new(time.tv_sec as u64, time.tv_nsec as u32)
}

/// Wall time, where no clock of threads is known.
#[cfg(not(unix))]
pub fn thread_time() -> Duration {
    static START: std::sync::LazyLock<std::time::Instant> = std::sync::LazyLock::new(std::time::Instant::now);
    START.elapsed()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_takes_time_and_sleep_does_not() {
        let start = thread_time();
        std::thread::sleep(Duration::from_millis(200));
        let slept = thread_time();
        let mut sum = 0_u64;
        while thread_time() < slept + Duration::from_millis(2) {
            sum = std::hint::black_box(sum + 1);
        }
        assert!(sum > 0);
        assert!(!cfg!(unix) || slept - start < Duration::from_millis(200), "the clock went on in sleep");
    }
}
