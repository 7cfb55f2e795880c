//! Files of 1 GiB that their first bytes and their length refuse. With no memory granted, reading the rest would be refused for the memory
//! that it takes, so each error here tells that the rest was not read. The files are sparse: they take no disk.

use anamorph::{Limits, Scene};
use std::fs;
use std::path::Path;

const LENGTH: u64 = 1 << 30;

/// Writes a file of [`LENGTH`] bytes that begins so; `false` where the file system would store its zeros.
#[cfg(unix)]
fn write_sparse(path: &Path, start: &[u8]) -> bool {
    use std::os::unix::fs::MetadataExt;
    fs::write(path, start).unwrap();
    let file = fs::OpenOptions::new().write(true).open(path).unwrap();
    file.set_len(LENGTH).unwrap();
    // blocks of 512 bytes
    file.metadata().unwrap().blocks() * 512 < LENGTH / 2
}

#[cfg(not(unix))]
fn write_sparse(_: &Path, _: &[u8]) -> bool {
    false
}

/// The start of an array of NumPy's.
fn npy(kind: &str, shape: &str) -> Vec<u8> {
    let header = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}\n");
    [b"\x93NUMPY\x01\x00", &(header.len() as u16).to_le_bytes()[..], header.as_bytes()].concat()
}

/// The error of a scene of these keys, with an image, and with a pinhole camera unless the keys begin with a camera.
fn error_of(keys: &str, folder: &Path) -> String {
    let camera = "camera = { kind = 'pinhole', eye = [0, 0, 4], target = [0, 0, 0], vfov = 40 }\n";
    let camera = if keys.starts_with("camera") { "" } else { camera };
    let text = format!("image = {{ width = 8, height = 6 }}\n{camera}{keys}");
    let scene = Scene::parse_within(&text, folder, Limits::default().memory(0));
    scene.and_then(|scene| scene.camera()).map(drop).expect_err(keys).to_string()
}

/// Checks the errors of files. Each has a name, its first bytes, the keys that name it as `FILE`, and a part of the error.
fn check(cases: Vec<(&str, Vec<u8>, &str, &str)>) {
    let folder = tempfile::tempdir().unwrap();
    for (file, start, keys, says) in cases {
        let path = folder.path().join(file);
        if !write_sparse(&path, &start) {
            return println!("skipped: the file system has no sparse files");
        }
        let error = error_of(&keys.replace("FILE", &format!("file = '{file}'")), folder.path());
        assert!(error.contains(says) && !error.contains('\n') && error.len() < 600, "{file}: {error}");
        fs::remove_file(path).unwrap();
    }
}

#[test]
fn meshes_are_refused_by_their_start_and_length() {
    let mesh = "mesh = [{ FILE }]";
    let glb = |length: u32, rest: &[u8]| [b"glTF\x02\0\0\0", &length.to_le_bytes()[..], rest].concat();
    let ply = b"ply\nformat binary_little_endian 1.0\nelement vertex 100000000\nproperty float x\nproperty float y\n\
                property float z\nelement face 100\nproperty list uchar int vertex_indices\nend_header\n";
    let text_ply = b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 0 0\n";
    let stl = [&[b' '; 80][..], &30_000_000u32.to_le_bytes()].concat();
    check(vec![
        ("zeros.obj", vec![], mesh, "is binary, not OBJ text"),
        ("zeros.ply", vec![], mesh, "is no PLY file"),
        ("zeros.stl", vec![], mesh, "has no triangles"),
        ("zeros.off", vec![], mesh, "has zero bytes in its text"),
        ("zeros.dae", vec![], mesh, "is neither UTF-8 nor UTF-16 text"),
        ("zeros.gltf", vec![], mesh, "is not glTF 2.0: expected value"),
        ("zeros.glb", vec![], mesh, "is not glTF 2.0: expected value"),
        ("zeros.png", vec![], mesh, "is no PNG that can be read"),
        ("zeros.tif", vec![], mesh, "is no TIFF that can be read"),
        ("zeros.asc", vec![], mesh, "line 1: expected a key and its number"),
        ("some.obj", b"v 0 0 0\n".to_vec(), mesh, "is binary, not OBJ text"),
        ("long.ply", ply.to_vec(), mesh, "its header says 100000000 vertexs, in a file of 1073741824 bytes"),
        ("some.ply", text_ply.to_vec(), mesh, "has zero bytes in its text"),
        ("some.off", b"OFF\n3 1 0\n0 0 0\n".to_vec(), mesh, "has zero bytes in its text"),
        ("long.stl", stl, mesh, "30000000 triangles by its header, 21474834 in the file"),
        ("solid.stl", b"solid a\nfacet normal 0 0 1\n".to_vec(), mesh, "has no triangles"),
        ("long.asc", b"ncols 10000\nnrows 10000\n1 2".to_vec(), mesh, "ends early: the header says 10000 x 10000"),
        ("end.gltf", b"{\"asset\": {\"version\": \"2.0\"}}".to_vec(), mesh, "is not glTF 2.0: trailing characters"),
        ("end.glb", glb(1 << 30, b"\0\0\0\x20JSON{}"), mesh, "is not glTF 2.0: trailing characters"),
        ("long.glb", glb(1 << 31, b""), mesh, "GLB is cut short"),
    ]);
}

#[test]
fn points_volumes_and_images_are_refused_by_their_start_and_length() {
    let spheres = "spheres = [{ FILE, radius = 1 }]";
    let colors = "spheres = [{ centers = [[0, 0, 0]], radius = 1, colors = 'colors.npy' }]";
    let volume = "volume = { FILE, min = [0, 0, 0], max = [1, 1, 1], transfer = [[0, 0, 0, 0, 0], [1, 1, 1, 1, 10]] }";
    let raw = &*volume.replace("FILE", "FILE, type = 'f32', shape = [4, 4, 4]");
    let sky = "environment = { FILE }";
    let nrrd = "NRRD0004\ntype: float\ndimension: 3\nsizes: 800 800 800\nencoding: raw\nendian: little\n\n";
    let meta = "NDims = 3\nDimSize = 800 800 800\nElementType = MET_FLOAT\nElementDataFile = LOCAL\n";
    let ends = "the file ends early";
    check(vec![
        ("zeros.npy", vec![], spheres, "this is not a .npy file"),
        ("zeros.ply", vec![], spheres, "is no PLY file"),
        ("zeros.csv", vec![], spheres, "is no UTF-8 text"),
        ("some.xyz", b"1 2 3\n".to_vec(), spheres, "is no UTF-8 text"),
        ("colors.npy", npy("<f8", "(60000000, 3)"), colors, ends),
        ("many.npy", npy("<f8", "(30000000, 4)"), spheres, "30000000 spheres takes about"),
        ("zeros.raw", vec![], raw, "the file has 1073741824 bytes; 4 x 4 x 4 numbers of 4 are 256"),
        ("zeros.nrrd", vec![], volume, "the header is over 65536 bytes"),
        ("long.nrrd", nrrd.into(), volume, ends),
        ("zip.nrrd", nrrd.replace("raw", "gzip").into(), volume, "of memory"),
        ("long.mha", meta.into(), volume, ends),
        ("long.npy", npy("<f4", "(800, 800, 800)"), volume, ends),
        ("zeros.png", vec![], sky, "is no PNG, JPEG or HDR"),
        ("zeros.hdr", vec![], sky, "is no PNG, JPEG or HDR"),
        ("zeros.tga", vec![], sky, "is no PNG, JPEG or HDR"),
    ]);
}

#[test]
fn files_of_cameras_are_refused_by_their_start_and_length() {
    let pose = "eye = [0, 0, 4], target = [0, 0, 0]";
    let posed = |keys: &str| format!("camera = {{ {keys}, {pose} }}");
    let mask = format!(
        "camera = {{ kind = 'composite', cameras = [{{ region = {{ kind = 'mask', FILE }}, \
         camera = {{ kind = 'pinhole', vfov = 40, {pose} }} }}] }}"
    );
    let raymap = "camera = { kind = 'raymap', origins = 'P.npy', directions = 'P.npy' }";
    let poses = "camera = { kind = 'pinhole', vfov = 40, poses = 'poses.txt' }";
    let display = "camera = { kind = 'display', eye = [0, 0, 4], mesh = 'screen.obj' }";
    let places = "mesh = [{ builtin = 'box', places = 'places.json' }]";
    check(vec![
        ("zeros.yaml", vec![], &posed("kind = 'calibrated', FILE"), "it is no text"),
        ("zeros.yml", vec![], &posed("kind = 'opencv', FILE"), "it has a zero byte"),
        ("poses.txt", b"1 0 0 0 0 1 0 0 0 0 1 0\n".to_vec(), poses, "it has a zero byte"),
        ("places.json", vec![], places, "it has a zero byte"),
        ("P.npy", npy("<f4", "(8000, 16000, 3)"), raymap, "the file ends early"),
        ("P.npy", npy("<f4", "(6, 8, 3)"), raymap, "an array of 144 numbers"),
        ("rays.npy", npy("<f8", "(20000000, 6)"), "camera = { kind = 'lidar', FILE }", "an array of 120000000 numbers"),
        ("screen.obj", vec![], display, "is binary, not OBJ text"),
        ("mask.png", vec![], &mask, "is no PNG, JPEG or HDR"),
    ]);
}

#[test]
fn a_scene_file_and_files_of_meshes_are_refused_by_their_start_and_length() {
    let folder = tempfile::tempdir().unwrap();
    let [scene, gltf] = ["scene.toml", "a.gltf"].map(|name| folder.path().join(name));
    let is_sparse = |name: &str| write_sparse(&folder.path().join(name), b"newmtl a\n");
    if !write_sparse(&scene, b"[image]\n") || !is_sparse("a.bin") || !is_sparse("a.mtl") {
        return println!("skipped: the file system has no sparse files");
    }
    let error = Scene::load_within(&scene, &[], 0.0, Limits::default().memory(0)).map(drop).unwrap_err().to_string();
    assert!(error.contains("it has a zero byte"), "{error}");
    let text = r#"{"asset": {"version": "2.0"}, "buffers": [{"uri": "a.bin", "byteLength": 2147483648}]}"#;
    fs::write(gltf, text).unwrap();
    let error = error_of("mesh = [{ file = 'a.gltf' }]", folder.path());
    assert!(error.contains("buffer 0: has 1073741824 of its 2147483648 bytes"), "{error}");
    fs::write(folder.path().join("a.obj"), "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    let error = error_of("mesh = [{ file = 'a.obj' }]", folder.path());
    assert!(error.contains("a.mtl: has zero bytes in its text"), "{error}");
}
