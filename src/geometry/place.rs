//! Placing meshes in the world by scale, rotation and translation, and merging meshes.

use crate::arrays::MapEach;
use crate::geometry::mesh::{MAX_TRIANGLES, Mesh, NO_COLOR, NO_NORMAL, NO_UV};
use crate::input::{Error, Result};
use crate::parallel;
use glam::{DAffine3, DMat3, DVec3, Vec3};

/// Places `mesh`: world = R (scale * p) + translate with R = Rz Ry Rx, right-handed, `rotate_deg` in degrees about
/// the world's x, y and z axes; multiples of 90 degrees are exact.
///
/// Normals go by the inverse transpose; a scale with a zero leaves no normals. Triangles keep their order and
/// their vertices' order, also where a negative scale mirrors them. Positions that overflow become infinite. A mesh with spheres is scaled
/// by the same number along all axes.
pub fn place(mut mesh: Mesh, scale: DVec3, rotate_deg: DVec3, translate: DVec3) -> Mesh {
    let rotation = rotation_xyz(rotate_deg);
    parallel::for_each_mut(&mut mesh.positions, |_, p| *p = rotation * (scale * *p) + translate);
    parallel::for_each_mut(&mut mesh.radii, |_, radius| *radius *= scale.x.abs());
    match world_normal_from_object(rotation * DMat3::from_diagonal(scale)) {
        Some(matrix) => parallel::for_each_mut(&mut mesh.normals, |_, n| *n = transformed_normal(matrix, *n)),
        None => {
            mesh.normals = Vec::new();
            mesh.corner_normals = Vec::new();
        }
    }
    mesh
}

/// The matrix of [`place`].
pub fn matrix(scale: DVec3, rotate_deg: DVec3, translate: DVec3) -> DAffine3 {
    DAffine3 { matrix3: rotation_xyz(rotate_deg) * DMat3::from_diagonal(scale), translation: translate }
}

/// What is wrong with a transform of spheres.
pub const STRETCHES: &str =
    "stretches spheres, which stay spheres only by rotation, translation and one scale for all axes; use only these";

/// Axes of a matrix may differ in length, and from right angles, by this much of a length: the rounding of matrices that were written with
/// seven decimal digits, or as f32.
pub const STRETCH_MAX: f64 = 1e-6;

/// Spheres stay spheres.
pub fn keeps_spheres(place: &DAffine3) -> bool {
    let axes = [place.matrix3.x_axis, place.matrix3.y_axis, place.matrix3.z_axis];
    let size = size_of(place);
    let is_as_long = |axis: &DVec3| (axis.length() - size).abs() <= STRETCH_MAX * size;
    let is_right_angle = |(a, b): (usize, usize)| axes[a].dot(axes[b]).abs() <= STRETCH_MAX * size * size;
    size > 0.0
        && size.is_finite()
        && axes.iter().all(is_as_long)
        && [(0, 1), (1, 2), (2, 0)].into_iter().all(is_right_angle)
}

/// By how much a transform that keeps spheres scales them.
pub fn size_of(place: &DAffine3) -> f64 {
    place.matrix3.x_axis.length()
}

/// Rz Ry Rx for angles in degrees.
pub fn rotation_xyz(degrees: DVec3) -> DMat3 {
    let [(sx, cx), (sy, cy), (sz, cz)] = degrees.to_array().map_each(sin_cos_deg);
    let about_x = DMat3::from_cols(DVec3::X, DVec3::new(0.0, cx, sx), DVec3::new(0.0, -sx, cx));
    let about_y = DMat3::from_cols(DVec3::new(cy, 0.0, -sy), DVec3::Y, DVec3::new(sy, 0.0, cy));
    let about_z = DMat3::from_cols(DVec3::new(cz, sz, 0.0), DVec3::new(-sz, cz, 0.0), DVec3::Z);
    about_z * about_y * about_x
}

/// Sine and cosine of an angle in degrees, exact at multiples of 90 degrees. The remainder is exact in f64.
fn sin_cos_deg(degrees: f64) -> (f64, f64) {
    match degrees.rem_euclid(360.0) {
        0.0 => (0.0, 1.0),
        90.0 => (1.0, 0.0),
        180.0 => (0.0, -1.0),
        270.0 => (-1.0, 0.0),
        other => other.to_radians().sin_cos(),
    }
}

/// The inverse transpose of `matrix` up to a positive factor; `None` if the matrix is singular or not finite.
pub(crate) fn world_normal_from_object(matrix: DMat3) -> Option<DMat3> {
    // Scaled first: a determinant of small or large scales leaves the range of f64.
    let [x, y, z] = [matrix.x_axis, matrix.y_axis, matrix.z_axis].map_each(|axis| {
        let largest = axis.abs().max_element();
        (axis / largest, largest)
    });
    // Column k of M^-T is that of the matrix of scaled columns, over the scale.
    let cofactors = [y.0.cross(z.0) / x.1, z.0.cross(x.0) / y.1, x.0.cross(y.0) / z.1];
    let determinant = x.0.dot(y.0.cross(z.0));
    if determinant == 0.0 || !determinant.is_finite() {
        return None;
    }
    let largest = cofactors.iter().map(|c| c.abs().max_element()).fold(0.0, f64::max);
    let inverse_transpose =
        DMat3::from_cols_array_2d(&cofactors.map_each(|c| (c / largest * determinant.signum()).into()));
    inverse_transpose.is_finite().then_some(inverse_transpose)
}

/// The unit normal `matrix * normal`.
pub(crate) fn transformed_normal(matrix: DMat3, normal: Vec3) -> Vec3 {
    let n = matrix * normal.as_dvec3();
    let largest = n.abs().max_element();
    if largest > 0.0 { (n / largest).normalize().as_vec3() } else { normal }
}

/// Refuses meshes that together have more than ids and indices can number.
///
/// # Errors
/// [`Error::Input`] if there are more than 2^28 triangles, or 2^32 - 1 or more vertices, normals, texture coordinates, colours or materials.
pub fn check_counts<'a>(meshes: impl IntoIterator<Item = &'a Mesh> + Clone) -> Result<()> {
    let total = |count: fn(&Mesh) -> usize| meshes.clone().into_iter().map(count).sum::<usize>();
    let triangles = total(|m| m.triangles.len());
    if triangles > MAX_TRIANGLES {
        return Err(Error::input(format!("the scene has {triangles} triangles, at most 2^28 are possible; use fewer")));
    }
    for (count, what) in [
        (total(|m| m.positions.len()), "vertices"),
        (total(|m| m.normals.len()), "normals"),
        (total(|m| m.uvs.len()), "texture coordinates"),
        (total(|m| m.colors.len()), "colours"),
        (total(|m| m.materials.len()), "materials"),
    ] {
        if count >= u32::MAX as usize {
            return Err(Error::input(format!("the scene has {count} {what}, under 2^32 - 1 are possible; use fewer")));
        }
    }
    Ok(())
}

/// Joins meshes in order: triangle ids run on from mesh to mesh. Each keeps its own materials. Where one has normals, texture coordinates
/// or colours, the corners of the others say that they have none; where one has spheres, the triangles of the others say that they are none.
///
/// # Errors
/// Those of [`check_counts`].
pub fn merge(meshes: Vec<Mesh>) -> Result<Mesh> {
    check_counts(&meshes)?;
    let mut meshes = meshes.into_iter();
    let mut all = meshes.next().unwrap_or_default();
    meshes.for_each(|mesh| append_with_all(&mut all, mesh));
    Ok(all)
}

/// Lists of the normals, texture coordinates and colours of corners.
fn corner_lists(mesh: &mut Mesh) -> [&mut Vec<[u32; 3]>; 3] {
    [&mut mesh.corner_normals, &mut mesh.corner_uvs, &mut mesh.corner_colors]
}

/// Marks a corner without an entry, in each of these lists.
const NONE: u32 = u32::MAX;
const _: () = assert!(NO_NORMAL == NONE && NO_UV == NONE && NO_COLOR == NONE);

/// Appends `mesh` to `all`: with normals, texture coordinates and colours only where `all` has some. The caller made sure that all counts
/// fit a u32.
pub fn append(all: &mut Mesh, mut mesh: Mesh) {
    if !all.triangles.is_empty() {
        let lists = corner_lists(all).into_iter().zip(corner_lists(&mut mesh));
        lists.filter(|(own, _)| own.is_empty()).for_each(|(_, more)| more.clear());
    }
    append_with_all(all, mesh);
}

/// Appends `mesh` to `all` with all that it has, as [`merge`] does. The caller has called [`check_counts`].
pub fn append_with_all(all: &mut Mesh, mut mesh: Mesh) {
    if *all == Mesh::default() {
        // nothing to join with, and nothing to copy
        *all = Mesh { parts: Vec::new(), ..mesh };
        return;
    }
    let before = all.triangles.len();
    let [position, material] = [all.positions.len(), all.materials.len()].map_each(|count| count as u32);
    let firsts = [all.normals.len(), all.uvs.len(), all.colors.len()].map_each(|count| count as u32);
    all.positions.extend_from_slice(&mesh.positions);
    all.normals.extend_from_slice(&mesh.normals);
    all.uvs.extend_from_slice(&mesh.uvs);
    all.colors.extend_from_slice(&mesh.colors);
    all.materials.append(&mut mesh.materials);
    all.missing.append(&mut mesh.missing);
    all.triangles.extend(mesh.triangles.iter().map(|t| t.map_each(|i| i + position)));
    all.material_of.extend(mesh.material_of.iter().map(|m| m + material));
    let count = all.triangles.len();
    if mesh.has_spheres() || all.has_spheres() {
        all.radii.resize(before, 0.0);
        all.radii.extend_from_slice(&mesh.radii);
        all.radii.resize(count, 0.0);
        all.has_capsules |= mesh.has_capsules;
    }
    for ((own, more), first) in corner_lists(all).into_iter().zip(corner_lists(&mut mesh)).zip(firsts) {
        if !own.is_empty() || !more.is_empty() {
            own.resize(before, [NONE; 3]);
            own.extend(more.iter().map(|t| t.map_each(|k| if k == NONE { k } else { k + first })));
            own.resize(count, [NONE; 3]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::mesh::Material;
    use proptest::prelude::*;

    fn triangle(with_normal: bool) -> Mesh {
        let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
        let normal = if with_normal { 1 } else { 0 };
        Mesh {
            positions,
            triangles: vec![[0, 1, 2]],
            radii: Vec::new(),
            has_capsules: false,
            normals: vec![Vec3::Z; normal],
            corner_normals: vec![[0, 0, NO_NORMAL]; normal],
            uvs: vec![glam::Vec2::Y; normal],
            corner_uvs: vec![[0, NO_UV, 0]; normal],
            colors: vec![[0.5; 3]; normal],
            corner_colors: vec![[NO_COLOR, 0, 0]; normal],
            materials: vec![Material::default()],
            material_of: vec![0],
            missing: Vec::new(),
            parts: Vec::new(),
            runs: Vec::new(),
        }
    }

    #[test]
    fn quarter_turns_are_exact_and_right_handed() {
        let rotated = |x, y, z, p| rotation_xyz(DVec3::new(x, y, z)) * p;
        assert_eq!(rotated(90.0, 0.0, 0.0, DVec3::Y), DVec3::Z);
        assert_eq!(rotated(0.0, 90.0, 0.0, DVec3::Z), DVec3::X);
        assert_eq!(rotated(0.0, 0.0, -270.0, DVec3::X), DVec3::Y);
        // About x first: y -> z, then about y: z -> x, then about z: x -> y.
        assert_eq!(rotated(90.0, 90.0, 90.0, DVec3::Y), DVec3::Y);
        assert_eq!(rotated(0.0, 3600.0 + 180.0, 0.0, DVec3::X), -DVec3::X);
    }

    #[test]
    fn scale_comes_first_translation_last() {
        let mesh = place(triangle(true), DVec3::new(2.0, 3.0, 4.0), DVec3::new(0.0, 0.0, 90.0), DVec3::ONE);
        assert_eq!(mesh.positions, [DVec3::ONE, DVec3::new(1.0, 3.0, 1.0), DVec3::new(-2.0, 1.0, 1.0)]);
        assert_eq!(mesh.normals, [Vec3::Z]);
        let flat = place(triangle(true), DVec3::new(1.0, 0.0, 1.0), DVec3::ZERO, DVec3::ZERO);
        assert!(flat.normals.is_empty() && flat.corner_normals.is_empty());
        assert_eq!(flat.triangles.len(), 1);
        let tiny = place(triangle(true), DVec3::splat(-1e-200), DVec3::ZERO, DVec3::ZERO);
        assert_eq!(tiny.normals, [-Vec3::Z]);
    }

    #[test]
    fn merged_meshes_keep_order_normals_and_materials() {
        let all = merge(vec![triangle(false), triangle(true), Mesh::default(), triangle(false)]).unwrap();
        assert_eq!(all.triangles, [[0, 1, 2], [3, 4, 5], [6, 7, 8]]);
        let none = [NO_NORMAL; 3];
        assert_eq!(all.corner_normals, [none, [0, 0, NO_NORMAL], none]);
        assert_eq!(all.corner_uvs, [[NO_UV; 3], [0, NO_UV, 0], [NO_UV; 3]]);
        assert_eq!(all.corner_colors, [[NO_COLOR; 3], [NO_COLOR, 0, 0], [NO_COLOR; 3]]);
        assert_eq!(all.colors_of(1), [[1.0; 3], [0.5; 3], [0.5; 3]]);
        assert_eq!(all.material_of, [0, 1, 2]);
        assert!(merge(vec![triangle(false); 2]).unwrap().corner_normals.is_empty());
        // a first mesh without triangles hides nothing of the others
        let all = merge(vec![Mesh::default(), triangle(false), triangle(true)]).unwrap();
        assert_eq!(
            (all.corner_normals, all.corner_colors),
            (vec![none, [0, 0, NO_NORMAL]], vec![[NO_COLOR; 3], [NO_COLOR, 0, 0]])
        );
        assert_eq!(merge(Vec::new()).unwrap(), Mesh::default());
    }

    proptest! {
        #[test]
        fn normals_stay_perpendicular_and_on_their_side(
            edges in prop::array::uniform2(prop::array::uniform3(-1.0f64..1.0)),
            scale in prop::array::uniform3(prop_oneof![0.1f64..10.0, -10.0f64..-0.1]),
            rotate in prop::array::uniform3(-720.0f64..720.0),
        ) {
            let [a, b] = edges.map(DVec3::from);
            let cross = a.cross(b);
            // A sliver's f32 normal says too little about its edges.
            prop_assume!(cross.length() > 0.05);
            let normal = cross.normalize().as_vec3();
            let mesh = Mesh { positions: vec![a, b, cross], normals: vec![normal], ..Mesh::default() };
            let placed = place(mesh, scale.into(), rotate.into(), DVec3::ZERO);
            let n = placed.normals[0].as_dvec3();
            // f32 unit vectors are right to 2^-23 or so, times a slope of at most 100 : 0.05.
            const PERPENDICULAR: f64 = 1e-3;
            prop_assert!(n.dot(placed.positions[0].normalize()).abs() < PERPENDICULAR);
            prop_assert!(n.dot(placed.positions[1].normalize()).abs() < PERPENDICULAR);
            prop_assert!(n.dot(placed.positions[2]) > 0.0);
        }
    }
}
