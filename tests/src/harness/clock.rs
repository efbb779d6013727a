//! Time on a machine that others use too.

use std::sync::LazyLock;
use std::time::Instant;

/// Seconds that this thread has run for: wall time tells little on a machine that is shared. Linux counts it in nanoseconds;
/// elsewhere it is wall time.
pub fn processor_time() -> f64 {
    static START: LazyLock<Instant> = LazyLock::new(Instant::now);
    let counted = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let nanoseconds = counted.and_then(|s| s.split(' ').next()?.parse::<f64>().ok());
    nanoseconds.map_or_else(|| START.elapsed().as_secs_f64(), |t| 1e-9 * t)
}
