//! Which triangles of a scene lie on a receiver, and where there.

use super::Receiver;
use crate::arrays::MapEach;
use crate::geometry::mesh::Mesh;
use crate::image::frame::NO_ID;
use crate::input::{Error, Result};
use crate::parallel;
use glam::{DVec2, DVec3};

/// A triangle in the plane of a receiver; it need not be within its border.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReceiverTriangle {
    pub receiver: u32,
    /// Its corners in file order, texels.
    pub corners: [DVec2; 3],
    /// Linear RGB.
    pub diffuse: [f32; 3],
}

/// All triangles on receivers.
#[derive(Debug, Clone, Default)]
pub struct ReceiverTriangles {
    /// Of each triangle of the scene: index into `triangles`, or [`NO_ID`].
    pub of_triangle: Vec<u32>,
    pub triangles: Vec<ReceiverTriangle>,
}

/// How far from a plane a point may lie that is in it, against all lengths at hand: a transform and a plane's normal take
/// some 2^-49 of these, text with ten digits 2^-33.
const PLANE_ROUNDING: f64 = 1.0 / (1u64 << 32) as f64;

/// The point is in the receiver's plane.
pub(crate) fn is_in_plane(receiver: &Receiver, p: DVec3) -> bool {
    let Some(n) = receiver.u.cross(receiver.v).try_normalize() else { return false };
    let size = p.length() + receiver.origin.length() + receiver.u.length() + receiver.v.length();
    (p - receiver.origin).dot(n).abs() <= PLANE_ROUNDING * size
}

impl ReceiverTriangles {
    pub fn new(receivers: &[Receiver], mesh: &Mesh) -> ReceiverTriangles {
        let receiver_triangle = |(id, triangle): (usize, &[u32; 3])| {
            if mesh.is_round(id as u32) {
                // caustics fall on triangles
                return None;
            }
            let corners = triangle.map_each(|k| mesh.positions[k as usize]);
            let receiver = receivers.iter().position(|r| corners.iter().all(|p| is_in_plane(r, *p)))?;
            let diffuse = mesh.materials[mesh.material_of[id] as usize].diffuse;
            let corners = corners.map_each(|p| receivers[receiver].texels_of(p));
            Some(ReceiverTriangle { receiver: receiver as u32, corners, diffuse })
        };
        let each: Vec<Option<ReceiverTriangle>> =
            parallel::map(0..mesh.triangles.len(), |id| receiver_triangle((id, &mesh.triangles[id])));
        let mut receiver_triangles = ReceiverTriangles::default();
        for receiver_triangle in each {
            let index = receiver_triangle.map_or(NO_ID, |_| receiver_triangles.triangles.len() as u32);
            receiver_triangles.of_triangle.push(index);
            receiver_triangles.triangles.extend(receiver_triangle);
        }
        receiver_triangles
    }

    /// What lies in a triangle.
    pub fn of(&self, triangle: u32) -> Option<&ReceiverTriangle> {
        let index = *self.of_triangle.get(triangle as usize)?;
        self.triangles.get(index as usize)
    }
}

impl ReceiverTriangle {
    /// The place of barycentric weights of the second and third corner.
    pub fn place(&self, [u, v]: [f64; 2]) -> DVec2 {
        let [a, b, c] = self.corners;
        a + u * (b - a) + v * (c - a)
    }
}

/// Refuses receivers without an area, without a triangle, or two in one plane.
pub fn check(receivers: &[Receiver], mesh: &Mesh) -> Result<()> {
    for (k, r) in receivers.iter().enumerate() {
        let wrong = |what: String| Err(Error::input(format!("caustics.receivers.{k}: {what}")));
        if r.area() <= PLANE_ROUNDING * r.u.length() * r.v.length() {
            return wrong("u and v are parallel or zero; give two sides of a parallelogram".into());
        }
        let corners = [r.origin, r.origin + r.u, r.origin + r.v];
        if let Some(other) = receivers[..k].iter().position(|o| corners.iter().all(|p| is_in_plane(o, *p))) {
            return wrong(format!("lies in the plane of receiver {other}; make one receiver of both"));
        }
    }
    let receiver_triangles = ReceiverTriangles::new(receivers, mesh);
    let bare = (0..receivers.len()).find(|k| receiver_triangles.triangles.iter().all(|l| l.receiver as usize != *k));
    match bare {
        Some(k) => Err(Error::input(format!(
            "caustics.receivers.{k}: no triangle of the scene lies in its plane; move it onto a floor or a wall"
        ))),
        None => Ok(()),
    }
}
