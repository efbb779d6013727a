//! The type of a node from the types of its operands: one rule per kind of node.

use crate::program::*;
use crate::ty::{Scalar, Ty, TyKind};

/// The type of `node`, or what is wrong with its operands. The operands are nodes of `p`.
pub fn type_of(p: &Program, node: &Node) -> Result<Ty, String> {
    match node {
        Node::Lit(lit) => Ok(lit.ty()),
        Node::Param { cont, index } => {
            let cont = p.conts.get(cont.index()).ok_or("a parameter of no continuation")?;
            let param = cont.params.get(*index as usize);
            param.map(|x| x.ty).ok_or_else(|| format!("`{}` has no parameter {index}", cont.name))
        }
        Node::Cont(cont) if cont.index() < p.conts.len() => Ok(p.cont_ty(*cont)),
        Node::Cont(_) => Err("no such continuation".to_owned()),
        Node::Prim { op, args } => {
            let types: Vec<Ty> = args[..op.arity()].iter().map(|x| p.ty(*x)).collect();
            op.result(&types)
        }
        Node::Pack(elems) => {
            let scalar = elems.first().and_then(|x| p.ty(*x).as_scalar());
            match scalar {
                Some(s) if (2..=16).contains(&elems.len()) && elems.iter().all(|x| p.ty(*x) == Ty::scalar(s)) => {
                    Ok(Ty::vector(s, elems.len()))
                }
                _ => Err("a vector is made of 2 to 16 scalars of one type".to_owned()),
            }
        }
        Node::Lane { vector, lane } => match *p.ty(*vector).kind() {
            TyKind::Vector(s, lanes) if *lane < lanes => Ok(Ty::scalar(s)),
            _ => Err(format!("no lane {lane} in {}", p.ty(*vector))),
        },
        Node::Tuple(elems) => Ok(Ty::tuple(&elems.iter().map(|x| p.ty(*x)).collect::<Vec<_>>())),
        Node::Extract { tuple, index } => match p.ty(*tuple).kind() {
            TyKind::Tuple(elems) if (*index as usize) < elems.len() => Ok(elems[*index as usize]),
            _ => Err(format!("no component {index} in {}", p.ty(*tuple))),
        },
        Node::Read { column, index } => {
            let decl = column_of(p, *column)?;
            let buffer = p.buffer(column.buf);
            if buffer.kind == BufKind::Stream {
                return Err(format!("`{}` is a stream; load from it", buffer.name));
            }
            let ty = p.ty(*index);
            if ty == Ty::row(column.buf) {
                return Ok(decl.ty.ty());
            }
            match (ty.lanes(), decl.ty) {
                (Some((Scalar::U32, 1)), _) => Ok(decl.ty.ty()),
                (Some((Scalar::U32, lanes)), ColTy::Scalar(s)) => Ok(Ty::vector(s, lanes)),
                (Some((Scalar::U32, _)), ColTy::Ref(_)) => {
                    Err(format!("`{}.{}` holds rows, of which there are no vectors", buffer.name, decl.name))
                }
                _ => Err(format!("`{}` is read at a u32, a vector of them or a row of it, not at {ty}", buffer.name)),
            }
        }
        Node::Row { table, index } => {
            let buffer = p.buffers.get(table.index()).ok_or("a row of no buffer")?;
            match (buffer.kind, p.ty(*index) == Ty::u32()) {
                (BufKind::Table { .. }, true) => Ok(Ty::row(*table)),
                (BufKind::Stream, _) => Err(format!("`{}` is a stream and has no rows as values", buffer.name)),
                (_, false) => Err(format!("a row is made at a u32, not at {}", p.ty(*index))),
            }
        }
        Node::Sibling { row, index } => match (p.ty(*row).kind(), p.ty(*index) == Ty::u32()) {
            (TyKind::Row(_), true) => Ok(p.ty(*row)),
            (TyKind::Row(_), false) => Err(format!("a row is made at a u32, not at {}", p.ty(*index))),
            _ => Err(format!("{} is no row", p.ty(*row))),
        },
        Node::RowIndex(row) => match p.ty(*row).kind() {
            TyKind::Row(_) => Ok(Ty::u32()),
            _ => Err(format!("{} is no row", p.ty(*row))),
        },
        Node::Known(_) => Ok(Ty::bool()),
    }
}

/// The declaration of a column, if there is one.
pub(crate) fn column_of(p: &Program, column: Column) -> Result<&ColumnDecl, String> {
    let buffer = p.buffers.get(column.buf.index()).ok_or("a column of no buffer")?;
    let decl = buffer.columns.get(column.col as usize);
    decl.ok_or_else(|| format!("`{}` has no column {}", buffer.name, column.col))
}
