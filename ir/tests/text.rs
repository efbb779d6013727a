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

/// Every construct of the text once, as the printer writes it.
const ALL: &str = include_str!("all.ir");

#[test]
fn every_construct_reads_back() {
    assert_eq!(print(&parse(ALL).unwrap()), ALL);
    let text = print(&pow().finish());
    assert_eq!(print(&parse(&text).unwrap()), text);
}

#[test]
fn text_depends_on_structure_not_on_the_order_of_making() {
    // The same program with its functions written in another order, comments and blank lines added.
    let (header, functions) = ALL.split_once("\n\n").unwrap();
    let mut functions: Vec<&str> = functions.split("\n\n").collect();
    let shared = functions.remove(0);
    functions.reverse();
    let shuffled = format!("{header}\n{shared}\n; a remark\n\n{}\n", functions.join("\n\n"));
    assert_eq!(print(&parse(&shuffled).unwrap()), ALL);
}

#[test]
fn hints_become_unique_words_and_lines_show_on_demand() {
    let mut w = World::new();
    let hints = ["x", "x", "ray.dir", "2nd", "true", "y7", ""];
    let mut params: Vec<Param> = hints.iter().map(|name| param(name, Ty::u32())).collect();
    params.push(Param { ty: Ty::func(&[]), name: None, keep: true });
    let f = w.cont("a function", Role::Fun, params, Loc { file: "here.rs", line: 3 });
    let last = w.param(f, hints.len());
    w.set_body(f, jump(last, &[]), AT);
    w.entry("f", f);
    let p = w.finish();
    let head =
        "fun a_function(x: u32, x_2: u32, ray_dir: u32, _2nd: u32, true_: u32, y1: u32, _: u32, keep y2: fn()) @";
    let line = |text: &str| text.lines().nth(3).unwrap().to_owned();
    assert_eq!(line(&print(&p)), head);
    assert_eq!(line(&print_with(&p, SourceLines::Shown)), format!("{head}  ; at here.rs:3"));
    assert_eq!(print(&parse(&print(&p)).unwrap()), print(&p));
}

/// Small generator (SplitMix64, Steele et al. 2014); tests print their seed.
struct Rng(u64);

impl Rng {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ z >> 31) % n as u64) as usize
    }
}

#[test]
fn mutated_texts_never_panic_and_what_parses_is_stable() {
    let words: Vec<&str> = ALL.split_inclusive([' ', '\n', '(', ')', ',']).collect();
    let mut parsed = 0;
    for seed in 0..4000 {
        let mut rng = Rng(seed);
        let mut words = words.clone();
        for _ in 0..=rng.below(3) {
            let (at, from) = (rng.below(words.len()), rng.below(words.len()));
            match rng.below(3) {
                0 => words[at] = words[from],
                1 => words.insert(at, words[from]),
                _ => drop(words.remove(at)),
            }
        }
        let text = words.concat();
        let result = std::panic::catch_unwind(|| {
            let once = print(&parse(&text).ok()?);
            Some((print(&parse(&once).expect("what is printed parses")), once))
        });
        match result {
            Ok(Some((twice, once))) => {
                parsed += 1;
                assert_eq!(twice, once, "seed {seed}");
            }
            Ok(None) => {}
            Err(_) => panic!("seed {seed}:\n{text}"),
        }
    }
    // Many mutations only rename or rewire.
    assert!(parsed > 200, "{parsed} of 4000 mutated texts parse");
}

#[test]
fn mutated_bytes_never_panic() {
    for seed in 0..4000 {
        let mut rng = Rng(seed);
        let mut bytes = ALL.as_bytes().to_vec();
        for _ in 0..=rng.below(4) {
            let at = rng.below(bytes.len());
            bytes[at] = b"\0 (){}:=.,-@;19eiux\xc3\n"[rng.below(21)];
        }
        let text = String::from_utf8_lossy(&bytes);
        assert!(std::panic::catch_unwind(|| parse(&text).is_ok()).is_ok(), "seed {seed}");
    }
}

#[test]
fn deep_and_wide_texts_are_refused_or_read_without_overflow() {
    let nested = |open: &str, close: &str| {
        format!("jerboa-ir 1\nfun f(x: {}u32{}) @\n  unset\n", open.repeat(100_000), close.repeat(100_000))
    };
    assert!(parse(&nested("(", ")")).unwrap_err().what.contains("too deep"));
    assert!(parse(&nested("fn(", ")")).unwrap_err().what.contains("too deep"));
    let filter = format!("jerboa-ir 1\nfun f(x: bool) @{}x{}\n  unset\n", "(not ".repeat(100_000), ")".repeat(100_000));
    assert!(parse(&filter).unwrap_err().what.contains("too deep"));
    // A tuple that doubles with every line.
    let doubling: String = (0..60).map(|i| format!("  t{} = tuple t{i} t{i}\n", i + 1)).collect();
    let error = parse(&format!("jerboa-ir 1\nfun f(t0: u32) @\n{doubling}  unset\n")).unwrap_err();
    assert!(error.what.contains("too large"), "{error}");
    // A long chain of lines and a deep nest of continuations are no mistake.
    let chain: String = (0..50_000).map(|i| format!("  n{} = add n{i} 1u\n", i + 1)).collect();
    let chain = format!("jerboa-ir 1\nfun f(n0: u32, k: fn(u32)) @\n{chain}  jump k(n50000)\n");
    assert!(print(&parse(&chain).unwrap()).ends_with("jump k(n50000)\n"));
    let nest: String =
        (0..5_000).map(|i| format!("  jump r{}(n{i})\n  rest r{}(n{}: u32)\n", i + 1, i + 1, i + 1)).collect();
    let nest = format!("jerboa-ir 1\nfun f(n0: u32, k: fn(u32)) @\n{nest}  jump k(n0)\n");
    let text = print(&parse(&nest).unwrap());
    assert!(text.ends_with("jump k(n0)\n"));
    assert_eq!(print(&parse(&text).unwrap()), text);
}

#[test]
fn errors_tell_line_and_column() {
    let at = |text: &str| {
        let error = parse(&format!("jerboa-ir 1\n{text}")).expect_err(text);
        format!("{}:{} {}", error.line, error.column, error.what)
    };
    assert_eq!(
        parse("jerboa-ir 2\n").unwrap_err().to_string(),
        "line 1, column 1: a text begins with `jerboa-ir 1`, this one with `jerboa-ir 2`"
    );
    assert_eq!(at("fun f(x: f64) @\n"), "2:10 `f64` is no type");
    assert_eq!(at("fun f(x: f32) @\n"), "2:1 this continuation has no jump");
    assert_eq!(at("fun f(x: f32) @\n  y = add x 1u\n  unset\n"), "3:7 add does not take [f32, u32]");
    assert_eq!(
        at("fun f(x: f32) @\n  y = add x 1\n  unset\n"),
        "3:13 `1` is neither a name nor a literal (`2i`, `2u`, `2.0`)"
    );
    assert_eq!(at("fun f(x: f32) @\n  y = add x z\n  unset\n"), "3:13 this name is not known here");
    assert_eq!(at("fun f(x: f32, x: f32) @\n  unset\n"), "2:5 a second `x` among the parameters and names here");
    assert_eq!(at("fun f() @\n  unset\n  unset\n"), "4:3 no continuation waits for a jump here");
    assert_eq!(at("entry e = f\n"), "2:11 no continuation `f` stands at the margin");
    assert_eq!(at("fun f() %\n  unset\n"), "2:9 `%` means nothing here");
    assert_eq!(at("  arm f() @\n  unset\n"), "2:3 the first continuation stands at the margin");
    assert_eq!(at("table t by rows\n  c: f32 sometimes\n"), "3:10 `structure`, `value` or `bulk`, not `sometimes`");
}
