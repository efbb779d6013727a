//! Functions and exits of the program.

use std::marker::PhantomData;
use std::sync::Arc;

use crate::lang::block::{Block, Ends, Left};
use crate::lang::staged::{Staged, leaf, next};
use crate::lang::value::Bool;
use crate::lang::{here, with};
use crate::program::{Body, ContId, Loc, Mode, NodeId, Param, Role};
use crate::ty::Ty;

/// A function of the program from `A` to `R`; `Fun<A, Never>` never returns.
///
/// Made by [`Fun::lam`] (always unfolded), [`Fun::rec`] (its own filter, may call itself) or [`Fun::named`] (stays a
/// call). The body runs once, when the function is made.
pub struct Fun<A, R>(NodeId, PhantomData<fn(A) -> R>);

/// The result of a function that does not return: it leaves through exits.
#[derive(Clone, Copy)]
pub struct Never;

/// A way out: a continuation that takes a `T` and does not come back. A value like any other.
pub type Exit<T> = Fun<T, Never>;

impl<A, R> Clone for Fun<A, R> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<A, R> Copy for Fun<A, R> {}

/// What a function returns: a staged value, or [`Never`].
pub trait Returns {
    /// The return continuation's type, if there is one.
    fn return_ty() -> Option<Ty>;
}

impl<R: Staged> Returns for R {
    fn return_ty() -> Option<Ty> {
        Some(Ty::func(&R::types()))
    }
}

impl Returns for Never {
    fn return_ty() -> Option<Ty> {
        None
    }
}

impl<A: Staged, R: Returns> Staged for Fun<A, R> {
    fn params(name: &str, out: &mut Vec<Param>) {
        let mut types = A::types();
        types.extend(R::return_ty());
        leaf(name, Ty::func(&types), out);
    }
    fn flatten(&self, out: &mut Vec<NodeId>) {
        out.push(self.0);
    }
    fn unflatten(nodes: &mut dyn Iterator<Item = NodeId>) -> Self {
        Fun(next(nodes), PhantomData)
    }
}

impl<A: Staged, R: Returns> Fun<A, R> {
    /// The function of this program by this name, made where it is first asked for: one, however many places call it. It must not
    /// depend on what is around any of them, and each name has one type.
    ///
    /// ```
    /// use jerboa_ir::lang::{Fun, I32, build, entry};
    ///
    /// let square = || Fun::<I32, I32>::shared("square", || Fun::lam(|_, x| x * x));
    /// let program = build(|| {
    ///     let fourth = Fun::<I32, I32>::lam(|b, x| {
    ///         let y = square().call(b, x);
    ///         square().call(b, y)
    ///     });
    ///     entry("fourth", fourth);
    /// });
    /// assert_eq!(jerboa_ir::print(&program).matches("\nfun ").count(), 2, "`fourth`, and one `square`");
    /// ```
    pub fn shared(name: &'static str, make: impl FnOnce() -> Self) -> Self {
        if let Some(made) = with(|w| w.shared(name)) {
            return Fun(made, PhantomData);
        }
        let made = make();
        with(|w| w.share(name, made.0));
        made
    }
}

/// The filter of a function that is always unfolded: `@`.
pub fn always() -> Bool {
    true.into()
}

/// The filter of a function that stays a call.
pub fn never() -> Bool {
    false.into()
}

/// Does the evaluator know this value? For filters; it never changes a result.
#[track_caller]
pub fn known<T: Staged>(x: T) -> Bool {
    let loc = here();
    let each = x.nodes().into_iter().map(|n| Bool(with(|w| w.known(n, loc))));
    each.reduce(|a, b| a & b).unwrap_or_else(always)
}

/// Declare an entry: a kernel of this name.
pub fn entry<A: Staged, R: Staged>(name: &str, f: Fun<A, R>) {
    with(|w| match *w.program().node(f.0) {
        crate::program::Node::Cont(cont) => w.entry(name, cont),
        _ => panic!("entry `{name}` must be a function made here, not a parameter"),
    });
}

/// A function's continuation before its body is written.
struct Header<A> {
    cont: ContId,
    args: A,
    ret: Option<NodeId>,
}

fn header<A: Staged, R: Returns>(name: &str, loc: Loc) -> Header<A> {
    let mut params = A::all_params("");
    if let Some(ty) = R::return_ty() {
        params.push(Param { ty, name: Some(Arc::from("return")), keep: false });
    }
    with(|w| {
        let cont = w.cont(name, Role::Fun, params, loc);
        let mut nodes = w.params(cont);
        let ret = R::return_ty().and_then(|_| nodes.pop());
        Header { cont, args: A::unflatten(&mut nodes.into_iter()), ret }
    })
}

impl<A: Staged, R: Staged> Fun<A, R> {
    /// An anonymous function that is always unfolded: `@|a| …`.
    #[track_caller]
    pub fn lam<E: Ends<R>>(body: impl FnOnce(&mut Block, A) -> E) -> Self {
        Self::make("lam", |_| always(), |b, _, a| body(b, a), here())
    }

    /// A function that stays a call.
    #[track_caller]
    pub fn named<E: Ends<R>>(name: &str, body: impl FnOnce(&mut Block, A) -> E) -> Self {
        Self::make(name, |_| never(), |b, _, a| body(b, a), here())
    }

    /// A function with a filter over its arguments, which may call itself: `fn @(filter) name(a) …`.
    #[track_caller]
    pub fn rec<E: Ends<R>>(
        name: &str,
        filter: impl FnOnce(A) -> Bool,
        body: impl FnOnce(&mut Block, Self, A) -> E,
    ) -> Self {
        Self::make(name, filter, body, here())
    }

    fn make<E: Ends<R>>(
        name: &str,
        filter: impl FnOnce(A) -> Bool,
        body: impl FnOnce(&mut Block, Self, A) -> E,
        loc: Loc,
    ) -> Self {
        let Header { cont, args, ret } = header::<A, R>(name, loc);
        let this = Fun(with(|w| w.cont_value(cont)), PhantomData);
        let filter = filter(args).0;
        with(|w| w.cont_mut(cont).filter = filter);
        let mut b = Block::new(cont);
        let end = body(&mut b, this, args);
        end.end(b, ret.expect("a function that returns has a return"), None, loc);
        this
    }

    /// Call it; its filter decides whether it is unfolded.
    #[track_caller]
    pub fn call(self, b: &mut Block, args: A) -> R {
        self.call_as(b, args, Mode::Filter, here())
    }

    /// Call it and unfold it, whatever its filter says.
    #[track_caller]
    pub fn call_now(self, b: &mut Block, args: A) -> R {
        self.call_as(b, args, Mode::Now, here())
    }

    /// Call it and leave the call, whatever its filter says.
    #[track_caller]
    pub fn call_later(self, b: &mut Block, args: A) -> R {
        self.call_as(b, args, Mode::Later, here())
    }

    fn call_as(self, b: &mut Block, args: A, mode: Mode, loc: Loc) -> R {
        let (rest, result) = Block::continuation::<R>("rest", Role::Rest, always(), loc);
        let mut nodes = args.nodes();
        nodes.push(with(|w| w.cont_value(rest)));
        b.leave(Body::Jump { callee: self.0, args: nodes, mode }, loc);
        *b = Block::new(rest);
        result
    }
}

impl<A: Staged> Fun<A, Never> {
    /// A function that does not return. Its body leaves through exits.
    #[track_caller]
    pub fn exits(body: impl FnOnce(&mut Block, A) -> Left) -> Self {
        let loc = here();
        let Header { cont, args, .. } = header::<A, Never>("exits", loc);
        body(&mut Block::new(cont), args);
        Fun(with(|w| w.cont_value(cont)), PhantomData)
    }

    /// Go there. The block is closed; nothing may follow on this path.
    #[track_caller]
    pub fn take(self, b: &mut Block, value: A) -> Left {
        let loc = here();
        b.leave(Body::Jump { callee: self.0, args: value.nodes(), mode: Mode::Filter }, loc);
        Left::new()
    }

    /// The exit to a continuation of these parameters.
    pub(crate) fn to(cont: ContId) -> Self {
        Fun(with(|w| w.cont_value(cont)), PhantomData)
    }
}
