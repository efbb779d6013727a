//! What a function takes and returns.

use jerboa_ir::NodeId;
use naga::{Binding, BuiltIn, FunctionArgument, FunctionResult};

use super::top::Top;
use super::{Emitter, Known, scalars};
use crate::Grid;

impl Emitter<'_> {
    /// Arguments and results as naga declares them.
    pub(super) fn signature(&mut self) {
        self.known.push(Default::default());
        match self.index {
            0 => self.of_entry(),
            _ => self.of_function(),
        }
    }

    /// The entry takes the number of the invocation, and its arguments from the launch.
    fn of_entry(&mut self) {
        let cont = self.unit.program.cont(self.f.cont);
        let mut params = 0..cont.params.len() as u32 - 1;
        if self.unit.grid == Grid::Items {
            let triple = self.types.triple();
            let number = self.types.scalar(jerboa_ir::Scalar::U32);
            let built_in = [
                ("group", triple, BuiltIn::WorkGroupId),
                ("groups", triple, BuiltIn::NumWorkGroups),
                ("local", number, BuiltIn::LocalInvocationIndex),
            ];
            for (name, ty, is) in built_in {
                let binding = Some(Binding::BuiltIn(is));
                self.code.function.arguments.push(FunctionArgument { name: Some(name.into()), ty, binding });
            }
            if let Some(number) = params.next().and_then(|i| self.param(i)) {
                let value = self.top(Top::Invocation);
                self.know(Known::Lane(number, 0), value);
            }
        }
        let mut word = 0;
        for i in params {
            for (lane, scalar) in scalars([cont.params[i as usize].ty]).into_iter().enumerate() {
                if let Some(param) = self.param(i) {
                    let value = self.top(Top::Argument(word, scalar));
                    self.know(Known::Lane(param, lane), value);
                }
                word += 1;
            }
        }
    }

    fn of_function(&mut self) {
        let cont = self.unit.program.cont(self.f.cont);
        let (ret, params) = cont.params.split_last().expect("a function has a return");
        let mut number = 0;
        for (i, param) in params.iter().enumerate() {
            for (lane, scalar) in scalars([param.ty]).into_iter().enumerate() {
                let name = param.name.as_deref().unwrap_or("x").to_owned();
                let ty = self.types.scalar(scalar);
                self.code.function.arguments.push(FunctionArgument { name: Some(name), ty, binding: None });
                if let Some(param) = self.param(i as u32) {
                    let value = self.code.argument(number);
                    self.know(Known::Lane(param, lane), value);
                }
                number += 1;
            }
        }
        let results = scalars(ret.ty.params().unwrap_or_default().iter().copied());
        let results = self.types.results(&results);
        self.code.function.result = results.map(|ty| FunctionResult { ty, binding: None });
        self.code.function.name = Some(cont.name.to_string());
    }

    /// A parameter of the function, if it is used.
    fn param(&self, index: u32) -> Option<NodeId> {
        let param = self.unit.params.get(&(self.f.cont, index)).copied();
        param.filter(|x| self.uses.is_used(*x))
    }
}
