//! `poses` of a camera: a file with the poses of many frames, which become keyframes of its eye and quaternion.

mod lists;

use crate::camera::kinds::calibrated;
use crate::camera::pose;
use crate::input::reader::{Field, Source};
use crate::input::tree::{Entry, Node, Value};
use crate::input::{Error, Loading, Result};
use glam::{DMat3, DQuat, DVec3};
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// Where a camera is, and from its axes to the world's.
type Pose = (DVec3, DQuat);

/// The poses of a file, and whose axes they are of: a `convention` of scene files.
struct Poses {
    all: Vec<Pose>,
    convention: &'static str,
}

/// Replaces `poses` of the scene's camera by keys of eye and quaternion: the first pose is that of frame 0, the next of frame 1, and so on.
pub(super) fn expand(root: &mut Node, source: &Source) -> Result<()> {
    let Value::Table(entries) = &mut root.value else { return Ok(()) };
    let Some(camera) = entries.iter_mut().find(|entry| entry.key == "camera") else { return Ok(()) };
    let table = Field::new(source, "camera", &camera.node);
    let Some(field) = table.is_table().then(|| table.table()).transpose()?.and_then(|table| table.get("poses")) else {
        return Ok(());
    };
    for key in pose::KEYS.iter().filter(|key| **key != "distance") {
        if let Some(beside) = table.table()?.get(key) {
            return Err(beside.error("poses says it already; remove one of the two"));
        }
    }
    let Poses { all, convention } = read(&field.path()?, field.loading())?;
    let place = field.node().place;
    let entry = |key: &str, value: Value| Entry { key: key.into(), place, node: Node { value, place } };
    let list = |numbers: &[f64]| Value::List(numbers.iter().map(|x| Node { value: Value::Float(*x), place }).collect());
    let keys = |values: &mut dyn Iterator<Item = Value>| {
        let key = |(frame, value): (usize, Value)| {
            let value = Value::Table(vec![entry("frame", Value::Int(frame as i128)), entry("value", value)]);
            Node { value, place }
        };
        Value::List(values.enumerate().map(key).collect())
    };
    let added = [
        entry("eye", keys(&mut all.iter().map(|(eye, _)| list(&eye.to_array())))),
        entry("quaternion", keys(&mut all.iter().map(|(_, q)| list(&[q.w, q.x, q.y, q.z])))),
        entry("convention", Value::Text(convention.into())),
    ];
    if let Value::Table(entries) = &mut camera.node.value {
        entries.retain(|entry| entry.key != "poses");
        entries.extend(added);
    }
    Ok(())
}

/// Reads a folder of COLMAP's, `transforms.json`, another project with images and poses, or a list of poses.
fn read(path: &Path, loading: &Loading) -> Result<Poses> {
    if let Some(files) = numbered(path) {
        let mut all = Vec::new();
        for file in files {
            all.extend(read(&file, loading)?.all);
        }
        return Ok(Poses { all, convention: "opencv" });
    }
    if calibrated::file::has_images(path) {
        let all =
            calibrated::file::poses(path, loading)?.into_iter().map(|placed| (placed.eye, placed.rotation)).collect();
        return Ok(Poses { all, convention: "opencv" });
    }
    let text =
        loading.read_to_string(path).map_err(|e| Error::unreadable(path, format_args!("{e}; check the path")))?;
    let start = text.trim_start_matches('\u{feff}').trim_start();
    let project = || calibrated::file::poses_of_text(&text);
    let poses = if !start.starts_with(['{', '[', '<']) {
        lists::poses(&text).map(|all| Poses { all, convention: "opencv" })
    } else if let Some(placed) = (!text.contains("transform_matrix")).then(project).flatten() {
        let all = placed.map(|all| all.into_iter().map(|placed| (placed.eye, placed.rotation)).collect());
        all.map(|all| Poses { all, convention: "opencv" })
    } else {
        transforms(&text).map(|all| Poses { all, convention: "opengl" })
    };
    let refuse = |why: String| Error::input(format!("{}: {why}", path.display()));
    let poses = poses.map_err(refuse)?;
    if poses.all.is_empty() {
        return Err(refuse("has no poses".into()));
    }
    Ok(poses)
}

/// The files 0.txt, 1.txt and on of a folder, by number, as ScanNet has one for each pose; `None` if it has no 0.txt.
fn numbered(folder: &Path) -> Option<Vec<PathBuf>> {
    if !folder.join("0.txt").is_file() {
        return None;
    }
    let paths = std::fs::read_dir(folder).ok()?.flatten().map(|entry| entry.path());
    let number = |path: &Path| path.file_stem()?.to_str()?.parse::<u64>().ok();
    let is_text = |path: &Path| path.extension().is_some_and(|e| e == "txt");
    let mut all: Vec<(u64, PathBuf)> =
        paths.filter(|path| is_text(path)).filter_map(|path| Some((number(&path)?, path))).collect();
    all.sort();
    Some(all.into_iter().map(|(_, path)| path).collect())
}

/// The `transforms.json` of nerfstudio and other NeRFs: camera to world, OpenGL's axes, in the order of the file.
fn transforms(text: &str) -> std::result::Result<Vec<Pose>, String> {
    #[derive(Deserialize)]
    struct File {
        frames: Vec<Frame>,
    }
    #[derive(Deserialize)]
    struct Frame {
        transform_matrix: Vec<Vec<f64>>,
    }
    let file: File = serde_json::from_str(text).map_err(|e| format!("not a transforms.json: {e}"))?;
    let pose = |(n, frame): (usize, &Frame)| {
        let rows: Vec<[f64; 4]> =
            frame.transform_matrix.iter().filter_map(|row| <[f64; 4]>::try_from(&row[..]).ok()).collect();
        match (rows[..].first_chunk::<3>(), rows.len() == frame.transform_matrix.len()) {
            (Some(rows), true) => of_rows(rows).map_err(|why| format!("frames.{n}.transform_matrix: {why}")),
            _ => Err(format!("frames.{n}.transform_matrix: must have 3 or 4 rows of 4 numbers")),
        }
    };
    file.frames.iter().enumerate().map(pose).collect()
}

/// The rows of a matrix from the camera to the world.
fn of_rows(rows: &[[f64; 4]; 3]) -> std::result::Result<Pose, String> {
    let column = |k: usize| DVec3::new(rows[0][k], rows[1][k], rows[2][k]);
    let axes = DMat3::from_cols(column(0), column(1), column(2));
    pose::check_axes(axes)?;
    Ok((column(3), DQuat::from_mat3(&axes).normalize()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;

    /// The camera's eye and its directions to the right, up and forward, at a frame of a file of this name and text.
    fn seen(name: &str, text: &str, frame: f64) -> Result<[DVec3; 4]> {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join(name), text).unwrap();
        let scene = folder.path().join("scene.toml");
        let camera = "kind = \"orthographic\"\nheight = 2";
        std::fs::write(&scene, format!("[image]\nwidth = 2\nheight = 2\n[camera]\n{camera}\nposes = \"{name}\"\n"))
            .unwrap();
        let camera = Scene::load(&scene, &[], frame, &Loading::default())?.camera()?;
        let at = |i, j| camera.ray(i, j).unwrap();
        let (a, b, c) = (at(0, 0), at(1, 0), at(0, 1));
        let eye = 0.5 * (b.origin + c.origin);
        Ok([eye, b.origin - a.origin, a.origin - c.origin, a.direction.normalize()])
    }

    /// Rotated by 180 degrees about x, and about an axis 22.5 degrees from x towards z.
    const TUM: &str =
        "# timestamp tx ty tz qx qy qz qw\n1.5 1 2 3 1 0 0 0\n\n2.5 3 2 3 0.9238795325112867 0 0.3826834323650898 0\n";

    #[test]
    fn poses_are_keys_of_frames() {
        let near = |a: [DVec3; 4], b: [DVec3; 4]| a.iter().zip(b).all(|(a, b)| a.distance(b) < 1e-14);
        // OpenCV's axes rotated by 180 degrees about x are OpenGL's, which look along -z
        let first = [DVec3::new(1.0, 2.0, 3.0), DVec3::X, DVec3::Y, DVec3::NEG_Z];
        assert!(near(seen("p.txt", TUM, 0.0).unwrap(), first), "{:?}", seen("p.txt", TUM, 0.0));
        let (sin, cos) = std::f64::consts::FRAC_PI_8.sin_cos();
        let half = [DVec3::new(2.0, 2.0, 3.0), DVec3::new(cos, 0.0, sin), DVec3::Y, DVec3::new(sin, 0.0, -cos)];
        assert!(near(seen("p.txt", TUM, 0.5).unwrap(), half), "{:?}", seen("p.txt", TUM, 0.5));

        let kitti = "1 0 0 1 0 -1 0 2 0 0 -1 3\n1e0 0 0 3 0 1 0 2 0 0 1 3\n";
        assert!(near(seen("p.txt", kitti, 0.0).unwrap(), first));
        let second = [DVec3::new(3.0, 2.0, 3.0), DVec3::X, DVec3::NEG_Y, DVec3::Z];
        assert!(near(seen("p.txt", kitti, 1.0).unwrap(), second));
        let nerf = r#"{"fl_x": 3, "frames": [{"file_path": "a", "transform_matrix": [[1,0,0,1],[0,1,0,2],[0,0,1,3],[0,0,0,1]]}]}"#;
        assert!(near(seen("transforms.json", nerf, 7.0).unwrap(), first));
        // the world to the camera, in the order of names
        let colmap = "2 0 1 0 0 -1 2 3 1 b.jpg\n\n1 1 0 0 0 0 0 0 1 a.jpg\n\n";
        assert!(near(seen("images.txt", colmap, 1.0).unwrap(), first), "{:?}", seen("images.txt", colmap, 1.0));
        assert!(near(seen("images.txt", colmap, 0.0).unwrap(), [DVec3::ZERO, DVec3::X, DVec3::NEG_Y, DVec3::Z]));
    }

    #[test]
    fn a_folder_of_numbered_files_has_a_pose_in_each() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join("pose")).unwrap();
        for n in [0, 2, 10] {
            let text = format!("1 0 0 {n}\n0 -1 0 2\n0 0 -1 3\n0 0 0 1\n");
            std::fs::write(folder.path().join(format!("pose/{n}.txt")), text).unwrap();
        }
        let found = read(&folder.path().join("pose"), &Loading::default()).unwrap();
        assert_eq!(found.all.iter().map(|(eye, _)| eye.x).collect::<Vec<_>>(), [0.0, 2.0, 10.0]);
    }

    #[test]
    fn poses_of_images_are_read_from_projects() {
        let shot = |x: f64| format!("{{\"rotation\": [0, 0, 0], \"translation\": [{x}, 0, 0], \"camera\": \"c\"}}");
        let camera = "{\"projection_type\": \"perspective\", \"width\": 4, \"height\": 4, \"focal\": 1}";
        let text = format!(
            "[{{\"cameras\": {{\"c\": {camera}}}, \"shots\": {{\"a\": {}, \"b\": {}}}}}]",
            shot(0.0),
            shot(-3.0)
        );
        let [eye, right, up, forward] = seen("reconstruction.json", &text, 1.0).unwrap();
        assert_eq!([eye, right, up, forward], [DVec3::X * 3.0, DVec3::X, DVec3::NEG_Y, DVec3::Z]);
    }

    #[test]
    fn wrong_poses_are_refused_in_one_line() {
        for (name, text, says) in [
            ("p.txt", "1 2 3\n", "p.txt: line 1: 3 numbers; TUM's poses have 8"),
            ("p.txt", "# none\n", "p.txt: has no poses"),
            ("p.txt", "1 2 3 4 5 6 7 x\n", "line 1: \"x\" is not a number"),
            ("p.txt", "2 0 0 1 0 -1 0 2 0 0 -1 3\n", "line 1: the first three columns have lengths 2.0"),
            ("p.txt", "0 1 2 3 0 0 0 0\n", "is no rotation"),
            ("p.txt", "0 nan 2 3 0 0 0 1\n", "finite"),
            (
                "t.json",
                "{\"frames\": [{\"transform_matrix\": [[1, 0], [0, 1]]}]}",
                "frames.0.transform_matrix: must have 3 or 4 rows",
            ),
            ("t.json", "{}", "not a transforms.json: missing field `frames`"),
            ("images.txt", "1 1 0 0", "line 1: QZ is missing"),
        ] {
            let error = seen(name, text, 0.0).unwrap_err().to_string();
            assert!(error.contains(says) && !error.contains('\n'), "{text}: {error}");
        }
    }
}
