//! Instructions per call of small kernels, by callgrind.

use std::process::Command;

use jerboa_ir::lang::{Fun, Row, entry};
use jerboa_lib_render::core::vec::Vec3;
use jerboa_lib_render::geometry::make_geometry;
use jerboa_lib_render::geometry::offset::spawn_ray;
use jerboa_lib_render::host::bvh::{Bvh, Triangle};
use jerboa_lib_render::host::film::Film;
use jerboa_lib_render::ray::{Hit, Ray};
use jerboa_lib_render::schema::{Geometries, Primitives, Vertices};
use jerboa_lib_render::shader::make_shader;
use jerboa_lib_render::traverse::make_traverse;
use jerboa_tests::harness::bench::{Bench, Random};
use jerboa_tests::harness::naive::{self, BoxTest, TriangleTest};
use jerboa_tests::harness::rays::{AIMS, Place, ball, declare_traversal, load, ray, set_plane};

use crate::renders::absolute;

/// A kernel: its name, what a call does, and the row it is compared with.
const KERNELS: [(&str, &str, &str); 7] = [
    ("traverse", "ray against 3,968 triangles: the renderer's", "traverse"),
    ("moeller-trumbore", "Möller-Trumbore for Woop and its checks", "traverse"),
    ("plain-boxes", "unpadded, ordered boxes", "traverse"),
    ("start", "normal of a hit and the ray that leaves it", "start"),
    ("start-absolute", "start moved by 1e-3 instead of by a bound", "start"),
    ("film", "a sample onto the exact film", "film"),
    ("film-f32", "a sample onto sums in f32", "film"),
];

/// Calls of a kernel under callgrind; as many again in the second run.
const CALLS: u64 = 20_000;

/// Prints a row for each kernel.
pub fn table() -> Result<(), String> {
    println!("| kernel | a call is | instructions per call | share of what it is compared with |");
    println!("|---|---|---|---|");
    let idle = count("idle", CALLS)?;
    let mut found = Vec::new();
    for (name, what, compared) in KERNELS {
        let is_film = name.starts_with("film");
        let each = count(name, CALLS)? - if is_film { 0.0 } else { idle };
        found.push((name, each));
        let base = found.iter().find(|f| f.0 == compared).map_or(f64::NAN, |f| f.1);
        println!("| {name} | {what} | {each:.1} | {:.3} of {compared} |", each / base);
    }
    Ok(())
}

/// Instructions per call: the difference of two runs.
fn count(name: &str, calls: u64) -> Result<f64, String> {
    let [once, twice] = [calls, 2 * calls].map(|n| collect(name, n));
    Ok((twice? as f64 - once? as f64) / calls as f64)
}

/// Instructions of a whole run of this program.
fn collect(name: &str, calls: u64) -> Result<u64, String> {
    let program = std::env::current_exe().map_err(|e| e.to_string())?;
    let mut command = Command::new("valgrind");
    command.args(["--tool=callgrind", "--callgrind-out-file=/dev/null"]).arg(program);
    let out = command.args(["kernel", name, &calls.to_string()]).output().map_err(|e| format!("valgrind: {e}"))?;
    let text = String::from_utf8_lossy(&out.stderr);
    let line = text.lines().find_map(|l| l.split_once("Collected : ")).ok_or_else(|| format!("`{name}`: {text}"))?;
    line.1.trim().parse().map_err(|e| format!("`{}`: {e}", line.1))
}

/// Runs a kernel so many times.
pub fn run(name: &str, calls: u64) -> Result<(), String> {
    match name {
        "film" => {
            let mut film = Film::of_size([64, 64]);
            (0..calls as u32).for_each(|i| film.add([i % 64, i / 64 % 64], [0.1, 0.2 * i as f32, 0.3]));
            std::hint::black_box(film);
        }
        "film-f32" => {
            let mut film = vec![[0.0_f32; 3]; 64 * 64];
            for i in 0..calls as u32 {
                let pixel = &mut film[(i % 4096) as usize];
                [0.1, 0.2 * i as f32, 0.3].iter().zip(pixel).for_each(|(s, sum)| *sum += s);
            }
            std::hint::black_box(film);
        }
        "start" | "start-absolute" => starts(name, calls),
        _ => rays(name, calls)?,
    }
    Ok(())
}

/// Rays from inside a displaced ball, anywhere.
fn rays(name: &str, calls: u64) -> Result<(), String> {
    let mut bench = match name {
        "idle" => Bench::new(|| entry("nearest", Fun::<Ray, Hit>::lam(|_, ray| Hit::miss(ray.tmax)))),
        "traverse" => Bench::new(|| declare_traversal(make_traverse())),
        "moeller-trumbore" => naive_bench(BoxTest::Padded, TriangleTest::MoellerTrumbore),
        "plain-boxes" => naive_bench(BoxTest::Plain, TriangleTest::Watertight),
        _ => return Err(format!("there is no kernel `{name}`")),
    };
    let triangles = ball(64, |i, j| 0.75 + 0.5 * ((64 * i + j) as f64 * 0.618_033_988_749_895).fract());
    load(&mut bench, &Bvh::build(&triangles), &triangles);
    let place = Place { centre: [0.0; 3], scale: 1.0 };
    let mut random = Random(7);
    let args: Vec<_> = (0..1000)
        .map(|_| {
            let (org, dir) = (AIMS[2].ray)(&mut random, place, &triangles);
            ray(org, dir)
        })
        .collect();
    (0..calls as usize).for_each(|i| {
        std::hint::black_box(bench.run("nearest", &args[i % args.len()]));
    });
    Ok(())
}

fn naive_bench(boxes: BoxTest, triangles: TriangleTest) -> Bench {
    Bench::new(|| declare_traversal(naive::make_traverse(boxes, triangles)))
}

/// The surface of a hit on one triangle, and the ray that leaves it.
fn starts(name: &str, calls: u64) {
    let is_absolute = name == "start-absolute";
    let mut bench = Bench::new(|| {
        entry(
            "nearest",
            Fun::<(Ray, Vec3), (Ray, Vec3)>::lam(move |b, (ray, dir)| {
                let hit = Hit { primitive: 0u32.into(), t: ray.tmax, u: ray.org.x, v: ray.org.y };
                let row = Row::<Geometries>::at(0u32);
                let surf =
                    make_geometry(row, make_shader(row.get(Geometries::MATERIAL))).surface_element.call(b, (ray, hit));
                let on = spawn_ray(surf, dir);
                (if is_absolute { absolute(surf.point, on) } else { on }, surf.face_normal)
            }),
        );
    });
    let triangle: Triangle = [[0.0, 0.1, 0.2], [1.0, 0.3, 0.1], [0.2, 1.0, 0.4]];
    bench.rows::<Vertices>(3);
    set_plane(&mut bench, 0, &triangle);
    for (i, p) in triangle.iter().enumerate() {
        bench.set([Primitives::I0, Primitives::I1, Primitives::I2][i], 0, i as u32);
        let columns = [Vertices::X, Vertices::Y, Vertices::Z];
        columns.into_iter().zip(p).for_each(|(column, x)| bench.set(column, i, *x));
    }
    let args = [&ray([0.2, 0.3, 0.0], [0.0, 0.0, 1.0])[..], &[0.3_f32, 0.2, 0.5].map(f32::to_bits)].concat();
    (0..calls).for_each(|_| {
        std::hint::black_box(bench.run("nearest", &args));
    });
}
