//! Time on a machine that others use too.

use jerboa_lib_render::host::clock::thread_time;

/// Seconds that this thread has run for: wall time tells little on a machine that is shared.
pub fn processor_time() -> f64 {
    thread_time().as_secs_f64()
}
