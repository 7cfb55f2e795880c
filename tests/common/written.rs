//! Cameras as a person writes them: the text of a scene file's `[camera]`.

use anamorph::internals::camera::Camera;
use anamorph::internals::input::{Loading, Result};
use anamorph::internals::scene::Scene;
use std::path::Path;

/// The camera of a `[camera]` table for an image of `size`, its files in `folder`.
pub fn camera_in(folder: &Path, table: &str, size: Option<(u32, u32)>) -> Result<Camera> {
    let path = folder.join("written.toml");
    std::fs::write(&path, format!("[camera]\n{table}\n")).unwrap();
    let scene = Scene::load(&path, &[], 0.0, &Loading::default())?;
    Camera::in_scene(&scene.camera, size.or(scene.size), &scene.mesh, &Loading::default())
}

/// The camera of a `[camera]` table without files.
pub fn try_camera(table: &str, size: (u32, u32)) -> Result<Camera> {
    camera_in(tempfile::tempdir().unwrap().path(), table, Some(size))
}

/// As [`try_camera`], of a table that is right.
pub fn camera(table: &str, size: (u32, u32)) -> Camera {
    try_camera(table, size).unwrap_or_else(|e| panic!("{table}: {e}"))
}

/// Asserts that the table is refused by one line for exit code 2 that holds `expected`.
pub fn assert_refused(table: &str, expected: &str) {
    let error = try_camera(table, (40, 30)).expect_err(table);
    let text = error.to_string();
    assert_eq!(error.exit_code(), 2, "{text}");
    assert!(text.contains(expected) && !text.contains('\n'), "{table}: {text}");
}
