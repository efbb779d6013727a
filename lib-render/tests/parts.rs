//! Renders in parts: samples in any pieces, on any machine, killed and gone on with, give the very bytes of the whole.

mod desk;

use std::fs;
use std::process::Stdio;
use std::thread::sleep;
use std::time::{Duration, Instant};

use desk::Desk;
use jerboa_lib_render::host::exr::read_channels;
use jerboa_lib_render::host::film::{Film, GROUPS, Window};
use jerboa_lib_render::host::generate::TracerKind;
use jerboa_lib_render::host::image_io::Image;
use jerboa_lib_render::host::origin::Span;
use jerboa_lib_render::host::part::Part;
use jerboa_lib_render::host::renderer::{Handle, Options, Render, Renderer};
use jerboa_scenes::Scene;

/// A small render of a scene that has everything, of as many sequences as tell its error; more words follow.
const SMALL: &str = "render builtin:material-balls --width 21 --height 14 --scrambles 8";

fn bytes(desk: &Desk, name: &str) -> Vec<u8> {
    fs::read(desk.path().join(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
}

fn part(desk: &Desk, name: &str) -> Part {
    Part::read(&desk.path().join(name)).unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn parts_add_up_to_the_bytes_of_the_whole() {
    let desk = Desk::new();
    for (words, layers) in
        [("", ""), ("--variance", "--variance"), ("--seed 5 --crop 3,2,11,9 --device cpu-scalar", "")]
    {
        desk.ok(&format!("{SMALL} {words} --spp 40 -o whole.exr"));
        // In pieces that fit no pass, by machines that have nothing in common.
        for (range, how) in
            [("0..7", "--threads 1"), ("7..24", "--threads 3 --known nothing"), ("24..40", "--known all")]
        {
            desk.ok(&format!("{SMALL} {words} {how} --sample-range {range} -o {range}.exr"));
        }
        desk.ok(&format!("merge 24..40.exr 0..7.exr 7..24.exr {layers} -o merged.exr"));
        assert!(bytes(&desk, "merged.exr") == bytes(&desk, "whole.exr"), "{words}");

        // Parts of parts are parts.
        desk.ok("merge 7..24.exr 24..40.exr --part -o rest.exr");
        desk.ok("merge rest.exr 0..7.exr --part -o all.exr");
        desk.ok(&format!("{SMALL} {words} --sample-range 0..40 -o at-once.exr"));
        assert!(bytes(&desk, "all.exr") == bytes(&desk, "at-once.exr"), "{words}");
        // Who knows nothing of parts sees the image.
        let seen = |name: &str| Image::read(&desk.path().join(name)).expect("an image");
        assert!(seen("all.exr") == seen("whole.exr"), "{words}");
        for name in desk.files() {
            fs::remove_file(desk.path().join(name)).expect("it is ours");
        }
    }
}

/// A tracer whose light falls on any pixel leaves a sum for a pass, as GPUs do.
#[test]
fn what_is_summed_by_passes_is_in_the_right_groups() {
    let scene = Scene::load("builtin:caustic").unwrap_or_else(|e| panic!("{e}"));
    let options = Options { tracer: TracerKind::Light, ..Options::default() };
    let renderer = Renderer::new(&scene, options).unwrap_or_else(|e| panic!("{e}"));
    let window = Window { x: 1, y: 2, width: 9, height: 7 };
    let render = |film: Film, sample: u32, end: u32| {
        let (mut film, job) = (film, Render { sample, spp: end - sample, seed: 3 });
        renderer
            .render_with(&scene.camera_or_default(), &mut film, job, &Handle::default())
            .unwrap_or_else(|e| panic!("{e}"));
        film
    };
    let grouped = || Film::try_grouped([12, 10], window).expect("memory");
    let whole = render(grouped(), 0, 20);
    let mut sum = render(grouped(), 5, 20);
    sum.merge(&render(grouped(), 0, 5)).expect("the same window");
    assert!(sum == whole);
    for (group, count) in (0..GROUPS).zip([3, 3, 3, 3, 2, 2, 2, 2]) {
        assert!(whole.group(group).all(|(_, n)| n == count), "group {group}");
    }
    assert!(whole.mean() == render(Film::crop([12, 10], window), 0, 20).mean());
    assert!(whole.mean().pixels.iter().any(|p| p[0] > 0.0));
}

/// Whether their numbers are the same or go on.
#[test]
fn parts_of_other_seeds_are_more_samples() {
    let desk = Desk::new();
    for (seed, range) in [(1, "0..8"), (2, "0..8"), (3, "8..16")] {
        desk.ok(&format!("{SMALL} --seed {seed} --sample-range {range} --variance -o {seed}.exr"));
    }
    let report = desk.ok("merge 1.exr 2.exr 3.exr --json -o all.exr");
    let report: serde_json::Value = serde_json::from_str(&report).expect("JSON");
    assert_eq!(report["spp"], 24);
    assert_eq!(report["samples"], serde_json::json!(["0..8 of seed 1", "0..8 of seed 2", "8..16 of seed 3"]));
    assert!(report["estimated_relmse"].as_f64() > Some(0.0), "{report}");
    let read = |name: &str| Image::read(&desk.path().join(name)).expect("an image").pixels;
    let (parts, all) = (["1.exr", "2.exr", "3.exr"].map(read), read("all.exr"));
    for (i, mean) in all.iter().enumerate() {
        for c in 0..3 {
            let sum: f32 = parts.iter().map(|part| part[i][c]).sum();
            assert!((sum / 3.0 - mean[c]).abs() <= 1e-6 * mean[c]);
        }
    }
}

#[test]
fn what_does_not_belong_together_is_refused_by_name() {
    let desk = Desk::new();
    let render = |name: &str, range: &str, words: &str| {
        desk.ok(&format!("{SMALL} --sample-range {range} {words} -o {name}.exr"));
    };
    render("a", "0..4", "");
    render("overlap", "2..6", "");
    render("one", "3..6", "");
    render("later", "8..9", "");
    render("wide", "4..5", "--width 22");
    render("crop", "4..5", "--crop 1,2,3,4");
    render("deep", "4..5", "--max-depth 3");
    render("lens", "4..5", "--aperture 0.01 --focus 3");
    render("sharp", "4..5", "--variance");
    render("dark", "4..5", "--env-strength 0.5");
    desk.ok("render builtin:cornell-box --width 21 --height 14 --sample-range 4..5 -o box.exr");
    desk.ok("render --width 21 --height 14 --spp 1 -o image.exr");
    let whole = bytes(&desk, "a.exr");
    fs::write(desk.path().join("cut.exr"), &whole[..whole.len() / 2]).expect("written");
    let cases = [
        ("a overlap", "cannot add overlap.exr to a.exr: samples 2..4 of seed 0 are counted twice"),
        ("a one", "cannot add one.exr to a.exr: samples 3..4 of seed 0 are counted twice"),
        ("a a", "cannot add a.exr to a.exr: samples 0..4 of seed 0 are counted twice"),
        ("later a", "samples 4..8 of seed 0 are in no part: render them, or put up with that by --gaps"),
        ("a wide", "cannot add wide.exr to a.exr: its film has 22x14 pixels, not 21x14"),
        ("a crop", "cannot add crop.exr to a.exr: it holds the pixels 1,2,3,4, not 0,0,21,14"),
        (
            "a deep",
            "cannot add deep.exr to a.exr: its choices differs: Choices { max_depth: Some(3), not Choices { max_depth: None",
        ),
        ("a lens", "cannot add lens.exr to a.exr: its camera differs: "),
        ("a sharp", "cannot add sharp.exr to a.exr: it was rendered with --variance, the others without --variance"),
        ("a dark", "cannot add dark.exr to a.exr: its scene differs: "),
        ("a box", "cannot add box.exr to a.exr: its scene differs: "),
        ("a image", "cannot read image.exr: it is no part: `jerboa render --sample-range A..B` writes one"),
        ("a cut", "cannot read cut.exr: "),
        ("nowhere", "cannot read nowhere.exr: No such file or directory"),
        ("a --variance", "the parts do not tell their variance: render them with --variance"),
    ];
    for (words, start) in cases {
        let words: Vec<String> =
            words.split(' ').map(|w| if w.starts_with('-') { w.into() } else { format!("{w}.exr") }).collect();
        let line = desk.error(&format!("merge {} -o merged.exr", words.join(" ")));
        assert!(line.starts_with(start), "{words:?}: {line}");
    }
    assert!(!desk.files().contains(&"merged.exr".to_string()));
    desk.ok("merge later.exr a.exr --gaps -o merged.exr");
    assert!(desk.error("merge a.exr --part -o a.png").contains("only an .exr has layers"));
}

/// A bit that is not as it was is found, wherever it is.
#[test]
fn a_spoiled_part_is_an_error() {
    let desk = Desk::new();
    desk.ok(&format!("{SMALL} --sample-range 0..3 -o a.exr"));
    let (whole, right) = (bytes(&desk, "a.exr"), part(&desk, "a.exr"));
    let path = desk.path().join("spoiled.exr");
    let mut refused = 0;
    // Every 97th byte, and some of each field of the header.
    let places = (0..whole.len()).step_by(97).chain((0..1200).step_by(3));
    for (i, place) in places.enumerate() {
        let mut spoiled = whole.clone();
        spoiled[place] ^= 1 << (i % 8);
        fs::write(&path, &spoiled).expect("written");
        match Part::read(&path) {
            Err(error) => {
                assert!(!error.to_string().contains('\n'), "{error}");
                refused += 1;
            }
            // It was in the image that others see, or in padding.
            Ok(part) => assert!(part == right, "byte {place}"),
        }
        fs::write(&path, &whole[..place]).expect("written");
        assert!(Part::read(&path).is_err(), "the first {place} bytes");
    }
    assert!(refused > 100, "{refused}");
}

/// Runs a command again and again, each time killed after it has kept another pass, so many times; then to its end.
fn killed(desk: &Desk, words: &str, kept: &str, times: usize) {
    let path = desk.path().join(kept);
    let done = || path.exists().then(|| part(desk, kept).origin.spans[0].end);
    for _ in 0..times {
        let before = done();
        let mut child = desk.command(words).stdout(Stdio::null()).spawn().expect("it starts");
        let start = Instant::now();
        while done() == before {
            assert!(start.elapsed() < Duration::from_secs(60), "no pass in a minute");
            assert!(
                child.try_wait().expect("it is ours").is_none(),
                "it ended before it was killed: give it more to do"
            );
            sleep(Duration::from_millis(1));
        }
        child.kill().expect("it is ours");
        child.wait().expect("it is ours");
        assert!(done() > before, "a pass that was kept stays");
    }
    desk.ok(words);
}

#[test]
fn who_is_killed_loses_the_pass_under_way() {
    let desk = Desk::new();
    let render = "render builtin:cornell-box --width 64 --height 64";
    killed(&desk, &format!("{render} --sample-range 3..260 -o part.exr"), "part.exr", 3);
    desk.ok(&format!("{render} --sample-range 3..260 -o at-once.exr"));
    assert!(bytes(&desk, "part.exr") == bytes(&desk, "at-once.exr"));
    assert_eq!(part(&desk, "part.exr").origin.spans, [Span { seed: 0, first: 3, end: 260 }]);
    // Of temporary files, those of the killed may stay; they are hidden, and nobody reads them.
    assert!(desk.files().iter().all(|name| name.ends_with(".exr") || name.starts_with(".jerboa-")));

    let words = format!("{render} --spp 250 --variance --checkpoint kept.exr -o image.exr");
    killed(&desk, &words, "kept.exr", 2);
    desk.ok(&format!("{render} --spp 250 --variance -o right.exr"));
    assert!(bytes(&desk, "image.exr") == bytes(&desk, "right.exr"));
    // What is kept serves for more samples.
    desk.ok(&words.replace("250", "260"));
    desk.ok(&format!("{render} --spp 260 --variance -o right.exr"));
    assert!(bytes(&desk, "image.exr") == bytes(&desk, "right.exr"));
}

#[test]
fn what_is_kept_of_another_render_is_refused() {
    let desk = Desk::new();
    desk.ok(&format!("{SMALL} --sample-range 0..4 -o a.exr"));
    let cannot = "is there, and this render cannot go on from it: ";
    for (words, why) in [
        ("--sample-range 0..3", "it holds the samples 0..4 of seed 0; remove it, or name another file"),
        ("--sample-range 1..9", "it holds the samples 0..4 of seed 0"),
        ("--sample-range 0..9 --seed 1", "it holds the samples 0..4 of seed 0"),
        ("--sample-range 0..9 --width 30", "its film has 21x14 pixels, not 30x14"),
        ("--sample-range 0..9 --rr-depth 9", "its choices differs: rr_depth: Some(3), not rr_depth: Some(9)"),
        ("--sample-range 0..9 --variance", "it was rendered without --variance"),
    ] {
        let line = desk.error(&format!("{SMALL} {words} -o a.exr"));
        assert!(line.starts_with(&format!("a.exr {cannot}{why}")), "{words}: {line}");
    }
    desk.ok(&format!("{SMALL} --spp 1 -o image.exr"));
    let line = desk.error(&format!("{SMALL} --checkpoint image.exr"));
    assert!(line.starts_with("cannot read image.exr: it is no part"), "{line}");
    let line = desk.error(&format!("{SMALL} --checkpoint b.exr -o b.exr"));
    assert!(line.starts_with("--checkpoint and --output name the same file"), "{line}");
    let line = desk.error(&format!("{SMALL} --sample-range 0..4 -o a.png"));
    assert!(line.contains("only an .exr has layers"), "{line}");
    let line = desk.error(&format!("{SMALL} --sample-range 4..4 -o b.exr"));
    assert!(line.contains("expected A..B with A below B"), "{line}");
    let line = desk.error("render --sample-range 0..9 --time-limit 0.000001 -o late.exr");
    assert!(line.starts_with("no pass came to its end within --time-limit"), "{line}");
    assert!(desk.error(&format!("{SMALL} --sample-range 0..4 --noise 0.1")).contains("cannot be used with"));
}

#[test]
fn a_render_stops_when_it_is_good_enough() {
    let desk = Desk::new();
    let report = |words: &str| -> serde_json::Value {
        let text = desk.ok(&format!("{SMALL} --json {words}"));
        serde_json::from_str(&text).expect("JSON")
    };
    assert!(report("--spp 16 -o a.exr")["estimated_relmse"].is_null());
    let at = |spp: u32| report(&format!("--spp {spp} --variance -o a.exr"))["estimated_relmse"].as_f64().expect("told");
    // What 96 samples reach, and what 64 do not quite: 96 is the next look.
    let target = (at(64) + at(96)) / 2.0;
    for words in ["--threads 1", "--threads 3 --known nothing", "--device cpu-scalar", "--checkpoint kept.exr"] {
        let stopped = report(&format!("--noise {target} {words} -o stopped.exr"));
        assert_eq!(stopped["spp"], 96, "{words}: {stopped}");
        assert!(stopped["estimated_relmse"].as_f64() <= Some(target));
        desk.ok(&format!("{SMALL} --spp 96 -o right.exr"));
        assert!(bytes(&desk, "stopped.exr") == bytes(&desk, "right.exr"), "{words}");
    }
    // What is kept of it is good enough at once.
    let again = report(&format!("--noise {target} --checkpoint kept.exr -o stopped.exr"));
    assert_eq!((&again["spp"], &again["rays"]["closest"]), (&96.into(), &0.into()));
    assert!(bytes(&desk, "stopped.exr") == bytes(&desk, "right.exr"));
    assert_eq!(report(&format!("--noise {target} --spp 40 -o a.exr"))["spp"], 40, "--spp still ends it");
    assert!(desk.ok(&format!("{SMALL} --noise 0.5 -o a.exr")).contains("\nestimated relMSE "));
    assert!(desk.error(&format!("{SMALL} --noise 0")).contains("expected a finite number above 0"));
}

#[test]
fn the_variance_is_a_layer() {
    let desk = Desk::new();
    desk.ok(&format!("{SMALL} --spp 32 --variance --aov samples -o a.exr"));
    let (_, channels) = read_channels(&desk.path().join("a.exr")).expect("channels");
    let names: Vec<&str> = channels.iter().map(|c| c.name.as_str()).collect();
    assert_eq!(names, ["B", "G", "R", "samples.X", "variance.B", "variance.G", "variance.R"]);
    for channel in channels.iter().filter(|c| c.name.starts_with("variance")) {
        assert!(channel.values.iter().all(|v| v.is_finite() && *v >= 0.0) && channel.values.iter().any(|v| *v > 0.0));
    }
    let plain = desk.path().join("b.exr");
    desk.ok(&format!("{SMALL} --spp 32 -o b.exr"));
    assert!(Image::read(&plain) == Image::read(&desk.path().join("a.exr")), "the image is the same");
}
