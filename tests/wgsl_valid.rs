//! Every kernel of every variant is valid WGSL with the least capabilities that the variant may use, is translated for every backend
//! that has these, and keeps f64 to the operations that every driver translates right.

use anamorph::internals::engine::stage;
use anamorph::internals::gpu::compile::lowered;
use anamorph::internals::gpu::exact;
use anamorph::internals::gpu::kernels::{Kernel, RaysKind, Variant};
use anamorph::internals::gpu::layout::GROUP;
use anamorph::internals::image::frame::Channel;
use anamorph_lab::control;
use anamorph_lab::rivals;
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use naga::{Expression, Function, MathFunction, Module, ScalarKind, ShaderStage, TypeInner};
use std::collections::HashSet;

mod wgsl {
    mod backends;
    mod headers;
    mod operations;
    mod scan;
    pub use backends::assert_translated;
    pub use headers::assert_scanned_right;
}

/// All variants on all kinds of adapters.
fn variants() -> impl Iterator<Item = Variant> {
    [false, true].into_iter().flat_map(|f64| [false, true].map(|atomics64| Variant::every(f64, atomics64))).flatten()
}

/// Kernels that have variants of arithmetic; rivals' among them, which hand on keys of f64.
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

/// Kernels that read each pixel's key once.
const READS_KEYS: [&str; 2] = ["shade", "volume"];

/// What a kernel of `variant` may use beyond plain WGSL: those of [`WIDE`] alone have variants of arithmetic,
/// and few merge keys.
fn allowed(kernel: &Kernel, variant: Variant) -> Capabilities {
    let mut caps = Capabilities::empty();
    let is_bounded = kernel.name == "raster" && variant.by_tile && !variant.f64_depths;
    caps.set(Capabilities::FLOAT64, variant.f64 && WIDE.contains(&kernel.name) && !is_bounded);
    let merges =
        !is_bounded && ["small", "raster", "trace", "recheck", "meet", "recheck_samples"].contains(&kernel.name);
    caps.set(
        Capabilities::SHADER_INT64_ATOMIC_MIN_MAX,
        variant.atomics64 && (merges || kernel.name == "sample" && !variant.by_tile),
    );
    // these read a key as one number
    caps.set(Capabilities::SHADER_INT64, !caps.is_empty() || variant.atomics64 && READS_KEYS.contains(&kernel.name));
    let has_lanes = !["allot", "sort", "recheck_samples"].contains(&kernel.name);
    // then each of its threads has a node of its own
    let has_lanes = has_lanes && !((variant.small || variant.wide) && kernel.name == "bin");
    caps.set(Capabilities::SUBGROUP, variant.by_tile && has_lanes || kernel.name == "subgroup_width");
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
    controls.iter().for_each(|k| check(k, Variant::PLAIN));
    let alone = [exact::kernel(), stage::gradient::kernel(), stage::gradient::edge_kernel()];
    alone.iter().for_each(|k| check(k, Variant { f64: true, ..Variant::PLAIN }));
    for variant in variants() {
        stage::all_kernels(variant, &Channel::every().collect::<Vec<_>>()).iter().for_each(|k| check(k, variant));
        for wide in [false, true] {
            each_by_tile(Variant { wide, ..variant.with_tiles() }, &mut check);
            if variant.f64_depths {
                each_by_tile(Variant { wide, f64_depths: false, ..variant.with_tiles() }, &mut check);
            }
        }
        if variant.optics.is_none() {
            rivals::kernels::all(variant).iter().for_each(|k| check(k, variant));
        }
    }
}

/// What is different where raster goes tile by tile.
fn each_by_tile(by_tile: Variant, check: &mut impl FnMut(&Kernel, Variant)) {
    if by_tile.by_tile {
        let kernels = [
            stage::bin::kernel(by_tile),
            stage::sort::allot_kernel(),
            stage::sort::kernel(),
            stage::raster::kernel(by_tile),
        ];
        kernels.iter().for_each(|k| check(k, by_tile));
    }
    let small = by_tile.with_small();
    if small.small {
        [stage::small::kernel(small), stage::bin::kernel(small)].iter().for_each(|k| check(k, small));
    }
    if by_tile.samples_by_tile() {
        let kernels = [stage::edges::by_tile_kernel, stage::sample::by_tile_kernel, stage::sample::recheck_kernel];
        kernels.iter().for_each(|k| check(&k(by_tile), by_tile));
    }
}

/// The draws of the rivals.
fn each_draw() -> Vec<Kernel> {
    [1, 3].into_iter().flat_map(rivals::kernels::draws).collect()
}

/// All checks of a kernel in one test, since reading a kernel takes longer than most of them.
#[test]
fn every_kernel_is_valid_and_portable() {
    let mut wide = 0;
    let mut checked = HashSet::new();
    each_kernel(|kernel, variant| {
        let caps = allowed(kernel, variant);
        wide += u32::from(caps.contains(Capabilities::FLOAT64));
        // variants share kernels
        let names: Vec<&str> = kernel.bindings.iter().map(|b| b.name).collect();
        let source = kernel.source();
        if !checked.insert((caps.bits(), source.clone(), format!("{names:?} {:?}", kernel.constants))) {
            return;
        }
        let what = format!("{} {variant:?}", kernel.name);
        let module = parse(&source).unwrap_or_else(|e| panic!("{what}: {e}"));
        let info = validate(&module, caps).unwrap_or_else(|e| panic!("{what} with {caps:?}: {e}"));
        for cap in caps.iter() {
            assert!(validate(&module, caps.difference(cap)).is_err(), "{what} does not need {cap:?}");
        }
        assert_one_entry_point(kernel, &module, &what);
        assert_globals_are_bindings(kernel, &module, &what);
        wgsl::assert_scanned_right(kernel, &module, &what);
        wgsl::assert_translated(kernel, &module, &info, caps);
        // SPIR-V's sine, exponential and the like take no f64
        assert_eq!(forbidden_f64(&module, &info), [], "{what}");
        // a driver need not round f64 to f32 and back
        assert_eq!(rounded_by_f32(&module, &info), 0, "{what}");
    });
    // of each kind of adapter with f64, with and without counting: ten cameras, one with lights in places, three with samples, three of
    // each kind of surface, three kinds of which are smooth, and two with an atlas; six cameras have curves, which are not rechecked;
    // rivals trace in two ways, and look up in two kinds of pictures
    let all = 10 + 1 + 3 + 12 + 2;
    let (raster_certify_and_shade, recheck, bounce, meet, paste) = (3 * all, all - 6, 12, 9, 2);
    let rivals = (10 + 1 + 3) * (2 + 1 + 2);
    let sample_and_resolve = 3 * 2;
    let by_pair = 4 * (raster_certify_and_shade + recheck + bounce + meet + paste + rivals + sample_and_resolve);
    // and four cameras of triangles with alpha masks, one of curves, and a mirror of facets with the rays that it bounces
    // and such triangles traced: pieces, and a field as things move, with rivals each; and curves that see a mirror
    // and pieces and a field with samples of them
    let masked = 2 * (4 * 3 + 3 + 4 * (2 + 1 + 2) + 2 * (3 + 1 + 1)) + 2 * (2 * (4 + 5) + 4) + 2 * 2 * (4 + 2 + 5);
    // with 64-bit atomics too, and subgroups of either kind: raster of what is rechecked; sample and recheck_samples where the camera is
    // no chain
    let by_tile = 2 * 2 * (all - 6 + 2 * 2);
    // and small where pieces have one layer and one sample: plain, with lights in places, and with each of five kinds of surface
    let small = 2 * 2 * (1 + 1 + 5);
    // where rays may be traced: pieces with both ways, by tile and with small too; pieces and a field without raster, three cameras of curves,
    // with rivals each; and the bounced rays of four kinds of optics, three of them smooth
    let traced = 4 * (5 + 2 * 4 + 3 * 3 + 6 * 5 + 4 * 5 + 3) + 2 * 2 + 2;
    // and where things move: a camera of pieces, a field and curves, with rivals each, and a mirror of facets with the rays that it bounces
    let timed = 4 * (2 * 4 + 3 + 3 * 5 + 2 * 5);
    // and with pictures on surfaces: pieces and a field with rivals, by tile too, and small for pieces; curves; pieces as things move; the rays
    // that a mirror of facets bounces; and samples
    let pictures = 4 * ((9 + 1 + 1) + (9 + 1) + 8 + 9 + (5 + 1) + (11 + 3));
    // and where there are spheres: four cameras of straight rays and three of curves, with rivals each, and a lens with the rays that it bends
    let spheres = 4 * (4 * (4 + 5) + 3 * (3 + 5) + 2 * 6);
    // and where there is a volume of each of three kinds: cameras of pieces, a field and curves, with rivals each; the first two by tile, and
    // the first with small
    let volumes = 4 * (3 * 2 * (3 + 1 + 1 + 5) + 3 * (3 + 1 + 5)) + 2 * 2 * 3 * 2 + 2 * 3 * 2;
    // and where optics are seen along layers: of pieces and of other straight rays, before four kinds of optics, three of them smooth; and along
    // curves of degree 2 and 3, before facets
    let layered_optics = 4 * ((4 * 5 + 3) + (4 * 4 + 3) + 2 * 4);
    // what an adapter is tested with, and two kernels of gradients
    let alone = 1 + 2;
    // take_samples wherever there are rivals; and one camera whose samples the rasterizer takes, with 14 other kernels by pair and by tile
    let has_rivals = |atomics64| Variant::every(true, atomics64).iter().filter(|v| v.optics.is_none()).count();
    let takes = (has_rivals(false) + has_rivals(true)) as u32;
    let multisampled = takes + 4 * 14;
    // and where meshes stand in several places: two cameras of pieces and one of a field, with rivals each
    let instanced = 4 * 3 * (4 + 5);
    // and where shade writes sRGB: a camera of a field, with rivals, and by tile too
    let written = 4 * (4 + 1 + 5);
    // a lens whose viewer moves, in front of fields of the camera's own rays
    let is_aimed = |v: &Variant| v.f64 && v.rays == RaysKind::Field && !v.bounced;
    let aimed = variants().filter(is_aimed).count() as u32;
    let more = aimed + written + instanced + pictures + spheres + volumes + layered_optics + alone + multisampled;
    assert_eq!(wide, by_pair + masked + by_tile + small + traced + timed + more);
}

/// It has the kernel's name and the common workgroup.
fn assert_one_entry_point(kernel: &Kernel, module: &Module, what: &str) {
    let [entry] = &module.entry_points[..] else { panic!("{what}: {} entries", module.entry_points.len()) };
    let side = if ["args", "choose"].contains(&kernel.name) { 1 } else { GROUP };
    assert_eq!((entry.name.as_str(), entry.stage), (kernel.name, ShaderStage::Compute), "{what}");
    assert_eq!(entry.workgroup_size, [side, 1, 1], "{what}");
}

/// Each binding of the table is a global in its place.
fn assert_globals_are_bindings(kernel: &Kernel, module: &Module, what: &str) {
    let mut globals: Vec<(u32, String)> = module
        .global_variables
        .iter()
        .filter_map(|(_, g)| g.binding.map(|b| (b.binding, g.name.clone().unwrap_or_default())))
        .collect();
    globals.sort();
    let table: Vec<(u32, String)> = (0..).zip(kernel.bindings.iter().map(|b| b.name.to_string())).collect();
    assert_eq!(globals, table, "{what}");
}

#[test]
fn every_kernel_does_without_f64_once_it_is_lowered() {
    let mut checked = HashSet::new();
    each_kernel(|kernel, variant| {
        assert_eq!(kernel.f64, kernel.source().contains("alias real = f64"), "{}", kernel.name);
        // tile by tile only where there is f64
        if !kernel.f64 || variant.by_tile || !checked.insert((variant.atomics64, kernel.source())) {
            return;
        }
        let module = lowered(&kernel.source()).unwrap_or_else(|e| panic!("{} {variant:?}: {e}", kernel.name));
        let mut caps = allowed(kernel, variant).difference(Capabilities::FLOAT64);
        let reads_keys = variant.atomics64 && READS_KEYS.contains(&kernel.name);
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
            assert_eq!(global.name.as_deref(), Some(kernel.bindings[binding.binding as usize].name));
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
