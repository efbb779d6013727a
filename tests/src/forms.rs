//! Every form of every operation: which types it takes.

use jerboa_ir::op::Rule;
use jerboa_ir::{Op, Scalar, Ty};

/// An operation at given types.
#[derive(Clone, Debug)]
pub struct Form {
    /// The operation.
    pub op: Op,
    /// Types of its operands.
    pub args: Vec<Ty>,
    /// Type of its result.
    pub result: Ty,
}

/// All forms over scalars (one lane) or over vectors of so many lanes.
pub fn forms(lanes: usize) -> Vec<Form> {
    let ty = |s: Scalar| if lanes == 1 { Ty::scalar(s) } else { Ty::vector(s, lanes) };
    let mut forms = Vec::new();
    for op in Op::ALL.iter().copied() {
        for scalar in op.scalars().iter().copied() {
            let args = match op.rule() {
                Rule::Select => vec![ty(Scalar::Bool), ty(scalar), ty(scalar)],
                Rule::Shift => vec![ty(scalar), ty(Scalar::U32)],
                Rule::Lanes(_) if lanes == 1 => continue,
                _ => vec![ty(scalar); op.arity()],
            };
            let result = op.result(&args).expect("a form fits its rule");
            forms.push(Form { op, args, result });
        }
    }
    forms
}
