//! Text of hand-made programs: what it looks like, and that it reads back.

use jerboa_ir::*;

const AT: Loc = Loc::NONE;

fn param(name: &str, ty: Ty) -> Param {
    Param { ty, name: Some(name.into()), keep: false }
}

fn jump(callee: NodeId, args: &[NodeId]) -> Body {
    Body::Jump { callee, args: args.to_vec(), mode: Mode::Filter }
}

/// `pow(x, n)` as in the paper, section 3.2, unfolded where `n` is known and below 64.
fn pow() -> World {
    let mut w = World::new();
    let (x, n, ret) = (param("x", Ty::f32()), param("n", Ty::i32()), param("return", Ty::func(&[Ty::f32()])));
    let pow = w.cont("pow", Role::Fun, vec![x, n, ret], AT);
    let [x, n, ret] = w.params(pow)[..] else { unreachable!() };
    let [zero, two, limit] = [0, 2, 64].map(|i| w.lit(Lit::I32(i)));
    let one = w.lit(Lit::f32(1.0));
    let (known, below) = (w.known(n, AT), w.prim(Op::Lt, &[n, limit], AT));
    w.cont_mut(pow).filter = w.prim(Op::And, &[known, below], AT);

    let [base, other, even, odd] = ["base", "other", "even", "odd"].map(|name| w.cont(name, Role::Arm, vec![], AT));
    let [base_, other_, even_, odd_, pow_] = [base, other, even, odd, pow].map(|c| w.cont_value(c));
    let is_zero = w.prim(Op::Eq, &[n, zero], AT);
    w.set_body(pow, Body::Branch { cond: is_zero, then: base_, other: other_ }, AT);
    w.set_body(base, jump(ret, &[one]), AT);
    let rem = w.prim(Op::Rem, &[n, two], AT);
    let is_even = w.prim(Op::Eq, &[rem, zero], AT);
    w.set_body(other, Body::Branch { cond: is_even, then: even_, other: odd_ }, AT);
    let half = w.prim(Op::Div, &[n, two], AT);
    let root = w.cont("half", Role::Rest, vec![param("y", Ty::f32())], AT);
    let root_ = w.cont_value(root);
    w.set_body(even, jump(pow_, &[x, half, root_]), AT);
    let y = w.param(root, 0);
    let square = w.prim(Op::Mul, &[y, y], AT);
    w.set_body(root, jump(ret, &[square]), AT);
    let less = w.lit(Lit::I32(1));
    let less = w.prim(Op::Sub, &[n, less], AT);
    let rest = w.cont("rest", Role::Rest, vec![param("y", Ty::f32())], AT);
    let rest_ = w.cont_value(rest);
    w.set_body(odd, jump(pow_, &[x, less, rest_]), AT);
    let y = w.param(rest, 0);
    let product = w.prim(Op::Mul, &[x, y], AT);
    w.set_body(rest, jump(ret, &[product]), AT);
    w.entry("pow", pow);
    w
}

#[test]
fn pow_prints_as_the_paper_reads() {
    let expected = "\
jerboa-ir 1  ; nodes 10  floats 2  conts 7  calls 2  closures 0  branches 2  reads 0  loads 0  stores 0
entry pow = pow

fun pow(x: f32, n: i32, return: fn(f32)) @(and (known n) (lt n 64i))
  y1 = eq n 0i
  branch y1 base other
    arm base() @  ; free: return
      jump return(1.0)
    arm other() @  ; free: x, n, return
      y2 = rem n 2i
      y3 = eq y2 0i
      branch y3 even odd
        arm even() @  ; free: x, n, return
          y4 = div n 2i
          jump pow(x, y4, half)
          rest half(y: f32) @  ; free: return
          y5 = mul y y
          jump return(y5)
        arm odd() @  ; free: x, n, return
          y6 = sub n 1i
          jump pow(x, y6, rest)
          rest rest(y_2: f32) @  ; free: x, return
          y7 = mul x y_2
          jump return(y7)
";
    assert_eq!(print(&pow().finish()), expected);
}
