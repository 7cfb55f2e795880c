//! The pose of a viewer: an eye, a target and an up vector; or a matrix; or an eye and a quaternion.

use super::view::{View, view};
use crate::arrays::MapEach;
use crate::camera::values::word;
use crate::input::Result;
use crate::input::reader::{Field, Table};
use glam::{DAffine3, DMat3, DQuat, DVec3, DVec4};

/// The keys of [`Pose::read`].
pub const KEYS: [&str; 7] = ["eye", "target", "up", "matrix", "quaternion", "convention", "distance"];

/// Those that only a matrix or a quaternion takes.
const WITH_ROTATION: [&str; 2] = ["convention", "distance"];

/// A viewer. The frame is pinhole's: f = unit(target - eye), r = unit(f x up), u = r x f.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    pub eye: DVec3,
    pub target: DVec3,
    pub up: DVec3,
    /// The frame of a matrix or a quaternion, from which target and up follow.
    frame: Option<View>,
}

impl Pose {
    /// At the origin, with [`View::UNTURNED`].
    pub const UNTURNED: Pose = Pose { eye: DVec3::ZERO, target: DVec3::Z, up: DVec3::Y, frame: Some(View::UNTURNED) };

    pub fn look_at(eye: DVec3, target: DVec3, up: DVec3) -> Pose {
        Pose { eye, target, up, frame: None }
    }

    /// Reads any of [`KEYS`].
    pub fn read(table: &Table) -> Result<Pose> {
        match Pose::read_rotation(table)? {
            Some(pose) => Ok(pose),
            None => {
                let eye = table.need("eye", "[0, 0, 5]")?.vec3()?;
                let target = table.need("target", "[0, 0, 0]")?.vec3()?;
                Ok(Pose::look_at(eye, target, table.or("up", DVec3::Y, Field::vec3)?))
            }
        }
    }

    /// Reads a pose given by a matrix or a quaternion; `None` if the table has neither.
    pub fn read_rotation(table: &Table) -> Result<Option<Pose>> {
        let (eye, axes) = match (table.get("matrix"), table.get("quaternion")) {
            (None, None) => {
                let alone = WITH_ROTATION.into_iter().find_map(|key| table.get(key));
                return match alone {
                    Some(key) => Err(key.error("goes with matrix or quaternion; leave it out")),
                    None => Ok(None),
                };
            }
            (Some(matrix), quaternion) => {
                refuse(["eye", "target", "up"].into_iter().find_map(|key| table.get(key)).or(quaternion), "matrix")?;
                read_matrix(&matrix)?
            }
            (None, Some(quaternion)) => {
                refuse(["target", "up"].into_iter().find_map(|key| table.get(key)), "quaternion")?;
                (table.need("eye", "[0, 0, 5]")?.vec3()?, read_quaternion(&quaternion)?)
            }
        };
        let is_opencv = table.or("convention", false, read_convention)?;
        let distance = table.or("distance", 1.0, Field::above_zero)?;
        let (up, forward) = if is_opencv { (-axes.y_axis, axes.z_axis) } else { (axes.y_axis, -axes.z_axis) };
        Pose::of_axes(eye, forward, up, distance).map(Some)
    }

    /// Of a camera in OpenCV's frame (x right, y down, z forward), which `rotation` takes to the world.
    pub fn of_camera(eye: DVec3, rotation: DQuat, distance: f64) -> Result<Pose> {
        Pose::of_axes(eye, rotation * DVec3::Z, -(rotation * DVec3::Y), distance)
    }

    fn of_axes(eye: DVec3, forward: DVec3, up: DVec3, distance: f64) -> Result<Pose> {
        // makes rounded entries orthonormal, as for target and up
        let frame = view(DVec3::ZERO, forward, up)?;
        Ok(Pose { eye, target: eye + distance * frame.forward, up: frame.up, frame: Some(frame) })
    }

    /// # Errors
    /// No frame: eye = target, or up along the view direction.
    pub(crate) fn view(&self) -> Result<View> {
        self.frame.map_or_else(|| view(self.eye, self.target, self.up), Ok)
    }

    /// From the eye to the target.
    pub fn distance(&self) -> f64 {
        self.eye.distance(self.target)
    }

    /// Eye, target and up, for cameras that use the target's direction only. A frame's target is moved so far away that its
    /// rounding turns the direction by no more than the direction's own rounding.
    pub fn directed(&self) -> (DVec3, DVec3, DVec3) {
        let far = self.eye.abs().max_element().max(1.0);
        (self.eye, self.frame.map_or(self.target, |f| self.eye + far * f.forward), self.up)
    }
}

fn refuse(field: Option<Field>, beside: &str) -> Result<()> {
    match field {
        Some(field) => Err(field.error(format_args!("{beside} says it already; remove one of the two"))),
        None => Ok(()),
    }
}

/// True for OpenCV's axes: y down, z forward.
fn read_convention(field: &Field) -> Result<bool> {
    let wrong = "use \"opengl\" (x right, y up, z backward) or \"opencv\" (x right, y down, z forward)";
    word(field, &[("opengl", false), ("opencv", true)], wrong)
}

/// Largest error of a matrix entry that was printed with four decimals, as Blender's console prints them.
const DECIMALS: f64 = 0.5e-4;
/// Then a column's error e has |e| <= sqrt(3) DECIMALS, and the dot product of two unit columns is off by up to 2 |e| + |e|^2.
const GRAM_ERROR: f64 = 2.0 * 1.732_050_807_568_877_3 * DECIMALS + 3.0 * DECIMALS * DECIMALS;

/// The camera's position and its axes, in the world.
fn read_matrix(field: &Field) -> Result<(DVec3, DMat3)> {
    let DAffine3 { matrix3: axes, translation: place } = field.affine()?;
    check_axes(axes).map_err(|why| field.error(why))?;
    Ok((place, axes))
}

/// That the axes are those of a rotation, as far as four decimals say.
pub(crate) fn check_axes(axes: DMat3) -> std::result::Result<(), String> {
    let [x, y, z] = [axes.x_axis, axes.y_axis, axes.z_axis];
    let lengths = [x, y, z].map_each(DVec3::length);
    // NaN is no length
    if !lengths.iter().all(|l| (l * l - 1.0).abs() <= GRAM_ERROR) {
        let [x, y, z] = lengths;
        return Err(format!(
            "the first three columns have lengths {x:.6}, {y:.6}, {z:.6}; a camera has no scale: divide them to length 1"
        ));
    }
    if [x.dot(y), y.dot(z), z.dot(x)].iter().any(|d| d.abs() > GRAM_ERROR) {
        return Err("the first three columns are not perpendicular to each other; give a rotation".into());
    }
    if axes.determinant() < 0.0 {
        return Err("the matrix mirrors (its determinant is -1); change the sign of one of its columns".into());
    }
    Ok(())
}

fn read_quaternion(field: &Field) -> Result<DMat3> {
    let [w, x, y, z] = field.numbers("a quaternion, as [w, x, y, z]")?;
    let unit = DVec4::new(x, y, z, w).try_normalize();
    let unit = unit
        .ok_or_else(|| field.error("is no rotation: its length is 0 or out of range; the identity is [1, 0, 0, 0]"))?;
    Ok(DMat3::from_quat(DQuat::from_vec4(unit)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Camera;
    use crate::camera::kinds::read_camera;
    use crate::input::Loading;
    use crate::input::load::with_tree;
    use proptest::prelude::*;

    fn camera(keys: &str) -> Result<Camera> {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("scene.toml");
        std::fs::write(&path, format!("[camera]\n{keys}\n")).unwrap();
        let spec = with_tree(&path, &Loading::default(), |file| read_camera(&file.table()?.need("camera", "{}")?))?;
        Camera::new(&spec, Some((8, 6)))
    }

    /// Every kind of camera that takes a pose, and its other keys.
    const KINDS: [(&str, &str); 22] = [
        ("pinhole", "vfov = 40"),
        ("orthographic", "height = 3"),
        ("cross_slit", "height = 3\nslits = [{ distance = 4, angle = 90 }, { distance = 2, angle = 0 }]"),
        ("pencil", "vfov = 40\nslit = 1"),
        ("twisted", "height = 3\nangle = 20"),
        ("hinge", "vfov = 40\npath = 2\nangle = 20"),
        ("fisheye", "fov = 120\nframe = \"full\""),
        ("sphere", ""),
        ("cylinder", "fov = 120\nvfov = 40"),
        ("panini", "fov = 120"),
        ("ods", "ipd = 0.1"),
        ("camera_texture", "vfov = 40\noffsets = [[[0, 0], [0, 0]], [[0, 0], [0.1, 0]]]"),
        ("lidar", "beams = [0, 5, 10, 15, 20, 25]\ncolumns = 8"),
        ("irregular_perspective", ""),
        ("twist", ""),
        ("curved_convergence", ""),
        ("ortho_to_perspective", ""),
        ("occlusion", ""),
        ("top_down", "vfov = 40\nregions = [{ rect = [0.3, 0.3, 0.6, 0.6], POSE, vfov = 40 }]"),
        ("track", "vfov = 40\ntargets = []"),
        (
            "bottom_up",
            "views = [{ POSE, vfov = 40 }, { eye = [40, 0, 0], target = [60, 0, -10], vfov = 30 }]\nfar = 10",
        ),
        ("mcop", "path = [{ POSE }, { POSE }]\nvfov = 40"),
    ];

    /// The keys of a camera of this kind with the pose `pose`, as lines of TOML.
    fn keys(kind: &str, more: &str, pose: &str) -> String {
        let inside = more.replace("POSE", &pose.replace('\n', ", "));
        let own = if matches!(kind, "bottom_up" | "mcop") { "" } else { pose };
        format!("kind = {kind:?}\n{own}\n{inside}")
    }

    fn rows(x: DVec3, y: DVec3, z: DVec3, eye: DVec3) -> String {
        let row = |k: usize| format!("[{:?}, {:?}, {:?}, {:?}]", x[k], y[k], z[k], eye[k]);
        format!("[{}, {}, {}, [0, 0, 0, 1]]", row(0), row(1), row(2))
    }

    #[test]
    fn all_kinds_take_matrices_and_quaternions_of_both_conventions() {
        let (eye, target, up) = (DVec3::new(1.0, 2.0, 3.0), DVec3::new(0.25, -0.5, -1.0), DVec3::new(0.1, 1.0, 0.2));
        let View { forward, right, up: above } = view(eye, target, up).unwrap();
        let [opengl, opencv] = [(above, -forward), (-above, forward)];
        let quaternion = |(y, z): (DVec3, DVec3)| {
            let q = DQuat::from_mat3(&DMat3::from_cols(right, y, z));
            format!("eye = {:?}\nquaternion = {:?}", eye.to_array(), [q.w, q.x, q.y, q.z].map(|k| -3.0 * k))
        };
        let matrix = |(y, z)| format!("matrix = {}", rows(right, y, z, eye));
        let plain = format!("eye = {:?}\ntarget = {:?}\nup = {:?}", eye.to_array(), target.to_array(), up.to_array());
        for (kind, more) in KINDS {
            let expected = camera(&keys(kind, more, &plain)).unwrap_or_else(|e| panic!("{kind}: {e}"));
            for pose in [
                matrix(opengl),
                matrix(opencv) + "\nconvention = \"opencv\"",
                quaternion(opengl),
                quaternion(opencv) + "\nconvention = \"opencv\"",
            ] {
                let pose = format!("{pose}\ndistance = {:?}", eye.distance(target));
                let found = camera(&keys(kind, more, &pose)).unwrap_or_else(|e| panic!("{kind}, {pose}: {e}"));
                for (i, j) in (0..8).flat_map(|i| (0..6).map(move |j| (i, j))) {
                    let (found, expected) = (found.ray(i, j), expected.ray(i, j));
                    assert_eq!(found.is_some(), expected.is_some(), "{kind}");
                    if let (Some(found), Some(expected)) = (found, expected) {
                        let difference =
                            |a: DVec3, b: DVec3| (a - b).abs().max_element() / b.abs().max_element().max(1.0);
                        let off = difference(found.origin, expected.origin)
                            .max(difference(found.direction, expected.direction));
                        // some hundred roundings of numbers of the size of the scene
                        assert!(off < 1e-12, "{kind}, {pose}: {off:e}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_matrix_keeps_its_precision_far_from_the_origin() {
        let axes = DMat3::from_quat(DQuat::from_xyzw(0.1, 0.2, 0.3, 0.4).normalize());
        let eye = DVec3::new(4e6, 350.0, -6e5);
        let matrix = rows(axes.x_axis, axes.y_axis, axes.z_axis, eye);
        for (kind, fov) in [("pinhole", "vfov"), ("fisheye", "fov")] {
            let camera = camera(&format!("kind = {kind:?}\nmatrix = {matrix}\n{fov} = 40")).unwrap();
            let sum = (0..8).flat_map(|i| (0..6).map(move |j| (i, j))).filter_map(|(i, j)| camera.ray(i, j));
            let middle: DVec3 = sum.map(|ray| ray.direction).sum();
            // by symmetry the rays' mean is the view direction, up to some roundings
            assert!((middle.normalize() + axes.z_axis).length() < 4e-15, "{kind}");
        }
    }

    fn pinhole(pose: &str) -> Result<Camera> {
        camera(&format!("kind = \"pinhole\"\nvfov = 40\n{pose}"))
    }

    #[test]
    fn wrong_poses_are_refused_in_one_line() {
        let eye = "eye = [0, 0, 5]\n";
        for (pose, says) in [
            ("matrix = [[1, 0, 0, 0], [0, 1, 0, 0]]".into(), "matrix: expected a matrix of 3 or 4 rows"),
            ("matrix = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]".into(), "matrix.0: expected a row of four numbers"),
            ("matrix = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 5, 1]]".into(), "matrix.3: the last row"),
            ("matrix = [[1, 0, 0, 0], [0, nan, 0, 0], [0, 0, 1, 0]]".into(), "matrix.1.1: expected a finite number"),
            (
                "matrix = [[2, 0, 0, 0], [0, 2, 0, 0], [0, 0, 2, 0]]".into(),
                "matrix: the first three columns have lengths 2.0",
            ),
            ("matrix = [[1, 0, 0, 0], [0, 1.0002, 0, 0], [0, 0, 1, 0]]".into(), "lengths 1.000000, 1.000200"),
            ("matrix = [[1, 0.01, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]".into(), "not perpendicular"),
            ("matrix = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, -1, 0]]".into(), "the matrix mirrors"),
            (format!("{eye}matrix = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]"), "eye: matrix says it already"),
            (format!("{eye}target = [0, 0, 0]\nquaternion = [1, 0, 0, 0]"), "target: quaternion says it already"),
            ("quaternion = [1, 0, 0, 0]".into(), "eye is missing"),
            (format!("{eye}quaternion = [0, 0, 0, 0]"), "quaternion: is no rotation"),
            (format!("{eye}quaternion = [1, 0, 0]"), "quaternion: expected a quaternion, as [w, x, y, z]"),
            (format!("{eye}quaternion = [1, 0, 0, 0]\nconvention = \"nerf\""), "convention: use \"opengl\""),
            (format!("{eye}target = [0, 0, 0]\nconvention = \"opencv\""), "convention: goes with matrix"),
            (format!("{eye}quaternion = [1, 0, 0, 0]\ndistance = 0"), "distance: 0 is out of range"),
        ] {
            let error = pinhole(&pose).unwrap_err().to_string();
            assert!(error.contains(says) && !error.contains('\n'), "{pose}: {error}");
        }
    }

    proptest! {
        #[test]
        fn four_decimals_are_enough(q in prop::array::uniform4(-1.0f64..1.0)) {
            prop_assume!(DVec4::from(q).length() > 0.1);
            let axes = DMat3::from_quat(DQuat::from_vec4(DVec4::from(q).normalize()));
            let round = |v: DVec3| (v * 1e4).round() / 1e4;
            let [x, y, z] = [axes.x_axis, axes.y_axis, axes.z_axis].map(round);
            let camera = pinhole(&format!("matrix = {}", rows(x, y, z, DVec3::ZERO)));
            prop_assert!(camera.is_ok(), "{:?}", camera.err());
            // and the steps right and down are perpendicular, as a pinhole's
            let Ok(camera) = camera else { unreachable!() };
            let d = |i, j| camera.ray(i, j).unwrap().direction;
            prop_assert!((d(1, 0) - d(0, 0)).dot(d(0, 1) - d(0, 0)).abs() < 1e-15);
        }
    }
}
