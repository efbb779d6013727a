//! Each kind of step, and the exits that need more than one.

use crate::{count, residual, single, validate};
use jerboa_backend_spirv::{Options, emit};

/// A function whose blocks go on in others as written, `a b, c` on a parameter; it returns which way it went.
fn graph(lines: &[&str]) -> String {
    let mut text = "entry f = f\nfun f(c: bool, d: bool, return: fn(u32))\n".to_owned();
    for (i, line) in lines.iter().enumerate() {
        let (name, succs) = line.split_once(' ').unwrap_or((line, ""));
        if i > 0 {
            text += &format!("  rest {name}()\n");
        }
        let cond = if i % 2 == 0 { "c" } else { "d" };
        text += &match succs.split(' ').collect::<Vec<_>>()[..] {
            [a, b] => format!("  branch {cond} {a} {b}\n"),
            [""] => format!("  jump return({i}u)\n"),
            [a] => format!("  jump {a}()\n"),
            _ => unreachable!("two at most"),
        };
    }
    text
}

#[test]
fn choices_need_no_frames() {
    for lines in [
        &["f a b", "a j", "b j", "j"][..],
        &["f a j", "a j", "j"],
        &["f a b", "a", "b j k", "j k", "k"],
        &["f a a", "a"],
    ] {
        let module = single(&graph(lines));
        assert_eq!((count(&module, "switch"), count(&module, "loop")), (0, 0), "{}", module.naga());
    }
}

#[test]
fn an_exit_past_a_join_is_one_switch() {
    let module = single(&graph(&["f a b", "a j k", "b j", "j k", "k"]));
    assert_eq!((count(&module, "switch"), count(&module, "exit")), (1, 0), "{}", module.naga());
}

#[test]
fn the_end_of_a_loop_needs_no_label() {
    let module = single(&graph(&["f o", "o i e", "i o e", "e"]));
    assert_eq!((count(&module, "switch"), count(&module, "exit = ")), (0, 0), "{}", module.naga());
    // Out of two loops at once, and back to the outer one from the inner one: each by what stands behind the inner loop, but
    // for one that hops.
    let module = single(&graph(&["f o", "o i e", "i k l", "k i m", "l o", "m e", "e"]));
    assert!(count(&module, "exit = ") > 0, "{}", module.naga());
    single(&graph(&["f o", "o i e", "i o k", "k i l", "l o", "e"]));
}

#[test]
fn exits_leave_three_loops_and_a_switch() {
    let module = single(
        "entry f = f
fun f(n: u32, return: fn(u32))
  jump a(0u)
  loop a(i: u32)
    i1 = add i 1u
    jump b(i1)
  loop b(j: u32)
    j1 = mul j 3u
    jump c(j1)
  loop c(k: u32)
    which = rem k 5u
    switch which 0: stop, 1: stop, 2: next_a, 3: next_b, else more
    arm more()
      k1 = add k 7u
      jump c(k1)
    arm next_b()
      jump b(k)
    arm next_a()
      large = gt j n
      branch large stop again
    arm again()
      jump a(k)
    join stop()
      sum = add i1 j1
      jump return(sum)
",
    );
    assert_eq!((count(&module, "loop"), count(&module, "switch")), (3, 1), "{}", module.naga());
    assert_eq!(module.report().blocks, 9);
    // What `stop` adds up was computed in the loops.
    assert_eq!(module.report().spills, 2, "{}", module.naga());
}

#[test]
fn a_switch_of_two_ways_is_an_if() {
    let two = single(
        "entry f = f
fun f(n: u32, return: fn(u32))
  switch n 3: a, 5: b, 8: a, else b
  arm a()
    jump return(1u)
  arm b()
    jump return(2u)
",
    );
    assert_eq!(count(&two, "switch"), 0, "{}", two.naga());
    assert!(two.naga().contains("== 3u") && two.naga().contains("== 8u") && !two.naga().contains("== 5u"));
    let three = single(
        "entry f = f
fun f(n: u32, return: fn(u32))
  switch n 3: a, 5: b, 8: a, 9: c, else c
  arm a()
    jump return(1u)
  arm b()
    jump return(2u)
  arm c()
    jump return(3u)
",
    );
    assert!(three.naga().contains("case 3u, 8u: {"), "{}", three.naga());
}

#[test]
fn parameters_are_copied_at_once() {
    // The two swap in each round.
    let module = single(
        "entry f = f
fun f(n: u32, return: fn(f32, f32))
  jump head(0u, 1.0, 2.0)
  loop head(i: u32, a: f32, b: f32)
    more = lt i n
    i1 = add i 1u
    branch more step done
  arm step()
    jump head(i1, b, a)
  arm done()
    jump return(a, b)
",
    );
    // Both are read where the loop begins, before either is written.
    let naga = module.naga();
    let read = naga.find("= head_b;").expect("b is read");
    let write = naga.rfind("head_a = ").expect("a is written");
    assert!(read < write, "{naga}");
}

#[test]
fn functions_take_and_return_scalars_and_vectors() {
    let module = single(
        "entry f = f
fun f(x: f32, return: fn(f32, bool))
  jump swap(x, 2.0, swapped)
  rest swapped(a: f32, b: f32)
    v = pack a b a
    jump sum(v, true, summed)
  rest summed(s: f32, yes: bool)
    jump return(s, yes)
fun swap(a: f32, b: f32, return: fn(f32, f32))
  jump return(b, a)
fun sum(v: f32x3, yes: bool, return: fn(f32, bool))
  w = add v v
  a = lane w 0
  b = lane w 2
  c = add a b
  jump id(c, yes, return)
fun id(a: f32, b: bool, return: fn(f32, bool))
  jump return(a, b)
",
    );
    assert_eq!((module.report().functions, module.report().calls), (4, 3));
    assert_eq!((module.arguments(), module.results()), (1, 2));
}

#[test]
fn a_vectorize_is_a_loop() {
    let p = residual(
        "stream s by columns
  x: u32 bulk
entry fill = fill
fun fill(group: u32, n: u32, return: fn())
  lo = mul group 8u
  hi = add lo 8u
  vectorize 8 lo hi each(n) -> done
  rest done()
    jump return()
fun each(n: u32, i: u32, return: fn())
  v = add i n
  store s.x i v -> stored
  rest stored()
    jump return()
",
    );
    let module = emit(&p, "fill", &Options::default()).unwrap();
    validate(&module);
    assert_eq!((count(&module, "loop"), module.arguments()), (1, 1), "{}", module.naga());
    assert!(module.naga().contains("workgroup_size(64, 1, 1)"));
}

#[test]
fn deep_and_long_programs_are_emitted() {
    // A chain of tests that leave, and arms within arms.
    let exits: Vec<String> = (0..500).map(|i| format!("b{i} e b{}", i + 1)).collect();
    let lines: Vec<&str> = ["f b0"].into_iter().chain(exits.iter().map(String::as_str)).chain(["b500", "e"]).collect();
    single(&graph(&lines));
    let open = (0..100).map(|i| format!("a{i} a{} j{i}", i + 1));
    let close = (0..100).map(|i| if i == 0 { "j0".to_owned() } else { format!("j{i} j{}", i - 1) });
    let nested: Vec<String> =
        ["f a0".to_owned()].into_iter().chain(open).chain(["a100 j99".into()]).chain(close).collect();
    single(&graph(&nested.iter().map(String::as_str).collect::<Vec<_>>()));
}
