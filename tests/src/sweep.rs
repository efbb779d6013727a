//! A residual run once for each row of a stream: its first entry as the body of a `vectorize`, or as an invocation of a GPU.
//!
//! The arguments of row i are in the columns of the stream `given`, or, those that are the same for all rows, are
//! arguments of the new entry `sweep`; the results of row i go to the columns of the stream `taken`. So whatever random
//! programs do is done in lanes, and many inputs take one launch.

use jerboa_ir::interp::Memory;
use jerboa_ir::*;

use crate::choices::Choices;
use crate::values;

/// Who goes through the rows.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Through {
    /// A loop of so many iterations at once, between two bounds that are the first arguments.
    Vectorize(u8),
    /// Somebody else: the first argument is a row's number. In a row beyond the last nothing is stored.
    Grid,
}

/// A program with its memory and the arguments of its entry `sweep`, less those that say which rows, which come first.
pub struct Sweep {
    /// The program: a residual.
    pub program: Program,
    /// Content of the buffers.
    pub memory: Vec<Memory>,
    /// The arguments that are the same for all rows.
    pub uniform: Vec<Lit>,
}

/// Can a residual be run for each row independently? It must not store to streams, nor vectorise itself.
pub fn fits(p: &Program) -> bool {
    let spoils =
        |c: &ContId| matches!(p.cont(*c).body, Body::Store { mem: Mem::Stream(_), .. } | Body::Vectorize { .. });
    !Reach::of(p).conts.iter().any(spoils)
}

/// So many rows of random arguments, some of them the same for all rows.
///
/// # Panics
/// When the program has no entry `main`, or does not fit.
pub fn sweep(residual: &Program, memory: &[Memory], rows: u32, through: Through, c: &mut Choices) -> Sweep {
    assert!(fits(residual), "runs of the program depend on each other");
    let main = residual.cont(residual.entry("main").expect("a residual has the entry"));
    let (ret, params) = main.params.split_last().expect("an entry has a return");
    let params: Vec<Ty> = params.iter().map(|param| param.ty).collect();
    let results = ret.ty.params().expect("a return is a continuation");
    let is_uniform: Vec<bool> = params.iter().map(|_| c.one_in(4)).collect();

    let text = print(residual);
    let (head, body) = text.split_once("entry main = ").expect("it has one entry");
    let (main, functions) = body.split_once('\n').expect("functions follow");
    let mut new = format!("{head}{}", stream("given", &params) + &stream("taken", results));
    let list = |each: &dyn Fn(usize) -> String| (0..params.len()).map(each).collect::<Vec<_>>();
    let uniform: Vec<usize> = (0..params.len()).filter(|i| is_uniform[*i]).collect();
    let declared: String = uniform.iter().map(|i| format!("sweep_u{i}: {}, ", params[*i])).collect();
    let captured: String = uniform.iter().map(|i| format!("sweep_u{i}, ")).collect();
    new += "entry sweep = sweep\n";
    new += &match through {
        Through::Vectorize(width) => format!(
            "fun sweep(sweep_lo: u32, sweep_hi: u32, {declared}return: fn())\n\
             \x20 vectorize {width} sweep_lo sweep_hi sweep_row({}) -> sweep_done\n\
             \x20 rest sweep_done()\n  jump return()\n",
            captured.trim_end_matches(", ")
        ),
        Through::Grid => format!(
            "fun sweep(sweep_row_number: u32, {declared}return: fn())\n\
             \x20 jump sweep_row({captured}sweep_row_number, return)\n"
        ),
    };
    new += &format!("fun sweep_row({declared}sweep_i: u32, return: fn())\n");
    for i in (0..params.len()).filter(|i| !is_uniform[*i]) {
        let (scalar, n) = params[i].lanes().expect("it is data");
        for l in 0..n {
            let name = format!("sweep_a{i}_{l}");
            new += &format!("  load given.c{i}_{l} sweep_i -> sweep_load{i}_{l}\n");
            new += &format!("  rest sweep_load{i}_{l}({name}: {})\n", scalar.name());
        }
        if n > 1 {
            let lanes: Vec<String> = (0..n).map(|l| format!("sweep_a{i}_{l}")).collect();
            new += &format!("  sweep_v{i} = pack {}\n", lanes.join(" "));
        }
    }
    let arg = |i: usize| match (is_uniform[i], params[i].as_scalar()) {
        (true, _) => format!("sweep_u{i}"),
        (_, Some(_)) => format!("sweep_a{i}_0"),
        _ => format!("sweep_v{i}"),
    };
    new += &format!("  jump {main}({}sweep_got)\n", list(&arg).iter().map(|a| format!("{a}, ")).collect::<String>());
    let got: Vec<String> = results.iter().enumerate().map(|(i, ty)| format!("sweep_r{i}: {ty}")).collect();
    new += &format!("  rest sweep_got({})\n", got.join(", "));
    for (i, ty) in results.iter().enumerate() {
        for l in 0..ty.lanes().expect("it is data").1 {
            let value = match ty.as_scalar() {
                Some(_) => format!("sweep_r{i}"),
                None => {
                    new += &format!("  sweep_l{i}_{l} = lane sweep_r{i} {l}\n");
                    format!("sweep_l{i}_{l}")
                }
            };
            new += &format!("  store taken.c{i}_{l} sweep_i {value} -> sweep_stored{i}_{l}\n");
            new += &format!("  rest sweep_stored{i}_{l}()\n");
        }
    }
    new += "  jump return()\n\n";
    new += functions;

    let program = parse(&new).unwrap_or_else(|e| panic!("{e}\n{new}"));
    let mut memory = memory.to_vec();
    let columns = |types: &[Ty]| {
        types
            .iter()
            .flat_map(|ty| {
                let (scalar, n) = ty.lanes().expect("it is data");
                std::iter::repeat_n(scalar, n)
            })
            .collect::<Vec<Scalar>>()
    };
    let words = columns(&params)
        .iter()
        .flat_map(|s| (0..rows).map(|_| values::random(*s, c).word()).collect::<Vec<_>>())
        .collect();
    memory.push(Memory { rows, words });
    memory.push(Memory { rows, words: vec![0; columns(results).len() * rows as usize] });
    let types: Vec<Ty> = uniform.iter().map(|i| params[*i]).collect();
    let uniform = columns(&types).iter().map(|s| values::random(*s, c)).collect();
    Sweep { program, memory, uniform }
}

/// The declaration of a stream with a column for each scalar of these types.
fn stream(name: &str, types: &[Ty]) -> String {
    let mut text = format!("stream {name} by columns\n");
    for (i, ty) in types.iter().enumerate() {
        let (scalar, n) = ty.lanes().expect("it is data");
        (0..n).for_each(|l| text += &format!("  c{i}_{l}: {} bulk\n", scalar.name()));
    }
    text
}
