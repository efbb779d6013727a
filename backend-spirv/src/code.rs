//! A naga function under construction.
//!
//! naga keeps expressions in one list and says in the body from where to where they are evaluated. Here an expression is
//! appended with [`Code::pure`], and whatever must happen in order is appended with [`Code::push`], which first lets all
//! expressions before it happen. Literals and names of variables are not evaluated; they are made once.

use std::num::NonZeroU32;

use jerboa_ir::{Lit, Scalar};
use naga::{
    ArraySize, BinaryOperator, Block, Expression, GlobalVariable, Handle, Literal, LocalVariable, MathFunction,
    ScalarKind, Span, Statement, Type, TypeInner, UnaryOperator,
};
use rustc_hash::FxHashMap;

/// An expression: a value, or a pointer to one.
pub(crate) type Value = Handle<Expression>;

/// naga's name of a scalar type.
pub(crate) fn scalar(s: Scalar) -> naga::Scalar {
    match s {
        Scalar::Bool => naga::Scalar::BOOL,
        Scalar::I32 => naga::Scalar::I32,
        Scalar::U32 => naga::Scalar::U32,
        Scalar::F32 => naga::Scalar::F32,
    }
}

/// naga's name of what a scalar is.
pub(crate) fn kind(s: Scalar) -> ScalarKind {
    scalar(s).kind
}

/// The types of a module.
#[derive(Default)]
pub(crate) struct Types(pub naga::UniqueArena<Type>);

impl Types {
    fn insert(&mut self, inner: TypeInner) -> Handle<Type> {
        self.0.insert(Type { name: None, inner }, Span::UNDEFINED)
    }

    /// A scalar.
    pub fn scalar(&mut self, s: Scalar) -> Handle<Type> {
        self.insert(TypeInner::Scalar(scalar(s)))
    }

    /// A vector of three `u32`.
    pub fn triple(&mut self) -> Handle<Type> {
        self.insert(TypeInner::Vector { size: naga::VectorSize::Tri, scalar: naga::Scalar::U32 })
    }

    /// An array; without a length it has as many elements as its storage buffer has room for.
    pub fn array(&mut self, s: Scalar, len: Option<u32>) -> Handle<Type> {
        let base = self.scalar(s);
        let len = len.and_then(NonZeroU32::new);
        self.insert(TypeInner::Array { base, size: len.map_or(ArraySize::Dynamic, ArraySize::Constant), stride: 4 })
    }

    /// What a function returns: nothing, a scalar, or a structure of scalars.
    pub fn results(&mut self, results: &[Scalar]) -> Option<Handle<Type>> {
        match results {
            [] => None,
            [one] => Some(self.scalar(*one)),
            _ => {
                let member = |(i, s): (usize, &Scalar)| naga::StructMember {
                    name: Some(format!("r{i}")),
                    ty: self.scalar(*s),
                    binding: None,
                    offset: i as u32 * 4,
                };
                let members = results.iter().enumerate().map(member).collect();
                Some(self.insert(TypeInner::Struct { members, span: results.len() as u32 * 4 }))
            }
        }
    }
}

/// A function, its open blocks, and what is not evaluated yet.
#[derive(Default)]
pub(crate) struct Code {
    pub function: naga::Function,
    /// What stands before all else.
    top: Block,
    is_at_top: bool,
    /// Innermost last.
    open: Vec<Block>,
    /// The first expression that is not evaluated yet.
    waiting: usize,
    literals: FxHashMap<Lit, Value>,
    names: FxHashMap<Name, Value>,
}

/// What has one value in the whole function.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
enum Name {
    Global(Handle<GlobalVariable>),
    Local(Handle<LocalVariable>),
    Argument(u32),
}

impl Code {
    /// The function; all blocks but one are closed.
    pub fn finish(mut self) -> naga::Function {
        let body = self.close();
        self.top.extend_block(body);
        self.function.body = self.top;
        self.function
    }

    /// Begins a block.
    pub fn open(&mut self) {
        self.evaluate();
        self.open.push(Block::new());
    }

    /// Ends the innermost block.
    pub fn close(&mut self) -> Block {
        self.evaluate();
        self.open.pop().expect("it was opened")
    }

    /// A block of what `f` appends.
    pub fn block(&mut self, f: impl FnOnce(&mut Code)) -> Block {
        self.open();
        f(self);
        self.close()
    }

    /// A statement, after all expressions so far.
    pub fn push(&mut self, statement: Statement) {
        self.evaluate();
        self.open.last_mut().expect("a block is open").push(statement, Span::UNDEFINED);
    }

    fn evaluate(&mut self) {
        let end = self.function.expressions.len();
        if self.waiting < end {
            let range = self.function.expressions.range_from(self.waiting);
            self.waiting = end;
            self.push(Statement::Emit(range));
        }
    }

    /// An expression that is evaluated here.
    pub fn pure(&mut self, e: Expression) -> Value {
        self.function.expressions.append(e, Span::UNDEFINED)
    }

    /// An expression that is not evaluated: the result of a statement, or one that is the same in the whole function.
    fn given(&mut self, e: Expression) -> Value {
        self.evaluate();
        self.waiting += 1;
        self.function.expressions.append(e, Span::UNDEFINED)
    }

    /// What `f` appends stands where the function begins, whatever has been appended before.
    pub fn at_top(&mut self, f: impl FnOnce(&mut Code) -> Value) -> Value {
        if self.is_at_top {
            return f(self);
        }
        self.evaluate();
        self.open.push(std::mem::take(&mut self.top));
        self.is_at_top = true;
        let value = f(self);
        self.is_at_top = false;
        self.top = self.close();
        value
    }

    /// A literal. A float is finite: naga takes no other.
    pub fn literal(&mut self, lit: Lit) -> Value {
        if let Some(value) = self.literals.get(&lit) {
            return *value;
        }
        let value = self.given(Expression::Literal(match lit {
            Lit::Bool(x) => Literal::Bool(x),
            Lit::I32(x) => Literal::I32(x),
            Lit::U32(x) => Literal::U32(x),
            Lit::F32(bits) => Literal::F32(f32::from_bits(bits)),
        }));
        self.literals.insert(lit, value);
        value
    }

    pub fn u32(&mut self, x: u32) -> Value {
        self.literal(Lit::U32(x))
    }

    pub fn i32(&mut self, x: i32) -> Value {
        self.literal(Lit::I32(x))
    }

    pub fn f32(&mut self, x: f32) -> Value {
        self.literal(Lit::f32(x))
    }

    /// The number, if a value is a literal.
    pub fn as_u32(&self, value: Value) -> Option<u32> {
        match self.function.expressions[value] {
            Expression::Literal(Literal::U32(x)) => Some(x),
            _ => None,
        }
    }

    fn name(&mut self, name: Name) -> Value {
        if let Some(value) = self.names.get(&name) {
            return *value;
        }
        let value = self.given(match name {
            Name::Global(variable) => Expression::GlobalVariable(variable),
            Name::Local(variable) => Expression::LocalVariable(variable),
            Name::Argument(index) => Expression::FunctionArgument(index),
        });
        self.names.insert(name, value);
        value
    }

    pub fn argument(&mut self, index: u32) -> Value {
        self.name(Name::Argument(index))
    }

    /// The pointer to a global variable.
    pub fn global(&mut self, variable: Handle<GlobalVariable>) -> Value {
        self.name(Name::Global(variable))
    }

    /// The pointer to a local variable.
    pub fn local(&mut self, variable: Handle<LocalVariable>) -> Value {
        self.name(Name::Local(variable))
    }

    pub fn variable(&mut self, name: &str, ty: Handle<Type>) -> Handle<LocalVariable> {
        let variable = LocalVariable { name: Some(name.to_owned()), ty, init: None };
        self.function.local_variables.append(variable, Span::UNDEFINED)
    }

    pub fn get(&mut self, variable: Handle<LocalVariable>) -> Value {
        let pointer = self.local(variable);
        self.load(pointer)
    }

    pub fn set(&mut self, variable: Handle<LocalVariable>, value: Value) {
        let pointer = self.local(variable);
        self.store(pointer, value);
    }

    pub fn load(&mut self, pointer: Value) -> Value {
        self.pure(Expression::Load { pointer })
    }

    pub fn store(&mut self, pointer: Value, value: Value) {
        self.push(Statement::Store { pointer, value });
    }

    /// Element of an array behind a pointer.
    pub fn element(&mut self, base: Value, index: Value) -> Value {
        self.pure(Expression::Access { base, index })
    }

    /// Element of an array behind a pointer, or a component of a value.
    pub fn component(&mut self, base: Value, index: u32) -> Value {
        self.pure(Expression::AccessIndex { base, index })
    }

    pub fn unary(&mut self, op: UnaryOperator, expr: Value) -> Value {
        self.pure(Expression::Unary { op, expr })
    }

    pub fn binary(&mut self, op: BinaryOperator, left: Value, right: Value) -> Value {
        self.pure(Expression::Binary { op, left, right })
    }

    pub fn math(&mut self, fun: MathFunction, arg: Value) -> Value {
        self.pure(Expression::Math { fun, arg, arg1: None, arg2: None, arg3: None })
    }

    pub fn select(&mut self, condition: Value, accept: Value, reject: Value) -> Value {
        self.pure(Expression::Select { condition, accept, reject })
    }

    /// The number of another type that is nearest.
    pub fn convert(&mut self, expr: Value, to: Scalar) -> Value {
        self.pure(Expression::As { expr, kind: kind(to), convert: Some(4) })
    }

    /// The same bits as another type.
    pub fn cast(&mut self, expr: Value, to: Scalar) -> Value {
        self.pure(Expression::As { expr, kind: kind(to), convert: None })
    }

    /// The smaller of two `u32`.
    pub fn umin(&mut self, a: Value, b: Value) -> Value {
        self.pure(Expression::Math { fun: MathFunction::Min, arg: a, arg1: Some(b), arg2: None, arg3: None })
    }

    /// `if condition { accept } else { reject }`
    pub fn branch(&mut self, condition: Value, accept: Block, reject: Block) {
        self.push(Statement::If { condition, accept, reject });
    }

    /// A loop that its body leaves.
    pub fn repeat(&mut self, body: Block) {
        self.push(Statement::Loop { body, continuing: Block::new(), break_if: None });
    }

    /// Calls a function; the result, if it has one.
    pub fn call(&mut self, function: Handle<naga::Function>, arguments: Vec<Value>, has_result: bool) -> Option<Value> {
        let result = has_result.then(|| self.given(Expression::CallResult(function)));
        self.push(Statement::Call { function, arguments, result });
        result
    }
}
