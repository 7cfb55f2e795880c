//! A cache of scene parts, reused by later scenes while their input files are unchanged.

use super::Scene;
use super::cameras::Cameras;
use super::file::{FileStep, SceneFile, SkySpec};
use super::projector_light::{ProjectorLight, ProjectorSpec, check_reach};
use super::shelf::Shelf;
use super::sky::Sky;
use crate::camera::Camera;
use crate::camera::exposure::Exposure;
use crate::geometry::instances::{Part, infinite_vertex};
use crate::geometry::load::{Object, load_unplaced, placed, with_unique_names};
use crate::geometry::mesh::Mesh;
use crate::geometry::scene_mesh::SceneMesh;
use crate::geometry::spec::MeshSpec;
use crate::geometry::texture::{Images, ImagesRead, Texture};
use crate::geometry::time_steps::{TimeStep, TimeSteps};
use crate::input::{Error, Loading, Result};
use crate::scene::caustics::Caustics;
use crate::scene::caustics::spec::CausticsSpec;
use crate::scene::volume::load::load_grid;
use crate::scene::volume::spec::{GridSpec, VolumeSpec};
use crate::scene::volume::{Grid, Volume};
use glam::DVec3;
use std::collections::HashSet;
use std::sync::Arc;

/// Loads scenes, and caches their parts across frames.
#[derive(Default)]
pub struct Library {
    /// Caching is off.
    is_for_once: bool,
    /// Meshes in object space.
    meshes: Shelf<(MeshSpec, ImagesRead), Mesh>,
    /// All meshes of a scene in world space, merged.
    merged: Shelf<(Vec<MeshSpec>, ImagesRead), Merged>,
    skies: Shelf<SkySpec, Sky>,
    volumes: Shelf<GridSpec, Grid>,
    caustics: Shelf<CausticsSpec, (Arc<Caustics>, Arc<SceneMesh>)>,
    cameras: Cameras,
}

/// All meshes, and the objects in them.
type Merged = (Arc<SceneMesh>, Vec<Object>);

/// Why a mesh cannot move during a frame.
const CHANGED: &str =
    "mesh: its triangles change while the frame is taken, they do not only move; make shutter and line_time 0";

impl Library {
    /// Without a cache, for one scene.
    pub fn for_once() -> Library {
        Library { is_for_once: true, ..Library::default() }
    }

    /// Loads a scene and all files that it names; `read` selects which textures are loaded.
    ///
    /// # Errors
    /// [`Error::Input`] naming the file or the key that is wrong.
    pub fn scene(&self, file: SceneFile, read: ImagesRead, loading: &Loading) -> Result<Scene> {
        self.meshes.next_scene();
        self.merged.next_scene();
        self.skies.next_scene();
        self.volumes.next_scene();
        self.caustics.next_scene();
        self.cameras.next_scene();
        let mut images = Images::of(read);
        let key = (file.meshes.clone(), read);
        let make = |loading: &Loading| self.merged(&file.meshes, &mut images, loading);
        let merged = self.merged.get(&key, !self.is_for_once, |_| true, loading, make)?;
        let (mesh, objects) = (merged.0.clone(), merged.1.clone());
        let steps = self.steps(&file, &mesh, &mut images, loading)?;
        let moves = file.steps.iter().any(|step| step.camera != file.camera);
        let camera_steps =
            file.steps.into_iter().filter(|_| moves).map(|step| (step.time, step.camera)).collect::<Vec<_>>();
        let size = match (file.image.width, file.image.height) {
            (Some(w), Some(h)) => Some((w, h)),
            (None, None) => None,
            _ => return Err(Error::input("image: give both width and height")),
        };
        let is_of = |known: &(Arc<Caustics>, Arc<SceneMesh>)| Arc::ptr_eq(&known.1, &mesh);
        let lit = |spec: &CausticsSpec| {
            let make = |loading: &Loading| {
                mesh.check_copies(loading.limits())?;
                Ok((Arc::new(Caustics::new(spec, &mesh, loading)?), mesh.clone()))
            };
            self.caustics.get(spec, !self.is_for_once, is_of, loading, make)
        };
        let caustics = file.caustics.as_ref().map(lit).transpose()?;
        let sky = |spec: &SkySpec| {
            let make = |loading: &Loading| Sky::new(spec, &mut images, loading);
            self.skies.get(spec, !self.is_for_once, |_| true, loading, make)
        };
        let sky = file.sky.as_ref().map(sky).transpose()?;
        let thrown = |(k, spec): (usize, &ProjectorSpec)| {
            let light = self.projector_light(spec, &mesh, &mut images, loading);
            light.map(Arc::new).map_err(|e| e.at(format_args!("projector_light.{k}")))
        };
        // where no colour is asked for
        let given = if read == ImagesRead::All { &file.projector_lights[..] } else { &[] };
        let projector_lights = given.iter().enumerate().map(thrown).collect::<Result<_>>()?;
        let volume = file.volume.map(|spec| self.volume(spec, loading)).transpose()?;
        Ok(Scene {
            mesh: mesh.clone(),
            objects,
            lights: file.lights,
            projector_lights,
            ambient_occlusion: file.ambient_occlusion,
            style: file.style,
            sky,
            volume,
            background: file.image.background,
            tone: file.image.tone,
            depth_range: file.image.depth_range,
            size,
            camera: file.camera,
            camera_keys: file.camera_keys,
            caustics: caustics.map(|c| c.0.clone()),
            exposure: Exposure { is_even: !camera_steps.is_empty(), ..file.exposure },
            steps,
            casters: None,
            camera_steps,
            output: file.output,
            limits: loading.limits(),
        })
    }

    fn volume(&self, spec: VolumeSpec, loading: &Loading) -> Result<Volume> {
        let VolumeSpec { grid, transfer, mode, is_lit } = spec;
        let make = |loading: &Loading| load_grid(&grid, None, loading);
        let grid = self.volumes.get(&grid, !self.is_for_once, |_| true, loading, make)?;
        Ok(Volume { grid, transfer, mode, is_lit })
    }

    /// The scene's camera for an image of `size`, or of the scene's own.
    ///
    /// # Errors
    /// Those of [`Camera::in_scene`].
    pub fn camera(&self, scene: &Scene, size: Option<(u32, u32)>, loading: &Loading) -> Result<Arc<Camera>> {
        self.cameras.of_scene(scene, size, !self.is_for_once, loading)
    }

    /// A picture and the camera that it is thrown by, in the scene of `mesh`.
    ///
    /// # Errors
    /// [`Error::Input`] if its rays are not straight, begin too far away, or its values contradict each other; those of files that cannot be read.
    pub(crate) fn projector_light(
        &self,
        spec: &ProjectorSpec,
        mesh: &Arc<SceneMesh>,
        images: &mut Images,
        loading: &Loading,
    ) -> Result<ProjectorLight> {
        let texels = images.load(&spec.image, loading)?;
        let key = (spec.camera.clone(), Some((texels.width, texels.height)));
        let camera = self.cameras.get(key, mesh, mesh.into(), !self.is_for_once, loading)?;
        check_reach(&camera, mesh)?;
        ProjectorLight::new(camera, Texture::new(texels), spec.throw)
    }

    /// All meshes in the world as one, and their objects.
    fn merged(&self, meshes: &[MeshSpec], images: &mut Images, loading: &Loading) -> Result<Merged> {
        let placed = meshes.iter().map(|m| self.placed(m, images, loading)).collect::<Result<Vec<_>>>()?;
        let (mut parts, objects): (Vec<Part>, Vec<Vec<Object>>) = placed.into_iter().unzip();
        let objects = with_unique_names(objects.into_iter().flatten());
        let mut known = HashSet::new();
        parts.iter_mut().for_each(|part| part.0.missing.retain(|missing| known.insert(missing.what.clone())));
        if let Some(v) = parts.iter().find_map(infinite_vertex) {
            return Err(Error::input(format!("mesh: a vertex lies at {v} after its transform; use finite numbers")));
        }
        Ok((Arc::new(SceneMesh::of(parts, loading.limits())?), objects))
    }

    /// Where the mesh is at the times of a frame, if it moves.
    fn steps(
        &self,
        file: &SceneFile,
        mesh: &SceneMesh,
        images: &mut Images,
        loading: &Loading,
    ) -> Result<Option<Arc<TimeSteps>>> {
        if file.steps.iter().all(|step| step.meshes == file.meshes) {
            return Ok(None);
        }
        mesh.check_copies(loading.limits())?;
        let step = |step: &FileStep| {
            let (now, _) = self.merged(&step.meshes, images, loading)?;
            let now = Mesh::clone(now.mesh());
            if (&now.triangles, &now.radii, &now.corner_normals) != (&mesh.triangles, &mesh.radii, &mesh.corner_normals)
            {
                return Err(Error::input(CHANGED));
            }
            Ok(TimeStep { positions: now.positions, normals: now.normals })
        };
        let steps = file.steps.iter().map(step).collect::<Result<_>>()?;
        let times = file.steps.iter().map(|step| step.time).collect();
        Ok(TimeSteps::beside(mesh, times, steps).map(Arc::new))
    }

    /// A mesh with its places, and its objects: one, or one for each copy.
    fn placed(&self, spec: &MeshSpec, images: &mut Images, loading: &Loading) -> Result<(Part, Vec<Object>)> {
        let (scale, rotate, translate) = (DVec3::ONE, DVec3::ZERO, DVec3::ZERO);
        let own = MeshSpec { scale, rotate, translate, places: None, ..spec.clone() };
        let key = (own, images.read);
        let make = |loading: &Loading| load_unplaced(&key.0, images, loading);
        let mesh = self.meshes.get(&key, !self.is_for_once, |_| true, loading, make)?;
        let mesh = Arc::try_unwrap(mesh).unwrap_or_else(|kept| (*kept).clone());
        placed(mesh, spec, loading)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::files::Inputs;
    use crate::scene::file;
    use std::path::Path;

    fn scene(keys: &str) -> String {
        let camera = "kind = \"panorama\"\nradius = 4\nheight = 3";
        format!("[image]\nwidth = 8\nheight = 6\n[[mesh]]\nfile = \"a.obj\"\n{keys}\n[camera]\n{camera}\n")
    }

    fn load(library: &Library, folder: &Path, keys: &str) -> (Scene, Arc<Camera>, Inputs) {
        let path = folder.join("scene.toml");
        std::fs::write(&path, scene(keys)).unwrap();
        let loading = Loading::default();
        let file = file::load(&path, &[], 0.0, &loading).unwrap();
        let scene = library.scene(file, ImagesRead::All, &loading).unwrap();
        let camera = library.camera(&scene, None, &loading).unwrap();
        (scene, camera, loading.into_inputs())
    }

    /// In quadratic time, with each name trying all numbers from 1, this would take hours.
    #[test]
    fn many_meshes_of_one_name_are_named_in_linear_time() {
        let names = ["box.3", "box"].into_iter().chain(std::iter::repeat_n("box", 200_000));
        let objects = with_unique_names(names.map(|name| Object { name: name.into(), triangles: 0 }));
        let first: Vec<&str> = objects.iter().take(5).map(|o| o.name.as_str()).collect();
        assert_eq!(first, ["box.3", "box", "box.2", "box.4", "box.5"]);
        assert_eq!(objects[200_001].name, "box.200002");
    }

    #[test]
    fn what_is_the_same_is_kept_and_what_has_changed_is_made_anew() {
        let dir = tempfile::tempdir().unwrap();
        let obj = |x: f64| format!("v {x} 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
        std::fs::write(dir.path().join("a.obj"), obj(0.0)).unwrap();
        let library = Library::default();
        let first = load(&library, dir.path(), "");
        let again = load(&library, dir.path(), "");
        assert!(Arc::ptr_eq(&first.0.mesh, &again.0.mesh) && Arc::ptr_eq(&first.1, &again.1));
        // files count for what is kept too
        let names = |inputs: &Inputs| inputs.files().map(|(path, _)| path.to_owned()).collect::<Vec<_>>();
        assert_eq!(names(&first.2), [dir.path().join("scene.toml"), dir.path().join("a.obj")]);
        assert_eq!(names(&again.2), names(&first.2));
        // a panorama does not look at the scene
        let rotated = load(&library, dir.path(), "rotate = [0, 30, 0]");
        assert!(!Arc::ptr_eq(&first.0.mesh, &rotated.0.mesh) && Arc::ptr_eq(&first.1, &rotated.1));
        let alone = Scene::load(&dir.path().join("scene.toml"), &[], 0.0, &Loading::default()).unwrap();
        assert!(*rotated.0.mesh == *alone.mesh);
        // the file is another one
        std::fs::write(dir.path().join("a.obj"), obj(-0.25)).unwrap();
        let other = load(&library, dir.path(), "");
        assert_eq!(other.0.mesh.positions[0].x, -0.25);
    }
}
