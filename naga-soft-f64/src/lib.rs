//! Lowers `f64` in a naga module to pairs of `u32`: every f64 becomes two words, low word first, and every operation on it a call of a
//! function in `soft_f64.wgsl`, which rounds as IEEE 754 says.
//!
//! See the README for what is supported.

use naga::valid::{Capabilities, FunctionInfo, ModuleInfo, ValidationFlags, Validator};
use naga::{
    ArraySize, BinaryOperator, Block, Expression, Function, Handle, Literal, MathFunction, Module, Range, Scalar,
    ScalarKind, Span, Statement, Type, TypeInner, UnaryOperator, VectorSize,
};
use std::collections::HashMap;

/// The functions that do the arithmetic.
const SOFT_F64: &str = include_str!("soft_f64.wgsl");

type Result<T> = std::result::Result<T, String>;
type Value = Handle<Expression>;

/// Lowers the f64 of a module that is written in WGSL; see [`lower`].
///
/// # Errors
/// The error of the parser or the validator, or the f64 operation that is not supported.
pub fn lower_wgsl(source: &str, identities: &[&str]) -> Result<Module> {
    let module = naga::front::wgsl::parse_str(source).map_err(|e| e.emit_to_string(source))?;
    let info =
        Validator::new(ValidationFlags::all(), Capabilities::all()).validate(&module).map_err(|e| format!("{e:?}"))?;
    lower(&module, &info, identities)
}

/// The module without f64. `identities` names functions of one argument that convert between an f64 and its two words (`vec2<u32>`, low
/// word first): their bodies are replaced by `return argument`, because both are the same here.
///
/// # Errors
/// The f64 operation that is not supported.
pub fn lower(module: &Module, info: &ModuleInfo, identities: &[&str]) -> Result<Module> {
    let new = naga::front::wgsl::parse_str(SOFT_F64).map_err(|e| e.emit_to_string(SOFT_F64))?;
    let soft = new.functions.iter().filter_map(|(h, f)| Some((f.name.clone()?, h))).collect();
    let mut lowering = Lowering {
        old: module,
        info,
        identities,
        new,
        soft,
        types: HashMap::new(),
        constants: HashMap::new(),
        overrides: HashMap::new(),
        globals: HashMap::new(),
        functions: HashMap::new(),
        global_values: HashMap::new(),
        literals: HashMap::new(),
    };
    lowering.module()?;
    Ok(lowering.new)
}

struct Lowering<'a> {
    old: &'a Module,
    info: &'a ModuleInfo,
    identities: &'a [&'a str],
    new: Module,
    /// The functions that do the arithmetic, by their names.
    soft: HashMap<String, Handle<Function>>,
    types: HashMap<Handle<Type>, Handle<Type>>,
    constants: HashMap<Handle<naga::Constant>, Handle<naga::Constant>>,
    overrides: HashMap<Handle<naga::Override>, Handle<naga::Override>>,
    globals: HashMap<Handle<naga::GlobalVariable>, Handle<naga::GlobalVariable>>,
    functions: HashMap<Handle<Function>, Handle<Function>>,
    global_values: HashMap<Value, Value>,
    /// The f64 that functions name, by their bits.
    literals: HashMap<u64, Handle<naga::Constant>>,
}

/// How many f64 a value is: 1 for a scalar, 2 to 4 for a vector, none for any other type.
pub fn doubles(inner: &TypeInner) -> Option<u32> {
    match *inner {
        TypeInner::Scalar(Scalar::F64) => Some(1),
        TypeInner::Vector { size, scalar: Scalar::F64 } => Some(size as u32),
        _ => None,
    }
}

impl<'a> Lowering<'a> {
    fn module(&mut self) -> Result<()> {
        let old = self.old;
        // overrides and constants name values, and values name them
        for (h, value) in old.global_expressions.iter() {
            let value = self.global_value(value)?;
            let new = self.new.global_expressions.append(value, Span::UNDEFINED);
            self.global_values.insert(h, new);
        }
        for (h, _) in old.overrides.iter() {
            self.override_of(h)?;
        }
        for (h, variable) in old.global_variables.iter() {
            let ty = self.type_of(variable.ty)?;
            let init = variable.init.map(|v| self.global_values[&v]);
            let new = naga::GlobalVariable { ty, init, ..variable.clone() };
            self.globals.insert(h, self.new.global_variables.append(new, Span::UNDEFINED));
        }
        for (h, function) in old.functions.iter() {
            let info = &self.info[h];
            let new = self.function(function, info)?;
            self.functions.insert(h, self.new.functions.append(new, Span::UNDEFINED));
        }
        for (k, entry) in old.entry_points.iter().enumerate() {
            let function = self.function(&entry.function, self.info.get_entry_point(k))?;
            self.new.entry_points.push(naga::EntryPoint { function, ..entry.clone() });
        }
        Ok(())
    }

    fn insert(&mut self, inner: TypeInner) -> Handle<Type> {
        self.new.types.insert(Type { name: None, inner }, Span::UNDEFINED)
    }

    /// Two u32.
    fn words(&mut self) -> Handle<Type> {
        self.insert(TypeInner::Vector { size: VectorSize::Bi, scalar: Scalar::U32 })
    }

    /// Of a scalar two u32, of a vector an array of them.
    fn doubles(&mut self, count: u32) -> Handle<Type> {
        let base = self.words();
        match std::num::NonZeroU32::new(count).filter(|n| n.get() > 1) {
            None => base,
            Some(n) => self.insert(TypeInner::Array { base, size: ArraySize::Constant(n), stride: 8 }),
        }
    }

    fn type_of(&mut self, ty: Handle<Type>) -> Result<Handle<Type>> {
        if let Some(&known) = self.types.get(&ty) {
            return Ok(known);
        }
        let of = &self.old.types[ty];
        let new = match of.inner {
            ref inner if doubles(inner).is_some() => self.doubles(doubles(inner).unwrap_or(1)),
            TypeInner::Array { base, size, stride } => {
                let new_base = self.type_of(base)?;
                // an array of vectors is packed closer than the vectors were
                let stride = match self.new.types[new_base].inner {
                    TypeInner::Array { size: ArraySize::Constant(n), stride, .. } => n.get() * stride,
                    _ => stride,
                };
                self.insert(TypeInner::Array { base: new_base, size, stride })
            }
            TypeInner::Struct { ref members, span } => {
                let mut members = members.clone();
                for member in &mut members {
                    member.ty = self.type_of(member.ty)?;
                }
                let inner = TypeInner::Struct { members, span };
                self.new.types.insert(Type { name: of.name.clone(), inner }, Span::UNDEFINED)
            }
            TypeInner::Pointer { base, space } => {
                let base = self.type_of(base)?;
                self.insert(TypeInner::Pointer { base, space })
            }
            _ => self.new.types.insert(of.clone(), Span::UNDEFINED),
        };
        self.types.insert(ty, new);
        Ok(new)
    }

    fn constant_of(&mut self, constant: Handle<naga::Constant>) -> Result<Handle<naga::Constant>> {
        if let Some(&known) = self.constants.get(&constant) {
            return Ok(known);
        }
        let of = &self.old.constants[constant];
        let ty = self.type_of(of.ty)?;
        let new = naga::Constant { name: of.name.clone(), ty, init: self.global_values[&of.init] };
        let new = self.new.constants.append(new, Span::UNDEFINED);
        self.constants.insert(constant, new);
        Ok(new)
    }

    fn override_of(&mut self, of: Handle<naga::Override>) -> Result<Handle<naga::Override>> {
        if let Some(&known) = self.overrides.get(&of) {
            return Ok(known);
        }
        let old = &self.old.overrides[of];
        let ty = self.type_of(old.ty)?;
        let new = naga::Override { ty, init: old.init.map(|v| self.global_values[&v]), ..old.clone() };
        let new = self.new.overrides.append(new, Span::UNDEFINED);
        self.overrides.insert(of, new);
        Ok(new)
    }

    /// Two u32 as a constant expression of the module.
    fn words_value(&mut self, bits: u64) -> Expression {
        let words = [bits as u32, (bits >> 32) as u32].map(|w| Expression::Literal(Literal::U32(w)));
        let components = words.map(|w| self.new.global_expressions.append(w, Span::UNDEFINED)).to_vec();
        Expression::Compose { ty: self.words(), components }
    }

    fn literal(&mut self, value: f64) -> Handle<naga::Constant> {
        let bits = value.to_bits();
        if let Some(&known) = self.literals.get(&bits) {
            return known;
        }
        let init = self.words_value(bits);
        let init = self.new.global_expressions.append(init, Span::UNDEFINED);
        let ty = self.words();
        let constant = self.new.constants.append(naga::Constant { name: None, ty, init }, Span::UNDEFINED);
        self.literals.insert(bits, constant);
        constant
    }

    /// Of a value of the module.
    fn is_f64(&self, value: Value) -> bool {
        doubles(self.info[value].inner_with(&self.old.types)).is_some()
    }

    fn global_value(&mut self, value: &Expression) -> Result<Expression> {
        match *value {
            Expression::Literal(Literal::F64(f)) => Ok(self.words_value(f.to_bits())),
            Expression::Compose { ty, ref components } => {
                let components = components.iter().map(|c| self.global_values[c]).collect();
                Ok(Expression::Compose { ty: self.type_of(ty)?, components })
            }
            Expression::Splat { size, value } if self.is_f64(value) => {
                let components = vec![self.global_values[&value]; size as usize];
                Ok(Expression::Compose { ty: self.doubles(size as u32), components })
            }
            ref other => {
                let values = self.global_values.clone();
                self.plain(other, &values)
            }
        }
    }

    /// An expression that is the same with and without f64, but for what it names.
    fn plain(&mut self, old: &Expression, values: &HashMap<Value, Value>) -> Result<Expression> {
        let value = |v: Value| values.get(&v).copied().ok_or_else(|| "a value before it is computed".to_string());
        let more = |v: Option<Value>| v.map(value).transpose();
        Ok(match *old {
            Expression::Literal(_) | Expression::FunctionArgument(_) => old.clone(),
            Expression::Constant(h) => Expression::Constant(self.constant_of(h)?),
            Expression::Override(h) => Expression::Override(self.override_of(h)?),
            Expression::GlobalVariable(h) => Expression::GlobalVariable(self.globals[&h]),
            Expression::ZeroValue(ty) => Expression::ZeroValue(self.type_of(ty)?),
            Expression::Compose { ty, ref components } => Expression::Compose {
                ty: self.type_of(ty)?,
                components: components.iter().map(|c| value(*c)).collect::<Result<_>>()?,
            },
            Expression::Access { base, index } => Expression::Access { base: value(base)?, index: value(index)? },
            Expression::AccessIndex { base, index } => Expression::AccessIndex { base: value(base)?, index },
            Expression::Splat { size, value: v } => Expression::Splat { size, value: value(v)? },
            Expression::Swizzle { size, vector, pattern } => {
                Expression::Swizzle { size, vector: value(vector)?, pattern }
            }
            Expression::Load { pointer } => Expression::Load { pointer: value(pointer)? },
            Expression::Unary { op, expr } => Expression::Unary { op, expr: value(expr)? },
            Expression::Binary { op, left, right } => {
                Expression::Binary { op, left: value(left)?, right: value(right)? }
            }
            Expression::Select { condition, accept, reject } => {
                Expression::Select { condition: value(condition)?, accept: value(accept)?, reject: value(reject)? }
            }
            Expression::Relational { fun, argument } => Expression::Relational { fun, argument: value(argument)? },
            Expression::Math { fun, arg, arg1, arg2, arg3 } => {
                Expression::Math { fun, arg: value(arg)?, arg1: more(arg1)?, arg2: more(arg2)?, arg3: more(arg3)? }
            }
            Expression::As { expr, kind, convert } => Expression::As { expr: value(expr)?, kind, convert },
            Expression::ArrayLength(v) => Expression::ArrayLength(value(v)?),
            Expression::ImageLoad { image, coordinate, array_index, sample, level } => {
                let (image, coordinate, array_index) = (value(image)?, value(coordinate)?, more(array_index)?);
                Expression::ImageLoad { image, coordinate, array_index, sample: more(sample)?, level: more(level)? }
            }
            ref other => return Err(format!("no way to lower {other:?}")),
        })
    }

    fn function(&mut self, old: &Function, info: &FunctionInfo) -> Result<Function> {
        let mut new = Function { name: old.name.clone(), ..Function::default() };
        for argument in &old.arguments {
            new.arguments.push(naga::FunctionArgument { ty: self.type_of(argument.ty)?, ..argument.clone() });
        }
        if let Some(result) = &old.result {
            new.result = Some(naga::FunctionResult { ty: self.type_of(result.ty)?, ..result.clone() });
        }
        let is_identity = old.name.as_deref().is_some_and(|name| self.identities.contains(&name));
        let mut body = Body { lowering: self, old, info, new, values: HashMap::new(), locals: HashMap::new() };
        if is_identity {
            let argument = body.append(Expression::FunctionArgument(0));
            body.new.body = Block::from_vec(vec![Statement::Return { value: Some(argument) }]);
            return Ok(body.new);
        }
        body.before()?;
        let block = body.block(&old.body)?;
        body.new.body = block;
        Ok(body.new)
    }
}

/// State of lowering one function.
struct Body<'l, 'a> {
    lowering: &'l mut Lowering<'a>,
    old: &'l Function,
    info: &'l FunctionInfo,
    new: Function,
    values: HashMap<Value, Value>,
    locals: HashMap<Handle<naga::LocalVariable>, Handle<naga::LocalVariable>>,
}

impl Body<'_, '_> {
    fn inner(&self, value: Value) -> &TypeInner {
        self.info[value].ty.inner_with(&self.lowering.old.types)
    }

    fn doubles(&self, value: Value) -> Option<u32> {
        doubles(self.inner(value))
    }

    fn append(&mut self, value: Expression) -> Value {
        self.new.expressions.append(value, Span::UNDEFINED)
    }

    fn emit(&mut self, block: &mut Block, value: Expression) -> Value {
        let new = self.append(value);
        block.push(Statement::Emit(Range::new_from_bounds(new, new)), Span::UNDEFINED);
        new
    }

    fn call(&mut self, block: &mut Block, name: &str, arguments: &[Value]) -> Result<Value> {
        let function = *self.lowering.soft.get(name).ok_or_else(|| format!("no function {name}"))?;
        let result = self.append(Expression::CallResult(function));
        let call = Statement::Call { function, arguments: arguments.to_vec(), result: Some(result) };
        block.push(call, Span::UNDEFINED);
        Ok(result)
    }

    /// What is there before any statement: constants, arguments and variables.
    fn before(&mut self) -> Result<()> {
        let old = self.old;
        let waiting = |e: &Expression| e.needs_pre_emit() && !matches!(e, Expression::LocalVariable(_));
        for (h, value) in old.expressions.iter().filter(|(_, e)| waiting(e)) {
            let new = match *value {
                Expression::Literal(Literal::F64(f)) => Expression::Constant(self.lowering.literal(f)),
                ref other => self.lowering.plain(other, &self.values)?,
            };
            self.keep(h, new);
        }
        for (h, variable) in old.local_variables.iter() {
            let ty = self.lowering.type_of(variable.ty)?;
            let init = variable.init.map(|v| self.initial(v)).transpose()?;
            let new = naga::LocalVariable { name: variable.name.clone(), ty, init };
            let new = self.new.local_variables.append(new, Span::UNDEFINED);
            self.locals.insert(h, new);
        }
        for (h, value) in old.expressions.iter() {
            if let Expression::LocalVariable(v) = *value {
                self.keep(h, Expression::LocalVariable(self.locals[&v]));
            }
        }
        Ok(())
    }

    /// What a variable starts with: a constant expression, which no statement computes.
    fn initial(&mut self, old: Value) -> Result<Value> {
        if let Some(&known) = self.values.get(&old) {
            return Ok(known);
        }
        let expressions = &self.old.expressions;
        let new = match expressions[old] {
            Expression::Splat { size, value } => {
                let start = self.initial(value)?;
                if self.doubles(value).is_some() {
                    let ty = self.lowering.doubles(size as u32);
                    Expression::Compose { ty, components: vec![start; size as usize] }
                } else {
                    Expression::Splat { size, value: start }
                }
            }
            Expression::Compose { ty, ref components } => {
                let components = components.iter().map(|c| self.initial(*c)).collect::<Result<_>>()?;
                Expression::Compose { ty: self.lowering.type_of(ty)?, components }
            }
            ref other => return Err(format!("no way to start a variable with {other:?}")),
        };
        Ok(self.keep(old, new))
    }

    fn keep(&mut self, old: Value, new: Expression) -> Value {
        let new = self.append(new);
        self.values.insert(old, new);
        new
    }

    /// What a value has become.
    fn value(&self, old: Value) -> Result<Value> {
        let known = self.values.get(&old).copied();
        known.ok_or_else(|| format!("a value before it is computed: {:?}", self.old.expressions[old]))
    }

    /// One f64 of a value, which of a scalar is all of it.
    fn component(&mut self, block: &mut Block, old: Value, index: u32) -> Result<Value> {
        let base = self.value(old)?;
        Ok(if self.doubles(old) == Some(1) { base } else { self.emit(block, Expression::AccessIndex { base, index }) })
    }

    /// A scalar or a vector of f64 from each of its components.
    fn each(
        &mut self,
        block: &mut Block,
        count: u32,
        mut one: impl FnMut(&mut Self, &mut Block, u32) -> Result<Value>,
    ) -> Result<Value> {
        if count == 1 {
            return one(self, block, 0);
        }
        let components = (0..count).map(|k| one(self, block, k)).collect::<Result<_>>()?;
        let ty = self.lowering.doubles(count);
        Ok(self.emit(block, Expression::Compose { ty, components }))
    }

    /// Three f64 of a value: of a scalar three times the same.
    fn triple(&mut self, block: &mut Block, old: Value) -> Result<Value> {
        if self.doubles(old) == Some(3) {
            return self.value(old);
        }
        self.each(block, 3, |s, _, _| s.value(old))
    }

    /// Computes a value where it was computed.
    fn compute(&mut self, block: &mut Block, old: Value) -> Result<()> {
        let new = match self.doubles(old) {
            Some(count) => self.double(block, old, count)?,
            None => self.other(block, old)?,
        };
        self.values.insert(old, new);
        Ok(())
    }

    /// A value that is f64.
    fn double(&mut self, block: &mut Block, old: Value, count: u32) -> Result<Value> {
        let expressions = &self.old.expressions;
        match expressions[old] {
            Expression::Compose { ref components, .. } => {
                let mut parts = Vec::new();
                for &c in components {
                    for k in 0..self.doubles(c).unwrap_or(1) {
                        parts.push(self.component(block, c, k)?);
                    }
                }
                self.each(block, count, |_, _, k| Ok(parts[k as usize]))
            }
            Expression::Splat { value, .. } => {
                let value = self.value(value)?;
                self.each(block, count, |_, _, _| Ok(value))
            }
            Expression::Swizzle { vector, pattern, .. } => {
                self.each(block, count, |s, block, k| s.component(block, vector, pattern[k as usize] as u32))
            }
            Expression::Unary { op: UnaryOperator::Negate, expr } => self.each(block, count, |s, block, k| {
                let a = s.component(block, expr, k)?;
                s.call(block, "f64_neg", &[a])
            }),
            Expression::Binary { op, left, right } => {
                let name = match op {
                    BinaryOperator::Add => "f64_add",
                    BinaryOperator::Subtract => "f64_sub",
                    BinaryOperator::Multiply => "f64_mul",
                    BinaryOperator::Divide => "f64_div",
                    _ => return Err(format!("no way to lower {op:?} of f64")),
                };
                if count == 3 {
                    let (a, b) = (self.triple(block, left)?, self.triple(block, right)?);
                    return self.call(block, &format!("{name}3"), &[a, b]);
                }
                self.each(block, count, |s, block, k| {
                    let (a, b) = (s.component(block, left, k)?, s.component(block, right, k)?);
                    s.call(block, name, &[a, b])
                })
            }
            Expression::Select { condition, accept, reject } => {
                let scalar = matches!(self.inner(condition), TypeInner::Scalar(_));
                let whether = self.value(condition)?;
                self.each(block, count, |s, block, k| {
                    let (accept, reject) = (s.component(block, accept, k)?, s.component(block, reject, k)?);
                    let condition = match scalar {
                        true => whether,
                        false => s.emit(block, Expression::AccessIndex { base: whether, index: k }),
                    };
                    Ok(s.emit(block, Expression::Select { condition, accept, reject }))
                })
            }
            // of two or four f64, first to last
            Expression::Math { fun: MathFunction::Dot, arg, arg1: Some(other), .. } if self.doubles(arg) != Some(3) => {
                let mut total = None;
                for k in 0..self.doubles(arg).unwrap_or(1) {
                    let (a, b) = (self.component(block, arg, k)?, self.component(block, other, k)?);
                    let product = self.call(block, "f64_mul", &[a, b])?;
                    total = Some(match total {
                        None => product,
                        Some(before) => self.call(block, "f64_add", &[before, product])?,
                    });
                }
                total.ok_or_else(|| "a dot product of nothing".into())
            }
            Expression::Math {
                fun: fun @ (MathFunction::Dot | MathFunction::Cross), arg, arg1: Some(other), ..
            } => {
                let name = if fun == MathFunction::Dot { "f64_dot" } else { "f64_cross" };
                let (a, b) = (self.value(arg)?, self.value(other)?);
                self.call(block, name, &[a, b])
            }
            Expression::Math { fun, arg, arg1, arg2: None, .. } => {
                let name = match fun {
                    MathFunction::Abs => "f64_abs",
                    MathFunction::Sqrt => "f64_sqrt",
                    MathFunction::Min => "f64_min",
                    MathFunction::Max => "f64_max",
                    _ => return Err(format!("no way to lower {fun:?} of f64")),
                };
                self.each(block, count, |s, block, k| {
                    let mut arguments = vec![s.component(block, arg, k)?];
                    if let Some(other) = arg1 {
                        arguments.push(s.component(block, other, k)?);
                    }
                    s.call(block, name, &arguments)
                })
            }
            Expression::As { expr, .. } => {
                let name = match *self.inner(expr) {
                    TypeInner::Scalar(s) | TypeInner::Vector { scalar: s, .. } if s == Scalar::F32 => "f64_from_f32",
                    TypeInner::Scalar(s) | TypeInner::Vector { scalar: s, .. } if s == Scalar::U32 => "f64_from_u32",
                    TypeInner::Scalar(s) | TypeInner::Vector { scalar: s, .. } if s == Scalar::I32 => "f64_from_i32",
                    // to itself
                    ref inner if doubles(inner).is_some() => return self.value(expr),
                    ref inner => return Err(format!("no way to lower a conversion of {inner:?} to f64")),
                };
                let whole = self.value(expr)?;
                if count == 3 && name == "f64_from_f32" {
                    return self.call(block, "f64_from_f32_3", &[whole]);
                }
                self.each(block, count, |s, block, k| {
                    let a = match count {
                        1 => whole,
                        _ => s.emit(block, Expression::AccessIndex { base: whole, index: k }),
                    };
                    s.call(block, name, &[a])
                })
            }
            _ => self.other(block, old),
        }
    }

    /// A value that is no f64, or only moves one.
    fn other(&mut self, block: &mut Block, old: Value) -> Result<Value> {
        let expression = &self.old.expressions[old];
        let new = match *expression {
            Expression::Binary { op, left, right } if self.doubles(left).is_some() => {
                let (name, swapped) = match op {
                    BinaryOperator::Less => ("f64_lt", false),
                    BinaryOperator::LessEqual => ("f64_le", false),
                    BinaryOperator::Greater => ("f64_lt", true),
                    BinaryOperator::GreaterEqual => ("f64_le", true),
                    BinaryOperator::Equal | BinaryOperator::NotEqual => ("f64_eq", false),
                    _ => return Err(format!("no way to lower {op:?} of f64")),
                };
                let (left, right) = if swapped { (right, left) } else { (left, right) };
                let mut parts = Vec::new();
                for k in 0..self.doubles(left).unwrap_or(1) {
                    let (a, b) = (self.component(block, left, k)?, self.component(block, right, k)?);
                    let mut part = self.call(block, name, &[a, b])?;
                    if op == BinaryOperator::NotEqual {
                        part = self.emit(block, Expression::Unary { op: UnaryOperator::LogicalNot, expr: part });
                    }
                    parts.push(part);
                }
                if let [one] = parts[..] {
                    return Ok(one);
                }
                let ty = self.lowering.insert(self.inner(old).clone());
                Expression::Compose { ty, components: parts }
            }
            Expression::As { expr, kind, convert } if self.doubles(expr).is_some() => {
                let name = match (kind, convert) {
                    (ScalarKind::Float, Some(4)) => "f32_from_f64",
                    (ScalarKind::Uint, Some(4)) => "u32_from_f64",
                    _ => return Err(format!("no way to lower a conversion of f64 to {kind:?}")),
                };
                let parts = (0..self.doubles(expr).unwrap_or(1))
                    .map(|k| {
                        let a = self.component(block, expr, k)?;
                        self.call(block, name, &[a])
                    })
                    .collect::<Result<Vec<_>>>()?;
                if let [one] = parts[..] {
                    return Ok(one);
                }
                let ty = self.lowering.insert(self.inner(old).clone());
                Expression::Compose { ty, components: parts }
            }
            ref same => self.lowering.plain(same, &self.values)?,
        };
        Ok(self.emit(block, new))
    }

    fn block(&mut self, old: &Block) -> Result<Block> {
        let mut block = Block::new();
        for statement in old.iter() {
            if let Some(new) = self.statement(&mut block, statement)? {
                block.push(new, Span::UNDEFINED);
            }
        }
        Ok(block)
    }

    /// A statement, after those that it needs.
    fn statement(&mut self, block: &mut Block, old: &Statement) -> Result<Option<Statement>> {
        Ok(Some(match *old {
            Statement::Emit(ref range) => {
                for h in range.clone() {
                    self.compute(block, h)?;
                }
                return Ok(None);
            }
            Statement::Block(ref b) => Statement::Block(self.block(b)?),
            Statement::If { condition, ref accept, ref reject } => Statement::If {
                condition: self.value(condition)?,
                accept: self.block(accept)?,
                reject: self.block(reject)?,
            },
            Statement::Switch { selector, ref cases } => {
                let selector = self.value(selector)?;
                let mut new = Vec::new();
                for case in cases {
                    new.push(naga::SwitchCase { body: self.block(&case.body)?, ..case.clone() });
                }
                Statement::Switch { selector, cases: new }
            }
            Statement::Loop { ref body, ref continuing, break_if } => {
                let (body, continuing) = (self.block(body)?, self.block(continuing)?);
                let break_if = break_if.map(|v| self.value(v)).transpose()?;
                Statement::Loop { body, continuing, break_if }
            }
            Statement::Break | Statement::Continue | Statement::ControlBarrier(_) | Statement::MemoryBarrier(_) => {
                old.clone()
            }
            Statement::Return { value } => Statement::Return { value: value.map(|v| self.value(v)).transpose()? },
            Statement::Store { pointer, value } => {
                Statement::Store { pointer: self.value(pointer)?, value: self.value(value)? }
            }
            Statement::Atomic { pointer, fun, value, result } => {
                let (pointer, value) = (self.value(pointer)?, self.value(value)?);
                let fun = match fun {
                    naga::AtomicFunction::Exchange { compare: Some(c) } => {
                        naga::AtomicFunction::Exchange { compare: Some(self.value(c)?) }
                    }
                    other => other,
                };
                let result = result.map(|v| self.result(v)).transpose()?;
                Statement::Atomic { pointer, fun, value, result }
            }
            Statement::WorkGroupUniformLoad { pointer, result } => {
                Statement::WorkGroupUniformLoad { pointer: self.value(pointer)?, result: self.result(result)? }
            }
            Statement::Call { function, ref arguments, result } => {
                let arguments = arguments.iter().map(|v| self.value(*v)).collect::<Result<_>>()?;
                let result = result.map(|v| self.result(v)).transpose()?;
                Statement::Call { function: self.lowering.functions[&function], arguments, result }
            }
            ref other => return Err(format!("no way to lower {other:?}")),
        }))
    }

    /// What a statement leaves.
    fn result(&mut self, old: Value) -> Result<Value> {
        let new = match self.old.expressions[old] {
            Expression::CallResult(function) => Expression::CallResult(self.lowering.functions[&function]),
            Expression::AtomicResult { ty, comparison } => {
                Expression::AtomicResult { ty: self.lowering.type_of(ty)?, comparison }
            }
            Expression::WorkGroupUniformLoadResult { ty } => {
                Expression::WorkGroupUniformLoadResult { ty: self.lowering.type_of(ty)? }
            }
            ref other => return Err(format!("no way to lower {other:?}")),
        };
        Ok(self.keep(old, new))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SOURCE: &str = "
        @group(0) @binding(0) var<storage, read_write> sums: array<f64>;
        fn to_words(a: f64) -> vec2<u32> { return bitcast<vec2<u32>>(vec2<f32>(f32(a), 0.0)); }
        @compute @workgroup_size(1)
        fn add(@builtin(global_invocation_id) id: vec3<u32>) { sums[id.x] = sqrt(sums[id.x]) / 3.0 + f64(to_words(0.1lf).x); }";

    fn validated(module: &Module, capabilities: Capabilities) -> bool {
        Validator::new(ValidationFlags::all(), capabilities).validate(module).is_ok()
    }

    #[test]
    fn a_lowered_module_is_valid_without_f64() {
        let module = naga::front::wgsl::parse_str(SOURCE).unwrap();
        assert!(!validated(&module, Capabilities::empty()) && validated(&module, Capabilities::FLOAT64));
        assert!(validated(&lower_wgsl(SOURCE, &["to_words"]).unwrap(), Capabilities::empty()));
    }

    #[test]
    fn what_is_not_supported_is_an_error() {
        let error = lower_wgsl("fn f(a: f64) -> f64 { return sin(a); }", &[]).unwrap_err();
        assert!(error.contains("Sin"), "{error}");
        assert!(lower_wgsl("fn f(", &[]).is_err());
    }
}
