//! Whole renders with one remedy replaced at a time.

use std::sync::Arc;

use jerboa_backend_cranelift as cranelift;
use jerboa_ir::lang::{Buf, Exit, F32, build};
use jerboa_lib_render::camera::make_camera;
use jerboa_lib_render::core::color::Color;
use jerboa_lib_render::core::vec::Vec3;
use jerboa_lib_render::device::cpu::trace_with;
use jerboa_lib_render::host::film::{Film, Window};
use jerboa_lib_render::host::tables::{Choices, Known, Pass, Tables, frame};
use jerboa_lib_render::ray::Ray;
use jerboa_lib_render::schema::{Frame, Samples, binding, declare_all};
use jerboa_lib_render::tracer::path::make_path_tracer;
use jerboa_lib_render::tracer::{OnBounceFn, OnShadowFn, RayState, Tracer};
use jerboa_lib_render::traverse::make_traverse;
use jerboa_peval::{Arg, Generic, specialize};
use jerboa_scenes::{Camera, Scene};
use jerboa_tests::harness::clock::processor_time;
use jerboa_tests::harness::naive::{self, BoxTest, TriangleTest};

/// What is replaced.
#[derive(Clone, Copy, PartialEq)]
enum Variant {
    Robust,
    MoellerTrumbore,
    PlainBoxes,
    AbsoluteStart,
    FreeNormals,
    F32Film,
    All,
}

const VARIANTS: [(Variant, &str); 7] = [
    (Variant::Robust, "nothing"),
    (Variant::MoellerTrumbore, "Woop by Möller-Trumbore"),
    (Variant::PlainBoxes, "padded boxes by plain ones"),
    (Variant::AbsoluteStart, "bounded offsets by 1e-3"),
    (Variant::FreeNormals, "consistent shading normals by free ones"),
    (Variant::F32Film, "the exact film by sums in f32"),
    (Variant::All, "all of these"),
];

/// Side of the film, and samples per pixel of a pass over it.
const SIDE: u32 = 96;
const SAMPLES: u32 = 8;

/// Prints a row for each scene and variant.
pub fn table(args: &[&str]) -> Result<(), String> {
    let mut rounds = 15;
    let mut scenes = Vec::new();
    let mut words = args.iter();
    while let Some(word) = words.next() {
        match *word {
            "--rounds" => {
                let n = words.next().ok_or("--rounds needs a number")?;
                rounds = n.parse().map_err(|e| format!("--rounds {n}: {e}"))?;
            }
            scene => scenes.push(scene),
        }
    }
    if scenes.is_empty() {
        scenes = vec!["builtin:cornell-box", "builtin:material-balls"];
    }
    println!(
        "| scene | replaced | median, ms | quartiles, ms | median of the ratio to the robust render of the round |"
    );
    println!("|---|---|---|---|---|");
    for name in scenes {
        let scene = Scene::load(name).map_err(|e| e.to_string())?;
        let mut kernels = VARIANTS.map(|(variant, _)| Kernel::new(&scene, variant));
        let mut times = vec![Vec::new(); VARIANTS.len()];
        for _ in 0..rounds {
            for (kernel, times) in kernels.iter_mut().zip(&mut times) {
                let start = processor_time();
                kernel.render();
                times.push(1e3 * (processor_time() - start));
            }
        }
        let robust = times[0].clone();
        for ((_, what), times) in VARIANTS.iter().zip(times) {
            let ratios = times.iter().zip(&robust).map(|(t, r)| t / r).collect();
            let [low, median, high] = quartiles(times);
            println!("| {} | {what} | {median:.1} | {low:.1} to {high:.1} | {:.3} |", scene.name, quartiles(ratios)[1]);
        }
    }
    Ok(())
}

fn quartiles(mut x: Vec<f64>) -> [f64; 3] {
    x.sort_by(f64::total_cmp);
    [1, 2, 3].map(|q| x[q * (x.len() - 1) / 4])
}

/// The ray, started from `point` by an absolute length, as renderers with a fixed epsilon do.
pub fn absolute(point: Vec3, ray: Ray) -> Ray {
    Ray { org: point + ray.dir * F32::from(1e-3), ..ray }
}

/// A path tracer whose rays start so. (Where a shadow ray ends at a light stays as it is.)
fn with_absolute_starts(tracer: Tracer) -> Tracer {
    Tracer {
        on_shadow: OnShadowFn::exits(move |b, (ray, hit, state, surf, mat, emit, skip)| {
            let moved =
                Exit::exits(|b, (shadow, light): (Ray, Color)| emit.take(b, (absolute(surf.point, shadow), light)));
            tracer.on_shadow.take(b, (ray, hit, state, surf, mat, moved, skip))
        }),
        on_bounce: OnBounceFn::exits(move |b, (ray, hit, state, surf, mat, next, end)| {
            let moved = Exit::exits(|b, (on, state): (Ray, RayState)| next.take(b, (absolute(surf.point, on), state)));
            tracer.on_bounce.take(b, (ray, hit, state, surf, mat, moved, end))
        }),
        ..tracer
    }
}

/// A renderer of one scene.
struct Kernel {
    tables: Tables,
    code: cranelift::Code,
    camera: Camera,
    exact_film: bool,
}

impl Kernel {
    fn new(scene: &Scene, variant: Variant) -> Kernel {
        let is = |v: Variant| variant == v || variant == Variant::All;
        let choices = Choices { consistent_normals: !is(Variant::FreeNormals), ..Choices::default() };
        let tables = Tables::new(scene, &choices, Known::Structure);
        let boxes = if is(Variant::PlainBoxes) { BoxTest::Plain } else { BoxTest::Padded };
        let triangles =
            if is(Variant::MoellerTrumbore) { TriangleTest::MoellerTrumbore } else { TriangleTest::Watertight };
        let program = build(|| {
            declare_all();
            let tracer = make_path_tracer(make_camera());
            let tracer = if is(Variant::AbsoluteStart) { with_absolute_starts(tracer) } else { tracer };
            // What replaces a part of the walk is to be compared with the copy that it replaces it in.
            let own = matches!(variant, Variant::MoellerTrumbore | Variant::PlainBoxes | Variant::All);
            trace_with("path", tracer, if own { naive::make_traverse(boxes, triangles) } else { make_traverse() });
        });
        let options = jerboa_peval::Options::default();
        let residual =
            specialize(&Generic::new(program), "path", &[Arg::Unknown, Arg::Unknown], &tables.facts, &options)
                .unwrap_or_else(|e| panic!("{}: {e}", scene.name));
        let code = cranelift::compile(&[&residual.program], &cranelift::Options::default()).expect("it compiles");
        Kernel { tables, code, camera: scene.camera_or_default(), exact_film: !is(Variant::F32Film) }
    }

    /// One pass over the film, summed.
    fn render(&mut self) {
        let items = SIDE * SIDE * SAMPLES;
        let window = Window { x: 0, y: 0, width: SIDE, height: SIDE };
        let pass = Pass { size: [SIDE; 2], window, sample: 0, samples: SAMPLES, seed: 0 };
        let mut frame = frame(&self.camera, self.tables.place(&self.camera), &pass).words;
        let mut samples = vec![0_u32; items as usize * Samples::COLUMNS.len()];
        let memory = self.tables.memory.iter_mut().map(Arc::make_mut);
        let mut bindings: Vec<_> = memory.map(|m| cranelift::Binding::new(&mut m.words, m.rows)).collect();
        bindings[binding::<Frame>()] = cranelift::Binding::new(&mut frame, 1);
        bindings[binding::<Samples>()] = cranelift::Binding::new(&mut samples, items);
        let kernel = self.code.kernel("path").expect("it was compiled under this name");
        // SAFETY: the bindings are those of `Renderer::call`: each holds as many rows as it says, of the schema's columns;
        // only the stream is written, and nobody else has it; the main thread has the stack that Rust gives it.
        let status = unsafe { kernel.call(&bindings, &[0, items], &mut []) };
        assert_eq!(status, cranelift::Status::Done);
        let colour = |i: u32| [0, 1, 2].map(|c| f32::from_bits(samples[(c * items + i) as usize]));
        let at = |i: u32| i / SAMPLES;
        if self.exact_film {
            let mut film = Film::of_size([SIDE; 2]);
            (0..items).for_each(|i| film.add([at(i) % SIDE, at(i) / SIDE], colour(i)));
            std::hint::black_box(film);
        } else {
            let mut film = vec![[0.0_f32; 3]; (SIDE * SIDE) as usize];
            for i in 0..items {
                film[at(i) as usize].iter_mut().zip(colour(i)).for_each(|(sum, x)| *sum += x);
            }
            std::hint::black_box(film);
        }
    }
}
