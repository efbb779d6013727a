//! What is refused, in which words.

use jerboa_backend_spirv::{Budget, Grid, Options, Packing, emit};

use crate::{residual, try_single};

fn refused(text: &str) -> String {
    try_single(text).err().map(|e| e.to_string()).unwrap_or_else(|| panic!("it was emitted:\n{text}"))
}

#[test]
fn recursion_names_its_chain() {
    let text = "entry f = f
fun f(n: u32, return: fn(u32))
  jump even(n, return)
fun even(n: u32, return: fn(u32))
  m = sub n 1u
  jump odd(m, back)
  rest back(r: u32)
    jump return(r)
fun odd(n: u32, return: fn(u32))
  m = sub n 1u
  jump even(m, return)
";
    let expected = "kernel `f` recurses, which GPUs cannot: `even` calls `odd` calls `even`; unfold the recursion or write \
                    it as a loop";
    assert_eq!(refused(text), expected);
    // As its last act a function calls itself; that is no loop to naga.
    let text = "entry f = f\nfun f(n: u32, return: fn(u32))\n  m = sub n 1u\n  jump f(m, return)\n";
    assert!(refused(text).contains("`f` calls `f`; "), "{}", refused(text));
}

#[test]
fn fma_is_refused() {
    let text = "entry f = f\nfun f(x: f32, return: fn(f32))\n  y = fma x x x\n  jump return(y)\n";
    let expected = "kernel `f`: function `f` (?) has an `fma`, which SPIR-V does not promise to round once; write the \
                    product and the sum, or take a CPU device";
    assert_eq!(refused(text), expected);
}

#[test]
fn loops_of_two_entries_are_named() {
    let text = "entry f = f
fun f(c: bool, return: fn())
  branch c a b
  arm a()
    branch c b done
  arm b()
    branch c a done
  join done()
    jump return()
";
    let why = refused(text);
    assert!(why.starts_with("kernel `f`: function `f` has a loop with two entries, "), "{why}");
}

#[test]
fn entries_fit_the_grid() {
    let p = residual(
        "entry f = f\nfun f(x: f32, return: fn(f32))\n  jump return(x)\nentry g = g\nfun g(i: u32, return: fn(u32))\n  jump return(i)\n",
    );
    let why = |entry: &str| emit(&p, entry, &Options::default()).err().map(|e| e.to_string());
    assert_eq!(
        why("f").as_deref(),
        Some("kernel `f`: its first parameter is not the number of the invocation, a `u32`")
    );
    let expected = "kernel `g`: it returns values; many invocations have no one to return them to, so store them";
    assert_eq!(why("g").as_deref(), Some(expected));
    assert_eq!(why("h").as_deref(), Some("there is no kernel `h`; there is `f`, `g`"));
}

#[test]
fn packings_fit_the_program() {
    let mut text = String::new();
    for i in 0..8 {
        text += &format!("stream s{i} by rows\n  x: u32 bulk\n");
    }
    text += "table t by rows\n  x: u32 bulk\nentry f = f\nfun f(n: u32, return: fn(u32))\n  jump return(n)\n";
    let p = residual(&text);
    let why = |packing: &[u32]| {
        let options = Options { grid: Grid::Single, packing: Packing(packing.into()), ..Options::default() };
        emit(&p, "f", &options).err().map(|e| e.to_string()).unwrap_or_default()
    };
    let begin = "kernel `f`: the packing does not fit the program: ";
    for (packing, rest) in [
        (&[1][..], "it places 1 buffers of 9"),
        (&[1, 2, 3, 4, 5, 6, 7, 8, 1], "it uses storage buffer 8; a kernel has 8, the launch among them"),
        (&[0, 1, 1, 1, 1, 1, 1, 1, 2], "it puts `s0` into storage buffer 0, the launch"),
        (&[1, 1, 1, 1, 1, 1, 1, 1, 3], "storage buffer 2 is left out"),
        (&[1, 2, 2, 2, 2, 2, 2, 2, 2], "stream `s1` and table `t` share storage buffer 2"),
        (&[1, 2, 3, 4, 5, 6, 6, 6, 7], "with the launch and the results there are 9 storage buffers, not 8"),
    ] {
        assert_eq!(why(packing), format!("{begin}{rest}"));
    }
    assert_eq!(why(&[1, 2, 3, 4, 5, 5, 5, 5, 6]), "");
}

#[test]
fn large_kernels_say_how_large() {
    let sum = (0..200).fold(String::new(), |text, i| text + &format!("  y{} = mul y{i} y{i}\n", i + 1));
    let text = format!("entry f = f\nfun f(y0: f32, return: fn(f32))\n{sum}  jump return(y200)\n");
    let p = residual(&text);
    let options = |words: usize| Options { grid: Grid::Single, budget: Budget { words }, ..Options::default() };
    let words = emit(&p, "f", &options(usize::MAX)).unwrap().report().words;
    assert!(emit(&p, "f", &options(words)).is_ok());
    let why = emit(&p, "f", &options(words - 1)).err().map(|e| e.to_string()).unwrap_or_default();
    let expected = format!(
        "kernel `f` takes {words} words of SPIR-V (blocks: 1), more than the budget of {}: drivers' compile time grows \
         faster than the kernel; specialise less, split the kernel (the wavefront device has one per shader), or raise \
         the budget",
        words - 1
    );
    assert_eq!(why, expected);
}
