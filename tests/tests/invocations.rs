//! The GPU devices without a GPU: their kernels compiled for the CPU, one invocation after the other. The film is that of the
//! CPU device to the bit, so the kernels and the schedule are right; what is left to a GPU is to do what they say.

use std::ops::Range;
use std::sync::Arc;

use jerboa_backend_cranelift::{Binding, Status};
use jerboa_ir::lang::Buf;
use jerboa_ir::print;
use jerboa_lib_render::device::wavefront::GROUP;
use jerboa_lib_render::host::device::DeviceKind;
use jerboa_lib_render::host::error::Error;
use jerboa_lib_render::host::film::{Film, Window};
use jerboa_lib_render::host::generate::{Generated, Keep, TracerKind, every_gpu_entry, generate, gpu_generic};
use jerboa_lib_render::host::gpu::{Device, Extent, Launch, Machine, Schedule};
use jerboa_lib_render::host::renderer::{Handle, Options, Renderer};
use jerboa_lib_render::host::tables::memory::Memory;
use jerboa_lib_render::host::tables::{Choices, Known, Pass, Tables, frame};
use jerboa_lib_render::schema::{BUFFERS, Frame, Next, Paths, Ranges, binding};
use jerboa_scenes::{Scene, builtin};

/// Runs each invocation of a launch in turn.
struct OneByOne {
    kernels: Vec<Arc<Generated>>,
    memory: Vec<Memory>,
    most_bytes: u64,
    /// Launches so far, and invocations.
    launched: [u64; 2],
}

impl OneByOne {
    fn grid(&self, extent: Extent) -> u32 {
        match extent {
            Extent::Items(items) => items.next_multiple_of(GROUP),
            Extent::Range(range) => {
                let row = &self.memory[binding::<Ranges>()].words[range as usize * Ranges::COLUMNS.len()..];
                let [x, y, z] = [Ranges::GROUPS_X, Ranges::GROUPS_Y, Ranges::GROUPS_Z].map(|c| row[c.0 as usize]);
                assert_eq!([y, z], [1, 1]);
                x * GROUP
            }
        }
    }

    fn launch(&mut self, launch: &Launch) {
        let kernel = self.kernels[launch.kernel].clone();
        let invocations = self.grid(launch.extent);
        self.launched[0] += 1;
        self.launched[1] += u64::from(invocations);
        let mut bindings: Vec<Binding> = self.memory.iter_mut().map(|m| Binding::new(&mut m.words, m.rows)).collect();
        if launch.swapped {
            bindings.swap(binding::<Paths>(), binding::<Next>());
        }
        for i in 0..invocations {
            let args: Vec<u32> = [i].into_iter().chain(launch.arguments.iter().copied()).collect();
            // SAFETY: each binding is the memory of its buffer, as many rows of its columns as it says, and nobody else's;
            // the tree was built by the host.
            let status = unsafe { kernel.kernel().call(&bindings, &args, &mut []) };
            assert_eq!(status, Status::Done, "{}", kernel.name);
        }
    }
}

impl Machine for OneByOne {
    fn most_bytes(&self) -> u64 {
        self.most_bytes
    }

    fn reserve(&mut self, rows: &[(usize, u32)]) -> Result<(), Error> {
        for (buffer, rows) in rows {
            // What nobody has written is no zero.
            let words = vec![0xdead_beef; *rows as usize * BUFFERS[*buffer].3.len()];
            self.memory[*buffer] = Memory { rows: *rows, words };
        }
        Ok(())
    }

    fn set_frame(&mut self, words: &[u32]) -> Result<(), Error> {
        self.memory[binding::<Frame>()].words = words.to_vec();
        Ok(())
    }

    fn run(&mut self, passes: &[Vec<Launch>]) -> Result<(), Error> {
        passes.iter().flatten().for_each(|launch| self.launch(launch));
        Ok(())
    }

    fn read(&mut self, stream: usize, rows: Range<u32>) -> Result<Vec<u32>, Error> {
        let columns = BUFFERS[stream].3.len();
        Ok(self.memory[stream].words[rows.start as usize * columns..rows.end as usize * columns].to_vec())
    }
}

fn load(name: &str) -> Scene {
    Scene::load(format!("builtin:{name}")).unwrap_or_else(|e| panic!("{name}: {e}"))
}

/// The device with memories of so many bytes at most.
fn device(kind: DeviceKind, tables: &Tables, tracer: TracerKind, most_bytes: u64) -> Device<OneByOne> {
    let requests = kind.requests(tables, tracer);
    let kernels = generate(tables, &requests, Keep::default()).unwrap_or_else(|e| panic!("{e}")).kernels;
    let schedule = Schedule::of(kind, &requests);
    let memory = tables.memory.iter().map(|m| Memory::clone(m)).collect();
    Device::new(OneByOne { kernels, memory, most_bytes, launched: [0; 2] }, schedule)
}

const WINDOW: Window = Window { x: 3, y: 2, width: 10, height: 12 };
const SIZE: [u32; 2] = [16, 16];

/// The same film and the same numbers of rays as on the CPU.
fn agree(name: &str, known: Known, tracer: TracerKind, most_bytes: u64) {
    let scene = load(name);
    let camera = scene.camera_or_default();
    let options = Options { known, tracer, spp: 12, seed: 5, ..Options::default() };
    let renderer = Renderer::new(&scene, options).unwrap_or_else(|e| panic!("{name}: {e}"));
    let mut right = Film::crop(SIZE, WINDOW);
    let stats = renderer.render(&camera, &mut right).unwrap_or_else(|e| panic!("{name}: {e}"));
    // The native walk has a tree of its own.
    let tables = Tables::new(&scene, &Choices::default(), known);
    for kind in [DeviceKind::GpuMegakernel, DeviceKind::GpuWavefront] {
        let what = format!("{name}, {known:?}, {tracer:?}, {kind:?}, {most_bytes} bytes");
        let mut device = device(kind, &tables, tracer, most_bytes);
        let mut film = Film::crop(SIZE, WINDOW);
        let mut rays = [0; 2];
        // So many in the second pass that a megakernel leaves some pixels for another launch.
        for (sample, samples) in [(0, 1), (1, 11)] {
            let pass = Pass { size: SIZE, window: WINDOW, sample, samples, seed: 5 };
            let frame = frame(&camera, tables.place(&camera), &pass).words;
            let (complete, more) = device.pass(&mut film, &pass, &frame, &Handle::default()).expect("it runs");
            assert!(complete, "{what}");
            (0..2).for_each(|k| rays[k] += more[k]);
        }
        film.asked_below(12);
        assert!(film == right, "{what}: the films differ");
        assert_eq!(rays, [stats.closest_rays, stats.shadow_rays], "{what}");
    }
}

#[test]
fn both_devices_leave_the_film_of_the_cpu() {
    for name in ["cornell-box", "alpha", "material-balls"] {
        agree(name, Known::Structure, TracerKind::Path, u64::MAX);
    }
}

/// A GPU with little memory: some pieces a pass.
#[test]
fn pieces_make_up_the_film() {
    agree("cornell-box", Known::Structure, TracerKind::Path, 50 * 256);
}

#[test]
fn what_is_known_and_shown_does_not_matter() {
    agree("textures", Known::Nothing, TracerKind::Path, u64::MAX);
    agree("empty", Known::All, TracerKind::Normals, u64::MAX);
    agree("textures", Known::Structure, TracerKind::Albedo, u64::MAX);
}

/// A pass that is cancelled adds no part of a piece.
#[test]
fn a_cancelled_pass_leaves_whole_pieces() {
    let scene = load("cornell-box");
    let tables = Tables::new(&scene, &Choices::default(), Known::Structure);
    let pass = Pass { size: SIZE, window: WINDOW, sample: 0, samples: 1, seed: 0 };
    let camera = scene.camera_or_default();
    let frame = frame(&camera, tables.place(&camera), &pass).words;
    let handle = Handle::default();
    handle.cancel();
    let mut device = device(DeviceKind::GpuWavefront, &tables, TracerKind::Path, u64::MAX);
    let mut film = Film::crop(SIZE, WINDOW);
    let (complete, rays) = device.pass(&mut film, &pass, &frame, &handle).expect("it runs");
    assert!(!complete && rays == [0; 2] && film == Film::crop(SIZE, WINDOW) && device.machine().launched == [0; 2]);
}

/// Law 1: the program is built without a scene, and building it again gives the same text.
#[test]
fn the_generic_program_does_not_depend_on_the_scene() {
    let shared = ["begin", "trace", "count", "scan", "plan", "scatter", "shadow", "retire", "accumulate"];
    let shared = shared.map(|stage| format!("wavefront_{stage}"));
    let of_path = ["megakernel", "wavefront_generate", "wavefront_shade", "wavefront_miss"].map(String::from);
    let expected = [shared.as_slice(), &of_path].concat();
    let found = gpu_generic().program().entries.iter().map(|(n, _)| n.to_string()).collect::<Vec<_>>();
    assert_eq!(found, expected);
    let first = print(gpu_generic().program());
    for scene in builtin::list().iter().take(3).map(|b| load(b.name)) {
        Tables::new(&scene, &Choices::default(), Known::Structure);
        assert!(print(&every_gpu_entry()) == first, "{}: the generic program changed", scene.name);
    }
}
