//! Boxes around the objects of a scene, and the kinds of content of each.

use crate::geometry::mesh::{Material, Mesh, NO_COLOR, NO_NORMAL, joined};
use crate::geometry::time_steps::MovingMesh;
use crate::parallel;
use crate::scene::Scene;
use glam::DVec3;
use std::ops::{BitAnd, BitOr, Not, Range};
use std::sync::OnceLock;

/// Kinds of content that kernels handle only in frames that need it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Kinds {
    pub spheres: bool,
    /// Vertices or normals move while the frame is taken.
    pub motion: bool,
    /// Images lie on triangles.
    pub images: bool,
    pub alpha_masks: bool,
    pub smooth_normals: bool,
    pub vertex_colors: bool,
    /// Patterns are drawn on surfaces.
    pub patterns: bool,
}

impl Kinds {
    pub const NONE: Kinds = Kinds::each(false);
    pub const ALL: Kinds = Kinds::each(true);
    /// Kinds that change only the surfaces that have them.
    pub const LOOKS: Kinds = Kinds { spheres: false, motion: false, images: false, alpha_masks: false, ..Kinds::ALL };

    const fn each(has: bool) -> Kinds {
        let [spheres, motion, images, alpha_masks, smooth_normals, vertex_colors, patterns] = [has; 7];
        Kinds { spheres, motion, images, alpha_masks, smooth_normals, vertex_colors, patterns }
    }

    fn joined(self, other: Kinds, join: impl Fn(bool, bool) -> bool) -> Kinds {
        Kinds {
            spheres: join(self.spheres, other.spheres),
            motion: join(self.motion, other.motion),
            images: join(self.images, other.images),
            alpha_masks: join(self.alpha_masks, other.alpha_masks),
            smooth_normals: join(self.smooth_normals, other.smooth_normals),
            vertex_colors: join(self.vertex_colors, other.vertex_colors),
            patterns: join(self.patterns, other.patterns),
        }
    }
}

impl BitOr for Kinds {
    type Output = Kinds;
    fn bitor(self, other: Kinds) -> Kinds {
        self.joined(other, |a, b| a || b)
    }
}

impl BitAnd for Kinds {
    type Output = Kinds;
    fn bitand(self, other: Kinds) -> Kinds {
        self.joined(other, |a, b| a && b)
    }
}

impl Not for Kinds {
    type Output = Kinds;
    fn not(self) -> Kinds {
        self.joined(Kinds::NONE, |a, _| !a)
    }
}

/// An object of a scene.
#[derive(Debug, Clone, Copy)]
pub struct ObjectBox {
    /// The least and the greatest corner of the box around it at all times of the frame, world units.
    pub bounds: (DVec3, DVec3),
    pub kinds: Kinds,
}

/// The objects of a scene, looked at when a frame first asks.
#[derive(Debug, Default)]
pub struct Objects(OnceLock<Vec<ObjectBox>>);

/// Triangles that one thread looks at together.
const BLOCK: u32 = 4096;

impl Objects {
    /// Returns one box for each object that has triangles, and one for the triangles that belong to no object.
    pub fn of(&self, scene: &Scene) -> &[ObjectBox] {
        self.0.get_or_init(|| {
            let blocks = blocks(scene);
            let parts = parallel::map(&blocks, |(object, ids)| (*object, of_triangles(scene, ids.clone())));
            let mut all: Vec<(usize, ObjectBox)> = Vec::new();
            for (object, part) in parts {
                match all.last_mut() {
                    Some((last, whole)) if *last == object => {
                        whole.bounds = joined(whole.bounds, part.bounds);
                        whole.kinds = whole.kinds | part.kinds;
                    }
                    _ => all.push((object, part)),
                }
            }
            all.into_iter().map(|(_, object)| object).collect()
        })
    }
}

/// The triangles of each object, in blocks.
fn blocks(scene: &Scene) -> Vec<(usize, Range<u32>)> {
    let count = scene.mesh.triangles.len() as u32;
    let mut blocks = Vec::new();
    let mut first = 0u32;
    let sizes = scene.objects.iter().map(|object| object.triangles as u32).chain([count]);
    for (object, size) in sizes.enumerate() {
        let end = first.saturating_add(size).min(count);
        let starts = (first..end).step_by(BLOCK as usize);
        blocks.extend(starts.map(|start| (object, start..start.saturating_add(BLOCK).min(end))));
        first = end;
    }
    blocks
}

fn of_triangles(scene: &Scene, ids: Range<u32>) -> ObjectBox {
    let (mesh, moving) = (&**scene.mesh, scene.moving_mesh());
    let mut object = ObjectBox { bounds: (DVec3::INFINITY, DVec3::NEG_INFINITY), kinds: Kinds::NONE };
    for id in ids {
        object.bounds = joined(object.bounds, mesh.primitive(id).bounds());
        if moves(moving, id) {
            object.kinds.motion = true;
            for step in 0..moving.count() {
                object.bounds = joined(object.bounds, moving.primitive(id, step).bounds());
            }
        }
        object.kinds = object.kinds | kinds(mesh, id);
    }
    object
}

/// The kinds of a triangle or sphere, but for motion.
fn kinds(mesh: &Mesh, id: u32) -> Kinds {
    let material = mesh.material(id);
    let is = |of: fn(&Material) -> bool| material.is_some_and(of);
    let has = |corners: &[[u32; 3]], none: u32| corners.get(id as usize).is_some_and(|c| *c != [none; 3]);
    Kinds {
        spheres: mesh.is_round(id),
        motion: false,
        images: is(|m| m.texture.is_some()) && mesh.uvs_of(id as usize).is_some(),
        alpha_masks: mesh.has_alpha(id),
        smooth_normals: has(&mesh.corner_normals, NO_NORMAL),
        vertex_colors: has(&mesh.corner_colors, NO_COLOR),
        patterns: is(|m| m.pattern.is_some()),
    }
}

/// Returns whether the corners or normals of a triangle differ from the mesh at any time step of the frame.
fn moves(all: MovingMesh, id: u32) -> bool {
    let still = MovingMesh::from(all.mesh);
    let normals = all.mesh.corner_normals.get(id as usize).copied().unwrap_or([NO_NORMAL; 3]);
    let turns = |step: u32| {
        let named = normals.iter().filter(|normal| **normal != NO_NORMAL);
        named.into_iter().any(|normal| all.normal(*normal, step) != still.normal(*normal, 0))
    };
    all.steps.is_some() && (0..all.count()).any(|step| all.corners(id, step) != still.corners(id, 0) || turns(step))
}
