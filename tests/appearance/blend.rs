//! Blended surfaces: what each sample sees, against the reference through every kind of rays; and the mean of all samples, against the product
//! of opacities.

use crate::common::gpu::{Without, check, hits, ids, render, render_with};
use crate::common::layered::chain;
use crate::common::{cameras::MeshShape, file::camera_of, mesh, scene};
use crate::textures::{families, masked_shapes};
use anamorph::internals::camera::Camera;
use anamorph::internals::camera::exposure::Sample;
use anamorph::internals::engine::RunOptions;
use anamorph::internals::engine::plan::samples::sample_offsets;
use anamorph::internals::geometry::mesh::{Material, NO_UV};
use anamorph::internals::image::frame::Channel;
use anamorph::internals::input::Loading;
use anamorph::internals::scene::Scene;
use glam::DVec3;
use std::path::Path;
use std::sync::Arc;

/// The cameras of all samples of a pixel.
fn of_samples(camera: &Camera, count: u32) -> impl Iterator<Item = Camera> {
    let offsets = (0..count).zip(sample_offsets(count));
    offsets.map(move |(number, offset)| camera.of_sample(offset.into(), Sample { number, count }).unwrap())
}

/// Triangles of two blended materials, one with an image, and a few triangles without texture coordinates.
fn blended_shapes() -> Scene {
    let mut scene = masked_shapes();
    let mesh = Arc::make_mut(&mut scene.mesh);
    (mesh.materials[0].blend, mesh.materials[1].blend) = (Some(0.8), Some(0.4));
    scene
}

#[test]
fn each_sample_sees_the_reference_s_triangles() {
    let scene = blended_shapes();
    const SMALL: (u32, u32) = (48, 36);
    let chain = chain(3, 3, (4, 3), MeshShape::default(), SMALL);
    for (name, camera) in families(SMALL).into_iter().chain([("chain", chain)]) {
        let Some(center) = render(&scene, &camera) else { return };
        // a pixel's center sees what is at least half opaque: the image's rings, and none of the other material
        assert!(ids(&center).iter().all(|id| scene.mesh.material_of.get(*id as usize) != Some(&1)), "{name}");
        let mut others = 0;
        for (k, sample) in of_samples(&camera, 3).enumerate() {
            let (frame, ..) = check(&format!("{name}, sample {k}"), &scene, &sample).unwrap();
            others += ids(&frame).iter().zip(ids(&center)).filter(|(a, b)| a != b).count();
            if k == 1 {
                let less = render_with(&scene, &sample, Without::Int64Atomics, &RunOptions::default()).unwrap();
                assert!(ids(&less.frame) == ids(&frame), "{name} in two dispatches");
            }
        }
        assert!(others > hits(&center) / 2, "{name}: {others} pixels of samples differ from the center's");
    }
}

/// Squares one behind another that shine in red, green and blue.
fn panes(opacities: [f32; 3]) -> Scene {
    let square = |z: f64| [(-9.0, -9.0), (9.0, -9.0), (9.0, 9.0), (-9.0, 9.0)].map(|(x, y)| DVec3::new(x, y, z));
    let corners = |first: u32| [[0, 1, 2], [0, 2, 3]].map(|t| t.map(|k| first + k));
    let mut all = mesh([0.0, -1.0, -2.0].map(square).concat(), [0, 4, 8].map(corners).concat());
    let shining = |k: usize| {
        let mut emissive = [0.0; 3];
        emissive[k] = 1.0;
        Material { diffuse: [0.0; 3], emissive, blend: Some(opacities[k]), ..Material::default() }
    };
    all.materials = (0..3).map(shining).collect();
    all.material_of = vec![0, 0, 1, 1, 2, 2];
    all.corner_uvs = vec![[NO_UV; 3]; 6];
    Scene { background: [0.0; 3], ..scene(all) }
}

/// The mean color of an image over so many samples.
fn mean(scene: &Scene, camera: &Camera, count: u32) -> Option<[f64; 3]> {
    let mut sum = [0.0; 3];
    for sample in of_samples(camera, count) {
        let frame = render(scene, &sample)?;
        for (sum, channel) in sum.iter_mut().zip([Channel::R, Channel::G, Channel::B]) {
            *sum += frame.f32(channel).unwrap().iter().map(|v| f64::from(*v)).sum::<f64>();
        }
    }
    let all = f64::from(camera.width) * f64::from(camera.height) * f64::from(count);
    Some(sum.map(|sum| sum / all))
}

#[test]
fn the_mean_of_all_samples_is_blended_from_front_to_back() {
    let size = (40, 30);
    let camera = camera_of("", size, "kind = \"pinhole\"\neye = [0, 0, 5]\ntarget = [0, 0, 0]\nvfov = 60").unwrap();
    for opacities in [[0.25, 0.5, 0.75], [0.5, 0.5, 1.0]] {
        let Some(seen) = mean(&panes(opacities), &camera, 16) else { return };
        let [a, b, c] = opacities.map(f64::from);
        // of one pixel the standard deviation of 16 samples is at most that of independent ones, 1/8; six of the mean of 1,200 pixels
        let most = 6.0 / 8.0 / 1200.0_f64.sqrt();
        for (seen, right) in [(seen[0], a), (seen[1], (1.0 - a) * b), (seen[2], (1.0 - a) * (1.0 - b) * c)] {
            assert!((seen - right).abs() < most, "{seen} instead of {right}, at most {most} off");
        }
    }
}

/// Files with opacities: read with the key `blend`, and without it.
#[test]
fn files_are_blended_where_the_scene_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let load = |file: &str, keys: &str| {
        let path = folder.path().join("s.toml");
        let camera = "[camera]\nkind = \"pinhole\"\neye = [0, 0, 5]\ntarget = [0, 0, 0]\nvfov = 60\n";
        std::fs::write(&path, format!("[image]\nwidth = 8\nheight = 8\n[[mesh]]\nfile = \"{file}\"\n{keys}\n{camera}"))
            .unwrap();
        Scene::load(&path, &[], 0.0, &Loading::default()).unwrap()
    };
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    let told = |scene: &Scene| scene.mesh.missing.iter().map(|m| format!("{}: {}", m.what, m.why)).collect::<Vec<_>>();

    write(
        "m.mtl",
        "newmtl glass\nKd 1 0 0\nd 0.3\nnewmtl wall\nd 1\nnewmtl fog\nTr 0.25\nnewmtl both\nd 0.5\nTr 0.5\nnewmtl halo\nd -halo 0.6\n",
    );
    let faces = ["glass", "wall", "fog", "both", "halo"].map(|name| format!("usemtl {name}\nf 1 2 3\n")).concat();
    write("a.obj", &format!("mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n{faces}"));
    let of_faces = |scene: &Scene| -> Vec<Option<f32>> {
        scene.mesh.material_of.iter().map(|m| scene.mesh.materials[*m as usize].blend).collect()
    };
    let plain = load("a.obj", "");
    assert_eq!(of_faces(&plain), [None; 5]);
    assert_eq!(told(&plain).len(), 4, "{:?}", told(&plain));
    assert!(told(&plain)[0].ends_with("m.mtl:3: its opacity is 0.3; it is drawn opaque without blend = true"));
    let blended = load("a.obj", "blend = true");
    assert_eq!(of_faces(&blended), [Some(0.3), None, Some(0.75), Some(0.5), Some(0.6)]);
    assert_eq!(told(&blended), [""; 0]);

    write_gltf(folder.path());
    let plain = load("a.gltf", "");
    assert_eq!(of_faces(&plain), [None; 2]);
    let told_of = told(&plain);
    assert!(
        told_of.len() == 1 && told_of[0].contains("its opacity is 0.75; it is drawn opaque without"),
        "{told_of:?}"
    );
    // the second triangle's corners have opacities of 1, 0 and 1/5
    let blended = load("a.gltf", "blend = true");
    assert_eq!(of_faces(&blended), [Some(0.75), Some(0.75 * 102.0 / 255.0)]);
    assert_eq!(told(&blended), [""; 0]);
    // a picture that lies on a mesh without a file's opacity
    let white = image::RgbaImage::from_pixel(1, 1, image::Rgba([255, 255, 255, 128]));
    white.save(folder.path().join("t.png")).unwrap();
    let pictured = load("a.gltf", "texture = \"t.png\"\nblend = true");
    let material = &pictured.mesh.materials[0];
    assert_eq!((material.blend, material.texture.as_ref().unwrap().cutoff), (Some(1.0), Some(0.5)));
}

/// Two triangles of a material of the mode `BLEND` and an opacity of 0.75, with colors and texture coordinates.
fn write_gltf(folder: &Path) {
    let mut bytes = Vec::new();
    let positions = [[0.0f32, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    [positions, positions].concat().iter().flatten().for_each(|v| bytes.extend(v.to_le_bytes()));
    [1.0f32, 1.0, 1.0, 1.0, 0.0, 0.2]
        .iter()
        .for_each(|a| [1.0, 1.0, 1.0, *a].iter().for_each(|v| bytes.extend(v.to_le_bytes())));
    [0.5f32; 12].iter().for_each(|v| bytes.extend(v.to_le_bytes()));
    std::fs::write(folder.join("a.bin"), &bytes).unwrap();
    let accessor = |view: u32, kind: &str| serde_json::json!({"bufferView": view, "componentType": 5126, "count": 6, "type": kind, "min": [0, 0, 0], "max": [1, 1, 0]});
    let mut accessors = [accessor(0, "VEC3"), accessor(1, "VEC4"), accessor(2, "VEC2")];
    accessors[1..]
        .iter_mut()
        .for_each(|a| ["min", "max"].iter().for_each(|k| drop(a.as_object_mut().unwrap().remove(*k))));
    let json = serde_json::json!({
        "asset": {"version": "2.0"},
        "buffers": [{"uri": "a.bin", "byteLength": 216}],
        "bufferViews": [{"buffer": 0, "byteLength": 72}, {"buffer": 0, "byteOffset": 72, "byteLength": 96}, {"buffer": 0, "byteOffset": 168, "byteLength": 48}],
        "accessors": accessors,
        "materials": [{"alphaMode": "BLEND", "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.75]}}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "COLOR_0": 1, "TEXCOORD_0": 2}, "material": 0}]}],
        "nodes": [{"mesh": 0}],
    });
    std::fs::write(folder.join("a.gltf"), json.to_string()).unwrap();
}
