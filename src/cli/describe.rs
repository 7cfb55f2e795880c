//! What a camera compiled to, for a person and for the header of an EXR.

use crate::camera::glc::{Class, classify};
use crate::camera::{Bundle, Camera, Rays};
use crate::scene::file::{CameraKind, CameraSpec, CameraVertex, MeshCameraSpec};
use glam::{DVec2, DVec3};
use serde::{Serialize, Serializer};
use std::fmt;

/// A compiled camera in short.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Description {
    pub kind: &'static str,
    pub width: u32,
    pub height: u32,
    pub t_range: [Bound; 2],
    /// 0 for a ray map.
    pub pieces: usize,
    /// The degree of the curves that the rays are, where they are not straight.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub degree: Option<usize>,
    /// The classes of the pieces' general linear cameras, the most frequent first.
    pub classes: Vec<ClassCount>,
    /// The rays, where the whole image is one piece.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bundle: Option<BundleRecord>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<String>,
}

/// An end of t; infinities are "inf" and "-inf" in JSON.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bound(pub f64);

/// How many pieces are of one class.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ClassCount {
    pub class: &'static str,
    pub pieces: usize,
    /// Ray parameters of the slits, where there is one such piece.
    pub slits: Vec<f64>,
}

/// `P = p[0] + x p[1] + y p[2]`, `D` alike, x and y in pixels from the middle of the image.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BundleRecord {
    pub p: [[f64; 3]; 3],
    pub d: [[f64; 3]; 3],
}

/// Rays whose weights differ over the piece are no affine functions of the image, so no GLC.
const WEIGHTED: &str = "weighted (its corners' w differ)";

impl Description {
    pub fn of(spec: &CameraSpec, camera: &Camera) -> Description {
        let corners = corner_rays(spec, camera);
        let bundle = match camera.layers.as_slice() {
            [Rays::Pieces(p)] => p.pieces.first().filter(|piece| piece.corners_px.is_none()).map(|piece| &piece.bundle),
            _ => None,
        };
        let rows = |v: &[DVec3; 3]| v.map(|v| v.to_array());
        Description {
            kind: camera.kind,
            width: camera.width,
            height: camera.height,
            t_range: camera.t_range.map(Bound),
            pieces: camera.piece_count(),
            degree: camera.layers.iter().filter_map(degree).max(),
            classes: count_classes(&corners),
            bundle: bundle.map(|b| BundleRecord { p: rows(&b.p), d: rows(&b.d) }),
            notes: camera.notes.clone(),
        }
    }
}

fn degree(layer: &Rays) -> Option<usize> {
    match layer {
        Rays::Curves(curves) => Some(curves.map.degree()),
        _ => None,
    }
}

fn count_classes(pieces: &[[CameraVertex; 3]]) -> Vec<ClassCount> {
    let mut classes: Vec<ClassCount> = Vec::new();
    for corners in pieces {
        let (class, slits) = if corners.iter().any(|c| c.w != corners[0].w) {
            (WEIGHTED, Vec::new())
        } else {
            let (class, slits) = classify(&corners.map(|c| c.near), &corners.map(|c| c.far));
            // a root of -0 is 0
            (class.name(), slits.into_iter().map(|t| t + 0.0).collect())
        };
        match classes.iter_mut().find(|c| c.class == class) {
            Some(count) => {
                count.pieces += 1;
                count.slits.clear();
            }
            None => classes.push(ClassCount { class, pieces: 1, slits }),
        }
    }
    // stable: equal counts stay in the order of the pieces
    classes.sort_by_key(|c| std::cmp::Reverse(c.pieces));
    classes
}

/// The rays at three corners of every piece, from the numbers as written where the scene has them.
fn corner_rays(spec: &CameraSpec, camera: &Camera) -> Vec<[CameraVertex; 3]> {
    match (&spec.kind, &camera.layers[0]) {
        (CameraKind::Mesh(mesh), _) => {
            let vertices = plain_vertices(mesh);
            mesh.triangles.iter().map(|t| t.map(|i| vertices[i as usize])).collect()
        }
        (CameraKind::Glc { near, far }, _) => {
            let image = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
            let vertex = |k: usize| CameraVertex { image: image[k], near: near[k], far: far[k], w: 1.0 };
            vec![[0, 1, 2].map(vertex)]
        }
        (_, Rays::Pieces(p)) => {
            let size = DVec2::new(camera.width.into(), camera.height.into());
            let whole = p.pieces.iter().filter(|piece| piece.corners_px.is_none());
            whole
                .map(|piece| {
                    [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(|ab| vertex_at(&piece.bundle, piece.centre_px, size, ab))
                })
                .collect()
        }
        (_, Rays::Field(_) | Rays::Curves(_)) => Vec::new(),
    }
}

/// The vertices of a mesh camera so that plain interpolation gives its rays: unit directions become far points.
pub fn plain_vertices(mesh: &MeshCameraSpec) -> Vec<CameraVertex> {
    let plain = |v: &CameraVertex| match mesh.normalize {
        true => CameraVertex { far: v.near + (v.far - v.near).normalize_or_zero(), ..*v },
        false => *v,
    };
    mesh.vertices.iter().map(plain).collect()
}

/// The ray at image coordinates `ab`, of a bundle with h = 1 centred on `centre_px`.
pub fn vertex_at(bundle: &Bundle, centre_px: DVec2, size: DVec2, ab: [f64; 2]) -> CameraVertex {
    let offset = DVec2::from(ab) * size - centre_px;
    let ray = bundle.ray(offset.x, offset.y);
    CameraVertex { image: ab, near: ray.origin, far: ray.origin + ray.direction, w: 1.0 }
}

impl fmt::Display for Bound {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}", self.0)
    }
}

impl Serialize for Bound {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        if self.0.is_finite() { serializer.serialize_f64(self.0) } else { serializer.collect_str(&self.0) }
    }
}

impl fmt::Display for Description {
    /// Some lines, each a word and its value.
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        writeln!(f, "kind     {}", self.kind)?;
        writeln!(f, "image    {} x {}", self.width, self.height)?;
        match (self.pieces, self.degree) {
            (0, None) => writeln!(f, "pieces   none: a ray of its own for each pixel")?,
            (0, Some(m)) => writeln!(f, "pieces   none: a curve of degree {m} for each pixel")?,
            (n, None) => writeln!(f, "pieces   {n}")?,
            (n, Some(m)) => writeln!(f, "pieces   {n}, of curves of degree {m}")?,
        }
        for count in &self.classes {
            let slits: Vec<String> = count.slits.iter().map(f64::to_string).collect();
            let slits = match slits.len() {
                0 => String::new(),
                1 if count.class == Class::Pinhole.name() => format!(", rays meet at t = {}", slits[0]),
                1 => format!(", slit at t = {}", slits[0]),
                _ => format!(", slits at t = {}", slits.join(" and ")),
            };
            let pieces = if self.pieces == 1 { String::new() } else { format!("{} of ", count.pieces) };
            writeln!(f, "class    {pieces}{}{slits}", count.class)?;
        }
        writeln!(f, "t_range  [{}, {}]", self.t_range[0], self.t_range[1])?;
        self.notes.iter().try_for_each(|note| writeln!(f, "note     {note}"))
    }
}
