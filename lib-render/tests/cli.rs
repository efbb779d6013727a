//! The command `jerboa` as its users run it: the words of the command line, what they print and write, and what they say
//! when something is wrong.

mod desk;

use std::process::Command;

use desk::Desk;
use jerboa_lib_render::host::image_io::Image;
use serde_json::Value;

/// A small, quick render of the default scene; more words follow.
const SMALL: &str = "render --width 20 --height 16 --spp 2";

impl Desk {
    fn json(&self, words: &str) -> Value {
        serde_json::from_str(&self.ok(words)).unwrap_or_else(|e| panic!("{words}: {e}"))
    }

    /// Bytes of the image that a small render with these words writes.
    fn bytes(&self, words: &str) -> Vec<u8> {
        self.ok(&format!("{SMALL} -o image.exr {words}"));
        std::fs::read(self.path().join("image.exr")).expect("it was written")
    }

    fn image(&self, words: &str) -> Image {
        self.bytes(words);
        Image::read(&self.path().join("image.exr")).expect("an image")
    }
}

fn mean(image: &Image) -> f64 {
    image.pixels.iter().flatten().map(|c| f64::from(*c)).sum::<f64>() / (3 * image.pixels.len()) as f64
}

fn keys(object: &Value) -> Vec<&str> {
    object.as_object().expect("an object").keys().map(String::as_str).collect()
}

#[test]
fn render_alone_writes_out_png_of_the_default_scene() {
    let desk = Desk::new();
    let text = desk.ok("render --width 20 --height 16");
    assert!(text.starts_with("out.png: 20x16, 64 spp, ") && text.contains("specialize"), "{text}");
    assert_eq!(desk.files(), ["out.png"]);
    let image = Image::read(&desk.path().join("out.png")).expect("an image");
    assert_eq!((image.width, image.height), (20, 16));
    assert!(mean(&image) > 0.05, "the box is lit");
}

#[test]
fn an_exr_is_linear_32_bit_rgb_and_a_png_is_exposed() {
    let desk = Desk::new();
    desk.ok(&format!("{SMALL} -o a.exr"));
    let exr = image::ImageReader::open(desk.path().join("a.exr")).expect("a file").decode().expect("an image");
    assert_eq!(exr.color(), image::ColorType::Rgb32F);
    let linear = Image::read(&desk.path().join("a.exr")).expect("an image");
    assert!(linear.pixels.iter().flatten().any(|c| *c > 1.0), "the lamp is brighter than white");
    for (ev, gain) in [("0", 1.0), ("-2", 0.25), ("1.5", 2.0_f32.powf(1.5))] {
        desk.ok(&format!("{SMALL} -o a.png --exposure {ev}"));
        let png = Image::read(&desk.path().join("a.png")).expect("an image");
        for (shown, c) in png.pixels.as_flattened().iter().zip(linear.pixels.as_flattened()) {
            // Half a step of 8 bits is at most 0.0046 where the sRGB curve is flattest, at 1.
            assert!((shown - (c * gain).clamp(0.0, 1.0)).abs() < 0.0047, "{ev} EV: {shown} for {c}");
        }
    }
}

#[test]
fn a_crop_has_the_very_pixels_of_the_full_image() {
    let desk = Desk::new();
    let full = desk.image("");
    for [x, y, width, height] in [[0, 0, 20, 16], [3, 5, 7, 9], [19, 15, 1, 1], [0, 15, 20, 1]] {
        let crop = desk.image(&format!("--crop {x},{y},{width},{height}"));
        let expected = Image::from_fn(width, height, |i, j| full.pixels[((y + j) * 20 + x + i) as usize]);
        assert!(crop == expected, "--crop {x},{y},{width},{height}");
    }
}

#[test]
fn what_must_not_change_the_image_does_not() {
    let desk = Desk::new();
    let image = desk.bytes("");
    for words in [
        "",
        "--threads 1",
        "--threads 2",
        "--known nothing",
        "--known all",
        "--device cpu",
        "--seed 0",
        "--time-limit 1000",
    ] {
        assert!(desk.bytes(words) == image, "{words}");
    }
}

#[test]
fn what_changes_the_image_does() {
    let desk = Desk::new();
    let image = desk.bytes("");
    for words in [
        "--seed 1",
        "--max-depth 1",
        "--max-depth 2",
        "--rr-depth 1",
        "--rr-cap 0.1",
        "--tracer normals",
        "--tracer albedo",
        "--tracer depth",
    ] {
        assert!(desk.bytes(words) != image, "{words}");
    }
}

#[test]
fn max_depth_counts_edges() {
    let desk = Desk::new();
    let [one, two, all] = ["1", "2", "1000"].map(|d| desk.image(&format!("--max-depth {d} --spp 8")));
    // With one edge only the lamp is seen; it fills a small part of the view.
    let lit = |image: &Image| image.pixels.iter().filter(|p| p[0] > 0.0).count();
    assert!((1..20 * 16 / 8).contains(&lit(&one)), "{} lit pixels", lit(&one));
    assert!(lit(&two) > 20 * 16 / 2);
    assert!(mean(&one) < mean(&two) && mean(&two) < mean(&all));
}

#[test]
fn debug_tracers_show_the_first_hit() {
    let desk = Desk::new();
    let view = "builtin:closed-box-50 --spp 1 --tracer";
    let albedo = desk.image(&format!("{view} albedo"));
    assert!(albedo.pixels.iter().all(|p| *p == [0.5; 3]), "{:?}", albedo.pixels[0]);
    for n in desk.image(&format!("{view} normals")).pixels {
        let n = n.map(|c| 2.0 * c - 1.0);
        assert!((n.iter().map(|c| c * c).sum::<f32>() - 1.0).abs() < 1e-5, "{n:?}");
    }
    // The camera stands inside the box 2 x 2 x 2.
    let depth = desk.image(&format!("{view} depth"));
    assert!(depth.pixels.iter().flatten().all(|d| (0.5..3.5).contains(d)), "{:?}", depth.pixels[0]);
}

#[test]
fn the_environment_comes_from_the_scene_or_the_command_line() {
    let desk = Desk::new();
    let sky = Image::from_fn(16, 8, |x, y| [x as f32 / 8.0, y as f32 / 4.0, 1.0]);
    sky.write(&desk.path().join("sky.exr"), 0.0).expect("written");
    let scene = "builtin:point-light --max-depth 3 --env sky.exr";
    let plain = desk.image(scene);
    assert!(desk.image("builtin:point-light --max-depth 3") != plain);
    assert!(desk.image(&format!("{scene} --env-rotation 0 --env-strength 1")) == plain);
    assert!(desk.image(&format!("{scene} --env-rotation -90")) != plain);
    // The environment's own strength scales the scene's too.
    let lit = |strength: &str| mean(&desk.image(&format!("builtin:white-furnace --env-strength {strength}")));
    assert_eq!(lit("0"), 0.0);
    assert!((lit("4") / lit("1") - 4.0).abs() < 1e-3);
}

#[test]
fn a_camera_is_found_by_name() {
    let desk = Desk::new();
    assert!(desk.bytes("--camera camera") == desk.bytes(""));
    let error = desk.error(&format!("{SMALL} --camera Foo"));
    assert_eq!(error, "camera \"Foo\": there is no camera of that name or number; there are camera");
}

#[test]
fn a_time_limit_ends_the_render_and_the_image_is_written() {
    let desk = Desk::new();
    let report = desk.json("render --width 64 --height 64 --spp 1000000000 --time-limit 0.5 --json -o a.exr");
    let spp = report["spp"].as_u64().expect("a number");
    assert!((1..1_000_000_000).contains(&spp), "{report}");
    assert!(mean(&Image::read(&desk.path().join("a.exr")).expect("an image")) > 0.05);
}

#[test]
fn shading_normals_and_the_film_size_are_chosen() {
    let desk = Desk::new();
    // They differ in few paths; in one at least with this seed.
    let odd = "builtin:odd-normals --sampler independent --seed 3 --shading-normals";
    assert!(desk.bytes(&format!("{odd} free")) != desk.bytes(&format!("{odd} consistent")));
    // The default camera asks for 512x512; one side alone keeps its aspect.
    let size = |words: &str| {
        let report = desk.json(&format!("render --spp 1 --json {words}"));
        (report["width"].as_u64(), report["height"].as_u64())
    };
    assert_eq!(size("--width 10"), (Some(10), Some(10)));
    assert_eq!(size("builtin:many-lights --height 12"), (Some(16), Some(12)));
    assert_eq!(size("--crop 0,0,2,2"), (Some(512), Some(512)));
}

#[test]
fn json_of_render_tells_samples_rays_and_seconds() {
    let desk = Desk::new();
    let report = desk.json(&format!("{SMALL} --json"));
    assert_eq!(
        keys(&report),
        ["dropped_samples", "estimated_relmse", "height", "output", "rays", "seconds", "spp", "width"]
    );
    assert_eq!((report["spp"].as_u64(), report["dropped_samples"].as_u64()), (Some(2), Some(0)));
    // Each sample has a camera ray.
    assert!(report["rays"]["closest"].as_u64() >= Some(20 * 16 * 2), "{report}");
    assert!(report["rays"]["shadow"].as_u64() > Some(0), "{report}");
    assert_eq!(keys(&report["seconds"]), ["bvh", "codegen", "load", "render", "specialize", "tables"]);
    assert!(report["seconds"].as_object().expect("an object").values().all(|s| s.as_f64() >= Some(0.0)), "{report}");
}

#[test]
fn json_of_time_tells_each_phase_and_kernel() {
    let desk = Desk::new();
    let report = desk.json("time builtin:cornell-box --json");
    assert_eq!(keys(&report), ["bvh_ms", "codegen_ms", "kernels", "load_ms", "specialize_ms", "total_ms"]);
    let kernels = report["kernels"].as_array().expect("a list");
    let names: Vec<_> = kernels.iter().map(|k| k["name"].as_str().expect("a name")).collect();
    assert_eq!(names, ["generate", "trace", "miss", "shadow", "shade.0", "shade.1", "shade.2"]);
    // Kernels are made in parallel, so the whole may take less than their sum, but no less than any of them.
    for key in ["specialize_ms", "codegen_ms"] {
        let ms = |object: &Value| object[key].as_f64().expect("a number");
        assert!(kernels.iter().all(|k| ms(k) <= ms(&report)), "{report}");
    }
    for k in kernels {
        let number = |key: &str| k[key].as_u64().expect("a whole number");
        assert!(number("nodes_before") >= number("nodes_after") && number("nodes_after") > 0, "{k}");
        assert!(number("code_bytes") > 0, "{k}");
    }
    assert!(desk.ok("time builtin:cornell-box").contains("generate specialize"));
}

#[test]
fn json_of_compare_tells_the_figures() {
    let desk = Desk::new();
    for seed in 0..17 {
        desk.ok(&format!("{SMALL} --seed {seed} -o {seed}.exr"));
    }
    let report = desk.json("compare 0.exr 1.exr 16.exr --json --diff d.png");
    for key in ["rmse", "relmse"] {
        assert!(report[key].as_f64() > Some(0.0), "{report}");
    }
    assert!(desk.path().join("d.png").is_file());
    let renders: Vec<String> = (0..16).map(|seed| format!("{seed}.exr")).collect();
    let report = desk.json(&format!("compare {} 16.exr --ref-variance 0.1 --json", renders.join(" ")));
    for key in ["rmse", "relmse", "rms_z", "blocks_beyond", "max_z", "mean_sigmas"] {
        assert!(report[key].is_f64(), "{key}: {report}");
    }
}

/// Where a driver is missing, the command lists what is there, and what would help.
#[test]
fn devices_lists_cpus_gpus_and_what_auto_takes() {
    let devices = |words: &str, driver: Option<&str>| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_jerboa"));
        driver.map(|path| command.env("VK_DRIVER_FILES", path).env("VK_ICD_FILENAMES", path));
        let out = command.args(words.split_whitespace()).output().expect("the command starts");
        assert!(out.status.success(), "{words}: {}", String::from_utf8_lossy(&out.stderr));
        String::from_utf8(out.stdout).expect("text")
    };
    let json = |text: String| serde_json::from_str::<Value>(&text).expect("JSON");
    let here = json(devices("devices --json", None));
    assert_eq!(keys(&here), ["adapters", "auto", "cpu", "no_adapter"]);
    assert_eq!(here["cpu"]["devices"], serde_json::json!(["cpu", "cpu-scalar"]));
    let (adapters, text) = (here["adapters"].as_array().expect("a list"), devices("devices", None));
    for adapter in adapters {
        let expected = ["devices", "driver", "exact", "kind", "largest_buffer_bytes", "name", "system", "unfit"];
        assert_eq!(keys(adapter), expected);
        assert!(text.contains(adapter["name"].as_str().expect("text")), "{text}");
        assert_eq!(
            adapter["devices"].as_array().expect("a list").is_empty(),
            adapter["unfit"].is_string(),
            "{adapter}"
        );
    }
    assert_eq!(here["no_adapter"].is_string(), adapters.is_empty(), "{here}");
    if adapters.iter().all(|a| a["kind"] == "software") {
        assert_eq!(here["auto"]["device"], "cpu");
    }
    assert!(text.contains(&format!("--device auto takes {}: ", here["auto"]["device"].as_str().expect("text"))));
    if cfg!(target_os = "linux") {
        let none = json(devices("devices --json", Some("/nonexistent")));
        assert_eq!((&none["adapters"], &none["auto"]["device"]), (&serde_json::json!([]), &Value::from("cpu")));
        let help = if cfg!(feature = "gpu") { "mesa-vulkan-drivers" } else { "cargo feature" };
        assert!(none["no_adapter"].as_str().is_some_and(|why| why.contains(help)), "{none}");
        assert!(devices("devices", Some("/nonexistent")).contains(help));
    }
    if cfg!(feature = "gpu") && adapters.is_empty() {
        assert_ne!(std::env::var("CI").as_deref(), Ok("true"), "no adapter is here: install mesa-vulkan-drivers");
        println!("skipped: what is said of an adapter, since none is here");
    }
}

/// Where a device needs a GPU and there is none: one line that says what would help, and exit code 1.
#[test]
fn without_a_driver_a_gpu_is_refused() {
    let nowhere = "/nonexistent";
    for words in ["render -o a.png --device gpu-megakernel", "time builtin:tiny --device gpu-wavefront"] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_jerboa"));
        command.env("VK_DRIVER_FILES", nowhere).env("VK_ICD_FILENAMES", nowhere);
        let out = command.args(words.split_whitespace()).output().expect("the command starts");
        let told = String::from_utf8_lossy(&out.stderr);
        let help = if cfg!(feature = "gpu") { "mesa-vulkan-drivers" } else { "cargo feature" };
        let is_right = told.lines().count() == 1 && told.contains(help);
        assert!(!cfg!(target_os = "linux") || (out.status.code() == Some(1) && is_right), "{words}: {told}");
    }
}

#[test]
fn bench_table_3_counts_the_sources() {
    let sources = concat!(env!("CARGO_MANIFEST_DIR"), "/src");
    let parts = Desk::new().json(&format!("bench table-3 {sources} --json"));
    let names: Vec<&str> =
        parts.as_array().expect("a list").iter().map(|p| p["part"].as_str().expect("text")).collect();
    assert_eq!(names[0], "core");
    assert!(names.len() > 2, "{names:?}");
    for part in parts.as_array().expect("a list") {
        assert!(part["lines"].as_u64() > Some(50) && part["effort"].as_f64() > Some(1e4), "{part}");
    }
}

/// A speed stands beside how far its images are from the CPU's, and a software driver's is not called a GPU's.
#[test]
fn bench_devices_tells_speed_and_whether_images_are_equal() {
    let desk = Desk::new();
    let report = desk.json("bench devices builtin:cornell-box --width 8 --height 8 --spp 1 --rounds 1 --json");
    let group = &report["charts"][0]["groups"][0];
    let bar = |name: &str| group["bars"].as_array().expect("a list").iter().find(|b| b["series"] == name).cloned();
    for device in ["cpu", "cpu-scalar"] {
        assert!(bar(device).is_some_and(|b| b["median"].as_f64() > Some(0.0)), "{report}");
    }
    assert_eq!(group["notes"]["cpu-scalar off"], 0.0);
    let remarks: Vec<&str> = report["remarks"].as_array().expect("a list").iter().filter_map(Value::as_str).collect();
    assert!(remarks.contains(&"cpu-scalar: all images equal those of cpu, bit for bit"), "{remarks:?}");
    let adapters = desk.json("devices --json")["adapters"].as_array().expect("a list").clone();
    let real = adapters.iter().any(|a| a["kind"].as_str().is_some_and(|k| k.ends_with("GPU")) && a["unfit"].is_null());
    let start = match adapters.first() {
        None if cfg!(feature = "gpu") => "no GPU and no driver",
        None => "this build has no code for GPUs",
        Some(_) if real => "GPU devices run on `",
        Some(_) => "no GPU speed is claimed: ",
    };
    assert!(remarks[0].starts_with(start), "{remarks:?}");
    for device in ["gpu-megakernel", "gpu-wavefront"] {
        let why = remarks.iter().any(|r| r.starts_with(&format!("{device}: ")));
        assert!(why, "{device} ran or it is said why not: {remarks:?}");
    }
}

#[test]
fn bench_stability_tells_speed_and_error_and_shows_pictures() {
    let desk = Desk::new();
    let report =
        desk.json("bench stability --scene pinpoint-lamp builtin:empty --spp 4 --threads 1 --json -o sheet.png");
    let [lamp, empty] = &report.as_array().expect("a list")[..] else { panic!("two scenes: {report}") };
    assert_eq!((lamp["scene"].as_str(), empty["scene"].as_str()), (Some("pinpoint-lamp"), Some("empty")));
    let expected = "beside dropped_samples mean naive non_finite_pixels pass purpose rays_per_sample rays_per_second reference relative \
                    samples samples_per_second scene seconds sigmas standard_error";
    assert_eq!(keys(lamp), expected.split_whitespace().collect::<Vec<_>>());
    assert_eq!(keys(&lamp["reference"]), ["mean", "source", "spp", "standard_error"]);
    for row in [lamp, empty] {
        assert_eq!((row["pass"].as_bool(), row["dropped_samples"].as_u64()), (Some(true), Some(0)), "{row}");
        assert!(
            row["samples_per_second"].as_f64() > Some(0.0) && row["rays_per_sample"].as_f64() >= Some(1.0),
            "{row}"
        );
    }
    assert_eq!((lamp["samples"].as_u64(), empty["mean"].as_f64()), (Some(4 * 108 * 108), Some(0.0)));
    assert!(lamp["sigmas"].as_f64().is_some_and(|s| s.abs() <= 4.0 && s != 0.0), "{lamp}");
    let sheet = Image::read(&desk.path().join("sheet.png")).expect("an image");
    assert!(sheet.width > 2 * 108 && sheet.height > 108 && mean(&sheet) > 0.02, "{}x{}", sheet.width, sheet.height);
    let table = desk.ok("bench stability --scene tiny --spp 4");
    assert_eq!(table.lines().count(), 6, "{table}");
    assert!(table.lines().nth(1).is_some_and(|l| l.starts_with("tiny ") && l.ends_with("pass")), "{table}");
    let beside = table.lines().last().is_some_and(|l| l.starts_with("tiny ") && l.ends_with("--ray-offset 0.001"));
    assert!(beside, "{table}");
}

#[test]
fn dumps_read_back_and_verify() {
    let desk = Desk::new();
    let generic = jerboa_ir::parse(&desk.ok("dump builtin:cornell-box --stage generic")).expect("it parses");
    assert_eq!(jerboa_ir::verify(&generic), []);
    for words in ["--kernel path", "--kernel normals_shade.0 --known nothing", "--kernel shade.1 --known all"] {
        let residual = jerboa_ir::parse(&desk.ok(&format!("dump builtin:cornell-box --stage residual {words}")))
            .expect("it parses");
        assert_eq!(jerboa_ir::verify_residual(&residual), [], "{words}");
    }
    assert!(desk.ok("dump builtin:cornell-box --stage clif --kernel depth").contains("function "));
    assert!(desk.ok("dump builtin:cornell-box --stage asm --kernel depth").contains("ret"));
    if cfg!(feature = "gpu") {
        for (stage, word) in [("structured", "loop"), ("naga", "@compute"), ("spirv", "OpEntryPoint")] {
            let text = desk.ok(&format!("dump builtin:cornell-box --stage {stage} --kernel wavefront_scan"));
            assert!(text.contains(word), "{stage}: {text}");
        }
    }
    let all = desk.ok("dump builtin:cornell-box --stage residual");
    let entries = |kernel: &str| all.lines().filter(|l| l.starts_with(&format!("entry {kernel} ="))).count();
    assert_eq!(["generate", "trace", "shade", "miss", "shadow", "path"].map(entries), [1, 1, 3, 1, 1, 0]);
}

#[test]
fn explain_says_why_and_trace_follows_a_path() {
    let desk = Desk::new();
    let text = desk.ok("explain builtin:cornell-box --kernel path");
    assert!(text.starts_with("kernel path\n") && text.contains("traverse"), "{text}");
    for sample in 0..4 {
        let text = desk.ok(&format!("trace builtin:material-balls --pixel 120,200 --sample {sample}"));
        assert!(text.contains("traverse") && text.contains("radiance ["), "{text}");
        assert!(text.ends_with("machine code gives the same bits\n"), "{text}");
    }
}

/// Commands that look into a render draw the numbers that it draws, with the same words and without any.
#[test]
fn what_is_traced_dumped_explained_and_timed_is_what_is_rendered() {
    let desk = Desk::new();
    for words in ["", "--sampler independent", "--scrambles 8 --seed 3"] {
        let text = desk.ok(&format!("trace builtin:material-balls --pixel 120,200 --sample 0 {words}"));
        let (_, radiance) = text.rsplit_once("radiance [").expect("the last lines");
        let numbers = radiance.split_once(']').expect("three numbers").0.split(", ");
        let traced: Vec<f32> = numbers.map(|x| x.parse().expect("a number")).collect();
        desk.ok(&format!("render builtin:material-balls --crop 120,200,1,1 --spp 1 -o a.exr {words}"));
        let rendered = Image::read(&desk.path().join("a.exr")).expect("an image").pixels[0];
        assert!(rendered[1] > 0.0 && traced == rendered, "{words}: {traced:?} and {rendered:?}");
    }
    for command in ["dump builtin:tiny --stage residual --kernel generate", "explain builtin:tiny --kernel generate"] {
        let [unsaid, sobol, independent] =
            ["", "--sampler sobol", "--sampler independent"].map(|words| desk.ok(&format!("{command} {words}")));
        // The log ends with times.
        let lines = |text: &str| text.lines().filter(|l| !l.contains(" us  ")).map(str::to_string).collect::<Vec<_>>();
        assert!(lines(&unsaid) == lines(&sobol) && lines(&unsaid) != lines(&independent), "{command}");
    }
    let nodes =
        |words: &str| desk.json(&format!("time builtin:tiny --json {words}"))["kernels"][0]["nodes_after"].as_u64();
    assert!(nodes("") == nodes("--sampler sobol") && nodes("") > nodes("--sampler independent"));
    let mean =
        |words: &str| desk.json(&format!("bench stability --scene tiny --spp 4 --json {words}"))[0]["mean"].as_f64();
    assert!(mean("") == mean("--sampler sobol") && mean("") != mean("--sampler independent"));
}

#[test]
fn every_error_is_one_readable_line() {
    let desk = Desk::new();
    std::fs::write(desk.path().join("hello.glb"), "hello").expect("written");
    std::fs::create_dir(desk.path().join("folder.png")).expect("made");
    let missing = "cannot be read: No such file or directory (os error 2); check the path and its permissions";
    let cases = [
        ("", "a command is missing: `jerboa render` makes a first picture (jerboa --help lists the words)"),
        ("frob", "unrecognized subcommand 'frob'"),
        ("render nowhere.glb", &format!("nowhere.glb: {missing}")),
        ("render hello.glb", "hello.glb: the JSON does not parse"),
        ("render builtin:nothing", "builtin:nothing: no such built-in scene; there are cornell-box, "),
        ("render -o out.jpg", "cannot write out.jpg: its name must end in .exr (linear) or .png (tone-mapped)"),
        ("render -o out.hdr", "cannot write out.hdr: its name must end in .exr (linear) or .png (tone-mapped)"),
        ("render -o nowhere/out.png", "cannot write nowhere/out.png: there is no such folder"),
        ("render -o folder.png", "cannot write folder.png: it is not a regular file"),
        ("render --env nowhere.hdr", &format!("nowhere.hdr: {missing}")),
        ("render --env-strength 2", "the scene has no environment to turn or scale: name one by --env FILE"),
        (
            "render --env-strength -2",
            "invalid value '-2' for '--env-strength <X>': expected a finite number, 0 or more",
        ),
        ("render --crop 510,0,4,4", "--crop 510,0,4,4 reaches beyond the film of 512x512"),
        ("render --crop 4294967295,0,1,1", "--crop 4294967295,0,1,1 reaches beyond the film of 512x512"),
        (
            "render --width 65536 --height 65536",
            "a film of 65536x65536 is too large, at most 67108864 pixels: render parts by --crop",
        ),
        ("render --spp 0", "invalid value '0' for '--spp <N>'"),
        (
            "render --tracer wood",
            "invalid value 'wood' for '--tracer <TRACER>' [possible values: path, light, bidirectional, normals, albedo, depth, ao]",
        ),
        (
            "dump builtin:cornell-box --stage clif --kernel wood",
            "there is no kernel `wood`; there are generate, trace, miss, shadow, shade.0, shade.1, shade.2, normals_generate, ",
        ),
        ("dump builtin:cornell-box --stage generic --kernel wood", "there is no kernel `wood`"),
        ("dump nowhere.glb --stage generic", &format!("nowhere.glb: {missing}")),
        ("dump builtin:cornell-box", "the following required arguments were not provided: --stage <STAGE>"),
        ("explain builtin:cornell-box --kernel wood", "there is no kernel `wood`"),
        ("time nowhere.glb", &format!("nowhere.glb: {missing}")),
        ("trace builtin:cornell-box --pixel 512,0 --sample 0", "--pixel 512,0 is not on the film of 512x512"),
        (
            "trace builtin:cornell-box --pixel 5 --sample 0",
            "invalid value '5' for '--pixel <X,Y>': expected X,Y, as in 120,80",
        ),
        (
            "bench stability --scene glass",
            "--scene glass: not in the gallery of hard cases; there are cornell-box, far-away, ",
        ),
        (
            "bench stability -o out.jpg",
            "cannot write out.jpg: its name must end in .exr (linear) or .png (tone-mapped)",
        ),
        ("bench table-3", "lib-render/src: cannot be read: No such file or directory"),
        ("bench table-3 .", ".: traverse is not there; these are not the sources I know"),
        ("bench stability --spp 0", "invalid value '0' for '--spp <N>'"),
        ("bench", "a command is missing"),
        ("compare a.exr b.exr", "cannot read b.exr: No such file or directory (os error 2)"),
    ];
    for (words, start) in cases {
        let line = desk.error(words);
        assert!(line.starts_with(start), "jerboa {words}: {line}");
    }
    assert_eq!(desk.files(), ["folder.png", "hello.glb"], "a failed command leaves nothing behind");
}

/// A built-in scene has nothing to choose among, so each word comes back with a complaint.
#[test]
fn every_command_that_loads_a_scene_takes_the_words_that_choose_within_a_file() {
    let desk = Desk::new();
    let commands = [
        "render",
        "dump --stage generic",
        "time",
        "explain",
        "trace --pixel 0,0 --sample 0",
        "bench rays",
        "bench edits",
        "bench devices",
        "bench table-2",
        "bench figure-2",
        "bench figure-5",
    ];
    for command in commands {
        for (words, noun) in
            [("--scene x", "scene"), ("--variant x", "variant"), ("--time 0.5 --animation x", "animation")]
        {
            let line = desk.error(&format!("{command} builtin:empty {words}"));
            assert_eq!(line, format!("{noun} \"x\": there is no {noun} to choose; leave the name out"), "{command}");
        }
    }
}

#[test]
fn a_failed_write_leaves_the_old_file() {
    let desk = Desk::new();
    let old = desk.path().join("out.png");
    std::fs::write(&old, "old").expect("written");
    desk.error("render --width 8 --height 8 --spp 1 builtin:nothing");
    desk.error("render --width 8 --height 8 --spp 1 --crop 9,9,9,9");
    assert_eq!(std::fs::read(&old).expect("it is there"), b"old");
    desk.ok("render --width 8 --height 8 --spp 1");
    assert!(Image::read(&old).is_ok());
    assert_eq!(desk.files(), ["out.png"], "no temporary file is left");
}

#[test]
fn warnings_are_lines_and_no_failure() {
    let desk = Desk::new();
    let out = desk.run(&format!("{SMALL} builtin:empty"));
    assert!(out.status.success());
    let warnings = String::from_utf8(out.stderr).expect("text");
    assert!(warnings.lines().all(|l| l.starts_with("jerboa: warning: ")), "{warnings}");
    assert!(warnings.contains("no triangles") && warnings.contains("no light"), "{warnings}");
    assert_eq!(mean(&Image::read(&desk.path().join("out.png")).expect("an image")), 0.0);
    let lit = desk.run(&format!("{SMALL} builtin:empty --env sky:30"));
    let warnings = String::from_utf8(lit.stderr).expect("text");
    assert!(warnings.contains("no triangles") && !warnings.contains("no light"), "{warnings}");
}

#[test]
fn help_says_every_word() {
    let desk = Desk::new();
    let help = desk.ok("--help");
    for command in ["render", "merge", "dump", "time", "explain", "trace", "compare", "devices", "bench"] {
        assert!(help.contains(&format!("\n  {command}")), "{help}");
        assert!(desk.ok(&format!("{command} --help")).contains("Usage: jerboa"), "{command}");
    }
    let words = "--output --spp --width --height --max-depth --seed --known --device --tracer --camera --shading-normals --env \
                 --env-rotation --env-strength --rr-depth --rr-cap --crop --exposure --threads --time-limit --json \
                 --sample-range --checkpoint --variance --noise";
    let help = desk.ok("bench stability --help");
    for word in ["--scene", "--spp", "--seed", "--threads", "--json", "--output", "standard errors"] {
        assert!(help.contains(word), "{word}: {help}");
    }
    let help = desk.ok("render --help");
    assert_eq!(
        words.split_whitespace().find(|w| !help.contains(&format!("{w} ")) && !help.contains(&format!("{w}\n"))),
        None
    );
}
