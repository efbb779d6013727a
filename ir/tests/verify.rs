//! Faults that no text can say; the others are golden files in `tests/files/verify`.

use jerboa_ir::*;

/// `fun f(x: f32, return: fn(f32))  y = add x 1.0  jump return(y)`, as tables to spoil.
fn sound() -> Program {
    let text = "jerboa-ir 1\ntable t by rows\n  c: f32 value\nentry f = f\n\
                fun f(x: f32, return: fn(f32)) @\n  y = add x 1.0\n  jump return(y)\n";
    let p = parse(text).unwrap();
    assert_eq!(verify(&p), []);
    p
}

fn rules(p: &Program) -> Vec<&'static str> {
    verify(p).iter().map(|fault| fault.rule).collect()
}

fn find(p: &Program, is: impl Fn(&Node) -> bool) -> usize {
    p.nodes.iter().position(is).unwrap()
}

#[test]
fn number() {
    let spoil: [fn(&mut Program); 8] = [
        |p| p.types.truncate(1),
        |p| {
            p.nodes.iter_mut().for_each(|n| {
                if let Node::Prim { args, .. } = n {
                    args[0] = NodeId(99)
                }
            })
        },
        |p| {
            p.nodes.iter_mut().for_each(|n| {
                if let Node::Param { index, .. } = n {
                    *index = 2
                }
            })
        },
        |p| p.nodes[0] = Node::Cont(ContId(1)),
        |p| p.nodes[0] = Node::Read { column: Column { buf: BufId(0), col: 1 }, index: NodeId(0) },
        |p| p.conts[0].filter = NodeId::NONE,
        |p| {
            p.conts[0].body =
                Body::Load { mem: Mem::Stream(Column { buf: BufId(3), col: 0 }), index: NodeId(0), next: NodeId(0) }
        },
        |p| p.entries[0].1 = ContId(1),
    ];
    for (i, spoil) in spoil.iter().enumerate() {
        let mut p = sound();
        spoil(&mut p);
        assert!(rules(&p).contains(&"number"), "{i}");
    }
    // An operand that comes after its user.
    let mut p = sound();
    let prim = find(&p, |n| matches!(n, Node::Prim { .. }));
    if let Node::Prim { args, .. } = &mut p.nodes[prim] {
        args[0] = NodeId(prim as u32);
    }
    assert_eq!(rules(&p), ["number"]);
}

#[test]
fn type_() {
    let mut p = sound();
    let prim = find(&p, |n| matches!(n, Node::Prim { .. }));
    p.types[prim] = Ty::u32();
    let faults = verify(&p);
    assert_eq!(faults[0].to_string(), "type: `y` (add): it is noted as u32, but is f32");
    let mut p = sound();
    let one = find(&p, |n| matches!(n, Node::Lit(Lit::F32(_))));
    p.nodes[one] = Node::Lit(Lit::U32(1));
    p.types[one] = Ty::u32();
    assert_eq!(verify(&p)[0].to_string(), "type: `y` (add): add does not take [f32, u32]");
}

#[test]
fn nan() {
    let mut p = sound();
    let one = find(&p, |n| matches!(n, Node::Lit(Lit::F32(_))));
    p.nodes[one] = Node::Lit(Lit::F32(0x7fc0_0001));
    assert_eq!(verify(&p)[0].to_string(), "nan: nan: its bits are 0x7fc00001, not 0x7fc00000");
}

#[test]
fn faults_carry_the_authors_line() {
    let mut p = sound();
    p.conts[0].loc = Loc { file: "power.rs", line: 7 };
    p.conts[0].body = Body::Unset;
    assert_eq!(verify(&p)[0].to_string(), "unset: in `f`: it has no jump (power.rs:7)");
}
