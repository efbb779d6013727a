//! Loops, switches, calls and recursion.

use jerboa_backend_cranelift::{Error, Options, compile};
use jerboa_ir::*;

use crate::build::{Build, agree, residual};

fn u32s(p: &Program, args: &[u32]) -> Option<Vec<Lit>> {
    agree(p, "f", &args.iter().map(|a| Lit::U32(*a)).collect::<Vec<_>>(), &[])
}

#[test]
fn nested_loops_with_an_exit_out_of_both() {
    // The first (i, j), j < i < n, with i · j = wanted; else (n, n).
    let p = residual(
        "entry f = f
fun f(n: u32, wanted: u32, return: fn(u32, u32))
  jump outer(0u)
    loop outer(i: u32)
      more = lt i n
      branch more body none
        arm body()
          jump inner(0u)
            loop inner(j: u32)
              inside = lt j i
              branch inside test next_i
                arm test()
                  product = mul i j
                  hit = eq product wanted
                  branch hit found next_j
                    arm found()
                      jump out(i, j)
                    arm next_j()
                      j2 = add j 1u
                      jump inner(j2)
                arm next_i()
                  i2 = add i 1u
                  jump outer(i2)
        arm none()
          jump out(n, n)
  label out(x: u32, y: u32)
    jump return(x, y)
",
    );
    assert_eq!(u32s(&p, &[10, 12]), Some(vec![Lit::U32(4), Lit::U32(3)]));
    assert_eq!(u32s(&p, &[10, 13]), Some(vec![Lit::U32(10), Lit::U32(10)]));
    assert_eq!(u32s(&p, &[0, 0]), Some(vec![Lit::U32(0), Lit::U32(0)]));
}

#[test]
fn loop_parameters_are_exchanged_at_once() {
    let p = residual(
        "entry f = f
fun f(n: u32, return: fn(u32, u32))
  jump again(n, 1u, 2u)
    loop again(i: u32, a: u32, b: u32)
      more = gt i 0u
      branch more swap done
        arm swap()
          less = sub i 1u
          jump again(less, b, a)
        arm done()
          jump return(a, b)
",
    );
    assert_eq!(u32s(&p, &[7]), Some(vec![Lit::U32(2), Lit::U32(1)]));
}

#[test]
fn switch_takes_every_number() {
    let p = residual(
        "entry f = f
fun f(i: u32, return: fn(u32))
  switch i 0: a, 1: b, 5: a, 2147483648: c, 4294967295: b, else d
    arm a()
      jump return(10u)
    arm b()
      jump return(11u)
    arm c()
      jump return(12u)
    arm d()
      jump return(13u)
",
    );
    for (i, expected) in [(0, 10), (1, 11), (2, 13), (5, 10), (1 << 31, 12), (u32::MAX, 11), (u32::MAX - 1, 13)] {
        assert_eq!(u32s(&p, &[i]), Some(vec![Lit::U32(expected)]), "{i}");
    }
}

#[test]
fn a_shared_division_stands_in_the_arms_that_use_it() {
    let p = residual(
        "entry f = f
fun f(i: u32, a: i32, b: i32, return: fn(i32))
  q = div a b
  switch i 0: one, 1: two, else three
    arm one()
      jump return(q)
    arm two()
      r = mul q q
      jump return(r)
    arm three()
      jump return(a)
",
    );
    for i in 0..3 {
        for (a, b) in [(7, 2), (7, 0), (i32::MIN, -1), (-7, 2)] {
            agree(&p, "f", &[Lit::U32(i), Lit::I32(a), Lit::I32(b)], &[]);
        }
    }
}

/// down(n) = n = 0 ? 0 : down(n − 1) + 1, and odd or even by mutual tail calls.
const RECURSION: &str = "entry f = f
entry even = even
fun f(n: u32, return: fn(u32))
  done = eq n 0u
  branch done zero more
    arm zero()
      jump return(0u)
    arm more()
      less = sub n 1u
      jump f(less, back)
  rest back(r: u32)
    r1 = add r 1u
    jump return(r1)
fun even(n: u32, return: fn(bool))
  done = eq n 0u
  branch done yes more
    arm yes()
      jump return(true)
    arm more()
      less = sub n 1u
      jump odd(less, return)
fun odd(n: u32, return: fn(bool))
  done = eq n 0u
  branch done no more
    arm no()
      jump return(false)
    arm more()
      less = sub n 1u
      jump even(less, return)
";

#[test]
fn recursion_ends_at_the_limit_and_not_before() {
    let p = residual(RECURSION);
    let limit = jerboa_backend_cranelift::DEPTH_LIMIT;
    assert_eq!(u32s(&p, &[limit - 1]), Some(vec![Lit::U32(limit - 1)]));
    assert_eq!(u32s(&p, &[limit]), None);
    assert_eq!(u32s(&p, &[100 * limit]), None);
}

#[test]
fn tail_calls_take_no_stack() {
    let p = residual(RECURSION);
    assert_eq!(agree(&p, "even", &[Lit::U32(300_000)], &[]), Some(vec![Lit::Bool(true)]));
    assert_eq!(agree(&p, "even", &[Lit::U32(300_001)], &[]), Some(vec![Lit::Bool(false)]));
}

#[test]
fn ackermann_and_a_caller_that_tail_calls_it() {
    let p = residual(
        "entry f = f
fun f(m: u32, n: u32, return: fn(u32))
  m1 = add m 1u
  small = lt m 1u
  branch small leaf deep
    arm leaf()
      jump twice(n, return)
    arm deep()
      jump ack(m, n, return)
fun twice(n: u32, return: fn(u32))
  n2 = add n n
  jump return(n2)
fun ack(m: u32, n: u32, return: fn(u32))
  m0 = eq m 0u
  m1 = sub m 1u
  branch m0 first other
    arm first()
      n2 = add n 1u
      jump return(n2)
    arm other()
      n0 = eq n 0u
      branch n0 second third
        arm second()
          jump ack(m1, 1u, return)
        arm third()
          n1 = sub n 1u
          jump ack(m, n1, back)
        rest back(r: u32)
          jump ack(m1, r, return)
",
    );
    assert_eq!(u32s(&p, &[2, 3]), Some(vec![Lit::U32(9)]));
    assert_eq!(u32s(&p, &[3, 3]), Some(vec![Lit::U32(61)]));
    assert_eq!(u32s(&p, &[0, 21]), Some(vec![Lit::U32(42)]));
}

/// `f(x, n)` returns `count` values of mixed types: x + i · n in places. It gets them from `g`, either at the end (a tail
/// call) or after which it exchanges the first and the last; `g` calls itself n times.
fn many(count: usize, tail: bool) -> Program {
    let mut b = Build::default();
    let kinds = [Scalar::U32, Scalar::F32, Scalar::Bool, Scalar::I32];
    let types: Vec<Ty> = (0..count).map(|i| Ty::scalar(kinds[i % 4])).collect();
    let params = [Ty::u32(), Ty::u32()];
    let (f, g) = (b.entry("f", &params, &types), b.fun("g", &params, &types));
    let (zero, one) = (b.u32(0), b.u32(1));
    // g
    let (x, n) = (b.param(g, 0), b.param(g, 1));
    let (leaf, deep, back) = (b.block(&[]), b.block(&[]), b.block(&types));
    let is_leaf = b.op(Op::Eq, &[n, zero]);
    b.branch(g, is_leaf, leaf, deep);
    let values: Vec<NodeId> = (0..count)
        .map(|i| {
            let i1 = b.u32(i as u32);
            let sum = b.op(Op::Add, &[x, i1]);
            match kinds[i % 4] {
                Scalar::U32 => sum,
                Scalar::F32 => b.op(Op::ToF32, &[sum]),
                Scalar::I32 => b.op(Op::IntOfBits, &[sum]),
                Scalar::Bool => b.op(Op::Gt, &[sum, one]),
            }
        })
        .collect();
    b.ret(leaf, g, &values);
    let (x2, n2) = (b.op(Op::Add, &[x, n]), b.op(Op::Sub, &[n, one]));
    b.call(deep, g, &[x2, n2], back);
    let returned = b.w.params(back);
    b.ret(back, g, &returned);
    // f
    let (x, n) = (b.param(f, 0), b.param(f, 1));
    if tail {
        b.tail_call(f, f, g, &[x, n]);
    } else {
        let back = b.block(&types);
        b.call(f, g, &[x, n], back);
        let mut returned = b.w.params(back);
        if types[0] == types[count - 1] {
            returned.swap(0, count - 1);
        }
        b.ret(back, f, &returned);
    }
    b.finish()
}

#[test]
fn any_number_of_results() {
    for count in [1, 9, 16, 17, 18, 33, 201] {
        for tail in [false, true] {
            let results = u32s(&many(count, tail), &[5, 4]).expect("it is not deep");
            assert_eq!(results.len(), count);
            let first = if tail { 0 } else { (count - 1) as u32 * ((count % 4 == 1) as u32) };
            assert_eq!(results[0], Lit::U32(15 + first), "{count} {tail}");
        }
    }
}

#[test]
fn vectors_are_parameters_results_and_state_of_loops() {
    let p = residual(
        "entry f = f
fun f(v: f32x3, n: u32, return: fn(f32x3, bool))
  jump again(v, n)
    loop again(w: f32x3, i: u32)
      more = gt i 0u
      branch more step done
        arm step()
          less = sub i 1u
          jump turn(w, 0.5, back)
        rest back(t: f32x3)
          jump again(t, less)
        arm done()
          lower = lt w v
          some = any lower
          jump return(w, some)
fun turn(v: f32x3, s: f32, return: fn(f32x3))
  x = lane v 0
  y = lane v 1
  z = lane v 2
  sss = pack s s s
  yzx = pack y z x
  r = mul yzx sss
  jump return(r)
",
    );
    let args = [Lit::f32(1.0), Lit::f32(2.0), Lit::f32(-3.0), Lit::U32(4)];
    let expected = [0.125, -0.1875, 0.0625].map(Lit::f32);
    assert_eq!(agree(&p, "f", &args, &[]), Some([&expected[..], &[Lit::Bool(true)]].concat()));
}

#[test]
fn what_cannot_be_compiled_is_an_error_that_names_the_kernel() {
    let one = residual("entry one = f\nfun f(x: u32, return: fn(u32))\n  jump return(x)\n");
    let same = compile(&[&one, &one], &Options::default()).map(drop);
    assert_eq!(same, Err(Error::SameName("one".to_owned())));
    let generic = [
        "fun f(g: fn(fn()), return: fn())\n  jump g(return)\n",
        "fun f(x: u32, return: fn(u32))\n  t = tuple x x\n  y = extract t 1\n  z = tuple y t\n  u = extract z 0\n  jump g(z, \
         return)\nfun g(t: (u32, (u32, u32)), return: fn(u32))\n  y = extract t 0\n  jump return(y)\n",
    ];
    for text in generic {
        let p = residual(&format!("entry one = f\n{text}"));
        let error = compile(&[&p], &Options::default()).map(drop).expect_err("it is generic").to_string();
        assert!(error.contains("`one`") && error.contains("first-order"), "{error}");
    }
}
