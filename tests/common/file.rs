//! Scenes written as a user writes them.

use anamorph::internals::camera::Camera;
use anamorph::internals::input::{Loading, Result};
use anamorph::internals::scene::Scene;

/// The scene of a TOML text.
pub fn load(text: &str) -> Result<Scene> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, text).unwrap();
    Scene::load(&path, &[], 0.0, &Loading::default())
}

/// A scene of `meshes` ([[mesh]] tables) in an image of a size, with a camera of these keys.
pub fn scene_of(meshes: &str, (width, height): (u32, u32), camera: &str) -> Result<Scene> {
    load(&format!("image = {{ width = {width}, height = {height} }}\n{meshes}\n[camera]\n{camera}\n"))
}

/// The camera of these keys.
pub fn camera_of(meshes: &str, size: (u32, u32), camera: &str) -> Result<Camera> {
    scene_of(meshes, size, camera)?.camera()
}

/// The message of the one-line error that the camera is refused with.
pub fn refusal(meshes: &str, size: (u32, u32), camera: &str) -> String {
    let error = camera_of(meshes, size, camera).expect_err(camera);
    assert_eq!(error.exit_code(), 2);
    let text = error.to_string();
    assert!(!text.contains('\n'), "{text}");
    text
}
