//! A kernel as structured text.
use jerboa_ir::Program;
use jerboa_ir::cfg::Cfg;
use jerboa_ir::schedule::Schedule;
use jerboa_ir::structure::Step;

/// The functions of a kernel.
pub(crate) fn structured(_p: &Program, _cfg: &Cfg, _schedules: &[Schedule], trees: &[Vec<Step>]) -> String {
    format!("{trees:#?}\n")
}
