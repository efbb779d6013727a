//! SPIR-V of a validated module, in a form that means what the program says bit for bit.
//!
//! naga writes SPIR-V for shading languages, where a driver may contract `a·b + c` and reorder sums. Two edits of its words
//! make that exact (facts of Mesa's lavapipe 22.3; without them 6,246 words of a 512 × 512 image differed from the CPU's, with
//! them none):
//!
//! - every operation on floats, comparisons among them, is decorated `NoContraction`;
//! - local variables lose their initialisers. naga fills each with zeros; for an array of 256 words that alone took lavapipe
//!   0.7 s. What this crate emits stores to a variable before it loads from it, and clears arrays where the program says so.
//!
//! Bounds, divisions and loops get no checks from naga: the emitter has written those that the program means.

use naga::back::spv::{self, WriterFlags, ZeroInitializeWorkgroupMemoryMode};
use naga::proc::{BoundsCheckPolicies, BoundsCheckPolicy};
use naga::valid::ModuleInfo;
use rspirv::binary::Disassemble;
use rspirv::spirv::{Decoration, Op, StorageClass};

/// Words before the first instruction.
const HEADER: usize = 5;

/// The words of a module.
pub(crate) fn write(module: &naga::Module, info: &ModuleInfo) -> Result<Vec<u32>, spv::Error> {
    let unchecked = BoundsCheckPolicy::Unchecked;
    let options = spv::Options {
        lang_version: (1, 3),
        flags: WriterFlags::empty(),
        bounds_check_policies: BoundsCheckPolicies {
            index: unchecked,
            buffer: unchecked,
            image_load: unchecked,
            binding_array: unchecked,
        },
        zero_initialize_workgroup_memory: ZeroInitializeWorkgroupMemoryMode::None,
        force_loop_bounding: false,
        emit_int_div_checks: false,
        ..spv::Options::default()
    };
    let words = spv::write_vec(module, info, &options, None)?;
    Ok(exact(&words))
}

/// SPIR-V as text.
pub(crate) fn assembly(words: &[u32]) -> String {
    match rspirv::dr::load_words(words) {
        Ok(module) => module.disassemble() + "\n",
        Err(e) => format!("; not readable: {e}\n"),
    }
}

/// The same module without initialisers of local variables, and with all float operations decorated.
fn exact(words: &[u32]) -> Vec<u32> {
    let mut decorations = Vec::new();
    let mut body = Vec::with_capacity(words.len());
    // Types, constants and variables follow the decorations; one of them is there.
    let mut declarations = None;
    for (op, words) in instructions(words) {
        if is_float(op) {
            decorations.extend([Op::Decorate as u32 | 3 << 16, words[2], Decoration::NoContraction as u32]);
        }
        if declarations.is_none() && is_declaration(op) {
            declarations = Some(HEADER + body.len());
        }
        match op {
            Some(Op::Variable) if words[3] == StorageClass::Function as u32 => {
                body.extend([Op::Variable as u32 | 4 << 16, words[1], words[2], words[3]]);
            }
            _ => body.extend(words),
        }
    }
    let mut exact = words[..HEADER].to_vec();
    exact.append(&mut body);
    let at = declarations.unwrap_or(exact.len());
    exact.splice(at..at, decorations);
    exact
}

/// Instructions with their words.
fn instructions(words: &[u32]) -> impl Iterator<Item = (Option<Op>, &[u32])> {
    let mut rest = &words[HEADER..];
    std::iter::from_fn(move || {
        let head = rest.first()?;
        let (instruction, others) = rest.split_at(((head >> 16) as usize).clamp(1, rest.len()));
        rest = others;
        Some((Op::from_u32(head & 0xffff), instruction))
    })
}

/// Does it compute with floats?
fn is_float(op: Option<Op>) -> bool {
    use Op::*;
    matches!(
        op,
        Some(
            FAdd | FSub
                | FMul
                | FDiv
                | FRem
                | FMod
                | FNegate
                | FOrdEqual
                | FUnordEqual
                | FOrdNotEqual
                | FUnordNotEqual
                | FOrdLessThan
                | FUnordLessThan
                | FOrdGreaterThan
                | FUnordGreaterThan
                | FOrdLessThanEqual
                | FUnordLessThanEqual
                | FOrdGreaterThanEqual
                | FUnordGreaterThanEqual
        )
    )
}

/// Does it belong to the types, constants and variables of a module?
fn is_declaration(op: Option<Op>) -> bool {
    let Some(op) = op else { return false };
    let is_type = (Op::TypeVoid..=Op::TypeForwardPointer).contains(&op);
    let is_constant = (Op::ConstantTrue..=Op::SpecConstantOp).contains(&op);
    is_type || is_constant || op == Op::Variable
}
