//! How long trees of hostile triangles take to build.

use jerboa_lib_render::host::bvh::Bvh;
use jerboa_tests::harness::bench::{Random, number};
use jerboa_tests::harness::hostile::LISTS;

use jerboa_tests::harness::clock::processor_time;

/// Builds of each list.
const ROUNDS: usize = 5;

/// Prints a row for each list; fails where a median is more than ten times that of random triangles.
pub fn table() -> Result<(), String> {
    let mut random = Random::new(0x5eed_0029);
    let n = number("JERBOA_TRIANGLES", 100_000);
    println!("| triangles | count | dropped | depth | median of {ROUNDS} builds, ms | times random |");
    println!("|---|---|---|---|---|---|");
    let mut measure = None;
    let mut slow = Vec::new();
    for list in &LISTS {
        let triangles = (list.make)(&mut random, n);
        let bvh = Bvh::build(&triangles);
        let mut times: Vec<f64> = (0..ROUNDS)
            .map(|_| {
                let start = processor_time();
                std::hint::black_box(Bvh::build(&triangles));
                1e3 * (processor_time() - start)
            })
            .collect();
        times.sort_by(f64::total_cmp);
        let median = times[ROUNDS / 2];
        let times_random = median / *measure.get_or_insert(median);
        let dropped = bvh.dropped.non_finite + bvh.dropped.zero_area;
        println!(
            "| {} | {} | {dropped} | {} | {median:.1} | {times_random:.2} |",
            list.name,
            triangles.len(),
            bvh.depth
        );
        if times_random > 10.0 {
            slow.push(list.name);
        }
    }
    if slow.is_empty() { Ok(()) } else { Err(format!("more than ten times the time of random triangles: {slow:?}")) }
}
