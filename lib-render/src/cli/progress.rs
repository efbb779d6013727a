//! A render watched: a bar on a terminal, and a limit of time.

use std::io::IsTerminal;
use std::sync::mpsc;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use crate::host::renderer::Handle;

/// How often the progress bar and the time limit are looked at.
const TICK: Duration = Duration::from_millis(20);

/// Runs `render`, with a progress bar over so many samples on a terminal, and cancels it when its time is up.
pub(super) fn with_progress<T: Send>(
    samples: u64,
    time_limit: Option<f32>,
    render: impl FnOnce(&Handle) -> T + Send,
) -> T {
    let handle = Handle::default();
    let deadline = time_limit.map(|s| Instant::now() + Duration::from_secs_f32(s));
    std::thread::scope(|scope| {
        let (done, finished) = mpsc::channel::<()>();
        let handle = &handle;
        scope.spawn(move || {
            let bar = std::io::stderr().is_terminal().then(|| progress_bar(samples));
            while finished.recv_timeout(TICK) == Err(mpsc::RecvTimeoutError::Timeout) {
                if let Some(bar) = &bar {
                    bar.set_position(handle.samples_done());
                }
                if deadline.is_some_and(|d| Instant::now() >= d) {
                    handle.cancel();
                }
            }
            if let Some(bar) = bar {
                bar.finish_and_clear();
            }
        });
        let result = render(handle);
        drop(done);
        result
    })
}

fn progress_bar(total: u64) -> ProgressBar {
    let style = ProgressStyle::with_template("{wide_bar} {percent}% {elapsed} (left {eta})");
    ProgressBar::new(total).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}
