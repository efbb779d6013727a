//! How much memory a scene of many instances takes: `instances INSTANCES shared|flat` lays out so many of a ball of 1,280
//! triangles and renders a small picture of them. Recorded in `tests/runs/instances.txt`.

use glam::{DAffine3, DVec3};
use jerboa_lib_render::host::film::Film;
use jerboa_lib_render::host::renderer::{Options, Renderer};
use jerboa_lib_render::host::tables::{Choices, sharing::MOST_COPIES};
use jerboa_lib_render::schema::BUFFERS;
use jerboa_scenes::{Instance, Scene};

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [count, how] = &arguments[..] else { panic!("say how many instances, and `shared` or `flat`") };
    let count: u32 = count.parse().expect("the number of instances is a number");
    let most_copies = if how == "flat" { u32::MAX } else { MOST_COPIES };
    let mut scene = Scene::load("builtin:pebbles").expect("a built-in loads");
    let pebble = scene.instances[1].clone();
    let side = (f64::from(count)).sqrt().ceil() as u32;
    scene.instances.truncate(1);
    for i in 0..count {
        let at = DVec3::new(f64::from(i % side) - f64::from(side) / 2.0, 0.2, -f64::from(i / side));
        scene.instances.push(Instance { to_world: DAffine3 { translation: at, ..pebble.to_world }, ..pebble });
    }
    let choices = Choices { most_copies, ..Choices::default() };
    let renderer = Renderer::new(&scene, Options { choices, spp: 4, ..Options::default() }).expect("it is made");
    let tables = renderer.tables();
    let mut all = 0;
    for (spec, memory) in BUFFERS.iter().zip(&tables.memory).filter(|(_, memory)| memory.words.len() > 1 << 14) {
        println!("{:>12}: {:>11} bytes", spec.0, 4 * memory.words.len());
        all += 4 * memory.words.len();
    }
    println!("{all} bytes in large tables for {} triangles", scene.triangle_count());
    println!("tables {:?}, of that the tree {:?}", renderer.tables_time + tables.bvh_time, tables.bvh_time);
    let mut film = Film::of_size([256, 128]);
    let stats = renderer.render(&scene.camera_or_default(), &mut film).expect("it renders");
    println!("{} rays in {:?}", stats.closest_rays + stats.shadow_rays, stats.time);
    let peak = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    peak.lines().filter(|line| line.starts_with("VmHWM")).for_each(|line| println!("{line}"));
}
