//! The functions of the math library, one row each, and how they are measured (T18).
//!
//! A row of [`FUNCTIONS`] adds a function to all of its tests: [`Function::sweep`] over arguments spread over all bit
//! patterns, [`Function::exhaust`] over every one of them (the command `sweep`), and [`Function::special`], which compares
//! special values on every engine.

use jerboa_ir::Lit;
use jerboa_ir::lang::{F32, build};
use jerboa_lib_render::core::math;

use super::bench::Random;
use super::sweep::{Left, Right, Sweep};
use crate::values::FLOATS;

/// A function of one or two floats.
pub struct Function {
    /// Name.
    pub name: &'static str,
    /// The function. One argument: the second is not looked at.
    pub build: fn(F32, F32) -> F32,
    /// What it should be, special values included: NaN, infinity and the sign of zero are demanded as they are here.
    pub truth: fn(f64, f64) -> f64,
    /// In which unit errors are measured.
    pub measure: Measure,
    /// Largest error, over all arguments.
    pub bound: f64,
    /// Arguments of a function of two: where it is hard. Half of the arguments are random bit patterns instead.
    pub hard: Option<fn(&mut Random) -> [f32; 2]>,
    /// Arguments, and the very float they must give; more than the truth says.
    pub exact: &'static [([f32; 2], f32)],
}

/// A unit of errors.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Measure {
    /// The spacing of floats at the true value; 2^-149 among denormals.
    Ulp,
    /// 1.
    Absolute,
}

/// Where [`math::sincos`] and [`math::tan`] end.
const FAR: f64 = 2048.0 * std::f64::consts::PI;

fn near(x: f64, f: fn(f64) -> f64) -> f64 {
    if x.abs() < FAR { f(x) } else { f64::NAN }
}

/// A float of any magnitude and sign, none rarer than another.
fn any(random: &mut Random) -> f32 {
    f32::from_bits(random.bits() as u32)
}

/// Sine and cosine of so many turns; exact at quarters, as f64 is not. The sign of a zero argument is lost.
fn turn(u: f64) -> (f64, f64) {
    let quarters = (u * 4.0).round_ties_even();
    let (s, c) = ((u - quarters * 0.25) * std::f64::consts::TAU).sin_cos();
    match quarters.rem_euclid(4.0) as u32 {
        0 => (s + 0.0, c),
        1 => (c, -s),
        2 => (-s, -c),
        _ => (-c, s),
    }
}

/// The math library.
pub const FUNCTIONS: &[Function] = &[
    Function {
        name: "sin",
        build: |x, _| math::sincos(x).0,
        // The sign of a zero is lost.
        truth: |x, _| near(x, |x| x.sin() + 0.0),
        measure: Measure::Absolute,
        bound: 8.4e-8,
        hard: None,
        exact: &[],
    },
    Function {
        name: "cos",
        build: |x, _| math::sincos(x).1,
        truth: |x, _| near(x, f64::cos),
        measure: Measure::Absolute,
        bound: 8.6e-8,
        hard: None,
        exact: &[([0.0, 0.0], 1.0)],
    },
    Function {
        name: "tan",
        build: |x, _| math::tan(x),
        truth: |x, _| near(x, |x| x.tan() + 0.0),
        measure: Measure::Ulp,
        bound: 3.6,
        hard: None,
        exact: &[],
    },
    Function {
        name: "sin_turns",
        build: |x, _| math::sincos_turns(x).0,
        truth: |x, _| turn(x).0,
        measure: Measure::Absolute,
        bound: 9.3e-8,
        hard: None,
        exact: &[([0.25, 0.0], 1.0), ([0.5, 0.0], -0.0), ([0.75, 0.0], -1.0), ([1e30, 0.0], 0.0)],
    },
    Function {
        name: "cos_turns",
        build: |x, _| math::sincos_turns(x).1,
        truth: |x, _| turn(x).1,
        measure: Measure::Absolute,
        bound: 9.3e-8,
        hard: None,
        exact: &[([0.25, 0.0], -0.0), ([0.5, 0.0], -1.0), ([0.75, 0.0], 0.0), ([1e30, 0.0], 1.0)],
    },
    Function {
        name: "asin",
        build: |x, _| math::asin(x),
        truth: |x, _| x.asin(),
        measure: Measure::Ulp,
        bound: 2.5,
        hard: None,
        exact: &[],
    },
    Function {
        name: "acos",
        build: |x, _| math::acos(x),
        truth: |x, _| x.acos(),
        measure: Measure::Ulp,
        bound: 1.3,
        hard: None,
        exact: &[([1.0, 0.0], 0.0)],
    },
    Function {
        name: "exp",
        build: |x, _| math::exp(x),
        truth: |x, _| x.exp(),
        measure: Measure::Ulp,
        bound: 1.0,
        hard: None,
        exact: &[([0.0, 0.0], 1.0), ([-0.0, 0.0], 1.0)],
    },
    Function {
        name: "exp2",
        build: |x, _| math::exp2(x),
        truth: |x, _| x.exp2(),
        measure: Measure::Ulp,
        bound: 1.3,
        hard: None,
        exact: &[([3.0, 0.0], 8.0), ([-126.0, 0.0], f32::MIN_POSITIVE), ([-149.0, 0.0], 1e-45), ([0.0, 0.0], 1.0)],
    },
    Function {
        name: "exp_m1",
        build: |x, _| math::exp_m1(x),
        truth: |x, _| x.exp_m1(),
        measure: Measure::Ulp,
        bound: 2.5,
        hard: None,
        exact: &[([-104.0, 0.0], -1.0)],
    },
    Function {
        name: "log",
        build: |x, _| math::log(x),
        truth: |x, _| x.ln(),
        measure: Measure::Ulp,
        bound: 0.83,
        hard: None,
        exact: &[([1.0, 0.0], 0.0)],
    },
    Function {
        name: "log2",
        build: |x, _| math::log2(x),
        truth: |x, _| x.log2(),
        measure: Measure::Ulp,
        bound: 1.46,
        hard: None,
        exact: &[([1.0, 0.0], 0.0), ([8.0, 0.0], 3.0), ([1e-45, 0.0], -149.0)],
    },
    Function {
        name: "log1p",
        build: |x, _| math::log1p(x),
        truth: |x, _| x.ln_1p(),
        measure: Measure::Ulp,
        bound: 2.5,
        hard: None,
        exact: &[],
    },
    Function {
        name: "pow",
        build: math::pow,
        // Negative zero counts as zero, other negative numbers have no power but the zeroth.
        truth: |x, y| if x < 0.0 && y != 0.0 { f64::NAN } else { x.abs().powf(y) },
        measure: Measure::Ulp,
        bound: 1.4,
        hard: Some(|random| {
            let x = any(random).abs();
            let x = if random.below(2) == 0 { x } else { 0.9 + 0.2 * random.uniform() as f32 };
            // Where x^y goes from 2^-150 to 2^128.
            [x, ((random.uniform() * 278.0 - 150.0) / f64::from(x).log2()) as f32]
        }),
        exact: &[],
    },
    Function {
        name: "atan2",
        build: math::atan2,
        truth: f64::atan2,
        measure: Measure::Ulp,
        bound: 2.9,
        hard: Some(|random| {
            let (s, c) = (random.uniform() * std::f64::consts::TAU).sin_cos();
            let scale = (random.uniform() * 250.0 - 125.0).exp2();
            [(s * scale) as f32, (c * scale) as f32]
        }),
        exact: &[],
    },
];

/// The largest error found, and where.
#[derive(Clone, Copy, Debug, Default)]
pub struct Worst {
    /// In units of the measure; infinite where a special value is wrong.
    pub error: f64,
    /// The arguments.
    pub at: [f32; 2],
    /// What the function gave.
    pub got: f32,
    /// How many arguments were tried.
    pub tried: u64,
}

impl Worst {
    fn and(self, o: Worst) -> Worst {
        let worse = if o.error > self.error { o } else { self };
        Worst { tried: self.tried + o.tried, ..worse }
    }
}

impl Function {
    /// How far off this value is.
    fn error(&self, got: f32, truth: f64) -> f64 {
        if truth.is_nan() || got.is_nan() || truth == 0.0 {
            let right = truth.is_nan() && got.is_nan() || got.to_bits() == (truth as f32).to_bits();
            // Of a zero that only f64 sees as such, as cos(π/2), the sign is nobody's.
            return if right { 0.0 } else { f64::INFINITY };
        }
        // Infinity is 2^128, where the spacing is that of the largest float; far beyond, nothing else will do.
        let top = 2f64.powi(128);
        let got = if got.is_infinite() { top.copysign(got.into()) } else { got.into() };
        let truth = truth.clamp(-top * (1.0 + 2f64.powi(-19)), top * (1.0 + 2f64.powi(-19)));
        if got.abs() == top && truth.abs() > top {
            return if (got > 0.0) == (truth > 0.0) { 0.0 } else { f64::INFINITY };
        }
        let exponent = ((truth.to_bits() >> 52 & 0x7ff) as i32 - 1023).clamp(-126, 127);
        match self.measure {
            Measure::Ulp => (got - truth).abs() * 2f64.powi(23 - exponent),
            Measure::Absolute => (got - truth).abs(),
        }
    }

    /// The function as machine code.
    fn compile(&self) -> Sweep {
        let build = self.build;
        Sweep::new(|b, cell, ()| {
            let x: jerboa_ir::lang::U32 = b.load(Left::WORD, cell);
            let y: jerboa_ir::lang::U32 = b.load(Right::WORD, cell);
            build(x.float_of_bits(), y.float_of_bits()).bits()
        })
    }

    /// The worst of these arguments.
    fn worst(&self, kernel: &Sweep, xs: &[u32], ys: &[u32]) -> Worst {
        let mut words = vec![0; xs.len()];
        kernel.fill(&[], [xs, ys], &mut words);
        let mut worst = Worst { tried: xs.len() as u64, ..Worst::default() };
        for ((x, y), word) in xs.iter().zip(ys).zip(words) {
            let (x, y, got) = (f32::from_bits(*x), f32::from_bits(*y), f32::from_bits(word));
            let error = self.error(got, (self.truth)(x.into(), y.into()));
            if error > worst.error {
                worst = Worst { error, at: [x, y], got, ..worst };
            }
        }
        worst
    }

    /// The worst of `n` arguments that are spread over all bit patterns; of a function of two, half of them random
    /// patterns and half of them hard.
    pub fn sweep(&self, random: &mut Random, n: usize) -> Worst {
        let kernel = self.compile();
        let step = ((1u64 << 32) / n as u64).max(1) as u32 | 1;
        let mut worst = Worst::default();
        let mut pattern = random.bits() as u32;
        for _ in 0..n.div_ceil(CHUNK) {
            let (mut xs, mut ys) = (vec![], vec![]);
            for i in 0..CHUNK.min(n) {
                pattern = pattern.wrapping_add(step);
                let [x, y] = match self.hard {
                    None => [pattern, 0],
                    Some(hard) if i % 2 == 0 => hard(random).map(f32::to_bits),
                    Some(_) => [random.bits() as u32, random.bits() as u32],
                };
                xs.push(x);
                ys.push(y);
            }
            worst = worst.and(self.worst(&kernel, &xs, &ys));
        }
        worst
    }

    /// The worst of all 2^32 arguments, by two threads. For a function of one.
    pub fn exhaust(&self) -> Worst {
        let kernel = self.compile();
        let half = |first: u32| {
            let ys = vec![0; CHUNK];
            let chunk = |start: u32| {
                let xs: Vec<u32> = (0..CHUNK as u32).map(|i| first + start + i).collect();
                self.worst(&kernel, &xs, &ys)
            };
            (0..1u32 << 31).step_by(CHUNK).map(chunk).fold(Worst::default(), Worst::and)
        };
        std::thread::scope(|scope| {
            let negative = scope.spawn(|| half(1 << 31));
            half(0).and(negative.join().expect("the other half ends"))
        })
    }

    /// Special values, and all pairs of them, by machine code, interpreter and folding: the same bits, and right.
    pub fn special(&self) {
        let more = [std::f32::consts::FRAC_1_SQRT_2, std::f32::consts::PI, 88.722_84, -103.972_08, 1e30, -1e30];
        let xs: Vec<f32> = FLOATS.into_iter().chain(more).collect();
        let others = if self.hard.is_some() { &xs[..] } else { &[0.0] };
        let pairs = xs.iter().flat_map(|x| others.iter().map(|y| [*x, *y]));
        let pairs: Vec<[f32; 2]> = pairs.chain(self.exact.iter().map(|(at, _)| *at)).collect();
        let word = |k: usize| pairs.iter().map(|p| p[k].to_bits()).collect::<Vec<u32>>();
        let inputs = [&word(0)[..], &word(1)[..]];
        let kernel = self.compile();
        let mut compiled = vec![0; pairs.len()];
        kernel.fill(&[], inputs, &mut compiled);
        let interpreted = kernel.interpret(&[], inputs, pairs.len());
        let folded: Vec<u32> = fold(&pairs, self.build).into_iter().map(f32::to_bits).collect();
        for (i, pair) in pairs.iter().enumerate() {
            let engines = [compiled[i], interpreted[i], folded[i]];
            assert!(engines.iter().all(|w| *w == engines[0]), "{}{pair:?}: {engines:x?}", self.name);
            let (got, truth) = (f32::from_bits(compiled[i]), (self.truth)(pair[0].into(), pair[1].into()));
            let error = self.error(got, truth);
            assert!(error <= self.bound, "{}{pair:?} = {got}, not {truth}", self.name);
        }
        let expected = self.exact.iter().map(|(_, y)| y.to_bits());
        let got = &compiled[pairs.len() - self.exact.len()..];
        assert!(expected.eq(got.iter().copied()), "{}: {:?} give the bits {got:x?}", self.name, self.exact);
    }
}

/// What f gives at each pair of arguments, by folding: no engine is needed where all is known.
pub fn fold(pairs: &[[f32; 2]], f: impl Fn(F32, F32) -> F32) -> Vec<f32> {
    let mut nodes = vec![];
    let program = build(|| nodes = pairs.iter().map(|[x, y]| f((*x).into(), (*y).into()).node()).collect());
    let value = |node| match program.as_lit(node) {
        Some(Lit::F32(bits)) => f32::from_bits(bits),
        other => panic!("it does not fold: {other:?}"),
    };
    nodes.into_iter().map(value).collect()
}

/// Arguments at a time: their words fit a core's cache.
const CHUNK: usize = 1 << 16;
