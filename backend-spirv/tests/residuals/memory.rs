//! Tables, streams and local arrays; what is stored and loaded in which order.

use jerboa_backend_spirv::{Binding, Grid, Options, Packing, emit};
use jerboa_ir::BufId;

use crate::{count, residual, single, validate};

const ROW: &str = "stream s by rows
  a: f32 bulk
  b: i32 bulk
  c: bool bulk
table t by columns
  x: f32 bulk
  y: u32 bulk
";

#[test]
fn stores_to_a_row_share_a_test() {
    let module = single(&format!(
        "{ROW}entry f = f
fun f(i: u32, x: f32, return: fn())
  store s.a i x -> one
  rest one()
  y = read t.y i
  b = int_of_bits y
  store s.b i b -> two
  rest two()
  c = lt b 3i
  store s.c i c -> three
  rest three()
  jump return()
"
    ));
    assert_eq!(count(&module, "if "), 1, "{}", module.naga());
}

#[test]
fn a_load_sees_the_store_before_it() {
    let module = single(&format!(
        "{ROW}entry f = f
fun f(i: u32, j: u32, x: f32, return: fn(f32))
  store s.a i x -> one
  rest one()
  load s.a j -> two
  rest two(y: f32)
  store s.a i y -> three
  rest three()
  jump return(x)
"
    ));
    let naga = module.naga();
    let mut rest = &naga[..];
    for next in ["if (", "= s[", "if ("] {
        let at = rest.find(next).unwrap_or_else(|| panic!("`{next}` is not next:\n{naga}"));
        rest = &rest[at + next.len()..];
    }
}

#[test]
fn vectors_are_gathered_scattered_and_run() {
    let module = single(&format!(
        "{ROW}entry f = f
fun f(i: u32, v: u32x4, m: boolx4, return: fn(f32))
  x = read t.x v
  store s.a v x when m -> one
  rest one()
  load s.a i -> two
  rest two(run: f32x4)
  store s.a i run when m -> three
  rest three()
  load unchecked t.x v -> four
  rest four(y: f32x4)
  z = add run y
  some = any m
  last = lane z 3
  r = select some last 0.0
  jump return(r)
"
    ));
    assert_eq!((module.arguments(), module.results()), (9, 1));
}

#[test]
fn lanes_that_are_alike_are_made_once() {
    let module = single(&format!(
        "{ROW}entry f = f
fun f(i: u32, x: f32, y: f32, return: fn())
  v = pack x y x x
  w = mul v v
  m = pack true true false true
  store s.a i w when m -> one
  rest one()
  jump return()
"
    ));
    assert_eq!((count(&module, "*"), count(&module, "if (")), (2 + 3, 3), "{}", module.naga());
}

#[test]
fn local_arrays_are_cleared_and_clamped() {
    for (len, loops) in [(1, 0), (8, 0), (9, 1), (300, 1)] {
        for scalar in ["f32", "bool", "i32", "u32"] {
            let module = single(&format!(
                "entry f = f
fun f(i: u32, return: fn({scalar}, {scalar}, {scalar}))
  local {scalar} {len} -> made
  rest made(a: local({scalar} {len}))
  load a 7u -> one
  rest one(x: {scalar})
  store a i x -> two
  rest two()
  store a 400u x -> three
  rest three()
  small = and i 0u
  load a small -> four
  rest four(y: {scalar})
  load a i -> five
  rest five(z: {scalar})
  jump return(x, y, z)
"
            ));
            assert_eq!(count(&module, "loop"), loops, "{}", module.naga());
            assert_eq!(module.report().arrays[0].len, len);
            // No driver has to fill them a second time.
            assert!(!module.assembly().lines().any(|l| l.contains("OpVariable") && l.contains("Function %")));
        }
    }
}

#[test]
fn literals_out_of_range_are_found_through_vectors() {
    // naga refuses an index that is a literal, even where it is never used.
    single(
        "entry f = f
fun f(n: u32, return: fn(u32, u32))
  local u32 4 -> made
  rest made(a: local(u32 4))
    v = pack 9u n
    i = lane v 0
    store a i n -> stored
  rest stored()
    load a i -> one
  rest one(x: u32)
    j = div n 0u
    k = bits 7i
    load a k -> two
  rest two(y: u32)
    z = add y j
    jump return(x, z)
",
    );
}

#[test]
fn an_array_serves_a_loop_in_another_block() {
    single(
        "entry f = f
fun f(n: u32, return: fn(u32))
  jump again(0u)
  loop again(i: u32)
    local u32 20 -> made
  rest made(a: local(u32 20))
    store a i n -> next
  rest next()
    i1 = add i 1u
    more = lt i1 n
    branch more go done
  arm go()
    jump again(i1)
  arm done()
    load a i1 -> got
  rest got(x: u32)
    jump return(x)
",
    );
}

#[test]
fn buffers_are_packed() {
    let p = residual(
        "table a by rows
  x: u32 bulk
stream s by rows
  x: u32 bulk
table b by columns
  x: f32 bulk
entry f = f
fun f(i: u32, return: fn(f32))
  k = read a.x i
  y = read b.x k
  store s.x i k -> stored
  rest stored()
  jump return(y)
",
    );
    let options =
        |packing: &[u32]| Options { grid: Grid::Single, packing: Packing(packing.into()), ..Default::default() };
    let (a, s, b) = (BufId(0), BufId(1), BufId(2));
    let module = emit(&p, "f", &options(&[])).unwrap();
    validate(&module);
    let expected = [Binding::Launch, Binding::Tables(vec![a, b]), Binding::Streams(vec![s]), Binding::Results];
    assert_eq!(module.bindings(), expected);
    assert_eq!(expected.map(|b| b.is_written()), [false, false, true, true]);
    let module = emit(&p, "f", &options(&[3, 1, 2])).unwrap();
    validate(&module);
    let expected = [
        Binding::Launch,
        Binding::Streams(vec![s]),
        Binding::Tables(vec![b]),
        Binding::Tables(vec![a]),
        Binding::Results,
    ];
    assert_eq!(module.bindings(), expected);
}

#[test]
fn zeros_and_what_is_no_number_are_made_at_run_time() {
    let module = single(
        "entry f = f
fun f(x: f32, return: fn(f32, f32, f32, bool))
  a = add x 0.0
  b = mul a -0.0
  c = add b inf
  d = min c nan
  e = lt x 0.0
  jump return(a, b, d, e)
",
    );
    let naga = module.naga();
    // The only literal zero is compared with.
    assert_eq!(naga.matches("0f").count(), 1, "{naga}");
    assert!(naga.contains("< 0f"), "{naga}");
    // Three arithmetic operations and two comparisons (one of the minimum).
    assert_eq!(module.assembly().matches("NoContraction").count(), 5, "{}", module.assembly());
}
