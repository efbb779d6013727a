//! The machine that the code is for: this one.

use std::sync::Arc;

use cranelift_codegen::isa::{self, TargetIsa};
use cranelift_codegen::settings::{self, Configurable};

use crate::Error;
use crate::lanes::Width;
use crate::simd::Simd;

/// How much work Cranelift puts into its code.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Opt {
    /// None: the residual is clean already, and Cranelift's own passes would cost compile time for nothing.
    #[default]
    None,
    /// Cranelift's e-graph: common subexpressions, strength reduction, hoisting of constants.
    Speed,
}

/// Settings of [`crate::compile`].
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Options {
    /// How much Cranelift optimises.
    pub opt: Opt,
    /// Check the CLIF before code is made of it; about doubles the time of code generation.
    pub verify: bool,
    /// Whether the iterations of a `vectorize` run in lanes, and how many at once; if not, one after the other.
    pub lanes: Option<Width>,
    /// Keep the CLIF and the disassembly of each kernel for [`crate::Code::clif`] and [`crate::Code::asm`].
    pub dumps: bool,
}

impl Default for Options {
    /// No optimisation, no dumps; lanes as the program says; verified in debug builds.
    fn default() -> Options {
        Options { opt: Opt::None, verify: cfg!(debug_assertions), lanes: Some(Width::Hint), dumps: false }
    }
}

/// The instruction set and what of it we rely on.
#[derive(Clone)]
pub(crate) struct Target {
    pub isa: Arc<dyn TargetIsa>,
    pub simd: Simd,
}

impl Target {
    /// This machine.
    pub fn host(options: &Options) -> Result<Target, Error> {
        let native = cranelift_native::builder().map_err(|e| Error::Host(e.to_string()))?;
        Target::new(native, options)
    }

    fn new(machine: isa::Builder, options: &Options) -> Result<Target, Error> {
        let fault = |e: &dyn std::fmt::Display| Error::Host(e.to_string());
        let mut flags = settings::builder();
        let opt_level = match options.opt {
            Opt::None => "none",
            Opt::Speed => "speed",
        };
        let verify = if options.verify { "true" } else { "false" };
        let wanted = [
            ("opt_level", opt_level),
            ("enable_verifier", verify),
            // The linker of `cranelift-jit` wants these two so.
            ("is_pic", "false"),
            ("use_colocated_libcalls", "false"),
            // Cranelift's tail calls need frame pointers; profilers like them too.
            ("preserve_frame_pointers", "true"),
        ];
        for (name, value) in wanted {
            flags.set(name, value).map_err(|e| fault(&e))?;
        }
        let isa = machine.finish(settings::Flags::new(flags)).map_err(|e| fault(&e))?;
        let feature = |name: &str| isa.isa_flags().iter().find(|f| f.name == name).and_then(|f| f.as_bool());
        // Rounding to integers and the choice by a mask are one instruction from SSE4.1 on; other machines that we know
        // have them always.
        if feature("has_sse41") == Some(false) {
            return Err(Error::Host("the processor has no SSE4.1 (x86 processors have it since 2008)".to_owned()));
        }
        // Without AVX Cranelift has no fused multiply-add, whatever the processor has.
        let fma = feature("has_fma") != Some(false) && feature("has_avx") != Some(false);
        let simd = Simd { x86: feature("has_sse41").is_some(), fma };
        Ok(Target { isa, simd })
    }

    /// The least machine that will do of this machine's kind.
    #[cfg(test)]
    pub fn least(options: &Options) -> Target {
        let host = cranelift_native::builder().expect("this machine is known").triple().to_string();
        let mut machine = isa::lookup_by_name(&host).expect("Cranelift makes code for this machine");
        if cfg!(target_arch = "x86_64") {
            for feature in ["has_sse3", "has_ssse3", "has_sse41"] {
                machine.enable(feature).expect("it is a feature");
            }
        }
        Target::new(machine, options).expect("it will do")
    }
}

/// What [`Simd::fma`] falls back to; rounds once, as the operation says.
pub(crate) extern "C" fn fused_multiply_add(a: f32, b: f32, c: f32) -> f32 {
    a.mul_add(b, c)
}
