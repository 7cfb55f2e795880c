//! Every example of the gallery, small: the engine's picture is right, and shows something.

mod common;

use anamorph::internals::image::frame::Channel;
use anamorph::internals::input::Loading;
use anamorph::internals::scene::Scene;
use anamorph_lab::gallery::gallery;
use common::gpu::check;

/// Pixels across; the height follows each scene's own shape.
const WIDTH: u32 = 80;
/// Of all pixels, those that show the scene at least; the emptiest picture (smoke) has 0.34.
const LEAST_SHARE: f64 = 0.33;

#[test]
#[ignore = "slow: make test-all"]
fn every_picture_of_the_gallery_is_right_and_not_empty() {
    let folder = tempfile::tempdir().unwrap();
    for example in gallery() {
        let path = example.write(folder.path()).unwrap();
        let (width, height) = Scene::load(&path, &[], 0.0, &Loading::default()).unwrap().size.unwrap();
        let small = [format!("image.width={WIDTH}"), format!("image.height={}", height * WIDTH / width)];
        let scene = Scene::load(&path, &small, 0.0, &Loading::default()).unwrap();
        let camera = scene.camera().unwrap();
        let Some((frame, judged, _)) = check(example.name, &scene, &camera) else { return };
        let pixels = f64::from(camera.width * camera.height);
        // of a surface or of a volume
        let shown = frame.f32(Channel::A).unwrap().iter().filter(|&&a| a > 0.0).count() as f64 / pixels;
        assert!(shown >= LEAST_SHARE, "{}: {shown} of the picture shows the scene", example.name);
        let safe = judged.safe.iter().filter(|&&safe| safe).count() as f64 / pixels;
        println!("{}: {:.3} of the pixels covered, {:.3} safe", example.name, shown, safe);
    }
}
