//! A panic of another crate as an error.

use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind, set_hook, take_hook};
use std::sync::Once;

thread_local! {
    static QUIET: Cell<bool> = const { Cell::new(false) };
}

/// What `work` returns, or the words of its panic, which the panic hook does not get to see: the process goes on, so nobody
/// should read that it failed. `work` must leave nothing half done that is used after a panic.
pub(super) fn quietly<T>(work: impl FnOnce() -> T) -> Result<T, String> {
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        let told = take_hook();
        set_hook(Box::new(move |panic| {
            if !QUIET.get() {
                told(panic);
            }
        }));
    });
    let before = QUIET.replace(true);
    let done = catch_unwind(AssertUnwindSafe(work));
    QUIET.set(before);
    done.map_err(|panic| {
        let text = panic.downcast_ref::<String>().map(String::as_str).or(panic.downcast_ref::<&str>().copied());
        text.unwrap_or("it panicked").to_owned()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_is_an_error_and_work_is_its_value() {
        assert_eq!(quietly(|| 7), Ok(7));
        assert_eq!(quietly(|| -> u32 { panic!("lost") }), Err("lost".into()));
        assert_eq!(quietly(|| -> u32 { panic!("lost at {}", 3) }), Err("lost at 3".into()));
        assert!(!QUIET.get());
    }
}
