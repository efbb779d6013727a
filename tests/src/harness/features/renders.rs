//! Features of renders: what one may ask for, whatever its scene.

use jerboa_lib_render::host::device::DeviceKind;
use jerboa_lib_render::host::generate::TracerKind;
use jerboa_lib_render::host::tables::{CameraKind, SamplerKind};
use jerboa_scenes::LightKind;

use super::Feature;
use super::used::*;
use crate::harness::subjects::Subject;

/// The table.
pub const TABLE: &[Feature] = &[
    // ---- cameras
    Feature {
        name: "pinholes",
        used: |s| s.camera() == CameraKind::Pinhole,
        facts: &["Settings.CAMERA"],
        leaves: &["camera/pinhole.rs"],
    },
    Feature {
        name: "thin lenses",
        used: |s| s.camera() == CameraKind::Thin,
        facts: &["Settings.CAMERA"],
        leaves: &["Frame.LENS_", "Frame.FOCUS", "camera/thin_lens.rs"],
    },
    Feature {
        name: "orthographic cameras",
        used: |s| s.camera() == CameraKind::Orthographic,
        facts: &["Settings.CAMERA"],
        leaves: &["camera/orthographic.rs"],
    },
    Feature {
        name: "fisheyes",
        used: |s| s.camera() == CameraKind::Fisheye,
        facts: &["Settings.CAMERA"],
        leaves: &["camera/fisheye.rs"],
    },
    // ---- samplers
    Feature {
        name: "independent numbers",
        used: |s| s.choices.sampler == SamplerKind::Independent,
        facts: &["Sampling.IS_SOBOL"],
        leaves: &["sampler/independent.rs"],
    },
    Feature {
        name: "Sobol points",
        used: |s| s.choices.sampler != SamplerKind::Independent,
        facts: &["Sampling.IS_SOBOL", "Sampling.LOG_SCRAMBLES"],
        leaves: &["sampler/sobol.rs", "core/sobol.rs"],
    },
    // ---- choices
    Feature {
        name: "a limit of depth",
        used: |s| s.choices.max_depth.is_some(),
        facts: &["Settings.DEPTH_LIMITED"],
        leaves: &["Settings.MAX_DEPTH"],
    },
    Feature {
        name: "roulette",
        used: |s| s.choices.rr_depth.is_some() && s.shows_light(),
        facts: &["Settings.ROULETTE"],
        leaves: &["Settings.RR_DEPTH", "Settings.RR_CAP", "tracer/roulette.rs"],
    },
    Feature {
        name: "roulette by what was learned",
        used: |s| s.choices.learned_roulette,
        facts: &["Settings.LEARNS"],
        leaves: &["LearnedGrid.", "LearnedLight.", "LearnedPixels.", "tracer/learned.rs"],
    },
    Feature {
        name: "an offset of rays",
        used: |s| s.choices.ray_offset > 0.0,
        facts: &["Settings.HAS_RAY_OFFSET"],
        leaves: &["Settings.RAY_OFFSET"],
    },
    Feature {
        name: "normals bent for reflections",
        used: |s| s.choices.consistent_normals && has_facets(s),
        facts: &["Settings.CONSISTENT_NORMALS"],
        leaves: &["bsdf/bent.rs"],
    },
    Feature {
        name: "lamps by solid angle, and lights that are seen without a surface",
        used: |s| s.choices.solid_angle || has_seen_lights(s),
        facts: &["Settings.BY_SOLID_ANGLE"],
        leaves: &["core/spherical.rs"],
    },
    // ---- tracers
    Feature {
        name: "light that surfaces have scattered",
        used: Subject::shows_light,
        facts: &[],
        leaves: &[
            "Lights.",
            "Environment.",
            "EnvironmentTexels.",
            "Materials.EMISSION_",
            "Materials.ROUGHNESS",
            "Parameters.",
            "tracer/path.rs",
        ],
    },
    Feature {
        name: "the path tracer's weights",
        used: |s| is_lit(&s.scene) && s.tracer == TracerKind::Path,
        facts: &[],
        leaves: &["mis.rs"],
    },
    Feature {
        name: "paths from lights",
        used: |s| s.tracer.is_splatting(),
        facts: &[],
        leaves: &["tracer/light.rs", "tracer/lens.rs", "tracer/adjoint.rs"],
    },
    Feature {
        name: "two paths that meet",
        used: |s| s.tracer == TracerKind::Bidirectional,
        facts: &[],
        leaves: &["LightVertices.", "tracer/bidirectional.rs", "device/both.rs"],
    },
    Feature {
        name: "paths from infinitely far away, disks before ceilings",
        used: |s| s.tracer.is_splatting() || has_light(s, |kind| matches!(kind, LightKind::Disk { .. })),
        facts: &[],
        leaves: &["Lights.SCENE_RADIUS"],
    },
    Feature {
        name: "ambient occlusion",
        used: |s| s.tracer == TracerKind::Occlusion,
        facts: &[],
        leaves: &["Settings.OCCLUSION_DISTANCE", "tracer/occlusion.rs"],
    },
    Feature {
        name: "layers of an image",
        used: |s| matches!(s.tracer, TracerKind::AovNormal | TracerKind::AovPlace),
        facts: &[],
        leaves: &["tracer/aov.rs"],
    },
    Feature {
        name: "normals as colours",
        used: |s| s.tracer == TracerKind::Normals,
        facts: &[],
        leaves: &["tracer/debug.rs"],
    },
    // ---- devices
    Feature {
        name: "streams of paths",
        used: |s| matches!(s.device, DeviceKind::Cpu | DeviceKind::GpuWavefront),
        facts: &[],
        leaves: &["Next.", "Hits.", "Order.", "Shadows."],
    },
    Feature {
        name: "paths that wait",
        used: |s| s.device != DeviceKind::CpuScalar,
        facts: &[],
        leaves: &["Paths.", "device/stream.rs"],
    },
    Feature {
        name: "samples in the order of pixels",
        used: |s| s.device != DeviceKind::Cpu,
        facts: &[],
        leaves: &["Samples."],
    },
    Feature {
        name: "sums that kernels add to",
        used: |s| s.device.is_gpu() || s.tracer.is_splatting(),
        facts: &[],
        leaves: &["Pixels.", "core/exact.rs", "device/pixel.rs"],
    },
    Feature {
        name: "counts of paths by the device",
        used: |s| s.device == DeviceKind::GpuWavefront,
        facts: &[],
        leaves: &["Ranges.", "Counts."],
    },
    Feature {
        name: "one kernel on a GPU",
        used: |s| s.device == DeviceKind::GpuMegakernel,
        facts: &[],
        leaves: &["device/megakernel.rs"],
    },
    Feature { name: "GPUs", used: |s| s.device.is_gpu(), facts: &[], leaves: &["device/wavefront.rs"] },
];
