//! Vectors in memory: gathers, scatters and runs of tables, streams and local arrays, on every engine, bit for bit.
//!
//! What is expected is written here a second time, lane by lane: a load clamps, a store out of range is dropped, a store
//! takes the lanes under its mask in ascending order, a run wraps as its indices do. Values are all special ones, indices
//! lie at and beyond the ends, masks have every pattern of up to 8 lanes.

use jerboa_backend_cranelift as cranelift;
use jerboa_ir::interp::{Limits, Memory, run};
use jerboa_ir::*;
use jerboa_peval::{Arg, Facts, Generic, specialize};
use jerboa_tests::choices::Choices;
use jerboa_tests::machine::call;
use jerboa_tests::values::specials;

/// Elements of the local array.
const LEN: u32 = 6;

/// How an access names its rows.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Access {
    /// Each lane has an index: gather and scatter.
    Scattered,
    /// The rows from an index on.
    Run,
}

/// One program: type, lanes, kind of access, layout of the buffers.
#[derive(Clone, Copy, Debug)]
struct Form {
    scalar: Scalar,
    lanes: usize,
    access: Access,
    layout: &'static str,
}

impl Form {
    /// Loads from a table and a stream, stores to the stream and to a local array, loads again.
    fn program(self) -> Program {
        let Form { scalar, lanes, access, layout } = self;
        let vector = format!("{}x{lanes}", scalar.name());
        // A table has no runs: its reads are pure, and one vector of indices is as good as another.
        let (index, read, first) = match access {
            Access::Scattered => (format!("u32x{lanes}"), "  read = read t.x at\n", "read"),
            Access::Run => ("u32".to_owned(), "", "value"),
        };
        let text = format!(
            "jerboa-ir 1
table t by {layout}
  pad: u32 bulk
  x: {s} bulk
stream s by {layout}
  pad: u32 bulk
  x: {s} bulk
entry main = main
fun main(at: {index}, value: {vector}, mask: boolx{lanes}, return: fn({vector}, {vector}, {vector}, {vector}))
{read}  load s.x at -> loaded
  rest loaded(before: {vector})
  store s.x at value when mask -> stored
  rest stored()
  load s.x at -> again
  rest again(after: {vector})
  local {s} {LEN} -> made
  rest made(array: local({s} {LEN}))
  store array at value when mask -> set
  rest set()
  load array at -> last
  rest last(element: {vector})
  jump return({first}, before, after, element)
",
            s = scalar.name()
        );
        let program = parse(&text).unwrap_or_else(|e| panic!("{e}\n{text}"));
        assert_eq!(verify_residual(&program), [], "{text}");
        assert_eq!(print(&parse(&print(&program)).expect("it reads back")), print(&program));
        program
    }
}

/// What a run is given.
struct Input {
    rows: Vec<u32>,
    value: Vec<Lit>,
    mask: Vec<bool>,
    memory: Vec<Memory>,
}

impl Input {
    fn new(form: Form, p: &Program, mask: u32, c: &mut Choices) -> Input {
        let values = specials(form.scalar);
        let stream_rows = c.pick(&[0, 1, 5, 21]);
        let ends = [0, 1, 2, 5, 6, 20, 21, 22, 1 << 30, u32::MAX - 3, u32::MAX - 1, u32::MAX];
        let mut index = || c.pick(&ends).wrapping_add(c.below(3));
        let first = index();
        let rows = (0..form.lanes as u32).map(|lane| match form.access {
            Access::Scattered => index(),
            Access::Run => first.wrapping_add(lane),
        });
        let rows = rows.collect();
        let mut memory = |b: usize, rows: u32| {
            let mut words = vec![0; rows as usize * 2];
            for row in 0..rows as usize {
                words[p.buffers[b].word(rows as usize, row, 0)] = c.below(u32::MAX);
                words[p.buffers[b].word(rows as usize, row, 1)] = c.pick(&values).word();
            }
            Memory { rows, words }
        };
        let memory = vec![memory(0, 5), memory(1, stream_rows)];
        let value = (0..form.lanes).map(|_| c.pick(&values)).collect();
        Input { rows, value, mask: (0..form.lanes).map(|l| mask >> l & 1 == 1).collect(), memory }
    }

    fn arguments(&self, form: Form) -> Vec<Lit> {
        let indices = if form.access == Access::Run { &self.rows[..1] } else { &self.rows[..] };
        let mask = self.mask.iter().map(|m| Lit::Bool(*m));
        indices.iter().map(|i| Lit::U32(*i)).chain(self.value.iter().copied()).chain(mask).collect()
    }

    /// Results, and memory afterwards.
    fn expected(&self, form: Form, p: &Program) -> (Vec<Lit>, Vec<Memory>) {
        let scalar = |word| Lit::from_word(form.scalar, word);
        let mut memory = self.memory.clone();
        let word = |m: &Memory, b: usize, row: u32| p.buffers[b].word(m.rows as usize, row as usize, 1);
        let column = |m: &Memory, b| (0..m.rows).map(|r| scalar(m.words[word(m, b, r)])).collect::<Vec<Lit>>();
        let gather = |from: &[Lit]| -> Vec<Lit> {
            let at = |row: &u32| from.get((*row as usize).min(from.len().saturating_sub(1)));
            self.rows.iter().map(|row| at(row).copied().unwrap_or(scalar(0))).collect()
        };
        let scatter = |to: &mut [Lit]| {
            for (lane, row) in self.rows.iter().enumerate().filter(|(lane, _)| self.mask[*lane]) {
                if let Some(cell) = to.get_mut(*row as usize) {
                    *cell = self.value[lane];
                }
            }
        };
        let mut results = match form.access {
            Access::Scattered => gather(&column(&memory[0], 0)),
            Access::Run => self.value.clone(),
        };
        let mut stream = column(&memory[1], 1);
        results.extend(gather(&stream));
        scatter(&mut stream);
        results.extend(gather(&stream));
        for (row, lit) in (0..).zip(&stream) {
            let at = word(&memory[1], 1, row);
            memory[1].words[at] = lit.word();
        }
        let mut array = vec![scalar(0); LEN as usize];
        scatter(&mut array);
        results.extend(gather(&array));
        (results, memory)
    }
}

/// Every pattern of few lanes; of many, some, all and none.
fn masks(lanes: usize) -> Vec<u32> {
    let all = (1u32 << lanes) - 1;
    if lanes <= 8 {
        return (0..=all).collect();
    }
    (0..lanes).flat_map(|l| [1 << l, all ^ 1 << l, (1 << l) - 1]).chain([all, 0x5555, 0xc3a5]).collect()
}

/// Every engine gives what is expected.
fn check(form: Form, seed: u64) {
    let p = form.program();
    let residual = |p: &Program| {
        let generic = Generic::new(p.clone());
        specialize(&generic, "main", &[Arg::Unknown; 3], &Facts::none(), &Default::default())
            .unwrap_or_else(|e| panic!("{form:?}: {e}"))
            .program
    };
    let once = residual(&p);
    assert_eq!(print(&residual(&once)), print(&once), "specialising again changes nothing: {form:?}");
    let code = |opt| {
        let options = cranelift::Options { opt, verify: true, ..Default::default() };
        cranelift::compile(&[&p], &options).unwrap_or_else(|e| panic!("{form:?}: {e}"))
    };
    let (fast, plain) = (code(cranelift::Opt::Speed), code(cranelift::Opt::None));
    let entry = |p: &Program| p.entry("main").expect("there is a main");
    let mut c = Choices::random(seed);
    for mask in masks(form.lanes) {
        let input = Input::new(form, &p, mask, &mut c);
        let (args, expected) = (input.arguments(form), input.expected(form, &p));
        let say = |engine: &str| format!("{engine}, {form:?}, rows {:?}, mask {:?}", input.rows, input.mask);
        for (name, program) in [("interpreter", &p), ("residual", &once)] {
            let mut memory = input.memory.clone();
            let results = run(program, entry(program), &args, &mut memory, Limits::default()).expect("it runs");
            assert_eq!((results, memory), expected, "{}", say(name));
        }
        for code in [&fast, &plain] {
            let mut memory = input.memory.clone();
            let kernel = code.kernel("main").expect("main is compiled");
            let results = call(kernel, &p, entry(&p), &args, &mut memory).expect("it runs");
            assert_eq!((results, memory), expected, "{}", say("machine code"));
        }
    }
}

fn forms(access: Access) -> Vec<Form> {
    let lanes = [2, 4, 8, 16].into_iter().zip(["rows", "columns"].into_iter().cycle());
    let of = |(lanes, layout)| Scalar::ALL.map(|scalar| Form { scalar, lanes, access, layout });
    lanes.flat_map(of).collect()
}

#[test]
fn gathers_and_scatters_agree() {
    println!("seed 1");
    forms(Access::Scattered).into_iter().for_each(|form| check(form, 1));
}

#[test]
fn runs_agree() {
    println!("seed 2");
    forms(Access::Run).into_iter().for_each(|form| check(form, 2));
}

/// A lane that is out of range where nothing is clamped is a fault, and no other lane hides it.
#[test]
fn unchecked_lanes_must_be_in_range() {
    let text = |index: &str| {
        format!(
            "jerboa-ir 1\ntable t by rows\n  x: f32 bulk\nentry main = main
fun main(at: {index}, return: fn(f32x4))
  load unchecked t.x at -> got
  rest got(x: f32x4)
  jump return(x)\n"
        )
    };
    let words = [1.0f32, -0.0, 2.5, f32::INFINITY, 4.0].map(f32::to_bits).to_vec();
    let interpret = |index: &str, at: &[u32]| {
        let p = parse(&text(index)).expect("it is a program");
        let args: Vec<Lit> = at.iter().map(|i| Lit::U32(*i)).collect();
        let mut memory = [Memory { rows: 5, words: words.clone() }];
        run(&p, p.entry("main").expect("there is a main"), &args, &mut memory, Limits::default())
    };
    let x = [4.0, -0.0, f32::INFINITY, 1.0].map(Lit::f32).to_vec();
    assert_eq!(interpret("u32x4", &[4, 1, 3, 0]), Ok(x));
    let x = [-0.0, 2.5, f32::INFINITY, 4.0].map(Lit::f32).to_vec();
    assert_eq!(interpret("u32", &[1]), Ok(x));
    for (index, at) in [("u32x4", &[4, 1, 5, 0][..]), ("u32", &[2]), ("u32", &[u32::MAX])] {
        let stop = interpret(index, at).expect_err("it is out of range");
        assert!(stop.to_string().contains("unchecked read of `t` at"), "{stop}");
    }
}

/// Local arrays at indices of which the program says how large they are at most: elements and runs that are surely there,
/// that just are not, and that are stored between a load and the use of its value.
#[test]
fn bounded_indices_of_local_arrays_agree() {
    use jerboa_ir::lang::{Block, F32, Fun, U32, Vector, build, entry};
    let body = |b: &mut Block, (x, y): (U32, U32)| -> (U32, Vector<F32, 4>) {
        let (words, floats) = (b.array::<U32>(LEN), b.array::<F32>(2 * LEN));
        let mut sum = U32::from(0);
        for offset in 0..=LEN {
            // At most 3 + offset: from offset 3 on it may lie beyond the end.
            let at = (x & 3) + offset;
            let before = b.get(words, at);
            b.set(words, at, y + offset);
            let after = b.get(words, at);
            sum = sum * 31 + before * 7 + after;
            b.set(floats, (x & 1) * 5 + offset, after.to_f32());
        }
        // At most 8, the last run that fits, and 9.
        let mut runs = Vector::<F32, 4>::splat(0.0);
        for offset in [5, 6] {
            let at = (x & 3) + offset;
            let run = b.get_run(floats, at);
            b.set_run(floats, at, run + Vector::splat(1.0));
            runs = runs + run + b.get_run(floats, at);
        }
        (sum, runs)
    };
    let p = build(|| entry("main", Fun::<(U32, U32), (U32, Vector<F32, 4>)>::named("main", body)));
    let generic = Generic::new(p);
    let residual = specialize(&generic, "main", &[Arg::Unknown; 2], &Facts::none(), &Default::default());
    let p = residual.expect("it is small").program;
    let code = cranelift::compile(&[&p], &Default::default()).expect("it compiles");
    let main = p.entry("main").expect("there is a main");
    for x in 0..8 {
        let len = LEN as usize;
        let (mut words, mut floats, mut sum) = (vec![0; len], vec![0.0; 2 * len], 0_u32);
        for offset in 0..=len {
            let at = (x & 3) as usize + offset;
            let before = words[at.min(len - 1)];
            if let Some(word) = words.get_mut(at) {
                *word = 100 + offset as u32;
            }
            let after = words[at.min(len - 1)];
            sum = sum.wrapping_mul(31).wrapping_add(before * 7 + after);
            floats[(x & 1) as usize * 5 + offset] = after as f32;
        }
        let mut runs = [0.0; 4];
        for offset in [5, 6] {
            let at = |lane: usize| (x & 3) as usize + offset + lane;
            let last = 2 * len - 1;
            let run = [0, 1, 2, 3].map(|lane| floats[at(lane).min(last)]);
            (0..4).filter(|lane| at(*lane) <= last).for_each(|lane| floats[at(lane)] = run[lane] + 1.0);
            runs = std::array::from_fn(|lane| runs[lane] + run[lane] + floats[at(lane).min(last)]);
        }
        let expected: Vec<Lit> = [Lit::U32(sum)].into_iter().chain(runs.map(Lit::f32)).collect();
        let args = [Lit::U32(x), Lit::U32(100)];
        assert_eq!(run(&p, main, &args, &mut [], Limits::default()), Ok(expected.clone()), "interpreter, {x}");
        let kernel = code.kernel("main").expect("main is compiled");
        assert_eq!(call(kernel, &p, main, &args, &mut []), Ok(expected), "machine code, {x}");
    }
}
