//! Every pipeline and bind-group layout of every variant, built on a device without a driver that has the limits of a
//! small adapter and no feature that the variant does not ask for.

use anamorph::internals::engine::stage::{KernelId, Stages, all_kernels};
use anamorph::internals::gpu::buffers::Pipeline;
use anamorph::internals::gpu::device::AdapterFeatures;
use anamorph::internals::gpu::kernels::{Access, Binding, File, Files, Kernel, Variant, reached, storage_buffers};
use anamorph::internals::gpu::layout::{GROUP, LANES, TEXELS_A_ROW};
use anamorph::internals::gpu::needs::{NEEDS, STORAGE_BUFFERS, STORAGE_BUFFERS_BY_TILE, lacks};
use anamorph::internals::gpu::{Gpu, GpuOptions};
use anamorph::internals::image::frame::Channel;
use rayon::prelude::*;
use std::collections::HashSet;
use wgpu::Features;

/// wgpu's defaults (128 MiB bindings, 65,535 workgroups a side) and as many storage buffers as the kernels bind.
fn limits() -> wgpu::Limits {
    wgpu::Limits { max_storage_buffers_per_shader_stage: STORAGE_BUFFERS_BY_TILE, ..wgpu::Limits::defaults() }
}

/// A device on an adapter that has these features and limits and nothing else.
fn open(features: Features, limits: wgpu::Limits, options: &GpuOptions) -> anamorph::internals::input::Result<Gpu> {
    let noop =
        wgpu::NoopBackendOptions { enable: true, features: Some(features), limits: Some(limits), ..Default::default() };
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
        backends: wgpu::Backends::NOOP,
        backend_options: wgpu::BackendOptions { noop, ..Default::default() },
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    });
    let adapters = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::NOOP));
    Gpu::from_adapter(adapters.first().expect("the noop adapter"), options)
}

const F64: Features = Features::SHADER_F64.union(Features::SHADER_INT64);
const ATOMICS: Features = Features::SHADER_INT64_ATOMIC_MIN_MAX.union(Features::SHADER_INT64);

/// The fewest features with which each set of variants runs: with more, no kernel asks for more.
const FEWEST: [(Features, bool, bool); 4] =
    [(Features::empty(), false, false), (F64, true, false), (ATOMICS, false, true), (F64.union(ATOMICS), true, true)];

/// The sets of features that choose between the variants, the useless halves of them included.
fn feature_sets() -> [(Features, bool, bool); 8] {
    [
        (Features::empty(), false, false),
        (Features::SHADER_F64, false, false),
        (Features::SHADER_INT64, false, false),
        (Features::SHADER_INT64_ATOMIC_MIN_MAX, false, false),
        (F64, true, false),
        (ATOMICS, false, true),
        (F64.union(ATOMICS), true, true),
        (F64.union(ATOMICS).union(Features::TIMESTAMP_QUERY), true, true),
    ]
}

#[test]
fn adapter_features_follow_from_those_of_wgpu_and_ask_for_no_more() {
    for (features, f64, atomics64) in feature_sets() {
        let gpu = open(features, limits(), &GpuOptions::default()).unwrap();
        let has = AdapterFeatures::of(features, &gpu.info, &limits());
        assert_eq!((has.f64, has.atomics64), (f64, atomics64), "{features:?}");
        assert!(features.contains(has.features()), "{features:?}: asks for {:?}", has.features());
        // subgroups help where they are no narrower than a tile
        let lanes = |features, [subgroup_min_size, subgroup_max_size]: [u32; 2]| {
            let info = wgpu::AdapterInfo { subgroup_min_size, subgroup_max_size, ..gpu.info.clone() };
            let has = AdapterFeatures::of(features, &info, &limits());
            (has.lanes, has.wide)
        };
        let more = features.union(Features::SUBGROUP);
        let few = wgpu::Limits { max_storage_buffers_per_shader_stage: STORAGE_BUFFERS_BY_TILE - 1, ..limits() };
        let info = wgpu::AdapterInfo { subgroup_min_size: LANES, subgroup_max_size: LANES, ..gpu.info.clone() };
        assert!(!AdapterFeatures::of(more, &info, &few).lanes);
        assert_eq!(lanes(more, [LANES, LANES]), (true, false));
        assert_eq!(lanes(more, [LANES, 4 * LANES]), (true, true));
        assert_eq!(lanes(more, [4 * LANES, 4 * LANES]), (true, true));
        assert_eq!(lanes(more, [LANES / 2, LANES]), (false, false));
        assert_eq!(lanes(features, [LANES, LANES]), (false, false));
        assert_eq!(gpu.device.features(), has.features());
    }
    let all = open(Features::all(), limits(), &GpuOptions::default()).unwrap();
    assert!(!all.device.features().contains(Features::SHADER_INT64_ATOMIC_ALL_OPS));
}

#[test]
fn no_int64_leaves_the_64_bit_atomics_closed() {
    let options = GpuOptions { no_int64: true, ..Default::default() };
    let gpu = open(F64.union(ATOMICS), limits(), &options).unwrap();
    assert_eq!(gpu.device.features(), F64);
    assert!(gpu.has.f64 && !gpu.has.atomics64);
}

#[test]
fn every_pipeline_builds_with_the_features_of_its_variant_alone() {
    FEWEST.into_par_iter().for_each(|(features, f64, atomics64)| {
        let gpu = open(features, limits(), &GpuOptions::default()).unwrap();
        // f64 that the adapter has not is done in 32-bit words
        for variant in [true, f64].into_iter().flat_map(|f64| Variant::every(f64, atomics64)) {
            Stages::new(&gpu, variant, &Channel::every().collect::<Vec<_>>()).unwrap();
            gpu.failure().unwrap_or_else(|e| panic!("{features:?} {variant:?}: {e}"));
        }
    });
}

#[test]
fn a_variant_that_the_device_cannot_run_is_reported() {
    let gpu = open(Features::empty(), limits(), &GpuOptions::default()).unwrap();
    let built = Stages::new(&gpu, Variant::every(true, true)[0], &Channel::every().collect::<Vec<_>>());
    assert!(built.is_err() || gpu.failure().is_err());
}

/// A file of that text; tests may leak a few bytes.
fn file(path: &'static str, text: &str) -> &'static File {
    Box::leak(Box::new(File::new(path, text.to_string().leak())))
}

/// The error of a broken kernel, joined from a helper and the entry point, on a device that runs nothing.
fn fault(helper: &str, source: &str) -> String {
    let gpu = open(Features::empty(), limits(), &GpuOptions::default()).unwrap();
    // the compiler takes declarations in any order
    let source = format!("{source}#import shared/helper.wgsl\nvar<storage, read> given: array<u32>;\n");
    let files = Files::of(&[file("shared/helper.wgsl", helper), file("broken.wgsl", &source)]);
    let kernel = Kernel { name: "broken", ..Kernel::of(&files, "broken.wgsl", &|_| &[], &|_| None) };
    let _broken = Pipeline::new(&gpu, kernel).unwrap();
    gpu.failure().unwrap_err().to_string()
}

#[test]
fn errors_of_kernels_name_the_file_its_line_and_that_line() {
    let helper = |body: &str| format!("// A helper.\nfn helper() {{\n    {body}\n}}\n");
    let kernel = |body: &str| format!("@compute @workgroup_size(64)\nfn broken() {{\n    {body}\n}}\n");
    let (missing, stored) = ("let x = missing + 1u;", "given[0] = 1u;");
    let faults = [
        // what cannot be parsed, and what is not valid
        (fault(&helper("return;"), &kernel(missing)), "broken.wgsl:3:13", missing),
        (fault(&helper("return;"), &kernel(stored)), "broken.wgsl:3:5", stored),
        (fault(&helper(missing), &kernel("helper();")), "shared/helper.wgsl:3:13", missing),
        // of functions that are not valid the compiler names the first line
        (fault(&helper(stored), &kernel("helper();")), "shared/helper.wgsl:2:1", "fn helper() {"),
    ];
    for (text, place, line) in faults {
        assert!(text.contains(&format!("kernel broken, {place}: ")) && text.contains(&format!(": {line} (")), "{text}");
        assert!(text.contains("--dump-kernels DIR") && !text.contains('\n'), "{text}");
    }
    // a long line is cut
    let long = kernel(&format!("let x = missing + {}1u;", "1u + ".repeat(100)));
    assert!(fault("", &long).len() < 400, "{}", fault("", &long));
    // an error without a place in the source
    let text = fault("", "@compute @workgroup_size(64) fn other() {}\n");
    assert!(text.contains("kernel broken") && !text.contains('\n'), "{text}");
}

/// The errors of all kernels of a variant on a device with these features, with `from` of a file replaced.
fn planted(features: Features, f64: bool, name: &'static str, from: &str, to: &str) -> String {
    let mut gpu = open(features, limits(), &GpuOptions::default()).unwrap();
    let variant = Variant::every(f64, false)[0];
    let raster = KernelId::Raster.kernel(variant, &[]).unwrap();
    let there = raster.files.iter().find(|f| f.path == name).expect("a file of raster");
    assert!(there.text.contains(from), "{name} has no {from:?}");
    gpu.replaced = vec![file(name, &there.text.replacen(from, to, 1))];
    let _broken = Pipeline::new(&gpu, raster).unwrap();
    gpu.failure().unwrap_err().to_string()
}

#[test]
fn an_error_planted_in_a_file_is_found_there() {
    let (name, from) = ("rays/affine_bundle.wgsl", "fn size3(v: real3) -> real {");
    let text =
        std::fs::read_to_string(std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("wgsl").join(name)).unwrap();
    let line = 1 + text.lines().position(|l| l == from).expect("the line of size3");
    // f32; f64; and f64 in 32-bit words
    for (features, f64) in [(Features::empty(), false), (F64, true), (Features::empty(), true)] {
        let error = planted(features, f64, name, from, "fn size3(v: reel3) -> real {");
        assert!(error.contains(&format!("kernel raster, {name}:{line}:")) && error.contains("reel3"), "{error}");
    }
}

/// A file holds a kernel's source, and above the first line of each file a line with its path.
fn assert_labelled(text: &str, kernel: &Kernel) {
    let label =
        |line: &str| line.strip_prefix("// ").and_then(|l| l.strip_suffix(".wgsl:1")).map(|n| format!("{n}.wgsl"));
    let plain: String = text.lines().filter(|l| label(l).is_none()).map(|l| format!("{l}\n")).collect();
    assert!(plain.starts_with(&kernel.source()));
    assert!(text.lines().filter_map(label).eq(kernel.files.iter().map(|f| f.path)));
    // the n-th line after a label is the file's n-th: a binding with its number, or once declared a comment; an import as a comment
    for file in &kernel.files {
        let (_, after) = text.split_once(&format!("// {}:1\n", file.path)).expect("a label");
        for (line, own) in after.lines().zip(file.text.lines()) {
            let is_again = || line.strip_prefix("// ").is_some_and(|name| own.contains(&format!("{name}: ")));
            assert!(line == own || line.ends_with(own) || is_again(), "{}: {line}", file.path);
        }
    }
}

#[test]
fn kernels_are_written_as_they_are_compiled() {
    let folder = tempfile::tempdir().unwrap();
    let into = folder.path().join("new");
    let options = GpuOptions { dump_kernels: Some(into.clone()), ..Default::default() };
    let gpu = open(Features::empty(), limits(), &options).unwrap();
    let variants = Variant::every(false, false);
    let planes: Vec<Channel> = Channel::every().collect();
    for variant in [variants[0], variants[0], variants[2]] {
        Stages::new(&gpu, variant, &planes).unwrap();
    }
    let text = |name: &str| std::fs::read_to_string(into.join(name)).unwrap();
    let [first, second] = [variants[0], variants[2]].map(|variant| KernelId::Raster.kernel(variant, &planes).unwrap());
    assert!(first.source() != second.source() && text("raster.wgsl").contains("// override COUNTING = 0"));
    for (file, kernel) in [("raster.wgsl", first), ("raster-2.wgsl", second)] {
        assert_labelled(&text(file), &kernel);
    }
    assert!(!into.join("raster-3.wgsl").exists() && !into.join("args-2.wgsl").exists());
    // a folder that cannot be made
    let options = GpuOptions { dump_kernels: Some(into.join("raster.wgsl")), ..Default::default() };
    let error = open(Features::empty(), limits(), &options).err().expect("an error");
    assert!(error.exit_code() == 1 && error.to_string().contains("raster.wgsl"), "{error}");
}

#[test]
fn a_kernel_with_more_storage_buffers_than_there_are_is_an_error_that_names_it() {
    let few = |most| wgpu::Limits { max_storage_buffers_per_shader_stage: most, ..limits() };
    let gpu = open(Features::empty(), few(STORAGE_BUFFERS), &GpuOptions::default()).unwrap();
    let bounce = all_kernels(Variant::every(false, false).into_iter().find(|v| v.bounces_rays()).unwrap(), &[]);
    let refused = Pipeline::new(&gpu, bounce.into_iter().find(|k| k.name == "bounce").unwrap());
    let error = refused.err().expect("an error").to_string();
    assert!(error.contains("kernel bounce needs 10 storage buffers, there are 8") && !error.contains('\n'), "{error}");
    // others compile as before
    let plain = all_kernels(Variant::every(false, false).into_iter().find(|v| !v.bounces_rays()).unwrap(), &[]);
    Pipeline::new(&gpu, plain.into_iter().find(|k| k.name == "cull").unwrap()).unwrap();
    gpu.failure().unwrap();
}

/// Kernels of scenes without optics, samples, caustics and the channel `certified`, pair by pair.
fn plain_kernels(f64: bool, atomics64: bool) -> Vec<Kernel> {
    let channels: Vec<Channel> = Channel::every().filter(|c| *c != Channel::Certified).collect();
    let plain = Variant::every(f64, atomics64).into_iter().filter(|v| v.rays.optics.is_none() && !v.samples_edges());
    plain.flat_map(|v| all_kernels(v, &channels)).filter(|k| k.name != "gather").collect()
}

/// What a kernel binds.
fn bound(kernel: &Kernel) -> Vec<(u32, Binding)> {
    reached(&naga::front::wgsl::parse_str(&kernel.source()).unwrap(), &kernel.bindings())
}

#[test]
fn plain_scenes_take_what_is_said_and_webgpu_has_it_by_default() {
    let kernels = plain_kernels(true, true);
    let mut seen = HashSet::new();
    let distinct: Vec<&Kernel> = kernels.iter().filter(|k| seen.insert(k.source())).collect();
    let lists: Vec<Vec<(u32, Binding)>> = distinct.par_iter().map(|kernel| bound(kernel)).collect();
    let most = |of: fn(&Binding) -> bool| {
        lists.iter().map(|list| list.iter().filter(|(_, b)| of(b)).count() as u32).max().unwrap()
    };
    let taken = [
        most(|b| matches!(b.access, Access::Read | Access::Write)),
        most(|b| b.access == Access::Uniform),
        most(|b| b.access == Access::Texels),
        most(|b| b.access == Access::WriteTexels),
        GROUP,
        TEXELS_A_ROW,
    ];
    assert_eq!(NEEDS.map(|need| need.needed), taken);
    let defaults = wgpu::Limits::defaults();
    assert!(NEEDS.iter().all(|need| need.needed <= (need.allowed)(&defaults)));
    assert!(lacks(&defaults).is_none());
    // what has no row: memory of workgroups, and structs in uniform buffers, which are small
    for kernel in distinct {
        let module = naga::front::wgsl::parse_str(&kernel.source()).unwrap();
        for (_, global) in module.global_variables.iter() {
            assert_ne!(global.space, naga::AddressSpace::WorkGroup, "{}", kernel.name);
            let bytes = u64::from(module.types[global.ty].inner.size(module.to_ctx()));
            let is_large =
                global.space == naga::AddressSpace::Uniform && bytes > defaults.max_uniform_buffer_binding_size;
            assert!(!is_large, "{}: {bytes} bytes", kernel.name);
        }
        assert!((kernel.bindings().len() as u32) < defaults.max_bindings_per_bind_group);
    }
}

/// By wgpu's own checks; f64 that the adapter has not is done in 32-bit words.
#[test]
fn kernels_of_plain_scenes_compile_with_the_default_limits_of_webgpu() {
    let sets = [(Features::empty(), false), (F64, false), (ATOMICS, true), (F64.union(ATOMICS), true)];
    sets.into_par_iter().for_each(|(features, atomics64)| {
        let gpu = open(features, wgpu::Limits::defaults(), &GpuOptions::default()).unwrap();
        plain_kernels(true, atomics64).into_iter().for_each(|kernel| drop(Pipeline::new(&gpu, kernel).unwrap()));
        gpu.failure().unwrap_or_else(|e| panic!("{features:?}: {e}"));
    });
}

#[test]
fn an_adapter_with_less_is_an_error_that_names_it() {
    let less: [fn(&mut wgpu::Limits); NEEDS.len()] = [
        |l| l.max_storage_buffers_per_shader_stage = 7,
        |l| l.max_uniform_buffers_per_shader_stage = 1,
        |l| l.max_sampled_textures_per_shader_stage = 2,
        |l| l.max_storage_textures_per_shader_stage = 0,
        |l| l.max_compute_workgroup_size_x = 32,
        |l| l.max_texture_dimension_2d = 2048,
    ];
    for (need, less) in NEEDS.iter().zip(less) {
        let mut few = limits();
        less(&mut few);
        let error = open(Features::empty(), few.clone(), &GpuOptions::default()).err().expect("an error").to_string();
        let says =
            format!("(noop): {} {}, {} needed; use --engine reference", (need.allowed)(&few), need.what, need.needed);
        assert!(error.starts_with("adapter ") && error.ends_with(&says), "{error}");
    }
}

#[test]
fn raster_by_tile_binds_as_many_storage_buffers_as_is_said() {
    let by_tile = Variant::every(true, true).into_iter().flat_map(|v| [vec![v], v.by_each_tile_path()].concat());
    let kernels = by_tile.flat_map(|v| all_kernels(v, &Channel::every().collect::<Vec<_>>()));
    let most = kernels.filter(|k| k.name != "gather").map(|k| storage_buffers(&bound(&k))).max();
    assert_eq!(most, Some(STORAGE_BUFFERS_BY_TILE));
}
