//! The values that words take, and how their text is read.

use clap::ValueEnum;

/// What a specialization knows about the scene (it never changes the image).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum KnownArg {
    /// Nothing: a generic renderer that dispatches at run time
    Nothing,
    /// Kinds, flags and counts: changing a number needs no compilation
    #[default]
    Structure,
    /// Numbers too: every value becomes a literal
    All,
}

/// Where kernels run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum DeviceArg {
    /// `gpu-wavefront` where there is a GPU, `cpu` otherwise
    #[default]
    Auto,
    /// All cores: streams of paths, sorted by shader
    Cpu,
    /// All cores, one path after the other
    CpuScalar,
    /// A GPU, or a driver that stands in for one: all samples of a pixel in one kernel
    GpuMegakernel,
    /// A GPU likewise: streams of paths, sorted by shader
    GpuWavefront,
}

/// Who finds what rays hit on the device `cpu` (it never changes the image).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum TraversalArg {
    /// By hand, eight boxes at once, where the processor has AVX-512 and the scene no cut-outs
    #[default]
    Native,
    /// The renderer's own kernel, four boxes at once
    Ir,
}

/// How random numbers are drawn (the image is the same on average).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum SamplerArg {
    /// Each by itself
    Independent,
    /// Sobol points with Owen's scrambling: the samples of a pixel fill the space of their numbers evenly
    #[default]
    Sobol,
}

/// What Russian roulette ends paths by (the image is the same on average).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum RouletteArg {
    /// By what of the light that is found would still arrive
    Throughput,
    /// By the light that there is still to be found, as the first 16 samples of each pixel tell; other tracers than `path` by
    /// throughput
    #[default]
    Learned,
}

/// How shading normals may differ from the surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum ShadingNormalsArg {
    /// A closed mesh never leaks light
    #[default]
    Consistent,
    /// As the reference images have it
    Free,
}

/// What `jerboa dump` shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum StageArg {
    /// The renderer before it has seen the scene
    Generic,
    /// What is left of it for this scene
    Residual,
    /// The same, with loops over lanes for what is vectorised
    Lanes,
    /// What Cranelift compiles
    Clif,
    /// The machine code
    Asm,
    /// The control flow of a kernel for GPUs
    Structured,
    /// What naga is given, as WGSL
    Naga,
    /// What a driver is given
    Spirv,
}

/// A pixel: column and row, from the top left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PixelArg(pub [u32; 2]);

impl std::str::FromStr for PixelArg {
    type Err = String;

    fn from_str(text: &str) -> Result<PixelArg, String> {
        numbers(text).map(PixelArg).ok_or_else(|| "expected X,Y, as in 120,80".into())
    }
}

/// A rectangle of pixels: left column, top row, width and height, both at least 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CropArg(pub [u32; 4]);

impl std::str::FromStr for CropArg {
    type Err = String;

    fn from_str(text: &str) -> Result<CropArg, String> {
        let crop = numbers(text).filter(|[_, _, width, height]| *width > 0 && *height > 0);
        crop.map(CropArg).ok_or_else(|| "expected X,Y,W,H with W and H at least 1, as in 0,0,64,64".into())
    }
}

/// `N` whole numbers separated by commas.
pub(in crate::cli) fn numbers<const N: usize>(text: &str) -> Option<[u32; N]> {
    let numbers = text.split(',').map(|n| n.trim().parse().ok()).collect::<Option<Vec<u32>>>()?;
    numbers.try_into().ok()
}

/// `text` as a finite number.
pub(in crate::cli) fn finite(text: &str) -> Result<f32, String> {
    text.parse().ok().filter(|x: &f32| x.is_finite()).ok_or_else(|| "expected a finite number".into())
}

/// `text` as a finite number that is not negative.
pub(in crate::cli) fn finite_not_negative(text: &str) -> Result<f32, String> {
    finite(text).ok().filter(|x| *x >= 0.0).ok_or_else(|| "expected a finite number, 0 or more".into())
}

/// `text` as a finite number above 0.
pub(in crate::cli) fn positive(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|x: &f64| x.is_finite() && *x > 0.0)
        .ok_or_else(|| "expected a finite number above 0".into())
}

/// `text` as a probability above 0: a cap of 0 would end every path.
pub(in crate::cli) fn probability(text: &str) -> Result<f32, String> {
    finite(text).ok().filter(|x| *x > 0.0 && *x <= 1.0).ok_or_else(|| "expected a number above 0, at most 1".into())
}

/// `text` as a power of two.
pub(in crate::cli) fn power_of_two(text: &str) -> Result<u32, String> {
    text.parse()
        .ok()
        .filter(|n: &u32| n.is_power_of_two())
        .ok_or_else(|| "expected a power of two: 1, 2, 4, 8, …".into())
}

/// `text` as a moment in seconds.
pub(in crate::cli) fn moment(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|x: &f64| x.is_finite()).ok_or_else(|| "expected a finite number of seconds".into())
}

/// `text` as a time in seconds above 0.
pub(in crate::cli) fn seconds(text: &str) -> Result<f32, String> {
    finite(text).ok().filter(|x| *x > 0.0).ok_or_else(|| "expected a number of seconds above 0".into())
}
