//! Chains as a scene file gives them: layers of mesh cameras.

use crate::common;

use anamorph::internals::camera::{Camera, Rays};
use common::continuity::{assert_joined, assert_seamless};
use common::file::{camera_of, refusal};
use glam::DVec3;

const SIZE: (u32, u32) = (40, 30);

/// A layer of two triangles over the image between planes z = near and z = far, which are `scale` wide and high.
fn layer([near, far]: [(f64, f64); 2]) -> String {
    let vertex = |a: f64, b: f64| {
        let point = |(z, scale): (f64, f64)| format!("[{}, {}, {z}]", scale * (a - 0.5), scale * (0.5 - b));
        format!("{{ image = [{a}, {b}], near = {}, far = {} }}", point(near), point(far))
    };
    let vertices = [vertex(0., 0.), vertex(1., 0.), vertex(0., 1.), vertex(1., 1.)].join(", ");
    format!("{{ vertices = [{vertices}], triangles = [[0, 1, 2], [1, 3, 2]] }}")
}

fn chain(layers: &[String]) -> String {
    format!("kind = \"chain\"\nlayers = [{}]", layers.join(", "))
}

fn camera(layers: &[String]) -> Camera {
    camera_of("", SIZE, &chain(layers)).unwrap()
}

#[test]
fn layers_are_run_through_one_after_the_other() {
    // opens to z = -1, runs straight to z = -2, closes to half as wide
    let faces = [(0.0, 2.0), (-1.0, 4.0), (-2.0, 4.0), (-3.0, 2.0)];
    let layers: Vec<String> = faces.windows(2).map(|f| layer([f[0], f[1]])).collect();
    let camera = camera(&layers);
    assert_eq!((camera.layers.len(), camera.piece_count(), camera.t_range), (3, 6, [0.0, 1.0]));
    assert!(camera.notes.is_empty(), "{:?}", camera.notes);
    for (layer, face) in faces.windows(2).enumerate() {
        for (i, j) in [(0, 0), (39, 0), (13, 22), (39, 29)] {
            let (piece, curve) = camera.curve(layer, i, j).unwrap();
            assert_eq!(piece as usize / 2, layer);
            let (x, y) = ((i as f64 + 0.5) / 40.0 - 0.5, 0.5 - (j as f64 + 0.5) / 30.0);
            for (t, (z, scale)) in [(0.0, face[0]), (1.0, face[1])] {
                // sums of a few numbers up to 4
                assert!((curve.at(t) - DVec3::new(scale * x, scale * y, z)).length() < 1e-14);
            }
        }
    }
    assert_eq!(assert_joined(&camera, 1), 3 * 2 * 40 * 30);
    assert_eq!(assert_seamless(&camera, 2), 3);
}

#[test]
fn a_gap_between_layers_is_noted_with_its_size() {
    let (front, back) = (layer([(0.0, 2.0), (-1.0, 2.0)]), layer([(-1.25, 2.0), (-2.0, 2.0)]));
    let camera = camera(&[front, back]);
    assert_eq!(camera.notes[..], ["layer 1 does not start where layer 0 ends: up to 0.250000 apart, at pixel 0,0"]);
}

#[test]
fn a_pixel_outside_a_layer_has_no_ray_there() {
    let half =
        r#"{ vertices = [{ image = [0, 0], near = [0, 0, 0], far = [0, 0, -1] }, { image = [1, 0], near = [1, 0, 0],
        far = [1, 0, -1] }, { image = [0, 1], near = [0, 1, 0], far = [0, 1, -1] }], triangles = [[0, 1, 2]] }"#
            .replace('\n', " ");
    let camera = camera(&[half, layer([(-1.0, 2.0), (-2.0, 2.0)])]);
    assert!(camera.pixel(0, 0, 0).is_some() && camera.pixel(0, 39, 29).is_none());
    assert_eq!(camera.pixel(1, 39, 29).map(|(piece, _)| piece), Some(2));
}

#[test]
fn sixteen_layers_are_the_most() {
    let one = layer([(0.0, 2.0), (-1.0, 2.0)]);
    assert_eq!(camera(&vec![one.clone(); 16]).layers.len(), 16);
    assert!(refusal("", SIZE, &chain(&vec![one; 17])).contains("camera.layers: 17 layers; a chain has 1 to 16"));
    assert!(refusal("", SIZE, &chain(&[])).contains("camera.layers: 0 layers"));
}

#[test]
fn errors_name_the_layer_and_its_key() {
    let good = layer([(0.0, 2.0), (-1.0, 2.0)]);
    let of = |bad: &str| refusal("", SIZE, &chain(&[good.clone(), bad.into()]));
    assert!(of("{ vertices = [], triangles = [] }").contains("camera.layers.1.triangles: the camera has no pieces"));
    assert!(of("{ vertices = [], triangels = [] }").contains("nearest known key: \"triangles\""));
    assert!(
        of(&good.replace("[1, 3, 2]", "[1, 3, 9]")).contains("camera.layers.1: triangles.1: vertex 9 does not exist")
    );
    assert!(of(&good.replace("[1, 3, 2]", "[1, 3, 0]")).contains("camera.layers.1.triangles: 0 and 1 overlap"));
    assert!(of("3").contains("camera.layers.1: expected a table"));
    let of_kind = |kind: &str| of(&good.replacen('{', &format!("{{ kind = {kind},"), 1));
    let says = "camera.layers.1.kind: a layer of a chain is a mesh camera; write kind = \"mesh\", or leave it out";
    assert!(of_kind("\"glc\"").contains(says) && of_kind("3").contains(says));
    assert!(refusal("", SIZE, "kind = \"chain\"").contains("layers is missing"));
    assert!(refusal("", SIZE, "kind = \"chain\"\nlayers = []\nt_range = [0, 1]").contains("unknown key \"t_range\""));
}

#[test]
fn layers_are_of_pieces() {
    let plain = layer([(0.0, 2.0), (-1.0, 2.0)]);
    let kind = plain.replacen('{', "{ kind = \"mesh\",", 1);
    for one in [plain, kind] {
        assert!(matches!(camera(&[one]).layers[..], [Rays::Pieces(_)]));
    }
}
