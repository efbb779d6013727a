//! Mistakes of a compiler: in the language, the partial evaluator and the back end.

use super::Mutation;

pub(super) const MUTATIONS: &[Mutation] = &[
    // ---- ir
    Mutation {
        name: "fast-math",
        file: "ir/src/fold.rs",
        before: "is(i, Lit::I32(0)) || is(i, Lit::U32(0))",
        after: "is(i, Lit::I32(0)) || is(i, Lit::U32(0)) || is(i, Lit::f32(0.0))",
        mistake: "x * 0 folds to 0 and x + 0 to x for floats: wrong for infinities, NaN and -0 (-ffast-math)",
    },
    Mutation {
        name: "min-swaps-operands",
        file: "ir/src/op.rs",
        before: "Op::Lt.eval(&[*a, *b]) == Bool(true)",
        after: "Op::Lt.eval(&[*b, *a]) != Bool(true)",
        mistake: "the other operand of `min` wins for NaN and for zeros, as it does on some engine (wgpu, Cranelift)",
    },
    Mutation {
        name: "owner-is-the-outer-one",
        file: "ir/src/scope.rs",
        before: "if self.level[x.index()] >= self.level[y.index()] { x } else { y }",
        after: "if self.level[x.index()] < self.level[y.index()] { x } else { y }",
        mistake: "a node that depends on two nested continuations is kept with the outer one: stale values in loops",
    },
    Mutation {
        name: "hoisted-past-its-operand",
        file: "ir/src/schedule.rs",
        before: "f.dom.dominates(top, above)",
        after: "true",
        mistake: "loop-invariant code motion does not ask whether the operands are defined outside of the loop",
    },
    Mutation {
        name: "verifier-ignores-surplus-arguments",
        file: "ir/src/verify/jumps.rs",
        before: "params.len() != args.len()",
        after: "params.len() > args.len()",
        mistake: "the verifier accepts a jump with more arguments than parameters",
    },
    // ---- peval
    Mutation {
        name: "memo-without-environment",
        file: "peval/src/call.rs",
        before: "vec![self.function.0, c.0, parent.0]",
        after: "vec![self.function.0, c.0]",
        mistake: "blocks are memoised by continuation and arguments alone, so two closures of one function share a block",
    },
    Mutation {
        name: "memo-without-positions",
        file: "peval/src/lift.rs",
        before: "lift.key.extend([0, at])",
        after: "lift.key.push(0)",
        mistake: "two functions that use the same unknown twice, and two unknowns, share one residual",
    },
    Mutation {
        name: "join-takes-the-first-class",
        file: "peval/src/facts.rs",
        before: "by_class.first().copied().filter(|first| by_class.iter().all(|x| x == first))",
        after: "by_class.first().copied()",
        mistake: "where classes meet, the first one's knowledge is taken for all",
    },
    Mutation {
        name: "join-takes-the-other-arm",
        file: "peval/src/tidy/select.rs",
        before: "draft.world.prim(Op::Select, &[cond, *a, *b], loc)",
        after: "draft.world.prim(Op::Select, &[cond, *b, *a], loc)",
        mistake: "the arguments of a join come from the other arm",
    },
    Mutation {
        name: "stores-compared-without-column",
        file: "peval/src/tidy/equal.rs",
        before: "hash_of((3, mem(m)))",
        after: "hash_of(3)",
        mistake: "two arms that store the same to different columns are merged: an effect goes elsewhere",
    },
    Mutation {
        name: "any-recursion-is-a-loop",
        file: "peval/src/tidy/tail.rs",
        before: "args[returns] == own_return",
        after: "true",
        mistake: "a call of itself that does not return its result at once becomes a loop (Thorin #82, non-tail ilog2)",
    },
    Mutation {
        name: "budget-is-not-heeded",
        file: "peval/src/call.rs",
        before: "Ok((false, Reason::Budget))",
        after: "Ok((true, Reason::Budget))",
        mistake: "a used-up budget is logged and unfolding goes on (Thorin #79: diverges with all variants enabled)",
    },
    // ---- backend-cranelift
    Mutation {
        name: "machine-min-passes-nan-on",
        file: "backend-cranelift/src/ops.rs",
        before: "pick(b, Op::Lt, scalar, x, y)",
        after: "if float { b.ins().fmin(x, y) } else { pick(b, Op::Lt, scalar, x, y) }",
        mistake: "the machine's `fmin` for `min`: NaN spreads and zeros are ordered (Cranelift's fmin)",
    },
    Mutation {
        name: "saturates-as-signed",
        file: "backend-cranelift/src/ops.rs",
        before: "b.ins().fcvt_to_uint_sat(types::I32, x)",
        after: "b.ins().fcvt_to_sint_sat(types::I32, x)",
        mistake: "3e9 as u32 saturates at 2147483647 (lavapipe, wgpu #7387)",
    },
    Mutation {
        name: "shift-is-logical",
        file: "backend-cranelift/src/ops.rs",
        before: "b.ins().sshr(x, y)",
        after: "b.ins().ushr(x, y)",
        mistake: "a signed shift to the right fills with zeros",
    },
    Mutation {
        name: "lanes-off-by-one",
        file: "backend-cranelift/src/pack.rs",
        before: "(lane % LANES) as u8",
        after: "((lane + 1) % LANES) as u8",
        mistake: "the lane after the one that was asked for (Cranelift #3216, replace_lane)",
    },
    Mutation {
        name: "store-one-past-the-end",
        file: "backend-cranelift/src/function/access.rs",
        before: "IntCC::UnsignedLessThan",
        after: "IntCC::UnsignedLessThanOrEqual",
        mistake: "a store at index = length is made",
    },
    // ---- backend-cranelift, lanes
    Mutation {
        name: "remaining-lanes-off-by-one",
        file: "backend-cranelift/src/lanes/copy.rs",
        before: "w.w.prim(Op::Lt, &[iota, all], loc)",
        after: "w.w.prim(Op::Le, &[iota, all], loc)",
        mistake: "one lane too many in the last round of a `vectorize`",
    },
    Mutation {
        name: "other-arm-under-the-whole-mask",
        file: "backend-cranelift/src/lanes/choice.rs",
        before: "w.without(mask, cond)",
        after: "{ _ = w.without(mask, cond); mask }",
        mistake: "the lanes of the first arm go through the second one, too",
    },
    Mutation {
        name: "last-to-join-passes-for-all",
        file: "backend-cranelift/src/lanes/function.rs",
        before: "self.lanes.writer.select(mask, &value, &old)",
        after: "value.clone()",
        mistake: "where lanes meet, the value of the arm that came last stands for all",
    },
    Mutation {
        name: "value-of-the-last-round-passes-for-all",
        file: "backend-cranelift/src/lanes/function.rs",
        before: "self.lanes.writer.select(mask, &vector, &old)",
        after: "vector.clone()",
        mistake: "a lane that has left a loop sees what the loop computes for others",
    },
    // ---- back end for GPUs
    Mutation {
        name: "minimum-of-the-driver",
        file: "backend-spirv/src/ops.rs",
        before: "pick(c, B::Less, x, y)",
        after: "c.umin(x, y)",
        mistake: "`min` is the driver's, which gives the operand that is a number (naga, WGSL)",
    },
    Mutation {
        name: "drivers-may-contract",
        file: "backend-spirv/src/spirv.rs",
        before: "is_float(op)",
        after: "false",
        mistake: "no float operation is decorated, so drivers contract and cancel (naga)",
    },
    Mutation {
        name: "ones-are-literals",
        file: "backend-spirv/src/function/top.rs",
        before: "is_one(word)",
        after: "false",
        mistake: "a driver sees the bits of 1.0 beside those of -0.0 and takes them for 1 and 0 (Mesa)",
    },
    Mutation {
        name: "exit-stays-under-way",
        file: "backend-spirv/src/flow.rs",
        before: "pieces.extend([Piece::Reset, piece])",
        after: "pieces.extend([piece])",
        mistake: "an exit through some frames is still noted the next time that one of them ends",
    },
    // ---- peval, vectorize
    Mutation {
        name: "half-of-a-vectorize-is-none",
        file: "peval/src/tidy/forward.rs",
        before: "bound(lo).zip(bound(hi)).is_some_and(|(lo, hi)| lo >= hi)",
        after: "bound(lo).zip(bound(hi)).is_some_and(|(lo, hi)| lo + 1 >= hi)",
        mistake: "a `vectorize` over one index is dropped as one over none",
    },
];
