//! The loop whose iterations are independent.

use crate::lang::block::{Block, Ends};
use crate::lang::fun::always;
use crate::lang::value::U32;
use crate::lang::{here, with};
use crate::program::{Body, Param, Role};
use crate::ty::Ty;

impl Block {
    /// `for i in lo..hi { body(i) }` where iterations are independent, so that a back end may run `width` of them at once;
    /// the width (4, 8 or 16) is a hint. What the body captures is the same in all iterations, and it stays a function
    /// in the residual.
    ///
    /// An iteration stores to a column of a stream at `i`, or at `i` plus something that is the same in all iterations, and
    /// loads from such a column only there, within the rows of the stream. It has its own local arrays, and ends by coming to its end. There is no
    /// `vectorize` within.
    ///
    /// ```
    /// use jerboa_ir::lang::*;
    ///
    /// jerboa_ir::stream! {
    ///     /// Points of a curve.
    ///     Points {
    ///         /// Where.
    ///         X: F32;
    ///         /// How high.
    ///         Y: F32;
    ///     }
    /// }
    /// let program = build(|| {
    ///     declare(&[spec::<Points>()]);
    ///     entry("scale", Fun::<(F32, U32), ()>::lam(|b, (a, n)| {
    ///         b.vectorize(8, 0, n, |b, i| {
    ///             let x = b.load::<Points, F32>(Points::X, i);
    ///             b.store(Points::Y, i, a * x);
    ///         });
    ///     }));
    /// });
    /// assert_eq!(jerboa_ir::verify(&program), []);
    /// ```
    ///
    /// # Panics
    /// When the width is another number. What the rules above forbid is a fault that the verifier finds, of exits and
    /// arrays in the program as it is written, of streams in the residual; of rows the interpreter finds it.
    #[track_caller]
    pub fn vectorize(&mut self, width: u8, lo: impl Into<U32>, hi: impl Into<U32>, body: impl FnOnce(&mut Block, U32)) {
        let (lo, hi, loc) = (lo.into().node(), hi.into().node(), here());
        assert!([4, 8, 16].contains(&width), "{loc}: `vectorize` is 4, 8 or 16 wide, not {width}");
        let param = |name: &str, ty: Ty| Param { ty, name: Some(name.into()), keep: false };
        let params = vec![param("i", Ty::u32()), param("return", Ty::func(&[]))];
        let (each, nodes) = with(|w| {
            let each = w.cont("each", Role::Fun, params, loc);
            (each, w.params(each))
        });
        let mut inner = Block::new(each);
        body(&mut inner, U32::from_node(nodes[0]));
        ().end(inner, nodes[1], None, loc);
        let (rest, ()) = Block::continuation("rest", Role::Rest, always(), loc);
        let (body, next) = with(|w| (w.cont_value(each), w.cont_value(rest)));
        self.leave(Body::Vectorize { width, lo, hi, body, args: vec![], next }, loc);
        *self = Block::new(rest);
    }
}
