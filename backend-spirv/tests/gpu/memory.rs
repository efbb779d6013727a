//! Words to the GPU and back.

use super::gpu;

/// Words that look random and differ from their neighbours.
fn words(count: u32) -> Vec<u32> {
    (0..count).map(|i| i.wrapping_mul(0x9e37_79b9) ^ (i >> 3)).collect()
}

#[test]
fn what_is_written_is_read() {
    let Some(gpu) = gpu() else { return };
    let memory = gpu.memory(1000).expect("there is room");
    assert_eq!(memory.words(), 1000);
    assert_eq!(gpu.read(&memory, 0..1000).expect("it is there"), [0; 1000], "zero until something is written");
    let written = words(700);
    gpu.write(&memory, 123, &written).expect("it fits");
    gpu.write(&memory, 124, &[7, 8]).expect("it fits");
    gpu.write(&memory, 1000, &[]).expect("nothing fits everywhere");
    let mut expected = vec![0; 1000];
    expected[123..823].copy_from_slice(&written);
    expected[124..126].copy_from_slice(&[7, 8]);
    assert_eq!(gpu.read(&memory, 0..1000).expect("it is there"), expected);
    assert_eq!(gpu.read(&memory, 124..127).expect("it is there"), expected[124..127]);
    assert_eq!(gpu.read(&memory, 5..5).expect("it is there"), []);
}

#[test]
fn more_than_travels_at_once_arrives_whole() {
    let Some(gpu) = gpu() else { return };
    let written = words((1 << 24) + 1000);
    let memory = gpu.memory(written.len() as u64 + 5).expect("there is room");
    gpu.write(&memory, 5, &written).expect("it fits");
    assert!(gpu.read(&memory, 5..memory.words()).expect("it is there") == written);
}

#[test]
fn what_does_not_fit_is_refused() {
    let Some(gpu) = gpu() else { return };
    let memory = gpu.memory(10).expect("there is room");
    let error = gpu.write(&memory, 8, &[1, 2, 3]).expect_err("it is too long").to_string();
    assert_eq!(error, "a write does not fit: words 8 to 11 of a buffer that has 10");
    let error = gpu.read(&memory, 0..11).expect_err("it is too long").to_string();
    assert_eq!(error, "a read does not fit: words 0 to 11 of a buffer that has 10");
    let most = gpu.adapter().most_bytes() / 4;
    let error = gpu.memory(most + 1).expect_err("it is too large").to_string();
    assert!(error.contains(" is too large for the GPU `") && error.contains("use a smaller scene"), "{error}");
    assert!(gpu.memory(u64::MAX).is_err());
}
