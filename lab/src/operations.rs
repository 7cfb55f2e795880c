//! Operations of a kernel, counted in its IR: what one invocation loads, stores and computes, outside of loops and within.
//!
//! The IR is that of the kernel's variant, its overrides replaced and called functions inlined. Branches that a constant
//! condition rules out are not counted. A driver's compiler leaves out more: what nothing uses, and what is computed twice.

use anamorph::internals::gpu::kernels::Kernel;
use naga_soft_f64::doubles;
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::ops::AddAssign;
use wgpu::naga;

use naga::back::pipeline_constants::process_overrides;
use naga::valid::{Capabilities, FunctionInfo, ModuleInfo, ValidationFlags, Validator};
use naga::{
    AddressSpace, ArraySize, BinaryOperator, Block, Expression, Function, Handle, Literal, LocalVariable, MathFunction,
    Module, Scalar, Statement, TypeInner, UnaryOperator,
};

/// What one invocation does. Both sides of a branch count: a subgroup whose threads differ takes both.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Operations {
    /// Words of 32 bits from storage buffers and textures; uniform buffers do not count.
    pub loads: u64,
    /// Words of 32 bits to them.
    pub stores: u64,
    /// Atomic operations on storage buffers, but for plain loads and stores.
    pub atomics: u64,
    /// Operations on f64 and conversions, by components. The same where they are calls of naga-soft-f64.
    pub f64: u64,
    /// Divisions and square roots of f64, which are not among the former.
    pub f64_divisions: u64,
}

/// Operations outside of loops, so once per item of the kernel; in a loop; and in a loop in a loop, or deeper: of one round each.
pub type ByLoopDepth = [Operations; 3];

impl AddAssign for Operations {
    fn add_assign(&mut self, other: Operations) {
        self.loads += other.loads;
        self.stores += other.stores;
        self.atomics += other.atomics;
        self.f64 += other.f64;
        self.f64_divisions += other.f64_divisions;
    }
}

/// Counts the operations of one invocation of a kernel.
///
/// # Errors
/// The reason why the kernel's source is not valid.
pub fn of_kernel(kernel: &Kernel) -> Result<ByLoopDepth, String> {
    operations(&kernel.source(), &kernel.constants).map_err(|e| format!("kernel {}: {e}", kernel.name))
}

/// What one invocation of a source's entry point does, with these values of its overrides.
///
/// # Errors
/// What is wrong with the source, or that it has not one entry point.
pub fn operations(source: &str, constants: &[(&str, f64)]) -> Result<ByLoopDepth, String> {
    let module = naga::front::wgsl::parse_str(source).map_err(|e| e.emit_to_string(source))?;
    let info =
        Validator::new(ValidationFlags::all(), Capabilities::all()).validate(&module).map_err(|e| format!("{e:?}"))?;
    let [entry] = &module.entry_points[..] else { return Err("there is not one entry point".into()) };
    let entry = (entry.stage, entry.name.as_str());
    let constants = constants.iter().map(|&(name, value)| (name.to_owned(), value)).collect();
    let (module, info) =
        process_overrides(&module, &info, Some(entry), &constants).map_err(|e| format!("its overrides: {e}"))?;
    let (function, own_info) = (&module.entry_points[0].function, info.get_entry_point(0));
    Ok(Counting::new(&module, &info, function, own_info, Vec::new()).all().counts)
}

/// A call of a function while its operations are counted.
struct Counting<'a> {
    module: &'a Module,
    info: &'a ModuleInfo,
    function: &'a Function,
    own_info: &'a FunctionInfo,
    /// Those that are constant.
    arguments: Vec<Option<Literal>>,
    /// Results of `&&` and `||` that are constant, as naga holds them: in variables without a name.
    results: HashMap<Handle<LocalVariable>, Literal>,
    /// Results of calls that are constant.
    called: HashMap<Handle<Expression>, Literal>,
    /// What it returns, in each place where it does.
    returned: Vec<Option<Literal>>,
    counts: ByLoopDepth,
}

impl<'a> Counting<'a> {
    fn new(
        module: &'a Module,
        info: &'a ModuleInfo,
        function: &'a Function,
        own_info: &'a FunctionInfo,
        arguments: Vec<Option<Literal>>,
    ) -> Self {
        let (results, called) = (HashMap::new(), HashMap::new());
        let (returned, counts) = (Vec::new(), ByLoopDepth::default());
        Counting { module, info, function, own_info, arguments, results, called, returned, counts }
    }

    fn all(mut self) -> Self {
        self.block(&self.function.body, 0);
        self
    }

    /// At a depth of loops.
    fn at(&mut self, depth: usize) -> &mut Operations {
        let deepest = self.counts.len() - 1;
        &mut self.counts[depth.min(deepest)]
    }

    /// Counts a block's statements; whether it is left before its end.
    fn block(&mut self, block: &Block, depth: usize) -> bool {
        block.iter().any(|statement| self.statement(statement, depth))
    }

    /// Whether what follows is not reached.
    fn statement(&mut self, statement: &Statement, depth: usize) -> bool {
        match *statement {
            Statement::Emit(ref range) => range.clone().for_each(|value| self.value(value, depth)),
            Statement::Block(ref block) => return self.block(block, depth),
            Statement::If { condition, ref accept, ref reject } => {
                let Some(Literal::Bool(is_met)) = self.constant(condition) else {
                    let are_left = [accept, reject].map(|block| self.block(block, depth));
                    return are_left == [true; 2];
                };
                let taken = if is_met { accept } else { reject };
                let is_left = self.block(taken, depth);
                self.keep_result(taken);
                return is_left;
            }
            Statement::Switch { ref cases, .. } => cases.iter().for_each(|case| {
                self.block(&case.body, depth);
            }),
            Statement::Loop { ref body, ref continuing, .. } => {
                self.block(body, depth + 1);
                self.block(continuing, depth + 1);
            }
            Statement::Return { value } => {
                self.returned.push(value.and_then(|value| self.constant(value)));
                return true;
            }
            Statement::Break | Statement::Continue | Statement::Kill => return true,
            Statement::Store { pointer, value } if self.is_in_storage(pointer) => {
                self.at(depth).stores += self.words(self.inner(value));
            }
            Statement::ImageStore { value, .. } => self.at(depth).stores += self.words(self.inner(value)),
            Statement::Atomic { pointer, .. } if self.is_in_storage(pointer) => self.at(depth).atomics += 1,
            Statement::ImageAtomic { .. } => self.at(depth).atomics += 1,
            Statement::Call { function, ref arguments, result } => {
                let arguments = arguments.iter().map(|argument| self.constant(*argument)).collect();
                let (called, own_info) = (&self.module.functions[function], &self.info[function]);
                let call = Counting::new(self.module, self.info, called, own_info, arguments).all();
                call.counts.into_iter().enumerate().for_each(|(inner, counted)| *self.at(depth + inner) += counted);
                self.called.extend(result.zip(call.result()));
            }
            _ => (),
        }
        false
    }

    /// Counts what computes a value.
    fn value(&mut self, value: Handle<Expression>, depth: usize) {
        match self.function.expressions[value] {
            Expression::Load { pointer } if self.is_in_storage(pointer) => {
                self.at(depth).loads += self.words(self.inner(value));
            }
            Expression::ImageLoad { .. } | Expression::ImageSample { .. } => {
                self.at(depth).loads += self.words(self.inner(value));
            }
            Expression::Unary { expr, .. } => self.at(depth).f64 += self.doubles(expr),
            Expression::Binary { op, left, right } => {
                let count = self.doubles(left).max(self.doubles(right));
                match op {
                    BinaryOperator::Divide | BinaryOperator::Modulo => self.at(depth).f64_divisions += count,
                    _ => self.at(depth).f64 += count,
                }
            }
            Expression::Math { fun, arg, .. } => match (fun, self.doubles(arg)) {
                (_, 0) => (),
                (MathFunction::Sqrt | MathFunction::InverseSqrt, count) => self.at(depth).f64_divisions += count,
                // products and sums
                (MathFunction::Dot, count) => self.at(depth).f64 += 2 * count - 1,
                (MathFunction::Cross, count) => self.at(depth).f64 += 3 * count,
                (_, count) => self.at(depth).f64 += count,
            },
            Expression::As { expr, convert: Some(_), .. } => {
                self.at(depth).f64 += self.doubles(expr).max(self.doubles(value));
            }
            _ => (),
        }
    }

    /// What it returns, if that is constant.
    fn result(&self) -> Option<Literal> {
        let first = self.returned.first().copied().flatten();
        first.filter(|_| self.returned.iter().all(|value| *value == first))
    }

    /// A value that is constant in this call.
    fn constant(&self, value: Handle<Expression>) -> Option<Literal> {
        let literal = |expression: &Expression| match *expression {
            Expression::Literal(value) => Some(value),
            _ => None,
        };
        match self.function.expressions[value] {
            Expression::Constant(named) => literal(&self.module.global_expressions[self.module.constants[named].init]),
            Expression::FunctionArgument(index) => self.arguments.get(index as usize).copied().flatten(),
            Expression::CallResult(_) => self.called.get(&value).copied(),
            Expression::Load { pointer } => self.results.get(&self.variable(pointer)?).copied(),
            Expression::Unary { op: UnaryOperator::LogicalNot, expr } => match self.constant(expr)? {
                Literal::Bool(value) => Some(Literal::Bool(!value)),
                _ => None,
            },
            Expression::Binary { op: op @ (BinaryOperator::Equal | BinaryOperator::NotEqual), left, right } => {
                let are_equal = self.constant(left)? == self.constant(right)?;
                Some(Literal::Bool(are_equal == (op == BinaryOperator::Equal)))
            }
            ref other => literal(other),
        }
    }

    /// After a branch that is always taken: `a && b` stores b or false, by a, to a variable of its own.
    fn keep_result(&mut self, taken: &Block) {
        let Some(&Statement::Store { pointer, value }) = taken.last() else { return };
        let variable = self.variable(pointer).filter(|v| self.function.local_variables[*v].name.is_none());
        if let Some((variable, value)) = variable.zip(self.constant(value)) {
            self.results.insert(variable, value);
        }
    }

    fn variable(&self, pointer: Handle<Expression>) -> Option<Handle<LocalVariable>> {
        match self.function.expressions[pointer] {
            Expression::LocalVariable(variable) => Some(variable),
            _ => None,
        }
    }

    fn inner(&self, value: Handle<Expression>) -> &'a TypeInner {
        self.own_info[value].ty.inner_with(&self.module.types)
    }

    fn is_in_storage(&self, pointer: Handle<Expression>) -> bool {
        matches!(self.inner(pointer).pointer_space(), Some(AddressSpace::Storage { .. }))
    }

    fn doubles(&self, value: Handle<Expression>) -> u64 {
        doubles(self.inner(value)).unwrap_or(0).into()
    }

    /// Words of 32 bits that a value has.
    fn words(&self, inner: &TypeInner) -> u64 {
        let scalars = |count: u64, scalar: Scalar| count * u64::from(scalar.width) / 4;
        let of = |ty| self.words(&self.module.types[ty].inner);
        match *inner {
            TypeInner::Scalar(scalar) | TypeInner::Atomic(scalar) => scalars(1, scalar),
            TypeInner::Vector { size, scalar } => scalars(size as u64, scalar),
            TypeInner::Matrix { columns, rows, scalar } => scalars(columns as u64 * rows as u64, scalar),
            TypeInner::Array { base, size: ArraySize::Constant(count), .. } => u64::from(count.get()) * of(base),
            TypeInner::Struct { ref members, .. } => members.iter().map(|member| of(member.ty)).sum(),
            _ => 0,
        }
    }
}
