//! Code memory is freed with its owner. Alone in its process, because it looks at the process's memory.

use jerboa_backend_cranelift::{Options, Status, compile};

/// Pages of this process that are in memory, where the system tells.
fn resident() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/self/statm").ok()?;
    text.split(' ').nth(1)?.parse().ok()
}

#[test]
fn a_thousand_programs_come_and_go() {
    let text = "jerboa-ir 1
entry f = f
fun f(x: u32, return: fn(u32))
  y = mul x x
  jump return(y)
";
    let p = jerboa_ir::parse(text).expect("it is a program");
    let once = || {
        let code = compile(&[&p], &Options::default()).expect("it is a residual");
        let mut y = [0];
        // SAFETY: the kernel touches no buffer.
        let status = unsafe { code.kernel("f").expect("it is an entry").call(&[], &[7], &mut y) };
        assert_eq!((status, y), (Status::Done, [49]));
    };
    (0..200).for_each(|_| once());
    let before = resident();
    (0..1000).for_each(|_| once());
    // Code that stays would take 1,000 pages at least.
    let grown = resident().zip(before).map_or(0, |(after, before)| after.saturating_sub(before));
    assert!(grown < 250, "{grown} pages more after 1,000 programs");
}
