//! A session: a progressive render that goes on while its scene is edited.
//!
//! ```
//! use jerboa_lib_render::host::renderer::{Options, Renderer};
//! use jerboa_lib_render::host::session::Session;
//! use jerboa_scenes::Scene;
//!
//! let scene = Scene::load("builtin:cornell-box").map_err(|e| e.to_string())?;
//! let renderer = Renderer::new(&scene, Options { spp: 4, ..Options::default() }).map_err(|e| e.to_string())?;
//! let (camera, mut wall) = (scene.camera_or_default(), scene.materials[0].clone());
//! let session = Session::start(renderer, scene, camera, [32, 32]).map_err(|e| e.to_string())?;
//!
//! wall.base_color = [0.1, 0.7, 0.3, 1.0];
//! let edit = session.set_material(0, wall); // comes back at once; the old picture goes on until the new code is there
//! let picture = session.wait(edit, 4).map_err(|e| e.to_string())?;
//! assert_eq!((picture.revision, picture.spp), (edit, 4));
//! # Ok::<(), String>(())
//! ```
//!
//! Two threads of its own: the *painter* adds pass after pass to the film and shows it after each; the *editor* takes the edits
//! in order, each from the renderer before it ([`Renderer::edited`]), while the painter goes on with the old code and the old
//! tables. When the new renderer is there the pass under way is cancelled, which takes as long as a wave at most, and the film
//! starts again. So what is shown is always some whole number of samples of one state of the scene: the very image that a
//! renderer made for that state gives.

mod editor;
mod painter;

use std::any::Any;
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;

use jerboa_scenes::{self as scenes, Camera, Light, Material, Scene, Texture};

use super::edit::Edit;
use super::error::Error;
use super::film::{Film, Window};
use super::image_io::Image;
use super::renderer::{Handle, Renderer};
use editor::Editor;
use painter::Painter;

/// A render in the background, of a scene that can be edited. Ends when it is dropped.
pub struct Session {
    shared: Arc<Shared>,
    threads: Vec<JoinHandle<()>>,
}

/// What the session shows.
#[derive(Clone, Debug)]
pub struct Picture {
    /// Number of the last edit that it shows, and it shows all before it; 0 before any.
    pub revision: u64,
    /// Samples of every pixel.
    pub spp: u32,
    /// Linear RGB radiance.
    pub image: Image,
}

/// A new value of a part of the scene.
enum Value {
    Material(usize, Box<Material>),
    Light(usize, Light),
    Texture(usize, Texture, Option<scenes::Image>),
    Camera(Camera),
}

/// What the painter paints.
#[derive(Clone)]
struct Live {
    revision: u64,
    renderer: Arc<Renderer>,
    camera: Camera,
}

struct State {
    /// Edits that wait, with their numbers.
    queue: Vec<(u64, Value)>,
    /// Number of the last edit that was asked for.
    asked: u64,
    live: Live,
    /// Ends the pass under way.
    handle: Arc<Handle>,
    picture: Option<Arc<Picture>>,
    /// What came of edits.
    outcomes: BTreeMap<u64, Result<Edit, Error>>,
    /// Why a thread ended before its time.
    fault: Option<Error>,
    stopped: bool,
}

struct Shared {
    state: Mutex<State>,
    changed: Condvar,
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, State> {
        // State is changed by assignments only, so a panic elsewhere leaves it whole.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn wait<'s>(&self, state: MutexGuard<'s, State>) -> MutexGuard<'s, State> {
        self.changed.wait(state).unwrap_or_else(PoisonError::into_inner)
    }

    /// Runs what a thread does for the session. Whatever makes it fail is told to those who wait.
    fn work(&self, work: impl FnOnce() -> Result<(), Error>) {
        let fault = match catch_unwind(AssertUnwindSafe(work)) {
            Ok(Ok(())) => return,
            Ok(Err(error)) => error,
            Err(panic) => Error::new(format!("a fault of Jerboa, please report it: {}", message(&*panic))),
        };
        let mut state = self.lock();
        state.fault = Some(fault);
        state.stopped = true;
        self.changed.notify_all();
    }
}

/// Lets other threads go first on this one's core: the editor, and whoever answers the user. A core without them paints no
/// slower.
fn step_back() {
    // Where it is not allowed, the editor shares the cores with the painter.
    #[cfg(target_os = "linux")]
    let _ = rustix::process::nice(10);
}

/// What a panic said.
fn message(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("it panicked")
}

impl Session {
    /// Starts to render this scene, for which the renderer was made, as the renderer's options say: up to their samples per
    /// pixel, on as many threads as rayon's current pool has. `size` is that of the film, columns and rows.
    ///
    /// # Errors
    /// When the options ask for no sample, there is no memory for the film, or no threads can be started.
    pub fn start(renderer: Renderer, scene: Scene, camera: Camera, size: [u32; 2]) -> Result<Session, Error> {
        if renderer.options.spp == 0 {
            return Err(Error::new("a session takes a sample per pixel at least"));
        }
        let [width, height] = size;
        let film = Film::try_crop(size, Window { x: 0, y: 0, width, height })?;
        let fault = |e: &dyn std::fmt::Display| Error::new(format!("cannot start the threads: {e}"));
        // One pool each: a job of the editor would wait for the end of a pass in the painter's.
        let pool = || rayon::ThreadPoolBuilder::new().num_threads(rayon::current_num_threads());
        let painters = pool().start_handler(|_| step_back()).build().map_err(|e| fault(&e))?;
        let editors = pool().build().map_err(|e| fault(&e))?;
        let live = Live { revision: 0, renderer: Arc::new(renderer), camera };
        let state = State {
            queue: Vec::new(),
            asked: 0,
            live: live.clone(),
            handle: Arc::default(),
            picture: None,
            outcomes: BTreeMap::new(),
            fault: None,
            stopped: false,
        };
        let shared = Arc::new(Shared { state: Mutex::new(state), changed: Condvar::new() });
        let mut session = Session { shared: shared.clone(), threads: Vec::new() };
        let (of_painter, of_editor) = (shared.clone(), shared);
        let paint = move || of_painter.work(|| painters.install(|| Painter::new(&of_painter, film).run()));
        let edit = move || {
            let mut editor = Editor::new(&of_editor, scene, live);
            of_editor.work(|| editors.install(|| editor.run()));
        };
        let named = |name: &str| std::thread::Builder::new().name(name.into());
        session.threads.push(named("painter").spawn(paint).map_err(|e| fault(&e))?);
        session.threads.push(named("editor").spawn(edit).map_err(|e| fault(&e))?);
        Ok(session)
    }

    /// Ask for another material in this place. Gives the number of the edit, at once.
    pub fn set_material(&self, number: usize, material: Material) -> u64 {
        self.ask(Value::Material(number, Box::new(material)))
    }

    /// Ask for another light in this place. Gives the number of the edit, at once.
    pub fn set_light(&self, number: usize, light: Light) -> u64 {
        self.ask(Value::Light(number, light))
    }

    /// Ask for another texture in this place, and for other texels of its image if there are any. Gives the number of the
    /// edit, at once.
    pub fn set_texture(&self, number: usize, texture: Texture, image: Option<scenes::Image>) -> u64 {
        self.ask(Value::Texture(number, texture, image))
    }

    /// Look from elsewhere. Gives the number of the edit, at once.
    pub fn set_camera(&self, camera: Camera) -> u64 {
        self.ask(Value::Camera(camera))
    }

    fn ask(&self, value: Value) -> u64 {
        let mut state = self.shared.lock();
        state.asked += 1;
        let number = state.asked;
        state.queue.push((number, value));
        self.shared.changed.notify_all();
        number
    }

    /// What the last pass left; nothing before the first.
    pub fn picture(&self) -> Option<Arc<Picture>> {
        self.shared.lock().picture.clone()
    }

    /// Waits for a picture that shows this edit with so many samples per pixel at least, or all there will be.
    ///
    /// # Errors
    /// When the edit was refused, as [`Renderer::edited`] says, or a kernel gave up.
    pub fn wait(&self, edit: u64, spp: u32) -> Result<Arc<Picture>, Error> {
        let mut state = self.shared.lock();
        loop {
            if let Some(Err(error)) = state.outcomes.get(&edit) {
                return Err(error.clone());
            }
            let enough = |p: &&Arc<Picture>| p.revision >= edit && p.spp >= spp.min(state.live.renderer.options.spp);
            if let Some(picture) = state.picture.as_ref().filter(enough) {
                return Ok(picture.clone());
            }
            if let Some(fault) = &state.fault {
                return Err(fault.clone());
            }
            state = self.shared.wait(state);
        }
    }

    /// What an edit took; nothing while it waits or is under way, and of a camera.
    pub fn outcome(&self, edit: u64) -> Option<Result<Edit, Error>> {
        self.shared.lock().outcomes.get(&edit).cloned()
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        let mut state = self.shared.lock();
        state.stopped = true;
        state.handle.cancel();
        self.shared.changed.notify_all();
        drop(state);
        for thread in self.threads.drain(..) {
            // It says by `fault` what went wrong.
            let _ = thread.join();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::host::renderer::Options;

    #[test]
    fn who_waits_is_told_of_a_panic() {
        let scene = Scene::load("builtin:cornell-box").expect("a built-in loads");
        let renderer = Renderer::new(&scene, Options { spp: 1, ..Options::default() }).expect("it is specialised");
        let camera = scene.camera_or_default();
        let session = Session::start(renderer, scene, camera, [4, 4]).expect("it starts");
        let shared = session.shared.clone();
        let thread = std::thread::spawn(move || shared.work(|| panic!("of this test")));
        let error = session.wait(1, 1).expect_err("there is no edit 1");
        assert_eq!(error.to_string(), "a fault of Jerboa, please report it: of this test");
        thread.join().expect("the panic was caught");
    }
}
