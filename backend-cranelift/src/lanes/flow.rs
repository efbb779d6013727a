//! Where lanes wait for one another: what varying choices do to a function's tree.
//!
//! The lanes that an arm of a varying choice is for go through it while the others wait behind the choice. An exit from
//! within that arm would take some lanes away from where the others are; so it cannot be a jump. The lanes that leave are
//! noted in a mask of the label they leave to, and go on there when all others have come, too. Such a label is *linear*: its
//! body is run through to its end. And so it goes on outwards: an exit past a linear label is noted in turn.
//!
//! A *place* is something with an end where lanes can wait: an arm, a label, a round of a loop.

use std::collections::BTreeSet;

use jerboa_ir::cfg::Function;
use jerboa_ir::structure::Step;

/// Where an edge goes.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub(crate) enum Target {
    /// Forward to this block; for one that several go on in, the end of its label.
    Block(u32),
    /// Back to this header: the end of a round.
    Round(u32),
    /// Out of the function.
    Return,
}

impl Target {
    /// Where the edge between two blocks goes.
    pub fn of(from: u32, to: u32) -> Target {
        if to <= from { Target::Round(to) } else { Target::Block(to) }
    }
}

/// A place of the tree.
struct Place {
    around: Option<usize>,
    kind: Kind,
}

/// What stands there.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    /// An arm of this block's choice.
    Arm(u32),
    /// A label's body, a loop's or the function's.
    Body(Target),
}

/// The places of a function and which of them are linear.
pub(crate) struct Flow {
    places: Vec<Place>,
    /// The place of each block.
    of_block: Vec<usize>,
    /// Exits: from which place, and where to.
    exits: Vec<(usize, Target)>,
    /// Choices that lanes make differently, by block.
    pub varying: Vec<bool>,
    /// Targets at which lanes wait.
    pub linear: BTreeSet<Target>,
    /// Targets whose body some lanes leave to elsewhere.
    pub open: BTreeSet<Target>,
    /// Loops that lanes leave in different rounds, by header.
    pub divergent: Vec<bool>,
}

impl Flow {
    /// All is uniform, to begin with.
    pub fn new(f: &Function, tree: &[Step]) -> Flow {
        let n = f.blocks.len();
        let mut flow = Flow {
            places: Vec::new(),
            of_block: vec![0; n],
            exits: Vec::new(),
            varying: vec![false; n],
            linear: BTreeSet::new(),
            open: BTreeSet::new(),
            divergent: vec![false; n],
        };
        flow.body(f, Target::Return, None, tree);
        flow
    }

    fn body(&mut self, f: &Function, target: Target, around: Option<usize>, steps: &[Step]) {
        self.place(f, Place { around, kind: Kind::Body(target) }, steps);
    }

    fn place(&mut self, f: &Function, place: Place, steps: &[Step]) {
        let at = self.places.len();
        self.places.push(place);
        for step in steps {
            match step {
                Step::Block(block) => {
                    self.of_block[*block as usize] = at;
                    if f.blocks[*block as usize].succs.is_empty() {
                        self.exits.push((at, Target::Return));
                    }
                }
                Step::Choice { block, arms } => {
                    self.of_block[*block as usize] = at;
                    for arm in arms {
                        self.place(f, Place { around: Some(at), kind: Kind::Arm(*block) }, arm);
                    }
                }
                Step::Label { join, body } => self.body(f, Target::Block(*join), Some(at), body),
                Step::Loop { header, body } => self.body(f, Target::Round(*header), Some(at), body),
                Step::Break(join) => self.exits.push((at, Target::Block(*join))),
                Step::Continue(header) => self.exits.push((at, Target::Round(*header))),
            }
        }
    }

    /// The places from one outwards.
    fn outwards(&self, from: usize) -> impl Iterator<Item = usize> {
        std::iter::successors(Some(from), |at| self.places[*at].around)
    }

    fn is_linear(&self, place: usize) -> bool {
        match self.places[place].kind {
            Kind::Arm(block) => self.varying[block as usize],
            Kind::Body(target) => self.linear.contains(&target),
        }
    }

    /// What follows from the varying choices.
    pub fn update(&mut self) {
        loop {
            let before = (self.linear.len(), self.open.len());
            for exit in 0..self.exits.len() {
                let (from, target) = self.exits[exit];
                let crossed: Vec<usize> =
                    self.outwards(from).take_while(|at| self.places[*at].kind != Kind::Body(target)).collect();
                let mut linear = false;
                for at in crossed {
                    linear |= self.is_linear(at);
                    if let Kind::Body(crossed) = self.places[at].kind {
                        self.open.insert(crossed);
                        if let Target::Round(header) = crossed {
                            self.divergent[header as usize] |= linear;
                        }
                    }
                }
                if linear {
                    self.linear.insert(target);
                }
            }
            if before == (self.linear.len(), self.open.len()) {
                return;
            }
        }
    }

    /// Do lanes that take this edge wait for others on the way?
    pub fn waits(&self, from: u32, target: Target) -> bool {
        let to = match target {
            Target::Block(block) | Target::Round(block) => Some(self.of_block[block as usize]),
            Target::Return => None,
        };
        let around: Vec<usize> = to.into_iter().flat_map(|to| self.outwards(to)).collect();
        self.outwards(self.of_block[from as usize]).take_while(|at| !around.contains(at)).any(|at| self.is_linear(at))
    }

    /// The linear targets that are left to from within a loop, past its end.
    pub fn exits_of(&self, header: u32) -> BTreeSet<Target> {
        let in_loop = Kind::Body(Target::Round(header));
        let leaves = |(from, target): &(usize, Target)| {
            let stays = |at: usize| self.places[at].kind == Kind::Body(*target);
            let mut crossed = self.outwards(*from).take_while(|at| !stays(*at));
            self.linear.contains(target) && crossed.any(|at| self.places[at].kind == in_loop)
        };
        self.exits.iter().filter(|e| leaves(e)).map(|(_, target)| *target).collect()
    }

    /// Does the block stand in the body of this loop?
    pub fn is_inside(&self, block: u32, header: u32) -> bool {
        let in_loop = Kind::Body(Target::Round(header));
        self.outwards(self.of_block[block as usize]).any(|at| self.places[at].kind == in_loop)
    }
}

/// Does some lane leave these steps for elsewhere than behind them?
pub(crate) fn leaves(f: &Function, steps: &[Step]) -> bool {
    fn walk(f: &Function, steps: &[Step], inside: &mut Vec<Target>) -> bool {
        steps.iter().any(|step| match step {
            Step::Block(block) => f.blocks[*block as usize].succs.is_empty(),
            Step::Choice { arms, .. } => arms.iter().any(|arm| walk(f, arm, inside)),
            Step::Label { body, .. } | Step::Loop { body, .. } => {
                inside.push(match step {
                    Step::Loop { header, .. } => Target::Round(*header),
                    Step::Label { join, .. } => Target::Block(*join),
                    _ => Target::Return,
                });
                let leaves = walk(f, body, inside);
                inside.pop();
                leaves
            }
            Step::Break(join) => !inside.contains(&Target::Block(*join)),
            Step::Continue(header) => !inside.contains(&Target::Round(*header)),
        })
    }
    walk(f, steps, &mut Vec::new())
}
