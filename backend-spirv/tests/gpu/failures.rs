//! What goes wrong is an error of one line, and no panic.

use std::process::Command;
use std::sync::Arc;

use jerboa_backend_spirv::gpu::{Adapter, Bound, Choice, Error, Extent, Gpu, Launch, Mode};

use super::{Buffers, gpu, kernel, launch};

/// That an error is one readable line.
fn line(error: Error) -> String {
    let text = error.to_string();
    assert!(!text.contains('\n') && text.len() > 20, "{text}");
    text
}

#[test]
fn a_launch_that_does_not_fit_is_refused() {
    let Some(gpu) = gpu() else { return };
    let (add, sum) = (kernel(gpu, "add", [2, 3]), kernel(gpu, "sum", [2, 2]));
    let buffers = Buffers::new(gpu, 64);
    let bound = buffers.bound();
    let refused = |launch: Launch| line(gpu.run(&[vec![launch]]).expect_err("it does not fit"));
    let whole = Extent::Items(64);
    assert_eq!(
        refused(launch(&add, &[], &bound, whole)),
        "a launch of the kernel `add` does not fit: it has 0 words of arguments, 1 are expected"
    );
    assert!(refused(launch(&add, &[1], &bound[..2], whole)).ends_with("it has 2 buffers, the program 3"));
    let beyond = [bound[0], bound[1], Bound { start: 65, ..bound[2] }];
    assert!(
        refused(launch(&add, &[1], &beyond, whole)).ends_with("buffer 2 starts at word 65, beyond its memory's end")
    );
    assert!(
        refused(launch(&add, &[1], &bound, Extent::Items(u32::MAX))).ends_with("4294967295 invocations are too many")
    );
    let grid = Extent::Indirect { memory: &buffers.grid, word: 1 };
    assert!(refused(launch(&add, &[1], &bound, grid)).ends_with("its grid is at word 1 of a memory of 3"));
    assert!(refused(launch(&sum, &[1, 2], &bound, whole)).ends_with("its results take 2 words, 0 are there"));
    let results = gpu.memory(2).expect("there is room");
    let apart = Launch { results: Some(&results), ..launch(&sum, &[1, 2], &bound, whole) };
    assert!(refused(apart).ends_with("buffer 2 lies in another memory than the rest of binding 2"));
    // The same memory to read and to write.
    let aliased = [Bound { memory: bound[2].memory, ..bound[0] }, bound[1], bound[2]];
    assert!(refused(launch(&add, &[1], &aliased, whole)).starts_with("the GPU's driver refused (launches); "));
    // And nothing of it has run, nor is the device worse for it.
    gpu.run(&[vec![launch(&add, &[1], &bound, whole)]]).expect("it fits");
    assert_eq!(gpu.read(&buffers.stream, 0..64).expect("it is there"), [1; 64]);
}

#[test]
fn a_device_is_shared_until_it_is_lost() {
    let Some(_) = gpu() else { return };
    // The portable mode of this test's own process would be shared with other tests, which must not lose it.
    if std::env::var_os("JERBOA_LOSE_THE_DEVICE").is_none() {
        let out = Command::new(std::env::current_exe().expect("a path"))
            .args(["failures::a_device_is_shared_until_it_is_lost", "--exact", "--nocapture"])
            .env("JERBOA_LOSE_THE_DEVICE", "1")
            .output()
            .expect("it starts");
        let said = String::from_utf8_lossy(&out.stdout) + String::from_utf8_lossy(&out.stderr);
        assert!(out.status.success() && said.contains("1 passed") && !said.contains("panicked"), "{said}");
        return;
    }
    let open = || Gpu::open_as(Adapter::choose(&Choice::Any).expect("it is there"), Mode::Portable).expect("it opens");
    let gpu = open();
    assert!(Arc::ptr_eq(&gpu, &open()));
    let add = kernel(&gpu, "add", [2, 3]);
    let buffers = Buffers::new(&gpu, 64);
    let bound = buffers.bound();
    gpu.run(&[vec![launch(&add, &[1], &bound, Extent::Items(64))]]).expect("it runs");
    gpu.destroy();
    let errors = [
        gpu.run(&[vec![launch(&add, &[1], &bound, Extent::Items(64))]]).expect_err("it is lost"),
        gpu.read(&buffers.stream, 0..64).expect_err("it is lost"),
        gpu.write(&buffers.stream, 0, &[1]).expect_err("it is lost"),
        gpu.memory(1).expect_err("it is lost"),
        gpu.wait().expect_err("it is lost"),
        gpu.warm(&add).expect_err("it is lost"),
    ];
    for error in errors {
        assert!(matches!(&error, Error::Lost(_)), "{error:?}");
        assert!(line(error).starts_with("the GPU was lost ("));
    }
    let again = open();
    assert!(!Arc::ptr_eq(&gpu, &again));
    assert!(again.memory(1).is_ok());
}

#[test]
fn without_a_driver_the_package_is_named() {
    if std::env::var_os("JERBOA_NO_DRIVER").is_some() {
        let error = line(Gpu::open(&Choice::Any).expect_err("there is none"));
        assert!(error.contains("mesa-vulkan-drivers"), "{error}");
        return;
    }
    if !cfg!(target_os = "linux") {
        return println!("skipped: only Linux's loader can be told to find no driver");
    }
    let out = Command::new(std::env::current_exe().expect("a path"))
        .args(["failures::without_a_driver_the_package_is_named", "--exact"])
        .envs(["JERBOA_NO_DRIVER", "VK_DRIVER_FILES", "VK_ICD_FILENAMES"].map(|name| (name, "/nonexistent")))
        .output()
        .expect("it starts");
    let said = String::from_utf8_lossy(&out.stdout);
    assert!(out.status.success() && said.contains("1 passed"), "{said}");
}

/// In a process that may have 6 GiB of addresses: buffers that nobody writes to take no more than that of lavapipe.
#[test]
fn a_full_memory_is_an_error() {
    let Some(gpu) = gpu() else { return };
    if gpu.adapter().kind().is_gpu() || !cfg!(target_os = "linux") {
        return println!("skipped: only a software driver's memory is that of the process");
    }
    if std::env::var_os("JERBOA_LITTLE_MEMORY").is_some() {
        let words = gpu.adapter().most_bytes() / 4;
        let mut held = Vec::new();
        let error = (0..60).find_map(|_| gpu.memory(words).map(|memory| held.push(memory)).err());
        let error = error.unwrap_or_else(|| panic!("{} buffers of {words} words fit", held.len()));
        assert!(matches!(error, Error::OutOfMemory { .. }), "{error}");
        assert!(line(error).starts_with("the GPU is out of memory (a buffer of "));
        held.clear();
        let memory = gpu.memory(1000).expect("there is room again");
        assert_eq!(gpu.read(&memory, 0..10).expect("it is there"), [0; 10]);
        return;
    }
    let out = Command::new("sh")
        .args(["-c", "ulimit -v 6291456 && exec \"$0\" failures::a_full_memory_is_an_error --exact"])
        .arg(std::env::current_exe().expect("a path"))
        .env("JERBOA_LITTLE_MEMORY", "1")
        .output()
        .expect("it starts");
    let said = String::from_utf8_lossy(&out.stdout) + String::from_utf8_lossy(&out.stderr);
    assert!(out.status.success() && said.contains("1 passed"), "{said}");
}

#[test]
fn an_adapter_that_is_not_there_is_named() {
    let Some(gpu) = gpu() else { return };
    let error = line(Adapter::choose(&Choice::Named("an abacus".into())).expect_err("there is none"));
    assert!(
        error.starts_with("no GPU has `an abacus` in its name; there is `") && error.contains(gpu.adapter().name())
    );
    let named = Adapter::choose(&Choice::Named(gpu.adapter().name().to_uppercase())).expect("it is there");
    assert_eq!(named.name(), gpu.adapter().name());
    if !gpu.adapter().kind().is_gpu() {
        let error = line(Adapter::choose(&Choice::RealOnly).expect_err("there is none"));
        assert!(error.starts_with("no GPU was found; there is `"), "{error}");
    }
}
