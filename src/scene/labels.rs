//! The object and the material of each triangle: the values of the channels `object.id` and `material.id`.

use super::Scene;
use crate::camera::Camera;
use crate::geometry::load::Object;
#[cfg(doc)]
use crate::geometry::mesh::Mesh;
use crate::geometry::scene_mesh::SceneMesh;
use crate::image::cryptomatte::{Matte, MatteKind};
use crate::image::frame::{Channel, NO_ID, PixelValues};
use std::sync::Arc;

/// Objects and materials by triangle id.
///
/// The number of an object is its index in [`Scene::objects`], that of a material its index in [`Mesh::materials`]: both in the order of
/// the meshes in the scene file. A mirror or lens of the camera has the number after the last object, and after the last material; the ids
/// of its facets come after those of all triangles.
#[derive(Debug, Clone)]
pub struct Labels {
    mesh: Arc<SceneMesh>,
    /// The first triangle after each object.
    ends: Vec<u32>,
}

impl Labels {
    /// The labels of a scene. Its mesh may have the facets of the camera's optics at its end.
    pub fn of(scene: &Scene) -> Labels {
        let end = |end: &mut u32, object: &Object| {
            // a scene has at most 2^28 triangles
            *end += object.triangles as u32;
            Some(*end)
        };
        Labels { mesh: scene.mesh.clone(), ends: scene.objects.iter().scan(0, end).collect() }
    }

    /// The object of a triangle; [`NO_ID`] where nothing is hit.
    pub fn object(&self, triangle: u32) -> u32 {
        match triangle {
            NO_ID => NO_ID,
            id => self.ends.partition_point(|end| *end <= id) as u32,
        }
    }

    /// The material of a triangle; [`NO_ID`] where nothing is hit.
    pub fn material(&self, triangle: u32) -> u32 {
        match triangle {
            NO_ID => NO_ID,
            id if (id as usize) < self.mesh.triangle_count() => {
                self.mesh.base().material_of[self.mesh.base_id(id) as usize]
            }
            _ => self.mesh.base().materials.len() as u32,
        }
    }

    /// A pixel with the labels of its triangle.
    pub fn labelled(&self, pixel: PixelValues) -> PixelValues {
        let (object, material) = (self.object(pixel.triangle), self.material(pixel.triangle));
        PixelValues { object, material, ..pixel }
    }

    /// An empty Cryptomatte for images of the scene through a camera. The ids of the camera's optics follow those of all triangles.
    pub fn matte(scene: &Scene, camera: &Camera, kind: MatteKind) -> Matte {
        let (names, name_of) = match kind {
            MatteKind::Objects => {
                let of = |(k, o): (u32, &Object)| std::iter::repeat_n(k, o.triangles);
                let names = scene.objects.iter().map(|o| o.name.clone()).collect();
                (names, (0..).zip(&scene.objects).flat_map(of).collect())
            }
            MatteKind::Materials => {
                let names = scene.mesh.base().materials.iter().map(|m| m.name.clone()).collect();
                (names, scene.mesh.material_of())
            }
        };
        Matte::new(kind, names, name_of, camera.optics.is_some())
    }

    /// The values of `channel` for these triangles; `None` if it is not a channel of labels.
    pub fn plane(&self, channel: Channel, triangles: &[u32]) -> Option<Vec<u32>> {
        match channel {
            Channel::ObjectId => Some(triangles.iter().map(|id| self.object(*id)).collect()),
            Channel::MaterialId => Some(triangles.iter().map(|id| self.material(*id)).collect()),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::Loading;

    #[test]
    fn ids_count_objects_and_their_materials_in_order() {
        let dir = tempfile::tempdir().unwrap();
        let file = |name: &str, text: &str| std::fs::write(dir.path().join(name), text).unwrap();
        file("two.mtl", "newmtl red\nKd 1 0 0\nnewmtl blue\nKd 0 0 1\n");
        file("two.obj", "mtllib two.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl blue\nf 1 2 3\nusemtl red\nf 1 2 3\n");
        let meshes = "mesh = [{ builtin = \"box\" }, { file = \"two.obj\" }, { builtin = \"box\" }]";
        let camera = "camera = { kind = \"pinhole\", eye = [0, 0, 9], target = [0, 0, 0], vfov = 40 }";
        file("scene.toml", &format!("{meshes}\n{camera}\n"));
        let mut scene = Scene::load(&dir.path().join("scene.toml"), &[], 0.0, &Loading::default()).unwrap();
        // an object without triangles
        scene.objects.insert(1, Object { name: "none".into(), triangles: 0 });
        let labels = Labels::of(&scene);
        let ids = [0, 11, 12, 13, 14, 25, 26, NO_ID];
        assert_eq!(labels.plane(Channel::ObjectId, &ids).unwrap(), [0, 0, 2, 2, 3, 3, 4, NO_ID]);
        let names: Vec<&str> = scene.mesh.materials.iter().map(|m| m.name.as_str()).collect();
        let materials = labels.plane(Channel::MaterialId, &ids).unwrap();
        assert_eq!(materials[6..], [names.len() as u32, NO_ID]);
        let named: Vec<&str> = materials[..6].iter().map(|k| names[*k as usize]).collect();
        assert_eq!(named, ["default", "default", "blue", "red", "default", "default"]);
        // each box has a material of its own, though they have one name
        assert_ne!(materials[0], materials[4]);
        assert_eq!(labels.plane(Channel::PieceId, &ids), None);
    }
}
