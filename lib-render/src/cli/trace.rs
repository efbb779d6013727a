//! `jerboa trace`: one path, step by step, in the interpreter, and whether machine code agrees.

use std::fmt::Write;

use jerboa_ir::interp::Observer;
use jerboa_ir::{ContId, Lit, NodeId, Program, Role};

use super::args::TraceArgs;
use super::scene::{camera, choices_of, film_size, load};
use crate::host::device::DeviceKind;
use crate::host::error::Error;
use crate::host::film::Window;
use crate::host::generate::{TracerKind, generic};
use crate::host::renderer::{Options, Renderer};
use crate::host::replay::interpret;
use crate::host::tables::Pass;

/// Follow the path of a sample: each function that is entered with its numbers, the first value that is not finite, the
/// radiance, and the radiance by machine code.
pub(super) fn run(args: &TraceArgs) -> Result<String, Error> {
    let (scene, _) = load(&args.scene, &args.select)?;
    let camera = camera(&scene, None)?;
    let size = film_size(&camera, None, None);
    let [x, y] = args.pixel.0;
    if x >= size[0] || y >= size[1] {
        return Err(Error::new(format!("--pixel {x},{y} is not on the film of {}x{}", size[0], size[1])));
    }
    let window = Window { x, y, width: 1, height: 1 };
    let pass = Pass { size, window, sample: args.sample, samples: 1, seed: args.seed };
    let choices = choices_of(&args.sampling);
    let renderer = Renderer::new(&scene, Options { device: DeviceKind::CpuScalar, choices, ..Options::default() })?;
    let program = generic().program();
    let mut steps = Steps { program, text: String::new(), current: None, non_finite: None };
    let kernel = TracerKind::Path.kernel();
    let meant = interpret(program, kernel, renderer.tables(), &camera, &pass, &mut steps)?;
    let compiled = renderer.samples(&camera, &pass)?;
    Ok(steps.finish(&meant, &compiled))
}

/// Writes down what a run enters.
struct Steps<'p> {
    program: &'p Program,
    text: String,
    /// The named function just entered, while its parameters arrive.
    current: Option<ContId>,
    non_finite: Option<(NodeId, f32)>,
}

impl Observer for Steps<'_> {
    fn enter(&mut self, cont: ContId) {
        let c = self.program.cont(cont);
        let shown = c.role == Role::Fun && &*c.name != "lam" && &*c.name != "exits" || c.role == Role::Loop;
        self.current = shown.then_some(cont);
        if shown {
            let _ = write!(self.text, "\n{:<10} {}", c.name, c.loc);
        }
    }

    fn value(&mut self, node: NodeId, lit: Lit) {
        let param = match *self.program.node(node) {
            jerboa_ir::Node::Param { cont, index } => Some((cont, index)),
            _ => None,
        };
        if let (Some(current), Some((cont, index))) = (self.current, param)
            && cont == current
        {
            let name = self.program.cont(cont).params[index as usize].name.as_deref().unwrap_or("_");
            let _ = write!(self.text, "  {name} {lit}");
        }
        if let Some(x) = lit.as_f32()
            && x.is_nan()
            && self.non_finite.is_none()
        {
            self.non_finite = Some((node, x));
        }
    }
}

impl Steps<'_> {
    fn finish(mut self, meant: &[u32], compiled: &[u32]) -> String {
        let rgb = |words: &[u32]| [0, 1, 2].map(|c| f32::from_bits(words[c]));
        let _ =
            write!(self.text, "\nradiance {:?}, {} closest-hit rays, {} shadow rays\n", rgb(meant), meant[3], meant[4]);
        // Comparisons drop a NaN where a ray is parallel to a plane; it matters where it reaches the radiance.
        if let Some((node, x)) = self.non_finite
            && rgb(meant).iter().any(|c| !c.is_finite())
        {
            let _ = writeln!(self.text, "first value that is not a number: {x} at {}", self.program.locs[node.index()]);
        }
        self.text += &match meant.iter().zip(compiled).position(|(a, b)| a != b) {
            None => "machine code gives the same bits\n".to_string(),
            Some(column) => format!("machine code differs first in column {column}: {:?}\n", rgb(compiled)),
        };
        self.text.trim_start().to_string()
    }
}
