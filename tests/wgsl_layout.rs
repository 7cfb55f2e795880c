//! The structs that the host writes are the structs that the kernels read: every struct of `wgsl/shared/params.wgsl`,
//! `shading.wgsl` and `beams.wgsl` against its twin in `src/gpu/layout.rs`, field by field, and every constant against its own.

use anamorph::internals::engine::clusters::CORNER_ORDERS;
use anamorph::internals::gpu::kernels::{Kernel, Variant};
use anamorph::internals::gpu::layout::{self, Counter};
use anamorph::internals::image::frame::Channel;
use naga::{Expression, Literal, Module, ScalarKind, Statement, SwitchValue, TypeInner};
use std::collections::BTreeMap;

const PARAMS: &str = include_str!("../wgsl/shared/params.wgsl");
const SHADING: &str = include_str!("../wgsl/shading/numbers.wgsl");
const MATERIAL: &str = include_str!("../wgsl/shading/materials/material.wgsl");
const STYLE: &str = include_str!("../wgsl/shading/styles/layout.wgsl");
const SEGMENT: &str = include_str!("../wgsl/hierarchy/segment.wgsl");
const BEAMS: &str = include_str!("../wgsl/project/beams.wgsl");
const PROJECT: &str = include_str!("../wgsl/project/layout.wgsl");
const GRADIENTS: &str = include_str!("../wgsl/gradients/layout.wgsl");
const OPTICS: &str = include_str!("../wgsl/optics/layout.wgsl");
const CAUSTICS: &str = include_str!("../wgsl/caustics/layout.wgsl");
const VOLUME: &str = include_str!("../wgsl/volume/layout.wgsl");
const RIVALS: &str = include_str!("../lab/wgsl/rivals/layout.wgsl");
const LAYOUT: &str = include_str!("../src/gpu/layout.rs");

/// One field as bytes: name, offset, size, kind of its numbers.
#[derive(Debug, Clone, PartialEq)]
struct Field {
    name: String,
    offset: usize,
    size: usize,
    kind: ScalarKind,
}

/// Structs by name: size and fields in order.
type Layouts = BTreeMap<String, (usize, Vec<Field>)>;

/// The numbers of a field's type.
trait Scalar {
    const KIND: ScalarKind;
}

impl Scalar for u32 {
    const KIND: ScalarKind = ScalarKind::Uint;
}

impl Scalar for f32 {
    const KIND: ScalarKind = ScalarKind::Float;
}

impl Scalar for i32 {
    const KIND: ScalarKind = ScalarKind::Sint;
}

impl<T: Scalar, const N: usize> Scalar for [T; N] {
    const KIND: ScalarKind = T::KIND;
}

fn field<S, T: Scalar>(name: &str, offset: usize, _: fn(&S) -> &T) -> Field {
    Field { name: name.into(), offset, size: size_of::<T>(), kind: T::KIND }
}

/// The layout of a struct of `layout`; a field that is left out does not compile.
macro_rules! layout {
    ($name:ident $body:tt) => { layout!(layout, $name $body) };
    ($layout:ident, $name:ident { $($field:ident),* $(,)? }) => {{
        let every_field = |value: $layout::$name| {
            let $layout::$name { $($field: _),* } = value;
        };
        let _ = every_field;
        let fields = vec![$(field(stringify!($field), std::mem::offset_of!($layout::$name, $field), |r: &$layout::$name| &r.$field)),*];
        (stringify!($name).to_string(), (size_of::<$layout::$name>(), fields))
    }};
}

fn rivals() -> Layouts {
    use anamorph_lab::rivals::layout as own;
    Layouts::from([
        layout!(own, Outline { a, b, c, is_whole, layer }),
        layout!(own, Cube { eye, side, right, pad0, up, pad1, forward, pad2 }),
        layout!(own, Splat { side, first, slots, pad0 }),
        layout!(own, Cone { eye, first, axis, count, angle, pad0, pad1, pad2 }),
    ])
}

fn host() -> Layouts {
    Layouts::from([
        layout!(Params {
            width,
            height,
            tiles_x,
            tiles_y,
            levels,
            cluster_first,
            cluster_count,
            id_bits,
            queue_capacity,
            work_capacity,
            pair_capacity,
            slab_rows,
            id_first,
            id_count,
            band_row,
            spans,
            recheck_capacity,
            origin_error,
            task_capacity,
            edge_capacity,
            scene_size,
            raster_budget,
            steps,
            sample,
            t_min,
            t_max,
            t_words,
            level_start,
            level_width,
            level_height,
            bvh_offset,
            surface_rows,
        }),
        layout!(Step { value }),
        layout!(ViewerPose { numbers, eye, ray_count, right, numbers_a_ray, up, node_count, forward, perturb }),
        layout!(Cluster { centre, first, half, count }),
        layout!(Node { p, r_p, px, r_d, py, rays, d, width, dx, piece, dy, pad2 }),
        layout!(Cell { p, h, d, piece, tile, mask_lo, mask_hi, node }),
        layout!(Piece {
            p_hi,
            h_hi,
            px_hi,
            hx_hi,
            py_hi,
            hy_hi,
            d_hi,
            origin_x,
            dx_hi,
            origin_y,
            dy_hi,
            number,
            p_lo,
            h_lo,
            px_lo,
            hx_lo,
            py_lo,
            hy_lo,
            d_lo,
            pad1,
            dx_lo,
            pad2,
            dy_lo,
            pad3,
        }),
        layout!(SampleOffsets { at }),
        layout!(Chunk { points, beams, slots, most, t_min, t_max, pad0, pad1 }),
        layout!(Beam { p_lo, next, p_hi, node, d_lo, pad0, d_hi, pad1 }),
        layout!(SolveParams { points, slots, images_most, pad0, t_min, t_max, width, height }),
        layout!(SolvePiece {
            p0,
            flags,
            p1,
            h1,
            p2,
            h2,
            d0,
            half_px,
            d1,
            beyond,
            d2,
            reach,
            anchor_hi,
            base_x,
            anchor_lo,
            base_y,
            corners_01,
            corners_23,
            edges
        }),
        layout!(SolveCell {
            terms,
            anchor_hi,
            base_x,
            anchor_lo,
            base_y,
            errors,
            end,
            size,
            flags,
            middle,
            pad0,
            pad1,
            pad2
        }),
        layout!(SolvePoint { hi, is_near, lo, pad0 }),
        layout!(SolveImage { point, piece, x_px, y_px, t, error_px, error_t, pixel }),
        layout!(Optic {
            eye_hi,
            first_id,
            eye_lo,
            count,
            tint,
            bounces,
            base,
            ends,
            ior_hi,
            ior_lo,
            sees_itself,
            piece_first,
            tilt_x_hi,
            tilt_x_lo,
            tilt_y_hi,
            tilt_y_lo,
            fresnel,
            branch,
            scale,
            colour_only,
            from_hi,
            is_environment,
            from_lo,
            law,
            box_centre,
            scene_size,
            box_half,
            pad0,
        }),
        layout!(AtlasLayout { side, columns, width, texel_count }),
        layout!(PathState { light, length, first, last, piece, pad0 }),
        layout!(Corner { p_hi, piece, p_lo, piece_u, n_hi, piece_v, n_lo, pad0 }),
        layout!(Quadric {
            centre_hi,
            c_hi,
            centre_lo,
            c_lo,
            diagonal_hi,
            low_hi,
            diagonal_lo,
            low_lo,
            beside_hi,
            high_hi,
            beside_lo,
            high_lo,
            b_hi,
            rim2_hi,
            b_lo,
            rim2_lo,
            axis_hi,
            pad0,
            axis_lo,
            pad1,
        }),
        layout!(Torus { centre_hi, size_hi, centre_lo, size_lo, axis_hi, ring_hi, axis_lo, ring_lo }),
        layout!(Wave {
            centre_hi,
            half_hi,
            centre_lo,
            half_lo,
            amplitude_hi,
            amplitude_lo,
            frequency_hi,
            frequency_lo,
        }),
        layout!(GradientParams { width, rows, first, pixels, directions, pixel_first, pad0, pad1 }),
        layout!(DepositParams { count, texels, pad0, pad1 }),
        layout!(CausticTriangle { a, b, c, receiver, pad0, flux, pad1 }),
        layout!(Receiver { columns, rows, first, scale }),
        layout!(ReceiverTriangle { a, ab, ac, receiver, pad0, diffuse, pad1 }),
        layout!(Medium {
            x_hi,
            x0_hi,
            x_lo,
            x0_lo,
            y_hi,
            y0_hi,
            y_lo,
            y0_lo,
            z_hi,
            z0_hi,
            z_lo,
            z0_lo,
            last,
            layers,
            corner_rate,
            value_error,
            place_error,
            headlight,
            point,
            slope,
            value,
        }),
        layout!(Shading {
            background,
            ambient,
            anchor,
            light_count,
            gain,
            curve,
            filter_width,
            shadow_bvh_scale,
            sky,
            sky_strength,
            sky_rotation,
            sky_is_seen,
            occlusion_rays,
            occlusion_reach,
            nodes_first,
            leaves_first,
            pictures_first,
            picture_count,
            masks_first,
            pad0,
            irradiance
        }),
        layout!(Material {
            diffuse,
            texture,
            origin,
            size,
            page,
            levels,
            span,
            cutoff,
            specular,
            alpha,
            emissive,
            metallic,
            pattern_light,
            pattern,
            pattern_dark,
            pattern_size,
            opacity,
            is_blended,
            pad0,
            pad1,
        }),
        layout!(Style {
            wire,
            wire_width,
            ink,
            hatch_spacing,
            paper,
            wire_depth,
            outline,
            outline_width,
            border,
            border_width,
            crease_cosine,
            outline_depth,
            jump_sine,
            pad0,
        }),
        layout!(BvhNode { lo, first, hi, count }),
        layout!(LeafTriangle { v0, id, v1, one_sided, v2, is_round }),
    ])
}

/// Of a kernel, or of a file that names nothing of those that it imports.
fn parse(source: &str) -> Module {
    let source: String = source.lines().filter(|l| !l.starts_with('#')).map(|l| format!("{l}\n")).collect();
    naga::front::wgsl::parse_str(&source).unwrap_or_else(|e| panic!("{}", e.emit_to_string(&source)))
}

fn wgsl(source: &str) -> Layouts {
    let module = parse(source);
    let kind = |inner: &TypeInner| {
        let mut inner = inner;
        while let TypeInner::Array { base, .. } = inner {
            inner = &module.types[*base].inner;
        }
        inner.scalar_kind().expect("structs hold numbers only")
    };
    let mut layouts = Layouts::new();
    for (_, ty) in module.types.iter() {
        let TypeInner::Struct { members, span } = &ty.inner else { continue };
        let fields = members.iter().map(|m| {
            let inner = &module.types[m.ty].inner;
            let size = inner.size(module.to_ctx()) as usize;
            Field { name: m.name.clone().unwrap(), offset: m.offset as usize, size, kind: kind(inner) }
        });
        layouts.insert(ty.name.clone().unwrap(), (*span as usize, fields.collect()));
    }
    layouts
}

/// Whole-number constants by name.
type Constants = BTreeMap<String, u32>;

fn wgsl_constants(source: &str) -> Constants {
    let module = parse(source);
    let value = |e| match module.global_expressions[e] {
        Expression::Literal(Literal::U32(v)) => Some(v),
        // tested in camera/perturb.rs
        Expression::Literal(Literal::F32(_)) => None,
        ref other => panic!("not a literal of u32 or f32: {other:?}"),
    };
    module.constants.iter().filter_map(|(_, c)| Some((c.name.clone().unwrap(), value(c.init)?))).collect()
}

/// The names of the u32 constants that a Rust source makes public.
fn rust_constants(source: &str) -> Vec<&str> {
    let rest = source.lines().filter_map(|l| l.strip_prefix("pub const "));
    rest.filter_map(|l| l.split_once(": u32")).map(|(name, _)| name).collect()
}

macro_rules! constants {
    ($($name:ident),* $(,)?) => { Constants::from([$((stringify!($name).to_string(), layout::$name)),*]) };
}

fn host_constants() -> Constants {
    let mut constants = constants![
        GROUP,
        BRANCH,
        CLUSTER,
        TRIANGLE_GROUP,
        NONE,
        PROVEN,
        RAYS_NONE,
        RAYS_LOOSE,
        RAYS_AFFINE,
        RAYS_DISCONTINUOUS,
        LEVEL_CELL,
        LANES,
        CULL_COST,
        TASK_COST,
        LARGE_COST,
        PAIR_COST,
        COUNTERS,
        TEXELS_A_ROW,
        LAW_NORMALS,
        LAW_FLAT,
    ];
    constants.insert("TILE".into(), anamorph::internals::camera::TILE);
    constants.extend(Counter::ALL.iter().map(|c| (c.name().to_uppercase(), c.index())));
    constants
}

/// Constants of `layout` that the kernels declare in another file than `params.wgsl`, or in another form.
const DECLARED_ELSEWHERE: [&str; 8] =
    ["CULL_QUEUES", "ID_BITS_MAX", "ID_MASK", "ORDER_SHIFT", "ONE_SIDED", "SPHERE", "CAPSULE", "ROUND"];

/// What two maps do not agree on, one line each, missing keys on either side included.
fn differences<V: PartialEq + std::fmt::Debug>(a: &BTreeMap<String, V>, b: &BTreeMap<String, V>) -> Vec<String> {
    let keys: std::collections::BTreeSet<&String> = a.keys().chain(b.keys()).collect();
    let differ = keys.into_iter().filter(|&k| a.get(k) != b.get(k));
    differ.map(|k| format!("{k}: {:?} against {:?}", a.get(k), b.get(k))).collect()
}

#[test]
fn every_struct_is_the_same_bytes_on_both_sides() {
    let mut kernels = wgsl(PARAMS);
    kernels.extend(wgsl(SHADING));
    kernels.extend(wgsl(MATERIAL));
    kernels.extend(wgsl(STYLE));
    // results and traversal state belong to the kernels alone
    kernels.extend(
        wgsl(&format!("{PARAMS}{SEGMENT}")).into_iter().filter(|(name, _)| name == "BvhNode" || name == "LeafTriangle"),
    );
    kernels.extend(wgsl(BEAMS));
    kernels.extend(wgsl(PROJECT));
    kernels.extend(wgsl(GRADIENTS));
    kernels.extend(wgsl(OPTICS));
    kernels.extend(wgsl(CAUSTICS));
    kernels.extend(wgsl(VOLUME));
    assert_eq!(differences(&host(), &kernels), [""; 0]);
    assert_eq!(differences(&rivals(), &wgsl(RIVALS)), [""; 0]);
}

#[test]
fn every_constant_has_the_same_value_on_both_sides() {
    let kernels = [wgsl_constants(PARAMS), wgsl_constants(OPTICS)].into_iter().flatten().collect();
    assert_eq!(differences(&host_constants(), &kernels), [""; 0]);
    let known = host_constants();
    let forgotten: Vec<&str> = rust_constants(LAYOUT)
        .into_iter()
        .filter(|name| !known.contains_key(*name) && !DECLARED_ELSEWHERE.contains(name))
        .collect();
    assert_eq!(forgotten, [""; 0], "constants of layout.rs that params.wgsl does not have");
}

/// The constants of a kernel that say where planes are: name and default.
fn plane_overrides(kernel: &Kernel) -> Vec<(String, u32)> {
    let module = parse(&kernel.source());
    let value = |e| match module.global_expressions[e] {
        Expression::Literal(Literal::U32(v)) => v,
        ref other => panic!("not a literal of u32: {other:?}"),
    };
    let named = module.overrides.iter().map(|(_, o)| (o.name.clone().unwrap(), o.init));
    named.filter(|(name, _)| name.starts_with("PLANE_")).map(|(name, init)| (name, value(init.unwrap()))).collect()
}

fn plane_constants(kernel: &Kernel) -> Vec<(&'static str, f64)> {
    kernel.constants.iter().copied().filter(|c| c.0.starts_with("PLANE_")).collect()
}

#[test]
fn every_channel_has_an_override_that_defaults_to_no_plane() {
    let all: Vec<Channel> = Channel::every().filter(|c| c.is_rendered()).collect();
    let name = |channel: &Channel| format!("PLANE_{}", channel.name().replace('.', "_").to_uppercase());
    let expected: Vec<(String, u32)> = all.iter().map(|channel| (name(channel), layout::NONE)).collect();
    let of = |planes: &[Channel]| {
        [
            Kernel::new("shade.wgsl", Variant::plain(false, false), planes),
            Kernel::new("certify.wgsl", Variant::plain(false, false), planes),
            Kernel::new("gather.wgsl", Variant::plain(false, false), planes),
            Kernel::new("outline.wgsl", Variant::plain(false, false), planes),
            Kernel::new("write.wgsl", Variant::plain(false, false), planes),
        ]
    };
    for kernel in of(&all) {
        assert_eq!(plane_overrides(&kernel), expected, "{}", kernel.name);
        let places: Vec<f64> = plane_constants(&kernel).iter().map(|c| c.1).collect();
        assert_eq!(places, (0..all.len()).map(|k| k as f64).collect::<Vec<_>>(), "{}", kernel.name);
    }
    for channel in all {
        for kernel in of(&[channel]) {
            assert_eq!(plane_constants(&kernel), [(name(&channel).as_str(), 0.0)], "{}", kernel.name);
        }
    }
}

#[test]
fn the_last_word_of_a_triangle_has_equal_fields() {
    let raster = Kernel::new("raster.wgsl", Variant::plain(false, false), &[]).source();
    let module = parse(&raster);
    let constant = |name: &str| {
        let (_, c) = module.constants.iter().find(|(_, c)| c.name.as_deref() == Some(name)).unwrap();
        module.global_expressions[c.init].clone()
    };
    let is = |name: &str, value: u32| matches!(constant(name), Expression::Literal(Literal::U32(v)) if v == value);
    assert!(is("ID_MASK", layout::ID_MASK));
    assert!(is("ONE_SIDED", layout::ONE_SIDED));
    assert_eq!(layout::ORDER_SHIFT, layout::ID_BITS_MAX);
    assert!(raster.contains(&format!("(triangle.w >> {}u) & 7u", layout::ORDER_SHIFT)));
    const { assert!(layout::ONE_SIDED >> layout::ORDER_SHIFT > 7, "the order's three bits end below the side's") };
}

/// The vectors that `corner_order` of `source` returns, by case; the default last.
fn corner_orders(source: &str) -> Vec<[usize; 3]> {
    let module = parse(source);
    let (_, function) = module.functions.iter().find(|(_, f)| f.name.as_deref() == Some("corner_order")).unwrap();
    let number = |e| match function.expressions[e] {
        Expression::Literal(Literal::U32(v)) => v as usize,
        ref other => panic!("not a literal: {other:?}"),
    };
    let cases = function.body.iter().find_map(|s| match s {
        Statement::Switch { cases, .. } => Some(cases),
        _ => None,
    });
    let cases = cases.unwrap().iter().enumerate().map(|(k, case)| {
        let expected = if k < 5 { SwitchValue::U32(k as u32) } else { SwitchValue::Default };
        assert_eq!(case.value, expected);
        let value = case.body.iter().find_map(|s| match s {
            Statement::Return { value } => *value,
            _ => None,
        });
        match &function.expressions[value.unwrap()] {
            Expression::Compose { components, .. } => [0, 1, 2].map(|c| number(components[c])),
            other => panic!("not a vector: {other:?}"),
        }
    });
    cases.collect()
}

#[test]
fn the_six_corner_orders_are_the_same_table() {
    let source = Kernel::new("raster.wgsl", Variant::plain(false, false), &[]).source();
    let shade = Kernel::new("shade.wgsl", Variant::plain(false, false), &Channel::ALL).source();
    assert_eq!((corner_orders(&source), corner_orders(&shade)), (CORNER_ORDERS.to_vec(), CORNER_ORDERS.to_vec()));
    let planted = source.replace("vec3<u32>(2u, 0u, 1u)", "vec3<u32>(0u, 2u, 1u)");
    assert_ne!(corner_orders(&planted), CORNER_ORDERS);
}

/// A change to one side that must be reported, by the struct that it touches.
const PLANTED: [(&str, &str, &str); 7] = [
    (
        "Params",
        "    queue_capacity: u32,    // items\n    work_capacity: u32,",
        "    work_capacity: u32,\n    queue_capacity: u32,",
    ),
    ("Params", "origin_error: f32", "origin_error: u32"),
    ("Cluster", "    half: vec3<f32>,\n    count: u32,", "    half: vec3<f32>,"),
    ("Cluster", "centre: vec3<f32>", "middle: vec3<f32>"),
    ("Cell", "    tile: u32,", "    tile: u32,\n    more: u32,"),
    ("Node", "struct Node {", "struct Node {\n    first: u32,"),
    ("Extra", "struct Step {", "struct Extra { a: u32 }\nstruct Step {"),
];

#[test]
fn a_planted_difference_in_a_struct_is_seen() {
    let mut host = host();
    host.retain(|name, _| wgsl(PARAMS).contains_key(name));
    assert_eq!(differences(&host, &wgsl(PARAMS)), [""; 0]);
    for (name, from, to) in PLANTED {
        assert!(PARAMS.contains(from), "{from:?} is no longer there to be changed");
        let seen = differences(&host, &wgsl(&PARAMS.replacen(from, to, 1)));
        assert_eq!(seen.len(), 1, "{to:?}: {seen:?}");
        assert!(seen[0].starts_with(&format!("{name}: ")), "{to:?}: {seen:?}");
    }
    let gone = host.remove("Step");
    assert!(gone.is_some() && differences(&host, &wgsl(PARAMS)) != [""; 0], "a struct that the host lacks");
}

#[test]
fn a_planted_difference_in_a_constant_is_seen() {
    for (from, to) in [
        ("COUNT_PAIRS: u32 = 9u", "COUNT_PAIRS: u32 = 8u"),
        ("const CLUSTER: u32 = 64u;", ""),
        ("const NONE", "const MORE: u32 = 1u;\nconst NONE"),
    ] {
        assert!(PARAMS.contains(from), "{from:?} is no longer there to be changed");
        let kernels = [wgsl_constants(&PARAMS.replacen(from, to, 1)), wgsl_constants(OPTICS)];
        let kernels = kernels.into_iter().flatten().collect();
        assert_eq!(differences(&host_constants(), &kernels).len(), 1, "{to:?}");
    }
    assert_eq!(rust_constants("pub const A: u32 = 1;\nconst B: u32 = 2;\npub const C: u64 = 3;"), ["A"]);
}
