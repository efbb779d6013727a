//! An open adapter: what all of a process's kernels and memory belong to.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};

use wgpu::{DeviceDescriptor, ErrorFilter, Features, PollType};

use super::error::one_line;
use super::quiet::quietly;
use super::{Adapter, Choice, Error};

/// How kernels reach the driver.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Mode {
    /// As our own SPIR-V, every float operation as it stands.
    Exact,
    /// As a `naga::Module`; a driver may fuse and reorder float operations.
    Portable,
}

impl Mode {
    /// A word for a table.
    pub fn name(self) -> &'static str {
        match self {
            Mode::Exact => "exact",
            Mode::Portable => "portable",
        }
    }
}

/// An open adapter. Shared: what opens the same one again in the same mode gets the same, as long as it is in use.
#[derive(Debug)]
pub struct Gpu {
    adapter: Adapter,
    mode: Mode,
    pub(super) device: wgpu::Device,
    pub(super) queue: wgpu::Queue,
    heard: Arc<Heard>,
    /// Holds the launches of the submission at hand; grows. Locked from the upload to the submission.
    pub(super) launches: Mutex<Option<wgpu::Buffer>>,
}

/// What the driver says unasked.
#[derive(Default, Debug)]
struct Heard {
    /// Why the device is lost, once it is.
    lost: Mutex<Option<String>>,
    /// An error that belongs to no call.
    late: Mutex<Option<String>>,
}

/// What is open, and how.
static OPEN: Mutex<Vec<(String, Mode, Weak<Gpu>)>> = Mutex::new(Vec::new());

impl Gpu {
    /// Opens the adapter that is chosen, in exact mode where it has one.
    ///
    /// # Errors
    ///
    /// There is none, it cannot run kernels, or its driver refuses.
    pub fn open(choice: &Choice) -> Result<Arc<Gpu>, Error> {
        let adapter = Adapter::choose(choice)?;
        let mode = adapter.mode();
        Gpu::open_as(adapter, mode)
    }

    /// Opens `adapter` in this mode.
    ///
    /// # Errors
    ///
    /// It has no such mode, cannot run kernels, or its driver refuses.
    pub fn open_as(adapter: Adapter, mode: Mode) -> Result<Arc<Gpu>, Error> {
        let unfit = |why: &str| Err(Error::Unfit { adapter: adapter.name().into(), why: why.into() });
        if let Some(why) = adapter.unfit() {
            return unfit(why);
        }
        if mode == Mode::Exact && !adapter.exact() {
            return unfit(
                "it has no exact mode, since it is not reached through Vulkan, or does not take SPIR-V as it is",
            );
        }
        let identity = adapter.identity();
        let mut open = lock(&OPEN);
        open.retain(|(_, _, gpu)| gpu.upgrade().is_some_and(|gpu| lock(&gpu.heard.lost).is_none()));
        if let Some(gpu) = open.iter().find(|(i, m, _)| *i == identity && *m == mode).and_then(|o| o.2.upgrade()) {
            return Ok(gpu);
        }
        let gpu = Arc::new(Gpu::new(adapter, mode)?);
        open.push((identity, mode, Arc::downgrade(&gpu)));
        Ok(gpu)
    }

    fn new(adapter: Adapter, mode: Mode) -> Result<Gpu, Error> {
        let descriptor = DeviceDescriptor {
            label: Some("jerboa"),
            required_features: if mode == Mode::Exact { Features::PASSTHROUGH_SHADERS } else { Features::empty() },
            required_limits: adapter.needs(),
            ..DeviceDescriptor::default()
        };
        let opened = pollster::block_on(adapter.inner.request_device(&descriptor));
        let (device, queue) = opened.map_err(|e| Error::Refused {
            doing: format!("opening `{}`", adapter.name()),
            why: one_line(&e.to_string()),
        })?;
        let heard = Arc::new(Heard::default());
        let told = heard.clone();
        device.set_device_lost_callback(move |_, why| {
            lock(&told.lost).get_or_insert(one_line(&why));
        });
        let told = heard.clone();
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            lock(&told.late).get_or_insert(one_line(&error.to_string()));
        }));
        Ok(Gpu { adapter, mode, device, queue, heard, launches: Mutex::new(None) })
    }

    /// What it runs on.
    pub fn adapter(&self) -> &Adapter {
        &self.adapter
    }

    /// How kernels reach its driver.
    pub fn mode(&self) -> Mode {
        self.mode
    }

    /// Waits until all that was submitted is done.
    ///
    /// # Errors
    ///
    /// The device is lost.
    pub fn wait(&self) -> Result<(), Error> {
        match quietly(|| self.device.poll(PollType::wait_indefinitely())) {
            Ok(Ok(_)) => self.heard("waiting"),
            Ok(Err(error)) => Err(Error::Refused { doing: "waiting".into(), why: one_line(&error.to_string()) }),
            // wgpu panics where it finds the device lost while it waits.
            Err(panic) => {
                let why = one_line(&panic);
                Err(Error::Lost(lock(&self.heard.lost).get_or_insert(why).clone()))
            }
        }
    }

    /// Gives the device's memory back now. Whatever is asked of it from here on is [`Error::Lost`].
    pub fn destroy(&self) {
        self.device.destroy();
        lock(&self.heard.lost).get_or_insert("it was destroyed".into());
    }

    /// Does `work`, and returns what wgpu has to say against it in place of its value.
    pub(super) fn guarded<T>(&self, doing: &str, work: impl FnOnce() -> T) -> Result<T, Error> {
        self.heard(doing)?;
        let filters = [ErrorFilter::Validation, ErrorFilter::Internal, ErrorFilter::OutOfMemory];
        let scopes = filters.map(|filter| self.device.push_error_scope(filter));
        let value = work();
        // The last scope is the innermost.
        let faults = scopes.into_iter().rev().map(|scope| pollster::block_on(scope.pop())).collect::<Vec<_>>();
        self.heard(doing)?;
        match faults.into_iter().flatten().next() {
            None => Ok(value),
            Some(wgpu::Error::OutOfMemory { .. }) => Err(Error::OutOfMemory { doing: doing.into() }),
            Some(fault) => Err(Error::Refused { doing: doing.into(), why: one_line(&fault.to_string()) }),
        }
    }

    /// What the driver has said unasked, if anything.
    fn heard(&self, doing: &str) -> Result<(), Error> {
        if let Some(why) = &*lock(&self.heard.lost) {
            return Err(Error::Lost(why.clone()));
        }
        match lock(&self.heard.late).take() {
            Some(why) => Err(Error::Refused { doing: format!("before {doing}"), why }),
            None => Ok(()),
        }
    }
}

/// What a mutex holds; a panic of a thread that held it has left nothing half done.
pub(super) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
