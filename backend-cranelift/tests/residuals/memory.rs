//! Tables, streams and local arrays, in range and out of it.

use jerboa_backend_cranelift::{Binding, Error, Opt, Options, Status, compile};
use jerboa_ir::interp::Memory;
use jerboa_ir::*;

use crate::build::{Build, agree, code, residual};

fn memory(rows: u32, words: impl IntoIterator<Item = u32>) -> Memory {
    Memory { rows, words: words.into_iter().collect() }
}

#[test]
fn reads_clamp_in_both_layouts() {
    for layout in ["rows", "columns"] {
        let p = residual(&format!(
            "table t by {layout}
  a: f32 bulk
  b: u32 bulk
  c: bool bulk
entry f = f
fun f(i: u32, return: fn(f32, u32, bool, f32))
  a = read t.a i
  b = read t.b i
  c = read t.c i
  first = read t.a 0u
  jump return(a, b, c, first)
"
        ));
        // A bool is any word but 0.
        let words = (0..15).map(|i| if i % 2 == 0 { 0 } else { i * 0x0101_0100 });
        for rows in [1, 5] {
            for i in [0, 1, 3, 4, 5, u32::MAX] {
                agree(&p, "f", &[Lit::U32(i)], &[memory(rows, words.clone().take(rows as usize * 3))]);
            }
        }
    }
}

#[test]
fn streams_clamp_loads_and_drop_stores() {
    for layout in ["rows", "columns"] {
        let p = residual(&format!(
            "stream s by {layout}
  a: f32 bulk
  b: bool bulk
  c: i32 bulk
entry f = f
fun f(i: u32, j: u32, x: f32, return: fn(f32, bool, i32, f32))
  load s.a i -> got_a
  rest got_a(a: f32)
  load s.b i -> got_b
  rest got_b(b: bool)
  load s.c i -> got_c
  rest got_c(c: i32)
  store s.a j x -> stored_a
  rest stored_a()
  not_b = not b
  store s.b j not_b -> stored_b
  rest stored_b()
  load s.a i -> again
  rest again(a2: f32)
  jump return(a, b, c, a2)
"
        ));
        for rows in [0, 1, 4] {
            let words = (0..rows * 3).map(|i: u32| i.wrapping_mul(0x0100_0001) & 0x3fff_ffff);
            for (i, j) in [(0, 0), (1, 3), (3, 3), (4, 4), (u32::MAX, u32::MAX), (2, 1 << 30)] {
                let args = [Lit::U32(i), Lit::U32(j), Lit::f32(1.5)];
                let results = agree(&p, "f", &args, &[memory(rows, words.clone())]);
                if rows == 0 {
                    assert_eq!(results.expect("it ends")[0], Lit::f32(0.0));
                }
            }
        }
    }
}

#[test]
fn functions_reach_buffers_and_unchecked_loads() {
    let p = residual(
        "table t by rows
  a: u32 bulk
stream s by columns
  x: u32 bulk
entry f = f
fun f(n: u32, return: fn())
  jump again(0u)
    loop again(i: u32)
      more = lt i n
      branch more step done
        arm step()
          jump copy(i, copied)
        rest copied()
          i1 = add i 1u
          jump again(i1)
        arm done()
          jump return()
fun copy(i: u32, return: fn())
  load unchecked t.a i -> got
  rest got(a: u32)
  known = read t.a 1u
  sum = add a known
  store s.x i sum -> stored
  rest stored()
  jump return()
",
    );
    agree(&p, "f", &[Lit::U32(3)], &[memory(3, [5, 6, 7]), memory(3, [0, 0, 0])]);
}

#[test]
fn local_arrays_are_zero_each_time() {
    for len in [1, 3, 64, 65, 1000] {
        let p = residual(&format!(
            "entry f = f
fun f(n: u32, at: u32, return: fn(u32))
  jump again(0u, 0u)
    loop again(i: u32, sum: u32)
      more = lt i n
      branch more step done
        arm step()
          local u32 {len} -> made
          rest made(array: local(u32 {len}))
          load array at -> before
          rest before(old: u32)
          store array at 7u -> written
          rest written()
          store array 4000000000u 9u -> dropped
          rest dropped()
          load array 4000000000u -> after
          rest after(last: u32)
          next = add i 1u
          s1 = add sum old
          s2 = mul s1 10u
          s3 = add s2 last
          jump again(next, s3)
        arm done()
          jump return(sum)
"
        ));
        for at in [0, len / 2, len - 1, len, u32::MAX] {
            agree(&p, "f", &[Lit::U32(3), Lit::U32(at)], &[]);
        }
    }
}

#[test]
fn local_arrays_of_all_types_stay_apart() {
    let p = residual(
        "entry f = f
fun f(i: u32, return: fn(bool, f32, i32))
  local bool 5 -> a
  rest a(flags: local(bool 5))
  local f32 5 -> b
  rest b(floats: local(f32 5))
  local i32 5 -> c
  rest c(ints: local(i32 5))
  store flags i true -> d
  rest d()
  store floats i 2.5 -> e
  rest e()
  store ints i -3i -> g
  rest g()
  load flags 2u -> h
  rest h(x: bool)
  load floats 2u -> k
  rest k(y: f32)
  load ints 2u -> l
  rest l(z: i32)
  jump return(x, y, z)
",
    );
    for i in [1, 2, 5] {
        agree(&p, "f", &[Lit::U32(i)], &[]);
    }
}

#[test]
fn arrays_beyond_the_stack_are_an_error() {
    let big = |len: u32, recursive: bool| {
        let mut b = Build::default();
        let f = b.entry("hungry", &[Ty::u32()], &[Ty::u32()]);
        let n = b.param(f, 0);
        let made = b.block(&[Ty::local(Scalar::U32, len)]);
        b.local(f, Scalar::U32, len, made);
        let (array, got, back) = (b.param(made, 0), b.block(&[Ty::u32()]), b.block(&[Ty::u32()]));
        b.load(made, Mem::Local(array), n, got);
        let x = b.param(got, 0);
        if recursive {
            b.call(got, f, &[x], back);
        } else {
            b.jump(got, back, &[x]);
        }
        let y = b.param(back, 0);
        b.ret(back, f, &[y]);
        compile(&[&b.finish()], &Options::default()).map(drop)
    };
    assert_eq!((big(1000, false), big(1000, true)), (Ok(()), Ok(())));
    assert!(matches!(big(20_000, true), Err(Error::Stack { function, .. }) if function == "hungry"));
    for len in [1 << 19, 1 << 30, u32::MAX] {
        let error = big(len, false).expect_err("it does not fit");
        assert!(error.to_string().contains("hungry") && error.to_string().contains("local arrays"), "{error}");
    }
}

#[test]
fn lanes_load_unchecked() {
    for (index, at) in [("u32x4", &[6u32, 0, 3, 6][..]), ("u32", &[3]), ("u32", &[0])] {
        let p = residual(&format!(
            "table t by rows
  pad: u32 bulk
  x: f32 bulk
entry f = f
fun f(at: {index}, return: fn(f32x4))
  load unchecked t.x at -> got
  rest got(x: f32x4)
  jump return(x)
"
        ));
        let args: Vec<Lit> = at.iter().map(|i| Lit::U32(*i)).collect();
        agree(&p, "f", &args, &[memory(7, (0..14).map(|i| i * 0x0101_0101))]);
    }
}

/// Runs of one buffer at one index share a test; the last store to a word stays, and what is computed between the stores is
/// computed.
#[test]
fn runs_of_several_columns() {
    let p = residual(
        "stream s by columns
  a: f32 bulk
  b: bool bulk
  c: f32 bulk
stream t by columns
  d: f32 bulk
entry f = f
fun f(i: u32, j: u32, mask: boolx8, return: fn(f32x8, boolx8, f32x8, f32x8))
  load s.a i -> got_a
  rest got_a(a: f32x8)
  load s.b i -> got_b
  rest got_b(b: boolx8)
  load s.c i -> got_c
  rest got_c(c: f32x8)
  load t.d i -> got_d
  rest got_d(d: f32x8)
  store s.a j c when mask -> stored_c
  rest stored_c()
  sum = add a c
  store s.c j sum when mask -> stored_sum
  rest stored_sum()
  less = lt a c
  store s.b j less when mask -> stored_less
  rest stored_less()
  product = mul sum d
  store s.a j product when mask -> stored_product
  rest stored_product()
  store t.d j a when b -> stored_a
  rest stored_a()
  store t.d j c when mask -> stored_last
  rest stored_last()
  jump return(a, b, c, d)
",
    );
    for rows in [0, 1, 7, 8, 21] {
        let mut words = (1u32..).map(|i| f32::from((i * 37 % 101) as u16).to_bits() * (i % 3).min(1));
        let memory = [memory(rows, words.by_ref().take(rows as usize * 3)), memory(20, words.take(20))];
        for (i, j) in [(0, 0), (1, 13), (13, 14), (14, 3), (20, 17), (u32::MAX - 2, 1), (0, u32::MAX - 4)] {
            for mask in [0xff, 0, 0b1010_0110] {
                let mask = (0..8).map(|l| Lit::Bool(mask >> l & 1 == 1));
                let args: Vec<Lit> = [Lit::U32(i), Lit::U32(j)].into_iter().chain(mask).collect();
                agree(&p, "f", &args, &memory);
            }
        }
    }
}

/// A row is stored as far as it is known, under the mask and where there is a row; what was loaded with its neighbours before
/// is loaded again.
#[test]
fn runs_of_rows() {
    let names = ["a", "b", "c", "d", "e", "g", "h"];
    let kind = |name: &str| if name == "d" { "bool" } else { "f32" };
    let columns = names.map(|name| format!("  {name}: {} bulk\n", kind(name))).concat();
    let load = |suffix: &str| {
        let one = |name: &&str| {
            format!(
                "  load s.{name} at -> got_{name}{suffix}\n  rest got_{name}{suffix}({name}{suffix}: {}x8)\n",
                kind(name)
            )
        };
        names.iter().map(one).collect::<String>()
    };
    // All but the first column, the last two at first with another value.
    let store = ["g a", "h b", "b c", "c h", "d d", "e a", "g e", "h g"];
    let store = store.iter().enumerate().map(|(i, what)| {
        let (column, value) = what.split_once(' ').expect("two names");
        format!("  store s.{column} j {value} when mask -> stored{i}\n  rest stored{i}()\n")
    });
    let results = |suffix: &str| names.map(|name| format!("{name}{suffix}")).join(", ");
    let types = names.map(|name| format!("{}x8", kind(name))).join(", ");
    let p = residual(&format!(
        "stream s by rows
{columns}entry f = f
fun f(at: u32x8, j: u32, mask: boolx8, return: fn({types}, {types}))
{}{}{}  jump return({}, {})
",
        load(""),
        store.collect::<String>(),
        load("2"),
        results(""),
        results("2"),
    ));
    for rows in [0, 1, 7, 8, 21] {
        let words = (0..rows * 7).map(|i| f32::from((i * 37 % 101) as u16).to_bits());
        let memory = [memory(rows, words)];
        for (at, j) in [(0, 0), (3, 13), (13, 14), (20, u32::MAX - 4)] {
            for mask in [0xff, 0, 0b1010_0110] {
                let at = (0..8).map(|l| Lit::U32(at + l % 5 * 3));
                let mask = (0..8).map(|l| Lit::Bool(mask >> l & 1 == 1));
                let args: Vec<Lit> = at.chain([Lit::U32(j)]).chain(mask).collect();
                agree(&p, "f", &args, &memory);
            }
        }
    }
}

/// Columns of a table by rows come with their neighbours, of any width of row.
#[test]
fn gathers_of_whole_rows() {
    for (columns, lanes) in [(3, 4), (4, 4), (5, 8), (6, 5), (7, 8), (9, 16)] {
        let kinds = ["f32", "u32", "bool"];
        let list =
            |f: &dyn Fn(usize) -> String, separator: &str| (0..columns).map(f).collect::<Vec<_>>().join(separator);
        let p = residual(&format!(
            "table t by rows\n{}\nentry f = f\nfun f(at: u32x{lanes}, return: fn({}, f32x{lanes}))\n{}
  last = pack {}
  near = and at last
  load unchecked t.c0 near -> got
  rest got(safe: f32x{lanes})
  jump return({}, safe)\n",
            list(&|c| format!("  c{c}: {} bulk", kinds[c % 3]), "\n"),
            list(&|c| format!("{}x{lanes}", kinds[c % 3]), ", "),
            list(&|c| format!("  x{c} = read t.c{c} at"), "\n"),
            vec!["3u"; lanes].join(" "),
            list(&|c| format!("x{c}"), ", "),
        ));
        let words = (0..columns as u32 * 4).map(|i| if i % 4 == 0 { 0 } else { (i * 0x2f1_3077) & 0x3fff_ffff });
        let memory = [memory(4, words)];
        for step in [0, 1, 5, 1 << 29] {
            let at: Vec<Lit> = (0..lanes as u32).map(|l| Lit::U32(l.wrapping_mul(step) % 7)).collect();
            agree(&p, "f", &at, &memory);
        }
    }
}

/// Lanes that are not under the mask are not even written as they were: another thread may write there. Here it is memory
/// that nobody may write, so that a mistake ends the process.
#[cfg(target_os = "linux")]
#[test]
fn lanes_beside_the_mask_are_left_alone() {
    // SAFETY: this is how the C library declares it.
    unsafe extern "C" {
        fn mprotect(address: *mut u32, bytes: usize, protection: i32) -> i32;
    }
    const READ: i32 = 1;
    const WRITE: i32 = 2;
    /// As large as a page of any machine.
    #[repr(align(65536))]
    struct Page([u32; 1 << 14]);
    for access in ["u32", "u32x8"] {
        let p = residual(&format!(
            "stream s by columns
  x: u32 bulk
entry f = f
fun f(i: {access}, value: u32x8, mask: boolx8, return: fn())
  store s.x i value when mask -> stored
  rest stored()
  jump return()
"
        ));
        let code = code(&p, Opt::None);
        let mut pages = vec![Page([0; 1 << 14]), Page([0; 1 << 14])];
        let end = pages[0].0.len() as u32;
        let binding = Binding { words: pages.as_mut_ptr().cast(), rows: 2 * end };
        // SAFETY: these bytes are the second page, all of it.
        let protect = |how| unsafe { mprotect(binding.words.add(end as usize), size_of::<Page>(), how) };
        assert_eq!(protect(READ), 0);
        let rows: Vec<u32> = (end - 3..end + 5).collect();
        let mask = [1, 0, 1, 0, 0, 0, 0, 0];
        let args = [&rows[..if access == "u32" { 1 } else { 8 }], &[7; 8], &mask].concat();
        // SAFETY: the one buffer is bound, with a word in each of its rows; those under the mask may be written.
        let status = unsafe { code.kernel("f").expect("it is an entry").call(&[binding], &args, &mut []) };
        assert_eq!((status, protect(READ | WRITE)), (Status::Done, 0));
        assert_eq!(pages[0].0[end as usize - 4..], [0, 7, 0, 7]);
    }
}
