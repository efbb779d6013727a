//! Trees of small graphs, one for each way that blocks can meet.

use super::*;
use crate::cfg::Cfg;

/// The tree of the first entry, with names for blocks.
fn tree(text: &str) -> Result<String, Unstructured> {
    let p = crate::parse(text).expect("it is a program");
    let cfg = Cfg::new(&p, &[p.entries[0].1]).expect("it is first-order");
    structure(&p, &cfg.functions[0]).map(|steps| words(&p, &cfg.functions[0], &steps))
}

fn words(p: &Program, f: &Function, steps: &[Step]) -> String {
    let name = |b: &u32| p.cont(f.blocks[*b as usize].cont).name.to_string();
    let step = |s: &Step| match s {
        Step::Block(b) => name(b),
        Step::Choice { block, arms } => {
            let arms: Vec<String> = arms.iter().map(|a| words(p, f, a)).collect();
            format!("{}{{{}}}", name(block), arms.join(" | "))
        }
        Step::Label { join, body } => format!("label {}({})", name(join), words(p, f, body)),
        Step::Loop { header: _, body } => format!("loop({})", words(p, f, body)),
        Step::Break(join) => format!("break {}", name(join)),
        Step::Continue(header) => format!("continue {}", name(header)),
    };
    steps.iter().map(step).collect::<Vec<_>>().join(" ")
}

/// A function whose blocks go on in others as written: `a b, c` branches on a parameter.
fn graph(lines: &[&str]) -> String {
    let mut text = "jerboa-ir 1\nentry f = f\nfun f(c: bool, return: fn())\n".to_owned();
    for (i, line) in lines.iter().enumerate() {
        let (name, succs) = line.split_once(' ').unwrap_or((line, ""));
        if i > 0 {
            text += &format!("  rest {name}()\n");
        }
        text += &match succs.split(' ').collect::<Vec<_>>()[..] {
            [a, b] => format!("  branch c {a} {b}\n"),
            [""] => "  jump return()\n".to_owned(),
            [a] => format!("  jump {a}()\n"),
            _ => unreachable!("two at most"),
        };
    }
    text
}

#[test]
fn arms_meet_behind_their_choice() {
    assert_eq!(tree(&graph(&["f a b", "a j", "b j", "j"])).as_deref(), Ok("f{a | b} j"));
    assert_eq!(tree(&graph(&["f a j", "a j", "j"])).as_deref(), Ok("f{a | } j"));
    // An arm that returns is left behind, and what follows is no arm.
    assert_eq!(tree(&graph(&["f a b", "a", "b j k", "j k", "k"])).as_deref(), Ok("f{a | } b{j | } k"));
}

#[test]
fn an_exit_past_a_join_breaks() {
    // a leaves past j, the join of f.
    let text = tree(&graph(&["f a b", "a j k", "b j", "j k", "k"]));
    assert_eq!(text.as_deref(), Ok("label k(f{a{ | break k} | b} j) k"));
}

#[test]
fn loops_are_left_to_what_stands_behind_them() {
    // Out of two loops at once, and back to the outer one from the inner one.
    let text = tree(&graph(&["f o", "o i e", "i k l", "k i m", "l o", "m e", "e"]));
    let expected = "f label e(label m(loop(o{ | break e} label l(loop(i{ | break l} k{ | break m})) l)) m) e";
    assert_eq!(text.as_deref(), Ok(expected));
    let text = tree(&graph(&["f o", "o i e", "i o k", "k i l", "l o", "e"]));
    let expected = "f label e(loop(o{ | break e} label l(loop(i{continue o | } k{ | break l})) l)) e";
    assert_eq!(text.as_deref(), Ok(expected));
}

#[test]
fn two_entries_are_named() {
    let Err(Unstructured::TwoEntries { function, first, second }) =
        tree(&graph(&["f a g", "g b e", "a b", "b a e", "e"]))
    else {
        panic!("it has no tree")
    };
    let mut entries = [first.name, second.name];
    entries.sort();
    assert_eq!((&*function.name, &*entries[0], &*entries[1]), ("f", "a", "b"));
}

#[test]
fn long_is_not_deep() {
    let early_exits: Vec<String> = (0..10_000).map(|i| format!("b{i} e b{}", i + 1)).collect();
    let lines = ["f b0"].into_iter().chain(early_exits.iter().map(String::as_str)).chain(["b10000", "e"]);
    assert!(tree(&graph(&lines.collect::<Vec<_>>())).is_ok());
    // Each arm holds the next one, and all meet one after the other.
    let open = (0..1000).map(|i| format!("a{i} a{} j{i}", i + 1));
    let close = (0..1000).map(|i| if i == 0 { "j0".to_owned() } else { format!("j{i} j{}", i - 1) });
    let nested: Vec<String> =
        ["f a0".to_owned()].into_iter().chain(open).chain(["a1000 j999".into()]).chain(close).collect();
    let deep = tree(&graph(&nested.iter().map(String::as_str).collect::<Vec<_>>()));
    assert!(matches!(deep, Err(Unstructured::Deep { .. })));
}
