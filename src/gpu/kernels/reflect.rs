//! Which bindings a kernel's entry points reach, by its module.

use super::files::Binding;
use std::collections::BTreeSet;
use wgpu::naga::{Block, Expression, Function, GlobalVariable, Handle, Module, Statement};

/// Those of a kernel's bindings that some entry point reaches, with their numbers.
pub fn reached(module: &Module, bindings: &[Binding]) -> Vec<(u32, Binding)> {
    let mut globals = BTreeSet::new();
    let mut seen = BTreeSet::new();
    let mut waiting: Vec<&Function> = module.entry_points.iter().map(|entry| &entry.function).collect();
    while let Some(function) = waiting.pop() {
        globals.extend(function.expressions.iter().filter_map(|(_, expression)| global(expression)));
        let mut called = Vec::new();
        calls(&function.body, &mut called);
        waiting.extend(called.into_iter().filter(|f| seen.insert(*f)).map(|f| &module.functions[f]));
    }
    let is_reached = |number: u32| {
        globals.iter().any(|g| module.global_variables[*g].binding.is_some_and(|at| at.binding == number))
    };
    (0..).zip(bindings.iter().copied()).filter(|(number, _)| is_reached(*number)).collect()
}

fn global(expression: &Expression) -> Option<Handle<GlobalVariable>> {
    if let Expression::GlobalVariable(global) = *expression { Some(global) } else { None }
}

/// The functions that statements call.
fn calls(block: &Block, called: &mut Vec<Handle<Function>>) {
    for statement in block {
        match statement {
            Statement::Call { function, .. } => called.push(*function),
            Statement::Block(block) => calls(block, called),
            Statement::If { accept, reject, .. } => [accept, reject].into_iter().for_each(|block| calls(block, called)),
            Statement::Switch { cases, .. } => cases.iter().for_each(|case| calls(&case.body, called)),
            Statement::Loop { body, continuing, .. } => {
                [body, continuing].into_iter().for_each(|block| calls(block, called));
            }
            _ => (),
        }
    }
}
