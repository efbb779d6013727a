//! Kernels on a GPU, or on lavapipe where there is none: memory, launches, their order, and what goes wrong.
//!
//! Where no adapter is, each test says that it is skipped; with `CI=true` it fails instead.

mod launches;
mod memory;
mod failures;

use std::sync::{Arc, OnceLock};

use jerboa_backend_spirv::gpu::{Bound, Choice, Error, Extent, Gpu, Kernel, Launch, Memory};
use jerboa_backend_spirv::{Grid, Options, Packing, emit};

/// The adapter, opened once for all tests.
fn gpu() -> Option<&'static Arc<Gpu>> {
    static GPU: OnceLock<Result<Arc<Gpu>, Error>> = OnceLock::new();
    match GPU.get_or_init(|| Gpu::open(&Choice::Any)) {
        Ok(gpu) => Some(gpu),
        Err(error) => {
            assert_ne!(std::env::var("CI").as_deref(), Ok("true"), "{error}");
            let name = std::thread::current().name().map(String::from);
            println!("skipped: {}: {error}", name.as_deref().unwrap_or("a test"));
            None
        }
    }
}

/// Kernels over a table `t`, a stream `grid` and a stream `s`, each in a storage buffer of its own.
const KERNELS: &str = "jerboa-ir 1
table t by rows
  x: u32 bulk
stream grid by rows
  x: u32 bulk
  y: u32 bulk
  z: u32 bulk
stream s by rows
  x: u32 bulk
entry number = number
entry add = add
entry double = double
entry grids = grids
entry sum = sum

; s[i] = t[i] + i
fun number(i: u32, n: u32, return: fn())
  inside = lt i n
  branch inside yes no
  join yes()
    x = read t.x i
    y = add x i
    store s.x i y -> no
  join no()
    jump return()

; s[i] += k, for every invocation that there is
fun add(i: u32, k: u32, return: fn())
  load s.x i -> loaded
  rest loaded(x: u32)
  y = add x k
  store s.x i y -> stored
  rest stored()
  jump return()

; s[i] *= 2, for every invocation that there is
fun double(i: u32, return: fn())
  load s.x i -> loaded
  rest loaded(x: u32)
  y = add x x
  store s.x i y -> stored
  rest stored()
  jump return()

; Invocation 0 says that s[at] workgroups follow.
fun grids(i: u32, at: u32, return: fn())
  first = eq i 0u
  branch first yes no
  join yes()
    load s.x at -> loaded
    join loaded(x: u32)
    store grid.x 0u x -> y
    join y()
    store grid.y 0u 1u -> z
    join z()
    store grid.z 0u 1u -> no
  join no()
    jump return()

fun sum(a: u32, b: f32, return: fn(u32, f32))
  x = add a 1u
  y = add b 0.5
  jump return(x, y)
";

/// An entry of [`KERNELS`]; tables in binding 1, streams in the binding that is given for each.
fn kernel(gpu: &Gpu, entry: &str, streams: [u32; 2]) -> Kernel {
    let program = jerboa_ir::parse(KERNELS).expect("it parses");
    assert_eq!(jerboa_ir::verify(&program), []);
    let grid = if entry == "sum" { Grid::Single } else { Grid::Items };
    let packing = Packing(vec![1, streams[0], streams[1]]);
    let module = emit(&program, entry, &Options { grid, packing, ..Options::default() });
    gpu.kernel(&module.unwrap_or_else(|e| panic!("{e}"))).unwrap_or_else(|e| panic!("{e}"))
}

/// The buffers of [`KERNELS`], in memories of their own.
struct Buffers {
    table: Memory,
    grid: Memory,
    stream: Memory,
}

impl Buffers {
    fn new(gpu: &Gpu, rows: u32) -> Buffers {
        let memory = |words: u32| gpu.memory(words.into()).unwrap_or_else(|e| panic!("{e}"));
        Buffers { table: memory(rows), grid: memory(3), stream: memory(rows) }
    }

    fn bound(&self) -> [Bound<'_>; 3] {
        let rows = self.stream.words();
        [(&self.table, rows), (&self.grid, 1), (&self.stream, rows)].map(|(memory, rows)| Bound {
            memory,
            start: 0,
            rows,
        })
    }
}

/// A launch without results.
fn launch<'a>(kernel: &'a Kernel, arguments: &[u32], buffers: &'a [Bound], extent: Extent<'a>) -> Launch<'a> {
    Launch { kernel, arguments: arguments.into(), buffers, results: None, extent }
}
