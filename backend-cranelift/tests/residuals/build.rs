//! Short ways to write a residual.

use jerboa_backend_cranelift::{Binding, Code, Opt, Options, Status, compile};
use jerboa_ir::interp::{self, Memory};
use jerboa_ir::*;

/// A residual under construction.
#[derive(Default)]
pub struct Build {
    pub w: World,
}

impl Build {
    /// A continuation with parameters of these types; its filter is `false`.
    pub fn cont(&mut self, name: &str, role: Role, params: &[Ty]) -> ContId {
        let params = params.iter().map(|ty| Param { ty: *ty, name: None, keep: false }).collect();
        let cont = self.w.cont(name, role, params, Loc::NONE);
        let never = self.w.lit(Lit::Bool(false));
        self.w.cont_mut(cont).filter = never;
        cont
    }

    /// A function of these parameters and results.
    pub fn fun(&mut self, name: &str, params: &[Ty], results: &[Ty]) -> ContId {
        let params: Vec<Ty> = params.iter().copied().chain([Ty::func(results)]).collect();
        self.cont(name, Role::Fun, &params)
    }

    /// A function that is an entry.
    pub fn entry(&mut self, name: &str, params: &[Ty], results: &[Ty]) -> ContId {
        let cont = self.fun(name, params, results);
        self.w.entry(name, cont);
        cont
    }

    pub fn block(&mut self, params: &[Ty]) -> ContId {
        self.cont("block", Role::Join, params)
    }

    pub fn param(&mut self, cont: ContId, index: usize) -> NodeId {
        self.w.param(cont, index)
    }

    pub fn u32(&mut self, x: u32) -> NodeId {
        self.w.lit(Lit::U32(x))
    }

    pub fn op(&mut self, op: Op, args: &[NodeId]) -> NodeId {
        self.w.prim(op, args, Loc::NONE)
    }

    pub fn value(&mut self, cont: ContId) -> NodeId {
        self.w.cont_value(cont)
    }

    pub fn body(&mut self, cont: ContId, body: Body) {
        self.w.set_body(cont, body, Loc::NONE);
    }

    pub fn jump_to(&mut self, from: ContId, callee: NodeId, args: &[NodeId]) {
        self.body(from, Body::Jump { callee, args: args.to_vec(), mode: Mode::Filter });
    }

    pub fn jump(&mut self, from: ContId, to: ContId, args: &[NodeId]) {
        let to = self.value(to);
        self.jump_to(from, to, args);
    }

    /// Leaves `from`, a block of the function `fun`, with results.
    pub fn ret(&mut self, from: ContId, fun: ContId, results: &[NodeId]) {
        let last = self.w.program().cont(fun).params.len() - 1;
        let ret = self.param(fun, last);
        self.jump_to(from, ret, results);
    }

    /// Calls a function; `back` takes the results.
    pub fn call(&mut self, from: ContId, callee: ContId, args: &[NodeId], back: ContId) {
        let mut args = args.to_vec();
        args.push(self.value(back));
        self.jump(from, callee, &args);
    }

    /// Calls a function whose results are those of `fun`.
    pub fn tail_call(&mut self, from: ContId, fun: ContId, callee: ContId, args: &[NodeId]) {
        let last = self.w.program().cont(fun).params.len() - 1;
        let mut args = args.to_vec();
        args.push(self.param(fun, last));
        self.jump(from, callee, &args);
    }

    pub fn branch(&mut self, from: ContId, cond: NodeId, then: ContId, other: ContId) {
        let (then, other) = (self.value(then), self.value(other));
        self.body(from, Body::Branch { cond, then, other });
    }

    pub fn load(&mut self, from: ContId, mem: Mem, index: NodeId, next: ContId) {
        let next = self.value(next);
        self.body(from, Body::Load { mem, index, next });
    }

    pub fn local(&mut self, from: ContId, scalar: Scalar, len: u32, next: ContId) {
        let next = self.value(next);
        self.body(from, Body::Local { scalar, len, next });
    }

    pub fn buffer(&mut self, kind: BufKind, layout: Layout, columns: &[Scalar]) -> BufId {
        let column = |s: &Scalar| ColumnDecl { name: s.name().into(), ty: ColTy::Scalar(*s), time: Time::Bulk };
        let columns = columns.iter().map(column).collect();
        self.w.buffer(Buffer { name: "buffer".into(), kind, layout, columns })
    }

    pub fn finish(self) -> Program {
        self.w.finish()
    }
}

/// Machine code, with the verifier on.
pub fn code(p: &Program, opt: Opt) -> Code {
    compile(&[p], &Options { opt, verify: true, ..Default::default() }).unwrap_or_else(|e| panic!("{e}"))
}

/// Runs a kernel over memory given as (rows, words).
pub fn run(code: &Code, name: &str, args: &[Lit], memory: &mut [(u32, Vec<u32>)]) -> Result<Vec<u32>, Status> {
    let kernel = code.kernel(name).expect("it was compiled");
    let bindings: Vec<Binding> = memory.iter_mut().map(|(rows, words)| Binding::new(words, *rows)).collect();
    let args: Vec<u32> = args.iter().map(|a| a.word()).collect();
    let mut results = vec![0; kernel.results()];
    // SAFETY: every test binds all buffers that it declares, with as many words as rows times columns.
    match unsafe { kernel.call(&bindings, &args, &mut results) } {
        Status::Done => Ok(results),
        limit => Err(limit),
    }
}

/// Runs an entry of a residual in the interpreter and as machine code, unoptimised and optimised, and asserts that
/// results and memory are the same. Gives the results; none if the machine code met the depth limit.
pub fn agree(p: &Program, entry: &str, args: &[Lit], memory: &[Memory]) -> Option<Vec<Lit>> {
    let mut expected_memory = memory.to_vec();
    let cont = p.entry(entry).expect("it is an entry");
    let expected = interp::run(p, cont, args, &mut expected_memory, interp::Limits::default());
    let expected = expected.unwrap_or_else(|stop| panic!("{entry} {args:?}: {stop}"));
    let mut limit = false;
    for opt in [Opt::None, Opt::Speed] {
        let code = code(p, opt);
        let mut got_memory: Vec<(u32, Vec<u32>)> = memory.iter().map(|m| (m.rows, m.words.clone())).collect();
        let Ok(words) = run(&code, entry, args, &mut got_memory) else {
            limit = true;
            continue;
        };
        let got: Vec<Lit> = words.iter().zip(&expected).map(|(w, e)| Lit::from_word(e.scalar(), *w)).collect();
        assert_eq!(got, expected, "{entry} {args:?} at {opt:?}");
        for (i, (got, expected)) in got_memory.iter().zip(&expected_memory).enumerate() {
            assert_eq!(got.1, expected.words, "buffer {i} after {entry} {args:?} at {opt:?}");
        }
    }
    (!limit).then_some(expected)
}

/// A residual from its text.
pub fn residual(text: &str) -> Program {
    parse(&format!("jerboa-ir 1\n{text}")).unwrap_or_else(|e| panic!("{e}"))
}
