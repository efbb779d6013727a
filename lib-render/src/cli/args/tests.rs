//! The words are understood, and what has no meaning is refused.

use super::*;
use clap::Args;

/// A command line that consists of the words of one subcommand.
#[derive(Debug, Parser)]
struct Only<A: Args> {
    #[command(flatten)]
    args: A,
}

fn parse<A: Args>(words: &str) -> Result<A, clap::Error> {
    Only::<A>::try_parse_from(["jerboa"].into_iter().chain(words.split_whitespace())).map(|only| only.args)
}

#[test]
fn clap_finds_no_fault_in_the_declarations() {
    use clap::CommandFactory;
    Cli::command().debug_assert();
    Only::<RenderArgs>::command().debug_assert();
    Only::<DumpArgs>::command().debug_assert();
    Only::<TimeArgs>::command().debug_assert();
    Only::<ExplainArgs>::command().debug_assert();
    Only::<TraceArgs>::command().debug_assert();
    Only::<StabilityArgs>::command().debug_assert();
    Only::<EditsArgs>::command().debug_assert();
    Only::<Table2Args>::command().debug_assert();
    Only::<Figure2Args>::command().debug_assert();
    Only::<Figure5Args>::command().debug_assert();
    Only::<RaysArgs>::command().debug_assert();
    Only::<BenchDevicesArgs>::command().debug_assert();
}

#[test]
fn render_alone_renders_the_default_scene() {
    let args: RenderArgs = parse("").unwrap();
    assert_eq!((args.scene.as_str(), args.output, args.spp), (DEFAULT_SCENE, "out.png".into(), 64));
    assert_eq!((args.known, args.shown.tracer), (KnownArg::Structure, TracerArg::Path));
    assert_eq!((args.rr_depth, args.rr_cap, args.max_depth), (3, 1.0, None));
    assert_eq!((args.shading_normals, args.sampling.sampler), (ShadingNormalsArg::Consistent, SamplerArg::Sobol));
}

#[test]
fn every_word_of_render_is_understood() {
    let args: RenderArgs = parse(
        "a.glb -o b.exr --spp 16 --width 40 --height 30 --max-depth 16 --seed 7 --sampler sobol --scrambles 4 --known all --device cpu \
         --tracer depth --camera Main --shading-normals free --env sky.hdr --env-rotation -90 --env-strength 2 \
         --scene 1 --variant night --time -0.5 --animation walk --aperture 0.5 --focus 3 --rr-depth 5 --rr-cap 0.95 --crop 1,2,3,4 --exposure -1.5 --threads 2 --time-limit 10 --json",
    )
    .unwrap();
    assert_eq!((args.scene.as_str(), args.output), ("a.glb", "b.exr".into()));
    assert_eq!((args.spp, args.width, args.height, args.max_depth), (16, Some(40), Some(30), Some(16)));
    assert_eq!((args.seed, args.known, args.shown.tracer), (7, KnownArg::All, TracerArg::Depth));
    assert_eq!((args.env_rotation, args.env_strength, args.exposure), (Some(-90.0), Some(2.0), -1.5));
    assert_eq!((args.crop, args.threads, args.time_limit), (Some(CropArg([1, 2, 3, 4])), Some(2), Some(10.0)));
    assert_eq!((args.aperture, args.focus), (Some(0.5), Some(3.0)));
    let select = args.select;
    assert_eq!((select.scene_of_file.as_deref(), select.variant.as_deref()), (Some("1"), Some("night")));
    assert_eq!((select.time, select.animation.as_deref()), (Some(-0.5), Some("walk")));
    assert!(
        args.json
            && (args.sampling.sampler, args.sampling.scrambles) == (SamplerArg::Sobol, Some(4))
            && args.camera.as_deref() == Some("Main")
    );
}

#[test]
fn the_other_subcommands_parse() {
    let dump: DumpArgs = parse("a.glb --stage residual --kernel shade --known nothing").unwrap();
    assert_eq!((dump.stage, dump.known), (StageArg::Residual, KnownArg::Nothing));
    assert!(parse::<TimeArgs>("a.glb --json").unwrap().json);
    assert_eq!(parse::<ExplainArgs>("a.glb --scene 1").unwrap().select.scene_of_file.as_deref(), Some("1"));
    assert_eq!(parse::<ExplainArgs>("a.glb --kernel shade").unwrap().kernel.as_deref(), Some("shade"));
    let trace: TraceArgs = parse("a.glb --pixel 120,80 --sample 3 --seed 7").unwrap();
    assert_eq!((trace.pixel, trace.sample, trace.seed), (PixelArg([120, 80]), 3, 7));
    let compare: CompareArgs = parse("a.exr b.exr ref.exr --ref-variance v.exr --diff d.png").unwrap();
    assert_eq!(compare.images.len(), 3);
    let bench: StabilityArgs = parse("--scene huge tiny --scene empty --spp 8 -o sheet.png").unwrap();
    assert_eq!((bench.scene.len(), bench.spp, bench.output), (3, 8, Some("sheet.png".into())));
}

#[test]
fn values_without_a_meaning_are_refused() {
    for words in [
        "--spp 0",
        "--width 0",
        "--crop 1,2,3",
        "--crop 1,2,0,4",
        "--rr-cap 0",
        "--rr-cap 1.1",
        "--env-strength -1",
        "--exposure nan",
        "--time-limit 0",
        "--known some",
        "--threads 0",
        "--rr-depth 0",
        "--scrambles 0",
        "--scrambles 6",
        "--max-depth 0",
        "--time inf",
        "--animation walk",
    ] {
        assert!(parse::<RenderArgs>(words).is_err(), "{words}");
    }
    assert!(parse::<TraceArgs>("a.glb --pixel 1 --sample 0").is_err());
    assert!(parse::<CompareArgs>("ref.exr").is_err());
    assert!(parse::<Table2Args>("a.glb --peer python3 --time 1").is_err(), "the peer shows a file as it is");
}
