//! Renders the scene of this example to the file that is named, `custom.png` without one.

use std::path::PathBuf;

use jerboa_example_custom::{components, scene};
use jerboa_lib_render::host::film::Film;
use jerboa_lib_render::host::library::Library;
use jerboa_lib_render::host::renderer::{Options, Renderer};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = std::env::args_os().nth(1).map_or_else(|| PathBuf::from("custom.png"), PathBuf::from);
    let (library, scene) = (Library::new(components()), scene());
    let renderer = Renderer::of(&library, &scene, Options::default())?;
    let mut film = Film::of_size([256, 256]);
    renderer.render(&scene.camera_or_default(), &mut film)?;
    film.mean().write(&file, 0.0)?;
    println!("{}", file.display());
    Ok(())
}
