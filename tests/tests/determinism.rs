//! An image is a function of scene, camera, options and sample numbers (Law 9, T21): not of threads, tiles, repetition or the
//! shape of the film. Every built-in scene, compared to the bit.

use jerboa_lib_render::host::film::{Film, Window};
use jerboa_lib_render::host::renderer::{Handle, Options, Render, Renderer};
use jerboa_scenes::{Camera, Scene, builtin};

/// Films that no tile and no vector fits: the last has several tiles.
const SIZES: [[u32; 2]; 4] = [[1, 1], [3, 5], [7, 1], [18, 17]];

/// Sides of the pieces that films are cut into, beside the renderer's own tiles.
const SIDES: [u32; 3] = [1, 5, 16];

const JOB: Render = Render { sample: 7, spp: 2, seed: 3 };

fn renderer(name: &str) -> (Renderer, Camera) {
    let scene = Scene::load(format!("builtin:{name}")).unwrap_or_else(|e| panic!("{e}"));
    (Renderer::new(&scene, Options::default()).unwrap_or_else(|e| panic!("{name}: {e}")), scene.camera_or_default())
}

fn render((renderer, camera): &(Renderer, Camera), size: [u32; 2], window: Window) -> Film {
    let mut film = Film::crop(size, window);
    renderer.render_with(camera, &mut film, JOB, &Handle::default()).unwrap_or_else(|e| panic!("{e}"));
    film
}

fn on_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads").install(work)
}

fn whole([width, height]: [u32; 2]) -> Window {
    Window { x: 0, y: 0, width, height }
}

/// The film put together from pieces of `side` by `side` pixels, the last first.
fn in_pieces(r: &(Renderer, Camera), size: [u32; 2], side: u32) -> Film {
    let starts = |length: u32| (0..length).step_by(side as usize).map(move |start| (start, side.min(length - start)));
    let pieces =
        starts(size[1]).flat_map(|(y, height)| starts(size[0]).map(move |(x, width)| Window { x, y, width, height }));
    let mut film = Film::of_size(size);
    for piece in pieces.collect::<Vec<_>>().into_iter().rev() {
        film.merge(&render(r, size, piece)).expect("a piece lies within");
    }
    film
}

#[test]
fn threads_tiles_and_repetition_change_no_bit() {
    for name in builtin::list().iter().map(|b| b.name) {
        let (first, again) = (renderer(name), renderer(name));
        for size in SIZES {
            let film = on_threads(1, || render(&first, size, whole(size)));
            for threads in [2, 8] {
                assert!(on_threads(threads, || render(&first, size, whole(size))) == film, "{name}, {threads} threads");
            }
            assert!(render(&again, size, whole(size)) == film, "{name}, {size:?}: made and rendered again");
        }
        // Half of the last film is enough to cut into pieces.
        let size = [18, 9];
        let film = render(&first, size, whole(size));
        for side in SIDES {
            assert!(in_pieces(&first, size, side) == film, "{name}: pieces of {side} pixels");
        }
    }
}

/// The pixels of a window are those of the whole, wherever it lies; a pixel of another film is another picture.
#[test]
fn a_window_has_the_very_pixels_of_the_whole() {
    let r = renderer("material-balls");
    let size = [61, 23];
    let image = render(&r, size, whole(size)).mean();
    for window in [[0, 0, 1, 1], [60, 22, 1, 1], [13, 0, 17, 23], [0, 7, 61, 1], [5, 6, 33, 16]] {
        let [x, y, width, height] = window;
        let part = render(&r, size, Window { x, y, width, height }).mean();
        for (i, pixel) in part.pixels.iter().enumerate() {
            let (px, py) = (x + i as u32 % width, y + i as u32 / width);
            assert_eq!(*pixel, image.pixels[(py * size[0] + px) as usize], "{window:?}: {px},{py}");
        }
    }
    let wider = render(&r, [62, 23], Window { x: 5, y: 6, width: 33, height: 16 }).mean();
    assert!(
        wider
            .pixels
            .iter()
            .zip(&render(&r, size, Window { x: 5, y: 6, width: 33, height: 16 }).mean().pixels)
            .any(|(a, b)| a != b)
    );
}
