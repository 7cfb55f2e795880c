//! What an adapter has, or loses, changes no pixel and hides no failure.

use crate::common;

use anamorph::internals::camera::Rays;
use anamorph::internals::engine::plan::Wanted;
use anamorph::internals::engine::{Engine, RunOptions};
use anamorph::internals::gpu::{Gpu, GpuOptions};
use anamorph::internals::image::compare::compare;
use anamorph::internals::image::frame::{Channel, Frame};
use anamorph::internals::reference::image::judge;
use common::any::any;
use common::gpu::engine_on;
use common::needs::{own_adapter, skip};
use common::rng::Rng;
use std::path::Path;
use std::process::{Command, Output};

const SIZE: (u32, u32) = (40, 30);

/// Scenes of every kind, by their numbers.
const SCENES: std::ops::Range<u64> = 0..60;

/// The frames of all scenes; without f64 of its own an adapter leaves out certificates and all cameras but one kind, whose kernels
/// with f64 in words a software adapter takes long to compile.
fn frames(engine: &mut Engine) -> Vec<Option<Frame>> {
    let channels = if engine.gpu.has.f64 { Channel::every().collect() } else { Channel::ALL.to_vec() };
    let wanted = Wanted::of(channels);
    let frame = |number| {
        let (scene, camera) = any(&mut Rng(number), SIZE);
        let is_seen = engine.gpu.has.f64 || (camera.layers.len() == 1 && matches!(camera.layers[0], Rays::Pieces(_)));
        is_seen.then(|| engine.render(&scene, &camera, &wanted, &RunOptions::default()).unwrap().frame)
    };
    SCENES.map(frame).collect()
}

/// Every plane that both have, as words.
fn differs(a: &Frame, b: &Frame) -> bool {
    let channels = Channel::ALL.iter();
    channels.into_iter().any(|c| match (a.u32(*c), b.u32(*c)) {
        (Some(a), Some(b)) => a != b,
        _ => {
            a.f32(*c).map(|v| v.iter().map(|x| x.to_bits()).collect::<Vec<_>>())
                != b.f32(*c).map(|v| v.iter().map(|x| x.to_bits()).collect::<Vec<_>>())
        }
    })
}

/// Takes something from an adapter.
type Less = fn(&mut Gpu);

/// Depths that pairs and tiles may find of the same hit: f64 rounding of other sums, of which f32 keeps half a unit, and a step of
/// what the key keeps.
const DEPTH_UNITS: u32 = 2;

/// Depths of tiles and of pairs are the same within [`DEPTH_UNITS`]; so is all else where the triangle is, and another one is as near.
fn differs_beyond_rounding(a: &Frame, b: &Frame) -> bool {
    let depths = [Channel::T, Channel::Z];
    let bits = |f: &Frame, c: Channel| f.f32(c).map(|v| v.iter().map(|x| x.to_bits()).collect::<Vec<_>>());
    let near = |a: &[u32], b: &[u32]| a.iter().zip(b).all(|(a, b)| a.abs_diff(*b) <= DEPTH_UNITS);
    let [ids, other_ids] = [a, b].map(|f| f.u32(Channel::TriangleId).unwrap());
    let same_triangles = |a: &[u32], b: &[u32]| (0..ids.len()).all(|k| ids[k] != other_ids[k] || a[k] == b[k]);
    !Channel::ALL.into_iter().all(|c| match (bits(a, c), bits(b, c)) {
        (Some(a), Some(b)) if depths.contains(&c) => near(&a, &b),
        (Some(a), Some(b)) => same_triangles(&a, &b),
        _ => a.u32(c).zip(b.u32(c)).is_none_or(|(a, b)| same_triangles(a, b)),
    })
}

/// Another triangle at a pixel of a scene whose answer does not change nearby.
fn differs_where_safe(number: u64, a: &Frame, b: &Frame) -> bool {
    let (scene, camera) = any(&mut Rng(number), SIZE);
    let safe = judge(&scene, &camera, a).safe;
    compare(a, b, Some(&safe), None).unwrap().wrong_safe != Some(0)
}

/// Raster goes pair by pair or tile by tile.
#[test]
#[ignore = "slow: make test-all"]
fn frames_are_the_same_by_tile_and_by_pair() {
    let (Some(mut by_tile), Some(mut by_pair)) =
        (engine_on(|gpu| gpu.has.by_pair = false), engine_on(|gpu| gpu.has.lanes = false))
    else {
        return;
    };
    if !by_tile.gpu.has.lanes {
        return skip("subgroups are not as wide as a tile");
    }
    for (number, (a, b)) in SCENES.zip(frames(&mut by_tile).iter().zip(&frames(&mut by_pair))) {
        let (Some(a), Some(b)) = (a, b) else { continue };
        assert!(!differs_beyond_rounding(a, b), "scene {number}");
    }
}

/// None, but on a CPU the count of a loop's rounds: lavapipe loses pixels without.
fn unchecked(gpu: &Gpu) -> wgpu::ShaderRuntimeChecks {
    let force_loop_bounding = gpu.has.software;
    wgpu::ShaderRuntimeChecks { force_loop_bounding, ..wgpu::ShaderRuntimeChecks::unchecked() }
}

/// With and without 64-bit atomics, f64, subgroups as wide as a tile, and the checks that wgpu adds to kernels.
#[test]
#[ignore = "slow: make test-all"]
fn frames_are_the_same_whatever_the_adapter_has() {
    let less: [(&str, Less); 9] = [
        // lanes may be a part of a subgroup, though here they are all of it
        ("subgroups of a known width", |gpu| gpu.has.wide = true),
        ("being a CPU", |gpu| gpu.has.software = false),
        ("tiles", |gpu| gpu.has.by_pair = true),
        ("64-bit atomics, by tile", |gpu| gpu.has.atomics64 = false),
        ("64-bit atomics", |gpu| (gpu.has.lanes, gpu.has.atomics64) = (false, false)),
        ("f64", |gpu| gpu.has.f64 = false),
        // SAFETY: what the kernels read and write is what this very test compares with checked ones
        ("checks by pair", |gpu| unsafe {
            gpu.has.lanes = false;
            gpu.with_checks(unchecked(gpu));
        }),
        // SAFETY: the same
        ("checks by tile", |gpu| unsafe { gpu.with_checks(unchecked(gpu)) }),
        // SAFETY: all checks there are
        ("loops without a count of their rounds", |gpu| unsafe {
            gpu.with_checks(wgpu::ShaderRuntimeChecks::checked())
        }),
    ];
    let (Some(mut by_tile), Some(mut by_pair)) =
        (engine_on(|gpu| gpu.has.by_pair = false), engine_on(|gpu| gpu.has.lanes = false))
    else {
        return;
    };
    let whole = [frames(&mut by_pair), frames(&mut by_tile)];
    for (what, less) in less {
        let Some(mut engine) = engine_on(less) else { return };
        let has = engine.gpu.has;
        // where raster bounds t, recheck finds it as raster does pair by pair
        let expected = &whole[usize::from(has.by_tile() && has.f64 && has.software && has.atomics64)];
        for (number, (frame, expected)) in SCENES.zip(frames(&mut engine).iter().zip(expected)) {
            let (Some(frame), Some(expected)) = (frame, expected) else { continue };
            // an adapter's own f64 may take sums and products in another order
            let same = match engine.gpu.has.f64 {
                true => !differs(frame, expected),
                false => !differs_where_safe(number, frame, expected),
            };
            assert!(same, "scene {number} without {what}");
        }
    }
}

/// WebGPU's default limits: as many storage buffers as plain scenes bind, and bindings of 128 MiB.
#[test]
fn plain_frames_are_the_same_with_the_default_limits_of_webgpu() {
    let small = engine_on(|gpu| (gpu.has.lanes, gpu.limits) = (false, wgpu::Limits::defaults()));
    let (Some(mut small), Some(mut whole)) = (small, engine_on(|gpu| gpu.has.lanes = false)) else { return };
    let wanted = Wanted { srgb8: true, ..Wanted::of(Channel::ALL.to_vec()) };
    for number in SCENES {
        let (scene, camera) = any(&mut Rng(number), SIZE);
        let frame = |engine: &mut Engine| engine.render(&scene, &camera, &wanted, &RunOptions::default()).unwrap();
        let (a, b) = (frame(&mut small), frame(&mut whole));
        assert!(!differs(&a.frame, &b.frame) && a.srgb8 == b.srgb8, "scene {number}");
    }
}

/// With wgpu's own check of indirect dispatches, without which kernels cannot ask for the number of workgroups on DirectX 12.
#[test]
fn frames_are_the_same_with_checked_dispatches() {
    let by_pair = |gpu: &mut Gpu| gpu.has.lanes = false;
    let Some(mut plain) = engine_on(by_pair) else { return };
    let backends = wgpu::Backends::from(plain.gpu.info.backend);
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
        backends,
        flags: wgpu::InstanceFlags::VALIDATION_INDIRECT_CALL,
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    });
    let adapters = pollster::block_on(instance.enumerate_adapters(backends));
    let adapter = adapters.iter().find(|a| a.get_info() == plain.gpu.info).expect("the same adapter");
    let mut gpu = Gpu::from_adapter(adapter, &GpuOptions::default()).unwrap();
    by_pair(&mut gpu);
    let (plain, checked) = (frames(&mut plain), frames(&mut Engine::new(gpu)));
    for (number, (plain, checked)) in SCENES.zip(plain.iter().zip(&checked)) {
        let (Some(plain), Some(checked)) = (plain, checked) else { continue };
        assert!(!differs(plain, checked), "scene {number}");
    }
}

/// A device that is lost is an error, once and for every frame after; another device goes on.
#[test]
fn a_lost_device_is_an_error_and_another_goes_on() {
    let Some(mut engine) = own_adapter().map(Engine::new) else { return };
    let (scene, camera) = any(&mut Rng(1), SIZE);
    let wanted = Wanted { srgb8: true, ..Wanted::of(vec![Channel::TriangleId]) };
    let render = |engine: &mut Engine| engine.render(&scene, &camera, &wanted, &RunOptions::default());
    let before = render(&mut engine).unwrap();
    engine.gpu.device.destroy();
    for _ in 0..2 {
        let text = match render(&mut engine) {
            Err(e) => e.to_string(),
            Ok(_) => panic!("a frame from a device that is gone"),
        };
        assert!(text.contains("adapter") && !text.contains('\n'), "{text}");
    }
    let Some(mut other) = engine_on(|_| {}) else { return };
    let after = render(&mut other).unwrap();
    assert!(before.frame == after.frame && before.srgb8 == after.srgb8);
}

/// Tests open adapters only by the functions that report a missing one.
#[test]
fn only_one_file_opens_adapters() {
    let mut folders = vec![Path::new(env!("CARGO_MANIFEST_DIR")).join("tests")];
    while let Some(folder) = folders.pop() {
        for path in std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()) {
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            if path.extension().is_none_or(|e| e != "rs") {
                continue;
            }
            let text = std::fs::read_to_string(&path).unwrap();
            let opens = ["Gpu", "Engine"].iter().any(|name| text.contains(&format!("{name}::open(")));
            assert_eq!(opens, path.ends_with("common/needs.rs"), "{}", path.display());
        }
    }
}

/// Runs one test of this program in an environment without a driver.
#[cfg(target_os = "linux")]
#[test]
fn without_an_adapter_tests_are_skipped_or_fail() {
    let name = "adapters::a_lost_device_is_an_error_and_another_goes_on";
    let run = |needed: Option<(&str, &str)>| {
        let mut command = Command::new(std::env::current_exe().unwrap());
        command.args(["--exact", name, "--test-threads", "2"]).env_remove("CI").env_remove("ANAMORPH_REQUIRE_ADAPTER");
        command.env("VK_DRIVER_FILES", "/nonexistent").env("VK_ICD_FILENAMES", "/nonexistent").envs(needed);
        let Output { status, stdout, stderr } = command.output().unwrap();
        let [out, err] = [stdout, stderr].map(|bytes| String::from_utf8(bytes).unwrap());
        assert!(out.contains("running 1 test"), "{out}");
        (status.success(), out + &err)
    };
    for needed in [None, Some(("CI", "false")), Some(("ANAMORPH_REQUIRE_ADAPTER", ""))] {
        let (passed, printed) = run(needed);
        let lines =
            [format!("skipped: {name}: no Vulkan adapter found"), "tests skipped for lack of an adapter: 1".into()];
        assert!(
            passed && lines.iter().all(|line| printed.lines().any(|l| l.starts_with(line))),
            "{needed:?}: {printed}"
        );
    }
    for needed in [("CI", "true"), ("ANAMORPH_REQUIRE_ADAPTER", "1")] {
        let (passed, printed) = run(Some(needed));
        assert!(
            !passed && printed.contains("no Vulkan adapter found") && !printed.contains("skipped"),
            "{needed:?}: {printed}"
        );
    }
}

/// Memory that the device does not have is an error of the frame, in a line that says so.
#[test]
fn what_an_adapter_cannot_hold_is_an_error() {
    let Some(mut engine) = engine_on(|gpu| gpu.limits.max_buffer_size = 1 << 12) else { return };
    let (scene, camera) = any(&mut Rng(1), (400, 300));
    let wanted = Wanted { srgb8: true, ..Wanted::of(vec![Channel::TriangleId]) };
    match engine.render(&scene, &camera, &wanted, &RunOptions::default()) {
        Err(e) => assert!(e.to_string().contains("bytes") && !e.to_string().contains('\n'), "{e}"),
        Ok(_) => panic!("a frame of buffers that do not fit"),
    }
}
