//! Kernels run as often as they are asked to, and in order.

use jerboa_backend_spirv::gpu::{Adapter, Bound, Choice, Extent, Gpu, Launch, Mode};

use super::{Buffers, gpu, kernel, launch};

#[test]
fn both_modes_run_what_is_asked_for() {
    let Some(shared) = gpu() else { return };
    let portable = Gpu::open_as(Adapter::choose(&Choice::Any).expect("it is there"), Mode::Portable).expect("it opens");
    assert_eq!((shared.mode(), portable.mode()), (shared.adapter().mode(), Mode::Portable));
    for gpu in [shared, &portable] {
        let number = kernel(gpu, "number", [2, 3]);
        let buffers = Buffers::new(gpu, 1000);
        gpu.write(&buffers.table, 0, &(0..1000).map(|i| i * i).collect::<Vec<u32>>()).expect("it fits");
        gpu.run(&[vec![launch(&number, &[900], &buffers.bound(), Extent::Items(900))]]).expect("it runs");
        let expected: Vec<u32> = (0..1000).map(|i| if i < 900 { i * i + i } else { 0 }).collect();
        assert_eq!(gpu.read(&buffers.stream, 0..1000).expect("it is there"), expected, "{}", gpu.mode().name());
    }
}

#[test]
fn a_grid_may_have_more_workgroups_than_a_side() {
    let Some(gpu) = gpu() else { return };
    // 65,535 workgroups of 64, and a row more; one word at the end that no invocation reaches.
    let count = 65_535 * 64 + 65;
    let (add, number) = (kernel(gpu, "add", [2, 3]), kernel(gpu, "number", [2, 3]));
    let buffers = Buffers::new(gpu, count + 1);
    let bound = buffers.bound();
    let numbered = launch(&number, &[count], &bound, Extent::Items(count));
    gpu.run(&[vec![numbered, launch(&add, &[1], &bound, Extent::Items(64))]]).expect("it runs");
    let got = gpu.read(&buffers.stream, 0..count + 1).expect("it is there");
    let expected = |i: u32| if i == count { 0 } else { i + u32::from(i < 64) };
    let wrong = (0..count + 1).find(|i| got[*i as usize] != expected(*i));
    assert_eq!(wrong, None, "of {count}");
}

#[test]
fn launches_see_what_those_before_them_wrote() {
    let Some(gpu) = gpu() else { return };
    let (add, double) = (kernel(gpu, "add", [2, 3]), kernel(gpu, "double", [2, 3]));
    let buffers = Buffers::new(gpu, 640);
    let bound = buffers.bound();
    let add = |k: u32| launch(&add, &[k], &bound, Extent::Items(640));
    let double = || launch(&double, &[], &bound, Extent::Items(640));
    // ((3 · 2 + 5) · 2 · 2 + 7) · 2 in one submission, some in one pass, and then one more submission.
    gpu.run(&[vec![add(3), double(), add(5)], vec![double()], vec![double(), add(7), double()], vec![]])
        .expect("it runs");
    gpu.run(&[vec![add(100)]]).expect("it runs");
    assert_eq!(gpu.read(&buffers.stream, 0..640).expect("it is there"), [202; 640]);
    let many: Vec<Launch> = (0..500).map(add).collect();
    gpu.run(&[many]).expect("it runs");
    assert_eq!(gpu.read(&buffers.stream, 639..640).expect("it is there"), [202 + 499 * 500 / 2]);
}

/// The grid of a launch is what a launch before it wrote, whether the kernel may write to where it lies or not.
#[test]
fn a_kernel_says_how_large_the_next_grid_is() {
    let Some(gpu) = gpu() else { return };
    for streams in [[2, 3], [2, 2]] {
        let [add, grids] = ["add", "grids"].map(|entry| kernel(gpu, entry, streams));
        let (table, memory) = (gpu.memory(1).expect("there is room"), gpu.memory(1000).expect("there is room"));
        let apart = gpu.memory(9).expect("there is room");
        let grid = if streams[0] == streams[1] {
            Bound { memory: &memory, start: 700, rows: 1 }
        } else {
            Bound { memory: &apart, start: 4, rows: 1 }
        };
        let bound = [Bound { memory: &table, start: 0, rows: 1 }, grid, Bound { memory: &memory, start: 0, rows: 640 }];
        let told = Extent::Indirect { memory: grid.memory, word: grid.start };
        // Counts of workgroups: 2, and 0, which the first pass leaves as they are.
        gpu.write(&memory, 630, &[2, 0]).expect("it fits");
        let grids = |at| launch(&grids, &[at], &bound, Extent::Items(1));
        let add = |k: u32| launch(&add, &[k], &bound, told);
        gpu.run(&[vec![grids(630), add(1), add(10)], vec![add(100), grids(631), add(1000)]]).expect("it runs");
        let got = gpu.read(&memory, 0..640).expect("it is there");
        let expected = |i| {
            if i < 128 {
                111
            } else if i == 630 {
                2
            } else {
                0
            }
        };
        assert_eq!(got, (0..640).map(expected).collect::<Vec<u32>>(), "streams in {streams:?}");
    }
}

#[test]
fn a_single_invocation_returns_results() {
    let Some(gpu) = gpu() else { return };
    let sum = kernel(gpu, "sum", [2, 3]);
    let (buffers, results) = (Buffers::new(gpu, 1), gpu.memory(2).expect("there is room"));
    let arguments = vec![41, 1.25f32.to_bits()];
    let bound = buffers.bound();
    let all = Launch { kernel: &sum, arguments, buffers: &bound, results: Some(&results), extent: Extent::Items(1) };
    gpu.run(&[vec![all]]).expect("it runs");
    assert_eq!(gpu.read(&results, 0..2).expect("they are there"), [42, 1.75f32.to_bits()]);
}

#[test]
fn threads_share_a_gpu() {
    let Some(gpu) = gpu() else { return };
    std::thread::scope(|scope| {
        for thread in 0..4u32 {
            scope.spawn(move || {
                let add = kernel(gpu, "add", [2, 3]);
                let buffers = Buffers::new(gpu, 64);
                let bound = buffers.bound();
                for _ in 0..50 {
                    gpu.run(&[vec![launch(&add, &[thread], &bound, Extent::Items(64))]]).expect("it runs");
                }
                assert_eq!(gpu.read(&buffers.stream, 0..64).expect("it is there"), [50 * thread; 64]);
            });
        }
    });
}

#[test]
fn warming_up_does_nothing_but_takes_time() {
    let Some(gpu) = gpu() else { return };
    for entry in ["add", "number", "sum"] {
        let kernel = kernel(gpu, entry, [2, 3]);
        assert!(gpu.warm(&kernel).expect("it runs") > std::time::Duration::ZERO);
        assert!(kernel.pipeline_time() > std::time::Duration::ZERO);
    }
}
