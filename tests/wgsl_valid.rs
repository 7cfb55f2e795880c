//! Every kernel of every variant is valid WGSL with the least capabilities that the variant may use, is translated for every backend
//! that has these, and keeps f64 to the operations that every driver translates right.

use anamorph::internals::engine::stage;
use anamorph::internals::gpu::compile::lowered;
use anamorph::internals::gpu::kernels::{Kernel, Variant, reached};
use anamorph::internals::gpu::layout::GROUP;
use anamorph::internals::image::frame::Channel;
use anamorph_lab::control;
use anamorph_lab::rivals;
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use naga::{Expression, Function, MathFunction, Module, ScalarKind, ShaderStage, TypeInner};
use std::collections::HashSet;

mod wgsl {
    mod backends;
    mod imports;
    mod operations;
    mod scan;
    pub use backends::assert_translated;
    pub use imports::assert_scanned_right;
}

/// All variants on all kinds of adapters.
fn variants() -> impl Iterator<Item = Variant> {
    [false, true].into_iter().flat_map(|f64| [false, true].map(|atomics64| Variant::every(f64, atomics64))).flatten()
}

/// Kernels that compute with f64 in some variant; rivals' among them, which hand on keys of f64.
const WIDE: [&str; 21] = [
    "aim",
    "exact",
    "small",
    "raster",
    "trace",
    "recheck",
    "certify",
    "sample",
    "recheck_samples",
    "resolve",
    "shade",
    "gradient",
    "gradient_edge",
    "volume",
    "meet",
    "bounce",
    "paste",
    "raytrace",
    "take",
    "take_samples",
    "unfold",
];

/// Kernels that merge keys in some variant.
const MERGING: [&str; 7] = ["small", "raster", "trace", "recheck", "meet", "sample", "recheck_samples"];

/// Kernels that read each pixel's key once.
const READS_KEYS: [&str; 2] = ["shade", "volume"];

/// What a kernel may use beyond plain WGSL, by its files.
fn allowed(kernel: &Kernel) -> Capabilities {
    let has = |path: &str| kernel.files.iter().any(|file| file.path == path);
    let mut caps = Capabilities::empty();
    caps.set(Capabilities::FLOAT64, kernel.has_f64());
    caps.set(Capabilities::SHADER_INT64_ATOMIC_MIN_MAX, has("keys/u64/merge.wgsl"));
    // these read a key as one number
    caps.set(Capabilities::SHADER_INT64, !caps.is_empty() || has("keys/u64/pixel.wgsl"));
    let mut lines = kernel.files.iter().flat_map(|file| file.text.lines());
    caps.set(Capabilities::SUBGROUP, lines.any(|line| line.contains("subgroup") && !line.contains("//")));
    caps
}

fn parse(source: &str) -> Result<Module, String> {
    naga::front::wgsl::parse_str(source).map_err(|e| e.emit_to_string(source))
}

fn validate(module: &Module, caps: Capabilities) -> Result<ModuleInfo, String> {
    Validator::new(ValidationFlags::all(), caps).validate(module).map_err(|e| format!("{:?}", e.into_inner()))
}

fn each_kernel(mut check: impl FnMut(&Kernel, Variant)) {
    let controls = [control::read_only(), control::write_only(), control::subgroup_width()];
    controls.iter().for_each(|k| check(k, Variant::plain(false, false)));
    let alone = ["control/exact.wgsl", "gradient.wgsl", "gradient_edge.wgsl"].map(Kernel::alone);
    alone.iter().for_each(|k| check(k, Variant::plain(true, false)));
    for variant in variants() {
        stage::all_kernels(variant, &Channel::every().collect::<Vec<_>>()).iter().for_each(|k| check(k, variant));
        variant.by_each_tile_path().into_iter().for_each(|by_tile| each_by_tile(by_tile, &mut check));
        if variant.rays.optics.is_none() {
            rivals::kernels::all(variant).iter().for_each(|k| check(k, variant));
        }
    }
}

/// What is different where raster goes tile by tile.
fn each_by_tile(by_tile: Variant, check: &mut impl FnMut(&Kernel, Variant)) {
    let files = ["bin.wgsl", "allot.wgsl", "sort.wgsl", "raster_by_tile.wgsl"];
    files.iter().for_each(|file| check(&Kernel::new(file, by_tile, &[]), by_tile));
    if by_tile.draws_small() {
        check(&Kernel::new("software/small.wgsl", by_tile, &[]), by_tile);
    }
    if by_tile.samples_by_tile() {
        let files = ["edges_by_tile.wgsl", "sample_by_tile.wgsl", "recheck_samples.wgsl"];
        files.iter().for_each(|file| check(&Kernel::new(file, by_tile, &[]), by_tile));
    }
}

/// The draws of the rivals.
fn each_draw() -> Vec<Kernel> {
    [1, 3].into_iter().flat_map(rivals::kernels::draws).collect()
}

/// All checks of a kernel in one test, since reading a kernel takes longer than most of them.
#[test]
fn every_kernel_is_valid_and_portable() {
    let (mut wide, mut merging, mut reads_keys) = (HashSet::new(), HashSet::new(), HashSet::new());
    let mut checked = HashSet::new();
    each_kernel(|kernel, variant| {
        let caps = allowed(kernel);
        let merges = caps.contains(Capabilities::SHADER_INT64_ATOMIC_MIN_MAX);
        assert!(variant.f64() || !kernel.has_f64(), "{} {variant:?}", kernel.name);
        assert!(variant.path.atomics64 || !merges, "{} {variant:?}", kernel.name);
        wide.extend(kernel.has_f64().then_some(kernel.name));
        merging.extend(merges.then_some(kernel.name));
        reads_keys.extend(kernel.files.iter().any(|f| f.path == "keys/u64/pixel.wgsl").then_some(kernel.name));
        // variants share kernels
        let source = kernel.source();
        if !checked.insert((caps.bits(), source.clone(), format!("{:?}", kernel.constants))) {
            return;
        }
        let what = format!("{} {variant:?}", kernel.name);
        let module = parse(&source).unwrap_or_else(|e| panic!("{what}: {e}"));
        let info = validate(&module, caps).unwrap_or_else(|e| panic!("{what} with {caps:?}: {e}"));
        for cap in caps.iter() {
            assert!(validate(&module, caps.difference(cap)).is_err(), "{what} does not need {cap:?}");
        }
        assert_one_entry_point(kernel, &module, &what);
        assert_bindings_are_reached(kernel, &module, &info, &what);
        wgsl::assert_scanned_right(kernel, &module, &what);
        wgsl::assert_translated(kernel, &module, &info, caps);
        // SPIR-V's sine, exponential and the like take no f64
        assert_eq!(forbidden_f64(&module, &info), [], "{what}");
        // a driver need not round f64 to f32 and back
        assert_eq!(rounded_by_f32(&module, &info), 0, "{what}");
    });
    assert_eq!(wide, HashSet::from(WIDE));
    assert_eq!(merging, HashSet::from(MERGING));
    assert_eq!(reads_keys, HashSet::from(READS_KEYS));
}

/// It has the kernel's name and the common workgroup.
fn assert_one_entry_point(kernel: &Kernel, module: &Module, what: &str) {
    let [entry] = &module.entry_points[..] else { panic!("{what}: {} entries", module.entry_points.len()) };
    let side = if ["args", "choose"].contains(&kernel.name) { 1 } else { GROUP };
    assert_eq!((entry.name.as_str(), entry.stage), (kernel.name, ShaderStage::Compute), "{what}");
    assert_eq!(entry.workgroup_size, [side, 1, 1], "{what}");
}

/// What the entry point reaches by the validator's own reading is bound, and nothing else.
fn assert_bindings_are_reached(kernel: &Kernel, module: &Module, info: &ModuleInfo, what: &str) {
    let point = info.get_entry_point(0);
    let used = module.global_variables.iter().filter(|(handle, _)| !point[*handle].is_empty());
    let mut used: Vec<(u32, &str)> =
        used.filter_map(|(_, g)| Some((g.binding?.binding, g.name.as_deref().unwrap_or_default()))).collect();
    used.sort();
    let bound = reached(module, &kernel.bindings());
    assert_eq!(used, bound.iter().map(|(number, b)| (*number, b.name)).collect::<Vec<_>>(), "{what}");
}

#[test]
fn every_kernel_does_without_f64_once_it_is_lowered() {
    let mut checked = HashSet::new();
    each_kernel(|kernel, variant| {
        assert_eq!(kernel.has_f64(), kernel.source().contains("alias real = f64"), "{}", kernel.name);
        // tile by tile only where there is f64
        if !kernel.has_f64() || variant.by_tile() || !checked.insert((variant.path.atomics64, kernel.source())) {
            return;
        }
        let module = lowered(&kernel.source()).unwrap_or_else(|e| panic!("{} {variant:?}: {e}", kernel.name));
        let mut caps = allowed(kernel).difference(Capabilities::FLOAT64);
        let reads_keys = variant.path.atomics64 && READS_KEYS.contains(&kernel.name);
        caps.set(Capabilities::SHADER_INT64, caps.contains(Capabilities::SHADER_INT64_ATOMIC_MIN_MAX) || reads_keys);
        let info = validate(&module, caps).unwrap_or_else(|e| panic!("{} {variant:?} with {caps:?}: {e}", kernel.name));
        wgsl::assert_translated(kernel, &module, &info, caps);
    });
}

#[test]
fn every_draw_of_the_rivals_validates_is_translated_and_binds_what_the_table_says() {
    for kernel in each_draw() {
        let module = parse(&kernel.source()).unwrap_or_else(|e| panic!("{}: {e}", kernel.name));
        let mut caps = Capabilities::empty();
        caps.set(Capabilities::CLIP_DISTANCES, ["warp", "bound", "perspective", "splat_move"].contains(&kernel.name));
        let info = validate(&module, caps).unwrap_or_else(|e| panic!("{}: {e}", kernel.name));
        let mut entries: Vec<_> = module.entry_points.iter().map(|e| (e.name.clone(), e.stage)).collect();
        entries.sort_by(|a, b| a.0.cmp(&b.0));
        let stages = [("corner", ShaderStage::Vertex), ("pixel", ShaderStage::Fragment)];
        assert!(entries.into_iter().eq(stages.map(|(name, stage)| (format!("{}_{name}", kernel.name), stage))));
        for (binding, global) in module.global_variables.iter().filter_map(|(_, g)| g.binding.map(|b| (b, g))) {
            assert_eq!(global.name.as_deref(), Some(kernel.bindings()[binding.binding as usize].name));
        }
        wgsl::assert_translated(&kernel, &module, &info, caps);
    }
}

/// f64 functions that SPIR-V has for 64 bits; its sin, exp and the like take 32 bits at most, and naga does not say so.
const F64_FUNCTIONS: [MathFunction; 6] = [
    MathFunction::Abs,
    MathFunction::Min,
    MathFunction::Max,
    MathFunction::Sqrt,
    MathFunction::Dot,
    MathFunction::Cross,
];

/// Every function over f64 in the module that is not one of [`F64_FUNCTIONS`].
fn forbidden_f64(module: &Module, info: &ModuleInfo) -> Vec<MathFunction> {
    let mut found = Vec::new();
    let mut scan = |function: &Function, info: &naga::valid::FunctionInfo| {
        let is_f64 = |handle: naga::Handle<Expression>| {
            let scalar = match info[handle].ty.inner_with(&module.types) {
                TypeInner::Scalar(s) | TypeInner::Vector { scalar: s, .. } | TypeInner::Matrix { scalar: s, .. } => *s,
                _ => return false,
            };
            scalar.kind == ScalarKind::Float && scalar.width == 8
        };
        for (handle, expression) in function.expressions.iter() {
            let Expression::Math { fun, arg, arg1, arg2, arg3 } = *expression else { continue };
            let wide = [Some(handle), Some(arg), arg1, arg2, arg3].into_iter().flatten().any(is_f64);
            if wide && !F64_FUNCTIONS.contains(&fun) {
                found.push(fun);
            }
        }
    };
    for (handle, function) in module.functions.iter() {
        scan(function, &info[handle]);
    }
    for (index, entry) in module.entry_points.iter().enumerate() {
        scan(&entry.function, info.get_entry_point(index));
    }
    found
}

#[test]
fn the_scan_sees_a_planted_sine_in_functions_and_entry_points() {
    let planted = "fn deep(x: f64) -> f64 { return sin(x) + abs(x); }
        @compute @workgroup_size(1) fn main() { var v = vec3<f64>(deep(1.0lf)); v = normalize(exp(v)); let w = sin(1.0f); }";
    let module = parse(planted).unwrap();
    let info = validate(&module, Capabilities::FLOAT64).unwrap();
    assert_eq!(forbidden_f64(&module, &info), [MathFunction::Sin, MathFunction::Exp, MathFunction::Normalize]);
}

/// Counts differences `x - f64(f32(x))`: a driver may optimize away the conversions, which makes them 0.
fn rounded_by_f32(module: &Module, info: &ModuleInfo) -> usize {
    let scan = |function: &Function, info: &naga::valid::FunctionInfo| {
        let width = |handle: naga::Handle<Expression>| match info[handle].ty.inner_with(&module.types) {
            TypeInner::Scalar(s) | TypeInner::Vector { scalar: s, .. } if s.kind == ScalarKind::Float => s.width,
            _ => 0,
        };
        let of = |handle: naga::Handle<Expression>| match function.expressions[handle] {
            Expression::As { expr, kind: ScalarKind::Float, convert: Some(_) } => Some(expr),
            _ => None,
        };
        let there_and_back = |handle: naga::Handle<Expression>| {
            let inner = of(handle).filter(|inner| width(handle) == 8 && width(*inner) == 4);
            inner.and_then(of).filter(|number| width(*number) == 8)
        };
        let is_rest = |expression: &Expression| match *expression {
            Expression::Binary { op: naga::BinaryOperator::Subtract, left, right } => {
                there_and_back(right) == Some(left)
            }
            _ => false,
        };
        function.expressions.iter().filter(|(_, expression)| is_rest(expression)).count()
    };
    let functions = module.functions.iter().map(|(handle, function)| scan(function, &info[handle]));
    let entries = module.entry_points.iter().enumerate().map(|(k, e)| scan(&e.function, info.get_entry_point(k)));
    functions.chain(entries).sum()
}

#[test]
fn the_scan_sees_a_planted_rounding() {
    let planted = "fn deep(x: f64) -> f64 { let hi = f32(x); return x - f64(hi); }
        @compute @workgroup_size(1) fn main() { let v = vec3<f64>(deep(1.0lf)); let w = v - vec3<f64>(vec3<f32>(v)); }";
    let module = parse(planted).unwrap();
    assert_eq!(rounded_by_f32(&module, &validate(&module, Capabilities::FLOAT64).unwrap()), 2);
}
